"""Bones that the file parents beside one another, or the wrong way round: what follows is not sure."""

from __future__ import annotations

import pytest
from recognition_bodies.skeletons import (
    ARM,
    FINGERS,
    MAN,
    TRUNK,
    Joint,
    both,
    line,
    renamed,
    rig_with,
)

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


FLAT_LEGS = {"shin": "hips", "foot": "hips"}
BESIDE = [
    FLAT_LEGS,
    {"forearm": "chest", "hand": "chest"},
    {"upper_arm": "chest", "forearm": "chest", "hand": "chest"},
    {"thigh": "root", "shin": "root", "foot": "root", "upper_arm": "root", "forearm": "root", "hand": "root"},
]
FOUR = {
    tuple(f"{bone}.{side}" for bone in bones)
    for side in "LR"
    for bones in (("upper_arm", "forearm", "hand"), ("thigh", "shin", "foot"))
}
ROOT: list[Joint] = [("root", "", (0.0, 0.0, 0.0))]
HORSE = [
    *line("hips spine chest neck head", "", (0, 1, -0.6), (0, 1, 0), (0, 1, 0.5), (0, 1.2, 0.8), (0, 1.4, 1)),
    *both(
        [
            (f"{end}_{part}.L", above, (0.12, y, z + dz))
            for end, above, z in (("front", "chest", 0.5), ("hind", "hips", -0.6))
            for part, y, dz in (("upper_leg", 0.9, 0.0), ("lower_leg", 0.5, 0.06), ("foot", 0.1, 0.0))
        ]
    ),
]


@pytest.mark.parametrize("above", BESIDE, ids=" ".join)
def test_names_tell_which_joint_follows_where_the_file_has_them_side_by_side(above: dict[str, str]) -> None:
    """Before, arms whose forearms and hands hang at the chest were missing though each joint is called so."""
    joints = [*ROOT, *((name, over or "root", at) for name, over, at in WITH_HANDS)]
    assert sure(parented(joints, above), named=True) == FOUR


def test_names_tell_which_joint_follows_in_the_legs_of_animals() -> None:
    """All joints of each leg hang at the hips or the chest, in no order."""
    expected = {
        (f"{end}_upper_leg.{side}", f"{end}_lower_leg.{side}", f"{end}_foot.{side}")
        for end in ("front", "hind")
        for side in "LR"
    }
    assert sure(HORSE, named=True) == expected


def test_a_limb_that_is_parented_the_wrong_way_round_is_told_by_its_names_and_not_sure() -> None:
    """Before, the hand and what hangs at it was told as an arm, or nothing was."""
    joints = parented(MAN, {"hand": "clavicle", "forearm": "hand", "upper_arm": "forearm"})
    arms = [k for k in limbs(joints, named=True) if k.kind == "arm"]
    assert {tuple(joints[k][0] for k in arm.bend) for arm in arms} == {k for k in FOUR if "hand" in k[2]}
    assert not any(arm.is_sure for arm in arms)


def test_names_that_are_swapped_put_no_joint_elsewhere() -> None:
    """What hangs at a bone of the other leg may be called wrongly, or be parented so: neither is sure."""
    joints = parented(MAN, {})
    swapped = {"shin.L": "shin.R", "shin.R": "shin.L"}
    joints = [(swapped.get(name, name), swapped.get(over, over), at) for name, over, at in joints]
    assert not [each for each in sure(joints, named=True) if "thigh" in each[0]]


def test_a_shoulder_that_holds_an_arm_begins_no_leg_where_names_are_one_joint_off() -> None:
    """Before, shoulder, thigh and shin were a leg at 0.93."""
    names = {"thigh": "LowerLeg", "shin": "Foot", "foot": "Toes", "toe": "Little1"}
    arms = {"clavicle": "Shoulder", "upper_arm": "UpperArm", "forearm": "LowerArm", "hand": "Hand"}
    joints = renamed(MAN, names | arms)
    found = [leg for leg in limbs(joints, named=True) if leg.kind == "leg"]
    assert [joints[leg.bend[0]][0] for leg in found] == ["LowerLeg.L", "LowerLeg.R"]
    assert not any(leg.is_sure for leg in found)
    assert len(sure(joints, named=True)) == 2


