"""Some points of a mesh at many times, with the nodes alone that move them."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from rigtri.evaluation.sampling import Motion, sample, worlds
from rigtri.evaluation.skinning import Influences, blended, influences
from rigtri.evaluation.timelines import Timeline
from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import inverse, multiply, transform_points
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track
from rigtri.model.dataclass import dataclass
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig

# Matrices evaluated at once: 64 bytes times nodes times this.
_BLOCK = 1 << 15


@dataclass(frozen=True, eq=False)
class SkinnedPoints:
    """Points ``rows`` of ``mesh``, seen from a node ``parent`` (−1: the world); few points, many times.

    Only the nodes that move these points are evaluated.
    """

    rig: Rig
    mesh: Mesh
    rows: Integers
    parent: int = -1

    @cached_property
    def _influences(self) -> Influences:
        """What moves the points, by the nodes of the rig that do so."""
        mesh = self.mesh
        found = influences(
            replace(mesh, joints=mesh.joints[self.rows], weights=mesh.weights[self.rows]), self.rig
        )
        weighs = found.weights != 0
        used = np.unique(found.joints[weighs])
        joints = np.where(weighs, np.searchsorted(used, found.joints), 0)
        return Influences(joints, found.weights, found.nodes[used], found.bind[used])

    @cached_property
    def nodes(self) -> list[int]:
        """The nodes whose motion moves the points, or the parent that they are seen from."""
        own: list[int] = self._influences.nodes.tolist() if self._skinned else [self.mesh.node]
        return sorted(self.rig.with_ancestors([*own, self.parent]))

    @cached_property
    def _part(self) -> tuple[Rig, dict[int, int]]:
        """A rig of these nodes alone, and the number of each in it."""
        return replace(self.rig, clips=()).subset(self.nodes)

    @property
    def _normalised(self) -> bool:
        """Whether viewers of the file make rotations unit."""
        return not self.rig.rules.raw_quaternions

    @property
    def _skinned(self) -> bool:
        return self.mesh.skin is not None and self.mesh.joints.shape[1] > 0

    def affecting(self, timeline: Timeline) -> Timeline:
        """The timeline with only those tracks that can move the points."""
        nodes = set(self.nodes)
        tracks = [t for t in timeline.clip.tracks if t.path != "weights" and t.node in nodes]
        weights = self._morph_track(timeline)
        tracks += [weights] if weights is not None else []
        return replace(timeline, clip=replace(timeline.clip, tracks=tuple(tracks)))

    def _morph_track(self, timeline: Timeline) -> Track | None:
        """The track of the morph weights, where a morph target moves one of the points."""
        moved = len(self.mesh.morphs) > 0 and bool(self.mesh.morphs[:, self.rows].any())
        return timeline.track(self.mesh.node, "weights") if moved else None

    def at_rest(self) -> Floats:
        """The points at rest, (p, 3)."""
        rig, _ = self._part
        world = worlds(rig, rig.normalised_local if self._normalised else rig.local)[np.newaxis]
        return np.asarray(self._seen(world, self.mesh.morph_weights[np.newaxis])[0])

    def sample(self, timeline: Timeline, times: Floats) -> Floats:
        """The points at ``times``, (f, p, 3), seen from the parent."""
        rig, number = self._part
        tracks = [
            replace(t, node=number[t.node])
            for t in timeline.clip.tracks
            if t.path != "weights" and t.node in number
        ]
        motion = Motion(rig, replace(timeline.clip, tracks=tuple(tracks)))
        size = max(1, _BLOCK // max(len(rig), 1))
        found = [np.zeros((0, len(self.rows), 3))]
        for start in range(0, len(times), size):
            some = times[start : start + size]
            world = worlds(rig, motion.locals_at(some, normalised=self._normalised))
            found.append(self._seen(world, self._morph(timeline, some)))
        return np.concatenate(found)

    def _morph(self, timeline: Timeline, times: Floats) -> Floats:
        track = self._morph_track(timeline)
        if track is not None:
            return sample(track, times)
        return np.broadcast_to(self.mesh.morph_weights, (len(times), len(self.mesh.morph_weights)))

    def _seen(self, world: Floats, morph: Floats) -> Floats:
        """The points, (f, p, 3), from world matrices of the part, (f, n, 4, 4), and morph weights (f, t)."""
        points = self.mesh.points[self.rows]
        for target in range(morph.shape[1]):
            offsets = self.mesh.morphs[target, self.rows]
            if offsets.any():
                points = points + morph[:, target, np.newaxis, np.newaxis] * offsets
        moved = self._moved(points, world)
        if self.parent < 0:
            return moved
        return transform_points(moved, inverse(world[:, self._part[1][self.parent]])[:, np.newaxis])

    def _moved(self, points: Floats, world: Floats) -> Floats:
        mesh, number = self.mesh, self._part[1]
        if not self._skinned:
            return transform_points(points, world[:, number[mesh.node], np.newaxis])
        joints, weights, nodes, bind = self._influences
        matrices = multiply(bind, world[:, [number[node] for node in nodes.tolist()]])
        return blended(points, matrices, joints, weights, dual_quaternion=mesh.dual_quaternion)
