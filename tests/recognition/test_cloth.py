"""Skirts, coats and strips of cloth are neither legs nor arms, and make no limb unsure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from recognition_bodies.skeletons import ARM, FINGERS, LEG, TRUNK, Joint, both, line, renamed, rig_with

from rigtri.model.content import Content
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.recognition.recognise import recognise

_BENT_ARM = line(
    "clavicle.L upper_arm.L forearm.L hand.L",
    "chest",
    (0.04, 1.45, 0),
    (0.16, 1.45, 0),
    (0.3, 1.25, -0.08),
    (0.4, 1.05, 0.1),
)


def ghost(strips: list[Joint], foot: float) -> Rig:
    """A body without names on strips whose ends move points so far ahead; its elbows say where it faces."""
    joints = [*TRUNK, *both([*_BENT_ARM, *strips])]
    rig = rig_with(joints, named=False)
    ends = np.array([[k] for k, (name, _, _) in enumerate(joints) if name.startswith("strip")])
    points = rig.world[ends.repeat(2), 3, :3] + [[0.0, -0.02, -0.02], [0.0, -0.08, foot]] * len(ends)
    mesh = Mesh("ends", -1, points, 0, ends.repeat(2, axis=0), np.ones((len(points), 1)))
    return replace(rig, content=Content(read_outlines=lambda: [mesh]))


@pytest.mark.parametrize("count", [3, 4, 5])
def test_strips_of_cloth_below_a_ghost_are_no_sure_legs(count: int) -> None:
    places = [(0.14, 0.97 - 0.25 * k, 0.0) for k in range(count)]
    strips = line(" ".join(f"strip{k}.L" for k in range(count)), "hips", *places)
    layout = recognise(ghost(strips, 0.02))
    assert [chain.name for chain in layout.chains if chain.is_sure and chain.kind == "leg"] == []
    assert any("as a strip of cloth does" in remark for remark in layout.remarks)


def test_straight_legs_without_toes_are_sure_where_what_they_move_is_a_foot() -> None:
    places = [(0.14, 0.97 - 0.43 * k, 0.0) for k in range(3)]
    layout = recognise(ghost(line("strip0.L strip1.L strip2.L", "hips", *places), 0.2))
    assert [chain.kind for chain in layout.chains if chain.is_sure].count("leg") == 2


@pytest.mark.parametrize("word", ["Jacket", "Dress", "coat", "スカート", "裙子"])
def test_a_chain_that_is_called_clothing_is_no_leg_of_an_upper_body(word: str) -> None:
    strips = line(
        f"{word}_1.L {word}_2.L {word}_3.L", "hips", (0.15, 1, 0.05), (0.16, 0.85, 0.06), (0.17, 0.7, 0.06)
    )
    layout = recognise(rig_with([*TRUNK, *both([*ARM, *strips])]))
    assert [chain.name for chain in layout.chains if chain.kind in ("arm", "leg")] == [
        "left arm",
        "right arm",
    ]


def test_arms_of_one_who_crouches_in_wide_sleeves_are_sure_below_strands_of_hair() -> None:
    """Names of bones are those of front legs below the arms of a centaur, which hang from no head."""
    torso = [(0, 1, 0), (0, 1.07, 0.07), (0, 1.29, 0.18), (0, 1.42, 0.27), (0, 1.49, 0.34)]
    arm = [(0.03, 1.36, 0.27), (0.18, 1.37, 0.24), (0.29, 1.12, 0.17), (0.31, 0.94, 0.35), (0.32, 0.88, 0.42)]
    sleeve = [(0.31, 0.89, 0.35), (0.31, 0.74, 0.35), (0.31, 0.54, 0.35)]
    leg = [(0.1, 0.95, 0), (0.12, 0.84, 0.42), (0.21, 0.46, 0.27), (0.21, 0.39, 0.4)]
    hair = [(0.12, 1.65, 0.38), (0.22, 1.45, 0.35), (0.25, 1.15, 0.33), (0.27, 0.8, 0.33), (0.29, 0.45, 0.33)]
    limbs = [
        *line("clavicle.L upper_arm.L forearm.L hand.L finger.L", "chest", *arm),
        *line("sleeve1.L sleeve2.L sleeve3.L", "hand.L", *sleeve),
        *line("thigh.L shin.L foot.L toe.L", "hips", *leg),
        *line("curl1.L curl2.L curl3.L curl4.L curl5.L", "head", *hair),
    ]
    layout = recognise(rig_with([*line("hips spine chest neck head", "", *torso), *both(limbs)]))
    assert {"left arm", "right arm"} <= {chain.name for chain in layout.chains if chain.is_sure}


def hung_with_cables(arm: Sequence[Joint], long: float) -> Rig:
    """Somebody without names who has a third joint in the spine, and cables at its first."""
    heights = (1.0, 1.1, 1.2, 1.3, 1.5, 1.6)
    trunk = line("hips spine belly chest neck head", "", *((0, high, 0) for high in heights))
    cable = line("c1.L c2.L c3.L", "spine", *((0.22 + 0.02 * k, 1.15 - long * k, -0.05) for k in range(3)))
    return rig_with([*trunk, *both([*arm, *LEG, *cable])], named=False)


@pytest.mark.parametrize("long", [0.2, 0.28])
def test_cables_below_arms_without_fingers_are_no_sure_arms(long: float) -> None:
    """Before, they were, at 0.94, since only the joints next to theirs were asked for other arms."""
    rig = hung_with_cables(ARM, long)
    limbs = list(recognise(rig).chains)
    assert not any(chain.is_sure for chain in limbs if chain.kind == "arm")
    assert all(chain.is_sure for chain in limbs if chain.kind == "leg")


def test_arms_that_end_in_hands_are_no_hair_above_cables() -> None:
    """Before, cables at the spine had it that what is above them is hair or ears."""
    rig = hung_with_cables([*ARM, *(joint for joint in FINGERS if joint[0].endswith(".L"))], 0.2)
    arms = [chain for chain in recognise(rig).chains if chain.kind == "arm"]
    assert len(arms) == 2
    assert all(arm.is_sure for arm in arms)
    left = next(arm for arm in arms if arm.side == "left")
    assert rig.world[left.bend[2], 3, :3] == pytest.approx((0.7, 1.45, 0.0))


@pytest.mark.parametrize("legs", ["cuisse tibia pied", "leg_a leg_b leg_c", ""])
@pytest.mark.parametrize("count", [3, 5])
def test_cables_of_a_machine_on_two_legs_are_no_sure_arms(count: int, legs: str) -> None:
    """Before, they were, at 0.94, where no scheme of names knows the legs. These stay sure."""
    names = " ".join(f"cable_{k}.L" for k in range(count))
    cable = line(names, "chest", *((0.22, 1.35 - 0.15 * k, 0.0) for k in range(count)))
    called = dict(zip(("thigh", "shin", "foot"), legs.split(), strict=False))
    joints = renamed([*TRUNK, *both([*LEG, *cable])], called)
    limbs = list(recognise(rig_with(joints, named=bool(legs))).chains)
    assert not any(chain.is_sure for chain in limbs if chain.kind == "arm")
    assert [chain.is_sure for chain in limbs if chain.kind == "leg"] == [True, True]


def test_arms_of_no_names_that_bend_or_have_clavicles_are_sure() -> None:
    """Of one who stands relaxed, without fingers."""
    relaxed = [(0.05, 1.45, 0.0), (0.18, 1.45, 0.0), (0.24, 1.2, -0.01), (0.27, 0.97, 0.03)]
    arm = line("clavicle.L upper_arm.L forearm.L hand.L", "chest", *relaxed)
    limbs = list(recognise(rig_with([*TRUNK, *both([*arm, *LEG])], named=False)).chains)
    assert [chain.is_sure for chain in limbs if chain.kind == "arm"] == [True, True]
