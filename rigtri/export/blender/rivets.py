"""Rivets in Blender: sockets that ride on vertices of the mesh as it is deformed, and the rivet on these."""

from __future__ import annotations

import numpy as np

from rigtri.errors import FileError
from rigtri.evaluation.dependency_graph import dependencies
from rigtri.export.blender.controls import middle
from rigtri.export.blender.plan import Plan, Share, left_out
from rigtri.maths.matrices import skew
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.mesh import Mesh
from rigtri.model.metadata import PoseReaderRecord, RivetRecord
from rigtri.model.rig import Rig
from rigtri.report import Report

# How much the axes of a mesh may differ in scale, as a share: more turns a triangle's normal.
_EVEN = 1e-4


def rivets(plan: Plan, report: Report) -> None:
    """All rivets of a rig; a warning for those that cannot ride on their mesh in Blender."""
    rig = plan.rig
    for node, record in sorted(rig.records(RivetRecord).items()):
        try:
            _rivet(plan, node, record)
        except (FileError, ValueError) as error:
            left_out(report, f"the rivet '{record.name or rig.title(node)}'", str(error))


def _rivet(plan: Plan, node: int, record: RivetRecord) -> None:
    """A point between three vertices, turned as their triangle is. ValueError says why there is none."""
    rig, name = plan.rig, plan.called(node)
    meshes = [mesh for mesh in rig.meshes if mesh.node == rig.known(record.mesh)]
    if not record.primitive < len(meshes) or min(record.barycentric) < 0:
        raise ValueError("its mesh has no such triangle")
    mesh = meshes[record.primitive]
    if mesh.dual_quaternion:
        raise ValueError("its mesh is skinned with dual quaternions, and Blender imports it as linear")
    if mesh.skin is None and not _even(rig.world[mesh.node]):
        raise ValueError("its mesh is scaled by another factor along each axis")
    moved = sorted(_moved_by(rig, node))
    bone = next((each for each in moved if plan.bone_axes(each)), None)
    if bone is not None:
        raise ValueError(f"it moves '{rig.title(bone)}', and Blender moves all bones before meshes")
    numbers, count = imported_vertices(meshes, record)
    word = plan.node(mesh.node)
    points = [
        (plan.on_vertices(f"{name} vertex {number}", word, [number], count), weight)
        for number, weight in zip(numbers, record.barycentric, strict=True)
        if weight > 0
    ]
    place, total, found = rig.world[node, 3, :3], 0.0, list[tuple[str, Share, Floats]]()
    for point, weight in points:
        total += weight
        found.append((point, weight / total, place))
    seat = middle(plan, f"{name} seat", found)
    turned = plan.on_vertices(f"{name} triangle", word, numbers, count)
    plan.constrain(plan.node(node), "COPY_LOCATION", seat, f"Rivet {plan.called(mesh.node)}")
    plan.constrain(plan.node(node), "COPY_ROTATION", turned, f"Rivet {plan.called(mesh.node)}")


def _even(world: Floats) -> bool:
    sizes = length(world[:3, :3])
    return bool(sizes.max() - sizes.min() <= _EVEN * sizes.max() and skew(world) <= _EVEN)


def _moved_by(rig: Rig, node: int) -> set[int]:
    """All nodes that depend on one, by parents, constraints and pose readers."""
    needs = dependencies(rig)
    for record in rig.records(PoseReaderRecord).values():
        names = [record.driver, record.frame, *(target.node for target in record.targets)]
        read = {k for name in names if name and (k := rig.known(name)) is not None}
        for output in record.outputs:
            joint = rig.known(output.joint) if output.joint else None
            if joint is not None:
                needs.setdefault(joint, set()).update(read)
    found, before = {node}, 0
    while len(found) > before:
        before = len(found)
        found |= {each for each, sources in needs.items() if not found.isdisjoint(sources)}
    return found - {node}


def imported_vertices(meshes: list[Mesh], record: RivetRecord) -> tuple[list[int], int]:
    """The numbers that Blender gives the three vertices of a rivet, and how many the mesh has there.

    Its glTF import joins all primitives of a mesh, each with those vertices alone that it draws.
    """
    surfaces = [mesh.surface_now for mesh in meshes]
    if any(surface is None for surface in surfaces):
        raise ValueError("its mesh cannot be read")
    if any(surface is not None and surface.kind == "Mesh" for surface in surfaces):
        return list(record.vertices), len(meshes[record.primitive].points)
    drawn = [np.unique(surface.corners) for surface in surfaces if surface is not None]
    before = sum(map(len, drawn[: record.primitive]))
    ranks = np.searchsorted(drawn[record.primitive], np.array(record.vertices))
    return [before + rank for rank in ranks.tolist()], sum(map(len, drawn))
