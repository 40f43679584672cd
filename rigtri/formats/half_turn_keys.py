"""Keys of rotations that are half a turn apart: rounding must not reverse the way from one to the next.

Players take the shorter arc, which the sign of a dot product decides.
"""

from __future__ import annotations

import numpy as np

from rigtri.maths.arrays import Booleans
from rigtri.maths.quaternions import dot, norm
from rigtri.maths.trigonometry import Floats

# Quaternions whose dot product is nearer to 0 than this share of their lengths are half a turn apart up to
# rounding.
HALF_TURN = 2.5e-7
# No key is moved further than this to keep its way round.
FAR = 1e-5


def half_turns(rows: Floats) -> Booleans:
    """Which keys of (n, 4) the next is half a turn away from, (n - 1,), whatever their lengths."""
    size = norm(rows)
    return np.asarray(np.abs(dot(rows[:-1], rows[1:])) < HALF_TURN * size[:-1] * size[1:])


def keep_way_round(rows: np.ndarray, k: int, *, negative: bool, limit: float = np.inf) -> None:
    """Move key k + 1 of ``rows``, (n, 4), in place until its dot product with key k has its sign.

    negative: the sign that the keys had before rounding. limit: no component gets larger, but for
    those that are.
    """
    sign, step = -1.0 if negative else 1.0, HALF_TURN
    first, then = rows[k].astype(np.float64), rows[k + 1].astype(np.float64)
    length, size = float(norm(first)), float(norm(then))
    if length == 0.0 or size == 0.0:
        return  # no rotation, so no way round
    limit = max(limit, float(np.abs(then).max()))
    while sign * float(dot(first, rows[k + 1].astype(np.float64))) < HALF_TURN * length * size and step < FAR:
        rows[k + 1] = np.clip(then + sign * step * (size / length) * first, -limit, limit)
        step += HALF_TURN
