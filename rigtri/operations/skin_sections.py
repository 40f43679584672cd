"""How wide the skin is around a joint: where the plane of a control's ring cuts the mesh at rest."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rigtri.errors import FileError
from rigtri.evaluation.sampling import morph_weights
from rigtri.evaluation.skinning import deformed
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot, length
from rigtri.model.mesh import Mesh
from rigtri.model.mesh_triangles import triangles
from rigtri.model.rig import Rig

# A vertex with less weight of a joint than this is skin of another.
_OWN = 0.1


@dataclass(frozen=True, eq=False)
class _Skinned:
    """A mesh at rest: its points in the world, (v, 3), and its edges, (e, 2)."""

    mesh: Mesh
    points: Floats
    edges: Integers


class SkinSections:
    """The meshes of a rig at rest, which planes through joints cut."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        world = rig.normalised_world[np.newaxis]
        still = np.zeros(1)
        rest = [deformed(mesh, rig, world, morph_weights(mesh, None, still))[0] for mesh in rig.meshes]
        self.meshes = [
            _Skinned(mesh, points, _edges(mesh))
            for mesh, points in zip(rig.meshes, rest, strict=True)
            if np.isfinite(points).all()
        ]

    def radius(self, joint: int, place: Floats, normal: Floats) -> float:
        """How far from a place, (3,), skin reaches in the plane square to ``normal``, (3,) unit.

        Of the joint, its parent and its children. Where the plane cuts no such skin, how far it reaches from
        the line along the normal; 0 without any skin. File units, in the world.
        """
        cut = whole = 0.0
        for skinned, own in self._of(joint):
            away = skinned.points - place
            height = dot(away, normal)
            flat = away - height[:, np.newaxis] * normal
            whole = max(whole, float(length(flat[own]).max(initial=0.0)))
            one, other = skinned.edges[own[skinned.edges].any(axis=1)].T
            a, b = height[one], height[other]
            crosses = ((a <= 0) & (b > 0)) | ((b <= 0) & (a > 0))
            one, other, a, b = one[crosses], other[crosses], a[crosses], b[crosses]
            share = (a / (a - b))[:, np.newaxis]
            cut = max(cut, float(length(flat[one] + share * (flat[other] - flat[one])).max(initial=0.0)))
        return cut or whole

    def _of(self, joint: int) -> Iterator[tuple[_Skinned, Booleans]]:
        """The meshes that have skin of a joint or of its neighbours, and which vertices of each, (v,)."""
        joints = [joint, int(self.rig.parents[joint]), *self.rig.children[joint]]
        for skinned in self.meshes:
            mesh = skinned.mesh
            if mesh.skin is None or not mesh.joints.shape[1]:
                beside = mesh.node in joints or int(self.rig.parents[mesh.node]) == joint
                own = np.full(len(skinned.points), beside)
            else:
                rows = np.flatnonzero(np.isin(self.rig.skins[mesh.skin].joints, joints))
                own = np.any(np.isin(mesh.joints, rows) & (mesh.weights >= _OWN), axis=1)
            if own.any():
                yield skinned, own


def _edges(mesh: Mesh) -> Integers:
    """The edges of a mesh's triangles, (e, 2); none where its faces cannot be read."""
    try:
        found = triangles(mesh)
    except FileError:
        return np.zeros((0, 2), dtype=np.int64)
    return np.concatenate([found[:, [0, 1]], found[:, [1, 2]], found[:, [2, 0]]])
