"""bake: what lies between samples is as near as the samples themselves, up to a highest rate."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from baked_rigs import animated, apart, control, rigged, size, with_keyed_controls
from places import slow
from rigs import chain

from rigtri.evaluation import curve_refinement, sampling
from rigtri.evaluation.active_controls import controls_at_work
from rigtri.evaluation.pose_cache import sample_parts
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.timelines import timelines
from rigtri.maths.matrices import transform_points
from rigtri.model.animation import Clip, Track
from rigtri.model.content import Content
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.bake.unbaked import unbaked
from rigtri.operations.bake.warnings import warn_spline_swings
from rigtri.report import Report

BOUND = 1e-5


def reaching(name: str) -> Rig:
    """A hand whose IK end goes inward and up on one straight line, between two keys, in a second."""
    rig = rigged(name)
    hand = control(rig, "hand_L", "ik")
    inward = rig.world[rig.find("upper_arm_L"), 3, :3] - rig.world[hand, 3, :3]
    move = (0.4 * inward + [0.0, 0.1, 0.05]) @ np.linalg.inv(rig.world[hand, :3, :3])
    rig = replace(rig, clips=(Clip("other", ()),))
    rig = animated(rig, hand, "translation", [[0, 0, 0], move], times=(0.0, rig.rules.per_second))
    return replace(rig, clips=rig.clips[-1:])


@pytest.mark.slow
@pytest.mark.parametrize("clip", [slow("walk"), "wave"])
def test_a_motion_comes_home_between_its_keys_too(clip: str) -> None:
    rig, report = rigged(), Report()
    home = bake(
        bake(rig, options=BakeOptions(to="controls", between=5e-6), report=report),
        options=BakeOptions(between=5e-6),
        report=report,
    )
    keys = sampling.key_times(rig.clip(clip))
    assert apart(rig, home, clip, np.linspace(keys[0], keys[-1], 2001)) < BOUND
    assert all(entry["between_samples"] <= BOUND for entry in report.added)
    assert not report.warnings


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_joints_follow_ik_between_keys(name: str) -> None:
    rig, report = reaching(name), Report()
    baked = bake(rig, options=BakeOptions(between=5e-6), report=report)
    times = np.linspace(0.0, rig.rules.per_second, 500)
    timeline = timelines(rig)[0]
    there = Solver(rig, controls_at_work(rig, timeline)).run(sample_parts(rig, timeline.clip, times))
    world = sampling.worlds(baked, sampling.locals_at(baked, baked.clips[0], times))
    for joint in ("forearm_L", "hand_L"):
        node = rig.find(joint)
        far = np.linalg.norm(world[:, node, 3, :3] - there.world(node)[:, 3, :3], axis=1).max()
        assert far / size(rig) < BOUND
    (entry,) = report.added
    assert 0.0 < entry["between_samples"] <= BOUND
    assert 10 < entry["frames"] < 1025


@pytest.mark.ci
def test_what_a_hand_holds_is_as_near_between_samples_as_the_hand() -> None:
    """The tip of a spear, twice as long as who holds it."""
    rig, report = reaching("biped.glb"), Report()
    hand = rig.find("hand_L")
    tip = np.array([[0.0, 2.0 * size(rig), 0.0]])
    spear = Mesh("spear", hand, tip)
    rig = replace(rig, content=Content(read_outlines=lambda: [spear]))
    baked = bake(rig, options=BakeOptions(between=1e-3), report=report)
    times = np.linspace(0.0, rig.rules.per_second, 500)
    timeline = timelines(rig)[0]
    there = Solver(rig, controls_at_work(rig, timeline)).run(sample_parts(rig, timeline.clip, times))
    world = sampling.worlds(baked, sampling.locals_at(baked, baked.clips[0], times))[:, hand]
    off = transform_points(tip, world[:, np.newaxis]) - transform_points(
        tip, there.world(hand)[:, np.newaxis]
    )
    far = np.linalg.norm(off, axis=-1).max() / size(rig)
    (entry,) = report.added
    assert far <= entry["between_samples"] <= 1e-3


@pytest.mark.ci
def test_a_larger_tolerance_takes_fewer_samples() -> None:
    counts = []
    for tolerance in (1e-3, 1e-4, 1e-5):
        report = Report()
        bake(reaching("biped.glb"), options=BakeOptions(between=tolerance / 2), report=report)
        counts.append(report.added[0]["frames"])
    assert counts[0] < counts[1] < counts[2]


def test_samples_that_were_requested_are_the_only_ones() -> None:
    report = Report()
    baked = bake(reaching("biped.glb"), options=BakeOptions(fps=10.0), report=report)
    (entry,) = report.added
    assert entry["frames"] == 11
    assert entry["between_samples"] > BOUND
    grid = np.linspace(0.0, 1.0, 11).astype(np.float32).astype(np.float64)
    assert all(np.isin(track.times, grid).all() for track in baked.clips[0].tracks)


def test_what_moves_on_lines_gets_no_more_samples() -> None:
    rig = rigged()
    rig = replace(rig, clips=())
    head = control(rig, "head", "fk")
    rig = animated(rig, head, "rotation", [[0, 0, 0, 1], [0, 0, 0.6, 0.8]])
    report = Report()
    bake(rig, options=BakeOptions(between=5e-6), report=report)
    assert [(e["frames"], e["between_samples"]) for e in report.added] == [(2, 0.0)]


def test_a_highest_rate_bounds_the_samples_and_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(curve_refinement, "MOST_A_SECOND", 8.0)
    report = Report()
    bake(reaching("biped.glb"), options=BakeOptions(between=5e-6), report=report)
    assert report.added[0]["frames"] == 9
    assert [notice.code for notice in report.warnings] == ["samples-limited"]
    text = report.warnings[0].text
    assert "'new'" in text
    assert "_L', of the limb of 'hand_L_ik_ctl', is still off" in text
    assert "A --between above that accepts it, and --soft" in text


@pytest.mark.ci
def test_a_spline_between_keys_of_opposite_sign_swings_round_as_its_file_states_and_is_reported() -> None:
    """glTF's splines are of components: from q to −q they pass near nothing, and every player swings."""
    rig = rigged()
    head = rig.find("head")
    turn = rig.rotation[head]
    tangent = np.array([0.0, 0.0, 2e-6, 0.0])
    still = np.zeros(4)
    values = np.array([[still, turn, tangent], [still, -turn, still]])
    track = Track(head, "rotation", "CUBICSPLINE", np.array([0.0, 1.0]), values)
    report = Report()
    bake(replace(rig, clips=(Clip("new", (track,)),)), options=BakeOptions(to="controls"), report=report)
    (notice,) = (notice for notice in report.warnings if notice.code == "splines-swing")
    assert "splines of 'head' swing round" in notice.text
    assert "first after 0;" in notice.text


