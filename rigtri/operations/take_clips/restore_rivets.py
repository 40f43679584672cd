"""Rivets of another file's rig on the same points of this file's meshes, which exporters number anew."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np

from rigtri.errors import FileError
from rigtri.evaluation.skinning import Influences, influences
from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import transform_points
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import distance, length
from rigtri.model.mesh import Mesh
from rigtri.model.metadata import RivetRecord
from rigtri.model.rig import Rig
from rigtri.report import Report

# Points that differ by less, as a share of the mesh's size, went through another program's float32.
_SAME = 1e-4


class _Corner(NamedTuple):
    """A corner of a triangle: where the joint sees it that moves it most, −1 for the node of a rigid mesh.

    weight: how much that joint moves it.
    """

    joint: int
    place: Floats
    weight: float


class _Primitive:
    """A primitive of a mesh, whose points and weights are worked out once for all rivets on it."""

    def __init__(self, mesh: Mesh, rig: Rig) -> None:
        self.mesh, self._rig = mesh, rig
        # Rivets of one garment share a few joints; those of all would be as many copies of a large mesh.
        self.placed = lru_cache(maxsize=4)(self._placed)

    @cached_property
    def moved(self) -> Influences | None:
        """What moves its points, None where it is rigid."""
        return None if self.mesh.skin is None else influences(self.mesh, self._rig)

    def _placed(self, row: int) -> tuple[Floats, float]:
        """Where a joint of the skin by its row, −1: the node, sees the points, (v, 3), and their size."""
        places = self.mesh.points
        if row >= 0 and self.moved is not None:
            places = transform_points(places, self.moved.bind[row])
        return places, float(length(places.max(axis=0) - places.min(axis=0)))

    def weights(self, rows: Integers, joint: int) -> Floats:
        """How much a joint of the skin moves some of the points; 1 of a rigid mesh."""
        if self.moved is None:
            return np.ones(len(rows))
        found: Floats = np.where(self.moved.joints[rows] == joint, self.moved.weights[rows], 0.0).max(axis=1)
        return found


class _Primitives:
    """The primitives of the meshes of a rig, by their node."""

    def __init__(self, rig: Rig) -> None:
        self.rig, self._known = rig, dict[int, list[_Primitive]]()

    def of(self, node: int | None) -> list[_Primitive]:
        """Those of one node, none of None."""
        if node is None:
            return []
        if node not in self._known:
            found = [_Primitive(mesh, self.rig) for mesh in self.rig.meshes if mesh.node == node]
            self._known[node] = found
        return self._known[node]


def with_rivets_of(rig: Rig, described: Rig, of: Mapping[int, int], report: Report) -> Rig:
    """The rig with its rivets, as the other file describes them, on the points that they have there.

    of: nodes of the other file to nodes of this one. Where the mesh has no such points any more, the rivet
    keeps its keys, and is a rivet no longer; a warning names it.
    """
    metadata, there, here = dict(rig.metadata), _Primitives(described), _Primitives(rig)
    for theirs, record in described.records(RivetRecord).items():
        node = of.get(theirs)
        if node is None or rig.type_of(node) != "rivet":
            continue
        try:
            found = _found_again(record, there, here, of)
        except FileError:
            continue  # bake tells it of the meshes that it cannot read
        if found is None:
            del metadata[node]
            report.warn(
                "follower-kept",
                f"'{rig.title(node)}' keeps its keys, and is a rivet no longer: mesh '{record.mesh}' of this "
                "file does not have the points that hold it in the file of --rig; add it again with: "
                "rigtri add-rivet",
                names=[rig.names[node]],
            )
        else:
            metadata[node] = {**metadata[node], **found}
    return rig if metadata == rig.metadata else replace(rig, metadata=metadata)


def _found_again(
    record: RivetRecord, described: _Primitives, now: _Primitives, of: Mapping[int, int]
) -> dict[str, Any] | None:
    """The primitive and the points of a rivet in this file, as its metadata holds them; None for none."""
    theirs = described.rig.known(record.mesh)
    there, here = described.of(theirs), now.of(None if theirs is None else of.get(theirs))
    rows = np.array(record.vertices, dtype=np.int64)
    if not here or record.primitive >= len(there) or rows.max() >= len(there[record.primitive].mesh.points):
        return {}  # bake says that there is no such mesh
    corners = [
        corner._replace(joint=of.get(corner.joint, -1)) if corner.joint >= 0 else corner
        for corner in _corners(there[record.primitive], rows)
    ]
    if (there[record.primitive].mesh.skin is None) != (here[0].mesh.skin is None):
        return None
    for primitive in sorted(range(len(here)), key=lambda k: k != record.primitive):
        same = rows if primitive == record.primitive else None
        points = _points(here[primitive], corners, same)
        if points is not None:
            return {"primitive": int(primitive), "vertices": points}
    return None


def _corners(there: _Primitive, rows: Integers) -> list[_Corner]:
    mesh, moved = there.mesh, there.moved
    if moved is None:
        return [_Corner(-1, mesh.points[row], 1.0) for row in rows]
    found = []
    for row in rows:
        most = int(np.argmax(moved.weights[row]))
        joint = int(moved.joints[row, most])
        place = transform_points(mesh.points[row], moved.bind[joint])
        found.append(_Corner(int(moved.nodes[joint]), place, float(moved.weights[row, most])))
    return found


def _points(here: _Primitive, corners: Sequence[_Corner], same: Integers | None) -> list[int] | None:
    """The points of a primitive at three corners, those of the ``same`` numbers where they are there."""
    if not len(here.mesh.points):
        return None
    found = []
    for k, corner in enumerate(corners):
        joint = -1
        if here.moved is not None:
            joints = np.flatnonzero(here.moved.nodes == corner.joint)
            if not len(joints):
                return None
            joint = int(joints[0])
        places, size = here.placed(joint)
        # Along one axis first, for that leaves few of many points.
        near = np.flatnonzero(np.abs(places[:, 0] - corner.place[0]) <= _SAME * size)
        apart = distance(places[near], corner.place)
        close = apart <= _SAME * size
        near, apart = near[close], apart[close]
        if not len(near):
            return None
        # Of points in one place, as along a seam, the one that moves alike.
        other = np.abs(here.weights(near, joint) - corner.weight)
        best = near[np.lexsort((apart, np.round(other, 3)))]
        again = same is not None and same[k] in near and other[near == same[k]][0] <= other.min() + _SAME
        found.append(int(same[k]) if same is not None and again else int(best[0]))
    return found
