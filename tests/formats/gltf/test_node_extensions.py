"""Extensions of nodes: those that hold nothing in the axes of a joint let it get new ones."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from gltf_files import Builder, small
from program import cli

from rigtri.formats.gltf.structure import _node_extensions, extension_in_axes

BODY = "KHR_physics_rigid_bodies"
FREE = [
    ("KHR_skeleton_bone", {}),
    ("KHR_skeleton_bone", {"connected": True, "mass": 2}),
    (BODY, {"motion": {"mass": 1, "isKinematic": True}}),
    ("OMI_physics_body", {"motion": {"type": "dynamic", "mass": 1}}),
    ("OMI_physics_body", {"type": "kinematic"}),
    ("OMI_personality", {"agent": "cat", "personality": "cheerful"}),
    ("OMI_link", {"uri": "https://example.org"}),
    ("KHR_node_visibility", {"visible": False}),
]
FROZEN = [
    ("KHR_skeleton_bone", {"length": 0.3}, "holds 'length' in its axes"),
    ("KHR_skeleton_bone", {"connected": True, "roll": 0.3}, "may hold 'roll' in its axes"),
    (BODY, {"motion": {"mass": 1, "centerOfMass": [0, 1, 0]}}, "holds 'motion.centerOfMass' in its axes"),
    (BODY, {"collider": {"geometry": {"shape": 0}}}, "holds 'collider' in its axes"),
    ("OMI_physics_body", {"trigger": {"shape": 0}}, "holds 'trigger' in its axes"),
    ("OMI_physics_shape", {"shape": 0}, "holds 'shape' in its axes"),
    ("OMI_seat", {"back": [0, 0, 0]}, "holds 'back' in its axes"),
    ("OMI_physics_gravity", {"type": "directional", "gravity": 9.8}, "holds 'type' in its axes"),
    ("OMI_physics_joint", {"constraints": [0]}, "holds 'constraints' in its axes"),
    ("OMI_physics_joint", {"joint": 0}, "holds 'joint' in its axes"),
    ("KHR_audio", {"emitter": 0}, "holds 'emitter' in its axes"),
    ("MSFT_audio_emitter", {"emitters": [0]}, "holds 'emitters' in its axes"),
    ("EXT_unheard_of", {}, "may hold directions in its axes; rigtri does not know it"),
]


def oriented(name: str, content: Any, folder: Path) -> dict[str, Any]:
    """What orient-joints reports of the root joint, which has an extension."""
    builder = small()
    builder.gltf["nodes"][0]["extensions"] = {name: content}
    builder.gltf["extensionsUsed"] = [name]
    builder.glb(path := folder / "in.glb")
    done = cli("orient-joints", path, "-o", folder / "out.glb", "--aim", "z", "--up", "x", "--json")
    assert done.exit_code == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


@pytest.mark.parametrize(("name", "content"), FREE, ids=str)
def test_a_joint_gets_new_axes_where_its_extension_holds_no_direction(
    name: str, content: Any, tmp_path: Path
) -> None:
    assert name not in json.dumps(oriented(name, content, tmp_path))


@pytest.mark.parametrize(("name", "content", "why"), FROZEN, ids=str)
def test_a_joint_keeps_its_axes_where_its_extension_holds_one_or_may(
    name: str, content: Any, why: str, tmp_path: Path
) -> None:
    assert f"its extension {name} {why}" in json.dumps(oriented(name, content, tmp_path))


@pytest.mark.parametrize("content", [None, 5, [], {"motion": 3}, {"motion": None}, "x"], ids=str)
def test_what_an_extension_holds_may_be_of_any_type(content: Any) -> None:
    assert extension_in_axes({"extensions": {BODY: content}}) == ("", "")


def test_every_known_extension_has_its_source() -> None:
    for name, known in _node_extensions().items():
        assert all(known[key] for key in ("keeps", "source")), name
        assert all(isinstance(path, str) for path in known["axes"])


def _records(builder: Builder, folder: Path) -> dict[str, Any]:
    """What orient-joints reports of each joint."""
    builder.glb(path := folder / "in.glb")
    done = cli("orient-joints", path, "-o", folder / "out.glb", "--aim", "z", "--up", "x", "--json", code=0)
    return {record["joint"]: record for record in done.json["joints"]}


@pytest.mark.parametrize(
    ("name", "content", "member"),
    [
        (BODY, {"joint": {"joint": 0, "connectedNode": 1}}, "joint.connectedNode"),
        ("OMI_physics_joint", {"joint": 0, "connectedNode": 1}, "connectedNode"),
    ],
)
def test_a_joint_keeps_its_axes_where_another_node_is_tied_to_it(
    name: str, content: Any, member: str, tmp_path: Path
) -> None:
    builder = small()
    builder.gltf["nodes"].append({"name": "pivot", "extensions": {name: content}})
    builder.gltf["extensionsUsed"] = [name]
    records = _records(builder, tmp_path)
    assert f"the extension {name} of node #4 measures by its axes: '{member}' names it" in json.dumps(
        records["joint 1"]
    )
    assert name not in json.dumps(records["joint 0"])


@pytest.mark.parametrize(
    ("pointer", "kept"),
    [
        ("/nodes/1/rotation", ["joint 0", "joint 1"]),
        ("/nodes/{index}/translation", ["joint 0", "joint 1", "joint 2"]),
        ("/nodes/99/rotation", []),
        ("/nodes/1/weights", []),
        ("/materials/1/rotation", []),
    ],
)
def test_joints_keep_their_axes_where_a_graph_addresses_their_transforms(
    pointer: str, kept: list[str], tmp_path: Path
) -> None:
    builder = small()
    graph = {"nodes": [{"declaration": 0, "configuration": {"pointer": {"value": [pointer]}}}]}
    builder.gltf["extensions"] = {"KHR_interactivity": {"graphs": [graph]}}
    builder.gltf["extensionsUsed"] = ["KHR_interactivity"]
    records = _records(builder, tmp_path)
    assert [name for name, record in records.items() if "KHR_interactivity" in json.dumps(record)] == kept


@pytest.mark.parametrize(
    ("section", "content", "why"),
    [
        ("", {"p": ["/nodes/1/rotation"]}, "addresses '/nodes/1/rotation'"),
        ("", {"ties": [{"connectedNode": 1}]}, "measures by its axes: 'connectedNode' names it"),
        ("nodes", {"joint": {"connectedNode": 1}}, "of node #3 measures by its axes"),
        ("scenes", {"p": "/nodes/1/rotation"}, "of scene #0 addresses"),
        ("skins", {"connectedNode": 1}, "of skin #0 measures"),
        ("meshes", {"p": "/nodes/1/translation"}, "of mesh #0 addresses"),
    ],
)
def test_a_joint_keeps_its_axes_where_an_extension_that_is_not_known_refers_to_them(
    section: str, content: Any, why: str, tmp_path: Path
) -> None:
    builder = small()
    holder = builder.gltf[section][-1] if section else builder.gltf
    holder["extensions"] = {"ACME_thing": content}
    builder.gltf["extensionsUsed"] = ["ACME_thing"]
    records = _records(builder, tmp_path)
    assert why in json.dumps(records["joint 1"])
    assert "ACME_thing" not in json.dumps(records["joint 2"])


@pytest.mark.parametrize(
    ("name", "options", "count"),
    [
        ("ACME_thing", (), 1),
        ("ACME_thing", ("--unknown-node-ext", "ignore"), 0),
        ("ACME_thing", ("--exclude", "*"), 0),
        ("KHR_materials_variants", (), 0),
        ("KHR_implicit_shapes", (), 0),
    ],
)
def test_an_extension_of_the_file_that_is_not_known_is_reported_where_joints_turn(
    name: str, options: tuple[str, ...], count: int, tmp_path: Path
) -> None:
    builder = small()
    builder.gltf["extensions"] = {name: {"attachments": [{"joint": 1, "offset": [1, 0, 0]}]}}
    builder.gltf["extensionsUsed"] = [name]
    builder.glb(path := tmp_path / "in.glb")
    words = ("--aim", "z", "--up", "x", "--json", *options)
    done = cli("orient-joints", path, "-o", tmp_path / "out.glb", *words, code=0)
    found = [w["text"] for w in done.json["warnings"] if w["code"] == "extension-axes"]
    assert len(found) == count
    assert all(f"The file has {name}, which rigtri does not know" in text for text in found)


@pytest.mark.parametrize(
    ("section", "content", "count"),
    [
        ("scenes", {"hand": 1}, 1),
        ("skins", {"ends": [{"bone": 1}]}, 1),
        ("meshes", {"bone": 1}, 1),
        ("nodes", {"bone": 1}, 1),
        ("nodes", {"level": 3}, 0),  # its own number
        ("meshes", {"scale": 0.5, "name": "1"}, 0),
        ("meshes", {"connectedNode": 1}, 0),  # which keeps its axes
    ],
)
def test_numbers_of_joints_in_extensions_that_are_not_known_are_reported(
    section: str, content: Any, count: int, tmp_path: Path
) -> None:
    """Before, those of nodes, scenes, skins and meshes were passed over in silence."""
    builder = small()
    builder.gltf[section][-1]["extensions"] = {"ACME_thing": content}
    builder.gltf["extensionsUsed"] = ["ACME_thing"]
    builder.glb(path := tmp_path / "in.glb")
    done = cli("orient-joints", path, "-o", tmp_path / "out.glb", "--aim", "z", "--up", "x", "--json", code=0)
    assert [w["code"] for w in done.json["warnings"]].count("extension-axes") == count


def test_freeze_reports_extensions_that_are_not_known(tmp_path: Path) -> None:
    builder = small()
    builder.gltf["extensions"] = {"ACME_thing": {"joint": 1}}
    builder.gltf["extensionsUsed"] = ["ACME_thing"]
    builder.gltf["nodes"][builder.gltf["scenes"][0]["nodes"][0]]["scale"] = [0.5, 0.5, 0.5]
    builder.glb(path := tmp_path / "in.glb")
    done = cli("freeze", path, "-o", tmp_path / "out.glb", "--json", code=0)
    assert "extension-axes" in [w["code"] for w in done.json["warnings"]]
