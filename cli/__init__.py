"""The program: parse, call, print. One file per command; shared options in options.py."""

from __future__ import annotations

import signal
from contextlib import suppress

# Until the program begins, which hears of interrupts itself, one ends it without a traceback of imports.
_silent = signal.getsignal(signal.SIGINT) is signal.default_int_handler
if _silent:
    with suppress(ValueError):  # a thread that is not the main one hears of none
        signal.signal(signal.SIGINT, signal.SIG_DFL)


def hear_interrupts() -> None:
    """Let interrupts be exceptions again."""
    if _silent and signal.getsignal(signal.SIGINT) is signal.SIG_DFL:
        with suppress(ValueError):
            signal.signal(signal.SIGINT, signal.default_int_handler)
