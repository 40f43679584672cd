"""A Dask cluster as the engine of a batch: chunks of files are tasks, each file has a process of its own."""

from __future__ import annotations

import logging
import os
import pickle
import queue
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self
from uuid import uuid4

from rigtri.errors import FileError, UsageError
from rigtri.files.staged_output import recover
from rigtri.files.worker_process import CrashError
from rigtri.pipeline.batch import urls
from rigtri.pipeline.batch.dask_worker import Chunk, Message, do
from rigtri.pipeline.batch.hashes import Hashes
from rigtri.pipeline.batch.inputs import Entry
from rigtri.pipeline.batch.local_engine import Heard
from rigtri.pipeline.batch.work import Assignment, Record

# A task of Dask costs some milliseconds; so many files share one where there are many.
CHUNK = 25
# A file that so many workers have died on is not given to another.
DEATHS = 3
# Seconds to wait for the scheduler, and for a first worker.
REACHED, STAFFED = 10.0, 60.0
_STEP = 0.2


@dataclass
class _Sent:
    """A chunk on its way. left: numbers of what is not done, in the order of doing."""

    left: list[int]
    future: Any = None
    attempt: str = ""
    begun: bool = False


@dataclass
class _State:
    """A run: what is on its way, and what is known of each assignment by its number."""

    assignments: list[Assignment]
    heard: Heard
    waiting: list[list[int]]
    sent: dict[int, _Sent] = field(default_factory=dict)
    told: dict[int, Record] = field(default_factory=dict)
    deaths: dict[int, int] = field(default_factory=dict)


