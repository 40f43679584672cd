"""Mirroring rivets: created or moved, at the mirrored position of the mesh or of its twin."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.evaluation.skinned_points import SkinnedPoints
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length, triple
from rigtri.model.joint_names import side as side_in_name
from rigtri.model.metadata import RivetRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_rivet.rivet import add_rivet, options_of
from rigtri.operations.mirror.counterparts import SUFFIX, NotMirroredError, mirror_each, other, twin_name
from rigtri.operations.options.mirror import MirrorOptions
from rigtri.operations.rigtri_nodes import find
from rigtri.recognition.sides import side_of
from rigtri.report import Report

# A mesh whose nearest point is farther off than this share of the mesh is not symmetric there.
NEAR = 1e-2
# Rivets this near to the mirrored place stand there; this near to the plane, on no side.
STANDS, CENTRE = 1e-5, 1e-4


def mirror_rivets(rig: Rig, options: MirrorOptions, report: Report) -> Rig:
    """Tie the twins of this side's rivets to the other side of the surface."""

    def build(rig: Rig, node: int, report: Report) -> Rig:
        return _rivet(rig, rig.records(RivetRecord)[node], options, report)

    return mirror_each(rig, rig.records(RivetRecord), "rivet", build, report)


def _rivet(rig: Rig, record: RivetRecord, options: MirrorOptions, report: Report) -> Rig:
    mesh = rig.known(record.mesh)
    seat = None if mesh is None else _seat(rig, mesh, record)
    if mesh is None or seat is None:
        raise NotMirroredError("its mesh has no such points")
    place, size = seat
    mirrored = options.across.points(place)
    side = side_in_name(record.name) or side_of(rig, mesh)
    if not side and length(mirrored - place) > CENTRE * size:
        raise NotMirroredError("neither its name nor its mesh says left or right")
    if side != options.from_side:
        return rig
    there = other(rig, mesh)
    if there is None:
        raise NotMirroredError(f"'{rig.title(mesh)}' has no twin")
    name = twin_name(record.name, f"{record.name}{SUFFIX[side]}")
    known = find(rig, RivetRecord, name=name)
    twin_options = replace(
        options_of(record),
        mesh=rig.path(there) if rig.names[there] else rig.labels[there],
        at=(triple(mirrored),),
        name=(name,),
    )
    built_report = Report()
    stands = known is not None and _stands(rig, known, there, record, mirrored, size)
    built = rig if stands else add_rivet(rig, options=twin_options, report=built_report)
    found = mirrored if stands else np.array(built_report.added[-1]["position"])
    if known is not None and (stands or _stands(rig, known, there, record, found, size)):
        # The nearest point of a mesh that is not quite symmetric, but for the rounding of its skinning.
        report.added.append({"node": rig.names[known], "type": "rivet", "new": False})
        return rig
    off = float(length(found - mirrored))
    if off > NEAR * size:
        raise NotMirroredError(f"the mesh is {off / size:.2g} of its size away from the mirrored place")
    report.merge(built_report)
    return built


def _seat(rig: Rig, node: int, record: RivetRecord) -> tuple[Floats, float] | None:
    """Where a record's place on a mesh is at rest, (3,), and the size of the mesh; None: nowhere."""
    primitives = [mesh for mesh in rig.meshes if mesh.node == node]
    rows = np.array(record.vertices, dtype=np.int64)
    if not record.primitive < len(primitives):
        return None
    mesh = primitives[record.primitive]
    if not len(mesh.points) or rows.max() >= len(mesh.points) or rows.min() < 0:
        return None
    corners = SkinnedPoints(rig, mesh, rows).at_rest()
    points = mesh.points[np.isfinite(mesh.points).all(axis=1)]
    a, b, c = record.barycentric
    place = a * corners[0] + b * corners[1] + c * corners[2]
    # Of the corners too: a mesh may be stored in other units than its bones.
    size = max(float(length(np.ptp(points, axis=0))), float(length(np.ptp(corners, axis=0))))
    return (place, size) if np.isfinite(place).all() and size > 0 else None


def _stands(rig: Rig, known: int, mesh: int, record: RivetRecord, mirrored: Floats, size: float) -> bool:
    """Whether the twin stands there already, made alike."""
    mine = rig.records(RivetRecord)[known]
    if rig.known(mine.mesh) != mesh or (mine.within, mine.fps) != (record.within, record.fps):
        return False
    seat = _seat(rig, mesh, mine)
    return seat is not None and float(length(seat[0] - mirrored)) <= STANDS * size
