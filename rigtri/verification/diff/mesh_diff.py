"""How the meshes of two rigs differ: points, weights, morphs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.verification.compare.correspondence import Correspondence, pair_meshes
from rigtri.verification.diff.axis_diff import moved
from rigtri.verification.diff.change import Change, furthest, rows, same_numbers


def mesh_changes(
    before: Rig, meshes: tuple[Sequence[Mesh], Sequence[Mesh]], m: Correspondence, tolerance: float
) -> Iterator[Change]:
    """Points, weights and morphs."""
    pairs, added = pair_meshes(m, *meshes)
    for mesh, other in pairs:
        title = mesh.name or before.title(mesh.node)
        if other is None:
            yield Change("meshes", "removed", title, f"{len(mesh.points)} points")
        else:
            yield from _mesh(mesh, other, title, tolerance)
    for mesh in added:
        yield Change("meshes", "added", mesh.name, f"{len(mesh.points)} points")


def _mesh(mesh: Mesh, other: Mesh, title: str, tolerance: float) -> Iterator[Change]:
    if len(mesh.points) != len(other.points):
        yield Change("meshes", "changed", title, f"points {len(mesh.points)} → {len(other.points)}")
        return
    if not same_numbers(mesh.points, other.points, tolerance):
        yield Change("meshes", "changed", title, f"points: {furthest(mesh.points, other.points)}")
    if (mesh.skin is None) != (other.skin is None):
        yield Change("meshes", "changed", title, f"is {'no longer' if other.skin is None else 'now'} skinned")
    elif not _same_weights(mesh, other, tolerance):
        yield Change("skins", "changed", f"weights of {title}", _weights(mesh, other))
    if len(mesh.morphs) != len(other.morphs):
        yield Change("meshes", "changed", title, f"morphs {len(mesh.morphs)} → {len(other.morphs)}")
    elif mesh.morphs.size and not same_numbers(mesh.morphs, other.morphs, tolerance):
        yield Change("meshes", "changed", title, f"morphs: {furthest(mesh.morphs, other.morphs)}")
    if not same_numbers(mesh.morph_weights, other.morph_weights, tolerance):
        yield Change(
            "meshes", "changed", title, f"morph weights {rows(mesh.morph_weights, other.morph_weights)}"
        )
    if not same_numbers(mesh.bind, other.bind, tolerance):
        yield Change("bind pose", "changed", title, f"geometry bind {moved(mesh.bind, other.bind)}")


def _same_weights(mesh: Mesh, other: Mesh, tolerance: float) -> bool:
    same = mesh.joints.shape == other.joints.shape
    return same and bool(
        (mesh.joints == other.joints)[mesh.weights != 0].all()
        and same_numbers(mesh.weights, other.weights, tolerance)
    )


def _weights(mesh: Mesh, other: Mesh) -> str:
    if mesh.weights.shape != other.weights.shape:
        return f"{mesh.weights.shape[1]} → {other.weights.shape[1]} joints for each vertex"
    differ = ((mesh.weights != other.weights) | ((mesh.joints != other.joints) & (mesh.weights != 0))).any(
        axis=1
    )
    worst = float(np.nanmax(np.abs(mesh.weights - other.weights), initial=0.0))
    return f"{int(differ.sum())} of {len(differ)} vertices differ, by up to {worst:.3g}"
