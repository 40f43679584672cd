"""Where on a sheet a picture lies, and what of the world it shows at which scale."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rigtri.export.drawing.view import View
from rigtri.maths.trigonometry import Floats


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

    def place(self, points: Floats) -> Floats:
        """Points of the world, (..., 3), on the sheet, (..., 2): right and down."""
        off = (self.view.flat(points) - self.middle) * self.scale
        return np.stack(
            [self.left + 0.5 * self.wide + off[..., 0], self.top + 0.5 * self.high - off[..., 1]], axis=-1
        )
