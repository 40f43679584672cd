"""How rigs of some makers are called: in segments, as controls, with hands left out, with uneven twins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from recognition_bodies.skeletons import ARM, LEG, MAN, TRUNK, Joint, both, line, renamed, rig_with, without
from rigs import rig_of

from rigtri.model.rig import Rig
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.layout import Chain
from rigtri.recognition.name_readings import _in_place
from rigtri.recognition.recognise import recognise

SIDES = ("left", "right")


def limbs(rig: Rig) -> dict[str, Chain]:
    return {chain.name: chain for chain in recognise(rig).chains if chain.kind in ("arm", "leg")}


def joints_of(rig: Rig, *, sure: bool = True) -> dict[str, str]:
    """Start, middle and end of each limb by its name; sure: of those alone that may be acted upon."""
    return {
        name: " ".join(rig.names[k] for k in chain.bend)
        for name, chain in limbs(rig).items()
        if chain.is_sure or not sure
    }


def in_segments(limb: str, bones: Sequence[Joint], parts: int, *, elbow: bool = False) -> list[Joint]:
    """A limb each of whose bones has so many segments, as mGear names it; elbow: with two joints there."""
    (_, above, a), (_, _, b), (_, _, c) = bones
    shares = np.arange(parts)[:, np.newaxis] / parts
    places = [
        *(a + shares * np.subtract(b, a)),
        *([b] if elbow else []),
        *(b + shares * np.subtract(c, b)),
        c,
    ]
    names = [*(f"{limb}_{k}" for k in range(len(places) - 1)), f"{limb}_end"]
    tops = [above, *names]
    return [
        (f"{n}.L", t if k == 0 else f"{t}.L", tuple(p))
        for k, (n, t, p) in enumerate(zip(names, tops, places, strict=False))
    ]


@pytest.mark.parametrize(
    ("parts", "elbow", "middle"), [(1, False, 1), (2, False, 2), (3, False, 3), (3, True, 4)]
)
def test_a_limb_in_counted_segments_bends_in_the_middle_of_its_count(
    parts: int, elbow: bool, middle: int
) -> None:
    """Before, the first three of ``arm_0`` … ``arm_end`` were the arm, and of legs surely so."""
    arm, leg = (
        in_segments(limb, bones, parts, elbow=elbow) for limb, bones in (("arm", ARM[1:]), ("leg", LEG[:3]))
    )
    rig = rig_with([*TRUNK, *both([ARM[0], *arm, *leg])])
    assert joints_of(rig) == {
        f"{side} {limb}": " ".join(f"{limb}_{k}.{side[0].upper()}" for k in (0, middle, "end"))
        for side in SIDES
        for limb in ("arm", "leg")
    }


def test_a_leg_whose_last_joint_is_called_its_end_still_bends_at_its_second() -> None:
    """The law beside it: thigh, shin and foot that are counted are no segments, though a tip follows them."""
    words = {"thigh": "leg1", "shin": "leg2", "foot": "leg3", "toe": "leg_end"}

    def called(name: str) -> str:
        part, dot, side = name.partition(".")
        return words.get(part, part) + dot + side

    rig = rig_with([(called(n), called(a), at) for n, a, at in MAN])
    assert joints_of(rig, sure=False)["left leg"] == "leg1.L leg2.L leg3.L"


def test_what_is_called_a_control_and_moves_points_is_a_bone() -> None:
    """Before, none of a rig's limbs was found if all its joints are called ``CTRL_FK_…``."""
    called = {name: f"CTRL_{'FK_' * ('.' in name)}{name}" for name, *_ in MAN}
    joints = [(called[name], called.get(above, ""), at) for name, above, at in MAN]
    rig = rig_with(joints)
    weighed = (replace(rig.skins[0], weigh=lambda: np.ones(len(joints), dtype=bool)),)
    (found,) = recognise(replace(rig, skins=weighed)).characters
    assert {k.name for k in found.chains if k.is_sure and k.bend} == {
        f"{s} {k}" for s in SIDES for k in ("arm", "leg")
    }
    assert [len(chain.joints) for chain in found.chains if chain.kind == "foot"] == [2, 2]


def test_an_arm_without_a_hand_does_not_end_at_a_leg() -> None:
    """Before, legs without feet were the hands of such arms, and the arms legs."""
    arm = line("Arm.L ForeArm.L", "body", (0.17, 0.72, 0), (0.21, 0.55, 0))
    leg = line("Leg.L Shin.L", "waist", (0.055, 0.37, 0), (0.055, 0.2, 0))
    trunk = line("root waist body head", "", (0, 0, 0), (0, 0.4, 0), (0, 0.6, 0), (0, 0.79, 0))
    found = joints_of(rig_with([*trunk, *both([*arm, *leg])]), sure=False)
    assert found == {f"{side} {kind}": "" for side in SIDES for kind in ("arm", "leg")}


def test_limbs_that_names_call_twins_are_a_pair_though_their_bones_differ() -> None:
    """Before, no limb was found of words that no scheme has, where noise made twins unlike."""
    words = {"upper_arm": "humerus", "forearm": "radius", "hand": "carpus"}

    def called(name: str) -> str:
        part, dot, side = name.partition(".")
        return words.get(part, part) + dot + side

    moved = {"forearm.L": (0.52, 1.45, -0.005), "hand.L": (0.71, 1.45, 0)}
    rig = rig_with([(called(n), called(a), moved.get(n, at)) for n, a, at in MAN])
    found = joints_of(rig, sure=False)
    assert found["left arm"] == "humerus.L radius.L carpus.L"
    assert found["right arm"] == "humerus.R radius.R carpus.R"


