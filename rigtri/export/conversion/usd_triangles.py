"""A Mesh prim as triangles of glTF: points with all their values, and the faces of each material.

What faces or corners have is given to points: one that has several of them becomes several points.
Source: UsdGeomMesh, UsdGeomPrimvar (interpolation), UsdGeomSubset; glTF 2.0 §3.7.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from pxr import UsdGeom, UsdShade

from rigtri.export.conversion.polygons import ears, turned_over
from rigtri.formats.usd.composition.value_types import integers, vectors
from rigtri.formats.usd.reading.mesh_reader import at_start, flattened
from rigtri.maths.arrays import Integers
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross
from rigtri.model.dataclass import dataclass
from rigtri.model.mesh import Mesh

# Texture coordinates by any of the names that programs give them, in their order: st, st1, UVMap …
_COORDINATES = ("texCoord2f[]", "float2[]", "texCoord2d[]", "double2[]", "half2[]", "texCoord2h[]")
FAMILY = "materialBind"


@dataclass(frozen=True, eq=False)
class Faces:
    """points: for each point of the result the one of the prim that it is, (v,). triangles: (3·f,).

    face: the face of the prim that each triangle is of, (f,). values: by glTF's names, (v, c). coordinates:
    the number of each set of texture coordinates, by its primvar.
    """

    points: Integers
    triangles: Integers
    face: Integers
    values: dict[str, Floats]
    coordinates: dict[str, int]


def read_faces(prim: Any, count: int, lose: Any) -> Faces | None:
    """The faces of a Mesh of ``count`` points; None where they make no sense."""
    mesh = UsdGeom.Mesh(prim)
    sizes = integers(at_start(mesh.GetFaceVertexCountsAttr()))
    corners = integers(at_start(mesh.GetFaceVertexIndicesAttr()))
    whole = len(sizes) and int(sizes.min()) >= 0 and int(np.add.reduce(sizes)) == len(corners)
    if not whole or int(corners.min(initial=0)) < 0 or int(corners.max(initial=0)) >= count:
        return None
    if mesh.GetSubdivisionSchemeAttr().Get() != UsdGeom.Tokens.none and (sizes > 3).any():
        lose(f"the subdivision of mesh {prim.GetPath()}: its cage is written")
    given, coordinates = _values(prim, lose)
    face_of = np.repeat(np.arange(len(sizes)), sizes)
    rows: list[Floats] = [corners[:, np.newaxis].astype(np.float64)]
    spread: dict[str, Floats] = {}
    for name, (values, interpolation) in given.items():
        each = _by_corner(values, interpolation, corners, face_of, (count, len(sizes)))
        if each is None:
            lose(f"{name} of mesh {prim.GetPath()}, which is not one for each {interpolation}")
            continue
        spread[name] = each
        if interpolation in ("faceVarying", "uniform"):
            rows.append(each)
    points, index, first = np.arange(count), corners, None
    if len(rows) > 1:
        _, first, index = np.unique(
            np.concatenate(rows, axis=1), axis=0, return_index=True, return_inverse=True
        )
        index = index.reshape(-1)
        points = corners[first]
    else:
        first = np.zeros(count, dtype=np.int64)
        first[corners] = np.arange(len(corners))
    flipped = mesh.GetOrientationAttr().Get() == "leftHanded"
    places = vectors(at_start(mesh.GetPointsAttr()))[corners]
    triangles, face = _triangulated(sizes, index, places, flipped=flipped)
    return Faces(points, triangles, face, {name: each[first] for name, each in spread.items()}, coordinates)


def _triangulated(
    sizes: Integers, index: Integers, places: Floats, *, flipped: bool
) -> tuple[Integers, Integers]:
    """Triangles, (3·f,), and the face that each is of, (f,): fans, and ears where a fan would leave the face.

    places: of corners, (c, 3).
    """
    starts = np.cumsum(sizes) - sizes
    many = np.maximum(sizes - 2, 0)
    face = np.repeat(np.arange(len(sizes)), many)
    number = np.arange(len(face)) - np.repeat(np.cumsum(many) - many, many)
    first = starts[face]
    second, third = first + number + 1, first + number + 2
    normals = cross(places[second] - places[first], places[third] - places[first])
    whole = np.zeros((len(sizes), 3))
    np.add.at(whole, face, normals)
    rows = np.stack([first, second, third], axis=1)
    for concave in np.unique(face[turned_over(normals, whole[face])]):
        start = starts[concave]
        cut = ears(places[start : start + sizes[concave]], whole[concave])
        if cut is not None:
            rows[face == concave] = start + cut
    return index[rows[:, [0, 2, 1]] if flipped else rows].reshape(-1), face


def _values(prim: Any, lose: Any) -> tuple[dict[str, tuple[Floats, str]], dict[str, int]]:
    """What of a mesh glTF has words for, with how it is spread; and texture coordinates by number."""
    found: dict[str, tuple[Floats, str]] = {}
    coordinates: dict[str, int] = {}
    normals = UsdGeom.Mesh(prim).GetNormalsAttr()
    rows = vectors(at_start(normals))
    if len(rows):
        found["NORMAL"] = rows, str(UsdGeom.Mesh(prim).GetNormalsInterpolation())
    for primvar in UsdGeom.PrimvarsAPI(prim).FindPrimvarsWithInheritance():
        name, kind = str(primvar.GetPrimvarName()), str(primvar.GetTypeName())
        if name.startswith("skel:"):
            continue
        value = flattened(primvar)
        if value is None and primvar.HasAuthoredValue():
            lose(f"primvar {name} of mesh {prim.GetPath()}, whose indices and values do not fit")
        if value is None or not hasattr(value, "__len__") or not len(value):
            continue
        spread = str(primvar.GetInterpolation())
        if name == "normals":
            found["NORMAL"] = vectors(value), spread
        elif kind in _COORDINATES:
            rows = np.array(value, dtype=np.float64)
            coordinates[name] = len(coordinates)
            turned = np.stack([rows[:, 0], 1.0 - rows[:, 1]], axis=1)
            found[f"TEXCOORD_{coordinates[name]}"] = turned, spread
        elif name == "displayColor":
            if spread != "constant":  # the colour of a whole mesh is its material's: see `colour_of`
                found["COLOR_0"] = vectors(value), spread
        elif name == "tangents" and kind == "float4[]":
            found["TANGENT"] = np.array(value, dtype=np.float64), spread
        elif name != "displayOpacity" or spread != "constant":
            lose(f"primvar {name} of meshes")
    return found, coordinates


def _by_corner(
    values: Floats, spread: str, corners: Integers, face: Integers, counts: tuple[int, int]
) -> Floats | None:
    """A value for each corner; None where they are not as many as they should be, or spread in no known way.

    counts: of points and faces.
    """
    ways = {
        "constant": (1, np.zeros(len(corners), dtype=np.int64)),
        "uniform": (counts[1], face),
        "vertex": (counts[0], corners),
        "varying": (counts[0], corners),
        "faceVarying": (len(corners), np.arange(len(corners))),
    }
    many, index = ways.get(spread, (-1, corners))
    return values[index] if len(values) == many else None


def materials_of(prim: Any, count: int) -> list[tuple[Any, Integers]]:
    """The materials of a Mesh of ``count`` faces, None for none, each with its faces."""
    left = np.ones(count, dtype=bool)
    found: list[tuple[Any, Integers]] = []
    for subset in UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets():
        faces = integers(at_start(subset.GetIndicesAttr()))
        faces = faces[(faces >= 0) & (faces < count)]
        faces = faces[left[faces]]
        left[faces] = False
        if len(faces):
            found.append((_bound(subset.GetPrim()), np.sort(faces)))
    if left.any():
        found.append((_bound(prim), np.flatnonzero(left)))
    return found


def colour_of(prim: Any) -> tuple[float, ...] | None:
    """Colour and opacity in which a whole Mesh without a material is drawn; None where neither is said."""
    found: dict[str, list[float]] = {}
    for name in ("displayColor", "displayOpacity"):
        primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
        value = flattened(primvar) if primvar else None
        if value is None or not hasattr(value, "__len__") or len(value) != 1:
            continue
        if primvar.GetInterpolation() == "constant":
            found[name] = np.array(value[0], dtype=np.float64).reshape(-1).tolist()
    if not found:
        return None
    return (*found.get("displayColor", (1.0, 1.0, 1.0)), *found.get("displayOpacity", (1.0,)))


def _bound(prim: Any) -> Any:
    """The material that viewers show a prim with: for previews, else for all, else for full renders."""
    for purpose in (UsdShade.Tokens.preview, UsdShade.Tokens.full):  # each or what is for all purposes
        material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial(purpose)
        if material:
            return material
    return None


def with_points(mesh: Mesh, faces: Faces) -> Mesh:
    """The mesh with the points that glTF needs."""
    rows = faces.points
    if np.array_equal(rows, np.arange(len(mesh.points))):
        return mesh
    return replace(
        mesh,
        points=mesh.points[rows],
        joints=mesh.joints[rows] if len(mesh.joints) else mesh.joints,
        weights=mesh.weights[rows] if len(mesh.weights) else mesh.weights,
        morphs=mesh.morphs[:, rows] if mesh.morphs.size else mesh.morphs,
        surface=None,
    )
