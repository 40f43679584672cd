"""A spline that a DCC has made into a key a frame, with tangents of its own, has not been edited."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rigs import chain

from rigtri.errors import GeometryError
from rigtri.evaluation.sampling import locals_at, sample, worlds
from rigtri.maths.matrices import decompose
from rigtri.maths.quaternions import from_axis_angle, make_continuous
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.animation import Path as TrackPath
from rigtri.model.rig import Rig
from rigtri.operations.take_clips import clip_comparison
from rigtri.operations.take_clips.retargeting import _mapped
from rigtri.operations.take_clips.take_clips import take_clips
from rigtri.report import Report

# Keys of thirty frames a second, and frames of twenty-four: most keys lie between two frames.
KNOTS = np.arange(20) * 4 / 30
FRAMES = np.arange(61) / 24


def natural(values: Floats) -> Floats:
    """The slopes of the curve without jumps of acceleration, by solving for all of them at once."""
    count, step = len(values), KNOTS[1]
    matrix, right = np.zeros((count, count)), np.zeros(values.shape)
    for k in range(count):
        for j in (k - 1, k):
            if 0 <= j < count - 1:
                other = j + 1 if j == k else j
                matrix[k, k] += 2 / step
                matrix[k, other] += 1 / step
                right[k] += 3 / step**2 * (values[j + 1] - values[j])
    return np.asarray(np.linalg.solve(matrix, right))


def spline(node: int, path: TrackPath, values: Floats, slopes: Floats) -> Track:
    return Track(node, path, "CUBICSPLINE", KNOTS, np.stack([slopes, values, slopes], axis=1))


def framed(track: Track) -> Track:
    return Track(track.node, track.path, "LINEAR", FRAMES, sample(track, FRAMES))


def playing(rig: Rig, *tracks: Track) -> Rig:
    return replace(rig, clips=(Clip("walk", tracks),))


RIG = chain((0, 0, 0), (0, 1, 0), (0, 2, 0))
JUMP = np.where(np.arange(20) < 12, 0.0, 0.3)
PLACES = np.stack([0 * JUMP, 1 + JUMP, 0 * JUMP], axis=1)
TURNS = from_axis_angle([1.0, 0.0, 0.0], np.sin(np.arange(20.0)) * 0.4)


@pytest.mark.parametrize(
    ("path", "values", "apart"), [("translation", PLACES, "0.016 of the size"), ("rotation", TURNS, "2.8°")]
)
def test_the_smooth_curve_of_a_dcc_through_the_keys_is_no_edit(
    path: TrackPath, values: Floats, apart: str
) -> None:
    """It swings beside a jump, where the keys of the spline, which lie flat, do not move at all."""
    flat, smooth = (spline(1, path, values, m) for m in (np.zeros_like(values), natural(values)))
    now = framed(smooth)
    assert np.abs(now.values - sample(flat, FRAMES)).max() > 1e-3
    rig, report = playing(RIG, flat), Report()
    assert take_clips(rig, from_=playing(RIG, now), report=report) is rig
    said = {notice.code: notice.text for notice in report.warnings}
    assert f"(up to {apart})" in said["splines-kept"]


@pytest.mark.parametrize(("path", "values"), [("translation", PLACES), ("rotation", TURNS)])
def test_a_frame_that_is_moved_away_from_the_curve_is_one(path: TrackPath, values: Floats) -> None:
    rig = playing(RIG, spline(1, path, values, np.zeros_like(values)))
    now = framed(spline(1, path, values, natural(values)))
    moved = now.values.copy()
    moved[8] = moved[8] + [0.1, 0, 0] if path == "translation" else from_axis_angle([0.0, 0.0, 1.0], 0.5)
    assert take_clips(rig, from_=playing(RIG, replace(now, values=moved))) is not rig


def respline(track: Track, slopes: Floats) -> Track:
    return replace(track, values=np.stack([slopes, track.values[:, 1], slopes], axis=1))


def test_tangents_that_a_dcc_has_dropped_and_made_anew_are_no_edit() -> None:
    """Blender drops them at its import, and may export splines with its own."""
    slopes = 0.3 * np.cos(np.arange(20.0))[:, np.newaxis] * np.ones(4)
    had = spline(1, "rotation", TURNS, slopes - TURNS * np.sum(slopes * TURNS, axis=1, keepdims=True))
    rig, report = playing(RIG, had), Report()
    now = respline(had, natural(TURNS))
    assert take_clips(rig, from_=playing(RIG, now), report=report) is rig
    now.values[[0, -1]] *= -1.0  # as Blender does; q and −q are one key
    assert take_clips(rig, from_=playing(RIG, now)) is rig
    assert "splines-kept" in {notice.code for notice in report.warnings}


@pytest.mark.parametrize("kept", [1, 17], ids=["one is RIG's", "all but one"])
def test_they_are_one_where_others_of_the_clip_are_still_the_rigs(kept: int) -> None:
    slopes = 0.3 * np.cos(np.arange(20.0))[:, np.newaxis] * np.ones(4)
    had = spline(1, "rotation", TURNS, slopes)
    now = np.where(np.arange(20)[:, np.newaxis] <= kept, slopes, natural(TURNS))
    rig = playing(RIG, had)
    assert take_clips(rig, from_=playing(RIG, respline(had, now))) is not rig


def test_a_key_that_was_moved_is_an_edit_whatever_became_of_tangents() -> None:
    rig = playing(RIG, spline(1, "translation", PLACES, np.zeros_like(PLACES) + 0.01))
    moved = PLACES.copy()
    moved[8, 0] += 0.01
    assert take_clips(rig, from_=playing(RIG, spline(1, "translation", moved, natural(moved)))) is not rig


def test_two_keys_within_a_hundredth_of_a_frame_are_one_after_blender() -> None:
    """At the time of the first, with the value of the second; farther apart they are two."""
    frame = 1 / 24
    for gap, edited in ((0.005, False), (0.05, True)):
        times = np.array([0.0, 1.4 * frame, (1.4 + gap) * frame, 3 * frame, 10 * frame])
        values = np.zeros((5, 3))
        values[:, 0] = [0.0, 0.5, 1.0, 1.0, 0.0]
        ours = playing(RIG, Track(1, "translation", "LINEAR", times, values))
        one = Track(1, "translation", "LINEAR", np.delete(times, 2), np.delete(values, 1, axis=0))
        frames = np.arange(11) * frame
        theirs = playing(RIG, Track(1, "translation", "LINEAR", frames, sample(one, frames)))
        (now,) = take_clips(ours, from_=theirs).clips[0].tracks
        assert np.array_equal(now.values, values) != edited


@pytest.mark.parametrize("ways", [("LINEAR", "LINEAR"), ("CUBICSPLINE", "LINEAR"), ("LINEAR", "CUBICSPLINE")])
def test_keys_taken_out_of_all_tracks_are_an_edit_and_its_motion_is_played(ways: tuple[str, str]) -> None:
    """No track shows the frames any more. Before, EDITED had no changes, for all its keys are RIG's."""
    values = np.stack([0 * KNOTS, 1 + 0.3 * np.sin(9 * KNOTS), 0 * KNOTS], axis=1)
    had, few = (
        spline(1, "translation", values, 0 * values)
        if way == "CUBICSPLINE"
        else Track(1, "translation", "LINEAR", KNOTS, values)
        for way in ways
    )
    few = replace(few, times=few.times[::4], values=few.values[::4])
    (now,) = take_clips(playing(RIG, had), from_=playing(RIG, few)).clips[0].tracks
    times = np.linspace(0.0, float(few.times[-1]), 50)
    assert np.abs(sample(now, times) - sample(few, times)).max() <= 1e-5


