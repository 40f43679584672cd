"""What skeletons of games and of mocap have: roots at the shoulders, bones from the middle, palms."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from recognition_bodies.skeletons import FINGERS, HORSE, MAN, TRUNK, Joint, both, line, rig_with, without

from rigtri.model.content import Content
from rigtri.model.mesh import Mesh
from rigtri.recognition.layout import Character
from rigtri.recognition.recognise import recognise

# A bone from the middle leads to each leg, as of an elephant's shoulder blade; the root is at the shoulders.
FRONT = line(
    "blade.L shoulder.L elbow.L carpus.L",
    "root",
    (0, 1.5, 0.6),
    (0.3, 0.95, 0.6),
    (0.3, 0.5, 0.55),
    (0.3, 0.05, 0.6),
)
HIND = line(
    "pelvis.L hip.L knee.L hock.L",
    "rump",
    (0, 1.5, -0.6),
    (0.3, 1.0, -0.6),
    (0.3, 0.55, -0.5),
    (0.3, 0.05, -0.6),
)
TAIL = line("tail1 tail2 tail3", "rump", (0, 1.5, -0.9), (0, 1.2, -1.0), (0, 0.9, -1.05))
HEAD = [
    *line("neck head jaw", "root", (0, 1.7, 0.8), (0, 1.9, 1.1), (0, 1.8, 1.4)),
    *both([("ear.L", "head", (0.12, 2.0, 1.05))]),
]
ELEPHANT = [
    ("root", "", (0.0, 1.5, 0.6)),
    ("rump", "root", (0.0, 1.5, -0.6)),
    *TAIL,
    *HEAD,
    *both([*FRONT, *HIND]),
]


def sure_limbs(joints: list[Joint], *, named: bool) -> tuple[Character, dict[str, str]]:
    (found,) = recognise(rig_with(joints, named=named)).characters
    limbs = (chain for chain in found.chains if chain.is_sure and chain.bend)
    return found, {chain.name: " ".join(joints[k][0] for k in chain.bend) for chain in limbs}


def test_a_quadruped_whose_root_is_at_its_shoulders_looks_where_its_head_is() -> None:
    """Before, its root was taken for hips: all four legs were surely called those of the other end and side.

    And they began in the middle, with the bone that leads to hip or shoulder.
    """
    (found,) = recognise(rig_with(ELEPHANT, named=False)).characters
    assert found.facing == pytest.approx((0, 0, 1), abs=1e-3)
    limbs = {chain.name: " ".join(ELEPHANT[k][0] for k in chain.bend) for chain in found.chains if chain.bend}
    assert limbs == {
        f"{side} {place} leg": joints.replace(".L", f".{side[0].upper()}")
        for side in ("left", "right")
        for place, joints in (("front", "shoulder.L elbow.L carpus.L"), ("hind", "hip.L knee.L hock.L"))
    }


@pytest.mark.parametrize("names", ["hip leg_up leg_low", "hip leg_upper leg_lower"])
def test_a_leg_without_a_foot_is_not_surely_bent_at_its_thigh(names: str) -> None:
    """Before, hip, thigh and shin were surely taken for thigh, shin and foot."""
    first, second, third = names.split()
    leg = line(f"{first}.L {second}.L {third}.L", "hips", (0, 1, 0), (0.1, 0.95, 0), (0.1, 0.5, 0.02))
    joints = without(MAN, "thigh", "shin", "foot", "toe")
    _, limbs = sure_limbs([*joints, *both(leg)], named=True)
    assert not any("leg" in name for name in limbs)


def test_index_to_little_finger_below_palms_of_which_one_holds_the_thumb() -> None:
    """Before, fingers without names of a Rigify rig were surely called in the wrong order."""
    palms, fingers = [], []
    for k in range(4):
        palms.append((f"p{k}.L", "hand.L", (0.72, 1.45, 0.015 - 0.01 * k)))
        fingers += [
            (n, f"p{k}.L" if n == f"f{k}1.L" else a, at)
            for n, a, at in FINGERS
            if n.startswith(f"f{k}") and ".L" in n
        ]
    thumb = [(n, "p0.L" if n == "t1.L" else a, at) for n, a, at in FINGERS if n.startswith("t") and ".L" in n]
    joints = [*MAN, *both([*palms, *fingers, *thumb])]
    (found,) = recognise(rig_with(joints, named=False)).characters
    called = {
        chain.name: {joints[k][0] for k in chain.joints} for chain in found.chains if chain.kind == "finger"
    }
    for k, finger in enumerate(("index", "middle", "ring", "little")):
        assert f"f{k}1.L" in called[f"left {finger} finger"]
    assert "t1.L" in called["left thumb"]


DOOM = {
    "upper_arm": "uparm",
    "forearm": "loarm",
    "thigh": "upleg",
    "shin": "loleg",
    "foot": "ankle",
    "toe": "toe",
}


@pytest.mark.parametrize("capital", [False, True])
def test_sides_that_are_glued_to_words_in_lower_case(capital: bool) -> None:
    """Doom 3 says ``luparm`` or ``Luparm``, the Acclaim format ``lfemur``: no capital parts the side."""

    def called(name: str) -> str:
        part, _, side = name.partition(".")
        return (side if capital else side.lower()) + DOOM.get(part, part) if side else part

    fingers = {"t": "thumb", "f0": "index", "f1": "mid", "f2": "ring", "f3": "pinky"}
    given = [
        (fingers.get(n[:-3], "") + n[-3:] if n[:-3] in fingers else n, a, at) for n, a, at in [*MAN, *FINGERS]
    ]
    row = {old[0]: new[0] for old, new in zip([*MAN, *FINGERS], given, strict=True)}
    joints = [(called(n), called(row.get(a, a)) if a else "", at) for n, a, at in given]
    (found,) = recognise(rig_with(joints)).characters
    chains = {chain.name: chain for chain in found.chains}
    assert "its names" in chains["left arm"].evidence[0]
    assert chains["left arm"].confidence > 0.9
    assert "its names" in chains["right index finger"].evidence[0]


def test_an_animal_with_the_names_of_a_person_has_four_legs_where_its_arms_end_in_toes() -> None:
    """Before, a cat with Rigify's names had arms, surely: its dewclaw stands apart as a thumb does."""
    toes = [
        joint
        for k in range(4)
        for joint in line(
            f"f{k}.L f{k}_end.L", "f_toe.L", *((0.17 + 0.02 * k, 0.38 - y, 0.75 + y) for y in (0, 0.05))
        )
    ]
    toes = [("f_toe.L", "hand.L", (0.2, 0.38, 0.7)), *toes]
    claw = line("claw.L claw_end.L", "hand.L", (0.17, 0.42, 0.6), (0.1, 0.4, 0.6))
    joints = [*(joint for joint in HORSE if "finger" not in joint[0]), *both([*toes, *claw])]
    found, limbs = sure_limbs(joints, named=True)
    assert found.form == "quadruped"
    assert not any("arm" in name for name in limbs)


