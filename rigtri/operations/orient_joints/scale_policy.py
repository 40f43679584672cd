"""What becomes of a turn where a joint's own scale is not uniform.

In place is exact when C·S·C⁻¹ stays diagonal at rest and at every key; else the
turn is replaced by the nearest one that is (`snap`), given up (`skip`), held by a
node of its own above the joint (`split`), or an error.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from rigtri.errors import GeometryError
from rigtri.frames.nonuniform_scale import SAME_SCALE, ScaleTable
from rigtri.maths.quaternions import (
    IDENTITY,
    conjugate,
    from_axes,
    from_axis_angle,
    multiply,
    norm,
    rotates,
    rotation_angle,
    to_axes,
    unit,
)
from rigtri.maths.trigonometry import Floats, arc_tangent
from rigtri.maths.vectors import angle, cross, dot
from rigtri.model.animation import key_values
from rigtri.model.rig import Rig
from rigtri.report import Report

# A turn and its nearest exact one are the same below this (radians).
EXACT = 1e-9
# Aims whose cosines differ by less are equally near.
SAME_AIM = 1e-7

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


def splits(
    rig: Rig, turn: Floats, axes: Mapping[int, tuple[int, int]], scales: ScaleTable
) -> dict[int, Floats]:
    """The joints, with their turns (4,), that can take them only by a node of their own.

    axes: per joint the indices of its aim and up axes. The turns are those of the joints'
    rotations: where a scale mirrors, the third axis gives way, for the new node does not.
    """
    uneven = np.flatnonzero(rotates(turn) & scales.uneven).tolist()
    exact = {k: nearest_exact(turn[k], scales, k, axes.get(k, (0, 1))[0]) for k in uneven}
    return {
        node: _unmirrored(turn[node], scales.sign[node], axes.get(node, (0, 1)))
        for node in uneven
        if _apart(exact[node], turn[node]) > EXACT
    }


def _unmirrored(turn: Floats, sign: Floats, axes: tuple[int, int]) -> Floats:
    """The turn, (4,), of a joint's rotation that brings aim and up where one of its mirrored axes does."""
    if (sign > 0).all():
        return turn
    rows = to_axes(turn) * sign
    rows[3 - sum(axes)] *= sign.prod()
    return from_axes(rows)


def axes_taken(axes: Floats, policy: Policy, kept: tuple[int, int], scales: ScaleTable, node: int) -> Floats:
    """The axes, (3, 3) rows in its own frame, that a node of uneven scale gets of those wanted.

    kept: the indices of its aim and up axes, for the third may give way.
    """
    wanted = from_axes(axes)
    exact = nearest_exact(wanted, scales, node, kept[0])
    if policy == "snap" or _apart(exact, wanted) <= EXACT:
        return to_axes(exact)
    if policy == "skip":
        return np.eye(3)
    axes = axes.copy()
    axes[3 - sum(kept)] *= scales.sign[node].prod()  # the node of a split does not mirror
    return axes


def allowed_turns(
    rig: Rig, turn: Floats, policy: Policy, aim_axis: Mapping[int, int], scales: ScaleTable, report: Report
) -> Floats:
    """Turns, (n, 4), of which each is exact in place; what had to give way is reported.

    aim_axis: per joint the index of its aim axis, to state the aim's error.
    Raises GeometryError with the policy ``error``.
    """
    uneven = np.flatnonzero(rotates(turn) & scales.uneven).tolist()
    if not uneven:
        return turn
    exact = turn.copy()
    for node in uneven:
        exact[node] = nearest_exact(turn[node], scales, node, aim_axis.get(node, 0))
    refused = [node for node in uneven if _apart(exact[node], turn[node]) > EXACT]
    if refused and policy == "error":
        names = ", ".join(f"'{rig.title(k)}' ({first_uneven(rig, k, scales)})" for k in refused[:6])
        raise GeometryError(
            f"{len(refused)} joints have a scale that is not uniform and cannot take their new axes "
            f"exactly: {names}. Choose --on-nonuniform-scale snap, split or skip."
        )
    for node in refused:
        if policy == "skip":
            exact[node] = IDENTITY
        _tell(rig, node, turn[node], exact[node], policy, aim_axis.get(node, 0), scales, report)
    return exact


def _apart(a: Floats, b: Floats) -> float:
    return float(rotation_angle(multiply(conjugate(a), b)))


