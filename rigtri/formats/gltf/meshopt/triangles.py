"""Streams of triangles in meshopt: each is coded by an edge or by corners that came shortly before.

The sixteen last edges and the sixteen last corners are kept. A byte for each triangle names which of
them it shares; what is further away is a difference from the last corner that was coded so.

Source: KHR_meshopt_compression, appendix A, "Mode 1: triangles".
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence

import numpy as np

from rigtri.formats.gltf.meshopt.attributes import Bytes

_FIRST_BYTE = 0xE1
# Bytes of the table of corner pairs, which ends the stream.
_TABLE = 16
_KEPT = 16
_MOST = (1 << 32) - 1
# What four bits mean for a corner: the next one that is new, or one that is spelled out.
_NEW, _SPELLED = 0, 15
# A corner beside an edge may be next to the last one spelled out: one before it, or one behind.
_STEPS = {13: -1, 14: 1}


def decode_triangles(stream: memoryview, count: int, stride: int) -> Bytes:
    """The corners of a triangle stream, (count, stride) with a stride of 2 or 4, as bytes.

    Raises ValueError, in words for the user, for a stream that is none or that has not exactly what
    ``count`` corners take.
    """
    first = bytes(stream[:1])
    if first != bytes([_FIRST_BYTE]):
        raise ValueError(f"the compressed data begin with {first.hex() or 'nothing'}, not e1")
    if count % 3:
        raise ValueError(f"{count} corners are not a whole number of triangles")
    if len(stream) < 1 + count // 3 + _TABLE:
        raise ValueError(f"{len(stream)} bytes cannot hold {count} compressed corners of triangles")
    packed = bytes(stream)
    codes, rest = packed[1 : 1 + count // 3], packed[1 + count // 3 : -_TABLE]
    triangles = _Triangles(rest, packed[-_TABLE:])
    corners = np.fromiter(triangles.corners(codes), np.uint32, count)
    triangles.end()
    return corners.astype("<u4").view(np.uint8).reshape(count, 4)[:, :stride]


class _Triangles:
    """What is known while triangles are read. rest: the bytes behind the codes of triangles.

    edges, seen: the latest first. new: the next corner that no triangle has yet. last: the last one
    that was spelled out.
    """

    def __init__(self, rest: bytes, table: bytes) -> None:
        self._rest, self._table, self._at = rest, table, 0
        self._edges: deque[tuple[int, int]] = deque([(_MOST, _MOST)] * _KEPT, _KEPT)
        self._seen: deque[int] = deque([_MOST] * _KEPT, _KEPT)
        self._new = self._last = 0

    def corners(self, codes: Sequence[int]) -> Iterator[int]:
        """Three for each code. ValueError where bytes are missing."""
        for code in codes:
            yield from self._beside(code >> 4, code & 15) if code < 0xF0 else self._alone(code)

    def end(self) -> None:
        """ValueError where bytes are left over."""
        if self._at != len(self._rest):
            raise ValueError(f"{len(self._rest) - self._at} bytes of the compressed data are left over")

    def _beside(self, edge: int, code: int) -> tuple[int, int, int]:
        """A triangle at an edge that came before."""
        a, b = self._edges[edge]
        if code in _STEPS:
            c = self._last = (self._last + _STEPS[code]) & _MOST
        elif code == _SPELLED:
            c = self._spelled()
        else:
            c = self._fresh() if code == _NEW else self._seen[code]
        if code == _NEW or code > 12:
            self._seen.appendleft(c)
        self._edges.extendleft([(c, b), (a, c)])
        return a, b, c

    def _alone(self, code: int) -> tuple[int, int, int]:
        """A triangle that shares no edge: its first corner is new, or spelled out."""
        long = code >= 0xFE
        pair = self._byte() if long else self._table[code & 15]
        if long and pair == 0:
            self._new = 0
        codes = (_SPELLED if code == 0xFF else _NEW, pair >> 4, pair & 15)
        # New ones are counted, and older ones looked up, before any that is spelled out is read.
        found = [self._fresh() if one == _NEW else self._seen[one - 1] for one in codes]
        spelled = [long and one == _SPELLED for one in codes]
        a, b, c = (self._spelled() if out else at for out, at in zip(spelled, found, strict=True))
        kept = [one == _NEW or out for one, out in zip(codes, spelled, strict=True)]
        self._seen.extendleft(at for at, keep in zip((a, b, c), kept, strict=True) if keep)
        self._edges.extendleft([(b, a), (c, b), (a, c)])
        return a, b, c

    def _fresh(self) -> int:
        self._new += 1
        return self._new - 1

    def _spelled(self) -> int:
        """A corner as a difference from the last one, in groups of seven bits, the lowest first."""
        value = shift = 0
        while True:
            byte = self._byte()
            value |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80:
                break
            if shift > 28:
                raise ValueError("a corner in the compressed data takes more than five bytes")
        self._last = (self._last + (value >> 1 ^ -(value & 1))) & _MOST
        return self._last

    def _byte(self) -> int:
        if self._at == len(self._rest):
            raise ValueError("the compressed data end too early")
        self._at += 1
        return self._rest[self._at - 1]
