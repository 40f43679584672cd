"""bake: a second run changes no byte, also where what follows joints shares its key times with them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from places import SAMPLES
from test_bake import WHOLE, control

from rigtri import pose
from rigtri.formats import read
from rigtri.matrices import nearest_rotation
from rigtri.ops.bake import Options, bake
from rigtri.ops.controls import add_controls
from rigtri.ops.posereader import Goal, add_posereader
from rigtri.ops.posereader import Options as ReaderOptions
from rigtri.ops.shared_keys import as_read
from rigtri.ops.twist import Options as TwistOptions
from rigtri.ops.twist import add_twist
from rigtri.pipeline import edit
from rigtri.quaternions import conjugate, from_axes, from_axis_angle, multiply, turn_angle
from rigtri.records import Clip, Track
from rigtri.report import Report
from rigtri.rig import Rig
from rigtri.trigonometry import Floats
from rigtri.twist import twists


def single(values: Floats) -> Floats:
    return np.asarray(values).astype(np.float32).astype(np.float64)


def built(rig: Rig, report: Report) -> Rig:
    """Controls with the clips' motion, twist joints in all limbs, and a reader of a lower arm."""
    rig = add_twist(rig, options=TwistOptions(auto=True), report=report)
    rig = add_controls(rig, options=WHOLE, report=report)
    reader = ReaderOptions("forearm_L", targets=(Goal("up", direction=(0, 1, 0)),), name="reader")
    rig = add_posereader(rig, options=reader, report=report)
    return bake(rig, options=Options(to="controls"), report=report)


def edited(rig: Rig) -> Rig:
    """The FK controls of a hand and its lower arm turn, with keys at other times than the joints had."""
    mine = {control(rig, joint, "fk"): a for joint, a in (("hand_L", 1.1), ("forearm_L", 0.7))}
    times = single(np.array([0.0, 0.37, 0.61, 1.0]) * rig.per_second)
    fresh = []
    for node, angle in mine.items():
        axis = [1.0, 0.3, 0.2]
        turns = np.stack([from_axis_angle(axis, angle * share) for share in (0.0, 1.0, -0.4, 0.2)])
        turns /= np.linalg.norm(turns, axis=1, keepdims=True)
        fresh.append(Track(node, "rotation", "LINEAR", times, single(turns)))
    clips = [
        replace(clip, tracks=tuple(t for t in clip.tracks if (t.node, t.path) not in by(fresh)))
        for clip in rig.clips
    ]
    home = next(k for k, clip in enumerate(rig.clips) if any(t.node in mine for t in clip.tracks))
    clips[home] = replace(clips[home], tracks=(*clips[home].tracks, *fresh))
    return replace(rig, clips=tuple(clips))


def by(tracks: list[Track]) -> set[tuple[int, str]]:
    return {(t.node, t.path) for t in tracks}


def off_law(rig: Rig) -> float:
    """How far twist joints are from what their notes say, at all of their keys, in radians."""
    worst = []
    for clip in rig.clips:
        for twist in twists(rig):
            track = next((t for t in clip.tracks if (t.node, t.path) == (twist.node, "rotation")), None)
            if track is not None:
                local = pose.locals_at(rig, clip, track.times)
                shown = from_axes(nearest_rotation(local[:, twist.node]))
                worst.append(turn_angle(multiply(conjugate(twist.rotations(local)), shown)).max())
    return float(max(worst))


@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_what_follows_joints_is_made_of_the_keys_that_are_read(name: str, tmp_path: Path) -> None:
    ready, once, twice = (tmp_path / f"{k}{Path(name).suffix}" for k in range(3))
    edit(SAMPLES / name, ready, lambda rig, report: edited(built(rig, report)), verify=False)
    edit(ready, once, lambda rig, report: bake(rig, options=Options(), report=report))
    was, now = read(ready).rig, read(once).rig
    turned = [
        pose.locals_at(rig, rig.clips[0], [0.37 * rig.per_second])[0, rig.find("hand_L")]
        for rig in (was, now)
    ]
    assert np.abs(turned[0] - turned[1]).max() > 0.1
    assert off_law(now) < 2e-6
    edit(once, twice, lambda rig, report: bake(rig, options=Options(), report=report))
    assert once.read_bytes() == twice.read_bytes()


def test_joints_that_share_an_array_are_read_at_each_others_times() -> None:
    rig = read(SAMPLES / "biped.usda").rig
    home = next(k for k, c in enumerate(rig.clips) if isinstance(c.key, tuple) and c.key[0] == "samples")
    turns = np.array([[0.0, 0.0, 0.0, 1.0], [0.6, 0.0, 0.0, 0.8]])
    one = Track(rig.find("head"), "rotation", "LINEAR", np.array([0.0, 4.0]), turns)
    other = Track(rig.find("hand_L"), "rotation", "STEP", np.array([0.0, 1.0]), turns)
    clip = Clip(rig.clips[home].name, (one, other), rig.clips[home].key)
    seen = as_read(replace(rig, clips=(clip,)))
    before = float(np.nextafter(np.float32(1.0), np.float32(0.0)))
    for track in seen.rig.clips[0].tracks:
        assert track.times.tolist() == [0.0, before, 1.0, 4.0]
    head, hand = (track.values for track in seen.rig.clips[0].tracks)
    np.testing.assert_allclose(pose.sample(one, [1.0])[0], head[2], atol=1e-7)
    np.testing.assert_allclose(hand, turns[[0, 0, 1, 1]], atol=1e-7)
    plain = replace(rig, clips=(clip,))
    assert seen.undone(seen.rig, plain).clips[0] is clip
    alone = read(SAMPLES / "biped.glb").rig
    assert as_read(alone).rig is alone
