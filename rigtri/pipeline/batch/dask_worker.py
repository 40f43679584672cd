"""Files of a batch as a task of Dask: this machine's engine, and messages to the process that submitted it.

An output appears only when the submitter has its record in the manifest, as in a batch of one machine:
a submitter that is killed finds in its manifest all that has appeared.
"""

from __future__ import annotations

import multiprocessing
import pickle
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import field
from typing import Any
from uuid import uuid4

from rigtri.files.working_folder import leave_out_working_folder
from rigtri.model.dataclass import dataclass
from rigtri.pipeline.batch import urls
from rigtri.pipeline.batch.file_task import Assignment, Record
from rigtri.pipeline.batch.local_engine import FileProcess

# A worker looks this often, in seconds, whether anybody still waits for a task.
_LOOK = 0.5
# A process ends that has had no file for so many seconds.
_KEPT = 10.0
# A child imports what its parent was started with, which takes longer than some files.
_PRELOADED = ("distributed.cli.dask_worker",)


class AbandonedError(Exception):
    """The submitter of a task is gone, or has cancelled it."""


@dataclass(frozen=True)
class Settings:
    """What all files of a batch have in common.

    topic: where the submitter listens. folder, limits, at: as `local_engine.FileProcess` takes them.
    """

    topic: str
    folder: str
    at: str
    secrets: urls.Secrets
    limits: dict[str, Any]


@dataclass(frozen=True)
class Event:
    """What a worker reports of a file.

    record: None where the file begins; what it is about to become or, with ``done``, has become.
    """

    number: int
    record: Record | None = None
    done: bool = False


@dataclass(frozen=True)
class Message:
    """What the submitter receives: an event, or a task's numbers as it begins. answers: the name of the
    `distributed.Queue` where an answer is waited for, "" for nowhere."""

    about: Event | tuple[int, ...]
    answers: str = ""


class _Submitter:
    """The process that has submitted a task, as the task speaks to it."""

    def __init__(self, topic: str, worker: Any, task: str) -> None:
        from distributed import Queue, get_client

        self._topic, self._worker, self._task = topic, worker, task
        self._name = f"{topic}-{uuid4().hex}"
        self._answers = Queue(self._name, client=get_client())

    def close(self) -> None:
        """Let the scheduler forget the answers."""
        self._answers.close()

    def tell(self, about: Event | tuple[int, ...], answers: str = "") -> None:
        """Send it, and go on."""
        self._worker.log_event(self._topic, pickle.dumps(Message(about, answers)))

    def ask(self, about: Event | tuple[int, ...]) -> Any:
        """Send it, and wait for the answer. AbandonedError where nobody is left to give one."""
        self.tell(about, self._name)
        while True:
            try:
                return self._answers.get(timeout=_LOOK)
            except TimeoutError:
                self.check()

    def check(self) -> None:
        """AbandonedError where nobody waits for the task any more."""
        if _abandoned(self._worker, self._task):
            raise AbandonedError


def do(packed: bytes) -> None:
    """Do some files. packed: each with its number and its `Assignment`, and the `Settings`, pickled.

    Each file is begun only when the submitter has said, of the one before, that it wants more.
    """
    from distributed import get_worker

    files, settings = pickle.loads(packed)
    # Workers are children of Dask's nannies, which may have none of their own otherwise.
    multiprocessing.current_process().daemon = False
    leave_out_working_folder()
    urls.add_secrets(settings.secrets)
    worker = get_worker()
    task = worker.get_current_task()
    with closing(_Submitter(settings.topic, worker, task)) as submitter:
        # A task is repeated whose worker has died, and then some of its files are done.
        left = submitter.ask(tuple(files))
        with _process(settings, worker, task) as process:
            for number in left:
                if not _do_one(number, files[number], process, submitter):
                    return


def _do_one(number: int, assignment: Assignment, process: FileProcess, submitter: _Submitter) -> bool:
    """Do a file; whether the submitter wants more. It is asked once of most, as that takes milliseconds."""
    answers: list[bool] = []
    submitter.tell(Event(number))
    record = process.do(assignment, lambda _, ready: answers.append(submitter.ask(Event(number, ready))))
    submitter.check()
    if not answers or record.failed:
        return bool(submitter.ask(Event(number, record, done=True)))
    submitter.tell(Event(number, record, done=True))
    return answers[0]


def _abandoned(worker: Any, task: str) -> bool:
    """Whether nobody waits for a task any more."""
    state = worker.state.tasks.get(task)
    alive = worker.status.name in ("init", "running", "paused")
    return state is None or state.state == "cancelled" or not alive


@dataclass
class _Processes:
    """The processes of a batch on this worker: those without a file, and by their tasks those at work."""

    idle: list[FileProcess] = field(default_factory=list)
    busy: dict[str, FileProcess] = field(default_factory=dict)


_batches: dict[str, _Processes] = {}
_lock = threading.Lock()


@contextmanager
def _process(settings: Settings, worker: Any, task: str) -> Iterator[FileProcess]:
    """A process for a task: one that has done another of the batch, or a new one."""
    with _lock:
        if settings.topic not in _batches:
            _batches[settings.topic] = _Processes()
            threading.Thread(target=_watch, args=(settings.topic, worker), daemon=True).start()
        ours = _batches[settings.topic]
        if ours.idle:
            process = ours.idle.pop()
        else:
            process = FileProcess(settings.folder, at=settings.at, preload=_PRELOADED, **settings.limits)
        ours.busy[task] = process
    try:
        with ExitStack() as failure:
            failure.callback(process.close)  # a process that was stopped within a file does no other
            yield process
            failure.pop_all()
        ours.idle.append(process)
    finally:
        with _lock:
            del ours.busy[task]


def _watch(topic: str, worker: Any) -> None:
    """Kill processes whose file is abandoned; end those of a batch that has had no file for a while."""
    ours, used = _batches[topic], time.monotonic()
    while topic in _batches:
        time.sleep(_LOOK)
        with _lock:
            for task, process in ours.busy.items():
                used = time.monotonic()
                if _abandoned(worker, task):
                    process.kill()
            if time.monotonic() - used >= _KEPT:
                del _batches[topic]
    for process in ours.idle:
        process.close()
