"""What is watched while two rigs are compared: points in the frames of nodes, or whole meshes.

Each watched thing gives distances, (r, f), between where it is in one rig and
in the other: rows at times. Verification only, so matrix products are BLAS's.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from rigtri.evaluation import sampling, skinning
from rigtri.frames.error_bounds import frames_shown
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.matrices import inverse
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Clip
from rigtri.model.bounding_boxes import boxes, corners, extent
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.verification.compare.correspondence import Matching, same_array

# Where no points can be read: how thick a body is at least, as a share of its longest side.
THICKNESS = 0.1
# Points moved in one matrix product; of a skin with more joints than that, only so many:
# a product has room for each point and each joint of its points.
_CHUNK, _CROWDED, _SMALL_CHUNK = 1024, 256, 64
# Of so many points those that are the same are looked for; of more the search takes too long.
_FEW = 1 << 17


@dataclass(frozen=True, eq=False)
class Moment:
    """Both rigs at some times of one clip: worlds (f, n, 4, 4), and what morphs need."""

    before: Floats
    after: Floats
    clips: tuple[Clip | None, Clip | None]
    times: Floats


class Watched(Protocol):
    """Things whose distance in the two rigs is asked for; ``owners`` are the meshes they are of."""

    @property
    def titles(self) -> Sequence[str]: ...
    @property
    def owners(self) -> Sequence[str]: ...
    @property
    def nodes(self) -> tuple[Integers, Integers]: ...
    def distances(self, moment: Moment) -> Floats:
        """(r, f), in file units; inf where only one of the two is a number."""


@dataclass(frozen=True, eq=False)
class Rows:
    """Points fixed in the frames of nodes, before and after: (r, k, 4) homogeneous each."""

    nodes: tuple[Integers, Integers]
    points: tuple[Floats, Floats]
    titles: Sequence[str]
    owners: Sequence[str]

    def apart(self, moment: Moment) -> Floats:
        """The points' differences, (r, k, 3, f): one matrix product a row and side."""
        mine, theirs = (
            _placed(world.transpose(1, 2, 3, 0)[nodes], points)
            for world, nodes, points in zip(
                (moment.before, moment.after), self.nodes, self.points, strict=True
            )
        )
        # The same numbers give the same products, so what is equal is apart by exactly 0.
        with np.errstate(invalid="ignore"):
            mine -= theirs
        return mine

    def distances(self, moment: Moment) -> Floats:
        apart = self.apart(moment)
        with np.errstate(invalid="ignore", over="ignore"):
            distance = np.sqrt(_squares(apart).max(axis=1))
        if np.isfinite(distance).all():
            return np.asarray(distance)
        broken = (
            _broken(world, nodes, points)
            for world, nodes, points in zip(
                (moment.before, moment.after), self.nodes, self.points, strict=True
            )
        )
        gone = np.logical_and(*broken)
        return np.where(gone, 0.0, np.where(np.isfinite(distance), distance, np.inf))


def _placed(world: Floats, points: Floats) -> Floats:
    """Points (r, k, 4) in the frames of rows, (r, 4, 4, f) → (r, k, 3, f)."""
    rows, times = len(world), world.shape[3]
    with np.errstate(invalid="ignore", over="ignore"):
        placed = points @ world[:, :, :3].reshape(rows, 4, 3 * times)
    return np.asarray(placed.reshape(rows, -1, 3, times))


def _squares(apart: Floats) -> Floats:
    """The squares of the lengths of differences, (..., 3, f) → (..., f); these are overwritten."""
    apart *= apart
    square = apart[..., 0, :] + apart[..., 1, :]
    square += apart[..., 2, :]
    return square


def _broken(world: Floats, nodes: Integers, points: Floats) -> Booleans:
    """Where rows are not a number, (r, f)."""
    moves = np.isfinite(world[:, nodes]).all(axis=(2, 3)).T
    exists = np.isfinite(points).all(axis=(1, 2))
    return ~(moves & exists.reshape(-1, 1))


