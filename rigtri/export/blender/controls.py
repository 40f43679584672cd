"""Controls in Blender: FK controls, IK controls with pole vectors, and root controls.

Each joint copies its control, or a socket that rides on it where the two have other axes. The control's
offset stands where its joint would be while the control is zero: on the joint above, turned by IK where the
limb's switch is on. A joint that nothing but its control moves stands where that does, so offsets below are
children of the control, as in the file, and need no constraint. IK is solved by
bones of the script's own, which lie along the limb, for bones of a file point where their joints' axes do.
"""

from __future__ import annotations

import numpy as np

from rigtri.evaluation.ik import Ik
from rigtri.evaluation.twist_joints import twist_joints
from rigtri.evaluation.zero_pose import SAME_PLACE, FkControl
from rigtri.export.blender.plan import Plan, frame
from rigtri.maths.matrices import from_frame, transform_directions, transform_points
from rigtri.maths.quaternions import from_axis_angle, rotate
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, length, normalise
from rigtri.model.constraints import Constraint, constraints_of

# Radians by which the bones that solve IK are built bent, where a limb is straighter: Blender's solver
# bends no chain that is built straight.
_BENT = 0.1


def controls(plan: Plan, limbs: list[Ik], poles: dict[int, str]) -> None:
    """All controls of a rig. poles: what a limb's pole is, by its IK end, where a rule moves it."""
    plan.add_control_bones()
    reference = plan.reference
    solved = {joint for limb in limbs for joint in limb.limb.chain}
    # Joints that stand elsewhere than their controls have them.
    loose = {rule.child for rule in constraints_of(plan.rig).values()}
    loose |= {twist.node for twist in twist_joints(plan.rig)}
    for limb in limbs:
        _limb(plan, limb, poles.get(limb.limb.control))
    for joint, own in reference.fk.items():
        if joint not in solved:
            _fk(plan, own, loose)
    for own in reference.roots:
        if own.joint not in reference.fk and own.joint not in solved:
            _copy(plan, own.joint, own.control)


def _fk(plan: Plan, own: FkControl, loose: set[int]) -> None:
    """A control over a joint; its offset rides on the joint of the control above."""
    carrier = plan.reference.control_of.get(own.above, -1)
    if carrier in loose:
        seat = plan.ride("seat", plan.node(carrier), own.offset)
        plan.constrain(plan.node(own.offset), "COPY_TRANSFORMS", seat, _ride(plan, carrier))
    _copy(plan, own.joint, own.control)


def _copy(plan: Plan, joint: int, control: int) -> None:
    """Let a joint stand where its control does."""
    world, word = plan.reference.world, plan.node(control)
    same = np.abs(world[joint] - world[control]).max() <= SAME_PLACE * max(1.0, np.abs(world[joint]).max())
    target = word if same and plan.bone_axes(control) else plan.ride("drive", word, joint)
    plan.constrain(plan.node(joint), "COPY_TRANSFORMS", target, f"Follow {plan.called(control)}")


def _limb(plan: Plan, ik: Ik, pole: str | None) -> None:
    """Three joints: what each stands on, what IK turns it by, and its FK control on top."""
    number = len(plan.limbs)
    plan.limbs.append(plan.node(ik.limb.control))
    name = f"IK {_limb_name(plan, ik)}"
    base, upper, lower = _bones(plan, ik, pole, number)
    _, _, end = ik.limb.chain
    turns = ((base, upper), (upper, lower), (lower, lower))
    for joint, (before, after) in zip(ik.limb.chain, turns, strict=True):
        own = ik.fk.get(joint)
        stands = own.own.offset if own else joint
        above = int(plan.rig.parents[joint])
        seat = plan.ride("seat", plan.node(above), stands)
        holder = plan.node(stands) if own else plan.ride("hold", "", stands)
        plan.constrain(holder, "COPY_TRANSFORMS", seat, _ride(plan, above))
        grip = plan.ride("grip", plan.node(ik.limb.control), stands) if joint == end else ""
        if grip and ik.limb.detached:
            for kind in ("COPY_LOCATION", "COPY_ROTATION"):
                plan.constrain(holder, kind, grip, name, limb=number)
        else:
            zero, turned = (plan.ride(word, bone, stands) for word, bone in (("zero", before), ("ik", after)))
            if grip:
                plan.constrain(turned, "COPY_ROTATION", grip, name)
            plan.constrain(holder, "COPY_TRANSFORMS", turned, name, space=zero, limb=number)
        if own:
            _copy(plan, joint, own.own.control)
        else:
            plan.constrain(plan.node(joint), "COPY_TRANSFORMS", plan.ride("drive", holder, joint), name)


