"""Orders, and choices of the largest, that rounding does not turn: of equals the first one.

What two machines round otherwise must not change what a report names or a file holds.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike

from rigtri.maths.trigonometry import Floats

Item = TypeVar("Item")

# Lengths, as a part of the whole body, and scores that differ by less are equal: files keep places as
# float32, and a second run has other rounding.
SAME_LENGTH, SAME_SCORE = 1e-5, 1e-4
# Numbers of which one is larger by less than this share are equal, for the same reason.
SAME_SHARE = 1e-5
# Axes about which this much (a cosine) is the same are equally far from a direction.
_SAME_AXIS = 0.1


def ranked(items: Iterable[Item], value: Callable[[Item], float], same: float) -> list[Item]:
    """Items with the largest value first; those whose values differ by less than ``same`` stay in order.

    What is no number counts as infinite.
    """
    order = list(items)
    values = [np.inf if np.isnan(each) else each for each in map(value, order)]
    rows = sorted(range(len(order)), key=lambda k: -values[k])
    found: list[Item] = []
    first = 0
    while first < len(rows):
        most, last = values[rows[first]], first + 1
        while last < len(rows) and (values[rows[last]] >= most or values[rows[last]] > most - same):
            last += 1
        found += [order[k] for k in sorted(rows[first:last])]
        first = last
    return found


def first_largest(values: ArrayLike) -> int:
    """The place of the largest of numbers; of those that are as large but for a share the first.

    >>> first_largest([1.0, 50.0, 50.0000001])
    1
    """
    found = np.asarray(values, dtype=np.float64)
    most = found.max()
    return int(np.argmax(found >= min(most * (1.0 - SAME_SHARE), most * (1.0 + SAME_SHARE))))


def largest(items: Iterable[Item], value: Callable[[Item], float]) -> Item:
    """The item with the largest value; of those whose values are as large but for a share the first."""
    order = list(items)
    return order[first_largest([value(item) for item in order])]


def axis_across(direction: ArrayLike) -> Floats:
    """The axis of the world least parallel to directions, (..., 3): of those that are about so the first.

    >>> axis_across([1e-17, -1.0, 0.0]).tolist()
    [1.0, 0.0, 0.0]
    """
    along = np.abs(np.asarray(direction, dtype=np.float64))
    least, most = along.min(axis=-1, keepdims=True), along.max(axis=-1, keepdims=True)
    return np.asarray(np.eye(3)[np.argmax(along <= least + _SAME_AXIS * most, axis=-1)])
