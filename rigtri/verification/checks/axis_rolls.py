"""How far joints are rolled against each other about the axis that aims, by their axes."""

from __future__ import annotations

import numpy as np

from rigtri.maths.quaternions import between, from_axis_angle, rotate
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, dot, perpendicular

# The number of an axis, 0 to 2, and its sign, 1 or −1.
Signed = tuple[int, float]


def roll_between(axes: Floats, aim: Signed, one: int, other: int, folds: Floats | None = None) -> float:
    """How far a joint is rolled against another about the axis that aims, degrees.

    axes: of all nodes as unit rows, (n, 3, 3). folds: the axis about which bones fold back, (3,): opposite
    ones have no shortest turn.
    """
    (k, sign), up = aim, (aim[0] + 1) % 3
    start, end, axis = axes[one, k] * sign, axes[other, k] * sign, axes[one, up]
    if folds is not None and dot(start, end) < 0:
        half = from_axis_angle(perpendicular(folds, start), np.pi)
        start, axis = rotate(half, start), rotate(half, axis)
    return float(np.degrees(angle(rotate(between(start, end), axis), axes[other, up])))


def roll_within(axes: Floats, aim: Signed, above: int, joint: int) -> float:
    """How far a joint of a finger is rolled against the one above, degrees.

    Bones that bend far, and lie in no one plane for noise, may share the axis that they flex about.
    """
    across = [k for k in range(3) if k != aim[0]]
    shared = np.degrees(angle(axes[above, across], axes[joint, across]))
    return min(roll_between(axes, aim, above, joint), float(shared.min()))
