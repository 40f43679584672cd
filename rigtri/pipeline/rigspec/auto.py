"""auto: look at a character, form the spec that belongs to it, and build it by that."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Sequence
from dataclasses import field, replace
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import Any

from rigtri.errors import FixedWeightsError, GeometryError, RigtriError, UsageError
from rigtri.files import temp_dirs
from rigtri.files.input_stream import called, opened, path_of, title
from rigtri.files.staged_output import StagedOutput, encoded, write_text
from rigtri.files.text_files import text_of
from rigtri.formats import ReadOptions, read
from rigtri.model.dataclass import dataclass
from rigtri.model.edit_options import RunOptions
from rigtri.model.rig import Rig
from rigtri.operations.operation import with_keywords
from rigtri.pipeline.edit import EditRequest, Outcome, requested
from rigtri.pipeline.rigspec.build import Built, build_file
from rigtri.pipeline.rigspec.control_check import CheckedControl, check_controls, refuse_idle_controls
from rigtri.pipeline.rigspec.errors import Fault, SpecError
from rigtri.pipeline.rigspec.load import load, need_libraries
from rigtri.pipeline.rigspec.spec_init import starter, unsure
from rigtri.progress import begin_stage
from rigtri.recognition.layout import Chain, Layout
from rigtri.recognition.naming_schemes import Scheme
from rigtri.recognition.one_character import alone, named
from rigtri.recognition.recognise import recognise
from rigtri.report import Report
from rigtri.text import a

SUFFIX = ".rig.yaml"
# The first words of a spec by which nothing was built, so that nobody takes it for one that works.
_IDLE = "# rigtri auto built nothing by this spec"
# The last line of a spec that nobody has edited; then comes the digest of what is above it.
_SEAL = "# Written by rigtri auto, which replaces it while it is unchanged: "


@dataclass(frozen=True)
class Proposal:
    """What was recognised in a file, and the spec that belongs to it, as YAML with open places.

    root: below which its joints are. character: of several, the only one that is meant. without_twist: the
    same spec without twist joints, and why. checked: what the controls move, once they are built.
    """

    source: Path
    rig: Rig
    layout: Layout
    text: str
    root: str | None = None
    character: str | None = None
    without_twist: Callable[[str], str] = str
    checked: list[CheckedControl] = field(default_factory=list)

    @property
    def is_character(self) -> bool:
        """Whether there is something to build, or to ask for."""
        return self.is_sure or bool(unsure(self.layout))

    @property
    def is_sure(self) -> bool:
        """Whether anything in it is sure."""
        return any(chain.is_sure for chain in self.layout.chains)

    @property
    def questions(self) -> tuple[str, ...]:
        """What the user must name: each limb that is not sure, and which joints it may be."""
        return tuple(self._question(chain) for chain in unsure(self.layout))

    def _question(self, chain: Chain) -> str:
        names = ", ".join(f"'{self.rig.title(node)}'" for node in chain.bend)
        return f"the {chain.name} is not sure ({chain.confidence:.2f}): perhaps {names}"

    def check(self, rig: Rig) -> None:
        """GeometryError where a control that was built does not do what it is for."""
        self.checked[:] = check_controls(_seen(rig, self.character), self.root)
        refuse_idle_controls(self.checked)

    def missing(self) -> str:
        """What there is instead of a character."""
        guesses = (f"perhaps {a(chain.name)} ({chain.confidence:.2f})" for chain in self.layout.chains)
        found = "; ".join([*guesses, *self.layout.remarks]) or "none of its joints make a body"
        return (
            f"no character was recognised in {self.source}: {found}. For steps of your own begin with: "
            f"rigtri spec-init {self.source} -o rig.yaml"
        )


def _seen(rig: Rig, character: str | None) -> Rig:
    """A rig as steps see it that edit one character of several alone; None for all."""
    return rig if character is None else alone(rig, named(rig, character))


def _proposal(
    at: Path,
    source: Path,
    *,
    preset: str,
    scheme: Sequence[Path | str | Scheme],
    options: ReadOptions,
    character: str | None,
) -> Proposal:
    need_libraries()
    rig = read(at, options).rig
    seen = _seen(rig, character)
    layout = recognise(seen, scheme=scheme)
    found = Proposal(source, rig, layout, "", options.root, character)
    if not found.is_character:
        return found
    make = partial(
        starter,
        seen,
        title(source),
        layout,
        preset=preset,
        open_places=True,
        options=options,
        character=character,
    )
    return replace(found, text=make(), without_twist=lambda why: make(fixed_weights=why))


@with_keywords(RunOptions)
def auto(
    source: Path | str,
    target: Path | str,
    *,
    preset: str = "",
    scheme: Sequence[Path | str | Scheme] = (),
    spec_out: Path | str | None = None,
    character: str | None = None,
    options: ReadOptions | None = None,
    report: Report | None = None,
    **given: Any,
) -> Built:
    """Give a character the rig that was recognised to belong to it; ``target`` appears whole or not at all.

    preset: the axes of its joints, as `orient_joints` has them. scheme: naming schemes that are tried first.
    spec_out: where the spec goes by which it was built, None for nowhere. character: of several, only the one
    at or below this node; without it, each gets its rig. options: how the source is read. Raises as
    `auto_file`.
    """
    request = requested("auto", source, target, options=options, **given)
    report = Report() if report is None else report
    return auto_file(request, report, preset=preset, scheme=scheme, spec_out=spec_out, character=character)


def auto_file(
    request: EditRequest,
    report: Report,
    *,
    preset: str = "",
    scheme: Sequence[Path | str | Scheme] = (),
    spec_out: Path | str | None = None,
    character: str | None = None,
    seen: Callable[[Proposal], None] = lambda proposal: None,
) -> Built:
    """Give a character the rig that was recognised to belong to it; the output appears whole or not at all.

    scheme: naming schemes that are tried first. spec_out: where the spec goes by which it was built, None for
    nowhere. character: of several, only the one at or below this node. seen: is called with what is proposed,
    before anything is built.
    Raises NameNotFoundError where there is no such character, GeometryError for what is no character, and
    for a limb that is not sure, whose joints are open places in the spec then; else as `build_file`, with the
    last step for controls that do not do what they are for. Then a spec is left that says that nothing was
    built by it, over no other than such a one.
    """
    place = None if spec_out is None or request.dry_run else path_of(spec_out)
    with opened(request.source) as at, temp_dirs.folder() as folder:
        begin_stage("recognise")
        found = _proposal(
            at,
            Path(request.source),
            preset=preset,
            scheme=scheme,
            options=request.options,
            character=character,
        )
        seen(found)
        if not found.is_character:
            raise GeometryError(found.missing())
        if found.questions:
            there = _leave(place, _open_places() + found.text)
            raise GeometryError(_unsure_message(found, place, request.target, there=there))
        side_files = [*request.side_files, *([] if place is None else [place])]
        inner = replace(request, source=at, options=_read_once(request), side_files=side_files)
        spec = Path(folder, "rig.yaml"), str(spec_out or "the spec")
        try:
            try:
                built = _built(inner, found, report, *spec, place)
            except FixedWeightsError as error:  # twist joints would twist nothing
                found = replace(found, text=found.without_twist(str(error)))
                seen(found)
                built = _built(inner, found, report, *spec, place)
        except SpecError as error:
            _leave(place, _not_built(error) + found.text)
            raise
    if request.to_stdout:
        _write(place, found.text)
    return built


def _read_once(request: EditRequest) -> ReadOptions:
    return replace(request.options, from_stream=str(request.source) == "-")


def _built(
    request: EditRequest, found: Proposal, report: Report, spec: Path, name: str, place: Path | None
) -> Built:
    """Build by what is proposed, and let the spec follow the output. A build that is done again, without
    twist joints, leaves no report."""

    def ready(outcome: Outcome, written: StagedOutput) -> None:
        if request.ready is not None:
            request.ready(outcome, written)
        if place is not None:
            written.follow(place, encoded(_sealed(found.text)))

    write_text(spec, found.text)
    own = replace(report, warnings=[], joints=[], limbs=[], added=[], removed=[])
    with called({str(spec): name}):
        limited = load(spec).limited(strict=request.strict, tolerance=request.tolerance)
        try:
            hint = _hint(found.source, place, request.target)
            built = build_file(replace(request, ready=ready), limited, own, found.check, hint)
        except FixedWeightsError:
            raise
        except RigtriError:
            report.merge(own)
            raise
    report.merge(own)
    return built


def _hint(source: Path, place: Path | None, target: Path | str) -> str:
    """How to give an option that a warning names: `auto` has none of a step."""
    if place is None:
        return (
            " (options of steps go into a spec, which --spec-out leaves; then: rigtri build IN --spec SPEC)"
        )
    return f" (options of steps go into {place}; then: {_build_line(source, place, target)})"


def _build_line(source: Path, place: Path, target: Path | str) -> str:
    """The command that builds by a spec, to be copied."""
    return f"rigtri build {shlex.join(map(str, (source, '--spec', place, '-o', target)))}"


def _leave(place: Path | None, text: str) -> bool:
    """Leave a spec by which nothing was built, and say whether it is there.

    Another one may be that of a rig that works, or edited: only one by which nothing was built is replaced.
    """
    if place is None or (place.exists() and not (_as_written(place) or "").startswith(_IDLE)):
        return False
    _write(place, text)
    return True


def _not_built(error: SpecError) -> str:
    """The first lines of a spec with a step that failed."""
    faults = "".join(f"#   {_one_line(fault)}\n" for fault in error.found)
    return f"{_IDLE}; it is here to be looked at and changed:\n{faults}"


def _open_places() -> str:
    """The first line of a spec with open places."""
    return f"{_IDLE}; it is here for you to name the joints of what is not sure, where it says null\n"


def _one_line(fault: Fault) -> str:
    return " ".join(fault.text.split())


def _unsure_message(found: Proposal, place: Path | None, target: Path | str, *, there: bool) -> str:
    """there: whether the spec with open places is at ``place``."""
    words = "; ".join(found.questions)
    if not found.is_sure:
        words = f"nothing of {found.source} is sure to be a character's: {words}"
    if place is None:
        return words
    if not there:
        return (
            f"{words}. {place} stays as it is; to get a spec where you can name their joints, use --spec-out"
        )
    return (
        f"{words}. Name their joints in {place}, where it says null, then: "
        f"{_build_line(found.source, place, target)}"
    )


def _write(place: Path | None, text: str) -> None:
    if place is not None:
        write_text(place, _sealed(text))


def _sealed(text: str) -> str:
    return f"{text}{_SEAL}{_digest(text)}\n"


def _digest(text: str) -> str:
    return sha256(encoded(text)).hexdigest()[:16]


def _as_written(place: Path) -> str | None:
    """The text of a spec that nobody has edited; None for any other file."""
    text, mark, digest = text_of(place).rpartition(_SEAL) if place.is_file() else ("", "", "")
    return text if mark and digest.strip() == _digest(text) else None


def refuse_edited(place: Path) -> None:
    """UsageError for a spec that is there and is not as `auto` wrote it: somebody's work would be lost."""
    if place.exists() and _as_written(place) is None:
        raise UsageError(
            f"{place} is not as rigtri auto wrote it, and --overwrite would lose what was edited there. "
            f"Build by it: rigtri build IN --spec {place}; or replace it with --spec-out {place}, or give "
            "--spec-out another name, or --no-spec"
        )
