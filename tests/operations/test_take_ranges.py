"""take-clips: a clip that starts elsewhere and is longer or shorter comes home in one range of time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from places import SAMPLES
from program import cli
from taken_clips import apart, notices, rig_of, turned_key, with_tracks
from usd_files import MESH, animation, save, scene, skeleton

import rigtri
from rigtri.errors import GeometryError
from rigtri.evaluation.sampling import locals_at, sample
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.rejoin_clips import joined
from rigtri.operations.take_clips.take_clips import take_clips
from rigtri.operations.take_clips.time_ranges import cut, with_end_keys
from rigtri.report import Report

# Of the rig's size; key times become float32.
NEAR = 1e-5


def retimed(rig: Rig, told: Callable[[Floats], Floats]) -> Rig:
    return with_tracks(rig, "walk", lambda track: replace(track, times=told(track.times)))


def longer(rig: Rig, joint: str, time: float) -> Rig:
    """One more key of a joint's turns, which are those of its first key again."""
    node = rig.find(joint)

    def changed(track: Track) -> Track:
        if (track.node, track.path) != (node, "rotation"):
            return track
        values = np.concatenate([track.values, track.values[:1]])
        return replace(track, times=np.append(track.times, time), values=values)

    return with_tracks(rig, "walk", changed)


def ends(rig: Rig) -> set[tuple[float, float]]:
    """The ranges of the tracks of the clip that have several keys."""
    return {(float(t.times[0]), float(t.times[-1])) for t in rig.clip("walk").tracks if len(t.times) > 1}


def walks(rig: Rig, start: float, end: float) -> float:
    """The last time of the clip, and a check that none of its tracks leaves a range."""
    assert all(start - 1e-6 <= a and b <= end + 1e-6 for a, b in ends(rig))
    return max(b for _, b in ends(rig))


@pytest.mark.parametrize(
    ("start", "end", "left"),
    [
        (0.0, 9.0, {2: 20, 4: 40, 6: 60}),
        (3.0, 9.0, {3: 30, 4: 40, 6: 60}),
        (0.0, 5.0, {2: 20, 4: 40, 5: 50}),
        (2.5, 3.5, {2.5: 25, 3.5: 35}),
        (4.0, 5.0, {4: 40, 5: 50}),
        # Outside altogether there is one key, at the nearer end.
        (7.0, 9.0, {7: 60}),
        (0.0, 1.0, {1: 20}),
    ],
)
def test_a_cut_track_has_keys_on_its_curve_where_it_is_cut(
    start: float, end: float, left: dict[float, float]
) -> None:
    values = np.outer([20.0, 40.0, 60.0], np.ones(3))
    found = cut(Track(0, "translation", "LINEAR", np.array([2.0, 4.0, 6.0]), values), start, end)
    assert dict(zip(found.times.tolist(), found.values[:, 0].round(9).tolist(), strict=True)) == left


@pytest.mark.parametrize(("name", "late"), [("biped.glb", 5.0), ("biped.usda", 1001.0)])
def test_unchanged_tracks_show_where_a_longer_clip_that_starts_elsewhere_lies(name: str, late: float) -> None:
    plain = rig_of(SAMPLES / name)
    last = float(max(b for _, b in ends(plain)))
    rig = retimed(plain, lambda times: times + late)
    report = Report()
    edited = longer(plain, "shin_L", 1.2 * last)
    home = take_clips(rig, from_=edited, report=report)
    changed = [t for t in home.clip("walk").tracks if not any(t is was for was in rig.clip("walk").tracks)]
    assert [(plain.names[t.node], t.path) for t in changed] == [("shin_L", "rotation")]
    assert changed[0].times[[0, -1]] == pytest.approx([late, late + 1.2 * last])
    assert notices(report) == ["other-range"]
    assert f"0 to {1.2 * last:g} in EDITED and from {late:g} to" in report.warnings[0].text
    assert apart(home, retimed(edited, lambda times: times + late), "walk") < NEAR
    assert take_clips(home, from_=edited) is home


