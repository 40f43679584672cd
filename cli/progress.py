"""How far a long command is: one line on a terminal, nothing where nobody looks."""

from __future__ import annotations

import sys
import time
from typing import Self

from .text import counted

# The shortest time between two updates of a terminal, in seconds.
_PAUSE = 0.1


class Progress:
    """Shows how many of ``total`` files are done, how many fail, the rate, and the time that is left.

    On standard error, and only on a terminal. Of one file it shows the clips or limbs, by `at`.
    """

    def __init__(self, total: int = 0, *, quiet: bool = False) -> None:
        self._total, self._done, self._failed, self._what = total, 0, 0, "files"
        self._began = self._shown = time.monotonic()
        self._shows = not quiet and sys.stderr is not None and sys.stderr.isatty()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._shows and self._what == "files" and self._total:
            self._show()
            sys.stderr.write("\n")
        self.clear()

    def step(self, *, failed: bool) -> None:
        """One file more is done."""
        self._done += 1
        self._failed += failed
        if self._shows and time.monotonic() - self._shown >= _PAUSE:
            self._show()

    def at(self, done: int, total: int, what: str) -> None:
        """So many of ``total`` things are done; ``what`` they are, in the plural."""
        if (total, what) != (self._total, self._what) or not done:
            self._began = time.monotonic()
        self._done, self._total, self._what = done, total, what
        if self._shows and time.monotonic() - self._shown >= _PAUSE:
            self._show()

    def clear(self) -> None:
        """Make room for a line of text."""
        if self._shows:
            sys.stderr.write("\r\x1b[K")

    def _show(self) -> None:
        self._shown = time.monotonic()
        seconds = self._shown - self._began
        rate = self._done / seconds if seconds > 0 else 0.0
        left = (self._total - self._done) / rate if rate > 0 else 0.0
        words = [f"{self._done}/{self._total} {self._what}", f"{rate:.1f}/s", f"{_clock(left)} left"]
        words += [counted(self._failed, "error")] if self._failed else []
        sys.stderr.write(f"\r\x1b[K{', '.join(words)}")
        sys.stderr.flush()


def _clock(seconds: float) -> str:
    """Seconds as people read them.

    >>> _clock(7), _clock(3723)
    ('0:07', '1:02:03')
    """
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
