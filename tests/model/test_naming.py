"""What joint names say about side, part and limb."""

from __future__ import annotations

import pytest

from rigtri.model.joint_names import side, twin, without_prefix


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("hand.L", "left"),
        ("hand_r", "right"),
        ("mixamorig:LeftForeArm", "left"),
        ("Bip01 R Thigh", "right"),
        ("J_Bip_L_UpperArm", "left"),
        ("左ひじ", "left"),
        ("왼쪽위팔", "left"),
        ("허벅지_오른쪽", "right"),
        ("RElbow", "right"),
        ("spine_01", ""),
        ("Lower", ""),
        ("left_to_right", ""),
    ],
)
def test_a_name_gives_its_side(name: str, expected: str) -> None:
    assert side(name) == expected


@pytest.mark.parametrize(
    "name",
    [
        "hand.L",
        "LeftArm",
        "l_knee_jnt",
        "左ひじ",
        "왼쪽위팔",
        "오른손",
        "허벅지_왼쪽",
        "Bip01 L Foot",
        "mixamorig:LeftHand",
        "lShldr",
        "RArm",
        "armL",
        "lf_arm",
        "RtArm",
    ],
)
def test_the_twin_of_the_twin_is_the_name_itself(name: str) -> None:
    assert twin(name) != name
    assert twin(twin(name)) == name


def test_of_several_ways_to_write_the_other_side_names_tell_which_it_is() -> None:
    """Before, ``Lt_Arm`` said no side, and ``RT_Leg`` was the twin of ``LF_Leg``, where ``RF_Leg`` is."""
    assert side("Lt_Arm") == "left"
    assert [twin("Rt_Arm", [name]) for name in ("Lt_Arm", "Lf_Arm", "arm")] == ["Lt_Arm", "Lf_Arm", "Lf_Arm"]
    assert [twin("LF_Leg", [name]) for name in ("RF_Leg", "RT_Leg")] == ["RF_Leg", "RT_Leg"]
    assert twin("RF_Leg", ["LF_Leg"]) == "LF_Leg"
    assert twin("RF_Leg") == "RF_Leg"


def test_a_name_without_a_side_is_its_own_twin() -> None:
    assert twin("spine_lower") == "spine_lower"
    assert twin("Lefty") == "Lefty"


def test_words_that_all_names_begin_with_are_ignored() -> None:
    assert without_prefix(["Fight_Hips", "Fight_LeftUpLeg"]) == ["Hips", "LeftUpLeg"]
    assert without_prefix(["CATHead", "CATHips", "CATFLLeg1"]) == ["Head", "Hips", "FLLeg1"]
    assert without_prefix(["LFArm", "LFLeg"]) == ["LFArm", "LFLeg"]
    assert without_prefix(["HEAD", "HEAt"]) == ["HEAD", "HEAt"]
    assert without_prefix(["arm", "armature"]) == ["arm", "armature"]
    assert without_prefix(["Fight_Hips"]) == ["Fight_Hips"]
    assert without_prefix([]) == []
