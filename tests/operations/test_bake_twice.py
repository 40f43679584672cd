"""bake: a second run changes no byte, also where what follows joints shares its key times with them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from baked_rigs import WHOLE, control
from places import SAMPLES, slow
from rigs import rig_of

import rigtri
from rigtri.errors import GeometryError
from rigtri.evaluation import sampling
from rigtri.evaluation.key_reduction import is_reduction_of
from rigtri.evaluation.shared_key_times import Shared, with_shared_times
from rigtri.evaluation.twist_joints import twist_joints
from rigtri.formats import read
from rigtri.maths.matrices import nearest_rotation
from rigtri.maths.quaternions import conjugate, from_axes, from_axis_angle, multiply, rotation_angle
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.metadata import PoleVectorRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.add_posereader.posereader import AddPosereaderOptions, Goal, add_posereader
from rigtri.operations.add_twist.twist import AddTwistOptions, add_twist
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.freeze import FreezeOptions, freeze
from rigtri.pipeline.edit import edit
from rigtri.report import Report

TO_CONTROLS = BakeOptions(to="controls", fps=24)


def single(values: Floats) -> Floats:
    return np.asarray(values).astype(np.float32).astype(np.float64)


def built(rig: Rig, report: Report) -> Rig:
    """Controls with the clips' motion, twist joints in all limbs, and a reader of a lower arm."""
    rig = add_twist(rig, options=AddTwistOptions(limbs="auto"), report=report)
    rig = add_controls(rig, options=WHOLE, report=report)
    reader = AddPosereaderOptions("forearm_L", target=(Goal("up", direction=(0, 1, 0)),), name="reader")
    rig = add_posereader(rig, options=reader, report=report)
    return bake(rig, options=BakeOptions(to="controls"), report=report)


def edited(rig: Rig) -> Rig:
    """The FK controls of a hand and its lower arm turn, with keys at other times than the joints had."""
    mine = {control(rig, joint, "fk"): a for joint, a in (("hand_L", 1.1), ("forearm_L", 0.7))}
    times = single(np.array([0.0, 0.37, 0.61, 1.0]) * rig.rules.per_second)
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
        for twist in twist_joints(rig):
            track = next((t for t in clip.tracks if (t.node, t.path) == (twist.node, "rotation")), None)
            if track is not None:
                local = sampling.locals_at(rig, clip, track.times)
                shown = from_axes(nearest_rotation(local[:, twist.node]))
                worst.append(rotation_angle(multiply(conjugate(twist.rotations(local)), shown)).max())
    return float(max(worst))


@pytest.mark.ci
@pytest.mark.parametrize("name", [slow("biped.glb"), "biped.usda"])
def test_what_follows_joints_is_made_of_the_keys_that_are_read(name: str, tmp_path: Path) -> None:
    ready, once, twice = (tmp_path / f"{k}{Path(name).suffix}" for k in range(3))
    edit(SAMPLES / name, ready, lambda rig, report: edited(built(rig, report)), verify=False)
    edit(ready, once, lambda rig, report: bake(rig, options=BakeOptions(), report=report))
    was, now = read(ready).rig, read(once).rig
    turned = [
        sampling.locals_at(rig, rig.clips[0], [0.37 * rig.rules.per_second])[0, rig.find("hand_L")]
        for rig in (was, now)
    ]
    assert np.abs(turned[0] - turned[1]).max() > 0.1
    assert off_law(now) < 2e-6
    edit(once, twice, lambda rig, report: bake(rig, options=BakeOptions(), report=report))
    assert once.read_bytes() == twice.read_bytes()


def test_joints_that_share_an_array_are_read_at_each_others_times() -> None:
    rig = read(SAMPLES / "biped.usda").rig
    home = next(k for k, c in enumerate(rig.clips) if isinstance(c.key, tuple) and c.key[0] == "samples")
    turns = np.array([[0.0, 0.0, 0.0, 1.0], [0.6, 0.0, 0.0, 0.8]])
    one = Track(rig.find("head"), "rotation", "LINEAR", np.array([0.0, 4.0]), turns)
    other = Track(rig.find("hand_L"), "rotation", "STEP", np.array([0.0, 1.0]), turns)
    clip = Clip(rig.clips[home].name, (one, other), rig.clips[home].key)
    seen = with_shared_times(replace(rig, clips=(clip,)))
    before = float(np.nextafter(np.float32(1.0), np.float32(0.0)))
    for track in seen.rig.clips[0].tracks:
        assert track.times.tolist() == [0.0, before, 1.0, 4.0]
    head, hand = (track.values for track in seen.rig.clips[0].tracks)
    np.testing.assert_allclose(sampling.sample(one, [1.0])[0], head[2], atol=1e-7)
    np.testing.assert_allclose(hand, turns[[0, 0, 1, 1]], atol=1e-7)
    # Who is left out neither gets nor gives any; weights and nodes of no skin share none.
    mesh = Track(int(np.flatnonzero(~rig.is_joint)[0]), "rotation", "LINEAR", np.array([0.0, 2.0]), turns)
    blink = Track(rig.find("hand_L"), "weights", "LINEAR", np.array([0.0, 3.0]), np.zeros((2, 1)))
    more = replace(clip, tracks=(one, other, mesh, blink))
    apart = with_shared_times(replace(rig, clips=(more,)), without=[rig.find("hand_L")])
    assert [track.times.tolist() for track in apart.rig.clips[0].tracks] == [[0, 4], [0, 1], [0, 2], [0, 3]]
    together = with_shared_times(replace(rig, clips=(more,))).rig.clips[0].tracks
    assert [len(track.times) for track in together] == [4, 4, 2, 2]
    plain = replace(rig, clips=(clip,))
    assert seen.undone(seen.rig, plain).clips[0] is clip
    alone = read(SAMPLES / "biped.glb").rig
    assert with_shared_times(alone).rig is alone


