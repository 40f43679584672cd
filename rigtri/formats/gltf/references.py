"""Who uses what: accessors and buffer views of a glTF file, whoever refers to them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any

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
            named += _named(value, "accessor")
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
                others.update(_named(accessor[part], "bufferView"))
    for key, value in gltf.items():
        if key not in ("accessors", "bufferViews", "buffers", "animations"):
            others.update(_named(value, "bufferView"))
    unnamed = set(range(len(gltf.get("bufferViews", [])))) - of_accessors
    return others | unnamed


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


def _named(value: Any, kind: str) -> Iterator[int]:
    """Every index below ``value`` that its key marks as one of ``kind``."""
    left = [value]
    for item in left:  # it grows as it is walked
        if isinstance(item, list):
            left += [below for below in item if isinstance(below, dict | list)]
            continue
        for key, below in item.items() if isinstance(item, dict) else ():
            if type(below) is int:
                if _refers(key, kind):
                    yield below
            elif isinstance(below, list) and below and type(below[0]) in (int, float):
                yield from below if type(below[0]) is int and _refers(key, kind) else ()
            elif kind == "accessor" and key == "attributes" and isinstance(below, dict):
                yield from (k for k in below.values() if type(k) is int)
            elif kind == "accessor" and key == "targets" and isinstance(below, list):
                for target in below:
                    numbers = target.values() if isinstance(target, dict) else ()
                    yield from (k for k in numbers if type(k) is int)
            elif isinstance(below, dict | list):
                left.append(below)


@lru_cache
def _refers(key: str, kind: str) -> bool:
    # 'bufferView', 'timesAccessor', 'accessors' ... and the one name the specification gives on its own.
    return kind.lower() in key.lower() or (kind == "accessor" and key in _NAMES)


def recounted(value: Any, kind: str, moved: Mapping[int, int]) -> Any:
    """``value`` with its indices of a kind counted anew; the very object where nothing in it changes."""
    if isinstance(value, list):
        items = [recounted(item, kind, moved) for item in value]
        return value if all(new is old for new, old in zip(items, value, strict=True)) else items
    if not isinstance(value, dict):
        return value
    members = {key: _member(key, item, kind, moved) for key, item in value.items()}
    return value if all(members[key] is item for key, item in value.items()) else members


def _member(key: str, item: Any, kind: str, moved: Mapping[int, int]) -> Any:
    if key == "extras":
        return item
    if type(item) is int:
        return moved.get(item, item) if _refers(key, kind) else item
    if isinstance(item, list) and item and type(item[0]) is int:
        return _each(item, moved) if _refers(key, kind) else item
    if kind == "accessor" and key == "attributes" and isinstance(item, dict):
        return _each(item, moved)
    if kind == "accessor" and key == "targets" and isinstance(item, list):
        targets = [_each(target, moved) for target in item]
        return item if all(new is old for new, old in zip(targets, item, strict=True)) else targets
    return recounted(item, kind, moved)


def _each(holder: Any, moved: Mapping[int, int]) -> Any:
    """A list or an object of indices, counted anew."""
    if isinstance(holder, list):
        items = [moved.get(k, k) if type(k) is int else k for k in holder]
        return holder if items == holder else items
    if not isinstance(holder, dict):
        return holder
    members = {key: moved.get(k, k) if type(k) is int else k for key, k in holder.items()}
    return holder if members == holder else members
