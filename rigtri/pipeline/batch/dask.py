"""A Dask cluster as the engine of a batch: a task is some files, each done by a process beside its worker."""

from __future__ import annotations

import asyncio
import logging
import os
import pickle
import queue
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Self
from uuid import uuid4

from rigtri.errors import FileError, UsageError
from rigtri.files.staged_output import recover
from rigtri.files.worker_process import CrashError
from rigtri.pipeline.batch import urls
from rigtri.pipeline.batch.dask_worker import Event, Message, Settings, do
from rigtri.pipeline.batch.file_task import Assignment, OnReady, Record
from rigtri.pipeline.batch.inputs import Entry

# Seconds to wait for the scheduler, and for a first worker.
REACHED, STAFFED = 10.0, 60.0
_STEP = 0.2
# A task costs some 8 ms of processors in client, scheduler and worker, which small files share. Tasks shrink
# towards the end, so that all workers end together: each takes this part of what waits for a worker.
_MOST, _PART = 25, 2


class Cluster:
    """The workers of a Dask scheduler, as an `rigtri.pipeline.batch.local_engine.Engine`.

    jobs: how many tasks are submitted at once, None for as many as keep all workers busy. All else as
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
        self._topic = f"rigtri-{uuid4().hex}"
        self._stopped = self._killed = False
        # What a file has become, the numbers of a task that has ended, or what went wrong.
        self._inbox: queue.SimpleQueue[Event | tuple[int, ...] | Exception] = queue.SimpleQueue()
        self._client: Any = None
        self._assignments: list[Assignment] = []
        self._on_ready: OnReady = lambda *_: None
        self._begun: Counter[int] = Counter()  # how many workers have begun a file
        self._done: set[int] = set()

    def __enter__(self) -> Self:
        """Connect. UsageError without the extra, FileError where the scheduler does not answer."""
        try:
            from distributed import Client
            from distributed.comm import get_address_host
        except ImportError:
            raise UsageError('--dask needs more packages: pip install "rigtri[dask]"') from None
        # Our own errors report what goes wrong, without tracebacks.
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
            self._client.subscribe_topic(self._topic, self._received)
        return self

    def __exit__(self, *_: object) -> None:
        with suppress(OSError):  # of a scheduler that is gone, which has been reported
            self._client.close()

    def check(self, entries: Sequence[Entry]) -> None:
        """FileError where there are no workers, or one lacks this rigtri or does not see the files."""
        from importlib.metadata import version

        from rigtri._version import __version__

        with self._alive():
            self._wait_for_workers()
            versions = self._on_all_workers(version, "rigtri")
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
            blind = [name for name, found in self._on_all_workers(seen, path).items() if found is not True]
            if blind:
                raise FileError(
                    f"the worker {blind[0]} does not see {path} ({len(blind)} of {workers} workers); "
                    "workers need the same file system under the same path"
                )

    def _on_all_workers(self, what: Callable[[str], object], of: str) -> dict[str, object]:
        """What each worker returns; ``what`` is of the standard library, as it may have no other."""
        found: dict[str, object] = self._client.run(what, of, on_error="return")
        return found

    def run(
        self, assignments: Iterable[Assignment], on_ready: OnReady
    ) -> Iterator[tuple[Assignment, Record]]:
        """As `Engine.run`."""
        self._assignments, self._on_ready = list(assignments), on_ready
        with self._alive():
            yield from self._run()

    def _run(self) -> Iterator[tuple[Assignment, Record]]:
        waiting, sent = [*range(len(self._assignments))][::-1], dict[tuple[int, ...], Any]()
        try:
            while not self._killed:
                self._submit(waiting, sent)
                if not sent and self._inbox.empty():
                    return
                with suppress(queue.Empty):
                    message = self._inbox.get(timeout=_STEP)
                    if isinstance(message, Exception):
                        raise message
                    if isinstance(message, Event):
                        assert message.record is not None  # `_put_down` had one
                        self._recover(message.number)
                        yield self._assignments[message.number], message.record
                    elif message in sent:  # and not cancelled
                        for number, record in self._after(message, sent.pop(message), waiting):
                            self._put_down(number, record)
        finally:
            with suppress(OSError):
                self._client.cancel([*sent.values()])

    def stop(self) -> None:
        """As `Engine.stop`."""
        self._stopped = True

    def kill(self) -> None:
        """As `Engine.kill`; workers see within a second that nobody waits for them."""
        self._stopped = self._killed = True

    def _submit(self, waiting: list[int], sent: dict[tuple[int, ...], Any]) -> None:
        """Keep all workers busy, and no more, so that a million files need no memory there.

        sent: the futures of tasks, by the numbers of their files.
        """
        if self._stopped:
            waiting.clear()
            idle = [numbers for numbers in sent if self._begun.keys().isdisjoint(numbers)]
            if idle:
                self._client.cancel([sent.pop(numbers) for numbers in idle])
        room = self._jobs or max(2, 2 * sum(self._client.nthreads().values()))
        while waiting and len(sent) < room:
            count = min(_MOST, max(1, len(waiting) // (_PART * room)))
            numbers = tuple(waiting.pop() for _ in range(count))
            # Packed, as the scheduler, which unpickles arguments, need not have rigtri.
            settings = Settings(self._topic, self._folder, self._at, urls.secrets(), self._limits)
            packed = pickle.dumps(({number: self._assignments[number] for number in numbers}, settings))
            future = self._client.submit(do, packed, pure=False, retries=2)
            sent[numbers] = future
            future.add_done_callback(lambda _, numbers=numbers: self._inbox.put(numbers))

    async def _received(self, event: tuple[float, bytes]) -> None:
        """A worker reports something, and may wait for an answer."""
        from distributed import Queue

        message: Message = pickle.loads(event[1])
        answer = await self._reply(message.about)
        if message.answers:
            answers = Queue(message.answers, client=self._client)
            await answers.put(answer)
            answers.close()

    async def _reply(self, about: Event | tuple[int, ...]) -> list[int] | bool:
        """Of the files of a task that begins: which are not done. Else whether more files are to be begun."""
        if isinstance(about, tuple):
            return [number for number in about if number not in self._done]
        if about.record is None:
            self._begun[about.number] += 1
        elif about.done:
            self._put_down(about.number, about.record)
        else:
            try:
                await asyncio.to_thread(self._on_ready, self._assignments[about.number], about.record)
            except Exception as error:
                self._inbox.put(error)  # raised where records are waited for
                raise
        return not self._stopped

    def _put_down(self, number: int, record: Record) -> None:
        """Take what became of a file, once; where too many have failed no other is begun."""
        if number in self._done:
            return
        self._done.add(number)
        self._failed += record.failed
        if self._max_errors is not None and self._failed > self._max_errors:
            self._stopped = True
        self._inbox.put(Event(number, record, done=True))

    def _recover(self, number: int) -> None:
        """Remove what a dead worker has left beside an output."""
        target = self._assignments[number].entry.target
        if self._begun[number] > 1 and not (self._limits["dry_run"] or urls.is_url(target)):
            with suppress(OSError):
                recover(Path(target), alone=True)

    def _after(
        self, numbers: tuple[int, ...], future: Any, waiting: list[int]
    ) -> Iterator[tuple[int, Record]]:
        """What became of the files that a task has left, where its workers died; others wait again."""
        from distributed.scheduler import KilledWorker

        left = [number for number in numbers if number not in self._done]
        status = future.status
        error = future.exception() if status == "error" else None
        if status != "finished" and not isinstance(error, KilledWorker):
            raise self._broken(f"{type(error).__name__}: {error}" if error else f"a task is {status}")
        for number in reversed(left):
            if error is None or self._begun[number] <= error.allowed_failures:
                waiting.append(number)  # it only waited for workers that died
                continue
            name, deaths = self._assignments[number].entry.source, self._begun[number]
            text = f"{name}: {deaths} workers of the cluster died on this file"
            yield number, Record("crashed", CrashError.kind, text, CrashError.exit_code)

    @contextmanager
    def _alive(self) -> Iterator[None]:
        """FileError where the scheduler goes meanwhile."""
        from distributed import CancelledError

        try:
            yield
        except (OSError, CancelledError) as error:
            raise self._broken(str(error)) from error

    def _broken(self, reason: str) -> FileError:
        return FileError(
            f"the Dask cluster at {self._address} cannot go on ({reason}). What is done is done; run it "
            "again for the rest"
        )
