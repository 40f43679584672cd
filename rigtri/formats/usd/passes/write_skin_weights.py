"""Write skin weights that were redistributed among joints.

Source: UsdSkel, SkelBindingAPI (`primvars:skel:jointIndices`, `primvars:skel:jointWeights`,
their elementSize, and `skel:joints`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.formats.usd.composition.stage import DEFAULT
from rigtri.formats.usd.opinions.edits import Edit, set_tokens
from rigtri.formats.usd.opinions.joint_influences import ORDER
from rigtri.formats.usd.opinions.skin_influences import check_editable, read_influences, set_influences
from rigtri.formats.usd.passes.usd_edit import UsdEdit, changed_besides
from rigtri.formats.usd.reading.mesh_reader import seen_at_start
from rigtri.formats.usd.reading.node_keys import kind, parts
from rigtri.maths.matrices import transform_points
from rigtri.model.skin import JointMerge, WeightRedistribution
from rigtri.model.skin_weights import folded, shared
from rigtri.report import Notice


def write_skin_weights(edit: UsdEdit) -> None:
    """Write the influences of meshes whose weights were split among joints, or whose joints go.

    FileError where they cannot be edited.
    """
    source, rig = edit.source, edit.rig
    by_path: dict[str, list[WeightRedistribution]] = {}
    for redistribution in rig.pending.weight_redistributions:
        key = rig.skins[redistribution.skin].key
        if kind(key) == "skeleton":
            by_path.setdefault(parts(key)[1], []).append(redistribution)
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
            if len(merges[path].rows) != len(tokens):
                raise changed_besides(path)
            node = source.rig.known(str(query.GetPrim().GetPath()))
            width = 0 if node is None else merges[path].widths.get(node, 0)
            edit.values += _merged(query, tokens, merges[path], width)


def _merged(query: Any, tokens: Sequence[str], merge: JointMerge, width: int) -> list[Edit]:
    """The influences of a mesh without the joints that go, where it has any, by number or by name.

    width: how many a point had before, 0 where that is not known.
    """
    path, own = query.GetPrim().GetPath(), query.GetJointOrder()
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
    # A mesh that moves as a whole has one row for all of its points.
    rigid = query.IsRigidlyDeformed()
    count = 1 if rigid else len(seen_at_start(query.GetPrim().GetAttribute("points")) or ())
    before = read_influences(query, count)
    if before is not None:
        rows = np.array([left.index(heir) for heir in heirs], dtype=np.int64)
        at = np.array([merge.at[tokens.index(token)] if token in tokens else 0.0 for token in order])
        joints, weights = folded(rows, at, *before, width)
        if not (np.array_equal(joints, before[0]) and np.array_equal(weights, before[1])):
            check_editable(query)
            edits += set_influences(query, joints, weights)
    if own:
        edits.append(set_tokens(path, ORDER, left))
    return edits


def _of_mesh(
    query: Any, tokens: Sequence[str], redistributions: Sequence[WeightRedistribution], warnings: list[Notice]
) -> list[Edit]:
    prim = query.GetPrim()
    points = seen_at_start(prim.GetAttribute("points"))
    if not points:
        return []
    bind = np.array(query.GetGeomBindTransform(DEFAULT), dtype=np.float64)
    placed = transform_points(np.array(points, dtype=np.float64), bind)
    before = read_influences(query, len(placed))
    if before is None:
        return []
    own = query.GetJointOrder()
    order = [str(token) for token in own] if own else list(tokens)
    joints, weights = before
    for redistribution in redistributions:
        listed, order = _in_order(redistribution, tokens, order)
        joints, weights = shared(listed, placed, joints, weights)
    if np.array_equal(joints, before[0]) and np.array_equal(weights, before[1]):
        return []
    if query.IsRigidlyDeformed():
        text = f"<{prim.GetPath()}> moves with its joints as a whole, so its weights were not split"
        warnings.append(Notice("rigid-not-split", text))
        return []
    check_editable(query)
    edits = set_influences(query, joints, weights)
    if own and len(order) > len(own):
        edits.append(set_tokens(prim.GetPath(), ORDER, order))
    return edits


def _in_order(
    redistribution: WeightRedistribution, tokens: Sequence[str], order: list[str]
) -> tuple[WeightRedistribution, list[str]]:
    """A redistribution by the places of its joints in a mesh's own order, which gets those that it lacks."""
    mine = [tokens[row] for row in redistribution.joints.tolist()]
    order = [*order, *(token for token in mine if token not in order)]
    rows = np.array([order.index(token) for token in mine], dtype=np.int64)
    return replace(redistribution, joints=rows), order
