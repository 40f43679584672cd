"""Where a character is looked at from, what of the world lies right, up and near then, and at which scale.

A view is orthographic: distances keep their scale, so two pictures can be laid side by side.
Everything is + − × ÷ √, so the same rig gives the same numbers on every machine.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from rigtri.errors import UsageError
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length, normalise, perpendicular
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.operations.option_kinds import three
from rigtri.operations.options.draw import VIEWS
from rigtri.recognition.limbs import forward, upright

# Directions less than this sine apart are one: nothing shows then which way is up.
_PARALLEL = 1e-6
# An arrow is seen head on where this share of it, or less, is; a letter is one of ten, and so sooner.
HEAD_ON, _HEAD_ON_LETTER = 0.35, 0.6
_ARROWS = "→↗↑↖←↙↓↘"
# tan 22.5°: half of the eighth of a turn that an arrow stands for.
_HALF_EIGHTH = 0.41421356237309503


@dataclass(frozen=True, eq=False)
class View:
    """Unit directions of the world, (3,) each: right and up in the picture, and towards the viewer."""

    right: Floats
    up: Floats
    eye: Floats

    @staticmethod
    def along(eye: ArrayLike, up: ArrayLike, spare: ArrayLike) -> View:
        """Seen from where ``eye`` points, ``up`` upright, or ``spare`` where that points at the viewer."""
        towards = normalise(eye)
        upright = perpendicular(normalise(up), towards)
        if not length(upright) > _PARALLEL:
            upright = perpendicular(normalise(spare), towards)
        upright = normalise(upright)
        return View(normalise(cross(upright, towards)), upright, towards)

    def flat(self, points: ArrayLike) -> Floats:
        """Points or directions, (..., 3), as seen: right and up, (..., 2), in file units."""
        return np.stack([dot(points, self.right), dot(points, self.up)], axis=-1)

    def depth(self, points: ArrayLike) -> Floats:
        """How near points, (..., 3), are to the viewer, (...); the larger the nearer."""
        return dot(points, self.eye)

    def arrow(self, direction: ArrayLike) -> str:
        """The character that shows a direction, (3,): one of eight arrows, ⊙ towards the viewer, ⊗ away.

        >>> front = View.along([0, 0, 1], [0, 1, 0], [0, 0, -1])
        >>> front.arrow([1, 0, 0]), front.arrow([1, -1, 0]), front.arrow([0, 0, 1])
        ('→', '↘', '⊙')
        """
        return self.arrows(np.asarray(direction)[np.newaxis])[0]

    def arrows(self, directions: Floats) -> list[str]:
        """`arrow` of each of many, (n, 3)."""
        unit = normalise(directions)
        fine = np.isfinite(unit).all(axis=1)
        columns = (fine, self.flat(unit), self.depth(unit) > 0)
        seen = zip(*(column.tolist() for column in columns), strict=True)
        return [_arrow(x, y, towards=towards) if is_fine else "·" for is_fine, (x, y), towards in seen]


def _arrow(x: float, y: float, *, towards: bool) -> str:
    if x * x + y * y < _HEAD_ON_LETTER * _HEAD_ON_LETTER:
        return "⊙" if towards else "⊗"
    if abs(y) <= _HALF_EIGHTH * abs(x):
        return _ARROWS[0 if x > 0 else 4]
    if abs(x) <= _HALF_EIGHTH * abs(y):
        return _ARROWS[2 if y > 0 else 6]
    return _ARROWS[(1 if x > 0 else 3) if y > 0 else (7 if x > 0 else 5)]


@dataclass(frozen=True, eq=False)
class Window:
    """A rectangle of a sheet, in its pixels. middle: what of the view, (2,), stands in its middle.

    scale: pixels for a file unit.
    """

    view: View
    left: float
    top: float
    wide: float
    high: float
    middle: Floats
    scale: float

    @staticmethod
    def around(
        points: Sequence[Floats], view: View, places: Sequence[tuple[float, float, float, float]], edge: float
    ) -> list[Window]:
        """A window for each place, (left, top, wide, high), that shows all points, (k, 3), at one scale.

        edge: how many pixels stay free all around.
        """
        flat = view.flat(np.concatenate([*points, np.zeros((0, 3))]))
        flat = flat[np.isfinite(flat).all(axis=1)]
        low, high = (flat.min(axis=0), flat.max(axis=0)) if len(flat) else (np.zeros(2), np.zeros(2))
        size, (_, _, w, h) = high - low, places[0]
        fits = [(room - 2 * edge) / s for room, s in zip((w, h), size.tolist(), strict=True) if s > 0]
        scale = min(fits, default=1.0)
        return [Window(view, *place, 0.5 * (low + high), scale) for place in places]

    def on_sheet(self, points: Floats) -> Floats:
        """Points of the world, (..., 3), on the sheet, (..., 2): right and down."""
        off = (self.view.flat(points) - self.middle) * self.scale
        return np.stack(
            [self.left + 0.5 * self.wide + off[..., 0], self.top + 0.5 * self.high - off[..., 1]], axis=-1
        )


def view_of(rig: Rig, name: str = "front") -> View:
    """A character from one of `VIEWS`, or from the direction ``x,y,z`` of the file's world.

    Up is that of the body, as a rule the format's. The front is where its limbs face, else where its format
    prescribes; the side is its left one. UsageError for anything else.
    """
    up, ahead = upright(rig), forward(rig)
    left = cross(up, ahead)
    eyes = {
        "front": ahead,
        "back": -ahead,
        "side": left,
        "top": up,
        "three-quarter": ahead + 0.7 * left + 0.35 * up,
    }
    eye = eyes[name.lower()] if name.lower() in eyes else direction(name, ", ".join(VIEWS) + ", or ")
    return View.along(eye, up, -ahead)


def direction(text: str, or_else: str = "") -> Floats:
    """The direction, (3,), that ``x,y,z`` means. UsageError where it means none; or_else: what might, too."""
    try:
        eye = normalise(three(text))
    except ValueError:
        raise UsageError(f"'{text}' is not a valid view: use {or_else}a direction x,y,z") from None
    if not np.isfinite(eye).all():
        raise UsageError(f"'{text}' points nowhere: a view is seen from a direction x,y,z")
    return eye
