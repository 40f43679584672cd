"""What must hold for a glTF file before its parts are read.

Source: glTF 2.0 §3.2 (JSON encoding), §3.12 (extensions).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from rigtri.formats.json_values import Value, index_of, object_at, object_in
from rigtri.report import Notice

LISTS = (
    "accessors",
    "animations",
    "buffers",
    "bufferViews",
    "cameras",
    "images",
    "meshes",
    "nodes",
    "scenes",
    "skins",
)
# What a node shows and hands over when its axes turn.
LIGHT, INSTANCING = "KHR_lights_punctual", "EXT_mesh_gpu_instancing"
SHOWN_EXTENSIONS = (LIGHT, INSTANCING)
_LINES = (1, 2, 3)  # the modes LINES, LINE_LOOP and LINE_STRIP of glTF 2.0 §3.7.2.1
# Required extensions that change how things look or are stored, never how joints move.
_HARMLESS_REQUIRED = (
    "EXT_lights",
    "EXT_mesh",
    "EXT_meshopt_compression",
    "EXT_texture",
    "GODOT_single_root",
    "KHR_animation_pointer",
    "KHR_draco",
    "KHR_lights",
    "KHR_materials",
    "KHR_mesh",
    "KHR_node",
    "KHR_texture",
    "KHR_xmp",
    "VRM",
)


# A JSON pointer to what a node does: its number, or a template that a graph fills in.
_TRANSFORM = re.compile(
    r"/nodes/([0-9]{1,9}|{[^/]*})/(translation|rotation|scale|matrix|globalMatrix)(?=/|$)"
)


def check_lists(gltf: Value) -> None:
    """All top-level lists are lists of objects. FileError otherwise."""
    for key in (*LISTS, "extensionsUsed", "extensionsRequired", "extensions", "scene"):
        if key in gltf.object():
            # A null is not the same as nothing, and no reader behind this one looks out for it.
            value = gltf.need(key)
            if key in LISTS and not {*map(type, value.entries())} <= {dict}:
                for item in value.items():
                    item.object()


def check_references(gltf: Value) -> None:
    """Scenes, and the skins of nodes, point at what is there. FileError otherwise."""
    raw = gltf.object()
    nodes, skins = len(raw.get("nodes", [])), len(raw.get("skins", []))
    for scene in gltf.each("scenes"):
        for node in scene.each("nodes"):
            node.index(nodes, "node")
    default = gltf.get("scene")
    if default is not None:
        default.index(len(raw.get("scenes", [])), "scene")
    for number, held in enumerate(raw.get("nodes", [])):
        if "skin" not in held and "extensions" not in held:
            continue
        item = Value(held, f"{gltf.where} nodes[{number}]")
        skin = item.get("skin")
        if skin is not None:
            skin.index(skins, "skin")
        if "extensions" in held:
            item.need("extensions").object()


def check_extensions(gltf: Value, notices: list[Notice]) -> None:
    """Say which required extensions rigtri does not know; it keeps them."""
    used = {item.text() for item in gltf.each("extensionsUsed")}
    required = {item.text() for item in gltf.each("extensionsRequired")}
    unknown = unknown_required(required)
    if unknown:
        text = f"The file requires {', '.join(unknown)}, which rigtri does not know; it is kept as it is"
        notices.append(Notice("extension-unknown", text))
    if required - used:
        missing = ", ".join(sorted(required - used))
        notices.append(Notice("extension-undeclared", f"{missing}: required, but not in extensionsUsed"))


def unknown_required(names: Iterable[str]) -> list[str]:
    """The required extensions that rigtri does not know to leave joints and storage alone."""
    return sorted(name for name in names if not name.startswith(_HARMLESS_REQUIRED))


@cache
def _node_extensions() -> Mapping[str, Mapping[str, Any]]:
    """What node_extensions.toml says of each extension that rigtri knows."""
    import tomllib  # few files have any

    return tomllib.loads(Path(__file__).with_name("node_extensions.toml").read_text("utf-8"))


def extension_in_axes(node: Mapping[str, Any]) -> tuple[str, str]:
    """An extension whose vectors lie in the node's own axes, or may, and why; two empty texts for none."""
    for name, content in (node.get("extensions") or {}).items():
        known = _node_extensions().get(name)
        if known is None:
            return name, f"its extension {name} may hold directions in its axes; rigtri does not know it"
        held = next((path for path in known["axes"] if _has(content, path.split("."))), "")
        if held:
            return name, f"its extension {name} holds '{held}' in its axes"
        later = (
            content.keys() - {*known["free"], "extras"}
            if "free" in known and isinstance(content, dict)
            else ()
        )
        if later:
            return name, f"its extension {name} may hold '{min(later)}' in its axes; rigtri does not know it"
    return "", ""


def _has(content: object, path: Sequence[str]) -> bool:
    """Whether an object has a member, by the keys that lead there."""
    first, *rest = path
    if not isinstance(content, dict) or first not in content:
        return False
    return not rest or _has(content[first], rest)


