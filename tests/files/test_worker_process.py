"""A process of one's own for a task: who kills it, and what it says of memory."""

from __future__ import annotations

import errno
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from multiprocessing import forkserver
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import pytest
from places import ci

from rigtri.errors import FileError
from rigtri.files import worker_process
from rigtri.files.worker_process import PRELOADED, CrashError, WorkerProcess
from rigtri.pipeline.batch.local_engine import PRELOADED as BATCH

SERVED = pytest.mark.skipif(
    "forkserver" not in multiprocessing.get_all_start_methods(),
    reason="this system has no POSIX file permissions",
)


def raised(error: Exception) -> None:
    raise error


@pytest.mark.ci
@SERVED
def test_a_server_of_processes_that_is_killed_early_is_started_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    server: Any = forkserver._forkserver  # type: ignore[attr-defined]
    server._stop()
    read, kills = forkserver.read_signed, []  # type: ignore[attr-defined]

    def killed_first(sentinel: int) -> int:
        if not kills:
            kills.append(server._forkserver_pid)
            os.kill(server._forkserver_pid, signal.SIGKILL)
        return int(read(sentinel))

    monkeypatch.setattr(forkserver, "read_signed", killed_first)
    with WorkerProcess() as child:
        assert child("a.glb", abs, -3) == 3
    assert kills != [server._forkserver_pid]


@SERVED
def test_a_time_limit_may_be_longer_than_the_system_waits_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    with WorkerProcess(seconds=1e15) as child:
        assert child("a.glb", abs, -3) == 3
    ours, theirs = multiprocessing.Pipe()
    monkeypatch.setattr(worker_process, "_WAIT", 1e-4)
    assert not worker_process._arrived(ours, time.monotonic() + 1e-3)
    theirs.send(1)
    assert worker_process._arrived(ours, time.monotonic())


class Ended:
    """A process that has ended by itself."""

    def __init__(self, exitcode: int) -> None:
        self.exitcode = exitcode

    def join(self) -> None: ...

    def kill(self) -> None: ...


