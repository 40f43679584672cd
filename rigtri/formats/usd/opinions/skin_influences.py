"""The influences of a mesh as stored: which joints move each point, and by how much.

Source: UsdSkel, SkelBindingAPI (`primvars:skel:jointIndices`, `primvars:skel:jointWeights`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from pxr import Sdf

from rigtri.errors import FixedWeightsError
from rigtri.formats.usd.composition.stage import DEFAULT, why_locked
from rigtri.formats.usd.opinions.edits import Declaration, Edit, binding_schema, set_value
from rigtri.formats.usd.opinions.joint_influences import INDICES, ORDER
from rigtri.maths.arrays import Integers
from rigtri.maths.trigonometry import Floats

WEIGHTS = "primvars:skel:jointWeights"
_OTHERWISE = "Leave the weights as they are"


def read_influences(query: Any, points: int) -> tuple[Integers, Floats] | None:
    """Joint indices and weights as stored, (v, k); None where UsdSkel has no use for them."""
    pair = query.ComputeVaryingJointInfluences(points, DEFAULT)
    width = max(query.GetNumInfluencesPerComponent(), 1)
    if not pair or len(pair[0]) != points * width:
        return None
    shape = (points, width)
    indices = np.array(pair[0], dtype=np.int64).reshape(shape)
    return indices, np.array(pair[1], dtype=np.float64).reshape(shape)


def check_editable(query: Any) -> None:
    """FixedWeightsError where the influences of a mesh cannot be written."""
    prim = query.GetPrim()
    why = why_locked(prim, (ORDER, INDICES, WEIGHTS))
    if why:
        raise FixedWeightsError(f"{why}. {_OTHERWISE}.")
    for primvar in (query.GetJointIndicesPrimvar(), query.GetJointWeightsPrimvar()):
        path = primvar.GetAttr().GetPath()
        if primvar.IsIndexed():
            raise FixedWeightsError(f"<{path}> is indexed, so its weights cannot be changed. {_OTHERWISE}.")
        if primvar.GetAttr().GetNumTimeSamples():
            raise FixedWeightsError(
                f"<{path}> has time samples, so its weights cannot be changed. {_OTHERWISE}."
            )


def set_influences(query: Any, joints: Integers, weights: Floats) -> list[Edit]:
    """The edits that give a mesh other influences, (v, k), in the types that it has.

    One that moves as a whole stays so: (1, k).
    """
    path = query.GetPrim().GetPath()
    interpolation = "constant" if query.IsRigidlyDeformed() else "vertex"
    edits = binding_schema(query.GetPrim())
    for name, primvar, rows in (
        (INDICES, query.GetJointIndicesPrimvar(), joints.astype(np.int32)),
        (WEIGHTS, query.GetJointWeightsPrimvar(), weights),
    ):
        attribute = primvar.GetAttr()
        stored = type(attribute.Get(DEFAULT))
        kind_of = np.array(attribute.Get(DEFAULT)).dtype
        value = stored.FromNumpy(np.ascontiguousarray(rows.reshape(-1).astype(kind_of)))
        edits.append(set_value(path, name, attribute.GetTypeName(), value))
        edits.append(_declared(path, name, {"elementSize": rows.shape[1], "interpolation": interpolation}))
    return edits


def _declared(path: Any, name: str, fields: Mapping[str, Any]) -> Edit:
    """Metadata of an attribute that an edit before has set."""

    def edit(layer: Any) -> None:
        spec = layer.GetAttributeAtPath(Sdf.Path(path).AppendProperty(name))
        for key, value in fields.items():
            if spec is not None and (not spec.HasInfo(key) or spec.GetInfo(key) != value):
                spec.SetInfo(key, value)

    return Declaration(Sdf.Path(path), edit, name, fields)
