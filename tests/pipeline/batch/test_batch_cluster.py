"""A batch on a Dask cluster is the batch of one machine, whatever becomes of the workers."""

from __future__ import annotations

import asyncio
import gc
import json
import os
import pickle
import re
import shutil
import signal
import socket
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("distributed", reason="distributed is not installed: pip install '.[test]'")

from batch_tasks import WAITED_FOR, Turn
from distributed import Client
from distributed.scheduler import KilledWorker, WorkerState
from places import BUILDERS
from polling import wait_for
from program import cli

from rigtri import edit, orient_joints
from rigtri.errors import FileError
from rigtri.pipeline.batch import dask, dask_worker, urls
from rigtri.pipeline.batch.dask_worker import Event
from rigtri.pipeline.batch.file_task import Assignment, Record
from rigtri.pipeline.batch.inputs import Entry

# Tasks travel by the name of their module, which workers must find, too.
ENVIRONMENT = os.environ | {"PYTHONPATH": str(BUILDERS), "PYTHONSAFEPATH": ""}
POSIX = pytest.mark.skipif(os.name != "posix", reason="this system has no POSIX file permissions")
LATE = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
pytestmark = [POSIX, LATE]
Begin = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture(autouse=True)
def tidy() -> Iterator[None]:
    """Sockets that the libraries close late are closed here, not in whichever test comes next."""
    yield
    gc.collect()


