"""Arms without names of which other joints may be elbow or hand: twist joints, and the cloth of sleeves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from recognition_bodies.skeletons import LEG, MAN, TRUNK, Joint, both, line, renamed, rig_with

from rigtri.model.rig import Rig
from rigtri.recognition.recognise import recognise

_CLAVICLE = ("clavicle.L", "chest", (0.04, 1.45, 0.0))
_START = (0.16, 1.45, -0.02)
# The joints along an arm in line, by how far from its start; the hand at 0.5.
_ELBOW, _HAND = 0.27, 0.5


def _arm(*within: tuple[str, float], clavicle: bool = True, bend: float = 0.0) -> list[Joint]:
    """An arm in T-pose, joints in its line, and whatever follows the hand."""
    joints = sorted(
        [("upper_arm.L", 0.0), ("forearm.L", _ELBOW), ("hand.L", _HAND), *within], key=lambda joint: joint[1]
    )
    above, found = "clavicle.L" if clavicle else "chest", [_CLAVICLE] if clavicle else []
    for name, far in joints:
        x, y, z = _START
        found.append((name, above, (x + far, y, z + bend * max(0.0, far - _ELBOW))))
        above = name
    return found


def _sleeve(below: str, *places: tuple[float, float, float]) -> list[Joint]:
    names = " ".join(f"sleeve{k}.L" for k in range(len(places)))
    return line(names, below, *places)


_ARMS = {
    "cloth of a sleeve": [
        *_arm(bend=0.1),
        *_sleeve("forearm.L", (0.6, 1.42, 0), (0.6, 1.2, 0)),
    ],
    "cloth along a sleeve": [*_arm(bend=0.1), *_sleeve("forearm.L", (0.61, 1.45, 0), (0.75, 1.45, 0.02))],
    "cloth of an upper sleeve": [*_arm(bend=0.1), *_sleeve("upper_arm.L", (0.4, 1.4, 0), (0.62, 1.3, 0.1))],
    "twist joint beside the elbow": _arm(("twist.L", 0.24), ("twist2.L", 0.45)),
    "elbow in the middle of two twist joints": _arm(("twist.L", 0.25), ("twist2.L", 0.36)),
    "twist joint at the wrist": _arm(("twist.L", 0.14), ("twist2.L", 0.46)),
    "twist joint at the wrist and a tip": _arm(("twist.L", 0.14), ("twist2.L", 0.46), ("tip.L", 0.58)),
    "tip of a hand": _arm(("twist.L", 0.14), ("tip.L", 0.62)),
    "no clavicle": [
        (name, above, (x + 0.08, y, z))
        for name, above, (x, y, z) in _arm(("twist.L", 0.1), clavicle=False, bend=0.12)
    ],
}


@pytest.mark.parametrize("arm", _ARMS)
def test_an_arm_of_which_another_joint_may_be_elbow_or_hand_is_right_or_not_sure(arm: str) -> None:
    joints = [*TRUNK, *both([*_ARMS[arm], *LEG])]
    layout = recognise(rig_with(joints, named=False))
    arms = [[joints[k][0] for k in one.bend] for one in layout.chains if one.kind == "arm" and one.is_sure]
    true = [[f"{bone}.{side}" for bone in ("upper_arm", "forearm", "hand")] for side in "LR"]
    assert sorted(arms) in ([], true)


def test_hands_with_fingers_stay_sure_beside_cloth_and_after_twist_joints() -> None:
    fingers = [
        joint
        for k in range(5)
        for joint in line(
            f"f{k}1.L f{k}2.L f{k}3.L",
            "hand.L",
            *((0.72 + 0.03 * step + 0.02 * (k > 0), 1.45, 0.05 - 0.02 * k) for step in range(3)),
        )
    ]
    cloth = _sleeve("forearm.L", (0.5, 1.4, 0), (0.5, 1.36, 0), (0.5, 1.33, 0))
    joints = [*TRUNK, *both([*_arm(("twist.L", 0.14), bend=0.3), *cloth, *fingers, *LEG])]
    layout = recognise(rig_with(joints, named=False))
    arms = [
        [joints[k][0] for k in each.bend] for each in layout.chains if each.is_sure and each.kind == "arm"
    ]
    assert sorted(arms) == [[f"{bone}.{side}" for bone in ("upper_arm", "forearm", "hand")] for side in "LR"]


# German, the words of which name a limb but for what a place leaves unknown; helpers have names of anatomy.
_GERMAN = {"UpperArm": "Oberarm", "Forearm": "Unterarm", "Hand": "Hand", "Thigh": "Oberschenkel"}
_GERMAN |= {"Shin": "Unterschenkel", "Foot": "Fuss"}
_TRUNK = {"hips": "Becken", "spine": "Wirbelsaeule", "chest": "Brust", "neck": "Hals", "head": "Kopf"}


def _german(unknown: str, helpers: list[Joint]) -> list[Joint]:
    bones = {"upper_arm": "UpperArm", "forearm": "Forearm", "hand": "Hand"}
    bones |= {"thigh": "Thigh", "shin": "Shin", "foot": "Foot"}
    words = {bone: "Xq" if part == unknown else _GERMAN[part] for bone, part in bones.items()}
    joints = [*TRUNK, *both([*_arm(bend=0.1), *LEG, *helpers])]
    return renamed(joints, {**_TRUNK, **words, "clavicle": "Schulter", "toe": "Zehen"}, ("_L", "_R"))


_HELPERS: dict[str, tuple[str, list[Joint]]] = {
    "a muscle in the place of the ankle": (
        "Foot",
        [
            ("Calf.L", "shin.L", (0.1, 0.3, 0.0)),
            *line("Soleus.L End.L", "shin.L", (0.1, 0.1, 0), (0.1, -0.1, 0)),
        ],
    ),
    "a muscle in the place of the wrist": (
        "Hand",
        [
            ("Ulna.L", "forearm.L", (0.5, 1.45, 0.0)),
            *line("Brachioradialis.L End.L", "forearm.L", (0.66, 1.45, 0), (0.7, 1.45, 0)),
        ],
    ),
}
# The bone of a forearm, in line, before a hand that is called by an unknown word.
_IN_LINE = [("Radius.L", "forearm.L", (0.64, 1.45, 0.02)), ("hand.L", "Radius.L", (0.66, 1.45, 0.02))]


def test_an_arm_that_ends_at_a_joint_called_as_a_bone_of_the_forearm_is_not_sure() -> None:
    joints = [joint for joint in _german("Hand", []) if not joint[0].startswith("Xq")]
    hands = renamed(both(_IN_LINE), {"hand": "Xq", "forearm": "Unterarm"}, ("_L", "_R"))
    layout = recognise(rig_with([*joints, *hands]))
    assert not [one for one in layout.chains if one.kind == "arm" and one.is_sure]


@pytest.mark.parametrize("clavicle", [True, False])
def test_an_arm_that_passes_a_joint_called_as_a_bone_of_the_forearm_is_not_sure(*, clavicle: bool) -> None:
    """Before, humerus, elbow and what follows the radius were an arm, sure to 0.89: the radius may end it."""
    start = [_CLAVICLE] if clavicle else []
    names = "Humerus.L Elbow.L Radius.L f1.L f2.L"
    places = (0.16, 1.45, 0), (0.44, 1.45, -0.005), (0.7, 1.45, 0), (0.78, 1.45, 0), (0.82, 1.45, 0)
    arm = line(names, "clavicle.L" if clavicle else "chest", *places)
    layout = recognise(rig_with([*TRUNK, *both([*start, *arm, *LEG])]))
    assert not [one for one in layout.chains if one.kind == "arm" and one.is_sure]


@pytest.mark.parametrize("helper", _HELPERS)
def test_a_helper_with_a_name_of_anatomy_is_no_joint_of_a_sure_limb(helper: str) -> None:
    joints = _german(*_HELPERS[helper])
    layout = recognise(rig_with(joints))
    used = {
        joints[k][0] for one in layout.chains if one.kind in ("arm", "leg") and one.is_sure for k in one.bend
    }
    assert used.isdisjoint({f"{word}_{s}" for word in ("Soleus", "Brachioradialis") for s in "LR"})


def test_named_limbs_stay_sure_beside_helpers_with_names_of_anatomy() -> None:
    helpers = [joint for _, each in _HELPERS.values() for joint in each if not joint[0].startswith("End")]
    joints = _german("", helpers)
    sure = [one for one in recognise(rig_with(joints)).chains if one.kind in ("arm", "leg") and one.is_sure]
    assert sorted(joints[one.bend[2]][0] for one in sure) == ["Fuss_L", "Fuss_R", "Hand_L", "Hand_R"]


def test_a_bone_of_the_thigh_that_hangs_beside_the_shin_is_not_surely_where_a_leg_begins() -> None:
    joints = [*MAN, *both([("femur.L", "thigh.L", (0.1, 0.85, 0.002))])]
    joints = renamed(joints, {"thigh": "xq", "upper_arm": "upperarm", "toe": "toes"}, ("_L", "_R"))
    layout = recognise(rig_with(joints))
    starts = [joints[one.bend[0]][0] for one in layout.chains if one.kind == "leg" and one.is_sure]
    assert sorted(starts) in ([], ["xq_L", "xq_R"])


def test_a_wrist_in_the_place_of_a_hand_is_no_second_finger() -> None:
    """Before, both were fingers of the forearm, and the arm, whose names all are there, was not sure."""
    joints = [*MAN, *both([("wrist.L", "forearm.L", (0.7, 1.45, 0.0))])]
    layout = recognise(rig_with(joints))
    sure = [[joints[k][0] for k in one.bend] for one in layout.chains if one.kind == "arm" and one.is_sure]
    assert sorted(sure) == [[f"{name}.{side}" for name in ("upper_arm", "forearm", "hand")] for side in "LR"]


_END = (0.7, 1.45, 0.03)


def _with_groups(weighted: frozenset[str]) -> tuple[list[Joint], Rig]:
    """A man with a joint in the place of each upper arm, below it, and the joints that move points."""
    arm = line("upper_arm.L group.L forearm.L hand.L", "clavicle.L", _START, _START, (0.44, 1.45, 0.0), _END)
    joints = [*TRUNK, *both([_CLAVICLE, *arm, *LEG])]
    rig = rig_with(joints, named=False)
    moving = np.array([name.partition(".")[0] in weighted for name, _, _ in joints])
    return joints, replace(rig, skins=(replace(rig.skins[0], weigh=lambda: moving),))


@pytest.mark.parametrize("moves", ["upper_arm", "group", ""])
def test_of_two_joints_in_one_place_that_move_no_points_neither_surely_begins_an_arm(moves: str) -> None:
    """Before, the lower one did at 0.94, also where it is an empty group below the bone."""
    others = {name.partition(".")[0] for name, _, _ in MAN} - {"upper_arm"}
    joints, rig = _with_groups(frozenset({*others, moves}))
    arms = [chain for chain in recognise(rig).chains if chain.kind == "arm"]
    assert len(arms) == 2
    assert [arm.is_sure for arm in arms] == [bool(moves)] * 2
    if moves:
        assert {joints[arm.bend[0]][0].partition(".")[0] for arm in arms} == {moves}
