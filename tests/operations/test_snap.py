"""snap: FK takes over from IK, or IK from FK, and nothing moves at that frame."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from baked_files import keyed_file, rigged_file
from baked_rigs import animated, control, moved, rigged, size, stored, with_keyed_controls
from places import SAMPLES, asset_files, slow
from program import cli
from second_opinions import validator

import rigtri
from rigtri.cli.snap import summary
from rigtri.errors import GeometryError, UsageError
from rigtri.evaluation import sampling
from rigtri.evaluation.fk import Fk
from rigtri.evaluation.timelines import timelines, times_within
from rigtri.formats import read
from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.animation import Interpolation, Track
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.constrain.constrain import ConstrainOptions, constrain
from rigtri.operations.options.snap import IkOrFk
from rigtri.operations.pose import PoseOptions, pose_of
from rigtri.operations.snap import SnapOptions, snap
from rigtri.report import Report

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
    up = with_keyed_controls()
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


@pytest.mark.ci
@pytest.mark.parametrize("time", [slow(0.0), 0.3, slow(1.0)])
def test_fk_takes_over_where_ik_has_put_the_joints(time: float) -> None:
    rig = posed_by_ik()
    at = f"walk@{time}"
    report = Report()
    done = snap(rig, options=SnapOptions("fk", (at,), limbs="auto"), report=report)
    assert len(report.added) == 4
    assert apart(rig, done, at) < BOUND
    assert not report.warnings
    assert control(rig, "hand_L", "ik") not in keyed(done, "walk")


@pytest.mark.parametrize("time", [0.25, 1.0])
def test_ik_takes_over_where_fk_has_put_the_joints(time: float) -> None:
    rig = posed_by_fk()
    at = f"new@{time}"
    done = snap(rig, options=SnapOptions("ik", (at,), (ARM,)))
    assert apart(rig, done, at) < BOUND
    assert control(rig, "hand_L", "ik") in keyed(done, "new")
    assert control(rig, "hand_R", "ik") not in keyed(done, "new")


@pytest.mark.ci
def test_several_frames_stand_each_and_there_and_back_is_the_pose() -> None:
    rig = posed_by_fk()
    at = ("new@0.25", "new@0.75", "new@1")
    there = snap(rig, options=SnapOptions("ik", at, (ARM,)))
    back = snap(there, options=SnapOptions("fk", at, (ARM,)))
    for moment in at:
        assert apart(rig, there, moment) < BOUND
        assert apart(rig, back, moment) < 2 * BOUND


@pytest.mark.ci
def test_ik_takes_up_what_fk_controls_hold_below_it() -> None:
    rig = with_keyed_controls()
    elbow = control(rig, "forearm_L", "fk")
    turn = from_axis_angle([0.0, 0.0, 1.0], 0.2)
    clips = []
    for clip in rig.clips:
        tracks = [t for t in clip.tracks if (t.node, t.path) != (elbow, "rotation")]
        tracks.append(Track(elbow, "rotation", "LINEAR", np.array([0.0, 1.0]), np.array([turn, turn])))
        clips.append(replace(clip, tracks=tuple(tracks)))
    rig = replace(rig, clips=tuple(clips))
    done = snap(rig, options=SnapOptions("ik", ("walk@1",), (ARM,)))
    assert apart(rig, done, "walk@1") < BOUND
    hand, end = rig.find("hand_L"), control(rig, "hand_L", "ik")
    for state, together in ((rig, False), (done, True)):
        posed = pose_of(state, PoseOptions("walk@1"))
        gap = np.linalg.norm(posed.world(hand)[0, 3, :3] - posed.world(end)[0, 3, :3])
        assert (gap < BOUND * size(rig)) == together
    assert apart(rig, done, "walk@0") < BOUND  # other keys stay


def keyed_apart(a: Rig, b: Rig, clip: str) -> float:
    times = sampling.key_times(a.clip(clip)).tolist()
    return max(apart(a, b, f"{clip}@{time}") for time in times)


@pytest.mark.parametrize("to", [pytest.param("fk", marks=pytest.mark.slow), "ik"])
def test_what_takes_over_shows_the_whole_clip(to: str) -> None:
    rig, clip = (posed_by_ik(), "walk") if to == "fk" else (posed_by_fk(), "new")
    done = snap(rig, options=SnapOptions(to, (f"{clip}@0.3",), (ARM,)))  # type: ignore[arg-type]
    assert keyed_apart(rig, done, clip) < BOUND
    # The other keys of a limb whose controls were at work already stay.
    end = control(rig, "hand_L", "ik" if to == "ik" else "fk")
    again = snap(done, options=SnapOptions(to, (f"{clip}@0.35",), (ARM,)))  # type: ignore[arg-type]
    assert keyed_apart(done, again, clip) < BOUND
    assert end in keyed(again, clip)


@pytest.mark.parametrize("way", ["STEP", "LINEAR"])
def test_what_takes_over_a_stepped_clip_is_stepped(way: Interpolation) -> None:
    rig = posed_by_fk()
    tracks = tuple(replace(track, interpolation=way) for track in rig.clip("new").tracks)
    rig = replace(rig, clips=(*rig.clips[:-1], replace(rig.clips[-1], tracks=tracks)))
    done = snap(rig, options=SnapOptions("ik", ("new@0.3",), (ARM,)))
    new = [track for track in done.clip("new").tracks if track.node == control(rig, "hand_L", "ik")]
    assert new
    assert {t.interpolation for t in new if len(t.times) > 1} == {way}
    assert {t.interpolation for t in done.clip("new").tracks if len(t.times) == 1} <= {"STEP"}


@pytest.mark.ci
def test_a_control_that_takes_over_has_keys_even_where_it_is_zero() -> None:
    # The joints have keys of their own, which would show again without keys of FK controls.
    rig = with_keyed_controls()
    zero = {"translation": np.zeros((1, 3)), "rotation": np.array([[0.0, 0, 0, 1]]), "scale": np.ones((1, 3))}
    still = tuple(
        replace(t, interpolation="STEP", times=t.times[:1], values=zero[t.path])
        if rig.metadata.get(t.node, {}).get("type") == "control" and t.path in zero
        else t
        for t in rig.clip("walk").tracks
        if rig.metadata.get(t.node, {}).get("type") not in ("poleVector", "offset")
    )
    rig = replace(rig, clips=(replace(rig.clip("walk"), tracks=still),))
    done = snap(rig, options=SnapOptions("fk", ("walk@0.25",), limbs="auto"))
    assert apart(rig, done, "walk@0.25") < BOUND
    assert control(rig, "hand_L", "fk") in keyed(done, "walk")


@pytest.mark.ci
def test_controls_below_a_limb_stand_on_its_joints_when_fk_has_taken_over() -> None:
    rig = posed_by_ik()
    done = snap(rig, options=SnapOptions("fk", ("walk@0.25",), (ARM,)))
    offset = done.parents[control(done, "hand_L", "fk")]
    assert offset in keyed(rig, "walk")
    assert offset not in keyed(done, "walk")
    back = snap(done, options=SnapOptions("ik", ("walk@0.25",), (ARM,)))
    for state in (done, back):
        posed = pose_of(state, PoseOptions("walk@0.25"))
        for joint in ARM:
            places = [posed.world(k)[0, 3, :3] for k in (state.find(joint), control(state, joint, "fk"))]
            np.testing.assert_allclose(*places, atol=BOUND * size(state))


@pytest.mark.ci
def test_splines_take_keys_and_stay_as_they_are_elsewhere() -> None:
    rig = posed_by_fk()
    done = snap(rig, options=SnapOptions("ik", ("new@0.5",), (ARM,)))
    end, elbow = control(done, "hand_L", "ik"), control(done, "forearm_L", "fk")
    clip = done.clip("new")
    times = np.array([0.0, 0.4, 0.7, 1.0])
    tracks = []
    for track in clip.tracks:
        if track.node == end:
            values = sampling.sample(track, times)
            slopes = np.zeros_like(values)
            track = replace(
                track,
                interpolation="CUBICSPLINE",
                times=times,
                values=np.stack([slopes, values, slopes], axis=1),
            )
        tracks.append(track)
    turn = np.array([from_axis_angle([0.0, 0.0, 1.0], 0.2)])
    tracks = [t for t in tracks if (t.node, t.path) != (elbow, "rotation")]
    tracks.append(Track(elbow, "rotation", "LINEAR", np.array([0.0, 1.0]), np.repeat(turn, 2, axis=0)))
    rig = replace(done, clips=(*done.clips[:-1], replace(clip, tracks=tuple(tracks))))
    done = snap(rig, options=SnapOptions("ik", ("new@0.55",), (ARM,)))
    assert apart(rig, done, "new@0.55") < BOUND
    was, now = (
        next(t for t in each.clip("new").tracks if (t.node, t.path) == (end, "translation"))
        for each in (rig, done)
    )
    assert now.interpolation == "CUBICSPLINE"
    np.testing.assert_allclose(now.times, [0.0, 0.4, 0.55, 0.7, 1.0], atol=1e-7)
    np.testing.assert_array_equal(now.values[[0, 1, 3, 4]], was.values)
    for time in (0.2, 0.4, 0.7, 0.9):
        np.testing.assert_array_equal(sampling.sample(now, [time]), sampling.sample(was, [time]))


@pytest.mark.ci
def test_what_moves_at_other_times_of_a_limb_that_ik_drives_already_is_reported(tmp_path: Path) -> None:
    """An FK control with one key moves the hand in the whole clip; IK takes that over at one moment alone."""
    rig = posed_by_ik()
    turn = from_axis_angle([0.0, 0.0, 1.0], 0.3)[None]
    wrist = Track(control(rig, "forearm_L", "fk"), "rotation", "LINEAR", np.array([0.0]), turn)
    walk = rig.clip("walk")
    others = [t for t in walk.tracks if (t.node, t.path) != (wrist.node, wrist.path)]
    walk = replace(walk, tracks=(*others, wrist))
    rig = replace(rig, clips=tuple(walk if each.name == "walk" else each for each in rig.clips))
    report = Report()
    done = snap(rig, options=SnapOptions("ik", ("walk@0.5",), (ARM,)), report=report)
    (entry,) = report.added
    assert entry["deviation"] < BOUND
    assert apart(rig, done, "walk@1.0") > 0.01
    assert entry["elsewhere"] > 0.01
    assert "at other times of the clip these joints move by up to" in summary(report)


def test_an_end_joint_that_a_constraint_turns_once_fk_takes_over_is_reported() -> None:
    """Nothing hangs below it whose place would show that."""
    leg = ("thigh_R", "shin_R", "foot_R")
    rig = rigtri.merge_joints(read(SAMPLES / "biped.glb").rig, joints=["toe_R"])
    rig = rigtri.bake(rigtri.add_controls(rig, ik=[leg]), to="controls")
    rig = rigtri.constrain(
        rig, type="orient", child="foot_R", driver=(("hand_L", 1.0),), driver_space="local"
    )
    report = Report()
    snap(rig, options=SnapOptions("fk", ("walk@0.5",), (leg,)), report=report)
    (said,) = report.warnings
    assert said.code == "snap-off"
    assert "'foot_R' follows a constraint" in said.text
    assert report.added[0]["deviation"] > 0.01


@pytest.mark.parametrize(("driver", "codes"), [("hand_L_ik_ctl", ["snap-off"]), ("hand_L", [])])
def test_what_follows_the_ik_end_that_fk_takes_over_from_is_reported(driver: str, codes: list[str]) -> None:
    """It stays behind with the control: no joint shows that, nor keys of the file. Before, without a word."""
    rig = with_keyed_controls()
    rig = rigtri.constrain(rig, child="staff", driver=((driver, 1.0),))
    report = Report()
    snap(rig, options=SnapOptions("fk", ("walk@0.5",), (ARM,)), report=report)
    assert [warning.code for warning in report.warnings] == codes
    for warning in report.warnings:
        assert f"follows '{driver}' and moves by 0." in warning.text


@pytest.mark.ci
def test_an_ik_end_that_follows_a_constraint_is_reported() -> None:
    rig = posed_by_ik()
    hand = rig.title(control(rig, "hand_L", "ik"))
    rig = constrain(rig, options=ConstrainOptions(type="parent", child=hand, driver=(("head", 1.0),)))
    with pytest.raises(GeometryError, match="follows a constraint"):
        snap(rig, options=SnapOptions("fk", ("walk@0.3",), (ARM,)))


def test_a_limb_whose_fk_controls_follow_and_are_followed_goes_to_ik_and_is_reported() -> None:
    rig, report = posed_by_fk(), Report()
    for child, driver in (("upper_arm_L_ctl", "head_ctl"), ("upper_arm_R_ctl", "hand_L_ctl")):
        rig = constrain(rig, options=ConstrainOptions(type="orient", child=child, driver=((driver, 1.0),)))
    done = snap(rig, options=SnapOptions("ik", ("new@0.5",), (ARM,)), report=report)
    assert control(rig, "hand_L", "ik") in keyed(done, "new")
    assert apart(rig, done, "new@0.5") < BOUND or any(each.code == "snap-off" for each in report.warnings)


def test_at_rest_channels_are_set_at_rest() -> None:
    rig = replace(rigged(), clips=())
    hand = control(rig, "hand_L", "ik")
    posed = stored(moved(rig, hand, np.array([-0.05, 0.1, 0.0])))
    done = stored(snap(posed, options=SnapOptions("fk", ("rest",), (ARM,))))
    assert apart(posed, done, "rest") < BOUND
    assert apart(rig, done, "rest") > 100 * BOUND
    np.testing.assert_allclose(done.translation[hand], 0.0)


@pytest.mark.slow
@pytest.mark.parametrize(("at", "told"), [slow("walk@1", 0), ("walk@99", 1)])
def test_a_time_outside_its_clip_is_reported_once_as_by_pose(at: str, told: int) -> None:
    rig = posed_by_ik()
    said, posed = Report(), Report()
    snap(rig, options=SnapOptions("fk", (at,), limbs="auto"), report=said)
    pose_of(rig, PoseOptions(at), posed)
    assert [n.text for n in said.warnings if n.code == "pose-outside"] == [n.text for n in posed.warnings]
    assert len(posed.warnings) == told


def outside() -> list[Any]:
    """Rigs, ways and times."""
    makers = {"ik": posed_by_ik, "fk": posed_by_fk, "usd": partial(rigged, "biped.usda")}
    short = {("ik", "fk", -5.0)}
    return [
        pytest.param(maker, to, time, marks=() if (kind, to, time) in short else pytest.mark.slow)
        for kind, maker in makers.items()
        for to in ("ik", "fk")
        for time in (-5.0, 77.0)
    ]


@pytest.mark.ci
@pytest.mark.parametrize(("maker", "to", "time"), outside())
def test_a_time_outside_its_clip_is_the_nearest_one_and_no_clip_gets_longer(
    maker: Callable[[], Rig], to: str, time: float
) -> None:
    rig = maker()
    name = timelines(rig)[-1].name
    keys = times_within(timelines(rig)[-1], None)
    inside = min(max(time, keys[0]), keys[-1])
    done, like = (
        snap(rig, options=SnapOptions(to, (f"{name}@{at:.17g}",), limbs="auto"))  # type: ignore[arg-type]
        for at in (time, inside)
    )
    now = times_within(timelines(done)[-1], None)
    np.testing.assert_array_equal(now[[0, -1]], keys[[0, -1]])
    for clip, other in zip(done.clips, like.clips, strict=True):
        for track, same in zip(clip.tracks, other.tracks, strict=True):
            np.testing.assert_array_equal(track.times, same.times)
            np.testing.assert_array_equal(track.values, same.values)


@pytest.mark.parametrize("to", ["ik", "fk"])
def test_controls_below_a_joint_that_they_move_are_reported(to: IkOrFk) -> None:
    rig = posed_by_ik()
    parents = rig.parents.copy()
    parents[rig.find("rigtri_controls")] = rig.find("hand_L")
    options = SnapOptions(limb=(ARM,), to=to, at=("rest",))
    with pytest.raises(GeometryError, match="'hand_L' → 'hand_L_ik_ctl'"):
        snap(replace(rig, parents=parents), options=options, report=Report())


def test_what_cannot_be_snapped_is_reported() -> None:
    rig = rigged()
    with pytest.raises(GeometryError, match="no IK end"):
        snap(rig, options=SnapOptions("ik", ("rest",), (("hips", "spine", "chest"),)))
    with pytest.raises(UsageError, match="give the moment"):
        snap(rig, options=SnapOptions("ik", (), limbs="auto"))


REAL = {"pixar_skinnedArm.usda", "raylib_robot.glb", "usdwg_RiggedFigure.usdz"}
TO_SNAP = [
    *map(slow, (SAMPLES / "biped.glb", SAMPLES / "biped.usda")),
    *(path for path in asset_files() if path.name in REAL),
]


@pytest.mark.parametrize("path", TO_SNAP, ids=lambda path: path.name)
def test_files_keep_their_joints_and_a_second_run_changes_no_byte(path: Path, tmp_path: Path) -> None:
    suffix = ".usdc" if path.suffix == ".usda" else path.suffix
    made, up, fk, ik, again = (tmp_path / f"{k}{suffix}" for k in range(5))
    if suffix != path.suffix:
        from pxr import Sdf

        converted = tmp_path / f"in{suffix}"
        assert Sdf.Layer.FindOrOpen(str(path)).Export(str(converted))
        path = converted
    for command in (
        ("add-controls", path, "-o", made, "--whole-character"),
        ("bake", made, "-o", up, "--to", "controls"),
    ):
        cli(*command, code=0)
    rig = read(up).rig
    played = timelines(rig)[0]
    keys = sampling.key_times(played.clip)
    at = [f"{played.name}@{time}" for time in (keys[-1], 0.3 * keys[0] + 0.7 * keys[1])]
    for source, target, to in ((up, fk, "fk"), (fk, ik, "ik")):
        for one, other in ((source, target), (target, again)):
            moments = ("--at", at[0], "--at", at[1])
            cli("snap", one, "-o", other, "--overwrite", "--limbs", "auto", "--to", to, *moments, code=0)
        assert again.read_bytes() == target.read_bytes()
        before, after = read(source).rig, read(target).rig
        for moment in at:
            assert apart(before, after, moment) < BOUND
        ends = {n for n, note in after.metadata.items() if note.get("kind") == "ik"}
        assert bool(ends & {t.node for t in timelines(after)[0].clip.tracks}) == (to == "ik")


@pytest.mark.slow
def test_the_command_leaves_the_file_looking_the_same(tmp_path: Path) -> None:
    one, two, out = (tmp_path / f"{k}.glb" for k in range(3))
    rigged_file("biped.glb", one)
    keyed_file("biped.glb", two)
    snapping = ("snap", two, "-o", out, "--limbs", "auto", "--to", "fk", "--at", "walk@0.5")
    posing = ("pose", two, "-o", tmp_path / "posed.glb", "--at", "walk@0.5")
    baking = ("bake", two, "-o", tmp_path / "baked.glb")
    for command in (snapping, posing, baking):
        told = tmp_path / f"{command[0]}.json"
        cli(*command, "--report", told, code=0)
        validator("report").validate(json.loads(told.read_text("utf-8")))
    before, after = read(two).rig, read(out).rig
    assert apart(before, after, "walk@0.5") < BOUND
    cli("snap", two, "-o", out, "--to", "fk", "--at", "walk@0.5", code=2)


def crowd(rig: Rig, count: int) -> Rig:
    """So many copies of a rig side by side, each with names of its own."""
    size, names = len(rig), frozenset(rig.names)

    def called(value: Any, k: int) -> Any:
        if isinstance(value, str):
            return f"{value}_{k}" if value in names else value
        return [called(item, k) for item in value] if isinstance(value, list) else value

    copies = range(count)
    return replace(
        rig,
        names=tuple(f"{name}_{k}" for k in copies for name in rig.names),
        parents=np.concatenate([np.where(rig.parents >= 0, rig.parents + k * size, -1) for k in copies]),
        **{
            part: np.concatenate([getattr(rig, part)] * count)
            for part in ("translation", "rotation", "scale", "matrix", "has_matrix")
        },
        attachment=np.full(count * size, -1),
        keys=tuple(range(count * size)),
        labels=tuple(f"#{node}" for node in range(count * size)),
        skins=tuple(replace(s, joints=s.joints + k * size) for k in copies for s in rig.skins),
        clips=tuple(
            replace(c, tracks=tuple(replace(t, node=t.node + k * size) for k in copies for t in c.tracks))
            for c in rig.clips
        ),
        metadata={
            node + k * size: {key: called(value, k) if key != "kind" else value for key, value in own.items()}
            for k in copies
            for node, own in rig.metadata.items()
        },
    )


@pytest.mark.slow
def test_a_crowd_takes_as_long_as_its_characters(monkeypatch: pytest.MonkeyPatch) -> None:
    """Before, each limb evaluated all controls of all characters: eight took thirty times as long as two."""
    runs: list[Fk] = []
    run = Fk.run
    monkeypatch.setattr(Fk, "run", lambda fk, posed: (runs.append(fk), run(fk, posed))[1])
    rig = bake(
        add_controls(read(SAMPLES / "biped.glb").rig, options=AddControlsOptions(whole_character=True)),
        options=BakeOptions(to="controls"),
    )
    counts = []
    for count in (1, 3):
        runs.clear()
        report = Report()
        options = SnapOptions(at=("walk@0.4",), to="fk", limbs="auto")
        snap(crowd(rig, count), options=options, report=report)
        assert all(entry["deviation"] < 1e-5 for entry in report.added)
        counts.append((len(report.added), len(runs)))
    assert counts[1][0] == 3 * counts[0][0]
    assert counts[1][1] <= 3 * counts[0][1]


def test_limbs_are_named_once() -> None:
    rig = rigged()
    with pytest.raises(UsageError, match=r"^give limbs= or limb=, not both$"):
        snap(rig, to="ik", at="rest", limb=ARM, limbs="auto")
    with pytest.raises(UsageError, match=r'name the limbs: limb=\(ROOT, MIDDLE, END\), or limbs="auto"'):
        snap(rig, to="ik", at="rest")
