"""One file, in the process that works on it."""

from __future__ import annotations

import os
import re
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import field, replace
from functools import partial
from pathlib import Path
from typing import Any, Protocol

from rigtri.errors import FileError, RigtriError, error_kind, faults_by_text, system_reason
from rigtri.files.staged_output import StagedOutput
from rigtri.files.temp_dirs import adopt
from rigtri.files.temp_dirs import folder as temporary
from rigtri.files.worker_process import of_memory, send_event
from rigtri.model.dataclass import dataclass
from rigtri.pipeline.batch.axis_summary import Axes, axes_of
from rigtri.pipeline.batch.hashes import Hashes, newer, no_file, seen_from
from rigtri.pipeline.batch.inputs import Entry
from rigtri.pipeline.edit import EditRequest, Outcome
from rigtri.report import Report

STATUSES = ("ok", "warned", "unchanged", "skipped", "error", "crashed")
FAILED = ("error", "crashed")
# After what is missing comes what a file has instead.
_NAMES = ("name not found", "ambiguous name")
# What a file has not, or not just one of, in the words of these errors.
_NOT_THERE = re.compile(r"No \w+ (?:is named|matches) '.*'|\d+ \w+s are named '.*?'")
_COUNT = re.compile(r"(?<= )\d+(?=[ ,.;]|$)")
_HINT = re.compile(r"(?<=')\. .*")
_SUGGESTION = re.compile(r"Did you mean [^?]*\?")


class Task(Protocol):
    """What is done to a file: `spec_task.SpecTask`, `convert_task.ConvertTask`. It travels by pickle.

    layers: outputs are layers over their inputs. beside: the suffix of a file that goes with each output,
    "" for none. relink: outputs refer to the files of their inputs where these are. sources: the files that
    describe what is done. paths: the variables that are paths. standard_rest: all outputs rest in one
    standard pose, from which rotations count, whatever each is bound in.
    """

    @property
    def layers(self) -> bool: ...
    @property
    def beside(self) -> str: ...
    @property
    def relink(self) -> bool: ...
    @property
    def sources(self) -> Sequence[Path]: ...
    @property
    def paths(self) -> frozenset[str]: ...
    @property
    def standard_rest(self) -> bool: ...
    def key(self) -> str:
        """All that decides what becomes of a file, but for the contents of `files`, as text."""

    def files(self) -> Sequence[Path]:
        """The files that are read besides the source."""

    def run(self, request: EditRequest, report: Report) -> Outcome:
        """Do it; raises RigtriErrors."""


@dataclass(frozen=True)
class Assignment:
    """One entry with what to do to it, as an engine takes it. It travels to other processes by pickle."""

    entry: Entry
    task: Task
    overwrite: bool = False


@dataclass(frozen=True)
class Record:
    """What became of one file.

    kind, message, exit_code: of what failed, as `rigtri.errors.kind_name`, or crash, timeout, memory, bug.
    deviation: as a share of the diagonal, None where it was not measured. seconds: of each stage.
    read, made: hashes of all files that were read and written; read is empty where one of
    them was written meanwhile, so that nobody knows what was read.
    """

    status: str
    kind: str | None = None
    message: str | None = None
    exit_code: int = 0
    deviation: float | None = None
    warnings: tuple[dict[str, Any], ...] = ()
    seconds: dict[str, float] = field(default_factory=dict)
    read: dict[str, str] = field(default_factory=dict)
    made: dict[str, str] = field(default_factory=dict)
    axes: Axes | None = None

    @property
    def failed(self) -> bool:
        return self.status in FAILED

    def as_json(self, entry: Entry, run: str, shard: str | None) -> dict[str, Any]:
        """One line of the log; schemas/batch.schema.json describes it."""
        return {
            "file": entry.source,
            "output": entry.target,
            "status": self.status,
            "kind": self.kind,
            "message": self.message,
            "exit_code": self.exit_code,
            "deviation": self.deviation,
            "warnings": list(self.warnings),
            "seconds": {name: round(value, 4) for name, value in self.seconds.items()},
            "run": run,
            "shard": shard,
        }


# Gets what a file is about to become.
OnReady = Callable[[Assignment, Record], None]


def reason(record: Record, entry: Entry) -> str | None:
    """Why a file failed, without its own name, so that files that failed alike can be counted."""
    return None if record.message is None else "; ".join(bare for bare, _ in faults(record, entry))


def faults(record: Record, entry: Entry) -> Sequence[tuple[str, str]]:
    """What a file failed for, fault by fault: without its own name and what may be meant, and with that."""
    text = record.message or ""
    for name in (entry.source, entry.target):
        text = text.replace(name, "FILE").replace(os.path.basename(name), "FILE")
    first = text.strip().splitlines()[-1] if text and record.kind == "bug" else text
    first = first.removeprefix("FILE: ")
    if record.kind == "file":
        first = _COUNT.sub("N", first)  # so that files that are cut off are, wherever that is
    if record.kind not in _NAMES:
        return [(first, first)] if first else ()
    found = ((_HINT.sub("", fault), _SUGGESTION.search(fault)) for fault in first.split("; "))
    return [(bare, f"{bare}. {meant[0]}" if meant else bare) for bare, meant in found]


