"""mirror: joint axes and all that rigtri has built, from one side of a character to the other.

Joints stay where they are: only their axes turn, and all that is bound to them follows.
What rigtri has built on one side is built or brought up to date on the other.

Source: `rigtri.frames.mirroring` (what each way of mirroring means).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from rigtri.errors import GeometryError
from rigtri.frames.mirroring import MIRRORS
from rigtri.frames.reoriented_constraints import changed_meaning, constraints_from_metadata, coupled_nodes
from rigtri.frames.skeleton import reference, skeleton
from rigtri.maths.matrices import nearest_rotation
from rigtri.maths.quaternions import normalise_for_storage
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.operations.constrain.constrain import NOT_VRM
from rigtri.operations.joint_selection import LONE, ROOT, WEIGHTLESS, chosen, select, warn_held
from rigtri.operations.mirror.constraints import mirror_constraints
from rigtri.operations.mirror.controls import mirror_controls, mirror_poles
from rigtri.operations.mirror.counterparts import refuse_without_sides, sided_bodies
from rigtri.operations.mirror.limbs import mirror_limbs
from rigtri.operations.mirror.pose_readers import mirror_readers
from rigtri.operations.mirror.rivets import mirror_rivets
from rigtri.operations.mirror.twists import mirror_twists
from rigtri.operations.mirror_plane import parting, warn_plane
from rigtri.operations.operation import operation
from rigtri.operations.option_kinds import Selection
from rigtri.operations.options.mirror import WHAT, What
from rigtri.operations.options.mirror import MirrorOptions as MirrorOptions
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.recognition.one_character import within
from rigtri.recognition.sides import side_of, twin_of, unpaired
from rigtri.report import Report
from rigtri.text import and_more


@operation(MirrorOptions)
def mirror(rig: Rig, *, options: MirrorOptions, report: Report) -> Rig:
    """Mirror axes, and what rigtri has built, from one side onto the other; create what is missing.

    What is there already is brought up to date; a second run changes nothing. Records go to
    ``report.joints``, ``report.added`` and ``report.limbs``; what cannot be mirrored is a warning
    (``not-mirrored``). Raises GeometryError where nothing here has a side, NameNotFoundError, UsageError.
    """
    known = list(zip(rig.keys, rig.labels, strict=True))
    sided = [[known[k] for k in nodes] for nodes in sided_bodies(rig, options.selection)]
    for nodes in sided:  # each about its own plane; nodes may have come between those of the next
        places = {both: k for k, both in enumerate(zip(rig.keys, rig.labels, strict=True))}
        alone = frozenset(places[both] for both in nodes)
        rig = within(rig, alone, partial(_one, options=options, report=report))
    return rig if sided else _one(rig, options, report)


def _one(rig: Rig, options: MirrorOptions, report: Report) -> Rig:
    """The rig with one character mirrored."""
    tree = skeleton(rig, options.root)
    refuse_without_sides(rig, tree.joints)
    ref = reference(tree, options.pose)
    parted = parting(tree, ref, tree.joints, options.plane, options.from_side, options.plane_at)
    warn_plane(options.plane_at, parted, report)
    options = replace(options, across=parted.across)
    before, known = rig, len(report.warnings)
    rig = _mirrored(rig, options, report)
    _refuse_turned_constraints(before, rig)
    if any(notice.code == NOT_VRM for notice in report.warnings[known:]):
        _warn_modes(before, options, report)
    return rig


def _mirrored(rig: Rig, options: MirrorOptions, report: Report) -> Rig:
    for what in WHAT:
        if what in (options.what or WHAT):
            rig = _STEPS[what](rig, options, report)
    return rig


def _refuse_turned_constraints(before: Rig, after: Rig) -> None:
    """GeometryError where a node constraint of others ties what was built to axes that mirroring changes."""
    ours = constraints_from_metadata(before)
    foreign = [c for c in before.node_constraints if c.key is not None and ours.get(c.node) != c.kind]
    tied = [c for c in foreign if {c.node, c.source, *(coupled_nodes(before, c) or ())} & before.own]
    if not tied:
        return
    places = {key: node for node, key in enumerate(after.keys) if key is not None}
    nodes = np.array([places.get(key, -1) for key in before.keys])
    axes = nearest_rotation(before.world), nearest_rotation(after.world)
    there = {c.key: c for c in after.node_constraints}
    for c in tied:
        if c.key in there and (change := changed_meaning(before, c, there[c.key], nodes, axes)):
            child, driver = before.title(c.node), before.title(c.source)
            raise GeometryError(
                f"The {c.kind} constraint of '{child}' by '{driver}', which is not rigtri's, {change} once "
                "what is built here is mirrored. Take it out of the file and mirror again, or name what to "
                "mirror with --what"
            )


def _warn_modes(rig: Rig, options: MirrorOptions, report: Report) -> None:
    """Say which other modes lose no VRM node constraint, where some do not."""
    found = []
    for mode in MIRRORS:
        built_report = Report()
        if mode != options.mode:
            _mirrored(rig, replace(options, mode=mode), built_report)
            if all(notice.code != NOT_VRM for notice in built_report.warnings):
                found.append(f"--mode {mode}")
    if found:
        text = f"{' or '.join(found)} keeps the VRM node constraints that --mode {options.mode} loses"
        report.warn("mode-keeps-vrm", text)


def _joints(rig: Rig, options: MirrorOptions, report: Report) -> Rig:
    """Turn the joints of the other side onto the mirrored axes of this side's.

    Where no joint may have axes of its own both sides have the world's, and what is built is mirrored alone.
    """
    if locked := rig.rules.orient_locked:
        if "joints" in options.what or not rig.metadata:
            raise GeometryError(f"{locked}, so the axes of no joint are mirrored")
        report.warn("not-mirrored", f"Joints keep their axes: {locked}. What is built on them is mirrored.")
        return rig
    both = _both_sides(rig, options, report)
    if not both.named:
        return rig
    oriented = OrientJointsOptions(
        keep=True,
        mirror=options.mode,
        from_side=options.from_side,
        across=options.across,
        joints=both.joints,
        on_nonuniform_scale=options.on_nonuniform_scale,
        on_constraint=options.on_constraint,
        pose=options.pose,
        root=options.root,
        tolerance=options.tolerance,
    )
    return _as_written(orient_joints(rig, options=oriented, report=report), rig)


def _as_written(rig: Rig, before: Rig) -> Rig:
    """Turned rotations made unit, as they are when they are written: what is derived next is from those.

    A second run reads the written ones, and must find everything where it is.
    """
    # By key, as nodes may have come between others, to hold axes or attachments; new ones have none.
    was: dict[object, list[Floats]] = {}
    for key, rotation in zip(before.keys, before.rotation, strict=True):
        was.setdefault(key, []).append(rotation)
    same = [
        any((old == own).all() for old in was.get(key, ()))
        for key, own in zip(rig.keys, rig.rotation, strict=True)
    ]
    turned = ~np.array(same, dtype=bool)[:, np.newaxis]
    return replace(rig, rotation=np.where(turned, normalise_for_storage(rig.rotation), rig.rotation))


def _both_sides(rig: Rig, options: MirrorOptions, report: Report) -> Selection:
    """The joints on either side that may turn, of those that the user has named; all unless any are.

    Warns of joints of the other side that the file holds in place.
    """
    tree = skeleton(rig, options.root)
    turning, kept = select(tree, reference(tree, options.pose), Selection())
    # A twin may be turned for its own sake, where orient-joints has no reason to.
    may = {*turning, *(joint for joint, why in kept.items() if why in (ROOT, WEIGHTLESS, LONE))}
    named = set(chosen(tree, options.selection))
    named |= {other for joint in named if (other := twin_of(rig, joint)) is not None}
    sides = {joint: side for joint in tree.joints if joint in named and (side := side_of(rig, joint))}
    warn_held(rig, {k: kept[k] for k in sides if k in kept and sides[k] != options.from_side}, report)
    lost = [chain for chain in unpaired(rig) if named.intersection(chain.joints)]
    if lost:
        names = [f"{chain.name} ({rig.chain_title(chain.bend or chain.joints)})" for chain in lost]
        report.warn(
            "not-mirrored",
            f"{and_more(names, 4)}: nothing shows surely which joints of the other side are the twins of "
            "those there, so their axes are not mirrored. Names with sides say it",
            names=names,
        )
    joints = [joint for joint in sides if joint in may]
    return Selection(joints=tuple(rig.address(joint) for joint in joints))


_STEPS: Mapping[What, Callable[[Rig, MirrorOptions, Report], Rig]] = {
    "limbs": mirror_limbs,
    "joints": _joints,
    "controls": mirror_controls,
    "polevectors": mirror_poles,
    "twists": mirror_twists,
    "constraints": mirror_constraints,
    "rivets": mirror_rivets,
    "posereaders": mirror_readers,
}
