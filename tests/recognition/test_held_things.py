"""What hands hold has joints in line, as limbs have, once leaf bones end it."""

from __future__ import annotations

import pytest
from recognition_bodies.skeletons import MAN, both, line, rig_with

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