def test_ik_that_is_posed_keeps_its_limb_from_constraints_once_the_limb_has_keys() -> None:
    """In a clip that moves something else, a posed IK control is at work until its limb has keys."""
    rig = rigtri.add_controls(read(SAMPLES / "tpose.glb").rig, whole_character=True)
    rig = rigtri.constrain(rig, type="point", child="forearm_L", driver=("head",), maintain_offset=False)
    end, place = control(rig, "hand_L", "ik"), rig.translation.copy()
    place[end] = (-0.1, -0.05, 0.02)
    nod = Track(control(rig, "head", "fk"), "rotation", "STEP", np.zeros(1), np.array([[0.0, 0.6, 0.0, 0.8]]))
    once = rigtri.bake(replace(rig, translation=place, clips=(Clip("nod", (nod,)),)))
    hand = once.find("hand_L")
    there, again = (
        sampling.worlds(each, sampling.locals_at(each, each.clips[0], [0.0]))[0, hand]
        for each in (once, rigtri.bake(once))
    )
    np.testing.assert_allclose(again, there, atol=1e-6)
    assert end in {track.node for track in once.clips[0].tracks}


@pytest.mark.parametrize(
    ("child", "kind"),
    [("forearm_L_pole", "point"), ("hand_L_ik_ctl_offset", "orient"), ("forearm_R_ctl_offset", "parent")],
)
def test_what_controls_count_from_stays_where_a_constraint_takes_it_away(child: str, kind: str) -> None:
    """Offset groups and pole vectors follow constraints in clips; at rest in the file they stay."""
    rig = rigtri.add_controls(read(SAMPLES / "tpose.glb").rig, whole_character=True)
    rig = rigtri.constrain(rig, type=kind, child=child, driver=("head",), maintain_offset=False)
    turned = Track(
        control(rig, "hips", "fk"), "rotation", "STEP", np.zeros(1), np.array([[0.0, 0.6, 0.0, 0.8]])
    )
    chest = Track(
        control(rig, "chest", "fk"), "rotation", "STEP", np.zeros(1), np.array([[0.0, 0.6, 0.0, 0.8]])
    )
    once = rigtri.bake(replace(rig, clips=(Clip("turn", (turned, chest)),)))
    twice = rigtri.bake(once)
    for at in ([0.0], None):
        there, again = (
            sampling.worlds(each, sampling.locals_at(each, each.clips[0], at)) if at else each.world
            for each in (once, twice)
        )
        np.testing.assert_allclose(again, there, atol=1e-6)
    node = rig.find(child)
    np.testing.assert_array_equal(once.local[node], rig.local[node])
    assert node in {track.node for track in once.clips[0].tracks}


# --- keys whose choice rounding turns


def flung(rig: Rig, seed: int) -> Rig:
    """IK ends of stretching limbs go far away, so what rounds above them shows."""
    rng = np.random.default_rng(seed)
    rig = add_controls(rig, options=WHOLE)
    times = np.array([0.0, 0.4, 1.0]) * rig.rules.per_second
    ends = [control(rig, joint, "ik") for joint in ("foot_L", "foot_R", "hand_L")]
    places = [rng.normal(size=(3, 3)) * [[1.0], [30.0], [3.0]] for _ in ends]
    fresh = (Track(e, "translation", "LINEAR", times, v) for e, v in zip(ends, places, strict=True))
    first, *others = rig.clips
    return replace(rig, clips=(replace(first, tracks=(*first.tracks, *fresh)), *others))


