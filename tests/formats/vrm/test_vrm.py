"""What VRM, VRMA and node constraints bind to nodes follows them, or holds them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from avatars import NODES, avatar
from gltf_files import Builder, glb_json, small
from vrm_files import vrm_0, vrm_1

from rigtri.errors import FileError
from rigtri.formats.gltf.document import GltfDocument
from rigtri.frames.reframe import reframe
from rigtri.frames.rescale import rescale
from rigtri.maths import vectors
from rigtri.maths.quaternions import IDENTITY, unit
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.report import Report

QUARTER = unit([0.0, 0.0, 1.0, 1.0])  # about Z: X goes to Y


def opened(builder: Builder, folder: Path) -> GltfDocument:
    return GltfDocument.read(builder.glb(folder / "a.vrm"))


def test_vrm_1_names_bones_and_looks_along_z(tmp_path: Path) -> None:
    rig = opened(vrm_1(), tmp_path).rig
    assert rig.humanoid == {"hips": 0, "head": 1}
    assert rig.rules.facing == (0.0, 0.0, 1.0)
    assert rig.rules.fixed == {}
    assert rig.find("vrm:head") == 1


def test_vrm_1_offsets_stay_where_they_are_in_the_world(tmp_path: Path) -> None:
    document = opened(vrm_1(), tmp_path)
    turn = unit(np.random.default_rng(2).normal(size=(4, 4)))
    document.write(reframe(document.rig, turn), tmp_path / "b.vrm", tmp_path / "b.vrm")
    after = GltfDocument.read(tmp_path / "b.vrm").rig
    assert len(after.bound) == 6
    for old, new in zip(document.rig.bound, after.bound, strict=True):
        before = np.append(old.vector, 1) @ document.rig.world[old.node]
        np.testing.assert_allclose(np.append(new.vector, 1) @ after.world[new.node], before, atol=1e-12)


def test_in_another_size_of_nodes_vectors_are_as_long_in_the_world_and_normals_of_length_one(
    tmp_path: Path,
) -> None:
    rig = opened(avatar(1), tmp_path).rig
    half = rescale(rig, np.full(len(rig.names), 0.5))
    assert [vectors.length(one.vector) for one in half.bound if one.is_direction] == pytest.approx([1.0])
    for old, new in zip(rig.bound, half.bound, strict=True):
        if not old.is_direction:
            np.testing.assert_allclose(new.vector, 2.0 * old.vector)


def test_vrm_1_numbers_by_hand(tmp_path: Path) -> None:
    document = opened(vrm_1(), tmp_path)
    turn = np.tile(IDENTITY, (4, 1))
    turn[1] = QUARTER
    document.write(reframe(document.rig, turn), tmp_path / "b.vrm", tmp_path / "b.vrm")
    extensions = glb_json(tmp_path / "b.vrm")["extensions"]
    capsule, ball = extensions["VRMC_springBone"]["colliders"]
    # The new X axis points along the old Y, so what lay along X lies along −Y.
    np.testing.assert_allclose(capsule["shape"]["capsule"]["offset"], [0, -1, 0], atol=1e-15)
    np.testing.assert_allclose(capsule["shape"]["capsule"]["tail"], [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(ball["shape"]["sphere"]["offset"], [2, -1, 3], atol=1e-15)
    plane = ball["extensions"]["VRMC_springBone_extended_collider"]["shape"]["plane"]
    np.testing.assert_allclose(plane["offset"], [1, 0, 0], atol=1e-15)
    # The normal that was not written, Z, is the axis of the turn: it has not changed.
    assert "normal" not in plane
    look = extensions["VRMC_vrm"]["lookAt"]["offsetFromHeadBone"]
    np.testing.assert_allclose(look, [0.5, 0, 0], atol=1e-15)
    assert (
        extensions["VRMC_springBone"]["springs"] == vrm_1().gltf["extensions"]["VRMC_springBone"]["springs"]
    )


def test_vrm_1_expressions_follow_a_mesh_that_moves_to_another_node(tmp_path: Path) -> None:
    document = opened(vrm_1(), tmp_path)
    turn = np.tile(IDENTITY, (4, 1))
    turn[2] = QUARTER
    document.write(reframe(document.rig, turn), tmp_path / "b.vrm", tmp_path / "b.vrm")
    vrm = glb_json(tmp_path / "b.vrm")["extensions"]["VRMC_vrm"]
    assert vrm["expressions"]["preset"]["happy"]["morphTargetBinds"][0] == {"node": 4, "index": 0}
    assert vrm["expressions"]["custom"]["odd"]["morphTargetBinds"][0] == {"node": 3, "index": 0}
    assert vrm["firstPerson"]["meshAnnotations"] == [{"node": 4, "type": "both"}]
    assert vrm["humanoid"] == vrm_1().gltf["extensions"]["VRMC_vrm"]["humanoid"]


def test_no_joint_of_a_vrm_0_file_may_be_reoriented(tmp_path: Path) -> None:
    rig = opened(vrm_0(), tmp_path).rig
    assert rig.humanoid == {"head": 1}
    assert rig.rules.facing == (0.0, 0.0, -1.0)
    assert "VRM 0.x" in rig.rules.orient_locked


def test_vrma_data_nodes_and_their_parents_are_frozen(tmp_path: Path) -> None:
    builder = small(6)
    builder.gltf["extensions"] = {
        "VRMC_vrm_animation": {
            "humanoid": {"humanBones": {"head": {"node": 0}}},
            "expressions": {"preset": {"happy": {"node": 2}}, "custom": {}},
            "lookAt": {"node": 5, "offsetFromHeadBone": [0, 0, 1]},
        }
    }
    rig = opened(builder, tmp_path).rig
    assert sorted(rig.rules.fixed) == [1, 2, 4, 5]
    assert "expression 'happy'" in rig.rules.fixed[2]
    assert rig.humanoid == {"head": 0}
    assert [bound.node for bound in rig.bound] == [0]


def test_vrma_data_nodes_are_left_alone_with_a_notice_whoever_names_them(tmp_path: Path) -> None:
    builder = small(6)
    builder.gltf["extensions"] = {
        "VRMC_vrm_animation": {
            "humanoid": {"humanBones": {"hips": {"node": 0}, "head": {"node": 1}}},
            "expressions": {"preset": {"happy": {"node": 5}}},
        }
    }
    rig = opened(builder, tmp_path).rig
    report = Report()
    data = OrientJointsOptions(joints=("joint 5",))
    assert orient_joints(rig, options=data, report=report) is rig
    (notice,) = report.warnings
    assert notice.text == "skipped: joint 5: its translation is the weight of the expression 'happy' (VRMA)"
    with pytest.raises(FileError, match="At and below 'joint 5' there is no joint"):
        orient_joints(rig, options=OrientJointsOptions(root="joint 5"))
    both = OrientJointsOptions(preset="blender", joints=("joint 5", "joint 1"))
    after = orient_joints(rig, options=both)
    changed = np.flatnonzero((after.rotation != rig.rotation).any(axis=1))
    assert changed.tolist() == [1, 2]
    everything = orient_joints(rig, options=OrientJointsOptions(preset="blender", joints=("*",)))
    assert (everything.rotation[5] == rig.rotation[5]).all()
    assert (everything.translation[5] == rig.translation[5]).all()


@pytest.mark.parametrize("seed", range(4))
def test_all_that_swings_looks_and_collides_stays_where_it_is(seed: int, tmp_path: Path) -> None:
    source, out = avatar(seed).glb(tmp_path / "a.vrm"), tmp_path / "b.vrm"
    document = GltfDocument.read(source)
    document.write(orient_joints(document.rig), out, out)
    before, after = places(source), places(out)
    assert before.keys() == after.keys()
    for what, place in before.items():
        np.testing.assert_allclose(after[what], place, atol=1e-9, err_msg=what)
    # The collider of a node that is no joint has kept its numbers, its node has turned back.
    was, now = (glb_json(path)["extensions"]["VRMC_springBone"]["colliders"] for path in (source, out))
    assert now[3] == was[3]
    assert all(now[k]["shape"] != was[k]["shape"] for k in range(3))
    assert now[2]["extensions"] != was[2]["extensions"]


def places(path: Path) -> dict[str, np.ndarray]:
    """Where colliders, plane normals, spring joints, their tails and the look-at point are in the world."""
    extensions, rig = glb_json(path)["extensions"], GltfDocument.read(path).rig
    world, found = rig.world, {}
    row = {key: k for k, key in enumerate(rig.keys)}
    springs, vrm = extensions["VRMC_springBone"], extensions["VRMC_vrm"]
    for k, collider in enumerate(springs["colliders"]):
        holders = [collider, *collider.get("extensions", {}).values()]
        for n, (kind, shape) in enumerate(pair for h in holders for pair in h["shape"].items()):
            for key in ("offset", "tail", "normal"):
                if key in shape:
                    point = np.append(shape[key], key != "normal")
                    found[f"{k} {n} {kind} {key}"] = point @ world[row[collider["node"]]]
    for joint in springs["springs"][0]["joints"]:
        found[f"spring {joint['node']}"] = world[row[joint["node"]], 3]
    head = row[vrm["humanoid"]["humanBones"]["head"]["node"]]
    found["look at"] = np.append(vrm["lookAt"]["offsetFromHeadBone"], 1) @ world[head]
    return found


def test_what_shows_a_mesh_is_found_by_expressions_and_first_person(tmp_path: Path) -> None:
    source, out = avatar(1).glb(tmp_path / "a.vrm"), tmp_path / "b.vrm"
    document = GltfDocument.read(source)
    document.write(orient_joints(document.rig), out, out)
    gltf = glb_json(out)
    (shown,) = [k for k, node in enumerate(gltf["nodes"]) if node.get("name") == "hand_payload"]
    vrm = gltf["extensions"]["VRMC_vrm"]
    binds = [vrm["expressions"][kind][name] for kind, name in (("preset", "happy"), ("custom", "wink"))]
    assert [bind["morphTargetBinds"][0]["node"] for bind in binds] == [shown, shown]
    assert vrm["firstPerson"]["meshAnnotations"] == [{"node": shown, "type": "both"}]
    assert gltf["nodes"][shown]["mesh"] == 1


def test_a_reference_written_as_a_float_is_followed_and_true_is_none(tmp_path: Path) -> None:
    builder = avatar(1)
    vrm = builder.gltf["extensions"]["VRMC_vrm"]
    vrm["firstPerson"]["meshAnnotations"] = [{"node": float(NODES["hand"])}, {"node": True}, {"node": 999}]
    document, out = GltfDocument.read(builder.glb(tmp_path / "a.vrm")), tmp_path / "b.vrm"
    assert [notice.code for notice in document.warnings] == ["vrm-reference", "vrm-reference"]
    document.write(orient_joints(document.rig), out, out)
    shown, *others = glb_json(out)["extensions"]["VRMC_vrm"]["firstPerson"]["meshAnnotations"]
    assert glb_json(out)["nodes"][shown["node"]]["name"] == "hand_payload"
    assert others == [{"node": True}, {"node": 999}]


@pytest.mark.parametrize(
    ("extensions", "words"),
    [
        ({"VRMC_vrm": {"humanoid": {"humanBones": {"head": {"node": 99}}}}}, "humanBones.head.node.*99"),
        ({"VRMC_vrm": {"humanoid": []}}, "humanoid"),
        ({"VRM": {"humanoid": {"humanBones": [{"bone": 5, "node": 0}]}}}, "bone: a text"),
        ({"VRMC_springBone": {"colliders": [{"node": "0"}]}}, r"colliders\[0\].node"),
        (
            {"VRMC_springBone": {"colliders": [{"node": 0, "shape": {"sphere": {"offset": [1]}}}]}},
            "3 numbers",
        ),
    ],
)
def test_broken_extensions_are_named(extensions: dict[str, Any], words: str, tmp_path: Path) -> None:
    builder = small()
    builder.gltf["extensions"] = extensions
    with pytest.raises(FileError, match=words):
        opened(builder, tmp_path)
