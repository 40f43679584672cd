"""orient-joints: new axes for chosen joints; nothing that can be seen moves.

Source: R. Katz, "Rigging with Triangles", GDC 2018, "Aiming node A at node B";
"Using Vector Math to Rig an Arm" (hinge of the limb's own triple).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError
from rigtri.frames.constraint_transform import lost_rules
from rigtri.frames.reframe import reframe, split
from rigtri.maths.quaternions import IDENTITY, rotates
from rigtri.maths.triangle import axis_of
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.operations.operation import operation
from rigtri.operations.orient_joints.constraint_policy import settle
from rigtri.operations.orient_joints.frame_sources import stored_splits
from rigtri.operations.orient_joints.messages import check, record, tell_fixed, tell_straight
from rigtri.operations.orient_joints.plan import OrientJointsOptions, Plan
from rigtri.operations.orient_joints.scale_policy import allowed_turns, splits
from rigtri.report import Report

# What products of float64 quaternions leave of a rotation that is undone.
LAST_BITS = 1e-12

__all__ = ["OrientJointsOptions", "orient_joints"]


@operation(OrientJointsOptions)
def orient_joints(rig: Rig, *, options: OrientJointsOptions, report: Report) -> Rig:
    """Give joints the axes that ``options`` ask for; all that is bound to them follows.

    Joints below the noise of float32 storage are left bit-exact, so that a second
    run changes nothing. Each joint's record goes to ``report.joints``.

    Raises NameNotFoundError, UsageError, GeometryError (a scale that forbids it under the
    policy ``error``, or ``split`` in a file that allows none), FileError (no skeleton; nothing may turn).
    Not handled: poses stored as differences to rest (additive clips).
    """
    plan = Plan.of(rig, options, report)
    wanted = plan.wanted()
    turns = np.broadcast_to(IDENTITY, (len(rig), 4)).copy()
    for joint, turn in wanted.items():
        turns[joint] = turn
    policy = options.on_nonuniform_scale
    styles = {joint: plan.style(joint) for joint in wanted}
    axis = {joint: axis_of(style.aim)[0] for joint, style in styles.items()}
    both = {joint: (axis[joint], axis_of(style.up)[0]) for joint, style in styles.items()}
    parted = splits(rig, _at_frames(rig, turns), both, plan.scales) if policy == "split" else {}
    if options.frames is not None and not options.inverse:
        parted |= stored_splits(rig, wanted, options.frames)
    for joint in plan.unsplittable.intersection(parted):
        del parted[joint]
    if parted and rig.rules.split_locked:
        raise GeometryError(_refusal(rig, list(parted)))
    exact = turns.copy()
    exact[list(parted)] = IDENTITY
    in_place = "skip" if policy == "split" else policy
    exact = allowed_turns(rig, _at_frames(rig, exact), in_place, axis, plan.scales, report)
    for joint in set(wanted) - set(rig.frame_of) - set(parted):
        if options.frames is None:  # what the snap left over is noise too
            exact[joint] = plan.quiet(joint, exact[joint])
    exact = settle(plan, exact, wanted, options.on_constraint)
    for joint in set(plan.tree.joints) - set(parted):
        turns[joint] = exact[rig.frame_of.get(joint, joint)]
    tell_fixed(plan)
    tell_straight(plan)
    check(plan, turns)
    record(plan, wanted, turns, parted)
    _tell_rules(rig, exact, report)
    out = _noted(_zeroed(reframe(rig, exact, scales=plan.scales), rig), plan, turns)
    return split(out, parted)


def _tell_rules(rig: Rig, turns: Floats, report: Report) -> None:
    """The constraints of rigtri's own whose rules the new axes cannot tell."""
    for node in lost_rules(rig, turns):
        report.warn(
            "constraint-lost",
            f"'{rig.names[node]}' tells its rule by axes that turned, so it means something else now; "
            "set it again with rigtri constrain",
        )


def _at_frames(rig: Rig, turns: Floats) -> Floats:
    """The turns of joints whose axes a node of their own holds, moved to that node."""
    if not rig.frame_of:
        return turns
    moved = turns.copy()
    for joint, holder in rig.frame_of.items():
        moved[holder], moved[joint] = turns[joint], IDENTITY
    return moved


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


def _refusal(rig: Rig, joints: list[int]) -> str:
    names = ", ".join(f"'{rig.title(joint)}'" for joint in joints)
    return f"{names} cannot be split: {rig.rules.split_locked}. Choose --on-nonuniform-scale snap or skip."


def _noted(rig: Rig, plan: Plan, turns: Floats) -> Rig:
    """Mark in the file the turned joints whose up direction was invented, and unmark the others.

    What did not turn keeps its mark or none: nothing was invented for it now. A node has one note, so
    a joint of rigtri's own keeps what says how it was made.
    """
    notes = {node: dict(note) for node, note in rig.metadata.items()}
    moves = rotates(turns)
    for joint in (joint for joint in plan.turning if moves[joint]):
        up, own = plan.ups.get(joint), notes.get(joint, {})
        if joint in rig.own:
            continue
        if up is not None and up.step >= 7:
            notes[joint] = {"v": 1, "type": "frame", "up": up.source, "invented": True}
        elif own.get("type") == "frame" and own.get("invented"):
            del notes[joint]
    return rig if notes == rig.metadata else replace(rig, metadata=notes)