HALVES = [
    *line(
        "front1 front2 neck head jaw", "", (0, 1, 0.1), (0, 1, 0.6), (0, 1.2, 0.9), (0, 1.3, 1), (0, 1.2, 1.2)
    ),
    *line("back1 back2 tail1 tail2", "", (0, 1, -0.1), (0, 1, -0.6), (0, 1.1, -0.9), (0, 1, -1.2)),
]
for place, at in (("Fore", 0.6), ("Hind", -0.6)):
    paths = [(0.2, 1.0, at), (0.2, 0.6, at * 0.85), (0.2, 0.1, at), (0.2, 0.03, at + 0.12)]
    names = " ".join(f"{place}Leg{k}.L" for k in range(1, 5))
    HALVES += both(line(names, "front2" if at > 0 else "back2", *paths))


def test_halves_of_an_animal_that_hang_from_nothing_are_one() -> None:
    """Before, they were two characters on two legs each."""
    (found,) = recognise(rig_with(HALVES)).characters
    assert found.form == "quadruped"
    assert {chain.name for chain in found.chains if chain.kind == "leg"} == {
        f"{side} {place} leg" for side in ("left", "right") for place in ("front", "hind")
    }


def test_front_legs_below_a_blade_that_begins_in_the_middle_are_sure() -> None:
    """Before, none of elephants, sheep and zebras were: their first bone might have been the blade."""
    _, limbs = sure_limbs(ELEPHANT, named=False)
    assert {name for name in limbs if "front" in name} == {"left front leg", "right front leg"}


