"""How two glTF files differ as files: JSON, spelling, chunks, accessors, views, loose bytes, images."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache, cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np

from rigtri.errors import FileError
from rigtri.formats import ReadOptions
from rigtri.formats.gltf.accessors import Accessors
from rigtri.formats.gltf.buffers import Buffers
from rigtri.formats.gltf.container import BIN_CHUNK, JSON_CHUNK, Container, open_container
from rigtri.formats.gltf.structure import check_lists
from rigtri.formats.gltf.uris import decode_data, file_of, is_data
from rigtri.formats.json_values import Value
from rigtri.verification.diff.change import Change, arrow, furthest, same_numbers
from rigtri.verification.diff.json_diff import json_changes, spelling_changes, tokens

# Bytes compared at once.
_BLOCK = 1 << 20
# Fewer bytes than this that are zero are there to align what follows.
_ALIGNMENT = 4


def file_changes(before: Path, after: Path, options: ReadOptions, tolerance: float) -> list[Change]:
    """Everything in which the second file is not the first. FileError where one is no glTF at all."""
    one, other = _Side(before, options), _Side(after, options)
    contents = cache(partial(_contents, one, other, tolerance))
    found: list[Change] = []
    if one.text != other.text:
        found += json_changes(one.json, other.json, contents, tolerance)
        found += spelling_changes(one.text, other.text)
    if not found and not tolerance and one.text != other.text:
        at = next((k for k, (a, b) in enumerate(zip(one.text, other.text, strict=False)) if a != b), 0)
        found.append(Change("spelling", "changed", "text", f"blanks or escapes, from character {at} on"))
    found += _chunks(one.container, other.container)
    found += _accessors(one, other, contents)
    found += _views(one, other, tolerance)
    found += _loose_bytes(one, other)
    found += _images(one, other)
    return found


class _Side:
    """A file taken apart; what cannot be read of its data is None: the JSON shows what differs."""

    def __init__(self, path: Path, options: ReadOptions) -> None:
        self.path, self.options = path, options
        self.container = open_container(path, lenient=True)
        content = self.container.chunks[0][1] if self.container.is_glb else self.container.source
        self.text = str(content, "utf-8")
        if self.container.is_glb:
            self.text = self.text.rstrip(" ")
        gltf = Value(self.container.gltf, f"{path}:")
        self.buffers: Buffers | None = None
        self.accessors: Accessors | None = None
        with suppress(FileError):
            check_lists(gltf)
            self.buffers = Buffers(gltf, self.container, allow_external=options.allow_external_paths)
            self.accessors = Accessors(gltf, self.buffers)

    @cached_property
    def json(self) -> Any:
        """The JSON with its numbers as they are spelled."""
        return tokens(self.text.removeprefix("\ufeff"), str(self.path))

    def each(self, key: str) -> list[Any]:
        """The items of a list of the JSON; none where it is something else."""
        found = self.container.gltf.get(key)
        return found if isinstance(found, list) else []

    def view(self, index: int) -> memoryview | None:
        """The bytes of a buffer view."""
        with suppress(FileError):
            if self.accessors is not None and self.buffers is not None:
                buffer, start, end = self.accessors.span(index)
                return self.buffers.content(buffer)[start:end]
        return None

    def numbers(self, index: int) -> np.ndarray[Any, Any] | None:
        """The numbers of an accessor."""
        with suppress(FileError):
            if self.accessors is not None and 0 <= index < len(self.accessors):
                return self.accessors.read(index)
        return None

    def content(self, index: int) -> memoryview | None:
        """The bytes of a buffer."""
        with suppress(FileError):
            if self.buffers is not None and index < len(self.buffers):
                return self.buffers.content(index)
        return None

    def image(self, image: Any) -> bytes | memoryview | None:
        """The bytes of an image."""
        if not isinstance(image, dict):
            return None
        uri, view = image.get("uri"), image.get("bufferView")
        if type(view) is int:
            return self.view(view)
        if not isinstance(uri, str):
            return None
        try:
            if is_data(uri):
                return decode_data(uri, "image")
            allowed = self.options.allow_external_paths
            path = file_of(uri, self.path.parent, "image", allow_external=allowed)
            return path.read_bytes() if path.is_file() else None
        except (FileError, OSError):
            return None


def _contents(before: _Side, after: _Side, tolerance: float, one: int, other: int) -> str:
    """How the numbers of two accessors differ, "" where they do not."""
    mine, theirs = before.numbers(one), after.numbers(other)
    if mine is None or theirs is None:
        return "" if mine is None and theirs is None and one == other else "content cannot be compared"
    if mine.shape != theirs.shape:
        return " → ".join(f"{rows} x {width} numbers" for rows, width in (mine.shape, theirs.shape))
    return "" if same_numbers(mine, theirs, tolerance) else furthest(mine, theirs)


def _chunks(before: Container, after: Container) -> Iterator[Change]:
    """Chunks that are gone, new, other, or in another order."""
    if before.is_glb != after.is_glb:
        words = [".glb" if side.is_glb else ".gltf" for side in (before, after)]
        yield Change("chunks", "changed", "container", arrow(*words))
        return
    names = [[_chunk_name(kind) for kind, _ in side.chunks] for side in (before, after)]
    if names[0] != names[1]:
        yield Change("chunks", "changed", "chunks", arrow(" ".join(names[0]), " ".join(names[1])))
    left = list(after.chunks)
    for kind, content in before.chunks:
        place = next((k for k, (other, _) in enumerate(left) if other == kind), -1)
        if place < 0:
            yield Change("chunks", "removed", f"chunk {_chunk_name(kind)}", f"{len(content)} bytes")
            continue
        _, now = left.pop(place)
        # The data of JSON and BIN are compared by what they mean.
        if kind not in (JSON_CHUNK, BIN_CHUNK) and not _same_bytes(content, now):
            yield Change("chunks", "changed", f"chunk {_chunk_name(kind)}", _byte_differences(content, now))
    for kind, content in left:
        yield Change("chunks", "added", f"chunk {_chunk_name(kind)}", f"{len(content)} bytes")


def _chunk_name(kind: int) -> str:
    text = kind.to_bytes(4, "little").rstrip(b"\0")
    return text.decode("ascii") if text.isascii() and text.decode("ascii").isprintable() else f"0x{kind:08x}"


def _accessors(before: _Side, after: _Side, contents: Callable[[int, int], str]) -> Iterator[Change]:
    """Accessors by index: content that differs, and content that only moved."""
    users = _users(before.container.gltf)
    pairs = zip(before.each("accessors"), after.each("accessors"), strict=False)
    for index, (one, other) in enumerate(pairs):
        if one == other and _same_view(before, after, one):
            continue
        title = f"accessor {index}{users.get(index, '')}"
        if text := contents(index, index):
            yield Change("accessors", "changed", title, text)
        elif one != other and _buffer_offset(one) != _buffer_offset(other):
            yield Change("accessors", "moved", title, "equal content")


def _same_view(before: _Side, after: _Side, accessor: Any) -> bool:
    """Whether the view of an accessor that is the same in both has the same bytes."""
    view = accessor.get("bufferView") if isinstance(accessor, dict) else None
    if not isinstance(view, int) or "sparse" in accessor:
        return False
    return _same_bytes(before.view(view), after.view(view))


def _buffer_offset(accessor: Any) -> Any:
    found = accessor if isinstance(accessor, dict) else {}
    return found.get("bufferView"), found.get("byteOffset", 0)


def _views(before: _Side, after: _Side, tolerance: float) -> Iterator[Change]:
    """Buffer views by index; with a tolerance only those whose numbers were not compared."""
    accessors = [item for item in before.each("accessors") if isinstance(item, dict)] if tolerance else []
    compared = {view for item in accessors if type(view := item.get("bufferView")) is int}
    for index in range(min(len(before.each("bufferViews")), len(after.each("bufferViews")))):
        one, other = before.view(index), after.view(index)
        if index not in compared and not _same_bytes(one, other):
            yield Change("buffer views", "changed", f"bufferView {index}", _byte_differences(one, other))


def _loose_bytes(before: _Side, after: _Side) -> Iterator[Change]:
    """Bytes of buffers that no view covers, and buffers without any view."""
    for index in range(len(before.each("buffers"))):
        one, other = before.content(index), after.content(index)
        if one is None or other is None:
            if one is not None:
                yield Change("buffers", "removed", f"buffer {index}", "its data cannot be read any more")
            elif other is not None:
                yield Change("buffers", "added", f"buffer {index}", "its data, which could not be read")
            continue
        if len(one) != len(other):
            yield Change("buffers", "changed", f"buffer {index}", f"{len(one)} → {len(other)} bytes")
        for start, end in _gaps(before, index, len(one)):
            yield from _loose_range(f"buffer {index}, bytes {start} to {end}", one[start:end], start, other)
        for start, end in _gaps(after, index, len(other)):
            if start >= len(one) and (end - start >= _ALIGNMENT or any(other[start:end])):
                where = f"buffer {index}, bytes {start} to {end}"
                yield Change("loose bytes", "added", where, "covered by no view")


def _gaps(side: _Side, buffer: int, length: int) -> Iterator[tuple[int, int]]:
    """Start and end of the bytes of a buffer that no view covers."""
    spans = []
    for index, view in enumerate(side.each("bufferViews")):
        if isinstance(view, dict) and view.get("buffer") == buffer and side.accessors is not None:
            with suppress(FileError):
                spans.append(side.accessors.span(index)[1:])
    reach = 0
    for start, end in [*sorted(spans), (length, length)]:
        if start > reach:
            yield reach, start
        reach = max(reach, end)


def _loose_range(where: str, content: memoryview, start: int, other: memoryview) -> Iterator[Change]:
    """What became of bytes that no view covers. other: the whole other buffer."""
    there = other[start : start + len(content)]
    if _same_bytes(content, there) or (len(content) < _ALIGNMENT and not any(content)):
        return
    at = bytes(other).find(bytes(content))
    if at >= 0:
        yield Change("loose bytes", "moved", where, f"to {at}")
    elif len(there) < len(content):
        yield Change("loose bytes", "removed", where, f"{len(content)} bytes that no view covers")
    else:
        yield Change("loose bytes", "changed", where, _byte_differences(content, there))


def _images(before: _Side, after: _Side) -> Iterator[Change]:
    """Images by index."""
    pairs = zip(before.each("images"), after.each("images"), strict=False)
    for index, (one, other) in enumerate(pairs):
        mine, theirs = before.image(one), after.image(other)
        if not _same_bytes(mine, theirs):
            name = one.get("name") if isinstance(one, dict) else None
            title = f"image {index}{f' {name}' if name else ''}"
            yield Change("images", "changed", title, _byte_differences(mine, theirs))


def _same_bytes(one: bytes | memoryview | None, other: bytes | memoryview | None) -> bool:
    """Whether both are the same; two that cannot be read are."""
    if one is None or other is None:
        return one is other
    return len(one) == len(other) and all(
        bytes(one[at : at + _BLOCK]) == bytes(other[at : at + _BLOCK]) for at in range(0, len(one), _BLOCK)
    )


def _byte_differences(one: bytes | memoryview | None, other: bytes | memoryview | None) -> str:
    """How two pieces of data differ."""
    if one is None or other is None:
        return "can be read only in one of the files"
    if len(one) != len(other):
        return f"{len(one)} → {len(other)} bytes"
    count, first = 0, -1
    for at in range(0, len(one), _BLOCK):
        mine, theirs = (np.frombuffer(side[at : at + _BLOCK], np.uint8) for side in (one, other))
        differ = np.flatnonzero(mine != theirs)
        if len(differ) and first < 0:
            first = at + int(differ[0])
        count += len(differ)
    return f"{count} of {len(one)} bytes differ, the first at {first}"


def _users(gltf: dict[str, Any]) -> dict[int, str]:
    """What accessors are for: ``, rotation of node 3 in animation 'walk'``."""
    found: dict[int, str] = {}
    try:
        for number, animation in enumerate(gltf.get("animations", [])):
            title = animation.get("name") or f"#{number}"
            for channel in animation["channels"]:
                sampler, target = animation["samplers"][channel["sampler"]], channel["target"]
                keys = f" (keys of {target.get('path')} of node {target.get('node')} in animation {title})"
                found.setdefault(sampler["output"], keys)
                found.setdefault(sampler["input"], f" (times in animation {title})")
        for number, skin in enumerate(gltf.get("skins", [])):
            title = skin.get("name") or f"#{number}"
            found.setdefault(skin.get("inverseBindMatrices", -1), f" (inverse binds of skin {title})")
        for number, mesh in enumerate(gltf.get("meshes", [])):
            title = mesh.get("name") or f"#{number}"
            for primitive in mesh["primitives"]:
                for name, index in primitive["attributes"].items():
                    found.setdefault(index, f" ({name} of mesh {title})")
    except (AttributeError, KeyError, IndexError, TypeError):
        pass  # a broken file is still compared, with fewer words
    return found
