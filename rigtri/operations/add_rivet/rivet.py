"""Rivets: locators held by a triangle of a mesh, through skinning and morphs, baked to keys."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.adaptive_sampling import adaptive_key_times
from rigtri.evaluation.sampling import sample
from rigtri.evaluation.skinned_points import SkinnedPoints
from rigtri.evaluation.timelines import (
    Timeline,
    as_float32,
    keys_and_between,
    put_tracks,
    steps_only,
    timelines,
    times_and_jumps,
)
from rigtri.evaluation.written_meshes import as_bound_in_file, as_in_file
from rigtri.maths.arrays import Integers
from rigtri.maths.quaternions import angle_between, from_axes, make_continuous, slerp, to_axes
from rigtri.maths.triangle import frame
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, distance, length
from rigtri.model.animation import Interpolation, Track
from rigtri.model.dataclass import dataclass
from rigtri.model.mesh import Mesh
from rigtri.model.mesh_triangles import flat, meshes_named, nearest, triangles, vertices_of
from rigtri.model.metadata import RivetRecord
from rigtri.model.rig import Rig
from rigtri.operations.operation import operation
from rigtri.operations.options.add_rivet import AddRivetOptions as AddRivetOptions
from rigtri.operations.rigtri_nodes import (
    add,
    find_named,
    given_name,
    group,
    refuse_taken,
    stand,
    with_record,
)
from rigtri.progress import counted
from rigtri.report import Report

# Something so long, as a share of the mesh, may be attached to a rivet: rotations count as its end moves.
ARM = 0.1
# What moves less than this share of the mesh stands still, and gets one key.
STILL = 1e-8
# A point that is farther from the mesh, as a share of its size, may be in other units or of another mesh.
FAR = 0.1
# Points of one place, as a share of the mesh's size: rivets of `bake --rig` were found again among such.
SAME_PLACE = 1e-4

Point = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class _Seat:
    """Where a rivet sits: a primitive, three of its points, and their weights.

    number: for messages. aside: how far it is from the point that was given, in file units.
    """

    mesh: Mesh
    primitive: int
    vertices: Integers
    weights: Floats
    number: int
    aside: float = 0.0


@operation(AddRivetOptions)
def add_rivet(rig: Rig, *, options: AddRivetOptions, report: Report) -> Rig:
    """Tie locators to triangles of a mesh and bake their motion in every clip.

    The frame of a rivet: x along the triangle's first edge, y its normal. A second run finds a
    rivet by its name and moves it. The record of each goes to ``report.added``, with the largest
    distance from the surface.

    Raises NameNotFoundError, UsageError, GeometryError (no triangles, out of range, no area), FileError.
    """
    meshes = [as_in_file(mesh, rig) for mesh in meshes_named(rig, options.mesh)]
    ground = _Ground(as_bound_in_file(rig), meshes, options.mesh)
    for name in options.name:
        given_name(rig, name, report)
    names = _names(rig, options, ground)
    for name in names if options.name else ():
        refuse_taken(rig, name, find_named(rig, RivetRecord, name))
    for name, seat in counted([*zip(names, ground.seats(options), strict=True)], "rivets"):
        if seat.aside > FAR * ground.size:
            text = f"The point of rivet '{name}' is {seat.aside:.4g} away from mesh '{ground.name}'"
            report.warn("rivet-far", f"{text}: the rivet is at the nearest point there", geometry=True)
        rig = _Rivet(rig, name, seat, ground.size, options, report).built()
    return rig


def options_of(record: RivetRecord) -> AddRivetOptions:
    """The options that a rivet was made with; its place is left to the caller."""
    return AddRivetOptions(mesh=record.mesh, name=(record.name,), between=record.within, fps=record.fps)


def rebaked(rig: Rig, node: int, *, clips: Collection[int], report: Report | None = None) -> Rig:
    """The rig with a rivet where its triangle is now: at rest, and in some clips, by their places.

    Raises GeometryError where its mesh has no such triangle any more, FileError.
    """
    record = rig.records(RivetRecord)[node]
    mesh_node, number = rig.known(record.mesh), record.primitive
    meshes = [as_in_file(mesh, rig) for mesh in rig.meshes if mesh.node == mesh_node]
    rows = np.array(record.vertices, dtype=np.int64)
    count = len(meshes[number].points) if number < len(meshes) else 0
    if len(rows) != 3 or rows.min() < 0 or rows.max() >= count:
        raise GeometryError(
            f"Rivet '{rig.title(node)}': mesh '{record.mesh}' has no such triangle, or cannot be read; "
            "add it again with: rigtri add-rivet"
        )
    ground = _Ground(as_bound_in_file(rig), meshes, record.mesh)
    if not ground.has_face(number, rows):
        raise GeometryError(
            f"Rivet '{rig.title(node)}': its points are no triangle of mesh '{record.mesh}': another "
            "program may have numbered these anew. Bake with --rig and the file from before, or add it again "
            "with: rigtri add-rivet"
        )
    seat = _Seat(meshes[number], number, rows, np.array(record.barycentric), ground.number(number, rows))
    report = report if report is not None else Report()
    options = options_of(record)
    return _Rivet(rig, record.name, seat, ground.size, options, report, frozenset(clips), node).built()


def _names(rig: Rig, options: AddRivetOptions, ground: _Ground) -> list[str]:
    if len(options.name) == options.count:
        return list(options.name)
    base = options.name[0] if options.name else f"{rig.names[ground.meshes[0].node] or 'mesh'}_rivet"
    return [base if k == 0 else f"{base}_{k + 1}" for k in range(options.count)]


@dataclass(frozen=True, eq=False)
class _Ground:
    """The primitives of the mesh that holds the rivets."""

    rig: Rig
    meshes: Sequence[Mesh]
    name: str

    @cached_property
    def triangles(self) -> list[Integers]:
        found = [triangles(mesh) for mesh in self.meshes]
        if not any(map(len, found)):
            raise GeometryError(f"Mesh '{self.name}' has no triangles to hold a rivet")
        return found

    @cached_property
    def points(self) -> list[Floats]:
        """The points of each primitive at rest, in the world."""
        return [SkinnedPoints(self.rig, mesh, np.arange(len(mesh.points))).at_rest() for mesh in self.meshes]

    @cached_property
    def size(self) -> float:
        """The diagonal of the box of the points at rest; 1 where all are in one place, to rounding."""
        points = np.concatenate(self.points)
        points = points[np.isfinite(points).all(axis=1)]
        if not len(points):
            raise GeometryError(f"No point of mesh '{self.name}' has a finite position at rest")
        diagonal = float(length(points.max(axis=0) - points.min(axis=0)))
        skins = {mesh.skin for mesh in self.meshes if mesh.skin is not None}
        joints = [self.rig.world[self.rig.skins[skin].joints, 3, :3] for skin in skins]
        # Files hold points, and where the joints stand that carry them, as float32.
        rounding = float(np.finfo(np.float32).eps) * max(
            float(np.abs(p).max(initial=0.0)) for p in [points, *joints]
        )
        return diagonal if diagonal > rounding else 1.0

    def seats(self, options: AddRivetOptions) -> list[_Seat]:
        middle = (1.0 / 3, 1.0 / 3, 1.0 / 3)
        given = [*options.barycentric, *[middle] * (len(options.triangle) - len(options.barycentric))]
        return [
            *(self._of_triangle(n, w) for n, w in zip(options.triangle, given, strict=True)),
            *map(self._nearest, options.at),
            *map(self._of_vertex, options.vertex),
        ]

    def _of_triangle(self, number: int, weights: Point) -> _Seat:
        total = sum(map(len, self.triangles))
        if not 0 <= number < total:
            raise GeometryError(
                f"Mesh '{self.name}' has {total} triangles, 0 to {total - 1}; there is no triangle {number}"
            )
        row, primitive = number, 0
        while row >= len(self.triangles[primitive]):
            row -= len(self.triangles[primitive])
            primitive += 1
        seat = self._seat(primitive, row, np.array(weights, dtype=np.float64))
        if flat(self.points[primitive][seat.vertices]):
            raise GeometryError(
                f"Triangle {number} of mesh '{self.name}' has no area, so it has no normal; choose another"
            )
        return seat

    def number(self, primitive: int, rows: Integers) -> int:
        """The number of the triangle with some corners, −1 where there is none any more."""
        hits = np.flatnonzero((self.triangles[primitive] == rows).all(axis=1))
        return sum(map(len, self.triangles[:primitive])) + int(hits[0]) if len(hits) else -1

    def has_face(self, primitive: int, rows: Integers) -> bool:
        """Whether points, or others in their places, as along seams, are the corners of a triangle."""
        found, points = self.triangles[primitive], self.meshes[primitive].points
        within = SAME_PLACE * float(length(points.max(axis=0) - points.min(axis=0)))
        for corner in rows:
            found = found[(distance(points, points[corner]) <= within)[found].any(axis=1)]
        return len(found) > 0

    def _seat(self, primitive: int, row: int, weights: Floats) -> _Seat:
        mesh, before = self.meshes[primitive], sum(map(len, self.triangles[:primitive]))
        # The place among all primitives of the node, also where one alone was named.
        every = [other.name for other in self.rig.meshes if other.node == mesh.node]
        rows = self.triangles[primitive][row]
        return _Seat(mesh, every.index(mesh.name), rows, weights, before + row)

    def _nearest(self, place: Point) -> _Seat:
        sizes = list(map(len, self.triangles))
        corners = np.concatenate(
            [points[rows] for points, rows in zip(self.points, self.triangles, strict=True)]
        )
        found, weights = nearest(np.array(place, dtype=np.float64), corners)
        primitive = int(np.searchsorted(np.cumsum(sizes), found, side="right"))
        seat = self._seat(primitive, found - sum(sizes[:primitive]), weights)
        a, b, c = self.points[primitive][seat.vertices]
        here = weights[0] * a + weights[1] * b + weights[2] * c
        return replace(seat, aside=float(distance(np.array(place, dtype=np.float64), here)))

    def _of_vertex(self, vertex: int) -> _Seat:
        count = len(self.meshes[0].points)
        if not 0 <= vertex < count:
            raise GeometryError(
                f"Mesh '{self.name}' has {count} points, 0 to {count - 1}; there is no vertex {vertex}"
            )
        for primitive, row, corner in vertices_of(self.triangles[:1], vertex):
            if not flat(self.points[primitive][self.triangles[primitive][row]]):
                return self._seat(primitive, row, np.where(np.arange(3) == corner, 1.0, 0.0))
        raise GeometryError(f"Vertex {vertex} of mesh '{self.name}' is in no triangle that has an area")


@dataclass(frozen=True, eq=False)
class _Rivet:
    """One rivet on its way into the rig. clips: the places of those it is baked into, None for all.

    node: that of one that is there.
    """

    rig: Rig
    name: str
    seat: _Seat
    size: float
    options: AddRivetOptions
    report: Report
    clips: frozenset[int] | None = None
    node: int | None = None

    def built(self) -> Rig:
        a, b, c = map(float, self.seat.weights)
        record = RivetRecord(
            name=self.name,
            mesh=self.rig.address(self.seat.mesh.node),
            primitive=self.seat.primitive,
            vertices=tuple(map(int, self.seat.vertices)),
            barycentric=(a, b, c),
            within=self.options.between,
            fps=self.options.fps,
        )
        rig, parent = group(self.rig)
        node = self.node
        if node is None:  # without a given name not the rivet of another character's mesh
            about = {} if self.options.name else {"mesh": self.seat.mesh.node}
            node = find_named(self.rig, RivetRecord, self.name, **about)
        if node is None:
            rig, node = add(rig, self.name, parent, record)
        else:
            rig = with_record(rig, node, record)
        mesh, rows = self.seat.mesh, self.seat.vertices
        corners = SkinnedPoints(as_bound_in_file(rig), mesh, rows).at_rest()
        resting = self._seats(corners[np.newaxis])[0]
        rig = stand(rig, node, resting[:3], to_axes(resting[3:]))
        held = SkinnedPoints(as_bound_in_file(rig), mesh, rows, int(rig.parents[node]))
        counts: dict[str, int] = {}
        worst = 0.0
        for timeline in counted(timelines(rig), "clips"):
            if self.clips is not None and self.clips.isdisjoint(timeline.members):
                continue
            tracks = self._tracks(held, timeline, node)
            rig = put_tracks(rig, timeline, tracks)
            counts[timeline.name] = max(len(track.times) for track in tracks)
            worst = max(worst, self._off(held, timeline, tracks))
        self._record(rig, node, counts, worst)
        return rig

    def _seats(self, points: Floats) -> Floats:
        """Position and rotation xyzw, (f, 7), on corners (f, 3, 3)."""
        weights = self.seat.weights
        place = weights[0] * points[:, 0] + weights[1] * points[:, 1] + weights[2] * points[:, 2]
        first, other = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
        with np.errstate(invalid="ignore", divide="ignore"):
            turns = from_axes(frame(first, cross(first, other)))
        turns = np.where(flat(points)[:, np.newaxis], np.nan, turns)
        return np.concatenate([place, turns], axis=1)

    def _tracks(self, held: SkinnedPoints, timeline: Timeline, node: int) -> list[Track]:
        """Translation and rotation of the rivet over a timeline, with as many keys as they need."""
        moving = held.affecting(timeline)

        def seats(times: Floats) -> Floats:
            return self._seats(held.sample(moving, times))

        times = times_and_jumps(
            moving if moving.clip.tracks else timeline, self.options.fps, held.rig.rules.per_second
        )
        holds = steps_only(moving)
        if not holds:
            bound, of = self.options.between * self.size, f"Rivet '{self.name}' in clip '{timeline.name}'"
            try:
                times = adaptive_key_times(seats, self._error, times, within=bound, of=of)
            except GeometryError as error:
                raise GeometryError(f"{error}. Or allow more with --between") from None
        values = self._whole(seats(times), timeline, times)
        if (self._deviation(values, np.broadcast_to(values[0], values.shape)) <= STILL * self.size).all():
            times, values = times[:1], values[:1]
        values = as_float32(values)  # as what follows the rivet will read them
        way: Interpolation = "STEP" if holds or len(times) == 1 else "LINEAR"
        return [
            Track(node, "translation", way, times, values[:, :3]),
            Track(node, "rotation", way, times, make_continuous(values[:, 3:])),
        ]

    def _whole(self, values: Floats, timeline: Timeline, times: Floats) -> Floats:
        """Values with turns also where the triangle has no area: those of the key before, or after."""
        if not np.isfinite(values[:, :3]).all():
            at = float(times[int((~np.isfinite(values[:, :3]).all(axis=1)).argmax())])
            raise GeometryError(
                f"Rivet '{self.name}' has no finite position in clip '{timeline.name}' at {at:g}"
            )
        known = np.asarray(np.isfinite(values[:, 3:]).all(axis=1))
        if known.all():
            return values
        at = float(times[int(np.argmin(known))])
        self.report.warn(
            "rivet-flat",
            f"Rivet '{self.name}': its triangle has no area in clip '{timeline.name}' at {at:g}; "
            "it keeps its axes there",
            geometry=True,
        )
        last = np.maximum.accumulate(np.where(known, np.arange(len(known)), -1))
        last = np.where(last < 0, int(known.argmax()) if known.any() else 0, last)
        turns = values[last, 3:] if known.any() else np.broadcast_to([0.0, 0, 0, 1], (len(values), 4))
        return np.concatenate([values[:, :3], turns], axis=1)

    def _error(self, values: Floats, left: Floats, right: Floats, share: Floats, times: Floats) -> Floats:
        """How far a line between two keys is off in between, (f,), in file units."""
        with np.errstate(invalid="ignore"):
            place = left[:, :3] + (right[:, :3] - left[:, :3]) * share[:, np.newaxis]
            between = np.concatenate([place, slerp(left[:, 3:], right[:, 3:], share)], axis=1)
            return np.nan_to_num(self._deviation(values, between), nan=0.0)

    def _deviation(self, values: Floats, others: Floats) -> Floats:
        """How far the end of what is attached to the rivet is moved, (f,), in file units."""
        turned = angle_between(values[:, 3:], others[:, 3:])
        return np.asarray(length(values[:, :3] - others[:, :3]) + ARM * self.size * turned)

    def _off(self, held: SkinnedPoints, timeline: Timeline, tracks: Sequence[Track]) -> float:
        """The largest distance of the baked rivet, stored as float32, from the surface, in file units."""
        moving = held.affecting(timeline)
        times = tracks[0].times if steps_only(moving) else keys_and_between(tracks[0].times)
        surface = self._seats(held.sample(moving, times))[:, :3]
        return float(length(surface - sample(tracks[0], times)).max(initial=0.0))

    def _record(self, rig: Rig, node: int, counts: dict[str, int], worst: float) -> None:
        self.report.added.append(
            {
                "node": rig.names[node],
                "type": "rivet",
                "mesh": rig.title(self.seat.mesh.node),
                "triangle": self.seat.number,
                "vertices": [int(vertex) for vertex in self.seat.vertices],
                "barycentric": [float(weight) for weight in self.seat.weights],
                "new": rig.keys[node] is None,
                "position": [float(x) for x in rig.world[node, 3, :3]],
                "keys": counts,
                "deviation": worst / self.size,
                "distance": self.seat.aside,
            }
        )