class Machines:
    """A scheduler and its workers, as processes."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.workers = folder, list[subprocess.Popen[bytes]]()
        self.scheduler = self._start("scheduler", "--port", "0", "--host", "127.0.0.1")
        known = folder / "scheduler.json"
        wait_for(lambda: _is_whole(known))
        self.address = str(json.loads(known.read_text())["address"])

    def add_worker(self, *words: str) -> None:
        kind = words or ("--no-nanny",)
        self.workers.append(self._start("worker", "--nthreads", "1", "--local-directory", "scratch", *kind))

    def _start(self, kind: str, *words: str) -> subprocess.Popen[bytes]:
        program = [sys.executable, "-m", f"distributed.cli.dask_{kind}", "--no-dashboard"]
        with (self.folder / f"{kind}.log").open("ab") as log:
            return subprocess.Popen(
                [*program, "--scheduler-file", str(self.folder / "scheduler.json"), *words],
                cwd=self.folder,
                env=ENVIRONMENT,
                stdout=log,
                stderr=log,
            )

    def is_idle(self) -> bool:
        """Whether no worker does anything."""
        with Client(self.address, set_as_default=False) as client:
            executing = client.run(lambda dask_worker: dask_worker.state.executing_count)
        return not any(executing.values())

    def end(self) -> None:
        for process in (*self.workers, self.scheduler):
            process.terminate()
        for process in (*self.workers, self.scheduler):
            try:
                process.wait(timeout=5)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def _is_whole(path: Path) -> bool:
    """Whether a JSON file is there to its end; the scheduler opens it before it writes."""
    try:
        return bool(json.loads(path.read_text()))
    except (OSError, ValueError):
        return False


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


@pytest.fixture
def machines(tmp_path: Path) -> Iterator[Machines]:
    place = tmp_path / "machines"
    place.mkdir()
    found = Machines(place)
    yield found
    found.end()


@pytest.fixture
def begin(tmp_path: Path, samples: Path) -> Iterator[Begin]:
    """Starts a batch over in/ to out/ in a process of its own; what is done is `Turn`."""
    (tmp_path / "in").mkdir()
    begun: list[subprocess.Popen[str]] = []

    def start(*words: str) -> subprocess.Popen[str]:
        given = ["batch", "in/*.glb", "--spec", "rig.yaml", "-O", "out", "--json", *words]
        process = subprocess.Popen(
            [sys.executable, "-c", "import sys, batch_tasks as t; t.run_program(sys.argv[1:])", *given],
            cwd=tmp_path,
            env=ENVIRONMENT,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        begun.append(process)
        return process

    yield start
    for process in begun:
        process.kill()
        process.communicate()


def add(folder: Path, sample: Path, *names: str) -> None:
    for name in names:
        shutil.copy(sample, folder / "in" / f"{name}.glb")


def statuses(told: str) -> dict[str, str]:
    """The status of each file, which was told once."""
    found = [json.loads(line) for line in told.splitlines()]
    assert len({line["file"] for line in found}) == len(found)
    return {Path(line["file"]).stem: line["status"] for line in found}


def outputs(folder: Path) -> dict[str, bytes]:
    return {p.stem: p.read_bytes() for p in (folder / "out").iterdir() if not p.name.startswith("rigtri-")}


@pytest.mark.slow
def test_a_cluster_gives_what_each_file_alone_gives(
    tmp_path: Path, samples: Path, machines: Machines, begin: Begin
) -> None:
    add(tmp_path, samples / "biped.glb", "a", "b", "refuse")
    machines.add_worker()
    stdout, stderr = begin("--dask", machines.address).communicate(timeout=120)
    assert statuses(stdout) == {"a": "ok", "b": "ok", "refuse": "error"}, stderr
    edit(samples / "biped.glb", tmp_path / "alone.glb", lambda rig, report: orient_joints(rig, report=report))
    assert outputs(tmp_path) == dict.fromkeys("ab", (tmp_path / "alone.glb").read_bytes())


@pytest.mark.slow
def test_a_killed_worker_and_a_killed_submitter_lose_nothing_and_do_nothing_twice(
    tmp_path: Path, samples: Path, machines: Machines, begin: Begin
) -> None:
    # The last ones wait until the first run is dead: on a busy machine it would be done before the kill.
    names = [*(f"slow{k:02}" for k in range(14)), *(f"wait{k}" for k in range(4))]
    add(tmp_path, samples / "biped.glb", *names, "refuse", "die")
    for _ in range(2):
        machines.add_worker()
    first = begin("--dask", machines.address)
    out = tmp_path / "out"
    wait_for(lambda: len(list(out.glob("slow*.glb"))) >= 4)
    machines.workers[0].send_signal(signal.SIGKILL)
    wait_for(lambda: len(list(out.glob("slow*.glb"))) >= 8)
    first.kill()
    first.communicate()
    wait_for(machines.is_idle)  # what a worker is at may appear; nothing else does
    before = {path: path.stat().st_mtime_ns for path in out.glob("slow*.glb")}
    assert len(before) >= 8
    assert not list(out.glob("wait*.glb"))
    (tmp_path / "in" / WAITED_FOR).touch()
    second = begin("--dask", machines.address)
    told, said = second.communicate(timeout=300)
    assert second.returncode == 7, said
    found = statuses(told)
    assert found.pop("refuse") == "error"
    assert found.pop("die") == "crashed"
    assert set(found) == set(names)
    assert set(found.values()) <= {"ok", "skipped"}
    assert {path: path.stat().st_mtime_ns for path in before} == before, "done twice"
    edit(samples / "biped.glb", tmp_path / "alone.glb", lambda rig, report: orient_joints(rig, report=report))
    whole = (tmp_path / "alone.glb").read_bytes()
    assert outputs(tmp_path) == dict.fromkeys(names, whole)


@pytest.mark.slow
def test_a_file_that_takes_its_worker_along_is_named_and_costs_no_other(
    tmp_path: Path, samples: Path, machines: Machines, begin: Begin
) -> None:
    names = [f"a{k}" for k in range(6)]
    add(tmp_path, samples / "biped.glb", "hang", *names, "slay")
    machines.add_worker("--nanny")
    process = begin("--dask", machines.address, "--timeout", "2", "-j", "1")
    told, said = process.communicate(timeout=120)
    assert process.returncode == 7, said
    assert statuses(told) == dict.fromkeys(names, "ok") | {"hang": "crashed", "slay": "crashed"}
    assert "slay.glb: 4 workers of the cluster died on this file" in said
    assert "hang.glb: took longer than 2 s" in said
    assert set(outputs(tmp_path)) == set(names)


def test_a_scheduler_that_is_not_there_is_reported_before_anything_is_done(
    tmp_path: Path, samples: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dask, "REACHED", 0.3)
    monkeypatch.chdir(tmp_path)
    Path("in").mkdir()
    add(tmp_path, samples / "biped.glb", "a")
    address = f"tcp://127.0.0.1:{free_port()}"
    Path("rig.yaml").write_text("steps: [{do: orient-joints}]")
    words = ["batch", "in/*.glb", "--spec", "rig.yaml", "-O", "out", "--dask", address]
    result = cli(*words)
    assert result.exit_code == 3, result.stderr
    assert f"no Dask scheduler answers at {address}" in result.stderr
    assert not Path("out").exists()


def test_a_worker_knows_the_secrets_of_urls_before_it_touches_a_file(monkeypatch: pytest.MonkeyPatch) -> None:
    """This process is no worker: what comes next has nobody to ask."""
    monkeypatch.setattr(urls, "_users", {})
    monkeypatch.setattr(urls, "_queries", {})
    monkeypatch.setattr(dask_worker, "leave_out_working_folder", lambda: None)
    secrets = {"s3://studio": "me:word"}, {"https://server/a.glb": "?sig=1"}
    with pytest.raises(ValueError, match="worker"):
        dask_worker.do(pickle.dumps(({}, SimpleNamespace(secrets=secrets))))
    assert urls.secrets() == secrets


@pytest.mark.parametrize("address", ["foo", "tcp://foo", "foo://127.0.0.1:1"])
def test_what_is_no_address_is_reported_before_a_client_waits_for_it(
    tmp_path: Path, address: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("distributed.Client", lambda *_, **__: pytest.fail("a client was begun"))
    with pytest.raises(FileError, match=f"no Dask scheduler answers at {address}"):
        dask.Cluster(address, str(tmp_path)).__enter__()


ERROR, FINE = Record("error", "geometry", "no way up", 5), Record("ok")


def unpacked(packed: bytes) -> tuple[list[tuple[int, Assignment]], Any]:
    """The files of a task by their numbers, and the settings."""
    files, settings = pickle.loads(packed)
    return [*files.items()], settings


def tell(engine: dask.Cluster, about: Event | tuple[int, ...]) -> object:
    """What a worker reports arrives; the answer."""
    return asyncio.run(engine._reply(about))


class Dying:
    """A client of a cluster whose workers die on one file, while the others wait for them."""

    def __init__(self, engine: dask.Cluster, dies: str) -> None:
        self._engine, self._dies, self.submitted = engine, dies, list[str]()

    def nthreads(self) -> dict[str, int]:
        return {}

    def submit(self, _: object, packed: bytes, **__: object) -> Any:
        ((number, assignment),), _settings = unpacked(packed)
        self.submitted.append(assignment.entry.source)
        if assignment.entry.source == self._dies:
            for _ in range(4):
                tell(self._engine, Event(number))
        elif self.submitted.count(assignment.entry.source) > 1:
            tell(self._engine, Event(number, FINE, done=True))
            return Ended()
        return Ended(KilledWorker("a", WorkerState.__new__(WorkerState), 3))

    def cancel(self, _: object) -> None:
        pass


class Ended:
    """A future that has ended."""

    def __init__(self, error: Exception | None = None) -> None:
        self._error, self.status = error, "error" if error else "finished"

    def add_done_callback(self, done: Callable[[object], None]) -> None:
        done(self)

    def result(self, **_: object) -> None:
        pass

    def exception(self) -> Exception | None:
        return self._error


def test_what_waited_for_a_worker_that_died_is_done_again_and_what_killed_it_is_named(tmp_path: Path) -> None:
    engine = dask.Cluster("", str(tmp_path))
    client = Dying(engine, dies="a")
    engine._client = client
    assignments = [Assignment(Entry(name, f"out/{name}"), Turn()) for name in ("a", "b")]
    found = [(a.entry.source, r.status, r.message) for a, r in engine.run(assignments, lambda *_: None)]
    died = "a: 4 workers of the cluster died on this file"
    assert found == [("a", "crashed", died), ("b", "ok", None)]
    assert client.submitted == ["a", "b", "b"]


@pytest.mark.parametrize(
    ("target", "dry_run", "begun", "recovered"),
    [
        ("out/a.glb", False, 2, ["out/a.glb"]),
        ("out/a.glb", False, 1, []),
        ("out/a.glb", True, 2, []),
        ("memory://out/a.glb", False, 2, []),
    ],
)
def test_what_a_dead_worker_has_left_is_removed_where_another_has_done_the_file(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    target: str,
    dry_run: bool,
    begun: int,
    recovered: list[str],
) -> None:
    found: list[str] = []
    monkeypatch.setattr(dask, "recover", lambda path, *, alone: found.append(path.as_posix()) or alone)
    engine = dask.Cluster("", str(tmp_path), jobs=1, dry_run=dry_run)
    engine._client = Working(engine, {"a": Record("ok")}, begun=("a",) * begun)
    list(engine.run([Assignment(Entry("a", target), Turn())], lambda *_: None))
    assert found == recovered


class Working:
    """A client whose worker does files with these records one by one; others are begun, or wait."""

    def __init__(self, engine: dask.Cluster, records: dict[str, Record], begun: tuple[str, ...] = ()) -> None:
        self._engine, self._records, self._begun = engine, records, begun
        self.tasks, self.done, self.cancelled = dict[str, Future](), list[str](), list[str]()

    def submit(self, _: object, packed: bytes, **__: object) -> Future:
        files, _settings = unpacked(packed)
        future = Future(self._engine, *((number, a.entry.source) for number, a in files))
        more: object = True
        for number, assignment in files:
            name = assignment.entry.source
            self.tasks[name] = future
            for _ in range(self._begun.count(name) if more else 0):
                tell(self._engine, Event(number))
            if more and name in self._records:
                self.done.append(name)
                more = future.end(self._records[name])
        return future

    def cancel(self, futures: list[Future]) -> None:
        self.cancelled += [name for future in futures for name in future.names]


class Future(Ended):
    """A task that has ended when its last file has, or no other is wanted."""

    def __init__(self, engine: dask.Cluster, *files: tuple[int, str]) -> None:
        super().__init__()
        self._numbers, self.names = [number for number, _ in files], [name for _, name in files]
        self._engine, self._done = engine, list[Callable[[object], None]]()
        self._ended = False

    def add_done_callback(self, done: Callable[[object], None]) -> None:
        self._done.append(done)
        if self._ended:
            done(self)

    def end(self, record: Record) -> object:
        """Its next file has become this; whether another one is wanted."""
        more = tell(self._engine, Event(self._numbers.pop(0), record, done=True))
        self._ended = not (more and self._numbers)
        for done in self._done if self._ended else ():
            done(self)
        return more


@pytest.mark.parametrize(
    ("most", "done"), [(None, "abcde"), (0, "a"), (1, "abc"), (2, "abcd"), (3, "abcde"), (4, "abcde")]
)
def test_no_file_is_submitted_once_more_have_failed_than_allowed(
    tmp_path: Path, most: int | None, done: str
) -> None:
    engine = dask.Cluster("", str(tmp_path), jobs=1, max_errors=most)
    records = {"a": ERROR, "b": FINE, "c": ERROR, "d": ERROR, "e": FINE}
    engine._client = client = Working(engine, records)
    assignments = [Assignment(Entry(name, f"out/{name}"), Turn()) for name in records]
    found = [(a.entry.source, record) for a, record in engine.run(assignments, lambda *_: None)]
    assert found == [(name, records[name]) for name in done]
    assert client.done == list(done)


def test_once_too_many_have_failed_what_waits_is_cancelled_and_what_is_begun_ends(tmp_path: Path) -> None:
    engine = dask.Cluster("", str(tmp_path), jobs=3, max_errors=0)
    engine._client = client = Working(engine, {"refused": ERROR}, begun=("refused", "begun"))
    assignments = [Assignment(Entry(k, f"out/{k}"), Turn()) for k in ("refused", "begun", "waits", "never")]
    run = engine.run(assignments, lambda *_: None)
    assert next(run)[1] == ERROR
    client.tasks["begun"].end(FINE)
    assert [(a.entry.source, record) for a, record in run] == [("begun", FINE)]
    assert list(client.tasks) == ["refused", "begun", "waits"]
    assert client.cancelled == ["waits"]


def test_small_files_share_tasks_which_shrink_towards_the_end(tmp_path: Path) -> None:
    engine = dask.Cluster("", str(tmp_path), jobs=2)
    names = [f"{k:03}" for k in range(260)]
    engine._client = client = Working(engine, dict.fromkeys(names, FINE))
    run = engine.run([Assignment(Entry(name, f"out/{name}"), Turn()) for name in names], lambda *_: None)
    assert [a.entry.source for a, _ in run] == names
    sizes = [len(task.names) for task in dict.fromkeys(client.tasks.values())]
    assert sizes[:7] == [25] * 7
    assert sizes[7:] == sorted(sizes[7:], reverse=True)
    assert sizes[-8:] == [2, *[1] * 7]


def test_a_task_that_is_repeated_does_what_is_left(tmp_path: Path) -> None:
    engine = dask.Cluster("", str(tmp_path))
    tell(engine, Event(4, FINE, done=True))
    assert tell(engine, (3, 4, 5)) == [3, 5]
    tell(engine, Event(4, ERROR, done=True))
    assert engine._inbox.get_nowait() == Event(4, FINE, done=True)
    assert engine._inbox.empty()


class Asked:
    """A client of two workers, the second of which says something else about one question."""

    def __init__(self, question: str, answer: object) -> None:
        self._question, self._answer = question, answer

    def submit(self, *_: object, **__: object) -> Ended:
        return Ended()

    def cancel(self, _: object) -> None:
        pass

    def nthreads(self) -> dict[str, int]:
        return {}

    def run(self, what: Callable[..., object], of: str, on_error: str) -> dict[str, object]:
        first = what(of)
        return {"tcp://a": first, "tcp://b": self._answer if what.__name__ == self._question else first}


@pytest.mark.parametrize(
    ("question", "answer", "said"),
    [
        ("version", "0.0.1", "the worker tcp://b has rigtri 0.0.1 (1 of 2 workers)"),
        ("version", ModuleNotFoundError("rigtri"), "the worker tcp://b has no rigtri (1 of 2 workers)"),
        ("isdir", False, "the worker tcp://b does not see"),
        ("isfile", PermissionError(), "a.glb (1 of 2 workers); workers need the same file system"),
    ],
)
def test_a_worker_that_cannot_do_it_is_named_before_anything_is_done(
    tmp_path: Path, question: str, answer: object, said: str
) -> None:
    (tmp_path / "a.glb").touch()
    engine = dask.Cluster("", str(tmp_path))
    engine._client = Asked(question, answer)
    with pytest.raises(FileError, match=re.escape(said)):
        engine.check([Entry(str(tmp_path / "a.glb"), "out/a.glb")])
    if not question.startswith("v"):
        engine.check([Entry("memory://in/a.glb", "memory://out/a.glb")])


class Gone(Asked):
    """A client whose scheduler dies at some question."""

    def __init__(self, question: str) -> None:
        super().__init__("", None)
        self._at = question

    def __getattribute__(self, name: str) -> Any:
        if name == object.__getattribute__(self, "_at"):
            raise OSError("ConnectionPool closing.")
        return object.__getattribute__(self, name)


@pytest.mark.parametrize("question", ["submit", "run", "nthreads"])
@pytest.mark.slow
def test_a_scheduler_that_dies_is_reported_alike_whenever_it_does(tmp_path: Path, question: str) -> None:
    (tmp_path / "a.glb").touch()
    entry = Entry(str(tmp_path / "a.glb"), "out/a.glb")
    engine = dask.Cluster("", str(tmp_path))
    engine._client = Gone(question)

    def all_of_it() -> None:
        engine.check([entry])
        list(engine.run([Assignment(entry, Turn())], lambda *_: None))

    with pytest.raises(FileError, match=r"cannot go on \(ConnectionPool closing.*run it again"):
        all_of_it()


@pytest.mark.slow
def test_workers_run_nothing_that_lies_where_they_or_the_batch_work(
    machines: Machines, tmp_path: Path, samples: Path
) -> None:
    pack, script = tmp_path / "pack", Path(sysconfig.get_path("scripts"), "rigtri")
    if not script.is_file():
        pytest.skip("no program is installed beside this Python")
    pack.mkdir()
    shutil.copy(samples / "biped.glb", pack)
    (pack / "rig.yaml").write_text("steps: [{do: orient-joints, preset: maya}]")
    machines.add_worker()
    with Client(machines.address, set_as_default=False) as client:
        client.wait_for_workers(1, timeout=60)
    for folder in (pack, machines.folder):
        for name in ("numpy", "pxr", "json", "pickle", "sitecustomize"):
            planted = f"open({str(tmp_path / name)!r}, 'w').close()\nraise SystemExit(1)"
            (folder / f"{name}.py").write_text(planted)
    given = ["batch", "*.glb", "--spec", "rig.yaml", "-O", "out", "--dask", machines.address]
    environment = ENVIRONMENT | {"PYTHONPATH": ""}
    subprocess.run([sys.executable, str(script), *given], cwd=pack, env=environment, check=True)
    assert (pack / "out" / "biped.glb").is_file()
    assert not [path for path in tmp_path.iterdir() if path.is_file()]


@pytest.mark.parametrize(
    ("source", "target", "asked"),
    [
        ("s3://a/b.glb", "s3://out/b.glb", []),
        ("s3://a/b.glb", "out/b.glb", ["out"]),
        ("b.glb", "s3://out/b.glb", ["out", "b.glb"]),
    ],
)
def test_workers_look_for_files_only_where_some_are_on_disk(
    source: str, target: str, asked: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    cluster, looked = object.__new__(dask.Cluster), list[str]()
    cluster._at = "out"

    def on_all_workers(seen: object, path: str) -> dict[str, bool]:
        looked.append(os.path.basename(path))
        return {"one": True}

    monkeypatch.setattr(cluster, "_on_all_workers", on_all_workers)
    cluster._look([Entry(source, target)], 1)
    assert looked == asked
    assert cluster._at == ("out" if asked else "")