def test_an_uneven_arm_begins_where_its_makers_scheme_says() -> None:
    """Before, single words of a Daz arm without a twin surely had it begin at its ``ShldrTwist``."""
    words = {"clavicle": "Collar", "upper_arm": "ShldrBend", "forearm": "ForearmBend", "hand": "Hand"}
    words |= {"thigh": "ThighBend", "shin": "Shin", "foot": "Foot", "toe": "Toe", "chest": "chestUpper"}

    def called(name: str) -> str:
        part, _, side = name.partition(".")
        return side.lower() + words.get(part, part)

    given = [(called(n), called(a), at) for n, a, at in without(MAN, "clavicle")]
    given = [(n, "rShldrTwist" if n == "rForearmBend" else a, at) for n, a, at in given]
    row = [n for n, *_ in given].index("rForearmBend")
    given[row:row] = [("rShldrTwist", "rShldrBend", (-0.25, 1.39, 0.0))]
    given = [
        (n, a.replace("rCollar", "chestUpper").replace("lCollar", "chestUpper"), at) for n, a, at in given
    ]
    found = joints_of(rig_with(given), sure=False)
    assert found["right arm"] == "rShldrBend rForearmBend rHand"


def test_an_arm_whose_last_joint_is_called_a_hand_ends_there() -> None:
    """Before, its hand could be a twist joint, as only the upper bone was parted (Auto-Rig Pro)."""
    arm = line(
        "shoulder.L c_arm_twist.L arm_stretch.L forearm_stretch.L hand.L",
        "chest",
        *((x, 1.45, z) for x, z in ((0.04, 0), (0.16, 0), (0.3, -0.0025), (0.44, -0.005), (0.7, 0))),
    )
    found = joints_of(rig_with([*TRUNK, *both([*arm, *LEG])]))
    assert found["left arm"] == "c_arm_twist.L forearm_stretch.L hand.L"


def test_no_limb_surely_begins_at_a_crooked_part_of_its_upper_bone() -> None:
    """Before, twist joints that noise bends surely were shoulders, after another twist joint."""
    places = ((0.04, 1.45, 0), (0.16, 1.45, 0), (0.3, 1.4, 0.05), (0.44, 1.45, -0.005), (0.7, 1.45, 0))
    arm = line("shoulder.L arm_twist.L arm_stretch.L forearm_stretch.L hand.L", "chest", *places)
    found = joints_of(rig_with([*TRUNK, *both([*arm, *LEG])]))
    assert not any("arm" in name for name in found) or found["left arm"].startswith("arm_twist.L")


def test_bones_of_the_middle_count_that_are_below_the_lowest_one() -> None:
    places = np.array([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 1.2, 0.0], [0.0, 1.5, 0.0], [0.0, 1.7, 0.0]])
    rig = rig_of(["top", "pelvis", "spine_ctl", "neck", "head"], [-1, 0, 0, 1, 3], places)
    bones = {"hips": 1, "spine": 2, "neck": 3, "head": 4, "left hand": 2}
    assert _in_place(Tree(rig, range(5), places), bones) == len(bones) - 1


def test_optitracks_letters_before_arm_are_a_side_and_a_bone() -> None:
    """Before, ``LF`` of ``LFArm`` was the left front, so that both arms of a person were not sure."""
    called = {"clavicle": "Shoulder", "upper_arm": "UArm", "forearm": "FArm", "hand": "Hand"}
    called |= {"thigh": "Thigh", "shin": "Shin", "foot": "Foot", "toe": "Toe"}

    def name(word: str) -> str:
        bone, dot, side = word.partition(".")
        return f"{side}{called[bone]}" if dot else word

    joints = [(name(joint), name(above), at) for joint, above, at in MAN]
    found = joints_of(rig_with(joints))
    assert found["left arm"] == "LUArm LFArm LHand"
    assert found["right arm"] == "RUArm RFArm RHand"


_UNREAL = {"hips": "pelvis", "spine": "spine_01", "chest": "spine_02", "neck": "neck_01", "toe": "ball"}
_UNREAL |= {"upper_arm": "upperarm", "forearm": "lowerarm", "shin": "calf"}


@pytest.mark.parametrize("root", ["root", "pelvis"])
def test_a_corrective_joint_of_unreal_is_no_second_upper_arm_where_all_joints_hang_at_one(root: str) -> None:
    """Before, ``upperarm_bicep_l`` might have been the start of the arm as well, and no arm was sure."""
    called = renamed(MAN, _UNREAL, ("_l", "_r"))
    helper = both([("upperarm_bicep.L", "upperarm.L", (0.3, 1.47, 0.04))])
    joints = [("root", "", (0.0, 0.0, 0.0)), *called, *renamed(helper, {}, ("_l", "_r"))]
    top = [name for name, _, _ in joints].index(root)
    flat = [
        (name, root if k > top else "root" if k else "", place) for k, (name, _, place) in enumerate(joints)
    ]
    sure = [one for one in recognise(rig_with(flat)).chains if one.kind == "arm" and one.is_sure]
    assert sorted(flat[one.bend[0]][0] for one in sure) == ["upperarm_l", "upperarm_r"]
