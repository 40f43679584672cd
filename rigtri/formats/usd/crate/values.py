"""Whether the values of a crate lie in it, and its arrays can be as long as they claim.

Source: OpenUSD, pxr/usd/usd: crateFile.cpp, crateDataTypes.h, crateValueInliners.h.
"""

from __future__ import annotations

import struct

import numpy as np

from rigtri.formats.usd.crate import lz4

Words = np.ndarray[tuple[int, ...], np.dtype[np.uint64]]

_ARRAY, _INLINED, _COMPRESSED = 1 << 63, 1 << 62, 1 << 61
_STRING, _TOKEN, _ASSET, _TIME_SAMPLES = 10, 11, 12, 46
# Type → bytes of one item of an array; strings, tokens, paths and expressions are indices.
_SIZES = {
    1: 1, 2: 1, 3: 4, 4: 4, 5: 8, 6: 8, 7: 2, 8: 4, 9: 8, 10: 4, 11: 4, 12: 4, 13: 32, 14: 72, 15: 128,
    16: 32, 17: 16, 18: 8, 19: 16, 20: 8, 21: 4, 22: 8, 23: 24, 24: 12, 25: 6, 26: 12, 27: 32, 28: 16,
    29: 8, 30: 16, 56: 8, 57: 4,
}  # fmt: skip
# Type → bytes that one item takes at least, of those that start with a count.
_COUNTED = {31: 12, 40: 4, 41: 4, 45: 8, 48: 8, 49: 16, 50: 4, 58: 8}
# Lists of edits: a byte whose bits are the lists that follow, then each with its count.
_LISTS = {32: 4, 33: 4, 34: 4, 35: 8, 36: 4, 37: 8, 38: 4, 39: 8, 54: 8, 55: 8}


def check(
    content: memoryview, values: Words, version: tuple[int, int, int], tokens: int, strings: int
) -> None:
    """ValueError for a value outside the file, or one that claims more items than it can have."""
    seen: set[int] = set()
    for kind, most in ((_STRING, strings), (_TOKEN, tokens), (_ASSET, tokens)):
        mine = values[(values >> np.uint64(48)) & np.uint64(0x80FF) == kind] & np.uint64(0xFFFFFFFF)
        if len(mine) and int(mine.max()) >= most:
            raise ValueError(f"a value names text {int(mine.max())} of {most}")
    for value in values.tolist():
        _check(content, value, version, seen)


def _check(content: memoryview, value: int, version: tuple[int, int, int], seen: set[int]) -> None:
    kind, at = value >> 48 & 0xFF, value & (1 << 48) - 1
    if value & _INLINED or (value & _ARRAY and at == 0) or value in seen:
        return
    if kind not in _SIZES and kind not in _COUNTED and kind not in _LISTS and kind != _TIME_SAMPLES:
        return
    seen.add(value)
    if value & _ARRAY:
        _check_array(content, kind, at, bool(value & _COMPRESSED), version)
    elif kind in _COUNTED:
        _fits(content, at + 8, _number(content, at), _COUNTED[kind])
    elif kind in _LISTS:
        _fits(content, at + 9, _number(content, at + 1) if _lists(content, at) else 0, _LISTS[kind])
    elif kind == _TIME_SAMPLES:
        _check_samples(content, at, version, seen)


def _lists(content: memoryview, at: int) -> int:
    """Which lists follow, by the bits after the first, which makes the whole explicit."""
    _inside(content, at, 1)
    return content[at] & 0b1111110


def _check_array(
    content: memoryview, kind: int, at: int, compressed: bool, version: tuple[int, int, int]
) -> None:
    at += 4 if version < (0, 5, 0) else 0  # the number of dimensions, always one
    wide = version >= (0, 7, 0)
    _inside(content, at, 8 if wide else 4)
    count = int(struct.unpack_from("<Q" if wide else "<I", content, at)[0])
    at += 8 if wide else 4
    size = _SIZES.get(kind, 1)
    if not compressed or count < 16:
        _fits(content, at, count, size)
        return
    if kind in (7, 8, 9):
        _inside(content, at, 5)
        if content[at] == ord("t"):
            entries = int(struct.unpack_from("<I", content, at + 1)[0])
            _fits(content, at + 5, entries, size)
            at += 4 + entries * size
        at += 1
    packed = _number(content, at)
    _fits(content, at + 8, packed, 1)
    if count > 4 * lz4.MOST * packed + 64:
        raise ValueError(f"an array claims {count} items, more than it can hold")


def _check_samples(content: memoryview, at: int, version: tuple[int, int, int], seen: set[int]) -> None:
    """Times and values; each stands behind what it needs, by a jump from where the jump is written."""
    times = at + _jump(content, at)
    _check(content, _number(content, times), version, seen)
    start = times + 8
    start += _jump(content, start)
    count = _number(content, start)
    _fits(content, start + 8, count, 8)
    for value in np.frombuffer(content[start + 8 : start + 8 + 8 * count], dtype="<u8").tolist():
        if value >> 48 & 0xFF != _TIME_SAMPLES:
            _check(content, value, version, seen)


def _jump(content: memoryview, at: int) -> int:
    _inside(content, at, 8)
    return int(struct.unpack_from("<q", content, at)[0])


def _number(content: memoryview, at: int) -> int:
    _inside(content, at, 8)
    return int(struct.unpack_from("<Q", content, at)[0])


def _fits(content: memoryview, at: int, count: int, size: int) -> None:
    _inside(content, at, 0)
    if count * size > len(content) - at:
        raise ValueError(f"a value claims {count} items, more than the file holds")


def _inside(content: memoryview, at: int, size: int) -> None:
    if at < 0 or at + size > len(content):
        raise ValueError("a value lies outside the file")
