"""Mutations of a file as bytes: what a bad disk, a cut download or a text editor does."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable
from random import Random


def flip(content: bytes, r: Random) -> bytes:
    """One to eight bits anywhere."""
    changed = bytearray(content)
    for _ in range(r.choice([1, 1, 2, 8])):
        if changed:
            changed[r.randrange(len(changed))] ^= 1 << r.randrange(8)
    return bytes(changed)


def cut(content: bytes, r: Random) -> bytes:
    """The end is missing."""
    return content[: r.randrange(len(content) + 1)]


def grow(content: bytes, r: Random) -> bytes:
    """More bytes behind the end, or a piece of the file twice."""
    at = r.randrange(len(content) + 1)
    end = min(len(content), at + r.randrange(64))
    return r.choice([content + b"\0" * r.randrange(1, 9), content[:end] + content[at:]])


def remove(content: bytes, r: Random) -> bytes:
    """A piece is missing."""
    at = r.randrange(len(content) + 1)
    return content[:at] + content[at + r.randrange(1, 64) :]


def integer(content: bytes, r: Random) -> bytes:
    """Four bytes that may be a length or an offset."""
    changed = bytearray(content)
    if len(changed) < 8:
        return content
    at = r.choice([4, 8, 12, 16, 20, 4 * r.randrange(len(changed) // 4)])
    number = r.choice([0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, len(content), len(content) - 1])
    changed[at : at + 4] = struct.pack("<I", number)
    return bytes(changed[: len(content)])


def digit(content: bytes, r: Random) -> bytes:
    """A number in a text becomes another."""
    found = list(re.finditer(rb"-?\d+(\.\d+)?", content[:60000]))
    if not found:
        return content
    at = r.choice(found)
    new = r.choice(
        [b"0", b"-1", b"1e9", b"1e-9", b"1.5", b"nan", b"inf", b"2147483648", b"1e39", b"1e999", b"7"]
    )
    return content[: at.start()] + new + content[at.end() :]


EVERY: list[Callable[[bytes, Random], bytes]] = [flip, flip, cut, grow, remove, integer, digit]
