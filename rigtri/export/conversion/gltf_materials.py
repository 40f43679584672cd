"""Materials, textures and images as lists of a glTF.

Source: glTF 2.0 §3.8, §3.9; KHR_texture_transform, KHR_materials_unlit, _emissive_strength, _clearcoat, _ior.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from rigtri.export.conversion.gltf_buffers import BufferBuilder
from rigtri.export.conversion.scene import Image, Material, Slot, Texture

_WRAPS = {"repeat": 10497, "clamp": 33071, "mirror": 33648}


class MaterialWriter:
    """extensions: those that the materials use. images: by their URIs, where they are files."""

    def __init__(self, buffer: BufferBuilder, place: Callable[[Image], str] | None) -> None:
        self._buffer, self._place = buffer, place
        self.extensions: set[str] = set()
        self.images: dict[str, Image] = {}
        self._lists: dict[str, list[dict[str, Any]]] = {"images": [], "samplers": [], "textures": []}

    def write(self, materials: Sequence[Material]) -> dict[str, list[dict[str, Any]]]:
        """The lists ``materials``, ``textures``, ``samplers`` and ``images``."""
        return {"materials": [self._material(one) for one in materials], **self._lists}

    def _material(self, material: Material) -> dict[str, Any]:
        slots = {slot: self._info(texture) for slot, texture in material.textures.items()}
        plain: dict[str, Any] = {
            "baseColorFactor": list(material.base),
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
        }
        found: dict[str, Any] = {"name": material.name, "pbrMetallicRoughness": plain}
        for slot, holder, key in (
            ("base", plain, "baseColorTexture"),
            ("metal_rough", plain, "metallicRoughnessTexture"),
            ("normal", found, "normalTexture"),
            ("occlusion", found, "occlusionTexture"),
            ("emissive", found, "emissiveTexture"),
        ):
            if slot in slots:
                holder[key] = slots[slot]
        if "normal" in slots and material.normal_scale != 1.0:
            found["normalTexture"]["scale"] = material.normal_scale
        if "occlusion" in slots and material.occlusion_strength != 1.0:
            found["occlusionTexture"]["strength"] = min(material.occlusion_strength, 1.0)
        if material.alpha != "OPAQUE":
            found["alphaMode"] = material.alpha
        if material.alpha == "MASK":
            found["alphaCutoff"] = material.cutoff
        if material.double_sided:
            found["doubleSided"] = True
        self._more(material, slots, found)
        return found

    def _more(self, material: Material, slots: Mapping[Slot, dict[str, Any]], found: dict[str, Any]) -> None:
        """Emission, and what extensions say."""
        extensions: dict[str, Any] = {}
        strength = max(*material.emissive, 1.0)
        if any(material.emissive):
            found["emissiveFactor"] = [x / strength for x in material.emissive]
        if strength > 1.0:
            extensions["KHR_materials_emissive_strength"] = {"emissiveStrength": strength}
        if material.unlit:
            extensions["KHR_materials_unlit"] = {}
        if material.clearcoat:
            coat: dict[str, Any] = {
                "clearcoatFactor": material.clearcoat,
                "clearcoatRoughnessFactor": material.clearcoat_roughness,
            }
            if "coat" in slots:
                coat["clearcoatTexture"] = slots["coat"]
            if "coat_rough" in slots:
                coat["clearcoatRoughnessTexture"] = slots["coat_rough"]
            extensions["KHR_materials_clearcoat"] = coat
        if material.ior != 1.5:
            extensions["KHR_materials_ior"] = {"ior": material.ior}
        if extensions:
            found["extensions"] = extensions
            self.extensions |= set(extensions)

    def _info(self, texture: Texture) -> dict[str, Any]:
        wraps = dict(zip(("wrapS", "wrapT"), (_WRAPS[wrap] for wrap in texture.wrap), strict=True))
        sampler = self._number("samplers", wraps)
        entry = {"sampler": sampler, "source": self._number("images", self._image(texture.image))}
        found: dict[str, Any] = {"index": self._number("textures", entry)}
        if texture.texcoord:
            found["texCoord"] = texture.texcoord
        if texture.is_transformed:
            offset, scale = list(texture.offset), list(texture.scale)
            change = {"offset": offset, "rotation": texture.rotation, "scale": scale}
            found["extensions"] = {"KHR_texture_transform": change}
            self.extensions.add("KHR_texture_transform")
        return found

    def _image(self, image: Image) -> dict[str, Any]:
        if self._place is not None:
            uri = self._place(image)
            self.images[uri] = image
            return {"uri": uri, "name": image.name.rpartition(".")[0]}
        for known in self._lists["images"]:
            if known["name"] == image.name.rpartition(".")[0]:
                return known
        kind = "image/png" if image.name.endswith(".png") else "image/jpeg"
        view = self._buffer.view(image.content)
        return {"name": image.name.rpartition(".")[0], "mimeType": kind, "bufferView": view}

    def _number(self, key: str, entry: dict[str, Any]) -> int:
        among = self._lists[key]
        if entry not in among:
            among.append(entry)
        return among.index(entry)
