"""A run: what is left to do, done, and put down."""

from __future__ import annotations

import hashlib
import os
import re
import sqlite3
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import cache
from pathlib import Path

from rigtri.errors import NameNotFoundError, RigtriError, UsageError
from rigtri.files import temp_dirs
from rigtri.files.atomic_write import fsync_folder
from rigtri.files.staged_output import as_file_error, recover
from rigtri.model.dataclass import dataclass
from rigtri.pipeline.batch import urls
from rigtri.pipeline.batch.file_task import Assignment, Record, Task, faults, missing, reason
from rigtri.pipeline.batch.hashes import ABSENT, Hashes, seen_from
from rigtri.pipeline.batch.inputs import MOST, Entry, at_line, exists
from rigtri.pipeline.batch.local_engine import Engine
from rigtri.pipeline.batch.manifest_lookup import Known, look_up, name_of
from rigtri.pipeline.batch.manifest_writer import Manifest
from rigtri.text import and_more

Tasks = Callable[[tuple[tuple[str, str], ...]], Task]

# A part or a backup of an output, as `rigtri.files.staged_output` names them.
_PART = re.compile(r"\.(.+)\.(?:part-[0-9]+(\.[^.]+)|kept-[0-9]+)")
# So many files are tried before the first is written.
TRIED = 8
_MISFITS = {"name not found", "ambiguous name", "usage"}
_DONE = ("ok", "warned", "unchanged")


@dataclass(frozen=True)
class Plan:
    """What is left to do, and what is done already, of these files each with its record."""

    assignments: tuple[Assignment, ...]
    settled: tuple[tuple[Entry, Record], ...]


class MisfitError(NameNotFoundError):
    """What is to be done fits none of the files that were tried."""

    def __init__(self, text: str) -> None:
        RigtriError.__init__(self, text)


class Run:
    """One run over entries. manifest: None in a run that only tries, which reads ``others`` alone.

    tasks: what to do to a file, by its variables. others: further manifests of the same folder,
    such as those of shards. folder: the one that manifests see files from.
    """

    def __init__(
        self,
        tasks: Tasks,
        folder: str,
        manifest: Manifest | None,
        others: Sequence[sqlite3.Connection] = (),
        *,
        overwrite: bool = False,
    ) -> None:
        self._tasks, self._folder, self._manifest, self._others = cache(tasks), folder, manifest, others
        self._overwrite, self._hashes = overwrite, Hashes()
        self._keys: dict[tuple[tuple[str, str], ...], str] = {}
        self._ready: dict[str, Record] = {}
        self._beside: dict[str, tuple[str, str]] = {}
        self.counts: Counter[str] = Counter()
        self.missing: Counter[str] = Counter()

    def plan(self, entries: Sequence[Entry], stopped: Callable[[], bool] = lambda: False) -> Plan:
        """What is to be done. Looks at the contents of all files that a manifest knows.

        UsageError, before anything is done, for outputs that would be lost: those that this batch has
        not written, or that were changed since, unless it may overwrite.
        """
        for variables, entry in {entry.variables: entry for entry in reversed(entries)}.items():
            try:
                self._keys[variables] = self._key(self._tasks(variables))
            except RigtriError as error:
                if variables:
                    error.args = (f"{at_line(entry.line, entry.source)}: {error}", *error.args[1:])
                raise
        appeared: dict[str, Record] = {}
        if self._manifest is not None:
            _clear(entries)
            appeared = self._appeared(entries, self._manifest)
        with ThreadPoolExecutor() as pool:
            looks = list(pool.map(lambda entry: None if stopped() else self._look(entry, appeared), entries))
        lost = [entry.target for entry, look in zip(entries, looks, strict=True) if look == "lost"]
        if lost:
            raise UsageError(
                "outputs that exist and that this batch has not written, or that were changed since, are "
                f"replaced only with --overwrite: {and_more(lost, MOST)}"
            )
        pairs = [(entry, look) for entry, look in zip(entries, looks, strict=True) if look is not None]
        return Plan(
            tuple(look for _, look in pairs if isinstance(look, Assignment)),
            tuple((entry, look) for entry, look in pairs if isinstance(look, Record)),
        )

    def keep(self, manifest: Manifest, entries: Sequence[Entry]) -> None:
        """Put down in a new manifest what becomes of entries that none has known so far."""
        self._manifest = manifest
        _clear(entries)

    def work(self, plan: Plan, engine: Engine) -> Iterator[tuple[Entry, Record]]:
        """Do what is left, and put each file down as it is done; gives all files, in the order they end."""
        for entry, record in plan.settled:
            self.counts[record.status] += 1
            yield entry, record
        for assignment, record in engine.run(plan.assignments, self._on_ready):
            entry = assignment.entry
            ready = self._ready.pop(entry.target, None)
            if record.failed and ready is not None and self._stands(ready):
                record = ready  # its process or worker was killed when its work was done
            record = self._alone(entry, record)
            if self._manifest is not None:
                if record.made:  # as long as its name is not on the disk it is not done
                    fsync_folder(Path(entry.target).parent)
                self._manifest.done(entry, self._keys[entry.variables], record)
            self.counts[record.status] += 1
            self.missing.update(missing(record.kind, reason(record, entry)))
            yield entry, record

    def _alone(self, entry: Entry, record: Record) -> Record:
        """The record, or an error where a file beside the output has replaced that of another one."""
        for name, content in record.made.items():
            if name != seen_from(self._folder, entry.target):
                own, owner = self._beside.setdefault(name, (content, entry.target))
                if own != content:
                    text = (
                        f"{entry.target} and {owner} need different files {name}; give them different folders"
                    )
                    return Record("error", "usage", text, UsageError.exit_code, seconds=record.seconds)
        return record

    @property
    def failures(self) -> int:
        return self.counts["error"] + self.counts["crashed"]

    def _key(self, task: Task) -> str:
        """What decides an output besides its source: the task, the files it reads, and rigtri itself."""
        from rigtri._version import __version__

        contents = [f"{path.name} {self._hashes.of(path)}" for path in task.files()]
        return hashlib.sha256("\n".join([__version__, task.key(), *contents]).encode()).hexdigest()

    def _appeared(self, entries: Sequence[Entry], manifest: Manifest) -> dict[str, Record]:
        """What a killed run had done but not put down as done, by output; it is put down now."""
        waiting = manifest.about_to_be()
        found: dict[str, Record] = {}
        if waiting:
            for entry in entries:
                task, record = waiting.get(self._name(entry), ("", None))
                if record is not None and self._stands(record):
                    fsync_folder(Path(entry.target).parent)
                    manifest.done(entry, task, record)
                    found[entry.target] = record
            here = {self._name(entry) for entry in entries}
            manifest.forget_ready(name for name in waiting if name in here)
        return found

    def _look(self, entry: Entry, appeared: dict[str, Record]) -> Assignment | Record | str:
        """What to do with an entry: an assignment, the record of what is done, or lost for its output."""
        known = self._known(entry)
        if known is not None and self._is_done(entry, known):
            return appeared.get(entry.target) or Record("skipped", deviation=known.deviation)
        mine = known is not None and self._is_ours(known)
        if not mine and not self._overwrite and exists(entry.target):
            return "lost"
        return Assignment(entry, self._tasks(entry.variables), overwrite=mine or self._overwrite)

    def _known(self, entry: Entry) -> Known | None:
        known = self._manifest.known(entry) if self._manifest is not None else None
        for other in self._others:
            if known is None or not self._is_done(entry, known):
                with suppress(sqlite3.Error):  # one that cannot be read is left out
                    known = look_up(other, self._name(entry)) or known
        return known

    def _is_done(self, entry: Entry, known: Known) -> bool:
        return (
            known.status in _DONE
            and known.task == self._keys[entry.variables]
            and seen_from(self._folder, entry.source) in known.read
            and self._hashes.same(known.read, self._folder)
            and self._hashes.same(known.made, self._folder)
        )

    def _is_ours(self, known: Known) -> bool:
        """Whether what stands there is what an earlier run has written, or is gone."""
        try:
            return bool(known.made) and all(
                self._hashes.now(name, self._folder, value) in (value, ABSENT)
                for name, value in known.made.items()
            )
        except OSError:
            return False

    def _name(self, entry: Entry) -> str:
        return name_of(self._folder, entry)

    def _on_ready(self, assignment: Assignment, record: Record) -> None:
        """What is about to appear is put down before it does."""
        self._ready[assignment.entry.target] = record
        if self._manifest is not None:
            self._manifest.ready(assignment.entry, self._keys[assignment.entry.variables], record)

    def _stands(self, record: Record) -> bool:
        """Whether the outputs of a record are there with these hashes."""
        return bool(record.made) and self._hashes.same(record.made, self._folder)


