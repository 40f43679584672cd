"""Streams of EXT_meshopt_compression and KHR_meshopt_compression, decoded with numpy.

Attributes are elements of ``stride`` bytes, stored byte by byte: for a block of elements first
all of their first bytes, then all of their second bytes and so on. Each byte is the difference
from the byte of the element before, in groups of 16 that take 0, 1, 2, 4 or 8 bits a difference.
Where a group begins follows from the groups before it, so they are found one after the other;
all else is done for many groups at once.

Source: KHR_meshopt_compression, appendix A (version 0 is the stream of EXT_meshopt_compression).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from itertools import chain, islice, repeat
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Bytes = NDArray[np.uint8]

GROUP = 16
# Bits of a difference in a group, by the two bits of its header and the mode of its byte.
_VERSION_0: tuple[tuple[int, ...], ...] = ((0, 2, 4, 8),)
_VERSION_1: tuple[tuple[int, ...], ...] = ((0, 1, 2, 4), (1, 2, 4, 8))
# Modes of a byte of the elements in version 1, past those two.
_ALL_ZERO, _LITERAL = 2, 3
# Where in a byte the differences lie, the first one first.
_SHIFTS = {1: tuple(range(8)), 2: (6, 4, 2, 0), 4: (4, 0)}
# The longest group: 16 differences of 4 bits, all of them followed by a whole byte.
_LONGEST = 24
# Bytes that the end of a stream is padded to, by version.
_SHORTEST_TAIL = (32, 24)
_INDEX_TAIL = 4
# Differences that are expanded at once; with its temporaries some 10 MB.
_PORTION = 1 << 19
_TOO_SHORT = "the compressed data end too early"


class _Shape(NamedTuple):
    """How the elements of a stream are cut up. block: elements in each block but the last."""

    version: int
    elements: int
    stride: int
    block: int

    @staticmethod
    def of(version: int, elements: int, stride: int) -> _Shape:
        return _Shape(version, elements, stride, min(8192 // stride & -GROUP, 256))

    def sizes(self) -> Iterator[int]:
        """How many elements each block has."""
        whole, rest = divmod(self.elements, self.block)
        return chain(repeat(self.block, whole), [rest] if rest else [])

    @property
    def tail(self) -> int:
        """Bytes of the element that the first one is counted from and of the modes of the channels."""
        return self.stride + (self.stride // 4 if self.version else 0)

    @property
    def padded_tail(self) -> int:
        return max(self.tail, _SHORTEST_TAIL[self.version])

    @property
    def least(self) -> int:
        """Bytes that the stream has at least: nothing but headers for zero."""
        whole, rest = divmod(self.elements, self.block)
        if self.version:
            headers = (whole + (rest > 0)) * self.stride // 4
        else:
            headers = (whole * _header_size(self.block) + _header_size(rest)) * self.stride
        return 1 + headers + self.padded_tail


def _groups(elements: int) -> int:
    return (elements + GROUP - 1) // GROUP


def _header_size(elements: int) -> int:
    """Bytes of two bits for each group."""
    return (_groups(elements) + 3) // 4


def decode_attributes(stream: memoryview, count: int, stride: int) -> Bytes:
    """The elements of an attribute stream, (count, stride).

    stride: a multiple of 4 up to 256. Raises ValueError, in words for the user, for a
    stream that is none or that has not exactly what ``count`` elements take; before
    anything large is allocated where it cannot hold them.
    """
    version = stream[0] - 0xA0 if len(stream) else -1
    if version not in (0, 1):
        raise ValueError(f"the compressed data begin with {_first(stream)}, not a0 or a1")
    shape = _Shape.of(version, count, stride)
    if len(stream) < shape.least:
        raise ValueError(f"{len(stream)} bytes cannot hold {count} compressed elements of {stride} bytes")
    tail = bytes(stream[len(stream) - shape.tail :])
    channels = tail[stride:] if version else bytes(stride // 4)
    for channel in channels:
        if channel & 15 > 2 or (channel & 15 < 2 and channel >> 4):
            raise ValueError(f"the compressed data have a channel of the unknown mode {channel}")
    packed = _Packed(stream, len(stream) - shape.padded_tail)
    elements = np.empty((count, stride), np.uint8)
    done = 0
    for blocks in _portions(shape):
        part = _read_blocks(packed, shape, blocks)
        elements[done : done + len(part)] = part
        done += len(part)
    if packed.at != packed.end:
        raise ValueError(f"{packed.end - packed.at} bytes of the compressed data are left over")
    for number, channel in enumerate(channels):
        _add_up(elements, 4 * number, tail, channel)
    return elements


def _first(stream: memoryview) -> str:
    return bytes(stream[:1]).hex() or "nothing"


class _Packed:
    """The bytes of a stream and how far they are read.

    lengths: by the bits of a difference, how many bytes a group takes that begins at each place.
    """

    def __init__(self, stream: memoryview, end: int) -> None:
        self.bytes = bytes(stream)
        self.numbers = np.frombuffer(self.bytes, np.uint8)
        self.at, self.end = 1, end
        size = len(self.bytes) + _LONGEST
        self.lengths = {0: bytes(size), 8: bytes([GROUP]) * size}
        self.lengths |= {bits: self._lengths(bits) for bits in (1, 2, 4)}

    def _lengths(self, bits: int) -> bytes:
        whole = np.concatenate([_sentinels(bits)[self.numbers], np.zeros(2 * _LONGEST, np.uint8)])
        # Eight bits are enough to count up to 16 by a difference.
        before = np.cumsum(whole, dtype=np.uint8)
        own = np.concatenate([before[2 * bits - 1 : 2 * bits], before[2 * bits :] - before[: -2 * bits]])
        return (own[: len(self.bytes) + _LONGEST] + np.uint8(2 * bits)).tobytes()


@cache
def _sentinels(bits: int) -> Bytes:
    """How many differences of each byte mark that a whole byte follows."""
    differences = _unpacked(np.arange(256, dtype=np.uint8)[:, np.newaxis], bits)
    return np.asarray(np.count_nonzero(differences == (1 << bits) - 1, axis=1), dtype=np.uint8)


def _unpacked(packed: Bytes, bits: int) -> Bytes:
    """Bytes (n, k) as differences (n, k·8/bits)."""
    shifts = np.array(_SHIFTS[bits], dtype=np.uint8)
    differences = packed[:, :, np.newaxis] >> shifts & np.uint8((1 << bits) - 1)
    return np.asarray(differences.reshape(len(packed), packed.shape[1] * (8 // bits)))


def _portions(shape: _Shape) -> Iterator[list[int]]:
    """Blocks in lists that are large enough for numpy and small enough for the memory."""
    many = max(1, _PORTION // (shape.block * shape.stride))
    sizes = shape.sizes()
    while blocks := list(islice(sizes, many)):
        yield blocks


def _read_blocks(packed: _Packed, shape: _Shape, blocks: Sequence[int]) -> Bytes:
    """The differences of some blocks, still in zigzag, (elements, stride)."""
    places: list[int] = []
    kinds = bytearray()
    for size in blocks:
        _find_groups(packed, shape, size, places, kinds)
    differences = _expand(packed.numbers, np.array(places, dtype=np.int64), np.frombuffer(kinds, np.uint8))
    # The last block may be the only one that is not full.
    full = len(blocks) - (blocks[-1] != shape.block)
    border = full * shape.stride * (shape.block // GROUP)
    columns = differences[:border].reshape(full, shape.stride, shape.block)
    parts = columns.transpose(0, 2, 1).reshape(full * shape.block, shape.stride)
    if full == len(blocks):
        return parts
    rest = differences[border:].reshape(shape.stride, -1).T[: blocks[-1]]
    return np.concatenate([parts, rest])


def _find_groups(packed: _Packed, shape: _Shape, size: int, places: list[int], kinds: bytearray) -> None:
    """Where the groups of a block begin and how many bits their differences have, byte by byte.

    size: elements of the block.
    """
    groups, headers = _groups(size), _header_size(size)
    modes = [0] * shape.stride
    if shape.version:
        control = packed.bytes[packed.at : packed.at + shape.stride // 4]
        modes = [byte >> shift & 3 for byte in control for shift in (0, 2, 4, 6)]
        packed.at += len(control)
    at = packed.at
    for mode in modes:
        if mode in (_ALL_ZERO, _LITERAL):
            places.extend(range(at, at + groups * GROUP, GROUP))
            kinds += bytes([8 if mode == _LITERAL else 0]) * groups
            # Here alone a group that is not full is as short as what is in it.
            at += size if mode == _LITERAL else 0
        else:
            four = _header(shape.version, mode)
            bits = b"".join([four[byte] for byte in packed.bytes[at : at + headers]])
            at += headers
            kinds += bits[:groups]
            try:
                for width in bits[:groups]:
                    places.append(at)
                    at += packed.lengths[width][at]
            except IndexError:
                raise ValueError(_TOO_SHORT) from None
        if at > packed.end:
            raise ValueError(_TOO_SHORT)
    packed.at = at


@cache
def _header(version: int, mode: int) -> Sequence[bytes]:
    """For each byte of a header the bits of the differences of four groups."""
    bits = (_VERSION_1 if version else _VERSION_0)[mode]
    return [bytes(bits[byte >> shift & 3] for shift in (0, 2, 4, 6)) for byte in range(256)]


def _expand(numbers: Bytes, places: NDArray[np.int64], kinds: Bytes) -> Bytes:
    """The differences of groups, (n, 16)."""
    expanded = np.zeros((len(places), GROUP), np.uint8)
    for bits in (1, 2, 4):
        rows = np.flatnonzero(kinds == bits)
        starts = places[rows, np.newaxis]
        differences = _unpacked(numbers[starts + np.arange(2 * bits)], bits)
        follows = differences == (1 << bits) - 1
        if follows.any():
            behind = starts + 2 * bits + np.cumsum(follows, axis=1) - 1
            differences[follows] = numbers[behind[follows]]
        expanded[rows] = differences
    rows = np.flatnonzero(kinds == 8)
    expanded[rows] = numbers[places[rows, np.newaxis] + np.arange(GROUP)]
    return expanded


def _add_up(elements: Bytes, byte: int, first: bytes, channel: int) -> None:
    """Turn the differences of four bytes of all elements into values, in place."""
    mode = channel & 15
    kind: Any = np.dtype(("<u1", "<u2", "<u4")[mode])
    start = np.frombuffer(first[byte : byte + 4], kind)
    values = np.ascontiguousarray(elements[:, byte : byte + 4]).view(kind)
    if mode == 2:
        turn = channel >> 4
        values = values >> kind.type(turn) | values << kind.type((32 - turn) & 31)
        values[:1] ^= start
        summed = np.bitwise_xor.accumulate(values, axis=0)
    else:
        # Zigzag: the lowest bit is the sign.
        one = kind.type(1)
        values = values >> one ^ -(values & one)
        values[:1] += start
        summed = np.cumsum(values, axis=0, dtype=kind)
    elements[:, byte : byte + 4] = summed.view(np.uint8)


def decode_indices(stream: memoryview, count: int, stride: int) -> Bytes:
    """The numbers of an index stream, (count, stride) with a stride of 2 or 4, as bytes.

    Raises ValueError like `decode_attributes`.
    """
    if _first(stream) != "d1":
        raise ValueError(f"the compressed data begin with {_first(stream)}, not d1")
    if len(stream) < 1 + count + _INDEX_TAIL:
        raise ValueError(f"{len(stream)} bytes cannot hold {count} compressed indices")
    packed = np.frombuffer(stream[1 : len(stream) - _INDEX_TAIL], np.uint8)
    ends = np.flatnonzero(packed < 0x80)
    if len(ends) != count or ends[-1] != len(packed) - 1:
        raise ValueError(f"the compressed data hold {len(ends)} indices, not {count}")
    starts = np.concatenate([[0], ends[:-1] + 1])
    if (ends - starts).max() >= 5:
        raise ValueError("an index in the compressed data takes more than five bytes")
    sevens = np.arange(len(packed)) - np.repeat(starts, ends - starts + 1)
    bits = (packed & 0x7F).astype(np.uint64) << (7 * sevens).astype(np.uint64)
    codes = np.add.reduceat(bits, starts).astype(np.uint32)
    steps = codes >> np.uint32(2) ^ -(codes >> np.uint32(1) & np.uint32(1))
    indices = np.empty(count, np.uint32)
    # Two sequences, each counted from its own last index; the lowest bit selects which.
    for baseline in (0, 1):
        mine = codes & np.uint32(1) == baseline
        indices[mine] = np.cumsum(steps[mine], dtype=np.uint32)
    return indices.astype("<u4").view(np.uint8).reshape(count, 4)[:, :stride]
