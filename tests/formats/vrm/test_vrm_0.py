"""VRM 0.x: zero rotations on every bone, as it demands, and nothing else."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from avatars import JOINTS, NODES, avatar_0
from gltf_files import glb_json
from numpy.testing import assert_allclose
from places import SAMPLES
from program import cli
from second_opinions import khronos_errors

import rigtri
from rigtri.errors import FileError, GeometryError, NameNotFoundError, UsageError
from rigtri.formats.gltf.document import GltfDocument
from rigtri.formats.json_values import Value
from rigtri.formats.vrm.bindings import Bindings
from rigtri.formats.vrm.scene_facts import read_facts
from rigtri.formats.vrm.vrm0 import read_vrm_0
from rigtri.frames.reframe import reframe
from rigtri.maths.quaternions import IDENTITY, unit
from rigtri.model.rig import Rig
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.report import Report
from rigtri.verification.compare.compare import verify

FLIP = np.diag([1.0, 1.0, -1.0])


run = partial(cli, "orient-joints")


def places(gltf: dict[str, Any], rig: Rig) -> np.ndarray:
    """Where VRM 0 vectors lie in the world, read without rigtri: node-local, z to the other side."""
    vrm, world = gltf["extensions"]["VRM"], rig.world
    found = [(vrm["firstPerson"]["firstPersonBone"], vrm["firstPerson"]["firstPersonBoneOffset"])]
    for group in vrm["secondaryAnimation"]["colliderGroups"]:
        found += [(group["node"], collider["offset"]) for collider in group["colliders"]]
    where = {key: k for k, key in enumerate(rig.keys)}
    return np.array(
        [
            np.append(FLIP @ [offset.get(axis, 0.0) for axis in "xyz"], 1) @ world[where[node]]
            for node, offset in found
        ]
    )


@pytest.mark.parametrize("option", ["--world", "--preset=vrm"])
def test_all_bones_get_zero_rotations_and_nothing_moves(option: str, tmp_path: Path) -> None:
    source, out = avatar_0(3).glb(tmp_path / "a.vrm"), tmp_path / "b.vrm"
    done = run(source, "-o", out, option)
    assert done.exit_code == 0, done.output
    before, after = GltfDocument.read(source), GltfDocument.read(out)
    bones = [NODES[name] for name in JOINTS if name != "hair_end"]
    assert_allclose(
        after.rig.world[bones, :3, :3], np.broadcast_to(np.eye(3), (len(bones), 3, 3)), atol=1e-12
    )
    assert_allclose(after.rig.rotation[bones], np.tile(IDENTITY, (len(bones), 1)), atol=1e-12)
    assert verify(before, after).passes(1e-6)
    assert_allclose(places(glb_json(out), after.rig), places(glb_json(source), before.rig), atol=1e-12)
    # They are other numbers now, so this was not for nothing; and z was turned to the other side.
    assert glb_json(source)["extensions"] != glb_json(out)["extensions"]


def test_offsets_by_hand(tmp_path: Path) -> None:
    """A quarter about Y takes the old x to −z; VRM 0 says z the other way round, so the offset's z is +."""
    builder = avatar_0(0)
    builder.gltf["nodes"][NODES["hips"]]["rotation"] = [0, np.sqrt(0.5), 0, np.sqrt(0.5)]
    offset = {"x": 0.25, "y": 0.5, "z": 0, "note": "kept"}
    colliders = [{"offset": offset, "radius": 0.1}]
    groups = builder.gltf["extensions"]["VRM"]["secondaryAnimation"]["colliderGroups"]
    groups[0]["colliders"] = colliders
    document = GltfDocument.read(builder.glb(tmp_path / "a.vrm"))
    out = tmp_path / "b.vrm"
    document.write(orient_joints(document.rig, options=OrientJointsOptions(world=True)), out, out)
    (written,) = glb_json(out)["extensions"]["VRM"]["secondaryAnimation"]["colliderGroups"][0]["colliders"]
    assert list(written["offset"]) == ["x", "y", "z", "note"]
    assert_allclose([written["offset"][axis] for axis in "xyz"], [0, 0.5, 0.25], atol=1e-12)


def test_a_second_run_changes_no_byte(tmp_path: Path) -> None:
    source, once, twice = avatar_0(4).glb(tmp_path / "a.vrm"), tmp_path / "b.vrm", tmp_path / "c.vrm"
    assert run(source, "-o", once, "--world").exit_code == 0
    assert run(once, "-o", twice, "--world").exit_code == 0
    assert once.read_bytes() == twice.read_bytes() != source.read_bytes()


def test_a_file_that_is_as_vrm_0_requires_it_stays_to_the_byte(tmp_path: Path) -> None:
    source, out = avatar_0(0).glb(tmp_path / "a.vrm"), tmp_path / "b.vrm"
    assert run(source, "-o", out, "--world").exit_code == 0
    assert out.read_bytes() == source.read_bytes()


