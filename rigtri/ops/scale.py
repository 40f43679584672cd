"""What becomes of a turn where a joint's own scale is not uniform.

In place is exact when C·S·C⁻¹ stays diagonal at rest and at every key; else the
turn is replaced by the nearest one that is (`snap`), given up (`skip`), held by a
node of its own above the joint (`split`), or an error.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from rigtri.errors import GeometryError
from rigtri.quaternions import (
    IDENTITY,
    conjugate,
    from_axes,
    from_axis_angle,
    multiply,
    norm,
    to_axes,
    turn_angle,
    unit,
)
from rigtri.reframe import Scales, stays_diagonal, turned
from rigtri.report import Report
from rigtri.rig import Rig
from rigtri.trigonometry import Floats
from rigtri.vectors import angle, cross

# A turn and its nearest exact one are the same below this (radians).
EXACT = 1e-9

Policy = Literal["snap", "skip", "split", "error"]


def cardinal_turns() -> Floats:
    """The 24 turns that take axes onto axes, (24, 4)."""
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    frames = [np.stack([x, y, cross(x, y)]) for x in axes for y in axes if not (np.abs(x) == np.abs(y)).all()]
    return from_axes(np.stack(frames))


def nearest_cardinal(turn: Floats) -> Floats:
    """The cardinal turn nearest to a turn, (4,), by the angle between them."""
    turns = cardinal_turns()
    products = turns * turn
    overlap = np.abs(products[:, 0] + products[:, 1] + products[:, 2] + products[:, 3])
    return np.asarray(turns[int(np.argmax(overlap))])


def splits(rig: Rig, turn: Floats) -> dict[int, Floats]:
    """The joints, with their turns (4,), that can take them only by a node of their own."""
    scales = Scales.of(rig)
    uneven = np.flatnonzero(turned(turn) & scales.uneven).tolist()
    exact = {node: _nearest_exact(turn[node], scales.rows[scales.owner == node]) for node in uneven}
    return {node: turn[node] for node in uneven if _apart(exact[node], turn[node]) > EXACT}


def allowed_turns(rig: Rig, turn: Floats, policy: Policy, aim_axis: dict[int, int], report: Report) -> Floats:
    """Turns, (n, 4), of which each is exact in place; what had to give way is reported.

    aim_axis: per joint the index of its aim axis, to state the aim's error.
    Raises GeometryError with the policy ``error``.
    """
    scales = Scales.of(rig)
    uneven = np.flatnonzero(turned(turn) & scales.uneven).tolist()
    if not uneven:
        return turn
    exact = turn.copy()
    for node in uneven:
        exact[node] = _nearest_exact(turn[node], scales.rows[scales.owner == node])
    refused = [node for node in uneven if _apart(exact[node], turn[node]) > EXACT]
    if refused and policy == "error":
        names = ", ".join(f"'{rig.title(node)}'" for node in refused[:6])
        raise GeometryError(
            f"{len(refused)} joints have a scale that is not uniform and cannot take their new axes "
            f"exactly: {names}. Choose --on-nonuniform-scale snap or skip."
        )
    for node in refused:
        if policy == "skip":
            exact[node] = IDENTITY
        _tell(rig, node, turn[node], exact[node], policy, aim_axis.get(node, 0), report)
    return exact


def _apart(a: Floats, b: Floats) -> float:
    return float(turn_angle(multiply(conjugate(a), b)))


def _nearest_exact(wanted: Floats, rows: Floats) -> Floats:
    """The nearest turn that keeps every scale, (k, 3), diagonal.

    A cardinal turn, with a free turn about an axis whose other two components are
    equal throughout. A small turn of a nearly uniform scale is not let through: it
    would drift a little further with every run.
    """
    quarter = [from_axis_angle(axis, np.pi / 4) for axis in np.eye(3)]
    odd = [k for k in range(3) if stays_diagonal(to_axes(quarter[k]), rows)]
    best, most = IDENTITY, -1.0
    for cardinal in cardinal_turns():
        rest = multiply(wanted, conjugate(cardinal))
        for axis in odd or (None,):
            free = np.zeros(4)
            free[3] = rest[3]
            if axis is not None:
                free[axis] = rest[axis]
            overlap = float(norm(free))
            if overlap > most + EXACT:  # the first of equals, so that a second run chooses alike
                best, most = multiply(unit(free), cardinal), overlap
    return np.asarray(np.where(best[3] < 0, -best, best))


def _tell(
    rig: Rig, node: int, wanted: Floats, got: Floats, policy: Policy, axis: int, report: Report
) -> None:
    aim_error = np.degrees(angle(to_axes(wanted)[axis], to_axes(got)[axis]))
    whole = np.degrees(_apart(wanted, got))
    what = "snapped to the nearest axes" if policy == "snap" else "left as it was"
    report.warn(
        "nonuniform-scale",
        f"'{rig.title(node)}' has a scale that is not uniform: {what}, its aim is {aim_error:.3f}° "
        f"and its frame {whole:.3f}° off.",
        joint=rig.title(node),
    )
