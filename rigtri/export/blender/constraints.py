"""Constraints and twist joints in Blender: the constraint of the same meaning for each, or none.

What follows stands on sockets that ride on its drivers, so that offsets are places and no numbers of a
constraint, and one that is seen from a node's own space is made of two sockets.
"""

from __future__ import annotations

import numpy as np

from rigtri.evaluation.constraint_solver import nearest_rotation_of
from rigtri.evaluation.twist_joints import TwistJoint
from rigtri.export.blender.controls import middle
from rigtri.export.blender.plan import Plan, Share, frame, left_out
from rigtri.maths.matrices import from_frame, multiply, orthonormal_axes, transform_directions
from rigtri.maths.quaternions import conjugate, rotate, to_axes
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross
from rigtri.model.constraints import Constraint
from rigtri.model.metadata import ROTATION, SCALE, TRANSLATION
from rigtri.report import Report

_GROUPS = {"t": TRANSLATION, "r": ROTATION, "s": SCALE}
_COPIES = {"t": "COPY_LOCATION", "r": "COPY_ROTATION", "s": "COPY_SCALE"}


def follow(plan: Plan, rule: Constraint, report: Report) -> None:
    """A rule as constraints of its child; a warning where Blender has no equivalent."""
    child = plan.rig.title(rule.child)
    if not rule.active or not rule.sets:
        return
    if any(0 < len(rule.skip & set(group)) < 3 for group in _GROUPS.values()):
        left_out(report, f"the {rule.kind} constraint of '{child}', of which some axes are skipped")
        return
    mixed = set(rule.drivers) if rule.weight_nodes else set(np.flatnonzero(rule.weights).tolist())
    if len(mixed) > 2 and rule.kind in ("parent", "orient"):
        text = f"'{child}' follows more than two drivers; Blender mixes their turns one after another"
        report.warn("blender-differs", text, joint=child)
    if rule.kind == "aim":
        _aim(plan, rule)
        return
    for driver, offset, share in zip(rule.drivers, rule.offsets, plan.shares(rule), strict=True):
        if share:
            _FOLLOWS[rule.kind](plan, rule, driver, offset, share)


def _parent(plan: Plan, rule: Constraint, driver: int, offset: Floats, share: Share) -> None:
    stand = multiply(offset, plan.reference.world[driver])
    name = f"{plan.called(rule.child)} parent"
    bone = plan.bone_axes(rule.child)
    socket = plan.socket(name, plan.node(driver), stand, bone=bone, child=rule.child)
    letters = sorted({channel[0] for channel in rule.sets}, key="trs".index)
    kinds = ["COPY_TRANSFORMS"] if len(letters) == 3 else [_COPIES[letter] for letter in letters]
    for kind in kinds:
        plan.constrain(plan.node(rule.child), kind, socket, f"Parent {plan.called(driver)}", share=share)


def _point(plan: Plan, rule: Constraint, driver: int, offset: Floats, share: Share) -> None:
    name = f"{plan.called(rule.child)} point"
    start = from_frame(np.eye(3), plan.reference.world[driver, 3, :3])
    there = plan.socket(name, "", start, bone=True)
    plan.constrain(there, "COPY_LOCATION", plan.node(driver), f"Point {plan.called(driver)}")
    stand = from_frame(np.eye(3), start[3, :3] + offset[3, :3])
    socket = plan.socket(f"{name} offset", there, stand, bone=True)
    plan.constrain(
        plan.node(rule.child), "COPY_LOCATION", socket, f"Point {plan.called(driver)}", share=share
    )


def _orient(plan: Plan, rule: Constraint, driver: int, offset: Floats, share: Share) -> None:
    if rule.space != "world":
        _locally(plan, rule, driver, offset, share)
        return
    turn = product(nearest_rotation_of(plan.reference.world[driver]), nearest_rotation_of(offset))
    stand = from_frame(to_axes(turn), plan.reference.world[driver, 3, :3])
    name, bone = f"{plan.called(rule.child)} orient", plan.bone_axes(rule.child)
    socket = plan.socket(name, plan.node(driver), stand, bone=bone)
    plan.constrain(
        plan.node(rule.child), "COPY_ROTATION", socket, f"Orient {plan.called(driver)}", share=share
    )


