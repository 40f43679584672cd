"""What hands hold has joints in line, as limbs have, once leaf bones end it."""

from __future__ import annotations

import pytest
from recognition_bodies.skeletons import FINGERS, MAN, both, line, rig_with, without

from rigtri.recognition.recognise import recognise


@pytest.mark.parametrize("leaf", ["weapon_end", "weapon_leaf", "weaponNub"])
@pytest.mark.parametrize("held", ["weapon", "sword"])
def test_a_weapon_with_a_leaf_bone_makes_no_arm_unsure(held: str, leaf: str) -> None:
    """Before, the shape alone was said to bend at the weapon, its tip and the leaf bone."""
    names = f"{held}.L {held}_tip.L {leaf}.L"
    weapon = both(line(names, "hand.L", (0.7, 1.43, 0.08), (0.7, 1.45, 0.98), (0.7, 1.46, 1.43)))
    rig = rig_with([*MAN, *weapon])
    arms = [chain for chain in recognise(rig).chains if chain.kind == "arm"]
    assert [rig.names[chain.bend[2]] for chain in arms if chain.is_sure] == ["hand.L", "hand.R"]


@pytest.mark.parametrize("above", ["upper_arm.L", "forearm.L"])
def test_what_hangs_at_an_arm_is_no_arm_though_it_is_longer_than_the_way_to_the_hand(above: str) -> None:
    """Before, the longest way down was the arm: a banner at the upper arm was one, sure."""
    hung = line("a.L b.L c.L", above, (0.35, 1.4, 0.05), (0.55, 1.0, 0.35), (0.75, 0.55, 0.6))
    joints = [*MAN, *FINGERS, *both(hung)]
    sure = [k for k in recognise(rig_with(joints, named=False)).chains if k.kind == "arm" and k.is_sure]
    assert sorted([joints[k][0] for k in chain.bend] for chain in sure) == [
        [f"{name}.{side}" for name in ("upper_arm", "forearm", "hand")] for side in "LR"
    ]


@pytest.mark.parametrize("clavicle", [True, False])
def test_two_spears_that_stand_on_hands_without_names_are_no_arms(clavicle: bool) -> None:
    """Before, each was an arm, at 0.88: it is longer than the arm that holds it."""
    spear = line("s1.L s2.L s3.L", "hand.L", (0.7, 1.45, 0), (0.7, 2.15, 0), (0.7, 2.85, 0))
    joints = [*MAN, *both(spear)]
    if not clavicle:
        joints = [
            (name, over.replace("clavicle.L", "chest").replace("clavicle.R", "chest"), at)
            for name, over, at in joints
        ]
        joints = without(joints, "clavicle")
    (man,) = recognise(rig_with(joints, named=False)).characters
    arms = [chain for chain in man.chains if chain.kind == "arm" and chain.is_sure]
    assert not [chain for chain in arms if joints[chain.bend[2]][0].startswith("s")]