@dataclass(frozen=True, eq=False)
class Points:
    """All points of one mesh in both rigs, moved by the plain evaluation of `rigtri.evaluation.sampling`."""

    rigs: tuple[Rig, Rig]
    meshes: tuple[Mesh, Mesh]

    @property
    def titles(self) -> Sequence[str]:
        return [f"mesh {mesh_title(self.rigs[0], self.meshes[0])}"]

    @property
    def owners(self) -> Sequence[str]:
        return [mesh_title(self.rigs[0], self.meshes[0])]

    @property
    def nodes(self) -> tuple[Integers, Integers]:
        none = np.zeros(0, dtype=np.int64)
        return none, none

    def distances(self, moment: Moment) -> Floats:
        sides = zip(self.meshes, self.rigs, (moment.before, moment.after), moment.clips, strict=True)
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            mine, theirs = (
                skinning.deformed(mesh, rig, world, sampling.morph_weights(mesh, clip, moment.times))
                for mesh, rig, world, clip in sides
            )
            here, there = (np.isfinite(points).all(axis=2) for points in (mine, theirs))
            distance = np.where(here & there, length(mine - theirs), 0.0)
        distance = np.where(here == there, distance, np.inf)
        return np.asarray(distance.max(axis=1, initial=0.0).reshape(1, -1))


@dataclass(frozen=True, eq=False)
class LinearPoints(Points):
    """A mesh that is the same in both: while no morph is on, points follow the matrices' difference.

    Linear blending is linear: p·Σ w·M − p·Σ w·M' = Σ (w·p)·(M − M'), one matrix
    product for all points and times, and without cancellation.
    """

    joints: Rows
    chunks: tuple[tuple[Integers, Floats], ...]

    def distances(self, moment: Moment) -> Floats:
        apart = self.joints.apart(moment)  # of the four rows of each matrix: (m, 4, 3, f)
        if not np.isfinite(apart).all() or self._morphs(moment):
            return super().distances(moment)
        times = apart.shape[3]
        square = np.zeros(times)
        for columns, weighted in self.chunks:
            moved = weighted @ apart[columns].swapaxes(2, 3).reshape(len(columns) * 4, times * 3)
            moved = moved.reshape(-1, times, 3)
            square = np.maximum(square, np.einsum("vfi,vfi->vf", moved, moved).max(axis=0, initial=0.0))
        return np.sqrt(square).reshape(1, -1)

    def _morphs(self, moment: Moment) -> bool:
        sides = zip(self.meshes, moment.clips, strict=True)
        return any(sampling.morph_weights(m, clip, moment.times).any() for m, clip in sides)


def points_of(before: Rig, after: Rig, mine: Mesh, theirs: Mesh) -> Points:
    """All points of a mesh, in the way that is fast for it."""
    rigs, meshes = (before, after), (mine, theirs)
    if mine.dual_quaternion or not same_mesh(mine, theirs):
        return Points(rigs, meshes)
    skinned = mine.skin is not None and mine.joints.shape[1] > 0
    weights = skinning.normalised_weights(mine.weights) if skinned else np.ones((len(mine.points), 1))
    if not (np.isfinite(weights).all() and np.isfinite(mine.points).all()):
        return Points(rigs, meshes)
    if skinned:
        skins = [rig.skins[mesh.skin or 0] for rig, mesh in zip(rigs, meshes, strict=True)]
        nodes = skins[0].joints, skins[1].joints
        with np.errstate(invalid="ignore"):
            matrices = mine.bind @ skins[0].inverse_bind, theirs.bind @ skins[1].inverse_bind
        joints = mine.joints
    else:
        nodes = np.array([mine.node]), np.array([theirs.node])
        matrices = np.eye(4)[np.newaxis], np.eye(4)[np.newaxis]
        joints = np.zeros((len(mine.points), 1), dtype=np.int64)
    if nodes[0].shape != nodes[1].shape:
        return Points(rigs, meshes)
    rows = Rows(nodes, matrices, (), ())
    return LinearPoints(rigs, meshes, rows, tuple(_chunks(mine.points, joints, weights)))


