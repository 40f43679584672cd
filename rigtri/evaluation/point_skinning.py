"""Some points of a mesh where skinning and morphs carry them, in numbers that may reach a file.

The same as `rigtri.evaluation.sampling.deformed`, for few points and many times: elementwise, so that the
bits do not depend on the machine, and with only those nodes evaluated that move the points.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from rigtri.evaluation import sampling
from rigtri.evaluation.timelines import Timeline
from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import from_frame, identity, inverse, multiply, nearest_rotation, transform_points
from rigtri.maths.quaternions import conjugate, from_axes, rotate, unit
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig

# Matrices evaluated at once: 64 bytes times nodes times this.
_BLOCK = 1 << 15


@dataclass(frozen=True, eq=False)
class SkinnedPoints:
    """Points ``rows`` of ``mesh``, and the ``parent`` that they are seen from (−1: the world)."""

    rig: Rig
    mesh: Mesh
    rows: Integers
    parent: int = -1

    @cached_property
    def _joints(self) -> Integers:
        """The joints, as places in the skin, that move any of the points, (j,)."""
        weights = sampling.normalised_weights(self.mesh)[self.rows]
        return np.unique(self.mesh.joints[self.rows][weights != 0])

    @cached_property
    def nodes(self) -> list[int]:
        """The nodes whose motion moves the points, or what they are seen from."""
        if self._skinned and self.mesh.skin is not None:
            own: list[int] = self.rig.skins[self.mesh.skin].joints[self._joints].tolist()
        else:
            own = [self.mesh.node]
        found: set[int] = set()
        for node in [*own, self.parent]:
            while node >= 0 and node not in found:
                found.add(node)
                node = int(self.rig.parents[node])
        return sorted(found)

    @cached_property
    def _part(self) -> tuple[Rig, dict[int, int]]:
        """The nodes alone, and where each went."""
        return replace(self.rig, clips=()).part(self.nodes)

    @property
    def _unit(self) -> bool:
        """Whether viewers of the file make rotations unit."""
        return not self.rig.rules.raw_quaternions

    @property
    def _skinned(self) -> bool:
        return self.mesh.skin is not None and self.mesh.joints.shape[1] > 0

    def affecting(self, timeline: Timeline) -> Timeline:
        """The timeline with only those tracks that can move the points."""
        nodes = set(self.nodes)
        tracks = [t for t in timeline.clip.tracks if t.path != "weights" and t.node in nodes]
        weights = self._weights(timeline)
        tracks += [weights] if weights is not None else []
        return replace(timeline, clip=replace(timeline.clip, tracks=tuple(tracks)))

    def _weights(self, timeline: Timeline) -> Track | None:
        """The track of the morph weights, where a morph moves one of the points."""
        moved = len(self.mesh.morphs) > 0 and bool(self.mesh.morphs[:, self.rows].any())
        return timeline.track(self.mesh.node, "weights") if moved else None

    def at_rest(self) -> Floats:
        """The points at rest, (p, 3)."""
        rig, place = self._part
        world = sampling.worlds(rig, rig.normalised_local if self._unit else rig.local)[np.newaxis]
        weights = np.broadcast_to(self.mesh.morph_weights, (1, len(self.mesh.morph_weights)))
        return np.asarray(self._seen(world, place, weights)[0])

    def sample(self, timeline: Timeline, times: Floats) -> Floats:
        """The points at ``times``, (f, p, 3), seen from the parent."""
        rig, place = self._part
        tracks = [
            replace(t, node=place[t.node])
            for t in timeline.clip.tracks
            if t.path != "weights" and t.node in place
        ]
        motion = sampling.Motion(rig, replace(timeline.clip, tracks=tuple(tracks)))
        size = max(1, _BLOCK // max(len(rig), 1))
        blocks = [times[start : start + size] for start in range(0, len(times), size)]
        found = [
            self._seen(
                sampling.worlds(rig, motion.locals_at(some, normalised=self._unit)),
                place,
                self._morph(timeline, some),
            )
            for some in blocks
        ]
        return np.concatenate([*found, np.zeros((0, len(self.rows), 3))])

    def _morph(self, timeline: Timeline, times: Floats) -> Floats:
        track = self._weights(timeline)
        if track is not None:
            return sampling.sample(track, times)
        return np.broadcast_to(self.mesh.morph_weights, (len(times), len(self.mesh.morph_weights)))

    def _seen(self, world: Floats, place: dict[int, int], morph: Floats) -> Floats:
        """The points, (f, p, 3), from world matrices of the part, (f, k, 4, 4), and morph weights (f, t)."""
        mesh = self.mesh
        points = np.broadcast_to(mesh.points[self.rows], (len(world), len(self.rows), 3))
        for target in range(morph.shape[1]):
            offsets = mesh.morphs[target, self.rows]
            if offsets.any():
                points = points + morph[:, target, np.newaxis, np.newaxis] * offsets
        moved = self._moved(points, world, place)
        if self.parent < 0:
            return moved
        above = inverse(world[:, place[self.parent]])
        return transform_points(moved, above[:, np.newaxis])

    def _moved(self, points: Floats, world: Floats, place: dict[int, int]) -> Floats:
        mesh = self.mesh
        if not self._skinned or mesh.skin is None:
            return transform_points(points, world[:, place[mesh.node], np.newaxis])
        skin = self.rig.skins[mesh.skin]
        joints = skin.joints[self._joints]
        there = world[:, [place[node] for node in joints.tolist()]]
        matrices = multiply(multiply(mesh.bind, skin.inverse_bind[self._joints]), there)
        weights = sampling.normalised_weights(mesh)[self.rows]
        column_of = np.searchsorted(self._joints, np.where(weights != 0, mesh.joints[self.rows], -1))
        column_of = np.where(weights != 0, column_of, 0)
        if mesh.dual_quaternion:
            return _blended_turns(points, matrices, column_of, weights)
        moved = np.zeros(points.shape)
        for k in range(weights.shape[1]):
            part = transform_points(points, matrices[:, column_of[:, k]])
            moved = moved + np.where(weights[:, k, np.newaxis] != 0, weights[:, k, np.newaxis] * part, 0.0)
        return moved


def _blended_turns(points: Floats, matrices: Floats, joints: Integers, weights: Floats) -> Floats:
    """Dual-quaternion skinning, as `evaluation.sampling` has it: stretched linearly, then turned and moved.

    Source: L. Kavan et al., "Skinning with dual quaternions", I3D 2007; UsdSkel.
    """
    axes = nearest_rotation(matrices)
    rotation = from_axes(axes)
    stretch = multiply(_linear(matrices), inverse(_linear(from_frame(axes, np.zeros(3)))))
    moved = np.concatenate([matrices[..., 3, :3], np.zeros((*rotation.shape[:-1], 1))], axis=-1)
    dual = 0.5 * product(moved, rotation)
    heaviest = np.argmax(np.abs(weights), axis=1)
    pivot = rotation[:, joints[np.arange(len(joints)), heaviest]]
    real, other = np.zeros((*points.shape[:-1], 4)), np.zeros((*points.shape[:-1], 4))
    stretched = np.zeros(points.shape)
    for k in range(joints.shape[1]):
        of, share = joints[:, k], weights[:, k, np.newaxis]
        stretched = stretched + share * transform_points(points, stretch[:, of])
        q = rotation[:, of]
        both = q * pivot
        along = both[..., 0] + both[..., 1] + both[..., 2] + both[..., 3]
        share = share * np.where(along[..., np.newaxis] < 0, -1.0, 1.0)
        real = real + share * q
        other = other + share * dual[:, of]
    square = real * real
    size = np.sqrt(square[..., 0] + square[..., 1] + square[..., 2] + square[..., 3])[..., np.newaxis]
    turned = rotate(unit(real), stretched)
    return turned + 2.0 * product(other / size, conjugate(unit(real)))[..., :3]


def _linear(matrices: Floats) -> Floats:
    """Matrices without their positions."""
    found = identity(*matrices.shape[:-2])
    found[..., :3, :3] = matrices[..., :3, :3]
    return found
