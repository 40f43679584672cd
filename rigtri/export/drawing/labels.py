"""Names beside the joints: each where no other name and no joint is, or nowhere."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence

import numpy as np

from rigtri.maths.arrays import Booleans
from rigtri.maths.trigonometry import Floats
from rigtri.model.dataclass import dataclass
from rigtri.text import shortened

# Names that are longer are shortened; the whole name is shown when the pointer is over the joint.
LONGEST = 36
# Cells of the grid that shows where there is room, in pixels; letters as a share of the size of their font.
_CELL, _LETTER, _WIDE = 3.0, 0.56, 1.05
# The smallest letters, in pixels.
_LEAST = 8.0
# How far a name may be from its joint, in pixels, and where: right and down.
_AWAY = (3.0, 12.0, 26.0)
_WAYS = ((1.0, 0.0), (0.8, -0.7), (0.8, 0.7), (0.0, -1.0), (0.0, 1.0), (-0.8, -0.7), (-0.8, 0.7), (-1.0, 0.0))
_NEAR_FIRST = [(away, x, y) for away in _AWAY for x, y in _WAYS]


@dataclass(frozen=True)
class Placed:
    """A name on the sheet. x, y: where its line begins, or ends where ``left`` of its joint; both in pixels.

    far: so far from its joint, at ``from_``, that a line between the two is drawn.
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


def fitted(text: str, font: float, wide: float) -> tuple[str, float]:
    """A line that has ``wide`` pixels, and its font: smaller where it must be, then cut.

    >>> fitted("three joints", 12.0, 400.0)
    ('three joints', 12.0)
    >>> fitted("three joints", 12.0, 64.0)
    ('three joints', 9.5)
    >>> fitted("three joints", 12.0, 40.0)
    ('three j…', 8.0)
    """
    size = min(font, np.floor(20.0 * wide / max(width(text, 10.0), 1.0)) / 2.0)
    if size >= _LEAST:
        return text, float(size)
    while text and width(f"{text}…", _LEAST) > wide:
        text = text[:-1].rstrip()
    return f"{text}…", _LEAST


def labels(
    requests: Sequence[tuple[str, Floats, float]],
    busy: Sequence[Floats],
    box: tuple[float, float, float, float],
    font: float,
    longest: int = LONGEST,
) -> list[Placed]:
    """Names that have room, the first requested first. requests: name, place (2,) and radius of each.

    busy: lines, (2, 2), that names lie over only where there is no other room near. box: left, top,
    width and height of the room that there is. longest: letters of a name.
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

    for _, place, radius in requests:
        dot = cells(place[0] - radius, place[1] - radius, 2 * radius, 2 * radius)
        if dot is not None:
            taken[dot] = True

    found = []
    for name, place, radius in requests:
        text = shortened(name, longest)
        size = width(text, font), 1.1 * font
        # Outwards first: there is more room than in the middle.
        out = -1.0 if place[0] < left + 0.5 * wide else 1.0
        spare: tuple[float, tuple[float, float], tuple[slice, slice]] | None = None
        for away, x, y in _NEAR_FIRST:
            if spare is not None and away == _AWAY[-1]:  # rather over a line than so far away
                break
            spot = _beside(place, radius, (away, x * out, y), size)
            where = cells(*spot, *size)
            if where is None or taken[where].any():
                continue
            clear = not lined[where].any()
            if spare is None or clear:
                spare = away, spot, where
            if clear:
                break
        if spare is not None:
            away, spot, where = spare
            taken[where] = True
            on_left = spot[0] + 0.5 * size[0] < place[0]
            start = spot[0] + size[0] if on_left else spot[0]
            at = (float(place[0]), float(place[1]))
            found.append(Placed(text, start, spot[1] + 0.85 * font, on_left, away > _AWAY[0], at))
    return found


def _lined(busy: Sequence[Floats], left: float, top: float, like: Booleans) -> Booleans:
    """The cells that lines go through."""
    lined = np.zeros_like(like)
    if not busy:
        return lined
    starts, ends = np.stack(list(busy), axis=1)
    cells_long = np.abs(ends - starts).max(axis=1) / _CELL
    # Longer ones are mostly outside the room.
    counts = np.where(cells_long < sum(like.shape), cells_long, -2.0).astype(np.int64) + 2
    for count in np.unique(counts[counts > 0]).tolist():
        some = counts == count
        start, end = starts[some, np.newaxis], ends[some, np.newaxis]
        share = np.arange(count)[:, np.newaxis] / (count - 1)
        cells = ((start + (end - start) * share - [left, top]) / _CELL).astype(np.int64).reshape(-1, 2)
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
