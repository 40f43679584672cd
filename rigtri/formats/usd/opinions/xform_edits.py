"""Transforms of prims as translate, orient and scale ops, still or moved by tracks.

Source: UsdGeomXformable, "Xform ops" and `xformOpOrder`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pxr import Gf, Sdf

from rigtri.formats.usd.opinions.edits import Setting, set_tokens, set_value
from rigtri.formats.usd.reading.xform_hierarchy import OPS
from rigtri.maths.matrices import decompose
from rigtri.maths.quaternions import norm, unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track

# Two rotations that differ by less are one that went through a few products.
SAME_ROTATION = 1e-12
# What a division in float64 leaves of a length of 1.
_ROUNDED = 1e-15


def quaternion(q: Floats) -> Any:
    """xyzw as a Gf quaternion of doubles."""
    return Gf.Quatd(float(q[3]), Gf.Vec3d(*q[:3].tolist()))


def transform_ops(local: Floats) -> list[str]:
    """The ops that `set_transform` writes, in order: those that are not the identity, translate always."""
    _, rotation, scale = decompose(local)
    order = ["xformOp:translate"]
    order += ["xformOp:orient"] if np.abs(rotation[:3]).max() > SAME_ROTATION else []
    return order + (["xformOp:scale"] if np.abs(scale - 1.0).max() > SAME_ROTATION else [])


def _samples(track: Track | None) -> dict[float, Any]:
    """The keys of a track as values of its op; none without a track."""
    if track is None:
        return {}
    values = unit_rotations(track.values) if track.path == "rotation" else track.values
    rows = zip(track.times.tolist(), values, strict=True)
    return {
        time: quaternion(row) if track.path == "rotation" else Gf.Vec3d(*row.tolist()) for time, row in rows
    }


def unit_rotations(rotations: Floats) -> Floats:
    """Rotations, (k, 4), that are unit; those that were keep their bits.

    USD takes the angle from w alone: in a small rotation, what float32 has rounded off a unit w is much.
    """
    off = np.abs(norm(rotations) - 1.0) > _ROUNDED
    return np.where(off[:, np.newaxis], unit(rotations), rotations)


def set_transform(path: Any, local: Floats, tracks: Sequence[Track] = ()) -> list[Setting]:
    """Edits that put a prim at a local matrix by translate, orient and scale ops, and move it by tracks."""
    translation, rotation, scale = decompose(local)
    types = Sdf.ValueTypeNames
    values = {
        "xformOp:translate": (types.Double3, Gf.Vec3d(*translation.tolist())),
        "xformOp:orient": (types.Quatd, quaternion(rotation)),
        "xformOp:scale": (types.Double3, Gf.Vec3d(*scale.tolist())),
    }
    moved = {OPS[track.path]: track for track in tracks}
    order = [name for name in values if name in moved or name in transform_ops(local)]
    edits = [
        set_value(path, name, *values[name], samples=_samples(moved.get(name)), alone=True) for name in order
    ]
    return [*edits, set_tokens(path, "xformOpOrder", order)]
