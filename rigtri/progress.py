"""How far long work is, reported to whoever watches: the stage, and how many of its things are done.

Work says it where it happens, and knows nobody who reads it; `report_progress` is for the one who does.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Protocol


class Watcher(Protocol):
    """Who reads how far work is."""

    def stage(self, name: str) -> None:
        """What is begun, such as ``verify``, or ``step 2 of 7, add-twist: verify``."""

    def at(self, done: int, total: int, what: str) -> None:
        """So many of ``total`` things of this stage are done; ``what`` they are, in the plural."""


_watcher: ContextVar[Watcher | None] = ContextVar("watcher", default=None)
_part: ContextVar[str] = ContextVar("part", default="")


@contextmanager
def report_progress(watcher: Watcher) -> Iterator[None]:
    """Report to ``watcher`` how far what happens here is."""
    token = _watcher.set(watcher)
    try:
        yield
    finally:
        _watcher.reset(token)


@contextmanager
def as_part(name: str) -> Iterator[None]:
    """The stages in here are those of a part of the whole."""
    token = _part.set(f"{name}: ")
    try:
        yield
    finally:
        _part.reset(token)


def begin_stage(name: str) -> None:
    """Something is begun."""
    if watcher := _watcher.get():
        watcher.stage(f"{_part.get()}{name}")


def count_done(done: int, total: int, what: str) -> None:
    """So many of ``total`` things are done."""
    if watcher := _watcher.get():
        watcher.at(done, total, what)
