"""A process of one's own for a task: who kills it, and what it says of memory."""

from __future__ import annotations

import errno
import multiprocessing
import os
import signal
from multiprocessing import forkserver
from typing import Any

import pytest

from rigtri.confined import Confined, CrashError
from rigtri.errors import FileError

SERVED = pytest.mark.skipif(
    "forkserver" not in multiprocessing.get_all_start_methods(),
    reason="this system has no POSIX file permissions",
)


def raised(error: Exception) -> None:
    raise error


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
    with Confined() as child:
        assert child("a.glb", abs, -3) == 3
    assert kills != [server._forkserver_pid]


@SERVED
def test_where_no_process_can_be_started_that_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(_: object) -> None:
        raise EOFError("unexpected EOF")

    monkeypatch.setattr(forkserver, "connect_to_new_process", refused)
    with Confined() as child, pytest.raises(FileError, match=r"no process can be started .*unexpected EOF"):
        child("a.glb", abs, -3)


def test_the_many_words_for_no_memory_mean_one_thing() -> None:
    every = [
        MemoryError(),
        RuntimeError("can't start new thread"),
        OSError(errno.ENOMEM, "Cannot allocate memory"),
        ImportError("x.so: failed to map segment from shared object"),
    ]
    with Confined() as child:
        for error in every:
            with pytest.raises(CrashError, match="not enough memory") as told:
                child("a.glb", raised, error)
            assert told.value.kind == "memory"
        with pytest.raises(RuntimeError, match="ordinary"):
            child("a.glb", raised, RuntimeError("ordinary"))
