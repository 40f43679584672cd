"""The reorientation that each joint's style asks for, from its aim and its up direction; and the dead band.

A reorientation below the precision of storage is none, and the joint stays bit-exact: so a second run
changes nothing. docs/exactness.md has the measurements.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.frames.scale_noise import NOISE, SAME_RATIO
from rigtri.frames.skeleton import ReferencePose
from rigtri.maths.matrices import transform_directions
from rigtri.maths.quaternions import IDENTITY, from_axes, to_axes
from rigtri.maths.triangle import DEGENERATE_SINE, axis_of, frame
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length, normalise
from rigtri.model.dataclass import dataclass
from rigtri.operations.axis_presets import AxisStyle
from rigtri.operations.orient_joints.bend_planes import UpDirections
from rigtri.operations.orient_joints.joints_to_orient import Targets
from rigtri.operations.orient_joints.scale_policy import ScalePolicy
from rigtri.operations.orient_joints.standard_frames import StandardFrames
from rigtri.operations.orient_joints.up_direction import UpLadder, crossing

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

    rounding: of float32 rotations, and of scales that pass as uniform, wherever they are: a joint may take
    its hinge from any other, a hand from each finger. roll: about the aim axis, of the up direction, once
    that is known. position: of float32 positions beside the bone's length.
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
        # A direction near the bone gives a poor roll: its noise grows with 1/sine.
        sine = np.maximum(length(cross(normalise(ups.vector[joints]), targets.bone[joints])), DEGENERATE_SINE)
        roll = self.rounding[joints] / sine - self.rounding[joints]
        plane = self.rounding[joints] - UNCHANGED + UNCHANGED_PLANE
        plane = plane + np.array([self._plane_noise(joint, targets) for joint in joints])
        of_plane = plane / np.maximum(ups.sine[joints], DEGENERATE_SINE)
        self.roll[joints] = np.where(ups.step[joints] >= 2, roll + of_plane, roll)

    def _plane_noise(self, joint: int, targets: Targets) -> float:
        """The position noise of the plane of a joint: the shortest bone beside it counts."""
        aims, above = targets.aims, targets.tree.above[joint]
        around = {joint, above, targets.tree.above.get(above, -1), aims[joint].node}
        known = [k for k in around if k is not None and k in aims and aims[k].length > 0]
        return max((float(self.position[k]) for k in known), default=0.0)


def dead_band(targets: Targets, scales: ScaleTable) -> DeadBand:
    """The dead band of every node before any up direction is known."""
    rig, ref = targets.tree.rig, targets.ref
    joints = list(targets.tree.joints)
    scale_noise = scales.noise.copy()  # of each node and all above it: each takes what is below it along
    for level in rig.levels[1:]:
        scale_noise[level] += scale_noise[rig.parents[level]]
    noise = max(float(scale_noise[joints].max()), float(_strain(ref.world)[joints].max()))
    bone = np.zeros(len(rig))
    bone[list(targets.aims)] = [aim.length for aim in targets.aims.values()]
    position = ref.rounding * ref.extent / np.maximum(np.maximum(bone, 1e-3 * ref.extent), 1e-30)
    return DeadBand(np.full(len(rig), UNCHANGED + noise), np.zeros(len(rig)), position)


def _strain(world: Floats) -> Floats:
    """By how much frames, (n, 4, 4), are no similarities, (n,), where that is noise; also of bind poses."""
    rows = world[:, :3, :3]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        size = length(rows)
        apart = size.max(axis=1) / size.min(axis=1) - 1.0
        aside = [np.abs(dot(rows[:, k], rows[:, k - 1])) / (size[:, k] * size[:, k - 1]) for k in range(3)]
        found = np.maximum.reduce([apart, *aside])
    return np.where((found > SAME_RATIO) & (found <= NOISE), found, 0.0)


def like_dead_band(count: int) -> DeadBand:
    """The dead band of ``count`` nodes that take axes of another file as they are."""
    return DeadBand(np.full(count, UNCHANGED_LIKE), np.zeros(count), np.zeros(count))


def apply_deadband(delta: Floats, limit: Floats) -> Floats:
    """Deltas, (k, 4), with exactly the identity for those of no more than ``limit``, (k,) radians."""
    x, y, z = delta[:, 0], delta[:, 1], delta[:, 2]
    angle = 2.0 * np.sqrt(x * x + y * y + z * z)  # where it is small enough to matter
    return np.where((angle <= limit)[:, np.newaxis], IDENTITY, delta)


def joint_frames(
    targets: Targets, ladder: UpLadder, band: DeadBand, policy: ScalePolicy, standard: StandardFrames
) -> Floats:
    """The change of frame of each node, (n, 4), in its own space; identity of what is no target.

    Finds the up directions of ``ladder`` and widens ``band`` by them on the way: an up direction may be
    the new axis of another joint.
    """
    delta = np.broadcast_to(IDENTITY, (len(targets.tree.rig), 4)).copy()
    for joints in _batches(targets):
        aimed = [joint for joint in joints if _is_aimed(targets, joint)]
        if aimed:
            ladder.find(aimed, _related_axes(aimed, delta, targets, band, policy))
            band.widen_for_roll(aimed, targets, ladder.ups)
            _set_aimed(delta, aimed, targets, ladder.ups.vector)
        world = [joint for joint in joints if _is_world(targets, joint)]
        rows = np.array([standard.axes.get(joint, np.eye(3)) for joint in world]).reshape(-1, 3, 3)
        set_world_axes(delta, rows, world, targets)
        copies = [joint for joint in joints if targets.aims[joint].how == "parent" and joint not in world]
        if copies:
            above = [targets.tree.above[joint] for joint in copies]
            band.roll[copies] = band.roll[above]
            axes = _new_axes(above, delta, targets, band, policy)
            for rows, joint in zip(axes, copies, strict=True):
                _keep_up(rows, joint, targets)
            set_world_axes(delta, axes, copies, targets)
        _set_standard(delta, [joint for joint in joints if joint not in world], targets, ladder, standard)
    return delta


def _keep_up(axes: Floats, joint: int, targets: Targets) -> None:
    """Give axes that a joint takes from its parent, (3, 3) rows, the joint's own up axis with ``keep``."""
    style = targets.styles[joint]
    (aim, _), (up, _) = axis_of(style.aim), axis_of(style.up)
    own = normalise(targets.ref.world[joint, up, :3])
    if style.up_from == "keep" and crossing(own, axes[aim]):
        axes[up] = own


