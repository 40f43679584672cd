"""Write skin weights that were redistributed among joints.

Source: UsdSkel, SkelBindingAPI (`primvars:skel:jointIndices`, `primvars:skel:jointWeights`,
their elementSize, and `skel:joints`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from pxr import Sdf

from rigtri.errors import FixedWeightsError
from rigtri.formats.usd.composition.stage import DEFAULT, why_instanced, why_locked
from rigtri.formats.usd.opinions.edits import Edit, set_tokens, set_value
from rigtri.formats.usd.opinions.joint_influences import INDICES, ORDER
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.mesh_reader import seen_at_start
from rigtri.formats.usd.reading.node_keys import kind, parts
from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import transform_points
from rigtri.maths.trigonometry import Floats
from rigtri.model.skin import JointMerge, WeightRedistribution
from rigtri.model.skin_weights import folded, limited, shared
from rigtri.report import Notice

WEIGHTS = "primvars:skel:jointWeights"
_OTHERWISE = "Leave out --split-weights"


def write_skin_weights(edit: UsdEdit) -> None:
    """Write the influences of meshes whose weights were split among joints, or whose joints go.

    FileError where they cannot be edited.
    """
    source, rig = edit.source, edit.rig
    by_path: dict[str, list[WeightRedistribution]] = {}
    for spread in rig.pending.weight_redistributions:
        key = rig.skins[spread.skin].key
        if kind(key) == "skeleton":
            by_path.setdefault(parts(key)[1], []).append(spread)
    merges = {
        parts(key)[1]: merge
        for merge in rig.pending.joint_merges
        if kind(key := rig.skins[merge.skin].key) == "skeleton"
    }
    for path, query in source.bindings.every if by_path or merges else ():
        if not query.HasJointInfluences():
            continue
        tokens = source.skeletons[path].tokens if path in source.skeletons else ()
        if path in by_path:
            edit.values += _of_mesh(query, tokens, by_path[path], edit.notices)
        if path in merges:
            node = source.rig.known(str(query.GetPrim().GetPath()))
            width = 0 if node is None else merges[path].widths.get(node, 0)
            edit.values += _merged(query, tokens, merges[path], width)


def limit_weights(edit: UsdEdit) -> None:
    """Let the points of all skinned meshes have as many joints as allowed. FileError where that cannot be."""
    limit = edit.rig.pending.weight_limit
    for _, query in edit.source.bindings.every if limit is not None else ():
        if limit is None or not query.HasJointInfluences() or query.IsRigidlyDeformed():
            continue
        count = len(seen_at_start(query.GetPrim().GetAttribute("points")) or ())
        before = _read(query, count)
        if before is None:
            continue
        joints, weights = limited(*before, limit)
        same = joints.shape == before[0].shape and np.array_equal(joints, before[0])
        if not (same and np.array_equal(weights, before[1])):
            _check(query)
            edit.values += _set(query, joints, weights)


def _merged(query: Any, tokens: Sequence[str], merge: JointMerge, width: int) -> list[Edit]:
    """The influences of a mesh without the joints that go, where it has any, by number or by name.

    width: how many a point had before, 0 where that is not known.
    """
    path, own = query.GetPrim().GetPath(), query.GetJointOrder()
    if merge.idle and not own:
        return []
    kept: dict[int, str] = {}
    for row, token in zip(merge.rows.tolist(), tokens, strict=True):
        kept.setdefault(row, token)  # heirs come before those that go
    order = [str(token) for token in own] if own else list(tokens)
    heirs = [kept[merge.rows[tokens.index(token)]] if token in tokens else token for token in order]
    left = [token for token, heir in zip(order, heirs, strict=True) if token == heir]
    left += [heir for heir in dict.fromkeys(heirs) if heir not in left]
    if left == order:
        return []
    edits: list[Edit] = []
    count = len(seen_at_start(query.GetPrim().GetAttribute("points")) or ())
    before = None if merge.idle or query.IsRigidlyDeformed() else _read(query, count)
    if before is not None:
        rows = np.array([left.index(heir) for heir in heirs], dtype=np.int64)
        at = np.array([merge.at[tokens.index(token)] if token in tokens else 0.0 for token in order])
        joints, weights = folded(rows, at, *before, width)
        if not (np.array_equal(joints, before[0]) and np.array_equal(weights, before[1])):
            _check(query)
            edits += _set(query, joints, weights)
    if own:
        edits.append(set_tokens(path, ORDER, left))
    return edits


def _of_mesh(
    query: Any, tokens: Sequence[str], spreads: Sequence[WeightRedistribution], warnings: list[Notice]
) -> list[Edit]:
    prim = query.GetPrim()
    points = seen_at_start(prim.GetAttribute("points"))
    if not points:
        return []
    bind = np.array(query.GetGeomBindTransform(DEFAULT), dtype=np.float64)
    placed = transform_points(np.array(points, dtype=np.float64), bind)
    before = _read(query, len(placed))
    if before is None:
        return []
    own = query.GetJointOrder()
    order = [str(token) for token in own] if own else list(tokens)
    joints, weights = before
    for spread in spreads:
        listed, order = _in_order(spread, tokens, order)
        joints, weights = shared(listed, placed, joints, weights)
    if np.array_equal(joints, before[0]) and np.array_equal(weights, before[1]):
        return []
    if query.IsRigidlyDeformed():
        text = f"<{prim.GetPath()}> moves with its joints as a whole, so its weights were not split"
        warnings.append(Notice("rigid-not-split", text))
        return []
    _check(query)
    edits = _set(query, joints, weights)
    if own and len(order) > len(own):
        edits.append(set_tokens(prim.GetPath(), ORDER, order))
    return edits


def _in_order(
    spread: WeightRedistribution, tokens: Sequence[str], order: list[str]
) -> tuple[WeightRedistribution, list[str]]:
    """A spread by the places of its joints in a mesh's own order, which gets those that it lacks."""
    mine = [tokens[row] for row in spread.joints.tolist()]
    order = [*order, *(token for token in mine if token not in order)]
    rows = np.array([order.index(token) for token in mine], dtype=np.int64)
    return WeightRedistribution(spread.skin, rows, spread.at, spread.start, spread.end, spread.most), order


