"""Primitives as prims: one Mesh for each, as each has points, morph targets and a material of its own.

GeomSubsets of one Mesh would need the points of all primitives in one array, and no way back to who had
which. Source: UsdGeomMesh, UsdGeomPrimvarsAPI, UsdSkelBindingAPI, UsdSkelBlendShape.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pxr import Sdf, UsdGeom, UsdSkel, Vt

from rigtri.evaluation.skinning import normalised_weights
from rigtri.export.conversion import usd_values as values
from rigtri.export.conversion.scene import Primitive, Scene
from rigtri.export.conversion.usd_materials import primvar
from rigtri.export.conversion.usd_names import Names
from rigtri.maths.arrays import Integers
from rigtri.maths.trigonometry import Floats
from rigtri.model.mesh import Mesh, Surface
from rigtri.text import is_number

_TYPES, _TOKENS = Sdf.ValueTypeNames, UsdGeom.Tokens
# Primvars that mean something to UsdGeom, and the last word that none may have.
_TAKEN = ("normals", "tangents", "displayColor", "displayOpacity", "widths", "indices")


def triangles(surface: Surface) -> Integers | None:
    """Corners of triangles, (3·f,); None for lines and points."""
    corners = surface.corners
    if surface.kind == "triangles":
        return corners[: len(corners) // 3 * 3]
    if len(corners) < 3:
        return None
    first, second, third = corners[:-2], corners[1:-1], corners[2:]
    if surface.kind == "triangle fan":
        apex = np.broadcast_to(corners[0], third.shape)
        return np.stack([second, third, apex], axis=1).reshape(-1)
    if surface.kind == "triangle strip":
        odd = np.arange(len(first)) % 2 == 1
        turned = np.where(odd, third, second), np.where(odd, second, third)
        return np.stack([first, *turned], axis=1).reshape(-1)
    return None


def _in_order(primitive: Primitive) -> bool:
    """Whether each point is used once, one after the other."""
    return np.array_equal(primitive.surface.corners, np.arange(len(primitive.mesh.points)))


def define(stage: Any, path: str, primitive: Primitive, scene: Scene, *, double_sided: bool) -> Any:
    """The prim of a primitive with its points and what they have; None for what cannot be said."""
    mesh, surface = primitive.mesh, primitive.surface
    faces = triangles(surface)
    if faces is not None:
        prim = UsdGeom.Mesh.Define(stage, path)
        prim.CreateFaceVertexCountsAttr(values.integers(np.full(len(faces) // 3, 3)))
        prim.CreateFaceVertexIndicesAttr(values.integers(faces))
        prim.CreateSubdivisionSchemeAttr(_TOKENS.none)
        prim.CreateDoubleSidedAttr(double_sided)
    elif surface.kind == "points":
        prim = UsdGeom.Points.Define(stage, path)
    elif surface.kind in ("line strip", "line loop") and _in_order(primitive):
        prim = UsdGeom.BasisCurves.Define(stage, path)
        prim.CreateTypeAttr(_TOKENS.linear)
        prim.CreateWrapAttr(_TOKENS.periodic if surface.kind == "line loop" else _TOKENS.nonperiodic)
        prim.CreateCurveVertexCountsAttr(values.integers([len(mesh.points)]))
    else:
        scene.lose(f"mesh {mesh.name}: {surface.kind} that share points")
        return None
    prim.CreatePointsAttr(values.vectors(mesh.points))
    finite = mesh.points[np.isfinite(mesh.points).all(axis=1)]
    if len(finite):
        prim.CreateExtentAttr(values.vectors(np.stack([finite.min(axis=0), finite.max(axis=0)])))
    if len(surface.normals) == len(mesh.points):
        normals = UsdGeom.PrimvarsAPI(prim).CreatePrimvar("normals", _TYPES.Normal3fArray, _TOKENS.vertex)
        normals.Set(values.vectors(surface.normals))
    _attributes(prim, mesh, surface, scene)
    return prim


def _attributes(prim: Any, mesh: Mesh, surface: Surface, scene: Scene) -> None:
    """Texture coordinates, colours, and what else points have."""
    primvars, each = UsdGeom.PrimvarsAPI(prim), _TOKENS.vertex
    own = Names([*_TAKEN, *map(primvar, range(len(surface.values)))])
    for name, found in surface.values.items():
        kind, _, number = name.partition("_")
        if kind == "TEXCOORD" and is_number(number):
            upwards = np.stack([found[:, 0], 1.0 - found[:, 1]], axis=1)
            made = primvars.CreatePrimvar(primvar(int(number)), _TYPES.TexCoord2fArray, each)
            made.Set(values.vectors(upwards))
        elif name == "COLOR_0":
            primvars.CreatePrimvar("displayColor", _TYPES.Color3fArray, each).Set(
                values.vectors(found[:, :3])
            )
            if found.shape[1] == 4:
                opacity = primvars.CreatePrimvar("displayOpacity", _TYPES.FloatArray, each)
                opacity.Set(values.floats(found[:, 3]))
        elif name == "TANGENT":
            tangents = primvars.CreatePrimvar("tangents", _TYPES.Float4Array, each)
            tangents.Set(Vt.Vec4fArray.FromNumpy(np.ascontiguousarray(found, dtype=np.float32)))
        elif " of morph target " not in name:
            word = own.unique(name.lstrip("_"), "attribute")
            if word not in (name, name.lstrip("_")):
                scene.lose(f"mesh {mesh.name}: the name of {name}, which is {word} now")
            made = primvars.CreatePrimvar(word, _TYPES.FloatArray, each, found.shape[1])
            made.Set(values.floats(found))
        elif not name.startswith("NORMAL of "):
            scene.lose(f"mesh {mesh.name}: {name.partition(' of ')[0]} of morph targets")


def bind(prim: Any, skeleton: str, geom_bind: Floats) -> None:
    """Let a skeleton move a prim."""
    binding = UsdSkel.BindingAPI.Apply(prim.GetPrim())
    binding.CreateSkeletonRel().SetTargets([skeleton])
    binding.CreateGeomBindTransformAttr(values.matrix(geom_bind))


def influence(prim: Any, joints: Integers, weights: Floats) -> None:
    """Which joints move the points of a prim: rows of its skeleton, (v, k), or (1, 1) where one moves all."""
    binding = UsdSkel.BindingAPI.Apply(prim.GetPrim())
    constant, width = len(joints) == 1, joints.shape[1]
    binding.CreateJointIndicesPrimvar(constant, width).Set(values.integers(joints))
    binding.CreateJointWeightsPrimvar(constant, width).Set(values.floats(weights))


def influences(mesh: Mesh, rows: Integers) -> tuple[Integers, Floats]:
    """Rows of the skeleton and weights that sum to 1, (v, k), without columns that nobody uses.

    rows: those of the skin's joints. UsdSkel takes weights as they are, glTF's are scaled to sum to 1.
    """
    weights = normalised_weights(mesh.weights)
    used = (weights != 0).any(axis=0)
    used[:1] = True
    return rows[mesh.joints[:, used]], weights[:, used]


def blend_shapes(stage: Any, prim: Any, mesh: Mesh, surface: Surface, tokens: list[str]) -> None:
    """The morph targets of a mesh as BlendShape prims below it, ``tokens``, with their names."""
    paths = []
    for k, (token, offsets) in enumerate(zip(tokens, mesh.morphs, strict=True)):
        normals = surface.values.get(f"NORMAL of morph target {k}")
        moved = (offsets != 0).any(axis=1)
        if normals is not None:
            moved |= (normals != 0).any(axis=1)
        rows = np.flatnonzero(moved)
        shape = UsdSkel.BlendShape.Define(stage, f"{prim.GetPath()}/{token}")
        shape.CreateOffsetsAttr(values.vectors(offsets[rows]))
        # Without indices the offsets are of all points, so none at all would be as many too few.
        if len(rows) < len(offsets):
            shape.CreatePointIndicesAttr(values.integers(rows))
        if normals is not None:
            shape.CreateNormalOffsetsAttr(values.vectors(normals[rows]))
        if k < len(mesh.morph_names) and mesh.morph_names[k] not in ("", token):
            shape.GetPrim().SetDisplayName(mesh.morph_names[k])
        paths.append(shape.GetPath())
    binding = UsdSkel.BindingAPI.Apply(prim.GetPrim())
    binding.CreateBlendShapesAttr(Vt.TokenArray(tokens))
    binding.CreateBlendShapeTargetsRel().SetTargets(paths)
