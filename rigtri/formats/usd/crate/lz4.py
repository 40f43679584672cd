"""Unpacking the LZ4 blocks of crate files.

Source: LZ4 block format description (github.com/lz4/lz4, doc/lz4_Block_format.md); the byte
in front, a count of chunks, is OpenUSD's.
"""

from __future__ import annotations

# A match of n bytes takes one byte for each 255 of them.
MOST = 255
_SHORTEST_MATCH = 4


def unpacked(packed: bytes, most: int) -> bytes:
    """The bytes in a packed run; ValueError where they are damaged or more than ``most``."""
    if not packed:
        raise ValueError("nothing is there")
    if packed[0] == 0:
        return _block(packed, 1, len(packed), most)
    whole, at = bytearray(), 1
    for _ in range(packed[0]):
        size = int.from_bytes(packed[at : at + 4], "little")
        if at + 4 + size > len(packed):
            raise ValueError("a chunk ends outside")
        whole += _block(packed, at + 4, at + 4 + size, most - len(whole))
        at += 4 + size
    return bytes(whole)


def _block(packed: bytes, at: int, end: int, most: int) -> bytes:
    out = bytearray()
    while at < end:
        token = packed[at]
        literals, at = _length(packed, at + 1, end, token >> 4)
        if at + literals > end:
            raise ValueError("it is cut off")
        out += packed[at : at + literals]
        at += literals
        if at < end:
            back = int.from_bytes(packed[at : at + 2], "little")
            size, at = _length(packed, at + 2, end, token & 15)
            _repeat(out, back, size + _SHORTEST_MATCH, most)
        if len(out) > most:
            raise ValueError("it is larger than it claims")
    return bytes(out)


def _length(packed: bytes, at: int, end: int, length: int) -> tuple[int, int]:
    if length == 15:
        while True:
            if at >= end:
                raise ValueError("it is cut off")
            more = packed[at]
            length, at = length + more, at + 1
            if more != 255:
                break
    return length, at


def _repeat(out: bytearray, back: int, size: int, most: int) -> None:
    """Append ``size`` bytes that began ``back`` bytes ago, perhaps some of the new ones too."""
    start = len(out) - back
    if back == 0 or start < 0 or len(out) + size > most:
        raise ValueError("it repeats what is not there")
    if back >= size:
        out += out[start : start + size]
    else:
        piece = bytes(out[start:])
        out += (piece * (size // back + 1))[:size]
