"""limit-weights: no vertex has more joints than an engine supports, and weights sum to 1."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.model.rig import Rig
from rigtri.model.skin import WeightLimit
from rigtri.model.skin_weights import limited
from rigtri.operations.add_rivet.rebind import rebind_rivets_on_new_weights
from rigtri.operations.operation import operation
from rigtri.operations.options.limit_weights import LimitWeightsOptions as LimitWeightsOptions
from rigtri.report import Report


@operation(LimitWeightsOptions)
def limit_weights(rig: Rig, *, options: LimitWeightsOptions, report: Report) -> Rig:
    """The rig whose vertices keep the joints of the largest weights, which sum to as much as before, or to 1.

    How far vertices move is measured when the file is written. What changes is in ``report.added``, by mesh.
    Rivets on meshes that change are baked anew.
    """
    skins = None if options.character is None else _skins(rig)
    limit = WeightLimit(options.max_influences, options.normalise, skins)
    for mesh in rig.meshes:
        _, weights = limited(mesh.joints, mesh.weights, limit)
        wide = int(np.count_nonzero(np.count_nonzero(mesh.weights, axis=1) > limit.most))
        width = min(weights.shape[1], mesh.weights.shape[1])
        differs = (weights[:, :width] != mesh.weights[:, :width]).any(axis=1)
        if wide or differs.any():
            entry = {"type": "weights", "node": rig.address(mesh.node), "new": False}
            report.added.append({**entry, "points": int(np.count_nonzero(differs)), "over": wide})
    if report.added and not rig.shown_clips:
        report.warn("no-clips", "This file has no clips: vertices were compared in the rest pose alone")
    limits = (*rig.pending.weight_limits, limit)
    if not report.added:
        return rig
    rig = replace(rig, pending=replace(rig.pending, weight_limits=limits))
    return rebind_rivets_on_new_weights(rig, report)


def _skins(rig: Rig) -> frozenset[int]:
    """The skins of the character that is edited alone: those of others have no joints meanwhile."""
    return frozenset(number for number, skin in enumerate(rig.skins) if len(skin.joints))
