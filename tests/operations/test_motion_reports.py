"""What edits say of motion that they change on purpose: how far, where and when."""

from __future__ import annotations

import base64
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from baked_rigs import WHOLE, control
from morphs import arm
from places import SAMPLES, slow
from program import cli
from rigs import random_rig

import rigtri
from rigtri.errors import GeometryError
from rigtri.evaluation import sampling
from rigtri.formats import read
from rigtri.formats.gltf.new_key_times import refuse_early
from rigtri.model.animation import Clip, Track, Tracks
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import add_controls
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.constrain.constrain import ConstrainOptions, constrain
from rigtri.operations.pose import PoseOptions, take_pose
from rigtri.operations.snap import SnapOptions, snap
from rigtri.operations.take_clips.restore_metadata import as_described
from rigtri.operations.take_clips.take_clips import take_clips
from rigtri.pipeline.edit import Outcome, edit
from rigtri.pipeline.rigspec.build import build
from rigtri.report import Report
from rigtri.verification.compare.verdict import Comparison

NAMES = ["biped.glb", slow("biped.usda")]
MOVE = np.array([0.3, 0.0, 0.4])  # half a unit


def carried(rig: Rig) -> Rig:
    """The rig whose root control goes half a unit away in a second of the first clip."""
    root = control(rig, "hips", "root")
    rest, times = rig.translation[root], np.array([0.0, 1.0]) * rig.rules.per_second
    track = Track(root, "translation", "LINEAR", times, np.stack([rest, rest + MOVE]))
    first = rig.clips[0]
    return replace(rig, clips=(replace(first, tracks=(*first.tracks, track)), *rig.clips[1:]))


def whole(name: str, folder: Path, *, move: bool = True) -> Path:
    """A file with controls, of which one moves."""

    def step(rig: Rig, report: Report) -> Rig:
        rig = add_controls(rig, options=WHOLE, report=report)
        return carried(rig) if move else rig

    path = folder / f"rigged.{name}"
    edit(SAMPLES / name, path, step)
    return path


def baked(source: Path, target: Path) -> Outcome:
    return edit(source, target, lambda rig, report: bake(rig, options=BakeOptions(), report=report))


@pytest.mark.ci
@pytest.mark.parametrize("name", NAMES)
def test_bake_reports_how_far_it_moves_joints_where_and_when(name: str, tmp_path: Path) -> None:
    source = whole(name, tmp_path)
    told = baked(source, tmp_path / name).verification
    assert told is not None
    assert told.motion is not None
    # All goes half a unit: points of what joints move, and so joints.
    assert told.motion.deviation * told.diagonal == pytest.approx(0.5, rel=1e-3)
    worst = told.motion.worst
    assert worst is not None
    assert worst.clip == read(source).rig.clips[0].name
    assert worst.time >= 0.99 * read(source).rig.rules.per_second
    assert told.summary().startswith("largest deviation from the intended result: ")
    assert (
        f"motion differs from IN by up to {told.motion.deviation:.2g} of the model's size ({worst})"
        in told.summary()
    )
    assert "is unchanged" not in told.summary()
    assert told.as_json()["motion"]["clips"][worst.clip] == told.motion.deviation


@pytest.mark.ci
@pytest.mark.parametrize("name", NAMES)
def test_what_moves_nothing_reports_it(name: str, tmp_path: Path) -> None:
    source = whole(name, tmp_path, move=False)
    at = f"{read(source).rig.clips[0].name}@0.5"
    options = SnapOptions("ik", (at,), (("upper_arm_L", "forearm_L", "hand_L"),))
    told = edit(source, tmp_path / name, lambda rig, report: snap(rig, options=options, report=report))
    assert told.verification is not None
    assert told.verification.motion is not None
    assert told.verification.motion.deviation == 0
    assert told.verification.summary().endswith("; everything that IN shows moves as in IN")


@pytest.mark.ci
@pytest.mark.parametrize("name", NAMES)
def test_take_clips_reports_how_far_what_it_took_moves(name: str, tmp_path: Path) -> None:
    edited = tmp_path / f"edited.{name}"
    baked(whole(name, tmp_path), edited)
    home = edit(
        SAMPLES / name,
        tmp_path / name,
        lambda rig, report: take_clips(rig, from_=read(edited).rig, report=report),
    ).verification
    assert home is not None
    assert home.motion is not None
    assert home.motion.deviation * home.diagonal == pytest.approx(0.5, rel=1e-3)


