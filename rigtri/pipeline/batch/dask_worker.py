"""A file of a batch as a task of Dask: this machine's engine, and messages to the process that submitted it.

An output appears only when the submitter has its record in the manifest, as in a batch of one machine:
a submitter that is killed finds in its manifest all that has appeared.
"""

from __future__ import annotations

import multiprocessing
import pickle
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import field
from typing import Any
from uuid import uuid4

from rigtri.files.import_path import leave_out_working_folder
from rigtri.model.dataclass import dataclass
from rigtri.pipeline.batch import urls
from rigtri.pipeline.batch.file_task import Assignment, Record
from rigtri.pipeline.batch.local_engine import FileProcess

# A worker looks this often, in seconds, whether anybody still waits for the file.
_LOOK = 0.5
# A process ends that has had no file for so many seconds.
_KEPT = 10.0
# A child imports what its parent was started with, which takes longer than some files.
_PRELOADED = ("distributed.cli.dask_worker",)


class AbandonedError(Exception):
    """The submitter of a file is gone, or has cancelled it."""


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
    """What a worker reports of a file: that it begins or, with a record, that its output is about to appear.

    answer: the name of the `distributed.Event` that lets it appear.
    """

    number: int
    record: Record | None = None
    answer: str = ""


def do(packed: bytes) -> Record:
    """Do one file. packed: its number, its `Assignment` and the `Settings`, pickled."""
    from distributed import Event as Answer
    from distributed import get_client, get_worker

    number, assignment, settings = pickle.loads(packed)
    # Workers are children of Dask's nannies, which may have none of their own otherwise.
    multiprocessing.current_process().daemon = False
    leave_out_working_folder()
    urls.add_secrets(settings.secrets)
    worker, client = get_worker(), get_client()
    task = worker.get_current_task()

    def send(event: Event) -> None:
        worker.log_event(settings.topic, pickle.dumps(event))

    def ready(_: Assignment, record: Record) -> None:
        answer = Answer(f"{settings.topic}-{uuid4().hex}", client=client)
        send(Event(number, record, answer.name))
        while not answer.wait(timeout=_LOOK):
            if _abandoned(worker, task):
                raise AbandonedError(assignment.entry.source)
        answer.clear()

    send(Event(number))
    with _process(settings, worker, task) as process:
        record = process.do(assignment, ready)
        if _abandoned(worker, task):
            raise AbandonedError(assignment.entry.source)
        return record


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
    """A process for a file: one that has done another of the batch, or a new one."""
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
