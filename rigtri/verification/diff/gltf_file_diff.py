"""How two glTF files differ as files: JSON, spelling, chunks, accessors, views, loose bytes, images."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from rigtri.errors import FileError
from rigtri.formats import ReadOptions
from rigtri.formats.gltf.accessors import Accessors
from rigtri.formats.gltf.buffers import Buffers
from rigtri.formats.gltf.container import open_container
from rigtri.formats.gltf.structure import check_lists
from rigtri.formats.gltf.uris import decode_data, file_of, is_data
from rigtri.formats.json_values import Value
from rigtri.verification.diff.binary_diff import (
    ALIGNMENT,
    chunk_changes,
    describe_bytes,
    loose_changes,
    same_bytes,
)
from rigtri.verification.diff.change import Change, furthest, same_numbers
from rigtri.verification.diff.json_diff import json_changes, spelling_changes, tokens


def file_changes(before: Path, after: Path, options: ReadOptions, tolerance: float = 0.0) -> list[Change]:
    """Everything in which the second file is not the first. FileError where one is no glTF at all."""
    one, other = _Side(before, options), _Side(after, options)
    pair = _Pair(one, other, tolerance)
    found: list[Change] = []
    if one.text != other.text:
        found += json_changes(one.json, other.json, pair.contents, tolerance)
        found += spelling_changes(one.text, other.text)
    if not found and not tolerance and one.text != other.text:
        at = next((k for k, (a, b) in enumerate(zip(one.text, other.text, strict=False)) if a != b), 0)
        found.append(Change("spelling", "changed", "text", f"blanks or escapes, from character {at} on"))
    found += chunk_changes(one.container, other.container)
    found += pair.accessors()
    found += pair.views()
    found += pair.loose_bytes()
    found += pair.images()
    return found


class _Side:
    """A file taken apart; what cannot be read of its data is None."""

    def __init__(self, path: Path, options: ReadOptions) -> None:
        self.path, self.options = path, options
        self.container = open_container(path, lenient=True)
        content = self.container.chunks[0][1] if self.container.is_glb else self.container.source
        self.text = str(content, "utf-8")
        if self.container.is_glb:
            self.text = self.text.rstrip(" ")
        self.gltf = Value(self.container.gltf, f"{path}:")
        self.buffers: Buffers | None = None
        self.accessors: Accessors | None = None
        try:
            check_lists(self.gltf)
            self.buffers = Buffers(self.gltf, self.container, allow_external=options.allow_external_paths)
            self.accessors = Accessors(self.gltf, self.buffers)
        except FileError:
            pass  # the JSON shows what differs

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
        try:
            if self.accessors is None or self.buffers is None:
                return None
            buffer, start, end = self.accessors.span(index)
            return self.buffers.content(buffer)[start:end]
        except FileError:
            return None

    def numbers(self, index: int) -> np.ndarray[Any, Any] | None:
        """The numbers of an accessor."""
        try:
            whole = self.accessors is not None and 0 <= index < len(self.accessors)
            return self.accessors.read(index) if self.accessors is not None and whole else None
        except FileError:
            return None

    def content(self, index: int) -> memoryview | None:
        """The bytes of a buffer."""
        try:
            there = self.buffers is not None and index < len(self.buffers)
            return self.buffers.content(index) if self.buffers is not None and there else None
        except FileError:
            return None

    def image(self, image: Any) -> bytes | memoryview | None:
        """The bytes of an image; None where they are not to be had."""
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


class _Pair:
    def __init__(self, before: _Side, after: _Side, tolerance: float) -> None:
        self.before, self.after, self.tolerance = before, after, tolerance
        self._descriptions: dict[tuple[int, int], str] = {}

    def contents(self, one: int, other: int) -> str:
        """How the numbers of two accessors differ, "" where they do not."""
        if (one, other) not in self._descriptions:
            self._descriptions[one, other] = self._contents(one, other)
        return self._descriptions[one, other]

    def _contents(self, one: int, other: int) -> str:
        mine, theirs = self.before.numbers(one), self.after.numbers(other)
        if mine is None or theirs is None:
            return "" if mine is None and theirs is None and one == other else "content cannot be compared"
        if mine.shape != theirs.shape:
            return f"{_shape(mine)} → {_shape(theirs)}"
        return "" if same_numbers(mine, theirs, self.tolerance) else furthest(mine, theirs)

    def accessors(self) -> Iterator[Change]:
        """Accessors by index: content that differs, and content that only moved."""
        pairs = zip(self.before.each("accessors"), self.after.each("accessors"), strict=False)
        users = _users(self.before.container.gltf)
        for index, (one, other) in enumerate(pairs):
            same = one == other
            if same and self._same_view(one):
                continue
            title = f"accessor {index}{users.get(index, '')}"
            if text := self.contents(index, index):
                yield Change("accessors", "changed", title, text)
            elif not same and _place(one) != _place(other):
                yield Change("accessors", "moved", title, "equal content")

    def _same_view(self, accessor: Any) -> bool:
        """Whether the view of an accessor that is the same in both has the same bytes."""
        view = accessor.get("bufferView") if isinstance(accessor, dict) else None
        if not isinstance(view, int) or "sparse" in accessor:
            return False
        return same_bytes(self.before.view(view), self.after.view(view))

    def views(self) -> Iterator[Change]:
        """Buffer views by index; with a tolerance only those whose numbers were not compared."""
        known = _views_of_accessors(self.before.container.gltf) if self.tolerance else set()
        for index in range(min(len(self.before.each("bufferViews")), len(self.after.each("bufferViews")))):
            one, other = self.before.view(index), self.after.view(index)
            if index not in known and not same_bytes(one, other):
                yield Change("buffer views", "changed", f"bufferView {index}", describe_bytes(one, other))

    def loose_bytes(self) -> Iterator[Change]:
        """Bytes of buffers that no view covers, and buffers without any view."""
        for index in range(len(self.before.each("buffers"))):
            one, other = self.before.content(index), self.after.content(index)
            if one is None or other is None:
                if one is not None:
                    yield Change("buffers", "removed", f"buffer {index}", "its data cannot be read any more")
                elif other is not None:
                    yield Change("buffers", "added", f"buffer {index}", "its data, which could not be read")
                continue
            if len(one) != len(other):
                yield Change("buffers", "changed", f"buffer {index}", f"{len(one)} → {len(other)} bytes")
            for start, end in _gaps(self.before, index, len(one)):
                yield from loose_changes(index, start, one[start:end], other)
            for start, end in _gaps(self.after, index, len(other)):
                if start >= len(one) and (end - start >= ALIGNMENT or any(other[start:end])):
                    where = f"buffer {index}, bytes {start} to {end}"
                    yield Change("loose bytes", "added", where, "covered by no view")

    def images(self) -> Iterator[Change]:
        """Images by index."""
        pairs = zip(self.before.each("images"), self.after.each("images"), strict=False)
        for index, (one, other) in enumerate(pairs):
            mine, theirs = self.before.image(one), self.after.image(other)
            if not same_bytes(mine, theirs):
                name = one.get("name") if isinstance(one, dict) else None
                title = f"image {index}{f' {name}' if name else ''}"
                yield Change("images", "changed", title, describe_bytes(mine, theirs))


def _views_of_accessors(gltf: dict[str, Any]) -> set[int]:
    items = gltf.get("accessors")
    raw = (
        [item.get("bufferView") for item in items if isinstance(item, dict)]
        if isinstance(items, list)
        else []
    )
    return {view for view in raw if type(view) is int}


def _gaps(side: _Side, buffer: int, length: int) -> Iterator[tuple[int, int]]:
    """Start and end of the bytes of a buffer that no view covers."""
    spans = []
    for index, view in enumerate(side.each("bufferViews")):
        if isinstance(view, dict) and view.get("buffer") == buffer and side.accessors is not None:
            try:
                spans.append(side.accessors.span(index)[1:])
            except FileError:
                continue
    reach = 0
    for start, end in sorted(spans):
        if start > reach:
            yield reach, start
        reach = max(reach, end)
    if reach < length:
        yield reach, length


def _shape(numbers: np.ndarray[Any, Any]) -> str:
    return f"{numbers.shape[0]} x {numbers.shape[1]} numbers"


def _place(accessor: Any) -> Any:
    found = accessor if isinstance(accessor, dict) else {}
    return found.get("bufferView"), found.get("byteOffset", 0)


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
