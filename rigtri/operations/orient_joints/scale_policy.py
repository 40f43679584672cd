"""The policy for joints whose own scale is not uniform.

A reorientation is exact in place when C·S·C⁻¹ stays diagonal at rest and at every key; else it is
replaced by the nearest one that is (`snap`), given up (`skip`), held by a node of its own above the
joint (`split`), or an error.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from rigtri.errors import GeometryError
from rigtri.frames.nonuniform_scale import SAME_SCALE, ScaleTable
from rigtri.maths import quaternions
from rigtri.maths.quaternions import (
    IDENTITY,
    angle_between,
    conjugate,
    from_axes,
    from_axis_angle,
    multiply,
    norm,
    rotates,
    to_axes,
    unit,
)
from rigtri.maths.ranking import first_largest
from rigtri.maths.triangle import axis_of
from rigtri.maths.trigonometry import Floats, arc_tangent
from rigtri.maths.vectors import angle, cross, dot, triple
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.operations.axis_presets import AxisStyle
from rigtri.operations.option_kinds import NonuniformScale
from rigtri.report import Report

# A delta and its nearest exact one are the same below this (radians).
EXACT = 1e-9
# Aims whose cosines differ by less are equally near.
SAME_AIM = 1e-7


@cache
def cardinal_rotations() -> Floats:
    """The 24 rotations that take axes onto axes, (24, 4)."""
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    frames = [np.stack([x, y, cross(x, y)]) for x in axes for y in axes if not (np.abs(x) == np.abs(y)).all()]
    return from_axes(np.stack(frames))


def nearest_cardinal(delta: Floats) -> Floats:
    """The cardinal rotations nearest to deltas, (k, 4), by the angle between them."""
    rotations = cardinal_rotations()
    overlap = np.abs(quaternions.dot(rotations, delta[:, np.newaxis]))
    return np.asarray(rotations[[first_largest(each) for each in overlap]])


@dataclass(frozen=True, eq=False)
class ScalePolicy:
    """What is to become of joints whose scale is not uniform.

    unsplittable: nodes whose own rotation a constraint reads or writes, or is not unit: it must stay
    with them. givers: controls, and nodes that constraints follow, that give a scale that is not uniform.
    """

    policy: NonuniformScale
    rig: Rig
    scales: ScaleTable
    unsplittable: frozenset[int]
    givers: Mapping[int, int]

    @property
    def in_place(self) -> NonuniformScale:
        """The policy for joints that keep their own node."""
        return "skip" if self.policy == "split" else self.policy

    def axes_taken(self, axes: Floats, node: int, style: AxisStyle) -> Floats:
        """The axes, (3, 3) rows in its own frame, that a node gets of those requested."""
        scales = self.scales
        if not scales.uneven[node] or node in self.rig.frame_of:
            return axes
        aim, up = _axes_of(style)
        requested = from_axes(axes)
        exact = nearest_exact(requested, scales, node, aim)
        policy = self.in_place if node in self.unsplittable else self.policy
        if policy == "snap" or angle_between(exact, requested) <= EXACT:
            return to_axes(exact)
        if policy == "skip":
            return np.eye(3)
        axes = axes.copy()
        axes[3 - aim - up] *= scales.sign[node].prod()  # the node of a split does not mirror
        return axes

    def splits(self, delta: Floats, styles: Mapping[int, AxisStyle]) -> dict[int, Floats]:
        """The joints, with their deltas (4,), that can take them only by a node of their own.

        delta: (n, 4), of the joints' rotations: where a scale mirrors, the third axis gives way,
        for the new node does not.
        """
        if self.policy != "split":
            return {}
        found = {}
        for node in self.refused(delta, self.nearest(delta, styles)):
            axes = _axes_of(styles[node]) if node in styles else (0, 1)
            found[node] = _unmirrored(delta[node], self.scales.sign[node], axes)
        return found

    def allowed(self, delta: Floats, styles: Mapping[int, AxisStyle], report: Report) -> Floats:
        """Deltas, (n, 4), of which each is exact in place; what had to give way is reported.

        Raises GeometryError with the policy ``error``.
        """
        rig = self.rig
        exact, nearest = delta.copy(), self.nearest(delta, styles)
        for node, allowed in nearest.items():
            exact[node] = allowed
        refused = self.refused(delta, nearest)
        if refused and self.policy == "error":
            names = ", ".join(f"'{rig.title(k)}' ({self.uneven_at(k)})" for k in refused[:6])
            raise GeometryError(
                f"{len(refused)} joints have a scale that is not uniform and cannot take their new axes "
                f"exactly: {names}. Choose --on-nonuniform-scale snap, split or skip."
            )
        for node in refused:
            if self.in_place == "skip":
                exact[node] = IDENTITY
        # The one that is farthest off first: of many, only a few are shown.
        off = dict(zip(refused, angle_between(delta[refused], exact[refused]).tolist(), strict=True))
        for node in sorted(refused, key=lambda node: -round(off[node], 6)):
            aim = _axes_of(styles[node])[0] if node in styles else 0
            self._warn(node, delta[node], exact[node], aim, report, refused)
            refused = []
        return exact

    def nearest(self, delta: Floats, styles: Mapping[int, AxisStyle]) -> dict[int, Floats]:
        """Of deltas, (n, 4), the nearest, (4,), that each node of non-uniform scale can take in place."""
        nodes = np.flatnonzero(rotates(delta) & self.scales.uneven).tolist()
        aims = [_axes_of(styles[node])[0] if node in styles else 0 for node in nodes]
        return {
            node: nearest_exact(delta[node], self.scales, node, aim)
            for node, aim in zip(nodes, aims, strict=True)
        }

    def uneven_at(self, node: int) -> Uneven:
        """Where the scale of a joint, or of what gives it one, is first not uniform."""
        giver = self.givers.get(node)
        found = first_uneven(self.rig, node if giver is None else giver, self.scales)
        return found if giver is None else replace(found, giver=self.rig.title(giver))

    @staticmethod
    def refused(delta: Floats, nearest: Mapping[int, Floats]) -> list[int]:
        """The nodes whose delta, (n, 4), is not the `nearest` one that they can take."""
        nodes = list(nearest)
        off = angle_between(np.array([nearest[node] for node in nodes]).reshape(-1, 4), delta[nodes])
        return [node for node, angle in zip(nodes, off.tolist(), strict=True) if angle > EXACT]

    def _warn(
        self, node: int, requested: Floats, got: Floats, aim: int, report: Report, alike: list[int]
    ) -> None:
        """alike: with the first warning, all nodes that it is of."""
        name, scales = self.rig.title(node), self.scales
        aim_error = np.degrees(angle(to_axes(requested)[aim], to_axes(got)[aim]))
        whole = np.degrees(angle_between(requested, got))
        what = "snapped to the nearest axes" if self.in_place == "snap" else "left as it was"
        scale, spread = str(self.uneven_at(node)), float(scales.spread[node])
        if scales.same[node] < SAME_SCALE:  # noise, but of something long
            scale += f", by {spread:.2g}, and what it moves reaches so far that it would be seen"
        remedy = ""
        if alike:
            most = f" It is the farthest off of {len(alike)}." if len(alike) > 1 else ""
            remedy = f"{most} With --on-nonuniform-scale split, a new parent holds exact axes."
        report.warn(
            "nonuniform-scale",
            f"'{name}' has a scale that is not uniform ({scale}): {what}, its aim is "
            f"{aim_error:.3f}° and its frame {whole:.3f}° off.{remedy}",
            joint=name,
        )


def _axes_of(style: AxisStyle) -> tuple[int, int]:
    """The indices of a style's aim and up axes."""
    return axis_of(style.aim)[0], axis_of(style.up)[0]


