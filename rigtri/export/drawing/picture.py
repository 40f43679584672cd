"""draw: a rig as a picture, alone or beside what it was before."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from rigtri.errors import FileError
from rigtri.evaluation.timelines import timeline_and_time
from rigtri.export.drawing.bones import AIMED
from rigtri.export.drawing.labels import width
from rigtri.export.drawing.primitives import Mark
from rigtri.export.drawing.scene import Scene, marks
from rigtri.export.drawing.silhouette import Patch, outline, patches
from rigtri.export.drawing.style import LEGEND
from rigtri.export.drawing.svg import arrow, heading, number, panel, path, sheet, stroke
from rigtri.export.drawing.view import View, Window, view_of
from rigtri.maths.trigonometry import Floats
from rigtri.model.dataclass import dataclass
from rigtri.model.options import check
from rigtri.model.rig import Rig
from rigtri.operations.operation import takes_keywords
from rigtri.operations.options.draw import VIEWS, DrawOptions
from rigtri.operations.pose import PoseOptions, pose_of
from rigtri.report import Report
from rigtri.text import counted

# Pixels: what is free around a picture, the room of its title, a cell of the outline.
_EDGE, _TITLE, _CELL = 28.0, 64.0, 2.0
# Where the legend begins, right of the axes of the world, and how high its rows are.
_GIZMO, _ROW = 84.0, 16.0
# Forms of the legend: a line, and the outline of a square.
_LINE = np.array([[-6.0, 0.0], [5.0, 0.0]])
_SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
# Many joints have small names.
_FONTS = ((40, 12.0), (120, 10.0), (1_000_000, 8.0))


@dataclass(frozen=True, eq=False)
class _Side:
    """One rig of a picture: what there is to see, and the words over it."""

    marks: list[Mark]
    patches: list[Patch]
    title: str
    words: tuple[str, ...]
    crooked: str


# What is no number is left out, whatever it came from.
@takes_keywords(DrawOptions)
@np.errstate(all="ignore")
def draw(
    rig: Rig,
    *,
    against: Rig | None = None,
    options: DrawOptions,
    title: str = "",
    title_against: str = "before",
    report: Report | None = None,
) -> str:
    """A rig as an SVG picture, the same bytes on every machine; on the left ``against``, which it was before.

    title, title_against: what stands over the two.
    Both are seen from where the view of ``rig`` is, at one scale. A rig without joints is drawn by
    its nodes, which is a warning of the report. Raises UsageError, NameNotFoundError (a joint, a clip),
    AmbiguousNameError.
    """
    check(options)
    report = report if report is not None else Report()
    sides = [_side(rig, options, title or ("after" if against is not None else ""), report)]
    if against is not None:
        sides.insert(0, _side(against, options, title_against, report))
    wide, high = options.size or ((1500 if against is not None else 1000), 900)
    view = view_of(rig, options.view)
    each = wide / len(sides)
    every = [mark for side in sides for mark in side.marks]
    below = _TITLE + _ROW * (len(_legend_rows(every, wide)) - 1)
    places = [(each * k, _TITLE, each, max(high - below, 1.0)) for k in range(len(sides))]
    # A bone that comes from a joint which is left out goes over the edge.
    around = [mark.points for mark in every if mark.kind not in ("bone", "link")]
    if not options.selection.named:
        around += [points[np.unique(faces)] for side in sides for points, faces in side.patches]
    windows = Window.around(around, view, places, min(_EDGE, 0.1 * min(each, high)))
    parts: list[str] = []
    for number_of, (side, window) in enumerate(zip(sides, windows, strict=True)):
        parts += _panel(side, window, options, number_of)
    parts += legend(every, wide, high)
    description = " | ".join(f"{side.title}: {', '.join([*side.words, side.crooked])}" for side in sides)
    return sheet([*parts, *gizmo(view, high)], wide, high, description)


@takes_keywords(DrawOptions)
@np.errstate(all="ignore")
def seen(rig: Rig, *, options: DrawOptions) -> list[Mark]:
    """What `draw` would draw of one rig, as lines and arrows in space, for those who draw otherwise."""
    check(options)
    return _side(rig, options, "", Report()).marks


def _side(rig: Rig, options: DrawOptions, title: str, report: Report) -> _Side:
    posed = pose_of(rig, PoseOptions(at=options.at), report)
    scene = Scene.of(rig, posed, options.selection)
    timeline, time = timeline_and_time(rig, options.at)
    found = marks(scene, arrows=options.axes)
    covered: list[Patch] = []
    try:
        covered = patches(scene, timeline, time) if options.mesh else []
    except FileError as error:  # the skeleton can be seen all the same
        report.warn("no-outline", f"The meshes are not drawn: {error}")
    jointed = bool(rig.is_joint.any())
    count = len(scene.joints)
    noun = "joint" if jointed else "node"
    words = [counted(count, noun)]
    if not count and len(scene.tree.joints):
        report.warn("nothing-selected", f"{title or 'The file'}: the selection leaves no {noun} to be drawn")
    if not jointed:
        what = f"its {'node is' if count == 1 else 'nodes are'} drawn" if count else "nor any node"
        report.warn("no-joints", f"{title or 'The file'} has no joints; {what}")
        words.append("no joints in this file")
    view = options.view.lower()
    words.append(f"{view} view" if view in VIEWS else f"from {view}")
    words.append("at rest" if options.at.lower() == "rest" else options.at)
    return _Side(found, covered, title, tuple(words), crooked(scene))


def crooked(scene: Scene) -> str:
    """How many joints have no axis along their bone; "" where nothing is known."""
    missed = [miss.degrees for joint in scene.joints if (miss := scene.bones.aimed(joint)) is not None]
    off = [degrees for degrees in missed if degrees > AIMED]
    if not missed:
        return ""
    if off:
        count = f"{len(off)} of {len(missed)} bones"
        return f"{count} are not along an axis of their joint, by up to {max(off):.1f}°"
    return f"all {len(missed)} bones are along an axis of their joint"


def _panel(side: _Side, window: Window, options: DrawOptions, place: int) -> Iterator[str]:
    """The elements of one side: outline, marks and names, clipped to its window, and the words over them."""
    loops = _outlines(side.patches, window)
    count = sum(mark.form == "dot" and bool(mark.name) for mark in side.marks)
    font = next(size for most, size in _FONTS if count <= most) if options.names else 0.0
    elements, unnamed = panel(side.marks, window, loops, font=font)
    clip = f"room{place}"
    box = f'x="{number(window.left)}" y="{number(window.top)}" width="{number(window.wide)}"'
    yield f'<clipPath id="{clip}"><rect {box} height="{number(window.high)}"/></clipPath>'
    yield f'<g clip-path="url(#{clip})">'
    yield from elements
    yield "</g>"
    words = [*side.words, *([f"{unnamed} names hidden"] if unnamed else [])]
    lines = [("title", side.title)] if side.title else []
    lines.append(("words", " · ".join(words)))
    if side.crooked:
        bad = any(mark.crooked for mark in side.marks)
        lines.append(("words crooked" if bad else "words", side.crooked))
    yield from heading(lines, window.left, window.wide)


def _outlines(found: Sequence[Patch], window: Window) -> list[Floats]:
    """The outline of meshes as loops in pixels of the sheet."""
    if not found:
        return []
    corner = np.array([window.left, window.top])

    def flat(points: Floats) -> Floats:
        cells: Floats = (window.on_sheet(points) - corner) / _CELL
        return cells

    loops = outline(found, flat, int(window.wide / _CELL) + 1, int(window.high / _CELL) + 1)
    return [loop * _CELL + corner for loop in loops]


# Which marks need which line of the legend; a joint that is crooked needs its own.
_MEANING = {
    "x": "x",
    "y": "y",
    "z": "z",
    "limb": "limb",
    "pole": "pole",
    "locator": "pole",
    "follows": "rule",
    "control": "control",
}


def _legend_rows(marks: Sequence[Mark], wide: int) -> list[list[tuple[str, float]]]:
    """What the colours of a picture mean, in rows as wide as it is: names of `LEGEND`, where they begin."""
    there = {_MEANING.get(mark.kind, "") for mark in marks} | {"crooked" for mark in marks if mark.crooked}
    rows: list[list[tuple[str, float]]] = [[]]
    x = _GIZMO
    for name, words in LEGEND.items():
        if name not in there:
            continue
        if rows[-1] and x + 8.0 + width(words, 11.0) > wide:
            rows.append([])
            x = _GIZMO
        rows[-1].append((name, x))
        x += 8.0 + width(words, 11.0) + 14.0
    return rows


def legend(marks: Sequence[Mark], wide: int, high: int) -> Iterator[str]:
    """The elements of a legend at the lower edge of a sheet; each mark has its form there, too."""
    rows = _legend_rows(marks, wide)
    colors = list(dict.fromkeys(mark.color for mark in marks if mark.kind == "control"))[:3]
    for number_of, row in enumerate(rows, start=1):
        y = high - 16.0 - _ROW * (len(rows) - number_of)
        for name, x in row:
            yield from _swatch(name, np.array([x, y - 4]), colors)
            yield f'<text class="key" x="{number(x + 8)}" y="{number(y)}">{LEGEND[name]}</text>'


def _swatch(name: str, place: Floats, colors: Sequence[tuple[float, ...] | None]) -> Iterator[str]:
    """How marks look, small: axes and bends are arrows, limbs triangles, controls outlines in ``colors``."""
    if name in ("x", "y", "z", "pole"):
        yield arrow(place + _LINE[0], place + _LINE[1], name, 11.0, True)
    elif name == "control":
        for k, color in enumerate(colors):
            yield path([place + _SQUARE * (5.0 - 2.0 * k)], "control", more=stroke(color))
    elif name == "limb":
        yield path([place + np.array([[-6.0, 4.0], [1.0, -5.0], [5.0, 4.0]])], "swatch limb")
    elif name == "rule":
        yield path([place + _LINE], "follows", closed=False)
    else:
        yield f'<circle class="swatch {name}" cx="{number(place[0])}" cy="{number(place[1])}" r="4"/>'


def gizmo(view: View, high: int) -> Iterator[str]:
    """The axes of the world at the lower left corner of a sheet, with their letters."""
    axes, size = np.eye(3), 20.0
    flat, depth = view.flat(axes), view.depth(axes)
    start = np.array([40.0, high - 40.0])
    yield "<g><title>axes of the world</title>"
    for k in sorted(range(3), key=lambda k: float(depth[k])):
        end = start + flat[k] * [size, -size]
        letter = "xyz"[k]
        yield arrow(start, end, letter, size, bool(depth[k] > 0))
        off = start + flat[k] * [size + 9, -(size + 9)] + [0.0, 3.5]
        off = off + ([-9.0, 9.0] if np.abs(flat[k]).max() < 0.35 else [0.0, 0.0])
        yield f'<text class="letter {letter}" x="{number(off[0])}" y="{number(off[1])}">{letter}</text>'
    yield "</g>"
