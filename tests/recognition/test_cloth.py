"""Skirts, coats and strips of cloth are neither legs nor arms, and make no limb unsure."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from recognition_bodies.skeletons import ARM, TRUNK, Joint, both, line, rig_with

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
