"""How far a long command is: one line on a terminal, nothing where nobody looks."""

from __future__ import annotations

import os
import sys
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Self

import click

from rigtri.progress import report_progress

from .terminal_text import colored, counted, plain

# The shortest time between two updates of a terminal, in seconds.
_PAUSE = 0.1
# Cells of the bar, and the characters that stand in front of what is done and of what is left.
_CELLS, _DONE, _LEFT = 24, "━", "─"
# Cells that a bar keeps where its words need the room.
_FEWEST = 6


class Progress:
    """The file, what is done with it, a bar, how many of its things are done, and the time that is left.

    On standard error, and only on a terminal. name: the file; of many files none, and ``total`` of them,
    of which those that fail are counted.
    """

    def __init__(self, name: str = "", *, total: int = 0, quiet: bool = False) -> None:
        self._name, self._stage = Path(name).name, ""
        self._total, self._failed, self._what = total, 0, "files"
        self._done = 0.0
        self._files = not name
        self._began = self._shown = time.monotonic()
        seen = sys.stderr is not None and sys.stderr.isatty() and os.environ.get("TERM") != "dumb"
        self._shows = seen and not quiet
        self._within = ExitStack()

    def __enter__(self) -> Self:
        if self._shows and not self._files:
            self._within.enter_context(report_progress(self))
        return self

    def __exit__(self, *_: object) -> None:
        self._within.close()
        if self._shows and self._files and self._total:
            self._show()
            sys.stderr.write("\n")
        self.clear()

    def step(self, *, failed: bool) -> None:
        """One file more is done."""
        self._done += 1
        self._failed += failed
        self._update()

    def stage(self, name: str) -> None:
        """Something else is begun with the file; how long it takes is not known."""
        self._stage, self._done, self._total = name, 0, 0
        self._show()

    def at(self, done: float, total: int, what: str) -> None:
        """So many of ``total`` things are done; ``what`` they are, in the plural."""
        if (total, what) != (self._total, self._what) or not done:
            self._began = time.monotonic()
        self._done, self._total, self._what = done, total, what
        self._update()

    def clear(self) -> None:
        """Make room for a line of text."""
        if self._shows:
            sys.stderr.write("\r\x1b[K")

    def _update(self) -> None:
        if self._shows and time.monotonic() - self._shown >= _PAUSE:
            self._show()

    def _show(self) -> None:
        import shutil

        self._shown = time.monotonic()
        color = colored(sys.stderr)
        words = [word for word in (self._name, self._stage) if word]
        numbers = self._numbers()
        line = plain(": ".join(words), one_line=True)
        room = shutil.get_terminal_size().columns - 1 - (len(numbers) + 4 if numbers else 0)
        cells = max(min(_CELLS, room - len(line)), _FEWEST)
        room -= cells if numbers else 0
        line = line if len(line) <= room else f"{line[: max(room - 1, 0)]}…"
        shown = [line] if line else []
        if self._total:
            full = round(cells * self._done / self._total)
            done, left = _DONE * full, _LEFT * (cells - full)
            shown += [click.style(done, fg="green") + click.style(left, dim=True) if color else done + left]
            shown.append(numbers)
        sys.stderr.write(f"\r\x1b[K{'  '.join(shown)}")
        sys.stderr.flush()

    def _numbers(self) -> str:
        """How many are done, how fast, and how long the others will take."""
        if not self._total:
            return ""
        seconds = self._shown - self._began
        rate = self._done / seconds if seconds > 0 else 0.0
        words = [f"{int(self._done)}/{self._total} {self._what}"]
        if self._files:
            words.append(f"{rate:.1f}/s")
        if rate > 0:
            words.append(f"{_clock((self._total - self._done) / rate)} left")
        return ", ".join(words + ([counted(self._failed, "error")] if self._failed else []))


def _clock(seconds: float) -> str:
    """Seconds as people read them.

    >>> _clock(7), _clock(3723)
    ('0:07', '1:02:03')
    """
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
