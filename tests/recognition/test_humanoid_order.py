"""The bone above each bone of a humanoid, as VRM's specifications have it, and joints that are elsewhere."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import pytest
from recognition_bodies.skeletons import MAN, rig_with
from rigs import rig_of

from rigtri.model.rig import Rig
from rigtri.recognition.humanoid_order import ABOVE, ABOVE_0, below_others, misplaced
from rigtri.recognition.recognise import recognise

TRUNK = {
    "hips": "",
    "spine": "hips",
    "chest": "spine",
    "upperChest": "chest",
    "neck": "upperChest",
    "head": "neck",
    "leftEye": "head",
    "rightEye": "head",
    "jaw": "head",
}
LEFT = {
    "leftUpperLeg": "hips",
    "leftLowerLeg": "leftUpperLeg",
    "leftFoot": "leftLowerLeg",
    "leftToes": "leftFoot",
    "leftShoulder": "upperChest",
    "leftUpperArm": "leftShoulder",
    "leftLowerArm": "leftUpperArm",
    "leftHand": "leftLowerArm",
    "leftIndexProximal": "leftHand",
    "leftIndexIntermediate": "leftIndexProximal",
    "leftIndexDistal": "leftIndexIntermediate",
    "leftMiddleProximal": "leftHand",
    "leftMiddleIntermediate": "leftMiddleProximal",
    "leftMiddleDistal": "leftMiddleIntermediate",
    "leftRingProximal": "leftHand",
    "leftRingIntermediate": "leftRingProximal",
    "leftRingDistal": "leftRingIntermediate",
    "leftLittleProximal": "leftHand",
    "leftLittleIntermediate": "leftLittleProximal",
    "leftLittleDistal": "leftLittleIntermediate",
}
THUMB = {
    "leftThumbMetacarpal": "leftHand",
    "leftThumbProximal": "leftThumbMetacarpal",
    "leftThumbDistal": "leftThumbProximal",
}
THUMB_0 = {
    "leftThumbProximal": "leftHand",
    "leftThumbIntermediate": "leftThumbProximal",
    "leftThumbDistal": "leftThumbIntermediate",
}


@pytest.mark.parametrize(("above", "thumb"), [(ABOVE, THUMB), (ABOVE_0, THUMB_0)])
def test_the_bone_above_each_bone_is_that_of_the_specification(above: object, thumb: dict[str, str]) -> None:
    left = LEFT | thumb
    right = {k.replace("left", "right"): v.replace("left", "right") for k, v in left.items()}
    assert above == TRUNK | left | right


def test_joints_that_are_not_below_that_of_the_bone_above_are_found() -> None:
    """Where that has no joint, the next above counts; the last bone has none and is nowhere wrong."""
    names = ["hips", "spine", "head", "leftHand", "leftUpperArm", "leftFoot"]
    rig = rig_of(names, [-1, 0, 1, 0, 3, 2], [[0, 0, 0]] * 6)
    bones = {name: node for node, name in enumerate(names)}
    # The hand is below the hips but not the upper arm, the upper arm not below the spine.
    assert list(misplaced(rig, bones)) == [(3, 4), (4, 1)]
    assert not list(misplaced(rig, {"leftHand": 3, "leftFoot": 5}))


def test_joints_right_below_a_bone_of_another_limb_are_found() -> None:
    names = ["hips", "spine", "leftUpperLeg", "twist", "leftHand", "leftFoot", "prop"]
    rig = rig_of(names, [-1, 0, 1, 2, 3, 2, 5], [[0, 0, 0]] * 7)
    named = ("hips", "spine", "leftUpperLeg", "leftHand", "leftFoot")
    bones = {name: names.index(name) for name in named}
    # The leg is below the spine, and the hand below the leg; the foot only lacks the shin between.
    assert list(below_others(rig, bones)) == [(2, 1), (4, 2)]


def test_thumbs_of_vrm_0_and_of_vrm_1_are_in_order() -> None:
    """Before, the tip of a thumb of VRM 0 was reported as below a joint that is none of those above it."""
    for parts in (("Metacarpal", "Proximal", "Distal"), ("Proximal", "Intermediate", "Distal")):
        names = ["leftHand", *(f"leftThumb{part}" for part in parts)]
        rig = rig_of(names, [-1, 0, 1, 2], [[0, 0, 0]] * 4)
        assert not list(below_others(rig, {name: node for node, name in enumerate(names)}))


_PARTS = {"upper_arm": "UpperArm", "forearm": "LowerArm", "hand": "Hand"}
_PARTS |= {"thigh": "UpperLeg", "shin": "LowerLeg", "foot": "Foot", "clavicle": "Shoulder", "toe": "Toes"}
_SIDES = {"L": "left", "R": "right"}


def mapped(other: Mapping[str, str], *, named: bool) -> Rig:
    """A man with a humanoid map in which joints have the bones of others, by their names."""
    rig, joints = rig_with(MAN), [name for name, _, _ in MAN]
    bones = {}
    for node, joint in enumerate(joints):
        word, _, side = other.get(joint, joint).partition(".")
        bones[_SIDES[side] + _PARTS[word] if side else word] = node
    return replace(rig, humanoid=bones, names=rig.names if named else ("",) * len(rig))


def exchanged(one: str, two: str, *words: str) -> dict[str, str]:
    """Names with the one ending or beginning for the other, and back, of these words."""
    pairs = [(name, name.replace(one, two)) for name, _, _ in MAN if one in name]
    pairs = [pair for pair in pairs if not words or pair[0].partition(".")[0] in words]
    return dict(pairs) | {b: a for a, b in pairs}


_ARMS, _LEGS = ("upper_arm", "forearm", "hand"), ("thigh", "shin", "foot")
_ARM_AND_LEG = {
    f"{a}.{side}": f"{b}.{side}"
    for one, two in ((_ARMS, _LEGS), (_LEGS, _ARMS))
    for a, b in zip(one, two, strict=True)
    for side in "LR"
}


@pytest.mark.parametrize("named", [True, False])
@pytest.mark.parametrize(
    ("other", "sure", "why"),
    [
        ({}, (4, 4), ""),
        (_ARM_AND_LEG, (0, 0), "entries of the humanoid map that cannot be: leftUpperArm"),
        ({"upper_arm.L": "hand.L", "hand.L": "upper_arm.L"}, (3, 3), "leftUpperArm"),
        (exchanged(".L", ".R"), (0, 0), "the humanoid map"),
        (exchanged(".L", ".R", *_ARMS, "clavicle"), (2, 0), "the humanoid map"),
        (exchanged(".L", ".R", "shin"), (2, 2), "leftLowerLeg"),
    ],
    ids=["right", "arm and leg", "shoulder and hand", "left and right", "arms", "shins"],
)
def test_limbs_of_a_humanoid_map_that_cannot_be_are_not_sure(
    other: dict[str, str], sure: tuple[int, int], why: str, named: bool
) -> None:
    """Before, all were sure at 0.99, and no remark said what is wrong.

    Where arms alone are exchanged and no name tells, legs may be as well.
    """
    layout = recognise(mapped(other, named=named))
    limbs = [chain for chain in layout.chains if chain.kind in ("arm", "leg")]
    assert [len(limbs), sum(limb.is_sure for limb in limbs)] == [4, sure[not named]]
    assert any(why in remark for remark in layout.remarks) == bool(why)
