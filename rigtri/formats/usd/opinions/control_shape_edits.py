"""Control shapes as BasisCurves below the prims that they show.

The curves alone are a guide: with that purpose on the control itself Blender's import
would drop the control with its attributes.

Source: UsdGeomBasisCurves (linear, wrap), UsdGeomImageable purpose.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pxr import Gf, Sdf, UsdGeom, Vt

from rigtri.formats.usd.opinions.edits import Edit, define, set_value
from rigtri.model.control_shapes import Shape


def define_curves(path: Any, shape: Shape) -> list[Edit]:
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
