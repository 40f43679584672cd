"""bake: rivets, pose readers and what is constrained to them follow the joints that were baked."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gltf_files import glb_bytes, glb_parts
from morphs import arm, arm_usd
from numpy.testing import assert_allclose
from places import SAMPLES, slow
from program import cli
from rigs import chain

from rigtri.errors import GeometryError
from rigtri.evaluation import sampling, skinning
from rigtri.evaluation.skinned_points import SkinnedPoints
from rigtri.evaluation.timelines import timelines
from rigtri.formats import read
from rigtri.maths.quaternions import from_axis_angle, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.add_posereader.posereader import AddPosereaderOptions, Goal, add_posereader
from rigtri.operations.add_rivet.rivet import AddRivetOptions, add_rivet
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.constrain.constrain import ConstrainOptions, constrain
from rigtri.pipeline.edit import edit
from rigtri.report import Report

SIDE = Goal("side", direction=(-1, 0, 0))


def source_of(kind: str, folder: Path) -> tuple[Path, str, str]:
    """A bending arm with a node beside it: the file, its lower joint and its mesh."""
    if kind == "usda":
        return arm_usd(folder), "b", "Skin"
    built = arm()
    built.gltf["nodes"].append({"name": "pin", "translation": [1, 0, 0]})
    built.gltf["scenes"][0]["nodes"].append(3)
    return built.glb(folder / "arm.glb"), "lower", "Skin"


def built(rig: Rig, joint: str, mesh: str, report: Report) -> Rig:
    rig = add_controls(rig, options=AddControlsOptions(joints=(joint,), frame="joint"), report=report)
    reader = AddPosereaderOptions(
        driver=joint, axis=(0, 1, 0), target=(SIDE,), morph=(("side", mesh, "bulge"),), name="reader"
    )
    rig = add_posereader(rig, options=reader, report=report)
    return add_rivet(rig, options=AddRivetOptions(mesh=mesh, triangle=(0,), name=("button",)), report=report)


def turned(rig: Rig, joint: str) -> Rig:
    """The control of the joint turns by half a right angle, at other times than the joint did."""
    control = next(n for n, note in rig.metadata.items() if note.get("type") == "control")
    assert rig.metadata[control]["joint"] == joint
    times = np.array([0.0, 0.5, 1.0]) * rig.rules.per_second
    values = np.stack([from_axis_angle([0.0, 0.0, 1.0], angle) for angle in (0.0, 0.5, 0.8)])
    values = values.astype(np.float32).astype(np.float64)
    first = rig.clips[0]
    track = Track(control, "rotation", "LINEAR", times, values)
    return replace(rig, clips=(replace(first, tracks=(*first.tracks, track)), *rig.clips[1:]))


def off_surface(rig: Rig, clip: Clip, times: Floats) -> float:
    """How far the rivet is from the middle of its triangle, by the plain evaluation."""
    node = rig.find("button", "node")
    mesh = next(m for m in rig.meshes if m.name.startswith("Skin") or "Skin" in m.name)
    world = sampling.worlds(rig, sampling.locals_at(rig, clip, times))
    points = skinning.deformed(mesh, rig, world, sampling.morph_weights(mesh, clip, times))
    middle = points[:, np.array(rig.metadata[node]["vertices"], dtype=np.int64)].mean(axis=1)
    return float(np.linalg.norm(world[:, node, 3, :3] - middle, axis=-1).max())


@pytest.mark.parametrize("kind", ["glb", slow("usda")])
def test_rivets_and_readers_follow_what_controls_make_of_the_joints(kind: str, tmp_path: Path) -> None:
    source, joint, mesh = source_of(kind, tmp_path)
    ready, once, twice = (tmp_path / f"{name}.{kind}" for name in ("ready", "once", "twice"))
    edit(source, ready, lambda rig, report: turned(built(rig, joint, mesh, report), joint))
    edit(ready, once, lambda rig, report: bake(rig, options=BakeOptions(), report=report))
    edit(once, twice, lambda rig, report: bake(rig, options=BakeOptions(), report=report))
    assert once.read_bytes() == twice.read_bytes()
    rig = read(once).rig
    clip = timelines(rig)[0].clip
    times = np.linspace(0.0, 1.0, 9) * rig.rules.per_second
    assert off_surface(rig, clip, times) < 3e-5
    weights = next(t for t in clip.tracks if t.path == "weights")
    plain = read(source).rig
    at_rest = plain.world[plain.find(joint)]
    for time, angle in ((0.0, 0.0), (0.5, 0.5), (1.0, 0.8)):
        axis = np.array([0.0, 1.0, 0.0]) @ at_rest[:3, :3]
        cosine = max(0.0, float(np.sin(angle) * axis[1] + np.cos(angle) * -axis[0]))
        assert_allclose(sampling.sample(weights, [time * rig.rules.per_second])[0, 0], cosine, atol=2e-4)


def test_what_is_constrained_to_a_rivet_follows_where_the_rivet_comes_to(tmp_path: Path) -> None:
    source, joint, mesh = source_of("glb", tmp_path)
    rig = built(read(source).rig, joint, mesh, Report())
    rig = constrain(
        rig, options=ConstrainOptions(type="parent", child="pin", driver=(("button", 1.0),)), report=Report()
    )
    before = rig.world[rig.find("pin")] @ np.linalg.inv(rig.world[rig.find("button", "node")])
    baked = bake(turned(rig, joint), options=BakeOptions())
    clip = baked.clips[0]
    times = np.linspace(0.0, 1.0, 9)
    world = sampling.worlds(baked, sampling.locals_at(baked, clip, times))
    pin, button = baked.find("pin"), baked.find("button", "node")
    assert np.abs(world[:, button] - world[0, button]).max() > 0.1
    assert_allclose(world[:, pin], before @ world[:, button], atol=1e-3)  # between keys: both are thinned
    keys = next(t for t in clip.tracks if t.node == pin).times
    world = sampling.worlds(baked, sampling.locals_at(baked, clip, keys))
    assert_allclose(world[:, pin], before @ world[:, button], atol=5e-5)


def test_a_joint_that_follows_a_rivet_on_its_own_mesh_is_a_circle(tmp_path: Path) -> None:
    source, joint, mesh = source_of("glb", tmp_path)
    rig = built(read(source).rig, joint, mesh, Report())
    rig = constrain(
        rig,
        options=ConstrainOptions(
            type="point", child="upper", driver=(("button", 1.0),), maintain_offset=False
        ),
        report=Report(),
    )
    with pytest.raises(GeometryError, match=r"cycle.*'button' → 'upper' → 'button'"):
        bake(turned(rig, joint), options=BakeOptions())


@pytest.mark.slow
def test_what_follows_a_rivet_on_a_mesh_that_controls_spin_is_no_circle(tmp_path: Path) -> None:
    """The joint's keys were given to its control: each pass finds fewer of them, at other times."""
    source, joint, mesh = source_of("glb", tmp_path)
    ready, once, twice = (tmp_path / f"{name}.glb" for name in ("ready", "once", "twice"))
    rest = read(source).rig.rotation[read(source).rig.find(joint)]
    times = np.linspace(0.0, 2.0, 9)
    turns = np.stack([multiply(rest, from_axis_angle([0.0, 0.0, 1.0], 0.9 * time)) for time in times])
    turns = turns.astype(np.float32).astype(np.float64)

    def spinning(rig: Rig, report: Report) -> Rig:
        rig = built(rig, joint, mesh, report)
        track = Track(rig.find(joint), "rotation", "LINEAR", times, turns)
        rig = replace(rig, clips=(*rig.clips, Clip("spin", (track,))))
        pinned = ConstrainOptions(type="parent", child="pin", driver=(("button", 1.0),))
        rig = constrain(rig, options=pinned, report=report)
        return bake(rig, options=BakeOptions(to="controls"), report=report)

    edit(source, ready, spinning)
    edit(ready, once, lambda rig, report: bake(rig, options=BakeOptions(), report=report))
    edit(once, twice, lambda rig, report: bake(rig, options=BakeOptions(), report=report))
    assert once.read_bytes() == twice.read_bytes()
    rig = read(once).rig
    before = rig.world[rig.find("pin")] @ np.linalg.inv(rig.world[rig.find("button", "node")])
    spin = rig.clip("spin")
    keys = next(t for t in spin.tracks if t.node == rig.find("pin")).times
    world = sampling.worlds(rig, sampling.locals_at(rig, spin, keys))
    button = rig.find("button", "node")
    assert np.abs(world[:, button, 3, :3] - world[0, button, 3, :3]).max() > 0.5
    assert_allclose(world[:, rig.find("pin")], before @ world[:, button], atol=5e-5)


