"""Nodes taken out of a draft, and what only they were using.

What stands at the end of its list goes without any other number changing. What has come to
stand between others goes where all that may count is known; else nodes are refused, and the rest
stays, unused, in its place.

Source: glTF 2.0 §5; KHR_animation_pointer; VRM 0.0 and 1.0.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import Any

from rigtri.errors import FileError
from rigtri.formats.gltf.animation_channels import drop_channels, drop_empty_animations
from rigtri.formats.gltf.buffer_writer import Storage
from rigtri.formats.gltf.garbage_collect import collect_garbage
from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite
from rigtri.formats.gltf.references import take_out

# Meshes and materials that rigtri draws shapes with; others stay, whoever used them.
_OURS = {"meshes": re.compile("rigtri_"), "materials": re.compile("rigtri_[0-9a-f]{6}$")}
# How extensions begin whose indices of these kinds all stand at those words, or that have none. Not KHR_
# alone: KHR_interactivity counts nodes in values of its graphs, and other drafts in words of their own.
_KNOWN = (
    "EXT_lights",
    "EXT_mesh",
    "EXT_texture",
    "GODOT_single_root",
    "KHR_animation_pointer",
    "KHR_audio",
    "KHR_draco",
    "KHR_gaussian_splatting",
    "KHR_implicit_shapes",
    "KHR_lights",
    "KHR_materials",
    "KHR_mesh",
    "KHR_node",
    "KHR_physics_rigid_bodies",
    "KHR_skeleton_bone",
    "KHR_texture",
    "KHR_xmp",
    "MSFT_lod",
    "VRM",
)


def prune(draft: CopyOnWrite, storage: Storage, nodes: Collection[int]) -> None:
    """Take nodes out of the file, by their indices there, with the shapes and keys that were theirs alone."""
    gltf = draft.gltf
    meshes = {gltf["nodes"][node].get("mesh") for node in nodes} - {None}
    _detach(draft, nodes)
    _drop(draft, "nodes", nodes)
    _drop_empty_skins(draft)
    meshes = _unneeded(gltf, "meshes", meshes, {node.get("mesh") for node in gltf.get("nodes", ())})
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
    for number, skin in enumerate(gltf.get("skins", [])):
        if skin.get("skeleton") in nodes:  # not above the joints that stay, so it says nothing of these
            draft.edit("skins", number).pop("skeleton")
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
    if not gone:
        return False
    at_the_end = min(gone) == len(draft.gltf[kind]) - len(gone)
    if not at_the_end and (unknown := _unknown(draft.gltf)):
        if kind != "nodes":
            return False
        raise FileError(
            f"Nodes that stay would get other numbers, and {unknown} may hold numbers of nodes at places "
            "that rigtri does not know. Take that extension out first"
        )
    take_out(draft, kind, gone)
    if not draft.gltf[kind]:
        draft.gltf.pop(kind)
    return True


def _unknown(gltf: dict[str, Any]) -> str:
    """An extension in use that may hold indices at words of its own, "" where there is none."""
    used = map(str, gltf.get("extensionsUsed", []))
    return next((name for name in used if not name.startswith(_KNOWN)), "")
