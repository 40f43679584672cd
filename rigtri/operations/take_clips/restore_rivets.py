"""Rivets of another file's rig on the same points of this file's meshes, which exporters number anew."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from rigtri.errors import FileError
from rigtri.evaluation.skinning import influences
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


def with_rivets_of(rig: Rig, described: Rig, of: Mapping[int, int], report: Report) -> Rig:
    """The rig with its rivets, as the other file describes them, on the points that they have there.

    of: nodes of the other file to nodes of this one. Where the mesh has no such points any more, the rivet
    keeps its keys, and is a rivet no longer; a warning names it.
    """
    metadata = dict(rig.metadata)
    for theirs, record in described.records(RivetRecord).items():
        node = of.get(theirs)
        if node is None or rig.type_of(node) != "rivet":
            continue
        try:
            found = _found_again(record, rig, described, of)
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
    record: RivetRecord, rig: Rig, described: Rig, of: Mapping[int, int]
) -> dict[str, Any] | None:
    """The primitive and the points of a rivet in this file, as its metadata holds them; None for none."""
    theirs = described.known(record.mesh)
    ours = None if theirs is None else of.get(theirs)
    there, here = _primitives(described, theirs), _primitives(rig, ours)
    rows = np.array(record.vertices, dtype=np.int64)
    if not here or record.primitive >= len(there) or rows.max() >= len(there[record.primitive].points):
        return {}  # bake says that there is no such mesh
    corners = [
        corner._replace(joint=of.get(corner.joint, -1)) if corner.joint >= 0 else corner
        for corner in _corners(there[record.primitive], described, rows)
    ]
    if (there[record.primitive].skin is None) != (here[0].skin is None):
        return None
    order = [record.primitive, *range(len(here))] if record.primitive < len(here) else range(len(here))
    for primitive in order:
        same = rows if primitive == record.primitive else None
        points = _points(here[primitive], rig, corners, same)
        if points is not None:
            return {"primitive": int(primitive), "vertices": points}
    return None


def _primitives(rig: Rig, node: int | None) -> list[Mesh]:
    return [mesh for mesh in rig.meshes if mesh.node == node]


def _corners(mesh: Mesh, rig: Rig, rows: Integers) -> list[_Corner]:
    if mesh.skin is None:
        return [_Corner(-1, mesh.points[row], 1.0) for row in rows]
    moved = influences(mesh, rig)
    found = []
    for row in rows:
        most = int(np.argmax(moved.weights[row]))
        joint = int(moved.joints[row, most])
        place = transform_points(mesh.points[row], moved.bind[joint])
        found.append(_Corner(int(moved.nodes[joint]), place, float(moved.weights[row, most])))
    return found


def _points(mesh: Mesh, rig: Rig, corners: Sequence[_Corner], same: Integers | None) -> list[int] | None:
    """The points of a primitive at three corners, those of the ``same`` numbers where they are there."""
    if not len(mesh.points):
        return None
    moved = influences(mesh, rig) if mesh.skin is not None else None
    found = []
    for k, corner in enumerate(corners):
        places, weights = mesh.points, np.ones(len(mesh.points))
        if moved is not None:
            joints = np.flatnonzero(moved.nodes == corner.joint)
            if not len(joints):
                return None
            places = transform_points(mesh.points, moved.bind[joints[0]])
            weights = np.where(moved.joints == joints[0], moved.weights, 0.0).max(axis=1)
        apart = distance(places, corner.place)
        size = float(length(places.max(axis=0) - places.min(axis=0)))
        near = np.flatnonzero(apart <= _SAME * size)
        if not len(near):
            return None
        # Of points in one place, as along a seam, the one that moves alike.
        other = np.abs(weights[near] - corner.weight)
        best = near[np.lexsort((apart[near], np.round(other, 3)))]
        again = same is not None and same[k] in near and other[near == same[k]][0] <= other.min() + _SAME
        found.append(int(same[k]) if same is not None and again else int(best[0]))
    return found
