"""Mirroring controls and pole vectors: created or updated on the other side."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.frames.mirroring import mirrored_axes
from rigtri.maths.matrices import inverse, multiply, orthonormal_axes
from rigtri.maths.quaternions import angle_between, from_axes
from rigtri.maths.triangle import bend_sine
from rigtri.maths.vectors import length, triple
from rigtri.model.constraints import constraints_of
from rigtri.model.metadata import PIVOTS, ControlRecord, OffsetRecord, PoleVectorRecord, Triple
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.control_frames import stored_style
from rigtri.operations.mirror.counterparts import (
    SAME_NUMBER,
    NotMirroredError,
    existing_twin_record,
    farthest_joint,
    mirror_each,
    of_side,
    other,
    same_values,
    twin_name,
)
from rigtri.operations.mirror_plane import TOLERANCE
from rigtri.operations.options.mirror import MirrorOptions
from rigtri.operations.rigtri_nodes import (
    add,
    find,
    group,
    remembered,
    renamed,
    stand,
    stand_local,
    unposed,
    with_record,
)
from rigtri.operations.skin_joints import add_joint, move_joint, skin_sibling_parent
from rigtri.recognition.limb_bends import NO_PLANE
from rigtri.recognition.limbs import given
from rigtri.report import Report
from rigtri.text import and_more


def mirror_controls(rig: Rig, options: MirrorOptions, report: Report) -> Rig:
    """Make the controls of the other side, or set their offsets anew, and mirror what was edited."""
    posed: list[str] = []

    def build(rig: Rig, node: int, report: Report) -> Rig:
        return _control(rig, node, rig.records(ControlRecord)[node], options, report, posed)

    def joint(node: int) -> tuple[int, int]:
        """Parents first, as the twins are children of each other."""
        here = rig.known(records[node].joint)
        there = None if here is None else other(rig, here)
        return (-1 if there is None else there), node

    records = rig.records(ControlRecord)
    nodes = [node for node in of_side(rig, options, ControlRecord) if records[node].kind != "root"]
    rig = mirror_each(rig, sorted(nodes, key=joint), "control", build, report)
    if posed:
        text = f"{and_more(posed, 6)}: takes the mirrored values at rest of the other side's controls"
        where = "at rest, and in clips where joints or channels have no keys"
        report.warn("mirror-moves", f"{text}, so the next bake gives another pose {where}")
    return rig


def _control(
    rig: Rig, node: int, record: ControlRecord, options: MirrorOptions, report: Report, posed: list[str]
) -> Rig:
    """posed: takes the names of controls that were there and get other values at rest."""
    there = existing_twin_record(rig, record)
    if record.kind in PIVOTS:  # made with the IK control that it is below
        twin = find(rig, ControlRecord, kind=record.kind, chain=there.chain)
        return rig if twin is None else _edited(rig, node, twin, options, posed)
    before = find(rig, ControlRecord, kind=record.kind, joint=there.joint)
    drawn = before is not None and rig.records(ControlRecord)[before].shape == record.shape
    shapes: Any = {record.kind: record.shape} if record.shape and not drawn else {}
    bends = _bends(rig, record, there, options) if record.kind == "ik" else {}
    frame = _frame(rig, node, before, there.joint, options)
    if record.kind == "ik" and before is not None:
        _warn_solved(rig, node, before, report)
    if record.kind == "fk":
        made = AddControlsOptions(joints=(there.joint,), shape=shapes, **frame)
    else:
        made = AddControlsOptions(
            ik=(given(rig, *there.chain),),
            shape=shapes,
            **frame,
            bend=bends,
            as_=None if before is not None else "joint" if rig.is_joint[node] else "locator",
            soft=record.soft or 0.0,
            stretch=bool(record.stretch),
            foot_roll=find(rig, ControlRecord, kind="ball", chain=record.chain) is not None or None,
        )
    rig = add_controls(rig, options=made, report=report)
    if bends:  # as on this side: nobody has said it, and there is no doubt
        report.warnings[:] = [one for one in report.warnings if one.code != "straight"]
    found = find(rig, ControlRecord, kind=record.kind, joint=there.joint)
    if found is None or rig.is_joint[found]:
        return rig  # a joint has no offset above it: it stands where the limb ends
    if before is None:
        rig = remembered(renamed(rig, found, twin_name(rig.names[node], rig.names[found])), [found])
    return _edited(rig, node, found, options, posed if before is not None else [])


def _warn_solved(rig: Rig, control: int, twin: int, report: Report) -> None:
    """Warn of clips in which IK moves the twin's limb, where that gets another softness or stretch."""
    own, other_side = rig.records(ControlRecord)[control], rig.records(ControlRecord)[twin]
    if _reach(own) != _reach(other_side) and (clips := _moving(rig, twin, other_side)):
        text = f"{rig.title(twin)} gets the softness and stretch of '{rig.title(control)}'"
        report.warn("mirror-moves", f"{text}: the next bake gives other motion in {and_more(clips, 6)}")


def _reach(record: ControlRecord) -> tuple[float, bool]:
    """How a limb reaches for an IK control: its softness, and whether it stretches."""
    return record.soft or 0.0, bool(record.stretch)


