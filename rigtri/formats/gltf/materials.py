"""What the materials of a glTF file are made of, down to the bytes of their images, as plain facts.

Source: glTF 2.0 §3.8 (textures), §3.9 (materials); KHR_materials_variants.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from hashlib import sha256
from typing import Any

from rigtri.errors import FileError
from rigtri.formats.json_values import object_at

VARIANTS = "KHR_materials_variants"
# What members mean that are not there: stating it adds nothing.
_DEFAULTS: dict[str, Any] = {
    "alphaMode": "OPAQUE",
    "alphaCutoff": 0.5,
    "doubleSided": False,
    "emissiveFactor": [0, 0, 0],
    "pbrMetallicRoughness baseColorFactor": [1, 1, 1, 1],
    "pbrMetallicRoughness metallicFactor": 1,
    "pbrMetallicRoughness roughnessFactor": 1,
}
# The same of textures that are there.
_OF_TEXTURES: dict[str, dict[str, Any]] = {
    "pbrMetallicRoughness baseColorTexture": {"texCoord": 0},
    "pbrMetallicRoughness metallicRoughnessTexture": {"texCoord": 0},
    "normalTexture": {"texCoord": 0, "scale": 1},
    "occlusionTexture": {"texCoord": 0, "strength": 1},
    "emissiveTexture": {"texCoord": 0},
}
_OF_SAMPLERS = {"wrapS": 10497, "wrapT": 10497}
# Deeper than any material is nested: what is deeper is compared as one.
_DEEPEST = 12
Read = Callable[[dict[str, Any]], "bytes | memoryview"]


class Materials:
    """Facts of the materials that nodes show, each material and image looked at once."""

    def __init__(self, gltf: Mapping[str, Any], read: Read) -> None:
        self._gltf, self._read = gltf, read
        self._materials: dict[int, dict[str, Any]] = {}
        self._images: dict[int, str] = {}

    def of(self, node: int) -> dict[str, Any]:
        """The facts of all materials that a node of the file shows, by primitive."""
        facts: dict[str, Any] = {}
        mesh = self._item("meshes", self._gltf["nodes"][node].get("mesh")) or {}
        primitives = mesh.get("primitives")
        for number, primitive in enumerate(primitives if isinstance(primitives, list) else ()):
            primitive = primitive if isinstance(primitive, dict) else {}
            for fact, value in self._material(primitive.get("material")).items():
                facts[f"{fact} of the material of primitive {number}"] = value
            extensions = primitive.get("extensions")
            variants = extensions.get(VARIANTS) if isinstance(extensions, dict) else None
            if variants is not None:
                facts[f"materials of the variants of primitive {number}"] = str(variants)
        return facts

    def _material(self, index: Any) -> dict[str, Any]:
        material = self._item("materials", index)
        if material is None:
            return _DEFAULTS
        if index not in self._materials:
            stated = {
                name: what for name, what in self._facts(material, "", 0) if name != "pbrMetallicRoughness"
            }
            textures = {
                f"{texture} {name}": value
                for texture, members in _OF_TEXTURES.items()
                if f"{texture} image" in stated
                for name, value in members.items()
            }
            self._materials[index] = {**_DEFAULTS, **textures, **stated}
        return self._materials[index]

    def _facts(self, value: Any, name: str, depth: int) -> Iterator[tuple[str, Any]]:
        if not isinstance(value, dict) or depth > _DEEPEST:
            yield name, value
            return
        if name and not value:
            yield name, "there"  # an extension such as KHR_materials_unlit means all by being there
        for key, item in value.items():
            place = f"{name} {key}".strip()
            if key == "index" and name.lower().endswith("texture"):
                yield from self._facts(self._texture(item), name, depth + 1)
            elif key not in ("name", "extras"):
                yield from self._facts(item, place, depth + 1)

    def _texture(self, index: Any) -> dict[str, Any]:
        """A texture with its sampler and, in place of their numbers, its images."""
        texture = self._item("textures", index) or {}
        sampler = self._item("samplers", texture.get("sampler")) or {}
        facts: dict[str, Any] = {"sampler": _OF_SAMPLERS | {k: v for k, v in sampler.items() if k != "name"}}
        facts["image"] = self._image(texture.get("source"))
        extensions = texture.get("extensions")
        for name, extension in extensions.items() if isinstance(extensions, dict) else ():
            if isinstance(extension, dict):
                facts[name] = self._image(extension.get("source"))
        return facts

    def _image(self, index: Any) -> str | None:
        """A short name for the bytes of an image; what cannot be read goes by its own name."""
        image = self._item("images", index)
        if image is None:
            return None
        if index not in self._images:
            try:
                self._images[index] = sha256(self._read(image)).hexdigest()[:16]
            except (FileError, OSError):
                self._images[index] = f"unread {str(image.get('uri', index)).rpartition('/')[2]}"
        return self._images[index]

    def _item(self, key: str, index: Any) -> dict[str, Any] | None:
        """An item of a list of the file; None where the index leads nowhere."""
        return object_at(self._gltf.get(key), index)
