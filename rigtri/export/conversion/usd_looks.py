"""UsdPreviewSurface networks as materials, and cameras and lights, in glTF's terms.

Source: UsdPreviewSurface specification 2.6; glTF 2.0 §3.9; UsdGeomCamera; UsdLux. `usd_materials` and
`usd_lenses` are the way there.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import PurePosixPath
from typing import Any

import numpy as np
from pxr import Ar, Usd, UsdGeom, UsdLux, UsdShade

from rigtri.export.conversion.scene import Camera, Image, Light, Material, Scene, Slot, Texture
from rigtri.export.conversion.usd_lenses import CANDELA, FAR, TENTHS
from rigtri.export.conversion.usd_materials import DEGREES, flipped
from rigtri.export.conversion.usd_values import rest_value
from rigtri.maths.trigonometry import arc_tangent

_WRAPS = {"clamp": "clamp", "mirror": "mirror", "repeat": "repeat", "black": "clamp"}


class Looks:
    """Materials of a stage, each and each image read once."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._known: dict[tuple[str, bool, str], int] = {}
        self._images: dict[str, Image | None] = {}
        self._names: set[str] = set()

    def number(self, material: Any, coordinates: Mapping[str, int], *, double_sided: bool) -> int | None:
        """The number of a material in the scene, for a mesh with these texture coordinates."""
        if material is None:
            return None
        key = str(material.GetPath()), double_sided, str(sorted(coordinates.items()))
        if key not in self._known:
            self._known[key] = len(self._scene.materials)
            self._scene.materials.append(self._read(material, coordinates, double_sided))
        return self._known[key]

    def coloured(self, colour: tuple[float, ...] | None, *, double_sided: bool) -> int | None:
        """The number of a material of one colour (displayColor, displayOpacity); None for none."""
        if colour is None:
            return None
        key = "displayColor", double_sided, str(colour)
        if key not in self._known:
            self._known[key] = len(self._scene.materials)
            red, green, blue, opacity = (min(max(x, 0.0), 1.0) for x in colour)
            self._scene.materials.append(
                Material(
                    "displayColor",
                    (red, green, blue, opacity),
                    metallic=0.0,
                    alpha="BLEND" if opacity < 1.0 else "OPAQUE",
                    double_sided=double_sided,
                )
            )
        return self._known[key]

    def _read(self, material: Any, coordinates: Mapping[str, int], double_sided: bool) -> Material:
        prim = material.GetPrim()
        name = prim.GetDisplayName() or prim.GetName()
        surface = UsdShade.Shader(material.ComputeSurfaceSource()[0])
        if not surface or surface.GetShaderId() != "UsdPreviewSurface":
            self._scene.lose(f"material '{name}', which is not a UsdPreviewSurface")
            return Material(name, metallic=0.0, double_sided=double_sided)
        unlit = prim.GetCustomDataByKey("unlit") is True
        textures: dict[Slot, Texture] = {}
        factors: dict[str, Any] = {}
        inputs: tuple[tuple[Slot, str], ...] = (
            ("base", "emissiveColor" if unlit else "diffuseColor"),
            ("metal_rough", "roughness"),
            ("normal", "normal"),
            ("occlusion", "occlusion"),
            ("emissive", "" if unlit else "emissiveColor"),
        )
        for slot, given in inputs:
            found = self._texture(surface, given, coordinates) if given else None
            if found is not None:
                textures[slot], factors[slot] = found
        colour = factors.get("base", (*self._value(surface, inputs[0][1], (0.18,) * 3), 1.0))
        both = factors.get("metal_rough", (1.0, None, None, 1.0))
        opacity = self._number(surface, "opacity", 1.0)
        cutoff = self._number(surface, "opacityThreshold", 0.0)
        linked = surface.GetInput("opacity") and surface.GetInput("opacity").HasConnectedSource()
        clear = linked or opacity < 1.0
        alpha = "MASK" if clear and cutoff > 0 else "BLEND" if clear else "OPAQUE"
        metallic = both[2] if both[2] is not None else self._number(surface, "metallic", 0.0)
        roughness = both[1] if both[1] is not None else self._number(surface, "roughness", 0.5)
        base = (*colour[:3], colour[3] if linked else opacity)
        if max(*base, metallic, roughness) > 1.0 or min(*base, metallic, roughness) < 0.0:
            self._scene.lose(f"factors of material '{name}' beyond 0 to 1")
        return Material(
            name,
            tuple(min(max(x, 0.0), 1.0) for x in base),
            min(max(metallic, 0.0), 1.0),
            min(max(roughness, 0.0), 1.0),
            factors["emissive"][:3]
            if "emissive" in factors
            else (0.0,) * 3
            if unlit
            else self._value(surface, "emissiveColor", (0.0,) * 3),
            alpha,  # type: ignore[arg-type]
            cutoff if alpha == "MASK" else 0.5,
            double_sided,
            unlit,
            factors["normal"][0] / 2.0 if "normal" in factors else 1.0,
            factors["occlusion"][0] if "occlusion" in factors else 1.0,
            self._number(surface, "clearcoat", 0.0),
            self._number(surface, "clearcoatRoughness", 0.01),
            self._number(surface, "ior", 1.5),
            textures,
        )

    @staticmethod
    def _value(surface: Any, name: str, otherwise: Any) -> Any:
        given = surface.GetInput(name)
        value = rest_value(given.GetAttr()) if given and not given.HasConnectedSource() else None
        if given and given.HasConnectedSource() and otherwise == (0.18,) * 3:
            return (1.0, 1.0, 1.0)  # a primvar, which glTF multiplies
        return otherwise if value is None else tuple(value)

    @staticmethod
    def _number(surface: Any, name: str, otherwise: float) -> float:
        given = surface.GetInput(name)
        value = rest_value(given.GetAttr()) if given and not given.HasConnectedSource() else None
        return otherwise if value is None else float(value)

    def _texture(
        self, surface: Any, name: str, coordinates: Mapping[str, int]
    ) -> tuple[Texture, tuple[float, ...]] | None:
        """The image that an input is connected to, and its scale."""
        node = _source(surface, name)
        if node is None or node.GetShaderId() != "UsdUVTexture":
            return None
        asset = rest_value(node.GetInput("file").GetAttr()) if node.GetInput("file") else None
        image = self._image(asset) if asset is not None else None
        if image is None:
            return None
        offset, rotation, scale, reader = (0.0, 0.0), 0.0, (1.0, 1.0), _source(node, "st")
        if reader is not None and reader.GetShaderId() == "UsdTransform2d":
            scale = tuple(self._value(reader, "scale", (1.0, 1.0)))
            rotation = self._number(reader, "rotation", 0.0) / DEGREES
            moved = tuple(self._value(reader, "translation", (0.0, 0.0)))
            # Turned over once more it is what it was, but for the way in which it is rotated.
            offset = flipped(moved, -rotation, scale)[0]
            reader = _source(reader, "in")
        named = (
            reader.GetInput("varname").Get() if reader is not None and reader.GetInput("varname") else "st"
        )
        wrap = tuple(_WRAPS.get(str(self._token(node, key)), "clamp") for key in ("wrapS", "wrapT"))
        texture = Texture(image, coordinates.get(str(named), 0), wrap, offset, rotation, scale)  # type: ignore[arg-type]
        return texture, tuple(self._value(node, "scale", (1.0,) * 4))

    @staticmethod
    def _token(node: Any, name: str) -> Any:
        given = node.GetInput(name)
        return given.Get() if given and given.Get() is not None else "black"

    def _image(self, asset: Any) -> Image | None:
        path = str(asset.resolvedPath)
        if path not in self._images:
            opened = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path)) if path else None
            if opened is None:
                self._scene.lose(f"texture '{asset.path}', which is missing or cannot be read")
            self._images[path] = (
                None if opened is None else self._named(asset.path, bytes(opened.GetBuffer()))
            )
        return self._images[path]

    def _named(self, path: str, content: bytes) -> Image | None:
        name = PurePosixPath(path.rstrip("]").replace("[", "/")).name
        known = content.startswith((b"\x89PNG", b"\xff\xd8\xff"))
        if not known:
            self._scene.lose(f"texture '{name}', which is neither PNG nor JPEG")
            return None
        stem, number = PurePosixPath(name).stem, 1
        suffix = ".png" if content.startswith(b"\x89PNG") else ".jpg"
        name = f"{stem}{suffix}"
        while name.lower() in self._names:
            name, number = f"{stem}_{number}{suffix}", number + 1
        self._names.add(name.lower())
        return Image(name, content)


