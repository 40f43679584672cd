"""Legs that names put at a corner of the body, and joints that carry what belongs to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import pytest
from recognition_bodies.skeletons import ARM, FINGERS, HORSE, LEG, MAN, TRUNK, Joint, both, line, rig_with

from rigtri.recognition.layout import Character
from rigtri.recognition.limb_words import limb_words
from rigtri.recognition.recognise import recognise

# What builders of walking machines call the corners: front, rear or hind, left and right.
CORNERS = ["FL FR RL RR", "LF RF LH RH", "FL FR HL HR"]


def on_four_legs(corners: str, *words: str) -> list[Joint]:
    """A machine whose four legs all begin at one joint, between them no trunk; it looks to +z."""
    joints: list[Joint] = [("base", "", (0.0, 0.6, 0.0))]
    for corner, x, z in zip(corners.split(), (1, -1, 1, -1), (1, 1, -1, -1), strict=True):
        places = [(0.05, 0.6, 0.2), (0.14, 0.6, 0.2), (0.14, 0.35, 0.16), (0.14, 0.05, 0.2)]
        above = "base"
        for word, (across, up, ahead) in zip(words, places, strict=True):
            joints.append((f"{corner}_{word}", above, (across * x, up, ahead * z)))
            above = joints[-1][0]
    return joints


def sure(found: Character, joints: list[Joint]) -> dict[str, list[str]]:
    return {k.name: [joints[j][0] for j in k.bend] for k in found.chains if k.bend and k.is_sure}


@pytest.mark.parametrize("corners", CORNERS)
def test_four_legs_of_one_joint_are_those_that_their_names_say(corners: str) -> None:
    """Before, the front legs were sure as the legs of a body on two, and the hind ones were not sure."""
    joints = on_four_legs(corners, "hip", "thigh", "calf", "foot")
    (found,) = recognise(rig_with(joints)).characters
    names = ("left front leg", "right front leg", "left hind leg", "right hind leg")
    expected = {
        name: [f"{corner}_{word}" for word in ("thigh", "calf", "foot")]
        for name, corner in zip(names, corners.split(), strict=True)
    }
    assert sure(found, joints) == expected
    assert found.form == "quadruped"


def test_four_legs_whose_words_a_table_has_too_are_not_sure() -> None:
    joints = on_four_legs(CORNERS[0], "top", "upper_leg", "lower_leg", "foot")
    assert [k.name for k in recognise(rig_with(joints)).chains if k.bend and k.is_sure] == []


def test_a_left_hand_is_no_left_hind_leg() -> None:
    """Two letters that mean a hind leg mean a hand where the name is of an arm."""
    assert (limb_words("lh_thigh").place, limb_words("lh_finger").place) == ("hind", "")


# Start, middle and end of a front and of a hind leg, as riggers of animals call them; {s} is l or r.
CALLED = [
    ("UpperLeg.F{s} LowerLeg.F{s} Paw.F{s}", "UpperLeg.B{s} LowerLeg.B{s} Paw.B{s}"),
    ("leg_f{s} shin_f{s} paw_f{s}", "leg_b{s} shin_b{s} paw_b{s}"),
    ("front_{s}_upper front_{s}_lower front_{s}_paw", "hind_{s}_upper hind_{s}_lower hind_{s}_paw"),
    ("fthigh_{s} fcalf_{s} paw_{s}", "thigh_{s} calf_{s} foot_{s}"),
    ("F{s}_hip F{s}_knee F{s}_foot", "R{s}_hip R{s}_knee R{s}_foot"),
]


@pytest.mark.parametrize(("front", "hind"), CALLED)
@pytest.mark.parametrize("turned", [False, True])
def test_a_horse_whatever_its_legs_are_called(front: str, hind: str, turned: bool) -> None:
    """Also where what is called left is on its right. Before, limbs were not sure, or of another side."""
    names, expected = {}, {}
    for side, s, given in (("left", "l", "R" if turned else "L"), ("right", "r", "L" if turned else "R")):
        for place, words, bones in (
            ("front", front, "upper_arm forearm hand"),
            ("hind", hind, "thigh shin foot"),
        ):
            new = words.format(s=s).split()
            names |= dict(zip([f"{bone}.{given}" for bone in bones.split()], new, strict=True))
            expected[f"{side} {place} leg"] = new
    joints = [(names.get(a, a), names.get(b, b), at) for a, b, at in HORSE]
    (found,) = recognise(rig_with(joints)).characters
    assert sure(found, joints) == expected


@pytest.mark.parametrize("named", [True, False])
def test_the_four_legs_of_a_centaur_are_front_and_hind_legs(named: bool) -> None:
    """Before, a body with arms beside four legs had two left legs of one name."""
    chest = next(above for name, above, _ in HORSE if name.startswith("neck"))
    x, y, z = next(at for name, _, at in HORSE if name == chest)
    arm = line(
        "Arm.L Elbow.L Wrist.L",
        chest,
        (x + 0.15, y + 0.3, z + 0.1),
        (x + 0.35, y + 0.1, z + 0.15),
        (x + 0.4, y, z + 0.45),
    )
    joints = [*HORSE, *both(arm)]
    (found,) = recognise(rig_with(joints, named=named)).characters
    legs = {k.name: joints[k.bend[0]][0] for k in found.chains if k.kind == "leg" and k.bend}
    assert legs == {
        "left front leg": "upper_arm.L",
        "right front leg": "upper_arm.R",
        "left hind leg": "thigh.L",
        "right hind leg": "thigh.R",
    }


# Sides of a person in two letters, and how riggers put them into names; {s} is the side.
PEOPLE = [("LF", "RF"), ("Lf", "Rf"), ("Lf", "Rt")]
PUT = ["{s}_{word}", "{word}_{s}", "bn_{word}_{s}_jnt", "{word}{s}"]


@pytest.mark.parametrize("sides", PEOPLE)
@pytest.mark.parametrize("put", PUT)
@pytest.mark.parametrize("short", [False, True])
def test_two_letters_are_a_side_where_no_leg_is_behind(sides: tuple[str, str], put: str, short: bool) -> None:
    """Before, a man's left arm, or both, were not sure: a front leg is called so."""
    names = {}
    for name in (name for name, _, _ in MAN if name[-2:] in (".L", ".R")):
        word = "hnd" if short and name.startswith("hand") else name[:-2]
        names[name] = put.format(s=sides[name.endswith(".R")], word=word)
    joints = [(names.get(a, a), names.get(b, b), at) for a, b, at in MAN]
    (found,) = recognise(rig_with(joints)).characters
    expected = {
        f"{side} {limb}": [names[f"{bone}.{letter}"] for bone in bones.split()]
        for limb, bones in (("arm", "upper_arm forearm hand"), ("leg", "thigh shin foot"))
        for side, letter in (("left", "L"), ("right", "R"))
    }
    assert sure(found, joints) == expected