def test_a_clip_is_played_at_the_rigs_keys_too_where_edited_has_few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever else took them for the same."""
    monkeypatch.setattr(clip_comparison, "lacking", lambda was, now, *_: np.zeros(len(now.times), dtype=bool))
    had = Track(1, "rotation", "LINEAR", KNOTS, TURNS)
    with pytest.raises(GeometryError, match="would not play as in EDITED"):
        take_clips(
            playing(RIG, had),
            from_=playing(RIG, replace(had, times=had.times[::4], values=had.values[::4])),
        )


def test_splines_that_were_kept_are_kept_by_a_second_run_too() -> None:
    """Another spline has EDITED's tangents by then, which says nothing of what a DCC did to the rest."""
    slopes = 0.3 * np.cos(np.arange(20.0))[:, np.newaxis] * np.ones(4)
    moved = from_axis_angle([0.0, 0.0, 1.0], np.sin(np.arange(20.0)) * 0.4)
    had, other = spline(1, "rotation", TURNS, slopes), spline(2, "rotation", TURNS, slopes)
    edited = playing(RIG, respline(had, natural(TURNS)), spline(2, "rotation", moved, natural(moved)))
    once = take_clips(playing(RIG, had, other), from_=edited)
    assert np.array_equal(once.clips[0].tracks[0].values, had.values)
    assert not np.array_equal(once.clips[0].tracks[1].values, other.values)
    assert take_clips(once, from_=edited) is once


def flattened(rig: Rig) -> Rig:
    """The same skeleton as exporters flatten it: each joint at the top, with a key a frame."""
    at = worlds(rig, locals_at(rig, rig.clips[0], FRAMES))
    places, turns, _ = decompose(at)
    tracks = [
        Track(joint, path, "LINEAR", FRAMES, values)
        for joint in range(len(rig))
        for path, values in zip(
            ("translation", "rotation"), (places[:, joint], make_continuous(turns[:, joint])), strict=True
        )
    ]
    flat = replace(rig, parents=np.full(len(rig), -1), translation=rig.world[:, 3, :3])
    return playing(flat, *tracks)


def test_what_hangs_below_a_kept_spline_is_seen_from_there_in_a_flat_hierarchy_too() -> None:
    flat, smooth = (spline(1, "rotation", TURNS, m) for m in (np.zeros_like(TURNS), natural(TURNS)))
    rig, report = playing(RIG, flat), Report()
    assert take_clips(rig, from_=flattened(playing(RIG, smooth)), report=report) is rig
    assert "splines-kept" in {notice.code for notice in report.warnings}


def test_tangents_are_directions_and_take_no_part_in_a_move() -> None:
    values = np.arange(9.0).reshape(1, 9).repeat(2, axis=0).reshape(2, 3, 3)
    track = Track(0, "translation", "CUBICSPLINE", np.array([0.0, 1.0]), values.reshape(6, 3))
    move = np.eye(4)
    move[3, :3], move[:3, :3] = (10.0, 20.0, 30.0), 2.0 * np.eye(3)
    keys = _mapped(replace(track, values=values), 4, np.eye(4), move)
    assert keys.node == 4
    np.testing.assert_allclose(keys.values[:, 1], 2 * values[:, 1] + move[3, :3])
    np.testing.assert_allclose(keys.values[:, [0, 2]], 2 * values[:, [0, 2]])
