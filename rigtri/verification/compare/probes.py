"""What is measured while two rigs are compared: points in the frames of nodes, and whole meshes.

A probe gives distances, (r, f), between where it is in one rig and
in the other: rows at times. Verification only, so matrix products are BLAS's.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Sequence
from dataclasses import field, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from rigtri.evaluation import sampling, skinning
from rigtri.frames.rig_size import placing_node
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Clip
from rigtri.model.dataclass import dataclass
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.verification.compare.correspondence import same_array

# Points moved in one matrix product; of a skin with more joints than that, only so many:
# a product has room for each point and each joint of its points.
_CHUNK, _CROWDED, _SMALL_CHUNK = 1024, 256, 64
# Of so many points those that are the same are looked for; of more the search takes too long.
_FEW = 1 << 17


@dataclass(frozen=True, eq=False)
class SampledPoses:
    """Both rigs at some times of one clip: worlds (f, n, 4, 4), and what morphs need."""

    before: Floats
    after: Floats
    clips: tuple[Clip | None, Clip | None]
    times: Floats


class Probe(Protocol):
    """Things whose distance in the two rigs is measured; ``owners`` are the meshes they are of."""

    @property
    def titles(self) -> Sequence[str]: ...
    @property
    def owners(self) -> Sequence[str]: ...
    @property
    def placed(self) -> Integers:
        """The nodes of the first rig that place the rows, (r,)."""

    def distances(self, poses: SampledPoses) -> Floats:
        """(r, f), in file units; inf where only one of the two is a number, NaN where none is."""


@dataclass(frozen=True, eq=False)
class FramePoints:
    """Points fixed in the frames of nodes, before and after: (r, k, 4) homogeneous each."""

    nodes: tuple[Integers, Integers]
    points: tuple[Floats, Floats]
    titles: Sequence[str]
    owners: Sequence[str]

    @property
    def placed(self) -> Integers:
        return self.nodes[0]

    def part(self, rows: Booleans) -> FramePoints:
        """Some rows, (r,), alone."""
        some = np.flatnonzero(rows)
        return replace(
            self,
            nodes=(self.nodes[0][some], self.nodes[1][some]),
            points=(self.points[0][some], self.points[1][some]),
            titles=[self.titles[row] for row in some.tolist()],
            owners=[self.owners[row] for row in some.tolist()],
        )

    def apart(self, poses: SampledPoses) -> Floats:
        """The points' differences, (r, k, 3, f): one matrix product a row and side."""
        mine, theirs = (
            _placed(world.transpose(1, 2, 3, 0)[:, :, :3][nodes], points)
            for world, nodes, points in zip((poses.before, poses.after), self.nodes, self.points, strict=True)
        )
        # The same numbers give the same products, so what is equal is apart by exactly 0.
        with np.errstate(invalid="ignore"):
            mine -= theirs
        return mine

    def distances(self, poses: SampledPoses) -> Floats:
        apart = self.apart(poses)
        with np.errstate(invalid="ignore", over="ignore"):
            distance = np.sqrt(_squares(apart).max(axis=1))
        if np.isfinite(distance).all():
            return np.asarray(distance)
        broken = (
            _broken(world, nodes, points)
            for world, nodes, points in zip((poses.before, poses.after), self.nodes, self.points, strict=True)
        )
        gone = np.logical_and(*broken)
        return np.where(gone, np.nan, np.where(np.isfinite(distance), distance, np.inf))


def in_few(probes: Sequence[Probe], most: int) -> list[Probe]:
    """The same rows in the same order: of points in frames those of neighbours as one probe.

    Each probe costs some dozen calls for each block of times, whatever it holds, and a character may be made
    of a thousand rigid meshes. most: rows of one probe, whose points at all times of a block take memory.
    """
    found: list[list[Probe]] = []
    rows, kind = 0, None
    for probe in probes:
        # What counts from other frames is of a class of its own.
        mine = probe.points[0].shape[1] if type(probe) is FramePoints else None
        rows += len(probe.titles)
        if mine is None or mine != kind or rows > most:
            found.append([])
            rows, kind = len(probe.titles), mine
        found[-1].append(probe)
    return [
        _as_one([p for p in some if isinstance(p, FramePoints)]) if some[1:] else some[0] for some in found
    ]


def _as_one(probes: Sequence[FramePoints]) -> FramePoints:
    """The rows of all of them, which have as many points each."""
    nodes, points = (
        [np.concatenate([pair[side] for pair in pairs]) for side in (0, 1)]
        for pairs in ([probe.nodes for probe in probes], [probe.points for probe in probes])
    )
    return FramePoints(
        (nodes[0], nodes[1]),
        (points[0], points[1]),
        [title for probe in probes for title in probe.titles],
        [owner for probe in probes for owner in probe.owners],
    )


