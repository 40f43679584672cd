"""Materials as networks of UsdPreviewSurface, and back.

USD's v runs upwards, glTF's downwards, so texture coordinates are written as (u, 1 − v) and transforms to
match. Source: UsdPreviewSurface specification 2.6; glTF 2.0 §3.9; KHR_texture_transform.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from pxr import Gf, Sdf, UsdShade

from rigtri.export.conversion.scene import Image, Material, Scene, Slot, Texture
from rigtri.maths.trigonometry import sin_cos

_TYPES = Sdf.ValueTypeNames
DEGREES = 180.0 / 3.141592653589793


def primvar(texcoord: int) -> str:
    """What texture coordinates are called: ``st``, as everywhere in USD, then ``st1`` and so on."""
    return f"st{texcoord}" if texcoord else "st"


class MaterialWriter:
    """Writes the materials of a scene below a prim. place: the asset path of an image."""

    def __init__(self, stage: Any, scene: Scene, place: Callable[[Image], str]) -> None:
        self._stage, self._scene, self._place = stage, scene, place

    def write(self, material: Material, path: str, *, coloured: bool) -> Any:
        """One material; coloured: meshes with it have colours of their own, ``displayColor``."""
        prim = UsdShade.Material.Define(self._stage, path)
        surface = self._shader(f"{path}/Surface", "UsdPreviewSurface")
        prim.CreateSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
        self._report_unsupported(material, coloured=coloured)
        readers = {slot: self._texture(path, slot, material) for slot in material.textures}
        self._colour(surface, material, readers, path, coloured=coloured)
        self._channels(surface, material, readers)
        if material.unlit:
            prim.GetPrim().SetCustomDataByKey("unlit", True)
        return prim

    def _report_unsupported(self, material: Material, *, coloured: bool) -> None:
        if material.unlit:
            self._scene.lose(f"material '{material.name}' is unlit: shown as light that it emits")
        shown = material.base[: 3 if material.alpha == "OPAQUE" else 4]
        if coloured and ("base" in material.textures or shown != (1.0,) * len(shown)):
            text = "vertex colours times texture or colour: USD shows the latter, and keeps displayColor"
            self._scene.lose(f"material '{material.name}': {text}")

    def _colour(
        self, surface: Any, material: Material, readers: dict[Slot, Any], path: str, *, coloured: bool
    ) -> None:
        name = "emissiveColor" if material.unlit else "diffuseColor"
        colour = surface.CreateInput(name, _TYPES.Color3f)
        if "base" in readers:
            colour.ConnectToSource(readers["base"].ConnectableAPI(), "rgb")
        elif coloured and material.base[:3] == (1.0, 1.0, 1.0):
            reader = self._primvar(f"{path}/VertexColor", "float3", "displayColor", _TYPES.Float3)
            colour.ConnectToSource(reader.ConnectableAPI(), "result")
        else:
            colour.Set(Gf.Vec3f(*material.base[:3]))
        if material.unlit:
            surface.CreateInput("diffuseColor", _TYPES.Color3f).Set(Gf.Vec3f(0.0))
        if material.alpha != "OPAQUE":
            opacity = surface.CreateInput("opacity", _TYPES.Float)
            if "base" in readers:
                opacity.ConnectToSource(readers["base"].ConnectableAPI(), "a")
            elif coloured and material.base == (1.0,) * 4:
                reader = self._primvar(f"{path}/VertexOpacity", "float", "displayOpacity", _TYPES.Float)
                reader.CreateInput("fallback", _TYPES.Float).Set(1.0)  # of colours without alpha
                opacity.ConnectToSource(reader.ConnectableAPI(), "result")
            else:
                opacity.Set(material.base[3])
        if material.alpha == "MASK":
            surface.CreateInput("opacityThreshold", _TYPES.Float).Set(material.cutoff)

    def _channels(self, surface: Any, material: Material, readers: dict[Slot, Any]) -> None:
        """What is a number or one channel of a texture, and normals and emission."""
        both = readers.get("metal_rough")
        for name, value, channel in (
            ("metallic", material.metallic, "b"),
            ("roughness", material.roughness, "g"),
        ):
            given = surface.CreateInput(name, _TYPES.Float)
            if both is None:
                given.Set(value)
            else:
                given.ConnectToSource(both.ConnectableAPI(), channel)
        if "normal" in readers:
            normal = surface.CreateInput("normal", _TYPES.Normal3f)
            normal.ConnectToSource(readers["normal"].ConnectableAPI(), "rgb")
        if "occlusion" in readers:
            occlusion = surface.CreateInput("occlusion", _TYPES.Float)
            occlusion.ConnectToSource(readers["occlusion"].ConnectableAPI(), "r")
        if not material.unlit and "emissive" in readers:
            emissive = surface.CreateInput("emissiveColor", _TYPES.Color3f)
            emissive.ConnectToSource(readers["emissive"].ConnectableAPI(), "rgb")
        elif not material.unlit and material.emissive != (0.0, 0.0, 0.0):
            surface.CreateInput("emissiveColor", _TYPES.Color3f).Set(Gf.Vec3f(*material.emissive))
        if material.ior != 1.5:
            surface.CreateInput("ior", _TYPES.Float).Set(material.ior)
        if material.clearcoat or material.clearcoat_roughness:
            self._coat(surface, material, readers)

    def _coat(self, surface: Any, material: Material, readers: dict[Slot, Any]) -> None:
        """The clear coat; both inputs, as USD's roughness is 0.01 where nothing is said."""
        coat: tuple[tuple[str, float, Slot, str], ...] = (
            ("clearcoat", material.clearcoat, "coat", "r"),
            ("clearcoatRoughness", material.clearcoat_roughness, "coat_rough", "g"),
        )
        for name, value, slot, channel in coat:
            given = surface.CreateInput(name, _TYPES.Float)
            if slot in readers:
                given.ConnectToSource(readers[slot].ConnectableAPI(), channel)
            else:
                given.Set(value)

    def _shader(self, path: str, kind: str) -> Any:
        shader = UsdShade.Shader.Define(self._stage, path)
        shader.CreateIdAttr(kind)
        return shader

    def _primvar(self, path: str, kind: str, name: str, type_name: Any) -> Any:
        """What reads a primvar of the mesh."""
        reader = self._shader(path, f"UsdPrimvarReader_{kind}")
        reader.CreateInput("varname", _TYPES.String).Set(name)
        reader.CreateOutput("result", type_name)
        return reader

    def _texture(self, path: str, slot: Slot, material: Material) -> Any:
        """An image on the surface, times its factor."""
        texture = material.textures[slot]
        coordinates = primvar(texture.texcoord)
        reader = self._primvar(f"{path}/{slot}_st", "float2", coordinates, _TYPES.Float2)
        if texture.is_transformed:
            reader = self._transform(f"{path}/{slot}_transform", texture, reader)
        image = self._shader(f"{path}/{slot}", "UsdUVTexture")
        image.CreateInput("file", _TYPES.Asset).Set(Sdf.AssetPath(self._place(texture.image)))
        image.CreateInput("st", _TYPES.Float2).ConnectToSource(reader.ConnectableAPI(), "result")
        for name, wrap in zip(("wrapS", "wrapT"), texture.wrap, strict=True):
            image.CreateInput(name, _TYPES.Token).Set(wrap)
        colour = "sRGB" if slot in ("base", "emissive") else "raw"
        image.CreateInput("sourceColorSpace", _TYPES.Token).Set(colour)
        scale, bias = _factors(slot, material)
        if scale != (1.0,) * 4:
            image.CreateInput("scale", _TYPES.Float4).Set(Gf.Vec4f(*scale))
        if bias != (0.0,) * 4:
            image.CreateInput("bias", _TYPES.Float4).Set(Gf.Vec4f(*bias))
        for name in ("r", "g", "b", "a"):
            image.CreateOutput(name, _TYPES.Float)
        image.CreateOutput("rgb", _TYPES.Float3)
        return image

    def _transform(self, path: str, texture: Texture, reader: Any) -> Any:
        shader = self._shader(path, "UsdTransform2d")
        shader.CreateInput("in", _TYPES.Float2).ConnectToSource(reader.ConnectableAPI(), "result")
        offset, rotation, scale = flipped(texture.offset, texture.rotation, texture.scale)
        shader.CreateInput("scale", _TYPES.Float2).Set(Gf.Vec2f(*scale))
        shader.CreateInput("rotation", _TYPES.Float).Set(rotation * DEGREES)
        shader.CreateInput("translation", _TYPES.Float2).Set(Gf.Vec2f(*offset))
        shader.CreateOutput("result", _TYPES.Float2)
        return shader


Pair = tuple[float, float]


def flipped(offset: Pair, rotation: float, scale: Pair) -> tuple[Pair, float, Pair]:
    """A texture's transform for coordinates with v upwards in place of downwards, or the other way round."""
    sine, cosine = (float(x) for x in sin_cos(np.array(rotation)))
    return (offset[0] + scale[1] * sine, 1.0 - offset[1] - scale[1] * cosine), rotation, scale


def _factors(slot: Slot, material: Material) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The scale and bias of a texture's four channels."""
    none = (0.0,) * 4
    if slot == "base":
        return material.base, none
    if slot == "metal_rough":
        return (1.0, material.roughness, material.metallic, 1.0), none
    if slot in ("coat", "coat_rough"):
        value = material.clearcoat if slot == "coat" else material.clearcoat_roughness
        return (value, value, value, 1.0), none
    if slot == "emissive":
        return (*material.emissive, 1.0), none
    if slot == "normal":
        n = material.normal_scale
        return (2.0 * n, 2.0 * n, 2.0, 1.0), (-n, -n, -1.0, 0.0)
    s = material.occlusion_strength
    return (s, s, s, 1.0), (1.0 - s,) * 3 + (0.0,)
