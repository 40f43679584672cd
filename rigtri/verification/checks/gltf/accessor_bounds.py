"""Whether the min and max that accessors state are those of their numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rigtri.maths.arrays import Booleans
from rigtri.maths.trigonometry import Floats

# Whole numbers below this are floats without loss.
_EXACT = 1 << 53


def is_far(stated: ArrayLike, found: Floats) -> Booleans:
    """Which bounds differ from those found, (…): they are stored as decimal text of 32-bit numbers.

    A value that is no number has no place in any order; its own check reports it.
    """
    given = np.asarray(stated, dtype=np.float64)
    with np.errstate(invalid="ignore", over="ignore"):
        size = np.maximum(1.0, np.maximum(np.abs(given), np.abs(found)))
        return np.asarray(np.abs(given - found) > 1e-5 * size)


def fitting(stated: Sequence[Any], found: Floats) -> Booleans:
    """Which of some bounds, as files have them, are those found, (a, width), or None; not what are no
    plain numbers.
    """
    width = found.shape[1]
    plain = [values is None or _are_plain(values, width) for values in stated]
    written = np.array([ok and values is not None for ok, values in zip(plain, stated, strict=True)])
    given = np.array([values if ok else [0.0] * width for ok, values in zip(written, stated, strict=True)])
    fits = np.isfinite(given).all(axis=1) & ~is_far(given, found).any(axis=1)
    return np.asarray(np.where(written, fits, np.array(plain)))


def _are_plain(values: Any, width: int) -> bool:
    """Whether these are so many floats and small whole numbers."""
    return (
        isinstance(values, list)
        and len(values) == width
        and all(type(value) is float or (type(value) is int and abs(value) < _EXACT) for value in values)
    )
