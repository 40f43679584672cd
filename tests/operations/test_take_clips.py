"""take-clips: the motion of an edited file comes home, and nothing else."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from morphs import arm
from places import SAMPLES, ci, files_of_all_kinds, leave_out_refused
from program import cli
from pxr import Usd
from rigs import chain
from taken_clips import BIPED, apart, notices, places, rig_of, split, turned_key, with_tracks

from rigtri.cli.take_clips import summary
from rigtri.errors import AmbiguousNameError, FileError, GeometryError, NameNotFoundError, UsageError
from rigtri.evaluation import bind_pose, sampling
from rigtri.evaluation.constraint_solver import to_parts
from rigtri.formats import read
from rigtri.maths.matrices import inverse
from rigtri.maths.matrices import multiply as matrices
from rigtri.maths.quaternions import from_axis_angle, multiply, to_axes
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Interpolation, Track, key_values
from rigtri.model.animation import Path as Property
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.operations.take_clips.retargeting import Transfer
from rigtri.operations.take_clips.take_clips import TakeClipsOptions, take_clips
from rigtri.operations.take_clips.unkeyed_poses import _passes
from rigtri.pipeline.edit import edit
from rigtri.report import Report

# Of the size of a character two metres high; float32 matrices between.
CLOSE = 1e-6


def in_metal(rig: Rig) -> Rig:
    """The rig as another program has it: centimetres, z up, another order, a node above all."""
    turn = from_axis_angle([1.0, 0.0, 0.0], np.pi / 2.0)
    skins = []
    for skin in rig.skins:
        bind = skin.inverse_bind.copy()
        bind[:, 3, :3] *= 100.0
        skins.append(replace(skin, inverse_bind=bind))

    def larger(track: Track) -> Track:
        return replace(track, values=track.values * 100.0) if track.path == "translation" else track

    clips = tuple(replace(clip, tracks=tuple(map(larger, clip.tracks))) for clip in rig.clips)
    rig = replace(rig, translation=rig.translation * 100.0, skins=tuple(skins), clips=clips)
    above = rig.with_nodes(["Armature"], [-1], np.zeros((1, 3)), turn[np.newaxis])
    parents = np.where(above.parents < 0, len(rig), above.parents)
    parents[-1] = -1
    order: list[int] = [len(rig)]
    for node in order:  # it grows as it is walked: level by level, children from last to first
        order += [k for k in range(len(rig) - 1, -1, -1) if parents[k] == node]
    upright = replace(above.rules, up=(0.0, 0.0, 1.0))
    return replace(above, parents=parents, rules=upright).reordered(order)


FILES = files_of_all_kinds()


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_a_file_takes_nothing_from_itself_nor_from_itself_with_other_axes(path: Path) -> None:
    try:
        rig = rig_of(path)
        turned = orient_joints(rig)
    except (FileError, GeometryError) as error:
        leave_out_refused(path, error)
    if not rig.clips:
        with pytest.raises(GeometryError):
            take_clips(rig, from_=turned)
        return
    for edited in (rig, turned):
        report = Report()
        assert take_clips(rig, from_=edited, report=report) is rig
        assert not report.reposed
        assert not {"sampled", "other-proportions"} & set(notices(report))


def test_only_nodes_that_carry_nothing_of_rig_would_lose_their_motion() -> None:
    """The motion of an armature that RIG lacks is in what is below it; that of a flag would be lost."""
    rig = rig_of(SAMPLES / "biped.glb")
    above, count = (
        rig.with_nodes(["Armature", "flag"], [-1, 0], np.zeros((2, 3)), np.eye(4)[[3, 3]]),
        len(rig),
    )
    parents = np.where(above.parents < 0, count, above.parents)
    parents[count] = -1
    edited = replace(above, parents=parents).reordered([count, *range(count), count + 1])
    places = np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]])
    tracks = tuple(
        Track(edited.names.index(name), "translation", "LINEAR", np.array([0.0, 1.0]), places)
        for name in ("Armature", "flag")
    )
    clips = (replace(c, tracks=(*c.tracks, *tracks)) if c.name == "walk" else c for c in edited.clips)
    edited = replace(edited, clips=tuple(clips))
    with pytest.raises(GeometryError, match=r"'walk' of EDITED would be lost: RIG has no 'flag'\. Give"):
        take_clips(rig, from_=edited)
    taken = take_clips(rig, from_=edited, exclude=["fl*"])
    assert apart(taken, edited, "walk") < CLOSE < apart(taken, rig, "walk")


@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_the_motion_of_a_joint_with_points_is_lost_where_edited_gives_it_another_name(name: str) -> None:
    """The hand below follows in the world, but the points of the forearm would stay."""
    rig = rig_of(SAMPLES / name)
    edited = turned_key(rig, "forearm_L")
    edited = replace(edited, names=tuple("Bone" if n == "forearm_L" else n for n in edited.names))
    with pytest.raises(
        GeometryError, match=r"RIG has no 'Bone', and 'forearm_L' in its place would not follow"
    ):
        take_clips(rig, from_=edited)


@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_a_key_that_was_moved_under_other_axes_comes_home_alone(name: str) -> None:
    rig = rig_of(SAMPLES / name)
    edited = turned_key(orient_joints(rig), "forearm_L")
    home = take_clips(rig, from_=edited)
    assert apart(home, edited, "walk") < CLOSE
    assert apart(home, rig, "walk") > 0.01
    changed = [
        (rig.names[now.node], now.path)
        for clip, before in zip(home.clips, rig.clips, strict=True)
        for now, was in zip(clip.tracks, before.tracks, strict=True)
        if now is not was
    ]
    assert changed == [("forearm_L", "rotation")]


@pytest.mark.ci
def test_lines_and_splines_stay_what_they_are() -> None:
    rig = rig_of()
    for clip, joint, way in (("walk", "thigh_L", "LINEAR"), ("wave", "forearm_R", "CUBICSPLINE")):
        edited = turned_key(orient_joints(rig), joint, clip)
        home = take_clips(rig, from_=edited)
        node = rig.find(joint)
        (now,) = (t for t in home.clip(clip).tracks if (t.node, t.path) == (node, "rotation"))
        (was,) = (t for t in rig.clip(clip).tracks if (t.node, t.path) == (node, "rotation"))
        assert now.interpolation == way
        assert now.times is was.times
        # Also halfway between the keys, so the tangents came along.
        assert apart(home, edited, clip) < CLOSE
        assert apart(home, rig, clip) > 0.01


@pytest.mark.ci
def test_unit_up_order_and_a_node_above_all_make_no_difference() -> None:
    rig = rig_of()
    report = Report()
    assert take_clips(rig, from_=in_metal(rig), report=report) is rig
    assert notices(report) == []
    edited = in_metal(turned_key(rig, "thigh_L"))
    home = take_clips(rig, from_=edited)
    wanted = turned_key(rig, "thigh_L")
    assert apart(home, wanted, "walk") < CLOSE
    # What does not stand up in its own format is told.
    lying = replace(in_metal(rig), rules=rig.rules)
    assert take_clips(rig, from_=lying, report=report) is rig
    assert notices(report) == ["other-facing"]
    # And the other way round: a rig in centimetres takes from one in metres.
    large = in_metal(rig)
    assert take_clips(large, from_=rig) is large
    assert apart(take_clips(large, from_=wanted), edited, "walk") < 100.0 * CLOSE


@pytest.mark.ci
def test_a_bind_pose_where_ours_rests_in_a_pose_is_no_motion() -> None:
    rig = rig_of()
    bind = bind_pose.bind_worlds(rig, rig.skins[0])
    posed = rig.rotation.copy()
    arm = rig.find("upper_arm_L")
    posed[arm] = multiply(posed[arm], from_axis_angle([0.0, 0.0, 1.0], 1.0))
    ours = replace(rig, rotation=posed)
    assert np.abs(ours.world[arm] - bind[arm]).max() > 0.1
    assert take_clips(ours, from_=rig) is ours
    # A new clip that leaves the arm at EDITED's rest must not leave it at ours.
    hips = rig.find("hips")
    track = Track(
        hips, "translation", "LINEAR", np.array([0.0, 1.0]), rig.translation[[hips, hips]] + [[0], [1]]
    )
    home = take_clips(ours, from_=replace(rig, clips=(Clip("jump", (track,)),)))
    made = replace(rig, clips=(Clip("jump", (track,)),))
    assert apart(home, made, "jump") < CLOSE


@pytest.mark.ci
def test_frames_of_a_dcc_are_no_change_where_it_interpolates_number_by_number() -> None:
    rig = rig_of()

    def framed(track: Track) -> Track:
        if len(track.times) < 2 or track.interpolation != "LINEAR":
            return track
        times = np.arange(0.0, float(track.times[-1]) + 1e-6, 1.0 / 24.0)
        values = np.stack([np.interp(times, track.times, column) for column in track.values.T], axis=1)
        if track.path == "rotation":
            values /= np.linalg.norm(values, axis=1, keepdims=True)
        return replace(track, times=times, values=values, key=None)

    framed_rig = with_tracks(rig, "walk", framed)
    assert max(len(t.times) for t in framed_rig.clip("walk").tracks) == 25
    assert take_clips(rig, from_=framed_rig) is rig
    edited = turned_key(framed_rig, "shin_R", key=10)
    home = take_clips(rig, from_=edited)
    changed = [t for t in home.clip("walk").tracks if all(t is not was for was in rig.clip("walk").tracks)]
    # Eight of RIG's nine keys, one of EDITED's, and two where the one meets the other.
    assert [(rig.names[t.node], len(t.times)) for t in changed] == [("shin_R", 11)]


@pytest.mark.ci
def test_a_key_that_was_taken_out_is_seen() -> None:
    rig = rig_of()
    node = rig.find("thigh_L")

    def thinner(track: Track) -> Track:
        if (track.node, track.path) != (node, "rotation"):
            return track
        return replace(track, times=np.delete(track.times, 2), values=np.delete(track.values, 2, axis=0))

    edited = with_tracks(rig, "walk", thinner)
    home = take_clips(rig, from_=edited)
    (now,) = (t for t in home.clip("walk").tracks if (t.node, t.path) == (node, "rotation"))
    assert len(now.times) == 8
    assert apart(home, edited, "walk") < CLOSE


def test_a_jump_between_two_frames_stays_beside_what_was_read_finer_than_frames() -> None:
    """As angles about three axes of USD prims are; b has keys of a control, c those of a weight."""
    rig = chain((0, 0, 0), (0, 1, 0), (0, 2, 0))
    control = {"v": 1, "type": "control", "kind": "fk", "joint": "a"}
    weight = {"v": 1, "type": "constraintWeight", "driver": "a"}
    rig = replace(rig, metadata={1: control, 2: weight}, skins=(Skin("", np.arange(1), np.eye(4)[None]),))
    frames, finer = np.arange(13) / 24, np.arange(97) / 192

    def turning(node: int, times: Floats) -> Track:
        return Track(node, "rotation", "LINEAR", times, from_axis_angle(np.eye(3)[:1], times))

    def jumping(before: float) -> Track:
        values = [[0.0, 2.0, 0.0], [0.0, 2.0, 0.0], [1.0, 2.0, 0.0]]
        return Track(2, "translation", "LINEAR", np.array([0.0, before, 0.25]), np.array(values))

    def clip(before: float, times: Floats) -> Clip:
        return Clip("walk", (turning(0, frames), turning(1, times), jumping(before)))

    rig = replace(rig, clips=(clip(0.2499999, frames),))
    assert take_clips(rig, from_=replace(rig, clips=(clip(5 / 24, finer),))) is rig


@pytest.mark.ci
def test_splines_that_came_back_as_frames_stay_unless_their_keys_moved() -> None:
    rig = rig_of()
    node = rig.find("forearm_R")

    def framed(by: float) -> Rig:
        def changed(track: Track) -> Track:
            if track.node != node or track.interpolation != "CUBICSPLINE":
                return track
            times = np.arange(0.0, float(track.times[-1]) + 1e-6, 0.05)
            straight = Track(node, "rotation", "LINEAR", track.times, key_values(track))
            values = sampling.sample(straight, times)
            values[10:12] = multiply(values[10:12], from_axis_angle([1.0, 0.0, 0.0], by))
            return Track(node, "rotation", "LINEAR", times, values)

        return with_tracks(rig, "wave", changed)

    report = Report()
    assert take_clips(rig, from_=framed(0.0), report=report) is rig
    assert notices(report) == ["splines-kept"]
    assert apart(take_clips(rig, from_=framed(1.5)), framed(1.5), "wave") < CLOSE


@pytest.mark.ci
@pytest.mark.parametrize("pattern", ["walk_{}", "{}|walk", "walk_{}.001", "{}Action"])
def test_clips_that_were_split_per_object_are_one_again(pattern: str) -> None:
    rig = rig_of()
    edited = split(turned_key(rig, "shin_L"), "walk", pattern.format)
    report = Report()
    home = take_clips(rig, from_=edited, report=report)
    assert [clip.name for clip in home.clips] == [clip.name for clip in rig.clips]
    assert apart(home, turned_key(rig, "shin_L"), "walk") < CLOSE
    assert notices(report) == []


@pytest.mark.ci
def test_an_action_that_fits_no_clip_is_one_of_its_own_until_it_is_declared_to_be_another() -> None:
    rig = rig_of()
    head = rig.find("head")
    turns = np.stack([rig.rotation[head], multiply(rig.rotation[head], from_axis_angle([1.0, 0, 0], 0.5))])
    track = Track(head, "rotation", "LINEAR", np.array([0.0, 0.4]), turns)
    edited = replace(rig, clips=(Clip("headAction", (track,)),))
    report = Report()
    assert [c.name for c in take_clips(rig, from_=edited, report=report).clips] == [
        "walk",
        "wave",
        "headAction",
    ]
    assert notices(report) == ["split-clip"]
    home = take_clips(rig, options=TakeClipsOptions(from_=edited, as_={"headAction": "wave"}))
    assert [c.name for c in home.clips] == ["walk", "wave"]
    now = [t for t in home.clip("wave").tracks if (t.node, t.path) == (head, "rotation")]
    np.testing.assert_array_equal(now[0].values, turns)
    with pytest.raises(NameNotFoundError):
        take_clips(rig, options=TakeClipsOptions(from_=edited, as_={"armAction": "wave"}))


@pytest.mark.ci
def test_new_clips_are_added_missing_ones_stay_and_only_those_requested_are_taken() -> None:
    rig = rig_of()
    edited = turned_key(turned_key(rig, "shin_L"), "forearm_R", "wave")
    walk = replace(edited.clip("walk"), name="limp", key=None)
    edited = replace(edited, clips=(walk, edited.clip("wave")))
    home = take_clips(rig, from_=edited)
    assert [clip.name for clip in home.clips] == ["walk", "wave", "limp"]
    assert home.clips[0] is rig.clips[0]
    assert apart(replace(home, clips=home.clips[2:]), edited, "limp") < CLOSE
    only = take_clips(rig, options=TakeClipsOptions(from_=edited, clip=("lim*",)))
    assert only.clips[:2] == rig.clips
    assert len(only.clips) == 3
    with pytest.raises(NameNotFoundError):
        take_clips(rig, options=TakeClipsOptions(from_=edited, clip=("run",)))


def test_controls_have_the_axes_of_what_is_above_them_whatever_frame_was_shown() -> None:
    """Exporters store what the current frame shows as the rest of a moving node."""
    rig = rig_of()
    with_locator = rig.with_nodes(["locator"], [0], np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]))
    node = len(rig)
    times, values = np.array([0.0, 1.0]), np.array([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    track = Track(node, "translation", "LINEAR", times, values)
    ours = replace(with_locator, clips=(Clip("walk", (track,)),))
    shown = ours.translation.copy()
    shown[node] = [0.0, 0.7, 0.0]
    rotation = ours.rotation.copy()
    rotation[node] = from_axis_angle([1.0, 1.0, 0.0], 1.0)
    turning = Track(node, "rotation", "STEP", times[:1], ours.rotation[[node]])
    edited = replace(ours, translation=shown, rotation=rotation, clips=(Clip("walk", (track, turning)),))
    assert take_clips(ours, from_=edited) is ours


@pytest.mark.ci
def test_a_joint_that_is_parented_elsewhere_moves_as_in_the_world() -> None:
    rig = turned_key(rig_of(), "chest")
    head, hips = rig.find("head"), rig.find("hips")
    assert rig.parents[head] != hips
    # EDITED has the head below the hips, with keys that keep its motion.
    clip = rig.clip("walk")
    times = np.linspace(0.0, 1.0, 97)
    world = sampling.worlds(rig, sampling.locals_at(rig, clip, times))
    parts = to_parts(matrices(world[:, head], inverse(world[:, hips])))
    still = to_parts(matrices(rig.world[head], inverse(rig.world[hips]))[np.newaxis])
    parents, translation, rotation = rig.parents.copy(), rig.translation.copy(), rig.rotation.copy()
    parents[head], translation[head], rotation[head] = hips, still.translation[0], still.rotation[0]
    own = (
        Track(head, "translation", "LINEAR", times, parts.translation),
        Track(head, "rotation", "LINEAR", times, parts.rotation),
    )
    tracks = (*(t for t in clip.tracks if t.node != head), *own)
    edited = replace(
        rig, parents=parents, translation=translation, rotation=rotation, clips=(Clip("walk", tracks),)
    )
    report = Report()
    home = take_clips(rig_of(), from_=edited, report=report)
    assert "other-parents" in notices(report)
    mine, its = places(home, "walk", times), places(edited, "walk", times)
    assert np.abs(mine["head"] - its["head"]).max() < 1e-5


def test_a_joint_that_edited_lets_rest_stays_there_where_rig_has_a_moving_one_above_it() -> None:
    times = np.array([0.0, 0.5, 1.0])
    turns = from_axis_angle([0.0, 0.0, 1.0], np.array([0.0, 0.8, -0.4]))
    ours, theirs = (
        chain((0, 0, 0), (1, 0, 0), (3, 0, 0), names="abc"),
        chain((0, 0, 0), (3, 0, 0), names="ac"),
    )
    walk = (Track(1, "rotation", "LINEAR", times, turns), Track(0, "rotation", "LINEAR", times, turns))
    rig = replace(ours, clips=(Clip("walk", walk),))
    edited = replace(theirs, clips=(Clip("walk", (Track(0, "rotation", "LINEAR", times, turns[::-1]),)),))
    home = take_clips(rig, from_=edited)
    mine, its = places(home, "walk", times), places(edited, "walk", times)
    np.testing.assert_allclose(mine["c"], its["c"], atol=CLOSE)
    assert np.abs(places(rig, "walk", times)["c"] - its["c"]).max() > 0.1


def test_a_rig_of_other_proportions_keeps_its_size() -> None:
    times, turns = np.array([0.0, 1.0]), from_axis_angle([0.0, 0.0, 1.0], np.array([0.0, 0.8]))
    rig = chain((0, 0, 0), (0, 1, 0), (0, 1, 1))
    other = chain((0, 0, 0), (0, 1.9, 0), (0, 1.9, 1.1))
    edited = replace(other, clips=(Clip("walk", (Track(0, "rotation", "LINEAR", times, turns),)),))
    report = Report()
    home = take_clips(rig, from_=edited, report=report)
    assert "other-proportions" in notices(report)
    world = sampling.worlds(home, sampling.locals_at(home, home.clip("walk"), times))
    np.testing.assert_allclose(np.linalg.norm(world[..., :3, :3], axis=-1), 1.0, atol=CLOSE)
    bones = np.linalg.norm(np.diff(world[..., 3, :3], axis=1), axis=-1)
    np.testing.assert_allclose(bones, 1.0, atol=CLOSE)


def test_morph_weights_go_by_the_names_of_their_targets(tmp_path: Path) -> None:
    rig = rig_of(arm().glb(tmp_path / "arm.glb"))
    other = arm()
    other.gltf["meshes"][0]["extras"]["targetNames"] = ["other", "bulge"]
    edited = rig_of(other.glb(tmp_path / "other.glb"))
    clip = edited.clips[0]
    assert take_clips(rig, from_=rig) is rig
    home = take_clips(rig, from_=edited)
    (was,) = (t for t in clip.tracks if t.path == "weights")
    (now,) = (t for t in home.clips[0].tracks if t.path == "weights")
    np.testing.assert_array_equal(now.values, was.values[:, ::-1])
    fewer = arm()
    fewer.gltf["meshes"][0]["extras"]["targetNames"] = ["bulge", "smile"]
    half = rig_of(fewer.glb(tmp_path / "fewer.glb"))
    with pytest.raises(GeometryError, match=r"RIG's 'Skin' has no morph targets 'smile'"):
        take_clips(rig, from_=half)
    (weights,) = (track for track in half.clips[0].tracks if track.path == "weights")
    (rest,) = (mesh.morph_weights[1] for mesh in half.meshes if len(mesh.morphs))
    still = replace(weights, values=weights.values * [1.0, 0.0] + [0.0, rest])
    half = with_tracks(half, half.clips[0].name, lambda track: still if track is weights else track)
    assert take_clips(rig, from_=half) is rig  # bulge moves as before, and other as ours
    nameless = arm()
    del nameless.gltf["meshes"][0]["extras"]
    report = Report()
    assert take_clips(rig, from_=rig_of(nameless.glb(tmp_path / "nameless.glb")), report=report) is rig
    assert notices(report) == []


def test_one_name_in_place_of_a_list_is_refused() -> None:
    with pytest.raises(UsageError, match=r"\('walk',\)"):
        take_clips(rig_of(), options=TakeClipsOptions(from_=rig_of(), clip="walk"))  # type: ignore[arg-type]


def test_no_rig_to_take_from_is_an_error_that_reports_what_is_missing() -> None:
    with pytest.raises(TypeError, match=r"from_ must be a Rig.*not NoneType"):
        take_clips(rig_of(), from_=None)  # type: ignore[arg-type]


def test_what_has_no_motion_or_no_common_name_is_an_error() -> None:
    rig = rig_of()
    with pytest.raises(GeometryError, match="no clips"):
        take_clips(rig, from_=replace(rig, clips=()))
    other = replace(rig, names=tuple(f"x{k}" for k in range(len(rig))))
    with pytest.raises(GeometryError, match=r"'x0', 'x1'.*'biped', 'hips'"):
        take_clips(rig, from_=other)
    twice = replace(rig, clips=(rig.clips[0], rig.clips[0]))
    with pytest.raises(AmbiguousNameError):
        take_clips(twice, from_=rig)


def test_a_clip_of_no_length_changes_none_that_has_one() -> None:
    rig = rig_of()

    def first(track: Track) -> Track:
        return replace(track, times=track.times[:1], values=track.values[:1] * 0.5, key=None)

    report = Report()
    edited = with_tracks(rig, "walk", first)
    assert take_clips(rig, options=TakeClipsOptions(from_=edited, clip=("walk",)), report=report) is rig
    assert notices(report) == ["no-length"]


def test_nodes_of_one_name_are_distinguished_by_their_paths_or_left_out_by_name() -> None:
    rig = rig_of()
    names = list(rig.names)
    names[rig.find("shin_L")] = "hand_L"
    ours = replace(rig, names=tuple(names))
    edited = turned_key(rig, "shin_L")
    edited = replace(edited, names=tuple(names))
    report = Report()
    home = take_clips(ours, from_=edited, report=report)
    assert apart(replace(home, names=rig.names), turned_key(rig, "shin_L"), "walk") < CLOSE
    assert notices(report) == []
    # With another name above both, what is next above each tells.
    names[0] = "Scene"
    others = tuple(names)
    assert take_clips(ours, from_=replace(rig, names=others)) is ours
    home = take_clips(ours, from_=replace(edited, names=others), report=report)
    assert apart(replace(home, names=rig.names), turned_key(rig, "shin_L"), "walk") < CLOSE
    assert notices(report) == []
    # Two below one node are the same to anyone.
    names = [name.replace("thigh_R", "thigh_L") for name in rig.names]
    ours = replace(rig, names=tuple(names))
    names[0] = "Scene"
    edited = replace(turned_key(rig, "thigh_L"), names=tuple(names))
    with pytest.raises(GeometryError, match="several nodes are called 'thigh_L'"):
        take_clips(ours, from_=edited)


@pytest.mark.ci
def test_keys_that_were_left_out_stay_with_a_notice() -> None:
    rig = rig_of()
    names = ("thigh_L", "shin_L", "thigh_R", "shin_R", "upper_arm_L", "upper_arm_R")
    without = [rig.find(name) for name in names]
    report = Report()
    edited = with_tracks(rig, "walk", lambda t: None if t.node in without else t)
    assert take_clips(rig, from_=edited, report=report) is rig
    assert notices(report) == ["kept-keys"]
    # Its text has the first four; the report has all.
    assert "and 2 more" in report.warnings[0].text
    assert sorted(report.warnings[0].names) == sorted(names)


@pytest.mark.ci
@pytest.mark.parametrize(("ours", "theirs"), [("biped.glb", "biped.usda"), ("biped.usda", "biped.glb")])
def test_gltf_and_usd_take_from_each_other(ours: str, theirs: str, tmp_path: Path) -> None:
    document = read(SAMPLES / theirs)
    assert (
        take_clips(
            rig := rig_of(SAMPLES / ours), options=TakeClipsOptions(from_=document.rig, clip=("walk",))
        )
        is rig
    )
    edited = turned_key(document.rig, "shin_L")

    def step(rig: Rig, report: Report) -> Rig:
        return take_clips(rig, options=TakeClipsOptions(from_=edited, clip=("walk",)), report=report)

    target = tmp_path / ours
    outcome = edit(SAMPLES / ours, target, step)
    assert outcome.verification is not None
    home = rig_of(target)
    seconds = home.rules.per_second / edited.rules.per_second
    times = sampling.key_times(edited.clip("walk"))
    mine, its = places(home, "walk", times * seconds), places(edited, "walk", times)
    both = mine.keys() & its.keys()
    assert len(both) >= 22
    assert max(np.abs(mine[name] - its[name]).max() for name in both) < 1e-5


def test_several_clips_for_a_usd_file_are_chosen_or_refused() -> None:
    rig, edited = rig_of(SAMPLES / "biped.usda"), rig_of()
    with pytest.raises(UsageError, match="with clip="):
        take_clips(rig, from_=edited)
    assert take_clips(rig, options=TakeClipsOptions(from_=edited, clip=("walk",))) is rig
    others = tuple(replace(clip, name=f"my {clip.name}") for clip in edited.clips)
    with pytest.raises(UsageError, match="with clip="):
        take_clips(rig, from_=replace(edited, clips=others))
    assert (
        take_clips(rig, options=TakeClipsOptions(from_=replace(edited, clips=others), clip=("my walk",)))
        is rig
    )


@pytest.mark.ci
def test_the_program_leaves_the_bytes_of_what_nobody_has_changed(tmp_path: Path) -> None:
    turned, out, report = tmp_path / "turned.glb", tmp_path / "out.glb", tmp_path / "report.json"
    edit(BIPED, turned, lambda rig, report: orient_joints(rig, report=report))
    words = ["take-clips", str(BIPED), "--from", str(turned), "-o", str(out), "--report", str(report)]
    result = cli(*words, code=0)
    assert "nothing was transferred" in result.output
    assert out.read_bytes() == BIPED.read_bytes()
    added = json.loads(report.read_text("utf-8"))["added"]
    assert [(entry["clip"], entry["tracks"], entry["new"]) for entry in added] == [
        ("walk", 0, False),
        ("wave", 0, False),
    ]


@pytest.mark.ci
def test_a_usd_mesh_below_a_prim_of_its_name_and_names_that_begin_with_digits_are_known() -> None:
    rig = rig_of()
    names = [f"2{name}" if name == "hand_L" else name for name in rig.names]
    ours = replace(rig, names=tuple(names))
    spelled = tuple("_2hand_L" if name == "2hand_L" else name for name in names)
    eyes = rig.find("eyes")
    still = np.array([[0.0, 0.0, 0.0, 1.0]])
    edited = replace(ours, names=spelled).with_nodes(["eyes"], [eyes], np.zeros((1, 3)), still)
    report = Report()
    assert take_clips(ours, from_=edited, report=report) is ours
    assert notices(report) == []
    turned = replace(edited, names=(*rig.names, "eyes"))
    turned = turned_key(turned_key(turned, "hand_L"), "thigh_L")
    turned = replace(turned, names=(*spelled, "eyes"))
    report = Report()
    take_clips(ours, from_=turned, report=report)
    assert {name for entry in report.added for name in entry["changed"]} == {"2hand_L", "thigh_L"}


@pytest.mark.ci
def test_nodes_without_names_are_known_by_their_place_where_both_files_are_built_alike() -> None:
    rig = rig_of()
    ours = replace(rig, names=("",) * len(rig))
    edited = turned_key(orient_joints(rig), "shin_L")
    for theirs in (("",) * len(rig), edited.names):
        report = Report()
        home = take_clips(ours, from_=replace(edited, names=theirs), report=report)
        named = replace(home, names=rig.names)
        assert apart(named, edited, "walk") < CLOSE
        assert apart(named, rig, "walk") > 0.01
        assert notices(report).count("by-place") == 1
    # Some alone: the others say whether the order is one.
    some = tuple("" if name == "shin_L" else name for name in rig.names)
    home = take_clips(replace(rig, names=some), from_=replace(edited, names=some))
    assert apart(replace(home, names=rig.names), edited, "walk") < CLOSE


def test_nodes_without_names_are_known_by_those_that_blender_gives_them() -> None:
    """Before, a character without names did not come home from Blender, which adds nodes of its own."""
    rig = rig_of()
    ours = replace(rig, names=("",) * len(rig))
    imported = tuple(f"Node_{label.removeprefix('#')}" for label in rig.labels)
    moved = turned_key(rig, "shin_L")
    edited = replace(moved, names=imported).with_nodes(["Empty"], [-1], np.zeros((1, 3)), np.eye(4)[3:])
    home = take_clips(ours, from_=edited)
    assert apart(replace(home, names=rig.names), moved, "walk") < CLOSE
    assert apart(replace(home, names=rig.names), rig, "walk") > 0.01


def test_nodes_without_names_are_refused_where_a_path_does_not_identify_them() -> None:
    rig = rig_of()
    ours = replace(rig, names=("",) * len(rig))
    nameless = replace(in_metal(rig), names=("",) * (len(rig) + 1))
    with pytest.raises(GeometryError, match=f"RIG and EDITED have no names.*{len(rig)} nodes and EDITED"):
        take_clips(ours, from_=nameless)
    twisted = rig.parents.copy()
    twisted[rig.find("hand_L")] = rig.find("chest")
    with pytest.raises(GeometryError, match="other parents"):
        take_clips(ours, from_=replace(ours, parents=twisted))
    skin = rig.skins[0]
    bind = skin.inverse_bind.copy()
    bind[3, 3, :3] += 0.2
    with pytest.raises(GeometryError, match="bind poses differ"):
        take_clips(ours, from_=replace(ours, skins=(replace(skin, inverse_bind=bind), *ours.skins[1:])))


# --- what exporters lose


def with_path(rig: Rig, joint: str, track: Track) -> Rig:
    """The rig with one track of a joint in ``walk`` replaced, or added."""
    node = rig.find(joint)
    clip = rig.clip("walk")
    others = tuple(t for t in clip.tracks if (t.node, t.path) != (node, track.path))
    now = replace(clip, tracks=(*others, replace(track, node=node)))
    return replace(rig, clips=tuple(now if found is clip else found for found in rig.clips))


def waved(rig: Rig, joint: str, by: float) -> Track:
    """A translation track that swings by so much about the rest, nine keys."""
    times = np.linspace(0.0, 1.0, 9)
    values = np.repeat(rig.translation[[rig.find(joint)]], 9, axis=0)
    values[:, 1] += by * np.sin(times * 2.0 * np.pi)
    return Track(0, "translation", "LINEAR", times, values)


def ends(track: Track) -> Track:
    return replace(track, times=track.times[[0, -1]], values=track.values[[0, -1]])


@pytest.mark.ci
@pytest.mark.parametrize(("by", "same"), [(4e-5, True), (4e-4, False)])
def test_keys_that_an_exporter_left_out_as_nothing_hardly_moves_are_no_edit(by: float, same: bool) -> None:
    rig = rig_of()
    swing = waved(rig, "neck", by)
    ours = with_path(rig, "neck", swing)
    edited = with_path(rig, "neck", ends(swing))
    assert (take_clips(ours, from_=edited) is ours) == same


@pytest.mark.ci
def test_a_world_of_another_up_is_of_one_size_with_ours_whatever_pose_it_rests_in() -> None:
    rig = rig_of()
    lower = rig.rotation.copy()
    for joint in ("spine", "thigh_L", "thigh_R"):
        node = rig.find(joint)
        lower[node] = multiply(lower[node], from_axis_angle([1.0, 0.0, 0.0], 2.0))
    edited = in_metal(rig)
    folded = edited.rotation.copy()
    for node, name in enumerate(edited.names):
        if name in rig.names:
            folded[node] = lower[rig.find(name)]
    edited = replace(edited, rotation=folded)
    assert take_clips(rig, from_=edited) is rig


def beside(angle: float) -> tuple[Floats, Floats]:
    """Turns whose middle angle of x, y and z is so far from a right one, and the same with a little noise.

    The noise is that of one float32 number, 1e-7, over the cosine of the middle angle.
    """
    middle = from_axis_angle([0.0, 1.0, 0.0], np.pi / 2.0 - angle)
    noisy = multiply(from_axis_angle([1.0, 0.0, 0.0], 1e-7 / np.sin(angle)), middle)
    return np.stack([middle, middle]), np.stack([middle, noisy])


def with_raw(rig: Rig, raw: bool = True) -> Rig:
    return replace(rig, rules=replace(rig.rules, raw_quaternions=raw))


@pytest.mark.parametrize(("raw", "same"), [(True, True), (False, False)])
def test_angles_of_usd_prims_describe_rotations_badly_where_two_axes_nearly_meet(
    raw: bool, same: bool
) -> None:
    rig = rig_of().with_nodes(["locator"], [0], np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]))
    told, noisy = beside(1e-4)
    times = np.array([0.0, 1.0])
    ours = with_path(rig, "locator", Track(0, "rotation", "LINEAR", times, told))
    edited = with_path(rig, "locator", Track(0, "rotation", "LINEAR", times, noisy))
    assert (take_clips(ours, from_=with_raw(edited, raw)) is ours) == same
    # Noise of that size is an edit where the axes are far apart.
    far, _ = beside(0.5)
    turned = np.stack([far[0], multiply(from_axis_angle([1.0, 0.0, 0.0], 1e-3), far[0])])
    ours = with_path(rig, "locator", Track(0, "rotation", "LINEAR", times, far))
    edited = with_path(rig, "locator", Track(0, "rotation", "LINEAR", times, turned))
    assert take_clips(ours, from_=with_raw(edited)) is not ours


@pytest.mark.parametrize("spin", [ci(0.0), 0.7, ci(1.5), -2.5])
def test_the_noise_of_angles_is_by_the_cosine_of_the_middle_one(spin: float) -> None:
    """Ten bits of float32 over it, 1.2e-3 for a cosine of 1e-3, however the other two are."""
    rig = rig_of().with_nodes(["locator"], [0], np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]))
    told, _ = beside(1e-3)
    told = multiply(from_axis_angle([0.0, 0.0, 1.0], spin), told)
    x, y, z = to_axes(told[0])[0]
    assert np.hypot(x, y) / np.linalg.norm([x, y, z]) == pytest.approx(1e-3, rel=1e-3)
    assert abs(y) == pytest.approx(1e-3 * abs(np.sin(spin)), rel=1e-3)
    for share, same in ((0.7, True), (1.5, False)):
        turn = from_axis_angle([1.0, 0.0, 0.0], share * 10 * 2.0**-23 / 1e-3)
        noisy, times = np.stack([told[0], multiply(turn, told[1])]), np.array([0.0, 1.0])
        ours = with_path(rig, "locator", Track(0, "rotation", "LINEAR", times, told))
        edited = with_path(rig, "locator", Track(0, "rotation", "LINEAR", times, noisy))
        assert (take_clips(ours, from_=with_raw(edited)) is ours) == same


@pytest.mark.ci
def test_scales_of_skeletons_in_usd_are_halves_and_lack_samples_that_are_near() -> None:
    rig = rig_of()
    times = np.linspace(0.0, 1.0, 9)
    grown = 1.3 + 0.002 * np.arange(9.0)[:, np.newaxis] * np.ones(3)
    ours = with_path(rig, "neck", Track(0, "scale", "LINEAR", times, grown))

    def told(values: Floats, count: int) -> Rig:
        halves = values.astype(np.float16).astype(np.float64)
        return with_path(rig, "neck", Track(0, "scale", "LINEAR", times[:count], halves[:count]))

    assert take_clips(ours, from_=with_raw(told(grown, 9))) is ours
    assert take_clips(ours, from_=told(grown, 9)) is not ours
    # The last four samples are within 0.01 of the fifth.
    assert take_clips(ours, from_=with_raw(told(grown, 5))) is ours
    assert take_clips(ours, from_=with_raw(told(grown + 0.02, 5))) is not ours
    assert take_clips(ours, from_=with_raw(told(grown + 0.005, 9))) is not ours


@pytest.mark.ci
def test_a_rotation_is_an_edit_where_its_children_move_by_more_than_can_be_lost() -> None:
    rig = rig_of()
    for angle, same in ((2e-6, True), (2e-4, False)):
        assert (take_clips(rig, from_=turned_key(rig, "thigh_L", angle=angle)) is rig) == same


# --- what is taken of a track


@pytest.mark.ci
def test_tangents_that_were_moved_are_an_edit() -> None:
    rig = rig_of()
    node = rig.find("forearm_R")

    def bent(track: Track) -> Track:
        if (track.node, track.interpolation) != (node, "CUBICSPLINE"):
            return track
        values = track.values.copy()
        values[2, 2] += 1.0
        return replace(track, values=values)

    edited = with_tracks(rig, "wave", bent)
    home = take_clips(rig, from_=edited)
    assert apart(home, edited, "wave") < CLOSE
    (now,) = (t for t in home.clip("wave").tracks if (t.node, t.path) == (node, "rotation"))
    (was,) = (t for t in rig.clip("wave").tracks if (t.node, t.path) == (node, "rotation"))
    np.testing.assert_array_equal(now.values[[0, 1, 4, 5]], was.values[[0, 1, 4, 5]])


@pytest.mark.ci
def test_splines_in_other_axes_stay_splines_where_the_tangents_of_scale_are_noise() -> None:
    """Before, noise of 1e-6 in them was taken for shear, and the splines became straight keys."""
    rig = rig_of()
    node = rig.find("forearm_R")
    times = next(track.times for track in rig.clip("wave").tracks if track.node == node)
    noise = 1e-6 * np.random.default_rng(1).normal(size=(len(times), 3, 3))
    noise[:, 1] = 1.0
    scale = Track(node, "scale", "CUBICSPLINE", times, noise)
    wave = rig.clip("wave")
    with_scale = replace(wave, tracks=(*wave.tracks, scale))
    rig = replace(rig, clips=tuple(with_scale if clip is wave else clip for clip in rig.clips))
    edited, report = turned_key(orient_joints(rig, aim="x", up="y"), "forearm_R", "wave", 1), Report()
    home = take_clips(rig, from_=edited, report=report)
    assert notices(report) == []
    assert apart(home, edited, "wave") < CLOSE
    (now,) = (t for t in home.clip("wave").tracks if (t.node, t.path) == (node, "rotation"))
    assert now.interpolation == "CUBICSPLINE"


def frames(rig: Rig, joint: str, fps: float, edit: Callable[[Floats, Floats], Floats]) -> Rig:
    """The rig with a joint's turns in ``walk`` sampled, as exporters do, and then edited."""
    node = rig.find(joint)

    def changed(track: Track) -> Track:
        if (track.node, track.path) != (node, "rotation"):
            return track
        times = np.arange(0.0, float(track.times[-1]) + 1e-9, 1.0 / fps)
        return replace(track, times=times, values=edit(times, sampling.sample(track, times)), key=None)

    return with_tracks(rig, "walk", changed)


