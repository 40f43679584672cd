"""Turning plain Xform prims, and standing prims of our own somewhere.

A prim is turned by two constant ops, without a change to any op it has::

    local' = C·local·Cp⁻¹    frame op C innermost (last), Cp⁻¹ outermost (first)

which is exact whatever scale or animation lies between, and which a second
turn multiplies into. ``bake`` writes translate, orient and scale instead.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pxr import Gf, Sdf, UsdGeom, Vt

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import DEFAULT, tokens_of, why_locked
from rigtri.formats.usd.opinions.edits import Edit, Setting, kind, set_value
from rigtri.maths.matrices import (
    SKEW,
    compose,
    decompose,
    from_frame,
    inverse,
    multiply,
    orthonormal_axes,
    skew,
)
from rigtri.maths.quaternions import IDENTITY, conjugate, from_axes, norm, unit
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Path, Track
from rigtri.model.rig import Rig
from rigtri.report import Notice

FRAME = "xformOp:orient:rigtriFrame"
PARENT_INVERSE = "xformOp:orient:rigtriParentInv"
# Two rotations that differ by less are one that went through a few products.
SAME_TURN = 1e-12
# What a turn may leave unexplained of a matrix, as a share of its largest number.
SAME_PLACE = 1e-9
# What a division in float64 leaves of a length of 1.
_ROUNDED = 1e-15


def turn_edits(
    stage: Any, before: Rig, after: Rig, nodes: list[int], bake: bool, warnings: list[Notice]
) -> list[Edit]:
    """Edits that give the prims ``nodes`` (all whose local matrix changed) their new axes."""
    turn = np.broadcast_to(IDENTITY, (len(before), 4)).copy()
    edits: list[Edit] = []
    wanted = set(nodes)
    for node in range(len(before)):
        if kind(before.keys[node]) != "prim":
            continue
        parent = int(before.parents[node])
        above = turn[parent] if parent >= 0 else IDENTITY
        if node not in wanted and (above == IDENTITY).all():
            continue
        turn[node] = _turn(before, after, node, above)
        edits += _prim_edits(stage, after, node, turn[node], above, bake, warnings)
    return edits


def _turn(before: Rig, after: Rig, node: int, above: Floats) -> Floats:
    """C of one prim from local' = C·local·Cp⁻¹; FileError where no rotation explains the change."""
    old, new = before.local[node], after.local[node]
    axes = from_frame(np.eye(3), np.zeros(3))
    lifted = multiply(new, compose(np.zeros(3), above, np.ones(3)))
    change = multiply(lifted, inverse(old))
    q = from_axes(orthonormal_axes(change))
    axes = compose(np.zeros(3), q, np.ones(3))
    left = np.abs(multiply(axes, old) - lifted).max()
    if not left <= SAME_PLACE * max(1.0, float(np.abs(lifted).max())):
        raise FileError(f"<{before.labels[node]}>: prims can be turned, but not moved or scaled.")
    return np.asarray(IDENTITY) if np.abs(q - IDENTITY).max() < SAME_TURN else q


def _prim_edits(
    stage: Any, after: Rig, node: int, turn: Floats, above: Floats, bake: bool, warnings: list[Notice]
) -> list[Edit]:
    prim = stage.GetPrimAtPath(after.labels[node])
    locked = why_locked(prim, ("xformOpOrder", FRAME, PARENT_INVERSE))
    if locked:
        raise FileError(f"{locked}.")
    xformable = UsdGeom.Xformable(prim)
    if bake:
        if not xformable.TransformMightBeTimeVarying() and skew(after.local[node]) < SKEW:
            return _baked(prim, after.local[node])
        warnings.append(
            Notice("not-baked", f"<{prim.GetPath()}> is animated or sheared; its ops stay, two are added.")
        )
    order = list(tokens_of(prim, "xformOpOrder"))
    edits: list[Edit] = []
    for name, change, last in ((FRAME, turn, True), (PARENT_INVERSE, conjugate(above), False)):
        old = _orient(prim, name) if name in order else IDENTITY
        # Row matrices: what stands nearer to the points comes first, in Hamilton's product last.
        new = product(old, change) if last else product(change, old)
        order = [op for op in order if op != name]
        if np.abs(np.abs(new[3]) - 1.0) > SAME_TURN or np.abs(new[:3]).max() > SAME_TURN:
            place = len(order) if last else int(bool(order) and order[0] == "!resetXformStack!")
            order.insert(place, name)
            edits.append(_set_orient(prim, name, new))
        elif not np.array_equal(old, IDENTITY):
            edits.append(_remove(prim, name))
    return [*edits, _set_order(prim, order)]


