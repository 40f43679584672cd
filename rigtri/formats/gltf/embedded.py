"""What a page must carry to show a glTF file: the file, and the files that it names.

Source: glTF 2.0 §2.8; KHR_draco_mesh_compression, KHR_texture_basisu, EXT_meshopt_compression.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rigtri.errors import FileError
from rigtri.formats import FOUR, Embedded
from rigtri.formats.gltf.resources import uris
from rigtri.formats.gltf.uris import file_of, is_data, is_there, why_absent
from rigtri.formats.gltf.values import Value

_MESHOPT = ("EXT_meshopt_compression", "KHR_meshopt_compression", "MESHOPT_compression")
# What viewers need another program for, and what is not seen without it.
_UNSEEN = {
    "KHR_draco_mesh_compression": "meshes that are compressed with Draco",
    "KHR_texture_basisu": "textures in KTX2 that have no other image",
}


def embedded(gltf: dict[str, Any], path: Path, *, allow_external: bool) -> Embedded:
    """The file at ``path`` with its buffers and images; what is missing or lies elsewhere is lacking."""
    files: dict[str, bytes | Path] = {}
    lacking = [f"{what} are not shown" for name, what in _UNSEEN.items() if name in _used(gltf)]
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
    meshopt = any(name in _used(gltf) for name in _MESHOPT)
    return Embedded("gltf", path, files, tuple(lacking), meshopt)


def _many_joints(gltf: dict[str, Any]) -> bool:
    """Whether points of a mesh have more than four joints."""
    for mesh in Value(gltf, "").each("meshes"):
        for primitive in mesh.each("primitives"):
            attributes = primitive.get("attributes")
            if attributes is not None and "JOINTS_1" in attributes.object():
                return True
    return False


def _used(gltf: dict[str, Any]) -> list[Any]:
    used = gltf.get("extensionsUsed")
    return used if isinstance(used, list) else []
