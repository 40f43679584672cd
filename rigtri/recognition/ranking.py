"""An order of the best first that rounding does not turn."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

Item = TypeVar("Item")

# Lengths, as a part of the whole body, and scores that differ by less are equal: files keep places as
# float32, and a second run has other rounding.
SAME_LENGTH, SAME_SCORE = 1e-5, 1e-4


def ranked(items: Iterable[Item], value: Callable[[Item], float], same: float) -> list[Item]:
    """Items with the largest value first; those whose values differ by less than ``same`` stay in order."""
    order = list(items)
    values = [value(item) for item in order]
    rows = sorted(range(len(order)), key=lambda k: -values[k])
    found: list[Item] = []
    while rows:
        alike = sorted(k for k in rows if values[k] > values[rows[0]] - same)
        found += [order[k] for k in alike]
        rows = rows[len(alike) :]
    return found
