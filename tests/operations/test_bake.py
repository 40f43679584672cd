"""bake: controls into joint keys, and back."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from baked_files import keyed_file, rigged_file
from baked_rigs import (
    BOUND,
    WHOLE,
    animated,
    apart,
    control,
    moved,
    rigged,
    size,
    stored,
    with_keyed_controls,
)
from places import SAMPLES, asset_files, leave_out_refused, sample_files, slow
from program import cli
from rigs import chain
from second_opinions import validator

import rigtri
from rigtri.errors import FileError, GeometryError, NameNotFoundError, UsageError
from rigtri.evaluation import sampling
from rigtri.evaluation.active_controls import controls_at_work
from rigtri.evaluation.pose_cache import sample_parts
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.timelines import timelines
from rigtri.formats import ReadOptions, read
from rigtri.maths.quaternions import from_axis_angle
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.constrain.constrain import ConstrainOptions, constrain
from rigtri.operations.pose import take_pose
from rigtri.pipeline.edit import edit
from rigtri.report import Report


@pytest.mark.ci
@pytest.mark.parametrize("clip", ["walk", slow("wave")])
def test_joints_to_controls_to_joints_gives_the_motion_back(clip: str) -> None:
    rig = rigged()
    home = bake(with_keyed_controls(), options=BakeOptions())
    assert apart(rig, home, clip, sampling.key_times(rig.clip(clip))) < BOUND


@pytest.mark.ci
def test_ik_is_at_work_in_the_round_trip_and_joint_keys_are_not_copied() -> None:
    rig = rigged()
    report = Report()
    up = bake(rig, options=BakeOptions(to="controls"), report=report)
    assert all(entry["limbs"] == 4 for entry in report.added)
    # Without the IK ends' keys the limbs would stand otherwise.
    ends = {control(up, joint, "ik") for joint in ("hand_L", "hand_R", "foot_L", "foot_R")}

    def shifted(track: Track) -> Track:
        mine = track.node in ends and track.path == "translation"
        return replace(track, values=track.values + 0.2) if mine else track

    clips = tuple(replace(clip, tracks=tuple(map(shifted, clip.tracks))) for clip in up.clips)
    home = bake(replace(up, clips=clips), options=BakeOptions())
    assert apart(rig, home, "walk", sampling.key_times(rig.clip("walk"))) > 0.01


def test_a_rig_that_nobody_moved_bakes_to_itself() -> None:
    rig = rigged("tpose.glb")
    assert bake(replace(rig, clips=()), options=BakeOptions()) is rig or np.array_equal(
        bake(rig, options=BakeOptions()).local, rig.local
    )


@pytest.mark.ci
def test_baking_again_changes_nothing() -> None:
    up = with_keyed_controls()
    once = bake(up, options=BakeOptions())
    twice = bake(once, options=BakeOptions())
    for a, b in zip(once.clips, twice.clips, strict=True):
        for one, two in zip(a.tracks, b.tracks, strict=True):
            assert one.values is two.values or np.array_equal(one.values, two.values)


def test_a_control_that_was_rotated_at_rest_rotates_its_joint_once_however_often_it_is_baked() -> None:
    rig = replace(rigged(), clips=())
    head = control(rig, "head", "fk")
    rotation = rig.rotation.copy()
    rotation[head] = from_axis_angle([0.0, 0.0, 1.0], 0.5)
    posed = replace(rig, rotation=rotation)
    once = bake(posed, options=BakeOptions())
    turned = np.linalg.norm(once.world[rig.find("head"), :3, :3] - rig.world[rig.find("head"), :3, :3])
    assert turned == pytest.approx(2.0 * np.sqrt(2.0) * np.sin(0.25), rel=1e-3)
    np.testing.assert_allclose(bake(stored(once), options=BakeOptions()).world, once.world, atol=1e-6)


def test_a_control_that_is_posed_at_rest_is_at_work_in_clips_where_nothing_of_it_has_keys() -> None:
    """An arm reaches for its keyed control from a chest that is turned at rest, before the bake and after."""
    rig = rigged()
    hand, chest = control(rig, "hand_L", "ik"), control(rig, "spine", "fk")
    rotation = rig.rotation.copy()
    rotation[chest] = from_axis_angle([0.0, 1.0, 0.0], 0.3)
    posed = replace(animated(rig, hand, "translation", [[0, 0, 0], [0.0, 0.01, 0.0]]), rotation=rotation)
    baked = bake(posed, options=BakeOptions(clip=("new",)))
    world = sampling.worlds(baked, sampling.locals_at(baked, baked.clip("new"), [1.0]))[0]
    np.testing.assert_allclose(world[rig.find("hand_L"), 3, :3], world[hand, 3, :3], atol=1e-6)


@pytest.mark.parametrize("keyed", ["b_ctl", "b"])
def test_a_clip_that_does_not_have_a_pose_of_controls_at_rest_does_not_get_it(keyed: str) -> None:
    """Neither where keys of the control are zero, nor where the joint has own keys, of its rotation."""
    rig = add_controls(
        chain((0, 0, 0), (1, 0, 0), (2, 0, 0)), options=AddControlsOptions(joints=("b",), frame="joint")
    )
    node, path = rig.find(keyed), "translation" if keyed == "b_ctl" else "rotation"
    value = getattr(rig, path)[[node]]
    translation = rig.translation.copy()
    translation[rig.find("b_ctl")] += [0.0, 0.25, 0.0]
    track = Track(node, path, "LINEAR", np.array([0.0, 1.0]), np.repeat(value, 2, axis=0))
    posed = replace(rig, translation=translation, clips=(Clip("zero", (track,)),))
    baked = bake(posed, options=BakeOptions())
    b = rig.find("b")
    assert baked.translation[b, 1] == 0.25
    assert sampling.locals_at(baked, baked.clips[0], [0.5])[0, b, 3, 1] == 0.0


def test_clips_that_are_not_baked_do_not_get_a_new_rest_pose() -> None:
    """And a bake of them later is the same as one of all clips."""
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0))
    rig = constrain(rig, options=ConstrainOptions(child="c", driver=("a",), maintain_offset=False))
    turns = np.array([[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.6, 0.8]])
    track = Track(rig.find("a"), "rotation", "LINEAR", np.array([0.0, 1.0]), turns)
    rig = replace(rig, clips=(Clip("walk", (track,)), Clip("idle", (track,))))
    once = bake(rig, options=BakeOptions(clip=("walk",)))
    assert np.abs(once.world - rig.world).max() > 0.5
    for time in ([0.0], [0.4], [1.0]):
        before, after = (sampling.locals_at(each, each.clips[1], time) for each in (rig, once))
        np.testing.assert_allclose(after, before, atol=1e-6)
    later, every = (bake(each, options=BakeOptions()) for each in (once, rig))
    np.testing.assert_allclose(*(sampling.locals_at(r, r.clips[1], [0.4]) for r in (later, every)), atol=1e-6)


def test_a_control_that_is_posed_at_rest_stays_so_in_a_clip_that_is_not_baked() -> None:
    """It is at work there, so a bake of that clip later, too, has its pose."""
    rig = add_controls(
        chain((0, 0, 0), (1, 0, 0), (2, 0, 0)), options=AddControlsOptions(joints=("b",), frame="joint")
    )
    translation = rig.translation.copy()
    translation[rig.find("b_ctl")] += [0.0, 0.25, 0.0]
    turns = np.array([[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.6, 0.8]])
    track = Track(rig.find("c"), "rotation", "LINEAR", np.array([0.0, 1.0]), turns)
    posed = replace(rig, translation=translation, clips=(Clip("walk", (track,)), Clip("idle", (track,))))
    later = bake(bake(posed, options=BakeOptions(clip=("walk",))), options=BakeOptions())
    assert sampling.locals_at(later, later.clips[1], [0.5])[0, rig.find("b"), 3, 1] == 0.25


def test_an_ik_end_takes_the_end_of_the_limb_along() -> None:
    rig = rigged()
    hand = control(rig, "hand_L", "ik")
    inward = rig.world[rig.find("upper_arm_L"), 3, :3] - rig.world[hand, 3, :3]
    move = (0.3 * inward + [0.0, 0.05, 0.05]) @ np.linalg.inv(rig.world[hand, :3, :3])
    rig = animated(rig, hand, "translation", [[0, 0, 0], move])
    baked = bake(rig, options=BakeOptions(clip=("new",)))
    for k, time in enumerate((0.0, 1.0)):
        local = sampling.locals_at(baked, baked.clip("new"), [time])
        world = sampling.worlds(baked, local)[0]
        np.testing.assert_allclose(world[rig.find("hand_L"), 3, :3], world[hand, 3, :3], atol=1e-6)
        assert k == 0 or np.abs(world[rig.find("hand_L")] - rig.world[rig.find("hand_L")]).max() > 0.05


def test_a_control_without_keys_leaves_its_joint_alone() -> None:
    rig = rigged()
    rig = animated(rig, control(rig, "head", "fk"), "rotation", [[0, 0, 0, 1], [0, 0, 0.6, 0.8]])
    baked = bake(rig, options=BakeOptions(clip=("new",)))
    joints = {rig.names[t.node] for t in baked.clip("new").tracks if rig.is_joint[t.node]}
    assert joints == {"head"}


@pytest.mark.ci
def test_stretch_and_soft_of_the_options_hold_for_all_limbs() -> None:
    rig = rigged()
    hand = control(rig, "hand_L", "ik")
    far = animated(rig, hand, "translation", [[0, 0, 0], [2.0, 0, 0]])

    def end(options: BakeOptions) -> Floats:
        baked = bake(far, options=options)
        return sampling.worlds(baked, sampling.locals_at(baked, baked.clip("new"), [1.0]))[0]

    stretched, plain = end(BakeOptions(clip=("new",), stretch=True)), end(BakeOptions(clip=("new",)))
    target = stretched[hand, 3, :3]
    joint = rig.find("hand_L")
    assert np.linalg.norm(stretched[joint, 3, :3] - target) < 1e-5
    assert np.linalg.norm(plain[joint, 3, :3] - target) > 0.5
    soft = end(BakeOptions(clip=("new",), soft=0.2))
    arm = rig.find("upper_arm_L")
    assert np.linalg.norm(soft[joint, 3, :3] - soft[arm, 3, :3]) <= np.linalg.norm(
        plain[joint, 3, :3] - plain[arm, 3, :3]
    )


def test_a_limb_that_would_stretch_without_end_is_refused_by_name() -> None:
    rig = rigged()
    hand = control(rig, "hand_L", "ik")
    far = animated(rig, hand, "translation", [[0, 0, 0], [1e30, 0, 0]])
    with pytest.raises(GeometryError, match=r"'hand_L_ik_ctl' is so far away at new@.* --no-stretch"):
        bake(far, options=BakeOptions(stretch=True))
    # A rest pose is no other; before, pose wrote it.
    stored = replace(far, metadata={**far.metadata, hand: {**far.metadata[hand], "stretch": True}})
    with pytest.raises(GeometryError, match=r"'hand_L_ik_ctl' is so far away at new@1 "):
        take_pose(stored, at="new@1")
    for target, stretch in ((1e30, False), (1e3, True)):
        near = animated(rig, hand, "translation", [[0, 0, 0], [target, 0, 0]])
        baked = bake(near, options=BakeOptions(stretch=stretch))
        assert all(np.isfinite(track.values).all() for clip in baked.clips for track in clip.tracks)


@pytest.mark.parametrize("suffix", [".glb", slow(".usda")])
def test_a_control_that_was_moved_at_rest_is_reported(suffix: str, tmp_path: Path) -> None:
    whole, turned, out, again = (tmp_path / f"{k}{suffix}" for k in ("whole", "turned", "out", "again"))
    rigged_file(f"biped{suffix}", whole)

    def move(rig: Rig, report: Report) -> Rig:
        return moved(rig, rig.find("chest_ctl"), np.array([0.0, 0.125, 0.0]))

    edit(whole, turned, move)
    result = cli("bake", turned, "-o", out, "--report", tmp_path / "report.json")
    assert "1 node at rest" in result.output
    assert "nothing" not in result.output
    report = json.loads((tmp_path / "report.json").read_text())
    assert {"type": "rest", "nodes": ["chest"]} in report["added"]
    validator("report").validate(report)
    result = cli("bake", out, "-o", again)
    assert "nothing was baked" in result.output
    assert "everything that was in the file is unchanged" in result.output
    assert again.read_bytes() == out.read_bytes()


@pytest.mark.ci
def test_a_constraint_is_worked_out_in_every_clip() -> None:
    rig = read(SAMPLES / "biped.glb").rig
    rig = constrain(rig, options=ConstrainOptions(type="parent", child="staff", driver=(("hand_L", 1.0),)))
    baked = bake(rig, options=BakeOptions())
    times = sampling.key_times(rig.clip("walk"))
    world = sampling.worlds(baked, sampling.locals_at(baked, baked.clip("walk"), times))
    hand, staff = rig.find("hand_L"), rig.find("staff")
    offset = rig.world[staff] @ np.linalg.inv(rig.world[hand])
    np.testing.assert_allclose(world[:, staff], offset @ world[:, hand], atol=1e-5)


@pytest.mark.ci
@pytest.mark.parametrize(("hinge", "far"), [((0.0, 0.0, 1.0), 0.6), ((0.0, 1.0, 0.0), 2.4)])
def test_poles_do_not_flip_when_a_limb_passes_straight(hinge: tuple[float, float, float], far: float) -> None:
    """Nor when it folds far the other way: the pole, as the bone saw it at rest, comes onto the line."""
    rig = rigged("tpose.glb")
    limb = next(note["chain"] for note in rig.metadata.values() if note.get("type") == "poleVector")
    pole = next(node for node, note in rig.metadata.items() if note.get("type") == "poleVector")
    middle = rig.find(limb[1])
    times = np.linspace(0.0, 1.0, 321)
    turns = np.stack([from_axis_angle(np.array(hinge), angle) for angle in np.linspace(-far, far, 321)])
    from rigtri.maths.quaternions import multiply

    track = Track(middle, "rotation", "LINEAR", times, multiply(rig.rotation[middle], turns))
    rig = replace(rig, clips=(Clip("bend", (track,)),))
    up = bake(rig, options=BakeOptions(to="controls"))
    world = sampling.worlds(up, sampling.locals_at(up, up.clip("bend"), times))
    step = np.linalg.norm(np.diff(world[:, pole, 3, :3], axis=0), axis=1) / size(rig)
    assert step.max() < 0.01
    home = bake(up, options=BakeOptions())
    assert apart(rig, home, "bend", times) < BOUND


def test_a_pole_turns_to_where_a_limb_bends_to_by_and_by() -> None:
    """The limb bends 40° beside where it bends at rest, by ever more of its length."""
    rig = chain((0, 0, 0), (1, 0.2, 0), (2, -0.4, 0))
    rig = add_controls(rig, options=AddControlsOptions(ik=(("a", "b", "c"),)))
    pole = next(node for node, note in rig.metadata.items() if note["type"] == "poleVector")
    heights = np.array([0.0, 0.01, 0.02, 0.04, 0.06, 0.08, 0.1, 0.15, 0.3])
    times, aside = np.arange(len(heights), dtype=float), np.array([0.0, *np.cos(np.radians([40, 50]))])
    middle = heights[:, np.newaxis] * aside + [1.0, 0.0, 0.0]
    tracks = (
        Track(1, "translation", "LINEAR", times, middle),
        Track(2, "translation", "LINEAR", times, [3.0, 0.0, 0.0] - middle),
    )
    up = bake(replace(rig, clips=(Clip("bends", tracks),)), options=BakeOptions(to="controls"))
    world = sampling.worlds(up, sampling.locals_at(up, up.clip("bends"), times))
    _, y, z = (world[:, pole, 3, :3] - middle).T
    # Up to a sine of 0.02, about half of the height, as the bone turns; from 0.15 on as the limb bends.
    expected = [0.0, -0.4, -0.7, -1.5, -1.7, -0.8, 0.9, 8.0, 30.5]
    np.testing.assert_allclose(np.degrees(np.arctan2(z, y)), expected, atol=0.1)


def test_a_clip_of_one_key_and_a_control_of_uneven_scale_have_a_meaning() -> None:
    rig = add_controls(rigged(), options=AddControlsOptions(joints=("head",), frame="joint"))
    head = control(rig, "head", "fk")
    rig = animated(rig, head, "scale", [[1.0, 2.0, 0.5]], times=[0.25])
    baked = bake(rig, options=BakeOptions(clip=("new",)))
    track = next(t for t in baked.clip("new").tracks if t.path == "scale" and t.node == rig.find("head"))
    np.testing.assert_allclose(track.values, [[1.0, 2.0, 0.5]], atol=1e-6)


@pytest.mark.ci
def test_thinned_keys_keep_what_was_linear_few() -> None:
    rig = rigged()
    head = rig.find("head")
    two = Track(head, "rotation", "LINEAR", np.array([0.0, 1.0]), np.array([[0, 0, 0, 1], [0, 0, 0.6, 0.8]]))
    many = Track(
        rig.find("hips"),
        "translation",
        "LINEAR",
        np.linspace(0, 1, 60),
        np.random.default_rng(0).normal(size=(60, 3)),
    )
    rig = replace(rig, clips=(Clip("mixed", (two, many)),))
    home = bake(bake(rig, options=BakeOptions(to="controls")), options=BakeOptions())
    kept = next(t for t in home.clip("mixed").tracks if t.node == head and t.path == "rotation")
    assert len(kept.times) == 2


@pytest.mark.parametrize(
    ("options", "error"),
    [
        (BakeOptions(clip=("wlak",)), NameNotFoundError),
        (BakeOptions(fps=0.0), UsageError),
        (BakeOptions(tolerance=np.inf), UsageError),
        (BakeOptions(fps="a"), UsageError),  # type: ignore[arg-type]
        (BakeOptions(clip="walk"), UsageError),  # type: ignore[arg-type]
        (BakeOptions(soft=1.0), UsageError),
        (BakeOptions(stretch="no"), UsageError),  # type: ignore[arg-type]
        (BakeOptions(to="bones"), UsageError),  # type: ignore[arg-type]
    ],
)
def test_options_that_cannot_be_are_reported(options: BakeOptions, error: type[Exception]) -> None:
    with pytest.raises(error):
        bake(rigged(), options=options)


def test_a_file_without_controls_has_nothing_to_bake() -> None:
    with pytest.raises(GeometryError, match="nothing to bake"):
        bake(read(SAMPLES / "biped.glb").rig, options=BakeOptions())


def test_of_constraints_whose_driver_is_gone_it_says_which() -> None:
    rig = rigtri.constrain(rigtri.read(SAMPLES / "biped.glb"), type="parent", child="head", driver="staff")
    gone = tuple("cane" if name == "staff" else name for name in rig.names)
    with pytest.raises(GeometryError, match=r"nothing to bake: Constraint '.*no one node is 'staff'"):
        rigtri.bake(replace(rig, names=gone))


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", slow("biped.gltf"), slow("biped.usda"), slow("biped.usdz")])
def test_the_command_takes_a_motion_to_controls_and_home_again(name: str, tmp_path: Path) -> None:
    steps = [tmp_path / f"{k}{Path(name).suffix}" for k in range(4)]
    rigged_file(name, steps[0])
    keyed_file(name, steps[1])
    cli("bake", steps[1], "-o", steps[2], "--to", "joints", code=0)
    cli("bake", steps[2], "-o", steps[3], code=0)
    assert steps[2].read_bytes() == steps[3].read_bytes()
    before, after = read(steps[0]).rig, read(steps[2]).rig
    assert apart(before, after, "walk", sampling.key_times(before.clip("walk"))) < BOUND


def test_a_description_comes_from_another_file_where_an_exporter_dropped_it(tmp_path: Path) -> None:
    whole, up, bare, out = (tmp_path / f"{k}.glb" for k in ("whole", "up", "bare", "out"))
    rigged_file("biped.glb", whole)
    keyed_file("biped.glb", up)
    bare.write_bytes(up.read_bytes().replace(b'"rigtri"', b'"unknwn"'))
    cli("bake", bare, "-o", out, code=5)
    cli("bake", bare, "-o", out, "--rig", whole, code=0)
    before, after = read(whole).rig, read(out).rig
    assert apart(before, after, "walk", sampling.key_times(before.clip("walk"))) < BOUND


# A .vrma has no joints.
@pytest.mark.ci
@pytest.mark.parametrize(
    "path",
    [
        path if path.name == "biped.glb" else slow(path)
        for path in (*sample_files(), *asset_files())
        if path.suffix != ".vrma"
    ],
    ids=lambda path: path.name,
)
def test_real_motion_comes_home(path: Path) -> None:
    try:
        rig = stored(add_controls(read(path, ReadOptions(allow_external_paths=True)).rig, options=WHOLE))
    except FileError as error:
        leave_out_refused(path, error)
    clips = [clip.name for clip in rig.shown_clips if clip.tracks]
    report = Report()
    up = bake(rig, options=BakeOptions(to="controls", fps=30.0), report=report)
    home = bake(up, options=BakeOptions(fps=30.0))
    assert "controls-off" not in {notice.code for notice in report.warnings}
    for name in clips:
        clip = rig.clip(name)
        times = sampling.key_times(clip)
        assert apart(rig, home, name, times[:: max(1, len(times) // 50)]) < BOUND


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", slow("biped.usda")])
def test_a_joint_that_only_the_root_control_moves_keeps_its_motion(name: str) -> None:
    only_limbs = AddControlsOptions(limbs="auto", root_control=True)
    rig, report = stored(add_controls(read(SAMPLES / name).rig, options=only_limbs)), Report()
    up = bake(rig, options=BakeOptions(to="controls"), report=report)
    assert max(entry["deviation"] for entry in report.added if entry["type"] == "clip") < BOUND
    home = bake(up, options=BakeOptions())
    for clip in rig.shown_clips:
        assert apart(rig, home, clip.name, sampling.key_times(clip)) < BOUND


def without_fk(rig: Rig) -> Rig:
    """The rig whose limbs have IK alone, as other builders make them."""
    notes = {node: note for node, note in rig.metadata.items() if note.get("kind") != "fk"}
    return replace(rig, metadata=notes)


def growing(rig: Rig) -> Rig:
    """The rig whose left shin moves away from the knee while it walks, which no IK end can say."""
    shin, walk = rig.find("shin_L"), rig.clip("walk")
    longer = rig.translation[shin] * [[1.0], [1.1]]
    track = Track(shin, "translation", "LINEAR", np.array([walk.tracks[0].times[0], 0.5]), longer)
    return replace(rig, clips=(replace(walk, tracks=(*walk.tracks, track)),))


@pytest.mark.slow
def test_what_the_controls_do_not_give_back_is_a_warning_that_reports_where_when_and_how_far() -> None:
    rig = growing(without_fk(rigged()))
    report = Report()
    up = bake(rig, options=BakeOptions(to="controls", between=1e-5), report=report)
    (notice,) = (notice for notice in report.warnings if notice.code == "controls-off")
    assert notice.geometry
    assert "has no FK control" in notice.text
    place, _, moment = notice.text.partition("walk@")
    off = float(place.split("back ")[1].split()[0])
    time = float(moment.split(";")[0])
    assert notice.joint is not None
    at = [
        sampling.worlds(one, sampling.locals_at(one, one.clip("walk"), [time]))[
            0, rig.find(notice.joint), 3, :3
        ]
        for one in (rig, bake(up, options=BakeOptions(between=1e-5)))
    ]
    assert np.linalg.norm(at[0] - at[1]) / size(rig) == pytest.approx(off, rel=0.1)
    assert off > 1e-3


def test_what_a_constraint_moves_without_controls_is_not_said_to_have_some() -> None:
    some = AddControlsOptions(joints=("hips", "spine", "chest", "neck"), limbs="auto")
    rig = stored(add_controls(read(SAMPLES / "biped.glb").rig, options=some))
    rig = constrain(rig, child="head", driver=["hand_L_ik_ctl"], type="parent", maintain_offset=False)
    bake(rig, options=BakeOptions(to="controls", clip=("walk",)), report=(report := Report()))
    (notice,) = (notice for notice in report.warnings if notice.code == "controls-off")
    assert notice.text.startswith("'head' is ")
    assert "it has no controls, and the constraint of 'head' moves it" in notice.text


def test_the_control_of_a_joint_whose_rotation_is_constrained_does_not_turn() -> None:
    rig = rigged()
    control = rig.find("head_ctl")
    rule = ConstrainOptions(type="orient", child="head", driver=(("hand_L", 1.0),))

    def turns(rig: Rig) -> bool:
        tracks = bake(rig, options=BakeOptions(to="controls", clip=("walk",))).clip("walk").tracks
        (values,) = (track.values for track in tracks if (track.node, track.path) == (control, "rotation"))
        return bool(np.ptp(values, axis=0).max() > 1e-3)

    assert turns(rig)
    assert not turns(constrain(rig, options=rule))


@pytest.mark.slow
def test_a_wider_tolerance_bears_more_and_strict_bears_none(tmp_path: Path) -> None:
    whole, bare, up = (tmp_path / f"{k}.glb" for k in ("whole", "bare", "up"))

    def moved(rig: Rig, report: Report) -> Rig:
        report.reposed = True
        found = growing(rig).clips
        return replace(rig, clips=(found[0], *rig.clips[1:]))

    def without_fk(rig: Rig, report: Report) -> Rig:
        kept = {node: note for node, note in rig.metadata.items() if note.get("kind") != "fk"}
        return replace(rig, metadata=kept)

    edit(SAMPLES / "biped.glb", tmp_path / "longer.glb", moved)
    cli("add-controls", tmp_path / "longer.glb", "-o", whole, "--whole-character")
    edit(whole, bare, without_fk)
    given = ("bake", bare, "-o", up, "--to", "controls", "--overwrite")
    cli(*given, "--tolerance", "1", "--strict", code=0)
    told = cli(*given, code=0)
    assert "controls give" in told.output
    cli(*given, "--strict", code=5)


@pytest.mark.slow
@pytest.mark.parametrize("block", [slow(1), 7, slow(64)])
def test_blocks_of_frames_change_no_bit(block: int) -> None:
    rig = rigged()
    rule = ConstrainOptions(type="parent", child="staff", driver=(("hand_L", 1.0),))
    up = bake(constrain(rig, options=rule), options=BakeOptions(to="controls", fps=120.0))
    for timeline in timelines(up):
        solver = Solver(up, controls_at_work(up, timeline))
        times = np.linspace(0.0, 1.0, 100)
        parts = sample_parts(up, timeline.clip, times)
        whole, some = solver.solved(parts), solver.solved(parts, block)
        assert whole.keys() == some.keys()
        for node in whole:
            for one, other in zip(whole[node], some[node], strict=True):
                rows = np.broadcast_to(one, (len(times), one.shape[1]))
                assert np.broadcast_to(other, rows.shape).tobytes() == rows.tobytes()


@pytest.mark.parametrize(
    ("kind", "child", "count"),
    [("orient", "forearm_L_ctl", 1), ("orient", "hand_L_ctl", 0), ("scale", "forearm_L_ctl", 0)],
)
def test_a_constraint_on_an_fk_control_of_a_limb_that_ik_moves_is_warned_of(
    kind: Any, child: str, count: int
) -> None:
    rig = bake(rigged(), options=BakeOptions(to="controls", fps=24.0))
    rig = constrain(rig, options=ConstrainOptions(type=kind, child=child, driver=(("head_ctl", 1.0),)))
    report = Report()
    bake(rig, options=BakeOptions(fps=24.0), report=report)
    found = [n for n in report.warnings if n.code == "constraint-below-ik" and "walk" in n.text]
    assert len(found) == count
    assert all(
        notice.text.startswith(f"'{child}' follows a constraint in walk@0, where IK") for notice in found
    )


@pytest.mark.parametrize(
    ("rule", "words"),
    [
        (
            ConstrainOptions(child="chest_ctl", type="orient", driver=(("hips_ctl", 1.0),)),
            "; --space moves its",
        ),
        (ConstrainOptions(child="forearm_L_pole", space=("world", "chest_ctl")), "constraint moves it"),
        (ConstrainOptions(child="head_ctl", type="scale", driver=(("hips_ctl", 1.0),)), ""),
        (ConstrainOptions(child="hand_L_ik_ctl", space=("world", "chest_ctl")), ""),
    ],
    ids=["control", "pole vector", "other channels", "offset"],
)
def test_keys_that_a_constraint_overrules_are_warned_of(rule: ConstrainOptions, words: str) -> None:
    rig, report = bake(rigged(), options=BakeOptions(to="controls", fps=24.0)), Report()
    constrain(rig, options=rule, report=report)
    found = [notice for notice in report.warnings if notice.code == "keys-overruled"]
    assert len(found) == bool(words)
    assert all(f"'{rule.child}' has keys in walk" in notice.text and words in notice.text for notice in found)


@pytest.mark.ci
def test_a_constraint_on_a_joint_of_a_limb_that_ik_moves_is_warned_of() -> None:
    rig = rigged()
    rule = ConstrainOptions(type="orient", child="hand_L", driver=(("head", 1.0),))
    rig, report = constrain(rig, options=rule), Report()
    baked = bake(rig, options=BakeOptions(fps=24.0))
    bake(baked, options=BakeOptions(to="controls", fps=24.0), report=report)
    assert not report.warnings
    rig = bake(rig, options=BakeOptions(to="controls", fps=24.0), report=report)
    (notice,) = {n for n in report.warnings if "walk" in n.text}
    assert notice.text.startswith(
        "'hand_L' follows a constraint in clip 'walk', which does nothing once IK moves"
    )
    report = Report()
    bake(rig, options=BakeOptions(fps=24.0), report=report)
    (notice,) = {n for n in report.warnings if n.code == "constraint-overruled" and "walk" in n.text}
    assert notice.text.startswith("'hand_L' does not follow its constraints in walk@0, where IK moves")