def _unmirrored(delta: Floats, sign: Floats, axes: tuple[int, int]) -> Floats:
    """The delta, (4,), of a joint's rotation that brings aim and up where one of its mirrored axes does."""
    if (sign > 0).all():
        return delta
    rows = to_axes(delta) * sign
    rows[3 - sum(axes)] *= sign.prod()
    return from_axes(rows)


def nearest_exact(requested: Floats, scales: ScaleTable, node: int, aim: int) -> Floats:
    """The nearest delta, (4,), that keeps every scale of a node diagonal: by its aim, then as a whole.

    A cardinal rotation, with a free rotation about an axis whose other two components are
    equal throughout. A small delta of a nearly uniform scale is not let through: it
    would drift a little further with every run; and the aim goes first, so that a
    second run, which sees other axes about the same aim, stays with its choice.
    """
    odd = [k for k, eighth in enumerate(_eighths()) if scales.keeps(node, eighth)]
    cardinals = cardinal_rotations()
    candidates = np.stack([_freed(cardinals, axis, requested, aim) for axis in odd] or [cardinals], axis=1)
    aims = dot(to_axes(candidates)[..., aim, :], to_axes(requested)[aim])
    overlaps = np.abs(quaternions.dot(candidates, requested))
    best, closest, most = IDENTITY, -2.0, -1.0
    for candidate, aimed, overlap in zip(
        candidates.reshape(-1, 4), aims.ravel().tolist(), overlaps.ravel().tolist(), strict=True
    ):
        nearer = aimed > closest + SAME_AIM
        if nearer or (aimed > closest - SAME_AIM and overlap > most + EXACT):
            best, closest, most = candidate, aimed, overlap
    return np.asarray(np.where(best[3] < 0, -best, best))


