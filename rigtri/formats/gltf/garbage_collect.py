"""Numbers of ours that nothing uses any more, taken out of a draft and of its buffers.

What is ours lies in buffer views of our name; what a file brought along stays, used or not.

Source: glTF 2.0 §3.6.
"""

from __future__ import annotations

import sys
from collections.abc import Collection, Iterable
from typing import Any

from rigtri.errors import FileError
from rigtri.formats.gltf.buffer_writer import OWN_NAME, Storage
from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite
from rigtri.formats.gltf.references import compressed_spans, take_out, used_accessors, used_views

_Span = tuple[int, int]


def collect_garbage(draft: CopyOnWrite, storage: Storage, *, renumber: bool) -> None:
    """Drop accessors of ours that nobody uses, views that are left empty, and their bytes.

    renumber: whether others may get new numbers; else only what stands at the ends of lists goes.
    """
    gltf = draft.gltf
    accessors = _dead(gltf, storage)
    if not renumber:
        accessors = _last(len(gltf.get("accessors", [])), accessors)
    if not accessors:
        return
    views = _emptied(gltf, accessors)
    if not renumber:
        views = _last(len(gltf["bufferViews"]), views)
    _drop_bytes(draft, storage, accessors, views)
    take_out(draft, "accessors", accessors)
    storage.count_anew(take_out(draft, "bufferViews", views))
    last = gltf["buffers"][-1]
    if last.get("name") == OWN_NAME and not last["byteLength"] and not storage.grows:
        draft.edit("buffers").pop()
    for kind in ("accessors", "bufferViews", "buffers"):
        if not gltf[kind]:
            gltf.pop(kind)


def _last(count: int, numbers: Collection[int]) -> set[int]:
    """Those of some numbers below ``count`` that only such follow."""
    first = count
    while first - 1 in numbers:
        first -= 1
    return set(range(first, count))


def _dead(gltf: dict[str, Any], storage: Storage) -> set[int]:
    """Accessors of the source in views of ours, which nobody refers to, and whose bytes we may take."""
    used, views = used_accessors(gltf), gltf.get("bufferViews", [])
    found = set()
    for index, accessor in enumerate(gltf.get("accessors", [])):
        view = accessor.get("bufferView", -1)
        if index in used or not 0 <= view < len(views) or views[view].get("name") != OWN_NAME:
            continue
        try:
            if storage.span(index)[0] >= 0:
                found.add(index)
        except FileError:
            continue  # another tool has broken it
    return found


def _emptied(gltf: dict[str, Any], accessors: Collection[int]) -> set[int]:
    """The views that only some accessors lie in."""
    views = {gltf["accessors"][index]["bufferView"] for index in accessors}
    others = {a.get("bufferView") for k, a in enumerate(gltf["accessors"]) if k not in accessors}
    return views - others - used_views(gltf)


def _drop_bytes(
    draft: CopyOnWrite, storage: Storage, accessors: Collection[int], views: Collection[int]
) -> None:
    """Take the bytes of accessors out of buffers, of all of a view where it goes, and move what follows.

    Where anybody else's lie there, they stay.
    """
    gltf = draft.gltf
    spans: dict[int, set[_Span]] = {}
    for index in accessors:
        buffer, start, end = storage.span(index)
        if (number := gltf["accessors"][index]["bufferView"]) in views:
            view = gltf["bufferViews"][number]
            start = view.get("byteOffset", 0)
            end = start + view["byteLength"]
        spans.setdefault(buffer, set()).add((-(-start // 4) * 4, end // 4 * 4))
    for buffer, ends in spans.items():
        taken = list(_taken(gltf, storage, buffer, accessors))
        gone = [
            (start, end)
            for start, end in sorted(ends)
            if start < end and not any(first < end and start < last for first, last in taken)
        ]
        left = gltf["buffers"][buffer]["byteLength"] - sum(end - start for start, end in gone)
        own = gltf["buffers"][buffer].get("name") == OWN_NAME and buffer == len(gltf["buffers"]) - 1
        packed = any(at == buffer and gone and end > gone[0][0] for at, _, end in compressed_spans(gltf))
        if gone and not packed and (left or own):
            _close_up(draft, buffer, gone)
            storage.remove(buffer, gone)


def _taken(
    gltf: dict[str, Any], storage: Storage, buffer: int, accessors: Collection[int]
) -> Iterable[_Span]:
    """Bytes of a buffer that others need: whole views of others, accessors that stay in ours."""
    for view in gltf["bufferViews"]:
        if view.get("buffer") == buffer and view.get("name") != OWN_NAME:
            # One that says no length, which is for its reader to refuse, may need all that follows.
            start = view.get("byteOffset", 0)
            yield start, start + view.get("byteLength", sys.maxsize)
    for index in range(len(gltf["accessors"])):
        view = gltf["accessors"][index].get("bufferView", -1)
        if index not in accessors and view >= 0 and gltf["bufferViews"][view].get("name") == OWN_NAME:
            try:
                at, start, end = storage.span(index)
            except FileError:
                continue
            if at == buffer:
                yield start, end


def _close_up(draft: CopyOnWrite, buffer: int, gone: list[_Span]) -> None:
    """Let views and accessors begin where their bytes come to lie."""

    def before(place: int) -> int:
        return sum(min(end, place) - start for start, end in gone if start < place)

    gltf = draft.gltf
    starts = {
        number: view.get("byteOffset", 0)
        for number, view in enumerate(gltf["bufferViews"])
        if view.get("buffer") == buffer
    }
    for index, accessor in enumerate(gltf["accessors"]):
        start = starts.get(accessor.get("bufferView", -1), -1)
        if start >= 0 and "byteOffset" in accessor:
            offset = accessor["byteOffset"]
            less = before(start + offset) - before(start)
            if less:
                draft.edit("accessors", index)["byteOffset"] = offset - less
    for number, start in starts.items():
        view = gltf["bufferViews"][number]
        inside = before(start + view["byteLength"]) - before(start)
        if inside or before(start):
            owned = draft.edit("bufferViews", number)
            owned["byteLength"] -= inside
            if before(start):
                owned["byteOffset"] = start - before(start)