def test_what_is_left_of_a_body_whose_leg_bones_stand_alone_is_not_sure() -> None:
    """The shoulder blades and thighs of a centaur's front legs are no legs of a person."""
    places = ((0.0, 1.05, -0.6), (0.0, 1.07, -0.2), (0.0, 1.07, 0.15), (0.0, 1.07, 0.55))
    trunk = line("hips a b chest", "", *places)
    trunk += line(
        "waist c d neck n head", "chest", *((0.0, y, 0.6) for y in (1.17, 1.39, 1.6, 1.75, 1.82, 1.9))
    )
    front = (
        (0.04, 1.12, 0.46),
        (0.08, 0.85, 0.57),
        (0.08, 0.47, 0.48),
        (0.08, 0.08, 0.57),
        (0.08, 0.04, 0.65),
    )
    legs = line("blade.L f_thigh.L f_shin.L f_foot.L f_toe.L", "chest", *front)
    hind = ((0.95, -0.6), (0.59, -0.46), (0.32, -0.73), (0.07, -0.64))
    legs += [(f"hind_{k}.L", "hips", (0.08, y, z)) for k, (y, z) in enumerate(hind)]
    arm = ((0.03, 1.69, 0.61), (0.18, 1.72, 0.6), (0.36, 1.51, 0.6), (0.52, 1.31, 0.62))
    joints = [*trunk, *both([*legs, *line("e.L f.L g.L h.L", "d", *arm)])]
    assert not [each for each in sure(joints) if "blade.L" in each]


def test_a_helper_in_the_place_of_a_knee_that_hangs_elsewhere_is_not_surely_the_knee() -> None:
    """Before, a helper below the thigh was the knee at 0.94 where the knee and the foot hang at the hips."""
    helpers = both([("helper.L", "hind_upper_leg.L", (0.12, 0.5, -0.54))])
    ends = both(
        [(f"{end}_toe.L", f"{end}_foot.L", (0.12, 0.04, z)) for end, z in (("front", 0.6), ("hind", -0.5))]
    )
    front = {
        "front_upper_leg": "chest",
        "front_lower_leg": "front_upper_leg",
        "front_foot": "front_lower_leg",
    }
    joints = parented([*HORSE, *helpers, *ends, ("muzzle", "head", (0.0, 1.35, 1.2))], front)
    assert not [each for each in sure(joints) if "helper.L" in each]


def test_a_clavicle_and_a_stump_are_no_arm_of_two_joints() -> None:
    """Before, ``RightShoulder`` and ``RightArm`` of a body without that arm were an arm at 0.94."""
    names = {"clavicle": "Shoulder", "upper_arm": "Arm", "forearm": "ForeArm", "hand": "Hand"}
    joints = renamed([joint for joint in MAN if joint[0] not in ("forearm.R", "hand.R")], names)
    found = sure(joints, named=True)
    assert ("Arm.L", "ForeArm.L", "Hand.L") in found
    assert not [each for each in found if "Arm.R" in each]


@pytest.mark.parametrize("other", ["blade_mount", "shield"])
def test_without_a_hierarchy_an_end_of_another_name_is_not_sure(other: str) -> None:
    """Toes end no leg whose foot has another name, and a shield no arm."""
    called = {"foot.L": "blade_mount.L"} if other == "blade_mount" else {}
    places = {"blade_mount.L": (0.1, 0.3, -0.06), "toe.L": (0.1, 0.15, 0.02)}
    joints = [(called.get(name, name), "hips" if name != "hips" else "", at) for name, _, at in MAN]
    joints = [(name, over, places.get(name, at) if called else at) for name, over, at in joints]
    joints += [("shield", "hips", (0.5, 1.3, 0.12))] if other == "shield" else []
    assert sure(joints, named=True) <= {*FOUR, ("thigh.L", "shin.L", "blade_mount.L")}