@pytest.mark.ci
def test_outside_the_edited_frames_the_keys_stay_bit_for_bit_and_inside_there_are_few() -> None:
    rig = rig_of()
    node = rig.find("thigh_L")

    def ramp(times: Floats, values: Floats) -> Floats:
        """Frames 30 to 60 of 97 go along one arc."""
        middle = multiply(values[45], from_axis_angle([1.0, 0.0, 0.0], 0.4))
        values[30:61] = sampling.sample(
            Track(node, "rotation", "LINEAR", times[[30, 60]], np.stack([values[30], middle])), times[30:61]
        )
        return values

    edited = frames(rig, "thigh_L", 96.0, ramp)
    home = take_clips(rig, from_=edited)
    (now,) = (t for t in home.clip("walk").tracks if (t.node, t.path) == (node, "rotation"))
    (was,) = (t for t in rig.clip("walk").tracks if (t.node, t.path) == (node, "rotation"))
    outside = (was.times <= 30 / 96) | (was.times >= 61 / 96)
    for time, value in zip(was.times[outside], was.values[outside], strict=True):
        np.testing.assert_array_equal(now.values[now.times == time], value[np.newaxis])
    # 30 more frames are told by one arc: its two ends, and the frame after it.
    assert outside.sum() < len(now.times) <= outside.sum() + 3
    assert apart(home, edited, "walk") < 1e-5
    assert take_clips(home, from_=edited) is home
    # And all of it where nothing may be left out.
    full = take_clips(rig, options=TakeClipsOptions(from_=edited, tolerance=0.0))
    assert sum(len(t.times) for t in full.clip("walk").tracks) > sum(
        len(t.times) for t in home.clip("walk").tracks
    )


