"""Marks as SVG: what each looks like, in an order in which near things cover far ones.

Numbers have two decimals and come from + − × ÷ √, so the same rig is the same bytes everywhere.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from rigtri.export.drawing.labels import LONGEST, fitted, labels
from rigtri.export.drawing.primitives import Mark
from rigtri.export.drawing.style import css
from rigtri.export.drawing.view import HEAD_ON, Window
from rigtri.maths.trigonometry import Floats
from rigtri.model.dataclass import dataclass

# What is drawn over what; joints come with the arrows of their axes, after all of these.
_LAYERS = (
    "follows",
    "link",
    "limb",
    "bone",
    "chord",
    "upright",
    "square",
    "foot",
    "control",
    "pole",
    "vector",
)
# Half the thickness of an arrow as a share of its length; and from where to where, in pixels.
_THICK, _THIN, _FAT = 0.04, 0.45, 1.5
# Radius of a dot, in pixels, from where to where; how wide a bone is and where, as shares of its length,
# and how wide at most, in pixels.
_DOTS, _BONE, _SHOULDER, _BROAD = (1.0, 4.5), 0.13, 0.14, 18.0


def panel(
    marks: Sequence[Mark], window: Window, loops: Sequence[Floats], *, font: float, longest: int = LONGEST
) -> tuple[list[str], int]:
    """The elements of one picture, and how many names had no room. loops: of the outline, (k, 2), in pixels.

    font: the size of names in pixels, 0 for none; longest: their letters.
    """
    parts = [path(loops, "body")] if loops else []
    seen = _Seen.of(marks, window)
    for kind in _LAYERS:
        alike = [mark for mark in marks if mark.kind == kind]
        alike.sort(key=lambda m: float(window.view.depth(m.points[0] + m.points[-1])))
        parts += [_titled(_shown(mark, seen), mark.description) for mark in alike]
    parts += _joints(marks, seen)
    named = [mark for mark in marks if mark.form == "dot" and mark.name] if font else []
    named.sort(key=lambda mark: (not mark.crooked, -mark.size))
    requests = [(printable(m.name), seen.places(m)[0], _radius(m, window) + 1.0) for m in named]
    busy = [seen.places(mark) for mark in marks if mark.form == "arrow"]
    placed = labels(requests, busy, (window.left, window.top, window.wide, window.high), font, longest)
    for label in placed:
        if label.far:
            (x, y), end = label.from_, (label.x, label.y - 0.35 * font)
            parts.append(f'<path class="leader" d="M{pair((x, y))} {pair(end)}"/>')
        anchor = ' text-anchor="end"' if label.left else ""
        where = f'x="{number(label.x)}" y="{number(label.y)}" font-size="{number(font)}"{anchor}'
        parts.append(f'<text class="name" {where}>{escape(label.text)}</text>')
    return parts, len(named) - len(placed)


@dataclass(frozen=True, eq=False)
class _Seen:
    """Marks in a window, all placed at once. flat: (p, 2), in pixels; depth: (p,), the larger the nearer.

    rows: where the points of each mark begin and end, by its identity.
    """

    window: Window
    flat: Floats
    depth: Floats
    rows: dict[int, slice]

    @staticmethod
    def of(marks: Sequence[Mark], window: Window) -> _Seen:
        points = np.concatenate([*(mark.points for mark in marks), np.zeros((0, 3))])
        ends = np.cumsum([len(mark.points) for mark in marks], dtype=np.int64).tolist()
        rows = {id(m): slice(end - len(m.points), end) for m, end in zip(marks, ends, strict=True)}
        return _Seen(window, window.on_sheet(points), window.view.depth(points), rows)

    def places(self, mark: Mark) -> Floats:
        return self.flat[self.rows[id(mark)]]

    def near(self, mark: Mark) -> float:
        """How near a mark begins."""
        return float(self.depth[self.rows[id(mark)].start])

    def ahead(self, mark: Mark) -> float:
        """How much nearer it ends than it begins."""
        along = mark.points[-1] - mark.points[0]
        return float(self.window.view.depth(along))


def _joints(marks: Sequence[Mark], seen: _Seen) -> list[str]:
    """The dots and axes of joints, the nearest last; what belongs to one joint is a group with its name."""
    groups: dict[str, list[Mark]] = {}
    for k, mark in enumerate(marks):
        if mark.kind in ("x", "y", "z", "joint", "node", "locator"):
            groups.setdefault(mark.node or f"#{k}", []).append(mark)

    def near(group: list[Mark]) -> float:
        return seen.near(group[-1])

    parts = []
    for group in sorted(groups.values(), key=near):
        order = sorted(group, key=lambda mark: (mark.form == "dot", seen.ahead(mark)))
        shapes = "".join(_shown(mark, seen) for mark in order)
        parts.append(f"<g>{_title(' / '.join(m.description for m in group if m.description))}{shapes}</g>")
    return parts


def _shown(mark: Mark, seen: _Seen) -> str:
    """One mark as an element."""
    places, window = seen.places(mark), seen.window
    if mark.form == "dot":
        return _dot(mark, places[0], _radius(mark, window))
    if mark.form == "arrow":
        return arrow(places[0], places[1], mark.kind, mark.size * window.scale, seen.ahead(mark) > 0)
    if mark.form == "bone":
        return _bone(places[0], places[1])
    return path([places], mark.kind, closed=mark.closed, more=stroke(mark.color))


def stroke(color: Sequence[float] | None) -> str:
    """The attribute for lines of a linear RGB colour; "" for none."""
    return f' style="stroke:{_hex(color)}"' if color is not None and len(color) == 3 else ""


def _radius(mark: Mark, window: Window) -> float:
    return min(max(mark.size * window.scale, _DOTS[0]), _DOTS[1]) + (1.0 if mark.crooked else 0.0)


def _dot(mark: Mark, place: Floats, radius: float) -> str:
    kind = f"{mark.kind} crooked" if mark.crooked else mark.kind
    if mark.kind == "locator":
        off = np.array([[0, -1], [1, 0], [0, 1], [-1, 0]]) * (radius + 2.0)
        return path([place + off], kind)
    return f'<circle class="{kind}" cx="{number(place[0])}" cy="{number(place[1])}" r="{number(radius)}"/>'


def arrow(start: Floats, end: Floats, kind: str, size: float, ahead: bool) -> str:
    """An arrow, ``size`` pixels long in space; one that is seen head on is a ring, crossed from behind."""
    along = end - start
    seen = float(np.sqrt(along[0] * along[0] + along[1] * along[1]))
    thick = min(max(_THICK * size, _THIN), _FAT)
    if seen < HEAD_ON * size or seen < 0.5:
        return _head_on(start, kind, min(max(0.16 * size, 1.5), 6.0), ahead)
    along = along / seen
    across = np.array([-along[1], along[0]]) * thick
    neck = end - along * min(7.0 * thick, 0.5 * seen)
    corners = [start + across, neck + across, neck + 2.8 * across, end]
    corners += [neck - 2.8 * across, neck - across, start - across]
    return path([np.stack(corners)], kind)


def _head_on(place: Floats, kind: str, radius: float, ahead: bool) -> str:
    x, y = place.tolist()
    ring = f'<circle class="{kind} ring" cx="{number(x)}" cy="{number(y)}" r="{number(radius)}"/>'
    if ahead:
        return ring
    off = 0.7 * radius
    ways = " ".join(f"M{pair((x - off, y - o))} {pair((x + off, y + o))}" for o in (off, -off))
    return f'{ring}<path class="{kind} ring" d="{ways}"/>'


def _bone(start: Floats, end: Floats) -> str:
    """A bone as a kite, wide near the joint that turns it."""
    along = end - start
    size = float(np.sqrt(along[0] * along[0] + along[1] * along[1]))
    wide = np.array([-along[1], along[0]]) * 0.5 * min(_BONE, _BROAD / size if size > 0 else 0.0)
    shoulder = start + along * _SHOULDER
    return path([np.stack([start, shoulder + wide, end, shoulder - wide])], "bone")


def path(strips: Iterable[Floats], kind: str, *, closed: bool = True, more: str = "") -> str:
    ways = (
        f"M{' '.join(pair(point) for point in strip.tolist())}{'Z' if closed else ''}" for strip in strips
    )
    return f'<path class="{kind}"{more} d="{"".join(ways)}"/>'


def _titled(element: str, description: str) -> str:
    return f"<g>{_title(description)}{element}</g>" if description else element


def _title(description: str) -> str:
    return f"<title>{escape(printable(description))}</title>" if description else ""


def sheet(parts: Sequence[str], wide: int, high: int, description: str) -> str:
    """A whole SVG document of elements. description: what it shows, for those who cannot see it."""
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide}" height="{high}" '
            f'viewBox="0 0 {wide} {high}" role="img" aria-label={quoteattr(printable(description))}>',
            f"<style>\n{css()}\n</style>",
            f'<rect class="paper" width="{wide}" height="{high}"/>',
            *parts,
            "</svg>\n",
        ]
    )


def heading(lines: Sequence[tuple[str, str]], left: float, wide: float) -> Iterator[str]:
    """The words over a picture, one below the other, each by its class; smaller where it has little room."""
    for row, (kind, text) in enumerate(lines):
        font = 16.0 if kind == "title" else 12.0
        # Bold letters are wider.
        line, size = fitted(printable(text), font, (wide - 24.0) * (1.0 if kind == "words" else 0.92))
        style = f' style="font-size: {number(size)}px"' if size != font else ""
        where = f'x="{number(left + 16)}" y="{number(26 + 19 * row)}"'
        yield f'<text class="{kind}" {where}{style}>{escape(line)}</text>'


def printable(text: str) -> str:
    """Text as a picture may hold it: what is no character to look at is a replacement."""
    return (
        text
        if text.isprintable()
        else "".join(t if t.isprintable() else "\N{REPLACEMENT CHARACTER}" for t in text)
    )


def number(value: float) -> str:
    """Two decimals at most.

    >>> number(1.0), number(-0.001), number(2.556)
    ('1', '0', '2.56')
    """
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def pair(point: Sequence[float]) -> str:
    return f"{number(point[0])},{number(point[1])}"


def _hex(color: Sequence[float]) -> str:
    """Linear RGB as the #rrggbb of sRGB, by roots that come close enough for eight bits."""
    codes = []
    for value in color:
        linear = min(max(value, 0.0), 1.0)
        one = float(np.sqrt(linear))
        two = float(np.sqrt(one))
        three = float(np.sqrt(two))
        curve = 0.585122381 * one + 0.783140355 * two - 0.368262736 * three
        codes.append(round(255 * min(max(12.92 * linear if linear <= 0.0031308 else curve, 0.0), 1.0)))
    return "#" + "".join(f"{code:02x}" for code in codes)
