"""What becomes of a turn where a joint's own scale is not uniform.

In place is exact when C·S·C⁻¹ stays diagonal at rest and at every key; else the
turn is replaced by the nearest one that is (`snap`), given up (`skip`), or an
error.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from rigtri.errors import GeometryError
from rigtri.quaternions import IDENTITY, conjugate, from_axes, multiply, norm, to_axes, turn_angle, unit
from rigtri.reframe import scale_allows
from rigtri.report import Report
from rigtri.rig import Rig
from rigtri.trigonometry import Floats
from rigtri.vectors import angle, cross

Policy = Literal["snap", "skip", "split", "error"]


def cardinal_turns() -> Floats:
    """The 24 turns that take axes onto axes, (24, 4)."""
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    frames = [
        np.stack([x, y, cross(x, y)]) for x in axes for y in axes if not (np.abs(x) == np.abs(y)).all()
    ]
    return from_axes(np.stack(frames))


def nearest_cardinal(turn: Floats) -> Floats:
    """The cardinal turn nearest to a turn, (4,), by the angle between them."""
    turns = cardinal_turns()
    products = turns * turn
    overlap = np.abs(products[:, 0] + products[:, 1] + products[:, 2] + products[:, 3])
    return np.asarray(turns[int(np.argmax(overlap))])


def allowed_turns(rig: Rig, turn: Floats, policy: Policy, aim_axis: dict[int, int], report: Report) -> Floats:
    """Turns, (n, 4), of which each is exact in place; what had to give way is reported.

    aim_axis: per joint the index of its aim axis, to state the aim's error.
    Raises GeometryError with the policy ``error``.
    """
    refused = np.flatnonzero(~scale_allows(rig, turn)).tolist()
    if not refused:
        return turn
    if policy == "error":
        names = ", ".join(f"'{rig.title(node)}'" for node in refused[:6])
        raise GeometryError(
            f"{len(refused)} joints have a scale that is not uniform and cannot take their new axes "
            f"exactly: {names}. Choose --on-nonuniform-scale snap or skip."
        )
    turn = turn.copy()
    for node in refused:
        wanted = turn[node].copy()
        turn[node] = _nearest_exact(rig, turn, node) if policy == "snap" else IDENTITY
        _tell(rig, node, wanted, turn[node], policy, aim_axis.get(node, 0), report)
    return turn


def _nearest_exact(rig: Rig, turn: Floats, node: int) -> Floats:
    """The nearest turn that keeps the scale diagonal: a cardinal one, with a free turn about an odd axis."""
    wanted, best, most = turn[node], IDENTITY, -1.0
    for cardinal in cardinal_turns():
        rest = multiply(wanted, conjugate(cardinal))
        for odd in (None, 0, 1, 2):
            free = np.zeros(4)
            free[3] = rest[3]
            if odd is not None:
                free[odd] = rest[odd]
            overlap = float(norm(free)) if odd is not None else abs(float(rest[3]))
            if overlap <= most + 1e-9:  # the plainer candidate wins a draw
                continue
            candidate = multiply(unit(free), cardinal) if odd is not None else cardinal
            trial = np.broadcast_to(IDENTITY, turn.shape).copy()
            trial[node] = candidate
            if scale_allows(rig, trial)[node]:
                best, most = candidate, overlap
    return np.asarray(best)


def _tell(
    rig: Rig, node: int, wanted: Floats, got: Floats, policy: Policy, axis: int, report: Report
) -> None:
    aim_error = np.degrees(angle(to_axes(wanted)[axis], to_axes(got)[axis]))
    whole = np.degrees(turn_angle(multiply(conjugate(wanted), got)))
    what = "snapped to the nearest axes" if policy == "snap" else "left as it was"
    report.warn(
        "nonuniform-scale",
        f"'{rig.title(node)}' has a scale that is not uniform: {what}, its aim is {aim_error:.3f}° "
        f"and its frame {whole:.3f}° off.",
        joint=rig.title(node),
    )
