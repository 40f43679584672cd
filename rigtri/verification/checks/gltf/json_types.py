"""Members of the JSON whose type is wrong, where nothing else looks at it.

Source: glTF 2.0 §5 (properties reference).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rigtri.formats.json_values import short_repr
from rigtri.verification.checks.gltf.tolerant_reader import View

# Holder → member → what it should be.
_MEMBERS: dict[str, dict[str, str]] = {
    "accessors": {
        "count": "integer", "componentType": "integer", "byteOffset": "integer", "bufferView": "integer",
        "normalized": "boolean", "type": "text",
    },
    "bufferViews": {
        "buffer": "integer", "byteOffset": "integer", "byteLength": "integer", "byteStride": "integer",
        "target": "integer",
    },
    "buffers": {"byteLength": "integer"},
    "meshes": {"primitives": "list", "weights": "list"},
    "skins": {"joints": "list"},
    "animations": {"channels": "list", "samplers": "list"},
    "images": {"uri": "text", "mimeType": "text", "bufferView": "integer"},
}  # fmt: skip
_PRIMITIVE = {"mode": "integer", "attributes": "object", "targets": "list"}


def check(view: View) -> None:
    """Note every member of the table that is there and of another type."""
    for key, members in _MEMBERS.items():
        for number, item in _objects(view.raw.get(key)):
            _check(view, item, members, f"{key} #{number}", f"/{key}/{number}")
    for number, mesh in _objects(view.raw.get("meshes")):
        for place, primitive in _objects(mesh.get("primitives")):
            _check(view, primitive, _PRIMITIVE, f"meshes #{number}", f"/meshes/{number}/primitives/{place}")


def _check(view: View, item: dict[str, Any], members: dict[str, str], place: str, pointer: str) -> None:
    for key, kind in members.items():
        if key in item and not _is(item[key], kind):
            article = "an" if kind[0] in "aio" else "a"
            words = f"{key} should be {article} {kind}, not {short_repr(item[key])}"
            view.add("gltf.json.value", place, f"{pointer}/{key}", words)


def _objects(found: Any) -> Iterator[tuple[int, dict[str, Any]]]:
    if isinstance(found, list):
        yield from ((number, item) for number, item in enumerate(found) if isinstance(item, dict))


def _is(value: Any, kind: str) -> bool:
    if isinstance(value, bool):
        return kind == "boolean"
    known = {"integer": int, "text": str, "list": list, "object": dict, "boolean": bool}
    return isinstance(value, known[kind])
