"""Control shapes as BasisCurves below the prims that they show.

The curves alone are a guide: with that purpose on the control itself Blender's import
would drop the control with its attributes.

Source: UsdGeomBasisCurves (linear, wrap), UsdGeomImageable purpose.
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

import numpy as np
from pxr import Gf, Sdf, UsdGeom, Vt

from rigtri.formats.usd.opinions.edits import Edit, define, kind, parts, set_value
from rigtri.model.control_shapes import Lines, Shape

NAME = "shape"


def drawing(path: Any, shape: Shape) -> list[Edit]:
    """Edits that define the curves of a shape at ``path``."""
    types = Sdf.ValueTypeNames
    points = Vt.Vec3fArray.FromNumpy(np.concatenate(shape.strips).astype(np.float32))
    counts = Vt.IntArray([len(strip) for strip in shape.strips])
    wrap = "periodic" if shape.closed else "nonperiodic"
    values: list[tuple[str, Any, Any, bool]] = [
        ("type", types.Token, "linear", True),
        ("wrap", types.Token, wrap, True),
        ("purpose", types.Token, "guide", True),
        ("curveVertexCounts", types.IntArray, counts, False),
        ("points", types.Point3fArray, points, False),
        ("extent", types.Float3Array, UsdGeom.PointBased.ComputeExtent(points), False),
        ("primvars:displayColor", types.Color3fArray, Vt.Vec3fArray([Gf.Vec3f(*shape.color)]), False),
    ]
    edits = [set_value(path, name, kind, value, uniform=uniform) for name, kind, value, uniform in values]
    return [define(path, "BasisCurves"), *edits]


def read_lines(stage: Any, key: Hashable) -> Lines | None:
    """The lines that `drawing` has drawn below the prim of a key; None where there is anything else."""
    if kind(key) != "prim":
        return None
    prim = stage.GetPrimAtPath(parts(key)[1]).GetChild(NAME)
    if not prim or prim.GetTypeName() != "BasisCurves" or UsdGeom.Xformable(prim).GetOrderedXformOps():
        return None
    curves = UsdGeom.BasisCurves(prim)
    colors: Any = curves.GetDisplayColorAttr().Get() or ()
    points = np.array(curves.GetPointsAttr().Get() or (), dtype=np.float64).reshape(-1, 3)
    counts = np.array(curves.GetCurveVertexCountsAttr().Get() or (), dtype=np.int64)
    straight = (
        curves.GetTypeAttr().Get() == "linear" and (counts > 1).all() and sum(counts.tolist()) == len(points)
    )
    if len(colors) != 1 or not len(counts) or not straight:
        return None
    strips = tuple(np.split(points, np.cumsum(counts)[:-1]))
    color = tuple(map(float, np.array(colors[0])))
    closed = curves.GetWrapAttr().Get() == "periodic"
    return Lines(Shape("", strips, closed, (0.0, 0.0, 0.0)).segments, color)
