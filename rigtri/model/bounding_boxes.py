"""Boxes of the points of a mesh: of what each joint moves, and of how far morphs carry them."""

from __future__ import annotations

from itertools import product

import numpy as np

from rigtri.maths.trigonometry import Floats
from rigtri.model.mesh import Mesh

# Which of low and high each corner takes, along each axis.
_HIGH = np.array(list(product((False, True), repeat=3)))


def boxes(mesh: Mesh, count: int) -> tuple[Floats, Floats]:
    """The boxes of the points that each of ``count`` joints moves, lows and highs, (count, 3)."""
    if mesh.box is not None:
        return np.broadcast_to(mesh.box[0], (count, 3)), np.broadcast_to(mesh.box[1], (count, 3))
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    lows, highs = mesh.joint_boxes
    low[: len(lows)], high[: len(highs)] = lows, highs
    return low, high


def extent(mesh: Mesh) -> tuple[Floats, Floats]:
    """How far morphs can carry each point, (v, 3) twice: every target from 0 to 1, all at once.

    The corners of its box where a mesh has one.
    """
    return (mesh.box[:1], mesh.box[1:]) if mesh.box is not None else mesh.morphed()


def corners(low: Floats, high: Floats) -> Floats:
    """The corners of boxes, lows and highs, (r, 3) twice → (r, 8, 3)."""
    return np.where(_HIGH, high[:, np.newaxis], low[:, np.newaxis])
