"""The program: parse, call, print. One module for each command, called after it.

`catalogue` lists the commands, `options` has the options that they share, `edit_command` makes the command of
an operation. Nothing here computes anything about rigs or opens their formats, and no other package imports
from it: what a command does is a call of the library.
"""

from __future__ import annotations

import _thread
import gc
import os
import signal
import time
from contextlib import suppress
from types import FrameType
from typing import Any, NoReturn

# The signals that let a program tidy up before it ends, and the word for that.
_WORDS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}
if hasattr(signal, "SIGHUP"):  # a terminal or a connection that closes; Windows has none
    _WORDS[signal.SIGHUP] = "hung up"
# What a shell sets that asks for completions.
COMPLETION = "_RIGTRI_COMPLETE"
# Two interrupts nearer than this, in seconds, are one: the second would break off what the first tidies up.
_NEAR = 0.5
_last = -_NEAR
# How many more objects there must be before rings of them are looked for, and how often that must have been
# before older ones are looked at, too: what is imported, 50,000 to 75,000, has none that go, and what a
# command reads few.
_RINGS = 100_000, 5, 10
# Seconds until an interrupt is tried again that came where it cannot be an exception.
_LATER = 0.01


def _end(number: int, _frame: object) -> NoReturn:
    """End at once: nothing is begun. Where a shell completes a line, words would stand in that line."""
    word, code = ending(KeyboardInterrupt(number))
    if COMPLETION not in os.environ:
        with suppress(OSError):  # nobody reads it
            os.write(2, f"\nrigtri: {word}\n".encode())
    os._exit(code)


def _raise(number: int, frame: FrameType | None) -> None:
    global _last
    if _would_be_lost(frame):
        _thread.start_new_thread(_again, (number, _thread.get_ident()))
        return
    before, _last = _last, time.monotonic()
    if _last - before > _NEAR:
        raise KeyboardInterrupt(number)


def ending(error: KeyboardInterrupt) -> tuple[str, int]:
    """The word for how a program ends, and its exit code, by what `_raise` raised or Python itself."""
    number = signal.Signals(error.args[0] if error.args else signal.SIGINT)
    return _WORDS[number], 128 + number


def heard() -> list[signal.Signals]:
    """The signals that end a program, without those that it was started to ignore, as by ``nohup``."""
    return [number for number in _WORDS if signal.getsignal(number) is not signal.SIG_IGN]


def _would_be_lost(frame: FrameType | None) -> bool:
    """Whether Python, or a module that is being imported, would make another error of an exception, or none.

    Python 3.11 makes a RuntimeError of what `__set_name__` raises, any version drops what `__del__` raises,
    and modules try to import others with an `except` that is too wide.
    """
    while frame is not None:
        code = frame.f_code
        if code.co_name in ("__set_name__", "__del__") or code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


def _again(number: int, main: int) -> None:
    """Interrupt the main thread a little later, whatever it waits for then."""
    time.sleep(_LATER)
    if os.name == "posix":
        signal.pthread_kill(main, number)
    else:
        _thread.interrupt_main(signal.Signals(number))


def begin() -> None:
    """Before anything else is imported: an interrupt ends the process without a traceback of imports.

    For `rigtri.__main__` alone: what a caller's process does with interrupts, memory and search path is not
    ours.
    """
    gc.set_threshold(*_RINGS)
    for number in _WORDS:
        unset = signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL
        _replace(number, unset, _end)


def raise_interrupts() -> None:
    """Let interrupts be exceptions again."""
    for number in _WORDS:
        _replace(number, _end, _raise)


def ignore_interrupts() -> None:
    """When all is done and printed, let an interrupt change nothing any more, and the process end at once."""
    gc.freeze()  # or Python would look through all objects for rings, to no end
    for number in _WORDS:
        _replace(number, _raise, signal.SIG_IGN)


def _replace(number: signal.Signals, old: object, new: Any) -> None:
    """Let another one handle a signal, unless somebody else than ``old`` does now."""
    if signal.getsignal(number) is old:
        with suppress(ValueError):  # a thread that is not the main one gets none
            signal.signal(number, new)