def _set_standard(
    delta: Floats, joints: Sequence[int], targets: Targets, ladder: UpLadder, standard: StandardFrames
) -> None:
    """Bring joints of a standard skeleton onto its axes."""
    for joint in (joint for joint in joints if joint in standard.bones):
        aim, hinge = standard.bones[joint]
        ladder.ups.set([joint], -hinge if targets.mirrored[joint] else hinge, 2, "standard skeleton")
        into = targets.ref.inverse[joint]
        own_aim, own_up = (transform_directions(k, into) for k in (aim, ladder.ups.vector[joint]))
        style = targets.styles[joint]
        delta[joint] = from_axes(frame(own_aim, own_up, aim_axis=style.aim, up_axis=style.up))


def _batches(targets: Targets) -> Iterator[list[int]]:
    """Joints whose frames can be found at once, each after those whose new axes it takes."""
    styles, above = targets.styles, targets.tree.above
    copies = {joint: None for joint in targets.joints if targets.aims[joint].how == "parent"}
    others = [joint for joint in targets.joints if joint not in copies]
    first = [joint for joint in others if styles[joint].up_from != "child"]
    if any(styles[joint].up_from == "parent" for joint in first):
        yield from ([joint] for joint in first)
    elif first:
        yield first
    yield from ([joint] for joint in reversed(others) if styles[joint].up_from == "child")
    while copies:
        ready = [joint for joint in copies if above[joint] not in copies]
        yield ready
        copies = {joint: None for joint in copies if joint not in ready}


def _is_world(targets: Targets, joint: int) -> bool:
    return targets.styles[joint].world or targets.aims[joint].how == "world"


def _is_aimed(targets: Targets, joint: int) -> bool:
    return targets.aims[joint].how not in ("keep", "parent") and not _is_world(targets, joint)


def _set_aimed(delta: Floats, joints: Sequence[int], targets: Targets, up: Floats) -> None:
    """Bring the aim axes of joints onto their bones, and their up axes near to ``up``, (n, 3)."""
    for style, group in targets.by_style(joints).items():
        own_up = transform_directions(up[group], targets.ref.inverse[group])
        delta[group] = from_axes(frame(targets.aim[group], own_up, aim_axis=style.aim, up_axis=style.up))


def set_world_axes(delta: Floats, axes: Floats, joints: Sequence[int], targets: Targets) -> None:
    """Bring joints onto axes of the world, (k, 3, 3) rows, of which they take their aim and up axes."""
    place = {joint: k for k, joint in enumerate(joints)}
    for style, group in targets.by_style(joints).items():
        delta[group] = delta_onto(axes[[place[joint] for joint in group]], targets.ref, group, style)


def delta_onto(axes: Floats, ref: ReferencePose, joints: Sequence[int], style: AxisStyle) -> Floats:
    """The deltas, (k, 4), that give joints these world axes (rows, any handedness), (k, 3, 3).

    Taken into the joint's own space and made orthonormal there, first the aim axis, then the up
    axis; the third gives way where the handedness is not the joint's own.
    """
    rows = transform_directions(axes, ref.inverse[list(joints)][:, np.newaxis])
    aim, up = style.aim[-1], style.up[-1]
    return from_axes(frame(rows[:, axis_of(aim)[0]], rows[:, axis_of(up)[0]], aim_axis=aim, up_axis=up))


def _new_axes(
    joints: Sequence[int], delta: Floats, targets: Targets, band: DeadBand, policy: ScalePolicy
) -> Floats:
    """The world axes (rows) that joints will have, (k, 3, 3)."""
    axes = to_axes(band.apply(delta[joints], joints))
    for row, joint in enumerate(joints):
        axes[row] = policy.axes_taken(axes[row], joint, targets.styles[joint])
    return normalise(transform_directions(axes, targets.ref.world[joints][:, np.newaxis]))


def _related_axes(
    joints: Sequence[int], delta: Floats, targets: Targets, band: DeadBand, policy: ScalePolicy
) -> Mapping[int, Floats]:
    """The direction in the world, (3,), of the axis of another joint that gives some joints their up."""
    found = {}
    tree, aims = targets.tree, targets.aims
    for joint in joints:
        style = targets.styles[joint]
        if style.up_from not in ("parent", "child"):
            continue
        letter, sign = axis_of(style.up)
        if style.up_from == "parent":
            other: int | None = tree.above[joint]
        else:
            other = aims[joint].node
            if other not in tree.above:
                other = next(iter(tree.below[joint]), None)
            if other is not None and other in aims and aims[other].how == "parent":
                other = None  # it copies this joint, so it has no up axis of its own
        if other is None or other < 0:
            found[joint] = targets.ref.world[joint, letter, :3] * sign
        else:
            found[joint] = _new_axes([other], delta, targets, band, policy)[0, letter] * sign
    return found
