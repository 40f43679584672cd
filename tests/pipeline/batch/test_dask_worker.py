"""What a worker of a cluster does, without a cluster: whom it asks, and when its processes end."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from rigtri.pipeline.batch import dask_worker
from rigtri.pipeline.batch.dask_worker import _KEPT, _LOOK, _do_one, _Processes, _watch


class Process:
    def __init__(self) -> None:
        self.ends = list[str]()

    def kill(self) -> None:
        self.ends.append("killed")

    def close(self) -> None:
        self.ends.append("closed")


def worker(**tasks: str) -> Any:
    states = {name: SimpleNamespace(state=state) for name, state in tasks.items()}
    return SimpleNamespace(state=SimpleNamespace(tasks=states), status=SimpleNamespace(name="running"))


def watched(ours: _Processes, by: Any, busy_for: int, patch: pytest.MonkeyPatch) -> float:
    """When watching ends, in seconds, of processes at work for so many looks, without waiting."""
    clock = [100.0]

    def sleep(seconds: float) -> None:
        clock[0] += seconds
        if clock[0] >= 100.0 + busy_for * _LOOK and ours.busy:
            ours.idle.extend(ours.busy.values())
            ours.busy.clear()

    patch.setattr(dask_worker, "time", SimpleNamespace(sleep=sleep, monotonic=lambda: clock[0]))
    patch.setitem(dask_worker._batches, "batch", ours)
    _watch("batch", by)
    assert "batch" not in dask_worker._batches
    return clock[0] - 100.0


def test_processes_end_once_a_batch_has_had_no_file_for_a_while(monkeypatch: pytest.MonkeyPatch) -> None:
    process: Any = Process()
    end = watched(_Processes(busy={"t": process}), worker(t="executing"), 60, monkeypatch)
    assert end == pytest.approx(59 * _LOOK + _KEPT)
    assert process.ends == ["closed"]


@pytest.mark.parametrize("by", [worker(), worker(t="cancelled")])
def test_a_process_is_killed_whose_task_nobody_waits_for(by: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    process: Any = Process()
    watched(_Processes(busy={"t": process}), by, 2, monkeypatch)
    assert process.ends == ["killed", "closed"]


@pytest.mark.parametrize(("state", "abandoned"), [("running", False), ("paused", False), ("closing", True)])
def test_tasks_of_a_worker_that_ends_are_abandoned(state: str, abandoned: bool) -> None:
    by = worker(t="executing")
    by.status.name = state
    assert dask_worker._abandoned(by, "t") is abandoned


@pytest.mark.parametrize("more", [True, False])
@pytest.mark.parametrize("most", [True, False])
@pytest.mark.parametrize("failed", [True, False])
def test_the_submitter_is_asked_once_of_each_file(failed: bool, most: bool, more: bool) -> None:
    """When most of a file is done, so that the answer is there at its end; at its end, where it fails."""
    said = list[tuple[str, int, Any, bool]]()

    def noted(how: str) -> Any:
        return lambda event: said.append((how, event.number, event.record, event.done)) or more

    submitter = SimpleNamespace(tell=noted("tell"), ask=noted("ask"), check=lambda: None)
    record = SimpleNamespace(failed=failed)

    def do(assignment: Any, ready: Any) -> Any:
        assert assignment == "file"
        if most:
            ready(7, "ready")
        return record

    assert _do_one(7, "file", SimpleNamespace(do=do), submitter) is more  # type: ignore[arg-type]
    asked = [("ask", 7, "ready", False)] if most else []
    end = "tell" if most and not failed else "ask"
    assert said == [("tell", 7, None, False), *asked, (end, 7, record, True)]


def test_a_process_that_was_not_stopped_within_a_file_does_the_next(monkeypatch: pytest.MonkeyPatch) -> None:
    made, batches = list[Process](), dict[str, _Processes]()

    def new(*_: object, **__: object) -> Process:
        made.append(Process())
        return made[-1]

    monkeypatch.setattr(dask_worker, "FileProcess", new)
    monkeypatch.setattr(dask_worker, "_batches", batches)
    monkeypatch.setattr(dask_worker, "_watch", lambda topic, by: None)
    settings = dask_worker.Settings("batch", "folder", "at", {}, {})
    with (
        dask_worker._process(settings, None, "one") as one,
        dask_worker._process(settings, None, "two") as two,
    ):
        assert one is not two
        assert batches["batch"].busy == {"one": one, "two": two}
    assert batches["batch"].busy == {}
    with pytest.raises(KeyError), dask_worker._process(settings, None, "three") as three:
        raise KeyError
    with dask_worker._process(settings, None, "four") as four:
        assert three is not four
    assert [process.ends for process in made if process is three] == [["closed"]]
    assert len(made) == 2
    assert batches["batch"].idle == [four]
