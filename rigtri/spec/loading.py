"""Read a rig spec: all that is wrong with it at once, each fault with file, line and column."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigtri.errors import RigtriError, UsageError
from rigtri.formats import Options
from rigtri.spec.faults import Fault, Place, SpecError
from rigtri.spec.tree import Keys, Tree
from rigtri.steps import STEPS, step
from rigtri.steps.request import Request

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

    from rigtri.spec.models.base import StepModel
    from rigtri.spec.models.spec import SpecModel

# Options that name files, by operation; a spec is done again when one of them has changed.
_FILES = ("like", "frames", "edited", "described")


@dataclass(frozen=True)
class PlannedStep:
    """One step: its operation, what is asked of it, and where it stands."""

    number: int
    do: str
    request: Request
    optional: bool
    place: Place
    said: dict[str, Any]


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
        keys: Keys = ("steps", step.number - 1)
        text = str(error)
        for below, place in self.tree.under(keys):
            value = _at(self.tree.values, (*keys, *below))
            if below and isinstance(value, str) and f"'{value}'" in text:
                return Fault(place, _where(self.tree.values, keys), text)
        return Fault(step.place, _where(self.tree.values, keys), text)


def load(path: Path | str, *, variables: Mapping[str, str] | None = None) -> Spec:
    """The spec in a YAML, TOML or JSON file.

    variables: values instead of those in the spec. Raises FileError for a file that cannot be read,
    SpecError, a UsageError, with all that is wrong in it.
    """
    _need_extra()
    from pydantic import ValidationError

    from rigtri.spec.merging import merged
    from rigtri.spec.models.spec import SpecModel

    path = Path(path)
    tree, sources = merged(path, variables or {})
    try:
        model = SpecModel.model_validate(tree.values, context={"folder": path.parent})
    except ValidationError as error:
        raise SpecError([_fault(tree, told) for told in error.errors(include_url=False)]) from error
    if not model.steps:
        raise SpecError([Fault(tree.place(("steps",)), "", "the spec has no steps; say what is to be done")])
    return Spec(path, model, _planned(model, tree), tree, sources)


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
        keys: Keys = ("steps", number)
        place = tree.place(keys)
        try:
            step(one.do, asked)
        except RigtriError as error:
            faults.append((Fault(place, _where(tree.values, keys), str(error)), error.exit_code))
        found.append(PlannedStep(number + 1, one.do, asked, one.optional, place, _said(one)))
    if faults:
        raise SpecError([fault for fault, _ in faults], faults[0][1])
    return tuple(found)


def _said(one: StepModel) -> dict[str, Any]:
    """The options that the spec gives a step, by their names there."""
    said = one.model_dump(mode="json", by_alias=True, exclude_unset=True)
    return {name: value for name, value in said.items() if name not in ("do", "optional")}


def _fault(tree: Tree, told: ErrorDetails) -> Fault:
    """A fault of the model in the user's words, at the place of the value."""
    keys = _known(tree.values, told["loc"])
    where = _where(tree.values, keys)
    kind, ctx = told["type"], told.get("ctx", {})
    name = str(told["loc"][-1]) if told["loc"] else ""
    if kind == "extra_forbidden":
        return Fault(tree.place(keys), where, f"there is no option '{name}'.{_near(tree, told['loc'])}")
    if kind == "missing" and name.isdigit():
        return Fault(tree.place(keys), where, f"{_option(keys)}: there are too few values")
    if kind == "missing":
        return Fault(tree.place(keys), where, f"'{name}' is missing")
    if kind == "union_tag_not_found":
        return Fault(tree.place(keys), where, "'do' is missing: the name of an operation, e.g. orient-joints")
    if kind == "union_tag_invalid":
        close = get_close_matches(str(ctx.get("tag")), STEPS, n=1)
        hint = f" Did you mean '{close[0]}'?" if close else f" There are {', '.join(STEPS)}."
        return Fault(tree.place((*keys, "do")), where, f"there is no operation {ctx.get('tag')!r}.{hint}")
    text = told["msg"].removeprefix("Value error, ")
    text = text[:1].lower() + text[1:]
    shown = "" if kind == "value_error" else f" (it is {_short(told['input'])})"
    option = _option(keys)
    return Fault(tree.place(keys), where, f"{option}: {text}{shown}" if option else f"{text}{shown}")


def _known(values: Any, loc: tuple[str | int, ...]) -> Keys:
    """The keys of a fault that the spec has; pydantic puts words for its own choices between."""
    keys: Keys = ()
    for key in loc:
        value = _at(values, keys)
        if (isinstance(value, dict) and key in value) or (
            isinstance(value, list) and isinstance(key, int) and key < len(value)
        ):
            keys = (*keys, key)
    return keys


def _at(values: Any, keys: Keys) -> Any:
    for key in keys:
        try:
            values = values[key]
        except (KeyError, IndexError, TypeError):
            return None
    return values


def _where(values: Any, keys: Keys) -> str:
    """Which step it is: ``step 3 (add-twist)``, counted from 1."""
    if len(keys) < 2 or keys[0] != "steps" or not isinstance(keys[1], int):
        return ""
    one = _at(values, keys[:2])
    do = one.get("do") if isinstance(one, dict) else None
    return f"step {keys[1] + 1} ({do})" if do else f"step {keys[1] + 1}"


def _option(keys: Keys) -> str:
    """The option that a fault is about."""
    below = keys[2:] if keys[:1] == ("steps",) else keys
    return ".".join(str(key) for key in below)


def _near(tree: Tree, loc: tuple[str | int, ...]) -> str:
    """What an unknown option may be meant to be."""
    from rigtri.spec.models.spec import SpecModel

    known: list[str] = [str(field.alias or name) for name, field in SpecModel.model_fields.items()]
    for model in _step_models():
        if len(loc) > 2 and loc[2] == model.model_fields["do"].annotation.__args__[0]:  # type: ignore[union-attr]
            known = [str(field.alias or name) for name, field in model.model_fields.items()]
    close = get_close_matches(str(loc[-1]), known, n=1)
    return f" Did you mean '{close[0]}'?" if close else ""


def _step_models() -> tuple[type[StepModel], ...]:
    from typing import get_args

    from rigtri.spec.models.spec import AnyStep

    models: tuple[type[StepModel], ...] = get_args(get_args(AnyStep)[0])
    return models


def _short(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False, default=str)
    return text if len(text) <= 60 else text[:57] + "…"