def test_all_else_in_the_extension_is_what_it_was(tmp_path: Path) -> None:
    document = GltfDocument.read(avatar_0(5).glb(tmp_path / "a.vrm"))
    out = tmp_path / "b.vrm"
    document.write(orient_joints(document.rig, options=OrientJointsOptions(world=True)), out, out)
    before, after = (glb_json(path)["extensions"]["VRM"] for path in (tmp_path / "a.vrm", out))
    for vrm in (before, after):
        vrm["firstPerson"].pop("firstPersonBoneOffset")
        for group in vrm["secondaryAnimation"]["colliderGroups"]:
            for collider in group["colliders"]:
                collider.pop("offset")
    assert after == before
    # The mesh of the hand stands on a node of its own; expressions go by the mesh, not by the node.
    nodes = glb_json(out)["nodes"]
    assert "mesh" not in nodes[NODES["hand"]]
    assert nodes[-1] | {"rotation": 0} == {"name": "hand_payload", "mesh": 1, "rotation": 0}


def test_of_what_swings_only_what_shows_nothing_itself_is_turned(tmp_path: Path) -> None:
    """A node that is no joint would have to hand over the mesh that it shows; one without is a bone."""
    builder = avatar_0(3)
    nodes = builder.gltf["nodes"]
    number = len(nodes)
    turn = {"translation": [0, 0.1, 0], "rotation": [0.6, 0, 0, 0.8]}
    nodes += [{"name": "bow", "mesh": 1} | turn, {"name": "lock", "children": [number + 2]} | turn]
    nodes += [{"name": "lock_end", "translation": [0, 0.1, 0]}]
    nodes[NODES["hair"]]["children"] += [number, number + 1]
    rig = GltfDocument.read(builder.glb(tmp_path / "a.vrm")).rig
    after = orient_joints(rig, options=OrientJointsOptions(world=True))
    assert_allclose(after.world[number], rig.world[number], atol=1e-12)
    assert_allclose(after.world[number + 1, :3, :3], np.eye(3), atol=1e-12)


def test_the_end_of_a_swinging_chain_keeps_its_pose(tmp_path: Path) -> None:
    """Viewers hang it along its translation, which its parent sees: both turn alike."""
    rig = GltfDocument.read(avatar_0(6).glb(tmp_path / "a.vrm")).rig
    after = orient_joints(rig, options=OrientJointsOptions(world=True))
    end = NODES["hair_end"]
    tails = [r.translation[end] @ r.world[end, :3, :3] for r in (rig, after)]
    assert_allclose(tails[1], tails[0], atol=1e-12)


@pytest.mark.parametrize(
    "options",
    [
        OrientJointsOptions(),
        OrientJointsOptions(preset="blender"),
        OrientJointsOptions(world=True, offset=(0, 0, 90)),
        OrientJointsOptions(world=True, mirror="behavior"),
        OrientJointsOptions(frames={"rigtri": "frames", "v": 1, "joints": {}}),
    ],
)
def test_all_other_axes_are_refused_with_the_reason_and_what_to_do(
    options: OrientJointsOptions, tmp_path: Path
) -> None:
    rig = GltfDocument.read(avatar_0(1).glb(tmp_path / "a.vrm")).rig
    with pytest.raises(GeometryError, match=r"VRM 0.x forbids.*--preset vrm.*convert.*VRM 1.0"):
        orient_joints(rig, options=options)


def test_controls_are_mirrored_where_joints_keep_their_axes() -> None:
    plain = rigtri.read(SAMPLES / "tpose.glb")
    plain = replace(plain, rules=replace(plain.rules, orient_locked="VRM 0.x forbids rest rotations"))
    with pytest.raises(GeometryError, match="rest rotations, so the axes of no joint"):
        rigtri.mirror(plain)
    rig, report = rigtri.add_controls(plain, joints="upper_arm_L"), Report()
    out = rigtri.mirror(rig, report=report)
    assert [notice.code for notice in report.warnings] == ["not-mirrored"]
    assert "upper_arm_R_ctl" not in rig.names
    assert "upper_arm_R_ctl" in out.names
    assert (out.world[out.find("upper_arm_R")] == plain.world[plain.find("upper_arm_R")]).all()
    with pytest.raises(GeometryError, match="the axes of no joint are mirrored"):
        rigtri.mirror(rig, what="joints")


def test_a_name_that_is_not_there_is_reported_first(tmp_path: Path) -> None:
    rig = GltfDocument.read(avatar_0(1).glb(tmp_path / "a.vrm")).rig
    with pytest.raises(NameNotFoundError, match="Did you mean 'head'"):
        orient_joints(rig, options=OrientJointsOptions(joints=("haed",)))


@pytest.mark.parametrize(
    "options",
    [
        OrientJointsOptions(world=True, joints=("head",)),
        OrientJointsOptions(world=True, exclude=("head",)),
        OrientJointsOptions(world=True, root="hips"),
        OrientJointsOptions(world=True, pose="bind"),
    ],
)
def test_a_part_of_the_bones_is_a_mistake(options: OrientJointsOptions, tmp_path: Path) -> None:
    rig = GltfDocument.read(avatar_0(1).glb(tmp_path / "a.vrm")).rig
    with pytest.raises(UsageError, match=r"VRM 0.x forbids rest rotations"):
        orient_joints(rig, options=options)


