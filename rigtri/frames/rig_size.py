"""The size of a rig: the measure to which movements are compared.

Bounds and shares are of the diagonal of the box of all points at rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from weakref import WeakKeyDictionary, ref

import numpy as np

from rigtri.evaluation.sampling import morph_weights
from rigtri.evaluation.skinning import deformed
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig

# The size of each rig with the meshes that it was measured by.
_sizes: WeakKeyDictionary[Rig, tuple[tuple[ref[Mesh], ...], float]] = WeakKeyDictionary()


def size_of(rig: Rig, meshes: Sequence[Mesh], world: Floats | None = None) -> float:
    """The diagonal of the box of all points at rest, in file units; without points, of joints' origins.

    Measured once, as an edit and its check both ask for it. world: (n, 4, 4) at rest, where it is known.
    """
    known = _sizes.get(rig)
    if known is not None and [one() for one in known[0]] == list(meshes):
        return known[1]
    size = _measured(rig, meshes, rig.normalised_world if world is None else world)
    _sizes[rig] = tuple(map(ref, meshes)), size
    return size


def _measured(rig: Rig, meshes: Sequence[Mesh], world: Floats) -> float:
    low, high = _box(rig, meshes, world)
    if not (low <= high).all():
        origins = world[rig.is_joint, 3, :3] if rig.is_joint.any() else world[:, 3, :3]
        origins = origins[np.isfinite(origins).all(axis=1)]
        if not len(origins):
            return 1.0
        low, high = origins.min(axis=0), origins.max(axis=0)
    return float(length(high - low)) or 1.0


def _box(rig: Rig, meshes: Sequence[Mesh], world: Floats) -> tuple[Floats, Floats]:
    """The lows and highs, (3,), of the points of meshes; lows above highs where there are none."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for mesh in meshes:
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            morph = morph_weights(mesh, None, np.zeros(1))
            points = deformed(mesh, rig, world[np.newaxis], morph)[0]
        if not np.isfinite(points).all():
            points = points[np.isfinite(points).all(axis=1)]
        low, high = (
            np.minimum(low, points.min(axis=0, initial=np.inf)),
            np.maximum(high, points.max(axis=0, initial=-np.inf)),
        )
    return low, high


def size_at_least(rig: Rig, meshes: Sequence[Mesh], world: Floats) -> float:
    """No more than `size_of`, nearly always almost as much: by the outermost points of each mesh alone."""
    low, high = _box(rig, [_outermost(mesh) for mesh in meshes], world)
    least = float(length(high - low)) if (low <= high).all() else 0.0
    return least or size_of(rig, meshes, world)


def _outermost(mesh: Mesh) -> Mesh:
    """A mesh of the points that are first and last along an axis alone, six or fewer."""
    if not len(mesh.points):
        return mesh
    columns = [mesh.points[:, axis] for axis in range(3)]
    rows = [int(end) for column in columns for end in (column.argmin(), column.argmax())]
    # A mesh without a skin, or without morphs, may have no rows of these at all.
    joints = mesh.joints[rows] if len(mesh.joints) else mesh.joints
    weights = mesh.weights[rows] if len(mesh.weights) else mesh.weights
    morphs = mesh.morphs[:, rows] if mesh.morphs.size else mesh.morphs
    return replace(mesh, points=mesh.points[rows], joints=joints, weights=weights, morphs=morphs)


def fits(mesh: Mesh, rig: Rig) -> bool:
    """Whether all joints that a mesh names are joints of its skin."""
    if mesh.skin is None:
        return True
    used, _ = mesh.moved
    return not len(used) or 0 <= int(used[0]) <= int(used[-1]) < len(rig.skins[mesh.skin].joints)
