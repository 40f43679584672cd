"""Half bodies and arms alone, of which nothing shows where they face: hands close, and the rest is told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from posed_bodies import Pose, posed_body

from rigtri import add_controls, add_polevector, orient_joints
from rigtri.maths.matrices import inverse
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.report import Report
from rigtri.verification.checks.axis_check import axis_findings

AHEAD = (0.0, 0.0, 1.0)


def part_of_a_body(pose: Pose, *, below: str = "", without: str = "") -> tuple[Rig, dict[str, Floats]]:
    """What is below a part of a posed body, and not of a side; and the hinge of each part that has one."""
    body = posed_body(pose)
    top = body.parts[below or "hips"]
    parts = {
        part: node
        for part, node in body.parts.items()
        if (node == top or body.rig.is_below(node, top)) and not (without and part.startswith(without))
    }
    rig, place = body.rig.subset(list(parts.values()))
    # What is above the part no longer rotates it.
    turned = np.linalg.solve(body.rig.world[top, :3, :3], rig.world[place[top], :3, :3])
    hinges = {part: body.hinges[node] @ turned for part, node in parts.items() if node in body.hinges}
    skin = Skin("skin", np.arange(len(rig)), inverse(rig.world), weigh=lambda: np.ones(len(rig), dtype=bool))
    return replace(rig, skins=(skin,)), hinges


def off(rig: Rig, pose: Pose, hinges: dict[str, Floats]) -> dict[str, float]:
    """How far +y of each joint is from the hinge of its part, square to the bone, degrees."""
    body, found = posed_body(pose), {}
    for part, hinge in hinges.items():
        aim, up = rig.world[rig.find(body.rig.names[body.parts[part]]), :2, :3]
        across = normalise(hinge - aim * (aim @ hinge) / (aim @ aim))
        found[part] = float(np.degrees(np.arccos(np.clip(normalise(up) @ across, -1, 1))))
    return found


HANDS = ("hand", "index", "middle", "ring", "little")


@pytest.mark.parametrize("curl", [0.0, 8.0])
@pytest.mark.parametrize("whole", [False, True])
def test_the_hand_of_an_arm_alone_closes_about_one_axis(curl: float, whole: bool) -> None:
    """Before, each of its fingers took the plane of its own noise, and the wrist that of the elbow."""
    pose = Pose(elbow=15.0, knee=15.0, curl=curl, noise=1.0)
    which = {"without": "right"} if whole else {"below": "left clavicle"}
    rig, hinges = part_of_a_body(pose, **which)
    out = orient_joints(rig)
    hands = {part: k for part, k in hinges.items() if part.removeprefix("left ").split()[0] in HANDS}
    assert {part: k for part, k in off(out, pose, hands).items() if k > 30.0} == {}
    assert [found for found in axis_findings(out) if "finger" in found[2]] == []


def test_what_takes_the_plane_of_its_noise_for_want_of_a_facing_direction_is_told() -> None:
    """Before, the knee of half a body bent back, and its pole vector was behind it, without a word."""
    pose = Pose(elbow=15.0, knee=-1.0)
    rig, hinges = part_of_a_body(pose, without="right")
    for edit, told in (
        (orient_joints, ["spine, neck, head", "LeftUpLeg"]),
        (lambda rig, **k: add_polevector(rig, limbs="auto", **k), ["LeftUpLeg"]),
        (lambda rig, **k: add_controls(rig, whole_character=True, **k), ["spine, neck, head", "LeftUpLeg"]),
    ):
        unheard, heard = Report(), Report()
        edit(rig, report=unheard)
        edit(rig, report=heard, facing=AHEAD)
        texts = [note.text for note in unheard.warnings if note.code == "no-facing"]
        assert len(texts) == len(told)
        assert all(words in text for words, text in zip(told, texts, strict=True))
        assert "no-facing" not in [note.code for note in heard.warnings]
    right = {part: hinges[part] for part in ("spine", "left upper leg", "left lower leg")}
    assert max(off(orient_joints(rig, facing=AHEAD), pose, right).values()) < 20.0


def test_controls_are_aimed_where_the_user_says_that_a_character_faces() -> None:
    """Before, the facing direction placed their pole vectors alone."""
    rig, _ = part_of_a_body(Pose(elbow=15.0, knee=-1.0), without="right")
    knees = []
    for ahead in (AHEAD, (0.0, 0.0, -1.0)):
        out = add_controls(rig, whole_character=True, facing=ahead)
        (shin,) = [k for k, name in enumerate(out.names) if name.endswith("LeftLeg_ctl")]
        knees.append(normalise(out.world[shin, 1, :3])[0])
    assert np.round(knees) == pytest.approx([1.0, -1.0])


def test_a_limb_that_bends_clearly_needs_no_facing_direction() -> None:
    rig, _ = part_of_a_body(Pose(elbow=15.0), below="left clavicle")
    report = Report()
    orient_joints(replace(rig, clips=()), report=report)
    assert "no-facing" not in [note.code for note in report.warnings]


@pytest.mark.parametrize("without", ["", "right"])
def test_axes_along_the_world_have_no_bend_direction_to_warn_of(without: str) -> None:
    """Before, all limbs that bend little were said to bend by noise, though it was known where they face."""
    rig, _ = part_of_a_body(Pose(elbow=5.0, knee=5.0), without=without)
    report = Report()
    orient_joints(rig, preset="vrm", report=report)
    assert [note.code for note in report.warnings] == []
