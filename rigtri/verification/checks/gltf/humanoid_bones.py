"""The bones of VRM humanoids: which there are, which must be there, and which is above which.

Source: VRMC_vrm 1.0, humanoid; VRM 0.0 README, "Defined Bones".
"""

from __future__ import annotations

from collections.abc import Mapping

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
_FINGERS = ("Index", "Middle", "Ring", "Little")
_REQUIRED_LIMBS = ("UpperLeg", "LowerLeg", "Foot", "UpperArm", "LowerArm", "Hand")
_REQUIRED = ("hips", "spine", "head")


def _above(thumb: tuple[str, str, str]) -> dict[str, str]:
    """Every bone with the bone above it. thumb: its segments from the hand on."""
    found = dict(_TRUNK)
    for side in ("left", "right"):
        for bone, parent in _LIMBS.items():
            found[side + bone] = parent if parent in _TRUNK else side + parent
        chains = [
            [f"{finger}{part}" for part in ("Proximal", "Intermediate", "Distal")] for finger in _FINGERS
        ]
        for chain in (*chains, [f"Thumb{part}" for part in thumb]):
            for bone, parent in zip(chain, ["Hand", *chain], strict=False):
                found[side + bone] = side + parent
    return found


ABOVE: Mapping[str, str] = _above(("Metacarpal", "Proximal", "Distal"))
ABOVE_0: Mapping[str, str] = _above(("Proximal", "Intermediate", "Distal"))
REQUIRED = (*_REQUIRED, *(side + bone for side in ("left", "right") for bone in _REQUIRED_LIMBS))
REQUIRED_0 = (*REQUIRED, "chest", "neck")


def needs_parent(bone: str) -> bool:
    """Whether a bone may only be there together with the one above it."""
    return bone == "upperChest" or bone.endswith(("Intermediate", "Distal")) or (
        "Thumb" in bone and bone.endswith("Proximal")
    )  # fmt: skip
