"""Reorient plain Xform prims.

A prim gets two constant ops, without a change to any op it has::

    local' = C·local·Cp⁻¹    frame op C innermost (last), Cp⁻¹ outermost (first)

which is exact whatever scale or animation lies between, and which a second
reorientation multiplies into. ``bake_xform`` writes translate, orient and scale instead, and so does a frame
of another size where the prim does not move; C then has a uniform scale beside its rotation.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from pxr import Sdf, UsdGeom

from rigtri.errors import FileError, GeometryError
from rigtri.formats.usd.composition.stage import DEFAULT, refuse, tokens_of, why_locked
from rigtri.formats.usd.composition.time_samples import ops_times
from rigtri.formats.usd.opinions.edits import Edit, remove_properties, set_tokens, set_value
from rigtri.formats.usd.opinions.instancer_edits import move_instancers
from rigtri.formats.usd.opinions.xform_edits import (
    SAME_ROTATION,
    after_reset,
    op_value,
    set_transform,
    stated_types,
)
from rigtri.formats.usd.passes.usd_edit import UsdEdit, sets_transform
from rigtri.formats.usd.reading.node_keys import kind
from rigtri.formats.usd.reading.xform_hierarchy import (
    FRAME,
    FRAME_SIZE,
    PARENT_INVERSE,
    PARENT_INVERSE_SIZE,
    value_numbers,
)
from rigtri.maths.matrices import (
    SKEW,
    compose,
    determinant,
    inverse,
    multiply,
    orthonormal_axes,
    skew,
)
from rigtri.maths.quaternions import IDENTITY, conjugate, from_axes
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.rig import Rig
from rigtri.report import Notice

_QUATD, _DOUBLE3 = Sdf.ValueTypeNames.Quatd, Sdf.ValueTypeNames.Double3
# Blender's exporter notes so the root that it adds to turn and scale the stage; its importer leaves out a
# root with the note, whatever the value, and with it the turn from y up to z up and the conversion of units.
_NOTE = ("Blender", "generated")
# What a rotation may leave unexplained of a matrix, as a share of its largest number.
SAME_POSITION = 1e-9


def reorient_xforms(edit: UsdEdit) -> None:
    """Give all prims whose local matrix changed their new axes, and those below them theirs.

    FileError where a prim cannot be edited, GeometryError where no rotation explains the change.
    """
    before, rig = edit.source.rig, edit.rig
    reoriented = {
        node
        for node in np.flatnonzero(edit.changes.moved).tolist()
        if kind(before.keys[node]) == "prim" and not sets_transform(before, rig, node)
    }
    if not reoriented:
        return
    top = _Frame() if rig.pending.conversion is None else _Frame(*rig.pending.conversion.frame)
    found: dict[int, _Frame] = {}
    for node in range(len(before)):
        if kind(before.keys[node]) != "prim":
            continue
        above = found.get(int(before.parents[node]), _Frame()) if before.parents[node] >= 0 else top
        if node not in reoriented and above.is_same:
            continue
        found[node] = _delta(before, rig, node, above)
        edit.values += _prim_edits(edit, node, found[node], above)
        prim = edit.source.stage.GetPrimAtPath(rig.labels[node])
        if not found[node].is_same and prim.HasCustomDataKey(":".join(_NOTE)):
            edit.removals.append(_without_generated(prim.GetPath()))
    _check_instances(before, found)
    nodes = {before.labels[k]: k for k in range(len(before)) if kind(before.keys[k]) == "prim"}

    def frame_at(path: Any) -> _Frame:
        node = next((nodes[str(one)] for one in path.GetAncestorsRange() if str(one) in nodes), -1)
        return top if node < 0 else found.get(node, _Frame())

    edit.values += move_instancers(edit.source, frame_at)


def _check_instances(rig: Rig, found: Mapping[int, _Frame]) -> None:
    """FileError where instances of one prototype get other frames, which all below them counts from."""
    same = _Frame()
    for node, first in rig.rules.instances.items():
        mine, its = found.get(node, same), found.get(first, same)
        apart = np.abs(mine.rotation - its.rotation).max(), abs(mine.size / its.size - 1.0)
        if max(apart) > SAME_ROTATION:
            raise FileError(
                f"<{rig.labels[first]}> and <{rig.labels[node]}> are instances of one prototype, and cannot "
                "get different axes or sizes. Make one of them no instance (instanceable = false)."
            )


def _without_generated(path: Any) -> Edit:
    """Take Blender's note off a prim that does not hold its conversion of axes and units any more."""

    def change(layer: Any) -> None:
        spec = layer.GetPrimAtPath(path)
        if spec is None or _NOTE[0] not in spec.customData:
            return
        data = dict(spec.customData)
        left = {key: value for key, value in dict(data.pop(_NOTE[0])).items() if key != _NOTE[1]}
        data |= {_NOTE[0]: left} if left else {}
        if data:
            spec.customData = data
        else:
            spec.ClearInfo("customData")

    return Edit(path, change)