def _orient(prim: Any, name: str) -> Floats:
    value = prim.GetAttribute(name).Get(DEFAULT)
    return np.array([*value.GetImaginary(), value.GetReal()], dtype=np.float64)


def quaternion(q: Floats) -> Any:
    """xyzw as a Gf quaternion of doubles."""
    return Gf.Quatd(float(q[3]), Gf.Vec3d(*q[:3].tolist()))


def _set_orient(prim: Any, name: str, q: Floats) -> Edit:
    return set_value(prim.GetPath(), name, Sdf.ValueTypeNames.Quatd, quaternion(q))


def _set_order(prim: Any, order: list[str]) -> Edit:
    return set_value(
        prim.GetPath(), "xformOpOrder", Sdf.ValueTypeNames.TokenArray, Vt.TokenArray(order), uniform=True
    )


def _remove(prim: Any, name: str) -> Edit:
    path = prim.GetPath()

    def edit(layer: Any) -> None:
        spec = layer.GetPrimAtPath(path)
        if spec is not None and name in spec.properties:
            spec.RemoveProperty(spec.properties[name])

    return Edit(path, edit)


def _baked(prim: Any, local: Floats) -> list[Edit]:
    """The local matrix as translate, orient, scale; the ops it had stay as unused attributes."""
    resets = UsdGeom.Xformable(prim).GetResetXformStack()
    order = (["!resetXformStack!"] if resets else []) + stand_order(local)
    return [*stand(prim.GetPath(), local), _set_order(prim, order)]


def stand_order(local: Floats) -> list[str]:
    """The ops that `stand` writes, in order: those that are not the identity, translate always."""
    _, rotation, scale = decompose(local)
    order = ["xformOp:translate"]
    order += ["xformOp:orient"] if np.abs(rotation[:3]).max() > SAME_TURN else []
    return order + (["xformOp:scale"] if np.abs(scale - 1.0).max() > SAME_TURN else [])


# The ops that hold what tracks of prims of ours drive.
OPS: dict[Path, str] = {
    "translation": "xformOp:translate",
    "rotation": "xformOp:orient",
    "scale": "xformOp:scale",
}


def _samples(track: Track | None) -> dict[float, Any]:
    """The keys of a track as values of its op; none without a track."""
    if track is None:
        return {}
    values = sure_turns(track.values) if track.path == "rotation" else track.values
    rows = zip(track.times.tolist(), values, strict=True)
    return {
        time: quaternion(row) if track.path == "rotation" else Gf.Vec3d(*row.tolist()) for time, row in rows
    }


def sure_turns(rotations: Floats) -> Floats:
    """Rotations, (k, 4), that are unit; those that were keep their bits.

    USD takes the angle from w alone: in a short turn, what float32 has rounded off a unit w is much.
    """
    off = np.abs(norm(rotations) - 1.0) > _ROUNDED
    return np.where(off[:, np.newaxis], unit(rotations), rotations)


def stand(path: Any, local: Floats, tracks: Sequence[Track] = ()) -> list[Setting]:
    """Edits that put a prim at a local matrix by translate, orient and scale ops, and move it by tracks."""
    translation, rotation, scale = decompose(local)
    types = Sdf.ValueTypeNames
    values = {
        "xformOp:translate": (types.Double3, Gf.Vec3d(*translation.tolist())),
        "xformOp:orient": (types.Quatd, quaternion(rotation)),
        "xformOp:scale": (types.Double3, Gf.Vec3d(*scale.tolist())),
    }
    moved = {OPS[track.path]: track for track in tracks}
    order = [name for name in values if name in moved or name in stand_order(local)]
    edits = [
        set_value(path, name, *values[name], samples=_samples(moved.get(name)), alone=True) for name in order
    ]
    tokens = Vt.TokenArray(order)
    return [*edits, set_value(path, "xformOpOrder", types.TokenArray, tokens, uniform=True)]