def _bones(plan: Plan, ik: Ik, pole: str | None, number: int) -> tuple[str, str, str]:
    """The bones that solve a limb, as words: the node above it, the upper and the lower one."""
    world, rest, above = plan.reference.world, ik.rest, ik.above
    name = plan.called(ik.limb.control)
    carrier = world[above] if above >= 0 else np.eye(4)
    first, second = (transform_directions(line, carrier) for line in rest.lines)
    side = rotate(plan.reference.world_rotation(above), rest.side)
    root = world[ik.limb.chain[0], 3, :3]
    sizes = float(length(first)), float(length(second))
    hinge = normalise(cross(first, side))
    sine = float(length(cross(normalise(first), normalise(second))))
    more = max(_BENT - sine, 0.0) / 2.0
    bent = _turned(first, hinge, more), _turned(second, hinge, -more)
    stand = from_frame(np.eye(3), root)
    base = plan.bone(f"{name} base", -1, stand, sizes[0] / 4.0)
    upper = plan.bone(f"{name} upper", base, frame(root, bent[0], side), sizes[0])
    lower = plan.bone(f"{name} lower", upper, frame(root + bent[0], bent[1], side), sizes[1])
    if above >= 0:
        hung = plan.socket(f"{name} base", plan.node(above), stand, bone=True, leads=True)
        plan.constrain(f"b{base}", "COPY_TRANSFORMS", hung, _ride(plan, above))
    if pole is None and ik.limb.pole >= 0:
        pole = plan.node(ik.limb.pole)
    elif pole is None:
        pole = plan.socket(f"{name} pole", f"b{base}", from_frame(np.eye(3), root + side), bone=True)
    plan.constrain(f"b{lower}", "IK", plan.node(ik.limb.control), f"IK {_limb_name(plan, ik)}", pole=pole)
    return f"b{base}", f"b{upper}", f"b{lower}"


def _limb_name(plan: Plan, ik: Ik) -> str:
    """What an animator calls a limb: "left arm" where it is recognised, else by its end joint."""
    return plan.limb_names.get(ik.limb.chain) or plan.called(ik.limb.chain[-1])


def _ride(plan: Plan, node: int) -> str:
    """What a constraint is called that lets something ride on a node."""
    return f"Ride on {plan.called(node)}" if node >= 0 else "Stay"


def _turned(line: Floats, hinge: Floats, angle: float) -> Floats:
    return rotate(from_axis_angle(hinge, np.float64(angle)), line) if np.isfinite(hinge).all() else line


def pole_place(plan: Plan, rule: Constraint) -> str:
    """What a rule makes the pole of a limb: the middle of points that ride on its drivers."""
    points = []
    for driver, offset, weight in zip(rule.drivers, rule.offsets, rule.weights.tolist(), strict=True):
        if weight > 0:
            place = transform_points(offset[3, :3], plan.reference.world[driver])
            stand = from_frame(np.eye(3), place)
            point = plan.socket(f"{plan.called(driver)} pole", plan.node(driver), stand, bone=True)
            points.append((point, weight, place))
    return middle(plan, f"{plan.called(rule.child)} pole", points)


def middle(plan: Plan, name: str, points: list[tuple[str, float, Floats]]) -> str:
    """A socket in the weighted middle of others, of which the places at rest are given, too."""
    total, place = 0.0, np.zeros(3)
    shares = []
    for _, weight, there in points:
        total += weight
        shares.append(weight / total)
        place = place + (there - place) * shares[-1]
    found = plan.socket(name, "", from_frame(np.eye(3), place), bone=True)
    for (point, _, _), share in zip(points, shares, strict=True):
        plan.constrain(found, "COPY_LOCATION", point, name, share=share)
    return found
