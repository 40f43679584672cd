"""What VRM, VRMA and node constraints bind to nodes follows them, or holds them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import Builder, glb_json, small

from rigtri.errors import FileError
from rigtri.formats.gltf.document import GltfDocument
from rigtri.pose import worlds
from rigtri.quaternions import IDENTITY, unit
from rigtri.reframe import reframe

QUARTER = unit([0.0, 0.0, 1.0, 1.0])  # about Z: X goes to Y


def opened(builder: Builder, folder: Path) -> GltfDocument:
    return GltfDocument.read(builder.glb(folder / "a.vrm"))


def vrm_1() -> Builder:
    """Joint 1 is the head and has colliders; joint 2 shows a mesh that expressions refer to."""
    builder = small()
    builder.gltf["nodes"][2] |= {"mesh": 0}
    sphere = {"sphere": {"offset": [1, 2, 3], "radius": 0.1}}
    extended = {"plane": {"offset": [0, 1, 0]}}
    builder.gltf |= {
        "extensionsUsed": ["VRMC_vrm", "VRMC_springBone"],
        "extensions": {
            "VRMC_vrm": {
                "specVersion": "1.0",
                "humanoid": {"humanBones": {"hips": {"node": 0}, "head": {"node": 1}}},
                "lookAt": {"offsetFromHeadBone": [0, 0.5, 0]},
                "expressions": {
                    "preset": {"happy": {"morphTargetBinds": [{"node": 2, "index": 0}]}},
                    "custom": {"odd": {"morphTargetBinds": [{"node": 3, "index": 0}]}},
                },
                "firstPerson": {"meshAnnotations": [{"node": 2, "type": "both"}]},
            },
            "VRMC_springBone": {
                "colliders": [
                    {"node": 1, "shape": {"capsule": {"offset": [1, 0, 0], "tail": [0, 0, 1]}}},
                    {
                        "node": 1,
                        "shape": sphere,
                        "extensions": {"VRMC_springBone_extended_collider": {"shape": extended}},
                    },
                ],
                "springs": [{"joints": [{"node": 0, "gravityDir": [0, -1, 0]}]}],
            },
        },
    }
    return builder


def vrm_0() -> Builder:
    builder = small(5)
    builder.gltf |= {
        "extensionsUsed": ["VRM"],
        "extensions": {
            "VRM": {
                "humanoid": {"humanBones": [{"bone": "head", "node": 1}, {"bone": "jaw", "node": -1}]},
                "firstPerson": {"firstPersonBone": 1, "meshAnnotations": [{"mesh": 0}]},
                "secondaryAnimation": {
                    "boneGroups": [{"bones": [3]}],
                    "colliderGroups": [{"node": 1, "colliders": []}],
                },
            }
        },
    }
    return builder


def test_vrm_1_names_bones_and_looks_along_z(tmp_path: Path) -> None:
    rig = opened(vrm_1(), tmp_path).rig
    assert rig.humanoid == {"hips": 0, "head": 1}
    assert rig.facing == (0.0, 0.0, 1.0)
    assert rig.fixed == {}
    assert rig.find("vrm:head") == 1


def test_vrm_1_offsets_stay_where_they_are_in_the_world(tmp_path: Path) -> None:
    document = opened(vrm_1(), tmp_path)
    turn = unit(np.random.default_rng(2).normal(size=(4, 4)))
    document.write(reframe(document.rig, turn), tmp_path / "b.vrm", tmp_path / "b.vrm")
    after = GltfDocument.read(tmp_path / "b.vrm").rig
    assert len(after.bound) == 6
    for old, new in zip(document.rig.bound, after.bound, strict=True):
        before = np.append(old.vector, 1) @ worlds(document.rig)[old.node]
        np.testing.assert_allclose(np.append(new.vector, 1) @ worlds(after)[new.node], before, atol=1e-12)


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


def test_no_joint_of_a_vrm_0_file_may_turn(tmp_path: Path) -> None:
    rig = opened(vrm_0(), tmp_path).rig
    assert rig.humanoid == {"head": 1}
    assert rig.facing == (0.0, 0.0, -1.0)
    assert "VRM 0.x" in rig.frozen


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
    assert sorted(rig.fixed) == [1, 2, 4, 5]
    assert "expression 'happy'" in rig.fixed[2]
    assert rig.humanoid == {"head": 0}
    assert [bound.node for bound in rig.bound] == [0]


@pytest.mark.parametrize(
    ("kind", "node", "source", "frozen"),
    [
        ("rotation", 3, 1, [1, 3]),
        ("aim", 3, 1, [3]),
        ("roll", 3, 1, [0, 2, 3]),
        ("roll", 5, 3, [5]),
    ],
)
def test_constraints_freeze_what_they_compare(
    kind: str, node: int, source: int, frozen: list[int], tmp_path: Path
) -> None:
    builder = small(5)
    builder.gltf["nodes"][5] = {"name": "twist"}
    builder.gltf["nodes"][2]["children"] = [3, 5]
    constraint = {"specVersion": "1.0", "constraint": {kind: {"source": source, "weight": 1}}}
    builder.gltf["nodes"][node]["extensions"] = {"VRMC_node_constraint": constraint}
    builder.gltf["scenes"] = []
    assert sorted(opened(builder, tmp_path).rig.fixed) == frozen


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