def _placed(world: Floats, points: Floats) -> Floats:
    """Points (r, k, 4) in the frames of rows, (r, 4, 3, f), without last columns → (r, k, 3, f)."""
    rows, times = len(world), world.shape[3]
    with np.errstate(invalid="ignore", over="ignore"):
        placed = points @ world.reshape(rows, 4, 3 * times)
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
class MeshPoints:
    """All points of one mesh in both rigs, moved by the plain evaluation of `rigtri.evaluation.sampling`.

    instances: the titles of others that are in its place in both, a row each.
    """

    rigs: tuple[Rig, Rig]
    meshes: tuple[Mesh, Mesh]
    instances: tuple[str, ...] = field(default=(), kw_only=True)

    @property
    def titles(self) -> Sequence[str]:
        return [f"mesh {owner}" for owner in self.owners]

    @property
    def owners(self) -> Sequence[str]:
        return [mesh_title(self.rigs[0], self.meshes[0]), *self.instances]

    @property
    def placed(self) -> Integers:
        return np.full(1 + len(self.instances), placing_node(self.rigs[0], self.meshes[0]))

    def _rows(self, distances: Floats) -> Floats:
        """Distances, (f,), as those of the mesh and all its instances, (r, f)."""
        return np.broadcast_to(distances, (1 + len(self.instances), len(distances)))

    @cached_property
    def nodes(self) -> tuple[Integers, Integers]:
        """The nodes whose frames move the points, in each rig."""
        mine, theirs = (
            np.array([mesh.node]) if mesh.skin is None else skinning.influences(mesh, rig).nodes
            for rig, mesh in zip(self.rigs, self.meshes, strict=True)
        )
        return mine, theirs

    def distances(self, poses: SampledPoses) -> Floats:
        sides = zip(self.meshes, self.rigs, (poses.before, poses.after), poses.clips, strict=True)
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            mine, theirs = (
                skinning.deformed(mesh, rig, world, sampling.morph_weights(mesh, clip, poses.times))
                for mesh, rig, world, clip in sides
            )
            here, there = (np.isfinite(points).all(axis=2) for points in (mine, theirs))
            distance = np.where(here & there, length(mine - theirs), 0.0)
        distance = np.where(here == there, distance, np.inf)
        seen = np.any(here | there, axis=1) | (not here.shape[1])
        return self._rows(np.where(seen, distance.max(axis=1, initial=0.0), np.nan))


@dataclass(frozen=True, eq=False)
class LinearMeshPoints(MeshPoints):
    """A mesh that is the same in both: while no morph is on, points follow the matrices' difference.

    Linear blending is linear: p·Σ w·M − p·Σ w·M' = Σ (w·p)·(M − M'), one matrix
    product for all points and times, and without cancellation.
    """

    joints: FramePoints
    chunks: tuple[tuple[Integers, Floats], ...]

    def distances(self, poses: SampledPoses) -> Floats:
        apart = self.joints.apart(poses)  # of the four rows of each matrix: (m, 4, 3, f)
        if not np.isfinite(apart).all() or self._morphs(poses):
            return super().distances(poses)
        times = apart.shape[3]
        square = np.zeros(times)
        for columns, weighted in self.chunks:
            moved = weighted @ apart[columns].swapaxes(2, 3).reshape(len(columns) * 4, times * 3)
            moved = moved.reshape(-1, times, 3)
            square = np.maximum(square, np.einsum("vfi,vfi->vf", moved, moved).max(axis=0, initial=0.0))
        return self._rows(np.sqrt(square))

    def _morphs(self, poses: SampledPoses) -> bool:
        sides = zip(self.meshes, poses.clips, strict=True)
        return any(sampling.morph_weights(m, clip, poses.times).any() for m, clip in sides)


def points_of(before: Rig, after: Rig, pairs: Iterable[tuple[Mesh, Mesh]]) -> list[MeshPoints]:
    """`mesh_points` of pairs of meshes; of instances that are in one place in both, once."""
    return [
        replace(mesh_points(before, after, *pair), instances=others)
        for pair, others in in_places(before, pairs)
    ]


def in_places(
    before: Rig, pairs: Iterable[tuple[Mesh, Mesh]]
) -> list[tuple[tuple[Mesh, Mesh], tuple[str, ...]]]:
    """Pairs of meshes, of instances in one place in both the first, each with the titles of the others."""
    places: dict[Hashable, list[tuple[Mesh, Mesh]]] = {}
    for mine, theirs in pairs:
        places.setdefault((mine.moved_as, theirs.moved_as), []).append((mine, theirs))
    return [(pairs[0], tuple(mesh_title(before, a) for a, _ in pairs[1:])) for pairs in places.values()]


def mesh_points(before: Rig, after: Rig, mine: Mesh, theirs: Mesh) -> MeshPoints:
    """All points of a mesh, in the way that is fast for it."""
    rigs, meshes = (before, after), (mine, theirs)
    if mine.dual_quaternion or not same_mesh(mine, theirs):
        return MeshPoints(rigs, meshes)
    skinned = mine.skin is not None and mine.joints.shape[1] > 0
    if not np.isfinite(mine.points).all():
        return MeshPoints(rigs, meshes)
    if skinned:
        with np.errstate(invalid="ignore"):
            found, now = skinning.influences(mine, before), skinning.influences(theirs, after)
        nodes, matrices, joints, weights = (found.nodes, now.nodes), (found.bind, now.bind), *found[:2]
    else:
        nodes = np.array([mine.node]), np.array([theirs.node])
        matrices = np.eye(4)[np.newaxis], np.eye(4)[np.newaxis]
        joints, weights = np.zeros((len(mine.points), 1), dtype=np.int64), np.ones((len(mine.points), 1))
    if not np.isfinite(weights).all():
        return MeshPoints(rigs, meshes)
    if nodes[0].shape != nodes[1].shape:
        return MeshPoints(rigs, meshes)
    rows = FramePoints(nodes, matrices, (), ())
    return LinearMeshPoints(rigs, meshes, rows, tuple(_chunks(mine.points, joints, weights)))


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


def same_mesh(a: Mesh, b: Mesh) -> bool:
    pairs = ((a.points, b.points), (a.joints, b.joints), (a.weights, b.weights), (a.bind, b.bind))
    return (
        a.dual_quaternion == b.dual_quaternion
        and (a.raw_weights == b.raw_weights or skinning.sums_to_one(a) == skinning.sums_to_one(b))
        and (a.skin is None) == (b.skin is None)
        and same_array(a.morphs, b.morphs)
        and all(same_array(x, y) for x, y in pairs)
    )


def mesh_title(rig: Rig, mesh: Mesh) -> str:
    return mesh.name or rig.title(mesh.node)
