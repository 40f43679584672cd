"""The dead band: a reorientation below the precision of storage is none, and the joint stays bit-exact.

So a second run changes nothing. docs/exactness.md has the measurements.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.maths.quaternions import IDENTITY
from rigtri.maths.triangle import DEGENERATE_SINE
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, length, normalise
from rigtri.operations.orient_joints.bend_planes import UpDirections
from rigtri.operations.orient_joints.targets import Targets

# float32 storage re-derives frames with up to this much noise (radians).
UNCHANGED = 2e-6
# … plus this over |sin bend| about the aim axis, where up comes from a plane.
UNCHANGED_PLANE = 2e-7
# However poor the positions are, a delta of more than this (0.06°) is intended.
MOST_NOISE = 1e-3
# Axes copied from a file (--like) hold no positions: only the rounding of rotations.
UNCHANGED_LIKE = 5e-7


@dataclass(frozen=True, eq=False)
class DeadBand:
    """The largest angle of each node, (n,) in radians, that means nothing: three parts of it.

    rounding: of float32 rotations, and of scales that pass as uniform. roll: about the aim axis, of
    the up direction, once that is known. position: of float32 positions beside the bone's length.
    """

    rounding: Floats
    roll: Floats
    position: Floats

    def limits(self, nodes: Sequence[int]) -> Floats:
        """(k,), in radians."""
        limit = self.rounding[nodes] + self.roll[nodes]
        return np.minimum(limit + self.position[nodes], MOST_NOISE)

    def apply(self, delta: Floats, nodes: Sequence[int]) -> Floats:
        """Deltas, (k, 4), with exactly the identity for those within the dead band of their nodes."""
        return apply_deadband(delta, self.limits(nodes))

    def widen_for_roll(self, joints: Sequence[int], targets: Targets, ups: UpDirections) -> None:
        """Take in how uncertain the up directions of ``joints`` leave their rolls."""
        # A direction near the bone tells the roll badly: its noise grows with 1/sine.
        sine = np.maximum(length(cross(normalise(ups.vector[joints]), targets.bone[joints])), DEGENERATE_SINE)
        roll = self.rounding[joints] / sine - self.rounding[joints]
        plane = UNCHANGED_PLANE + np.array([self._plane_noise(joint, targets) for joint in joints])
        of_plane = plane / np.maximum(ups.sine[joints], DEGENERATE_SINE)
        self.roll[joints] = np.where(ups.step[joints] >= 2, roll + of_plane, roll)

    def _plane_noise(self, joint: int, targets: Targets) -> float:
        """The position noise of the plane of a joint: the shortest bone beside it tells it worst."""
        aims, above = targets.aims, targets.tree.above[joint]
        around = {joint, above, targets.tree.above.get(above, -1), aims[joint].node}
        known = [k for k in around if k is not None and k in aims and aims[k].length > 0]
        return max((float(self.position[k]) for k in known), default=0.0)


def dead_band(targets: Targets, scales: ScaleTable) -> DeadBand:
    """The dead band of every node before any up direction is known."""
    rig, ref = targets.tree.rig, targets.ref
    scale_noise = scales.noise  # of each node and those above it
    for level in rig.levels[1:]:
        scale_noise[level] = np.maximum(scale_noise[level], scale_noise[rig.parents[level]])
    bone = np.zeros(len(rig))
    bone[list(targets.aims)] = [aim.length for aim in targets.aims.values()]
    position = ref.rounding * ref.extent / np.maximum(np.maximum(bone, 1e-3 * ref.extent), 1e-30)
    return DeadBand(UNCHANGED + scale_noise, np.zeros(len(rig)), position)


def like_dead_band(count: int) -> DeadBand:
    """The dead band of ``count`` nodes that take axes of another file as they are."""
    return DeadBand(np.full(count, UNCHANGED_LIKE), np.zeros(count), np.zeros(count))


def apply_deadband(delta: Floats, limit: Floats) -> Floats:
    """Deltas, (k, 4), with exactly the identity for those of no more than ``limit``, (k,) radians."""
    x, y, z = delta[:, 0], delta[:, 1], delta[:, 2]
    angle = 2.0 * np.sqrt(x * x + y * y + z * z)  # where it is small enough to matter
    return np.where((angle <= limit)[:, np.newaxis], IDENTITY, delta)
