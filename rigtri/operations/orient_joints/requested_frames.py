"""The reorientations that the options request, before the scale and constraint policies."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from rigtri.errors import UsageError
from rigtri.frames.mirroring import parting
from rigtri.maths.quaternions import IDENTITY, from_axis_angle, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.operations.options.orient_joints import OrientJointsOptions
from rigtri.operations.orient_joints.bend_planes import UpDirections, bend_planes
from rigtri.operations.orient_joints.dead_band import DeadBand, dead_band, like_dead_band
from rigtri.operations.orient_joints.frame_sources import like_deltas, mirrored_deltas, stored_deltas
from rigtri.operations.orient_joints.joint_frames import joint_frames
from rigtri.operations.orient_joints.scale_policy import ScalePolicy, nearest_cardinal
from rigtri.operations.orient_joints.targets import Targets
from rigtri.operations.orient_joints.up_direction import UpLadder
from rigtri.report import Report


@dataclass(frozen=True, eq=False)
class RequestedFrames:
    """joints: those that have a delta. delta: (n, 4), identity for joints that already have their axes.

    straight: per joint of a limb or chain without a plane of its own, its name and the sine of its bend.
    """

    joints: list[int]
    delta: Floats
    band: DeadBand
    ups: UpDirections
    straight: dict[int, tuple[str, float]] = field(default_factory=dict)


def requested_frames(
    targets: Targets, options: OrientJointsOptions, policy: ScalePolicy, report: Report
) -> RequestedFrames:
    """What each target is to take: from its style, a stored file, another rig, or the other side."""
    rig, joints = targets.tree.rig, targets.joints
    delta, band = np.broadcast_to(IDENTITY, (len(rig), 4)).copy(), dead_band(targets, policy.scales)
    ups, straight = UpDirections.none(len(rig)), {}
    if options.frames is not None:  # applied as they are, however small
        joints, stored = stored_deltas(rig, joints, options.frames, inverted=options.inverse, report=report)
        delta[joints] = stored
        return RequestedFrames(joints, delta, band, ups)
    if options.like is not None:
        joints, delta[joints] = like_deltas(targets, options.like, report)
        band = like_dead_band(len(rig))
    elif not options.keep:
        planes = bend_planes(targets, _facing(rig, options), per_joint=options.per_joint_plane)
        # After an offset or a snap the present axis is not the one that a run before has found.
        present = not any(options.offset) and not options.snap
        ladder = UpLadder(targets, planes, present=present, report=report)
        delta = joint_frames(targets, ladder, band, policy)
        ups, straight = ladder.ups, planes.straight
    delta[joints] = _finished(delta[joints], options)
    if options.mirror is not None:
        across = options.across
        if across is None:
            across = parting(targets.tree, targets.ref, options.plane, options.from_side).across
        delta = mirrored_deltas(
            targets,
            joints,
            delta,
            mirror=options.mirror,
            from_side=options.from_side,
            across=across,
            report=report,
        )
    delta[joints] = band.apply(delta[joints], joints)
    return RequestedFrames(joints, delta, band, ups, straight)


def _finished(delta: Floats, options: OrientJointsOptions) -> Floats:
    """``--snap`` and ``--offset``: after everything else."""
    if options.snap:
        delta = nearest_cardinal(delta)
    for axis, degrees in zip(np.eye(3), options.offset, strict=True):
        if degrees:
            delta = multiply(delta, from_axis_angle(axis, degrees * (np.pi / 180.0)))
    return delta


def _facing(rig: Rig, options: OrientJointsOptions) -> Floats | None:
    facing = options.facing if options.facing is not None else rig.rules.facing
    if facing is None:
        return None
    direction = np.asarray(facing, dtype=np.float64)
    if not direction.any() or not np.isfinite(direction).all():
        raise UsageError(f"--facing {facing} is not a valid direction")
    return direction