def try_out(plan: Plan, engine: Engine) -> str:
    """Try some of the files: MisfitError or UsageError where the task fits none of them.

    ``engine`` writes nothing. Files are taken from the whole of the plan, as folders hold one kind each.
    Those that cannot be done for other reasons do not count; where none can be done, and not
    one of them for its names, the reasons are returned as text, else "".
    """
    count = len(plan.assignments)
    places = {k * (count - 1) // max(TRIED - 1, 1) for k in range(TRIED)} if count else set()
    some = [plan.assignments[place] for place in sorted(places)]
    reasons: Counter[str] = Counter()
    words: dict[str, str] = {}
    kinds: list[str | None] = []
    for assignment, record in engine.run(some, lambda _, __: None):
        if not record.failed:
            engine.stop()
        kinds.append(record.kind if record.failed else None)
        for bare, whole in faults(record, assignment.entry):
            reasons[bare] += 1
            words.setdefault(bare, whole.replace("FILE", assignment.entry.source))
    if not kinds or None in kinds:
        return ""
    most = reasons.most_common(MOST)
    listed = "; ".join(f"{words[bare]} ({files} of {len(kinds)})" for bare, files in most)
    listed += f"; and {len(reasons) - MOST} more" if len(reasons) > MOST else ""
    tried = f"{len(kinds)} files" if count == len(kinds) else f"{len(kinds)} of {count} files"
    misfits = _MISFITS.intersection(kinds)
    if not misfits:
        return f"None of the {tried} that were tried can be done: {listed}"
    text = f"What is to be done fits none of the {tried} that were tried: {listed}"
    raise UsageError(text) if misfits == {"usage"} else MisfitError(text)


def _clear(entries: Sequence[Entry]) -> None:
    """Remove what killed runs have left beside the outputs; each folder is looked through once."""
    temp_dirs.remove_stale()  # where all is done, no process has work that would need such a folder
    names: dict[str, set[str]] = {}
    for entry in entries:
        if urls.is_url(entry.target):
            continue  # nothing is written there under another name
        folder, name = os.path.split(entry.target)
        names.setdefault(folder, set()).add(name)
    for folder, own in names.items():
        with suppress(FileNotFoundError):
            parts = [found for name in os.listdir(folder or ".") if (found := _PART.fullmatch(name))]
            for name in own & {f"{part[1]}{part[2] or ''}" for part in parts}:
                final = Path(folder, name)
                with as_file_error(final):
                    recover(final, alone=True)  # the manifest is ours, and so are its outputs