@pytest.mark.parametrize("hind", ["LH RH", "LB RB", "LR RR", "l_hind r_hind"])
def test_two_letters_are_front_where_a_leg_is_behind(hind: str) -> None:
    """A horse whose front legs have the names of arms, with words of hind legs beside them."""
    names = {}
    for bones, places in (("upper_arm forearm hand", "LF RF"), ("thigh shin foot", hind)):
        for bone in bones.split():
            for given, place in zip("LR", places.split(), strict=True):
                names[f"{bone}.{given}"] = f"{place}_{bone}"
    joints = [(names.get(a, a), names.get(b, b), at) for a, b, at in HORSE]
    (found,) = recognise(rig_with(joints)).characters
    assert {k.name for k in found.chains if k.kind == "arm" and k.is_sure} == set()


def test_lf_and_rt_are_left_and_right_of_hind_legs_too() -> None:
    names = {
        f"{bone}.{given}": f"{side}_{place}_{word}"
        for bones, place in (("upper_arm forearm hand", "front"), ("thigh shin foot", "hind"))
        for bone, word in zip(bones.split(), ("thigh", "shin", "paw"), strict=True)
        for given, side in (("L", "Lf"), ("R", "Rt"))
    }
    joints = [(names.get(a, a), names.get(b, b), at) for a, b, at in HORSE]
    (found,) = recognise(rig_with(joints)).characters
    words = ("thigh", "shin", "paw")
    assert sure(found, joints) == {
        f"{side} {place} leg": [f"{two}_{place}_{word}" for word in words]
        for place in ("front", "hind")
        for side, two in (("left", "Lf"), ("right", "Rt"))
    }


