"""Scale tables: the scales of nodes at rest and at keys, and which reorientations they allow.

A reorientation is exact for uniform scales and unit rotations. What falls short of that moves
something, by a share of how far what is below the joint reaches; where that would be
seen, the joint counts as one of non-uniform scale, or takes the delta of its parent.

Source: glTF 2.0 §3.5.3 forbids sheared nodes; docs/exactness.md, "Scale" and "Quaternions that are not unit".
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import cached_property

import numpy as np

from rigtri.frames.error_bounds import LeverArm, bearable
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.matrices import handedness
from rigtri.maths.quaternions import IDENTITY, half_turn, norm, rotates, to_axes
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Column
from rigtri.model.bindings import NodeConstraint
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig

# Scale components that differ by less (share of the largest) are one number: exporters leave
# up to 1.6e-5 of noise on characters nobody scaled. Turning them moves points by at most half
# of that times the bone's reach, a share of the size well inside the tolerance of 1e-5.
SAME_SCALE = 2e-5
# A rotation this near to a signed permutation of the axes is one.
SAME_AXIS = 1e-9
# What float64 leaves beside the diagonal of a scale that was turned exactly, as a share of the scale.
LAST_BITS = 1e-12
# How much of the tolerance all that is nearly uniform along a line of joints may use up, and all
# that is nearly unit: both are bounds that only the worst of deltas in the worst of poses reaches.
SCALES_MAY, ROTATIONS_MAY = 0.9, 0.3
# Half a unit in the last place of float32 numbers near 1, of squares and of scales.
ROUNDING = 1.2e-7
# Squares of numbers of six digits.
SIX_DIGITS = 4e-6
# Turns whose numbers differ by less are one.
SAME_TURN = 1e-6


@dataclass(frozen=True, eq=False)
class ScaleTable:
    """Every scale that nodes have, at rest and at keys (tangents are scales too).

    rows: (k, 3). owner: (k,), the node of each row. sign: (n, 3), of the scale at rest.
    apart: (n, 3), how far x and y, y and z, z and x of |S| are apart at most, as a share of the largest.
    same: (n,), how far apart they may be to count as one number: `SAME_SCALE`, or less where so
    much is below a node that it would be seen.
    """

    rows: Floats
    owner: Integers
    sign: Floats
    apart: Floats
    same: Floats

    @staticmethod
    def of(rig: Rig) -> ScaleTable:
        columns = [c for clip in rig.clips for c in clip.columns if c.path == "scale" and len(c.times)]
        sign = _signs(rig)
        rest = np.where(rig.has_matrix[:, np.newaxis], length(rig.matrix[:, :3, :3]) * sign, rig.scale)
        keys = [_scale_rows(column) for column in columns]
        many = [np.full(len(rows), rows.shape[1]) for rows in keys]
        counts = np.concatenate([np.ones(len(rig), dtype=np.int64), *many])
        nodes = np.concatenate([np.arange(len(rig)), *(column.nodes for column in columns)])
        rows = np.concatenate([rest, *(rows.reshape(-1, 3) for rows in keys)])
        owner = np.repeat(nodes, counts)
        unsigned = rows * sign[owner]
        # Of each node's rest and each of its tracks, and then of each node.
        sizes = _sizes(unsigned)
        most = np.zeros((6, len(rig)))
        np.maximum.at(most.T, nodes, np.maximum.reduceat(sizes, np.cumsum(counts) - counts, axis=1).T)
        return ScaleTable(rows, owner, sign, _apart(most), np.full(len(rig), SAME_SCALE))

    def with_rows(self, rows: Mapping[int, Floats]) -> ScaleTable:
        """The table with more scales of nodes, (k, 3) each, none of which mirrors."""
        if not rows:
            return self
        apart = self.apart.copy()
        for node, own in rows.items():
            apart[node] = np.maximum(apart[node], _apart(_sizes(own).max(axis=1)))
        owner = np.repeat(list(rows), [len(own) for own in rows.values()])
        return replace(
            self,
            rows=np.concatenate([self.rows, *rows.values()]),
            owner=np.concatenate([self.owner, owner]),
            apart=apart,
        )

    @cached_property
    def _by_owner(self) -> tuple[Integers, Integers]:
        order = np.argsort(self.owner, kind="stable")
        return order, np.searchsorted(self.owner[order], np.arange(len(self.sign) + 1))

    def of_node(self, node: int) -> Floats:
        """All scales of one node, (k, 3)."""
        order, starts = self._by_owner
        return self.rows[order[starts[node] : starts[node + 1]]]

    @cached_property
    def uneven(self) -> Booleans:
        """Which nodes, (n,), have a scale that is not uniform, beyond the noise of exporters.

        Two pairs that are alike make all three alike: otherwise a rotation about either odd axis
        would be exact but not both, and a second run would find a third.
        """
        over = self.apart > self.same[:, np.newaxis]
        return np.asarray((over & over[:, [2, 0, 1]]).any(axis=1))

    @property
    def spread(self) -> Floats:
        """The largest share by which |S| of each node is not uniform, (n,)."""
        return np.asarray(self.apart.max(axis=1))

    @property
    def noise(self) -> Floats:
        """How far apart components are that count as one number, (n,): of uneven scales those of a pair."""
        alike = np.where(self.apart <= self.same[:, np.newaxis], self.apart, 0.0).max(axis=1)
        return np.where(self.uneven, alike, self.spread)

    def keeps(self, node: int, axes: Floats) -> bool:
        """Whether C·S·C⁻¹ has nothing off its diagonal for any scale of a node, up to its noise.

        axes: the rows of C, (3, 3).
        """
        rows = self.of_node(node)
        limit = max(0.5 * self.same[node], LAST_BITS) * np.abs(rows).max()
        products = axes[[0, 1, 2]] * axes[[1, 2, 0]]
        off = sum(products[:, k] * rows[:, k, np.newaxis] for k in range(3))
        return bool((np.abs(off) <= limit).all())

    def allows(self, delta: Floats) -> Booleans:
        """Which nodes can take their delta, (n, 4), in place, (n,): C·S·C⁻¹ has to stay diagonal.

        At rest and at every key. So it does for a uniform |S|, for a signed permutation of the
        axes, and for two equal components with a rotation about the third.
        """
        allowed = np.ones(len(delta), dtype=bool)
        for node in np.flatnonzero(rotates(delta) & self.uneven).tolist():
            allowed[node] = self.keeps(node, to_axes(delta[node]))
        return allowed

    @cached_property
    def mixed(self) -> Booleans:
        """Which nodes, (n,), have a scale at rest that mirrors some of their axes and not all."""
        return np.asarray((self.sign != self.sign[:, :1]).any(axis=1))

    def fold(self, delta: Floats) -> Floats:
        """Half turns (n, 4) that a uniform scale of mixed signs stands for: S = ±|S|·half turn.

        Only of nodes whose delta, (n, 4), does not map axes to axes.
        """
        half, nodes = (
            np.tile(IDENTITY, (len(delta), 1)),
            np.flatnonzero(self.mixed & ~self.uneven & rotates(delta)),
        )
        if len(nodes):
            nodes = nodes[~_permutes(to_axes(delta[nodes]))]
            sign = self.sign[nodes]
            half[nodes] = half_turn(sign * sign.prod(axis=1, keepdims=True))
        return half


def _sizes(rows: Floats) -> Floats:
    """Of scales, (k, 3), each component, and how far x and y, y and z, z and x are apart, (6, k)."""
    x, y, z = rows.T
    return np.asarray(np.abs(np.stack([x, y, z, x - y, y - z, z - x])))


def _apart(most: Floats) -> Floats:
    """`ScaleTable.apart`, (..., 3), of the largest `_sizes`, (6, ...)."""
    largest = most[:3].max(axis=0)
    return np.asarray((most[3:] / np.where(largest == 0, 1.0, largest)).T)


def _signs(rig: Rig) -> Floats:
    """The signs of each node's scale at rest, (n, 3), ±1; three alike where only a matrix tells."""
    sign = np.where(rig.scale < 0, -1.0, 1.0)
    if not rig.has_matrix.any():
        return sign
    mirrored = handedness(rig.matrix)[:, np.newaxis]
    unknown = rig.has_matrix[:, np.newaxis] & (sign.prod(axis=1, keepdims=True) != mirrored)
    return np.where(unknown, mirrored, sign)