@pytest.mark.ci
def test_a_new_clip_of_a_key_a_frame_has_as_few_keys_as_it_needs_and_its_length() -> None:
    rig = rig_of()
    edited = frames(rig, "thigh_L", 96.0, lambda times, values: values)
    edited = replace(edited, clips=(replace(edited.clip("walk"), name="stroll"),))
    home = take_clips(rig, from_=edited)
    (now,) = (t for t in home.clip("stroll").tracks if (t.node, t.path) == (rig.find("thigh_L"), "rotation"))
    (was,) = (t for t in rig.clip("walk").tracks if (t.node, t.path) == (rig.find("thigh_L"), "rotation"))
    assert len(now.times) <= len(was.times)
    assert now.times[-1] == 1.0
    assert apart(replace(home, clips=home.clips[2:]), edited, "stroll") < 1e-5
    with pytest.raises(UsageError, match="--tolerance"):
        take_clips(rig, options=TakeClipsOptions(from_=edited, tolerance=-1.0))


@pytest.mark.slow
def test_a_usd_rig_takes_its_controls_home_and_bakes_them_to_joints(tmp_path: Path) -> None:
    """RIG, flattened to a crate by OpenUSD, one control moved there."""
    rigged, flat, moved, home, game, before = (
        tmp_path / name
        for name in ("rigged.usda", "flat.usdc", "moved.usdc", "home.usda", "game.usda", "before.usda")
    )

    def controls(rig: Rig, report: Report) -> Rig:
        rig = add_controls(rig, options=AddControlsOptions(whole_character=True), report=report)
        return bake(rig, options=BakeOptions(to="controls"), report=report)

    def joints(rig: Rig, report: Report) -> Rig:
        return bake(rig, options=BakeOptions(to="joints", fps=24.0), report=report)

    def lifted(rig: Rig, report: Report) -> Rig:
        report.reposed = True
        hand = rig.find("hand_L_ik_ctl")

        def changed(track: Track) -> Track:
            if (track.node, track.path) != (hand, "translation"):
                return track
            values = track.values.copy()
            values[3, 1] += 0.1
            return replace(track, values=values)

        clips = tuple(replace(c, tracks=tuple(map(changed, c.tracks))) for c in rig.clips)
        return replace(rig, clips=clips)

    edit(SAMPLES / "biped.usda", rigged, controls)
    Usd.Stage.Open(str(rigged)).Flatten().Export(str(flat))
    edit(rigged, home, lambda rig, report: take_clips(rig, from_=rig_of(flat), report=report))
    assert home.read_bytes() == rigged.read_bytes()
    edit(flat, moved, lifted)
    reports: list[Report] = []

    def taken(rig: Rig, report: Report) -> Rig:
        reports.append(report)
        return take_clips(rig, from_=rig_of(moved), report=report)

    home.unlink()
    edit(rigged, home, taken)
    assert [entry["changed"] for entry in reports[0].added] == [["hand_L_ik_ctl"]]
    edit(home, game, joints)
    edit(rigged, before, joints)
    now, was = rig_of(game), rig_of(before)
    times = np.union1d(sampling.key_times(was.clip("walk")), sampling.key_times(now.clip("walk")))
    mine, its = places(now, "walk", times), places(was, "walk", times)
    far = {name: float(np.abs(mine[name] - its[name]).max()) for name in mine}
    assert {name for name, apart in far.items() if apart > 1e-6} == {"forearm_L", "hand_L", "fingers_L"}
    assert far["hand_L"] > 0.05


