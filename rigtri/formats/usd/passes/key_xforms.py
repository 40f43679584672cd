"""Key prims that are not rigtri's: time samples of their ops, as far as their stacks allow.

A stack of translate, orient and scale holds what tracks hold. Another one is replaced by these; what keeps
its keys goes along, as it was sampled where the prim was read (`reading.xform_hierarchy`).

Source: UsdGeomXformable, "Xform ops" and `xformOpOrder`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import refuse, tokens_of
from rigtri.formats.usd.opinions.edits import Edit, set_tokens, set_value
from rigtri.formats.usd.opinions.skeleton_edits import as_one, as_samples
from rigtri.formats.usd.opinions.variant_paths import why_unkeyable
from rigtri.formats.usd.opinions.xform_edits import (
    OP_TYPES,
    RESET,
    SAME_ROTATION,
    after_reset,
    op_samples,
    op_value,
    set_transform,
    stands_by,
    transform_ops,
)
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.mesh_reader import at_start
from rigtri.formats.usd.reading.sampled_xforms import can_scale
from rigtri.formats.usd.reading.source import Source
from rigtri.formats.usd.reading.xform_hierarchy import NOTHING, OPS, read_transform
from rigtri.maths.matrices import SKEW, decompose, skew
from rigtri.maths.quaternions import angle_between
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Path, Track
from rigtri.model.rig import Rig


def key_xforms(edit: UsdEdit) -> None:
    """Write the new keys of prims that are not rigtri's. FileError where the ops of one take none."""
    tracks = edit.changes.prim_tracks
    for node in dict.fromkeys(track.node for track in tracks):
        mine = as_one((track for track in tracks if track.node == node), f"<{edit.rig.labels[node]}>")
        edit.values += _prim_edits(edit.source, edit.rig, node, mine)


def _prim_edits(source: Source, rig: Rig, node: int, tracks: dict[Path, Track]) -> list[Edit]:
    prim, path = source.stage.GetPrimAtPath(rig.labels[node]), Sdf.Path(rig.labels[node])
    order = list(tokens_of(prim, "xformOpOrder"))
    start = after_reset(order)
    resets, ops = [RESET] if start else [], order[start:]
    refuse(why_unkeyable(prim))
    moved = bool((source.rig.local[node] != rig.local[node]).any())
    if ops == [name for name in OPS.values() if name in ops]:
        return _into_stack(prim, rig.local[node] if moved else None, tracks, resets, ops)
    xformable = UsdGeom.Xformable(prim)
    still = not xformable.TransformMightBeTimeVarying()
    if not still:  # what keeps its keys gets them in the new ops
        kept = (t for clip in rig.clips for t in clip.tracks if t.node == node and t.path in OPS)
        tracks = {t.path: as_samples(t, f"<{path}>") for t in kept} | tracks
    # What has no key stands still where tracks hold the ops.
    moves = {*OPS} if can_scale(xformable) else {*OPS} - {"scale"}
    whole = still or moves <= {*tracks} or read_transform(prim, node, "LINEAR") is not None
    if not whole or skew(rig.local[node]) >= SKEW:
        shown = ", ".join(ops)
        raise FileError(
            f"<{path}> stands by {shown}, which cannot take keys. Give it the ops xformOp:translate, "
            "xformOp:orient and xformOp:scale, in this order."
        )
    local, sampled = rig.local[node], _sampled(xformable, rig.local[node], tracks)
    return [*set_transform(path, local, list(tracks.values()), resets=bool(resets), sampled=sampled)]


def _sampled(xformable: Any, local: Floats, tracks: Mapping[Path, Track]) -> list[Path]:
    """What of a prim new ops have samples of, and no default, so that without time it stands as before.

    Ops without a default count for nothing there, and the prim rests at the first samples of all its ops.
    None where one of them would still stand elsewhere: half of its old place is no place.
    """
    without_time = np.array(xformable.GetLocalTransformation(Usd.TimeCode.Default()))
    if skew(without_time) >= SKEW:
        return []
    found: list[Path] = []
    for path, stands, rests in zip(OPS, decompose(without_time), decompose(local), strict=True):
        track = tracks.get(path)
        if track is not None and not _is_same(path, track.values[0], rests):
            return []
        if _is_same(path, stands, rests):
            continue
        stated = xformable.GetPrim().GetAttribute(OPS[path])  # an op that is out of use
        if (
            track is None
            or not _is_same(path, stands, NOTHING[path])
            or (stated and stated.Get() is not None)
        ):
            return []
        found.append(path)
    return found


def _is_same(path: Path, one: Floats, other: Floats) -> bool:
    if path == "rotation":
        return bool(angle_between(one, other) <= SAME_ROTATION)
    return bool((np.abs(one - other) <= SAME_ROTATION * np.maximum(1.0, np.abs(other))).all())


def _missing_defaults(
    prim: Any, samples: Mapping[str, Mapping[float, Any]], ops: list[str]
) -> dict[str, Any]:
    """The defaults that ops lack, by name, where new samples would have the prim rest elsewhere; else none.

    samples: the new ones of ops. A prim rests at its first samples where an op has no default.
    """
    starts = {
        name: at_start(prim.GetAttribute(name)) for name in ops if prim.GetAttribute(name).Get() is None
    }
    moves = (bool(new) and new[min(new)] != starts[name] for name, new in samples.items() if name in starts)
    return starts if any(moves) else {}


def _into_stack(
    prim: Any, local: Floats | None, tracks: dict[Path, Track], resets: list[str], ops: list[str]
) -> list[Edit]:
    """Samples for the ops that have new tracks; new ops where they belong. local: a new rest, or None."""
    found: list[Edit] = []
    path = prim.GetPath()
    rest = {} if local is None else stands_by(local)
    stands = transform_ops(rest) if rest else []
    names = [name for p, name in OPS.items() if name in ops or p in tracks or name in stands]
    types = {
        p: prim.GetAttribute(name).GetTypeName() if name in ops else OP_TYPES[p] for p, name in OPS.items()
    }
    samples = {OPS[p]: op_samples(track, types[p]) for p, track in tracks.items() if p in OPS}
    defaults = {} if rest else _missing_defaults(prim, samples, ops)
    for p, name in OPS.items():
        if name not in names or not (p in tracks or p in rest or name in defaults):
            continue
        type_name, values = types[p], samples.get(name, {})
        still = rest.get(p, None if name in ops else NOTHING[p])
        default = defaults.get(name) if still is None else op_value(type_name, still)
        found.append(set_value(path, name, type_name, default, samples=values, alone=p in tracks))
    return found if names == ops else [*found, set_tokens(path, "xformOpOrder", [*resets, *names])]
