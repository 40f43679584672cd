"""Controls in Blender: FK controls, IK controls with pole vectors, and root controls.

Each joint copies its control, or a socket that rides on it where the two have other axes. The control's
offset stands where its joint would be while the control is zero: on the joint above, turned by IK where the
limb's switch is on. A joint that nothing but its control moves stands where that does, so offsets below are
children of the control, as in the file, and need no constraint. IK is solved by bones of the script's own,
as rigtri solves it: Blender's own solver iterates, and is off by up to a thousandth of the size.
"""

from __future__ import annotations

import numpy as np

from rigtri.evaluation.ik import Ik
from rigtri.evaluation.pole_lean import STRAIGHT, turning_way
from rigtri.evaluation.twist_joints import twist_joints
from rigtri.evaluation.zero_pose import SAME_POSITION, FkControl
from rigtri.export.blender.plan import Plan, Share, armature_of, frame
from rigtri.maths.matrices import from_frame, transform_directions, transform_points
from rigtri.maths.quaternions import rotate
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.constraints import Constraint, constraints_of
from rigtri.operations.solver_warnings import TURNED, turned_at_rest
from rigtri.report import Report


def controls(plan: Plan, limbs: list[Ik], poles: dict[int, str], report: Report) -> None:
    """All controls of a rig. poles: what a limb's pole is, by its IK end, where a rule moves it."""
    plan.add_control_bones()
    reference = plan.reference
    solved = {joint for limb in limbs for joint in limb.limb.chain}
    # Joints that stand elsewhere than their controls have them.
    loose = {rule.child for rule in constraints_of(plan.rig).values()}
    loose |= {twist.node for twist in twist_joints(plan.rig)}
    for limb in limbs:
        _limb(plan, limb, poles.get(limb.limb.control))
        if limb.limb.control not in poles:
            _warn_turned(plan, limb, report)
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
    """Let a joint stand where its control does, whose bone rests in the scale of the armature."""
    world, word = plan.reference.world, plan.node(control)
    place, armature = world[control].copy(), armature_of(plan.rig, joint)
    if armature >= 0 and not plan.apart:
        place[:3, :3] *= length(plan.rig.world[armature, 0, :3])
    same = np.abs(world[joint] - place).max() <= SAME_POSITION * max(1.0, np.abs(world[joint]).max())
    same = same and plan.bone_axes(joint)  # an object has other axes than the bone of its control
    target = word if same else plan.ride("drive", word, joint)
    plan.constrain(plan.node(joint), "COPY_TRANSFORMS", target, f"Follow {plan.called(control)}")


def _limb(plan: Plan, ik: Ik, pole: str | None) -> None:
    """Three joints: what each stands on, what IK turns it by, and its FK control on top."""
    number = len(plan.limbs)
    plan.limbs.append(plan.node(ik.limb.control))
    name = f"IK {_limb_name(plan, ik)}"
    base, upper, lower = _bones(plan, ik, pole, name)
    _, _, end = ik.limb.chain
    turns = ((base, upper), (upper, lower), (lower, lower))
    for joint, (before, after) in zip(ik.limb.chain, turns, strict=True):
        own = ik.fk.get(joint)
        stands = own.own.offset if own else joint
        above = int(plan.rig.parents[joint])
        seat = plan.ride("seat", plan.node(above), stands)
        holder = plan.node(stands) if own else plan.ride("hold", "", stands)
        plan.constrain(holder, "COPY_TRANSFORMS", seat, _ride(plan, above))
        grip = plan.ride("grip", plan.node(ik.limb.holder), stands) if joint == end else ""
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
    if ik.limb.toe >= 0:
        _toe(plan, ik, name, number)


def _toe(plan: Plan, ik: Ik, name: str, number: int) -> None:
    """The toe of a foot with pivots: it turns as the pivot that is next to last does, seen from the foot's.

    So what FK controls add to the foot and the leg, they add to the toe.
    """
    toe = ik.limb.toe
    stands = plan.reference.fk[toe].offset if toe in plan.reference.fk else toe
    grip = plan.ride("roll", plan.node(ik.limb.pivots[-2]), stands)
    zero, turned = (plan.ride(word, plan.node(ik.limb.holder), stands) for word in ("zero", "ik"))
    plan.constrain(turned, "COPY_ROTATION", grip, name)
    plan.constrain(plan.node(stands), "COPY_TRANSFORMS", turned, name, space=zero, limb=number)