def _frame(rig: Rig, node: int, before: int | None, joint: str, options: MirrorOptions) -> dict[str, Any]:
    """What gives the twin of a control its axes: its joint's, where the control has those of its joint."""
    offset = rig.record(int(rig.parents[node]))
    if not isinstance(offset, OffsetRecord):
        return {}
    if stored_style(rig, offset) is None and offset.axes is None:
        return {"frame": "joint"}
    axes = mirrored_axes(orthonormal_axes(unposed(rig, node)), options.mode, options.across)
    if before is not None:
        apart = angle_between(from_axes(orthonormal_axes(unposed(rig, before))), from_axes(axes))
        if float(apart) <= SAME_NUMBER:
            return {}
    return {"axes": {joint: axes}}


def _bends(
    rig: Rig, record: ControlRecord, there: ControlRecord, options: MirrorOptions
) -> dict[str, Triple]:
    """Which way a straight limb bends, where its twin's pole vector knows."""
    pole = find(rig, PoleVectorRecord, chain=record.chain)
    places = [rig.world[rig.find(name), 3, :3] for name in there.chain]
    found = find(rig, PoleVectorRecord, chain=there.chain)
    if found is not None and _moving(rig, found, there):
        return {}
    if pole is None or bend_sine(*places) >= NO_PLANE:
        return {}
    away = rig.world[pole, 3, :3] - rig.world[rig.find(record.chain[1]), 3, :3]
    return {there.chain[1]: triple(options.across.directions(away))}


def _edited(rig: Rig, control: int, found: int, options: MirrorOptions, posed: list[str]) -> Rig:
    """Give a control the mirrored motion of its twin, both against their offsets.

    With O and O' the offsets in the world while controls are zero, M the reflection and L what the
    animator has set:
    L' = O'·M·O⁻¹·L·O·M·O'⁻¹. Untouched controls stay exactly as they are.
    """
    own = rig.local[control]
    if np.array_equal(own, np.eye(4)) and np.array_equal(rig.local[found], np.eye(4)):
        return rig
    here, there = (unposed(rig, int(rig.parents[node])) for node in (control, found))
    across = multiply(multiply(there, options.across.matrix), inverse(here))
    place = multiply(multiply(across, own), inverse(across))
    if not same_values(place.ravel().tolist(), rig.local[found].ravel().tolist(), farthest_joint(rig)):
        posed.append(rig.title(found))
    return stand_local(rig, found, place)


def mirror_poles(rig: Rig, options: MirrorOptions, report: Report) -> Rig:
    """Stand the pole vectors of the other side where the mirror image of this side's is."""

    def build(rig: Rig, node: int, report: Report) -> Rig:
        there = existing_twin_record(rig, rig.records(PoleVectorRecord)[node])
        return _pole(rig, node, there, options, report)

    return mirror_each(rig, of_side(rig, options, PoleVectorRecord), "pole vector", build, report)


def _pole(rig: Rig, node: int, there: PoleVectorRecord, options: MirrorOptions, report: Report) -> Rig:
    world = unposed(rig, node)
    place = options.across.points(world[3, :3])
    axes = mirrored_axes(orthonormal_axes(world), options.mode, options.across)
    found = find(rig, PoleVectorRecord, chain=there.chain)
    if found is not None and (clips := _moving(rig, found, there)):
        if length(place - unposed(rig, found)[3, :3]) > TOLERANCE * farthest_joint(rig):
            where = f"'{rig.title(found)}' at rest would change how its limb moves in {and_more(clips, 6)}"
            raise NotMirroredError(f"to move {where}")
        return rig
    # What is drawn at either is its own: another colour, and nothing where nothing was drawn.
    drawn = there if node in rig.pending.shapes else replace(there, shape="", size=None, color=None)
    new = found is None
    if found is None:
        name = twin_name(rig.names[node], f"{rig.names[rig.find(there.chain[1])] or 'limb'}_pole")
        if rig.is_joint[node]:
            parent, like = skin_sibling_parent(rig, rig.find(there.chain[0]))
            rig, found = add_joint(rig, name, parent, there, place, axes, like=like)
        else:
            rig, parent = _home(rig, node)
            rig, found = add(rig, name, parent, drawn)
            if node in rig.pending.shapes:
                shapes = {**rig.pending.shapes, found: rig.pending.shapes[node]}
                rig = replace(rig, pending=replace(rig.pending, shapes=shapes))
    old = rig.records(PoleVectorRecord)[found]
    rig = with_record(rig, found, replace(there, shape=old.shape, size=old.size, color=old.color))
    rig = (move_joint if rig.is_joint[found] else stand)(rig, found, place, axes)
    report.added.append({"node": rig.names[found], "type": "poleVector", "new": new})
    return rig


def _moving(rig: Rig, pole: int, record: PoleVectorRecord | ControlRecord) -> list[str]:
    """The clips in which IK moves a limb, counted from the rest position of its pole vector: that, the IK
    control or a pivot of the foot has keys there, or follows a constraint.
    """
    controls = rig.records(ControlRecord)
    nodes = {pole, *(node for node, each in controls.items() if each.chain == record.chain)}
    always = not nodes.isdisjoint(rule.child for rule in constraints_of(rig).values())
    return [clip.name for clip in rig.clips if always or any(track.node in nodes for track in clip.tracks)]


def _home(rig: Rig, node: int) -> tuple[Rig, int]:
    """The parent of a node's twin: the node's own parent, where that is on neither side."""
    parent = int(rig.parents[node])
    if parent < 0:
        return group(rig)
    there = other(rig, parent)
    return rig, parent if there is None else there