def test_a_rivet_whose_mesh_is_gone_keeps_its_keys_and_is_reported(tmp_path: Path) -> None:
    source, joint, mesh = source_of("glb", tmp_path)
    rig = turned(built(read(source).rig, joint, mesh, Report()), joint)
    rivet = rig.find("button", "node")
    rig = replace(rig, metadata={**rig.metadata, rivet: {**rig.metadata[rivet], "mesh": "Coat"}})
    report = Report()
    baked = bake(rig, options=BakeOptions(), report=report)
    assert [notice.code for notice in report.warnings] == ["follower-kept"]
    was = [t for t in rig.clips[0].tracks if t.node == rivet]
    assert [t for t in baked.clips[0].tracks if t.node == rivet] == was


@pytest.mark.ci
def test_the_seat_is_that_of_the_rivet_not_of_its_number(tmp_path: Path) -> None:
    source, joint, mesh = source_of("glb", tmp_path)
    rig = built(read(source).rig, joint, mesh, Report())
    node = rig.find("button", "node")
    note = dict(rig.metadata[node])
    baked = bake(turned(rig, joint), options=BakeOptions())
    assert dict(baked.metadata[node]) == note
    seat = SkinnedPoints(baked, baked.meshes[0], np.array(note["vertices"])).at_rest().mean(axis=0)
    assert_allclose(baked.world[node, 3, :3], seat, atol=1e-6)


