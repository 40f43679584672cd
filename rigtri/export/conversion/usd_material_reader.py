"""UsdPreviewSurface networks as materials in glTF's terms; `usd_materials` is the way there.

Source: UsdPreviewSurface specification 2.6; glTF 2.0 §3.9.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import PurePosixPath
from typing import Any

import numpy as np
from pxr import Usd, UsdShade

from rigtri.errors import FileError
from rigtri.export.conversion.scene import Image, Material, Scene, Slot, Texture, short_stem
from rigtri.export.conversion.usd_materials import DEGREES, flipped
from rigtri.export.conversion.usd_networks import source_of, value_of
from rigtri.maths.trigonometry import sin_cos

# Texture coordinates this near to an edge are on it: float32, turned over and back.
_ROUNDED = 1e-6
_WRAPS = {"clamp": "clamp", "mirror": "mirror", "repeat": "repeat"}
# Inputs whose textures glTF takes for sRGB, those of all others for linear values (glTF 2.0, chapter 3.9).
_COLOURS = ("diffuseColor", "emissiveColor")
# The channels of textures that glTF takes; of colour and roughness those of two others, too.
_CHANNELS: Mapping[Slot, str] = {
    "base": "rgb",
    "metal_rough": "g",
    "normal": "rgb",
    "occlusion": "r",
    "emissive": "rgb",
    "coat": "r",
    "coat_rough": "g",
}
_SHARED = {"opacity": "a", "metallic": "b"}
_SHARED_WITH = {
    "opacity": "alpha of the texture of colour",
    "metallic": "channel b of the texture of roughness",
}
# The markers before the size and the channels of a JPEG.
_FRAMES = (0xC0, 0xC1, 0xC2)
# Has the colour type of a PNG with three colours, by themselves or in a palette.
_RGB = 2
# Where the colour type is in a PNG, which may be cut off before it.
_COLOUR_TYPE = 25


class MaterialReader:
    """Materials of a stage, each and each image read once."""

    def __init__(self, scene: Scene, read: Callable[[Any], bytes]) -> None:
        """read: the bytes of the texture that an asset path names; FileError where they are not to be had."""
        self._scene, self._content = scene, read
        self._known: dict[tuple[str, bool, str], int] = {}
        self._used: dict[str, str] = {}  # where the opinions of a material are, by its path
        # Textures that are black beside their edges, and whether along u and v, by material and by path.
        self._black: dict[int, dict[str, tuple[Texture, list[bool]]]] = {}
        self._images: dict[str, Image | None] = {}
        self._names: set[str] = set()

    def number(
        self, material: Any, coordinates: Mapping[str, int], values: Mapping[str, Any], *, double_sided: bool
    ) -> int:
        """The number of a material in the scene, for faces with these texture coordinates.

        coordinates: the number of each set. values: what corners have, by glTF's names, (c, ...).
        """
        path = str(material.GetPath())
        if path not in self._used:
            self._used[path] = _specs(material.GetPrim())
        key = self._used[path], double_sided, str(sorted(coordinates.items()))
        if key not in self._known:
            self._known[key] = len(self._scene.materials)
            self._scene.materials.append(self._read(material, coordinates, double_sided))
        number = self._known[key]
        for path, (texture, black) in self._black.get(number, {}).items():
            if _leaves(texture, values.get(f"TEXCOORD_{texture.texcoord}"), black):
                self._scene.lose(f"that '{path}' is black beside its edges: its last texels go on")
        return number

    def unused(self, prim: Any) -> bool:
        """Whether a prim is a material that no mesh has."""
        return prim.IsA(UsdShade.Material) and str(prim.GetPath()) not in self._used

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
        textures, factors, amounts = self._textures(surface, name, coordinates, unlit=unlit)
        colour = factors.get(
            "base", (*self._value(surface, "emissiveColor" if unlit else "diffuseColor", (0.18,) * 3), 1.0)
        )
        opacity, linked = self._channel(surface, "opacity", name, textures.get("base"), coordinates, 1.0)
        cutoff = self._number(surface, "opacityThreshold", 0.0)
        clear = linked or opacity < 1.0
        alpha = "MASK" if clear and cutoff > 0 else "BLEND" if clear else "OPAQUE"
        rough = textures.get("metal_rough")
        metallic, _ = self._channel(surface, "metallic", name, rough, coordinates, 0.0)
        roughness = amounts["metal_rough"] if rough else self._number(surface, "roughness", 0.5)
        base = (*colour[:3], opacity)
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
            amounts.get("coat", self._number(surface, "clearcoat", 0.0)),
            amounts.get("coat_rough", self._number(surface, "clearcoatRoughness", 0.01)),
            self._number(surface, "ior", 1.5),
            textures,
        )

    def _textures(
        self, surface: Any, name: str, coordinates: Mapping[str, int], *, unlit: bool
    ) -> tuple[dict[Slot, Texture], dict[str, Any], dict[str, float]]:
        """The textures of a material, the scales of all their channels, and of the first that is taken."""
        textures: dict[Slot, Texture] = {}
        factors: dict[str, Any] = {}
        amounts: dict[str, float] = {}
        inputs: tuple[tuple[Slot, str], ...] = (
            ("base", "emissiveColor" if unlit else "diffuseColor"),
            ("metal_rough", "roughness"),
            ("normal", "normal"),
            ("occlusion", "occlusion"),
            ("emissive", "" if unlit else "emissiveColor"),
            ("coat", "clearcoat"),
            ("coat_rough", "clearcoatRoughness"),
        )
        for slot, given in inputs:
            found = self._texture(surface, given, name, coordinates) if given else None
            if found is not None:
                textures[slot], factors[slot], channel = found
                amounts[slot] = factors[slot]["rgba".index(channel[0])]
                if channel != _CHANNELS[slot] and not _is_grey(textures[slot].image):
                    self._scene.lose(
                        f"that {given} of material '{name}' is channel {channel} of its texture: glTF takes "
                        f"{_CHANNELS[slot]}"
                    )
        return textures, factors, amounts

    def _channel(
        self,
        surface: Any,
        name: str,
        material: str,
        beside: Texture | None,
        coordinates: Mapping[str, int],
        otherwise: float,
    ) -> tuple[float, bool]:
        """The factor of an input that glTF takes from a channel of another's texture; and whether it has one.

        beside: the other's texture.
        """
        linked = source_of(surface, name) is not None
        if not linked:
            value = self._number(surface, name, otherwise)
            if name == "metallic" and beside is not None and value:
                self._scene.lose(
                    f"that metallic of material '{material}' is {value:g} everywhere: glTF multiplies it by "
                    f"{_SHARED_WITH[name]}"
                )
            return value, False
        found = self._texture(surface, name, material, coordinates)
        channel = _SHARED[name]
        if found is not None and found[0] == beside and found[2] == channel:
            return found[1]["rgba".index(channel)], True
        if found is not None:
            self._scene.lose(
                f"the texture of {name} of material '{material}': glTF has it in {_SHARED_WITH[name]}"
            )
        return otherwise, True

    @staticmethod
    def _value(surface: Any, name: str, otherwise: Any) -> Any:
        value = value_of(surface, name)
        if source_of(surface, name) is not None and otherwise == (0.18,) * 3:
            return (1.0, 1.0, 1.0)  # a primvar, which glTF multiplies
        return otherwise if value is None else tuple(value)

    @staticmethod
    def _number(surface: Any, name: str, otherwise: float) -> float:
        value = value_of(surface, name)
        return otherwise if value is None else float(value)

    def _texture(
        self, surface: Any, name: str, material: str, coordinates: Mapping[str, int]
    ) -> tuple[Texture, tuple[float, ...], str] | None:
        """The image that an input is connected to, its scale, and the channel that is taken."""
        source = source_of(surface, name)
        if source is None:
            return None
        node, channel = source
        if node.GetShaderId() != "UsdUVTexture":
            if not _is_colour_of_points(node):
                self._scene.lose(f"{name} of material '{material}', which <{node.GetPath()}> gives")
            return None
        asset = value_of(node, "file")
        image = self._image(asset) if asset is not None else None
        if image is None:
            return None
        offset, rotation, scale, reader = (0.0, 0.0), 0.0, (1.0, 1.0), source_of(node, "st")
        if reader is not None and reader[0].GetShaderId() == "UsdTransform2d":
            change = reader[0]
            scale = tuple(self._value(change, "scale", (1.0, 1.0)))
            rotation = self._number(change, "rotation", 0.0) / DEGREES
            moved = tuple(self._value(change, "translation", (0.0, 0.0)))
            # Turned over once more it is what it was, but for the way in which it is rotated.
            offset = flipped(moved, -rotation, scale)[0]
            reader = source_of(change, "in")
        named = value_of(reader[0], "varname") if reader is not None else None
        wraps = [str(value_of(node, key)) for key in ("wrapS", "wrapT")]
        wrap = tuple(_WRAPS.get(each, "clamp") for each in wraps)
        number = coordinates.get("st" if named is None else str(named), 0)
        texture = Texture(image, number, wrap, offset, rotation, scale)  # type: ignore[arg-type]
        if "black" in wraps:
            mine = self._black.setdefault(len(self._scene.materials), {})
            mine[asset.path] = texture, [wrap == "black" for wrap in wraps]
        scales = tuple(self._value(node, "scale", (1.0,) * 4))
        self._bias(node, name, channel, scales)
        self._colour_space(node, name, material, channel, image)
        return texture, scales, channel

    def _colour_space(self, node: Any, name: str, material: str, channel: str, image: Image) -> None:
        """Report values that a stage demands in another space than glTF has them in; alpha has none."""
        given, due = value_of(node, "sourceColorSpace"), "sRGB" if name in _COLOURS else "raw"
        why = ""
        if given not in ("raw", "sRGB"):  # the auto of UsdPreviewSurface, which it is where nothing is said
            given = "sRGB" if _is_rgb_of_8_bits(image) else "raw"
            why = f" (sourceColorSpace auto, {'' if given == 'sRGB' else 'not '}8-bit RGB)"
        if channel != "a" and given != due:
            what = f"that the texture of {name} of material '{material}' is {given}{why}"
            self._scene.lose(f"{what}: glTF reads it as {due}")

    def _bias(self, node: Any, name: str, channel: str, scales: tuple[float, ...]) -> None:
        """Report what a texture adds where glTF does not, as it does for normals and occlusion."""
        bias = self._value(node, "bias", (0.0,) * 4)
        implied = {"normal": lambda k: -scales[k] / 2.0, "occlusion": lambda k: 1.0 - scales[k]}.get(name)
        used = ["rgba".index(one) for one in channel]
        if any(bias) and any(abs(bias[k] - (implied(k) if implied else 0.0)) > _ROUNDED for k in used):
            self._scene.lose(f"inputs:bias (<{node.GetPath()}>)")

    def _image(self, asset: Any) -> Image | None:
        path = str(asset.resolvedPath) or asset.path
        if "<UDIM>" in path and path not in self._images:
            self._scene.lose(f"the texture '{asset.path}': glTF has no UDIM tiles")
            self._images[path] = None
        if path not in self._images:
            try:
                self._images[path] = self._named(asset.path, self._content(asset))
            except FileError as error:
                self._scene.lose(str(error))
                self._images[path] = None
        return self._images[path]

    def _named(self, path: str, content: bytes) -> Image | None:
        name = PurePosixPath(path.rstrip("]").replace("[", "/")).name
        known = content.startswith((b"\x89PNG", b"\xff\xd8\xff"))
        if not known:
            self._scene.lose(f"texture '{name}', which is neither PNG nor JPEG")
            return None
        stem, number = short_stem(PurePosixPath(name).stem), 1
        suffix = ".png" if content.startswith(b"\x89PNG") else ".jpg"
        name = f"{stem}{suffix}"
        while name.lower() in self._names:
            name, number = f"{stem}_{number}{suffix}", number + 1
        self._names.add(name.lower())
        return Image(name, content)


def _specs(material: Any) -> str:
    """Where all opinions about a material are: what instances show of one asset is one material."""
    stacks = (prim.GetPrimStack() for prim in Usd.PrimRange(material))
    return str([(spec.layer.identifier, str(spec.path)) for stack in stacks for spec in stack])


def _is_grey(image: Image) -> bool:
    """Whether a PNG or JPEG says that all its channels are one."""
    content = image.content
    if content.startswith(b"\x89PNG") and len(content) > _COLOUR_TYPE:
        return content[_COLOUR_TYPE] in (0, 4)
    at = 2
    while content[at : at + 1] == b"\xff" and at + 9 < len(content):
        if content[at + 1] in _FRAMES:
            return content[at + 9] == 1
        at += 2 + int.from_bytes(content[at + 2 : at + 4], "big")
    return False


def _is_rgb_of_8_bits(image: Image) -> bool:
    """Whether a PNG or JPEG decodes to 8 bits of three colours, with or without alpha."""
    content = image.content
    if content.startswith(b"\x89PNG") and len(content) > _COLOUR_TYPE:
        return content[24] <= 8 and bool(content[_COLOUR_TYPE] & _RGB)
    return not _is_grey(image)


def _leaves(texture: Texture, coordinates: Any, along: Sequence[bool]) -> bool:
    """Whether texture coordinates, (c, 2), are beside the image along u or v, once they are transformed."""
    if coordinates is None:
        return False
    sine, cosine = (float(x) for x in sin_cos(np.array(texture.rotation)))
    u, v = (np.asarray(coordinates, dtype=np.float64) * texture.scale).T
    placed = np.stack([cosine * u + sine * v, cosine * v - sine * u], axis=1) + texture.offset
    return bool(((placed < -_ROUNDED) | (placed > 1.0 + _ROUNDED))[:, list(along)].any())


def _is_colour_of_points(shader: Any) -> bool:
    return str(value_of(shader, "varname")) == "displayColor"


def shows_colours(material: Any) -> bool:
    """Whether a material shows the displayColor of meshes; where there is none, they are drawn in it."""
    shaders = [UsdShade.Shader(prim) for prim in Usd.PrimRange(material.GetPrim())] if material else []
    return not material or any(_is_colour_of_points(shader) for shader in shaders if shader)
