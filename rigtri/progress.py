"""How far long work is, reported to whoever watches: the stage, and how many of its things are done.

Work says it where it happens, and knows nobody who reads it; `report_progress` is for the one who does.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import NamedTuple, Protocol, TypeVar

T = TypeVar("T")


class Watcher(Protocol):
    """Who reads how far work is."""

    def stage(self, name: str) -> None:
        """What is begun, such as ``verify``, or ``step 2 of 7, add-twist: verify``."""

    def at(self, done: float, total: int, what: str) -> None:
        """So many of ``total`` things of this stage are done; ``what`` they are, in the plural."""


class _Count(NamedTuple):
    """How many things are done, which part of one is begun, of how many, and what they are."""

    done: float
    share: float
    total: int
    what: str

    def within(self, done: float, total: int) -> _Count:
        """What is begun where so many of ``total`` parts of this one are done."""
        return _Count(self.done + self.share * done / total, self.share / total, self.total, self.what)


_watcher: ContextVar[Watcher | None] = ContextVar("watcher", default=None)
_part: ContextVar[str] = ContextVar("part", default="")
_outer: ContextVar[_Count | None] = ContextVar("outer", default=None)


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


def count_done(done: float, total: int, what: str) -> None:
    """So many of ``total`` things are done; within another count, so much of one of its things."""
    if watcher := _watcher.get():
        outer = _outer.get()
        one = outer.within(done, total) if outer else _Count(done, 1.0, total, what)
        watcher.at(one.done, one.total, one.what)


@contextmanager
def as_share(begin: float, end: float) -> Iterator[None]:
    """What is counted in here is this share, from 0 to 1, of the thing that is begun."""
    outer = _outer.get()
    if outer is not None:
        inner = outer.within(begin, 1)
        _outer.set(inner._replace(share=outer.share * (end - begin)))
        count_done(0, 1, inner.what)
    try:
        yield
    finally:
        _outer.set(outer)


def counted(things: Collection[T], what: str) -> Iterator[T]:
    """Things one by one, with a sign of how many are done; ``what`` they are, in the plural."""
    outer, total = _outer.get(), len(things)
    try:
        for done, thing in enumerate(things):
            count_done(done, total, what)
            _outer.set(outer.within(done, total) if outer else _Count(done, 1.0, total, what))
            yield thing
            _outer.set(outer)
        if total:
            count_done(total, total, what)
    finally:
        _outer.set(outer)
