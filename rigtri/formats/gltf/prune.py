"""Nodes taken out of a draft, and what only they were using.

What stands at the end of its list goes without any other number changing. What has come to
stand between others goes where all that may count is known; else nodes are refused, and the rest
stays, unused, in its place.

Source: glTF 2.0 §5 (which properties hold indices); KHR_animation_pointer; VRM 0.0 and 1.0.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection
from typing import Any

from rigtri.errors import FileError
from rigtri.formats.gltf.animation_channels import drop_channels, drop_empty_animations
from rigtri.formats.gltf.buffer_writer import Storage
from rigtri.formats.gltf.garbage_collect import collect_garbage
from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite

# Meshes and materials that rigtri draws shapes with; others stay, whoever used them.
_OURS = {"meshes": re.compile("rigtri_"), "materials": re.compile("rigtri_[0-9a-f]{6}$")}
# Sections of the file that hold indices of a kind, and the words that they stand at there.
_NODE_WORDS = "node nodes children joints skeleton source center bones ids firstPersonBone"
_WORDS: dict[str, tuple[tuple[str, ...], frozenset[str]]] = {
    "nodes": (("nodes", "scenes", "skins", "animations", "extensions"), frozenset(_NODE_WORDS.split())),
    "meshes": (("nodes", "extensions"), frozenset({"mesh"})),
    "materials": (("meshes", "extensions"), frozenset({"material"})),
}
# Extensions whose indices of these kinds all stand at those words, or that have none.
_KNOWN = ("EXT_mesh", "EXT_texture", "GODOT_single_root", "KHR_", "MSFT_lod", "VRM")


def prune(draft: CopyOnWrite, storage: Storage, nodes: Collection[int]) -> None:
    """Take nodes out of the file, by their indices there, with the shapes and keys that were theirs alone."""
    gltf = draft.gltf
    meshes = {gltf["nodes"][node].get("mesh") for node in nodes} - {None}
    _detach(draft, nodes)
    _drop(draft, "nodes", nodes)
    _drop_empty_skins(draft)
    meshes = _unneeded(gltf, "meshes", meshes, {node.get("mesh") for node in gltf["nodes"]})
    materials = {p.get("material") for mesh in meshes for p in gltf["meshes"][mesh]["primitives"]} - {None}
    dropped = _drop(draft, "meshes", meshes)
    rest = {p.get("material") for mesh in gltf.get("meshes", []) for p in mesh.get("primitives", ())}
    if dropped:
        _drop(draft, "materials", _unneeded(gltf, "materials", materials, rest))
    collect_garbage(draft, storage, renumber=not _unknown(gltf))


def _detach(draft: CopyOnWrite, nodes: Collection[int]) -> None:
    """Take nodes out of lists of children, scenes and joints, and channels away that drive them."""
    gltf = draft.gltf
    for section, key in (("nodes", "children"), ("scenes", "nodes"), ("skins", "joints")):
        for number, holder in enumerate(gltf.get(section, [])):
            inside = holder.get(key)
            if inside and any(node in nodes for node in inside):
                owned = draft.edit(section, number)
                owned[key] = [node for node in inside if node not in nodes]
                if not owned[key]:
                    owned.pop(key)
    for number, animation in enumerate(gltf.get("animations", [])):
        channels = animation.get("channels", [])
        lost = {k for k, c in enumerate(channels) if c.get("target", {}).get("node") in nodes}
        if lost:
            drop_channels(draft, number, lost)
    drop_empty_animations(draft)


def _drop_empty_skins(draft: CopyOnWrite) -> None:
    """A skin without joints is not allowed; those of ours come last, and nothing is drawn with them."""
    skins = draft.gltf.get("skins", [])
    while skins and "joints" not in skins[-1]:
        draft.edit("skins").pop()
        skins = draft.gltf["skins"]
    if "skins" in draft.gltf and not skins:
        draft.gltf.pop("skins")


def _unneeded(
    gltf: dict[str, Any], kind: str, candidates: Collection[Any], used: Collection[Any]
) -> set[int]:
    """The candidates of ours that nothing uses any more."""
    ours = _OURS[kind]
    return {k for k in candidates if k not in used and ours.match(str(gltf[kind][k].get("name", "")))}


def _drop(draft: CopyOnWrite, kind: str, gone: Collection[int]) -> bool:
    """Take entries out of a list and count the others anew; False where they have to stay."""
    entries = draft.gltf.get(kind, [])
    if not gone:
        return False
    count = len(entries)
    at_the_end = min(gone) == count - len(gone)
    if not at_the_end and (unknown := _unknown(draft.gltf)):
        if kind != "nodes":
            return False
        raise FileError(
            f"What rigtri added stands between other nodes, and {unknown} may count nodes in ways that "
            "rigtri does not know. Take that extension out first"
        )
    draft.edit(kind)[:] = [entry for k, entry in enumerate(entries) if k not in gone]
    if not at_the_end:
        _renumber(draft, kind, _moves(count, gone))
    if not draft.gltf[kind]:
        draft.gltf.pop(kind)
    return True


def _unknown(gltf: dict[str, Any]) -> str:
    """An extension in use that may hold indices at words of its own, "" where there is none."""
    used = map(str, gltf.get("extensionsUsed", []))
    return next((name for name in used if not name.startswith(_KNOWN)), "")


def _moves(count: int, gone: Collection[int]) -> dict[int, int]:
    """Old index → new index of what stays."""
    kept = [k for k in range(count) if k not in gone]
    return {old: new for new, old in enumerate(kept)}


def _renumber(draft: CopyOnWrite, kind: str, moved: dict[int, int]) -> None:
    sections, words = _WORDS[kind]
    pointer = re.compile(rf"/{kind}/(\d+)(?=/|$)")

    def text(match: re.Match[str]) -> str:
        old = int(match[1])
        return f"/{kind}/{moved.get(old, old)}"

    for section in sections:
        if section in draft.gltf:
            draft.edit(section)  # so that the whole counts as changed
            draft.gltf[section] = _renumbered(
                draft.gltf[section], words, moved, lambda value: pointer.sub(text, value)
            )


def _renumbered(value: Any, words: frozenset[str], moved: dict[int, int], point: Callable[[str], str]) -> Any:
    """``value`` with its indices counted anew; the very object where nothing in it changes."""
    if isinstance(value, list):
        items = [_renumbered(item, words, moved, point) for item in value]
        return value if all(new is old for new, old in zip(items, value, strict=True)) else items
    if not isinstance(value, dict):
        return value
    members: dict[str, Any] = {}
    for key, item in value.items():
        if key == "extras":
            members[key] = item
        elif key in words and type(item) is int:
            members[key] = moved.get(item, item)
        elif key in words and isinstance(item, list) and item and type(item[0]) is int:
            members[key] = [moved.get(k, k) for k in item]
        elif key == "pointer" and isinstance(item, str):
            members[key] = point(item)
        else:
            members[key] = _renumbered(item, words, moved, point)
    same = all(members[key] is item or members[key] == item for key, item in value.items())
    return value if same else members