def test_keys_of_a_corrective_joint_s_own_say_when_what_follows_it_jumps() -> None:
    """A reader scales it; that it turns at once in a clip is its own, and moves what is constrained to it."""
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0, 0))
    rig.parents[2] = 0
    times, turn = np.array([0.0, 0.5, 1.0]), np.radians([0.0, 90.0, 90.0])
    jump = Track(1, "rotation", "STEP", times, from_axis_angle([0, 0, 1], turn))
    swing = Track(0, "rotation", "LINEAR", times, from_axis_angle([0, 1, 0], turn))
    rig = replace(rig, clips=(Clip("clip", (jump, swing)),))
    grown = AddPosereaderOptions(
        driver="a", target=(Goal("bent", pose="clip@1"),), joint=(("bent", "b", "sx=2"),)
    )
    rig = add_posereader(rig, options=grown)
    rig = constrain(rig, options=ConstrainOptions(type="parent", child="c", driver=("b",)))
    report = Report()
    tracks = bake(rig, options=BakeOptions(), report=report).clips[0].tracks
    (found,) = (track for track in tracks if (track.node, track.path) == (2, "rotation"))
    assert 0.5 in found.times
    assert [warning.code for warning in report.warnings] == []


@pytest.mark.parametrize("sword", ["joint", "mesh", "bare", "control"])
def test_what_others_have_put_on_or_below_a_control_is_named_where_a_bake_would_move_it(
    tmp_path: Path, sword: str
) -> None:
    """A mesh, a joint, a bare node, or a mesh of the control itself, which moved without a word before."""
    built, path, out = (tmp_path / name for name in ("built.glb", "in.glb", "out.glb"))
    cli("add-controls", SAMPLES / "biped.glb", "-o", built, "--joints", "forearm_L", code=0)
    gltf, binary = glb_parts(built)
    (control,) = (node for node in gltf["nodes"] if node["name"] == "forearm_L_ctl")
    told, do = "'sword', which is not from rigtri, is a child of 'forearm_L_ctl'", "parent it to"
    if sword == "control":
        control["mesh"] = 0
        told, do = (
            "'forearm_L_ctl' shows a mesh, a camera or a light that is not from rigtri",
            "show this with",
        )
    else:
        control["children"] = [*control.get("children", []), len(gltf["nodes"])]
        gltf["nodes"].append({"name": "sword", "mesh": 0} if sword == "mesh" else {"name": "sword"})
    if sword == "joint":  # it holds what the head does
        (head,) = (k for k, node in enumerate(gltf["nodes"]) if node["name"] == "head")
        joints = gltf["skins"][0]["joints"]
        joints[joints.index(head)] = len(gltf["nodes"]) - 1
    path.write_bytes(glb_bytes(json.dumps(gltf).encode(), binary))
    printed = " ".join(cli("bake", path, "-o", out, "--to", "controls", code=5).stderr.split())
    assert f"{told}, and that would move otherwise in clip 'walk'" in printed
    assert f"{do} 'forearm_L'" in printed
    if sword == "control":
        printed = cli("add-controls", path, "-o", out, "--joints", "forearm_L", "--up", "z", code=5).stderr
        assert f"'forearm_L_ctl' would get another place, and {told}: that would move with it" in printed