def test_the_neck_and_head_of_a_guitar_are_not_sure() -> None:
    """It has a body, too."""
    pegs = both([(f"peg_{k}.L", "head", (0.04, 1.33 + 0.04 * k, 0.0)) for k in range(3)])
    flat = [("body", "", (0, 0.3, 0)), ("neck", "body", (0, 0.8, 0)), ("head", "body", (0, 1.3, 0))]
    joints: list[Joint] = [*flat, *((name, "body", at) for name, _, at in pegs)]
    found = recognise(rig_with(joints)).characters
    assert not [chain for each in found for chain in each.chains if chain.is_sure]


def test_a_group_that_stands_where_its_parent_does_begins_no_limb() -> None:
    """Before, ``arm_grp`` was the shoulder of a claw whose joints stand beside one another below it."""
    legs = [
        joint
        for k, z in enumerate((-0.1, 0.0, 0.1, 0.2))
        for joint in line(
            f"leg_a_{k}.L leg_b_{k}.L leg_c_{k}.L", "carapace", (0.1, 0.25, z), (0.33, 0.45, z), (0.58, 0, z)
        )
    ]
    claw = [("arm_grp.L", "carapace", (0.0, 0.25, 0.0))]
    claw += [
        ("claw_upper.L", "arm_grp.L", (0.15, 0.25, 0.15)),
        ("claw_lower.L", "arm_grp.L", (0.35, 0.3, 0.3)),
    ]
    claw += line("claw_hand.L claw_pincer.L", "arm_grp.L", (0.3, 0.25, 0.5), (0.22, 0.25, 0.6))
    joints: list[Joint] = [("carapace", "", (0.0, 0.25, 0.0)), *both([*legs, *claw])]
    assert not [each for each in limbs(joints, named=True) if "grp" in joints[each.joints[0]][0]]


def test_a_wing_of_a_guessed_hierarchy_that_begins_at_a_shoulder_is_not_sure() -> None:
    """Before, ``shoulder``, ``wing_1`` and ``wing_2`` were a wing at 0.9 where all joints hang at one."""
    places = ((0.08, 1.53, -0.13), (0.36, 1.68, -0.16), (0.64, 1.63, -0.19), (0.92, 1.78, -0.22))
    wing = both([(f"wing_{k}.L", "root", at) for k, at in enumerate(places)])
    flat = [(name, "root", at) for name, _, at in MAN]
    joints = [*ROOT, *flat, *wing]
    found = [k for k in limbs(joints, named=True) if k.kind == "wing" and k.is_sure]
    assert not [k for k in found if any("wing" not in joints[node][0] for node in k.bend)]


def test_names_tell_the_order_of_joints_below_a_control() -> None:
    """Before, ``left_leg_ctrl``, to which all joints of a leg are parented, was taken for a bone of one."""
    controls = both([("leg_ctrl.L", "hips", (0.1, 0.95, 0.05))])
    hung = parented([*WITH_HANDS, *controls], {"thigh": "leg_ctrl", "shin": "leg_ctrl", "foot": "leg_ctrl"})
    assert sure(hung, named=True) == FOUR


def test_a_wing_whose_next_bone_hangs_elsewhere_is_not_sure() -> None:
    """Before, ``wing_upper`` and ``wing_lower`` alone were a wing at 0.9, and ``wing_hand`` was left over."""
    wing = line("wing_upper.L wing_lower.L", "chest", (0.1, 1.4, -0.1), (0.5, 1.6, -0.1))
    wing += line("wing_hand.L wing_tip.L", "root", (1.0, 1.5, -0.1), (1.4, 1.3, -0.2))
    joints = [*ROOT, *((name, over or "root", at) for name, over, at in MAN), *both(wing)]
    found = [k for k in limbs(joints, named=True) if k.kind == "wing"]
    assert found
    assert not any(k.is_sure for k in found)


@pytest.mark.parametrize("other", [[], ["upper_arm.R", "forearm.R"]])
def test_names_that_are_told_in_part_make_no_limb_of_the_hip_and_the_elbow(other: list[str]) -> None:
    words = {"thigh": "hip", "shin": "knee", "foot": "ankle", "toe": "ball", "clavicle": "collar"}
    words |= {"upper_arm": "shoulder", "forearm": "elbow", "hand": "wrist"}
    man, lost = [*MAN, *FINGERS], ["upper_arm.L", "shin.L", "foot.L", *other]
    told = renamed(man, words)
    new = {name: f"bone_{k}" for k, (name, _, _) in enumerate(told) if man[k][0] in lost}
    found = sure(
        [(new.get(name, name), new.get(over, over), place) for name, over, place in told], named=True
    )
    assert not any({"hip.L", "elbow.L"} <= set(limb) for limb in found)
    assert any(limb[1:] == ("elbow.L", "wrist.L") and limb[0].startswith("bone_") for limb in found)