def test_splines_swing_from_keys_to_keys_that_are_nearly_opposite_and_in_baked_clips_alone() -> None:
    """From q to −q; the keys after it are at most at right angles, as quaternions."""
    rig, head, times = chain((0, 0, 0), (1, 0, 0)), 1, np.arange(4.0)
    keys = np.array([[0, 0, 0, 1.0], [0, 0, 0, -1], [0, 0, 0.8, -0.6], [0, 0, 0.6, 0.8]])
    spline = np.stack([np.zeros((4, 4)), keys, np.zeros((4, 4))], axis=1)
    swings = Clip("swings", (Track(head, "rotation", "CUBICSPLINE", times, spline),))
    straight = Clip("straight", (Track(head, "rotation", "LINEAR", times, keys),))
    late = Clip(
        "late", (Track(head, "rotation", "CUBICSPLINE", times[1:], spline[1:] * [[[1]], [[1]], [[-1]]]),)
    )
    rig, report = replace(rig, clips=(swings, straight, late, replace(swings, name="else"))), Report()
    report.added += [{"type": "clip", "clip": name} for name in ("swings", "straight", "late")]
    warn_spline_swings(rig, report)
    told = [str(warning) for warning in report.warnings]
    assert len(told) == 1
    assert "Clip 'swings'" in told[0]
    assert "first after 0;" in told[0]