def _locally(plan: Plan, rule: Constraint, driver: int, offset: Floats, share: Share) -> None:
    """A rotation relative to the driver's parent: what one socket sees of the other is the child's turn
    from rest, in its own axes; of a roll, with y along the axis of the roll."""
    rig, world, child = plan.rig, plan.reference.world, rule.child
    above, place = int(rig.parents[driver]), world[driver, 3, :3]
    hung, own = plan.reference.world_rotation(above), nearest_rotation_of(plan.reference.local[driver])
    rolls = rule.space == "roll"
    first = (
        rule.rest
        if rolls
        else product(conjugate(nearest_rotation_of(offset)), nearest_rotation_of(plan.reference.local[child]))
    )
    second = product(own, nearest_rotation_of(offset)) if rolls else own
    stands = [from_frame(to_axes(product(hung, turn)), place) for turn in (first, second)]
    axis = np.eye(3)["xyz".index(rule.roll)] if rolls else np.zeros(3)
    if rolls:
        stands = [multiply(frame(np.zeros(3), axis, np.zeros(3)), stand) for stand in stands]
    name, bone = f"{plan.called(child)} {rule.space}", rolls or plan.bone_axes(child)
    zero = plan.socket(f"{name} zero", plan.node(above), stands[0], bone=bone)
    turned = plan.socket(name, plan.node(driver), stands[1], bone=bone)
    if rolls:
        line = rotate(plan.reference.world_rotation(child), axis)
        _turn_about(
            plan, child, f"{name} axis", turned, zero, line, 1.0, f"Roll {plan.called(driver)}", share=share
        )
        return
    hold = plan.ride("local", plan.node(int(rig.parents[child])), child)
    label = f"Orient {plan.called(driver)}"
    plan.constrain(hold, "COPY_TRANSFORMS", turned, label, space=zero)
    plan.constrain(plan.node(child), "COPY_ROTATION", hold, label, share=share)


def _scale(plan: Plan, rule: Constraint, driver: int, offset: Floats, share: Share) -> None:
    world = plan.reference.world[driver]
    stand = world.copy()
    stand[:3, :3] = world[:3, :3] * np.diagonal(offset)[:3, np.newaxis]
    name, bone = f"{plan.called(rule.child)} scale", plan.bone_axes(rule.child)
    socket = plan.socket(name, plan.node(driver), stand, bone=bone, child=rule.child)
    plan.constrain(plan.node(rule.child), "COPY_SCALE", socket, f"Scale {plan.called(driver)}", share=share)


_FOLLOWS = {"parent": _parent, "point": _point, "orient": _orient, "scale": _scale}


def _aim(plan: Plan, rule: Constraint) -> None:
    """A socket whose y axis tracks the target, and its z axis what is up; the child rides on it."""
    rig, world = plan.rig, plan.reference.world
    child, above = rule.child, int(rig.parents[rule.child])
    name, place = plan.called(child), world[child, 3, :3]
    drivers = zip(rule.drivers, plan.shares(rule), strict=True)
    points = [(plan.node(node), share, world[node, 3, :3]) for node, share in drivers if share]
    target = points[0][0] if len(points) == 1 else middle(plan, f"{name} aim", points)
    turn = product(plan.reference.world_rotation(above), rule.rest)
    aim, up = (rotate(turn, np.asarray(axis, dtype=np.float64)) for axis in (rule.aim, rule.up))
    stand = frame(place, aim, cross(aim, up))
    hung = plan.node(above)
    tracker = plan.socket(f"{name} tracker", hung, stand, bone=True)
    label = f"Aim {', '.join(plan.called(node) for node in rule.drivers)}"
    plan.constrain(tracker, "DAMPED_TRACK", target, label, track_axis="TRACK_Y")
    if rule.world_up != "none":
        top = _top(plan, rule, hung, place)
        plan.constrain(tracker, "LOCKED_TRACK", top, "Up", track_axis="TRACK_Z", lock_axis="LOCK_Y")
    own = from_frame(to_axes(product(turn, nearest_rotation_of(rule.offsets[0]))), place)
    socket = plan.socket(f"{name} aimed", tracker, own, bone=plan.bone_axes(child))
    plan.constrain(plan.node(child), "COPY_ROTATION", socket, label)


