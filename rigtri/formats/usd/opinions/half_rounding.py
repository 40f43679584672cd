"""From float64 to the precision an animation array is stored in, so that poses move least."""

from __future__ import annotations

import numpy as np

from rigtri.formats.half_turn_keys import HALF_TURN, dots, keep_way_round
from rigtri.maths.quaternions import norm
from rigtri.maths.trigonometry import Floats

# Rotations this near to unit length were unit before they were rounded to float32.
UNIT = 1e-6


def put(into: np.ndarray, column: int, stored: np.ndarray, values: Floats) -> None:
    """Put one joint's values, (k, c), into an array (k, j, c); rows that did not change keep their bits.

    stored: (k, c), what the file has. Rotations that were meant to be unit become unit.
    """
    changed = (values != stored.astype(np.float64)).any(axis=1)
    rotations = values.shape[-1] == 4
    if rotations:
        size = norm(values)[:, np.newaxis]
        meant = np.abs(size - 1.0) < UNIT
        values = np.where(meant, values / np.where(meant, size, 1.0), values)
    into[changed, column] = values[changed].astype(into.dtype)
    if rotations:
        _keep_ways_round(into[:, column], stored.astype(np.float64), changed)


def _keep_ways_round(rows: np.ndarray, before: Floats, changed: np.ndarray) -> None:
    """Keep rounding from reversing the way from one key to the next, where it is half a turn.

    USD takes the shorter arc, which the sign of a dot product decides; rows change in place.
    """
    near = np.abs(dots(rows[:-1].astype(np.float64), rows[1:].astype(np.float64))) < HALF_TURN
    negative = dots(before[:-1], before[1:]) < 0
    for k in np.flatnonzero(near & changed[1:]).tolist():
        keep_way_round(rows, k, negative=bool(negative[k]))
