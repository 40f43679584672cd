"""What joint names say about side, part and limb."""

from __future__ import annotations

import pytest

from rigtri.naming import limb_parts, side, twin, without_prefix


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("hand.L", "left"),
        ("hand_r", "right"),
        ("mixamorig:LeftForeArm", "left"),
        ("Bip01 R Thigh", "right"),
        ("J_Bip_L_UpperArm", "left"),
        ("左ひじ", "left"),
        ("RElbow", "right"),
        ("spine_01", ""),
        ("Lower", ""),
        ("left_to_right", ""),
    ],
)
def test_a_name_tells_its_side(name: str, expected: str) -> None:
    assert side(name) == expected


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("upper_arm.L", "arm/start"),
        ("LeftArm", "arm/start"),
        ("LeftForeArm", "arm/middle"),
        ("lowerarm_l", "arm/middle"),
        ("LElbow", "arm/middle"),
        ("wrist.l", "arm/end"),
        ("LeftUpLeg", "leg/start"),
        ("DEF-shin.R.001", "leg/middle"),
        ("RKnee", "leg/middle"),
        ("foot_r", "leg/end"),
    ],
)
def test_a_name_tells_its_part_of_a_limb(name: str, expected: str) -> None:
    assert limb_parts(name)[0] == expected


@pytest.mark.parametrize(
    "name", ["handIK.L", "handslot.l", "kneeIK.r", "PoleTarget.L", "l-LEGCONTROL", "upperarm_twist_01_l"]
)
def test_a_control_or_helper_is_no_part_of_a_limb(name: str) -> None:
    assert limb_parts(name) == ()


@pytest.mark.parametrize(
    "name", ["hand.L", "LeftArm", "l_knee_jnt", "左ひじ", "Bip01 L Foot", "mixamorig:LeftHand"]
)
def test_the_twin_of_the_twin_is_the_name_itself(name: str) -> None:
    assert twin(name) != name
    assert twin(twin(name)) == name


def test_a_name_without_a_side_is_its_own_twin() -> None:
    assert twin("spine_lower") == "spine_lower"
    assert twin("Lefty") == "Lefty"


def test_words_that_all_names_begin_with_say_nothing() -> None:
    assert without_prefix(["Fight_Hips", "Fight_LeftUpLeg"]) == ["Hips", "LeftUpLeg"]
    assert without_prefix(["arm", "armature"]) == ["arm", "armature"]
