"""Values and materials of a stage as USD resolves them: samples, indices, connections, texture channels."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from convertible import png
from gltf_files import glb_json, glb_parts
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel

import rigtri
from rigtri.export.conversion.scene import Image
from rigtri.export.conversion.usd_material_reader import _is_grey, _is_rgb_of_8_bits

_TYPES = Sdf.ValueTypeNames


def _lost(outcome: Any) -> set[str]:
    return {n.text.removeprefix("not converted: ") for n in outcome.report.warnings if n.code == "lost"}


def _mesh(stage: Any, path: str) -> Any:
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    mesh.CreateFaceVertexCountsAttr([3])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2])
    return mesh


def _skinned(stage: Any) -> None:
    """A triangle that a joint moves, with indexed texture coordinates; and one of an indexed colour."""
    UsdSkel.Root.Define(stage, "/r")
    skeleton = UsdSkel.Skeleton.Define(stage, "/r/s")
    skeleton.CreateJointsAttr(["a"])
    for give in (skeleton.CreateBindTransformsAttr, skeleton.CreateRestTransformsAttr):
        give([Gf.Matrix4d(1.0)])
    skin = _mesh(stage, "/r/skin")
    binding = UsdSkel.BindingAPI.Apply(skin.GetPrim())
    binding.CreateSkeletonRel().SetTargets(["/r/s"])
    binding.CreateJointIndicesPrimvar(True, 1).Set([0])
    binding.CreateJointWeightsPrimvar(True, 1).Set([1.0])
    binding.CreateGeomBindTransformAttr(Gf.Matrix4d().SetTranslate((0, 2, 0)))
    coordinates = UsdGeom.PrimvarsAPI(skin).CreatePrimvar("st", _TYPES.TexCoord2fArray, "vertex")
    coordinates.Set([(0, 0), (1, 0)])
    coordinates.SetIndices([0, 1, 1])
    colour = UsdGeom.PrimvarsAPI(_mesh(stage, "/r/red")).CreatePrimvar("displayColor", _TYPES.Color3fArray)
    colour.Set([(0, 1, 0), (1, 0, 0)])
    colour.SetIndices([1])


def test_values_that_are_samples_alone_are_converted_as_defaults_are(tmp_path: Path) -> None:
    found = []
    for name in ("default", "samples"):
        (tmp_path / name).mkdir()
        stage = Usd.Stage.CreateNew(str(tmp_path / name / "in.usda"))
        _skinned(stage)
        for prim in stage.Traverse() if name == "samples" else ():
            for one in prim.GetAuthoredAttributes():
                value = one.Get()
                if one.GetVariability() == Sdf.VariabilityVarying and value is not None:
                    one.ClearDefault()
                    one.Set(value, 3.0)
        stage.Save()
        rigtri.convert(tmp_path / name / "in.usda", tmp_path / name / "out.glb")
        found.append(glb_parts(tmp_path / name / "out.glb"))
    assert found[0] == found[1]
    assert found[0][0]["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] == [1, 0, 0, 1]


def test_a_primvar_whose_indices_lead_nowhere_is_listed(tmp_path: Path) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / "in.usda"))
    coordinates = UsdGeom.PrimvarsAPI(_mesh(stage, "/m")).CreatePrimvar("st", _TYPES.TexCoord2fArray)
    coordinates.Set([(0, 0)])
    coordinates.SetIndices([7])
    stage.Save()
    outcome = rigtri.convert(tmp_path / "in.usda", tmp_path / "out.glb")
    assert "primvar st of mesh /m, whose indices and values do not fit" in _lost(outcome)


_MAP = (
    'def Shader "{name}" {{ uniform token info:id = "UsdUVTexture"\n asset inputs:file{file}\n {more}\n'
    " float2 inputs:st.connect = <{at}/uv.outputs:result>\n float3 outputs:rgb\n float outputs:r\n"
    " float outputs:g\n float outputs:b\n float outputs:a\n}}\n"
)
_RAW = 'token inputs:sourceColorSpace = "raw"\n '


def _map(name: str, file: str = " = @./rgb.png@", more: str = "", at: str = "/m/look") -> str:
    return _MAP.format(name=name, file=file, more=more, at=at)


def _look(folder: Path, inputs: str, body: str = "", interface: str = "") -> tuple[dict[str, Any], set[str]]:
    """The material of a triangle in glTF, and what is lost; images: rgb.png and grey.png."""
    grey = bytearray(png((9, 9, 9)))
    grey[25] = 0  # the colour type
    (folder / "rgb.png").write_bytes(png((255, 0, 0)))
    (folder / "grey.png").write_bytes(grey)
    reader = (
        'def Shader "uv" { uniform token info:id = "UsdPrimvarReader_float2"\n'
        ' string inputs:varname = "st"\n float2 outputs:result\n}\n'
    )
    (folder / "in.usda").write_text(
        '#usda 1.0\n( upAxis = "Y"\n metersPerUnit = 1 )\ndef Xform "m" {\n'
        'def Mesh "mesh" (prepend apiSchemas = ["MaterialBindingAPI"]) {\n'
        " int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0, 1, 2]\n"
        " point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n rel material:binding = </m/look>\n"
        ' texCoord2f[] primvars:st = [(0, 0), (1, 0), (0, 1)] ( interpolation = "vertex" )\n}\n'
        f'def Material "look" {{ token outputs:surface.connect = </m/look/s.outputs:surface>\n{interface}\n'
        f'def Shader "s" {{ uniform token info:id = "UsdPreviewSurface"\n{inputs}\n'
        f" token outputs:surface\n}}\n{reader}{body}\n}}\n}}\n"
    )
    outcome = rigtri.convert(folder / "in.usda", folder / "out.glb")
    (material,) = glb_json(folder / "out.glb")["materials"]
    return material, _lost(outcome)


@pytest.mark.parametrize(
    ("taken", "scale", "bias", "lost"),
    [
        ("normal = rgb", "2, 2, 2, 1", "-1, -1, -1, 0", False),
        ("normal = rgb", "1.4, 1.4, 2, 1", "-0.7, -0.7, -1, 0", False),
        ("normal = rgb", "2, -2, 2, 1", "-1, -1, -1, 0", True),
        ("occlusion = r", "0.25, 0, 0, 1", "0.75, 0.5, 0, 0", False),
        ("occlusion = r", "0.25, 0, 0, 1", "0.5, 0, 0, 0", True),
        ("diffuseColor = rgb", "1, 1, 1, 1", "0, 0, 0, 0.5", False),
        ("diffuseColor = rgb", "0.5, 0.5, 0.5, 1", "0.5, 0.5, 0.5, 0", True),
    ],
)
def test_a_bias_is_listed_where_gltf_has_none(
    taken: str, scale: str, bias: str, lost: bool, tmp_path: Path
) -> None:
    name, channel = taken.split(" = ")
    kind = "normal3f" if name == "normal" else "color3f" if channel == "rgb" else "float"
    more = f"float4 inputs:scale = ({scale})\n float4 inputs:bias = ({bias})"
    link = f"{kind} inputs:{name}.connect = </m/look/map.outputs:{channel}>"
    found = _look(tmp_path, link, _map("map", " = @./grey.png@", more))[1]
    assert ("inputs:bias (</m/look/map>)" in found) is lost


@pytest.mark.parametrize(
    ("taken", "space", "lost"),
    [
        ("diffuseColor = rgb", "raw", True),
        ("diffuseColor = rgb", "sRGB", False),
        ("roughness = g", "sRGB", True),
        ("roughness = g", "raw", False),
        ("roughness = g", "auto", True),
        ("roughness = g", None, True),  # which is auto
        ("diffuseColor = rgb", "auto", False),
        ("opacity = a", "auto", False),
    ],
)
def test_a_colour_space_is_listed_where_gltf_has_another(
    taken: str, space: str | None, lost: bool, tmp_path: Path
) -> None:
    """Before, colours came out darker or roughness other, without a word."""
    name, channel = taken.split(" = ")
    kind = "color3f" if channel == "rgb" else "float"
    link = f"{kind} inputs:{name}.connect = </m/look/map.outputs:{channel}>"
    said = "" if space is None else f'token inputs:sourceColorSpace = "{space}"'
    found = _look(tmp_path, link, _map("map", more=said))[1]
    shown = f"is {space}" if space in ("raw", "sRGB") else "is sRGB (sourceColorSpace auto, 8-bit RGB)"
    assert any(f"of material 'look' {shown}: glTF reads it as" in text for text in found) is lost


@pytest.mark.parametrize(
    ("content", "takes"),
    [
        (b"\x89PNG" + bytes(20) + b"\x08\x02", True),
        (b"\x89PNG" + bytes(20) + b"\x10\x02", False),  # 16 bits
        (b"\x89PNG" + bytes(20) + b"\x08\x06", True),
        (b"\x89PNG" + bytes(20) + b"\x04\x03", True),  # a palette
        (b"\x89PNG" + bytes(20) + b"\x08\x00", False),
        (b"\xff\xd8\xff\xc0\x00\x11\x08\x00\x01\x00\x01\x03", True),
        (b"\xff\xd8\xff\xc0\x00\x0b\x08\x00\x01\x00\x01\x01", False),
    ],
)
def test_auto_takes_three_colours_of_8_bits_for_srgb(content: bytes, takes: bool) -> None:
    assert _is_rgb_of_8_bits(Image("a", content)) is takes


def test_tiles_of_a_texture_are_listed_as_such(tmp_path: Path) -> None:
    (tmp_path / "skin.1001.png").write_bytes(png((255, 0, 0)))
    link = "color3f inputs:diffuseColor.connect = </m/look/map.outputs:rgb>"
    _, lost = _look(tmp_path, link, _map("map", " = @./skin.<UDIM>.png@"))
    assert "the texture './skin.<UDIM>.png': glTF has no UDIM tiles" in lost


def test_values_come_through_interfaces_of_materials(tmp_path: Path) -> None:
    material, lost = _look(
        tmp_path,
        "color3f inputs:diffuseColor.connect = </m/look.inputs:tint>\n"
        "float inputs:opacity.connect = </m/look.inputs:fade>",
        interface="color3f inputs:tint = (0.25, 0.5, 0.75)\n float inputs:fade = 0.5",
    )
    assert material["pbrMetallicRoughness"]["baseColorFactor"] == [0.25, 0.5, 0.75, 0.5]
    assert not lost


@pytest.mark.parametrize("way", ["interface", "node graph"])
def test_textures_come_through_interfaces_and_node_graphs(way: str, tmp_path: Path) -> None:
    if way == "interface":
        given = "</m/look/t.outputs:rgb>", _map("t", ".connect = </m/look.inputs:map>")
        interface = "asset inputs:map = @./rgb.png@"
    else:
        inside = _map("t", ".connect = </m/look/graph.inputs:map>")
        outside = "color3f outputs:c.connect = </m/look/graph/t.outputs:rgb>"
        body = f'def NodeGraph "graph" {{ asset inputs:map = @./rgb.png@\n {outside}\n{inside}\n}}\n'
        given, interface = ("</m/look/graph.outputs:c>", body), ""
    material, lost = _look(tmp_path, f"color3f inputs:diffuseColor.connect = {given[0]}", given[1], interface)
    assert material["pbrMetallicRoughness"]["baseColorTexture"] == {"index": 0}
    assert not lost


def test_an_interface_input_that_nothing_reads_is_listed(tmp_path: Path) -> None:
    _, lost = _look(tmp_path, "float inputs:ior = 1.4", interface="float inputs:dirt = 0.5")
    assert lost == {"inputs:dirt (</m/look>)"}


def test_roughness_and_metallic_share_a_texture_as_gltf_has_them(tmp_path: Path) -> None:
    rough = "float inputs:roughness.connect = </m/look/t.outputs:{}>\n"
    metal = "float inputs:metallic{}\n"
    linked = ".connect = </m/look/t.outputs:{}>"
    body = _map("t", more=_RAW + "float4 inputs:scale = (1, 0.5, 0.25, 1)")
    body += _map("other", " = @./grey.png@")
    for inputs, metallic, words in (
        (rough.format("g") + metal.format(linked.format("b")), 0.25, ""),
        (rough.format("g"), 0.0, ""),  # a texture of roughness makes nothing a metal
        (rough.format("g") + metal.format(" = 0.5"), 0.5, "metallic of material 'look' is 0.5 everywhere"),
        (rough.format("r"), 0.0, "that roughness of material 'look' is channel r of its texture"),
        (rough.format("g") + metal.format(linked.format("r")), 0.0, "the texture of metallic of material"),
        (metal.format(linked.format("b")), 0.0, "the texture of metallic of material"),
        (rough.format("r").replace("/t.", "/other."), 0.0, ""),  # grey: all channels are one
    ):
        material, lost = _look(tmp_path, inputs, body)
        assert material["pbrMetallicRoughness"]["metallicFactor"] == metallic
        assert [words in line for line in lost] == ([True] if words else [])
        (tmp_path / "out.glb").unlink()


@pytest.mark.parametrize(
    ("wrap", "change", "leaves"),
    [
        ("wrapS", "", False),  # the coordinates are those of the image's corners
        ("wrapS", "float2 inputs:translation = (0.25, 0)", True),
        ("wrapT", "float2 inputs:translation = (0.25, 0)", False),
        ("wrapS", "float inputs:rotation = 30", True),
        ("wrapT", "float inputs:rotation = 30", False),
        ("wrapT", "float inputs:rotation = -30", True),
    ],
)
def test_black_edges_are_listed_where_texture_coordinates_are_beside_them(
    wrap: str, change: str, leaves: bool, tmp_path: Path
) -> None:
    body = _map("t", more=f'token inputs:{wrap} = "black"')
    if change:
        body = body.replace("</m/look/uv.outputs:result>", "</m/look/move.outputs:result>")
        body += (
            f'def Shader "move" {{ uniform token info:id = "UsdTransform2d"\n {change}\n'
            " float2 inputs:in.connect = </m/look/uv.outputs:result>\n float2 outputs:result\n}\n"
        )
    _, lost = _look(tmp_path, "color3f inputs:diffuseColor.connect = </m/look/t.outputs:rgb>", body)
    assert lost == (
        {"that './rgb.png' is black beside its edges: its last texels go on"} if leaves else set()
    )


def test_what_textures_have_that_gltf_cannot_say_is_listed(tmp_path: Path) -> None:
    body = _map("gone", " = @./gone.png@") + _map("t", more='token inputs:wrapS = "black"')
    body += 'def Shader "noise" { uniform token info:id = "Noise"\n float3 outputs:rgb\n}\n'
    _, lost = _look(
        tmp_path,
        "float inputs:metallic.connect = </m/look/gone.outputs:b>\n"
        "color3f inputs:diffuseColor.connect = </m/look/t.outputs:rgb>\n"
        "float inputs:opacity.connect = </m/look/t.outputs:r>\n"
        "color3f inputs:emissiveColor.connect = </m/look/noise.outputs:rgb>",
        body,
    )
    assert lost == {
        "the texture './gone.png' is missing",
        "the texture of opacity of material 'look': glTF has it in alpha of the texture of colour",
        "that the texture of opacity of material 'look' is sRGB (sourceColorSpace auto, 8-bit RGB): "
        "glTF reads it as raw",
        "emissiveColor of material 'look', which </m/look/noise> gives",
        "prims of type Noise (</m/look/noise>)",
    }


_BEGIN, _TABLE = b"\xff\xd8", b"\xff\xe0\x00\x04ab"


@pytest.mark.parametrize(
    ("content", "grey"),
    [
        (_BEGIN + _TABLE + b"\xff\xc0\x00\x0b\x08\x00\x01\x00\x01\x01\x01\x11\x00", True),
        (_BEGIN + _TABLE + b"\xff\xc2\x00\x11\x08\x00\x01\x00\x01\x03\x01\x11\x00", False),
        (_BEGIN + b"\xff\xc0\x00\x0b\x08\x00\x01\x00\x01\x01", True),
        (_BEGIN + b"\xff\xc0\x00\x0b\x08\x00\x01\x00\x01", False),  # cut off before the channels
        (_BEGIN + b"\x00\xc0\x00\x0b\x08\x00\x01\x00\x01\x01", False),
        (_BEGIN + _TABLE, False),
        (b"\x89PNG" + bytes(21) + b"\x00", True),
        (b"\x89PNG" + bytes(21) + b"\x04", True),
        (b"\x89PNG" + bytes(21) + b"\x06", False),
    ],
)
def test_the_header_of_an_image_says_whether_it_is_grey(content: bytes, grey: bool) -> None:
    assert _is_grey(Image("a.jpg", content)) is grey


def test_a_clear_coat_has_its_textures(tmp_path: Path) -> None:
    link = (
        "float inputs:clearcoat.connect = </m/look/map.outputs:r>\n"
        "float inputs:clearcoatRoughness.connect = </m/look/map.outputs:g>"
    )
    more = 'float4 inputs:scale = (0.5, 0.25, 1, 1)\n token inputs:sourceColorSpace = "raw"'
    material, lost = _look(tmp_path, link, _map("map", " = @./rgb.png@", more))
    coat = material["extensions"]["KHR_materials_clearcoat"]
    assert (coat["clearcoatFactor"], coat["clearcoatRoughnessFactor"]) == (0.5, 0.25)
    assert (coat["clearcoatTexture"], coat["clearcoatRoughnessTexture"]) == ({"index": 0}, {"index": 0})
    assert not lost
