"""What no pose tells: `verify` sees each fault, `self_check` those that need no mesh."""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import gltf_files
import numpy as np
import pytest
import usd_files
from places import SAMPLES
from program import cli

from rigtri.formats import read
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.verification.compare.compare import self_check, verify
from rigtri.verification.compare.scene_facts import compare_surfaces, flat

# glTF


def stage_set() -> gltf_files.Builder:
    """A skinned triangle with indices, normals, a material and a morph, a camera and a light."""
    b = gltf_files.small()
    primitive = b.gltf["meshes"][0]["primitives"][0]
    primitive["indices"] = b.accessor([0, 1, 2], "u2")
    primitive["attributes"]["NORMAL"] = b.accessor([[0, 0, 1]] * 3)
    primitive["material"] = 0
    primitive["targets"] = [{"POSITION": b.accessor(np.zeros((3, 3)))}]
    b.gltf["meshes"][0]["extras"] = {"targetNames": ["smile"]}
    primitive["attributes"]["TEXCOORD_0"] = b.accessor([[0, 0], [1, 0], [0, 1]])
    painted = {"baseColorFactor": [1, 1, 1, 1], "baseColorTexture": {"index": 0}}
    b.gltf["materials"] = [{"name": "skin", "pbrMetallicRoughness": painted}, {"name": "cloth"}]
    b.gltf["textures"], b.gltf["images"] = [{"source": 0}], [{"uri": "data:image/png;base64,AAAA"}]
    b.gltf["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]
    b.gltf["extensions"] = {
        "KHR_lights_punctual": {"lights": [{"type": "spot", "intensity": 4}]},
        "EXT_lights_image_based": {"lights": [_studio(3), _studio(4)]},
    }
    b.gltf["extensionsUsed"] = ["KHR_lights_punctual", "EXT_lights_image_based"]
    b.gltf["nodes"] += [
        {"name": "eye", "camera": 0},
        {"name": "lamp", "extensions": {"KHR_lights_punctual": {"light": 0}}},
    ]
    b.gltf["nodes"][3]["name"] = "body"
    b.gltf["scenes"] = [{"nodes": [0, 3, 4, 5]} | _lit(0), {"nodes": [0]}]
    return b


def _studio(intensity: float) -> dict[str, Any]:
    images = {"specularImageSize": 1, "specularImages": [[0] * 6]}
    return {"intensity": intensity, "irradianceCoefficients": [[1, 1, 1]] * 9, **images}


def _lit(number: int) -> dict[str, Any]:
    return {"extensions": {"EXT_lights_image_based": {"light": number}}}


def _lights(gltf: Any) -> Any:
    return gltf["extensions"]["KHR_lights_punctual"]["lights"]


def _primitive(gltf: Any) -> Any:
    return gltf["meshes"][0]["primitives"][0]


def test_what_shows_is_in_the_scenes_and_as_hidden_as_the_nodes_above_it(tmp_path: Path) -> None:
    b = stage_set()
    hidden = {"extensions": {"KHR_node_visibility": {"visible": False}}}
    b.gltf["nodes"] += [{"name": "off", "children": [4], **hidden}, {"name": "top", "children": [6, 5]}]
    b.gltf["extensionsUsed"].append("KHR_node_visibility")
    b.gltf |= {"scene": 1, "scenes": [{"nodes": [0, 3, 7]}, {"nodes": [0, 3]}]}
    document = read(b.glb(tmp_path / "in.glb"))
    rig, facts = document.rig, document.scene_facts().nodes
    seen = {name: facts[rig.find(name)] for name in ("body", "eye", "lamp")}
    assert {name: (fact["scenes"], fact["visibility"]) for name, fact in seen.items()} == {
        "body": (("scene #0", "the scene that is shown"), None),
        "eye": (("scene #0",), "hidden"),
        "lamp": (("scene #0",), None),
    }


# Each fault and the words it is told with; those behind an asterisk only by verify.
GLTF_FAULTS: dict[str, tuple[Callable[[Any], Any], str]] = {
    "out of its scene": (
        lambda g: g["scenes"][0]["nodes"].remove(3),
        "scenes of body is none, was the scene that is shown",
    ),
    "another scene shown": (
        lambda g: g.update(scene=1),
        "scenes of body is scene #0, was the scene that is shown",
    ),
    "hidden": (
        lambda g: g["nodes"][3].update(extensions={"KHR_node_visibility": {"visible": False}}),
        "visibility of body is hidden, was none",
    ),
    "another lens": (
        lambda g: g["cameras"][0]["perspective"].update(yfov=1.01),
        "camera perspective yfov of eye is 1.01, was 1",
    ),
    "another light": (lambda g: _lights(g)[0].update(intensity=5), "light intensity of lamp is 5, was 4"),
    "a light where none was": (
        lambda g: g["nodes"][1].update(extensions={"KHR_lights_punctual": {"light": 0}}),
        "light type of joint 1 is spot, was none",
    ),
    "other surroundings": (
        lambda g: g["scenes"][0].update(_lit(1)),
        "image-based light intensity of the scene that is shown is 4, was 3",
    ),
    "no surroundings": (
        lambda g: g["scenes"][0].pop("extensions"),
        "image-based light specularImageSize of the scene that is shown is none, was 1",
    ),
    "surroundings where none were": (
        lambda g: g["scenes"][1].update(_lit(1)),
        "image-based light intensity of scene #1 is 4, was none",
    ),
    "brighter surroundings": (
        lambda g: g["extensions"]["EXT_lights_image_based"]["lights"][0].update(intensity=5),
        "image-based light intensity of the scene that is shown is 5, was 3",
    ),
    "another colour of light": (
        lambda g: _lights(g)[0].update(color=[1, 0, 0]),
        "light color of lamp is 1, 0, 0, was none",
    ),
    "another material": (
        lambda g: _primitive(g).update(material=1),
        "material of primitive 0 of body is cloth, was skin",
    ),
    "no material": (lambda g: _primitive(g).pop("material"), "of body is none, was skin"),
    "*no normals": (
        lambda g: _primitive(g)["attributes"].pop("NORMAL"),
        "0 normals instead of 3: the normals of mesh body/0",
    ),
    "*no morph target": (
        lambda g: _primitive(g).pop("targets"),
        "0 morph targets instead of 1: the morph targets of mesh body/0",
    ),
    "*no texture coordinates": (
        lambda g: _primitive(g)["attributes"].pop("TEXCOORD_0"),
        "TEXCOORD_0, which is gone, of mesh body/0",
    ),
    "*another colour of a material": (
        lambda g: g["materials"][0]["pbrMetallicRoughness"].update(baseColorFactor=[1, 0, 0, 1]),
        "baseColorFactor of the material of primitive 0 of body is 1, 0, 0, 1, was 1, 1, 1, 1",
    ),
    "*another image": (
        lambda g: g["images"][0].update(uri="data:image/png;base64,AAAB"),
        "baseColorTexture image of the material of primitive 0 of body is",
    ),
    "*another way to blend": (
        lambda g: g["materials"][0].update(alphaMode="BLEND"),
        "alphaMode of the material of primitive 0 of body is BLEND, was OPAQUE",
    ),
    "*lines": (lambda g: _primitive(g).update(mode=3), "line strip instead of triangles: the faces"),
}


@pytest.mark.parametrize("name", GLTF_FAULTS)
def test_a_fault_that_no_pose_shows_is_seen_in_gltf(name: str, tmp_path: Path) -> None:
    fault, words = GLTF_FAULTS[name]
    before = read(stage_set().glb(tmp_path / "before.glb"))
    broken = stage_set()
    fault(broken.gltf)
    after = read(broken.glb(tmp_path / "after.glb"))
    result = verify(before, after)
    assert not result.passes()
    assert any(words in text for text in result.different), result.different
    assert words in result.describe(verbose=True)
    assert self_check(before, after).passes() == name.startswith("*")


def test_a_material_that_states_what_holds_anyway_is_the_same(tmp_path: Path) -> None:
    before = read(stage_set().glb(tmp_path / "before.glb"))
    stated = stage_set()
    painted = stated.gltf["materials"][0]["pbrMetallicRoughness"]
    painted |= {"metallicFactor": 1.0, "roughnessFactor": 1.0}
    painted["baseColorTexture"]["texCoord"] = 0
    stated.gltf["materials"][0] |= {"alphaMode": "OPAQUE", "doubleSided": False, "emissiveFactor": [0.0] * 3}
    stated.gltf["textures"][0]["sampler"] = 0
    stated.gltf["samplers"] = [{"wrapS": 10497}]
    assert verify(before, read(stated.glb(tmp_path / "stated.glb"))).passes()
    stated.gltf["samplers"] = [{"wrapS": 33071}]
    assert not verify(before, read(stated.glb(tmp_path / "other.glb"))).passes()


@pytest.mark.parametrize(
    ("shown", "words"),
    [
        ({"mesh": 0}, "more, which was not there, shows a mesh"),
        ({"extensions": {"KHR_lights_punctual": {"light": 0}}}, "more, which was not there, shows a light"),
        ({}, ""),
    ],
)
def test_a_node_that_shows_more_is_different(shown: dict[str, Any], words: str, tmp_path: Path) -> None:
    before = read(stage_set().glb(tmp_path / "before.glb"))
    other = stage_set()
    other.gltf["nodes"].append({"name": "more", **shown})
    other.gltf["scenes"][0]["nodes"].append(6)
    result = verify(before, read(other.glb(tmp_path / "after.glb")))
    assert result.different == ((words,) if words else ())


def test_a_light_that_states_what_holds_anyway_is_the_same(tmp_path: Path) -> None:
    before = read(stage_set().glb(tmp_path / "before.glb"))
    stated = stage_set()
    _lights(stated.gltf)[0] |= {"color": [1.0, 1.0, 1.0], "spot": {"innerConeAngle": 0.0}}
    assert verify(before, read(stated.glb(tmp_path / "stated.glb"))).passes()


def stored_data(at: float = 1.0, colour: float = 1.0, packed: bytes = b"abcd") -> gltf_files.Builder:
    """The stage set with instances, a colour that a clip drives, and a primitive that Draco has packed."""
    b = stage_set()
    lamp = b.gltf["nodes"][5]["extensions"]
    lamp["EXT_mesh_gpu_instancing"] = {"attributes": {"TRANSLATION": b.accessor([[0, 0, 0], [at, 0, 0]])}}
    driven = {"pointer": "/materials/0/pbrMetallicRoughness/baseColorFactor"}
    target = {"path": "pointer", "extensions": {"KHR_animation_pointer": driven}}
    sampler = {"input": b.accessor([0.0, 1.0]), "output": b.accessor([[1, 1, 1, 1], [colour, 0, 0, 1]])}
    b.gltf["animations"] = [
        {"name": "glow", "channels": [{"sampler": 0, "target": target}], "samplers": [sampler]}
    ]
    view = b.gltf["accessors"][b.accessor(list(packed), "u1")]["bufferView"]
    packed_primitive = {"bufferView": view, "attributes": {"POSITION": 0}}
    b.gltf["meshes"].append({"primitives": [{"attributes": {}, "extensions": {DRACO: packed_primitive}}]})
    b.gltf["nodes"].append({"name": "crate", "mesh": len(b.gltf["meshes"]) - 1})
    b.gltf["scenes"][0]["nodes"].append(6)
    b.gltf["extensionsUsed"] += ["EXT_mesh_gpu_instancing", "KHR_animation_pointer", DRACO]
    return b


DRACO = "KHR_draco_mesh_compression"


@pytest.mark.parametrize(
    ("other", "words"),
    [
        ({"at": 2.0}, "TRANSLATION of the instances of lamp is"),
        ({"colour": 0.5}, "/materials/0/pbrMetallicRoughness/baseColorFactor in clip 'glow' is"),
        ({"packed": b"abcx"}, "compressed data of primitive 0 of crate is"),
        ({}, ""),
    ],
)
def test_what_no_pose_is_made_of_is_compared_as_it_is_stored(
    other: dict[str, Any], words: str, tmp_path: Path
) -> None:
    before = read(stored_data().glb(tmp_path / "before.glb"))
    result = verify(before, read(stored_data(**other).glb(tmp_path / "after.glb")))
    assert result.passes() is not bool(words), result.different
    assert not words or any(text.startswith(words) for text in result.different), result.different


def test_stored_data_that_cannot_be_read_stops_no_comparison(tmp_path: Path) -> None:
    """What no pose is made of costs nothing: as nothing that is wrong with it costs an edit."""
    files = []
    for name, last in (("before", 1.0), ("after", 2.0)):
        damaged = stored_data(at=last)
        (clip,) = damaged.gltf["animations"]
        for number in (clip["samplers"][0]["output"], _instances(damaged.gltf)):
            views = {"bufferView": 0, "byteOffset": 2**33}
            sparse = {"count": 1, "indices": views | {"componentType": 5123}, "values": {"bufferView": 0}}
            damaged.gltf["accessors"][number]["sparse"] = sparse
        clip["channels"].append({"sampler": 0, "target": "head"})
        files.append(damaged.glb(tmp_path / f"{name}.glb"))
    assert verify(*map(read, files)).passes()


def _instances(gltf: dict[str, Any]) -> int:
    instancing = gltf["nodes"][5]["extensions"]["EXT_mesh_gpu_instancing"]
    return int(instancing["attributes"]["TRANSLATION"])


@pytest.mark.parametrize(
    ("rows", "kind", "key", "words"),
    [
        ([0, 2, 1], "u2", "indices", "2 of 3 corners of the faces"),
        ([0, 1, 2, 0, 2, 1], "u2", "indices", "6 corners instead of 3 corners"),
        ([[0, 0, 1], [0, 0, 1], [0, 0.6, 0.8]], "f4", "NORMAL", "the normals, by up to 0.6,"),
        ([[0, 0], [1, 0], [0, 0.5]], "f4", "TEXCOORD_0", "TEXCOORD_0, by up to 0.5,"),
        ([[1, 1, 1, 0.5]] * 3, "f4", "COLOR_0", "COLOR_0, which was not there,"),
    ],
)
def test_other_faces_and_normals_are_seen(rows: Any, kind: str, key: str, words: str, tmp_path: Path) -> None:
    before = read(stage_set().glb(tmp_path / "before.glb"))
    broken = stage_set()
    primitive = _primitive(broken.gltf)
    (primitive if key == "indices" else primitive["attributes"])[key] = broken.accessor(rows, kind)
    result = verify(before, read(broken.glb(tmp_path / "after.glb")))
    assert not result.passes()
    assert result.different[0].startswith(words)


def test_faces_and_normals_that_are_only_stored_otherwise_are_the_same(tmp_path: Path) -> None:
    before = read(stage_set().glb(tmp_path / "before.glb"))
    other = stage_set()
    primitive = _primitive(other.gltf)
    primitive["attributes"]["NORMAL"] = other.accessor([[0, 0, 127]] * 3, "i1", normalized=True)
    del primitive["indices"]
    other.gltf["cameras"][0]["perspective"]["znear"] = struct.unpack("<f", struct.pack("<f", 0.1))[0]
    result = verify(before, read(other.glb(tmp_path / "after.glb")))
    assert result.different == ()


@pytest.mark.parametrize(("off", "seen"), [(0.01, True), (1e-6, False)])
def test_offsets_of_a_morph_without_weight_are_compared(off: float, seen: bool, tmp_path: Path) -> None:
    before = read(stage_set().glb(tmp_path / "before.glb"))
    other = stage_set()
    offsets = other.accessor([[off, 0, 0], [0, 0, 0], [0, 0, 0]])
    _primitive(other.gltf)["targets"] = [{"POSITION": offsets}]
    result = verify(before, read(other.glb(tmp_path / "after.glb")))
    assert result.deviation == 0
    assert result.passes() == (not seen)
    assert [text.split(", ")[0] for text in result.different] == ["the offsets of morph target 0"] * seen


def test_names_of_morph_targets_do_not_show_and_are_reported(tmp_path: Path) -> None:
    before = read(stage_set().glb(tmp_path / "before.glb"))
    other = stage_set()
    other.gltf["meshes"][0]["extras"]["targetNames"] = ["frown"]
    result = verify(before, read(other.glb(tmp_path / "after.glb")))
    assert result.passes()
    assert result.changed == ("morph target names of body is frown, was smile",)


def test_a_camera_that_moved_to_a_node_of_its_own_keeps_its_lens(tmp_path: Path) -> None:
    b = stage_set()
    b.gltf["nodes"][1]["camera"] = 0
    before = read(b.glb(tmp_path / "before.glb"))
    rig = orient_joints(before.rig)
    before.write(rig, tmp_path / "after.glb", tmp_path / "after.glb")
    after = read(tmp_path / "after.glb")
    assert any(name.startswith("joint 1_payload") for name in after.rig.names)
    assert self_check(before, after).different == ()
    assert verify(before, after).different == ()


# USD

SCENE = """
def Camera "Eye"
{
    float focalLength = 50
}
def SphereLight "Lamp"
{
    float inputs:intensity = 3
}
def Material "Cloth"
{
}
def Material "Hide"
{
    def Shader "Paint"
    {
        float inputs:roughness = 0.5
        asset inputs:file = @./hide.png@
    }
}
"""
MESH = usd_files.MESH.replace(
    "int[] faceVertexCounts",
    'rel material:binding = </Root/Hide>\nuniform token purpose = "default"\ntoken visibility = "inherited"\n'
    'normal3f[] normals = [(0, 0, 1), (0, 0, 1), (0, 0, 1)] (interpolation = "vertex")\n'
    'uniform token orientation = "rightHanded"\n'
    'color3f[] primvars:displayColor = [(1, 0.5, 0)] (interpolation = "constant")\n'
    'texCoord2f[] primvars:st = [(0, 0), (1, 0), (0, 1)] (interpolation = "vertex")\n'
    "int[] faceVertexCounts",
)
HEAD = "metersPerUnit = 1\ntimeCodesPerSecond = 24\nstartTimeCode = 1\nendTimeCode = 5\n"
USD_FAULTS = {
    "invisible": ('visibility = "inherited"', 'visibility = "invisible"', "visibility of Skin is invisible"),
    "a guide": ('purpose = "default"', 'purpose = "guide"', "purpose of Skin"),
    "another material": ("</Root/Hide>", "</Root/Cloth>", "material of Skin"),
    "another lens": ("focalLength = 50", "focalLength = 51", "camera focalLength of Eye is 51, was 50"),
    "another light": ("intensity = 3", "intensity = 4", "light intensity of Lamp is 4, was 3"),
    "other units": ("metersPerUnit = 1", "metersPerUnit = 0.01", "metersPerUnit is 0.01, was 1"),
    "other speed": ("timeCodesPerSecond = 24", "timeCodesPerSecond = 30", "timeCodesPerSecond is 30, was 24"),
    "another up": ('upAxis = "Y"', 'upAxis = "Z"', "up axis is Z, was Y"),
    "*other faces": ("Indices = [0, 1, 2]", "Indices = [0, 2, 1]", "2 of 3 corners of the faces"),
    "*other normals": ("normals = [(0, 0, 1)", "normals = [(0, 0, -1)", "the normals, by up to 2,"),
    "*another colour": ("(1, 0.5, 0)", "(1, 0.75, 0)", "primvar displayColor, by up to 0.25, of mesh"),
    "*no colour": (
        "color3f[] primvars:displayColor",
        "color3f[] gone",
        "primvar displayColor, which is gone,",
    ),
    "*other texture coordinates": ("(0, 0), (1, 0)", "(0, 0), (0.5, 0)", "primvar st, by up to 0.5, of mesh"),
    "*another shader": (
        "roughness = 0.5",
        "roughness = 0.25",
        "inputs:roughness of the material of Skin is",
    ),
    "*another image": ("@./hide.png@", "@./fur.png@", "inputs:file of the material of Skin is fur.png"),
    "inside out": ('"rightHanded"', '"leftHanded"', "orientation of Skin is leftHanded, was rightHanded"),
}


def stage_text() -> str:
    return usd_files.scene(MESH, SCENE, usd_files.skeleton(), usd_files.animation(), head=HEAD)


@pytest.mark.parametrize("name", USD_FAULTS)
def test_a_fault_that_no_pose_shows_is_seen_in_usd(name: str, tmp_path: Path) -> None:
    old, new, words = USD_FAULTS[name]
    text = stage_text()
    assert text.count(old) >= 1
    before = read(usd_files.save(tmp_path, text, "before.usda"))
    after = read(usd_files.save(tmp_path, text.replace(old, new, 1), "after.usda"))
    assert verify(before, before).different == ()
    result = verify(before, after)
    assert not result.passes()
    assert any(words in text for text in result.different), result.different
    assert self_check(before, after).passes() == name.startswith("*")


def test_what_a_prim_above_hides_is_hidden(tmp_path: Path) -> None:
    text = stage_text()
    before = read(usd_files.save(tmp_path, text, "before.usda"))
    hidden = text.replace('def SkelRoot "Root"\n{', 'def SkelRoot "Root"\n{\ntoken visibility = "invisible"')
    result = verify(before, read(usd_files.save(tmp_path, hidden, "after.usda")))
    assert len([text for text in result.different if text.startswith("visibility")]) == 3


def test_another_range_of_time_does_not_show_and_is_reported(tmp_path: Path) -> None:
    text = stage_text()
    before = read(usd_files.save(tmp_path, text, "before.usda"))
    longer = text.replace("endTimeCode = 5", "endTimeCode = 9")
    result = verify(before, read(usd_files.save(tmp_path, longer, "after.usda")))
    assert result.passes()
    assert result.changed == ("end time code is 9, was 5",)


def test_facts_of_two_formats_are_not_compared(samples: Path) -> None:
    assert verify(read(samples / "biped.glb"), read(samples / "biped.usda")).different == ()


def test_the_program_ends_with_6_and_reports_what_is_different(tmp_path: Path) -> None:
    stage_set().glb(tmp_path / "before.glb")
    broken = stage_set()
    broken.gltf["scenes"][0]["nodes"].remove(3)
    broken.glb(tmp_path / "after.glb")
    run = cli("verify", tmp_path / "before.glb", tmp_path / "after.glb", code=6)
    assert "different   scenes of body" in run.stdout
    assert "different: scenes of body" in run.stderr


def test_what_is_nested_is_reported_by_its_path() -> None:
    assert dict(flat({"a": {"b": 1, "name": "x"}}, "camera")) == {"camera a b": 1}


def test_a_surface_that_nobody_can_tell_differs_from_none() -> None:
    mesh = read(SAMPLES / "biped.glb").meshes()[0]
    unknown = replace(mesh, surface=None)
    assert compare_surfaces([(unknown, mesh), (mesh, unknown)], str) == []


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ('def Sphere "More" {}', "More, which was not there, shows a mesh"),
        ('def DomeLight "More" {}', "More, which was not there, shows a light"),
        ('def Sphere "More" {\ntoken visibility = "invisible"\n}', ""),
        ('def Xform "More" {}', ""),
    ],
    ids=["drawn", "light", "invisible", "nothing"],
)
def test_a_prim_that_shows_more_is_different(more: str, words: str, tmp_path: Path) -> None:
    text = stage_text()
    before = read(usd_files.save(tmp_path, text, "before.usda"))
    after = read(
        usd_files.save(tmp_path, text.replace('def Camera "Eye"', f'{more}\ndef Camera "Eye"'), "after.usda")
    )
    assert verify(before, after).different == ((words,) if words else ())
