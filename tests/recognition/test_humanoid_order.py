"""The bone above each bone of a humanoid, as VRM's specifications have it, and joints that are elsewhere."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from rigs import rig_of

from rigtri.recognition.humanoid_order import ABOVE, ABOVE_0, below_others, misplaced

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
    character: Any = SimpleNamespace(bones={name: node for node, name in enumerate(names)})
    # The hand is below the hips but not the upper arm, the upper arm not below the spine.
    assert list(misplaced(rig, character)) == [(3, 4), (4, 1)]
    character.bones = {"leftHand": 3, "leftFoot": 5}
    assert not list(misplaced(rig, character))


def test_joints_right_below_a_bone_of_another_limb_are_found() -> None:
    names = ["hips", "spine", "leftUpperLeg", "twist", "leftHand", "leftFoot", "prop"]
    rig = rig_of(names, [-1, 0, 1, 2, 3, 2, 5], [[0, 0, 0]] * 7)
    named = ("hips", "spine", "leftUpperLeg", "leftHand", "leftFoot")
    character: Any = SimpleNamespace(bones={name: names.index(name) for name in named})
    # The leg is below the spine, and the hand below the leg; the foot only lacks the shin between.
    assert list(below_others(rig, character)) == [(2, 1), (4, 2)]
