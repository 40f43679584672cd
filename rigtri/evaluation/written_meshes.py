"""Meshes as they will be in the file, where changes of their weights and sizes wait to be written.

Weights that are stored as whole numbers are rounded there, by half a unit at most.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.maths.matrices import multiply, transform_points
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.model.skin_weights import limited, shared


def as_bound_in_file(rig: Rig) -> Rig:
    """The rig with bind poses as float32, which glTF keeps them in, where weights wait to be written.

    So a second run, which reads those, finds the same places.
    """
    if not rig.pending.changes_weights:
        return rig
    skins = (
        replace(skin, inverse_bind=skin.inverse_bind.astype(np.float32).astype(np.float64))
        for skin in rig.skins
    )
    return replace(rig, skins=tuple(skins))


def as_in_file(mesh: Mesh, rig: Rig) -> Mesh:
    """A mesh of the size that its points are to be bound with, and with the weights that the redistributions
    of its skin, and limits, give it."""
    if mesh.skin is not None and mesh.skin in rig.pending.bind_sizes:
        size = np.diag([*rig.pending.bind_sizes[mesh.skin], 1.0])
        mesh = replace(mesh, bind=multiply(mesh.bind, size))
    joints, weights = mesh.joints, mesh.weights
    for redistribution in rig.pending.weight_redistributions if len(joints) else ():
        if redistribution.skin == mesh.skin:
            points = transform_points(mesh.points, mesh.bind)
            joints, weights = shared(redistribution, points, joints, weights)
    for limit in rig.pending.weight_limits if mesh.skin is not None else ():
        if limit.skins is None or mesh.skin in limit.skins:
            joints, weights = limited(joints, weights, limit)
    return mesh if weights is mesh.weights else replace(mesh, joints=joints, weights=weights)