def test_a_front_leg_alone_is_one() -> None:
    joints = line("front_thigh front_shin front_paw", "", (0, 0.7, 0), (0, 0.4, 0.1), (0, 0.1, 0.05))
    (found,) = recognise(rig_with(joints)).characters
    assert [chain.name for chain in found.limbs] == ["front leg"]


def test_a_limb_that_is_called_as_others_are_is_not_sure() -> None:
    """Before, the first of four legs that only numbers tell apart was surely the leg."""
    joints = _numbered()
    assert [k.name for k in recognise(rig_with(joints)).chains if k.bend and k.is_sure] == []


def _numbered() -> list[Joint]:
    joints = on_four_legs("1 2 3 4", "hip", "knee", "ankle", "foot")
    turned = [tuple(reversed(name.split("_"))) for name, _, _ in joints]
    names = {old[0]: "_".join(new) for old, new in zip(joints, turned, strict=True)}
    return [(names[a], names.get(b, b), at) for a, b, at in joints]


def test_a_mane_is_no_neck_and_no_head() -> None:
    """Before, the head of a horse cut off below its neck was the hair above it, surely."""
    horse = [joint for joint in HORSE if not joint[0].startswith(("neck", "head", "jaw", "ear"))]
    chest = next(above for name, above, _ in HORSE if name.startswith("neck"))
    x, y, z = next(at for name, _, at in HORSE if name == chest)
    crest: list[Joint] = [
        ("mane_base", chest, (x, y + 0.3, z + 0.2)),
        ("mane_top", "mane_base", (x, y + 0.4, z + 0.25)),
    ]
    (found,) = recognise(rig_with([*horse, *crest])).characters
    assert {"neck", "head"}.isdisjoint(chain.kind for chain in found.chains)


def roles(joints: list[Joint]) -> Mapping[str, str]:
    (found,) = recognise(rig_with(joints)).characters
    return {joints[part.joint][0]: part.role for part in found.parts}


def test_a_spine_beside_the_hips_is_of_the_body() -> None:
    """Before, what is not below the hips was outside the body, and called an attachment."""
    name, above, (x, y, z) = MAN[0]
    under = [(a, "middle" if b == name and not a.startswith("thigh") else b, at) for a, b, at in MAN[1:]]
    joints: list[Joint] = [("middle", "", (x, y, z)), (name, "middle", (x, y - 0.02, z)), *under]
    plate = both([("plate.L", "chest", (0.1, 1.3, 0.1)), ("plate_2.L", "plate.L", (0.12, 1.2, 0.15))])
    assert above == ""
    assert roles([*joints, *plate])["plate.L"] == "deform"


def test_a_leg_does_not_end_before_its_longest_bone() -> None:
    """Before, hips and knee of a machine with three axles at its hips were surely a leg by shape."""
    leg = line(
        "pitch.L roll.L yaw.L knee.L ankle.L sole.L",
        "hips",
        *[(0.06, 0.92, 0), (0.12, 0.89, 0), (0.12, 0.77, 0.05), (0.12, 0.57, 0)],
        *[(0.12, 0.27, 0), (0.12, 0.2, 0.1)],
    )
    joints = [*TRUNK, *both([*ARM, *leg]), *FINGERS]
    (found,) = recognise(rig_with(joints, named=False)).characters
    legs = {" ".join(joints[k][0] for k in chain.bend) for chain in found.chains if chain.kind == "leg"}
    assert legs == {"roll.L yaw.L knee.L", "roll.R yaw.R knee.R"}
    assert not any(chain.is_sure for chain in found.chains if chain.kind == "leg")


def test_a_body_whose_legs_are_sure_gives_axes_though_its_arms_are_not() -> None:
    """Before, the mean of all limbs had to be, so that a trunk was rolled where its legs were right."""
    wings = both(line("w.L w2.L", "chest", (0.16, 1.45, 0), (0.4, 1.43, -0.05)))
    joints = [*TRUNK, *both(LEG), *wings]
    (found,) = recognise(rig_with(joints, named=False)).characters
    assert [chain.kind for chain in found.limbs if chain.is_sure] == ["leg", "leg"]
    assert replace(found, confidence=0.6).gives_axes


def test_what_moves_points_below_a_hand_is_no_socket() -> None:
    """Before, a chain that skin hangs on was an attachment, and got new axes all the same."""
    more = both([("flap.L", "hand.L", (0.9, 1.3, 0.3)), ("flap_2.L", "flap.L", (0.95, 1.1, 0.5))])
    assert roles([*MAN, *more])["flap.L"] == "deform"


