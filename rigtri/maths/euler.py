"""Euler angles in one of six orders from quaternions, and back.

Order ``xyz`` rotates about x first, then about y, then about z, of axes that stand still:
``Rx · Ry · Rz`` as row-vector matrices, Maya's ``rotateOrder`` of the same name.

Source: K. Shoemake, "Euler angle conversion", Graphics Gems IV, 1994; the first angle is taken
after the last is undone, which keeps all digits where the middle axis is near a right angle.
"""

from __future__ import annotations

from typing import get_args

import numpy as np
from numpy.typing import ArrayLike

from rigtri.maths import RotateOrder
from rigtri.maths.quaternions import from_axis_angle, multiply, to_axes
from rigtri.maths.trigonometry import Floats, arc_tangent, sin_cos

# The public mathematics; the rest of the module serves rigtri alone.
__all__ = [
    "from_angles",
    "to_angles",
]

# Of a unit vector: less of it gives no direction, and the last angle is taken as 0.
_NOTHING = 1e-15


def to_angles(q: ArrayLike, order: RotateOrder) -> Floats:
    """Angles about x, y and z in radians, (..., 3), of unit quaternions (..., 4).

    The middle angle of the order lies in ±π/2; at its ends the last angle is 0. Raises ValueError for
    an order that is none of the six.

    Source: Shoemake 1994.

    >>> to_angles([0, 0, 0.6, 0.8], "xyz").round(6).tolist()  # 2·atan(0.6/0.8) about z
    [0.0, 0.0, 1.287002]
    """
    i, j, k = _axes(order)
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    m = to_axes(q)
    along, aside = m[..., i, i], sign * m[..., i, j]
    size = np.sqrt(along * along + aside * aside)
    last = np.where(size > _NOTHING, arc_tangent(aside, along), 0.0)
    sine, cosine = sin_cos(last)
    undone = cosine[..., np.newaxis] * m[..., :, j] - sign * sine[..., np.newaxis] * m[..., :, i]
    first = arc_tangent(-sign * undone[..., k], undone[..., j])
    angles = {i: first, j: arc_tangent(-sign * m[..., i, k], size), k: last}
    return np.stack([angles[axis] for axis in range(3)], axis=-1)


def from_angles(angles: ArrayLike, order: RotateOrder) -> Floats:
    """Unit quaternions of angles about x, y and z in radians, (..., 3) → (..., 4).

    Raises ValueError for an order that is none of the six.

    Source: Shoemake 1994: one rotation about each axis, in the order.

    >>> to_angles(from_angles([0.1, 0.2, 0.3], "zyx"), "zyx").round(9).tolist()
    [0.1, 0.2, 0.3]
    """
    angles = np.asarray(angles, dtype=np.float64)
    first, second, third = (from_axis_angle(np.eye(3)[axis], angles[..., axis]) for axis in _axes(order))
    return multiply(third, multiply(second, first))


def _axes(order: RotateOrder) -> tuple[int, int, int]:
    """The axes of an order by their numbers."""
    if order not in (known := get_args(RotateOrder)):
        raise ValueError(f"{order!r} is not a valid order: use {', '.join(known)}")
    i, j, k = map("xyz".index, order)
    return i, j, k
