"""Boxes of the points of a mesh: of what each joint moves, and of how far morphs carry them."""

from __future__ import annotations

from itertools import product

import numpy as np

from rigtri.maths.arrays import runs
from rigtri.maths.trigonometry import Floats
from rigtri.model.mesh import Mesh

# Which of low and high each corner takes, along each axis.
_HIGH = np.array(list(product((False, True), repeat=3)))


def boxes(mesh: Mesh, count: int) -> tuple[Floats, Floats]:
    """The boxes of the points that each of ``count`` joints moves, lows and highs, (count, 3)."""
    if mesh.box is not None:
        return np.broadcast_to(mesh.box[0], (count, 3)), np.broadcast_to(mesh.box[1], (count, 3))
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    near, far = extent(mesh)
    joints, points = mesh.moved
    if not np.isfinite(near).all():
        live = np.asarray(np.isfinite(near).all(axis=1))[points]
        joints, points = joints[live], points[live]
    if not len(joints):
        return low, high
    starts = runs(joints)
    for axis in range(3):
        lows = near[:, axis][points]
        highs = lows if far is near else far[:, axis][points]
        low[joints[starts], axis] = np.minimum.reduceat(lows, starts)
        high[joints[starts], axis] = np.maximum.reduceat(highs, starts)
    return low, high


def extent(mesh: Mesh) -> tuple[Floats, Floats]:
    """How far morphs can carry each point, (v, 3) twice: every target from 0 to 1, all at once.

    The corners of its box where a mesh has one.
    """
    if mesh.box is not None:
        return mesh.box[:1], mesh.box[1:]
    if not mesh.morphs.size:
        return mesh.points, mesh.points
    lows = np.minimum(mesh.morph_weights, 0.0) if len(mesh.morph_weights) else np.zeros(len(mesh.morphs))
    highs = np.maximum(mesh.morph_weights, 1.0) if len(mesh.morph_weights) else np.ones(len(mesh.morphs))
    near, far = mesh.points.copy(), mesh.points.copy()
    for low, high, offsets in zip(lows, highs, mesh.morphs, strict=True):
        near += np.minimum(low * offsets, high * offsets)
        far += np.maximum(low * offsets, high * offsets)
    return near, far


def corners(low: Floats, high: Floats) -> Floats:
    """The corners of boxes, lows and highs, (r, 3) twice → (r, 8, 3)."""
    return np.where(_HIGH, high[:, np.newaxis], low[:, np.newaxis])