@pytest.mark.parametrize(("far", "told"), [(0.05, False), (2.0, True)])
def test_what_follows_an_ik_end_that_its_limb_did_not_reach_is_told_of(far: float, told: bool) -> None:
    """Before, a locator of a real file was 0.014 of the size off at the next bake, without a word."""
    rig = read(SAMPLES / "biped.glb").rig
    rig = add_controls(rig, options=AddControlsOptions(whole_character=True), report=Report())
    rig = constrain(
        rig,
        options=ConstrainOptions(child="body", driver=("hand_L_ik_ctl",), type="point"),
        report=Report(),
    )
    goal = rig.find("hand_L_ik_ctl")
    value = rig.translation[[goal]] - [0.1 * far, far, 0.0]
    rig = replace(rig, clips=(Clip("reach", (Track(goal, "translation", "STEP", np.zeros(1), value),)),))
    report = Report()
    bake(bake(rig, options=BakeOptions(), report=Report()), options=BakeOptions(to="controls"), report=report)
    found = [notice.text for notice in report.warnings if notice.code == "followers-go-along"]
    assert bool(found) == told
    assert all(text.startswith("'body' will move otherwise in clip 'reach'") for text in found)


def test_a_corrective_joint_whose_control_has_keys_forms_no_circle_with_a_rivet() -> None:
    """Before, control and reader wrote its keys in turn, the same ones in each pass: "they form a cycle"."""
    rig = replace(read(SAMPLES / "biped.glb").rig, clips=())
    rig = add_controls(rig, options=AddControlsOptions(joints=("head", "hips", "toe_*")))
    grown = AddPosereaderOptions(
        driver="head", target=(Goal("up", (0.0, 1.0, 0.0)),), joint=(("up", "toe_L", "rz=20"),)
    )
    rig = add_posereader(rig, options=grown)
    rig = add_rivet(rig, options=AddRivetOptions(mesh="body", triangle=(0,), name=("button",)))
    rig = constrain(rig, options=ConstrainOptions(child="eyes", driver=(("button", 1.0),)))
    keys = from_axis_angle([0, 0, 1], np.radians([0.0, 30.0]))
    waved = (
        Track(rig.find(f"{n}_ctl"), "rotation", "LINEAR", np.array([0.0, 0.5]), keys)
        for n in ("hips", "toe_L")
    )
    rig = replace(rig, clips=(Clip("wave", tuple(waved)),))
    baked = bake(rig, options=BakeOptions())
    before = rig.world[rig.find("eyes")] @ np.linalg.inv(rig.world[rig.find("button", "node")])
    clip = baked.clips[0]
    times = np.array([0.0, 0.5])
    world = sampling.worlds(baked, sampling.locals_at(baked, clip, times))
    eyes, button = baked.find("eyes"), baked.find("button", "node")
    assert np.abs(world[:, eyes] - world[0, eyes]).max() > 0.01
    assert_allclose(world[:, eyes], before @ world[:, button], atol=5e-5)
