"""Keeping what C++ code prints past Python away from the user: it speaks of system calls, not of files."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

_STDERR = 2


@dataclass
class _State:
    """Where standard error led before the first block of any thread that is still inside one."""

    lock: threading.Lock = field(default_factory=threading.Lock)
    inside: int = 0
    saved: int = -1


_STATE = _State()


@contextmanager
def silent() -> Iterator[None]:
    """Let the system's standard error lead nowhere; blocks may nest, also those of several threads."""
    _enter()
    try:
        yield
    finally:
        _leave()


def _enter() -> None:
    with _STATE.lock:
        _STATE.inside += 1
        if _STATE.inside > 1:
            return
        if sys.stderr is not None:
            sys.stderr.flush()
        try:
            _STATE.saved = os.dup(_STDERR)
        except OSError:  # a program without standard error
            _STATE.saved = -1
            return
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, _STDERR)
        os.close(nowhere)


def _leave() -> None:
    with _STATE.lock:
        _STATE.inside -= 1
        if _STATE.inside or _STATE.saved < 0:
            return
        os.dup2(_STATE.saved, _STDERR)
        os.close(_STATE.saved)
        _STATE.saved = -1
