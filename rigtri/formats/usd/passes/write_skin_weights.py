"""Write skin weights that were redistributed among joints, or limited, or whose joints go.

Source: UsdSkel, SkelBindingAPI (`primvars:skel:jointIndices`, `primvars:skel:jointWeights`,
their elementSize, and `skel:joints`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
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
from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import transform_points
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.model.skin import JointMerge, WeightLimit, WeightRedistribution
from rigtri.model.skin_weights import folded, limited, shared
from rigtri.report import Notice


def write_skin_weights(edit: UsdEdit) -> None:
    """Write the influences of meshes whose weights were split, whose joints go, or that were limited.

    In this order, each of what the one before has left. FileError where they cannot be edited.
    """
    source, rig = edit.source, edit.rig
    by_path: dict[str, list[WeightRedistribution]] = {}
    for redistribution in rig.pending.weight_redistributions:
        for path in _skeletons(rig, [redistribution.skin]):
            by_path.setdefault(path, []).append(redistribution)
    merges = {path: merge for merge in rig.pending.joint_merges for path in _skeletons(rig, [merge.skin])}
    limits = [
        (limit, None if limit.skins is None else _skeletons(rig, limit.skins))
        for limit in rig.pending.weight_limits
    ]
    for path, query in source.bindings.every if by_path or merges or limits else ():
        own = [limit for limit, skeletons in limits if skeletons is None or path in skeletons]
        if not query.HasJointInfluences() or not (path in by_path or path in merges or own):
            continue
        tokens = source.skeletons[path].tokens if path in source.skeletons else ()
        mesh = _Influences(query, tokens)
        if path in by_path:
            mesh.share(by_path[path], edit.notices)
        if path in merges:
            if len(merges[path].rows) != len(tokens):
                raise changed_besides(path)
            node = source.rig.known(str(query.GetPrim().GetPath()))
            mesh.merge(merges[path], 0 if node is None else merges[path].widths.get(node, 0))
        mesh.limit(own)
        edit.values += mesh.edits()


def _skeletons(rig: Rig, skins: Iterable[int]) -> set[str]:
    """The paths of the Skeleton prims of skins."""
    keys = (rig.skins[skin].key for skin in skins)
    return {parts(key)[1] for key in keys if kind(key) == "skeleton"}


class _Influences:
    """The influences of a mesh while an edit changes them.

    tokens: of the joints of its Skeleton. order: those that its influences count, which it may list itself.
    now: joints and weights, (v, k), or (1, k) where it moves as a whole; None where UsdSkel has no use for
    them.
    """

    def __init__(self, query: Any, tokens: Sequence[str]) -> None:
        self.query, self.tokens = query, tokens
        self.own = [str(token) for token in query.GetJointOrder() or ()]
        self.order = self.own or list(tokens)
        self.rigid = query.IsRigidlyDeformed()
        self.points = seen_at_start(query.GetPrim().GetAttribute("points")) or ()
        self.before = self.now = read_influences(query, 1 if self.rigid else len(self.points))

    def share(self, redistributions: Sequence[WeightRedistribution], notices: list[Notice]) -> None:
        """Split the weights of joints along their bones; what moves as a whole stays so, with a notice."""
        before = read_influences(self.query, len(self.points)) if self.rigid else self.before
        if before is None or not len(self.points):
            return
        bind = np.array(self.query.GetGeomBindTransform(DEFAULT), dtype=np.float64)
        placed = transform_points(np.array(self.points, dtype=np.float64), bind)
        order, now = self.order, before
        for redistribution in redistributions:
            listed, order = _in_order(redistribution, self.tokens, order)
            now = shared(listed, placed, *now)
        if _are_same(now, before):
            return
        if self.rigid:
            path = self.query.GetPrim().GetPath()
            text = f"<{path}> moves with its joints as a whole, so its weights were not split"
            notices.append(Notice("rigid-not-split", text))
            return
        self.order, self.now = order, now

    def merge(self, merge: JointMerge, width: int) -> None:
        """Let heirs have what points have of joints that go, by number or by name.

        width: how many joints a point had before, 0 where that is not known.
        """
        tokens, order, kept = self.tokens, self.order, dict[int, str]()
        for row, token in zip(merge.rows.tolist(), tokens, strict=True):
            kept.setdefault(row, token)  # heirs come before those that go
        heirs = [kept[merge.rows[tokens.index(token)]] if token in tokens else token for token in order]
        left = [token for token, heir in zip(order, heirs, strict=True) if token == heir]
        left += [heir for heir in dict.fromkeys(heirs) if heir not in left]
        if left == order:
            return
        if self.now is not None:
            rows = np.array([left.index(heir) for heir in heirs], dtype=np.int64)
            at = np.array([merge.at[tokens.index(token)] if token in tokens else 0.0 for token in order])
            self.now = folded(rows, at, *self.now, width)
        self.order = left

    def limit(self, limits: Sequence[WeightLimit]) -> None:
        """Let points have no more joints than allowed; not where they move as a whole."""
        for limit in limits:
            if self.now is not None and not self.rigid:
                self.now = limited(*self.now, limit)

    def edits(self) -> list[Edit]:
        """What of it has changed, as edits. FileError where that cannot be edited."""
        edits: list[Edit] = []
        if self.now is not None and self.before is not None and not _are_same(self.now, self.before):
            check_editable(self.query)
            edits += set_influences(self.query, *self.now)
        if self.own and self.order != self.own:
            edits.append(set_tokens(self.query.GetPrim().GetPath(), ORDER, self.order))
        return edits


def _are_same(one: tuple[Integers, Floats], other: tuple[Integers, Floats]) -> bool:
    return np.array_equal(one[0], other[0]) and np.array_equal(one[1], other[1])


def _in_order(
    redistribution: WeightRedistribution, tokens: Sequence[str], order: list[str]
) -> tuple[WeightRedistribution, list[str]]:
    """A redistribution by the places of its joints in a mesh's own order, which gets those that it lacks."""
    mine = [tokens[row] for row in redistribution.joints.tolist()]
    order = [*order, *(token for token in mine if token not in order)]
    rows = np.array([order.index(token) for token in mine], dtype=np.int64)
    return replace(redistribution, joints=rows), order