def _bones(plan: Plan, ik: Ik, pole: str | None, name: str) -> tuple[str, str, str]:
    """The bones that solve a limb, as words: the node above it, the upper and the lower one.

    A bone at the root points at the control, with its x axis to the pole's side; below it two bones turn
    about their z axis by the angles of the triangle, which drivers compute by the law of cosines.
    """
    world, rest, above = plan.reference.world, ik.rest, ik.above
    title = plan.called(ik.limb.control)
    carrier = world[above] if above >= 0 else np.eye(4)
    root = world[ik.limb.chain[0], 3, :3]
    turn = plan.reference.world_rotation(above)
    side, line = rotate(turn, rest.side), rotate(turn, rest.root_to_end)
    lines = [transform_directions(bone, carrier) for bone in rest.lines]
    sizes = [float(length(bone)) for bone in lines]
    stand = from_frame(np.eye(3), root)
    base = plan.bone(f"{title} base", -1, stand, sizes[0] / 4.0)
    marks = [
        plan.bone(f"{title} {word}", base, from_frame(np.eye(3), root + bone), sizes[0] / 8.0)
        for word, bone in zip(("first", "second"), lines, strict=True)
    ]
    aim = plan.bone(f"{title} aim", base, frame(root, line, side), sizes[0])
    stands, last, leaning, turning = frame(root, line, side), aim, [], []
    for word, size in zip(("upper", "lower"), sizes, strict=True):
        if ik.lean:
            last = plan.bone(f"{title} {word} lean", last, stands, size)
            leaning.append(last)
        last = plan.bone(f"{title} {word}", last, stands, size)
        turning.append(last)
        stands = frame(root + sizes[0] * line, line, side)
    upper, lower = turning
    if above >= 0:
        hung = plan.socket(f"{title} base", plan.node(above), stand, bone=True, leads=True)
        plan.constrain(f"b{base}", "COPY_TRANSFORMS", hung, _ride(plan, above))
    if pole is None and ik.limb.pole >= 0:
        pole = plan.node(ik.limb.pole)
    elif pole is None:
        pole = plan.socket(f"{title} pole", f"b{base}", from_frame(np.eye(3), root + side), bone=True)
    target = plan.node(ik.limb.control)
    if ik.limb.pivots:
        ankle = from_frame(np.eye(3), world[ik.limb.control, 3, :3])
        target = plan.socket(f"{title} ankle", plan.node(ik.limb.holder), ankle, bone=True)
    words = [f"b{bone}" for bone in (base, *marks, aim, upper, lower, *leaning)]
    about = {"name": name, "bones": words, "target": target, "pole": pole, "rest": (root + side).tolist()}
    straight = ik.reach_at_rest >= 1.0 - STRAIGHT
    lean = {"lean": [ik.lean, ik.reach_at_rest, turning_way(ik.reach_at_rest)]} if ik.lean else {}
    plan.triangles.append(about | lean | ({"straight": ik.reach_at_rest} if straight else {}))
    return f"b{base}", f"b{upper}", f"b{lower}"


def _warn_turned(plan: Plan, ik: Ik, report: Report) -> None:
    """Warn of a limb that bends to another side than to its pole, and turns to it once IK moves it."""
    degrees = turned_at_rest(ik)
    if degrees > TURNED:
        limb, name = _limb_name(plan, ik), plan.rig.title(ik.limb.pole)
        text = f"The {limb} turns by {degrees:.0f}° at rest while IK moves it, to its pole '{name}'"
        report.warn("pole-elsewhere", text, joint=name)


def _limb_name(plan: Plan, ik: Ik) -> str:
    """What an animator calls a limb: "left arm" where it is recognised, else by its end joint."""
    return plan.limb_names.get(ik.limb.chain) or plan.called(ik.limb.chain[-1])


def _ride(plan: Plan, node: int) -> str:
    """What a constraint is called that lets something ride on a node."""
    return f"Ride on {plan.called(node)}" if node >= 0 else "Stay"


def pole_expression(plan: Plan, rule: Constraint) -> str:
    """What a rule makes the pole of a limb: the middle of points that ride on its drivers."""
    points = []
    for driver, offset, share in zip(rule.drivers, rule.offsets, plan.shares(rule), strict=True):
        if share:
            place = transform_points(offset[3, :3], plan.reference.world[driver])
            stand = from_frame(np.eye(3), place)
            point = plan.socket(f"{plan.called(driver)} pole", plan.node(driver), stand, bone=True)
            points.append((point, share, place))
    return middle(plan, f"{plan.called(rule.child)} pole", points)


def middle(plan: Plan, name: str, points: list[tuple[str, Share, Floats]]) -> str:
    """A socket in the weighted middle of others, with their shares (`Plan.shares`) and places at rest."""
    place = np.zeros(3)
    for number, (_, share, there) in enumerate(points):
        place = place + (there - place) * (share if isinstance(share, float) else 1.0 / (number + 1))
    found = plan.socket(name, "", from_frame(np.eye(3), place), bone=True)
    for point, share, _ in points:
        plan.constrain(found, "COPY_LOCATION", point, name, share=share)
    return found
