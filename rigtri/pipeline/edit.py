"""One file: read, apply, write beside, re-open, compare, rename. Nothing half done, nothing lost."""

from __future__ import annotations

import filecmp
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import field, replace
from pathlib import Path
from typing import Any

from rigtri.errors import DeviationError, FileError, UsageError
from rigtri.files import temp_dirs
from rigtri.files.atomic_write import same_file
from rigtri.files.background_copy import BackgroundCopies
from rigtri.files.folder_locks import folder_lock
from rigtri.files.input_stream import called, opened, path_of
from rigtri.files.staged_output import (
    StagedOutput,
    as_file_error,
    check_not_an_input,
    destination,
    recover,
)
from rigtri.files.text_files import check_utf8_path
from rigtri.formats import GLTF_SUFFIXES, USD_SUFFIXES, Document, ReadOptions, output_suffixes, read
from rigtri.model.dataclass import dataclass
from rigtri.model.edit_options import RunOptions
from rigtri.model.metadata import EXPORT_WARNINGS
from rigtri.model.rig import Rig
from rigtri.operations.left_behind import BEHIND, warning_once
from rigtri.operations.operation import from_keywords, reporting_to, with_keywords
from rigtri.pipeline.rig_checks import check_numbers, check_order
from rigtri.progress import begin_stage
from rigtri.report import Notice, Report
from rigtri.verification.compare.compare import Comparison, Source, self_check
from rigtri.verification.compare.expected_result import ExpectedResult, check_result

Step = Callable[[Rig, Report], Rig]

# From this size on, reading all of a file and waiting for the disk are worth avoiding.
_LARGE = 1 << 24


@dataclass(frozen=True)
class Outcome:
    """What an edit did: the report, the measured deviation (None with verify off), and the clock.

    rig: as it was written. files: all that the source is made of, itself first, there or not. hides: by file
    of another layer (USD), the attributes whose opinions there are hidden by those of the output.
    """

    report: Report
    verification: Comparison | None
    written: bool
    changed: bool
    seconds: dict[str, float] = field(default_factory=dict)
    rig: Rig | None = None
    files: tuple[Path, ...] = ()
    hides: Mapping[str, Sequence[str]] = field(default_factory=dict)

    @property
    def unread(self) -> list[str]:
        """Why meshes could not be read, one text for each; how they look was not measured."""
        return [notice.text for notice in self.report.warnings if notice.code == "mesh-unread"]


@dataclass(frozen=True)
class EditRequest(RunOptions):
    """What is to be done to one file, and how.

    target: ``-`` is standard output. side_files: what the caller will write besides. document: the source,
    where it was read already, with the same ``options``. ahead: copies that the caller has begun
    (`files.background_copy`). measured: is called with what the output was to be, what it is, and how far
    they are apart. ready: is called when the output has passed and is about to take its name.
    shared, passing: others write beside it at the same time, nobody needs it afterwards
    (`files.staged_output`).
    """

    source: Path | str
    target: Path | str
    options: ReadOptions = field(default_factory=ReadOptions)
    side_files: Sequence[Path] = ()
    document: Document | None = None
    ahead: BackgroundCopies | None = None
    measured: Callable[[ExpectedResult, Source, Comparison], None] | None = None
    ready: Callable[[Outcome, StagedOutput], None] | None = None
    shared: bool = False
    passing: bool = False

    def __post_init__(self) -> None:
        for path in (self.source, self.target):
            path_of(path)  # says what else was given
        if not self.tolerance >= 0:
            raise UsageError(f"--tolerance {self.tolerance} is not a valid tolerance: use a number from 0 on")

    @property
    def to_stdout(self) -> bool:
        return str(self.target) == "-"

    @property
    def is_kept(self) -> bool:
        """Whether the output becomes a file."""
        return not (self.to_stdout or self.dry_run)


def requested(name: str, source: Path | str, target: Path | str, **given: Any) -> EditRequest:
    """What a function of the library is to do to a file; TypeError for keywords that it does not have."""
    given = {word: value for word, value in given.items() if word != "options" or value is not None}
    return from_keywords(EditRequest, {"source": source, "target": target, **given}, name)


@with_keywords(RunOptions)
def edit(
    source: Path | str,
    target: Path | str,
    step: Step,
    *,
    options: ReadOptions | None = None,
    report: Report | None = None,
    **given: Any,
) -> Outcome:
    """Apply ``step`` to the rig in ``source``; ``target`` appears complete or not at all.

    ``-`` is standard input or output. step: a function of the rig and the report, which returns a rig; its
    operations report there, if to nobody else. options: how the source is read. Raises as `edit_file`.
    """
    request = requested("edit", source, target, options=options, **given)
    return edit_file(request, step, Report() if report is None else report)