@pytest.mark.ci
def test_a_key_put_before_a_clip_that_starts_elsewhere_does_not_move_it() -> None:
    """The unchanged tracks tell more than the starts do."""
    plain = rig_of()
    node = plain.find("shin_L")

    def earlier(track: Track) -> Track:
        track = replace(track, times=track.times + 0.25)
        if (track.node, track.path) != (node, "rotation"):
            return track
        times, values = np.append(0.0, track.times), np.concatenate([track.values[-1:], track.values])
        return replace(track, times=times, values=values)

    rig = retimed(plain, lambda times: times + 5.0)
    home = take_clips(rig, from_=with_tracks(plain, "walk", earlier))
    changed = [t for t in home.clip("walk").tracks if not any(t is was for was in rig.clip("walk").tracks)]
    assert [t.node for t in changed] == [node]
    assert changed[0].times[[0, 1, -1]] == pytest.approx([4.75, 5.0, 6.0])


@pytest.mark.ci
@pytest.mark.parametrize("stretch", [1.5, 0.6])
def test_a_retimed_clip_that_starts_elsewhere_is_taken_as_a_whole_from_the_start_of_ours(
    stretch: float,
) -> None:
    rig = rig_of()
    edited = retimed(rig, lambda times: stretch * times + 5.0)
    report = Report()
    home = take_clips(rig, from_=edited, report=report)
    assert walks(home, 0.0, stretch) == pytest.approx(stretch)
    assert {(round(a, 6), round(b, 6)) for a, b in ends(home)} == {(0.0, stretch)}
    assert apart(home, retimed(rig, lambda times: stretch * times), "walk") < NEAR
    assert notices(report) == ["other-range"]
    assert take_clips(home, from_=edited) is home


@pytest.mark.ci
def test_of_a_shorter_clip_the_keys_inside_stay_bit_for_bit_and_all_tracks_end_with_it() -> None:
    rig = rig_of()
    edited = with_tracks(rig, "walk", lambda track: cut(track, 0.0, 0.55))
    report = Report()
    home = take_clips(rig, from_=edited, report=report)
    assert walks(home, 0.0, 0.55) == 0.55
    assert notices(report) == ["other-range"]
    for was, now in zip(rig.clip("walk").tracks, home.clip("walk").tracks, strict=True):
        inside = was.times[was.times < 0.55]
        np.testing.assert_array_equal(now.values[: len(inside)], was.values[: len(inside)])
    assert apart(home, edited, "walk") < NEAR
    # And what EDITED has no keys of ends with the others.
    node = rig.find("shin_L")
    fewer = with_tracks(edited, "walk", lambda track: None if track.node == node else track)
    assert walks(take_clips(rig, from_=fewer), 0.0, 0.55) == 0.55


def test_a_few_tracks_that_fit_nowhere_are_an_error_that_reports_both_ranges() -> None:
    rig = rig_of()
    node = rig.find("shin_L")

    def only(track: Track) -> Track | None:
        return replace(track, times=7.0 + 1.7 * track.times) if track.node == node else None

    edited = with_tracks(turned_key(rig, "shin_L"), "walk", only)
    with pytest.raises(GeometryError, match=r"'walk', from 7 to 8\.7, where RIG has 0 to 1"):
        take_clips(rig, from_=edited)


def test_few_tracks_that_are_shorter_cut_nothing_else() -> None:
    """Programs write an action for each object, and one may be short."""
    rig = rig_of()
    node = rig.find("shin_L")
    edited = with_tracks(rig, "walk", lambda track: cut(track, 0.0, 0.5) if track.node == node else None)
    home = take_clips(turned_key(rig, "shin_L"), from_=edited)
    assert {b for _, b in ends(home)} >= {1.0}