def _source(shader: Any, name: str) -> Any:
    given = shader.GetInput(name)
    sources = given.GetConnectedSources()[0] if given else []
    return UsdShade.Shader(sources[0].source.GetPrim()) if sources else None


def read_camera(prim: Any, unit: float) -> Camera:
    """A Camera; unit: of the stage in metres, in which near and far are."""
    camera = UsdGeom.Camera(prim)
    wide, high = (
        float(rest_value(a)) for a in (camera.GetHorizontalApertureAttr(), camera.GetVerticalApertureAttr())
    )
    near, far = rest_value(camera.GetClippingRangeAttr())
    flat = rest_value(camera.GetProjectionAttr()) == UsdGeom.Tokens.orthographic
    focal = float(rest_value(camera.GetFocalLengthAttr()))
    angle = 2.0 * float(arc_tangent(np.array(high / 2.0), np.array(focal)))
    height = high / TENTHS * unit if flat else angle
    name = prim.GetDisplayName() or prim.GetName()
    # The eye of glTF may not touch what is near.
    return Camera(name, flat, height, wide / high, max(near * unit, 1e-6), None if far >= FAR else far * unit)


def read_light(prim: Any, scene: Scene) -> Light | None:
    """A light of glTF; None, with a word, for one that has no place or another shape."""
    name = prim.GetDisplayName() or prim.GetName()
    if not (prim.IsA(UsdLux.SphereLight) or prim.IsA(UsdLux.DistantLight)):
        scene.lose(f"light '{name}' of type {prim.GetTypeName()}")
        return None
    api = UsdLux.LightAPI(prim)
    exposure = float(rest_value(api.GetExposureAttr()) or 0.0)
    if exposure:
        scene.lose(f"exposure of light '{name}'")
    red, green, blue = map(float, rest_value(api.GetColorAttr()))
    # glTF's colours end at 1; what is brighter is intensity.
    most = max(red, green, blue, 1.0)
    intensity = float(rest_value(api.GetIntensityAttr())) * most
    colour = red / most, green / most, blue / most
    if prim.IsA(UsdLux.DistantLight):
        return Light(name, "directional", colour, intensity)
    if not rest_value(api.GetNormalizeAttr()):
        radius = float(rest_value(UsdLux.SphereLight(prim).GetRadiusAttr()))
        intensity *= 4.0 * 3.141592653589793 * radius * radius
    shaping = UsdLux.ShapingAPI(prim)
    cone = rest_value(shaping.GetShapingConeAngleAttr()) if prim.HasAPI(UsdLux.ShapingAPI) else None
    if cone is None or cone >= 90.0:
        return Light(name, "point", colour, intensity / CANDELA)
    soft = float(rest_value(shaping.GetShapingConeSoftnessAttr()) or 0.0)
    outer = float(cone) / DEGREES
    return Light(name, "spot", colour, intensity / CANDELA, outer * (1.0 - min(soft, 1.0)), outer)


def shows_colours(material: Any) -> bool:
    """Whether a material shows the displayColor of meshes; where there is none, they are drawn in it."""
    shaders = [UsdShade.Shader(prim) for prim in Usd.PrimRange(material.GetPrim())] if material else []
    names = [shader.GetInput("varname") for shader in shaders if shader]
    return not material or any(str(name.Get()) == "displayColor" for name in names if name)