def referred_frames(gltf: Mapping[str, Any], above: Sequence[int]) -> dict[int, tuple[str, str]]:
    """Nodes whose axes an extension of others, or of the file, means: its name and why, by file index.

    Of an extension that is not known, what any ``connectedNode`` names and any pointer addresses.
    """
    found: dict[int, tuple[str, str]] = {}
    for holder, name, content in _extensions(gltf):
        known = _node_extensions().get(name)
        for path, item in _frames(content) if known is None else _members(content, known.get("frames", ())):
            if (other := index_of(item, len(above))) is not None:
                why = f"the extension {name}{holder} measures by its axes: '{path}' names it"
                found.setdefault(other, (name, why))
        if known is None or known.get("pointers"):
            for node, pointer in _addressed(content, above):
                why = f"the extension {name}{holder} addresses '{pointer}', numbers in its axes"
                found.setdefault(node, (name, why))
    return found


def unread_extensions(gltf: Mapping[str, Any]) -> tuple[str, ...]:
    """Extensions that are not known and may mean joints: those of the file, others that hold their numbers.

    Those of a node keep its own axes, and are listed there.
    """
    held = [each for each in _extensions(gltf) if each[1] not in _node_extensions()]
    at_nodes = {name for holder, name, _ in held if holder.startswith(" of node ")}
    found = {name for holder, name, _ in held if not holder} - at_nodes
    joints = {joint for skin in gltf.get("skins", []) for joint in skin.get("joints", [])}
    for holder, name, content in held:
        numbers = {item for item in _walked(content) if type(item) in (int, float)} if holder else set()
        where, number = holder.rsplit("#", 1) if holder else ("", "")
        own = {int(number)} if where == " of node " else set()
        listed = {index_of(item, len(gltf["nodes"])) for _, item in _frames(content)}
        if numbers & joints - own - listed:
            found.add(name)
    return tuple(unknown_required(found))


def _extensions(gltf: Mapping[str, Any]) -> Iterator[tuple[str, str, object]]:
    """Extensions that may mean joints: of what, in words, with the name and what it holds."""
    held = [("", gltf)]
    for section, one in (("nodes", "node"), ("scenes", "scene"), ("skins", "skin"), ("meshes", "mesh")):
        listed = enumerate(gltf.get(section, []))
        held += [(f" of {one} #{number}", each) for number, each in listed if "extensions" in each]
    for holder, each in held:
        extensions = each.get("extensions")
        for name, content in extensions.items() if isinstance(extensions, dict) else ():
            if not name.startswith("VRM"):
                yield holder, name, content


def _members(content: object, paths: Iterable[str]) -> Iterator[tuple[str, object]]:
    """What an object holds at paths."""
    for path in paths:
        item = content
        for key in path.split("."):
            item = item.get(key) if isinstance(item, dict) else None
        yield path, item


def _frames(content: object) -> Iterator[tuple[str, object]]:
    """Every ``connectedNode`` of an extension."""
    return (
        ("connectedNode", item["connectedNode"])
        for item in _walked(content)
        if isinstance(item, dict) and "connectedNode" in item
    )


def _walked(content: object) -> Iterator[object]:
    """A JSON value and all values in it."""
    left = [content]
    for item in left:  # it grows as it is walked
        if isinstance(item, dict | list):
            left += item.values() if isinstance(item, dict) else item
        yield item


def _addressed(content: object, above: Sequence[int]) -> Iterator[tuple[int, str]]:
    """The nodes in whose axes transforms are that pointers address: node or parent, of a template all."""
    for item in _walked(content):
        if isinstance(item, str) and (match := _TRANSFORM.match(item)):
            named = range(len(above)) if match[1].startswith("{") else [int(match[1])]
            for node in named:
                if node < len(above):
                    yield from ((k, item) for k in (node, above[node]) if k >= 0)


def shows(node: Mapping[str, Any]) -> bool:
    """Whether a node itself shows a mesh, camera, light or instances."""
    used = node.get("extensions") or {}
    return "mesh" in node or "camera" in node or any(name in used for name in SHOWN_EXTENSIONS)


def _shows_lines(node: Mapping[str, Any], meshes: Any) -> bool:
    """Whether a node itself shows lines and nothing else, or what nobody can read.

    meshes: those of the file, as they stand there.
    """
    used = object_in(node, "extensions")
    if {"camera", "skin"} & node.keys() or any(name in used for name in SHOWN_EXTENSIONS):
        return False
    primitives = (object_at(meshes, node.get("mesh")) or {}).get("primitives")
    found = (one for one in (primitives if isinstance(primitives, list) else ()) if isinstance(one, dict))
    return all(one.get("mode", 4) in _LINES for one in found)


def lines_shown(nodes: Sequence[Mapping[str, Any]], meshes: Any) -> frozenset[int]:
    """The nodes, by place, that show lines and nothing else, or a mesh that nobody can read."""
    return frozenset(k for k, node in enumerate(nodes) if "mesh" in node and _shows_lines(node, meshes))