def nearest_exact(wanted: Floats, scales: ScaleTable, node: int, aim: int) -> Floats:
    """The nearest turn, (4,), that keeps every scale of a node diagonal: by its aim, then as a whole.

    A cardinal turn, with a free turn about an axis whose other two components are
    equal throughout. A small turn of a nearly uniform scale is not let through: it
    would drift a little further with every run; and the aim goes first, so that a
    second run, which sees other axes about the same aim, stays with its choice.
    """
    quarter = [from_axis_angle(axis, np.pi / 4) for axis in np.eye(3)]
    odd = [k for k in range(3) if scales.keeps(node, to_axes(quarter[k]))]
    target = to_axes(wanted)[aim]
    best, closest, most = IDENTITY, -2.0, -1.0
    for cardinal in cardinal_turns():
        for axis in odd or (None,):
            candidate = cardinal if axis is None else _freed(cardinal, axis, wanted, aim)
            aimed = float(dot(to_axes(candidate)[aim], target))
            products = candidate * wanted
            overlap = abs(float(products[0] + products[1] + products[2] + products[3]))
            nearer = aimed > closest + SAME_AIM
            if nearer or (aimed > closest - SAME_AIM and overlap > most + EXACT):
                best, closest, most = candidate, aimed, overlap
    return np.asarray(np.where(best[3] < 0, -best, best))


def _freed(cardinal: Floats, axis: int, wanted: Floats, aim: int) -> Floats:
    """A cardinal turn, then turned about an axis to bring its aim, or else all of it, near ``wanted``."""
    now, target = to_axes(cardinal)[aim], to_axes(wanted)[aim]
    about = np.eye(3)[axis]
    if abs(now[axis]) > 0.5:  # the aim lies along the axis: only the roll is free
        rest = multiply(wanted, conjugate(cardinal))
        free = about * rest[axis]
        turn = np.array([free[0], free[1], free[2], rest[3]])
        return multiply(unit(turn), cardinal) if norm(turn) > EXACT else cardinal
    angle_ = arc_tangent(dot(cross(about, now), target), dot(now, target))
    return multiply(from_axis_angle(about, angle_), cardinal)


@dataclass(frozen=True)
class Uneven:
    """A scale that is not uniform: at rest, or at the first key of a clip where it is not."""

    value: tuple[float, float, float]
    clip: str | None = None
    time: float | None = None

    def __str__(self) -> str:
        words = " ".join(f"{x:.6g}" for x in self.value)
        return words if self.clip is None else f"{words} in {self.clip} at {self.time:.6g}"

    def as_json(self) -> dict[str, Any]:
        return {"value": list(self.value), "clip": self.clip, "time": self.time}


def first_uneven(rig: Rig, node: int, scales: ScaleTable) -> Uneven:
    """Where the scale of a node that has one is first seen not to be uniform."""
    found = [Uneven(_three(scales.rows[node]))]
    found += [
        Uneven(_three(row), clip.name or f"#{k}", float(time))
        for k, clip in enumerate(rig.clips)
        for track in clip.tracks
        if track.node == node and track.path == "scale"
        for time, row in zip(track.times, key_values(track), strict=True)
    ]
    rows = np.array([uneven.value for uneven in found])
    largest = np.abs(rows).max(axis=1)
    spread = np.ptp(rows * scales.sign[node], axis=1) / np.where(largest == 0, 1.0, largest)
    over = spread > scales.same[node]
    return found[int(np.argmax(over if over.any() else spread))]


def _three(row: Floats) -> tuple[float, float, float]:
    x, y, z = row.tolist()
    return x, y, z


def _tell(
    rig: Rig,
    node: int,
    wanted: Floats,
    got: Floats,
    policy: Policy,
    axis: int,
    scales: ScaleTable,
    report: Report,
) -> None:
    aim_error = np.degrees(angle(to_axes(wanted)[axis], to_axes(got)[axis]))
    whole = np.degrees(_apart(wanted, got))
    what = "snapped to the nearest axes" if policy == "snap" else "left as it was"
    scale, spread = str(first_uneven(rig, node, scales)), float(scales.spread[node])
    if scales.same[node] < SAME_SCALE:  # noise, but of something long
        scale += f", by {spread:.2g}, and what hangs there reaches so far that it would be seen"
    report.warn(
        "nonuniform-scale",
        f"'{rig.title(node)}' has a scale that is not uniform ({scale}): {what}, its aim is "
        f"{aim_error:.3f}° and its frame {whole:.3f}° off.",
        joint=rig.title(node),
    )
