"""Where changed numbers go: over the old ones where nobody else uses those, else behind the end.

Source: glTF 2.0 §3.6 (buffers, views, accessors), §4.4.3 (the BIN chunk).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import field
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from rigtri.errors import FileError
from rigtri.formats.document import Companion
from rigtri.formats.gltf.accessors import COMPONENTS, Accessors
from rigtri.formats.gltf.container import Container, Piece
from rigtri.formats.gltf.float32_rounding import Singles
from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite
from rigtri.formats.gltf.references import compressed_spans, used_accessors, used_views
from rigtri.formats.gltf.uris import encode_data, escape, is_data
from rigtri.model.dataclass import dataclass

# A view holds one kind only: validators call anything else an override.
Role = Literal[
    "inverse bind matrices", "animation", "shapes", "influences 4", "influences 8", "influences 16"
]
# Attributes of vertices that share a view must state their stride.
_STRIDES: dict[Role, int] = {"shapes": 12, "influences 4": 4, "influences 8": 8, "influences 16": 16}
Numbers = NDArray[Any]
OWN_NAME = "rigtri"
_ARRAY_BUFFER = 34962
# Where the bytes lie of buffers that are ours to change.
_OURS = ("bin", "data", "own")


@dataclass
class _Tail:
    """New bytes of one role and the view that will hold them."""

    view: int
    content: bytearray = field(default_factory=bytearray)


class Storage:
    """Takes new numbers for accessors and decides in the end what becomes of the buffers."""

    def __init__(self, draft: CopyOnWrite, accessors: Accessors, container: Container) -> None:
        self._draft, self._accessors, self._container = draft, accessors, container
        self._buffers = accessors.buffers
        self._gltf = container.gltf
        self._patches: dict[int, list[tuple[int, Singles]]] = {}
        self._tails: dict[Role, _Tail] = {}
        self._gone: dict[int, list[tuple[int, int]]] = {}
        self._added: dict[tuple[Any, ...], int] = {}

    @cached_property
    def users(self) -> Counter[int]:
        """How many things of the file use each accessor."""
        return used_accessors(self._gltf)

    @cached_property
    def free(self) -> set[int]:
        """Accessors whose bytes may be written over: plain, ours to change, nobody else's."""
        return _free_accessors(self._gltf, self._accessors)

    def replace(self, changes: Sequence[tuple[int, Singles]]) -> None:
        """Write rows over the bytes of accessors that are `free`, in their old layout."""
        bounded: dict[tuple[int, ...], list[tuple[int, Singles]]] = {}
        for accessor, rows in changes:
            layout = self._accessors.layout(accessor)
            self._patches.setdefault(layout.buffer, []).append((layout.start, rows))
            raw = self._gltf["accessors"][accessor]
            if "min" in raw or "max" in raw:
                bounded.setdefault(rows.shape, []).append((accessor, rows))
        for alike in bounded.values():
            width = alike[0][1].shape[1]
            low, high = _bounds(np.concatenate([rows for _, rows in alike], axis=1))
            for k, (accessor, _) in enumerate(alike):
                mine = slice(k * width, (k + 1) * width)
                _put_bounds(self._draft.edit("accessors", accessor), low[mine], high[mine])

    def add(
        self,
        rows: Numbers,
        kind: str,
        role: Role,
        like: int | None = None,
        *,
        bounds: bool = False,
        normalized: bool = False,
    ) -> int:
        """A new accessor, or the one that already got the same rows. like: whose name and bounds it takes.

        normalized: integers stand for 0 to 1.
        """
        source = self._gltf["accessors"][int(like)] if like is not None else {}
        bounds = bounds or "min" in source or "max" in source
        content = rows.tobytes()
        key = (role, kind, content, bounds, rows.dtype.str, normalized)
        if key not in self._added:
            self._added[key] = self._append(content, rows, kind, role, source, bounds)
            if normalized:
                self._draft.edit("accessors", self._added[key])["normalized"] = True
        return self._added[key]

    @property
    def idle(self) -> bool:
        """Whether nothing has been given to it."""
        return not self._tails and not self._patches

    @property
    def grows(self) -> bool:
        """Whether new accessors will lie behind the old bytes."""
        return bool(self._tails)

    def span(self, accessor: int) -> tuple[int, int, int]:
        """Buffer, start and end of an accessor's bytes, buffer −1 for none that are ours to change."""
        if accessor >= len(self._accessors):
            return -1, 0, 0
        layout = self._accessors.layout(accessor)
        whole = layout.stride == layout.size and not layout.sparse
        if layout.buffer < 0 or not whole or not self.changeable(layout.buffer):
            return -1, 0, 0
        return layout.buffer, layout.start, layout.end

    def changeable(self, buffer: int) -> bool:
        """Whether a buffer of the file that was read is ours to change."""
        return buffer < len(self._buffers) and self._buffers.storage(buffer) in _OURS

    def remove(self, buffer: int, spans: list[tuple[int, int]]) -> None:
        """Leave ranges of bytes, rising and apart, out of a buffer that is `changeable`."""
        self._gone[buffer] = spans
        self._draft.edit("buffers", buffer)["byteLength"] -= sum(end - start for start, end in spans)

    def count_anew(self, views: Mapping[int, int]) -> None:
        """Views that new bytes go to have other numbers now."""
        for tail in self._tails.values():
            tail.view = views.get(tail.view, tail.view)

    def _append(
        self, content: bytes, rows: Numbers, kind: str, role: Role, source: dict[str, Any], bounds: bool
    ) -> int:
        if role not in self._tails:
            views = self._draft.need("bufferViews", empty=[])
            self._tails[role] = _Tail(len(views))
            stride = _STRIDES.get(role)
            # By its name a later run knows that what nobody uses there has served.
            views.append(
                {"name": OWN_NAME, **({"byteStride": stride, "target": _ARRAY_BUFFER} if stride else {})}
            )
        tail = self._tails[role]
        accessor: dict[str, Any] = {key: source[key] for key in ("name", "extras") if key in source}
        accessor |= {
            "bufferView": tail.view,
            "byteOffset": len(tail.content),
            "componentType": next(k for k, item in COMPONENTS.items() if item == rows.dtype),
            "count": len(rows),
            "type": kind,
        }
        if bounds:
            accessor |= {"min": [], "max": []}
            _put_bounds(accessor, *_bounds(rows))
        tail.content += content
        accessors = self._draft.need("accessors", empty=[])
        accessors.append(accessor)
        return len(accessors) - 1

    def finish(self, stem: str) -> tuple[list[Piece] | None, list[Companion]]:
        """Settle the buffers: the pieces of a changed BIN chunk, and files to put beside the output.

        stem: of the output's name, for a buffer file of ours.
        """
        tail = b""
        for role in sorted(self._tails):
            view = self._draft.edit("bufferViews", self._tails[role].view)
            # Filled in below, when the buffer is known; all tails are multiples of 4 long.
            view |= {"buffer": 0, "byteOffset": len(tail), "byteLength": len(self._tails[role].content)}
            tail += bytes(self._tails[role].content)
        home = self._target_buffer() if tail else -1
        binary, companions = None, []
        buffers = range(len(self._draft.gltf.get("buffers", [])))
        for index in sorted({*self._patches, *self._gone, *([home] if tail else [])} & {*buffers}):
            more = tail if index == home else b""
            place = self._place(index)
            if place == "bin":
                binary = self._binary(index, more)
            else:
                companions += self._rewrite(index, more, stem, place)
        return binary, companions

    def _place(self, index: int) -> str:
        if index < len(self._buffers):
            return self._buffers.storage(index)
        return str(self._draft.gltf["buffers"][index].get("uri", "bin"))

    def _target_buffer(self) -> int:
        """The buffer that takes new data: one of ours if there is one, else a new one."""
        places = [self._buffers.storage(k) for k in range(len(self._buffers))]
        names = [self._buffers.raw(k).get("name") for k in range(len(places))]
        if "bin" in places:
            return 0
        for index, place in enumerate(places):
            if place == "own" or (place == "data" and names[index] == OWN_NAME):
                return index
        buffers = self._draft.need("buffers", empty=[])
        if self._container.is_glb and not places and self._container.binary is None:
            buffers.append({"byteLength": 0})
        else:
            beside = not self._container.is_glb and "file" in places
            buffers.append({"name": OWN_NAME, "byteLength": 0, "uri": "own" if beside else "data"})
        return len(buffers) - 1

    def _settle(self, home: int, base: int) -> None:
        for tail in self._tails.values():
            view = self._draft.edit("bufferViews", tail.view)
            view |= {"buffer": home, "byteOffset": base + view["byteOffset"]}

    def _binary(self, index: int, tail: bytes) -> list[Piece]:
        """The BIN chunk as ranges of the source with the changed parts between them."""
        old = self._container.binary if self._container.binary is not None else memoryview(b"")
        pieces: list[Piece] = []
        at = 0
        patches = [(start, start + rows.nbytes, rows) for start, rows in self._patches.get(index, [])]
        gone = self._gone.get(index, [])
        for start, end, rows in sorted(
            [*patches, *((start, end, None) for start, end in gone)], key=lambda change: change[0]
        ):
            if start > at:
                pieces.append(old[at:start])
            if rows is not None:
                pieces.append(rows.data.cast("B"))
            at = end
        pieces.append(old[at:])
        if tail:
            length = len(old) - sum(end - start for start, end in gone)
            padding = -length % 4
            self._settle(index, length + padding)
            pieces += [b"\0" * padding, tail]
            self._draft.edit("buffers", index)["byteLength"] = length + padding + len(tail)
        return pieces

    def _rewrite(self, index: int, tail: bytes, stem: str, place: str) -> list[Companion]:
        """A buffer in a URI or in a file of ours, with its changes."""
        content = bytearray(self._buffers.content(index) if index < len(self._buffers) else b"")
        for start, rows in self._patches.get(index, []):
            content[start : start + rows.nbytes] = rows.data.cast("B")
        for start, end in reversed(self._gone.get(index, [])):
            del content[start:end]
        if tail:
            content += b"\0" * (-len(content) % 4)
            self._settle(index, len(content))
            content += tail
        buffer = self._draft.edit("buffers", index)
        buffer["byteLength"] = len(content)
        if place == "data":
            old = buffer["uri"]
            head = old.partition(",")[0] if is_data(old) else "data:application/octet-stream;base64"
            buffer["uri"] = encode_data(content, head)
            return []
        from hashlib import sha256  # of a .glb nobody needs it

        name = f"{stem}.rigtri-{sha256(content).hexdigest()[:8]}.bin"
        buffer["uri"] = escape(name)
        return [Companion(name, bytes(content))]


