"""snap: FK takes over from IK, or IK from FK, and nothing moves at that frame."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from places import SAMPLES
from second_opinions import validator
from test_bake import animated, control, moved, rigged, run, size, stored

from rigtri.errors import GeometryError, UsageError
from rigtri.formats import read
from rigtri.ops.bake import Options as BakeOptions
from rigtri.ops.bake import bake
from rigtri.ops.posing import Options as PoseOptions
from rigtri.ops.posing import pose_of
from rigtri.ops.snap import Options, snap
from rigtri.quaternions import from_axis_angle
from rigtri.records import Track
from rigtri.report import Report
from rigtri.rig import Rig

# The bound: of the character's size.
BOUND = 1e-5
ARM = ("upper_arm_L", "forearm_L", "hand_L")


def apart(a: Rig, b: Rig, at: str) -> float:
    """How far joints are apart in the evaluated pose of a moment, places and axes."""
    one, other = pose_of(a, PoseOptions(at)), pose_of(b, PoseOptions(at))
    joints = np.flatnonzero(a.is_joint).tolist()
    return max(float(np.abs(one.world(j) - other.world(j)).max()) for j in joints) / size(a)


def posed_by_ik() -> Rig:
    """All limbs at work by IK in a clip, the left hand elsewhere than the joints' own keys."""
    up = bake(rigged(), options=BakeOptions(to="controls"))
    return moved(up, up.parents[control(up, "hand_L", "ik")], np.array([0.02, 0.05, -0.03]))


def posed_by_fk() -> Rig:
    rig = rigged()
    tracks = []
    for joint, angle in zip(ARM, (0.4, 0.7, -0.3), strict=True):
        turn = from_axis_angle([0.3, 0.2, 1.0], np.array([0.0, angle]))
        turn = turn.astype(np.float32).astype(np.float64)
        tracks.append(Track(control(rig, joint, "fk"), "rotation", "LINEAR", np.array([0.0, 1.0]), turn))
    rig = animated(rig, control(rig, "head", "fk"), "rotation", [[0, 0, 0, 1], [0, 0, 0.6, 0.8]])
    new = rig.clips[-1]
    return replace(rig, clips=(*rig.clips[:-1], replace(new, tracks=(*new.tracks, *tracks))))


def keyed(rig: Rig, clip: str) -> set[int]:
    return {track.node for track in rig.clip(clip).tracks}


@pytest.mark.parametrize("time", [0.0, 0.3, 1.0])
def test_fk_takes_over_where_ik_has_put_the_joints(time: float) -> None:
    rig = posed_by_ik()
    at = f"walk@{time}"
    report = Report()
    done = snap(rig, options=Options("fk", (at,)), report=report)
    assert len(report.added) == 4
    assert apart(rig, done, at) < BOUND
    assert not report.warnings
    assert control(rig, "hand_L", "ik") not in keyed(done, "walk")


@pytest.mark.parametrize("time", [0.25, 1.0])
def test_ik_takes_over_where_fk_has_put_the_joints(time: float) -> None:
    rig = posed_by_fk()
    at = f"new@{time}"
    done = snap(rig, options=Options("ik", (at,), (ARM,)))
    assert apart(rig, done, at) < BOUND
    assert control(rig, "hand_L", "ik") in keyed(done, "new")
    assert control(rig, "hand_R", "ik") not in keyed(done, "new")


def test_several_frames_stand_each_and_there_and_back_is_the_pose() -> None:
    rig = posed_by_fk()
    at = ("new@0.25", "new@0.75", "new@1")
    there = snap(rig, options=Options("ik", at, (ARM,)))
    back = snap(there, options=Options("fk", at, (ARM,)))
    for moment in at:
        assert apart(rig, there, moment) < BOUND
        assert apart(rig, back, moment) < 2 * BOUND


def test_ik_takes_up_what_fk_controls_hold_below_it() -> None:
    rig = bake(rigged(), options=BakeOptions(to="controls"))
    elbow = control(rig, "forearm_L", "fk")
    turn = from_axis_angle([0.0, 0.0, 1.0], 0.2)
    clips = []
    for clip in rig.clips:
        tracks = [t for t in clip.tracks if (t.node, t.path) != (elbow, "rotation")]
        tracks.append(Track(elbow, "rotation", "LINEAR", np.array([0.0, 1.0]), np.array([turn, turn])))
        clips.append(replace(clip, tracks=tuple(tracks)))
    rig = replace(rig, clips=tuple(clips))
    done = snap(rig, options=Options("ik", ("walk@1",), (ARM,)))
    assert apart(rig, done, "walk@1") < BOUND
    hand, end = rig.find("hand_L"), control(rig, "hand_L", "ik")
    for state, together in ((rig, False), (done, True)):
        posed = pose_of(state, PoseOptions("walk@1"))
        gap = np.linalg.norm(posed.world(hand)[0, 3, :3] - posed.world(end)[0, 3, :3])
        assert (gap < BOUND * size(rig)) == together
    assert apart(rig, done, "walk@0") < BOUND  # other keys stay


def test_at_rest_channels_are_set_at_rest() -> None:
    rig = replace(rigged(), clips=())
    hand = control(rig, "hand_L", "ik")
    posed = stored(moved(rig, hand, np.array([-0.05, 0.1, 0.0])))
    done = stored(snap(posed, options=Options("fk", ("rest",), (ARM,))))
    assert apart(posed, done, "rest") < BOUND
    assert apart(rig, done, "rest") > 100 * BOUND
    np.testing.assert_allclose(done.translation[hand], 0.0)


def test_what_cannot_be_snapped_is_told() -> None:
    rig = rigged()
    with pytest.raises(GeometryError, match="no IK end"):
        snap(rig, options=Options("ik", ("rest",), (("hips", "spine", "chest"),)))
    with pytest.raises(UsageError, match="say when"):
        snap(rig, options=Options("ik", ()))


def test_the_command_leaves_the_file_looking_the_same(tmp_path: Path) -> None:
    one, two, out = (tmp_path / f"{k}.glb" for k in range(3))
    run("add-controls", SAMPLES / "biped.glb", "-o", one, "--whole-character")
    run("bake", one, "-o", two, "--to", "controls")
    snapping = ("snap", two, "-o", out, "--all-limbs", "--to", "fk", "--at", "walk@0.5")
    posing = ("pose", two, "-o", tmp_path / "posed.glb", "--at", "walk@0.5")
    baking = ("bake", two, "-o", tmp_path / "baked.glb")
    for command in (snapping, posing, baking):
        told = tmp_path / f"{command[0]}.json"
        done = run(*command, "--report", told)
        assert done.exit_code == 0, done.output
        validator("report").validate(json.loads(told.read_text("utf-8")))
    before, after = read(two).rig, read(out).rig
    assert apart(before, after, "walk@0.5") < BOUND
    assert run("snap", two, "-o", out, "--to", "fk", "--at", "walk@0.5").exit_code == 2