def _top(plan: Plan, rule: Constraint, hung: str, place: Floats) -> str:
    """What the up axis of an aim leans to: a node, or a socket in a direction from the child."""
    if rule.world_up == "object":
        return plan.node(rule.up_object)
    name = plan.called(rule.child)
    here = plan.socket(f"{name} here", hung, from_frame(np.eye(3), place), bone=True)
    axes, vector = np.eye(3), np.asarray(rule.up_vector, dtype=np.float64)
    if rule.world_up == "objectrotation":
        axes = orthonormal_axes(plan.reference.world[rule.up_object])
        vector = transform_directions(vector, plan.reference.world[rule.up_object])
    origin = plan.socket(f"{name} up from", "", from_frame(axes, place), bone=True)
    plan.constrain(origin, "COPY_LOCATION", here, "Up")
    if rule.world_up == "objectrotation":
        leader = from_frame(axes, plan.reference.world[rule.up_object, 3, :3])
        turned = plan.socket(f"{name} up turn", plan.node(rule.up_object), leader, bone=True)
        plan.constrain(origin, "COPY_ROTATION", turned, "Up")
    return plan.socket(f"{name} up", origin, from_frame(np.eye(3), place + vector), bone=True)


def twist(plan: Plan, found: TwistJoint) -> None:
    """A twist joint: its share of the turn of its driver about the bone."""
    rig, world = plan.rig, plan.reference.world
    driver = found.path[0]
    below = int(rig.parents[found.path[-1]])
    line = transform_directions(found.axis, world[below]) if below >= 0 else found.axis
    stand = frame(world[driver, 3, :3], line, np.zeros(3))
    name = f"{plan.called(found.node)} twist"
    zero = plan.socket(f"{name} zero", plan.node(below), stand, bone=True)
    turned = plan.socket(name, plan.node(driver), stand, bone=True)
    above = int(rig.parents[found.node])
    own = transform_directions(found.own_axis, world[above]) if above >= 0 else found.own_axis
    label = f"Twist {plan.called(driver)}"
    _turn_about(plan, found.node, f"{name} axis", turned, zero, own, found.weight, label)


def _turn_about(
    plan: Plan,
    child: int,
    name: str,
    turned: str,
    zero: str,
    line: Floats,
    weight: float,
    label: str,
    *,
    share: Share = 1.0,
) -> None:
    """A socket on the child's parent rotates about a line as ``turned`` twists about its y axis."""
    above = int(plan.rig.parents[child])
    stand = frame(plan.reference.world[child, 3, :3], line, np.zeros(3))
    # Blender's local space of an object is its parent, so that has to stand in the same frame.
    holder = plan.socket(f"{name} frame", plan.node(above), stand, bone=True)
    turner = plan.socket(name, holder, stand, bone=True)
    plan.constrain(turner, "TRANSFORM", turned, label, space=zero, weight=weight)
    own = plan.ride("twisted", turner, child)
    plan.constrain(plan.node(child), "COPY_ROTATION", own, label, share=share)


def without_equivalent(plan: Plan, report: Report) -> None:
    """Warnings for what rigtri has noted that no constraint of Blender's can do."""
    rig = plan.rig
    for node, note in sorted(rig.metadata.items()):
        title, kind = rig.title(node), note.get("type")
        if kind == "control" and note.get("soft"):
            left_out(report, f"the softness of '{title}'; its limb snaps straight")
        if kind == "control" and note.get("stretch"):
            left_out(report, f"the stretch of '{title}'; its limb ends where it is straight")
