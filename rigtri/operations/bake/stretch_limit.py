"""The limit of IK stretch, beyond which float32 holds no pose."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.ik import Ik
from rigtri.evaluation.pose_cache import PoseCache
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.rig import Rig

# So many times its length a bone may be: float32 has seven digits, and the pose is to have some of them.
MOST = 1e4


def refuse_overstretch(
    rig: Rig, limbs: Iterable[Ik], parts: Mapping[int, Parts], clip: str, times: Floats
) -> None:
    """GeometryError where IK with stretch makes bones more than `MOST` times as long as at rest.

    parts: of all nodes that are moved, at ``times``, (f,), of a clip.
    """
    still = PoseCache(rig)
    for limb in (ik.limb for ik in limbs if ik.limb.stretch):
        for node in (node for node in limb.chain[1:] if node in parts):
            size = float(length(still.part(node).translation)[0])
            grown = length(parts[node].translation) / (size if size > 0 else np.inf)
            frame = int(np.argmax(grown > MOST))
            if grown[frame] > MOST:
                raise GeometryError(
                    f"'{rig.title(limb.control)}' is so far away at {clip}@{times[frame]:g} that its limb "
                    f"would be {grown[frame]:.2g} times as long; {MOST:g} times is the most. Bring it "
                    "nearer, or bake with --no-stretch"
                )
