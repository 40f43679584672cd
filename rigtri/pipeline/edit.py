"""One file: read, apply, write beside, re-open, compare, rename. Nothing half done, nothing lost."""

from __future__ import annotations

import filecmp
import shutil
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from rigtri.errors import DeviationError, FileError, GeometryError, UsageError
from rigtri.files import temp_dirs
from rigtri.files.atomic_write import same_file
from rigtri.files.background_copy import BackgroundCopies
from rigtri.files.input_stream import called, opened
from rigtri.files.staged_output import StagedOutput, as_file_error, check_not_an_input, destination
from rigtri.formats import Document, ReadOptions, output_suffixes, read
from rigtri.model.rig import Rig
from rigtri.report import Notice, Report
from rigtri.verification.compare.advice import why_near
from rigtri.verification.compare.compare import TOLERANCE, Comparison, self_check
from rigtri.verification.compare.expected_result import ExpectedResult, check_result

Step = Callable[[Rig, Report], Rig]

# From this size on, reading all of a file and waiting for the disk are worth avoiding.
_LARGE = 1 << 24


@dataclass(frozen=True)
class Outcome:
    """What an edit did: the report, the measured deviation (None with verify off), and the clock.

    rig: as it was written. files: all that the source is made of, itself first, there or not.
    """

    report: Report
    verification: Comparison | None
    written: bool
    changed: bool
    seconds: dict[str, float] = field(default_factory=dict)
    rig: Rig | None = None
    files: tuple[Path, ...] = ()

    @property
    def unread(self) -> list[str]:
        """Why meshes could not be read, one text for each; how they look was not measured."""
        return [notice.text for notice in self.report.warnings if notice.code == "mesh-unread"]


def edit(
    source: Path | str,
    target: Path | str,
    step: Step,
    *,
    document: Document | None = None,
    options: ReadOptions | None = None,
    report: Report | None = None,
    overwrite: bool = False,
    verify: bool = True,
    tolerance: float = TOLERANCE,
    dry_run: bool = False,
    strict: bool = False,
    side_files: Sequence[Path] = (),
    ahead: BackgroundCopies | None = None,
    ready: Callable[[Outcome, StagedOutput], None] | None = None,
) -> Outcome:
    """Apply ``step`` to the rig in ``source``; ``target`` appears complete or not at all.

    ``-`` is standard input or output. The file about to be delivered is re-opened and
    compared with the source first: over ``tolerance`` (a share of the bounding-box
    diagonal) DeviationError is raised and nothing is written. ``document``: the source, where it was
    read already, with the same ``options``. ``strict`` makes
    any warning a GeometryError. ``side_files`` are what the caller will write besides, ``ahead``
    the copies that it has begun (`files.background_copy`). ``ready`` is called when the output has passed
    and is about to take its name, by runs of many files at once: these may share copies, which then stay
    where the edit fails.
    Raises FileError for anything that cannot be read or written, UsageError for an existing
    target without ``overwrite``, and for a target or side file that the source refers to.
    """
    report = report if report is not None else Report()
    clock = _Clock()
    with opened(source) as path:
        to_stdout = str(target) == "-"
        options = options or ReadOptions()
        spooled = options.from_stream or str(source) == "-"
        options = replace(options, from_stream=spooled, to_stream=to_stdout)
        final = _final(path, target, overwrite, options)
        if not to_stdout:
            _check_suffix(path, final, options)
        document = document or read(path, options)
        needed = _needed(document, path, final, options)
        files = tuple(dict.fromkeys([path, *(file for file, _ in needed)]))
        for place in (*side_files, *(() if to_stdout else (final,))):
            check_not_an_input(place, needed)
        _take_warnings(document, report, strict)
        clock.lap("read")
        rig = step(document.rig, report)
        _check_numbers(document.rig, rig)
        _check_order(rig)
        _take_warnings(document, report, strict)
        clock.lap("edit")
        with _folder(final, to_stdout or dry_run) as folder:
            place = folder / final.name
            written = StagedOutput(place, overwrite, needed, ahead, shared=ready is not None)
            try:
                keep = not (to_stdout or dry_run)
                result = _deliver(document, path, rig, written, verify, tolerance, clock, report, keep)
                _take_warnings(document, report, strict)  # meshes are read, and misread, while measuring
                if to_stdout and not dry_run:
                    _to_stdout(written)
                elif not dry_run:
                    if ready is not None:
                        changed = rig is not document.rig
                        ready(Outcome(report, result, True, changed, clock.laps, rig, files), written)
                    written.finish()
                    report.extend(_left_behind(document, path, final, needed))
            except BaseException:  # an interrupt too leaves the folder as it was; it goes on up
                written.undo()
                raise
            clock.lap("write")
            return Outcome(report, result, not dry_run, rig is not document.rig, clock.laps, rig, files)


