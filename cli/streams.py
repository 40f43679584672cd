"""Standard output and standard error of this process, whatever its caller has made of them."""

from __future__ import annotations

import io
import os
import sys
from typing import Any


class _Kept(io.FileIO):
    """A standard stream whose reader may go: what nobody reads is dropped, and a command ends as it would.

    Else the first line that is printed would end it, with an exit code that depends on when the reader went.
    """

    lost = False

    def write(self, content: Any, /) -> int:
        """The number of bytes that are done with. Messages that cannot be written at all are dropped."""
        try:
            return super().write(content)
        except OSError as error:
            if self.fileno() == 1 and not isinstance(error, BrokenPipeError):
                raise
            self.lost = True
            return memoryview(content).nbytes


class _Unbuffered(io.BufferedWriter):
    """Writes whole at once, as PYTHONUNBUFFERED asks; a file without a buffer may write a part of it."""

    def write(self, content: Any, /) -> int:
        done = super().write(content)
        self.flush()
        return done


def hold() -> None:
    """Give the standard streams that the caller has closed their places back.

    Else the next file that is opened gets the number, and what is printed goes into it. What is
    written to standard output then fails, for it would be lost.
    """
    held = os.open(os.devnull, os.O_RDONLY)
    while held < 2:
        held = os.dup(held)
    if held > 2:
        os.close(held)
    if sys.stdout is None:
        sys.stdout = os.fdopen(1, "w", encoding="utf-8", closefd=False)


def keep() -> None:
    """Let nobody's reading end the program. Where a process is ours: this replaces the streams."""
    if os.name == "posix":  # elsewhere consoles have streams of another kind
        sys.stdout, sys.stderr = (_kept(stream) for stream in (sys.stdout, sys.stderr))


def _kept(stream: Any) -> Any:
    if not isinstance(stream, io.TextIOWrapper):
        return stream
    lines, at_once = stream.line_buffering, stream.write_through
    buffer = _Unbuffered if at_once else io.BufferedWriter
    binary = buffer(_Kept(stream.fileno(), "w", closefd=False))
    return io.TextIOWrapper(binary, stream.encoding, stream.errors, "\n", lines, at_once)


def lost() -> bool:
    """Whether the reader of standard output went before all was written."""
    stream = sys.stdout
    stream.flush()
    raw = getattr(getattr(stream, "buffer", None), "raw", None)
    return isinstance(raw, _Kept) and raw.lost