def _bounds(rows: Numbers) -> tuple[list[Any], list[Any]]:
    """The lows and highs of rows along the first axis, as numbers of JSON."""
    low, high = (bound.reduce(rows, axis=0).astype(np.float64) for bound in (np.minimum, np.maximum))
    return low.tolist(), high.tolist()


def _put_bounds(accessor: dict[str, Any], low: list[float], high: list[float]) -> None:
    for key, numbers in (("min", low), ("max", high)):
        if key in accessor:
            accessor[key] = numbers


def _free_accessors(gltf: dict[str, Any], accessors: Accessors) -> set[int]:
    """Accessors of plain float32 whose bytes lie where we may write and overlap nothing else."""
    raw, views = gltf.get("accessors", []), gltf.get("bufferViews", [])
    shared, buffers = used_views(gltf), accessors.buffers
    ours = {buffer for buffer in range(len(buffers)) if buffers.storage(buffer) in _OURS}
    spans: list[tuple[int, int, int, int]] = []
    for index in range(len(raw)):
        try:
            layout = accessors.layout(index)
        except FileError:
            # Nobody knows where the bytes of a broken or compressed accessor lie: its whole view is taken.
            shared.update(used_views({"images": [raw[index]]}))
            continue
        if layout.buffer >= 0:
            held = "extensions" in raw[index] or "extensions" in views[layout.view]
            free = layout.plain and layout.buffer in ours and not held
            spans.append((layout.buffer, layout.start, layout.end, index if free else -1))
    for view in shared:
        try:
            buffer, start, end = accessors.span(view)
        except FileError:
            continue  # it leads nowhere
        spans.append((buffer, start, end, -1))
    spans += [(*span, -1) for span in compressed_spans(gltf)]
    return _alone(spans)


def _alone(spans: list[tuple[int, int, int, int]]) -> set[int]:
    """The last numbers of spans (buffer, start, end, index) that overlap no other; −1 is nobody."""
    alone: set[int] = set()
    buffer, reach, last = -1, 0, -1
    for span in sorted(spans):
        if span[0] != buffer:
            buffer, reach, last = span[0], 0, -1
        if span[1] < reach:
            alone.discard(last)
        else:
            alone.add(span[3])
        # Whoever reaches furthest is the one that a later span would touch first.
        if span[2] > reach:
            reach, last = span[2], span[3]
    alone.discard(-1)
    return alone
