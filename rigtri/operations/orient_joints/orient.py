"""orient-joints: new axes for chosen joints; nothing that can be seen moves.

Source: R. Katz, "Rigging with Triangles", GDC 2018, "Aiming node A at node B";
"Using Vector Math to Rig an Arm" (hinge of the limb's own triple).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError
from rigtri.frames.error_bounds import LeverArm
from rigtri.frames.nonuniform_scale import ScaleTable, same_scales, ties
from rigtri.frames.reframe import reframe, split
from rigtri.frames.reoriented_constraints import axes_compared
from rigtri.frames.scale_noise import Frozen, frozen, noisy_joints
from rigtri.maths.quaternions import IDENTITY, from_axis_angle, multiply, rotates
from rigtri.maths.trigonometry import Floats
from rigtri.model.bindings import NodeConstraint
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import FrameRecord
from rigtri.model.rig import Rig
from rigtri.operations.operation import operation
from rigtri.operations.options.orient_joints import OrientJointsOptions
from rigtri.operations.orient_joints import messages
from rigtri.operations.orient_joints.bend_planes import UpDirections, bend_planes
from rigtri.operations.orient_joints.constraint_policy import apply_constraint_policy
from rigtri.operations.orient_joints.joint_frames import dead_band, joint_frames, like_dead_band
from rigtri.operations.orient_joints.joints_to_orient import Targets, find_targets
from rigtri.operations.orient_joints.messages import RequestedFrames
from rigtri.operations.orient_joints.scale_policy import ScalePolicy, nearest_cardinal
from rigtri.operations.orient_joints.standard_frames import StandardFrames, standard_frames, warn_facing
from rigtri.operations.orient_joints.unknown_bodies import warn_unsure
from rigtri.operations.orient_joints.up_direction import UpLadder
from rigtri.recognition.body_hinges import bodies, warn_both, warn_turned
from rigtri.recognition.recognise import recognise
from rigtri.report import Report

# How much of the tolerance scale noise that is frozen may use up in the poses of a file, as measured;
# rounding and what passes as uniform have the rest.
FROZEN_MAY = 0.7
# What products of float64 quaternions leave of a rotation that is undone.
LAST_BITS = 1e-12

__all__ = ["OrientJointsOptions", "orient_joints"]


@operation(OrientJointsOptions)
def orient_joints(rig: Rig, *, options: OrientJointsOptions, report: Report) -> Rig:
    """Give joints the axes that ``options`` ask for; all that is bound to them follows.

    Joints below the noise of float32 storage are left bit-exact, so that a second
    run changes nothing. Each joint's record goes to ``report.joints``.

    Raises NameNotFoundError, UsageError, GeometryError (a scale that forbids it under the
    policy ``error``, or ``split`` in a file that allows none), FileError (no skeleton; no axes may change).
    Not handled: poses stored as differences to rest (additive clips).
    """
    plan = plan_frames(rig, options)
    noise = _without_noise(rig, plan, options)
    if noise is not None:
        rig, plan = noise.rig, plan_frames(noise.rig, options)
        messages.warn_noise(noise, report)
    targets, policy, tied, requested = plan.targets, plan.policy, plan.tied, plan.requested
    report.merge(plan.notes)
    splits = _find_splits(rig, requested, targets, policy, options)
    delta = _allowed(rig, requested, splits, targets, policy, report, exactly=options.frames is not None)
    constrained = apply_constraint_policy(
        delta,
        requested.joints,
        targets,
        policy.scales,
        requested.band,
        tied,
        policy=options.on_constraint,
        report=report,
    )
    outcome = messages.Outcome(
        targets,
        requested,
        policy,
        _at_joints(rig, constrained.delta, targets, requested, splits),
        splits,
        constrained.skipped,
        constrained.follows,
        {} if noise is None else noise.joints,
    )
    messages.warn_fixed(outcome, options.selection, report)
    messages.warn_straight(outcome, report)
    messages.check(outcome, report)
    messages.record(outcome, report)
    out = _zeroed(reframe(rig, constrained.delta, scales=policy.scales), rig)
    if rig.nodes_of("control"):
        # With the solver of controls, which a character without them does not import.
        from rigtri.operations.controls_check import refuse_other_axes

        refuse_other_axes(rig, out, constrained.delta, policy.scales, options.tolerance)
    return split(_marked(out, outcome), splits)


@dataclass(frozen=True, eq=False)
class FramePlan:
    """What is requested of which joints. tied: what ties joints to parents. notes: warnings so far."""

    targets: Targets
    policy: ScalePolicy
    tied: tuple[NodeConstraint, ...]
    requested: RequestedFrames
    notes: Report


def plan_frames(rig: Rig, options: OrientJointsOptions, uniform: Sequence[int] = ()) -> FramePlan:
    """What options ask of which joints, before any policy. uniform: joints taken as of uniform scale."""
    targets, notes = find_targets(rig, options), Report()
    lever_arm, scales = LeverArm(rig), ScaleTable.of(rig)
    scales.apart[list(uniform)] = 0.0
    same = same_scales(rig, targets.tree.joints, scales, lever_arm, options.tolerance)
    tied = ties(rig, lever_arm, options.tolerance)
    rotated = {k for c in axes_compared(rig) for k in (c.node, c.source) if c.kind != "aim" or k == c.node}
    unsplittable = frozenset(rotated | {tie.node for tie in tied})
    scales, givers = replace(scales, same=same), dict[int, int]()
    if rig.nodes_of("control", "constraint"):
        # With what poses controls, which a character without them does not import.
        from rigtri.operations.orient_joints.scaled_controls import scales_given

        scales, givers = scales_given(rig, scales)
    policy = ScalePolicy(options.on_nonuniform_scale, rig, scales, unsplittable, givers)
    return FramePlan(targets, policy, tied, requested_frames(targets, options, policy, notes), notes)


def _without_noise(rig: Rig, plan: FramePlan, options: OrientJointsOptions) -> Frozen | None:
    """The rig with uniform scales where only noise of a scale stands against what is requested."""
    policy = plan.policy
    noisy = noisy_joints(rig, policy.scales)
    if not noisy:
        return None
    # As if none were in the way: joints may copy the axes of others.
    free = plan_frames(rig, options, noisy)
    delta = _at_nodes(rig, free.requested.delta)
    refused = policy.refused(delta, policy.nearest(delta, free.targets.styles))
    noisy = [joint for joint in noisy if joint in refused]
    return frozen(rig, noisy, policy.scales, FROZEN_MAY * options.tolerance) if noisy else None


def _find_splits(
    rig: Rig,
    requested: RequestedFrames,
    targets: Targets,
    policy: ScalePolicy,
    options: OrientJointsOptions,
) -> dict[int, Floats]:
    """The joints, with their deltas (4,), that take them by a node of their own."""
    found = policy.splits(_at_nodes(rig, requested.delta), targets.styles)
    if options.frames is not None and not options.inverse:
        from rigtri.operations.orient_joints.frame_sources import stored_splits

        stored = stored_splits(rig, requested.joints, options.frames)
        found |= {joint: requested.delta[joint] for joint in stored}
    found = {joint: delta for joint, delta in found.items() if joint not in policy.unsplittable}
    if found and rig.rules.split_locked:
        names = ", ".join(f"'{rig.title(joint)}'" for joint in found)
        raise GeometryError(
            f"{names} cannot be split: {rig.rules.split_locked}. Choose --on-nonuniform-scale snap or skip."
        )
    return found


def _allowed(
    rig: Rig,
    requested: RequestedFrames,
    splits: dict[int, Floats],
    targets: Targets,
    policy: ScalePolicy,
    report: Report,
    *,
    exactly: bool,
) -> Floats:
    """What nodes take in place, (n, 4), for the sake of their scales; ``exactly``: however small."""
    delta = requested.delta.copy()
    delta[list(splits)] = IDENTITY
    delta = policy.allowed(_at_nodes(rig, delta), targets.styles, report)
    if not exactly:  # what the snap left over is noise too
        joints = [joint for joint in requested.joints if joint not in rig.frame_of and joint not in splits]
        delta[joints] = requested.band.apply(delta[joints], joints)
    return delta


def _at_nodes(rig: Rig, delta: Floats) -> Floats:
    """Deltas, (n, 4), of joints whose axes a node of their own holds, moved to that node."""
    if not rig.frame_of:
        return delta
    moved = delta.copy()
    for joint, holder in rig.frame_of.items():
        moved[holder], moved[joint] = delta[joint], IDENTITY
    return moved


def _at_joints(
    rig: Rig, delta: Floats, targets: Targets, requested: RequestedFrames, splits: dict[int, Floats]
) -> Floats:
    """What joints take of deltas of nodes, (n, 4), or by a node of their own."""
    taken = requested.delta.copy()
    joints = [joint for joint in targets.tree.joints if joint not in splits]
    taken[joints] = delta[[rig.frame_of.get(joint, joint) for joint in joints]]
    return taken


def _zeroed(rig: Rig, before: Rig) -> Rig:
    """Write rotations as 0 0 0 1 that are zero up to the last bit or the sign, where a format asks for zeros.

    What has not changed stays as it is.
    """
    if rig is before or not rig.rules.world_aligned:
        return rig
    nodes = sorted(rig.rules.world_aligned)
    q = rig.rotation[nodes]
    nothing = (np.abs(q[:, :3]).max(axis=1) <= LAST_BITS) & (q != before.rotation[nodes]).any(axis=1)
    rotation = rig.rotation.copy()
    rotation[np.array(nodes)[nothing]] = IDENTITY
    return replace(rig, rotation=rotation)


def _marked(rig: Rig, outcome: messages.Outcome) -> Rig:
    """Mark in the file the re-oriented joints whose up direction was invented, and unmark the others.

    What keeps its axes keeps its mark or none: nothing was invented for it now. A node has one record, so
    a joint of rigtri's own keeps what says how it was made.
    """
    metadata = dict(rig.metadata)
    moves, ups = rotates(outcome.delta), outcome.requested.ups
    for joint in (joint for joint in outcome.targets.joints if moves[joint] and joint not in rig.own):
        if ups.step[joint] >= 7:
            metadata[joint] = FrameRecord(up=ups.source[joint], invented=True).to_dict()
        elif isinstance(own := rig.record(joint), FrameRecord) and own.invented:
            del metadata[joint]
    return rig if metadata == rig.metadata else replace(rig, metadata=metadata)


def requested_frames(
    targets: Targets, options: OrientJointsOptions, policy: ScalePolicy, report: Report
) -> RequestedFrames:
    """What each target is to take: from its style, a stored file, another rig, or the other side."""
    rig, joints = targets.tree.rig, targets.joints
    delta, band = np.broadcast_to(IDENTITY, (len(rig), 4)).copy(), dead_band(targets, policy.scales)
    ups, straight = UpDirections.none(len(rig)), {}
    if options.frames is not None:  # applied as they are, however small
        from rigtri.operations.orient_joints.frame_sources import stored_deltas

        joints, stored = stored_deltas(rig, joints, options.frames, inverted=options.inverse, report=report)
        delta[joints] = stored
        return RequestedFrames(joints, delta, band, ups)
    if options.like is not None:
        from rigtri.operations.orient_joints.frame_sources import like_deltas

        joints, delta[joints] = like_deltas(targets, options.like, report)
        band = like_dead_band(len(rig))
    elif not options.keep:
        facing = None if options.facing is None else np.asarray(options.facing, dtype=np.float64)
        along_world = all(targets.styles[joint].world for joint in targets.joints)
        # Where a format asks for the axes of the world, a body has no others.
        pose = None if rig.rules.world_aligned else options.standard_pose
        characters = () if along_world and pose is None else recognise(rig).characters
        standard = StandardFrames()
        if pose is not None:
            standard = standard_frames(rig, targets.ref.world, characters, pose, options.facing)
            warn_facing(standard, report)
        known = targets.bodies if characters else ()
        known = bodies(rig, characters, targets.ref.world, facing) if known is None else known
        if facing is not None:
            warn_both(rig, characters, report)
        else:
            warn_turned(known, report)
        warn_unsure(targets, report, per_joint=options.per_joint_plane, faces=facing is not None)
        planes = bend_planes(targets, known, facing, per_joint=options.per_joint_plane, report=report)
        # After an offset or a snap the present axis is not the one that a run before has found.
        present = not any(options.offset) and not options.snap
        ladder = UpLadder(targets, planes, present=present, report=report)
        delta = joint_frames(targets, ladder, band, policy, standard)
        ups, straight = ladder.ups, {k: v for k, v in planes.straight.items() if k not in standard.bones}
    delta[joints] = _with_offset(delta[joints], options)
    if options.mirror is not None:
        from rigtri.operations.orient_joints.frame_sources import mirrored_deltas

        delta = mirrored_deltas(targets, joints, delta, options.mirror, options, report)
    delta[joints] = band.apply(delta[joints], joints)
    return RequestedFrames(joints, delta, band, ups, straight)


def _with_offset(delta: Floats, options: OrientJointsOptions) -> Floats:
    """``--snap`` and ``--offset``: after everything else."""
    if options.snap:
        delta = nearest_cardinal(delta)
    for axis, degrees in zip(np.eye(3), options.offset, strict=True):
        if degrees:
            delta = multiply(delta, from_axis_angle(axis, degrees * (np.pi / 180.0)))
    return delta
