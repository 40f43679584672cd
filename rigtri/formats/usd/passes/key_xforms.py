"""Key prims that are not rigtri's: time samples of their ops, as far as their stacks allow.

A stack of translate, orient and scale holds what tracks hold. Another one that stands still is
replaced by these; one that moves goes between its keys in ways that no track has.

Source: UsdGeomXformable, "Xform ops" and `xformOpOrder`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pxr import Gf, Sdf, UsdGeom

from rigtri.errors import FileError
from rigtri.evaluation.timelines import without_steps
from rigtri.formats.usd.composition.stage import tokens_of, why_locked
from rigtri.formats.usd.opinions.edits import Edit, set_tokens, set_value
from rigtri.formats.usd.opinions.xform_edits import OPS, set_transform, transform_ops, unit_rotations
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.source import Source
from rigtri.maths.matrices import SKEW, decompose, skew
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Path, Track
from rigtri.model.rig import Rig

_RESET = "!resetXformStack!"
_TYPES = Sdf.ValueTypeNames
_NEW = {"translation": _TYPES.Double3, "rotation": _TYPES.Quatd, "scale": _TYPES.Double3}
_VECTORS = {"double3": Gf.Vec3d, "float3": Gf.Vec3f, "half3": Gf.Vec3h}
_TURNS = {"quatd": (Gf.Quatd, Gf.Vec3d), "quatf": (Gf.Quatf, Gf.Vec3f), "quath": (Gf.Quath, Gf.Vec3h)}


def key_xforms(edit: UsdEdit) -> None:
    """Write the new keys of prims that are not rigtri's. FileError where the ops of one take none."""
    tracks = edit.changes.prim_tracks
    for node in dict.fromkeys(track.node for track in tracks):
        mine = {track.path: _linear(edit.rig, track) for track in tracks if track.node == node}
        edit.values += _prim_edits(edit.source, edit.rig, node, mine)


def _linear(rig: Rig, track: Track) -> Track:
    if track.interpolation == "CUBICSPLINE" and len(track.times) > 1:
        raise FileError(f"<{rig.labels[track.node]}> moves by splines, which USD has none of here.")
    return without_steps(track)


def _prim_edits(source: Source, rig: Rig, node: int, tracks: dict[Path, Track]) -> list[Edit]:
    prim, path = source.stage.GetPrimAtPath(rig.labels[node]), Sdf.Path(rig.labels[node])
    order = list(tokens_of(prim, "xformOpOrder"))
    resets = [_RESET] if order[:1] == [_RESET] else []
    ops = order[len(resets) :]
    if why := why_locked(prim, ("xformOpOrder", *ops, *OPS.values())):
        raise FileError(f"{why}.")
    moved = bool((source.rig.local[node] != rig.local[node]).any())
    if ops == [name for name in OPS.values() if name in ops]:
        return _into_stack(prim, rig.local[node] if moved else None, tracks, resets, ops)
    still = not UsdGeom.Xformable(prim).TransformMightBeTimeVarying()
    if not (still or len(tracks) == len(OPS)) or skew(rig.local[node]) >= SKEW:
        shown = ", ".join(ops)
        raise FileError(
            f"<{path}> stands by {shown}, which cannot take keys. Give it the ops xformOp:translate, "
            "xformOp:orient and xformOp:scale, in this order."
        )
    names = transform_ops(rig.local[node])
    names = [*resets, *(name for p, name in OPS.items() if p in tracks or name in names)]
    return [
        *set_transform(path, rig.local[node], list(tracks.values())),
        set_tokens(path, "xformOpOrder", names),
    ]


def _into_stack(
    prim: Any, local: Floats | None, tracks: dict[Path, Track], resets: list[str], ops: list[str]
) -> list[Edit]:
    """Samples for the ops that have new tracks; new ops where they belong. local: a new rest, or None."""
    found: list[Edit] = []
    path = prim.GetPath()
    rest = {} if local is None else dict(zip(OPS, decompose(local), strict=True))
    stands = [] if local is None else transform_ops(local)
    names = [name for p, name in OPS.items() if name in ops or p in tracks or name in stands]
    for p, name in OPS.items():
        if name not in names or not (p in tracks or p in rest):
            continue
        type_name = prim.GetAttribute(name).GetTypeName() if name in ops else _NEW[p]
        track = tracks.get(p)
        rows = np.zeros((0, 4)) if track is None else track.values
        rows = unit_rotations(rows) if p == "rotation" else rows
        times = [] if track is None else track.times.tolist()
        values = {time: _value(type_name, row) for time, row in zip(times, rows, strict=True)}
        still = rest.get(p, None if name in ops else _NOTHING[p])
        default = None if still is None else _value(type_name, still)
        found.append(set_value(path, name, type_name, default, samples=values, alone=track is not None))
    return found if names == ops else [*found, set_tokens(path, "xformOpOrder", [*resets, *names])]


_NOTHING: dict[Path, Floats] = {
    "translation": np.zeros(3),
    "rotation": np.array([0.0, 0.0, 0.0, 1.0]),
    "scale": np.ones(3),
}


def _value(type_name: Any, row: Floats) -> Any:
    """A row as a value of an op's type, quaternions from xyzw."""
    if str(type_name) in _VECTORS:
        return _VECTORS[str(type_name)](*row.tolist())
    quaternion, vector = _TURNS[str(type_name)]
    return quaternion(float(row[3]), vector(*row[:3].tolist()))