def test_a_limb_that_passes_straight_gets_samples_where_it_does_and_few_elsewhere() -> None:
    """There its joints turn like the square root of time: at 1024 a second a chord of it is 0.004 off."""
    rig = rigged()
    hand = control(rig, "hand_L", "ik")
    places = [rig.world[rig.find(joint), 3, :3] for joint in ("upper_arm_L", "forearm_L", "hand_L")]
    full = sum(np.linalg.norm(b - a) for a, b in pairwise(places))
    out = (places[2] - places[0]) / np.linalg.norm(places[2] - places[0])
    back = np.linalg.inv(rig.world[hand, :3, :3])
    moves = [(places[0] + share * full * out - places[2]) @ back for share in (0.3, 1.3)]
    rig = replace(rig, clips=(Clip("other", ()),))
    rig = animated(rig, hand, "translation", moves, times=(0.0, 0.3))
    report = Report()
    bake(replace(rig, clips=rig.clips[-1:]), options=BakeOptions(), report=report)
    (entry,) = report.added
    assert entry["between_samples"] <= 1e-3
    assert entry["frames"] < 100
    assert "samples-limited" not in [notice.code for notice in report.warnings]


def test_what_a_bake_leaves_between_keys_is_no_motion_that_joints_lack() -> None:
    """Where another joint alone has keys an elbow's axes are off by 0.004, which strip refused."""
    rig = bake(bake(with_more_keys(with_keyed_controls(), "head"), options=BakeOptions(to="controls")))
    assert unbaked(with_more_keys(rig, "head")) == ""
    (elbow,) = rotations(rig, "forearm_R")
    less = replace(elbow, times=elbow.times[::4], values=elbow.values[::4])
    assert "in clip 'walk' as its own keys do not" in unbaked(with_track(rig, elbow, less))


def rotations(rig: Rig, joint: str) -> list[Track]:
    """The rotation of a joint in the clip `walk`."""
    return [t for t in rig.clip("walk").tracks if rig.names[t.node] == joint and t.path == "rotation"]


def with_more_keys(rig: Rig, joint: str) -> Rig:
    """The rig with a key of a joint between each two of its keys, in the clip `walk`."""
    (track,) = rotations(rig, joint)
    times = np.sort(np.concatenate([track.times, (track.times[1:] + track.times[:-1]) / 2]))
    return with_track(rig, track, replace(track, times=times, values=sampling.sample(track, times)))


def with_track(rig: Rig, old: Track, new: Track) -> Rig:
    """The rig with a track in the place of another."""
    clips = (replace(c, tracks=tuple(new if t is old else t for t in c.tracks)) for c in rig.clips)
    return replace(rig, clips=tuple(clips))


def test_there_is_no_error_at_the_one_key_of_a_track() -> None:
    """A pole vector is placed once, while its hand moves. Before, a bake had no sample there."""
    rig, at = reaching("biped.glb"), np.array([0.375])
    pole = rig.nodes_of("poleVector")[0]
    once = Track(pole, "translation", "STEP", at, rig.translation[[pole]] + [0.0, 0.0, 0.05])
    rig = replace(rig, clips=(replace(rig.clips[0], tracks=(*rig.clips[0].tracks, once)),))
    (clip,) = timelines(rig)
    solver, options = Solver(rig, controls_at_work(rig, clip)), BakeOptions(between=0.1, tolerance=1e-7)
    baked = bake(rig, options=options, report=Report())
    asked = solver.run(sample_parts(rig, clip.clip, at))
    found = sampling.worlds(baked, sampling.locals_at(baked, baked.clips[0], at))[0]
    assert max(np.abs(asked.world(k)[0] - found[k]).max() for k in solver.sets) < 1e-6 * size(rig)
