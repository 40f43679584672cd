"""Bones that the file parents beside one another, or the wrong way round: what follows is not sure."""

from __future__ import annotations

import pytest
from recognition_bodies.skeletons import ARM, FINGERS, MAN, TRUNK, Joint, both, line, rig_with

from rigtri.recognition.joint_tree import Tree, segments_of
from rigtri.recognition.layout import Chain
from rigtri.recognition.recognise import recognise

WITH_HANDS = [*MAN, *both(FINGERS)]


def parented(joints: list[Joint], above: dict[str, str]) -> list[Joint]:
    """The joints, those that are named before a dot below others of their side, or of the trunk."""
    found = []
    for name, over, place in joints:
        part, _, side = name.partition(".")
        new = above.get(part, "")
        sided = f"{new}.{side}" if any(k == f"{new}.{side}" for k, _, _ in joints) else new
        found.append((name, sided or over, place))
    order: list[str] = [""]
    for name in order:  # it grows as it is walked
        order += [joint for joint, over, _ in found if over == name]
    return sorted(found, key=lambda joint: order.index(joint[0]))


def limbs(joints: list[Joint], *, named: bool = False) -> list[Chain]:
    found = recognise(rig_with(joints, named=named)).characters
    return [chain for each in found for chain in each.chains if chain.kind in ("arm", "leg", "wing")]


def sure(joints: list[Joint], *, named: bool = False) -> set[tuple[str, ...]]:
    """The joints of each sure limb, by name."""
    return {
        tuple(joints[k][0] for k in one.bend or one.joints)
        for one in limbs(joints, named=named)
        if one.is_sure
    }


def test_hands_below_the_chest_are_no_arms_where_arms_stand_alone_beside_them() -> None:
    """Before, palm and fingers were an arm at 0.81."""
    joints = parented(WITH_HANDS, dict.fromkeys(("clavicle", "upper_arm", "forearm", "hand"), "chest"))
    assert not [each for each in sure(joints) if each[0].startswith("hand")]


def test_a_limb_that_is_parented_the_wrong_way_round_is_not_sure() -> None:
    joints = parented(MAN, {"hand": "chest", "forearm": "hand", "upper_arm": "forearm"})
    assert not [each for each in sure(joints) if "forearm.L" in each]


def test_a_guess_of_a_hierarchy_is_not_sure_beside_further_limbs() -> None:
    """Of four arms without a hierarchy each joint may be nearest to one of another arm."""
    lower = both(line("a.L b.L c.L", "spine", (0.15, 1.3, 0), (0.4, 1.25, 0), (0.65, 1.2, 0.1)))
    flat = [(name, "hips" if k else "", at) for k, (name, _, at) in enumerate([*MAN, *lower])]
    assert not [each for each in sure(flat) if {"forearm.L", "b.L"} & {*each}]


@pytest.mark.parametrize("name", ["forearm.L_offset", "forearm.L_grp", "grp_forearm.L"])
def test_what_only_holds_a_joint_is_called_so_and_is_no_joint_of_the_limb(name: str) -> None:
    """Before, ``forearm.L_offset`` was the elbow above ``forearm.L``, at 0.99."""
    arm = [(name, "upper_arm.L", at) for called, _, at in ARM if called == "forearm.L"]
    joints = [(called, name if called == "forearm.L" else over, at) for called, over, at in MAN]
    at = [called for called, _, _ in joints].index("forearm.L")
    joints = [*joints[:at], *arm, *joints[at:]]
    assert ("upper_arm.L", "forearm.L", "hand.L") in sure(joints, named=True)


def test_a_group_is_a_joint_where_no_other_has_its_name() -> None:
    rig = rig_with(
        [*TRUNK, *line("upper_arm_grp.L forearm_grp.L hand_grp.L", "chest", *(k[2] for k in ARM[1:]))]
    )
    assert not segments_of(Tree(rig, range(len(rig)), rig.world[:, 3, :3]))


def test_a_limb_of_two_joints_is_not_sure_beside_another_joint_that_is_called_as_one_of_it() -> None:
    """Before, a crab's ``tibia`` and ``tarsus``, parented above its ``femur``, were a leg at 0.94."""
    legs = [
        (f"{part}_{pair}.L", over and f"{over}_{pair}.L", (x, y, 0.2 * pair))
        for pair in range(4)
        for part, over, x, y in (
            ("tarsus", "", 0.6, 0.0),
            ("tibia", "tarsus", 0.35, 0.4),
            ("femur", "tibia", 0.1, 0.3),
        )
    ]
    body = [("thorax", "", (0.0, 0.3, 0.3)), ("head", "thorax", (0.0, 0.3, 0.9))]
    joints = [*body, *both([(name, over or "thorax", at) for name, over, at in legs])]
    assert not sure(joints, named=True)


def test_the_head_of_an_easel_is_not_sure() -> None:
    joints = [("head", "", (0.0, 1.6, 0.0)), ("tray", "head", (0.0, 0.8, 0.15))]
    joints += both(
        line("leg_1.L leg_2.L leg_3.L", "head", (0.03, 1.58, 0.02), (0.25, 0.8, 0.1), (0.42, 0, 0.2))
    )
    found = recognise(rig_with(joints)).characters
    assert not [chain for each in found for chain in each.chains if chain.kind == "head" and chain.is_sure]


def test_a_wing_is_not_sure_whose_first_bones_stand_alone_beside_it() -> None:
    places = ((0.1, 1.4, -0.1), (0.4, 1.5, -0.1), (0.7, 1.45, -0.1), (1.0, 1.4, -0.1))
    chain = both(line("wing_1.L wing_2.L wing_3.L wing_4.L", "chest", *places))
    flat = parented([*MAN, *chain], {"wing_1": "chest", "wing_2": "chest", "wing_3": "chest"})
    for joints, expected in (([*MAN, *chain], True), (flat, False)):
        assert [k.is_sure for k in limbs(joints, named=True) if k.kind == "wing"] == [expected] * 2


def test_a_leg_is_not_sure_to_end_where_another_joint_stands_on_beyond_it_in_the_file() -> None:
    """Before, thigh, a piece of the thigh and shin were a leg at 0.94, and the foot was left over."""
    pieces = both([("piece_a.L", "thigh.L", (0.1, 0.73, 0.01)), ("piece_b.L", "shin.L", (0.1, 0.3, 0.01))])
    joints = parented([*MAN, *pieces], {"shin": "hips", "foot": "hips"})
    assert ("thigh.L", "piece_a.L", "shin.L") not in sure(joints)


def test_what_helps_a_joint_by_its_name_is_not_surely_the_joint() -> None:
    """Before, of joints that all hang at one, ``front_lower_leg_corrective`` was a knee at 0.99."""
    legs = [
        joint
        for end, z in (("front", 0.5), ("hind", -0.5))
        for joint in (
            (f"{end}_upper_leg.L", "", (0.1, 0.8, z)),
            (f"{end}_lower_leg.L", "", (0.1, 0.4, z - 0.01)),
            (f"{end}_lower_leg_corrective.L", "", (0.1, 0.4, z + 0.03)),
            (f"{end}_foot.L", "", (0.1, 0.05, z)),
        )
    ]
    trunk = [("hips", (0, 0.9, -0.5)), ("spine", (0, 0.9, 0)), ("neck", (0, 1, 0.7)), ("head", (0, 1.2, 0.9))]
    joints = [("root", "", (0.0, 0.0, 0.0)), *((name, "root", at) for name, at in trunk)]
    joints += both([(name, "root", at) for name, _, at in legs])
    assert not [each for each in sure(joints, named=True) if "corrective" in each[1]]
