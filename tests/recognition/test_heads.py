"""Which joint is the head, of those beyond the arms; and which the first of a finger."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from recognition_bodies.skeletons import LEG, MAN, TRUNK, Joint, both, line, renamed, rig_with

from rigtri.model.content import Content
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.recognition.layout import CONFIDENT
from rigtri.recognition.recognise import recognise

ARMS = both(
    line("upper_arm.L forearm.L hand.L", "chest", (0.16, 1.45, 0), (0.44, 1.45, -0.005), (0.7, 1.45, 0))
)
# All that hangs at the head.
JAW: Joint = ("jaw", "head", (0, 1.63, 0.06))
BODY = [*TRUNK, JAW, *ARMS, *both(LEG)]
# How far from each joint its points reach.
SIZES = {"neck": 0.06, "head": 0.1, "jaw": 0.02}


def with_points(rig: Rig, joints: list[Joint]) -> Rig:
    """Each joint moves the two ends of the diagonal of a cube around it."""
    half = np.array([SIZES.get(name, 0.08) for name, _, _ in joints])
    places = np.array([place for _, _, place in joints])
    points = np.concatenate([places - half[:, np.newaxis], places + half[:, np.newaxis]])
    rows = np.tile(np.arange(len(joints)), 2)[:, np.newaxis]
    mesh = Mesh("body", 0, points, skin=0, joints=rows, weights=np.ones(rows.shape))
    return replace(rig, content=Content(read_outlines=lambda: [mesh]))


def found(rig: Rig, joints: list[Joint]) -> dict[str, list[str]]:
    """The joints of neck and head, of those that are sure."""
    (character,) = recognise(rig).characters
    return {
        chain.kind: [joints[k][0] for k in chain.joints]
        for chain in character.chains
        if chain.kind in ("neck", "head") and chain.confidence >= CONFIDENT
    }


@pytest.mark.parametrize(
    "names",
    [
        {"neck": "DEF-spine.004", "head": "DEF-spine.005", "jaw": "DEF-jaw"},
        {"neck": "neck.x", "head": "head.x", "jaw": "c_jawbone.x"},
        {"neck": "NPC Neck [Neck]", "head": "NPC Head [Head]"},
        {"neck": "Neck_M", "head": "Head_M", "jaw": "Jaw_M"},
    ],
    ids=["Rigify", "Auto-Rig Pro", "Skyrim", "Advanced Skeleton"],
)
def test_a_jaw_that_is_all_a_head_has_is_not_the_head(names: dict[str, str]) -> None:
    """Before, the jaw was the head, and the head a part of the neck, and both were sure."""
    rig = rig_with(BODY)
    called = replace(rig, names=tuple(names.get(name, name) for name in rig.names))
    assert found(called, BODY) == {"neck": ["neck"], "head": ["head"]}


def test_the_last_of_several_necks_is_the_head() -> None:
    """As CesiumMan has it."""
    joints = [*TRUNK, *ARMS, *both(LEG)]
    called = {"neck": "Skeleton_neck_joint_1", "head": "Skeleton_neck_joint_2"}
    rig = rig_with(joints)
    rig = replace(rig, names=tuple(called.get(name, name) for name in rig.names))
    assert found(rig, joints) == {"neck": ["neck"], "head": ["head"]}


def test_a_neck_that_nothing_is_above_is_no_head() -> None:
    """Before, rename-joints called it a head."""
    joints = [(name, above, at) for name, above, at in BODY if name not in ("head", "jaw")]
    assert found(rig_with(joints), joints) == {"neck": ["neck"]}


def test_the_base_of_all_fingers_is_no_phalanx() -> None:
    """As CMU's motion capture has it. Before, it was the first of the index finger."""
    fingers = line("FingerBase.L HandIndex1.L", "hand.L", (0.74, 1.45, 0), (0.8, 1.45, 0))
    thumb = line("Thumb.L", "hand.L", (0.72, 1.44, 0.05))
    joints = [*BODY, *both([*fingers, *thumb])]
    (body,) = recognise(rig_with(joints)).characters
    assert joints[body.bones["leftIndexProximal"]][0] == "HandIndex1.L"