def _scale_rows(column: Column) -> Floats:
    """All scales of tracks, (t, r, 3); cubic tangents as what they add over the longest interval."""
    if column.interpolation != "CUBICSPLINE":
        return column.values
    longest = float(np.diff(column.times).max(initial=0.0))
    tangents = column.values[:, :, ::2].reshape(len(column), -1, 3)
    return np.concatenate([column.key_values, tangents * longest], axis=1)


def _permutes(axes: Floats) -> Booleans:
    """Which frames, (..., 3, 3), are signed permutations of the axes, (...)."""
    return np.asarray((np.abs(axes - np.rint(axes)) < SAME_AXIS).all(axis=(-1, -2)))


def same_scales(
    rig: Rig, joints: Collection[int], scales: ScaleTable, reach: LeverArm, tolerance: float
) -> Floats:
    """How far apart the components of each scale may be to count as one number, (n,).

    reach: how far what is below each node reaches; tolerance: how far anything may move, as a share of
    the size.
    """
    spread = np.zeros(len(rig))
    spread[list(joints)] = scales.noise[list(joints)]
    if spread.max(initial=0.0) <= ROUNDING:
        return scales.same
    if np.isinf(bearable(rig, _effect(spread, reach.at_most), SCALES_MAY * tolerance)):
        return scales.same
    far = reach.exact
    limit = bearable(rig, spread * far, SCALES_MAY * tolerance)
    over = spread * far > limit
    return np.where(over, np.minimum(scales.same, limit / np.where(over, far, 1.0)), scales.same)


