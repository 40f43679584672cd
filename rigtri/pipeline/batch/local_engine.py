"""Who works on the files of a batch. Here: processes of this machine; `batch.dask` has others."""

from __future__ import annotations

import os
import queue
import tempfile
import threading
from collections.abc import Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, suppress
from pathlib import Path
from typing import Any, Protocol

from rigtri.errors import RigtriError
from rigtri.files import temp_dirs
from rigtri.files.staged_output import recover
from rigtri.files.worker_process import CrashError, WorkerProcess
from rigtri.formats import references
from rigtri.pipeline.batch.file_task import Assignment, OnReady, Record, work
from rigtri.pipeline.batch.remote_files import RemoteAssignment, is_elsewhere

# What work and most tasks need, so that a new process has it.
PRELOADED = (
    "rigtri.operations.orient_joints.orient",  # and with it what most operations need
    "rigtri.pipeline.batch.file_task",
    "rigtri.pipeline.batch.spec_task",
    "rigtri.pipeline.rigspec.expand",
    "rigtri.pipeline.rigspec.models.spec",
)
# Waiting for an answer in steps lets signals be on_ready everywhere.
_STEP = 0.2


class Engine(Protocol):
    """Takes assignments and gives records, in any order; one that dies on a file gives that as a record.

    A record with the status ``error`` or ``crashed`` is about its own file alone. What an engine hands to
    several files at once, or to other machines, is its own matter.
    """

    def run(
        self, assignments: Iterable[Assignment], on_ready: OnReady
    ) -> Iterator[tuple[Assignment, Record]]:
        """Work through the assignments.

        ``on_ready`` is called, from any thread, with what a file will have become just before its
        output appears, where the engine knows; it is on record when that returns.
        """

    def stop(self) -> None:
        """Hand nothing more out; what is begun is done."""

    def kill(self) -> None:
        """Give up what is begun, too."""


def processors() -> int:
    """How many processes can work at once here."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class FileProcess(AbstractContextManager["FileProcess"]):
    """A process of this machine that does one file after another, wherever they are.

    seconds, memory: what one file may take, as `rigtri.files.worker_process.WorkerProcess` understands them.
    folder: where the manifest is. at: the folder that relative paths are seen from, where it is not this
    process's own. preload: further modules that the process needs.
    """

    def __init__(
        self,
        folder: str,
        *,
        seconds: float | None = None,
        memory: int | None = None,
        dry_run: bool = False,
        at: str = "",
        preload: Sequence[str] = (),
    ) -> None:
        self._folder, self._dry_run, self._at = folder, dry_run, at
        self._child = WorkerProcess(seconds=seconds, memory=memory, preload=(*PRELOADED, *preload))
        # Of this object, for a process that is killed cannot remove what it has written for itself.
        self._temporary: tempfile.TemporaryDirectory[str] | None = None

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the process, and remove its temporary files."""
        self._child.close()
        if self._temporary is not None:
            self._temporary.cleanup()

    def kill(self) -> None:
        """End the process in the middle of its file, from any thread."""
        self._child.kill()

    def do(self, assignment: Assignment, on_ready: OnReady) -> Record:
        """Do one file; ``on_ready`` as `Engine.run` has it."""
        if not is_elsewhere(assignment.entry):
            return self._near(assignment, on_ready)
        name = assignment.entry.source
        try:
            return RemoteAssignment(
                assignment,
                self._folder,
                self._temporary_folder(),
                references=lambda path: self._child(name, references, Path(path)),
                near=self._near,
                dry_run=self._dry_run,
            ).done(on_ready)
        except CrashError as error:
            return Record("crashed", error.kind, str(error), error.exit_code)

    def _temporary_folder(self) -> str:
        if self._temporary is None:
            self._temporary = temp_dirs.folder()
        return self._temporary.name

    def _near(self, assignment: Assignment, on_ready: OnReady) -> Record:
        """One file of this machine, whatever becomes of the process."""
        name = assignment.entry.source
        try:
            place = self._folder, self._temporary_folder(), self._dry_run, self._at
            return self._child(
                name, work, assignment, *place, on_event=lambda record: on_ready(assignment, record)
            )
        except CrashError as error:
            record = Record("crashed", error.kind, str(error), error.exit_code)
        except RigtriError:
            raise
        except RuntimeError as error:  # a mistake of ours, with its traceback
            record = Record("crashed", "bug", f"{name}: {str(error).strip()}", 1)
        if not self._dry_run:
            with suppress(OSError):  # the file is reported as failed, and the next run tries again
                recover(Path(self._at, assignment.entry.target), alone=True)
        return record


class Local:
    """Processes of this machine, each with a thread that hands it one file after another.

    folder, limits: as `FileProcess` takes them. max_errors: once more files than that have failed, no other
    is begun.
    """

    def __init__(self, jobs: int, folder: str, *, max_errors: int | None = None, **limits: Any) -> None:
        self._max_errors, self._failed = max_errors, 0
        self._processes = [FileProcess(folder, **limits) for _ in range(jobs)]
        self._stopped, self._killed = threading.Event(), threading.Event()
        self._lock = threading.Lock()
        self._results: queue.SimpleQueue[tuple[Assignment, Record] | BaseException | None] = (
            queue.SimpleQueue()
        )

    def run(
        self, assignments: Iterable[Assignment], on_ready: OnReady
    ) -> Iterator[tuple[Assignment, Record]]:
        """As `Engine.run`."""
        source = iter(assignments)
        threads = [
            threading.Thread(target=self._serve, args=(process, source, on_ready), daemon=True)
            for process in self._processes
        ]
        for thread in threads:
            thread.start()
        left = len(threads)
        try:
            while left:
                with suppress(queue.Empty):
                    result = self._results.get(timeout=_STEP)
                    if isinstance(result, BaseException):
                        raise result
                    if result is None:
                        left -= 1
                    else:
                        yield result
        finally:
            if left:
                self.kill()
            for thread in threads:
                thread.join()

    def stop(self) -> None:
        """As `Engine.stop`."""
        self._stopped.set()

    def kill(self) -> None:
        """As `Engine.kill`."""
        self._stopped.set()
        self._killed.set()
        for process in self._processes:
            process.kill()

    def _serve(self, process: FileProcess, source: Iterator[Assignment], on_ready: OnReady) -> None:
        """The life of a thread: the next assignment for its process, until there are none."""
        try:
            with process:
                while not self._stopped.is_set():
                    with self._lock:
                        assignment = next(source, None)
                    if assignment is None:
                        break
                    record = process.do(assignment, on_ready)
                    self._count(record)
                    if not self._killed.is_set():
                        self._results.put((assignment, record))
        except BaseException as error:  # raised where the results are waited for
            self._results.put(error)
            raise SystemExit from error
        finally:
            self._results.put(None)

    def _count(self, record: Record) -> None:
        """Here and not where the results go, so that no file is begun meanwhile."""
        with self._lock:
            self._failed += record.failed
            if self._max_errors is not None and self._failed > self._max_errors:
                self._stopped.set()