# MakeHuman's default rig: a thigh of two bones, of which the first is short and bends into the second.
SPLIT_THIGH = line(
    "pelvis.L upperleg01.L upperleg02.L lowerleg01.L lowerleg02.L foot.L toe.L",
    "hips",
    (0, 1, 0),
    (0.1, 0.95, 0),
    (0.125, 0.87, 0),
    (0.13, 0.5, 0.01),
    (0.13, 0.3, -0.005),
    (0.13, 0.1, -0.02),
    (0.13, 0.03, 0.12),
)


def test_a_thigh_of_two_bones() -> None:
    """Before, legs without names surely began at the second bone, and so those with names were not sure."""
    joints = without([*MAN, *FINGERS], "thigh", "shin", "foot", "toe") + both(SPLIT_THIGH)
    _, limbs = sure_limbs(joints, named=False)
    assert set(limbs) == {"left arm", "right arm"}
    _, limbs = sure_limbs(joints, named=True)
    assert limbs["left leg"] == "upperleg01.L lowerleg01.L foot.L"


# Front legs by themselves below the root, and ribs at the flanks of the trunk that point to their blades.
PARTED = [
    ("all", "", (0.0, 0.0, 0.0)),
    ("hips", "all", (0.0, 1.4, -0.7)),
    *line("spine chest neck head", "hips", (0, 1.5, -0.2), (0, 1.6, 0.3), (0, 1.7, 0.8), (0, 1.8, 1.2)),
    *both(line("flank.L rib.L", "spine", (0.3, 1.6, -0.2), (0.3, 1.55, 0.4))),
    *both(
        line(
            "blade.L arm.L forearm.L carpus.L hoof.L",
            "all",
            (0.25, 1.3, 0.7),
            (0.3, 0.95, 0.6),
            (0.3, 0.5, 0.55),
            (0.3, 0.1, 0.6),
            (0.3, 0.05, 0.65),
        )
    ),
    *both(
        line(
            "leg.L foreleg.L hock.L toe.L",
            "hips",
            (0.25, 1.0, -0.6),
            (0.25, 0.6, -0.5),
            (0.25, 0.1, -0.6),
            (0.25, 0.02, -0.5),
        )
    ),
]


def test_front_legs_by_themselves_are_in_front() -> None:
    """Before, ribs that point to their blades were arms, and a foreleg after a leg made it a front one."""
    (found,) = recognise(rig_with(PARTED)).characters
    assert found.form == "quadruped"
    limbs = {chain.name: " ".join(PARTED[k][0] for k in chain.bend) for chain in found.chains if chain.bend}
    for side in ("left", "right"):
        end = side[0].upper()
        assert limbs[f"{side} front leg"] == f"arm.{end} forearm.{end} carpus.{end}"
        assert limbs[f"{side} hind leg"] == f"leg.{end} foreleg.{end} hock.{end}"
    assert found.facing == pytest.approx((0, 0, 1), abs=1e-3)


SHEEP = [
    ("root", "", (0.0, 1.5, 0.6)),
    ("rump", "root", (0.0, 1.5, -0.6)),
    *both([*FRONT, *HIND]),
    *line("neck head", "root", (0, 1.6, 0.9), (0, 1.8, 1.1)),
    *line("tail1 tail2", "rump", (0, 1.45, -0.9), (0, 1.3, -1.1)),
]


def test_which_end_of_a_body_has_the_head_is_not_sure_where_nothing_shows_it() -> None:
    """Before, the hierarchy alone decided: legs of a sheep whose root is at its shoulders were surely called

    those of the other end and side.
    """
    _, limbs = sure_limbs(SHEEP, named=False)
    assert limbs == {}
    (found,) = recognise(rig_with(SHEEP, named=False)).characters
    legs = [chain for chain in found.chains if chain.kind == "leg"]
    assert len(legs) == 4
    assert all("which end of its trunk" in " ".join(chain.evidence) for chain in legs)


LAST_THREE = {
    "leg": line("hip.L up.L low.L", "hips", (0, 0.9, 0.01), (0.15, 0.84, -0.06), (0.11, 0.45, 0.04)),
    "arm": line("collar.L up.L low.L", "chest", (0.09, 1.5, 0), (0.16, 1.5, 0), (0.41, 1.5, 0)),
}


@pytest.mark.parametrize("kind", LAST_THREE)
def test_limbs_whose_last_joint_is_missing_are_not_sure(kind: str) -> None:
    """Before, hip, thigh and shin, and collar, upper arm and forearm, were surely the bones after them."""
    gone = {"leg": ("thigh", "shin", "foot", "toe"), "arm": ("clavicle", "upper_arm", "forearm", "hand")}[
        kind
    ]
    joints = [joint for joint in MAN if joint[0].partition(".")[0] not in gone]
    _, limbs = sure_limbs([*joints, *both(LAST_THREE[kind])], named=False)
    assert not any(kind in name for name in limbs)