def test_take_clips_refuses_motion_that_only_controls_have(tmp_path: Path) -> None:
    """Of the same file, baked, all is taken: see the test above."""
    edited = read(whole("biped.glb", tmp_path)).rig
    with pytest.raises(GeometryError, match="RIG has no 'hips_root_ctl'"):
        take_clips(read(SAMPLES / "biped.glb").rig, from_=edited)


def bare(path: Path) -> Path:
    """Nodes without a mesh: one that turns by 90° in a second, another that follows its turn, and a third."""
    values = np.array([0, 1, 0, 0, 0, 1, 0, 0, np.sqrt(0.5), np.sqrt(0.5)], dtype="<f4").tobytes()
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1, 2]}],
        "nodes": [
            {"name": "leads"},
            {"name": "follows", "translation": [3.0, 0.0, 0.0]},
            {"name": "far", "translation": [3.0, 4.0, 0.0]},
        ],
        "buffers": [{"byteLength": 40, "uri": f"data:;base64,{base64.b64encode(values).decode()}"}],
        "bufferViews": [{"buffer": 0, "byteLength": 8}, {"buffer": 0, "byteOffset": 8, "byteLength": 32}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
            {"bufferView": 1, "componentType": 5126, "count": 2, "type": "VEC4"},
        ],
        "animations": [
            {
                "name": "turn",
                "channels": [{"sampler": 0, "target": {"node": 0, "path": "rotation"}}],
                "samplers": [{"input": 0, "output": 1}],
            }
        ],
    }
    path.write_text(json.dumps(document))
    return path


def test_rotations_of_nodes_without_a_mesh_are_reported(tmp_path: Path) -> None:
    """Nothing moves from its place: the axes turn by 90°, seen a twentieth of the size (5) away."""
    source, rigged, out = bare(tmp_path / "in.gltf"), tmp_path / "rigged.gltf", tmp_path / "out.gltf"
    orient = ConstrainOptions(type="orient", child="follows", driver=(("leads", 1.0),))
    added = edit(source, rigged, lambda rig, report: constrain(rig, options=orient, report=report))
    assert added.verification is not None
    assert added.verification.deviation == 0
    told = baked(rigged, out).verification
    assert told is not None
    assert told.motion is not None
    assert told.motion.deviation == pytest.approx(0.05 * np.sqrt(2.0), rel=1e-5)
    assert str(told.motion.worst) == "turn of follows, turn at 1"
    assert "all that IN shows" not in told.summary()


def test_between_its_keys_too_motion_is_measured(tmp_path: Path) -> None:
    """A step between two keys that agree with both: keys alone would see nothing."""
    source, target = SAMPLES / "biped.glb", tmp_path / "a.glb"

    def held(rig: Rig, report: Report) -> Rig:
        report.reposed = True
        clip = rig.clips[0]
        tracks = tuple(replace(t, interpolation="STEP") if t.path == "rotation" else t for t in clip.tracks)
        return replace(rig, clips=(replace(clip, tracks=tracks), *rig.clips[1:]))

    told = edit(source, target, held).verification
    assert told is not None
    assert told.motion is not None
    assert told.motion.worst is not None
    before, after = read(source).rig, read(target).rig
    times = sampling.between_keys(sampling.key_times(before.clips[0]))
    joints = np.flatnonzero(before.is_joint)
    far = max(
        float(np.linalg.norm(a - b, axis=-1).max())
        for a, b in [
            [
                sampling.worlds(r, sampling.locals_at(r, r.clips[0], times))[:, joints, 3, :3]
                for r in (before, after)
            ]
        ]
    )
    assert far > 0.01
    assert told.motion.deviation * told.diagonal >= far * (1 - 1e-6)


def test_a_pose_reports_how_far_the_rest_moves(tmp_path: Path) -> None:
    told = edit(
        SAMPLES / "biped.glb",
        tmp_path / "a.glb",
        lambda rig, report: take_pose(rig, options=PoseOptions("walk@0.3"), report=report),
    ).verification
    assert told is not None
    assert told.motion is not None
    assert told.motion.worst is not None
    assert told.motion.worst.clip == ""
    assert "at rest" in told.summary()


@pytest.mark.ci
def test_the_report_of_a_command_has_the_motion(tmp_path: Path) -> None:
    source, out = whole("biped.glb", tmp_path), tmp_path / "out.glb"
    report = tmp_path / "report.json"
    done = cli("bake", source, "-o", out, "--report", report, code=0)
    assert "motion differs from IN by up to" in done.output
    told = json.loads(report.read_text("utf-8"))["verification"]["motion"]
    assert told["deviation"] > 0.1
    assert told["worst"]["clip"] == "walk"
    bare = ["bake", str(source), "-o", str(out), "--overwrite", "--no-verify"]
    assert "motion differs" not in cli(*bare).output


