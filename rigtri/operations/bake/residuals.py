"""How far the evaluated controls are off the motion that they were solved for, and what IK left to FK."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigtri.evaluation.active_controls import NOTHING
from rigtri.evaluation.inverse_solver import Block
from rigtri.evaluation.zero_pose import ControlsAtZero
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.rig import Rig
from rigtri.report import Notice


def fidelity(
    rig: Rig, blocks: Sequence[Block], times: Floats, *, clip: str, size: float, tolerance: float
) -> tuple[dict[str, float], list[Notice]]:
    """The record of a clip, as shares of ``size`` and degrees; and a warning about what is off by more.

    blocks: what controls make of a motion at ``times``, and that motion. size: in file units.
    tolerance: as a share of it.
    """
    joint, time, far = _farthest(rig, blocks, times)
    residuals = [residual for block in blocks for residual in block.found.residuals]
    record = {
        "deviation": far / size,
        "residual_degrees": float(np.degrees(max((r.turn for r in residuals), default=0.0))),
        "residual_move": max((r.move for r in residuals), default=0.0) / size,
    }
    if far <= max(tolerance, NOTHING) * size:
        return record, []
    name = rig.title(joint)
    text = f"The controls give '{name}' back {far / size:.2g} of the size off, at {clip}@{time:g}"
    return record, [Notice("controls-off", f"{text}; {_advice(rig, joint)}", name, geometry=True)]


def _farthest(rig: Rig, blocks: Sequence[Block], times: Floats) -> tuple[int, float, float]:
    """The joint that is off most, when, and by how much in file units; −1 where none is."""
    worst, start = (-1, 0.0, 0.0), 0
    for source, found in blocks:
        joints = np.flatnonzero(rig.is_joint).tolist() or sorted(source.parts)
        count = 1
        for joint in joints:
            a, b = found.posed.world(joint), source.world(joint)
            apart = np.nan_to_num(length(a[:, 3, :3] - b[:, 3, :3]))
            row, count = int(np.argmax(apart)), max(count, len(apart))
            if apart[row] > worst[2]:
                worst = (joint, float(times[start + row]), float(apart[row]))
        start += count
        if len(blocks) > 1:
            source.forget()
            found.posed.forget()
    return worst


def _advice(rig: Rig, joint: int) -> str:
    """What may help a joint that its controls do not give back."""
    reference = ControlsAtZero(rig)
    chains = [limb.chain for limb in reference.limbs if rig.is_below(joint, limb.chain[0])]
    bare = [node for chain in chains for node in chain if node not in reference.fk]
    if bare:
        name = rig.title(bare[0])
        return f"'{name}' has no FK control for what IK cannot hold: make one with rigtri add-controls"
    return "what also moves it is not its controls' to hold: see docs/evaluation.md"
