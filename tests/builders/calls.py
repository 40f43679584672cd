"""Work as a number that no machine and no other load changes: how many functions are called."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any


def calls(work: Callable[[], object]) -> int:
    """How many functions ``work()`` calls, of Python and of C."""
    count = 0

    def counted(_frame: object, event: str, _argument: object) -> None:
        nonlocal count
        count += event in ("call", "c_call")

    known = sys.getprofile()
    sys.setprofile(counted)
    try:
        work()
    finally:
        sys.setprofile(known)
    return count


def lines(work: Callable[[], object]) -> int:
    """How many lines ``work()`` executes, of all Python functions that it calls: loops count as well."""
    count = 0

    def counted(_frame: object, event: str, _argument: object) -> Callable[..., Any]:
        nonlocal count
        count += event == "line"
        return counted

    known = sys.gettrace()
    sys.settrace(counted)
    try:
        work()
    finally:
        sys.settrace(known)
    return count