def _chunks(points: Floats, joints: Integers, weights: Floats) -> Iterator[tuple[Integers, Floats]]:
    """Points in chunks with their joints and weight·(p, 1) by joint, (v, joints·4)."""
    joints = np.where(weights != 0, joints, 0)
    if len(points) <= _FEW:
        # Points are stored again for each normal and texture place: what moves alike is moved once.
        rows = np.unique(np.concatenate([joints, weights, points], axis=1), axis=0)
        joints, weights, points = np.split(rows, [joints.shape[1], 2 * joints.shape[1]], axis=1)
        joints = joints.astype(np.int64)
    heaviest = np.argmax(np.abs(weights), axis=1)
    order = np.argsort(joints[np.arange(len(points)), heaviest], kind="stable")
    size = _CHUNK if joints.max(initial=0) < _CROWDED else _SMALL_CHUNK
    for start in range(0, len(points), size):
        mine = order[start : start + size]
        used = weights[mine] != 0
        columns, inside = np.unique(joints[mine], return_inverse=True)
        inside = inside.reshape(used.shape)
        share = np.zeros((len(mine), len(columns)))
        for column in range(used.shape[1]):
            share[np.arange(len(mine)), inside[:, column]] += weights[mine, column]
        full = np.concatenate([points[mine], np.ones((len(mine), 1))], axis=1)
        yield columns, (share[:, :, np.newaxis] * full[:, np.newaxis, :]).reshape(len(mine), -1)


def skin_corners(
    before: Rig, after: Rig, m: Matching, meshes: Sequence[Mesh], moving: Booleans
) -> Iterator[Rows]:
    """The corners of what each joint moves, and the joint's own place in the bind pose."""
    for number, partner in enumerate(m.skin.tolist()):
        if partner < 0:
            continue
        mine, theirs = before.skins[number], _without_holders(after, partner, m)
        if len(theirs.joints) < len(mine.joints):
            continue
        count = len(mine.joints)
        joints = theirs.joints[:count]
        same = np.array_equal(mine.inverse_bind, theirs.inverse_bind[:count], equal_nan=True)
        differ = moving[mine.joints] | (m.node[mine.joints] != joints)
        if not same:
            differ |= (mine.inverse_bind != theirs.inverse_bind[:count]).any(axis=(1, 2))
        if not differ.any():
            continue
        owner = mine.name or f"skin #{number}"
        own = np.isin(mine.joints, list(before.own)) if before.own else np.zeros(count, dtype=bool)
        for bind, low, high in _skin_boxes(mine, [x for x in meshes if x.skin == number]):
            # A joint of ours may move, but not what somebody has bound to it.
            rows = np.flatnonzero(differ & ~(own & ~np.isfinite(low).all(axis=1)))
            if not len(rows):
                continue
            titles = [f"joint {before.title(joint)}" for joint in mine.joints[rows].tolist()]
            points = _with_bind_origin(_corners(low[rows], high[rows]), bind, mine.bind[rows])
            with np.errstate(invalid="ignore"):
                moved = tuple(points @ bind @ s.inverse_bind[rows] for s in (mine, theirs))
            yield Rows((mine.joints[rows], joints[rows]), (moved[0], moved[1]), titles, [owner] * len(rows))


def _without_holders(after: Rig, skin: int, m: Matching) -> Skin:
    """A skin without the rows of joints that a split has put into it."""
    whole, added = after.skins[skin], sorted(after.holders.difference(m.node.tolist()))
    if not added:
        return whole
    keep = ~np.isin(whole.joints, added)
    if keep.all():
        return whole
    return replace(whole, joints=whole.joints[keep], inverse_bind=whole.inverse_bind[keep])


def _with_bind_origin(points: Floats, bind: Floats, frames: Floats) -> Floats:
    """Corners, (r, 8, 4), and each joint's place in the bind pose; that alone where there is no box.

    bind: of the mesh, (4, 4). frames: of the joints, seen from the skin, (r, 4, 4).
    """
    place = frames[:, 3] @ inverse(bind)
    place = np.where(np.isfinite(place).all(axis=1, keepdims=True), place, [0.0, 0.0, 0.0, 1.0])
    full = np.isfinite(points).all(axis=(1, 2)).reshape(-1, 1, 1)
    points = np.where(full, points, place[:, np.newaxis])
    return np.concatenate([points, place[:, np.newaxis]], axis=1)


