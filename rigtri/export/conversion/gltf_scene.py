"""A glTF file as a scene: materials with their images, cameras, lights, extras and primitives.

Source: glTF 2.0 §3.9 to §3.10; KHR_texture_transform, KHR_lights_punctual, KHR_materials_unlit,
KHR_materials_emissive_strength, KHR_materials_clearcoat, KHR_materials_ior, KHR_node_visibility.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import PurePosixPath
from typing import Any
from urllib.parse import unquote

from rigtri.errors import FileError
from rigtri.export.conversion.scene import (
    Camera,
    Image,
    Light,
    Material,
    Primitive,
    Scene,
    Slot,
    Texture,
    short_stem,
)
from rigtri.formats.gltf.document import GltfDocument
from rigtri.formats.gltf.scene_facts import LIGHTS
from rigtri.formats.gltf.uris import is_data
from rigtri.formats.json_values import name_in
from rigtri.model.rig import Rig
from rigtri.text import and_more

_WRAPS = {10497: "repeat", 33071: "clamp", 33648: "mirror"}
_TYPES = {"image/png": ".png", "image/jpeg": ".jpg", "image/webp": ".webp", "image/ktx2": ".ktx2"}
_MAPS: Mapping[Slot, tuple[str, ...]] = {
    "base": ("pbrMetallicRoughness", "baseColorTexture"),
    "metal_rough": ("pbrMetallicRoughness", "metallicRoughnessTexture"),
    "normal": ("normalTexture",),
    "occlusion": ("occlusionTexture",),
    "emissive": ("emissiveTexture",),
    "coat": ("extensions", "KHR_materials_clearcoat", "clearcoatTexture"),
    "coat_rough": ("extensions", "KHR_materials_clearcoat", "clearcoatRoughnessTexture"),
}
# What is said in other words, or changes nothing that is seen.
_KNOWN = {
    "KHR_texture_transform",
    LIGHTS,
    "KHR_materials_unlit",
    "KHR_materials_emissive_strength",
    "KHR_materials_clearcoat",
    "KHR_materials_ior",
    "KHR_node_visibility",
    "KHR_mesh_quantization",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "KHR_draco_mesh_compression",  # its meshes are named one by one
    "KHR_texture_basisu",  # likewise its images
    "EXT_texture_webp",
}
# Filters that show the texels of an image: for what is near, and for what is far.
_NEAREST = {"magFilter": (9728,), "minFilter": (9728, 9984, 9986)}


def read_scene(document: GltfDocument, rig: Rig, name: str) -> Scene:
    """All of a file that USD can say; the rest is in `Scene.lost`.

    rig: the document's, with some of its clips. FileError for what is broken.
    """
    try:
        return _Reader(document, rig, name).read()
    except (LookupError, TypeError, ValueError, AttributeError) as error:
        path = document.container.path
        raise FileError(
            f"{path}: cameras, lights, materials or textures are not as glTF has them ({error}); find out "
            f"what is wrong with: rigtri check {path.name}"
        ) from None


class _Reader:
    """One pass over a file."""

    def __init__(self, document: GltfDocument, rig: Rig, name: str) -> None:
        self.document, self.gltf = document, document.container.gltf
        self.scene = Scene(rig, name)
        self._images: dict[int, Image] = {}
        self._used: set[str] = set()
        self._nearest: list[str] = []

    def read(self) -> Scene:
        scene, rig = self.scene, self.scene.rig
        scene.omit_built()
        scene.copyright = str(self._object(self.gltf, "asset").get("copyright", ""))
        scene.materials = [self._material(raw, k) for k, raw in enumerate(self._list("materials"))]
        self._primitives()
        lights = self._object(self.gltf.get("extensions"), LIGHTS).get("lights") or []
        shown = self.document.scene_facts().nodes
        for node, key in enumerate(rig.keys):
            raw = self.gltf["nodes"][key]
            if "camera" in raw:
                scene.cameras[node] = self._camera(self._list("cameras")[raw["camera"]])
            light = self._object(raw.get("extensions"), LIGHTS).get("light")
            if light is not None:
                scene.lights[node] = self._light(lights[light])
            extras = raw.get("extras")
            if isinstance(extras, dict):
                extras = {word: value for word, value in extras.items() if word != "rigtri"}
            if extras:
                scene.extras[node] = extras
            facts = shown.get(node, {})
            scenes = facts.get("scenes")
            elsewhere = scenes is not None and "the scene that is shown" not in scenes
            if facts.get("visibility") == "hidden" or elsewhere:
                scene.hidden.add(node)
        self._unsaid()
        return scene

    def _unsaid(self) -> None:
        scene = self.scene
        for name in self.gltf.get("extensionsUsed") or ():
            if name not in _KNOWN:
                scene.lose(f"extension {name}")
        for notice in self.document.warnings:
            if notice.code == "mesh-unread":
                text = notice.text.removesuffix(" (the mesh is kept, but not checked)")
                scene.lose(f"a mesh that cannot be read: {text}")
        if self._nearest:
            images = and_more(sorted(set(self._nearest)), 3)
            scene.lose(f"the filter NEAREST of {images}: USD smooths textures between texels")
        for key, value in self.gltf.items():
            if key == "extras" and value:
                scene.lose("extras of the file")
            elif key != "nodes" and (count := _extras(value)):
                scene.lose(f"extras of {key} ({count})")

    def _list(self, key: str) -> list[Any]:
        found = self.gltf.get(key)
        return found if isinstance(found, list) else []

    @staticmethod
    def _object(holder: Any, key: str) -> dict[str, Any]:
        found = holder.get(key) if isinstance(holder, dict) else None
        return found if isinstance(found, dict) else {}

    def _primitives(self) -> None:
        scene = self.scene
        for mesh in self.document.meshes():
            if mesh.node in scene.omitted:
                continue
            number = int(mesh.name.rpartition("/")[2])
            index = self.gltf["nodes"][scene.rig.keys[mesh.node]]["mesh"]
            raw = self._list("meshes")[index]
            surface = mesh.surface_now
            if surface is None:
                scene.lose(f"mesh {mesh.name}, whose faces cannot be read")
                continue
            name = name_in(raw)
            primitive = raw["primitives"][number]
            shared, material = (index, number), primitive.get("material")
            if material is not None and not (type(material) is int and 0 <= material < len(scene.materials)):
                raise LookupError(f"there is no materials[{material!r:.20}] for mesh {mesh.name}")
            scene.primitives.setdefault(mesh.node, []).append(
                Primitive(mesh, surface, name or f"mesh_{index}", material, shared)
            )

    def _camera(self, raw: Mapping[str, Any]) -> Camera:
        lens = self._object(raw, str(raw.get("type")))
        name = name_in(raw)
        near, far = float(lens.get("znear", 0.01)), lens.get("zfar")
        if raw.get("type") == "orthographic":
            height = 2.0 * float(lens["ymag"])
            return Camera(name, True, height, float(lens["xmag"]) / float(lens["ymag"]), near, far)
        return Camera(name, False, float(lens["yfov"]), lens.get("aspectRatio"), near, far)

    def _light(self, raw: Mapping[str, Any]) -> Light:
        spot = self._object(raw, "spot")
        if raw.get("range") is not None:
            self.scene.lose(f"the range of light '{raw.get('name', '')}'")
        return Light(
            name_in(raw),
            str(raw.get("type")),
            tuple(map(float, raw.get("color", (1.0, 1.0, 1.0)))),  # type: ignore[arg-type]
            float(raw.get("intensity", 1.0)),
            float(spot.get("innerConeAngle", 0.0)),
            float(spot.get("outerConeAngle", Light.outer)),
        )

    def _material(self, raw: Mapping[str, Any], number: int) -> Material:
        plain, more = self._object(raw, "pbrMetallicRoughness"), raw.get("extensions")
        textures: dict[Slot, Texture] = {}
        for slot, way in _MAPS.items():
            holder: Any = raw
            for step in way:
                holder = self._object(holder, step)
            texture = self._texture(holder) if holder else None
            if texture is not None:
                textures[slot] = texture
        strength = float(self._object(more, "KHR_materials_emissive_strength").get("emissiveStrength", 1.0))
        coat = self._object(more, "KHR_materials_clearcoat")
        name = name_in(raw) or f"material_{number}"
        alpha, cutoff = raw.get("alphaMode", "OPAQUE"), float(raw.get("alphaCutoff", 0.5))
        if alpha == "MASK" and cutoff <= 0.0:  # it hides nothing; an opacityThreshold of 0 blends in USD
            alpha = "OPAQUE"
        if "clearcoatNormalTexture" in coat:
            self.scene.lose(f"the normal texture of the clear coat of material '{name}'")
        return Material(
            name,
            tuple(map(float, plain.get("baseColorFactor", (1.0,) * 4))),  # type: ignore[arg-type]
            float(plain.get("metallicFactor", 1.0)),
            float(plain.get("roughnessFactor", 1.0)),
            tuple(strength * float(x) for x in raw.get("emissiveFactor", (0.0,) * 3)),  # type: ignore[arg-type]
            alpha,
            cutoff,
            raw.get("doubleSided") is True,
            isinstance(more, dict) and "KHR_materials_unlit" in more,
            float(self._object(raw, "normalTexture").get("scale", 1.0)),
            float(self._object(raw, "occlusionTexture").get("strength", 1.0)),
            float(coat.get("clearcoatFactor", 0.0)),
            float(coat.get("clearcoatRoughnessFactor", 0.0)),
            float(self._object(more, "KHR_materials_ior").get("ior", 1.5)),
            textures,
        )

    def _texture(self, info: Mapping[str, Any]) -> Texture | None:
        texture = self._list("textures")[info["index"]]
        more = self._object(texture, "extensions")
        source = texture.get("source", self._object(more, "EXT_texture_webp").get("source"))
        if source is None:
            self.scene.lose(f"texture #{info['index']}, which is in {', '.join(more) or 'no image'} alone")
            return None
        image = self._image(source)
        if image is None:
            return None
        sampler = self._list("samplers")[texture["sampler"]] if "sampler" in texture else {}
        if any(sampler.get(key) in nearest for key, nearest in _NEAREST.items()):
            self._nearest.append(image.name)
        change = self._object(info.get("extensions"), "KHR_texture_transform")
        return Texture(
            image,
            int(change.get("texCoord", info.get("texCoord", 0))),
            tuple(_WRAPS.get(sampler.get(key, 10497), "repeat") for key in ("wrapS", "wrapT")),  # type: ignore[arg-type]
            tuple(map(float, change.get("offset", (0.0, 0.0)))),  # type: ignore[arg-type]
            float(change.get("rotation", 0.0)),
            tuple(map(float, change.get("scale", (1.0, 1.0)))),  # type: ignore[arg-type]
        )

    def _image(self, number: int) -> Image | None:
        raw = self._list("images")[number]
        if number not in self._images:
            try:
                content = bytes(self.document.image(raw))
            except (FileError, OSError) as error:
                self.scene.lose(f"image #{number}: {error}")
                return None
            self._images[number] = Image(self._file_name(raw, number, content), content)
        return self._images[number]

    def _file_name(self, raw: Mapping[str, Any], number: int, content: bytes) -> str:
        """A plain name with the suffix of what the image is."""
        uri, named = raw.get("uri"), raw.get("name")
        path = unquote(uri) if isinstance(uri, str) and not is_data(uri) else str(named or f"image_{number}")
        plain = PurePosixPath(path).name.partition(".")[0]
        stem = short_stem("".join(c if c.isalnum() or c in "-_" else "_" for c in plain))
        known = {b"\x89PNG": ".png", b"\xff\xd8\xff": ".jpg", b"RIFF": ".webp", b"\xabKTX": ".ktx2"}
        suffix = next((s for start, s in known.items() if content.startswith(start)), "")
        suffix = suffix or _TYPES.get(str(raw.get("mimeType")), PurePosixPath(path).suffix or ".png")
        name, again = f"{stem or 'image'}{suffix}", 1
        while name.lower() in self._used:
            name, again = f"{stem}_{again}{suffix}", again + 1
        self._used.add(name.lower())
        if suffix not in (".png", ".jpg"):
            why = "is neither PNG nor JPEG, which all USD viewers show; it is copied as it is"
            self.scene.lose(f"image {name} {why}")
        return name


def _extras(value: Any) -> int:
    """How many objects in JSON have extras, but for the names of morph targets."""
    if isinstance(value, list):
        return sum(map(_extras, value))
    if not isinstance(value, dict):
        return 0
    own = value.get("extras")
    named = isinstance(own, dict) and set(own) <= {"targetNames"}
    return int(bool(own) and not named) + sum(_extras(one) for key, one in value.items() if key != "extras")