@pytest.mark.parametrize("now", ["LINEAR", "CUBICSPLINE"])
@pytest.mark.parametrize("gap", [0.25, 0.04])
def test_few_keys_with_another_interpolation_are_an_edit_and_frames_of_a_dcc_are_none(
    gap: float, now: Interpolation
) -> None:
    rig = rig_of(BIPED)
    node = rig.find("forearm_L")
    times = np.arange(5) * gap
    turns = multiply(from_axis_angle((1.0, 0.0, 0.0), 4.0 * times), rig.rotation[node])
    smooth = np.stack([np.zeros_like(turns), turns, np.zeros_like(turns)], axis=1)
    tracks = (
        Track(node, "rotation", "STEP", times, turns),
        Track(node, "rotation", now, times, smooth if now == "CUBICSPLINE" else turns),
    )
    ours, theirs = (replace(rig, clips=(replace(rig.clips[0], tracks=(each,)),)) for each in tracks)
    (found,) = take_clips(ours, from_=theirs, report=Report()).clips[0].tracks
    assert found.interpolation == (now if gap > 0.1 else "STEP")


@pytest.mark.parametrize("gap", [0.25, 1 / 30])
def test_steps_made_of_lines_are_an_edit_however_near_the_keys_are(gap: float) -> None:
    rig = rig_of(BIPED)
    node = rig.find("forearm_L")
    times = np.arange(5) * gap
    turns = multiply(from_axis_angle((1.0, 0.0, 0.0), 4.0 * times), rig.rotation[node])
    line = Track(node, "rotation", "LINEAR", times, turns)
    ours, theirs = (
        replace(rig, clips=(replace(rig.clips[0], tracks=(each,)),))
        for each in (line, replace(line, interpolation="STEP"))
    )
    (found,) = take_clips(ours, from_=theirs, report=Report()).clips[0].tracks
    assert found.interpolation == "STEP"
    np.testing.assert_array_equal(found.values, turns)


