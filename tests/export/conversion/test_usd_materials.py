"""Materials as networks of UsdPreviewSurface: inputs, channels and factors, and textures with v upwards."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from pxr import Usd, UsdShade
from rigs import chain

from rigtri.export.conversion.scene import Image, Material, Scene, Texture
from rigtri.export.conversion.usd_materials import MaterialWriter, flipped, primvar

SKIN = Texture(Image("skin.png", b""))


def written(material: Material, *, coloured: bool = False) -> tuple[Any, Scene]:
    stage, scene = Usd.Stage.CreateInMemory(), Scene(chain((0, 0, 0)), "scene")
    writer = MaterialWriter(stage, scene, lambda image: f"textures/{image.name}")
    prim = writer.write(material, "/m", coloured=coloured)
    assert prim.GetSurfaceOutput().GetConnectedSources()[0][0].source.GetPath() == "/m/Surface"
    return stage, scene


def inputs(stage: Any, path: str) -> dict[str, Any]:
    """Values, and for connections the prim and output that they come from."""
    found: dict[str, Any] = {}
    for one in UsdShade.Shader.Get(stage, path).GetInputs():
        sources = one.GetConnectedSources()[0]
        if sources:
            found[one.GetBaseName()] = f"{sources[0].source.GetPrim().GetName()}.{sources[0].sourceName}"
        else:
            value = one.Get()
            found[one.GetBaseName()] = (
                [*value] if hasattr(value, "__len__") and not isinstance(value, str) else value
            )
    return found


def surface(material: Material, *, coloured: bool = False) -> tuple[dict[str, Any], list[str]]:
    stage, scene = written(material, coloured=coloured)
    assert UsdShade.Shader.Get(stage, "/m/Surface").GetIdAttr().Get() == "UsdPreviewSurface"
    return inputs(stage, "/m/Surface"), scene.lost


PLAIN = {"diffuseColor": [1.0, 1.0, 1.0], "metallic": 1.0, "roughness": 1.0}


@pytest.mark.parametrize(
    ("values", "more"),
    [
        ({}, {}),
        ({"base": (0.25, 0.5, 0.75, 0.5)}, {"diffuseColor": [0.25, 0.5, 0.75]}),
        ({"base": (1.0, 1.0, 1.0, 0.5), "alpha": "BLEND"}, {"opacity": 0.5}),
        ({"alpha": "MASK", "cutoff": 0.25}, {"opacity": 1.0, "opacityThreshold": 0.25}),
        ({"metallic": 0.25, "roughness": 0.5}, {"metallic": 0.25, "roughness": 0.5}),
        ({"emissive": (0.5, 0.0, 2.0)}, {"emissiveColor": [0.5, 0.0, 2.0]}),
        ({"clearcoat": 0.5}, {"clearcoat": 0.5, "clearcoatRoughness": 0.0}),
        ({"clearcoat_roughness": 0.5}, {"clearcoat": 0.0, "clearcoatRoughness": 0.5}),
        ({"ior": 1.25}, {"ior": 1.25}),
    ],
)
def test_factors_are_inputs_of_the_surface(values: dict[str, Any], more: dict[str, Any]) -> None:
    assert surface(Material("m", **values)) == (PLAIN | more, [])


def test_an_unlit_material_emits_its_colour() -> None:
    material = Material("m", base=(0.25, 0.5, 0.75, 1.0), unlit=True, emissive=(9.0, 9.0, 9.0))
    found, lost = surface(material)
    assert found == PLAIN | {"diffuseColor": [0.0, 0.0, 0.0], "emissiveColor": [0.25, 0.5, 0.75]}
    assert lost == ["material 'm' is unlit: shown as light that it emits"]
    stage, _ = written(material)
    assert stage.GetPrimAtPath("/m").GetCustomDataByKey("unlit") is True
    assert written(Material("m"))[0].GetPrimAtPath("/m").GetCustomDataByKey("unlit") is None


def test_textures_are_read_channel_by_channel() -> None:
    names = ("base", "metal_rough", "normal", "occlusion", "emissive", "coat", "coat_rough")
    slots = dict.fromkeys(names, SKIN)
    coated = Material("m", textures=slots, alpha="BLEND", clearcoat=1.0)  # type: ignore[arg-type]
    found, lost = surface(coated)
    assert found == {
        "diffuseColor": "base.rgb",
        "opacity": "base.a",
        "metallic": "metal_rough.b",
        "roughness": "metal_rough.g",
        "normal": "normal.rgb",
        "occlusion": "occlusion.r",
        "emissiveColor": "emissive.rgb",
        "clearcoat": "coat.r",
        "clearcoatRoughness": "coat_rough.g",
    }
    assert not lost
    unlit, _ = surface(Material("m", textures=slots, unlit=True))  # type: ignore[arg-type]
    assert (unlit["emissiveColor"], unlit["diffuseColor"]) == ("base.rgb", [0.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("slot", "values", "scale", "bias"),
    [
        ("base", {"base": (0.1, 0.2, 0.3, 0.4)}, (0.1, 0.2, 0.3, 0.4), None),
        ("base", {}, None, None),
        ("metal_rough", {"metallic": 0.25, "roughness": 0.5}, (1.0, 0.5, 0.25, 1.0), None),
        ("emissive", {"emissive": (0.5, 2.0, 0.0)}, (0.5, 2.0, 0.0, 1.0), None),
        ("coat", {"clearcoat": 0.5}, (0.5, 0.5, 0.5, 1.0), None),
        ("coat_rough", {"clearcoat": 1.0, "clearcoat_roughness": 0.25}, (0.25, 0.25, 0.25, 1.0), None),
        ("normal", {"normal_scale": 0.5}, (1.0, 1.0, 2.0, 1.0), (-0.5, -0.5, -1.0, 0.0)),
        ("occlusion", {"occlusion_strength": 0.25}, (0.25, 0.25, 0.25, 1.0), (0.75, 0.75, 0.75, 0.0)),
    ],
)
def test_a_texture_is_multiplied_by_its_factors(
    slot: Any, values: dict[str, Any], scale: tuple[float, ...] | None, bias: tuple[float, ...] | None
) -> None:
    stage, _ = written(Material("m", textures={slot: SKIN}, **values))
    found = inputs(stage, f"/m/{slot}")
    for name, given in (("scale", scale), ("bias", bias)):
        assert (name in found) == (given is not None)
        if given is not None:
            assert_allclose(found[name], given, rtol=1e-6)
    assert found["sourceColorSpace"] == ("sRGB" if slot in ("base", "emissive") else "raw")
    assert (found["st"], found["wrapS"], found["wrapT"]) == (f"{slot}_st.result", "repeat", "repeat")
    file = UsdShade.Shader.Get(stage, f"/m/{slot}").GetInput("file").Get()
    assert file.path == "textures/skin.png"
    assert inputs(stage, f"/m/{slot}_st") == {"varname": "st"}


def test_a_transform_stands_between_coordinates_and_image() -> None:
    texture = Texture(SKIN.image, 3, ("clamp", "mirror"), (0.5, 0.25), np.pi / 6, (2.0, 3.0))
    stage, _ = written(Material("m", textures={"base": texture}))
    found = inputs(stage, "/m/base")
    assert (found["st"], found["wrapS"], found["wrapT"]) == ("base_transform.result", "clamp", "mirror")
    moved = inputs(stage, "/m/base_transform")
    assert moved["in"] == "base_st.result"
    assert moved["rotation"] == pytest.approx(30.0)
    assert_allclose(moved["scale"], [2.0, 3.0])
    assert_allclose(moved["translation"], [0.5 + 3.0 * 0.5, 1.0 - 0.25 - 3.0 * np.sqrt(0.75)], rtol=1e-6)
    assert inputs(stage, "/m/base_st") == {"varname": "st3"}


def test_a_flipped_transform_takes_the_same_texel() -> None:
    offset, rotation, scale = (0.3, -0.2), 0.7, (1.5, 0.4)

    def placed(u: float, v: float, offset: Any, rotation: float, scale: Any) -> tuple[float, float]:
        """KHR_texture_transform: translation · rotation · scale, which turns by −rotation in u and v."""
        x, y = u * scale[0], v * scale[1]
        c, s = np.cos(rotation), np.sin(rotation)
        return c * x + s * y + offset[0], c * y - s * x + offset[1]

    def upwards(u: float, v: float, offset: Any, rotation: float, scale: Any) -> tuple[float, float]:
        """UsdTransform2d: scale, turn counterclockwise, translate."""
        x, y = u * scale[0], v * scale[1]
        c, s = np.cos(rotation), np.sin(rotation)
        return c * x - s * y + offset[0], s * x + c * y + offset[1]

    there = flipped(offset, rotation, scale)
    for u, v in ((0.0, 0.0), (1.0, 0.0), (0.25, 0.75)):
        across, down = placed(u, v, offset, rotation, scale)
        assert_allclose(upwards(u, 1.0 - v, *there), (across, 1.0 - down), atol=1e-12)


TIMES = "vertex colours times texture or colour: USD shows the latter, and keeps displayColor"


def test_colours_of_points_are_shown_where_nothing_else_is() -> None:
    stage, scene = written(Material("m"), coloured=True)
    assert inputs(stage, "/m/Surface")["diffuseColor"] == "VertexColor.result"
    assert inputs(stage, "/m/VertexColor") == {"varname": "displayColor"}
    assert not scene.lost
    for values in ({"base": (0.5, 1.0, 1.0, 1.0)}, {"textures": {"base": SKIN}}):
        found, lost = surface(Material("m", **values), coloured=True)  # type: ignore[arg-type]
        assert found["diffuseColor"] in ([0.5, 1.0, 1.0], "base.rgb")
        assert lost == [f"material 'm': {TIMES}"]


@pytest.mark.parametrize("alpha", ["OPAQUE", "MASK", "BLEND"])
def test_opacities_of_points_are_shown_where_the_material_has_an_opacity(alpha: Any) -> None:
    stage, scene = written(Material("m", alpha=alpha), coloured=True)
    shown = inputs(stage, "/m/Surface")
    assert not scene.lost
    if alpha == "OPAQUE":
        assert "opacity" not in shown
    else:
        assert shown["opacity"] == "VertexOpacity.result"
        assert inputs(stage, "/m/VertexOpacity") == {"varname": "displayOpacity", "fallback": 1.0}
    assert surface(Material("m", alpha=alpha, base=(1, 1, 1, 0.5)), coloured=True)[1] == (
        [] if alpha == "OPAQUE" else [f"material 'm': {TIMES}"]
    )


def test_texture_coordinates_are_called_st() -> None:
    assert [primvar(number) for number in (0, 1, 2)] == ["st", "st1", "st2"]