def check_target(source: Path | str, target: Path | str, *, overwrite: bool, options: ReadOptions) -> None:
    """Refuse, before anything is read, a target that `edit` would refuse.

    source: no stream, which can be read only once. Raises FileError, and UsageError for one that exists,
    without ``overwrite``, or is of another format.
    """
    with opened(source) as path:
        final = _final(path, target, overwrite, options)
        if str(target) != "-":
            _check_suffix(path, final, options)


def _check_numbers(before: Rig, after: Rig) -> None:
    """GeometryError for a node whose numbers an edit made infinite or NaN; what was so may stay so."""
    if after is before:
        return
    lost = np.zeros(len(after), dtype=bool)
    for name in ("translation", "rotation", "scale", "matrix"):
        wrong, known = ~np.isfinite(getattr(after, name)), ~np.isfinite(getattr(before, name))
        wrong[: len(before)] &= ~known
        lost |= wrong.any(axis=tuple(range(1, wrong.ndim)))
    for number, new in enumerate(after.skins):
        worse = ~np.isfinite(new.inverse_bind)
        if number < len(before.skins):
            old = before.skins[number].inverse_bind[: len(worse)]
            worse[: len(old)] &= np.isfinite(old)
        lost[new.joints[worse.any(axis=(1, 2))]] = True
    if lost.any():
        node = int(lost.argmax())
        raise GeometryError(
            f"'{after.names[node] or after.labels[node]}' gets no place that is a number: a scale at or "
            "above it is zero, or numbers there are too large. Leave it out with --exclude"
        )


def _check_order(rig: Rig) -> None:
    """UsageError where nodes were taken out of the file and others added: no writer does both at once."""
    if rig.pending.removed and any(
        key is None and node not in rig.pending.removed for node, key in enumerate(rig.keys)
    ):
        raise UsageError(
            "strip has taken nodes out of the file, and others were added after it: write what strip has "
            "left, read that, and add to it"
        )


def _deliver(
    document: Document,
    path: Path,
    rig: Rig,
    written: StagedOutput,
    verify: bool,
    tolerance: float,
    clock: _Clock,
    report: Report,
    keep: bool,
) -> Comparison | None:
    """Write the part, re-open it, compare it with the source. keep: it is to last."""
    names = {str(written.part): str(written.final), written.part.name: written.final.name}
    with called(names), as_file_error(written.final):
        for companion in document.write(rig, written.part, written.final):
            written.add(companion)
        if keep and verify:
            written.fsync_in_background()
    clock.lap("write")
    if not verify:
        return None
    result = _compared(document, path, rig, written, names, tolerance, report)
    clock.lap("verify")
    if not result.passes(tolerance):
        report.extend(document.warnings)  # which meshes could only be bounded
        raise DeviationError(
            f"The result would look different: {result.summary(tolerance)}. Nothing was written."
            f"{why_near(document.rig, rig, result, tolerance)}"
        )
    return result


def _compared(
    document: Document,
    path: Path,
    rig: Rig,
    written: StagedOutput,
    names: dict[str, str],
    tolerance: float,
    report: Report,
) -> Comparison:
    """Compare the part with what was expected of the edit."""
    small = written.part.stat().st_size < _LARGE
    if small and rig is document.rig and filecmp.cmp(path, written.part, shallow=False):
        return self_check(document, document)
    reposed = report.reposed and rig is not document.rig
    expected = ExpectedResult(document, rig, report.morph_changes, reposed)
    with called(names):
        return check_result(expected, document.reopen(written.part), tolerance)


