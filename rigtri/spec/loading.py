"""Read a rig spec: all that is wrong with it at once, each fault with file, line and column."""

from __future__ import annotations

import json
from collections.abc import Container, Mapping
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigtri.compare import TOLERANCE
from rigtri.errors import RigtriError, UsageError
from rigtri.formats import Options
from rigtri.spec.faults import Fault, Place, SpecError
from rigtri.spec.tree import Keys, Label, Tree
from rigtri.spec.validating import step_models, validated, value_at, where_of
from rigtri.steps import step
from rigtri.steps.request import Request

if TYPE_CHECKING:
    from rigtri.spec.models.base import StepModel
    from rigtri.spec.models.spec import SpecModel

# Options that name files, by operation; a spec is done again when one of them has changed.
_FILES = ("like", "frames", "edited", "described")


@dataclass(frozen=True)
class PlannedStep:
    """One step: its operation, what is asked of it, and where it stands. index: among all, from 0."""

    index: int
    label: Label
    do: str
    request: Request
    optional: bool
    place: Place
    said: dict[str, Any]

    @property
    def number(self) -> int:
        """Its number in the file, from 1; steps of the same braces have the same."""
        return self.label.number


@dataclass(frozen=True)
class Spec:
    """A spec that is right in itself; whether a character has its joints shows when it is built."""

    path: Path
    model: SpecModel
    steps: tuple[PlannedStep, ...]
    tree: Tree
    sources: tuple[Path, ...]

    @property
    def reading(self) -> Options:
        """How files are read and written."""
        return self.model.reading()

    def limited(
        self, *, strict: bool = False, tolerance: float | None = None, resources: str | None = None
    ) -> Spec:
        """The spec as one that is strict, or with another tolerance or way with the files of a .gltf.

        Its own where nothing is said.
        """
        changed: dict[str, Any] = {"strict": True} if strict else {}
        changed |= {} if tolerance is None else {"tolerance": tolerance}
        changed |= {} if resources is None else {"resources": resources}
        if not changed:
            return self
        model = self.model.model_copy(update=changed)
        return replace(self, model=model, steps=_planned(model, self.tree))

    def canonical(self) -> str:
        """What is done, as JSON that is equal for equal work: options by name, defaults filled in."""
        said = self.model.model_dump(mode="json", by_alias=True, exclude={"schema_", "name", "extends"})
        for word in ("variables", "defaults"):  # they have gone into the steps
            said.pop(word)
        return json.dumps(said, sort_keys=True, ensure_ascii=False)

    def files(self) -> tuple[Path, ...]:
        """All files that the spec is made of or that its steps read, besides the character."""
        named = [step.request.values.get(name) for step in self.steps for name in _FILES]
        return (*self.sources, *dict.fromkeys(Path(name) for name in named if name))

    def needed(self) -> tuple[tuple[Path, str], ...]:
        """`files`, each with what it is: nothing that is written may take their place."""
        spec = self.sources[0]
        said = {spec: "the spec", **dict.fromkeys(self.sources[1:], f"a spec that {spec} extends")}
        return tuple((file, said.get(file, f"a file that {spec} names")) for file in self.files())

    def fault(self, step: PlannedStep, error: RigtriError) -> Fault:
        """What a step said about a character, at the word of the spec that it is about."""
        keys: Keys = ("steps", step.index)
        text = str(error)
        where = where_of(self.tree, keys)
        for below, place in self.tree.under(keys):
            value = value_at(self.tree.values, (*keys, *below))
            if below and any(f"'{name}'" in text for name in _names(value, below)):
                return Fault(place, where, text)
        return Fault(step.place, where, text)


def _names(value: Any, keys: Keys) -> list[str]:
    """What a value of a spec may name: itself, its key, or one of both sides of ``=``."""
    words = [value, *value.split("=")] if isinstance(value, str) else []
    return [word for word in (*words, keys[-1]) if isinstance(word, str)]


