"""Control shapes: lines that an animator sees and grabs.

A shape is unit-sized, lies about its origin and shows its plane's normal along x;
`drawn` gives it a size and another normal.

Source: R. Katz, "Rigging with Triangles", GDC 2018, "Build finger" (one shape per control).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import product
from typing import Any, Literal

import numpy as np

from rigtri.maths.trigonometry import Floats, sin_cos
from rigtri.maths.vectors import cross
from rigtri.model.dataclass import dataclass

Kind = Literal[
    "circle", "square", "diamond", "cube", "sphere", "pyramid", "arrow", "cross", "locator", "axes"
]
# Left blue, right red, centre yellow: what Maya's and Blender's riggers expect.
COLORS = {"left": (0.05, 0.2, 1.0), "right": (1.0, 0.05, 0.05), "": (1.0, 0.8, 0.0)}
_SEGMENTS = 24
# Lines of ours as a file gives them back: a share of their size, and of a colour.
_SAME_POINT, _SAME_COLOR = 1e-5, 1e-6


@dataclass(frozen=True, eq=False)
class Shape:
    """Lines at a node: strips of points (k, 3) in its space, each closed or open; colour linear RGB."""

    kind: str
    strips: tuple[Floats, ...]
    closed: bool
    color: tuple[float, float, float]

    @property
    def segments(self) -> Floats:
        """The ends of every line, (s, 2, 3)."""
        ends = [np.roll(strip, -1, axis=0) if self.closed else strip[1:] for strip in self.strips]
        starts = [strip if self.closed else strip[:-1] for strip in self.strips]
        return np.stack([np.concatenate(starts), np.concatenate(ends)], axis=1)


@dataclass(frozen=True, eq=False)
class Lines:
    """What a file draws at a node: the ends of every line, (s, 2, 3), in its space; colour linear RGB."""

    segments: Floats
    color: tuple[float, ...]

    def are(self, kind: str, size: float, color: Sequence[float], shift: float = 0.0) -> bool:
        """Whether `drawn` draws these lines, however they are turned; up to the rounding of float32."""
        if kind not in _STRIPS or len(color) != len(self.color):
            return False
        off = max(abs(a - b) for a, b in zip(self.color, color, strict=True))
        return off <= _SAME_COLOR and any(
            self._match(shape, size + abs(shift)) for shape in _placed(kind, size, shift)
        )

    def _match(self, shape: Shape, size: float) -> bool:
        other = shape.segments
        same = other.shape == self.segments.shape
        return same and bool(np.abs(other - self.segments).max() <= _SAME_POINT * size)


def nothing(key: object) -> Lines | None:
    """What is drawn at the nodes of a rig that no file was read for."""
    return None


def _placed(kind: Any, size: float, shift: float) -> Iterator[Shape]:
    """A shape in every way that `drawn` can turn it."""
    ways = [sign * axis for axis in np.eye(3) for sign in (1.0, -1.0)]
    for normal in ways:
        for ahead in (None, *ways):
            if ahead is None or not (normal * ahead).any():
                yield drawn(kind, size=size, normal=normal, color=COLORS[""], ahead=ahead, shift=shift)


def drawn(
    kind: Kind,
    *,
    size: float,
    normal: Floats,
    color: tuple[float, float, float],
    ahead: Floats | None = None,
    shift: float = 0.0,
) -> Shape:
    """A shape of a radius ``size`` in file units of its node, its plane's normal along ``normal`` (3,).

    normal is one of the six axes, and so is ahead, (3,), across it: where the tip of an arrow
    points. shift: how far along its normal it stands from its origin, in file units of its node. Raises
    ValueError for a kind that is none.
    """
    if kind not in _STRIPS:
        raise ValueError(f"there is no shape {kind!r}")
    strips, closed = _STRIPS[kind]()
    beside = shift * np.asarray(normal)
    if ahead is not None:
        aside = cross(ahead, normal)
        placed = (strip[:, :1] * normal + strip[:, 1:2] * aside + strip[:, 2:] * ahead for strip in strips)
        return Shape(kind, tuple(strip * size + beside for strip in placed), closed, color)
    axis = int(np.argmax(np.abs(normal)))
    # Cyclic permutations are rotations: x goes to the axis, and the shape keeps its handedness.
    turned = (np.roll(strip, axis, axis=1) for strip in strips)
    sign = -1.0 if normal[axis] < 0 else 1.0
    flip = np.ones(3)
    flip[[axis, (axis + 1) % 3]] = sign
    return Shape(kind, tuple(strip * flip * size + beside for strip in turned), closed, color)


def _circle() -> tuple[list[Floats], bool]:
    return [_ring(1, 2)], True


def _ring(first: int, second: int) -> Floats:
    turn = np.arange(_SEGMENTS) * (2 * np.pi / _SEGMENTS)
    points = np.zeros((_SEGMENTS, 3))
    points[:, second], points[:, first] = sin_cos(turn)
    return points


def _sphere() -> tuple[list[Floats], bool]:
    return [_ring(1, 2), _ring(2, 0), _ring(0, 1)], True


def _square() -> tuple[list[Floats], bool]:
    return [np.array([[0.0, -1, -1], [0, 1, -1], [0, 1, 1], [0, -1, 1]])], True


def _diamond() -> tuple[list[Floats], bool]:
    """An octahedron: a flat one would be a mere stroke from the side."""
    flat = np.array([[0.0, -1, 0], [0, 0, -1], [0, 1, 0], [0, 0, 1]])
    return [np.roll(flat, axis, axis=1) for axis in range(3)], True


def _cube() -> tuple[list[Floats], bool]:
    corners = np.array(list(product((-1.0, 1.0), repeat=3)))
    edges = [
        np.stack([a, b])
        for k, a in enumerate(corners)
        for b in corners[k + 1 :]
        if np.count_nonzero(a != b) == 1
    ]
    return edges, False


def _pyramid() -> tuple[list[Floats], bool]:
    base = _square()[0][0]
    tip = np.array([1.0, 0, 0])
    return [np.concatenate([base, base[:1]]), *(np.stack([corner, tip]) for corner in base)], False


def _arrow() -> tuple[list[Floats], bool]:
    outline = [[0.0, 0, 1], [0, 0.5, 0.4], [0, 0.2, 0.4], [0, 0.2, -1]]
    other = [[0.0, -y, z] for _, y, z in reversed(outline[1:])]
    return [np.array(outline + other)], True


def _cross() -> tuple[list[Floats], bool]:
    arm = [[0.0, 0.3, 0.3], [0, 1, 0.3], [0, 1, -0.3]]
    points = np.array(arm)
    quarters = [points]
    for _ in range(3):
        points = np.stack([points[:, 0], points[:, 2], -points[:, 1]], axis=1)
        quarters.append(points)
    return [np.concatenate(quarters)], True


def _locator() -> tuple[list[Floats], bool]:
    return [np.stack([-axis, axis]) for axis in np.eye(3)], False


def _axes() -> tuple[list[Floats], bool]:
    return [np.stack([np.zeros(3), axis]) for axis in np.eye(3)], False


_STRIPS: dict[str, Callable[[], tuple[list[Floats], bool]]] = {
    "circle": _circle,
    "square": _square,
    "diamond": _diamond,
    "cube": _cube,
    "sphere": _sphere,
    "pyramid": _pyramid,
    "arrow": _arrow,
    "cross": _cross,
    "locator": _locator,
    "axes": _axes,
}
KINDS = tuple(_STRIPS)