@pytest.mark.slow
def test_more_keys_than_there_were_are_reported(tmp_path: Path) -> None:
    """The joints of the sample's walk have few keys; with IK at work they bend between them."""
    up, edited, out = (tmp_path / f"{name}.glb" for name in ("up", "edited", "out"))
    words = ["bake", str(whole("biped.glb", tmp_path, move=False)), "-o", str(up), "--to", "controls"]
    cli(*words, code=0)

    def lifted(rig: Rig, report: Report) -> Rig:
        report.reposed = True
        end = control(rig, "hand_L", "ik")
        clips = []
        for clip in rig.clips:
            tracks = []
            for track in clip.tracks:
                if (track.node, track.path) == (end, "translation"):
                    track = replace(track, values=track.values + np.array([0.0, 0.2, 0.0]))
                tracks.append(track)
            clips.append(replace(clip, tracks=tuple(tracks)))
        return replace(rig, clips=tuple(clips))

    edit(up, edited, lifted)
    report = tmp_path / "report.json"
    done = cli("bake", edited, "-o", out, "--report", report, code=0)
    clips = json.loads(report.read_text("utf-8"))["added"]
    before = sum(entry["keys_before"] for entry in clips)
    assert sum(entry["keys"] for entry in clips) > 2 * before > 0
    assert f"the same properties had {before} keys before" in done.output


def test_a_file_without_clips_reports_it(tmp_path: Path) -> None:
    source, bare, out = whole("biped.glb", tmp_path, move=False), tmp_path / "bare.glb", tmp_path / "out.glb"

    def still(rig: Rig, report: Report) -> Rig:
        report.reposed = True
        return replace(rig, clips=tuple(replace(clip, tracks=()) for clip in rig.clips))

    edit(source, bare, still)
    done = cli("bake", bare, "-o", out, "--to", "controls", code=0)
    assert "The file has no clips" in done.output
    assert "the file has no clips; nothing was baked" in done.output


def test_help_reports_what_else_the_tolerance_bounds() -> None:
    words = " ".join(cli("help", "bake").output.split())
    assert "removed keys" in words
    assert "removed keys" not in cli("help", "orient-joints").output


@pytest.mark.parametrize("name", NAMES)
def test_a_key_before_0_is_refused_in_gltf(name: str, tmp_path: Path) -> None:
    source, out = whole(name, tmp_path), tmp_path / f"out.{name}"

    def earlier(rig: Rig, report: Report) -> Rig:
        report.reposed = True
        clip, *others = rig.clips
        tracks = tuple(replace(track, times=track.times - 5.0) for track in clip.tracks)
        return replace(rig, clips=(replace(clip, tracks=tracks), *others))

    if name == "biped.usda":
        edit(source, out, earlier, verify=False)  # time codes may be anything
        return
    with pytest.raises(GeometryError, match="at -5 s in clip 'walk', and glTF has no time before 0"):
        edit(source, out, earlier, verify=False)
    assert not out.exists()


def test_a_new_key_is_not_looked_for_among_the_tracks_of_all_clips() -> None:
    class Unread(Tracks):
        def __iter__(self) -> Any:
            raise AssertionError

    rig = random_rig(1)
    clips = tuple(Clip(f"{k}", Unread(clip.columns), key=k) for k, clip in enumerate(rig.clips * 2))
    first, *others = clips
    own = tuple(Tracks(first.columns))
    added = replace(first, tracks=(*own, replace(own[0], times=own[0].times + 1.0)))
    refuse_early(replace(rig, clips=clips), replace(rig, clips=(added, *others)))


def test_other_morph_weights_count_as_motion(tmp_path: Path) -> None:
    """The target ``bulge`` moves all points by one unit along z, and half of it is on top now."""
    source = arm().glb(tmp_path / "arm.glb")

    def fuller(rig: Rig, report: Report) -> Rig:
        report.reposed = True
        clips = []
        for clip in rig.clips:
            tracks = [
                replace(t, values=t.values + np.array([0.5, 0.0])) if t.path == "weights" else t
                for t in clip.tracks
            ]
            clips.append(replace(clip, tracks=tuple(tracks)))
        return replace(rig, clips=tuple(clips))

    told = edit(source, tmp_path / "out.glb", fuller).verification
    assert told is not None
    assert told.motion is not None
    assert told.motion.deviation * told.diagonal == pytest.approx(0.5)
    assert {name: far * told.diagonal for name, far in told.motion.per_mesh.items()} == {
        "Skin/0": pytest.approx(0.5)
    }