def _read(query: Any, points: int) -> tuple[Integers, Floats] | None:
    """Joint indices and weights as stored, (v, k); None where UsdSkel has no use for them."""
    pair = query.ComputeVaryingJointInfluences(points, DEFAULT)
    width = max(query.GetNumInfluencesPerComponent(), 1)
    if not pair or len(pair[0]) != points * width or len(pair[1]) != len(pair[0]):
        return None
    shape = (points, width)
    indices = np.array(pair[0], dtype=np.int64).reshape(shape)
    return indices, np.array(pair[1], dtype=np.float64).reshape(shape)


def _check(query: Any) -> None:
    prim = query.GetPrim()
    why = why_instanced(prim) or why_locked(prim, (ORDER, INDICES, WEIGHTS))
    if why:
        raise FixedWeightsError(f"{why}. {_OTHERWISE}.")
    for primvar in (query.GetJointIndicesPrimvar(), query.GetJointWeightsPrimvar()):
        path = primvar.GetAttr().GetPath()
        if primvar.IsIndexed():
            raise FixedWeightsError(f"<{path}> is indexed, so its weights cannot be split. {_OTHERWISE}.")
        if primvar.GetAttr().GetNumTimeSamples():
            raise FixedWeightsError(
                f"<{path}> has time samples, so its weights cannot be split. {_OTHERWISE}."
            )


def _set(query: Any, joints: Integers, weights: Floats) -> list[Edit]:
    path = query.GetPrim().GetPath()
    edits: list[Edit] = []
    for name, primvar, rows in (
        (INDICES, query.GetJointIndicesPrimvar(), joints.astype(np.int32)),
        (WEIGHTS, query.GetJointWeightsPrimvar(), weights),
    ):
        attribute = primvar.GetAttr()
        stored = type(attribute.Get(DEFAULT))
        kind_of = np.array(attribute.Get(DEFAULT)).dtype
        value = stored.FromNumpy(np.ascontiguousarray(rows.reshape(-1).astype(kind_of)))
        edits.append(set_value(path, name, attribute.GetTypeName(), value))
        edits.append(_declared(path, name, {"elementSize": rows.shape[1], "interpolation": "vertex"}))
    return edits


def _declared(path: Any, name: str, fields: Mapping[str, Any]) -> Edit:
    """Metadata of an attribute that an edit before has set."""

    def edit(layer: Any) -> None:
        spec = layer.GetAttributeAtPath(Sdf.Path(path).AppendProperty(name))
        for key, value in fields.items():
            if spec is not None and (not spec.HasInfo(key) or spec.GetInfo(key) != value):
                spec.SetInfo(key, value)

    return Edit(Sdf.Path(path), edit)
