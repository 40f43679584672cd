"""Meshes: points that skins or nodes move, and how they are drawn between their points."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigtri.maths.arrays import Integers, runs
from rigtri.maths.trigonometry import Floats
from rigtri.model.dataclass import dataclass
from rigtri.model.skin import Skin
from rigtri.text import is_number

# Points at once: what is sorted and gathered of them stays in the cache.
_BLOCK = 1 << 13


class Surface(NamedTuple):
    """How a mesh is drawn between its points; read only to compare.

    kind: what is drawn, e.g. ``triangles``. sizes: corners of each face, (f,), empty
    where ``kind`` says it. corners: point indices. normals: (m, 3), (0, 3) where there are none.
    values: by name what else points, corners or faces have: colours, texture coordinates, tangents.
    """

    kind: str
    sizes: Integers
    corners: Integers
    normals: Floats
    values: Mapping[str, NDArray[Any]] = {}


@dataclass(frozen=True, eq=False)
class Mesh:
    """Points that skins or nodes move; read only to measure, never written.

    points: (v, 3). joints, weights: (v, k), indices into the skin's joints; empty
    (v, 0) for a rigid mesh, whose points are in the space of ``node``. bind: the
    matrix that takes points into the space of the skin's bind pose. morphs:
    (t, v, 3) offsets, weighted by ``morph_weights`` (t,) or a weights track of ``node``;
    morph_names: what they are called, empty where nothing says it.
    raw_weights: they count as they are, whatever they sum to (UsdSkel); else they are scaled to sum to 1.
    ``surface`` reads faces and normals, None where they cannot be read; read only when needed.
    box: where ``points`` are only some of many, the lows and highs of all of them wherever
    morphs carry them: (2, 3), and any joint may move any of them, or of those that each joint
    of the skin moves, (2, m, 3).
    """

    name: str
    node: int
    points: Floats
    skin: int | None = None
    joints: Integers = field(default_factory=lambda: np.zeros((0, 0), dtype=np.int64))
    weights: Floats = field(default_factory=lambda: np.zeros((0, 0)))
    bind: Floats = field(default_factory=lambda: np.eye(4))
    morphs: Floats = field(default_factory=lambda: np.zeros((0, 0, 3)))
    morph_weights: Floats = field(default_factory=lambda: np.zeros(0))
    morph_names: tuple[str, ...] = ()
    dual_quaternion: bool = False
    raw_weights: bool = False
    surface: Callable[[], Surface | None] | None = None
    box: Floats | None = None

    def __repr__(self) -> str:
        return f"<Mesh {self.name!r}: {len(self.points)} vertices>"

    def morph_column(self, name: str) -> int | None:
        """The number of a morph target, by its name or by that number in digits; None where there is none."""
        if name in self.morph_names:
            return self.morph_names.index(name)
        return int(name) if is_number(name) and int(name) < len(self.morphs) else None

    @cached_property
    def moved(self) -> tuple[Integers, Integers]:
        """Joint and point of each weight that is not 0, (w,) each, joint by joint."""
        return _moved(self.joints, self.weights)

    def morphed(self) -> tuple[Floats, Floats]:
        """How far morphs can carry each point, (v, 3) twice: every target from 0 to 1, all at once."""
        if not self.morphs.size:
            return self.points, self.points
        given = self.morph_weights if len(self.morph_weights) else np.zeros(len(self.morphs))
        lows, highs = np.minimum(given, 0.0), np.maximum(given, 1.0)
        near, far = self.points.copy(), self.points.copy()
        for low, high, offsets in zip(lows, highs, self.morphs, strict=True):
            near += np.minimum(low * offsets, high * offsets)
            far += np.maximum(low * offsets, high * offsets)
        return near, far

    @cached_property
    def joint_boxes(self) -> tuple[Floats, Floats]:
        """Lows and highs of the points that each joint moves, wherever morphs carry them, (m, 3) twice.

        The last joint is the last that the mesh names; inf where one moves nothing.
        """
        count = int(self.joints.max(initial=-1)) + 1
        low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
        near, far = self.morphed()
        for first in range(0, len(near), _BLOCK):
            some = slice(first, first + _BLOCK)
            joints, points = _moved(self.joints[some], self.weights[some])
            live = np.asarray(np.isfinite(near[some]).all(axis=1))
            if not live.all():
                joints, points = joints[live[points]], points[live[points]]
            if not len(joints):
                continue
            starts = runs(joints)
            own = joints[starts]
            for axis in range(3):
                lows = near[some, axis][points]
                highs = lows if far is near else far[some, axis][points]
                low[own, axis] = np.minimum(low[own, axis], np.minimum.reduceat(lows, starts))
                high[own, axis] = np.maximum(high[own, axis], np.maximum.reduceat(highs, starts))
        return low, high

    @property
    def moved_as(self) -> Hashable:
        """What is the same of meshes that are in one place in all poses, as long as both are there.

        Instances that a skin moves, wherever their nodes are: a reader gives them the same arrays. Morph
        weights are of each node.
        """
        if self.skin is None or not self.joints.shape[1] or len(self.morphs):
            return id(self)
        arrays = self.points, self.joints, self.weights, self.bind, self.box
        return (self.skin, self.dual_quaternion, self.raw_weights, *map(id, arrays))

    def fits(self, skins: Sequence[Skin]) -> bool:
        """Whether all joints that it names are joints of its skin."""
        if self.skin is None:
            return True
        count = len(skins[self.skin].joints)
        fit = (self.joints >= 0) & (self.joints < count)
        return bool(fit.all() or not self.weights[~fit].any())

    @cached_property
    def surface_now(self) -> Surface | None:
        """Faces and normals; None when nobody can tell."""
        return None if self.surface is None else self.surface()


def each_place(meshes: Iterable[Mesh]) -> list[Mesh]:
    """The meshes without those that are wherever an earlier one of them is."""
    found: dict[Hashable, Mesh] = {}
    for mesh in meshes:
        found.setdefault(mesh.moved_as, mesh)
    return list(found.values())


def _moved(joints: Integers, weights: Floats) -> tuple[Integers, Integers]:
    """Joint and point of each weight that is not 0, (w,) each, joint by joint."""
    held = np.flatnonzero(weights != 0)
    named = joints.ravel()[held]
    # Of joints that fit into 16 bits a sort counts, which is far faster.
    least = np.min_scalar_type(int(named.max(initial=0)))
    order = np.argsort(named.astype(least) if named.min(initial=0) >= 0 else named, kind="stable")
    return named[order], held[order] // max(weights.shape[1], 1)
