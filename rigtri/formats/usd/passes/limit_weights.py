"""Let points have no more joints than allowed.

Source: UsdSkel, SkelBindingAPI.
"""

from __future__ import annotations

import numpy as np

from rigtri.formats.usd.opinions.skin_influences import check_editable, read_influences, set_influences
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.mesh_reader import seen_at_start
from rigtri.model.skin_weights import limited


def limit_weights(edit: UsdEdit) -> None:
    """Let the points of all skinned meshes have as many joints as allowed. FileError where that cannot be."""
    limit = edit.rig.pending.weight_limit
    if limit is None:
        return
    for _, query in edit.source.bindings.every:
        if query.IsRigidlyDeformed():
            continue
        count = len(seen_at_start(query.GetPrim().GetAttribute("points")) or ())
        before = read_influences(query, count)
        if before is None:
            continue
        joints, weights = limited(*before, limit)
        if not (np.array_equal(joints, before[0]) and np.array_equal(weights, before[1])):
            check_editable(query)
            edit.values += set_influences(query, joints, weights)