@pytest.mark.parametrize("way", ["LINEAR", "STEP", "CUBICSPLINE"])
def test_a_track_that_was_cut_goes_the_same_way_inside_and_one_that_was_held_everywhere(way: str) -> None:
    shape = (4, 3, 3) if way == "CUBICSPLINE" else (4, 3)
    values = np.random.default_rng(7).normal(size=shape)
    track = Track(0, "translation", way, np.array([0.0, 1.0, 1.5, 3.0]), values)  # type: ignore[arg-type]
    times = np.linspace(0.25, 1.9, 34)
    short = cut(track, 0.25, 1.9)
    assert short.times.tolist() == [0.25, 1.0, 1.5, 1.9]
    np.testing.assert_allclose(sample(short, times), sample(track, times), atol=1e-14)
    long = with_end_keys(track, -1.0, 4.0)
    assert long.times.tolist() == [-1.0, 0.0, 1.0, 1.5, 3.0, 4.0]
    times = np.linspace(-2.0, 5.0, 71)
    np.testing.assert_allclose(sample(long, times), sample(track, times), atol=1e-14)
    assert cut(track, 0.0, 3.0) is track
    assert cut(track, 4.0, 5.0).times.tolist() == [4.0]


@pytest.mark.ci
def test_steps_become_samples_just_before_each_jump_in_usd(tmp_path: Path) -> None:
    """A clip that an animator has made stepped: samples of USD go straight from one to the next."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    walk = next(clip for clip in rig.clips if clip.name == "walk")
    stepped = (replace(walk, tracks=tuple(replace(track, interpolation="STEP") for track in walk.tracks)),)
    edited, out = tmp_path / "edited.glb", tmp_path / "out.usda"
    rigtri.write(replace(rig, clips=stepped), edited, verify=False)
    cli("take-clips", SAMPLES / "biped.usda", "--from", edited, "-o", out, code=0)
    before, after = rigtri.read(SAMPLES / "biped.usda"), rigtri.read(out)
    arm = after.find("forearm_R")
    held = locals_at(after, after.clips[0], np.array([3.0, 5.9]))[:, arm]
    assert np.abs(held[0] - held[1]).max() < 1e-6
    there = locals_at(before, before.clips[0], np.array([6.0]))[0, arm]
    assert np.abs(locals_at(after, after.clips[0], np.array([6.0]))[0, arm] - there).max() < 1e-6


def test_another_frame_rate_is_reported_where_time_codes_are_the_same(tmp_path: Path) -> None:
    """Blender's import of USD leaves the frame rate of the scene, and its export writes that."""
    text = (SAMPLES / "biped.usda").read_text("utf-8")
    faster = tmp_path / "faster.usda"
    faster.write_text(text.replace("timeCodesPerSecond = 24", "timeCodesPerSecond = 30"), "utf-8")
    rig, edited, report = rig_of(SAMPLES / "biped.usda"), rig_of(faster), Report()
    take_clips(rig, from_=edited, report=report)
    assert notices(report) == ["other-range"]
    assert "30 a second instead of 24" in report.warnings[0].text
    assert "give the scene the frame rate 24" in report.warnings[0].text
    report = Report()
    joined(edited, rig, report=report)
    assert notices(report) == ["other-range"]


@pytest.mark.parametrize("rate", [1, 25])
def test_a_step_that_usd_holds_nearer_than_float32_comes_home(rate: int, tmp_path: Path) -> None:
    def hero(turned: str, name: str) -> Path:
        keys = {0: "1, 0, 0, 0", 4.999999999: "1, 0, 0, 0", 5: turned, 10: turned}
        samples = ", ".join(f"{t!r}: [(1, 0, 0, 0), ({q}), (1, 0, 0, 0)]" for t, q in keys.items())
        moves = animation(rotations=f"quatf[] rotations.timeSamples = {{{samples}}}")
        head = f"    timeCodesPerSecond = {rate}\n"
        return save(tmp_path, scene(skeleton(), moves, MESH, head=head), name)

    source, edited = hero("0.8, 0, 0.6, 0", "source.usda"), hero("0.6, 0, 0, 0.8", "edited.usda")
    rig, out, as_glb = (tmp_path / name for name in ("rig.glb", "out.glb", "edited.glb"))
    cli("convert", source, "-o", rig, code=0)
    cli("take-clips", rig, "--from", edited, "-o", out, code=0)
    cli("convert", edited, "-o", as_glb, code=0)
    assert rigtri.verify(as_glb, out).deviation < NEAR