def against_parent(rig: Rig, delta: Floats) -> Integers:
    """The nodes of rotations that are not unit and that viewers of the rig's format would show elsewhere
    after the deltas, (n, 4), for their parents take others.

    Of anything that is off by more than float32 rounding and six digits: where points are not at hand.
    """
    above = np.where((rig.parents >= 0)[:, np.newaxis], delta[rig.parents], IDENTITY)
    apart = np.minimum(np.abs(delta - above), np.abs(delta + above)).max(axis=1) > SAME_TURN
    return np.flatnonzero(apart & rig.rules.raw_quaternions & (_off_unit(rig) > SIX_DIGITS))


def ties(rig: Rig, reach: LeverArm, tolerance: float) -> tuple[NodeConstraint, ...]:
    """Each node whose rotations are not unit, tied to its parent: both must take the same delta.

    A quaternion of length L is the matrix L²·R + (1 − L²)·1 to a viewer that takes it as it is,
    and the frames C of joint and parent give C·(L²·R + (1 − L²)·1)·Cp⁻¹. That is such a matrix
    again, of the length L, where C = Cp, and else not. Only of a rig whose format says that
    viewers do so.
    """
    if not rig.rules.raw_quaternions:
        return ()
    off = _off_unit(rig)
    if off.max(initial=0.0) <= 2 * ROUNDING:
        return ()
    # A turn by δ against the parent: 2·sin(δ/2) of it.
    seen = 2.0 * off * reach.unread > tolerance
    if np.isinf(bearable(rig, _effect(2.0 * off, reach.at_most), ROTATIONS_MAY * tolerance)):
        tied = np.flatnonzero(seen).tolist()
    else:
        effect = 2.0 * off * reach.exact
        tied = np.flatnonzero(seen | (effect > bearable(rig, effect, ROTATIONS_MAY * tolerance))).tolist()
    return tuple(NodeConstraint("length", node, int(rig.parents[node]), np.zeros(3)) for node in tied)


def _effect(fault: Floats, far: Floats) -> Floats:
    """What faults move, (n,); nothing where there is none, however far anything reaches."""
    return np.where(fault > 0, fault * np.where(fault > 0, far, 0.0), 0.0)


def _off_unit(rig: Rig) -> Floats:
    """The largest | |q|² − 1 | of each node's rotations, at rest and at keys, (n,)."""
    off = np.where(rig.has_matrix, 0.0, _off(rig.rotation))
    for column in (c for clip in rig.clips for c in clip.columns if c.path == "rotation"):
        for rows, values in column.parts():
            np.maximum.at(off, column.nodes[rows], _off(values).max(axis=1, initial=0.0))
    return np.asarray(off)


def _off(q: Floats) -> Floats:
    size = norm(q)
    away = np.abs(size * size - 1.0)
    return np.where(np.isfinite(away), away, 0.0)
