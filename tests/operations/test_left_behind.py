"""What is said of followers that an edit leaves behind, also where their metadata is of another file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from followers import BUILT, MOVES, off, stored
from test_bake_followers import built, source_of
from test_take_followers import bent

import rigtri
from rigtri import (
    add_posereader,
    add_socket,
    bake,
    constrain,
    edit,
    orient_joints,
    rename_joints,
    set_rest,
    take_clips,
)
from rigtri.formats import read
from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.animation import Track
from rigtri.model.rig import Rig
from rigtri.operations.follower_places import followers, off_at_rest
from rigtri.operations.left_behind import LeftBehind
from rigtri.report import Report

POSE = "bend@0.5"


def behind(report: Report) -> list[Sequence[str]]:
    """The names in each warning of followers that were left behind."""
    return [list(notice.names) for notice in report.warnings if notice.code == "followers-behind"]


@pytest.fixture
def reading(tmp_path: Path) -> Rig:
    """An arm with a rivet and a pose reader that drives a morph target."""
    source, joint, mesh = source_of("glb", tmp_path)
    return built(read(source).rig, joint, mesh, Report())


@pytest.mark.parametrize("names", [("other", "names"), ()])
def test_a_morph_target_that_was_renamed_is_not_measured(names: tuple[str, ...], reading: Rig) -> None:
    """Before, every edit ended with the traceback of a ValueError."""
    report = Report()
    meshes = [replace(mesh, morph_names=names) for mesh in reading.meshes]
    renamed = replace(reading, content=replace(reading.content, read_meshes=lambda: meshes))
    orient_joints(renamed, offset=(10, 20, 30), report=report)
    assert behind(report) == []


def test_a_reader_that_follows_a_target_it_does_not_have_is_not_measured(reading: Rig) -> None:
    """Before, every edit ended with the traceback of a ValueError."""
    node = reading.find("reader")
    stored = reading.metadata[node]
    outputs = [{**output, "target": "#3"} for output in stored["outputs"]]
    driven = [{"target": "#3", "joint": reading.address(reading.find("pin")), "translation": [1, 0, 0]}]
    damaged = {**stored, "outputs": [*outputs, *driven]}
    set_rest(replace(reading, metadata={**reading.metadata, node: damaged}), pose=POSE)


@pytest.mark.parametrize("change", [{"primitive": 4}, {"primitive": -1}, {"vertices": [0, 1]},
                                    {"vertices": [0, 1, 10**6]}, {"vertices": [0, -1, 2]}])  # fmt: skip
def test_a_rivet_without_its_triangle_is_not_measured(change: dict[str, object], reading: Rig) -> None:
    node = reading.find("button")
    damaged = {**reading.metadata[node], **change}
    report = Report()
    set_rest(replace(reading, metadata={**reading.metadata, node: damaged}), pose=POSE, report=report)
    assert behind(report) == []


def in_two_clips(rig: Rig) -> Rig:
    """The rig with a second clip, which moves as the first one does."""
    first = rig.clips[0]
    return replace(rig, clips=(first, replace(first, name="again", key=None)))


@pytest.mark.parametrize("baked", ["bend", "*"])
def test_a_follower_that_was_not_baked_in_one_clip_is_named_for_another(baked: str, tmp_path: Path) -> None:
    """Before, the worst of all clips was compared: once off its place in one, it was never named."""
    source, joint, _ = source_of("glb", tmp_path)
    rig = constrain(in_two_clips(read(source).rig), type="parent", child="pin", driver=joint)
    rig = bake(rig, clip=(baked,), to="joints")
    report = Report()
    take_clips(rig, from_=bent(rig, joint), report=report)
    assert behind(report) == [["pin"]]


@pytest.mark.parametrize("steps", [1, 2])
def test_a_follower_is_named_for_one_key_of_a_long_clip(steps: int, tmp_path: Path) -> None:
    """Before, so many keys of a clip were looked at, and an edit of one frame may have been none of them."""
    source, joint, _ = source_of("glb", tmp_path)
    rig = read(source).rig
    clip, node = rig.clips[0], rig.find(joint)
    times = np.linspace(0.0, 200.0, 12001)
    turns = from_axis_angle(np.array([0.0, 0.0, 1.0]), np.sin(times))
    moved = replace(clip, tracks=(Track(node, "rotation", "LINEAR", times, turns),))
    rig = constrain(replace(rig, clips=(moved,)), type="parent", child="pin", driver=joint)
    rig = bake(rig, to="joints")
    (track,) = (t for t in rig.clips[0].tracks if (t.node, t.path) == (node, "rotation"))
    values = track.values.copy()
    values[1511] = from_axis_angle(np.array([0.0, 0.0, 1.0]), 2.5)
    tracks = tuple(replace(t, values=values) if t is track else t for t in rig.clips[0].tracks)
    other = replace(rig, clips=(replace(rig.clips[0], tracks=tracks),))
    report, whole = Report(), LeftBehind()
    with whole.noting():
        made = take_clips(rig, from_=other, report=report)
        for _ in range(1, steps):
            made = rename_joints(made, map={"names": {joint: "renamed"}}, report=report)
    whole.warn(made, report)
    assert behind(report) == [["pin"]]


def test_what_a_later_step_of_an_edit_brings_back_is_not_named(tmp_path: Path) -> None:
    """Before, each step warned, and the bake that the warning asks for did not count."""
    source, joint, mesh = source_of("glb", tmp_path)
    place, report = tmp_path / "rig.glb", Report()
    edit(source, place, lambda rig, report: bake(built(rig, joint, mesh, report), to="joints"))
    other = bent(read(place).rig, "lower")

    def taken(rig: Rig, report: Report) -> Rig:
        return take_clips(rig, from_=other, report=report)

    def step(rig: Rig, report: Report) -> Rig:
        return bake(taken(rig, report), to="joints", report=report)

    edit(place, tmp_path / "out.glb", step, report=report, strict=True)
    assert behind(report) == []
    edit(
        place, tmp_path / "again.glb", lambda rig, report: renamed(taken(rig, report), report), report=report
    )
    assert [sorted(names) for names in behind(report)] == [["new_button", "new_reader"]]


def renamed(rig: Rig, report: Report) -> Rig:
    return rename_joints(rig, name={"button": "new_button", "reader": "new_reader"}, report=report)


def test_a_single_follower_stays_behind_what_it_follows(tmp_path: Path) -> None:
    """Before: "'pin' stay behind what they follow"."""
    source, joint, _ = source_of("glb", tmp_path)
    rig = bake(constrain(read(source).rig, type="parent", child="pin", driver=joint), to="joints")
    report = Report()
    set_rest(rig, pose=POSE, report=report)
    (text,) = [notice.text for notice in report.warnings if notice.code == "followers-behind"]
    assert text == "At rest, 'pin' stays behind what it follows: put it there with rigtri bake"


def test_a_place_that_is_no_number_any_more_is_off(reading: Rig) -> None:
    """Before, it counted as on its place."""
    node = reading.find("button")
    local = reading.translation.copy()
    local[node] = np.nan
    (rivet,) = [each for each in followers(reading) if each.node == node]
    assert off_at_rest(replace(reading, translation=local), [rivet]) == [np.inf]


def test_of_a_reader_the_joint_that_it_drives_is_named(samples: Path) -> None:
    """Before, the reader was."""
    rig = add_socket(read(samples / "biped.glb").rig, name="helper", on="forearm_L")
    rig = add_posereader(
        rig, driver="shin_L", target=("up=walk@0",), joint=(("up", "helper", "tx=0.1"),), name="knee"
    )
    report = Report()
    take_clips(bake(rig, to="joints"), from_=bent(rig, "shin_L"), report=report)
    assert behind(report) == [["helper"]]


def test_new_keys_between_those_of_a_bake_leave_nothing_behind(samples: Path, tmp_path: Path) -> None:
    """Before, what a bake leaves between keys counted as behind at keys that yaw has added."""
    rig = stored(BUILT["children"](rigtri.read(samples / "biped.glb")), tmp_path / "in.glb")
    report = Report()
    rigtri.root_motion(rig, yaw=True, report=report)
    assert behind(report) == []


@pytest.mark.ci
@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_a_rivet_that_is_put_elsewhere_leaves_what_follows_it_behind_and_the_next_bake_takes_it_there(
    suffix: str, samples: Path, tmp_path: Path
) -> None:
    """Before, it was refused with 6: the child of the constraint no longer stood where that holds it."""
    source, out = tmp_path / f"in{suffix}", tmp_path / f"out{suffix}"
    stored(BUILT["rivets"](rigtri.read(samples / f"biped{suffix}")), source)
    report = Report()
    edit(source, out, MOVES["add-rivet"], report=report)
    assert behind(report) == [["stuck_1"]]
    edit(out, out, lambda rig, report: bake(rig, to="joints", report=report), overwrite=True)
    assert max(off(read(out).rig).values()) < 2e-4


def test_a_child_that_was_never_baked_has_no_keys_that_follow_the_old_motion(tmp_path: Path) -> None:
    """Before, it was told that its keys do, and it had none."""
    source, joint, _ = source_of("glb", tmp_path)
    moved, report = read(source).rig, Report()
    rig = constrain(replace(moved, clips=()), type="parent", child="pin", driver=joint)
    take_clips(rig, from_=replace(rig, clips=moved.clips), report=report)
    (text,) = [notice.text for notice in report.warnings if notice.code == "followers-behind"]
    assert text == "In clips, 'pin' stays behind what it follows: put it there with rigtri bake"
