"""An explanation as a picture: the triangle, its vectors, the aimed axes, the projection and the pole."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rigtri.export.drawing.picture import gizmo, legend
from rigtri.export.drawing.primitives import Kind, Mark
from rigtri.export.drawing.scene import pole_arrow, triangle
from rigtri.export.drawing.svg import heading, panel, printable, sheet
from rigtri.export.drawing.view import View, Window, direction
from rigtri.export.explain.explain import Explanation
from rigtri.maths.triangle import frame, hinge, pole_position
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length, normalise, project

_WIDE, _HIGH = 900, 700
# Axes and dots as shares of the longest side.
_AXES, _DOT = 0.2, 0.012
# Letters of a name, which has more room beside three points than among many joints.
_LONGEST = 72
# A triangle lies flat whose normal is nearer to upright than this cosine.
_FLAT = 0.8


# What is no number is left out.
@np.errstate(all="ignore")
def picture(found: Explanation, *, view: str | None = None) -> str:
    """The three points as an SVG picture. view: x,y,z, where it is seen from; else across its plane."""
    marks = [mark for mark in _marks(found) if mark.clear]
    seen = _across(found) if view is None else View.along(direction(view), [0.0, 1.0, 0.0], [0.0, 0.0, -1.0])
    points = [mark.points for mark in marks] or [found.points]
    (window,) = Window.around(points, seen, [(0.0, 64.0, float(_WIDE), _HIGH - 64.0)], 70.0)
    parts, _ = panel(marks, window, [], font=15.0, longest=_LONGEST)
    a, b, c = (printable(name) for name in found.names)
    lines = [("title", f"{a} → {b} → {c}"), ("words", _words(found))]
    parts += heading(lines, 0.0, _WIDE)
    parts += [*legend(marks, _WIDE, _HIGH), *gizmo(seen, _HIGH)]
    return sheet(parts, _WIDE, _HIGH, f"{a}, {b}, {c}: {_words(found)}")


def _words(found: Explanation) -> str:
    return found.trouble or "red aim_X at B, green aim_Y towards C, blue aim_Z; P: B projected on AC"


def _marks(found: Explanation) -> Iterator[Mark]:
    """What there is of a triangle: less of it where the points make none."""
    a, b, c = found.points
    long = max(float(length(b - a)), float(length(c - b)), float(length(c - a))) or 1.0
    yield from triangle(a, b, c)
    yield from pole_arrow(a, b, c)
    for start, end in ((a, b), (b, c), (a, c)):
        yield Mark("arrow", "vector", np.stack([start, end]), size=float(length(end - start)))
    with np.errstate(all="ignore"):
        axes = frame(b - a, c - a) if np.isfinite(hinge(a, b, c)).all() else np.full((3, 3), np.nan)
    yield Mark("arrow", "x", np.stack([a, a + _AXES * long * axes[0]]), "A", size=_AXES * long)
    yield Mark("arrow", "y", np.stack([a, a + _AXES * long * axes[1]]), "A", size=_AXES * long)
    yield Mark("arrow", "z", np.stack([a, a + _AXES * long * axes[2]]), "A", size=_AXES * long)
    for letter, name, point in zip("ABC", found.names, found.points, strict=True):
        yield _dot(letter, letter if name == letter else f"{letter} {name}", point, long)
    yield _dot("P", "P", project(b, a, c) if np.isfinite(axes).all() else np.full(3, np.nan), long)
    yield _dot("pole", "pole vector", pole_position(a, b, c), long)


def _dot(node: str, name: str, point: Floats, long: float) -> Mark:
    description = f"{name} ({', '.join(f'{x + 0.0:.6g}' for x in point.tolist())})"
    kind: Kind = "locator" if node == "pole" else "joint"
    return Mark("dot", kind, point[np.newaxis], node, name, description, size=_DOT * long)


def _across(found: Explanation) -> View:
    """Nearly along the normal, so that the plane is seen as it is; upright unless the triangle lies flat."""
    a, b, c = found.points
    normal, up = hinge(a, b, c), np.array([0.0, 1.0, 0.0])
    if not np.isfinite(normal).all():
        return View.along([0.5, 0.4, 1.0], up, [0.0, 0.0, -1.0])
    normal = normal if float(dot(normal, [0.2, 0.5, 1.0])) >= 0 else -normal
    if abs(float(dot(normal, up))) > _FLAT:
        up = cross(normal, c - a)  # from A on the left to C on the right
    aside = normalise(cross(up, normal))
    return View.along(normal + 0.45 * aside + 0.3 * cross(normal, aside), up, [0.0, 0.0, -1.0])
