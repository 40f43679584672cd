"""A turn between two frames in words: degrees about an axis."""

from __future__ import annotations

import numpy as np

from rigtri.maths.matrices import nearest_rotation
from rigtri.maths.ranking import first_largest
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.verification.diff.change import furthest, rows, same_numbers

# Radians, and the same share of a size: what is derived carries the rounding of all joints above.
DERIVED = 1e-6
# An axis nearer to x, y or z than this is called so.
_NEAR = 1e-4


def turns(before: Floats, after: Floats) -> tuple[Floats, Floats]:
    """From rotation matrices, (k, 3, 3), to others: degrees, (k,), and axes of any length, (k, 3).

    The axes are as the first frames see them. NaN where one is no frame.

    >>> degrees, axes = turns(np.eye(3)[np.newaxis], np.array([[[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]]))
    >>> degrees.tolist(), axis_words(axes[0])
    ([90.0], '+z')
    """
    rows, columns = after[:, :, np.newaxis], before[:, np.newaxis]
    with np.errstate(invalid="ignore", over="ignore"):
        change = (rows[..., 0] * columns[..., 0] + rows[..., 1] * columns[..., 1]) + (
            rows[..., 2] * columns[..., 2]
        )
        skewed = np.stack(
            [
                change[:, 1, 2] - change[:, 2, 1],
                change[:, 2, 0] - change[:, 0, 2],
                change[:, 0, 1] - change[:, 1, 0],
            ],
            axis=-1,
        )
        sine = length(skewed) / 2.0
        cosine = (change[:, 0, 0] + change[:, 1, 1] + change[:, 2, 2] - 1.0) / 2.0
        degrees = np.degrees(np.arctan2(sine, cosine))
    half = np.logical_and(np.logical_not(sine > _NEAR), cosine < 0)
    axes = np.where(np.expand_dims(half, 1), _half_turns(change), skewed)
    whole = np.isfinite(change).all(axis=(1, 2))
    return np.where(whole, degrees, np.nan), np.where(np.expand_dims(whole, 1), axes, np.nan)


def _half_turns(change: Floats) -> Floats:
    """The axes of half turns, (k, 3), whose matrices are 2·aaᵀ − 1."""
    outer = (change + np.eye(3)) / 2.0
    return np.array([each[first_largest(np.diagonal(each))] for each in outer]).reshape(-1, 3)


def axis_words(axis: Floats) -> str:
    """``+z``, or the direction of an axis, (3,); "" for none."""
    if not np.isfinite(axis).all():
        return ""
    size = float(length(axis))
    unit = axis / size if size else axis
    main = int(np.argmax(np.abs(unit)))
    if np.abs(np.delete(unit, main)).max() < _NEAR:
        return f"{'+' if unit[main] > 0 else '-'}{'xyz'[main]}"
    return f"({' '.join(f'{x + 0.0:.3g}' for x in unit.tolist())})"


def moved(before: Floats, after: Floats) -> str:
    """How two matrices differ: by a turn, a way, and a change of size."""
    return all_moved(before[np.newaxis], after[np.newaxis])[0]


def all_moved(before: Floats, after: Floats) -> list[str]:
    """The same for many, (k, 4, 4) twice."""
    with np.errstate(invalid="ignore", divide="ignore"):
        degrees, axes = turns(nearest_rotation(before), nearest_rotation(after))
    sizes = length(before[:, :3, :3]), length(after[:, :3, :3])
    return [
        _moved(before[k], after[k], (float(degrees[k]), axes[k]), (sizes[0][k], sizes[1][k]))
        for k in range(len(before))
    ]


def _moved(before: Floats, after: Floats, turned: tuple[float, Floats], sizes: tuple[Floats, Floats]) -> str:
    parts = []
    if turned[0] > np.degrees(DERIVED):
        parts.append(f"rotated {turned[0]:.4g}° about its local {axis_words(turned[1])}")
    if not same_numbers(before[3, :3], after[3, :3], DERIVED * float(np.abs(before[3, :3]).max())):
        parts.append(f"position {rows(before[3, :3], after[3, :3])}")
    if not same_numbers(sizes[0], sizes[1], DERIVED * float(sizes[0].max())):
        parts.append(f"scale {rows(*sizes)}")
    return ", ".join(parts) or f"matrix: {furthest(before, after)}"
