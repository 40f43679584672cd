"""How the bytes of two glTF files differ: chunks, and what no buffer view covers."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rigtri.formats.gltf.container import BIN_CHUNK, JSON_CHUNK, Container
from rigtri.verification.diff.change import Change, arrow

# Bytes compared at once.
_BLOCK = 1 << 20
# Fewer bytes than this that are zero are there to align what follows.
ALIGNMENT = 4


def chunk_changes(before: Container, after: Container) -> Iterator[Change]:
    """Chunks that are gone, new, other, or in another order."""
    if before.is_glb != after.is_glb:
        words = [".glb" if side.is_glb else ".gltf" for side in (before, after)]
        yield Change("chunks", "changed", "container", arrow(*words))
        return
    names = [[_chunk_name(kind) for kind, _ in side.chunks] for side in (before, after)]
    if names[0] != names[1]:
        yield Change("chunks", "changed", "chunks", arrow(" ".join(names[0]), " ".join(names[1])))
    left = list(after.chunks)
    for kind, content in before.chunks:
        place = next((k for k, (other, _) in enumerate(left) if other == kind), -1)
        if place < 0:
            yield Change("chunks", "removed", f"chunk {_chunk_name(kind)}", f"{len(content)} bytes")
            continue
        _, now = left.pop(place)
        # The data of JSON and BIN are compared by what they mean.
        if kind not in (JSON_CHUNK, BIN_CHUNK) and not same_bytes(content, now):
            yield Change("chunks", "changed", f"chunk {_chunk_name(kind)}", describe_bytes(content, now))
    for kind, content in left:
        yield Change("chunks", "added", f"chunk {_chunk_name(kind)}", f"{len(content)} bytes")


def _chunk_name(kind: int) -> str:
    text = kind.to_bytes(4, "little").rstrip(b"\0")
    return text.decode("ascii") if text.isascii() and text.decode("ascii").isprintable() else f"0x{kind:08x}"


def loose_changes(buffer: int, start: int, content: memoryview, other: memoryview) -> Iterator[Change]:
    """What became of bytes that no view covers. other: the whole other buffer."""
    end = start + len(content)
    where = f"buffer {buffer}, bytes {start} to {end}"
    if same_bytes(content, other[start:end]):
        return
    if len(content) < ALIGNMENT and not any(content):
        return
    at = bytes(other).find(bytes(content))
    if at >= 0:
        yield Change("loose bytes", "moved", where, f"to {at}")
    elif len(other) < end:
        yield Change("loose bytes", "removed", where, f"{len(content)} bytes that no view covers")
    else:
        yield Change("loose bytes", "changed", where, describe_bytes(content, other[start:end]))


def same_bytes(one: bytes | memoryview | None, other: bytes | memoryview | None) -> bool:
    """Whether both are the same; two that cannot be read are."""
    if one is None or other is None:
        return one is other
    return len(one) == len(other) and all(
        bytes(one[at : at + _BLOCK]) == bytes(other[at : at + _BLOCK]) for at in range(0, len(one), _BLOCK)
    )


def describe_bytes(one: bytes | memoryview | None, other: bytes | memoryview | None) -> str:
    """How two pieces of data differ."""
    if one is None or other is None:
        return "can be read only in one of the files"
    if len(one) != len(other):
        return f"{len(one)} → {len(other)} bytes"
    count, first = 0, -1
    for at in range(0, len(one), _BLOCK):
        mine, theirs = (np.frombuffer(side[at : at + _BLOCK], np.uint8) for side in (one, other))
        differ = np.flatnonzero(mine != theirs)
        if len(differ) and first < 0:
            first = at + int(differ[0])
        count += len(differ)
    return f"{count} of {len(one)} bytes differ, the first at {first}"
