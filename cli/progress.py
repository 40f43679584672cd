"""How far a long command is: a bar where rich is there, else one line; nothing where nobody looks."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Any, Self

from .text import counted

# The shortest time between two updates of a terminal, in seconds.
_PAUSE = 0.1


class Progress:
    """Shows how many of ``total`` files are done, how many fail, the rate, and the time that is left.

    On standard error, and only on a terminal.
    """

    def __init__(self, total: int, *, quiet: bool = False) -> None:
        self._total, self._done, self._failed = total, 0, 0
        self._began = self._shown = time.monotonic()
        self._shows = not quiet and total > 0 and sys.stderr is not None and sys.stderr.isatty()
        self._bar: Any = None
        self._task: Any = None

    def __enter__(self) -> Self:
        if self._shows:
            self._bar, self._task = _bar(self._total)
            if self._bar is not None:
                self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._show()
            self._bar.stop()
        elif self._shows:
            self._show()
            sys.stderr.write("\n")

    def step(self, *, failed: bool) -> None:
        """One file more is done."""
        self._done += 1
        self._failed += failed
        if self._shows and time.monotonic() - self._shown >= _PAUSE:
            self._show()

    def clear(self) -> None:
        """Make room for a line of text."""
        if self._shows and self._bar is None:
            sys.stderr.write("\r\x1b[K")

    def line(self) -> str:
        """All of it in one line."""
        rate = self._rate()
        left = (self._total - self._done) / rate if rate > 0 else 0.0
        words = [f"{self._done}/{self._total} files", f"{rate:.1f}/s", f"{_clock(left)} left"]
        return ", ".join([*words, counted(self._failed, "error")] if self._failed else words)

    def _rate(self) -> float:
        seconds = time.monotonic() - self._began
        return self._done / seconds if seconds > 0 else 0.0

    def _show(self) -> None:
        self._shown = time.monotonic()
        if self._bar is not None:
            fields = {"errors": counted(self._failed, "error"), "rate": f"{self._rate():.1f}/s"}
            self._bar.update(self._task, completed=self._done, **fields)
        else:
            sys.stderr.write(f"\r\x1b[K{self.line()}")
            sys.stderr.flush()


def _bar(total: int) -> tuple[Any, Any]:
    """rich's bar and its task; None twice where there is no rich."""
    try:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
        from rich.progress import Progress as Bar
    except ImportError:
        return None, None
    bar = Bar(
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("files {task.fields[rate]}"),
        TimeRemainingColumn(),
        TextColumn("{task.fields[errors]}"),
        console=Console(stderr=True),
        transient=True,
    )
    return bar, bar.add_task("", total=total, errors="", rate="")


def _clock(seconds: float) -> str:
    """Seconds as people read them.

    >>> _clock(7), _clock(3723)
    ('0:07', '1:02:03')
    """
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