def test_reoriented_nodes_above_the_bones_are_compensated_too(tmp_path: Path) -> None:
    """An armature that lies on its back: its bones can only be at zero when it is."""
    builder = avatar_0(2)
    builder.gltf["nodes"].append(
        {"name": "armature", "rotation": [-(0.5**0.5), 0, 0, 0.5**0.5], "children": [0]}
    )
    builder.gltf["scenes"][0]["nodes"][0] = len(builder.gltf["nodes"]) - 1
    rig = GltfDocument.read(builder.glb(tmp_path / "a.vrm")).rig
    after = orient_joints(rig, options=OrientJointsOptions(world=True))
    assert_allclose(after.rotation[after.find("armature", "node")], IDENTITY, atol=1e-12)
    assert_allclose(after.rotation[after.find("hips")], IDENTITY, atol=1e-12)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_real_character_that_another_program_reoriented_comes_back(
    assets: Path, seed: int, tmp_path: Path
) -> None:
    path, turned, out = assets / "vrm" / "Godette_v4.vrm", tmp_path / "turned.vrm", tmp_path / "out.vrm"
    document = GltfDocument.read(path)
    turns = unit(np.random.default_rng(seed).normal(size=(len(document.rig), 4)))
    turns[~document.rig.is_joint] = IDENTITY
    free = replace(document.rig, node_constraints=())
    document.write(reframe(free, turns), turned, turned)
    done = run(turned, "-o", out, "--world", "--report", tmp_path / "report.json")
    assert done.exit_code == 0, done.output
    before, after = GltfDocument.read(path), GltfDocument.read(out)
    bones = sorted(before.rig.rules.world_aligned - {c.node for c in before.rig.node_constraints})
    assert (after.rig.rotation[bones] == IDENTITY).all()
    assert_allclose(places(glb_json(out), after.rig), places(glb_json(path), before.rig), atol=1e-6)
    assert verify(before, after).passes(1e-6)
    assert json.loads((tmp_path / "report.json").read_text())["verification"]["deviation"] < 1e-6
    was, now = khronos_errors(turned, out)
    assert now <= was


def test_a_real_character_is_left_to_the_byte(assets: Path, tmp_path: Path) -> None:
    path, out = assets / "vrm" / "Godette_v4.vrm", tmp_path / "out.vrm"
    for axes in (["--world"], ["--preset", "vrm", "--overwrite"]):
        assert run(path, "-o", out, *axes).exit_code == 0
        assert out.read_bytes() == path.read_bytes()
    refused = run(path, "-o", tmp_path / "no.vrm")
    assert refused.exit_code == 5
    assert "--preset vrm" in refused.output


@pytest.mark.parametrize(
    ("place", "value", "words"),
    [
        (("firstPerson", "firstPersonBone"), 99, "no node 99"),
        (("firstPerson", "firstPersonBoneOffset"), [0, 0, 0], "an object should stand here"),
        (("firstPerson", "firstPersonBoneOffset"), {"x": "0"}, "3 numbers"),
        (("secondaryAnimation", "colliderGroups"), {}, "a list should stand here"),
        (("secondaryAnimation", "colliderGroups"), [{"node": 0, "colliders": [5]}], "an object"),
        (("secondaryAnimation", "boneGroups"), [{"bones": [1.5]}], "whole number"),
        (("secondaryAnimation", "boneGroups"), [{"bones": [400]}], "no node 400"),
        (("humanoid",), [], "an object should stand here"),
    ],
)
def test_broken_blocks_are_named(place: tuple[str, ...], value: object, words: str, tmp_path: Path) -> None:
    builder = avatar_0(1)
    holder = builder.gltf["extensions"]["VRM"]
    for key in place[:-1]:
        holder = holder[key]
    holder[place[-1]] = value
    with pytest.raises(FileError, match=words):
        GltfDocument.read(builder.glb(tmp_path / "a.vrm"))


def test_the_end_of_a_swinging_chain_hangs_along_its_translation_which_its_parent_sees() -> None:
    found = Bindings()
    swinging = {"secondaryAnimation": {"boneGroups": [{"bones": [1, -1]}]}}
    read_vrm_0(Value(swinging, "extensions.VRM"), [-1, 0, 1, 0], found)
    assert [(each.node, each.source) for each in found.constraints] == [(2, 1)]


@pytest.mark.parametrize("number", [0, 1])
def test_a_mesh_is_the_same_fact_under_another_number(number: int) -> None:
    """It is named by the node that shows it."""
    vrm = {"firstPerson": {"meshAnnotations": [{"mesh": number}]}}
    nodes = [{"mesh": number}, {"mesh": 1 - number}]
    facts, _ = read_facts({"nodes": nodes, "meshes": [{}, {}], "extensions": {"VRM": vrm}}, [4, 5], ())
    ((shown,),) = facts.values()
    assert (shown.node, shown.shows) == (4, True)
