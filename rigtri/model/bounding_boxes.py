"""Boxes of the points of a mesh: of what each joint moves, and of how far morphs carry them."""

from __future__ import annotations

from itertools import product

import numpy as np

from rigtri.maths.trigonometry import Floats
from rigtri.model.mesh import Mesh

# Where no points can be read: how thick a body is at least, as a share of its longest side.
THICKNESS = 0.1
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


def box_of_joints(bind: Floats) -> tuple[Floats, Floats] | None:
    """The box of the joints of a skin, (m, 4, 4), for points that cannot be read: low and high, (3,).

    None where none of them has a place.
    """
    places = bind[:, 3, :3]
    places = places[np.isfinite(places).all(axis=1)]
    if not len(places):
        return None
    low, high = places.min(axis=0), places.max(axis=0)
    # Joints on a line would not show a twist about it.
    thin = np.maximum(THICKNESS * (high - low).max() - (high - low), 0.0) / 2.0
    return low - thin, high + thin


def extent(mesh: Mesh) -> tuple[Floats, Floats]:
    """How far morphs can carry each point, (v, 3) twice: every target from 0 to 1, all at once.

    The corners of its box where a mesh has one.
    """
    return (mesh.box[:1], mesh.box[1:]) if mesh.box is not None else mesh.morphed()


def corners(low: Floats, high: Floats) -> Floats:
    """The corners of boxes, lows and highs, (r, 3) twice → (r, 8, 3)."""
    return np.where(_HIGH, high[:, np.newaxis], low[:, np.newaxis])