def edit_file(request: EditRequest, step: Step, report: Report) -> Outcome:
    """Apply ``step`` to the rig of a file; the output appears complete or not at all.

    The file about to be delivered is re-opened and compared with the source first: over the tolerance
    DeviationError is raised and nothing is written, and with ``strict`` GeometryError for a warning.
    Raises FileError for anything that cannot be read or written, UsageError for an existing
    target without ``overwrite``, and for a target or side file that the source refers to.
    """
    clock = Clock()
    begin_stage("read")
    with opened(request.source) as path:
        spooled = request.options.from_stream or str(request.source) == "-"
        options = replace(request.options, from_stream=spooled, to_stream=request.to_stdout)
        final = _checked_target(path, request)
        document = request.document or read(path, options)
        needed = _needed(document, path, final, options)
        written_to = [*request.side_files, *(() if request.to_stdout else (final,))]
        for place in written_to:
            check_not_an_input(place, needed)
        # What exporters drop may come from another file yet.
        lost = [notice for notice in document.warnings if notice.code in EXPORT_WARNINGS]
        _take_warnings(document, report, request.strict and not lost)
        clock.lap("read")
        begin_stage("edit")
        with reporting_to(report):
            rig = _own(warning_once(step)(document.rig, report))
        check_numbers(document.rig, rig)
        check_order(rig)
        for place in written_to:
            if not same_file(place, path):  # who edits IN in place has it replaced, whatever refers to it
                check_not_an_input(place, report.sources)
        _take_warnings(document, report, request.strict)
        clock.lap("edit")
        with working_folder(final, request) as folder:
            place, spared = folder / final.name, [*needed, *report.sources]
            how = {"shared": request.shared, "passing": request.passing}
            written = StagedOutput(place, request.overwrite, spared, request.ahead, **how)
            try:
                result = _deliver(document, path, rig, written, request, report, clock)
                # Meshes are read, and misread, while measuring.
                _take_warnings(document, report, request.strict)
                files = tuple(dict.fromkeys([path, *(file for file, _ in needed)]))
                changed = rig is not document.rig
                outcome = Outcome(
                    report, result, not request.dry_run, changed, clock.laps, rig, files, document.hidden
                )
                if request.is_kept:
                    if request.ready is not None:
                        request.ready(outcome, written)
                    written.finish()
                    report.extend(_left_behind(document, path, final, needed))
                elif request.to_stdout and not request.dry_run:
                    _to_stdout(written)
            except BaseException:  # an interrupt too leaves the folder as it was; it goes on up
                written.undo()
                raise
            clock.lap("write")
            return outcome


def check_target(request: EditRequest) -> Path:
    """Where the output goes; refuse, before anything is read, a target that `edit_file` would refuse.

    Of a stream it is a name. The source is no stream, which can be read only once. Raises FileError, and
    UsageError for a target that exists, without ``overwrite``, or is of another format.
    """
    with opened(request.source) as path:
        return _checked_target(path, request)


def _checked_target(path: Path, request: EditRequest) -> Path:
    """Where the output goes; of a stream its name."""
    options = request.options
    if request.to_stdout:
        # An override is a layer, also where it is of a package.
        layer = options.is_override and path.suffix.lower() == ".usdz"
        return Path(path.stem + ".usda" if layer else path.name)
    final = allowed_target(target_of(request), path, request.overwrite)
    fits = output_suffixes(path, options)  # writers know it more closely, when the file has been read
    if fits and final.suffix.lower() not in fits:
        what = "an override is a layer" if options.is_override else "the output has the format of the input"
        if path.suffix.lower() not in fits and not options.is_override:
            what = f"{path.name} is {fits[0]} inside, and {what}"
        other = "" if options.is_override else _other_way(path, final)
        raise UsageError(f"{final.name}: {what}; give it the suffix {' or '.join(fits)}{other}")
    return final


def _other_way(path: Path, final: Path) -> str:
    """Which command writes a file in the format that a user wants of an edit; "" where none does."""
    source, suffix = path.suffix.lower(), final.suffix.lower()
    to_usd = source in GLTF_SUFFIXES and suffix in USD_SUFFIXES
    to_gltf = source in USD_SUFFIXES and suffix in (".glb", ".gltf")
    return f". rigtri convert writes {source} files as {suffix}" if to_usd or to_gltf else ""


def _own(rig: object) -> Rig:
    """What a step returns, which may be a user's function, if it is the rig that it was given, edited."""
    if not isinstance(rig, Rig):
        given = "nothing" if rig is None else f"a {type(rig).__name__}"
        raise TypeError(f"edit: step must return the edited rig, as rigtri.orient_joints does, not {given}")
    if rig.source is not None:
        raise UsageError("edit: step must return the rig that it is given, edited, not one of rigtri.read")
    return rig


def _deliver(
    document: Document,
    path: Path,
    rig: Rig,
    written: StagedOutput,
    request: EditRequest,
    report: Report,
    clock: Clock,
) -> Comparison | None:
    """Write the part, re-open it, compare it with the source."""
    begin_stage("write")
    names = {str(written.part): str(written.final), written.part.name: written.final.name}
    with called(names), as_file_error(written.final):
        for companion in document.write(rig, written.part, written.final):
            written.add(companion)
        if request.is_kept and request.verify:
            written.fsync_in_background()
    clock.lap("write")
    if not request.verify:
        return None
    begin_stage("verify")
    tolerance = request.tolerance
    with called(names):
        expected, output, result = _compared(document, path, rig, written.part, tolerance, report)
    clock.lap("verify")
    if not result.passes(tolerance):
        from rigtri.verification.compare.advice import why_near

        report.extend(document.warnings)  # which meshes could only be bounded
        raise DeviationError(
            f"The result would look different: {result.summary(tolerance)}. Nothing was written."
            f"{why_near(document.rig, rig, result, tolerance)}"
        )
    if request.measured is not None:
        with called(names):
            request.measured(expected, output, result)
        clock.lap("verify")
    return result


