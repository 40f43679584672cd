"""Which bone of a humanoid is below which.

Source: VRMC_vrm 1.0, humanoid.md (parent-child relationships of humanoid bones); VRM 0.x, humanoid.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from rigtri.model.rig import Rig
from rigtri.recognition.layout import FINGERS, PHALANGES

_TRUNK = {
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
_LIMBS = {
    "UpperLeg": "hips",
    "LowerLeg": "UpperLeg",
    "Foot": "LowerLeg",
    "Toes": "Foot",
    "Shoulder": "upperChest",
    "UpperArm": "Shoulder",
    "LowerArm": "UpperArm",
    "Hand": "LowerArm",
}


def _above(thumb: tuple[str, str, str]) -> dict[str, str]:
    """Every bone with the bone above it. thumb: its segments from the hand on."""
    found = dict(_TRUNK)
    for side in ("left", "right"):
        for bone, parent in _LIMBS.items():
            found[side + bone] = parent if parent in _TRUNK else side + parent
        chains = [[f"{finger}{part}" for part in PHALANGES] for finger in FINGERS[1:]]
        for chain in (*chains, [f"Thumb{part}" for part in thumb]):
            for bone, parent in zip(chain, ["Hand", *chain], strict=False):
                found[side + bone] = side + parent
    return found


ABOVE: Mapping[str, str] = _above(("Metacarpal", "Proximal", "Distal"))
ABOVE_0: Mapping[str, str] = _above(PHALANGES)


def misplaced(rig: Rig, bones: Mapping[str, int]) -> Iterator[tuple[int, int]]:
    """The joints of bones that are not below the joint of the bone above them, with that joint.

    bones: joints by bone.
    """
    for bone, node in bones.items():
        parent = next((each for each in _all_above(bone, bones) if each in bones), "")
        if parent and bones[parent] not in rig.path_to_root(node):
            yield node, bones[parent]


def below_others(rig: Rig, bones: Mapping[str, int]) -> Iterator[tuple[int, int]]:
    """The joints of bones right below one that is none of those above them in a humanoid, with that joint.

    bones: joints by bone.
    """
    bone_of = {node: bone for bone, node in bones.items()}
    for bone, node in bones.items():
        above = next((each for each in rig.path_to_root(node)[1:] if each in bone_of), -1)
        allowed = {*_all_above(bone, bones)}
        if above >= 0 and allowed and bone_of[above] not in allowed:
            yield node, above


def _all_above(bone: str, bones: Collection[str]) -> Iterator[str]:
    """The bones above one, the nearest first; a thumb has the segments of VRM 0 where these bones do."""
    above = ABOVE_0 if "leftThumbIntermediate" in bones or "rightThumbIntermediate" in bones else ABOVE
    while bone := above.get(bone, ""):
        yield bone
