"""What is recognised is the same however places are rounded: a second run reads what a first one wrote."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from recognition_bodies.skeletons import ARM, LEG, TRUNK, Joint, both, line, rig_with

from rigtri.recognition.recognise import recognise


def below(joints: list[Joint], number: int) -> list[Joint]:
    """The same arms again, further down the chest."""
    again = [(name.replace(".", f"{number}."), over, place) for name, over, place in joints]
    return [
        (name, over if over == "chest" else over.replace(".", f"{number}."), (x, y - 0.13 * number, z))
        for name, over, (x, y, z) in again
    ]


FOUR_ARMED = [*TRUNK, *both([*ARM, *below(ARM, 1), *LEG])]
FOUR_ARMED = [(name, over, (x / 3, y / 3, z / 3)) for name, over, (x, y, z) in FOUR_ARMED]


def arms(joints: list[Joint], off: float, *, named: bool) -> list[str]:
    """Which arms are recognised, the likeliest first, where those further down are so much longer."""
    rig = rig_with(joints, named=named)
    longer = np.array([[1.0 + off * ("1." in name)] for name, _, _ in joints])
    (found,) = recognise(replace(rig, translation=rig.translation * longer, skins=())).characters
    return [joints[chain.bend[0]][0] for chain in found.chains if chain.bend and chain.kind == "arm"]


@pytest.mark.parametrize("off", [-1e-7, 1e-7])
@pytest.mark.parametrize("named", [True, False])
def test_of_pairs_of_arms_alike_the_first_of_the_file_are_the_arms(named: bool, off: float) -> None:
    """Before, rounding chose, and a second run of orient-joints turned hands by 90°."""
    found = arms(FOUR_ARMED, off, named=named)
    assert set(found[:2]) == {"upper_arm.L", "upper_arm.R"}
    assert set(found[2:]) == {"upper_arm1.L", "upper_arm1.R"}


@pytest.mark.parametrize("fingers", [("thumb", "index", "middle", "ring"), ("thumb", "ring")])
def test_fingers_of_a_lone_arm_do_not_say_where_it_faces(fingers: tuple[str, ...]) -> None:
    """Before, two fingers alike were its left and right, and a pole stood above or below the elbow."""
    joints = line("upper_arm.L forearm.L hand.L", "", (0.2, 1.4, 0), (0.48, 1.4, 0), (0.74, 1.4, 0))
    for k, finger in enumerate(fingers):
        places = [(0.8 + 0.03 * step, 1.4 - 0.004 * step * step, 0.04 - 0.02 * k) for step in range(3)]
        joints += line(" ".join(f"{finger}{step}.L" for step in range(3)), "hand.L", *places)
    (found,) = recognise(rig_with(joints)).characters
    assert [chain.name for chain in found.chains if chain.is_sure and chain.bend] == ["left arm"]
    assert not any(found.facing)