def _skin_boxes(skin: Skin, meshes: Sequence[Mesh]) -> Iterator[tuple[Floats, Floats, Floats]]:
    """For each bind matrix of the meshes: it, and the boxes of what each joint moves, (m, 3) twice.

    Meshes that share their bind matrix share their boxes. inf where a joint moves nothing.
    """
    if not meshes:
        places = skin.bind[:, 3, :3]
        places = places[np.isfinite(places).all(axis=1)]
        if len(places):
            shape = (len(skin.joints), 3)
            low, high = places.min(axis=0), places.max(axis=0)
            # Joints on a line would not show a twist about it.
            thin = np.maximum(THICKNESS * (high - low).max() - (high - low), 0.0) / 2.0
            yield np.eye(4), np.broadcast_to(low - thin, shape), np.broadcast_to(high + thin, shape)
        return
    groups: dict[bytes, list[Mesh]] = {}
    for mesh in meshes:
        groups.setdefault(mesh.bind.tobytes(), []).append(mesh)
    for group in groups.values():
        found = [boxes(mesh, len(skin.joints)) for mesh in group]
        low = np.minimum.reduce([box[0] for box in found])
        high = np.maximum.reduce([box[1] for box in found])
        yield group[0].bind, low, high


def _corners(low: Floats, high: Floats) -> Floats:
    """The corners of boxes, (r, 3) twice → (r, 8, 4) homogeneous."""
    points = np.ones((len(low), 8, 4))
    points[..., :3] = corners(low, high)
    return points


def rigid_corners(before: Rig, m: Matching, meshes: Sequence[Mesh], moving: Booleans) -> Iterator[Rows]:
    """The corners of the boxes of rigid meshes, in the frames of the nodes that show them."""
    for mesh in meshes:
        if (mesh.skin is not None and mesh.joints.shape[1]) or not _to_watch(mesh.node, m, moving):
            continue
        near, far = extent(mesh)
        fit = np.isfinite(near).all(axis=1) & np.isfinite(far).all(axis=1)
        if fit.any():
            low, high = near[fit].min(axis=0), far[fit].max(axis=0)
            title = mesh_title(before, mesh)
            yield _framed(
                [mesh.node], m, _corners(low[np.newaxis], high[np.newaxis]), [f"mesh {title}"], [title]
            )


def frames(
    before: Rig, m: Matching, meshes: Sequence[Mesh], moving: Booleans, diagonal: float
) -> Iterator[Rows]:
    """The whole frames, a diagonal long, of what is no mesh: cameras, lights and such not ours."""
    nodes = [node for node in frames_shown(before, meshes) if _to_watch(node, m, moving)]
    if nodes:
        titles = [f"frame of {before.title(node)}" for node in nodes]
        yield _framed(nodes, m, _whole(before, nodes, diagonal), titles, [""] * len(nodes))


def own_frames(before: Rig, m: Matching, moving: Booleans, diagonal: float) -> Iterator[Rows]:
    """The whole frames, a diagonal long, of what rigtri itself has added."""
    nodes = [node for node in sorted(before.own) if m.node[node] >= 0 and moving[node]]
    if nodes:
        titles = [f"frame of {before.title(node)}" for node in nodes]
        points = _whole(before, nodes, diagonal)
        yield Rows((np.array(nodes), m.node[nodes]), (points, points), titles, [""] * len(nodes))


