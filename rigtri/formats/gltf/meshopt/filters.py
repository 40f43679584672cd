"""What undoes the filters of EXT_meshopt_compression and KHR_meshopt_compression.

The specification leaves the last bit of three of them open. Viewers use one library for all
of it, in float32; the same steps in float32 give its very bits.

Source: KHR_meshopt_compression, appendix B.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigtri.formats.gltf.meshopt.attributes import Bytes


def octahedral(elements: Bytes) -> Bytes:
    """Unit vectors from two coordinates on an unfolded octahedron; elements of 4 or 8 bytes."""
    kind: Any = np.dtype(f"<i{elements.shape[1] // 4}")
    stored = elements.view(kind)
    x, y, one = stored[:, :3].astype(np.float32).T
    z = one - np.abs(x) - np.abs(y)
    behind = np.minimum(z, np.float32(0.0))
    x, y = (a + np.where(a >= 0, behind, -behind) for a in (x, y))
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = np.float32(np.iinfo(kind).max) / np.sqrt(x * x + (y * y + z * z))
        vectors = np.stack([x * scale, y * scale, z * scale], axis=1)
    return _bytes(np.concatenate([_rounded(vectors, kind), stored[:, 3:]], axis=1))


def quaternion(elements: Bytes) -> Bytes:
    """Rotations from their three smaller components; elements of 8 bytes."""
    stored = elements.view("<i2")
    one = (stored[:, 3:] | 3).astype(np.float32)
    smaller = stored[:, :3].astype(np.float32)
    x, y, z = (smaller * smaller).T[..., np.newaxis]
    # The components are stored √2 times as large as they are.
    largest = np.sqrt(np.maximum(one * one * np.float32(2.0) - (x + (y + z)), np.float32(0.0)))
    scale = np.float32(32767.0) / np.sqrt(np.float32(2.0)) / one
    parts = _rounded(np.concatenate([largest, smaller], axis=1) * scale, np.dtype("<i2"))
    place = (stored[:, 3:] & 3) + np.arange(4) & 3
    turned = np.empty_like(parts)
    np.put_along_axis(turned, place, parts, axis=1)
    return _bytes(turned)


def exponential(elements: Bytes) -> Bytes:
    """float32 numbers from an exponent of 8 bits and a mantissa of 24; elements of 4·k bytes."""
    stored = elements.view("<i4")
    power = ((stored >> 24) + 127 << 23).astype("<i4").view("<f4")
    with np.errstate(invalid="ignore", over="ignore"):
        return _bytes(power * (stored << 8 >> 8).astype(np.float32))


def color(elements: Bytes) -> Bytes:
    """Red, green, blue and alpha from luma and chroma; elements of 4 or 8 bytes."""
    size = elements.shape[1] // 4
    y, alpha = elements.view(f"<u{size}")[:, [0, 3]].astype(np.int32).T
    co, cg = elements.view(f"<i{size}")[:, 1:3].astype(np.int32).T
    # All bits up to the highest of alpha, which gives how many bits the numbers have.
    most = alpha
    for shift in (1, 2, 4, 8):
        most = most | most >> shift
    alpha = alpha << 1 & most | alpha & 1
    channels = np.stack([y + co - cg, y + cg, y - co - cg, alpha], axis=1).astype(np.float32)
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = np.float32(256**size - 1) / most.astype(np.float32)[:, np.newaxis]
        return _bytes(_rounded(channels * scale, np.dtype(f"<u{size}")))


FILTERS: dict[str, tuple[Callable[[Bytes], Bytes] | None, tuple[int, ...]]] = {
    # The strides that a filter is for; none: all.
    "NONE": (None, ()),
    "OCTAHEDRAL": (octahedral, (4, 8)),
    "QUATERNION": (quaternion, (8,)),
    "EXPONENTIAL": (exponential, ()),
    "COLOR": (color, (4, 8)),
}


def _rounded(numbers: NDArray[np.float32], kind: np.dtype[Any]) -> NDArray[Any]:
    """To whole numbers, halves to the even one."""
    # What no valid stream holds becomes 0; casting it would depend on the processor.
    fit = np.abs(numbers) < np.float32(2**31)
    return np.rint(np.where(fit, numbers, np.float32(0.0))).astype(np.int32).astype(kind)


def _bytes(numbers: NDArray[Any]) -> Bytes:
    return np.ascontiguousarray(numbers).view(np.uint8)