def rounded_above(rig: Rig, seed: int) -> Rig:
    """The hips' keys are off by as much as float32 leaves open."""
    rng, hips = np.random.default_rng(seed), rig.find("hips")

    def off(track: Track) -> Track:
        noise = rng.uniform(-6e-8, 6e-8, track.values.shape)
        return replace(track, values=track.values + noise) if track.node == hips else track

    return replace(rig, clips=tuple(replace(c, tracks=tuple(map(off, c.tracks))) for c in rig.clips))


@pytest.mark.ci
@pytest.mark.parametrize("seed", [1, slow(4)])
def test_rounding_above_a_limb_changes_no_choice_of_keys(seed: int) -> None:
    coarse = BakeOptions(stretch=True, tolerance=1e-3)
    once = with_shared_times(bake(flung(read(SAMPLES / "biped.usda").rig, seed), options=coarse)).rig
    ready = rounded_above(once, seed)
    twice = bake(ready, options=coarse)
    for was, now in zip(ready.clips, twice.clips, strict=True):
        assert all(a is b for a, b in zip(was.tracks, now.tracks, strict=True))
    # A smaller tolerance is another question.
    finer = bake(ready, options=replace(coarse, tolerance=1e-4))
    assert any(now is not was for now, was in zip(finer.clips, ready.clips, strict=True))


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", slow("biped.usda")])
def test_a_larger_tolerance_still_leaves_out_more(name: str) -> None:
    ready = flung(read(SAMPLES / name).rig, 1)
    fine = bake(ready, options=BakeOptions(stretch=True))
    coarse = bake(fine, options=BakeOptions(stretch=True, tolerance=1e-2))
    ends = {rig.find("hand_L") for rig in (fine, coarse)}
    counts = [
        [len(t.times) for c in rig.clips[:1] for t in c.tracks if t.node in ends and t.path == "translation"]
        for rig in (fine, coarse)
    ]
    assert counts[1] < counts[0]


def test_thinned_values_are_some_of_the_values_and_lines_between_them() -> None:
    times = np.arange(5.0)
    values = np.array([[0.0], [1.0], [2.1], [3.0], [4.0]])
    line = times[:, np.newaxis].copy()
    assert is_reduction_of(times, values, values, 0.0, 1e-6)
    assert is_reduction_of(times, values, line, 0.2, 1e-6)
    assert not is_reduction_of(times, values, line, 0.05, 1e-6)  # the third value is farther off
    bent = np.where(times == 2.0, 2.05, times)[:, np.newaxis]
    assert not is_reduction_of(times, values, bent, 0.2, 1e-6)  # neither a value nor on the line
    assert not is_reduction_of(times, values, values + 0.01, 0.2, 1e-6)  # an edit, however small
    turns = np.stack([from_axis_angle([0.0, 0.0, 1.0], angle) for angle in values[:, 0] / 10])
    arc = np.stack([from_axis_angle([0.0, 0.0, 1.0], angle) for angle in times / 10])
    assert is_reduction_of(times, turns, -arc, 0.02, 1e-6)
    assert not is_reduction_of(times, turns, arc, 0.005, 1e-6)


@pytest.mark.parametrize("between", [0.001, 1.0])
def test_a_bake_to_controls_is_refused_where_only_controls_have_the_motion(between: float) -> None:
    """Before, a large --between let it go, though it is about what lies between keys alone."""
    one = AddControlsOptions(joints=("forearm_L",))
    rig = add_controls(read(SAMPLES / "biped.glb").rig, options=one)
    node = rig.find("forearm_L_ctl")
    turned = multiply(rig.rotation[node], from_axis_angle([0, 0, 1], np.array([0.0, 0.5])))
    track = Track(node, "rotation", "LINEAR", np.array([0.0, 1.0]), turned)
    rig = replace(rig, clips=(*rig.clips, Clip("waves", (track,))))
    with pytest.raises(GeometryError, match="'waves' as its own keys do not"):
        bake(rig, options=BakeOptions(to="controls", between=between))
    bake(rig, options=BakeOptions(to="controls", clip=("walk",)))
    bake(bake(rig), options=BakeOptions(to="controls"))
    lost = bake(rig, options=BakeOptions(to="controls", discard_motion=True))
    assert not any(len(track.times) > 1 for track in lost.clip("waves").tracks)


