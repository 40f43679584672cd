"""Skin at rest that planes cut, and rings around the cuts: how far these reach, and what they hide."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from rigtri.errors import FileError
from rigtri.evaluation.sampling import morph_weights
from rigtri.evaluation.skinning import deformed
from rigtri.maths.arrays import Integers
from rigtri.maths.ranking import axis_across
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, normalise, perpendicular
from rigtri.model.mesh import Mesh
from rigtri.model.mesh_triangles import triangles
from rigtri.model.rig import Rig

# The radius of a shape as a share of how far the skin reaches around the joint.
MARGIN = 1.2
# A vertex is skin of the joint that has the largest weight there, or as large a one but for rounding.
_LARGEST = 0.999
# By this factor at a time a ring gets wider until a quarter at most is inside.
_STEP = 1.1
# So many triangles, one after another, share a box: where a plane passes that, it cuts none of them.
_BLOCK = 64
# A box grows by this share of the largest coordinate: rounding moves no point so far.
_ROUNDING = 1e-12
# Directions in a plane.
AROUND = (
    np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)])
    * np.where(np.arange(8) % 2, np.sqrt(0.5), 1.0)[:, np.newaxis]
)


class SkinnedMesh:
    """A mesh at rest, skinned when it is needed."""

    def __init__(self, rig: Rig, mesh: Mesh) -> None:
        self.rig, self.mesh = rig, mesh

    @cached_property
    def points(self) -> Floats:
        """Its points in the world, (v, 3)."""
        weights = morph_weights(self.mesh, None, np.zeros(1))
        return np.asarray(deformed(self.mesh, self.rig, self.rig.normalised_world[np.newaxis], weights)[0])

    @cached_property
    def usable(self) -> bool:
        return bool(np.isfinite(self.points).all())

    def vertices_of(self, rows: list[int]) -> Integers:
        """The vertices, (v,), that rows of the skin's joints move most."""
        return np.unique(self._own.of(np.array(rows)))

    def cut(self, corners: Integers, place: Floats, normal: Floats) -> Floats:
        """The lines, (m, 2, 3), in which triangles, (t, 3), cut a plane, seen from ``place``."""
        return self.signed_cut(corners, place, normal)[0]

    def cut_of(self, vertices: Integers, place: Floats, normal: Floats) -> Floats:
        """As `cut`, of the triangles at vertices, (v,).

        One that has a single corner there is skin of another joint, and may reach across the trunk: it
        counts where no other is cut.
        """
        numbers, corners = np.unique(self._at.of(vertices), return_counts=True)
        lines = self.cut(self.triangles[numbers[corners > 1]], place, normal)
        return lines if len(lines) else self.cut(self.triangles[numbers], place, normal)

    def signed_cut(self, corners: Integers, place: Floats, normal: Floats) -> tuple[Floats, Floats]:
        """As `cut`, and the sign, (m,), with which each line goes round what the surface encloses."""
        above = dot(self.points[corners], normal) > dot(place, normal)
        corners = corners[above.any(axis=1) & ~above.all(axis=1)]
        flat, height = seen_from(self.points[corners], place, normal)
        # Rounded in this way, what begins in the plane may be on one side of it after all.
        parted = (height > 0).any(axis=1) & (height <= 0).any(axis=1)
        flat, height = flat[parted], height[parted]
        above = height > 0
        # The corner that is alone on its side comes first.
        a, b, c = above.T
        alone = np.where(b == c, 0, np.where(a == c, 1, 2))
        order = (alone[:, np.newaxis] + np.arange(3)) % 3
        each = np.arange(len(order))[:, np.newaxis]
        flat, height = flat[each, order], height[each, order]
        apart = height[:, :1] - height[:, 1:]
        share = height[:, :1] / apart
        lines = flat[:, :1] + share[..., np.newaxis] * (flat[:, 1:] - flat[:, :1])
        return np.asarray(lines), np.where(height[:, 0] > 0, 1.0, -1.0)

    def triangles_near(self, place: Floats, normal: Floats) -> Integers:
        """The triangles, (t, 3), in their order, without most of those that a plane does not cut."""
        middles, halves, farthest = self._boxes
        slack = _ROUNDING * max(farthest, float(np.abs(place).max()))
        reached = np.abs(dot(middles - place, normal)) <= dot(halves, np.abs(normal)) + slack
        rows = np.flatnonzero(reached)[:, np.newaxis] * _BLOCK + np.arange(_BLOCK)
        return np.asarray(self.triangles[rows[rows < len(self.triangles)]])

    @cached_property
    def _boxes(self) -> tuple[Floats, Floats, float]:
        """Of the boxes of blocks of triangles middles and half sizes, (b, 3), and the largest coordinate."""
        corners, starts = self.points[self.triangles], np.arange(0, len(self.triangles), _BLOCK)
        low = np.minimum.reduceat(corners.min(axis=1), starts)
        high = np.maximum.reduceat(corners.max(axis=1), starts)
        return (low + high) / 2, (high - low) / 2, float(np.abs(corners).max(initial=0.0))

    @cached_property
    def _own(self) -> _Groups:
        weights = self.mesh.weights
        vertices, columns = np.nonzero(weights >= _LARGEST * weights.max(axis=1, keepdims=True))
        return _Groups(self.mesh.joints[vertices, columns], vertices)

    @cached_property
    def triangles(self) -> Integers:
        """(t, 3); none where its faces cannot be read."""
        try:
            return triangles(self.mesh)
        except FileError:
            return np.zeros((0, 3), dtype=np.int64)

    @cached_property
    def _at(self) -> _Groups:
        numbers = np.arange(len(self.triangles))
        return _Groups(self.triangles.T.ravel(), np.concatenate([numbers] * 3))