def _chunks(count: int, threads: int) -> list[list[int]]:
    """Numbers up to ``count`` in chunks, some for each thread so that all end at about the same time."""
    size = max(1, min(CHUNK, count // (4 * max(threads, 1))))
    return [list(range(k, min(k + size, count))) for k in range(0, count, size)]


class Cluster:
    """The workers of a Dask scheduler, as an `rigtri.pipeline.batch.local_engine.Engine`.

    jobs: how many chunks are on their way at once, None for as many as keep all workers busy. All else as
    `local_engine.Local`; with max_errors, other workers end the file that they have begun.
    Used as a context, which connects and looks whether the workers can do what is to be done.
    """

    def __init__(
        self,
        address: str,
        folder: str,
        *,
        jobs: int | None = None,
        seconds: float | None = None,
        memory: int | None = None,
        dry_run: bool = False,
        max_errors: int | None = None,
    ) -> None:
        self._address, self._folder, self._jobs = address, folder, jobs
        self._limits: dict[str, Any] = {"seconds": seconds, "memory": memory, "dry_run": dry_run}
        self._max_errors, self._failed = max_errors, 0
        self._at = os.getcwd()
        self._topic, self._number = f"rigtri-{uuid4().hex}", 0
        self._stopped = self._killed = False
        self._inbox: queue.SimpleQueue[Message | int] = queue.SimpleQueue()
        self._client: Any = None
        self._hashes = Hashes()

    def __enter__(self) -> Self:
        """Connect. UsageError without the extra, FileError where the scheduler does not answer."""
        try:
            from distributed import Client
            from distributed.comm import get_address_host
        except ImportError:
            raise UsageError('--dask needs more packages: pip install "rigtri[dask]"') from None
        # What goes wrong is told by errors of ours, without tracebacks.
        for name in ("distributed", "distributed.client"):
            logging.getLogger(name).setLevel(logging.CRITICAL)
        try:
            get_address_host(self._address)  # a client of what is no address waits for its own end
            self._client = Client(self._address, timeout=REACHED, set_as_default=False)
        except (OSError, ValueError) as error:
            raise FileError(
                f"no Dask scheduler answers at {self._address} ({str(error).strip().splitlines()[0]}); start "
                "one with: dask scheduler"
            ) from error
        with self._alive():
            self._client.subscribe_topic(self._topic, lambda event: self._inbox.put(pickle.loads(event[1])))
        return self

    def __exit__(self, *_: object) -> None:
        with suppress(OSError):  # of a scheduler that is gone, which has been told
            self._client.close()

    def check(self, entries: Sequence[Entry]) -> None:
        """FileError where there are no workers, or one lacks this rigtri or does not see the files."""
        from importlib.metadata import version

        from rigtri._version import __version__

        with self._alive():
            self._wait_for_workers()
            versions = self._asked(version, "rigtri")
        odd = {name: found for name, found in versions.items() if found != __version__}
        for name, found in odd.items():
            has = f"has rigtri {found}" if isinstance(found, str) else "has no rigtri"
            raise FileError(
                f"the worker {name} {has} ({len(odd)} of {len(versions)} workers), and this is "
                f"{__version__}; install the same everywhere"
            )
        with self._alive():
            self._look(entries, len(versions))

    def _wait_for_workers(self) -> None:
        # A task, and no question, as there are clusters that start workers when there is something to do.
        probe = self._client.submit(os.getpid, pure=False)
        try:
            probe.result(timeout=STAFFED)
        except TimeoutError:
            raise FileError(
                f"the Dask scheduler at {self._address} has no workers; start some with: dask worker "
                f"{self._address}"
            ) from None

    def _look(self, entries: Sequence[Entry], workers: int) -> None:
        """Let workers look for what they need; where all is elsewhere that is nothing."""
        if all(urls.is_url(entry.source) and urls.is_url(entry.target) for entry in entries):
            self._at = ""
            return
        sources = (os.path.abspath(entry.source) for entry in entries if not urls.is_url(entry.source))
        for path, seen in ((self._at, os.path.isdir), (next(sources, ""), os.path.isfile)):
            if not path:
                continue
            blind = [name for name, found in self._asked(seen, path).items() if found is not True]
            if blind:
                raise FileError(
                    f"the worker {blind[0]} does not see {path} ({len(blind)} of {workers} workers); "
                    "workers need the same file system under the same path"
                )

    def _asked(self, what: Callable[[str], object], of: str) -> dict[str, object]:
        """What each worker says; something of the standard library, as it may have no other."""
        found: dict[str, object] = self._client.run(what, of, on_error="return")
        return found

    def run(self, assignments: Iterable[Assignment], heard: Heard) -> Iterator[tuple[Assignment, Record]]:
        """As `Engine.run`."""
        every = list(assignments)
        with self._alive():
            yield from self._run(every, heard)

    def _run(self, every: list[Assignment], heard: Heard) -> Iterator[tuple[Assignment, Record]]:
        threads = sum(self._client.nthreads().values())
        state = _State(every, heard, _chunks(len(every), threads)[::-1])
        try:
            while not self._killed:
                self._send(state)
                if not state.sent:
                    return
                with suppress(queue.Empty):
                    message = self._inbox.get(timeout=_STEP)
                    for number, record in self._received(message, state):
                        self._failed += record.failed
                        if self._max_errors is not None and self._failed > self._max_errors:
                            self._stopped = True
                        yield state.assignments[number], record
        finally:
            with suppress(OSError):
                self._client.cancel([sent.future for sent in state.sent.values()])

    def stop(self) -> None:
        """As `Engine.stop`."""
        self._stopped = True

    def kill(self) -> None:
        """As `Engine.kill`; workers see within a second that nobody waits for them."""
        self._stopped = self._killed = True

    def _send(self, state: _State) -> None:
        """Keep all workers busy, and no more, so that a million files need no memory there."""
        if self._stopped:
            state.waiting.clear()
        room = self._jobs or max(2, 2 * sum(self._client.nthreads().values()))
        while state.waiting and len(state.sent) < room:
            self._number += 1
            left = state.waiting.pop()
            mine = {number: state.assignments[number] for number in left}
            chunk = Chunk(
                self._number, self._topic, mine, self._folder, self._at, urls.secrets(), **self._limits
            )
            key = f"{self._topic}-{self._number}"
            future = self._client.submit(do, pickle.dumps(chunk), key=key, pure=False)
            state.sent[self._number] = _Sent(left, future)
            future.add_done_callback(lambda _, number=self._number: self._inbox.put(number))

    def _received(self, message: Message | int, state: _State) -> Iterator[tuple[int, Record]]:
        """What a message tells is done. A number: the end of that chunk."""
        if isinstance(message, int):
            yield from self._ended(state.sent.pop(message), state)
            return
        sent = state.sent.get(message.chunk)
        if message.kind == "begin":
            yield from self._begun(message, sent, state)
            return
        mine = sent is not None and sent.attempt == message.attempt and message.assignment in sent.left
        record = message.record
        if message.kind == "ready":
            if mine and record is not None:
                state.heard(state.assignments[message.assignment], record)
                state.told[message.assignment] = record
            self._answer(message, "no" if not mine else "last" if self._stopped else "go")
        elif mine and sent is not None and record is not None:
            sent.left.remove(message.assignment)
            yield message.assignment, record

    def _begun(self, message: Message, sent: _Sent | None, state: _State) -> Iterator[tuple[int, Record]]:
        """A worker begins a chunk; perhaps another one died on it."""
        if sent is None or self._stopped:
            self._answer(message, ([], None))
            return
        if sent.begun:
            yield from self._died(sent, state)
        sent.attempt, sent.begun = message.attempt, True
        most = None if self._max_errors is None else self._max_errors - self._failed
        self._answer(message, (list(sent.left), most))

    def _died(self, sent: _Sent, state: _State) -> Iterator[tuple[int, Record]]:
        """What the worker had done without saying so; and what it was at comes last, or not again."""
        for number in [n for n in sent.left if n in state.told]:
            if self._hashes.same(state.told[number].made, self._folder):
                sent.left.remove(number)
                yield number, state.told[number]
        if sent.left:
            last = sent.left.pop(0)
            self._recover(state.assignments[last])
            state.deaths[last] = state.deaths.get(last, 0) + 1
            if state.deaths[last] < DEATHS:
                sent.left.append(last)
            else:
                name = state.assignments[last].entry.source
                text = f"{name}: {DEATHS} workers of the cluster died on this file"
                yield last, Record("crashed", CrashError.kind, text, CrashError.exit_code)

    def _ended(self, sent: _Sent, state: _State) -> Iterator[tuple[int, Record]]:
        """A chunk is done, or Dask has given it up."""
        from distributed.scheduler import KilledWorker

        if sent.future.status == "finished":
            for number, record in sent.future.result():
                if number in sent.left:
                    sent.left.remove(number)
                    yield number, record
            return
        error = sent.future.exception() if sent.future.status == "error" else None
        if isinstance(error, KilledWorker) and sent.begun:
            yield from self._died(sent, state)
            if sent.left:
                state.waiting.append(sent.left)
            return
        said = f"{type(error).__name__}: {error}" if error else f"its tasks are {sent.future.status}"
        raise self._broken(said)

    @contextmanager
    def _alive(self) -> Iterator[None]:
        """FileError where the scheduler goes meanwhile."""
        from distributed import CancelledError

        try:
            yield
        except (OSError, CancelledError) as error:
            raise self._broken(str(error)) from error

    def _broken(self, said: str) -> FileError:
        return FileError(
            f"the Dask cluster at {self._address} cannot go on ({said}). What is done is done; run it again "
            "for the rest"
        )

    def _recover(self, assignment: Assignment) -> None:
        """Remove what a dead worker has left beside an output."""
        if not self._limits["dry_run"] and not urls.is_url(assignment.entry.target):
            with suppress(OSError):  # it is done again all the same
                recover(Path(assignment.entry.target), alone=True)

    def _answer(self, message: Message, what: object) -> None:
        from distributed import Variable

        Variable(message.answer, client=self._client).set(what)
