"""The points of a mesh that an edit has changed: others, or moved by others; all else of it stays behind."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.trigonometry import Floats
from rigtri.model.mesh import Mesh


def changed_points(mesh: Mesh, other: Mesh, nodes: tuple[Integers, Integers] | None = None) -> Booleans:
    """Which points of a mesh are others now, or have other influences, (v,).

    nodes: the joints of its skin in each, by numbers that mean the same. None where their rows do.
    """
    alike = mesh.points.shape == other.points.shape and mesh.morphs.shape == other.morphs.shape
    if not alike or (mesh.skin is None) != (other.skin is None):
        return np.ones(len(mesh.points), dtype=bool)
    changed: Booleans = (mesh.points != other.points).any(axis=1)
    if len(mesh.morphs):
        changed |= (mesh.morphs != other.morphs).any(axis=(0, 2))
    width = max(mesh.joints.shape[1], other.joints.shape[1])
    if mesh.skin is None or not width:  # a rigid mesh has no influences
        return changed
    mine, theirs = (None, None) if nodes is None else nodes
    was, now = _influences(mesh, mine, width), _influences(other, theirs, width)
    changed |= (was[0] != now[0]).any(axis=1) | (was[1] != now[1]).any(axis=1)
    return changed


def _influences(mesh: Mesh, nodes: Integers | None, width: int) -> tuple[Integers, Floats]:
    """What moves each point, (v, width), −1 where it has no weight; and the weights."""
    joints = mesh.joints if nodes is None else nodes[mesh.joints]
    beyond = (0, 0), (0, width - mesh.joints.shape[1])
    moving = np.where(mesh.weights != 0, joints, -1)
    return np.pad(moving, beyond, constant_values=-1), np.pad(mesh.weights, beyond)


def some_points(mesh: Mesh, rows: Booleans) -> Mesh:
    """Some points of a mesh as a mesh; its faces stay behind."""
    return replace(
        mesh,
        surface=None,
        points=mesh.points[rows],
        joints=mesh.joints[rows],
        weights=mesh.weights[rows],
        morphs=mesh.morphs[:, rows] if len(mesh.morphs) else mesh.morphs,
    )
