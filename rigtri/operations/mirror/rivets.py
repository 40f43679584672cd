"""Mirroring rivets: created or moved, at the mirrored position of the mesh or of its twin."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.errors import GeometryError, UsageError
from rigtri.evaluation.skinning import SkinnedPoints
from rigtri.frames.mirroring import side_of
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.joint_names import side as side_in_name
from rigtri.model.rig import Rig
from rigtri.operations.add_rivet.rivet import add_rivet, options_of
from rigtri.operations.mirror.mirrored_metadata import MirrorOptions, lone, other, twin_name
from rigtri.operations.rigtri_nodes import find
from rigtri.report import Report

# A mesh whose nearest point is farther off than this share of the mesh is not symmetric there.
NEAR = 1e-2
# Rivets this near to the mirrored place stand there; this near to the plane, on no side.
STANDS, CENTRE = 1e-5, 1e-4


def mirror_rivets(rig: Rig, options: MirrorOptions, report: Report) -> Rig:
    """Tie the twins of this side's rivets to the other side of the surface."""
    for node, note in list(rig.metadata.items()):
        if note.get("type") == "rivet":
            rig = _rivet(rig, node, note, options, report)
    return rig


def _rivet(rig: Rig, node: int, note: Mapping[str, Any], options: MirrorOptions, report: Report) -> Rig:
    mesh = rig.known(note["mesh"])
    seat = None if mesh is None else _seat(rig, mesh, note)
    if mesh is None or seat is None:
        lone(rig, node, report, "rivet", "its mesh has no such points")
        return rig
    place, size = seat
    mirrored = options.across.points(place)
    side = side_in_name(str(note["name"])) or side_of(rig, mesh)
    if not side and length(mirrored - place) > CENTRE * size:
        lone(rig, node, report, "rivet", "neither its name nor its mesh says left or right")
    if side != options.from_side:
        return rig
    there = other(rig, mesh)
    if there is None:
        lone(rig, node, report, "rivet", f"'{rig.title(mesh)}' has no twin")
        return rig
    suffix = "_R" if side == "left" else "_L"
    name = twin_name(str(note["name"]), f"{note['name']}{suffix}")
    known = find(rig, type="rivet", name=name)
    if known is not None and _stands(rig, known, there, note, mirrored, size):
        report.added.append({"node": rig.names[known], "type": "rivet", "new": False})
        return rig
    x, y, z = mirrored.tolist()
    twin_options = replace(
        options_of(note),
        mesh=rig.path(there) if rig.names[there] else rig.labels[there],
        at=((x, y, z),),
        name=(name,),
    )
    built_report = Report()
    try:
        built = add_rivet(rig, options=twin_options, report=built_report)
    except (UsageError, GeometryError) as error:
        lone(rig, node, report, "rivet", str(error))
        return rig
    found = np.array(built_report.added[-1]["position"])
    if known is not None and _stands(rig, known, there, note, found, size):
        # The nearest point of a mesh that is not quite symmetric, but for the rounding of its skinning.
        report.added.append({"node": rig.names[known], "type": "rivet", "new": False})
        return rig
    off = float(length(found - mirrored))
    if off > NEAR * size:
        why = f"the mesh is {off / size:.2g} of its size away from the mirrored place"
        lone(rig, node, report, "rivet", why)
        return rig
    report.added.extend(built_report.added)
    report.extend(built_report.warnings)
    return built


def _seat(rig: Rig, node: int, note: Mapping[str, Any]) -> tuple[Floats, float] | None:
    """Where a note's place on a mesh is at rest, (3,), and the size of the mesh; None: nowhere."""
    primitives = [mesh for mesh in rig.meshes if mesh.node == node]
    rows = np.array(note["vertices"], dtype=np.int64)
    if not int(note["primitive"]) < len(primitives):
        return None
    mesh = primitives[int(note["primitive"])]
    if not len(mesh.points) or rows.max() >= len(mesh.points) or rows.min() < 0:
        return None
    corners = SkinnedPoints(rig, mesh, rows).at_rest()
    points = mesh.points[np.isfinite(mesh.points).all(axis=1)]
    a, b, c = note["barycentric"]
    place = a * corners[0] + b * corners[1] + c * corners[2]
    # Of the corners too: a mesh may be stored in other units than its bones.
    size = max(float(length(np.ptp(points, axis=0))), float(length(np.ptp(corners, axis=0))))
    return (place, size) if np.isfinite(place).all() and size > 0 else None


def _stands(rig: Rig, known: int, mesh: int, note: Mapping[str, Any], mirrored: Floats, size: float) -> bool:
    """Whether the twin stands there already, made alike."""
    mine = rig.metadata[known]
    if rig.known(mine["mesh"]) != mesh or any(mine.get(key) != note.get(key) for key in ("within", "fps")):
        return False
    seat = _seat(rig, mesh, mine)
    return seat is not None and float(length(seat[0] - mirrored)) <= STANDS * size
