"""Meshopt streams made in plain Python, byte by byte, and what the C library makes of them.

Nothing here is rigtri's. The encoder tries no harder than it must: which of the allowed
ways a byte goes is drawn by chance, so that a few streams hold all of them.

Source: KHR_meshopt_compression, appendix A.
"""

from __future__ import annotations

import base64
import json
import os
import random
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import pytest

# tests/README.md says what RIGTRI_MESHOPTIMIZER names.
NO_LIBRARY = "meshoptimizer is not here: set RIGTRI_MESHOPTIMIZER"
_SCRIPT = Path(__file__).parent / "meshopt.mjs"


def encode_attributes(elements: bytes, stride: int, version: int, chance: random.Random) -> bytes:
    """A stream of version 0 or 1 with the elements of ``stride`` bytes."""
    rows = [elements[k : k + stride] for k in range(0, len(elements), stride)]
    modes = [_channel(chance) if version else 0 for _ in range(stride // 4)]
    deltas = [_deltas(now, then, modes) for now, then in zip(rows, [rows[0], *rows], strict=False)]
    size = min(8192 // stride // 16 * 16, 256)
    out = bytes([0xA0 + version])
    for start in range(0, len(deltas), size):
        out += _block(deltas[start : start + size], stride, version, chance)
    tail = rows[0] + (bytes(modes) if version else b"")
    return out + b"\0" * ((24 if version else 32) - len(tail)) + tail


def _channel(chance: random.Random) -> int:
    mode = chance.randrange(3)
    return mode | chance.randrange(16) << 4 if mode == 2 else mode


def _deltas(now: bytes, then: bytes, modes: Sequence[int]) -> bytes:
    """How four bytes after the other differ from those of the element before."""
    found = b""
    for channel, mode in enumerate(modes):
        width = (1, 2, 4)[mode & 3]
        for at in range(4 * channel, 4 * channel + 4, width):
            new, old = (int.from_bytes(row[at : at + width], "little") for row in (now, then))
            bits = 8 * width
            if mode & 3 == 2:
                value, turn = new ^ old, mode >> 4
                value = (value << turn | value >> (bits - turn)) & (1 << bits) - 1
            else:
                step = (new - old) % (1 << bits)
                negative = step >> (bits - 1)
                value = ((1 << bits) - 1 - step) * 2 + 1 if negative else step * 2
            found += value.to_bytes(width, "little")
    return found


def _block(deltas: Sequence[bytes], stride: int, version: int, chance: random.Random) -> bytes:
    controls, columns = [], b""
    for byte in range(stride):
        column = bytes(delta[byte] for delta in deltas)
        allowed = [0, 1, 3, *([2] if not any(column) else [])] if version else [0]
        control = chance.choice(allowed)
        controls.append(control)
        if control == 3:
            columns += column
        elif control != 2:
            kinds = ((0, 1, 2, 4), (1, 2, 4, 8))[control] if version else (0, 2, 4, 8)
            columns += _column(column, kinds, chance)
    packed = [sum(c << 2 * k for k, c in enumerate(controls[i : i + 4])) for i in range(0, stride, 4)]
    return (bytes(packed) if version else b"") + columns


def _column(column: bytes, kinds: Sequence[int], chance: random.Random) -> bytes:
    header, content = [], b""
    for start in range(0, len(column), 16):
        group = column[start : start + 16].ljust(16, b"\0")
        code = chance.choice([k for k, bits in enumerate(kinds) if bits or not any(group)])
        header.append(code)
        content += _group(group, kinds[code])
    packed = [sum(c << 2 * k for k, c in enumerate(header[i : i + 4])) for i in range(0, len(header), 4)]
    return bytes(packed) + content


def _group(group: bytes, bits: int) -> bytes:
    if bits in (0, 8):
        return group if bits else b""
    most = (1 << bits) - 1
    small = [min(value, most) for value in group]
    each = 8 // bits
    places = range(0, 8, bits) if bits == 1 else range(8 - bits, -1, -bits)
    packed = [
        sum(v << p for v, p in zip(small[k : k + each], places, strict=True)) for k in range(0, 16, each)
    ]
    return bytes(packed) + bytes(value for value in group if value >= most)


def encode_indices(indices: Sequence[int], chance: random.Random) -> bytes:
    """An index stream; which of the two sequences an index belongs to is drawn by chance."""
    out, last = b"\xd1", [0, 0]
    for index in indices:
        which = chance.randrange(2)
        step = index - last[which]
        last[which] = index
        code = (-step * 2 - 1 if step < 0 else step * 2) << 1 | which
        while code >= 0x80:
            out += bytes([code & 0x7F | 0x80])
            code >>= 7
        out += bytes([code])
    return out + bytes(4)


class Job(NamedTuple):
    """Elements for the C library to encode, with level and version, and to decode again."""

    raw: bytes
    stride: int
    mode: str = "ATTRIBUTES"
    kind: str = "NONE"
    version: int = 1
    level: int = 2

    @property
    def count(self) -> int:
        return len(self.raw) // self.stride


def by_the_c_library(jobs: Sequence[Job]) -> list[tuple[bytes, bytes]]:
    """The stream of each job and what it decodes to. Skips where the library is not there."""
    folder, node = os.environ.get("RIGTRI_MESHOPTIMIZER"), shutil.which("node")
    if not folder or not node:
        pytest.skip(NO_LIBRARY)
    asked = [job._asdict() | {"raw": base64.b64encode(job.raw).decode(), "count": job.count} for job in jobs]
    run = subprocess.run(
        [node, _SCRIPT, folder],
        input=json.dumps(asked),
        capture_output=True,
        text=True,
        check=True,
        timeout=300,
    )
    found: list[dict[str, Any]] = json.loads(run.stdout)
    return [(base64.b64decode(one["stream"]), base64.b64decode(one["decoded"])) for one in found]