@cache
def _eighths() -> Floats:
    """The axes, (3, 3, 3), of an eighth of a turn about each axis."""
    return to_axes(from_axis_angle(np.eye(3), np.pi / 4))


def _freed(cardinals: Floats, axis: int, requested: Floats, aim: int) -> Floats:
    """Cardinal rotations, (c, 4), each then about an axis so that its aim, or all of it, is near a delta."""
    now, target = to_axes(cardinals)[:, aim], to_axes(requested)[aim]
    about = np.eye(3)[axis]
    # Where the aim lies along the axis, only the roll is free.
    rest = multiply(requested, conjugate(cardinals))
    roll = np.concatenate([about * rest[:, axis : axis + 1], rest[:, 3:]], axis=1)
    with np.errstate(invalid="ignore"):
        rolled = np.where(norm(roll)[:, np.newaxis] > EXACT, multiply(unit(roll), cardinals), cardinals)
    angles = arc_tangent(dot(cross(about, now), target), dot(now, target))
    aimed = multiply(from_axis_angle(about, angles), cardinals)
    return np.where(np.abs(now[:, axis : axis + 1]) > 0.5, rolled, aimed)


@dataclass(frozen=True)
class Uneven:
    """A scale that is not uniform: at rest, or at the first key of a clip where it, or a tangent, is not."""

    value: tuple[float, float, float]
    clip: str | None = None
    time: float | None = None
    tangent: bool = False
    giver: str | None = None

    def __str__(self) -> str:
        words = " ".join(f"{x:.6g}" for x in self.value)
        words = f"tangent {words}" if self.tangent else words
        words = f"'{self.giver}' {words}" if self.giver is not None else words
        return words if self.clip is None else f"{words} in {self.clip} at {self.time:.6g}"

    def as_json(self) -> dict[str, Any]:
        return {"value": list(self.value), "clip": self.clip, "time": self.time}


def first_uneven(rig: Rig, node: int, scales: ScaleTable) -> Uneven:
    """Where the scale of a node that has one is first seen not to be uniform."""
    columns = [
        (clip.name or f"#{k}", column, row)
        for k, clip in enumerate(rig.clips)
        for column in clip.columns
        if column.path == "scale"
        for row in np.flatnonzero(column.nodes == node).tolist()
    ]
    found = [(name, c.times, c.key_values[row], False) for name, c, row in columns]
    found += [
        (name, np.repeat(c.times, 2), c.values[row, :, ::2].reshape(-1, 3), True)
        for name, c, row in columns
        if c.interpolation == "CUBICSPLINE"
    ]
    rows = np.concatenate([scales.rows[[node]], *(values for _, _, values, _ in found)])
    largest = np.abs(rows).max(axis=1)
    spread = np.ptp(rows * scales.sign[node], axis=1) / np.where(largest == 0, 1.0, largest)
    over = spread > scales.same[node]
    first = int(np.argmax(over)) if over.any() else first_largest(spread)
    key = first - 1
    for name, times, _, tangent in found if first else ():
        if key < len(times):
            return Uneven(triple(rows[first]), name, float(times[key]), tangent)
        key -= len(times)
    return Uneven(triple(rows[first]))
