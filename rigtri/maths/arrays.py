"""Types of arrays of whole numbers and of masks, and what is counted in them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Integers = NDArray[np.int64]
Booleans = NDArray[np.bool_]


def runs(numbers: Integers) -> Integers:
    """Where each run of the same number begins in sorted ones, (w,)."""
    first = np.ones(len(numbers), dtype=bool)
    np.not_equal(numbers[1:], numbers[:-1], out=first[1:])
    return np.flatnonzero(first)


def level(*arrays: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Arrays with as many rows as the longest of them."""
    count = max(map(len, arrays))
    return [np.broadcast_to(each, (count, *each.shape[1:])) for each in arrays]
