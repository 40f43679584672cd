"""Indices that point at nothing, members of a wrong type, and extensions, wherever they stand.

What nodes, scenes, skins and animations refer to is judged where it is read; here
is the rest of a file. Source: glTF 2.0 §5 (properties reference); §3.12 (extensions).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rigtri.formats.json_values import short_repr
from rigtri.verification.checks.gltf.tolerant_reader import Item, View, one, titled

# Where indices stand (* is any item), and which list they count.
_PRIMITIVE = "meshes/*/primitives/*"
_TEXTURE = "materials/*"
PLACES = (
    (f"{_PRIMITIVE}/attributes/*", "accessors"),
    (f"{_PRIMITIVE}/targets/*/*", "accessors"),
    (f"{_PRIMITIVE}/indices", "accessors"),
    (f"{_PRIMITIVE}/material", "materials"),
    ("nodes/*/camera", "cameras"),
    (f"{_TEXTURE}/pbrMetallicRoughness/baseColorTexture/index", "textures"),
    (f"{_TEXTURE}/pbrMetallicRoughness/metallicRoughnessTexture/index", "textures"),
    (f"{_TEXTURE}/normalTexture/index", "textures"),
    (f"{_TEXTURE}/occlusionTexture/index", "textures"),
    (f"{_TEXTURE}/emissiveTexture/index", "textures"),
    ("textures/*/source", "images"),
    ("textures/*/sampler", "samplers"),
    ("images/*/bufferView", "bufferViews"),
    ("accessors/*/bufferView", "bufferViews"),
    ("accessors/*/sparse/indices/bufferView", "bufferViews"),
    ("accessors/*/sparse/values/bufferView", "bufferViews"),
    ("bufferViews/*/buffer", "buffers"),
)

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
_OF_PRIMITIVE = {"mode": "integer", "attributes": "object", "targets": "list"}
_TYPES = {"integer": int, "text": str, "list": list, "object": dict, "boolean": bool}


def check_types(view: View) -> None:
    """Note every member of the table that is there and of another type."""
    for section, members in _MEMBERS.items():
        for number, raw in enumerate(view.lists[section]):
            if not _fits(raw, members):  # what to call each of thousands is put together where it is told
                _check_members(view.item(section, number), members)
    for mesh in view.each("meshes"):
        for primitive in mesh.objects("primitives"):
            _check_members(primitive, _OF_PRIMITIVE)


def _fits(raw: dict[str, Any], members: dict[str, str]) -> bool:
    """Whether all members that are there are just of their types."""
    return all(key not in raw or type(raw[key]) is _TYPES[kind] for key, kind in members.items())


def _check_members(item: Item, members: dict[str, str]) -> None:
    for key, kind in members.items():
        value = item.raw.get(key, _TYPES[kind]())
        if not isinstance(value, _TYPES[kind]) or (kind == "integer" and isinstance(value, bool)):
            article = "an" if kind[0] in "aio" else "a"
            item.add("gltf.json.value", f"{key} should be {article} {kind}, not {short_repr(value)}", key)


def check(view: View) -> None:
    """All indices that no other check reads."""
    for path, among in PLACES:
        items = view.raw.get(among)
        count = len(items) if isinstance(items, list) else 0
        for pointer, raw in _found(view.raw, path.split("/"), ""):
            if type(raw) is not int or not 0 <= raw < count:
                view.index(raw, count, one(among), _pointer_text(view, pointer), pointer)


def _found(value: Any, path: list[str], pointer: str) -> Iterator[tuple[str, Any]]:
    """What stands at a path, with its JSON pointer."""
    if not path:
        yield pointer, value
    elif path[0] != "*":
        if isinstance(value, dict) and path[0] in value:
            yield from _found(value[path[0]], path[1:], f"{pointer}/{path[0]}")
    elif isinstance(value, (dict, list)):
        key = path[1] if len(path) > 1 else "*"
        for place, item in value.items() if isinstance(value, dict) else enumerate(value):
            if key == "*" or (isinstance(item, dict) and key in item):
                yield from _found(item, path[1:], f"{pointer}/{place}")


def _pointer_text(view: View, pointer: str) -> str:
    _, key, number, *inner = pointer.split("/")
    place = titled(one(key), view.raw[key][int(number)], int(number))
    return f"{place}, primitive {inner[1]}" if inner[:1] == ["primitives"] else place


def extensions(raw: dict[str, Any]) -> dict[str, str]:
    """The names of all extensions that objects of a file have, each with the first place that has it."""
    found: dict[str, str] = {}
    waiting: list[tuple[str, Any]] = [("", raw)]
    while waiting:
        pointer, value = waiting.pop()
        own = value.get("extensions") if isinstance(value, dict) else None
        for name in own if isinstance(own, dict) else ():
            found.setdefault(name, f"{pointer}/extensions")
        items: Any = enumerate(value) if isinstance(value, list) else value.items()
        for key, item in items:
            # Extras are anybody's, whatever they are called in there.
            if isinstance(item, (dict, list)) and key != "extras":
                waiting.append((f"{pointer}/{key}", item))
    return found
