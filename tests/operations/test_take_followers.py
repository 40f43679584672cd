"""take-clips: what follows joints has keys of the motion before, until bake makes them anew."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rigtri import add_controls, add_posereader, add_rivet, add_twist, bake, read, take_clips
from rigtri.evaluation.sampling import locals_at, worlds
from rigtri.evaluation.timelines import timelines
from rigtri.evaluation.twist_joints import twist_joints
from rigtri.maths.quaternions import from_axis_angle, multiply
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.bake.bake import BakeOptions
from rigtri.operations.bake.unbaked import moved_otherwise
from rigtri.report import Report


def bent(rig: Rig, joint: str) -> Rig:
    """The rig with a joint turned further in all keys of its first clip."""
    node, more = rig.find(joint), from_axis_angle([0.6, 0.0, 0.8], 0.8)

    def again(track: Track) -> Track:
        if (track.node, track.path) != (node, "rotation"):
            return track
        return replace(track, values=multiply(track.values, more))

    first = rig.clips[0]
    return replace(rig, clips=(replace(first, tracks=tuple(map(again, first.tracks))), *rig.clips[1:]))


@pytest.fixture
def rigged(samples: Path) -> Rig:
    rig = add_twist(read(samples / "biped.glb"), joint="forearm_L", to="hand_L", count=1)
    rig = add_posereader(rig, driver="shin_L", target=("up=walk@0",), name="knee")
    return add_rivet(rig, mesh="body", triangle=(350,), name=("button",))


@pytest.mark.parametrize(
    ("joint", "behind"),
    [
        ("hand_L", ["button", "forearm_L_twist_1"]),
        ("shin_L", ["knee"]),
        ("head", []),
    ],
)
def test_what_follows_another_motion_now_is_named(joint: str, behind: list[str], rigged: Rig) -> None:
    """Before, a reader kept 0.995 where the elbow it reads gives 0.711, without a word; and then all rivets
    were named, also one on a wrist where the head alone moves."""
    report = Report()
    take_clips(rigged, from_=bent(rigged, joint), report=report)
    named = [each.names for each in report.warnings if each.code == "followers-behind"]
    assert [sorted(names) for names in named] == ([sorted(behind)] if behind else [])


def test_the_same_motion_is_taken_without_a_warning(rigged: Rig) -> None:
    report = Report()
    take_clips(rigged, from_=rigged, report=report)
    assert "followers-behind" not in {notice.code for notice in report.warnings}


def test_bake_turns_twist_joints_of_a_rig_without_controls(samples: Path) -> None:
    """Before: "There is nothing to bake"."""
    rig = add_twist(read(samples / "biped.glb"), joint="forearm_L", to="hand_L", count=1)
    taken = take_clips(rig, from_=bent(rig, "hand_L"))
    times = np.array([0.0, 0.25, 0.5])
    (twist,) = twist_joints(taken)

    def error(rig: Rig) -> float:
        clip: Clip = rig.clips[0]
        local = locals_at(rig, clip, times)
        now = np.linalg.norm(local[:, twist.node, :3, :3] - _matrices(twist.rotations(local)), axis=(1, 2))
        return float(now.max())

    assert error(taken) > 0.1
    assert error(bake(taken)) < 1e-6


def _matrices(turns: np.ndarray) -> np.ndarray:
    from rigtri.maths.quaternions import to_axes

    return to_axes(turns)


def test_joints_that_controls_overrule_are_named(samples: Path) -> None:
    """Before, the motion of edited joints was taken, and the next bake replaced it, without a word."""
    plain = read(samples / "biped.glb")
    rig = bake(add_controls(plain, chain=[("spine", "chest")]), to="controls")
    report = Report()
    home = take_clips(rig, from_=bent(plain, "spine"), report=report)
    (found,) = [notice for notice in report.warnings if notice.code == "controls-overrule"]
    assert found.names == ("spine",)
    assert "In 'walk' EDITED moves 'spine' otherwise" in found.text
    # What the warning says puts EDITED's motion onto the controls.
    baked = bake(bake(home, to="controls", discard_motion=True), to="joints")
    times = np.array([0.0, 0.25, 0.5])
    node = rig.find("chest")
    there, back = (worlds(one, locals_at(one, one.clips[0], times))[:, node] for one in (home, baked))
    np.testing.assert_allclose(back, there, atol=1e-5)


def from_blender(shown: Rig) -> Rig:
    """A file that the script of export-blender was at work in, with the IK of a leg on."""
    end = shown.find("foot_L_ik_ctl")
    shown = shown.with_nodes(["rigtri_ik_foot_L_ik_ctl"], [end], np.zeros((1, 3)), np.array([[0.0, 0, 0, 1]]))
    return replace(shown, scale=np.concatenate([shown.scale[:-1], [[1.5] * 3]]))


@pytest.mark.parametrize("posed", [True, False])
def test_keys_of_an_offset_bone_alone_are_named(posed: bool, samples: Path) -> None:
    """Before: "EDITED has no changes", though Blender showed the head elsewhere."""
    rig = bake(add_controls(read(samples / "biped.glb"), whole_character=True), to="controls", fps=24)
    shown, report = from_blender(rig), Report()
    offset = shown.find("neck_ctl_offset")
    turns = np.stack([shown.rotation[offset]] * 2)
    turns[1] = multiply(turns[1], from_axis_angle([0.6, 0.0, 0.8], 0.5 if posed else 1e-5))
    track = Track(offset, "rotation", "LINEAR", np.array([0.0, 0.5]), turns)
    first = replace(shown.clips[0], tracks=(*shown.clips[0].tracks, track))
    take_clips(rig, from_=replace(shown, clips=(first, *shown.clips[1:])), report=report)
    found = [notice.text for notice in report.warnings if notice.code == "offset-keys"]
    assert len(found) == posed
    assert all(text.startswith("Keys of 'neck_ctl_offset' in 'walk' move no joint") for text in found)


@pytest.mark.parametrize(("joint", "told"), [("shin_L", ["shin_L", "foot_L", "toe_L"]), (None, [])])
def test_bake_with_a_rig_names_joints_that_blender_has_shown_otherwise(
    joint: str | None, told: list[str], samples: Path
) -> None:
    """Where a switch of IK has keys, say. Before, the motion of the controls was taken, without a word."""
    rig = bake(add_controls(read(samples / "biped.glb"), whole_character=True), to="controls", fps=24)
    shown = from_blender(bake(rig, fps=24))
    report = Report()
    options = BakeOptions(rig_=rig)
    bake(bent(shown, joint) if joint else shown, options=options, report=report)
    found = [notice for notice in report.warnings if notice.code == "controls-overrule"]
    assert [list(notice.names) for notice in found] == [told] * bool(told)


@pytest.mark.parametrize("joint", ["head", None])
def test_joints_without_controls_and_unedited_ones_are_not(joint: str | None, samples: Path) -> None:
    plain = read(samples / "biped.glb")
    rig = bake(add_controls(plain, chain=[("spine", "chest")]), to="controls")
    report = Report()
    take_clips(rig, from_=bent(plain, joint) if joint else plain, report=report)
    assert "controls-overrule" not in {notice.code for notice in report.warnings}


def test_between_keys_of_a_joint_above_no_motion_is_called_another(samples: Path) -> None:
    """Of a clip that has a key a frame for limbs, and RIG's own between frames for others.

    Before, a limb was said to move by 0.04 of the size otherwise than its controls.
    """
    rig = add_controls(read(samples / "biped.glb"), chain=[("spine", "chest")])
    turns, times = np.radians([0.0, 20.0, 0.0, 20.0, 0.0]), np.arange(5) / 8.0
    values = np.stack([np.sin(turns), 0 * turns, 0 * turns, np.cos(turns)], axis=1)
    spine, chest = rig.find("spine"), rig.find("chest")
    tracks = [
        Track(rig.find(f"{name}_ctl"), "rotation", "LINEAR", times, values) for name in ("spine", "chest")
    ]
    baked = bake(replace(rig, clips=(replace(rig.clips[0], tracks=tuple(tracks)),)))
    (timeline,) = timelines(baked)
    taken = frozenset({(spine, "rotation"), (chest, "rotation")})
    assert max(moved_otherwise(baked, timeline, taken).values()) < 1e-6
    half = tuple(
        replace(t, times=t.times[::2], values=t.values[::2]) if t.node == spine and len(t.times) == 5 else t
        for t in timeline.clip.tracks
    )
    assert half != timeline.clip.tracks
    (timeline,) = timelines(replace(baked, clips=(replace(baked.clips[0], tracks=half),)))
    off = moved_otherwise(baked, timeline, taken)
    assert set(off) == {spine, chest}
    assert max(off.values()) < 1e-6


def test_keys_that_were_not_taken_do_not_hide_those_that_were(samples: Path) -> None:
    """Of a clip of 30 frames a second that was edited at 24, a third of the keys is shared.

    Before, joints were compared everywhere, between their keys, too, and were said to move otherwise by 0.03.
    """
    rig = add_controls(read(samples / "biped.glb"), chain=[("spine", "chest")])
    spine, chest = rig.find("spine"), rig.find("chest")
    times = np.arange(9) / 8.0
    turns = np.radians([0.0, 20.0, 0.0, 20.0, 5.0, 20.0, 0.0, 20.0, 0.0])
    values = np.stack([np.sin(turns), 0 * turns, 0 * turns, np.cos(turns)], axis=1)
    tracks = tuple(
        Track(rig.find(f"{name}_ctl"), "rotation", "LINEAR", times, values) for name in ("spine", "chest")
    )
    baked = bake(replace(rig, clips=(replace(rig.clips[0], tracks=tracks),)))
    mixed = [
        replace(t, times=t.times[::4], values=t.values[::4]) if (t.node, t.path) == (spine, "rotation") else t
        for t in baked.clips[0].tracks
    ]
    assert {len(t.times) for t in mixed if t.path == "rotation" and t.node in (spine, chest)} == {3, 9}
    mixed.append(Track(chest, "scale", "LINEAR", times[:-1] + 1 / 16, np.ones((8, 3))))
    (timeline,) = timelines(replace(baked, clips=(replace(baked.clips[0], tracks=tuple(mixed)),)))
    off = moved_otherwise(baked, timeline, frozenset({(spine, "rotation"), (chest, "rotation")}))
    assert set(off) == {spine, chest}
    assert max(off.values()) < 1e-6
