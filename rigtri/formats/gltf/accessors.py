"""Accessors: typed views of buffers, decoded as float64.

Source: glTF 2.0 §3.6.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.gltf.buffers import Buffers, compression_of
from rigtri.formats.json_values import Value, short_repr
from rigtri.maths.trigonometry import Floats

FLOAT = 5126
COMPONENTS: dict[int, np.dtype[Any]] = {
    5120: np.dtype("<i1"),
    5121: np.dtype("<u1"),
    5122: np.dtype("<i2"),
    5123: np.dtype("<u2"),
    5125: np.dtype("<u4"),
    FLOAT: np.dtype("<f4"),
}
# What one stands for in a normalised integer, §3.6.2.2.
FULL = {5120: 127.0, 5121: 255.0, 5122: 32767.0, 5123: 65535.0}
# MAT2 and MAT3 are missing: nothing that rigtri reads uses them.
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
# An accessor without bytes could claim any size; no skeleton needs more numbers than this.
MOST_ZEROS = 1 << 24
_BOUNDS = {"min": None, "max": None}
# So many layouts are kept for the writer.
MOST_LAYOUTS = 1 << 14


class Layout(NamedTuple):
    """Where the numbers of an accessor lie. start: in the buffer.

    buffer −1: in none. Without a view the numbers are zero, with one they lie in what
    the view is compressed to, and ``start`` is in that.
    """

    component: int
    width: int
    rows: int
    normalized: bool
    sparse: bool
    view: int = -1
    buffer: int = -1
    start: int = 0
    stride: int = 0

    @property
    def size(self) -> int:
        """Bytes of one element."""
        return COMPONENTS[self.component].itemsize * self.width

    @property
    def end(self) -> int:
        """Where the last element ends, in the buffer."""
        return self.start + self.stride * (self.rows - 1) + self.size

    @property
    def plain(self) -> bool:
        """Whether the bytes are float32 one after the other: what can be written over."""
        own = self.buffer >= 0 and self.component == FLOAT and self.stride == 4 * self.width
        return own and not self.sparse and not self.normalized


class Accessors:
    """All accessors of a file. Bounds are checked before anything is allocated."""

    def __init__(self, gltf: Value, buffers: Buffers, like: Accessors | None = None) -> None:
        self.buffers = buffers
        self._file = gltf.where
        self._items = gltf.object().get("accessors", [])
        self._views = gltf.object().get("bufferViews", [])
        self._known_views: dict[int, tuple[int, int, int, int]] = {}
        # Where numbers lie is found out once for a file and what is made of it.
        self.known = like if like is not None and self._lies_as(like) else None
        self._layouts: dict[int, Layout] = {} if self.known is None else dict(self.known._layouts)
        self._floats: dict[int, Floats] = {}
        self._decoded: dict[int, memoryview] = {}

    def __len__(self) -> int:
        return len(self._items)

    def _lies_as(self, like: Accessors) -> bool:
        """Whether the numbers of all accessors of another file lie here where they do there."""
        return (
            self.buffers.hold(like.buffers)
            and self._views[: len(like._views)] == like._views
            and len(self._items) >= len(like._items)
            and all(map(_same_layout, self._items, like._items))
        )

    def value(self, index: int) -> Value:
        """The JSON of an accessor."""
        return Value(self._items[index], f"{self._file} accessors[{index}]")

    def layout(self, index: int) -> Layout:
        """Where the numbers of accessor ``index`` lie. FileError for anything out of bounds."""
        if index not in self._layouts:
            self._layouts[index] = self._lay_plain(self._items[index]) or self._lay(self.value(index))
        return self._layouts[index]

    def forget_layouts(self) -> None:
        """Let go of where very many numbers lie: of 200,000 accessors that is as much as their JSON."""
        if len(self._layouts) > MOST_LAYOUTS:
            self._layouts.clear()
        if len(self._known_views) > MOST_LAYOUTS:
            self._known_views.clear()

    def span(self, view: int) -> tuple[int, int, int]:
        """Buffer, start and end of a buffer view. FileError where it is not to be had."""
        if not 0 <= view < len(self._views):
            raise FileError(f"{self._file} there is no bufferView {view}")
        buffer, start, length, _ = self._view(view)
        return buffer, start, start + length

    def read(self, index: int) -> Floats:
        """The numbers of accessor ``index``, (count, width)."""
        with np.errstate(invalid="ignore"):  # some NaN are signalling ones: no warnings about them
            return self.read_aloud(index)

    def read_aloud(self, index: int) -> Floats:
        """As `read`, for callers that read very many and have silenced numpy's warnings themselves."""
        layout = self.layout(index)
        return self._read_plain(layout) if layout.plain else self._converted(index, layout)

    def readable(self, index: int) -> tuple[int, int]:
        """The count and width of an accessor that can be read: FileError for one that cannot."""
        layout = self.layout(index)
        if layout.plain:
            self.buffers.content(layout.buffer)
        else:
            self.read_aloud(index)
        return layout.rows, layout.width

    def read_alike(self, indices: Sequence[int]) -> Floats:
        """The numbers of accessors with the same count, (a, count · width); plain ones are read at once."""
        layouts = [self.layout(index) for index in indices]
        first = layouts[0]
        if any(not one.plain or one.buffer != first.buffer or one.start % 4 for one in layouts):
            return np.stack([self.read_aloud(index).ravel() for index in indices])
        starts = np.array([one.start // 4 for one in layouts])[:, np.newaxis]
        numbers: Floats = self._singles(first.buffer)[starts + np.arange(first.rows * first.width)]
        return numbers.astype(np.float64)

    def has_rows(self, index: int) -> bool:
        """Whether `rows` can read some rows alone: they are neither compressed nor sparse."""
        layout = self.layout(index)
        return layout.buffer >= 0 and not layout.sparse

    def rows(self, index: int, start: int, stop: int) -> Floats:
        """Some rows of what `read` gives, of an accessor that `has_rows`; no others stay in memory."""
        layout = self.layout(index)
        if start >= layout.rows:
            self.value(index).fail(f"has {layout.rows} elements, fewer than the mesh has vertices")
        first = layout.start + start * layout.stride
        numbers = self._converted(index, layout._replace(start=first, rows=min(stop, layout.rows) - start))
        # A page that is read brings up to 2 MB around it into memory.
        self.buffers.forget()
        return numbers

    def stated(self, index: int) -> Floats | None:
        """The lows and highs, (2, width), that the file states for an accessor; None where it does not."""
        layout, raw = self.layout(index), self._items[index]
        if "min" not in raw or "max" not in raw:
            return None
        accessor = self.value(index)
        bounds = np.array([accessor.need(key).numbers(layout.width) for key in ("min", "max")])
        return _whole(bounds, layout)

    def _converted(self, index: int, layout: Layout) -> Floats:
        accessor = self.value(index)
        numbers = self._elements(layout)
        if layout.sparse:
            numbers = self._replaced(numbers, accessor.need("sparse"), layout)
        # Some NaN are signalling ones: no warnings about them.
        with np.errstate(invalid="ignore"):
            return _whole(numbers.astype(np.float64), layout)

    def _read_plain(self, layout: Layout) -> Floats:
        start, rest = divmod(layout.start, 4)
        if rest:
            return self._elements(layout).astype(np.float64)
        part = self._singles(layout.buffer)[start : start + layout.rows * layout.width]
        return part.astype(np.float64).reshape(layout.rows, layout.width)

    def _singles(self, buffer: int) -> Floats:
        """A buffer as float32: one view of it serves all its accessors."""
        if buffer not in self._floats:
            content = self.buffers.content(buffer)
            self._floats[buffer] = np.frombuffer(content, "<f4", len(content) // 4)
        return self._floats[buffer]

    def _lay_plain(self, raw: dict[str, Any]) -> Layout | None:
        """As `_lay`, for what is stored plainly, as nearly all is; None for what is not, or is wrong."""
        try:
            kind, component, count, view = raw["type"], raw["componentType"], raw["count"], raw["bufferView"]
        except KeyError:
            return None
        offset = raw.get("byteOffset", 0)
        if not (type(component) is type(count) is type(view) is type(offset) is int and type(kind) is str):
            return None
        width, item = WIDTHS.get(kind), COMPONENTS.get(component)
        if width is None or item is None or count < 1 or view < 0 or offset < 0:
            return None
        buffer, start, length, stride = self._view(view)
        if buffer < 0:
            return None
        size = item.itemsize * width
        stride = stride or size
        if stride < size or offset + stride * (count - 1) + size > length:
            return None
        normalized, sparse = raw.get("normalized") is True, raw.get("sparse") is not None
        step = stride if count > 1 else size  # of one element it says nothing, however large
        return Layout(component, width, count, normalized, sparse, view, buffer, start + offset, step)

    def _lay(self, accessor: Value) -> Layout:
        raw = accessor.object()
        component, width = raw.get("componentType"), WIDTHS.get(str(raw.get("type")))
        if type(component) is not int or component not in COMPONENTS:
            accessor.fail(f"componentType {component!r} is not defined by glTF")
        if width is None:
            accessor.fail(f"type {raw.get('type')!r} cannot be read here")
        count = accessor.natural("count") or accessor.need("count").count(1)
        normalized, sparse = raw.get("normalized") is True, raw.get("sparse") is not None
        if raw.get("bufferView") is None:
            if count * width > MOST_ZEROS:
                accessor.fail(f"claims {short_repr(count)} elements without bytes for them")
            return Layout(component, width, count, normalized, sparse)
        view = accessor.natural("bufferView")
        layout = Layout(component, width, count, normalized, sparse, view)
        return self._within(accessor, layout, accessor.natural("byteOffset", 0))

    def _within(self, accessor: Value, layout: Layout, offset: int) -> Layout:
        """``layout`` at ``offset`` of its view, which must hold all of it."""
        buffer, start, length, stride = self._view(layout.view)
        stride = stride or layout.size
        need = offset + stride * (layout.rows - 1) + layout.size
        if stride < layout.size:
            accessor.fail(f"byteStride {stride} is less than the {layout.size} bytes of an element")
        if need > length:
            accessor.fail(f"needs {need} bytes of bufferView {layout.view}, which has {length}")
        step = stride if layout.rows > 1 else layout.size  # of one element it says nothing, however large
        return layout._replace(buffer=buffer, start=start + offset, stride=step)

    def _view(self, index: int) -> tuple[int, int, int, int]:
        """Buffer, offset, length and stride (0: none) of a buffer view; buffer −1 for a compressed one."""
        # Many accessors share one.
        known = self._known_views.get(index)
        if known is None:
            known = self._read_plain_view(index) or self._read_view(self._view_value(index))
            self._known_views[index] = known
        return known

    def _read_plain_view(self, index: int) -> tuple[int, int, int, int] | None:
        """As `_read_view`, for one without extensions, as nearly all are; None for others, or wrong ones."""
        raw = self._views[index] if index < len(self._views) else {"extensions": {}}
        if "extensions" in raw:
            return None
        buffer, start, length = raw.get("buffer"), raw.get("byteOffset", 0), raw.get("byteLength")
        stride = raw.get("byteStride", 0)
        if not type(buffer) is type(start) is type(length) is type(stride) is int:
            return None
        if buffer < 0 or start < 0 or length < 0 or stride < 0 or buffer >= len(self.buffers):
            return None
        return (buffer, start, length, stride) if start + length <= self.buffers.length(buffer) else None

    def _read_view(self, view: Value) -> tuple[int, int, int, int]:
        buffer = view.natural("buffer")
        if buffer >= len(self.buffers):
            view.fail(f"there is no buffer {buffer}, the file has {len(self.buffers)}")
        start, length = view.natural("byteOffset", 0), view.natural("byteLength")
        stride = view.natural("byteStride", 0)
        # Where the same bytes are also there uncompressed, those are read.
        if "extensions" in view.raw and self.buffers.storage(buffer) == "none" and compression_of(view):
            return -1, 0, length, stride
        whole = self.buffers.length(buffer)
        if start + length > whole:
            view.fail(f"ends at {start + length}, outside buffer {buffer} of {whole} bytes")
        return buffer, start, length, stride

    def _view_value(self, index: int) -> Value:
        if index >= len(self._views):
            raise FileError(f"{self._file} there is no bufferView {index}, the file has {len(self._views)}")
        return Value(self._views[index], f"{self._file} bufferViews[{index}]")

    def _content(self, layout: Layout) -> memoryview:
        """The bytes that ``layout.start`` counts from."""
        if layout.buffer >= 0:
            return self.buffers.content(layout.buffer)
        if layout.view not in self._decoded:
            from rigtri.formats.gltf.meshopt.views import decode_view

            self._decoded[layout.view] = decode_view(self._view_value(layout.view), self.buffers)
        return self._decoded[layout.view]

    def _elements(self, layout: Layout) -> np.ndarray:
        """The elements as stored, (count, width), zeros where there are no bytes."""
        kind = COMPONENTS[layout.component]
        shape = (layout.rows, layout.width)
        if layout.view < 0:
            return np.zeros(shape, kind)
        strides = (layout.stride, kind.itemsize)
        return np.ndarray(shape, kind, buffer=self._content(layout), offset=layout.start, strides=strides)

    def _replaced(self, numbers: np.ndarray, sparse: Value, layout: Layout) -> np.ndarray:
        """``numbers`` with the elements that a sparse accessor names put in."""
        count = sparse.need("count").count(1)
        if count > layout.rows:
            sparse.fail(f"replaces {count} of {layout.rows} elements")
        where, what = sparse.need("indices"), sparse.need("values")
        component = where.need("componentType").count()
        if component not in (5121, 5123, 5125):
            where.fail(f"componentType {component} is not valid for indices")
        indices = self._part(where, Layout(component, 1, count, False, False))[:, 0].astype(np.int64)
        if indices.max() >= layout.rows:
            where.fail(f"there is no element {indices.max()}, the accessor has {layout.rows}")
        numbers = numbers.copy()
        numbers[indices] = self._part(what, Layout(layout.component, layout.width, count, False, False))
        return numbers

    def _part(self, value: Value, layout: Layout) -> np.ndarray:
        value.object()
        view = value.natural("bufferView")
        placed = Layout(layout.component, layout.width, layout.rows, False, False, view)
        return self._elements(self._within(value, placed, value.natural("byteOffset", 0)))


def _same_layout(a: Any, b: Any) -> bool:
    """Whether two accessors differ in no more than the bounds of their numbers."""
    return bool(a is b or a == b or (type(a) is type(b) is dict and {**a, **_BOUNDS} == {**b, **_BOUNDS}))


def _whole(numbers: Floats, layout: Layout) -> Floats:
    """Normalised integers as the numbers they stand for; all others as they are."""
    if layout.normalized and layout.component in FULL:
        return np.asarray(np.maximum(numbers / FULL[layout.component], -1.0))
    return numbers
