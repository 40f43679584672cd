"""Indices of a glTF file: additions take none that leads nowhere, and removals move pointers along."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from gltf_files import Builder, small

from rigtri.errors import FileError
from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite
from rigtri.formats.gltf.references import take_out, used_views
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.pipeline.edit import edit


def test_whole_numbers_of_a_list_refer_to_something_and_nothing_else_does() -> None:
    found = used_views({"extensions": {"one": {"bufferViews": [2, 1.0, 0.5, "a", None, float("nan")]}}})
    assert sorted(map(repr, found)) == ["1", "2"]


def _to_mesh(builder: Builder) -> None:
    builder.gltf["nodes"][2]["mesh"] = 1


def _to_material(builder: Builder) -> None:
    builder.gltf["meshes"][0]["primitives"][0]["material"] = 0


def _to_accessor(builder: Builder) -> None:
    builder.gltf["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = len(builder.gltf["accessors"])


def _to_view(builder: Builder) -> None:
    builder.gltf["images"] = [{"mimeType": "image/png", "bufferView": len(builder.gltf["bufferViews"])}]


def _to_node(builder: Builder) -> None:
    annotations = [{"node": len(builder.gltf["nodes"]), "type": "auto"}]
    builder.gltf["extensions"] = {"VRMC_vrm": {"firstPerson": {"meshAnnotations": annotations}}}


@pytest.mark.parametrize("damage", [_to_node, _to_mesh, _to_material, _to_accessor, _to_view])
def test_what_is_added_does_not_take_an_index_that_led_nowhere(damage: Any, tmp_path: Path) -> None:
    builder = small()
    damage(builder)
    source, target = builder.glb(tmp_path / "in.glb"), tmp_path / "out.glb"
    options = AddControlsOptions(joints=("*",))
    with pytest.raises(FileError, match=r"is referred to, but is not in the file"):
        edit(source, target, lambda rig, report: add_controls(rig, options=options, report=report))
    assert not target.exists()


@pytest.mark.parametrize("materials", [{}, True, "x"])
def test_what_is_no_list_gets_no_entry(materials: object, tmp_path: Path) -> None:
    builder = small()
    builder.gltf["materials"] = materials
    source, target = builder.glb(tmp_path / "in.glb"), tmp_path / "out.glb"
    options = AddControlsOptions(joints=("*",))
    with pytest.raises(FileError, match="materials needs an entry"):
        edit(source, target, lambda rig, report: add_controls(rig, options=options, report=report))
    assert not target.exists()


def test_an_index_far_behind_the_end_is_left_alone(tmp_path: Path) -> None:
    builder = small()
    builder.gltf["nodes"][2]["mesh"] = 99
    source, target = builder.glb(tmp_path / "in.glb"), tmp_path / "out.glb"
    options = AddControlsOptions(joints=("joint 0",))
    edit(source, target, lambda rig, report: add_controls(rig, options=options, report=report))
    assert target.exists()


def test_pointers_count_entries_anew_as_indices_do() -> None:
    pointer = {"pointer": "/nodes/2/rotation", "other": "/nodes/2"}
    channel = {"target": {"path": "pointer", "extensions": {"KHR_animation_pointer": pointer}}}
    gltf = {"nodes": [{}, {}, {}, {"children": [2]}], "animations": [{"channels": [channel]}]}
    draft = CopyOnWrite(gltf)
    take_out(draft, "nodes", {1})
    moved = draft.gltf["animations"][0]["channels"][0]["target"]["extensions"]["KHR_animation_pointer"]
    assert moved == {"pointer": "/nodes/1/rotation", "other": "/nodes/2"}
    assert draft.gltf["nodes"][2] == {"children": [1]}


def test_materials_of_another_type_are_left_alone(tmp_path: Path) -> None:
    builder = small()
    builder.gltf["materials"] = 5
    source, target = builder.glb(tmp_path / "in.glb"), tmp_path / "out.glb"
    edit(source, target, lambda rig, report: orient_joints(rig, report=report))
    assert target.exists()
