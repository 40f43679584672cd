"""The types that UsdSkel reads attributes as; of another type it reads nothing.

UsdSkel reads exactly one C++ type each: ``double3[]`` translations make it ignore the
whole animation. Roles (point3f, frame4d) are the same type. Measured with UsdSkel.BakeSkinning.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from pxr import Sdf

from rigtri.errors import FileError
from rigtri.maths.arrays import Integers
from rigtri.maths.trigonometry import Floats

_NAMES = Sdf.ValueTypeNames
INDICES, WEIGHTS = "primvars:skel:jointIndices", "primvars:skel:jointWeights"
BIND = "primvars:skel:geomBindTransform"


class Expected(NamedTuple):
    """The type that UsdSkel reads, and what another one means to it."""

    type: Any
    lost: str


_ANIMATION = "the whole animation is ignored but for its blend shapes"
_SKIN = "the prim is not skinned"
TYPES: Mapping[str, Expected] = {
    "joints": Expected(_NAMES.TokenArray, "there are no joints"),
    "bindTransforms": Expected(_NAMES.Matrix4dArray, "there is no bind pose and no skinning"),
    "restTransforms": Expected(_NAMES.Matrix4dArray, "there is no rest pose"),
    "translations": Expected(_NAMES.Float3Array, _ANIMATION),
    "rotations": Expected(_NAMES.QuatfArray, _ANIMATION),
    "scales": Expected(_NAMES.Half3Array, _ANIMATION),
    "blendShapes": Expected(_NAMES.TokenArray, "no blend shape is driven"),
    "blendShapeWeights": Expected(_NAMES.FloatArray, "no blend shape is driven"),
    "skel:joints": Expected(_NAMES.TokenArray, "indices count the joints of the skeleton"),
    "skel:blendShapes": Expected(_NAMES.TokenArray, "the prim has no blend shapes"),
    INDICES: Expected(_NAMES.IntArray, _SKIN),
    WEIGHTS: Expected(_NAMES.FloatArray, _SKIN),
    BIND: Expected(_NAMES.Matrix4d, "it counts as identity"),
    "xformOpOrder": Expected(_NAMES.TokenArray, "the prim has no ops"),
    "points": Expected(_NAMES.Float3Array, "the prim has no points"),
    "offsets": Expected(_NAMES.Float3Array, "the blend shape moves nothing"),
    "pointIndices": Expected(_NAMES.IntArray, "the offsets count as those of all points"),
}
# Attributes of bound prims; the other attributes are judged where they are read.
_BOUND = (INDICES, WEIGHTS, BIND, "points", "skel:joints", "skel:blendShapes")


class WrongTypeError(FileError):
    """An attribute has a type that UsdSkel does not read there."""


def wrong_type(name: str, value: Any) -> str:
    """What type a value has and should have, "" where UsdSkel reads it; ``name`` is one of TYPES."""
    expected, found = TYPES[name].type, Sdf.GetValueTypeNameForValue(value)
    if found.type == expected.type:
        return ""
    return f"{name} is {str(found) or 'of an unknown type'} and should be {expected}"


def demand(attribute: Any, value: Any) -> None:
    """WrongTypeError where UsdSkel does not read a value of an attribute."""
    why = wrong_type(attribute.GetName(), value)
    if why:
        text = f"<{attribute.GetPrimPath()}>.{why}; UsdSkel reads nothing else there. Export it again."
        raise WrongTypeError(text)


def usable(attribute: Any, value: Any) -> Any:
    """A value as UsdSkel sees it: None where its type is wrong."""
    return None if value is None or wrong_type(attribute.GetName(), value) else value


def integers(value: Any) -> Integers:
    """The integers of an attribute's value, (n,); none where it holds something else."""
    return np.array(_rows(value, "iu", 1), dtype=np.int64).reshape(-1)


def vectors(value: Any) -> Floats:
    """The vectors of an attribute's value, (n, 3); none where it holds something else."""
    return np.array(_rows(value, "iuf", 3), dtype=np.float64)


def _rows(value: Any, kinds: str, width: int) -> Any:
    """kinds: of numpy's types of numbers, those that count."""
    found = np.asarray(() if value is None else value)
    fits = found.dtype.kind in kinds and found.size % width == 0
    return (found if fits else np.zeros(0)).reshape(-1, width)


def ignored(prim: Any) -> list[str]:
    """What UsdSkel does not read of a prim that is bound to a skeleton, by the types in its layers."""
    found = []
    for name in _BOUND:
        attribute, (expected, lost) = prim.GetAttribute(name), TYPES[name]
        stack = attribute.GetPropertyStack() if attribute and attribute.HasAuthoredValue() else ()
        for spec in stack[:1]:
            if spec.typeName.type != expected.type:
                text = f"<{prim.GetPath()}>.{name} is {spec.typeName} and should be {expected}"
                found.append(f"{text}, so for UsdSkel {lost}. It is left as it is.")
    return found
