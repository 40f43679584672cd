"""The bytes of the buffers of a glTF file, fetched when they are needed.

Source: glTF 2.0 §3.6.1; KHR_meshopt_compression, "Fallback buffers".
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

from rigtri.files.mapped_file import Mapped, load
from rigtri.formats.gltf.container import Container
from rigtri.formats.gltf.uris import decode_data, file_of, is_data, is_file, is_own, is_there, why_absent
from rigtri.formats.json_values import Value

# Where a buffer lies: in the GLB, in its URI, in a file of ours, in a file of the user's, nowhere.
Storage = Literal["bin", "data", "own", "file", "none"]
MESHOPT = ("KHR_meshopt_compression", "EXT_meshopt_compression")


class Buffers:
    """All buffers of a file. Those in files are looked for at once and read later.

    The file of a fallback buffer may be missing: its views are compressed elsewhere.
    """

    def __init__(self, gltf: Value, container: Container, *, allow_external: bool = False) -> None:
        self._items = list(gltf.each("buffers"))
        self._container = container
        self._allow_external = allow_external
        self._content: dict[int, memoryview] = {}
        self._lengths: dict[int, int] = {}
        self._undeployed: set[int] = set()
        for index, item in enumerate(self._items):
            if self.storage(index) in ("file", "own") and is_file(self.uri(index)):
                path = self._path(index)
                if not is_there(path) and _is_fallback(item):
                    self._undeployed.add(index)
                elif not is_there(path):
                    item.fail(why_absent(self.uri(index), path, container.path))

    def __len__(self) -> int:
        return len(self._items)

    def hold(self, others: Buffers) -> bool:
        """Whether all others have theirs here, of at least that length and in the same kind of place."""
        pairs = [(self.raw(k), others.raw(k)) for k in range(min(len(self), len(others)))]
        lengths = [(a.get("byteLength"), b.get("byteLength")) for a, b in pairs]
        return (
            len(pairs) == len(others)
            and all(self.storage(k) == others.storage(k) for k in range(len(pairs)))
            and all(type(a) is type(b) is int and a >= b for a, b in lengths)
        )

    def uri(self, index: int) -> str:
        """The URI of a buffer, "" where it has none."""
        uri = self._items[index].get("uri")
        return "" if uri is None else uri.text()

    def storage(self, index: int) -> Storage:
        """Where the bytes of a buffer lie."""
        uri = self.uri(index)
        if index in self._undeployed:
            return "none"
        if not uri:
            return "bin" if index == 0 and self._container.binary is not None else "none"
        if is_data(uri):
            return "data"
        # The name alone does not make a file ours: it must stand where we would put it.
        return "own" if is_own(uri) and "/" not in uri else "file"

    def content(self, index: int) -> memoryview:
        """The bytes of a buffer, exactly ``byteLength`` of them. FileError where they are not to be had."""
        if index not in self._content:
            self._content[index] = self._fetch(index)
        return self._content[index]

    def length(self, index: int) -> int:
        """The ``byteLength`` of a buffer, all of which is there. FileError where it is not."""
        if index not in self._lengths:
            item = self._items[index]
            length = item.need("byteLength").count()
            file = self.storage(index) in ("file", "own")
            if (self._path(index).stat().st_size if file else len(self.content(index))) < length:
                self.content(index)
            self._lengths[index] = length
        return self._lengths[index]

    def forget(self) -> None:
        """Let go of the pages of mapped files: who reads all of a large buffer does so part by part."""
        for content in (self._container.source, *self._content.values()):
            if isinstance(content.obj, Mapped):
                content.obj.forget()

    def _fetch(self, index: int) -> memoryview:
        item, place = self._items[index], self.storage(index)
        length = item.need("byteLength").count()
        if place == "bin" and self._container.binary is not None:
            content = self._container.binary
        elif place == "data":
            content = memoryview(decode_data(self.uri(index), item.where))
        elif place == "none":
            item.fail("the buffer has no data")
        else:
            content = load(self._path(index))
        if len(content) < length:
            item.fail(f"the buffer should have {length} bytes and has only {len(content)}; export it again")
        return content[:length]

    def _path(self, index: int) -> Path:
        folder, where = self._container.path.parent, self._items[index].where
        return file_of(self.uri(index), folder, where, allow_external=self._allow_external)

    def raw(self, index: int) -> dict[str, Any]:
        """The JSON of a buffer."""
        return self._items[index].object()


def _is_fallback(buffer: Value) -> bool:
    used = buffer.object().get("extensions")
    marks = [used.get(name) for name in MESHOPT] if isinstance(used, dict) else []
    return any(isinstance(mark, dict) and mark.get("fallback") is True for mark in marks)


def compression_of(view: Value) -> Value | None:
    """The extension of a buffer view that states how its bytes are compressed."""
    extensions = view.get("extensions")
    found = (extensions.get(name) for name in MESHOPT) if extensions is not None else iter(())
    return next((extension for extension in found if extension is not None), None)
