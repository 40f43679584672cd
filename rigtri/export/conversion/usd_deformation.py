"""What deforms a mesh in USD and cannot be said in glTF, with how far it moves points.

Source: UsdSkelSkinningQuery, which takes weights as they are; glTF 2.0, 3.7.3.1: weights sum to 1.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from rigtri.evaluation.skinning import sums_to_one
from rigtri.formats.usd.composition.value_types import vectors
from rigtri.formats.usd.reading.mesh_reader import at_start
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.mesh import Mesh


def lost_deformations(mesh: Mesh, shapes: Sequence[Any]) -> Iterator[str]:
    """What glTF cannot say of the skinning and the blend shapes (UsdSkelBlendShape) of a mesh."""
    if mesh.dual_quaternion:
        yield f"dual-quaternion skinning of mesh {mesh.name}: it is skinned linearly"
    elif not sums_to_one(mesh):
        yield (
            f"weights of mesh {mesh.name} that do not sum to 1, which UsdSkel takes as they are: "
            "they are scaled to sum to 1"
        )
    if any(shape.GetInbetweens() for shape in shapes):
        far, size = max(map(_beside_the_line, shapes)), _diagonal(mesh.points)
        yield (
            f"inbetweens of blend shapes of mesh {mesh.name}: at their weights they move points up to "
            f"{far / size if size else far:.2g} of the mesh's size, which is not in the deviation"
        )


def _beside_the_line(shape: Any) -> float:
    """How far inbetweens are from the straight way to their target, at most: there they are farthest."""
    whole = vectors(at_start(shape.GetOffsetsAttr()))
    most = 0.0
    for one in shape.GetInbetweens():
        offsets, weight = vectors(one.GetOffsets()), one.GetWeight()
        if len(offsets) == len(whole) and len(whole) and weight is not None:
            most = max(most, float(length(offsets - weight * whole).max()))
    return most


def _diagonal(points: Floats) -> float:
    return float(length(points.max(axis=0) - points.min(axis=0)))
