"""Who uses what in a glTF file, and entries taken out of its lists, with all indices counted anew.

Source: glTF 2.0 §5 (which properties hold indices); KHR_animation_pointer; VRM 0.0 and 1.0.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from rigtri.errors import FileError
from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite

# Sections of the file that hold indices of a list, and the words that they stand at there.
_NODE_WORDS = "node nodes children joints skeleton source center bones ids firstPersonBone connectedNode"
_WORDS: dict[str, tuple[tuple[str, ...], frozenset[str]]] = {
    "nodes": (("nodes", "scenes", "skins", "animations", "extensions"), frozenset(_NODE_WORDS.split())),
    "meshes": (("nodes", "extensions"), frozenset({"mesh"})),
    "materials": (("meshes", "extensions"), frozenset({"material"})),
}
# Names of properties that are indices of accessors without saying so.
_NAMES = ("indices", "input", "output", "inverseBindMatrices")


def used_accessors(gltf: dict[str, Any]) -> Counter[int]:
    """How many references there are to each accessor, those of extensions included."""
    named = [skin.get("inverseBindMatrices", -1) for skin in gltf.get("skins", [])]
    for animation in gltf.get("animations", []):
        for sampler in animation.get("samplers", []):
            if isinstance(sampler, dict):
                named += sampler.get("input"), sampler.get("output")
    for key, value in gltf.items():
        if key not in ("skins", "animations", "accessors", "bufferViews", "buffers"):
            named += _named(value, "accessors")
    # 3.0 is the same number.
    return Counter(index for index in named if type(index) in (int, float))


def used_views(gltf: dict[str, Any]) -> set[int]:
    """Buffer views that anything but the bytes of an accessor refers to, or that nobody names at all."""
    others: set[int] = set()
    of_accessors: set[int] = set()
    for accessor in gltf.get("accessors", []):
        view = accessor.get("bufferView")
        if type(view) is int:
            of_accessors.add(view)
        for part in ("sparse", "extensions"):
            if part in accessor:
                others.update(_named(accessor[part], "bufferViews"))
    for key, value in gltf.items():
        if key not in ("accessors", "bufferViews", "buffers", "animations"):
            others.update(_named(value, "bufferViews"))
    unnamed = set(range(len(gltf.get("bufferViews", [])))) - of_accessors
    return others | unnamed


def check_added(gltf: dict[str, Any], written: dict[str, Any], path: Path) -> None:
    """FileError where an index of ``gltf`` that leads nowhere would lead to an entry that is added."""
    for section in ("nodes", "meshes", "materials", "accessors", "bufferViews"):
        lists = [entries for each in (gltf, written) if isinstance(entries := each.get(section, []), list)]
        if len(lists) < 2:
            continue  # nothing is added to what is no list
        before, count = map(len, lists)
        taken = [k for k in _referred(gltf, section) if before <= k < count] if count > before else []
        if taken:
            raise FileError(
                f"{path}: {section}[{taken[0]}] is referred to, but is not in the file, and what is added "
                "would take its place. Take that reference out first; rigtri check lists it"
            )


def _referred(gltf: dict[str, Any], section: str) -> Collection[int]:
    """The indices of a list that are referred to anywhere."""
    if section == "accessors":
        return used_accessors(gltf)
    if section == "bufferViews":
        named = (accessor.get("bufferView") for accessor in gltf.get("accessors", []))
        return used_views(gltf) | {index for index in named if type(index) is int}
    places = {place: gltf.get(place) for place in _WORDS[section][0]}
    if section == "nodes" and isinstance(extensions := places["extensions"], dict):
        # Graphs of other extensions have nodes of their own.
        places["extensions"] = {name: each for name, each in extensions.items() if name.startswith("VRM")}
    return {k for value in places.values() for k in _named(value, section)}


def named_nodes(gltf: dict[str, Any]) -> set[int]:
    """The nodes that extensions refer to: springs, colliders, constraints, looks, levels of detail."""
    held = [gltf.get("extensions"), *(node.get("extensions") for node in gltf.get("nodes", []))]
    return {k for value in held if value for k in _named(value, "nodes") if type(k) is int and k >= 0}


def compressed_spans(gltf: dict[str, Any]) -> Iterator[tuple[int, int, int]]:
    """Buffer, start and end of bytes that extensions of buffer views refer to, past any view."""
    for view in gltf.get("bufferViews", []):
        extensions = view.get("extensions")
        for extension in extensions.values() if isinstance(extensions, dict) else ():
            if isinstance(extension, dict):
                buffer, start, length = (
                    extension.get(key, 0) for key in ("buffer", "byteOffset", "byteLength")
                )
                if type(buffer) is type(start) is type(length) is int:
                    yield buffer, start, start + length


def _named(value: Any, section: str) -> Iterator[int]:
    """Every index below ``value`` that its key marks as one of a list of the file."""
    left = [value]
    for item in left:  # it grows as it is walked
        if isinstance(item, list):
            left += [below for below in item if isinstance(below, dict | list)]
            continue
        for key, below in item.items() if isinstance(item, dict) else ():
            if type(below) is int:
                if _refers(key, section):
                    yield below
            elif isinstance(below, list) and below and type(below[0]) in (int, float):
                if type(below[0]) is int and _refers(key, section):
                    # 3.0 is the same number.
                    yield from (int(k) for k in below if type(k) in (int, float) and k == k // 1)
            elif section == "accessors" and key == "attributes" and isinstance(below, dict):
                yield from (k for k in below.values() if type(k) is int)
            elif section == "accessors" and key == "targets" and isinstance(below, list):
                for target in below:
                    numbers = target.values() if isinstance(target, dict) else ()
                    yield from (k for k in numbers if type(k) is int)
            elif isinstance(below, dict | list):
                left.append(below)


@lru_cache
def _refers(key: str, section: str) -> bool:
    if section in _WORDS:
        return key in _WORDS[section][1]
    # 'bufferView', 'timesAccessor', 'accessors' ... and the one name the specification gives on its own.
    return section[:-1].lower() in key.lower() or (section == "accessors" and key in _NAMES)


def take_out(draft: CopyOnWrite, section: str, gone: Collection[int]) -> dict[int, int]:
    """Take entries out of a list and count references to the others anew: old number → new."""
    entries = draft.gltf[section]
    kept = [number for number in range(len(entries)) if number not in gone]
    moved = {old: new for new, old in enumerate(kept)}
    draft.edit(section)[:] = [entries[number] for number in kept]
    if any(old != new for old, new in moved.items()):
        for place in draft.gltf:
            new = _recounted(draft.gltf[place], section, moved) if _holds(place, section) else None
            if new is not None and new is not draft.gltf[place]:
                draft.edit(place)  # so that the whole counts as changed
                draft.gltf[place] = new
    return moved


def _holds(place: str, section: str) -> bool:
    """Whether a section of the file may refer to entries of a list."""
    if section in _WORDS:
        return place in _WORDS[section][0]
    return place not in ("buffers", section) and (section, place) != ("accessors", "bufferViews")


def _recounted(value: Any, section: str, moved: Mapping[int, int]) -> Any:
    """``value`` with its indices of a list counted anew; the very object where nothing in it changes."""
    if isinstance(value, list):
        items = [_recounted(item, section, moved) for item in value]
        return value if all(new is old for new, old in zip(items, value, strict=True)) else items
    if not isinstance(value, dict):
        return value
    members = {key: _member(key, item, section, moved) for key, item in value.items()}
    return value if all(members[key] is item for key, item in value.items()) else members


def _member(key: str, item: Any, section: str, moved: Mapping[int, int]) -> Any:
    if key == "extras":
        return item
    if type(item) is int:
        number = moved.get(item, item) if _refers(key, section) else item
        return item if number == item else number
    if key == "pointer" and isinstance(item, str):
        pattern = rf"/{section}/([0-9]{{1,18}})(?=/|$)"
        pointer = re.sub(pattern, lambda m: f"/{section}/{moved.get(int(m[1]), m[1])}", item)
        return item if pointer == item else pointer
    if isinstance(item, list) and item and type(item[0]) is int:
        return _each(item, moved) if _refers(key, section) else item
    if section == "accessors" and key == "attributes" and isinstance(item, dict):
        return _each(item, moved)
    if section == "accessors" and key == "targets" and isinstance(item, list):
        targets = [_each(target, moved) for target in item]
        return item if all(new is old for new, old in zip(targets, item, strict=True)) else targets
    return _recounted(item, section, moved)


def _each(holder: Any, moved: Mapping[int, int]) -> Any:
    """A list or an object of indices, counted anew."""
    if isinstance(holder, list):
        items = [moved.get(k, k) if type(k) is int else k for k in holder]
        return holder if items == holder else items
    if not isinstance(holder, dict):
        return holder
    members = {key: moved.get(k, k) if type(k) is int else k for key, k in holder.items()}
    return holder if members == holder else members