def _compared(
    document: Document, path: Path, rig: Rig, part: Path, tolerance: float, report: Report
) -> tuple[ExpectedResult, Source, Comparison]:
    """Compare the part with what was expected of the edit: that, the part as it was read, and the verdict."""
    expected = ExpectedResult(
        document,
        rig,
        report.morph_changes,
        reposed=(report.reposed or report.rekeyed) and rig is not document.rig,
        keeps_clips=not report.reposed,
        moves=frozenset(report.moves),
        behind=report.named(BEHIND),
    )
    if part.stat().st_size < _LARGE and rig is document.rig and filecmp.cmp(path, part, shallow=False):
        return expected, document, self_check(document, document)
    written = document.reopen(part)
    return expected, written, check_result(expected, written, tolerance)


def _to_stdout(written: StagedOutput) -> None:
    if written.placed:
        names = ", ".join(place.name for place, _ in written.placed[:4])
        raise UsageError(
            f"-o -: the output refers to other files ({names}), which a stream cannot hold. "
            "Give a file name, or embed the data first."
        )
    import shutil

    with written.part.open("rb") as file:
        shutil.copyfileobj(file, sys.stdout.buffer)
    sys.stdout.buffer.flush()


def _take_warnings(document: Document, report: Report, strict: bool) -> None:
    """Take the document's notices into the report; with ``strict`` the first of all is an error."""
    report.extend(document.warnings)
    if strict:
        report.refuse_warnings()


def _needed(document: Document, path: Path, final: Path, options: ReadOptions) -> list[tuple[Path, str]]:
    """What the document's output goes on needing: each file, and what it is."""
    needed = list(document.needed())
    if not options.from_stream:
        return needed
    # What came by a stream stands where its output will.
    folder, place = path.parent.resolve(), final.parent.resolve()
    return [
        (place / file.relative_to(folder) if file.is_relative_to(folder) else file, what)
        for file, what in needed
    ]


def _left_behind(
    document: Document, path: Path, final: Path, needed: Sequence[tuple[Path, str]]
) -> list[Notice]:
    """Files that a .gltf edited in place referred to before, and does no longer. They are not removed."""
    if final.suffix.lower() != ".gltf" or not same_file(path, final):
        return []
    kept = [file for file, _ in document.reopen(final).needed()]
    return [
        Notice("file-left", f"{file} is no longer referred to by {final.name}; it was left where it is")
        for file, _ in needed
        if file.is_file() and not any(same_file(file, other) for other in kept)
    ]


def target_of(request: EditRequest) -> Path:
    """Where the output goes. What killed runs have left there is put in order, before anything is read."""
    # Where many share a folder that is for the caller: who looks through it for each of them is never done.
    with as_file_error(Path(request.target)):
        final = destination(Path(request.target))
        if request.is_kept and not request.shared:
            if not request.passing:  # whose own folder it lies in
                temp_dirs.remove_stale()
            with folder_lock(final.parent):  # what bears the number of this process may be a thread's
                recover(final, request.side_files)
    return final


def allowed_target(final: Path, path: Path, overwrite: bool) -> Path:
    """``final``, if a result of ``path`` may be written there."""
    if final.is_dir():
        raise UsageError(f"{final} is a folder; give the name of the output file")
    if not final.suffix:
        raise UsageError(f"{final} has no suffix; the output's format is the input's: {path.suffix}")
    if final.exists() and not overwrite:
        itself = "is IN itself" if same_file(final, path) else "exists"
        raise UsageError(f"{final} {itself}; it is replaced only with --overwrite")
    if not final.parent.is_dir():
        if final.parent.exists():
            raise FileError(f"{final.parent} is a file, not a folder to write {final.name} into")
        raise FileError(f"There is no folder {final.parent} to write {final.name} into")
    if final.suffix.lower() in USD_SUFFIXES:
        check_utf8_path(final.absolute())
    return final


@contextmanager
def working_folder(final: Path, request: EditRequest) -> Iterator[Path]:
    """Where the part is written: beside the target, as soon as no other thread does, or in a folder that is
    thrown away."""
    if request.is_kept:
        with folder_lock(final.parent):
            yield final.parent
        return
    with temp_dirs.folder() as folder:
        yield Path(folder)


class Clock:
    """Seconds per stage."""

    def __init__(self) -> None:
        self.laps: dict[str, float] = {}
        self._last = time.perf_counter()

    def lap(self, name: str) -> None:
        now = time.perf_counter()
        self.laps[name] = self.laps.get(name, 0.0) + now - self._last
        self._last = now
