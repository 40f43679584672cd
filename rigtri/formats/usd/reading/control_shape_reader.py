"""The lines of control shapes, read from the BasisCurves below their prims.

Source: UsdGeomBasisCurves (linear, wrap).
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

import numpy as np
from pxr import UsdGeom

from rigtri.formats.usd.reading.node_keys import kind, parts
from rigtri.model.control_shapes import Lines, Shape

# The name of the curves below the prim of a control.
NAME = "shape"


def read_lines(stage: Any, key: Hashable) -> Lines | None:
    """The lines of the curves of rigtri below the prim of a key; None where there is anything else."""
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