class _Frame(NamedTuple):
    """How a frame differs from the one that was: turned, (4,) xyzw, and times as large, below 0 mirrored."""

    rotation: Floats = IDENTITY
    size: float = 1.0

    @property
    def is_same(self) -> bool:
        return self.size == 1.0 and bool((self.rotation == IDENTITY).all())


def _delta(before: Rig, after: Rig, node: int, above: _Frame) -> _Frame:
    """C of one prim from local' = C·local·Cp⁻¹; GeometryError where no rotation and size explain it."""
    old, new = before.local[node], after.local[node]
    lifted = multiply(new, compose(np.zeros(3), above.rotation, np.full(3, above.size)))
    change = multiply(lifted, inverse(old))
    q, size = from_axes(orthonormal_axes(change)), float(length(change[0, :3]))
    size = -size if determinant(change) < 0 else size
    size = 1.0 if abs(size - 1.0) < SAME_ROTATION else size
    axes = compose(np.zeros(3), q, np.full(3, size))
    left = np.abs(multiply(axes, old) - lifted).max()
    if not left <= SAME_POSITION * max(1.0, float(np.abs(lifted).max())):
        raise GeometryError(
            f"<{before.labels[node]}> is a plain prim, which can get other axes, but no other rest pose. "
            "Change its xformOps in the program that it is from"
        )
    return _Frame(np.asarray(IDENTITY) if np.abs(q - IDENTITY).max() < SAME_ROTATION else q, size)


def _prim_edits(edit: UsdEdit, node: int, delta: _Frame, above: _Frame) -> list[Edit]:
    local = edit.rig.local[node]
    prim = edit.source.stage.GetPrimAtPath(edit.rig.labels[node])
    refuse(why_locked(prim, ("xformOpOrder", FRAME, PARENT_INVERSE)))
    xformable = UsdGeom.Xformable(prim)
    if delta.size != 1.0 and not ops_times(xformable) and skew(local) < SKEW:
        return _baked(edit, prim, local)
    if edit.options.bake_xform:
        if not xformable.TransformMightBeTimeVarying() and skew(local) < SKEW:
            return _baked(edit, prim, local)
        edit.notices.append(
            Notice("not-baked", f"<{prim.GetPath()}> is animated or sheared; its ops stay, two are added.")
        )
    order = list(tokens_of(prim, "xformOpOrder"))
    applied = order[after_reset(order) :]
    edits: list[Edit] = []
    for name, size, last in ((FRAME_SIZE, delta.size, True), (PARENT_INVERSE_SIZE, 1.0 / above.size, False)):
        if size == 1.0:
            continue
        was = float(prim.GetAttribute(name).Get(DEFAULT)[0]) if name in applied else 1.0
        order = [op for op in order if op != name]
        order.insert(len(order) if last else after_reset(order), name)
        edits.append(set_value(prim.GetPath(), name, _DOUBLE3, op_value(_DOUBLE3, np.full(3, was * size))))
    inverse_above = conjugate(above.rotation)
    for name, change, last in ((FRAME, delta.rotation, True), (PARENT_INVERSE, inverse_above, False)):
        old = value_numbers(prim.GetAttribute(name).Get(DEFAULT)) if name in applied else IDENTITY
        # Row matrices: what stands nearer to the points comes first, in Hamilton's product last.
        new = product(old, change) if last else product(change, old)
        order = [op for op in order if op != name]
        if np.abs(np.abs(new[3]) - 1.0) > SAME_ROTATION or np.abs(new[:3]).max() > SAME_ROTATION:
            order.insert(len(order) if last else after_reset(order), name)
            edits.append(set_value(prim.GetPath(), name, _QUATD, op_value(_QUATD, new)))
        elif not np.array_equal(old, IDENTITY):
            edits.append(remove_properties(prim.GetPath(), name))
    return [*edits, set_tokens(prim.GetPath(), "xformOpOrder", order)]


def _baked(edit: UsdEdit, prim: Any, local: Floats) -> list[Edit]:
    """The local matrix as translate, orient, scale; the ops it had stay as unused attributes."""
    resets = UsdGeom.Xformable(prim).GetResetXformStack()
    edited = edit.source.stage.GetRootLayer() if edit.options.edit_target == "root" else None
    return [*set_transform(prim.GetPath(), local, resets=resets, types=stated_types(prim, edited))]
