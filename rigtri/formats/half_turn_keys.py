"""Keys of rotations that are half a turn apart: rounding must not reverse the way from one to the next.

Players take the shorter arc, which the sign of a dot product decides.
"""

from __future__ import annotations

import numpy as np

from rigtri.maths.quaternions import dot

# Quaternions whose dot product is nearer to 0 than this are half a turn apart up to rounding.
HALF_TURN = 2.5e-7
# No key is moved further than this to keep its way round.
FAR = 1e-5


def keep_way_round(rows: np.ndarray, k: int, *, negative: bool, limit: float = np.inf) -> None:
    """Move key k + 1 of ``rows``, (n, 4), in place until its dot product with key k has its sign.

    negative: the sign that the keys had before rounding. limit: no component gets larger.
    """
    sign, step = -1.0 if negative else 1.0, HALF_TURN
    first, then = rows[k].astype(np.float64), rows[k + 1].astype(np.float64)
    while sign * float(dot(first, rows[k + 1].astype(np.float64))) < HALF_TURN and step < FAR:
        rows[k + 1] = np.clip(then + sign * step * first, -limit, limit)
        step += HALF_TURN