@pytest.mark.parametrize("corners", ["fl fr bl br", "LF RF LR RR", "FL FR RL RR"])
def test_letters_for_a_corner_of_the_body_say_side_and_place(corners: str) -> None:
    """Before, they said nothing, so that legs of animals that stand askew had no side or the other one."""
    front_left, front_right, hind_left, hind_right = corners.split()

    legs = {"upper_arm": "thigh", "forearm": "shin", "hand": "foot", "finger": "toe"}

    def called(name: str) -> str:
        part, _, side = name.partition(".")
        if not side:
            return part
        front, hind = (front_left, hind_left) if side == "L" else (front_right, hind_right)
        return f"{legs[part]}_{front}" if part in legs else f"{part}_{hind}"

    mirrored = [(called(name), called(above), (-x, y, z)) for name, above, (x, y, z) in HORSE]
    (found,) = recognise(rig_with(mirrored)).characters
    limbs = {chain.name: mirrored[chain.bend[0]][0] for chain in found.chains if chain.bend and chain.is_sure}
    assert limbs == {
        "left front leg": f"thigh_{front_left}",
        "right front leg": f"thigh_{front_right}",
        "left hind leg": f"thigh_{hind_left}",
        "right hind leg": f"thigh_{hind_right}",
    }


# The upper half of MakeHuman's Rigify rig, whose palms hold the fingers and one the thumb, too, and its ears.
EARS = line("ear1.L ear2.L ear3.L", "head", (0.07, 1.515, 0.058), (0.07, 1.541, 0.057), (0.079, 1.554, 0.041))
CHEEKS = line(
    "jaw.L jaw1.L chin.L", "head", (0.065, 1.515, 0.066), (0.056, 1.483, 0.077), (0.026, 1.456, 0.125)
)
UPPER_BODY = [
    *line("chest neck head", "", (0, 1.239, -0.019), (0, 1.414, 0.005), (0, 1.515, 0.044)),
    *both(
        [
            *EARS,
            *CHEEKS,
            *line(
                "shoulder.L upper_arm.L forearm.L hand.L",
                "chest",
                (0.023, 1.342, 0.022),
                (0.17, 1.32, 0.019),
                (0.331, 1.14, 0.02),
                (0.453, 1.016, 0.183),
            ),
            *(
                joint
                for k in range(4)
                for joint in line(
                    f"palm{k}.L a{k}.L b{k}.L c{k}.L",
                    "hand.L",
                    (0.454 + 0.008 * k, 1.008 - 0.007 * k, 0.227 - 0.011 * k),
                    (0.481 + 0.008 * k, 0.975 - 0.009 * k, 0.278 - 0.018 * k),
                    (0.484 + 0.01 * k, 0.96 - 0.01 * k, 0.298 - 0.022 * k),
                    (0.484 + 0.01 * k, 0.944 - 0.01 * k, 0.315 - 0.026 * k),
                )
            ),
            *line("t1.L t2.L t3.L", "palm0.L", (0.46, 1.0, 0.25), (0.45, 0.98, 0.27), (0.44, 0.97, 0.29)),
        ]
    ),
]


def test_arms_of_half_a_body_are_no_legs() -> None:
    """Before, shoulder, upper arm and forearm were surely a leg, and ears or cheeks its arms."""
    _, limbs = sure_limbs(UPPER_BODY, named=False)
    assert not any("leg" in name for name in limbs)


@pytest.mark.parametrize("names", ["Shoulder Arm ForeArm Hand", "Shoulder UpperArm LowerArm Hand"])
def test_a_shoulder_before_an_arm_is_none_of_the_three_joints_of_an_arm_by_itself(names: str) -> None:
    """Before, a straight arm without a twin surely began at its clavicle."""
    words = " ".join(f"Right{word}" for word in [*names.split(), "HandEnd"])
    places = [(x, 1.4, 0) for x in (-0.03, -0.19, -0.46, -0.76, -0.83)]
    joints = line(words, "", *places)
    _, limbs = sure_limbs(joints, named=True)
    assert limbs == {"right arm": " ".join(words.split()[1:4])}


