"""Read a rig spec: all that is wrong with it at once, each fault with file, line and column."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigtri.errors import FileError, RigtriError, UsageError
from rigtri.files.input_stream import path_of
from rigtri.files.text_files import check_plain
from rigtri.formats import ReadOptions
from rigtri.formats.registry import is_installed
from rigtri.model.dataclass import dataclass
from rigtri.model.edit_options import OF_BUILDS, EditOptions, FileOptions, RunOptions
from rigtri.model.options import options_of
from rigtri.model.spelling import Spelling, spec_spelling, spelled
from rigtri.operations.registry import options_class
from rigtri.pipeline.rigspec.errors import Fault, Place, SpecError
from rigtri.pipeline.rigspec.missing_names import unnamed
from rigtri.pipeline.rigspec.positions import Keys, Label, Tree
from rigtri.pipeline.rigspec.validation import sound, step_models, where_of, wrong
from rigtri.pipeline.steps import applied

if TYPE_CHECKING:
    from rigtri.pipeline.rigspec.models.spec import SpecModel
    from rigtri.pipeline.rigspec.models.steps import StepModel


@dataclass(frozen=True)
class PlannedStep:
    """One step: its operation, that one's options, and its position in the spec.

    index: among all, from 0. given: the options that the spec gives, as it gives them.
    """

    index: int
    label: Label
    do: str
    options: Any
    optional: bool
    place: Place
    given: dict[str, Any]

    @property
    def number(self) -> int:
        """Its number in the file, from 1; steps of the same braces have the same."""
        return self.label.number


@dataclass(frozen=True)
class Spec:
    """A spec that is right in itself; whether a character has its joints shows when it is built.

    sources: the spec and all that it extends. paths: variables that the user gave and paths begin with.
    """

    path: Path
    model: SpecModel
    steps: tuple[PlannedStep, ...]
    tree: Tree
    sources: tuple[Path, ...]
    paths: frozenset[str] = frozenset()

    @property
    def reading(self) -> ReadOptions:
        """How files are read and written."""
        return self.model.reading()

    def limited(self, *, tolerance: float | None = None, resources: str | None = None, **flags: bool) -> Spec:
        """The spec with another tolerance or way with the files of a .gltf, or with flags such as ``strict``.

        Its own where nothing is given.
        """
        changed: dict[str, Any] = {name: True for name, is_set in flags.items() if is_set}
        changed |= {} if tolerance is None else {"tolerance": tolerance}
        changed |= {} if resources is None else {"resources": resources}
        if not changed:
            return self
        model = self.model.model_copy(update=changed)
        steps, faults = _planned(model, self.tree, range(len(model.steps)))
        if faults:
            raise SpecError(faults)
        return replace(self, model=model, steps=steps)

    def canonical(self) -> str:
        """What is done, as JSON that is equal for equal work: options by name, defaults filled in."""
        document = self.model.model_dump(mode="json", by_alias=True, exclude={"schema_", "name", "extends"})
        for word in ("variables", "defaults"):  # they have gone into the steps
            document.pop(word)
        return json.dumps(document, sort_keys=True, ensure_ascii=False)

    def files(self) -> tuple[Path, ...]:
        """All files that the spec is made of or that its steps read, besides the character."""
        named = [getattr(step.options, name) for step in self.steps for name in _files_of(step.do)]
        return (*self.sources, *dict.fromkeys(Path(name) for name in named if name))

    def needed(self) -> tuple[tuple[Path, str], ...]:
        """`files`, each with what it is: nothing that is written may take their place."""
        spec = self.sources[0]
        roles = {spec: "the spec", **dict.fromkeys(self.sources[1:], f"a spec that {spec} extends")}
        return tuple((file, roles.get(file, f"a file that {spec} names")) for file in self.files())


def load(
    path: Path | str,
    *,
    variables: Mapping[str, str] | None = None,
    folders: Mapping[str, Path] | None = None,
    source: Path | str | None = None,
) -> Spec:
    """The spec in a YAML or JSON file.

    variables: values instead of those in the spec. folders: what paths that begin with these are seen from,
    by their names; else the working folder. source: a character, whose names are looked for where
    the spec is wrong. Raises FileError for a file that cannot be read, SpecError, a UsageError,
    with all that is wrong in it.
    """
    need_libraries()
    from rigtri.pipeline.rigspec.expand import merged, plain

    path, given = path_of(path), dict.fromkeys(variables or (), Path()) | dict(folders or {})
    spec = merged(path, variables or {})
    tree, unsure = spec.tree, spec.unsure
    paths, lost = _find_files(tree, given)
    found = [*wrong(tree, whole=spec.whole), *lost]
    # A value with a variable that there is not is wrong for no other reason.
    faults = [
        *spec.faults,
        *(one for keys, one in found if one and not unsure & {place for _, place in tree.under(keys)}),
    ]
    known = {fault.place for fault in faults}
    hidden = (one for base in spec.bases for _, one in wrong(plain(base), whole=False) if one)
    faults += [one for one in hidden if one.place not in known]
    parts = [keys for keys, _ in found] + [keys for keys, place in tree.spot.all() if place in unsure]
    model, numbers = sound(tree, {keys[: 2 if keys[0] == "steps" else 1] for keys in parts})
    steps, contradictions = _planned(model, tree, numbers)
    faults += contradictions
    if not faults and not tree.steps:
        faults.append(Fault(tree.place(("steps",)), "", "the spec has no steps"))
    if faults and source is not None:
        names = unnamed(tree, steps, source, model.reading())
        faults += (fault for fault in names if fault.place not in unsure)
    if faults:
        raise SpecError(faults)
    return Spec(path, model, steps, tree, spec.files, paths)


def _find_files(tree: Tree, given: Mapping[str, Path]) -> tuple[frozenset[str], list[tuple[Keys, Fault]]]:
    """Let the files that steps name be seen from the file of the spec that names it, or its variable.

    given: folders of variables that the user gives. The names of those that paths begin with; and by their
    keys the files that are not there.
    """
    used, lost = set[str](), list[tuple[Keys, Fault]]()
    models = step_models()
    for number, one in enumerate(tree.steps):
        model = models.get(str(one.get("do"))) if isinstance(one, dict) else None
        files = _files_of(str(one["do"])) if model else ()
        for name, about in model.model_fields.items() if model else ():
            option = about.alias or name
            if name in files and isinstance(one.get(option), str) and one[option]:
                keys: Keys = ("steps", number, option)
                spot = tree.at(keys)
                source = tree.place(("variables", spot.variable)) if spot.variable else spot.place
                used.update(given.keys() & {spot.variable})
                one[option] = str(given.get(spot.variable, Path(source.file).parent) / one[option])
                try:
                    check_plain(one[option], option)
                except FileError as error:
                    lost.append((keys, Fault(spot.place, where_of(tree, keys), str(error))))
    return frozenset(used), lost


def _files_of(do: str) -> list[str]:
    """The options of an operation that name files; a spec is done again when one of them has changed."""
    try:
        declared = options_class(do)
    except ModuleNotFoundError:
        return []
    return [name for name, one in options_of(declared).items() if one.is_file]


def keys_of(tree: Tree, do: str) -> Spelling:
    """How a spec writes the options of a step, and those of the whole file.

    Whoever builds can also give some of those, and has, where they are not in the spec.
    """
    whole = [
        one
        for name, one in options_of(EditOptions).items()
        if name not in OF_BUILDS and (one.key in tree.values or name not in options_of(RunOptions))
    ]
    own = [one for one in options_of(options_class(do)).values() if one.where == "all"]
    return spec_spelling([*whole, *own], options_of(FileOptions))


def need_libraries() -> None:
    """UsageError where what reads specs is missing, as in a DCC that has rigtri's folder alone."""
    missing = [name for name in ("pydantic", "ruamel.yaml") if not is_installed(name)]
    if missing:
        raise UsageError(f"specs need {' and '.join(missing)}; pip install {' '.join(missing)}")


def _planned(
    model: SpecModel, tree: Tree, numbers: Sequence[int]
) -> tuple[tuple[PlannedStep, ...], list[Fault]]:
    """The steps of a model, by their numbers in the tree; faults of those that contradict themselves."""
    reading, shared = model.reading(), model.shared()
    found, faults = [], []
    for number, one in zip(numbers, model.steps, strict=True):
        keys: Keys = ("steps", number)
        place, label = tree.place(keys), tree.labels[number]
        try:
            with spelled(keys_of(tree, one.do)):
                options = one.options(shared)
                applied(one.do, options, reading)
        except RigtriError as error:
            faults.append(Fault(place, where_of(tree, keys), str(error)))
            continue
        found.append(PlannedStep(number, label, one.do, options, one.optional, place, _given_options(one)))
    return tuple(found), faults


def _given_options(one: StepModel) -> dict[str, Any]:
    """The options that the spec gives a step, by their names there."""
    given = one.model_dump(mode="json", by_alias=True, exclude_unset=True)
    return {name: value for name, value in given.items() if name not in ("do", "optional")}
