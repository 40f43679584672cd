"""What a page must carry to show a glTF file: the file, and the files that it names.

Source: glTF 2.0 §2.8, §5.29; KHR_draco_mesh_compression, KHR_texture_basisu, EXT_meshopt_compression.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from rigtri.errors import FileError
from rigtri.formats.document import FOUR, Embedded
from rigtri.formats.gltf.uris import file_of, is_data, is_there, uris, why_absent
from rigtri.formats.image_types import KINDS, shows
from rigtri.formats.json_values import Value
from rigtri.text import and_more

_DECODERS = {
    "EXT_meshopt_compression": "meshopt",
    "KHR_meshopt_compression": "meshopt",
    "MESHOPT_compression": "meshopt",
    "KHR_draco_mesh_compression": "draco",
}
# Extensions that have an image for a texture, in the order in which three.js asks them.
_IMAGES = ("EXT_texture_webp", "EXT_texture_avif")
_KTX2 = "KHR_texture_basisu"

# The bytes of an entry of ``images``; FileError where they are not to be had.
Images = Callable[[dict[str, object]], bytes | memoryview]


def embedded(gltf: dict[str, Any], path: Path, images: Images, *, allow_external: bool) -> Embedded:
    """The file at ``path`` with its buffers and images; what is missing or lies elsewhere is lacking."""
    files: dict[str, bytes | Path] = {}
    lacking = list(_unshown(gltf, images))
    if _many_joints(gltf):
        lacking.append(FOUR)
    for place, uri in uris(gltf):
        if not uri or is_data(uri) or uri in files or place[0] == "extensions":
            continue
        try:
            file = file_of(uri, path.parent, ".".join(map(str, place)), allow_external=allow_external)
        except FileError as error:
            lacking.append(str(error))
            continue
        if is_there(file):
            files[uri] = file
        else:
            lacking.append(why_absent(uri, file, path))
    used = gltf.get("extensionsUsed")
    decoders = {_DECODERS.get(str(name), "") for name in used} if isinstance(used, list) else set()
    return Embedded("gltf", path, files, tuple(lacking), tuple(sorted(decoders - {""})))


def _unshown(gltf: dict[str, Any], images: Images) -> Iterator[str]:
    """Which textures are not shown, and why."""
    packed, other = 0, dict[str, None]()
    entries = list(Value(gltf, "").each("images"))
    for texture in Value(gltf, "").each("textures"):
        with suppress(FileError):  # of images that are missing, which is reported with their files
            used = texture.object().get("extensions")
            known = [used[name] for name in _IMAGES if isinstance(used, dict) and name in used]
            source = Value(known[0], texture.where).get("source") if known else texture.get("source")
            if source is None:
                packed += isinstance(used, dict) and _KTX2 in used
                continue
            number = source.index(len(entries), "image")
            if not shows(images(entries[number].object())):
                other[_called(entries[number].object(), number)] = None
    if packed:
        yield (
            f"textures in KTX2 are not shown ({packed}), for a page that runs nothing but its own script can "
            "have no decoder of it; give them PNG, JPEG or WebP as well"
        )
    if other:
        yield f"textures whose images are not one of {KINDS} are not shown: {and_more(list(other), 3)}"


def _called(image: dict[str, Any], number: int) -> str:
    """What a user knows an image by."""
    uri = image.get("uri")
    if isinstance(uri, str) and not is_data(uri):
        return f"'{uri}'"
    name = image.get("name")
    return f"'{name}'" if isinstance(name, str) and name else f"images[{number}]"


def _many_joints(gltf: dict[str, Any]) -> bool:
    """Whether points of a mesh have more than four joints."""
    for mesh in Value(gltf, "").each("meshes"):
        for primitive in mesh.each("primitives"):
            attributes = primitive.get("attributes")
            if attributes is not None and "JOINTS_1" in attributes.object():
                return True
    return False
