"""A turn between two frames in words: degrees about an axis."""

from __future__ import annotations

import numpy as np

from rigtri.changes.change import furthest, rows, same_numbers
from rigtri.matrices import nearest_rotation
from rigtri.trigonometry import Floats
from rigtri.vectors import length

# Radians, and the same share of a size: what is derived carries the rounding of all joints above.
DERIVED = 1e-6
# An axis nearer to x, y or z than this is called so.
_NEAR = 1e-4


def turn(before: Floats, after: Floats) -> tuple[float, str]:
    """Degrees from one rotation matrix (3, 3) to another, and the axis as the first frame sees it.

    NaN where one is no frame.

    >>> turn(np.eye(3), np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]))
    (90.0, '+z')
    """
    change = np.array([[(after[i] * before[j]).sum() for j in range(3)] for i in range(3)])
    if not np.isfinite(change).all():
        return float("nan"), ""
    skewed = np.array([change[1, 2] - change[2, 1], change[2, 0] - change[0, 2], change[0, 1] - change[1, 0]])
    sine, cosine = float(length(skewed)) / 2.0, (float(np.trace(change)) - 1.0) / 2.0
    degrees = float(np.degrees(np.arctan2(sine, cosine)))
    axis = skewed if sine > _NEAR else _half_turn(change) if cosine < 0 else skewed
    return degrees, _axis(axis)


def _half_turn(change: Floats) -> Floats:
    """The axis of half a turn, whose matrix is 2·aaᵀ − 1."""
    outer = (change + np.eye(3)) / 2.0
    return np.asarray(outer[int(np.argmax(np.diag(outer)))])


def _axis(axis: Floats) -> str:
    size = float(length(axis))
    unit = axis / size if size else axis
    main = int(np.argmax(np.abs(unit)))
    if np.abs(np.delete(unit, main)).max() < _NEAR:
        return f"{'+' if unit[main] > 0 else '-'}{'xyz'[main]}"
    return f"({' '.join(f'{x + 0.0:.3g}' for x in unit.tolist())})"


def moved(before: Floats, after: Floats) -> str:
    """How two matrices differ: by a turn, a way, and a change of size."""
    with np.errstate(invalid="ignore", divide="ignore"):
        degrees, axis = turn(nearest_rotation(before), nearest_rotation(after))
    sizes = length(before[:3, :3]), length(after[:3, :3])
    parts = []
    if degrees > np.degrees(DERIVED):
        parts.append(f"turned {degrees:.4g}° about its own {axis}")
    if not same_numbers(before[3, :3], after[3, :3], DERIVED * float(np.abs(before[3, :3]).max())):
        parts.append(f"position {rows(before[3, :3], after[3, :3])}")
    if not same_numbers(sizes[0], sizes[1], DERIVED * float(sizes[0].max())):
        parts.append(f"scale {rows(*sizes)}")
    return ", ".join(parts) or f"matrix: {furthest(before, after)}"
