"""The lines of control shapes, read from the BasisCurves below their prims.

Source: UsdGeomBasisCurves (linear, wrap).
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

import numpy as np
from pxr import UsdGeom

from rigtri.formats.usd.composition.stage import quiet
from rigtri.formats.usd.composition.value_types import integers, vectors
from rigtri.formats.usd.reading.metadata_attributes import is_drawing
from rigtri.formats.usd.reading.node_keys import kind, parts
from rigtri.model.control_shapes import Lines, Shape
from rigtri.model.rig import DRAWING


def curves_of(prim: Any) -> Any:
    """The BasisCurves below the prim of a control; None where it has none."""
    children = prim.GetChildren() if prim else ()
    return next((one for one in children if is_drawing(one.GetTypeName(), one.GetName())), None)


def curves_name(control: str) -> str:
    """What new curves of a control are called: Blender gives a control with nothing else their name."""
    return f"{control}_{DRAWING}"


def read_lines(stage: Any, key: Hashable) -> Lines | None:
    """The lines of the curves of rigtri below the prim of a key; None where there is anything else."""
    if kind(key) != "prim":
        return None
    prim = curves_of(stage.GetPrimAtPath(parts(key)[1]))
    if prim is None:
        return None
    with quiet(f"<{prim.GetPath()}>: USD cannot read where it stands"):
        if UsdGeom.Xformable(prim).GetOrderedXformOps():
            return None
    curves = UsdGeom.BasisCurves(prim)
    colors = vectors(curves.GetDisplayColorAttr().Get())
    points = vectors(curves.GetPointsAttr().Get())
    counts = integers(curves.GetCurveVertexCountsAttr().Get())
    straight = (
        curves.GetTypeAttr().Get() == "linear" and (counts > 1).all() and sum(counts.tolist()) == len(points)
    )
    if len(colors) != 1 or not len(counts) or not straight:
        return None
    strips = tuple(np.split(points, np.cumsum(counts)[:-1]))
    color = tuple(colors[0].tolist())
    closed = curves.GetWrapAttr().Get() == "periodic"
    return Lines(Shape("", strips, closed, (0.0, 0.0, 0.0)).segments, color)
