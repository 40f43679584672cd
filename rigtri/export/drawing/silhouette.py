"""The outline of a character: what its meshes cover in the picture, as few smooth loops.

The triangles are laid on a grid of cells, and the edge of the covered cells is followed; so it costs
the same for a hundred points and for a million, and any number of meshes becomes one shape.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from rigtri.errors import FileError
from rigtri.evaluation import sampling, skinning
from rigtri.evaluation.timelines import Timeline
from rigtri.export.drawing.scene import Scene
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.matrices import multiply, transform_points
from rigtri.maths.trigonometry import Floats
from rigtri.model.mesh import Mesh
from rigtri.model.mesh_triangles import triangles
from rigtri.model.rig import Rig

# Points on a triangle are laid this share of a cell apart; one with a side of more than 2^_MOST parts is
# filled cell by cell.
_STEP, _MOST = 0.75, 6
# Points laid at a time: what they need of memory stays below 25 MB.
_AT_ONCE = 250_000
# Triangles filled before what they hide is looked for.
_FILLED = 4096
# Cells: more than the rounding of a point that is laid on a side of a triangle.
_ROUNDED = 1e-6
# Corners of a loop that are off the straight line by less, in cells, are left out.
_SMOOTH = 0.7
# How often the corners of a loop are moved towards their neighbours before.
_ROUNDS = 4
# Loops around fewer cells are specks.
_SPECK = 6

Patch = tuple[Floats, Integers]


def patches(scene: Scene, timeline: Timeline | None, time: float) -> list[Patch]:
    """The meshes of a scene in its pose: points (v, 3) of the world, and triangles (t, 3).

    Of a rig with joints those that move with them: a floor or a room is no part of a character.
    """
    rig = scene.rig
    jointed = bool(rig.is_joint.any())
    found = []
    for mesh in rig.meshes:
        if jointed and mesh.skin is None and not _jointed(rig, mesh.node):
            continue
        clip = None if timeline is None else timeline.clip
        points = _placed(mesh, scene, sampling.morph_weights(mesh, clip, np.array([time]))[0])
        try:
            faces = triangles(mesh)
        except FileError:  # the points still show where the mesh is
            faces = np.zeros((0, 3), dtype=np.int64)
        fine = np.asarray(np.isfinite(points).all(axis=1))
        if not len(faces):
            alone = np.flatnonzero(fine)
            faces = np.stack([alone, alone, alone], axis=1)
        found.append((points, faces[fine[faces].all(axis=1)]))
    return found


def _jointed(rig: Rig, node: int) -> bool:
    """Whether a node is, or is below, a joint."""
    joint: list[bool] = rig.is_joint.tolist()
    while node >= 0 and not joint[node]:
        node = int(rig.parents[node])
    return node >= 0


def _placed(mesh: Mesh, scene: Scene, morph: Floats) -> Floats:
    """The points of a mesh in the world, (v, 3), one operation after the other: the same bits everywhere.

    Blended linearly, whatever the mesh asks for: an outline shows no difference.
    """
    points = mesh.points
    for share, offsets in zip(morph.tolist(), mesh.morphs, strict=False):
        points = points + offsets * share if share else points
    if mesh.skin is None or not mesh.joints.shape[1]:
        return transform_points(points, scene.world[mesh.node])
    known = (mesh.joints >= 0) & (mesh.joints < len(scene.rig.skins[mesh.skin].joints))
    found = replace(mesh, joints=np.where(known, mesh.joints, 0), weights=np.where(known, mesh.weights, 0.0))
    joints, weights, nodes, bind = skinning.influences(found, scene.rig)
    matrices = multiply(bind, scene.world[nodes])
    placed = np.zeros(points.shape)
    for column in range(weights.shape[1]):
        live = np.flatnonzero(weights[:, column])
        through = transform_points(points[live], matrices[joints[live, column]])
        placed[live] += through * weights[live, column, np.newaxis]
    return placed


def outline(found: Sequence[Patch], flat: Callable[[Floats], Floats], wide: int, high: int) -> list[Floats]:
    """The edge of what is covered, loops (k, 2), in cells of a grid; ``flat`` takes points there."""
    covered = np.zeros((high, wide), dtype=bool)
    for corners in _blocks(found, flat):
        _cover(covered, corners)
    return [loop for loop in map(_smoothed, _loops(_closed(covered))) if len(loop) > 2]


def _blocks(found: Sequence[Patch], flat: Callable[[Floats], Floats]) -> Iterator[Floats]:
    """The triangles of all meshes, (t, 3, 2) in cells: small meshes together, large ones in parts."""
    kept, count = list[Floats](), 0
    for points, faces in found:
        seen = flat(points)
        for first in range(0, len(faces), _AT_ONCE):
            kept.append(seen[faces[first : first + _AT_ONCE]])
            count += len(kept[-1])
            if count >= _AT_ONCE:
                yield np.concatenate(kept)
                kept, count = [], 0
    if kept:
        yield np.concatenate(kept)


def _cover(covered: Booleans, corners: Floats) -> None:
    """Mark the cells that triangles, (t, 3, 2), lie on; those of a size are laid with points together."""
    low, high = corners.min(axis=1), corners.max(axis=1)
    inside = ((high >= 0) & (low < covered.shape[::-1])).all(axis=1)
    corners, low, high = corners[inside], low[inside], high[inside]
    parts = np.maximum(np.ceil((high - low).max(axis=1) / _STEP), 1)
    for some in _parts(np.flatnonzero(parts > 2**_MOST), _FILLED):
        some = some[_open(covered, low[some], high[some])]
        _fill(covered, corners[some], low[some], high[some])
    for power in range(_MOST + 1):
        count = 2**power
        rows, columns = np.divmod(np.arange((count + 1) ** 2), count + 1)
        along, across = rows[rows + columns <= count] / count, columns[rows + columns <= count] / count
        chosen = np.flatnonzero((parts <= count) & (parts > count // 2))
        for some in _parts(chosen, max(1, _AT_ONCE // len(along))):
            some = some[_open(covered, low[some], high[some])]
            _mark(covered, *(_laid(corners[some, :, k], along, across) for k in range(2)))


def _parts(chosen: Integers, most: int) -> Iterator[Integers]:
    return (chosen[first : first + most] for first in range(0, len(chosen), most))


def _laid(corners: Floats, along: Floats, across: Floats) -> Floats:
    """One coordinate of points on triangles, of their (t, 3), at shares of two sides, (k,): (t k,)."""
    a, b, c = (corners[:, k, np.newaxis] for k in range(3))
    return np.asarray(a + (b - a) * along + (c - a) * across).reshape(-1)


def _open(covered: Booleans, low: Floats, high: Floats) -> Booleans:
    """Whether a cell in the box of a triangle is not covered yet, (t,): most triangles lie behind others."""
    room = covered.shape[::-1]
    left, top = np.floor(np.clip(low - _ROUNDED, 0, room)).astype(np.int64).T
    right, bottom = np.ceil(np.clip(high + _ROUNDED, 0, room)).astype(np.int64).T
    # How many cells above and left of each corner of the grid are covered.
    below = np.zeros((room[1] + 1, room[0] + 1), dtype=np.int64)
    np.cumsum(np.cumsum(covered, axis=0, dtype=np.int64), axis=1, out=below[1:, 1:])
    count = below[bottom, right] - below[top, right] - below[bottom, left] + below[top, left]
    return np.asarray(count < (right - left) * (bottom - top))


def _fill(covered: Booleans, corners: Floats, low: Floats, high: Floats) -> None:
    """Mark the cells whose middle lies in a triangle, of (t, 3, 2), between ``low`` and ``high``, (t, 2)."""
    room = covered.shape[::-1]
    first = np.floor(np.clip(low, 0, room)).astype(np.int64).tolist()
    behind = np.ceil(np.clip(high, 0, room)).astype(np.int64).tolist()
    for triangle, (left, top), (right, bottom) in zip(corners.tolist(), first, behind, strict=True):
        cells = covered[top:bottom, left:right]
        rows, columns = np.nonzero(~cells)  # few, where a mesh has many triangles of this size
        x, y = columns + (left + 0.5), rows + (top + 0.5)
        sides = []
        for k in range(3):
            (ax, ay), (bx, by) = triangle[k], triangle[(k + 1) % 3]
            sides.append((bx - ax) * (y - ay) - (by - ay) * (x - ax))
        one, two, three = sides
        within = ((one >= 0) & (two >= 0) & (three >= 0)) | ((one <= 0) & (two <= 0) & (three <= 0))
        cells[rows[within], columns[within]] = True


def _mark(covered: Booleans, x: Floats, y: Floats) -> None:
    high, wide = covered.shape
    inside = (x >= 0) & (x < wide) & (y >= 0) & (y < high)
    covered[y[inside].astype(np.int64), x[inside].astype(np.int64)] = True


def _closed(covered: Booleans) -> Booleans:
    """Without pin-holes: a cell counts with at least five covered ones around it."""
    padded = np.pad(covered, 1).astype(np.int64)
    rows, columns = covered.shape
    around = sum(
        padded[1 + y : 1 + y + rows, 1 + x : 1 + x + columns]
        for y in (-1, 0, 1)
        for x in (-1, 0, 1)
        if (x, y) != (0, 0)
    )
    return np.asarray(covered | (around >= 5))


def _loops(covered: Booleans) -> Iterator[Floats]:
    """The edges of covered cells as loops of corners, (k, 2), covered cells on one side."""
    ends: dict[tuple[int, int], list[tuple[int, int]]] = {}
    padded = np.pad(covered, 1)
    here = padded[1:-1, 1:-1]
    # For each side of a cell: the cell beyond it, and where the edge begins and ends.
    for beyond, start, end in (
        (padded[:-2, 1:-1], (0, 0), (1, 0)),
        (padded[1:-1, 2:], (1, 0), (1, 1)),
        (padded[2:, 1:-1], (1, 1), (0, 1)),
        (padded[1:-1, :-2], (0, 1), (0, 0)),
    ):
        for y, x in np.argwhere(here & ~beyond).tolist():
            ends.setdefault((x + start[0], y + start[1]), []).append((x + end[0], y + end[1]))
    while ends:
        first = min(ends)
        loop = [first]
        while True:
            ways = ends[loop[-1]]
            step = ways.pop()
            if not ways:
                del ends[loop[-1]]
            if step == first:
                break
            loop.append(step)
        corners = np.array(loop, dtype=np.float64)
        if _area(corners) >= _SPECK:
            yield corners


def _area(loop: Floats) -> float:
    x, y = loop[:, 0], loop[:, 1]
    return abs(float(np.add.reduce(x * np.roll(y, -1) - np.roll(x, -1) * y))) / 2


def _smoothed(loop: Floats) -> Floats:
    """A loop without its staircase: the middles of its edges, and of those the ones that matter."""
    middles = (loop + np.roll(loop, -1, axis=0)) / 2
    for _ in range(_ROUNDS):
        middles = (np.roll(middles, 1, axis=0) + 2.0 * middles + np.roll(middles, -1, axis=0)) / 4
    far = int(np.argmax(_far(middles, middles[:1], middles[:1])))
    halves = (middles[: far + 1], np.concatenate([middles[far:], middles[:1]]))
    return np.concatenate([_fewer(half)[:-1] for half in halves])


def _fewer(line: Floats) -> Floats:
    """The corners of a line, (k, 2), that are off the straight way, by Douglas and Peucker's rule."""
    keep, todo = {0, len(line) - 1}, [(0, len(line) - 1)]
    while todo:
        start, end = todo.pop()
        if end - start < 2:
            continue
        off = _far(line[start + 1 : end], line[start : start + 1], line[end : end + 1])
        worst = start + 1 + int(np.argmax(off))
        if off[worst - start - 1] > _SMOOTH:
            keep.add(worst)
            todo += [(start, worst), (worst, end)]
    return line[sorted(keep)]


def _far(points: Floats, start: Floats, end: Floats) -> Floats:
    """How far points are from a line, or from its start where it has no length, (k,)."""
    along = end - start
    size = np.sqrt(along[:, 0] * along[:, 0] + along[:, 1] * along[:, 1])
    off = points - start
    if not size[0] > 0:
        return np.asarray(np.sqrt(off[:, 0] * off[:, 0] + off[:, 1] * off[:, 1]))
    return np.asarray(np.abs(off[:, 0] * along[:, 1] - off[:, 1] * along[:, 0]) / size)