def test_the_eyes_of_smpl_x_are_eyes() -> None:
    """Before, they were helpers, and conformed characters had none."""
    eyes: list[Joint] = [
        (f"{side}_eye_smplhf", "head", (x, 1.66, 0.08)) for side, x in (("left", 0.03), ("right", -0.03))
    ]
    joints = [*BODY, *eyes]
    (body,) = recognise(rig_with(joints)).characters
    assert [joints[body.bones[bone]][0] for bone in ("leftEye", "rightEye")] == [name for name, _, _ in eyes]


def test_without_names_what_moves_far_less_than_the_head_is_a_jaw() -> None:
    rig = with_points(rig_with(BODY, named=False), BODY)
    assert found(rig, BODY) == {"neck": ["neck"], "head": ["head"]}


def test_without_names_a_small_head_with_ears_is_no_jaw() -> None:
    """Before, of a long neck and a small head the neck's last joint was the head, at 0.85."""
    ears: list[Joint] = [(f"ear{side}", "jaw", (x, 1.7, 0.06)) for side, x in (("L", 0.04), ("R", -0.04))]
    joints = [*BODY, *ears]
    rig = with_points(rig_with(joints, named=False), joints)
    assert found(rig, joints) == {}
    (character,) = recognise(rig).characters
    assert [joints[k][0] for c in character.chains if c.kind == "head" for k in c.joints] == ["jaw"]


def test_without_names_or_a_neck_a_head_with_a_jaw_is_not_sure() -> None:
    """A small head on a thick neck would look the same."""
    joints = [(name, "chest" if name == "head" else above, at) for name, above, at in BODY if name != "neck"]
    assert found(with_points(rig_with(joints, named=False), joints), joints) == {}


def test_the_neck_of_a_numbered_trunk_begins_beyond_the_arms() -> None:
    """Rigify's numbers are those of three spine joints; before, the fourth and fifth were of the neck."""
    spine = [(f"DEF-spine.{k:03}", (0, 1.0 + 0.06 * k, 0)) for k in range(1, 6)]
    names = " ".join(["hips", *(name for name, _ in spine), "neck", "head"])
    places = [(0, 1, 0), *(at for _, at in spine), (0, 1.5, 0), (0, 1.6, 0.02)]
    arms = [(name, "DEF-spine.005" if above == "chest" else above, at) for name, above, at in ARMS]
    joints = [*line(names, "", *places), *arms, *both(LEG)]
    called = {"hips": "DEF-spine", "neck": "DEF-spine.006", "head": "DEF-spine.007"}
    called |= {name: f"DEF-{name}" for name, _, _ in (*arms, *both(LEG))}
    rig = rig_with(joints)
    rig = replace(rig, names=tuple(called.get(name, name) for name in rig.names))
    assert found(rig, joints) == {"neck": ["neck"], "head": ["head"]}
    (character,) = recognise(rig).characters
    (trunk,) = (chain.joints for chain in character.chains if chain.kind == "spine")
    assert [joints[k][0] for k in trunk] == [name for name, _ in spine]
    bones = {part.bone: joints[part.joint][0] for part in character.parts}
    assert bones["neck"] == "neck"


@pytest.mark.parametrize("called", ["DEF-spine.005", "throat", ""])
def test_what_is_between_the_chest_and_a_head_is_the_neck_whatever_it_is_called(called: str) -> None:
    """Before, it was nothing, the chest aimed at the mean of all its children, and no word said so."""
    rig = rig_with([*BODY, ("cape", "chest", (0, 1.4, -0.3)), ("pack", "chest", (0, 1.3, -0.2))])
    names = {"neck": called, "spine": "DEF-spine.001", "chest": "DEF-spine.003", "head": "DEF-spine.006"}
    rig = replace(rig, names=tuple(names.get(name, name) for name in rig.names))
    (character,) = recognise(rig).characters
    neck = [k for k, (name, _, _) in enumerate(BODY) if name == "neck"]
    assert [list(chain.joints) for chain in character.chains if chain.kind == "neck"] == [neck]
    assert character.bones["neck"] == neck[0]


def test_what_stands_above_legs_alone_is_no_sure_head() -> None:
    """It may be a turret or a load. Before, it was beyond the arms of a body without any, at 0.89."""
    load = [("hips", "", (0, 0.95, 0)), ("middle", "hips", (0, 1.2, 0)), ("top", "middle", (0, 1.5, 0))]
    (character,) = recognise(rig_with([*load, *both(LEG)])).characters
    head = next(chain for chain in character.chains if chain.kind == "head")
    assert not head.is_sure
    assert head.evidence == ("is beyond the legs",)