def test_a_body_on_two_legs_has_no_front_legs() -> None:
    """Makers of machines on two legs call them front left and front right, as those of machines on four."""
    joints = on_four_legs("FL FR RL RR", "SHOULDER", "UPPER_LEG", "LOWER_LEG", "FOOT")
    joints = [joint for joint in joints if not joint[0].startswith("R")]
    (found,) = recognise(rig_with(joints)).characters
    assert {k.name for k in found.chains if k.kind == "leg"} == {"left leg", "right leg"}


def test_from_hind_to_front_legs_it_goes_ahead_however_they_spread() -> None:
    """Before, legs that spread to the corners had the way from hind to front ones for up."""
    joints: list[Joint] = [("torso", "", (0.0, 0.57, 0.0))]
    for place, z in (("front", 1.0), ("back", -1.0)):
        for side, x in (("left", 1.0), ("right", -1.0)):
            places = [(0.2, 0.57, 0.2), (0.41, 0.68, 0.41), (0.59, 0.43, 0.59), (0.59, 0.13, 0.59)]
            above = "torso"
            for word, (across, up, ahead) in zip(["hip", "knee", "ankle", "toe"], places, strict=True):
                joints.append((f"{word}_{place}_{side}", above, (across * x, up, ahead * z)))
                above = joints[-1][0]
    (found,) = recognise(rig_with(joints)).characters
    assert found.up == (0.0, 1.0, 0.0)
    assert found.facing == (0.0, 0.0, 1.0)


def test_a_wrist_at_the_elbow_ends_no_forearm() -> None:
    """Before, the axle that turns a machine's forearm, named for its wrist, was surely the end of an arm."""
    arm = line(
        "ShoulderYaw.L ElbowPitch.L WristYaw.L WristRoll.L Gripper.L nub.L",
        "chest",
        *[(0.29, 1.45, 0), (0.29, 1.14, 0.015), (0.29, 1.14, 0), (0.28, 0.89, 0), (0.29, 0.86, 0)],
        (0.29, 0.84, 0),
    )
    joints = [*TRUNK, *both(arm)]
    (found,) = recognise(rig_with(joints)).characters
    arms = {" ".join(joints[k][0] for k in chain.bend): chain for chain in found.chains if chain.bend}
    wrong = arms.get("ShoulderYaw.L ElbowPitch.L WristYaw.L")
    assert wrong is None or not wrong.is_sure


@pytest.mark.parametrize(("ends", "certain"), [(("Ear", "Tail"), True), (("Knob", "Handle"), False)])
def test_legs_beside_ears_and_a_tail_are_an_animals(ends: tuple[str, str], *, certain: bool) -> None:
    """Before, they were not sure, as those of a table are not: nothing of the trunk had a name."""
    ear, tail = ends
    trunk: list[Joint] = [
        ("Root", "", (0.0, 0.65, -0.4)),
        ("joint2", "Root", (0.0, 0.78, -0.2)),
        ("joint3", "joint2", (0.0, 0.8, 0.1)),
        ("joint4", "joint3", (0.0, 0.72, 0.33)),
        (tail, "Root", (0.0, 0.6, -0.5)),
        ("joint18", tail, (0.0, 0.45, -0.52)),
    ]
    places = [(0.1, 0.68, 0.2), (0.1, 0.34, 0.16), (0.1, 0.12, 0.17), (0.1, 0.01, 0.2)]
    words = ["Oberschenkel", "Knee", "Foot", "FootEnd"]
    legs = [
        *line(" ".join(f"{word}_F.L" for word in words), "joint3", *places),
        *line(" ".join(f"{word}_B.L" for word in words), "Root", *((x, y, z - 0.6) for x, y, z in places)),
    ]
    ears: list[Joint] = [
        (f"{ear}.L", "joint4", (0.1, 0.76, 0.39)),
        (f"{ear}2.L", f"{ear}.L", (0.2, 0.76, 0.3)),
    ]
    joints = [*trunk, *both([*legs, *ears])]
    (found,) = recognise(rig_with(joints)).characters
    legs_found = [k for k in found.chains if k.kind == "leg"]
    assert len(legs_found) == 4
    assert all(k.is_sure is certain for k in legs_found)