def test_a_build_reports_the_motion_of_its_steps(tmp_path: Path) -> None:
    spec = tmp_path / "rig.yaml"
    # What turns joints rounds more than what moves them.
    text = "steps:\n- {do: pose, at: walk@0.3}\n- {do: orient-joints, preset: unreal-editor}\n"
    spec.write_text(text, "utf-8")
    source, out = str(SAMPLES / "biped.glb"), str(tmp_path / "out.glb")
    done = cli("build", source, "--spec", spec, "-o", out, code=0)
    assert "motion differs from IN by up to" in done.output
    assert "everything that was in the file is unchanged" not in done.output


@pytest.mark.ci
def test_controls_are_not_what_moves_where_an_exporter_has_dropped_the_metadata(tmp_path: Path) -> None:
    """They rest where the current frame shows them, and their lines with them; IN's joints rest alike."""
    source, plain = whole("biped.gltf", tmp_path, move=False), tmp_path / "plain.gltf"
    document = json.loads(source.read_bytes())
    for number, node in enumerate(document["nodes"]):
        if (note := node.pop("extras", {}).get("rigtri")) and note["type"] in ("control", "poleVector"):
            node["translation"] = [3.0 * (k + number) for k in range(3)]
    plain.write_text(json.dumps(document))
    rig = read(source).rig
    told = edit(
        plain, tmp_path / "out.gltf", lambda given, report: as_described(given, rig, report=report)
    ).verification
    assert told is not None
    assert told.motion is not None
    assert told.motion.deviation == 0


@pytest.mark.parametrize("clips", [True, False])
def test_fewer_weights_without_clips_are_measured_at_rest_alone(clips: bool, samples: Path) -> None:
    rig, report = rigtri.read(samples / "biped.glb"), Report()
    rig = rig if clips else replace(rig, clips=())
    rigtri.limit_weights(rig, max_influences=1, report=report)
    assert report.added
    assert report.warned("no-clips") is not clips


def built(source: Path, target: Path, *steps: str) -> Comparison:
    """What a build by a spec of these steps says of its output."""
    spec = target.with_name("rig.yaml")
    spec.write_text("steps:\n" + "".join(f"- {{{step}}}\n" for step in steps), "utf-8")
    found = build(source, target, spec).outcome.verification
    assert found is not None
    return found


@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
def test_steps_of_a_build_that_undo_each_other_move_nothing(name: str, tmp_path: Path) -> None:
    """Also where joints are renamed between them."""
    steps = ("do: set-rest, pose: tpose", "do: conform, to: unreal", "do: set-rest, pose: bind")
    told = built(SAMPLES / name, tmp_path / name, *steps)
    assert told.motion is not None
    assert told.motion.deviation < 1e-6
    first = built(SAMPLES / name, tmp_path / f"first.{name}", steps[0])
    assert first.motion is not None
    assert first.motion.deviation > 0.2


def test_steps_of_a_build_that_move_one_way_add_up(tmp_path: Path) -> None:
    """Three poses, each a third of the way: what is said is the whole way, of the mesh as of the joints."""
    source, out = tmp_path / "in.glb", tmp_path / "out.glb"

    def shifted(rig: Rig, report: Report) -> Rig:
        root, rest = rig.find("hips"), rig.translation[rig.find("hips")]
        report.reposed = True
        thirds = np.array([rest + MOVE * share for share in (1 / 3, 2 / 3, 1.0)])
        track = Track(root, "translation", "STEP", np.arange(3.0) * rig.rules.per_second, thirds)
        return replace(rig, clips=(replace(rig.clips[0], tracks=(track,)),))

    edit(SAMPLES / "biped.glb", source, shifted)
    told = built(source, out, *(f"do: pose, at: walk@{time}" for time in (0, 1, 2)))
    assert told.motion is not None
    assert told.motion.worst is not None
    assert told.motion.deviation * told.diagonal == pytest.approx(0.5, rel=1e-4)
    assert told.motion.worst.clip == ""


def test_a_build_measures_what_points_move_with_whose_joints_went(tmp_path: Path) -> None:
    """Twist joints go, all is posed, and other twist joints come: each point is looked at."""
    source, out = tmp_path / "in.glb", tmp_path / "out.glb"
    twist = "do: add-twist, limbs: auto, split-weights: true"
    built(SAMPLES / "biped.glb", source, twist)
    told = built(source, out, "do: strip", "do: set-rest, pose: tpose", twist)
    assert told.motion is not None
    alone = built(SAMPLES / "biped.glb", tmp_path / "alone.glb", "do: set-rest, pose: tpose").motion
    assert alone is not None
    assert told.motion.deviation >= alone.deviation * (1 - 1e-3)