@pytest.mark.parametrize("over", ["mHead", "mNeck"])
def test_a_collision_volume_of_second_life_is_not_the_head(over: str) -> None:
    """Before, ``HEAD`` was the head and ``mHead`` a part of the neck, or ``mNeck`` the head."""
    names = {"hips": "mPelvis", "spine": "mTorso", "chest": "mChest", "neck": "mNeck", "head": "mHead"}
    body = [(names.get(own, own), names.get(above, above), at) for own, above, at in BODY if own != "jaw"]
    volumes: list[Joint] = [("HEAD", over, (0, 1.67, 0.04)), ("NECK", "mNeck", (0, 1.54, 0))]
    for count in (1, 2):
        joints = [*body, *volumes[:count]]
        assert found(rig_with(joints), joints) == {"neck": ["mNeck"], "head": ["mHead"]}


PAIRED = both([("eye.L", "face", (0.03, 1.68, 0.09))])
ON_HEADS = {
    "jaw": [("jaw", "head", (0, 1.61, 0.05))],
    "hat": [("hat", "head", (0, 1.78, 0))],
    "face": [("face", "head", (0, 1.63, 0.05)), *PAIRED],
    "helmet": [("helmet", "head", (0, 1.8, 0)), *both([("horn.L", "helmet", (0.1, 1.9, 0))])],
    "hair": line("hair1 hair2", "head", (0, 1.75, -0.1), (0, 1.65, -0.16)),
}


@pytest.mark.parametrize("joints", ON_HEADS.values(), ids=ON_HEADS)
def test_what_goes_on_above_a_head_without_names_is_no_sure_head(joints: list[Joint]) -> None:
    """Before, a hat, a jaw and a face were heads at 0.85, and the head was the neck."""
    body = [*TRUNK, *joints, *ARMS, *both(LEG)]
    assert found(rig_with(body, named=False), body).get("head") in (None, ["head"])


@pytest.mark.parametrize("name", ["hat2", "face", "hair_01", "jaw"])
def test_a_word_for_what_heads_have_or_wear_ends_the_neck_where_no_name_of_a_head_is_known(name: str) -> None:
    """Before, `hat2` was a head at 0.85, and what carries it the neck."""
    joints = [*TRUNK, (name, "head", (0, 1.75, 0.02)), *ARMS, *both(LEG)]
    words = {"neck": "krk", "head": "hlava"}
    called = [(words.get(joint, joint), words.get(over, over), at) for joint, over, at in joints]
    assert found(rig_with(called), joints) == {"neck": ["neck"], "head": ["head"]}


@pytest.mark.parametrize(
    ("eyes", "sure"), [(True, {"neck": ["neck", "neck2"], "head": ["head"]}), (False, {})]
)
def test_eyes_or_ears_show_which_of_three_joints_is_the_head(eyes: bool, sure: dict[str, list[str]]) -> None:
    """Nothing tells the head after two joints of a neck from a hat on the head after one."""
    at = {name: place for name, _, place in TRUNK}
    (_, low, _), (_, high, z) = at["neck"], at["head"]
    neck: Joint = ("neck2", "neck", (0, (low + high) / 2, z))
    trunk = [joint for joint in TRUNK if joint[0] != "head"]
    pair = both([("eye.L", "head", (0.03, high + 0.07, 0.08))]) if eyes else []
    joints = [*trunk, neck, ("head", "neck2", at["head"]), *pair, *ARMS, *both(LEG)]
    assert found(rig_with(joints, named=False), joints) == sure


def test_a_neck_below_a_head_that_is_called_nose_is_no_sure_head() -> None:
    """Before, the last joint that is called a neck was the head at 0.89."""
    called = renamed(MAN, {"hips": "MidHip", "neck": "Neck", "head": "Neck1"})
    face: list[Joint] = [
        ("Nose", "Neck1", (0.0, 1.7, 0.03)),
        *both([("eye.L", "Nose", (0.03, 1.75, 0.1))]),
        ("jaw", "Nose", (0.0, 1.68, 0.08)),
    ]
    (character,) = recognise(rig_with([*called, *face])).characters
    assert [one for one in character.chains if one.kind == "head" and one.is_sure] == []
