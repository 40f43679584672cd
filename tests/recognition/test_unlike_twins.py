"""Bodies of which one joint of one side is misspelt, one too many, or missing: nothing wrong is sure."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import pytest
from recognition_bodies.skeletons import FINGERS, MAN, Joint, both, line, rig_with

from rigtri.recognition.recognise import recognise

_WORDS = {
    "plain": {"upper_arm": "{} Arm", "forearm": "{} Forearm", "hand": "{} Hand"},
    "game": {"upper_arm": "UpperArm_{}", "forearm": "LowerArm_{}", "hand": "Hand_{}"},
    "counted": {"upper_arm": "arm_joint_{}_1", "forearm": "arm_joint_{}_2", "hand": "arm_joint_{}_3"},
}
_LEGS = {
    "plain": {"thigh": "{} Thigh", "shin": "{} Shin", "foot": "{} Foot", "toe": "{} Toe"},
    "game": {"thigh": "Thigh_{}", "shin": "Calf_{}", "foot": "Foot_{}", "toe": "Ball_{}"},
    "counted": {"thigh": "leg_joint_{}_1", "shin": "leg_joint_{}_2", "foot": "leg_joint_{}_3", "toe": "t_{}"},
}
_SIDES = {"plain": ("Left", "Right"), "game": ("l", "r"), "counted": ("L", "R")}
_LIMBS = {("arm", "upper_arm forearm hand"), ("leg", "thigh shin foot")}
_ODD = ("{} Twits 1", "{}_twst", "{}1", "{}_socket", "{}_sleeve", "{}_rol", "", "Object_99", "xyzzy")


def _called(words: str, joints: list[Joint]) -> list[Joint]:
    """The joints with the names of a scheme."""
    left, right = _SIDES[words]

    def name(own: str) -> str:
        bone, _, side = own.partition(".")
        known = (_WORDS[words] | _LEGS[words]).get(bone)
        return known.format(left if side == "L" else right) if known else own

    return [(name(own), name(above), place) for own, above, place in joints]


def _with_joint(joints: list[Joint], below: str, part: float) -> list[Joint]:
    """The joints with one more, "odd", on the bone to ``below``, so far along it."""
    at = {own: place for own, _, place in joints}
    over = next(above for own, above, _ in joints if own == below)
    x, y, z = (a + part * (b - a) for a, b in zip(at[over], at[below], strict=True))
    found = list[Joint]()
    for own, above, place in joints:
        found += [("odd", over, (x, y, z)), (own, "odd", place)] if own == below else [(own, above, place)]
    return found


def _surely_wrong(words: str, joints: list[Joint], *, odd: str = "", lost: str = "") -> Iterator[str]:
    """The sure arms and legs that are none of the body.

    odd: what the joint "odd" is called. lost: a joint that the body lacks.
    """
    left, right = _SIDES[words]
    known, meant = _WORDS[words] | _LEGS[words], set[tuple[str, ...]]()
    for (kind, bones), (side, called) in ((k, s) for k in _LIMBS for s in (("left", left), ("right", right))):
        names = [known[bone].format(called) for bone in bones.split()]
        if lost not in names:
            meant.add((kind, side, *names))
    rig = rig_with(joints)
    rig = replace(rig, names=tuple(odd if name == "odd" else name for name in rig.names))
    for chain in recognise(rig).chains:
        found = (chain.kind, chain.side, *(rig.names[joint] for joint in chain.bend))
        if chain.kind in ("arm", "leg") and chain.bend and chain.is_sure and found not in meant:
            yield str(found)


@pytest.mark.parametrize("words", _WORDS)
@pytest.mark.parametrize("body", ["plain", "fingers"])
def test_a_joint_more_of_one_side_whatever_it_is_called_makes_nothing_sure_that_is_wrong(
    words: str, body: str
) -> None:
    """Before, a misspelt twist joint was the elbow, and sure."""
    joints = _called(words, [*MAN, *(FINGERS if body == "fingers" else [])])
    names = {own for own, _, _ in _called(words, [*MAN])}
    right = [joint for joint in joints if joint[0] in names and joint[1] and joint[2][0] < 0.0]
    for first, (below, over, _) in enumerate(right):
        for part, odd in list(product((0.3, 0.5, 0.7), _ODD))[first % 3 :: 3]:
            changed = _with_joint(joints, below, part)
            wrong = list(_surely_wrong(words, changed, odd=odd.format(over)))
            assert not wrong, (below, odd, part)


def test_a_finger_of_one_hand_has_a_joint_more() -> None:
    """Before, recognition broke where the midmost fingers of both hands had not as many joints."""
    joints = _called("plain", [*MAN, *FINGERS])
    for below in [own for own, _, _ in FINGERS if own.endswith(".R")]:
        assert not list(_surely_wrong("plain", _with_joint(joints, below, 0.7), odd="Object_99"))


@pytest.mark.parametrize("words", _WORDS)
def test_a_joint_that_one_side_lacks_makes_no_other_of_that_limb_sure(words: str) -> None:
    joints = _called(words, [*MAN, *FINGERS])
    known = _WORDS[words] | _LEGS[words]
    for bone in ("upper_arm", "forearm", "hand", "thigh", "shin", "foot"):
        for side in _SIDES[words]:
            lost = known[bone].format(side)
            above = next(over for own, over, _ in joints if own == lost)
            left = [(own, above if over == lost else over, at) for own, over, at in joints if own != lost]
            assert not list(_surely_wrong(words, left, lost=lost)), lost


@pytest.mark.parametrize("misspelt", ["{} Arm Twits 1", "{}_arm_twst", "Object_7", ""])
@pytest.mark.parametrize("side", ["Left", "Right"])
def test_a_twist_joint_of_both_sides_that_is_misspelt_on_one_is_no_elbow(side: str, misspelt: str) -> None:
    twisted = both(
        line(
            "clavicle.L upper_arm.L twist.L forearm.L hand.L",
            "chest",
            (0.04, 1.45, 0),
            (0.16, 1.45, 0),
            (0.3, 1.45, 0),
            (0.44, 1.45, -0.005),
            (0.7, 1.45, 0),
        )
    )
    trunk_and_legs = [joint for joint in MAN if not joint[0].startswith(("clav", "upper", "fore", "hand"))]
    joints = _called("plain", [*trunk_and_legs, *twisted, *FINGERS])
    names = {"twist.L": "Left Arm Twist 1", "twist.R": "Right Arm Twist 1"}
    names |= {f"twist.{side[0]}": "odd"}
    changed = [(names.get(own, own), names.get(above, above), at) for own, above, at in joints]
    assert not list(_surely_wrong("plain", changed, odd=misspelt.format(side)))


@pytest.mark.parametrize("part", [0.5, 0.7, 0.75, 0.8])
@pytest.mark.parametrize("far", [1.0, 1.1, 1.2])
def test_a_joint_above_a_leg_of_two_joints_begins_no_sure_leg(far: float, part: float) -> None:
    """Before, it did where what it left of its bone was about as long as the leg."""
    beetle = [
        *line("hub body eyes", "", (0, 0, 0), (0, 0.45, 0), (0, 0.51, 0.48)),
        *both(line("front_leg.L front_leg2.L", "hub", (far, 0.45, 0.63), (far, 0.05, 0.63))),
        *both(line("hind_leg.L hind_leg2.L", "hub", (far + 0.15, 0.45, -0.65), (far + 0.15, 0.05, -0.65))),
    ]
    for below in ("front_leg.R", "front_leg.L", "hind_leg.R"):
        joints = _with_joint(beetle, below, part)
        for chain in recognise(rig_with(joints)).chains:
            assert "odd" not in [joints[k][0] for k in chain.joints] or not chain.is_sure, (below, chain)
