"""Transforms of prims as translate, orient and scale ops, still or moved by tracks.

Source: UsdGeomXformable, "Xform ops" and `xformOpOrder`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np
from pxr import Gf, Sdf

from rigtri.formats.usd.opinions.edits import Setting, set_tokens, set_value
from rigtri.formats.usd.reading.xform_hierarchy import OPS
from rigtri.maths.matrices import decompose_flat
from rigtri.maths.quaternions import IDENTITY, norm, unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Path, Track

# The types of ops that are new, and how values of those that are there are made.
OP_TYPES: Mapping[Path, Any] = {
    "translation": Sdf.ValueTypeNames.Double3,
    "rotation": Sdf.ValueTypeNames.Quatd,
    "scale": Sdf.ValueTypeNames.Double3,
}
# The rotation of a control that nobody has turned: what animators key.
EULER = "xformOp:rotateXYZ"
# The word in an order of ops with which a prim does not follow what is above it.
RESET = "!resetXformStack!"
_VECTORS = {"double3": Gf.Vec3d, "float3": Gf.Vec3f, "half3": Gf.Vec3h}
_QUATERNIONS = {"quatd": (Gf.Quatd, Gf.Vec3d), "quatf": (Gf.Quatf, Gf.Vec3f), "quath": (Gf.Quath, Gf.Vec3h)}
_FLOAT_TYPES = ("float3", "quatf")
# Two rotations that differ by less are one that went through a few products.
SAME_ROTATION = 1e-12
# What a division in float64, and what float32, leaves of a length of 1.
_ROUNDED, _FLOAT32 = 1e-15, 1e-6


def op_value(type_name: Any, row: Floats) -> Any:
    """A row as a value of an op's type, quaternions from xyzw."""
    if str(type_name) in _VECTORS:
        return _VECTORS[str(type_name)](*row.tolist())
    quaternion, vector = _QUATERNIONS[str(type_name)]
    return quaternion(float(row[3]), vector(*row[:3].tolist()))


def stated_types(prim: Any, edited: Any | None) -> dict[str, Any]:
    """The types of ops that weaker layers state, by name: an opinion of another type contradicts them.

    edited: the layer that gets the opinions, which may change its own types. Half floats are too coarse.
    """
    found: dict[str, Any] = {}
    for name in OPS.values():
        attribute = prim.GetAttribute(name)
        stack = attribute.GetPropertyStack() if attribute else ()
        stated = [spec.typeName for spec in stack if spec.layer != edited]
        if stated and str(stated[0]) in _FLOAT_TYPES:
            found[name] = stated[0]
    return found


def after_reset(order: Sequence[str]) -> int:
    """Where the ops of an order begin that USD applies: none counts before a reset."""
    return max((k for k, name in enumerate(order, 1) if name == RESET), default=0)


def stands_by(local: Floats) -> dict[Path, Floats]:
    """Translation, rotation and scale that make a local matrix, (4, 4); no rotation where no axes say one."""
    translation, rotation, scale = decompose_flat(local)
    rotation = rotation if np.isfinite(rotation).all() else IDENTITY
    return dict(zip(OPS, (translation, rotation, scale), strict=True))


def transform_ops(rows: Mapping[Path, Floats]) -> list[str]:
    """The ops that `set_transform` writes, in order: those that are not the identity, translate always.

    rows: as `stands_by` has them.
    """
    rotation, scale = rows["rotation"], rows["scale"]
    order = ["xformOp:translate"]
    order += ["xformOp:orient"] if np.abs(rotation[:3]).max() > SAME_ROTATION else []
    return order + (["xformOp:scale"] if np.abs(scale - 1.0).max() > SAME_ROTATION else [])


def op_samples(track: Track | None, type_name: Any) -> dict[float, Any]:
    """The keys of a track as values of its op; none without a track."""
    if track is None:
        return {}
    rows = _unit_rotations(track.values) if track.path == "rotation" else track.values
    return {time: op_value(type_name, row) for time, row in zip(track.times.tolist(), rows, strict=True)}


def _unit_rotations(rotations: Floats) -> Floats:
    """Rotations, (k, 4), that are unit; those that were keep their bits, and those that never were.

    USD takes the angle from w alone: in a small rotation, what float32 has rounded off a unit w is much.
    """
    off = np.abs(norm(rotations) - 1.0)
    rounded = (off > _ROUNDED) & (off <= _FLOAT32)
    return np.where(rounded[:, np.newaxis], unit(rotations), rotations)


def set_transform(
    path: Any,
    local: Floats,
    tracks: Sequence[Track] = (),
    *,
    to_key: bool = False,
    resets: bool = False,
    types: Mapping[str, Any] = MappingProxyType({}),
    sampled: Collection[Path] = (),
) -> list[Setting]:
    """Edits that put a prim at a local matrix by translate, orient and scale ops, and move it by tracks.

    resets: the prim does not follow what is above it. sampled: what of it has samples and no default.
    to_key: there are all three, for an animator to key; the rotation is Euler angles where it is still zero.
    types: those of ops by name, where they are others than `OP_TYPES`.
    """
    rows = stands_by(local)
    moved = {track.path: track for track in tracks}
    stands = {*transform_ops(rows), *(OPS[path] for path in moved)}
    order = {path: name for path, name in OPS.items() if to_key or name in stands}
    if OPS["scale"] not in stands:  # what a product has left of 1
        rows["scale"] = np.ones(3)
    still: list[Setting] = []
    if to_key and order["rotation"] not in stands:
        order["rotation"], double3 = EULER, OP_TYPES["scale"]
        still = [set_value(path, EULER, double3, op_value(double3, np.zeros(3)), alone=True)]
    names = set_tokens(path, "xformOpOrder", [*([RESET] if resets else []), *order.values()])
    ops = {p: o for p, o in order.items() if o != EULER}
    return [*_ops(path, rows, moved, ops, types, sampled), *still, names]


def _ops(
    path: Any,
    rows: Mapping[Path, Floats],
    moved: Mapping[Path, Track],
    order: Mapping[Path, str],
    types: Mapping[str, Any],
    sampled: Collection[Path],
) -> list[Setting]:
    found = []
    for prop, name in order.items():
        type_name = types.get(name, OP_TYPES[prop])
        value = None if prop in sampled else op_value(type_name, rows[prop])
        samples = op_samples(moved.get(prop), type_name)
        found.append(set_value(path, name, type_name, value, samples=samples, alone=True))
    return found
