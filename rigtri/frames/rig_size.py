"""The size of a rig: the measure to which movements are compared.

Bounds and shares are of the diagonal of the box of all points at rest, where a file has several characters
of those of each.
"""

from __future__ import annotations

from collections.abc import Sequence
from weakref import WeakKeyDictionary, ref

import numpy as np

from rigtri.evaluation.sampling import morph_weights
from rigtri.evaluation.skinning import deformed_parts
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.characters import characters
from rigtri.model.mesh import Mesh, each_place
from rigtri.model.rig import Rig

# The share of its distance from the origin that a character is as large as at least: a chain of some ten
# joints adds up ten roundings of float32, 6e-8 of that distance each.
FAR = 0.1
# The size of each rig with the meshes that it was measured by.
_sizes: WeakKeyDictionary[Rig, tuple[tuple[ref[Mesh], ...], float]] = WeakKeyDictionary()


def size_of(rig: Rig, meshes: Sequence[Mesh]) -> float:
    """The diagonal of the box of all points at rest, in file units; without points, of joints' origins.

    Measured once, as an edit and its check both ask for it.
    """
    known = _sizes.get(rig)
    if known is not None and [one() for one in known[0]] == list(meshes):
        return known[1]
    size = _measured(rig, meshes, rig.normalised_world)
    _sizes[rig] = tuple(map(ref, meshes)), size
    return size


def sizes_of(rig: Rig, meshes: Sequence[Mesh]) -> Floats:
    """What the movement of each node is compared to, (n,), in file units: the size of its character.

    A character is what skins with common joints move, with all that is below these joints. Other nodes have
    the size of the whole.
    """
    sizes, world = np.full(len(rig), size_of(rig, meshes)), rig.normalised_world
    placed = np.array([placing_node(rig, mesh) for mesh in meshes], dtype=np.int64)
    for nodes in characters(rig):
        some = np.zeros(len(rig), dtype=bool)
        some[nodes] = True
        mine = [meshes[k] for k in np.flatnonzero(some[placed]).tolist()]
        if mine and len(mine) == len(meshes):
            continue  # the only one: its size is that of the whole
        low, high = _box(rig, mine, world)
        if not (low <= high).all():
            places = world[nodes, 3, :3]
            low, high = places.min(axis=0), places.max(axis=0)
        with np.errstate(invalid="ignore"):
            far = float(np.maximum(length(low), length(high)))
            size = max(float(length(high - low)), FAR * far)
        if 0.0 < size < sizes[nodes[0]]:
            sizes[nodes] = size
            sizes[[mesh.node for mesh in mine]] = size
    return sizes


def placing_node(rig: Rig, mesh: Mesh) -> int:
    """The node that places a mesh: of a skinned one a joint."""
    skin = None if mesh.skin is None or not mesh.joints.shape[1] else rig.skins[mesh.skin]
    return mesh.node if skin is None or not len(skin.joints) else int(skin.joints[0])


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
    for mesh in each_place(meshes):
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            (morph,) = morph_weights(mesh, None, np.zeros(1))
            for points in deformed_parts(mesh, rig, world, morph):
                if not np.isfinite(points).all():
                    points = points[np.isfinite(points).all(axis=1)]
                low = np.minimum(low, points.min(axis=0, initial=np.inf))
                high = np.maximum(high, points.max(axis=0, initial=-np.inf))
    return low, high