def test_a_metacarpal_that_two_phalanges_follow() -> None:
    """Before, what its name calls a metacarpal was the proximal phalanx."""
    called = {"1": "_metacarpal", "2": "_01", "3": "_02"}
    joints = [(_renamed(name, called), _renamed(above, called), at) for name, above, at in [*MAN, *FINGERS]]
    (found,) = recognise(rig_with(joints)).characters
    bones = {bone: joints[k][0] for bone, k in found.bones.items()}
    assert bones["leftIndexProximal"] == "index_01.L"
    assert bones["leftIndexIntermediate"] == "index_02.L"
    assert "leftIndexDistal" not in bones


def _renamed(name: str, called: dict[str, str]) -> str:
    words = {"f0": "index", "f1": "middle", "f2": "ring", "f3": "pinky"}
    return words[name[:2]] + called[name[2]] + name[3:] if name[:2] in words else name


def test_the_shoulder_of_mmd_is_not_the_joint_that_undoes_it() -> None:
    """Before, 肩C, which stands at the upper arm, was the shoulder."""
    names = {"clavicle": "肩", "upper_arm": "腕", "forearm": "ひじ", "hand": "手首"}
    names |= {"thigh": "足", "shin": "ひざ", "foot": "足首"}
    body = {"hips": "下半身", "spine": "上半身", "chest": "上半身2", "neck": "首", "head": "頭"}

    def japanese(name: str) -> str:
        word, _, side = name.partition(".")
        return {"L": "左", "R": "右"}[side] + names[word] if word in names else body.get(name, name)

    joints = list[Joint]()
    for name, above, at in MAN:
        arm = name.startswith("upper_arm")
        undoing = japanese(above) + "C"
        joints += [(undoing, japanese(above), at)] * arm
        joints.append((japanese(name), undoing if arm else japanese(above), at))
    (found,) = recognise(rig_with(joints)).characters
    assert joints[found.bones["leftShoulder"]][0] == "左肩"


def test_an_arm_of_three_numbered_joints_and_a_hand_begins_with_a_clavicle() -> None:
    """As 3ds Max writes it. Before, the first three were taken, and no arm was sure."""
    arm = line(
        "arm.L arm1.L arm2.L hand.L",
        "chest",
        (0.03, 1.42, 0),
        (0.18, 1.42, 0),
        (0.45, 1.4, -0.03),
        (0.7, 1.4, 0),
    )
    rest = without(MAN, "clavicle", "upper_arm", "forearm", "hand")
    _, limbs = sure_limbs([*rest, *both(arm)], named=True)
    assert limbs["left arm"] == "arm1.L arm2.L hand.L"
    assert limbs["right arm"] == "arm1.R arm2.R hand.R"


def test_wings_of_which_the_last_joint_alone_says_the_side_are_on_it() -> None:
    """Before, where the body was taken to face the other way, LeftWing was surely a right wing."""
    wing = [
        ("a1", "chest", (0.1, 1.4, 0)),
        ("a2", "a1", (0.4, 1.5, -0.1)),
        ("LeftWing", "a2", (0.8, 1.3, -0.1)),
    ]
    other = [
        ("b1", "chest", (-0.1, 1.4, 0)),
        ("b2", "b1", (-0.4, 1.5, -0.1)),
        ("RightWing", "b2", (-0.8, 1.3, -0.1)),
    ]
    turned = [(name, above, (-x, y, z)) for name, above, (x, y, z) in [*wing, *other]]
    rest = [
        joint
        for joint in MAN
        if not joint[0].endswith((".L", ".R")) or joint[0].split(".")[0] in ("thigh", "shin", "foot", "toe")
    ]
    (found,) = recognise(rig_with([*rest, *turned])).characters
    sides = {chain.side: chain.joints[-1] for chain in found.chains if chain.kind == "wing"}
    names = [name for name, _, _ in [*rest, *turned]]
    assert {side: names[k] for side, k in sides.items()} == {"left": "LeftWing", "right": "RightWing"}