@pytest.mark.parametrize(
    ("code", "memory", "words", "kind"),
    [
        (-signal.SIGKILL, None, "was killed (SIGKILL), as systems do that run out of memory", "crash"),
        (-signal.SIGKILL, 1 << 30, "was killed (SIGKILL), as systems do that run out of memory", "crash"),
        (-signal.SIGSEGV, None, "crashed (SIGSEGV). The file is damaged; export it again", "crash"),
        (-signal.SIGABRT, 1 << 30, "crashed (SIGABRT): it needs more memory than it may have", "crash"),
        (-500, None, "crashed (-500). The file is damaged", "crash"),  # no signal that has a name
        (3, None, "crashed (3). The file is damaged", "crash"),
        (0, None, "crashed (0). The file is damaged", "crash"),
        (125, None, "there is not enough memory for this file", "memory"),
    ],
)
def test_how_a_process_ended_is_reported_by_its_exit_code(
    code: int, memory: int | None, words: str, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for begun in (True, False):
        mine, theirs = multiprocessing.Pipe()
        if begun:
            theirs.send("ready")
        theirs.close()
        child = WorkerProcess(memory=memory)
        monkeypatch.setattr(child, "_start", lambda mine=mine: (Ended(code), mine))
        with pytest.raises(CrashError) as refused:
            child("a.glb", abs, -3)
        assert str(refused.value).startswith(
            "a.glb: the" if begun or code == -9 else "a.glb: the process for"
        )
        told = f"(exit code {signal.Signals(-code).name if -64 < code < 0 else code})"
        expected = words if begun or code == -signal.SIGKILL else f"ended before it began {told}"
        assert expected in str(refused.value)
        assert refused.value.kind == (kind if begun else "crash")


@SERVED
def test_a_working_folder_that_was_removed_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    with WorkerProcess() as worker, pytest.raises(FileError, match="working folder was removed"):
        worker("a file", os.getpid)


@SERVED
def test_a_limit_of_open_files_that_no_process_can_live_with_is_reported(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Before, multiprocessing failed, with tracebacks of the server of processes and at exit."""
    resource = pytest.importorskip("resource", reason="no limits of open files here")
    monkeypatch.setattr(resource, "getrlimit", lambda _: (14, 1024))
    with (
        WorkerProcess() as child,
        pytest.raises(FileError, match=r"at most 14 files .* Allow more: ulimit -n"),
    ):
        child("a", len, "abc")


def test_where_no_process_can_be_started_that_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(_: object) -> None:
        raise EOFError("unexpected EOF")

    monkeypatch.setattr(forkserver, "connect_to_new_process", refused)
    with (
        WorkerProcess() as child,
        pytest.raises(FileError, match=r"no process can be started .*unexpected EOF"),
    ):
        child("a.glb", abs, -3)


def speechless() -> None:
    """A process that has not even the memory to say that it has none."""

    def send(_self: Connection, _value: object) -> None:
        raise MemoryError

    Connection.send = send  # type: ignore[method-assign]
    raise MemoryError


def test_a_process_without_memory_for_a_word_ends_without_a_traceback(
    capfd: pytest.CaptureFixture[str],
) -> None:
    with (
        WorkerProcess() as child,
        pytest.raises(CrashError, match=r"a\.glb: there is not enough memory") as told,
    ):
        child("a.glb", speechless)
    assert told.value.kind == "memory"
    assert "Traceback" not in capfd.readouterr().err


def test_a_process_does_so_many_files_and_another_takes_its_place(monkeypatch: pytest.MonkeyPatch) -> None:
    # OpenUSD keeps names, paths and handles of each file until its process ends.
    monkeypatch.setattr(worker_process, "_TASKS", 2)
    with WorkerProcess() as child:
        first, second, third, _, last = [child("a.usda", os.getpid) for _ in range(5)]
    assert first == second
    assert len({first, third, last}) == 3


def test_the_many_words_for_no_memory_mean_one_thing() -> None:
    every = [
        MemoryError(),
        RuntimeError("can't start new thread"),
        OSError(errno.ENOMEM, "Cannot allocate memory"),
        ImportError("x.so: failed to map segment from shared object"),
    ]
    with WorkerProcess() as child:
        for error in every:
            with pytest.raises(CrashError, match="not enough memory") as told:
                child("a.glb", raised, error)
            assert told.value.kind == "memory"
        with pytest.raises(RuntimeError, match="ordinary"):
            child("a.glb", raised, RuntimeError("ordinary"))


@pytest.mark.parametrize(
    ("error", "memory"),
    [
        (MemoryError(), True),
        (OSError(errno.ENOMEM, "no"), True),
        (OSError(errno.ENOENT, "no"), False),
        (RuntimeError("can't start new thread"), True),
        (RuntimeError("can't"), False),
        (ValueError("can't start new thread"), False),
        (ImportError("x.so: failed to map segment from shared object"), True),
        (ImportError("no module named x"), False),
        (ValueError("failed to map segment from shared object"), False),
    ],
)
def test_an_error_is_of_memory_by_its_type_and_words(error: Exception, memory: bool) -> None:
    assert worker_process.of_memory(error) is memory


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="nothing tells how much is mapped")
@pytest.mark.parametrize(("most", "least"), [(-1, None), (1 << 62, None), (4096, 4096)])
def test_the_limit_is_what_is_mapped_and_so_much_more_but_no_more_than_allowed(
    monkeypatch: pytest.MonkeyPatch, most: int, least: int | None
) -> None:
    import resource

    found: list[tuple[int, tuple[int, int]]] = []
    monkeypatch.setattr(resource, "getrlimit", lambda kind: (most, most))
    monkeypatch.setattr(resource, "setrlimit", lambda kind, limits: found.append((kind, limits)))
    monkeypatch.setattr(Path, "read_text", lambda self: "1000 7 5")
    worker_process._limit(1 << 30)
    limit = least or 1000 * resource.getpagesize() + (1 << 30)
    assert found == [(resource.RLIMIT_AS, (limit, most))]


@SERVED
def test_a_child_that_is_given_up_while_it_starts_is_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is stopped here, as one that waits for a disk that is gone: it never becomes ready."""
    child = WorkerProcess()
    start = child._start

    def given_up() -> Any:
        process, pipe = start()
        os.kill(process.pid, signal.SIGSTOP)
        child.kill()
        return process, pipe

    monkeypatch.setattr(child, "_start", given_up)
    ends: list[BaseException] = []

    def ask() -> None:
        try:
            child("a file", abs, -1)
        except CrashError as error:
            ends.append(error)

    asking = threading.Thread(target=ask, daemon=True)
    asking.start()
    asking.join(30.0)
    assert len(ends) == 1


INTERRUPTED = """
import os, signal, sys
from multiprocessing import resource_tracker
from rigtri.files.worker_process import WorkerProcess
signal.signal(signal.SIGINT, lambda *_: print("heard", flush=True))
if __name__ == "__main__":
    with WorkerProcess(preload=["interrupting"]) as child:
        print(child("a file", abs, -1))
    os.kill(resource_tracker._resource_tracker._pid, signal.SIGKILL)
    with WorkerProcess() as child:
        print(child("a file", abs, -2))
"""


@SERVED
def test_what_works_on_files_reports_nothing_of_interrupts_and_kills(tmp_path: Path) -> None:
    (tmp_path / "interrupting.py").write_text("import os, signal\nos.killpg(0, signal.SIGINT)\n")
    script = tmp_path / "script.py"
    script.write_text(INTERRUPTED)
    path = os.pathsep.join([str(tmp_path), *sys.path])
    done = subprocess.run(
        [sys.executable, str(script)],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        start_new_session=True,
        timeout=60,
        check=False,
    )
    assert (done.stdout.split(), done.stderr, done.returncode) == (["heard", "1", "2"], "", 0)


@SERVED
@pytest.mark.parametrize(
    ("name", "code", "word"),
    [("SIGINT", 130, "interrupted"), ci("SIGTERM", 143, "terminated"), ("SIGHUP", 129, "hung up")],
)
@pytest.mark.parametrize(
    "line",
    [
        "rigtri.cli; rigtri.cli.begin(); {0}",
        "rigtri.__main__, rigtri.cli.main; {1}; rigtri.__main__.program()",
    ],
)
def test_an_interrupt_at_any_time_ends_the_program_in_our_words(
    line: str, name: str, code: int, word: str
) -> None:
    now = f"os.kill(os.getpid(), signal.{name})"
    soon = "rigtri.cli.main.import_module = lambda _: [" + f"{now}, " * 3 + "]"
    # What runs behind a shell's back, or by nohup, was told not to hear of them.
    heard = "signal.signal(signal.SIGINT, signal.default_int_handler)"
    if name != "SIGINT":
        heard += f"; signal.signal(signal.{name}, signal.SIG_DFL)"
    text = f"import os, signal, sys; {heard}; import {line.format(now, soon)}"
    done = subprocess.run([sys.executable, "-c", text, "build"], capture_output=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (code, f"\nrigtri: {word}\n".encode())


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="this system does not list threads")
def test_what_the_server_of_processes_has_loaded_has_started_no_thread() -> None:
    """A fork copies locks that threads hold, and no thread to let them go."""
    count = f"""
import os
from importlib import import_module
for name in {[*PRELOADED, *BATCH]!r}:
    import_module(name)
print(len(os.listdir("/proc/self/task")))
"""
    alone = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}  # it looks after forks itself
    done = subprocess.run(
        [sys.executable, "-c", count], capture_output=True, text=True, check=True, env=alone
    )
    assert done.stdout == "1\n"
