"""Let points have no more joints than allowed.

Source: UsdSkel, SkelBindingAPI.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from rigtri.formats.usd.opinions.skin_influences import check_editable, read_influences, set_influences
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.mesh_reader import seen_at_start
from rigtri.formats.usd.reading.node_keys import kind, parts
from rigtri.model.rig import Rig
from rigtri.model.skin_weights import limited


def limit_weights(edit: UsdEdit) -> None:
    """Let the points of skinned meshes have as many joints as allowed. FileError where that cannot be."""
    limits = [(limit, _skeletons(edit.rig, limit.skins)) for limit in edit.rig.pending.weight_limits]
    for path, query in edit.source.bindings.every if limits else ():
        own = [limit for limit, skeletons in limits if skeletons is None or path in skeletons]
        if not own or query.IsRigidlyDeformed():
            continue
        count = len(seen_at_start(query.GetPrim().GetAttribute("points")) or ())
        before = read_influences(query, count)
        if before is None:
            continue
        joints, weights = before
        for limit in own:
            joints, weights = limited(joints, weights, limit)
        if not (np.array_equal(joints, before[0]) and np.array_equal(weights, before[1])):
            check_editable(query)
            edit.values += set_influences(query, joints, weights)


def _skeletons(rig: Rig, skins: Iterable[int] | None) -> set[str] | None:
    """The paths of the Skeleton prims of skins; None for all."""
    if skins is None:
        return None
    keys = (rig.skins[skin].key for skin in skins)
    return {parts(key)[1] for key in keys if kind(key) == "skeleton"}