@pytest.mark.parametrize(
    ("arm", "leg"),
    [
        ("upper_arm.L upper_arm.L.001 hand.L", "thigh.L thigh.L.001 foot.L toe.L"),
        ("arm.L arm.L.001 hand.L", "leg.L leg.L.001 foot.L toe.L"),
        ("bras.L bras.L.001 main.L", "jambe.L jambe.L.001 pied.L pied.L.001"),
    ],
)
def test_a_lower_bone_that_was_drawn_out_of_the_upper_one_and_not_renamed(arm: str, leg: str) -> None:
    """Before, it was a part of the upper bone: a leg was surely thigh, foot and toe."""
    above = line(arm, "chest", (0.16, 1.45, 0), (0.44, 1.45, -0.01), (0.7, 1.45, 0))
    below = line(leg, "hips", (0.1, 0.95, 0), (0.1, 0.5, 0.01), (0.1, 0.1, -0.02), (0.1, 0.03, 0.12))
    _, limbs = sure_limbs([*TRUNK, *both([*above, *below])], named=True)
    assert limbs["left arm"] == arm
    assert limbs["left leg"] == " ".join(leg.split()[:3])


def test_legs_of_halved_bones_do_not_face_back() -> None:
    """Before, calf and heel were the sole of a foot that points back from the knee.

    So, without names, legs surely bent in the middle of their thighs, and left and right were exchanged.
    """
    leg = line(
        "thigh1.L thigh2.L shin1.L shin2.L foot.L toe.L",
        "hips",
        (0.09, 0.94, -0.05),
        (0.1, 0.71, -0.044),
        (0.11, 0.48, -0.03),
        (0.11, 0.29, -0.07),
        (0.13, 0.14, -0.12),
        (0.13, 0.02, 0),
    )
    arms = [joint for joint in MAN if joint[0].split(".")[0] in ("clavicle", "upper_arm", "forearm", "hand")]
    joints = [*TRUNK, *arms, *both(leg)]
    rows = np.array(
        [[k] for k, (name, _, _) in enumerate(joints) if name.startswith(("shin1", "foot", "toe"))]
    )
    behind = {"shin1": -0.08, "foot": -0.06, "toe": 0.06}
    points = np.array(
        [(x, y, z + behind[name[:-2]]) for name, _, (x, y, z) in (joints[k] for k in rows[:, 0])]
    )
    mesh = Mesh("legs", -1, points, 0, rows, np.ones((len(rows), 1)))
    content = Content(read_outlines=partial(list, [mesh]))
    (found,) = recognise(replace(rig_with(joints, named=False), content=content)).characters
    assert found.facing[2] > 0.9


def test_a_flat_skeleton_is_told_not_to_have_limbs_that_commands_use() -> None:
    """Before, its limbs were sure, and commands said that none is recognised with enough confidence."""
    joints = [("root", "", (0.0, 0.0, 0.0)), *((name, "root", at) for name, _, at in MAN)]
    layout = recognise(rig_with(joints))
    remark = (
        "no command but orient-joints works on the left arm: 'forearm.L' does not lie below 'upper_arm.L'"
    )
    assert remark in layout.remarks


@pytest.mark.parametrize("bent", [0.0, 0.06, 0.12])
def test_of_pieces_of_one_bone_the_first_begins_a_limb(bent: float) -> None:
    """Before, where they were not quite in line, arms surely began at the second piece."""
    arm = line(
        "clavicle.L upper_arm.L.01 upper_arm.L.02 forearm.L.01 forearm.L.02 hand.L",
        "chest",
        (0.04, 1.45, 0),
        (0.16, 1.45, 0),
        (0.3, 1.45 + bent, 0),
        (0.44, 1.45, -0.01),
        (0.57, 1.45, -0.005),
        (0.7, 1.45, 0),
    )
    rest = without(MAN, "clavicle", "upper_arm", "forearm", "hand")
    _, limbs = sure_limbs([*rest, *both(arm)], named=True)
    assert limbs.get("left arm") in (None, "upper_arm.L.01 forearm.L.01 hand.L")


def test_a_leg_that_ends_at_its_knee_is_not_sure() -> None:
    """Before, without names, a thigh of two halves was surely a leg of two bones, where noise bends it."""
    leg = line(
        "thigh1.L thigh2.L shin1.L shin2.L foot.L toe.L",
        "hips",
        (0.1, 0.95, 0),
        (0.1, 0.72, 0.035),
        (0.1, 0.5, 0),
        (0.1, 0.3, 0.01),
        (0.1, 0.1, -0.02),
        (0.1, 0.02, 0.12),
    )
    rest = without(MAN, "thigh", "shin", "foot", "toe")
    _, limbs = sure_limbs([*rest, *both(leg)], named=False)
    assert "thigh1.L thigh2.L shin1.L" not in limbs.values()