@pytest.mark.parametrize(
    ("path", "ends", "value", "passes"),
    [
        ("translation", ([0, 0, 0], [20, 0, 0]), [7, 0.0015, 0], True),
        ("translation", ([0, 0, 0], [20, 0, 0]), [7, 0.0025, 0], False),
        ("translation", ([0, 0, 0], [20, 0, 0]), [20.5, 0, 0], False),
        ("translation", ([7, 0, 0], [7, 0, 0]), [7, 0, 0], False),  # it does not move
        ("rotation", ([0, 0, 0, 1], [0, 0, 1, 0]), [0, 0, -np.sqrt(0.5), -np.sqrt(0.5)], True),
        ("rotation", ([0, 0, 0, 1], [0, 0, 1, 0]), [0, 0, -np.sqrt(0.5), np.sqrt(0.5)], False),
    ],
)
def test_a_track_passes_a_value_that_it_comes_near_on_its_way(
    path: Property, ends: Any, value: Any, passes: bool
) -> None:
    track = Track(0, path, "LINEAR", np.array([0.0, 1.0]), np.array(ends, dtype=float))
    assert _passes(track, np.array([value], dtype=float)) is passes


@pytest.mark.parametrize(
    ("joints", "frames"),
    [([0.0, 2.0, 4.0], [0.0, 2.0, 4.0]), ([0.0, 4.0], [0.0, 1.0, 2.0, 3.0, 4.0]), ([], [0.0, 1.0, 2.0, 3.0])],
)
def test_joints_with_keys_between_first_and_last_say_when_frames_are(
    joints: list[float], frames: list[float]
) -> None:
    other = SimpleNamespace(is_joint=np.array([False, True]))
    bodies: Any = SimpleNamespace(both=SimpleNamespace(other=other, of={}))
    held = [(0, [0.0, 1.0, 2.0, 3.0]), (1, joints)]
    tracks = [Track(n, "scale", "LINEAR", np.array(t), np.ones((len(t), 3))) for n, t in held if t]
    assert Transfer(bodies, Clip("walk", tracks), None, lambda times: times).joint_frames.tolist() == frames


def test_nodes_of_one_name_are_counted_and_listed_as_several() -> None:
    rig = rig_of()
    both = [rig.find(name) for name in ("forearm_L", "forearm_R")]
    edited = turned_key(turned_key(rig, "forearm_L"), "forearm_R")
    names = tuple("forearm" if node in both else name for node, name in enumerate(rig.names))
    report = Report()
    take_clips(replace(rig, names=names), from_=replace(edited, names=names), clip="walk", report=report)
    assert "2 tracks of 2 nodes transferred" in summary(report)
    assert set(report.added[0]["changed"]) == {f"forearm ({rig.labels[node]})" for node in both}
