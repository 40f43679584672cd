"""Buffer views whose bytes are compressed with meshopt.

Source: EXT_meshopt_compression and KHR_meshopt_compression, "JSON schema updates".
"""

from __future__ import annotations

import numpy as np

from rigtri.formats.gltf.buffers import Buffers, compression_of
from rigtri.formats.gltf.meshopt.attributes import decode_attributes, decode_indices
from rigtri.formats.gltf.meshopt.filters import FILTERS
from rigtri.formats.gltf.meshopt.triangles import decode_triangles
from rigtri.formats.json_values import Value

_DECODERS = {"ATTRIBUTES": decode_attributes, "INDICES": decode_indices, "TRIANGLES": decode_triangles}
# No character has this much in one view.
MOST_BYTES = 1 << 28
# Zeros can be packed a thousand to one, numbers that mean something a tenth of that; a small view may.
RATIO, SMALL = 100, 1 << 24


def decode_view(view: Value, buffers: Buffers) -> memoryview:
    """The bytes of a compressed buffer view.

    FileError, naming the view, for what the extension does not allow, and for a
    stream that does not hold exactly what the view should have. Everything that
    is claimed is checked before it is allocated.
    """
    how = compression_of(view)
    if how is None:
        view.fail("its buffer has no data and nothing says that it is compressed")
    mode, kind = how.need("mode").text(), how.raw.get("filter", "NONE")
    count, stride = how.need("count").count(1), how.natural("byteStride")
    _check(how, mode, kind, stride)
    length = view.natural("byteLength")
    if count * stride != length:
        how.fail(f"{count} elements of {stride} bytes are not the {length} bytes of the view")
    if length > MOST_BYTES:
        how.fail(f"claims {length} bytes, and rigtri decodes {MOST_BYTES} at most; split the view")
    stream = _stream(how, buffers)
    if length > max(SMALL, RATIO * len(stream)):
        how.fail(f"{len(stream)} bytes claim to be {length}; nothing but a trap is packed like that")
    try:
        elements = _DECODERS[mode](stream, count, stride)
    except ValueError as error:
        view.fail(f"{error}; pack the file again")
    undo = FILTERS[kind][0]
    # Of numbers of two bytes the decoders leave every second pair out.
    return np.ascontiguousarray(elements if undo is None else undo(elements)).data.cast("B")


def _check(how: Value, mode: str, kind: object, stride: int) -> None:
    """Refuse what no stream can be."""
    if mode not in _DECODERS:
        how.fail(f"mode '{mode}' is unknown to rigtri")
    if not isinstance(kind, str) or kind not in FILTERS:
        how.fail(f"filter {kind!r} is unknown to rigtri")
    indices = mode != "ATTRIBUTES"
    fit = stride in (2, 4) if indices else 4 <= stride <= 256 and stride % 4 == 0
    if not fit:
        how.fail(f"byteStride {stride} is not valid for {mode}")
    strides = FILTERS[kind][1]
    if (strides and stride not in strides) or (indices and kind != "NONE"):
        how.fail(f"filter {kind} does not go with {mode} of byteStride {stride}")


def _stream(how: Value, buffers: Buffers) -> memoryview:
    number = how.natural("buffer")
    if number >= len(buffers):
        how.fail(f"there is no buffer {number}, the file has {len(buffers)}")
    start, length = how.natural("byteOffset", 0), how.natural("byteLength")
    content = buffers.content(number)
    if start + length > len(content):
        how.fail(f"ends at {start + length}, outside buffer {number} of {len(content)} bytes")
    return content[start : start + length]