class _Groups:
    """Numbers by a key each, (n,), so that those of a few keys are found without a look at all of them."""

    def __init__(self, keys: Integers, values: Integers) -> None:
        order = np.argsort(keys, kind="stable")
        self._keys, self._values = keys[order], values[order]

    def of(self, keys: Integers) -> Integers:
        """The numbers of keys, (k,), one after another, (m,)."""
        first = np.searchsorted(self._keys, keys, side="left")
        count = np.searchsorted(self._keys, keys, side="right") - first
        before = np.cumsum(count) - count
        ahead = np.repeat(first - before, count)
        return np.asarray(self._values[np.arange(len(ahead)) + ahead])


def seen_from(points: Floats, place: Floats, normal: Floats) -> tuple[Floats, Floats]:
    """Points, (..., 3), from a place: in the plane square to a normal, and how far beside it, (...)."""
    away = points - place
    height = dot(away, normal)
    return away - height[..., np.newaxis] * normal, height


def farthest(cuts: list[Floats], normal: Floats) -> Floats:
    """How far lines, (m, 2, 3) each, lie away at most in each direction around a normal, (8,), ascending."""
    ends = np.array([np.zeros(len(AROUND)), *(ends_of(lines, normal) for lines in cuts)]).max(axis=0)
    return np.asarray(np.sort(ends))


def half(ends: Floats) -> float:
    """How far a ring must reach for half of it to be beyond all that ends, (8,), as `farthest` has them."""
    return float(ends[len(ends) // 2])


def outside(radius: float, most: float, cuts: list[tuple[Floats, Floats]], normal: Floats) -> float:
    """The smallest radius at which up to a quarter of a ring is inside lines; ``most`` where at none."""
    crossings_of = crossed(cuts, normal)
    while radius < most:
        if 4 * inside(radius, *crossings_of) <= len(AROUND):
            return radius
        radius *= _STEP
    return most


def crossed(cuts: list[tuple[Floats, Floats]], normal: Floats) -> tuple[Floats, Floats]:
    """Where directions cross the lines of cuts, as `crossings`, and whether into what a surface encloses."""
    found = [crossings(lines, normal) for lines, _ in cuts]
    at = np.concatenate([along for along, _ in found], axis=1)
    turns = np.concatenate([turns * sign for (_, turns), (_, sign) in zip(found, cuts, strict=True)], axis=1)
    return at, turns


def inside(radius: float, at: Floats, turns: Floats) -> int:
    """In how many of the directions `AROUND` a ring of a radius, drawn with its margin, is inside."""
    beyond = at > MARGIN * radius
    into, out = (np.count_nonzero(beyond & (turns == way), axis=1) for way in (1.0, -1.0))
    return int(np.count_nonzero(into != out))


def ends_of(lines: Floats, normal: Floats) -> Floats:
    """How far lines, (m, 2, 3), lie away at most in each of the directions `AROUND` a normal, (8,)."""
    return np.asarray(crossings(lines, normal)[0].max(axis=1, initial=0.0))


def crossings(lines: Floats, normal: Floats) -> tuple[Floats, Floats]:
    """How far away each direction `AROUND` a normal crosses lines, (8, m), and to which side, 1 or −1.

    Both are 0 where one does not cross a line.
    """
    u = normalise(perpendicular(axis_across(normal), normal))
    v = cross(normal, u)
    ahead = AROUND[:, :1] * u + AROUND[:, 1:] * v
    aside = cross(normal, ahead)
    along, across = (dot(lines[np.newaxis], k[:, np.newaxis, np.newaxis]) for k in (ahead, aside))
    (a, b), (c, d) = (np.moveaxis(k, 2, 0) for k in (along, across))
    crosses = (c <= 0) != (d <= 0)
    share = c / np.where(crosses, c - d, 1.0)
    at = np.where(crosses, a + share * (b - a), 0.0)
    return at, np.where(crosses, np.where(c <= 0, 1.0, -1.0), 0.0)