def load(path: Path | str, *, variables: Mapping[str, str] | None = None) -> Spec:
    """The spec in a YAML, TOML or JSON file.

    variables: values instead of those in the spec. Raises FileError for a file that cannot be read,
    SpecError, a UsageError, with all that is wrong in it.
    """
    _need_extra()
    from rigtri.spec.merging import merged

    path = Path(path)
    tree, sources, faults = merged(path, variables or {})
    unsure = {fault.place for fault in faults}
    _find_files(tree)
    model, found = validated(tree)
    wrong = {keys[1] for keys, _ in found if len(keys) > 1 and keys[0] == "steps"}
    wrong |= {n for n, _ in enumerate(tree.labels) if unsure & {p for _, p in tree.under(("steps", n))}}
    # A value with a variable that there is not is wrong for no other reason.
    faults += [one for keys, one in found if not unsure & {place for _, place in tree.under(keys)}]
    if model is None or faults:
        faults += [fault for fault, _ in _contradictions(tree, wrong)]
        raise SpecError(faults)
    if not model.steps:
        raise SpecError([Fault(tree.place(("steps",)), "", "the spec has no steps; say what is to be done")])
    return Spec(path, model, _planned(model, tree), tree, sources)


def _contradictions(tree: Tree, wrong: Container[int | str]) -> list[tuple[Fault, int]]:
    """What is wrong with options of steps together, where nothing is with any alone; with exit codes."""
    steps = tree.values.get("steps")
    found = []
    for number, said in enumerate(steps if isinstance(steps, list) else ()):
        if number not in wrong:
            one = step_models()[said["do"]].model_validate(said)
            asked = one.request({"root": None, "tolerance": TOLERANCE}, Options())
            if told := _contradiction(tree, number, said["do"], asked):
                found.append(told)
    return found


def _contradiction(tree: Tree, number: int, do: str, asked: Request) -> tuple[Fault, int] | None:
    keys: Keys = ("steps", number)
    try:
        step(do, asked)
    except RigtriError as error:
        return Fault(tree.place(keys), where_of(tree, keys), str(error)), error.exit_code
    return None


def _find_files(tree: Tree) -> None:
    """Let the files that steps name be seen from the file of the spec that says so."""
    models = step_models()
    steps = tree.values.get("steps")
    for number, one in enumerate(steps if isinstance(steps, list) else ()):
        model = models.get(str(one.get("do"))) if isinstance(one, dict) else None
        for name, about in model.model_fields.items() if model else ():
            option = about.alias or name
            if name in _FILES and isinstance(one.get(option), str) and one[option]:
                folder = Path(tree.place(("steps", number, option)).file).parent
                one[option] = str(folder / one[option])


def _need_extra() -> None:
    missing = [name for name in ("pydantic", "ruamel.yaml") if not _has(name)]
    if missing:
        words = " and ".join(missing)
        raise UsageError(f"specs need {words}; install them with: pip install 'rigtri[spec]'")


def _has(name: str) -> bool:
    try:
        return find_spec(name) is not None
    except ModuleNotFoundError:
        return False


def _planned(model: SpecModel, tree: Tree) -> tuple[PlannedStep, ...]:
    """The steps; SpecError with all those whose options contradict each other."""
    reading, shared = model.reading(), model.shared()
    found, faults = [], []
    for number, one in enumerate(model.steps):
        asked = one.request(shared, reading)
        if told := _contradiction(tree, number, one.do, asked):
            faults.append(told)
        place, label = tree.place(("steps", number)), tree.labels[number]
        found.append(PlannedStep(number, label, one.do, asked, one.optional, place, _said(one)))
    if faults:
        raise SpecError([fault for fault, _ in faults], faults[0][1])
    return tuple(found)


def _said(one: StepModel) -> dict[str, Any]:
    """The options that the spec gives a step, by their names there."""
    said = one.model_dump(mode="json", by_alias=True, exclude_unset=True)
    return {name: value for name, value in said.items() if name not in ("do", "optional")}
