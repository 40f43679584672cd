"""Arms without names of which other joints may be elbow or hand: twist joints, and the cloth of sleeves."""

from __future__ import annotations

import pytest
from recognition_bodies.skeletons import LEG, TRUNK, Joint, both, line, rig_with

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
