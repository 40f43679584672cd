"""Swing and twist: the part of a rotation about an axis, and the rest of it.

A rotation q is ``multiply(swing, twist)``: first the twist about the axis, which leaves the axis
where it is, then the swing, which takes the axis to where q takes it. In the other order the twist
would move what the swing has aimed.

Source: P. Dobrowolski, "Swing-twist decomposition in Clifford algebra", 2015.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from rigtri.maths.quaternions import as_quaternions, conjugate, from_axis_angle
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats, arc_tangent
from rigtri.maths.vectors import dot

# A rotation whose part about the axis is shorter than this swings by 180°: it has no twist.
HALF_ROUND = 1e-9


def twist_angle(q: ArrayLike, axis: ArrayLike) -> Floats:
    """How far unit quaternions, (..., 4), twist about a unit axis, (..., 3): (...), in radians, −π to π.

    0 where they swing by 180°, where every twist would do.

    >>> q = product(from_axis_angle([0, 1, 0], 1.0), from_axis_angle([1, 0, 0], 0.5))
    >>> float(twist_angle(q, [1.0, 0.0, 0.0]).round(12))
    0.5
    """
    q = as_quaternions(q)
    along, w = dot(q[..., :3], axis), q[..., 3]
    # q and −q are one turn: the one with w ≥ 0 has the shorter angle.
    sign = np.where(w < 0, -1.0, 1.0)
    angle = 2.0 * arc_tangent(along * sign, w * sign)
    return np.where(along * along + w * w < HALF_ROUND * HALF_ROUND, 0.0, angle)


def swing_twist(q: ArrayLike, axis: ArrayLike) -> tuple[Floats, Floats]:
    """Unit quaternions (..., 4) as a swing and a twist about ``axis``: ``multiply(swing, twist)``."""
    q = as_quaternions(q)
    twist = from_axis_angle(axis, twist_angle(q, axis))
    return product(q, conjugate(twist)), twist
