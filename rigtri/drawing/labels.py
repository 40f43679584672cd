"""Names beside the joints: each where no other name and no joint is, or nowhere."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from rigtri.records import Booleans
from rigtri.trigonometry import Floats

# Names that are longer end in …; the whole name is told when the pointer is over the joint.
LONGEST = 36
# Cells of the grid that says where there is room, in pixels; letters as a share of the size of their font.
_CELL, _LETTER, _WIDE = 3.0, 0.56, 1.05
# How far a name may be from its joint, in pixels, and where: right and down.
_AWAY = (3.0, 12.0, 26.0)
_WAYS = ((1.0, 0.0), (0.8, -0.7), (0.8, 0.7), (0.0, -1.0), (0.0, 1.0), (-0.8, -0.7), (-0.8, 0.7), (-1.0, 0.0))


@dataclass(frozen=True)
class Placed:
    """A name on the sheet. x, y: where its line begins, or ends where ``left`` of its joint; both in pixels.

    far: so far from its joint, at ``from_``, that a line between the two is wanted.
    """

    text: str
    x: float
    y: float
    left: bool
    far: bool
    from_: tuple[float, float]


def width(text: str, font: float) -> float:
    """About how many pixels wide a line is; which font it will be is not known."""
    wide = sum(unicodedata.east_asian_width(letter) in "WF" for letter in text)
    return font * (_LETTER * (len(text) - wide) + _WIDE * wide)


def labels(
    asked: Sequence[tuple[str, Floats, float]],
    busy: Sequence[Floats],
    box: tuple[float, float, float, float],
    font: float,
) -> list[Placed]:
    """Names that have room, the first asked first. asked: name, place (2,) and radius of what is named.

    busy: lines, (2, 2), that names lie over only where there is no other room near. box: left, top,
    width and height of the room that there is.
    """
    left, top, wide, high = box
    taken = np.zeros((int(high / _CELL) + 1, int(wide / _CELL) + 1), dtype=bool)
    lined = _lined(busy, left, top, taken)

    def cells(x: float, y: float, w: float, h: float) -> tuple[slice, slice] | None:
        """The cells of a rectangle; None where it is not all in the room."""
        if x < left or y < top or x + w > left + wide or y + h > top + high:
            return None
        rows = slice(int((y - top) / _CELL), int((y + h - top) / _CELL) + 1)
        return rows, slice(int((x - left) / _CELL), int((x + w - left) / _CELL) + 1)

    for _, place, radius in asked:
        dot = cells(place[0] - radius, place[1] - radius, 2 * radius, 2 * radius)
        if dot is not None:
            taken[dot] = True

    def ways(out: float) -> Iterator[tuple[tuple[float, float, float], bool]]:
        """Where to put a name, the best first, and whether that must be free of lines."""
        near = [(away, x * out, y) for away in _AWAY[:2] for x, y in _WAYS]
        yield from ((way, True) for way in near)
        yield from (((away, x * out, y), False) for away in _AWAY for x, y in _WAYS)

    found = []
    for name, place, radius in asked:
        text = name if len(name) <= LONGEST else f"{name[: LONGEST - 1]}…"
        size = width(text, font), 1.1 * font
        # Outwards first: there is more room than in the middle.
        out = -1.0 if place[0] < left + 0.5 * wide else 1.0
        for way, free in ways(out):
            spot = _beside(place, radius, way, size)
            where = cells(*spot, *size)
            if where is not None and not taken[where].any() and not (free and lined[where].any()):
                taken[where] = True
                on_left = spot[0] + 0.5 * size[0] < place[0]
                x = spot[0] + size[0] if on_left else spot[0]
                far, at = way[0] > _AWAY[0], (float(place[0]), float(place[1]))
                found.append(Placed(text, x, spot[1] + 0.85 * font, on_left, far, at))
                break
    return found


def _lined(busy: Sequence[Floats], left: float, top: float, like: Booleans) -> Booleans:
    """The cells that lines go through."""
    lined = np.zeros_like(like)
    for start, end in busy:
        count = int(np.abs(end - start).max() / _CELL) + 2
        if count > sum(like.shape):  # mostly outside the room
            continue
        share = np.arange(count)[:, np.newaxis] / (count - 1)
        cells = ((start + (end - start) * share - [left, top]) / _CELL).astype(np.int64)
        inside = ((cells >= 0) & (cells < like.shape[::-1])).all(axis=1)
        lined[cells[inside, 1], cells[inside, 0]] = True
    return lined


def _beside(
    place: Floats, radius: float, way: tuple[float, float, float], size: tuple[float, float]
) -> tuple[float, float]:
    """The top left corner of a name that lies this way from its joint."""
    away, x, y = way
    off = radius + away
    left = place[0] + off * x - (size[0] if x < 0 else 0.5 * size[0] if x == 0 else 0.0)
    middle = place[1] + (off + 0.5 * size[1] * (abs(y) if abs(y) == 1 else 0.5)) * y
    return float(left), float(middle - 0.5 * size[1])
