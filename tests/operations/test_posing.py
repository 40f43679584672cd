"""pose: the pose of one moment, printed or written."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from baked_rigs import control, moved, size, stored, with_keyed_controls
from morphs import arm, arm_usd
from places import SAMPLES, slow
from program import cli
from second_opinions import validator

from rigtri.errors import NameNotFoundError, UsageError
from rigtri.evaluation import sampling, skinning
from rigtri.formats import read
from rigtri.model.animation import Track
from rigtri.model.rig import Rig
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.pose import PoseOptions, pose_of, table, take_pose
from rigtri.pipeline.edit import edit
from rigtri.report import Report


@pytest.mark.ci
def test_the_pose_is_the_one_that_baking_gives() -> None:
    up = with_keyed_controls()
    # The IK end says otherwise than the joints' own keys.
    up = moved(up, up.parents[control(up, "hand_L", "ik")], np.array([0.02, 0.05, -0.03]))
    baked = bake(up, options=BakeOptions(tolerance=0.0))
    posed = pose_of(up, PoseOptions("walk@0.5"))
    there = sampling.worlds(baked, sampling.locals_at(baked, baked.clip("walk"), [0.5]))[0]
    plain = pose_of(up, PoseOptions("walk@0.5", evaluate=False))
    joints = np.flatnonzero(up.is_joint).tolist()
    far = max(np.abs(posed.world(j)[0, 3, :3] - there[j, 3, :3]).max() for j in joints)
    apart = max(np.abs(plain.world(j)[0, 3, :3] - there[j, 3, :3]).max() for j in joints)
    assert far < 1e-5 * size(up) < 1e-2 * size(up) < apart


def test_without_evaluation_it_is_the_clip_as_it_plays() -> None:
    rig = read(SAMPLES / "biped.glb").rig
    found = table(rig, PoseOptions("walk@0.3", evaluate=False))
    world = sampling.worlds(rig, sampling.locals_at(rig, rig.clip("walk"), [0.3]))[0]
    for row in found["joints"]:
        np.testing.assert_allclose(row["position"], world[rig.find(row["joint"]), 3, :3], atol=1e-12)


@pytest.mark.ci
def test_a_written_pose_is_the_rest_pose_and_stays_when_evaluated_again() -> None:
    up = with_keyed_controls()
    taken = stored(take_pose(up, options=PoseOptions("walk@0.5")))
    posed = pose_of(up, PoseOptions("walk@0.5"))
    again = pose_of(taken, PoseOptions("rest"))
    for joint in np.flatnonzero(up.is_joint).tolist():
        np.testing.assert_allclose(taken.world[joint], posed.world(joint)[0], atol=1e-5)
        np.testing.assert_allclose(again.world(joint)[0], posed.world(joint)[0], atol=1e-5)
    assert taken.clips == up.clips


@pytest.mark.parametrize("name", ["biped.glb", slow("biped.usda")])
def test_the_command_writes_the_pose_it_prints(name: str, tmp_path: Path) -> None:
    out = tmp_path / name
    rig = read(SAMPLES / name).rig
    clip = rig.shown_clips[0].name
    at = f"{clip}@{0.25 * rig.rules.per_second}"
    printed = cli("pose", SAMPLES / name, "--at", at, "--json", code=0)
    found = json.loads(printed.stdout)
    validator("pose").validate(found)
    cli("pose", SAMPLES / name, "--at", at, "-o", out, code=0)
    after = read(out).rig
    for row in found["joints"]:
        np.testing.assert_allclose(after.world[after.find(row["joint"]), 3, :3], row["position"], atol=1e-5)
    shown = cli("pose", out, code=0)
    assert len(shown.stdout.splitlines()) == 1 + len(found["joints"])


def test_what_is_no_pose_is_reported() -> None:
    rig = read(SAMPLES / "biped.glb").rig
    with pytest.raises(UsageError, match="CLIP@TIME"):
        pose_of(rig, PoseOptions("walk"))
    with pytest.raises(NameNotFoundError):
        pose_of(rig, PoseOptions("wlak@0"))
    refused = cli("pose", SAMPLES / "biped.glb", "--dry-run", code=2)
    assert "-o OUT" in refused.output


def skinned(path: Path, clip: str | None, time: float) -> list[np.ndarray]:
    """The points of all meshes of a file as it plays, or at rest; no controls take part."""
    document = read(path)
    rig = document.rig
    if clip is None:
        world = rig.world[np.newaxis]
    else:
        world = sampling.worlds(rig, sampling.locals_at(rig, rig.clip(clip), [time]))
    return [
        skinning.deformed(m, rig, world, np.repeat(m.morph_weights[np.newaxis], 1, axis=0))[0]
        for m in document.meshes()
        if m.skin is not None
    ]


@pytest.mark.ci
@pytest.mark.parametrize("suffix", [".glb", slow(".gltf"), slow(".usda"), slow(".usdc"), slow(".usdz")])
def test_a_written_pose_skins_as_the_evaluated_source_does(suffix: str, tmp_path: Path) -> None:
    name = {".usdc": ".usda"}.get(suffix, suffix)
    made, up, baked, still = (tmp_path / f"{k}{suffix}" for k in range(4))
    source = SAMPLES / f"biped{name}"
    if suffix == ".usdc":
        from pxr import Sdf

        source = tmp_path / "in.usdc"
        assert Sdf.Layer.FindOrOpen(str(SAMPLES / "biped.usda")).Export(str(source))
    steps = [
        ("add-controls", source, "-o", made, "--whole-character"),
        ("bake", made, "-o", up, "--to", "controls"),
        # IK is at work in `up`; what it makes of the joints is baked, and skinned from joint keys alone.
        # As near as float32 holds what is resampled.
        ("bake", up, "-o", baked, "--tolerance", "2e-7"),
    ]
    rig = read(SAMPLES / f"biped{name}").rig
    clip = rig.shown_clips[0].name
    time = float(sampling.key_times(rig.clip(clip))[3])
    for step in [*steps, ("pose", up, "-o", still, "--at", f"{clip}@{time}")]:
        cli(*step, code=0)
    there, rest, now = skinned(baked, clip, time), skinned(up, None, 0.0), skinned(still, None, 0.0)
    assert now
    for was, before, is_now in zip(there, rest, now, strict=True):
        assert np.abs(was - before).max() > 1e-2 * size(rig)
        assert np.abs(was - is_now).max() < 1e-6 * size(rig)


def test_a_time_outside_of_the_clip_is_reported_and_holds_the_nearest_pose() -> None:
    shown = cli("pose", SAMPLES / "biped.glb", "--at", "walk@99", "--json")
    last = read(SAMPLES / "biped.glb").rig.clip("walk").tracks[0].times[-1]
    assert shown.exit_code == 0
    assert "has keys from 0 to" in shown.stderr
    rig = read(SAMPLES / "biped.glb").rig
    found = json.loads(shown.stdout)
    validator("pose").validate(found)
    assert found["joints"] == table(rig, PoseOptions(f"walk@{last}"))["joints"]
    assert [notice["code"] for notice in found["warnings"]] == ["pose-outside"]


def test_a_pose_that_another_clip_shows_is_reported_with_its_joints() -> None:
    """Clips show the rest pose of what they have no keys of, but for what controls or constraints move."""
    rig = read(SAMPLES / "biped.glb").rig
    for at, told in (
        ("wave@0.5", "Clips without keys of chest show them in this pose (walk)"),
        ("walk@0.5", "Clips without keys of hips, upper_arm_L, forearm_L, hand_L and 9 more show"),
    ):
        take_pose(rig, at=at, report=(report := Report()))
        (notice,) = (each for each in report.warnings if each.code == "pose-shown")
        assert notice.text.startswith(told)
    take_pose(with_keyed_controls(), at="walk@0.5", report=(report := Report()))
    assert not report.warned("pose-shown")


@pytest.mark.parametrize("at", ["walk@0.5", "rest"])
def test_controls_that_stay_in_the_old_rest_pose_are_named(at: str) -> None:
    """Before, a later key of zero moved the mesh back without a word; a pose at rest is one of controls."""
    up = with_keyed_controls()
    take_pose(
        moved(up, control(up, "hand_L", "ik"), np.array([0.02, 0.05, -0.03])),
        at=at,
        report=(report := Report()),
    )
    told = [notice for notice in report.warnings if notice.code == "controls-old-rest"]
    assert bool(told) == (at != "rest")
    for notice in told:
        assert {"thigh_L_ctl", "foot_R_ik_ctl"} & {*notice.names}


def test_a_printed_pose_is_strict_and_quiet_as_other_commands_are() -> None:
    line = ("pose", SAMPLES / "biped.glb", "--at", "walk@99")
    refused = cli(*line, "--strict", code=5)
    assert "rigtri: --strict: Clip 'walk' has keys" in refused.stderr
    assert not refused.stdout
    assert not cli(*line, "--quiet").stderr
    cli("pose", SAMPLES / "biped.glb", "--at", "walk@0.25", "--strict", code=0)


@pytest.mark.parametrize(
    ("at", "told"), [("walk@12f", "seconds"), ("walk@0.5s", "seconds"), ("walk@nan", "walk")]
)
def test_a_time_is_a_number_in_the_unit_of_the_file(at: str, told: str) -> None:
    with pytest.raises(UsageError, match=told):
        pose_of(read(SAMPLES / "biped.glb").rig, PoseOptions(at))
    if told == "seconds":
        with pytest.raises(UsageError, match="time codes, 24 a second"):
            pose_of(read(SAMPLES / "biped.usda").rig, PoseOptions(at))


def test_the_last_at_splits_and_a_wrong_name_is_met_with_the_nearest() -> None:
    rig = read(SAMPLES / "biped.glb").rig
    renamed = replace(rig, clips=(replace(rig.clip("walk"), name="w@lk@1"),))
    one, other = table(renamed, PoseOptions("w@lk@1@0.25")), table(rig, PoseOptions("walk@0.25"))
    assert one["joints"] == other["joints"]
    with pytest.raises(NameNotFoundError, match=r"Did you mean 'w@lk@1'"):
        table(renamed, PoseOptions("w@lk@0.25"))


def test_morph_weights_are_reported_in_the_pose() -> None:
    rig = read(SAMPLES / "biped.glb").rig
    weights = Track(
        rig.find("hips"), "weights", "LINEAR", np.array([0.0, 1.0]), np.array([[0.0, 1.0], [1.0, 0.5]])
    )
    walk = rig.clip("walk")
    rig = replace(rig, clips=(replace(walk, tracks=(*walk.tracks, weights)),))
    found = table(rig, PoseOptions("walk@0.25"))
    assert found["weights"] == [{"node": "hips", "weights": [0.25, 0.875]}]
    validator("pose").validate({"file": "x.glb", "warnings": [], **found})
    assert table(rig, PoseOptions("rest"))["weights"] == []


@pytest.mark.parametrize("kind", ["glb", "usda"])
def test_a_written_pose_looks_as_the_clip_does_morphs_included(kind: str, tmp_path: Path) -> None:
    source = arm().glb(tmp_path / "arm.glb") if kind == "glb" else arm_usd(tmp_path)
    out, again = (tmp_path / f"{name}.{kind}" for name in ("out", "again"))
    before = read(source).rig
    clip = next(c for c in before.clips if any(t.path == "weights" for t in c.tracks))
    time = 0.3 * before.rules.per_second
    times = np.array([time])

    def posed(rig: Rig, report: Report) -> Rig:
        return take_pose(rig, options=PoseOptions(f"{clip.name}@{time:g}"), report=report)

    outcome = edit(source, out, posed)
    assert not outcome.report.warnings
    after = read(out).rig
    (mesh,), (now,) = before.meshes, after.meshes
    weights = sampling.morph_weights(mesh, clip, times)
    assert weights[0].any()
    np.testing.assert_allclose(now.morph_weights, weights[0], atol=1e-7)
    played = sampling.worlds(before, sampling.locals_at(before, clip, times))
    still = sampling.worlds(after, after.normalised_local)[np.newaxis]
    shown = skinning.deformed(now, after, still, now.morph_weights[np.newaxis])
    assert np.abs(shown - skinning.deformed(mesh, before, played, mesh.morph_weights[np.newaxis])).max() > 0.1
    np.testing.assert_allclose(shown, skinning.deformed(mesh, before, played, weights), atol=1e-6)
    # The clip itself stays, and a second run has nothing to do.
    keys = next(t for c in after.clips for t in c.tracks if t.path == "weights").values
    np.testing.assert_array_equal(keys, next(t for t in clip.tracks if t.path == "weights").values)
    edit(out, again, posed)
    assert out.read_bytes() == again.read_bytes()


@pytest.mark.parametrize(("moment", "told"), [(1.4, []), (1.401, ["pose-outside"])])
def test_the_last_key_of_a_clip_is_no_moment_after_it(moment: float, told: list[str], samples: Path) -> None:
    """glTF stores 1.4 s as 1.39999998."""
    rig = read(samples / "biped.glb").rig
    times = np.array([0.0, 1.4], dtype=np.float32).astype(np.float64)
    track = Track(rig.find("head"), "rotation", "LINEAR", times, np.tile([0.0, 0.0, 0.0, 1.0], (2, 1)))
    rig, report = replace(rig, clips=(replace(rig.clips[0], tracks=(track,)),)), Report()
    table(rig, PoseOptions(at=f"walk@{moment}"), report)
    assert [notice.code for notice in report.warnings] == told
