"""What a sample is made of: nodes, tubes of skin around chains of joints, and clips.

Everything is plain arithmetic on top of rigtri's own, so that the bytes are the
same on every machine. Figures face +z, +y is up, +x is their left.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from rigtri.maths.matrices import compose, inverse, multiply
from rigtri.maths.quaternions import IDENTITY, conjugate, from_axis_angle, rotate
from rigtri.maths.quaternions import multiply as then
from rigtri.maths.trigonometry import Floats, sin_cos
from rigtri.maths.vectors import cross, length, normalise, perpendicular

Vector = Sequence[float]
# The turn of a joint, seen in world axes, at a time in seconds: what an animator would say.
Motion = Callable[[float], Floats]
Mode = Literal["LINEAR", "STEP", "CUBICSPLINE"]


@dataclass
class Node:
    """A node at ``position`` with the axes ``axes``, both in the space of the figure.

    space: the node is no joint but a space that others stand in; its position,
    axes and scale are then seen from its parent.
    """

    name: str
    parent: int
    position: Floats
    axes: Floats
    scale: Vector = (1.0, 1.0, 1.0)
    space: bool = False
    joint: bool = True
    mesh: Skinless | None = None
    camera: bool = False


@dataclass
class Skinless:
    """A rigid mesh: a box from ``low`` to ``high``, in the space of its node."""

    low: Vector
    high: Vector


@dataclass
class Keys:
    """The keys of one property of one node; CUBICSPLINE values have tangents, (k, 3, c)."""

    node: int
    path: Literal["translation", "rotation", "scale"]
    times: tuple[float, ...]
    values: Floats
    mode: Mode


@dataclass
class Skin:
    """Points around joints, with up to two joints for each."""

    points: list[Floats] = field(default_factory=list)
    weights: list[dict[int, float]] = field(default_factory=list)
    triangles: list[tuple[int, int, int]] = field(default_factory=list)

    def tube(self, stations: Sequence[Station], *, side: Vector, corners: int = 6) -> None:
        """Close a tube around stations; ``side`` says where the wide radius points."""
        centres = np.stack([station.centre for station in stations])
        along = normalise(np.gradient(centres, axis=0))
        first = len(self.points)
        sine, cosine = sin_cos(np.arange(corners) * (2 * np.pi / corners))
        for station, forward in zip(stations, along, strict=True):
            wide = normalise(perpendicular(np.asarray(side, float), forward))
            deep = cross(forward, wide)
            for s, c in zip(sine, cosine, strict=True):
                self._add(station.centre + wide * c * station.wide + deep * s * station.deep, station)
        for ring in range(len(stations) - 1):
            for corner in range(corners):
                a = first + ring * corners + corner
                b = first + ring * corners + (corner + 1) % corners
                self.triangles += [(a, b, b + corners), (a, b + corners, a + corners)]
        self._close(first, stations[0], corners, flip=True)
        self._close(first + (len(stations) - 1) * corners, stations[-1], corners, flip=False)

    def _add(self, point: Floats, station: Station) -> None:
        self.points.append(point)
        self.weights.append(station.weights)

    def _close(self, ring: int, station: Station, corners: int, *, flip: bool) -> None:
        centre = len(self.points)
        self._add(station.centre, station)
        for corner in range(corners):
            a, b = ring + corner, ring + (corner + 1) % corners
            self.triangles.append((b, a, centre) if flip else (a, b, centre))

    def normals(self) -> Floats:
        points = np.stack(self.points)
        total = np.zeros_like(points)
        for a, b, c in self.triangles:
            total[[a, b, c]] += cross(points[b] - points[a], points[c] - points[a])
        return normalise(total)


@dataclass
class Station:
    """A cross-section of a tube."""

    centre: Floats
    wide: float
    deep: float
    weights: dict[int, float]


class Figure:
    """Nodes, skin and clips of one sample."""

    def __init__(self, name: str, *, crooked: float = 1.0) -> None:
        self.name = name
        self.crooked = crooked
        self.nodes: list[Node] = []
        self.skin = Skin()
        self.clips: dict[str, list[Keys]] = {}
        # The node in whose space the skin was modelled; the world unless said.
        self.modelled_in: int | None = None

    def space(
        self,
        name: str,
        position: Vector = (0, 0, 0),
        axes: Floats = IDENTITY,
        scale: Vector = (1, 1, 1),
    ) -> int:
        """Add a node that is no joint and that others stand in."""
        at = np.asarray(position, dtype=np.float64)
        self.nodes.append(Node(name, -1, at, axes, scale, space=True, joint=False))
        return len(self.nodes) - 1

    def joint(self, name: str, parent: str | int, position: Vector, axes: Floats | None = None) -> int:
        """Add a joint; its axes are crooked, and no two have the same, unless they are given."""
        above = self.index(parent) if isinstance(parent, str) else parent
        own = self._crooked_axes(len(self.nodes)) if axes is None else axes
        self.nodes.append(Node(name, above, np.asarray(position, dtype=np.float64), own))
        return len(self.nodes) - 1

    def chain(self, parent: str | int, *joints: tuple[str, Vector]) -> None:
        """Add joints, each under the one before."""
        for name, position in joints:
            parent = self.joint(name, parent, position)

    def index(self, name: str) -> int:
        return [node.name for node in self.nodes].index(name)

    def at(self, name: str) -> Floats:
        return self.nodes[self.index(name)].position

    def _crooked_axes(self, number: int) -> Floats:
        # Multiples of irrational numbers spread evenly and never repeat.
        share = (np.array([0.7548776662, 0.5698402910, 0.8191725134]) * (number + 1)) % 1.0
        axis = normalise(share * 2.0 - 1.0)
        return from_axis_angle(axis, self.crooked * (0.4 + 2.2 * ((number * 0.6180339887) % 1.0)))

    def wrap(
        self,
        joints: Sequence[str],
        radii: Sequence[float],
        *,
        side: Vector = (0, 0, 1),
        flat: float = 1.0,
        above: str | None = None,
        start: Vector | None = None,
        tip: Vector | None = None,
        corners: int = 6,
    ) -> None:
        """Put a tube of skin around a chain of joints, two joints to a point near each bend.

        radii: one for each joint and one for the end. flat: depth over width.
        above: what the first joint blends with. start, tip: where the first joint's part
        begins, behind the joint, and where the last one's ends.
        """
        index = [self.index(name) for name in joints]
        centres = [self.nodes[k].position for k in index]
        ends = [*centres[1:], np.asarray(tip, float)] if tip is not None else centres[1:]
        stations = []
        if start is not None:
            whole = {self.index(above) if above else index[0]: 1.0}
            behind = Station(np.asarray(start, float), radii[0] * 0.7, radii[0] * flat * 0.7, whole)
            stations.append(behind)
        for k, end in enumerate(ends):
            before = index[k - 1] if k else (self.index(above) if above else index[0])
            after = index[k + 1] if k + 1 < len(index) else index[k]
            for share, blend in ((0.0, {before: 0.5}), (0.3, {before: 0.1}), (0.7, {after: 0.1})):
                radius = radii[k] + (radii[k + 1] - radii[k]) * share
                weights = _blend(index[k], blend)
                stations.append(
                    Station(centres[k] + (end - centres[k]) * share, radius, radius * flat, weights)
                )
        last = index[-1]
        weights = {last: 1.0} if tip is not None else _blend(last, {index[-2]: 0.5})
        stations.append(Station(ends[-1], radii[len(ends)], radii[len(ends)] * flat, weights))
        self.skin.tube(stations, side=side, corners=corners)

    def animate(
        self,
        clip: str,
        times: Sequence[float],
        motions: dict[str, Motion],
        *,
        mode: Mode = "LINEAR",
    ) -> None:
        """Key the rotation of joints: motions turn about world axes, on top of the rest pose."""
        for name, motion in motions.items():
            node = self.index(name)
            before = conjugate(self._axes_above(node))
            values = np.stack([then(then(before, motion(t)), self.nodes[node].axes) for t in times])
            for k in range(1, len(values)):
                if (values[k] * values[k - 1]).sum() < 0:
                    values[k] = -values[k]
            self.key(clip, name, "rotation", times, values, mode=mode)

    def key(
        self,
        clip: str,
        name: str,
        path: Literal["translation", "rotation", "scale"],
        times: Sequence[float],
        values: Floats,
        *,
        mode: Mode = "LINEAR",
    ) -> None:
        """Key a property of a node as it is stored; cubic tangents run through the neighbours."""
        if mode == "CUBICSPLINE":
            tangents = np.zeros_like(values)
            span = np.asarray(times[2:]) - np.asarray(times[:-2])
            tangents[1:-1] = (values[2:] - values[:-2]) / span[:, np.newaxis]
            values = np.stack([tangents, values, tangents], axis=1)
        self.clips.setdefault(clip, []).append(Keys(self.index(name), path, tuple(times), values, mode))

    def _axes_above(self, node: int) -> Floats:
        parent = self.nodes[node].parent
        return IDENTITY if parent < 0 or self.nodes[parent].space else self.nodes[parent].axes

    def local(self) -> tuple[Floats, Floats, Floats]:
        """Translation, rotation and scale of all nodes, rounded as they are stored."""
        translation, rotation = [], []
        for k, node in enumerate(self.nodes):
            inward = conjugate(self._axes_above(k))
            stands = node.parent < 0 or self.nodes[node.parent].space
            origin = np.zeros(3) if stands else self.nodes[node.parent].position
            translation.append(rotate(inward, node.position - origin))
            rotation.append(then(inward, node.axes))
        scale = np.array([node.scale for node in self.nodes], dtype=np.float64)
        return rounded(np.stack(translation)), rounded(np.stack(rotation)), scale

    def worlds(self) -> Floats:
        """World matrices of the rest pose as stored, (n, 4, 4)."""
        local = compose(*self.local())
        world = local.copy()
        for k, node in enumerate(self.nodes):
            if node.parent >= 0:
                world[k] = multiply(local[k], world[node.parent])
        return world

    def binds(self) -> Floats:
        """Matrices of all nodes in the space that the skin was modelled in, (n, 4, 4)."""
        world = self.worlds()
        return world if self.modelled_in is None else multiply(world, inverse(world[self.modelled_in]))

    def joints(self) -> list[int]:
        """The nodes that are joints of the skin."""
        return [k for k, node in enumerate(self.nodes) if node.joint]


def _blend(own: int, other: dict[int, float]) -> dict[int, float]:
    ((node, share),) = other.items()
    return {own: 1.0} if node == own else {own: 1.0 - share, node: share}


def rounded(values: Floats) -> Floats:
    """Seven decimals, no negative zero: what a reader of the file wants to see."""
    return np.array([round(float(v), 7) + 0.0 for v in values.ravel()]).reshape(values.shape)


def box(mesh: Skinless) -> tuple[Floats, Floats, list[tuple[int, int, int]]]:
    """Points, normals and triangles of a box with hard edges."""
    points, normals, triangles = [], [], []
    corners = np.array([mesh.low, mesh.high], dtype=np.float64)
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for end in (0, 1):
            first = len(points)
            for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)) if end else ((0, 0), (0, 1), (1, 1), (1, 0)):
                point = np.zeros(3)
                point[axis], point[u], point[v] = corners[end, axis], corners[a, u], corners[b, v]
                points.append(point)
                normals.append(np.eye(3)[axis] * (1.0 if end else -1.0))
            triangles += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
    return np.stack(points), np.stack(normals), triangles


def about(axis: Vector, degrees: float) -> Floats:
    """A turn about an axis of the world."""
    return from_axis_angle(np.asarray(axis, float), degrees * (np.pi / 180.0))


def wave(share: float) -> float:
    """The sine of a share of a whole turn."""
    return float(sin_cos(share * 2.0 * np.pi)[0])


def size(v: Floats) -> float:
    return float(length(v))