def bare_frames(
    before: Rig, m: Matching, meshes: Sequence[Mesh], moving: Booleans, diagonal: float
) -> Iterator[Rows]:
    """The ends of the axes of nodes that show no mesh and have none below them, nor are rigtri's own.

    They tell turns; as far away as what hangs on each node, a twentieth of the diagonal at least.
    """
    unseen = ~_drawn(before, meshes) & moving & (m.node >= 0)
    unseen[list(before.own)] = False
    nodes = np.flatnonzero(unseen).tolist()
    if nodes:
        reach = _reaches(before, 0.05 * diagonal)[nodes]
        axes = length(before.world[nodes, :3, :3])
        with np.errstate(divide="ignore", invalid="ignore"):
            far = reach[:, np.newaxis] / axes
        ends = np.where(np.isfinite(far), far, 0.0)[:, np.newaxis] * np.eye(3)
        points = np.concatenate([ends, np.ones((len(nodes), 3, 1))], axis=2)
        titles = [f"turn of {before.title(node)}" for node in nodes]
        yield Rows((np.array(nodes), m.node[nodes]), (points, points), titles, [""] * len(nodes))


def _drawn(rig: Rig, meshes: Sequence[Mesh]) -> Booleans:
    """Which nodes move points of meshes, (n,), or have a node below them that does."""
    found = np.zeros(len(rig), dtype=bool)
    read = {mesh.skin for mesh in meshes}
    for number, skin in enumerate(rig.skins):
        if number not in read:  # all of its joints are watched
            found[skin.joints] = True
    for mesh in meshes:
        if mesh.skin is None or not mesh.joints.shape[1]:
            found[mesh.node] = True
        else:
            joints = rig.skins[mesh.skin].joints
            found[joints if mesh.box is not None else joints[np.unique(mesh.joints[mesh.weights != 0])]] = (
                True
            )
    for node in range(len(rig) - 1, -1, -1):
        if found[node] and rig.parents[node] >= 0:
            found[rig.parents[node]] = True
    return found


def _reaches(rig: Rig, least: float) -> Floats:
    """How far what hangs on each node reaches at rest, (n,), in file units."""
    places, found = rig.world[:, 3, :3], np.full(len(rig), least)
    for node in range(len(rig) - 1, -1, -1):
        parent = int(rig.parents[node])
        if parent >= 0:
            bone = float(np.nan_to_num(length(places[node] - places[parent])))
            found[parent] = max(found[parent], found[node] + bone)
    return found


def _whole(rig: Rig, nodes: Sequence[int], diagonal: float) -> Floats:
    """The corners of frames a diagonal long, (r, 8, 4); of what has no size at rest, its place."""
    axes = length(rig.world[nodes, :3, :3])
    with np.errstate(divide="ignore", invalid="ignore"):
        size = diagonal / axes
    size = np.where(np.isfinite(size), size, 0.0)
    return _corners(-size, size)


def _to_watch(node: int, m: Matching, moving: Booleans) -> bool:
    there = m.shown[node]
    return bool(there >= 0 and (moving[node] or there != m.node[node]))


def _framed(nodes: Sequence[int], m: Matching, points: Floats, titles: list[str], owners: list[str]) -> Rows:
    return Rows((np.array(nodes), m.shown[nodes]), (points, points), titles, owners)


def origins(before: Rig, m: Matching, moving: Booleans) -> Rows:
    """Where nodes are; what rigtri itself has added may move."""
    watched = moving & (m.node >= 0)
    watched[list(before.own)] = False
    nodes = np.flatnonzero(watched)
    points = np.broadcast_to([0.0, 0.0, 0.0, 1.0], (len(nodes), 1, 4))
    titles = [f"origin of {before.title(node)}" for node in nodes.tolist()]
    return Rows((nodes, m.node[nodes]), (points, points), titles, [""] * len(nodes))


def same_mesh(a: Mesh, b: Mesh) -> bool:
    pairs = ((a.points, b.points), (a.joints, b.joints), (a.weights, b.weights), (a.bind, b.bind))
    return (
        a.dual_quaternion == b.dual_quaternion
        and (a.skin is None) == (b.skin is None)
        and same_array(a.morphs, b.morphs)
        and all(same_array(x, y) for x, y in pairs)
    )


def mesh_title(rig: Rig, mesh: Mesh) -> str:
    return mesh.name or rig.title(mesh.node)