_GERMAN = {
    "hips": "Huefte",
    "spine": "Wirbelsaeule1",
    "chest": "Wirbelsaeule2",
    "neck": "Hals",
    "head": "Kopf",
    "clavicle": "Schluesselbein",
    "upper_arm": "Schulter",
    "forearm": "Ellenbogen",
    "hand": "Handgelenk",
    "thigh": "Oberschenkel",
    "shin": "Knie",
    "foot": "Knoechel",
    "toe": "Zehen",
}


@pytest.mark.parametrize("twists", [1, 2])
def test_an_elbow_beside_a_helper_is_no_knee_of_a_leg_whose_words_are_half_known(twists: int) -> None:
    """Before, elbow and wrist followed the thigh, and the body stood on its head at 0.97."""
    helpers = [(f"Hilfe{k}.L", "upper_arm.L", (0.2 + 0.1 * k, 1.45, -0.05)) for k in range(twists)]
    joints = renamed([*MAN, *both(helpers)], _GERMAN, ("_L", "_R"))
    assert {
        ("Schulter_L", "Ellenbogen_L", "Handgelenk_L"),
        ("Oberschenkel_R", "Knie_R", "Knoechel_R"),
    } <= sure(joints, named=True)
    (found,) = recognise(rig_with(joints)).characters
    assert found.up == (0.0, 1.0, 0.0)
    assert found.facing == (0.0, 0.0, 1.0)


def test_a_muscle_beside_the_elbow_is_no_upper_bone() -> None:
    """Before, the elbow followed ``bicep.L``, which hangs at the shoulder as it does, at 0.99."""
    called = {"upper_arm": "shoulder", "forearm": "elbow", "hand": "wrist", "shin": "knee", "foot": "ankle"}
    joints = renamed([*MAN, *FINGERS, *both([("bicep.L", "upper_arm.L", (0.27, 1.47, 0.03))])], called)
    assert not [each for each in sure(joints, named=True) if "bicep.L" in each]
    assert ("shoulder.L", "elbow.L", "wrist.L") in {
        tuple(joints[k][0] for k in one.bend) for one in limbs(joints, named=True)
    }


_FLAT = {"foot": "hips"}


@pytest.mark.parametrize("words", [("leg1", "leg2"), ("bn_thigh", "bn_shank"), ("leg_up", "leg_low")])
@pytest.mark.parametrize("helper", ["knee_helper", "cor_knee", "knee_push", "patella"])
def test_a_helper_at_the_knee_of_a_flat_leg_is_not_surely_the_knee(
    helper: str, words: tuple[str, str]
) -> None:
    """Before, thigh, helper and foot were the leg at 0.98, and the shin beside the helper was passed over."""
    joints = parented([*MAN, *both([(f"{helper}.L", "thigh.L", (0.1, 0.5, 0.04))])], _FLAT)
    called = renamed(joints, dict(zip(("thigh", "shin"), words, strict=True)))
    found = sure(called, named=True)
    assert not [each for each in found if f"{helper}.L" in each]
    leg = (f"{words[0]}.L", f"{words[1]}.L", "foot.L")
    assert leg in found or helper == "patella"  # which names a bone of its own


def test_a_leg_whose_foot_hangs_elsewhere_does_not_end_at_a_muscle_of_its_shin() -> None:
    """Before, ``Mus_calf`` below the knee was the foot of a leg whose foot hangs at the root, at 0.99."""
    joints = parented([*MAN, *both([("Mus_calf.L", "shin.L", (0.1, 0.38, -0.05))])], _FLAT)
    called = renamed(joints, {"shin": "Knee", "thigh": "LegUpper", "foot": "Leg3", "toe": "Toes"})
    assert not [each for each in sure(called, named=True) if "Mus_calf.L" in each]
