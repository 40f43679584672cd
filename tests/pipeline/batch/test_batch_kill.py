"""Killed at any moment and run again: nothing lost, nothing done twice, no half files."""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from batch_tasks import WAITED_FOR
from places import BUILDERS, slow
from polling import wait_for

from rigtri import edit, orient_joints
from rigtri.errors import FileError
from rigtri.pipeline.batch.file_task import Record
from rigtri.pipeline.batch.inputs import Entry
from rigtri.pipeline.batch.manifest_writer import Manifest

PROGRAM = BUILDERS / "batch_tasks.py"
POSIX = pytest.mark.skipif(os.name != "posix", reason="this system has no POSIX file permissions")
COUNT = 10
Start = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def start(tmp_path: Path, samples: Path) -> Iterator[Start]:
    """Starts a batch of slow characters, .glb and .gltf that share a buffer, in a process of its own."""
    folder = tmp_path / "in"
    folder.mkdir()
    shutil.copy(samples / "biped.bin", folder)
    for k in range(COUNT // 2):
        shutil.copy(samples / "biped.glb", folder / f"slow{k:02}.glb")
        shutil.copy(samples / "biped.gltf", folder / f"slow{k:02}.gltf")

    begun: list[subprocess.Popen[str]] = []

    def begin(*words: str) -> subprocess.Popen[str]:
        given = ["--spec", "rig.yaml", "-O", "out", "-j", "2", *words, "in/*.glb", "in/*.gltf"]
        process = subprocess.Popen(
            [sys.executable, str(PROGRAM), "batch", *given],
            cwd=tmp_path,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        begun.append(process)
        return process

    yield begin
    for process in begun:
        process.kill()
        process.wait()
        for stream in (process.stdout, process.stderr):
            assert stream is not None
            stream.close()


@pytest.fixture
def temporary(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Where the temporary files of what is started go; sockets need a short name."""
    with tempfile.TemporaryDirectory() as name:
        monkeypatch.setenv("TMPDIR", name)
        yield Path(name)


def expected(folder: Path) -> dict[str, bytes]:
    """What a batch that nobody disturbs would leave."""
    alone = folder / "alone"
    alone.mkdir()
    for source in [*folder.glob("in/*.glb"), *folder.glob("in/*.gltf")]:
        edit(source, alone / source.name, lambda rig, report: orient_joints(rig, report=report))
    return {path.name: path.read_bytes() for path in alone.iterdir()}


def outputs(folder: Path) -> list[Path]:
    found = (folder / "out").glob("*") if (folder / "out").is_dir() else ()
    return [p for p in found if not p.name.startswith((".", "rigtri-batch")) and p.suffix != ".bin"]


def left_behind(folder: Path) -> list[str]:
    return [path.name for path in (folder / "out").iterdir() if path.name.startswith(".")]


@POSIX
@pytest.mark.parametrize("method", ["forkserver", "spawn"])
@pytest.mark.parametrize("seed", [slow(0), slow(1)])
def test_kills_at_any_moment_lose_nothing_and_do_nothing_twice(
    seed: int, method: str, tmp_path: Path, start: Start, temporary: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("START_METHOD", method)
    chance, want = random.Random(seed), expected(tmp_path)
    first: dict[str, tuple[int, int]] = {}
    known: dict[str, float] = {}
    kills = 0
    for attempt in range(25):
        process = start("--json", "--log", "log.jsonl")
        try:
            # The first hit a fast machine at work, too, and the last let even a slow one end.
            process.communicate(timeout=chance.uniform(0.1, 0.6 + attempt))
            ended = True
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            ended, kills = False, kills + 1
        for path in outputs(tmp_path):
            assert path.read_bytes() == want[path.name], "half a file"
            state = path.stat()
            assert first.setdefault(path.name, (state.st_ino, state.st_mtime_ns)) == (
                state.st_ino,
                state.st_mtime_ns,
            ), "done twice"
        if (tmp_path / "out/rigtri-batch.sqlite").exists():
            base = sqlite3.connect(tmp_path / "out/rigtri-batch.sqlite")
            try:
                at = dict(base.execute("SELECT output, at FROM files WHERE status='ok'").fetchall())
            except sqlite3.OperationalError:  # killed before it had a table
                at = {}
            base.close()
            assert known.items() <= at.items(), "lost, or done twice"
            known = at
        if ended:
            break
    assert ended
    assert process.returncode == 0
    assert kills >= 1
    assert (
        set(known) == {path.name for path in outputs(tmp_path)} == {n for n in want if not n.endswith(".bin")}
    )
    assert left_behind(tmp_path) == list(temporary.iterdir()) == []
    assert {p.name: p.read_bytes() for p in (tmp_path / "out").glob("*.bin")} == {
        name: content for name, content in want.items() if name.endswith(".bin")
    }


@pytest.mark.slow
@POSIX
def test_a_worker_that_is_killed_costs_its_file_alone(tmp_path: Path, start: Start) -> None:
    process = start("--json")
    assert process.stdout is not None
    first = process.stdout.readline()
    victims = workers(process.pid)
    assert victims
    os.kill(victims[-1], signal.SIGKILL)
    rest, _ = rest_of(process)
    lines = [json.loads(line) for line in (first + rest).splitlines()]
    assert len(lines) == COUNT
    failed = [line for line in lines if line["status"] != "ok"]
    assert len(failed) <= 1
    assert process.returncode == (7 if failed else 0)
    for line in failed:
        assert (line["status"], line["kind"]) == ("crashed", "crash")
        assert "SIGKILL" in line["message"]
    again = start("--json")
    assert again.wait(timeout=60) == 0
    assert len(outputs(tmp_path)) == COUNT
    assert left_behind(tmp_path) == []


def rest_of(process: subprocess.Popen[str]) -> tuple[str, str]:
    """What a process says until its end; `communicate` would lose what `readline` has read ahead."""
    assert process.stdout is not None
    assert process.stderr is not None
    process.wait(timeout=60)  # it says less than a pipe holds
    return process.stdout.read(), process.stderr.read()


def workers(process: int) -> list[int]:
    """The processes that work for a batch: below it and below the server that forks them."""
    found: list[int] = []
    for path in Path("/proc").glob("[0-9]*/task/[0-9]*/children"):
        if int(path.parts[2]) in (process, *found):
            try:
                found += [int(word) for word in path.read_text().split()]
            except OSError:
                continue
    below: list[int] = []
    for child in found:
        try:
            below += [int(w) for w in Path(f"/proc/{child}/task/{child}/children").read_text().split()]
        except OSError:
            continue
    return below


@POSIX
@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGINT, 130), slow(signal.SIGTERM, 143), slow(signal.SIGHUP, 129)]
)
def test_an_interrupt_ends_what_is_begun_and_keeps_what_is_done(
    number: signal.Signals, code: int, tmp_path: Path, start: Start
) -> None:
    folder = tmp_path / "in"
    # The first four are tried; what is begun of the others ends when the interrupt has been heard.
    for path in folder.glob("slow0[2-9].*"):
        path.rename(path.with_name(path.name.replace("slow", "wait")))
    process = start("--json")
    assert process.stdout is not None
    assert process.stderr is not None
    first = process.stdout.readline()
    process.send_signal(number)
    heard = iter(process.stderr.readline, "")
    assert any("started files are finished" in line for line in heard)
    (folder / WAITED_FOR).touch()
    rest, told = rest_of(process)
    lines = [json.loads(line) for line in (first + rest).splitlines()]
    assert process.returncode == code
    assert {line["status"] for line in lines} == {"ok"}
    assert 0 < len(lines) < COUNT
    assert f"{COUNT - len(lines)} not started" in told
    assert len(outputs(tmp_path)) == len(lines)
    assert left_behind(tmp_path) == []
    rest, _ = start("--json").communicate(timeout=60)
    again = [json.loads(line)["status"] for line in rest.splitlines()]
    assert (again.count("skipped"), again.count("ok")) == (len(lines), COUNT - len(lines))


@POSIX
@pytest.mark.slow
def test_a_second_interrupt_gives_up_what_is_begun(tmp_path: Path, start: Start, samples: Path) -> None:
    for k in range(2):
        shutil.copy(samples / "biped.glb", tmp_path / "in" / f"hang{k}.glb")
    process = start("--json", "--fail-fast")
    wait_for(lambda: list((tmp_path / "in").glob("hang*.begun")))
    process.send_signal(signal.SIGINT)
    assert process.stderr is not None
    while "started files are finished" not in process.stderr.readline():
        assert process.poll() is None
    process.send_signal(signal.SIGINT)
    out, told = rest_of(process)
    assert process.returncode == 130
    assert out == ""
    assert f"{COUNT + 2} not started" in told
    assert left_behind(tmp_path) == [] if (tmp_path / "out").exists() else True


@POSIX
@pytest.mark.slow
def test_a_reader_that_has_gone_ends_a_batch(tmp_path: Path, start: Start) -> None:
    process = start("--json")
    assert process.stdout is not None
    process.stdout.readline()
    process.stdout.close()
    assert process.wait(timeout=60) != 0
    assert process.stderr is not None
    assert "Traceback" not in process.stderr.read()
    assert left_behind(tmp_path) == []


def test_a_manifest_on_a_full_disk_is_one_error_and_the_next_run_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before: a traceback, "cannot commit - no transaction is active"."""
    path, connect = tmp_path / "rigtri-batch.sqlite", sqlite3.connect
    entry, record = Entry("a.glb", "out/a.glb"), Record("ok", message="x" * 9000)
    with Manifest(path):
        pass

    def full(*given: Any, **more: Any) -> sqlite3.Connection:
        base = connect(*given, **more)
        (pages,) = base.execute("PRAGMA page_count").fetchone()
        base.execute(f"PRAGMA max_page_count={pages}")
        return base

    with monkeypatch.context() as patched:
        patched.setattr(sqlite3, "connect", full)
        found = pytest.raises(FileError, match=r"cannot be used: database or disk is full.*make room")
        with found, Manifest(path) as manifest:
            manifest.ready(entry, "key", record)
    with Manifest(path) as manifest:
        manifest.ready(entry, "key", record)
        manifest.done(entry, "key", record)
        assert manifest.known(entry) is not None


def test_a_new_manifest_that_a_full_disk_does_not_hold_is_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before, one without tables was left behind."""
    path, connect = tmp_path / "rigtri-batch.sqlite", sqlite3.connect

    def full(*given: Any, **more: Any) -> sqlite3.Connection:
        base = connect(*given, **more)
        base.execute("PRAGMA max_page_count=1")
        return base

    monkeypatch.setattr(sqlite3, "connect", full)
    with pytest.raises(FileError, match="database or disk is full"):
        Manifest(path)
    assert list(tmp_path.iterdir()) == []
