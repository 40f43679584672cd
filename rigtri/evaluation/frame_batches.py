"""Frames in batches, so that memory does not grow with their number."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from rigtri.evaluation.constraint_solver import Parts
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import by_component

# Frames evaluated at once: enough that numpy's calls cost little, and a hundred joints 100 MB.
BLOCK = 4096


def frames(parts: Mapping[int, Parts]) -> int:
    """How many frames there are; 1 where nothing moves."""
    return max((len(each) for of in parts.values() for each in of), default=1)


def blocks(count: int, block: int = BLOCK) -> list[slice]:
    """All of ``count`` frames, so many at a time."""
    return [slice(start, min(start + block, count)) for start in range(0, count, block)]


def cut(parts: Mapping[int, Parts], rows: slice) -> dict[int, Parts]:
    """Some frames of what moves; what does not has one row, and keeps it."""
    return {
        node: Parts(*(part if len(part) == 1 else part[rows] for part in of)) for node, of in parts.items()
    }


def joined(found: Sequence[Mapping[int, Parts]], count: int, block: int = BLOCK) -> dict[int, Parts]:
    """The parts of the blocks of ``count`` frames, one after another."""
    if len(found) == 1:
        return dict(found[0])
    sizes = [rows.stop - rows.start for rows in blocks(count, block)]
    return {
        node: Parts(*(_joined([part[node][k] for part in found], sizes) for k in range(3)))
        for node in found[0]
    }


def _joined(pieces: Sequence[Floats], sizes: Sequence[int]) -> Floats:
    """Pieces of ``sizes`` rows, or of one that holds for all of them, one after another."""
    if all(len(piece) == 1 and np.array_equal(piece, pieces[0]) for piece in pieces):
        return pieces[0]
    together, start = by_component((sum(sizes), pieces[0].shape[1])), 0
    for piece, size in zip(pieces, sizes, strict=True):
        together[start : start + size] = piece
        start += size
    return together
