"""A chunk of a batch, on a worker of a Dask cluster: this machine's engine, and a line to who has sent it.

What is about to appear is told before it does, and appears only when the sender has put it down, as
in a batch of one machine. So a sender that was killed finds all that has appeared in its manifest,
and of a worker that was killed everybody knows how far it was.
"""

from __future__ import annotations

import multiprocessing
import pickle
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any
from uuid import uuid4

from rigtri.pipeline.batch import urls
from rigtri.pipeline.batch.local_engine import Local
from rigtri.pipeline.batch.work import Assignment, Record

# A worker looks this often, in seconds, whether it is still wanted.
_LOOK = 0.5
# A child imports what its parent was started with, which takes longer than some files.
_PRELOADED = ("distributed.cli.dask_worker",)


class ForsakenError(Exception):
    """Whoever has sent the chunk is gone, or has given it to another worker."""


@dataclass(frozen=True)
class Chunk:
    """Some assignments by their numbers in the batch, and how to do them, as `local_engine.Local`.

    topic: where the sender listens. at: the folder that relative paths are seen from.
    """

    number: int
    topic: str
    assignments: dict[int, Assignment]
    folder: str
    at: str
    secrets: urls.Secrets
    seconds: float | None
    memory: int | None
    dry_run: bool


@dataclass(frozen=True)
class Message:
    """What a worker says of its chunk. kind: begin, ready or done.

    attempt: another each time that a chunk is begun. answer: the name that an answer is waited for at.
    """

    kind: str
    chunk: int
    attempt: str
    answer: str = ""
    assignment: int = -1
    record: Record | None = None


def do(packed: bytes) -> list[tuple[int, Record]]:
    """Do a pickled `Chunk` as a task of Dask; records by the numbers of their assignments."""
    chunk: Chunk = pickle.loads(packed)
    # Workers are children of Dask's nannies, which may have none of their own otherwise.
    multiprocessing.current_process().daemon = False
    urls.remember(chunk.secrets)
    line = _Line(chunk)
    wanted, most = line.ask("begin")
    numbers = {id(chunk.assignments[number]): number for number in wanted}
    limits: dict[str, Any] = {"seconds": chunk.seconds, "memory": chunk.memory, "max_errors": most}
    engine = Local(1, chunk.folder, **limits, dry_run=chunk.dry_run, at=chunk.at, preload=_PRELOADED)

    def heard(assignment: Assignment, record: Record) -> None:
        said = line.ask("ready", numbers[id(assignment)], record)
        if said == "no":
            raise ForsakenError(chunk.number)
        if said == "last":
            engine.stop()

    found = []
    with line.watched(engine):
        for assignment, record in engine.run([chunk.assignments[number] for number in wanted], heard):
            number = numbers[id(assignment)]
            line.tell(Message("done", chunk.number, line.attempt, assignment=number, record=record))
            found.append((number, record))
    return found


class _Line:
    """The way from a task to the one who has sent it: events there, variables back, both by the scheduler."""

    def __init__(self, chunk: Chunk) -> None:
        from distributed import get_client, get_worker

        self._chunk, self.attempt, self._asked = chunk, uuid4().hex, 0
        self._worker, self._client = get_worker(), get_client()
        self._task = self._worker.get_current_task()

    def tell(self, message: Message) -> None:
        self._worker.log_event(self._chunk.topic, pickle.dumps(message))

    def ask(self, kind: str, assignment: int = -1, record: Record | None = None) -> Any:
        """Tell something, and wait for what is said to it. ForsakenError where nobody will."""
        from distributed import Variable

        self._asked += 1
        name = f"{self._chunk.topic}-{self.attempt}-{self._asked}"
        answer = Variable(name, client=self._client)
        self.tell(Message(kind, self._chunk.number, self.attempt, name, assignment, record))
        while not self._forsaken():
            try:
                said = answer.get(timeout=_LOOK)
            except TimeoutError:
                continue
            answer.delete()
            return said
        raise ForsakenError(self._chunk.number)

    def _forsaken(self) -> bool:
        """Whether nobody waits for this task any more, as its sender is gone or the scheduler is."""
        task = self._worker.state.tasks.get(self._task)
        alive = self._worker.status.name in ("init", "running", "paused")
        return task is None or task.state == "cancelled" or not alive

    @contextmanager
    def watched(self, engine: Local) -> Iterator[None]:
        """Meanwhile the engine's work is given up when nobody waits for it."""
        ended = threading.Event()

        def look() -> None:
            while not ended.wait(_LOOK):
                if self._forsaken():
                    engine.kill()
                    return

        watcher = threading.Thread(target=look, daemon=True)
        watcher.start()
        try:
            yield
        finally:
            ended.set()
            watcher.join()