@pytest.mark.ci
def test_what_is_keyed_on_a_root_control_goes_to_the_joints_and_back() -> None:
    """Before, the control below the root got all of it and the root kept its keys: twice the motion."""
    rig = add_controls(read(SAMPLES / "biped.glb").rig, options=WHOLE)
    root, hips = control(rig, "hips", "root"), rig.find("hips")
    times = np.array([0.0, 0.5, 1.0]) * rig.rules.per_second
    keys = Track(root, "translation", "LINEAR", times, single([[0, 0, 0], [0.3, 0, 0.1], [0.1, 0, 0.4]]))
    # A spline's tangents of zero are no scale of zero.
    size = np.tile(np.array([0.0, 1.0, 0.0])[:, np.newaxis], (3, 1, 3))
    still = Track(root, "scale", "CUBICSPLINE", times, size)
    rig = replace(rig, clips=(replace(rig.clips[0], tracks=(*rig.clips[0].tracks, keys, still)),))
    there = bake(rig)
    back = bake(bake(there, options=BakeOptions(to="controls")))
    shown = [
        sampling.worlds(each, sampling.locals_at(each, each.clips[0], times))[:, hips]
        for each in (there, back)
    ]
    np.testing.assert_allclose(shown[1], shown[0], atol=2e-6)
    assert np.abs(shown[0][1:, 3, 0] - shown[0][0, 3, 0]).min() > 0.05


def test_a_root_control_stays_where_keys_of_others_count_from_it() -> None:
    """Before, a second add-controls turned it to the new up axis, and keyed poles went along."""
    rig = read(SAMPLES / "biped.usda").rig
    rig = replace(rig, clips=rig.clips[:1])
    rig = bake(add_controls(rig, options=WHOLE), options=BakeOptions(to="controls"))
    lying = freeze(rig, options=FreezeOptions(up_axis="z"))
    again = add_controls(lying, options=WHOLE)
    pole = min(lying.nodes_of(PoleVectorRecord.type))
    times = np.array([0.0, 0.5]) * rig.rules.per_second
    shown = [sampling.worlds(each, sampling.locals_at(each, each.clips[0], times)) for each in (lying, again)]
    np.testing.assert_allclose(shown[1][:, pole, 3], shown[0][:, pole, 3], atol=1e-9)


def test_states_have_the_same_times_where_all_their_arrays_have() -> None:
    times = np.array([0.0, 1.0])
    rig = rig_of(["a"], [-1], np.zeros((1, 3)))
    one = Shared(rig, {("walk", "rotation"): times, ("walk", "scale"): times}, {})
    assert one.same_times(replace(one, times=dict(one.times)))
    assert not one.same_times(replace(one, times={("walk", "rotation"): times}))
    assert not one.same_times(replace(one, times={**one.times, ("walk", "scale"): times + 1}))


@pytest.mark.parametrize(("kind", "shared"), [("samples", True), ("xforms", False)])
def test_skins_that_play_one_animation_share_its_times(kind: str, shared: bool) -> None:
    """Two skins, a joint each; what no animation holds is each skin's own."""
    rig = rig_of(["a", "b"], [-1, -1], np.zeros((2, 3)))
    skins = tuple(Skin(name, np.array([k]), np.eye(4)[np.newaxis]) for k, name in enumerate("ab"))
    ways = [np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])] * 2
    tracks = tuple(Track(k, "translation", "LINEAR", np.array([0.0, k + 1.0]), ways[k]) for k in range(2))
    rig = replace(rig, skins=skins, clips=(Clip("walk", tracks, (kind, "/Anim")),))
    times = [track.times.tolist() for track in with_shared_times(rig).rig.clips[0].tracks]
    before = float(np.nextafter(np.float32(1.0), np.float32(0.0)))
    assert before not in times[0]
    assert times == ([[0.0, 1.0, 2.0]] * 2 if shared else [[0.0, 1.0], [0.0, 2.0]])


@pytest.mark.ci
def test_keys_of_a_rivet_are_no_moments_at_which_a_bake_to_controls_is_refused() -> None:
    """Before, motion between the frames of --fps counted as lost, where a rivet had keys there."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    rig = bake(add_controls(replace(rig, clips=rig.clips[:1]), options=WHOLE), options=TO_CONTROLS)
    hand = control(rig, "hand_L", "ik")
    places = rig.translation[hand] + np.array([[0, 0, 0], [0.4, 0.3, 0.2], [-0.3, 0.4, 0.1], [0, 0, 0.0]])
    keys = Track(hand, "translation", "LINEAR", np.arange(4.0) / 24, single(places))
    kept = tuple(t for t in rig.clips[0].tracks if (t.node, t.path) != (hand, "translation"))
    rig = replace(rig, clips=(replace(rig.clips[0], tracks=(*kept, keys)),))
    rig = rigtri.add_rivet(rig, mesh=rig.address(rig.meshes[0].node), triangle=(0,), name="button", fps=96)
    baked = bake(rig, options=BakeOptions(fps=24))
    again = bake(bake(baked, options=TO_CONTROLS), options=BakeOptions(fps=24))
    times = np.arange(4.0) / 24
    shown = [sampling.worlds(each, sampling.locals_at(each, each.clips[0], times)) for each in (baked, again)]
    joints = np.flatnonzero(rig.is_joint)
    np.testing.assert_allclose(shown[1][:, joints], shown[0][:, joints], atol=1e-5)