def missing(kind: str | None, reason: str | None) -> Sequence[str]:
    """What a file has not that steps name, by its `reason`; each once, however many steps name it."""
    if kind not in _NAMES or reason is None:
        return ()
    found = (_NOT_THERE.search(fault) for fault in reason.split("; "))
    return tuple(dict.fromkeys(what[0] for what in found if what))


# Of this process: a texture that many files share is read once.
_hashes = Hashes()


def work(assignment: Assignment, folder: str, scratch: str, dry_run: bool, at: str = "") -> Record:
    """Do one file. What is about to appear is sent before it does (`rigtri.files.worker_process.send_event`).

    folder: where the manifest is, from which it sees all files. scratch: a folder for temporary
    files, which somebody else removes. at: the folder that relative paths are seen from.
    """
    _outlive_signals()
    if at:
        os.chdir(at)
    adopt(scratch)
    entry, moment, began = assignment.entry, time.time_ns(), time.perf_counter()
    report, sent = Report(records=False), []
    record_of = partial(_record, folder=folder, moment=moment, at_rest=assignment.task.standard_rest)

    def ready(outcome: Outcome, written: StagedOutput) -> None:
        sent.append(record_of(outcome, written))
        send_event(sent[0])

    try:
        if why := no_file(entry.source):
            raise FileError(why)
        with _output_path(entry, dry_run) as target:
            request = EditRequest(
                Path(entry.source),
                target,
                overwrite=assignment.overwrite,
                dry_run=dry_run,
                ready=ready,
                shared=True,
            )
            outcome = assignment.task.run(request, report)
            record = sent[0] if sent else record_of(outcome, None)
            record = replace(record, seconds=dict(outcome.seconds))
    except (RigtriError, OSError) as error:
        if of_memory(error):
            raise
        record = _refused(error, report)
    return replace(record, seconds=record.seconds | {"all": time.perf_counter() - began})


@contextmanager
def _output_path(entry: Entry, dry_run: bool) -> Iterator[Path]:
    """The output's path, in a folder that is there; with dry_run in one that is thrown away."""
    target = Path(entry.target)
    if dry_run:
        with temporary() as place:
            yield Path(place, target.name)
    else:
        target.parent.mkdir(parents=True, exist_ok=True)
        yield target


def _record(
    outcome: Outcome, written: StagedOutput | None, *, folder: str, moment: int, at_rest: bool
) -> Record:
    """What an edit did; with ``written`` also what it wrote, under the names that it will have."""
    read = {} if newer(outcome.files, moment) else _hashes.of_all(outcome.files, folder)
    made: dict[str, str] = {}
    if written is not None:
        needs = {place: written.copied.get(place, place) for place in written.beside}
        made = {seen_from(folder, os.fspath(place)): _hashes.of(file) for place, file in needs.items()}
        made[seen_from(folder, os.fspath(written.final))] = _hashes.of(written.part)
    # What steps add and take out again leaves a file as it was, too.
    same = written is not None and {*made.values()} == {*read.values()}
    status = "warned" if outcome.report.warnings else "ok" if outcome.changed and not same else "unchanged"
    verification = outcome.verification
    return Record(
        status,
        deviation=None if verification is None else float(verification.deviation),
        warnings=_warnings(outcome.report),
        seconds=dict(outcome.seconds),
        read=read,
        made=made,
        axes=None if outcome.rig is None else axes_of(outcome.rig, at_rest=at_rest),
    )


def _warnings(report: Report) -> tuple[dict[str, Any], ...]:
    return tuple({"code": n.code, "text": n.text, "joint": n.joint} for n in report.warnings)


def _refused(error: RigtriError | OSError, report: Report) -> Record:
    if isinstance(error, RigtriError):
        # What is wrong in several places of a spec is one reason.
        text = "; ".join(str(first) for first, *_ in faults_by_text(error.faults).values()) or str(error)
        return Record("error", error_kind(error), text, error.exit_code, warnings=_warnings(report))
    text = f"{error.filename or 'the output'}: {system_reason(error)}"
    return Record("error", "file", text, 3, warnings=_warnings(report))


def _outlive_signals() -> None:
    """Let the one who hands files out decide when to end, also where a farm signals all processes."""
    main = threading.current_thread() is threading.main_thread()
    for number in (signal.SIGTERM, signal.SIGHUP) if os.name == "posix" and main else ():
        if signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, signal.SIG_IGN)
