"""Reorient plain Xform prims.

A prim gets two constant ops, without a change to any op it has::

    local' = C·local·Cp⁻¹    frame op C innermost (last), Cp⁻¹ outermost (first)

which is exact whatever scale or animation lies between, and which a second
reorientation multiplies into. ``bake_xform`` writes translate, orient and scale instead.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pxr import Sdf, UsdGeom

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import DEFAULT, refuse, tokens_of, why_locked
from rigtri.formats.usd.opinions.edits import Edit, remove_properties, set_tokens, set_value
from rigtri.formats.usd.opinions.xform_edits import SAME_ROTATION, op_value, set_transform, transform_ops
from rigtri.formats.usd.passes.usd_edit import UsdEdit, sets_transform
from rigtri.formats.usd.reading.node_keys import kind
from rigtri.formats.usd.reading.xform_hierarchy import FRAME, PARENT_INVERSE, value_numbers
from rigtri.maths.matrices import (
    SKEW,
    compose,
    inverse,
    multiply,
    orthonormal_axes,
    skew,
)
from rigtri.maths.quaternions import IDENTITY, conjugate, from_axes
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.report import Notice

_QUATD = Sdf.ValueTypeNames.Quatd
# What a rotation may leave unexplained of a matrix, as a share of its largest number.
SAME_PLACE = 1e-9


def reorient_xforms(edit: UsdEdit) -> None:
    """Give all prims whose local matrix changed their new axes, and those below them theirs.

    FileError where a prim cannot be edited, or no rotation explains the change.
    """
    before, rig = edit.source.rig, edit.rig
    reoriented = {
        node
        for node in np.flatnonzero(edit.changes.moved).tolist()
        if kind(before.keys[node]) == "prim" and not sets_transform(before, rig, node)
    }
    if not reoriented:
        return
    delta = np.broadcast_to(IDENTITY, (len(before), 4)).copy()
    for node in range(len(before)):
        if kind(before.keys[node]) != "prim":
            continue
        parent = int(before.parents[node])
        above = delta[parent] if parent >= 0 else IDENTITY
        if node not in reoriented and (above == IDENTITY).all():
            continue
        delta[node] = _delta(before, rig, node, above)
        edit.values += _prim_edits(edit, node, delta[node], above)


def _delta(before: Rig, after: Rig, node: int, above: Floats) -> Floats:
    """C of one prim from local' = C·local·Cp⁻¹; FileError where no rotation explains the change."""
    old, new = before.local[node], after.local[node]
    lifted = multiply(new, compose(np.zeros(3), above, np.ones(3)))
    change = multiply(lifted, inverse(old))
    q = from_axes(orthonormal_axes(change))
    axes = compose(np.zeros(3), q, np.ones(3))
    left = np.abs(multiply(axes, old) - lifted).max()
    if not left <= SAME_PLACE * max(1.0, float(np.abs(lifted).max())):
        raise FileError(f"<{before.labels[node]}>: prims can be re-oriented, but not moved or scaled.")
    return np.asarray(IDENTITY) if np.abs(q - IDENTITY).max() < SAME_ROTATION else q


def _prim_edits(edit: UsdEdit, node: int, delta: Floats, above: Floats) -> list[Edit]:
    local = edit.rig.local[node]
    prim = edit.source.stage.GetPrimAtPath(edit.rig.labels[node])
    refuse(why_locked(prim, ("xformOpOrder", FRAME, PARENT_INVERSE)))
    xformable = UsdGeom.Xformable(prim)
    if edit.options.bake_xform:
        if not xformable.TransformMightBeTimeVarying() and skew(local) < SKEW:
            return _baked(prim, local)
        edit.notices.append(
            Notice("not-baked", f"<{prim.GetPath()}> is animated or sheared; its ops stay, two are added.")
        )
    order = list(tokens_of(prim, "xformOpOrder"))
    edits: list[Edit] = []
    for name, change, last in ((FRAME, delta, True), (PARENT_INVERSE, conjugate(above), False)):
        old = value_numbers(prim.GetAttribute(name).Get(DEFAULT)) if name in order else IDENTITY
        # Row matrices: what stands nearer to the points comes first, in Hamilton's product last.
        new = product(old, change) if last else product(change, old)
        order = [op for op in order if op != name]
        if np.abs(np.abs(new[3]) - 1.0) > SAME_ROTATION or np.abs(new[:3]).max() > SAME_ROTATION:
            place = len(order) if last else int(bool(order) and order[0] == "!resetXformStack!")
            order.insert(place, name)
            edits.append(set_value(prim.GetPath(), name, _QUATD, op_value(_QUATD, new)))
        elif not np.array_equal(old, IDENTITY):
            edits.append(remove_properties(prim.GetPath(), name))
    return [*edits, set_tokens(prim.GetPath(), "xformOpOrder", order)]


def _baked(prim: Any, local: Floats) -> list[Edit]:
    """The local matrix as translate, orient, scale; the ops it had stay as unused attributes."""
    resets = UsdGeom.Xformable(prim).GetResetXformStack()
    order = (["!resetXformStack!"] if resets else []) + transform_ops(local)
    return [*set_transform(prim.GetPath(), local), set_tokens(prim.GetPath(), "xformOpOrder", order)]