def _to_stdout(written: StagedOutput) -> None:
    if written.placed:
        names = ", ".join(place.name for place, _ in written.placed[:4])
        raise UsageError(
            f"-o -: the output refers to other files ({names}), which a stream cannot hold. "
            "Give a file name, or embed the data first."
        )
    with written.part.open("rb") as file:
        shutil.copyfileobj(file, sys.stdout.buffer)
    sys.stdout.buffer.flush()


def _take_warnings(document: Document, report: Report, strict: bool) -> None:
    """Take the document's notices into the report; with ``strict`` the first of all is an error."""
    report.extend(document.warnings)
    if strict:
        report.refuse_warnings()


def _final(path: Path, target: Path | str, overwrite: bool, options: ReadOptions) -> Path:
    if str(target) == "-":
        # An override is a layer, also where it is of a package.
        layer = bool(options.override) and path.suffix.lower() == ".usdz"
        return Path(path.stem + ".usda" if layer else path.name)
    with as_file_error(Path(target)):
        return _allowed(destination(Path(target)), path, overwrite)


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


def _check_suffix(path: Path, final: Path, options: ReadOptions) -> None:
    """UsageError for an output of another format, before anything is read; writers know it more closely."""
    fits = output_suffixes(path, options)
    if fits and final.suffix.lower() not in fits:
        what = "an override is a layer" if options.override else "the output has the format of the input"
        raise UsageError(f"{final.name}: {what}; give it the suffix {' or '.join(fits)}")


def _allowed(final: Path, path: Path, overwrite: bool) -> Path:
    """``final``, if a result of ``path`` may be written there."""
    if final.is_dir():
        raise UsageError(f"{final} is a folder; give the name of the output file")
    if not final.suffix:
        raise UsageError(f"{final} has no suffix; the output's format is the input's: {path.suffix}")
    if final.exists() and not overwrite:
        raise UsageError(f"{final} exists; it is replaced only with --overwrite")
    if not final.parent.is_dir():
        raise FileError(f"There is no folder {final.parent} to write {final.name} into")
    return final


@contextmanager
def _folder(final: Path, elsewhere: bool) -> Iterator[Path]:
    """Where the part is written: beside the target, or in a folder that is thrown away."""
    if not elsewhere:
        yield final.parent
        return
    with temp_dirs.folder() as folder:
        yield Path(folder)


class _Clock:
    """Seconds per stage."""

    def __init__(self) -> None:
        self.laps: dict[str, float] = {}
        self._last = time.perf_counter()

    def lap(self, name: str) -> None:
        now = time.perf_counter()
        self.laps[name] = self.laps.get(name, 0.0) + now - self._last
        self._last = now


def report_json(
    command: str,
    source: str,
    target: str | None,
    options: dict[str, Any],
    outcome: Outcome,
    *,
    tolerance: float,
    dry_run: bool,
) -> dict[str, Any]:
    """The document that ``--report`` and ``--json`` give; schemas/report.schema.json describes it.

    target: None for a run that names no output.
    """
    from rigtri._version import __version__

    verification = None
    if outcome.verification is not None:
        verification = outcome.verification.as_json() | {"tolerance": tolerance, "unread": outcome.unread}
    return {
        "rigtri": __version__,
        "command": command,
        "source": source,
        "target": target,
        "written": outcome.written,
        "dry_run": dry_run,
        "options": options,
        "joints": outcome.report.joints,
        "limbs": outcome.report.limbs,
        "added": outcome.report.added,
        "removed": outcome.report.removed,
        "warnings": [
            {"code": n.code, "text": n.text, "joint": n.joint, "geometry": n.geometry}
            for n in outcome.report.warnings
        ],
        "verification": verification,
        "seconds": {name: round(value, 4) for name, value in outcome.seconds.items()},
    }
