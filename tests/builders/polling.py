"""Waiting for a state of other processes that can be asked for."""

from __future__ import annotations

import time
from collections.abc import Callable


def wait_for(state: Callable[[], object], seconds: float = 120) -> None:
    """Return as soon as ``state()`` is true; fails after a time that is no measure of speed."""
    end = time.monotonic() + seconds
    while not state():
        assert time.monotonic() < end, "it did not come"
        # The state is of other processes (a file, a process id), which announce no change: a pause between
        # looks leaves them the processor, and no test takes longer because of its length.
        time.sleep(0.02)
