"""take-clips: crowds, instances of one character or many, of which EDITED moves only some."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from calls import calls
from crowds import crowd
from program import cli
from rigs import rig_of
from usd_files import MESH, animation, deviation, save, scene, skeleton

from rigtri.maths.matrices import inverse
from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.take_clips.take_clips import take_clips
from rigtri.report import Report

ALL, NONE = "instanceable = true", "instanceable = false"
OTHER = animation("Other").replace("(0.8, 0, 0.6, 0), (0.6,", "(1, 0, 0, 0), (0.6,")


def changed(source: Path, agent: str, old: str, new: str, more: str = "") -> Path:
    """The crowd with something else said about one agent; more: prims before it."""
    before, mark, after = source.read_text().partition(f'def "{agent}"')
    out = source.with_name("edited.usda")
    out.write_text(before + more + "\n" + mark + after.replace(old, new, 1))
    return out


def taken(source: Path, edited: Path, code: int) -> str:
    out = source.with_name("out.usda")
    ran = cli("take-clips", source, "--from", edited, "-o", out, code=code)
    assert out.exists() == (code == 0)
    return ran.output


@pytest.mark.parametrize("agent", ["One", "Two"])
@pytest.mark.parametrize(("clip", "more"), [("Run", ""), ("Other", OTHER)])
def test_an_instance_that_plays_another_animation_alone_is_refused_by_name(
    agent: str, clip: str, more: str, tmp_path: Path
) -> None:
    source = crowd(tmp_path)
    edited = changed(source, agent, "</World/Walk>", f"</World/{clip}>", more)
    printed = taken(source, edited, 5)
    assert "'/World/Two' and '/World/One/Skel' share the animation 'Walk' in RIG" in printed
    assert f"'{clip}'" in printed


def test_an_instance_with_joints_of_its_own_in_one_file_is_refused_by_name(tmp_path: Path) -> None:
    source = crowd(tmp_path)
    assert "'Two' of RIG is an instance" in taken(source, changed(source, "Two", ALL, NONE), 5)
    alone = changed(source, "Two", ALL, NONE)
    assert "'Two' has joints of its own in RIG" in taken(alone.rename(tmp_path / "alone.usda"), source, 5)


def test_an_edit_of_one_of_several_animations_is_refused_by_name(tmp_path: Path) -> None:
    source = crowd(tmp_path)
    edited = source.with_name("edited.usda")
    edited.write_text(source.read_text().replace("(0.8, 0, 0.6, 0), (0.6,", "(1, 0, 0, 0), (0.6,"))
    assert "'Walk' of EDITED is not 'Walk' of RIG" in taken(source, edited, 5)


def test_where_an_instance_goes_comes_home(tmp_path: Path) -> None:
    source = crowd(tmp_path)
    path = "xformOp:translate = (4.0, 0, 0)"
    keys = "xformOp:translate.timeSamples = {1: (4, 0, 0), 5: (5, 0, 1)}"
    edited = changed(source, "Two", path, keys)
    taken(source, edited, 0)
    assert deviation(tmp_path / "edited.usda", tmp_path / "out.usda", at_rest=False) == 0.0
    assert deviation(source, tmp_path / "out.usda", at_rest=False) > 0.1


def test_one_clip_is_that_of_several_animations_which_the_user_names(tmp_path: Path) -> None:
    source = crowd(tmp_path)
    other = animation("Take").replace("(0.8, 0, 0.6, 0), (0.6,", "(1, 0, 0, 0), (0.6,")
    edited = save(tmp_path, scene(skeleton(source="rel skel:animationSource = </Root/Take>"), other, MESH))
    assert "say which 'Take' is with --as 'Take=CLIP'" in taken(source, edited, 2)


def dancers(count: int, angle: float) -> Rig:
    """Characters of three joints, each with a clip of its own that bends the middle one so far at last."""
    names = [f"{part}{k}" for k in range(count) for part in ("hips", "spine", "head")]
    parents = [3 * k + above for k in range(count) for above in (-3 * k - 1, 0, 1)]
    places = np.array([[5.0 * k * (part == 0), 1, 0.2 * part] for k in range(count) for part in range(3)])
    rig = rig_of(names, parents, places)
    times, bends = np.array([0.0, 1, 2]), np.array([0.0, 0.1, angle])
    turns = from_axis_angle(np.array([0.0, 0, 1]), bends)
    every = [np.arange(3 * k, 3 * k + 3) for k in range(count)]
    return replace(
        rig,
        skins=tuple(Skin(f"skin{k}", joints, inverse(rig.world[joints])) for k, joints in enumerate(every)),
        clips=tuple(
            Clip(f"dance{k}", (Track(3 * k + 1, "rotation", "LINEAR", times, turns),)) for k in range(count)
        ),
    )


def test_each_clip_of_a_crowd_costs_what_its_own_character_does() -> None:
    """Before, all joints of all characters were compared for each clip."""

    def steps(count: int) -> int:
        rig, edited = dancers(count, 0.2), dancers(count, 0.4)
        return calls(lambda: take_clips(rig, from_=edited))

    steps(2)  # what is imported and looked up once
    few, more, many = steps(3), steps(6), steps(12)
    assert many - more < 2.4 * (more - few)


def test_a_character_that_rests_in_another_pose_is_named_for_each_clip_of_the_others() -> None:
    rig, edited = dancers(3, 0.2), dancers(3, 0.4)
    turned = edited.rotation.copy()
    turned[8] = from_axis_angle([1.0, 0, 0], 0.5)
    report = Report()
    take_clips(rig, from_=replace(edited, rotation=turned), report=report)
    held = [notice.text for notice in report.warnings if notice.code == "held-without-keys"]
    assert [text.partition(",")[0] for text in held] == [
        f"EDITED has no keys of 'head2' in 'dance{k}'" for k in range(3)
    ]
