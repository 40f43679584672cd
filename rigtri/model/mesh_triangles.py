"""The triangles of meshes: which there are, and where a point of one lies nearest.

Polygons are cut into a fan from their first corner, so a face of s corners is s − 2
triangles; triangles are counted through all faces, and through all primitives of a node.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigtri.errors import AmbiguousNameError, FileError, GeometryError, NameNotFoundError
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.triangle import barycentric
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length
from rigtri.model.mesh import Mesh, Surface
from rigtri.model.rig import Rig

# A triangle has no area whose height is below this share of its longest side.
FLAT = 1e-9
# Triangles are equally near whose distances differ by less than this share of the mesh.
_EQUALLY_NEAR = 1e-12


def meshes_named(rig: Rig, name: str) -> list[Mesh]:
    """The primitives of the one node with a mesh that is called so: name, label, path or mesh title.

    ``NODE/2`` is the third primitive of a node alone. Raises NameNotFoundError, AmbiguousNameError,
    and GeometryError where nothing that is drawn can be read.
    """
    if not rig.meshes:
        raise GeometryError("There is no mesh in this file whose vertices can be read")
    called: dict[str, dict[int, None]] = {}
    for mesh in rig.meshes:
        node = mesh.node
        for word in (rig.names[node], rig.labels[node], rig.path(node), mesh.name.rpartition("/")[0]):
            called.setdefault(word, {})[node] = None
    if name in called and name:
        nodes = list(called[name])
        if len(nodes) > 1:
            raise AmbiguousNameError("mesh", name, [rig.labels[node] for node in nodes])
        return [mesh for mesh in rig.meshes if mesh.node == nodes[0]]
    alone = [mesh for mesh in rig.meshes if mesh.name == name]
    if not alone:
        raise NameNotFoundError("mesh", name, [word for word in called if word])
    return alone[:1]


def triangles(mesh: Mesh) -> Integers:
    """The corners of the triangles of a mesh, point indices (t, 3); none for lines and points.

    FileError for faces that cannot be read or name points that are not there.
    """
    surface = mesh.surface_now
    if surface is None:
        raise FileError(f"mesh '{mesh.name}': its faces cannot be read")
    found = _cut(surface)
    if len(found) and not 0 <= int(found.min()) <= int(found.max()) < len(mesh.points):
        raise FileError(f"mesh '{mesh.name}': a face names a vertex that is not there; export it again")
    return found


def _cut(surface: Surface) -> Integers:
    corners = surface.corners
    if surface.kind == "triangles":
        return corners[: len(corners) // 3 * 3].reshape(-1, 3)
    if surface.kind == "triangle strip":
        rows = np.stack([corners[:-2], corners[1:-1], corners[2:]], axis=1)
        # Every second one is wound the other way, so that all faces look the same way.
        return np.asarray(np.where(np.arange(len(rows))[:, np.newaxis] % 2 == 0, rows, rows[:, [1, 0, 2]]))
    if surface.kind == "triangle fan":
        return _fans(np.array([len(corners)]), corners)
    if surface.kind == "Mesh":
        return _fans(surface.sizes, corners)
    return np.zeros((0, 3), dtype=np.int64)


def _fans(sizes: Integers, corners: Integers) -> Integers:
    """Polygons as fans from their first corner, (t, 3)."""
    if (sizes < 0).any() or int(np.add.reduce(sizes)) != len(corners):
        raise FileError("the sizes of faces do not add up to their corners; export the mesh again")
    counts = np.maximum(sizes - 2, 0)
    starts = np.cumsum(sizes) - sizes
    first = np.repeat(starts, counts)
    inside = np.arange(len(first)) - np.repeat(np.cumsum(counts) - counts, counts)
    return np.asarray(corners[np.stack([first, first + inside + 1, first + inside + 2], axis=1)])


def flat(points: Floats) -> Booleans:
    """Which triangles, points (..., 3, 3), have no area; what is not a number has none either."""
    a, b, c = (points[..., k, :] for k in range(3))
    with np.errstate(invalid="ignore", over="ignore"):
        longest = np.maximum(np.maximum(length(b - a), length(c - b)), length(a - c))
        area = length(cross(b - a, c - a))
        return np.asarray(~(area > FLAT * longest * longest))


def nearest(point: Floats, corners: Floats) -> tuple[int, Floats]:
    """The triangle nearest to a point, of (t, 3, 3), and the barycentric weights of its nearest point.

    Flat triangles are passed over; GeometryError where all are. Of equally near ones the first.

    Source: C. Ericson, "Real-Time Collision Detection", §5.1.5.
    """
    usable = np.flatnonzero(~flat(corners))
    if not len(usable):
        raise GeometryError("No triangle of the mesh has an area")
    weights = _nearest_weights(point, corners[usable])
    there = np.zeros((len(usable), 3))
    for k in range(3):
        there = there + weights[:, k, np.newaxis] * corners[usable, k]
    off = length(there - point)
    # On an edge of two triangles rounding alone says which is nearer.
    span = float(np.ptp(corners[usable].reshape(-1, 3), axis=0).max())
    best = int(np.argmax(off <= off.min() + _EQUALLY_NEAR * span))
    return int(usable[best]), weights[best]


def _nearest_weights(p: Floats, corners: Floats) -> Floats:
    """Barycentric weights, (t, 3), of the point of each triangle that is nearest to ``p``."""
    a, b, c = (corners[:, k] for k in range(3))
    inside = barycentric(np.broadcast_to(p, a.shape), a, b, c)
    candidates = [inside]
    for k, (start, end) in enumerate(((a, b), (b, c), (c, a))):
        along = end - start
        share = np.clip(dot(p - start, along) / np.maximum(dot(along, along), 1e-300), 0.0, 1.0)
        weights = np.zeros((len(corners), 3))
        weights[:, k], weights[:, (k + 1) % 3] = 1.0 - share, share
        candidates.append(weights)
    outside = (inside < 0).any(axis=1)
    best, least = inside.copy(), np.where(outside, np.inf, -1.0)
    for weights in candidates[1:]:
        there = weights[:, 0, np.newaxis] * a + weights[:, 1, np.newaxis] * b + weights[:, 2, np.newaxis] * c
        far = length(there - p)
        nearer = far < least
        best, least = np.where(nearer[:, np.newaxis], weights, best), np.where(nearer, far, least)
    return best


def vertices_of(found: Sequence[Integers], vertex: int) -> list[tuple[int, int, int]]:
    """Primitive, triangle and corner of every triangle that has a vertex, the first primitive's first."""
    return [
        (k, int(row), int(column))
        for k, rows in enumerate(found)
        for row, column in np.argwhere(rows == vertex)
    ]
