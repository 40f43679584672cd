"""Chains that move no point beside the bones that do: those of IK, FK and mechanisms, without names."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from recognition_bodies.skeletons import FINGERS, MAN, Joint, rig_with

from rigtri.model.rig import Rig
from rigtri.recognition.recognise import recognise

BONES = [*MAN, *FINGERS]
LIMBS = [
    *("upper_arm.L forearm.L hand.L", "upper_arm.R forearm.R hand.R"),
    *("thigh.L shin.L foot.L", "thigh.R shin.R foot.R"),
]


def doubled(off: float) -> tuple[Rig, list[str]]:
    """A man whose limbs each have a chain before and one behind them that moves nothing; and his names."""
    above = {name: over for name, over, _ in BONES}
    at = {name: place for name, _, place in BONES}

    def idle(mark: str) -> list[Joint]:
        found: list[Joint] = []
        for limb in LIMBS:
            over = above[limb.split()[0]]
            for k, name in enumerate(limb.split()):
                x, y, z = at[name]
                found.append((mark + name, over, (x, y, z + off * (k - 1))))
                over = mark + name
        return found

    trunk = [joint for joint in BONES if "." not in joint[0]]
    clavicles = [joint for joint in BONES if joint[0].startswith("clavicle")]
    rest = [joint for joint in BONES if joint not in trunk and joint not in clavicles]
    joints = [*trunk, *clavicles, *idle("ik "), *rest, *idle("fk ")]
    moved = np.array([" " not in name for name, _, _ in joints])
    rig = rig_with(joints, named=False)
    skin = replace(rig.skins[0], weigh=lambda: moved)
    return replace(rig, skins=(skin,)), [name for name, _, _ in joints]


def test_limbs_without_names_are_the_chains_that_move_points() -> None:
    """Before, one of the three was taken for each limb, and surely."""
    rig, names = doubled(0.0)
    (man,) = recognise(rig).characters
    found = {" ".join(names[k] for k in chain.bend) for chain in man.limbs if chain.is_sure}
    assert found == set(LIMBS)


@pytest.mark.parametrize("off", [0.004, 0.01])
def test_a_chain_beside_the_bones_that_moves_nothing_is_no_sure_limb(off: float) -> None:
    """Of a man whose other leg has no such chain, and with noise between chain and bones."""
    leg = [joint for joint in MAN if joint[0] in ("thigh.R", "shin.R", "foot.R")]
    idle = [
        (f"ik {name}", over if k == 0 else f"ik {over}", (x, y, z))
        for k, (name, over, (x, y, z)) in enumerate(leg)
    ]
    bones = [
        (name, over, (x + off, y, z) if (name, over, (x, y, z)) in leg else (x, y, z))
        for name, over, (x, y, z) in BONES
    ]
    joints = [*bones[:5], *idle, *bones[5:]]
    moved = np.array([" " not in name for name, _, _ in joints])
    rig = rig_with(joints, named=False)
    rig = replace(rig, skins=(replace(rig.skins[0], weigh=lambda: moved),))
    names = [name for name, _, _ in joints]
    sure = {
        " ".join(names[k] for k in chain.bend)
        for chain in recognise(rig).chains
        if chain.is_sure and chain.bend
    }
    assert sure <= set(LIMBS)
