"""glTF files with their buffer views compressed, made from a Builder without rigtri."""

from __future__ import annotations

import json
import random
from pathlib import Path
from typing import Any, Literal

from gltf_files import TYPES, Builder, glb_bytes
from meshopt_streams import encode_attributes, encode_indices

EXT, KHR = "EXT_meshopt_compression", "KHR_meshopt_compression"
# Where the uncompressed bytes lie: nowhere, in the file, in a file beside it, in one that is missing.
Fallback = Literal["none", "there", "beside", "missing"]
_SIZES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
_WIDTHS = {name: width for width, name in TYPES.items()}


def pack(
    builder: Builder, path: Path, *, version: int = 0, name: str = EXT, fallback: Fallback = "none"
) -> Path:
    """Write a .glb whose views are all compressed; sparse indices as indices, the rest as attributes."""
    gltf: dict[str, Any] = json.loads(json.dumps(builder.gltf))
    chance, binary, plain = random.Random(version), bytearray(), bytes(builder.binary)
    for number, view in enumerate(gltf["bufferViews"]):
        start, length = view["byteOffset"], view["byteLength"]
        content, size = plain[start : start + length], _element(gltf, number)
        stride, mode = view.get("byteStride", size), "ATTRIBUTES"
        if size == 2:
            mode, numbers = "INDICES", [content[k] | content[k + 1] << 8 for k in range(0, length, 2)]
            stream = encode_indices(numbers, chance)
        else:
            stream = encode_attributes(content, stride, version, chance)
        how = {"buffer": 0, "byteOffset": len(binary), "byteLength": len(stream), "byteStride": stride}
        view["buffer"] = 1
        view["extensions"] = {name: how | {"mode": mode, "count": length // stride}}
        binary += stream
    gltf["extensionsUsed"] = [*gltf.get("extensionsUsed", []), name]
    gltf["extensionsRequired"] = [name]
    kept = {"byteLength": len(plain), "extensions": {name: {"fallback": True}}}
    if fallback in ("beside", "missing"):
        kept["uri"] = "fallback.bin"
    if fallback == "there":
        for view in gltf["bufferViews"]:
            view |= {"buffer": 0, "byteOffset": view["byteOffset"] + len(binary) + -len(binary) % 4}
        binary += b"\0" * (-len(binary) % 4) + plain
    if fallback == "beside":
        (path.parent / "fallback.bin").write_bytes(plain)
    gltf["buffers"] = [{"byteLength": len(binary)}, *([kept] if fallback != "there" else [])]
    path.write_bytes(glb_bytes(gltf, bytes(binary)))
    return path


def _element(gltf: dict[str, Any], view: int) -> int:
    """Bytes of an element of whoever uses a view."""
    for accessor in gltf["accessors"]:
        width = _WIDTHS[accessor["type"]]
        sparse = accessor.get("sparse", {"indices": {}, "values": {}})
        if accessor.get("bufferView") == view or sparse["values"].get("bufferView") == view:
            return _SIZES[accessor["componentType"]] * width
        if sparse["indices"].get("bufferView") == view:
            return _SIZES[sparse["indices"]["componentType"]]
    raise ValueError(f"nobody uses view {view}")
