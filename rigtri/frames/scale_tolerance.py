"""Tolerances: nearly uniform scales and nearly unit rotations that count as exact.

A reorientation is exact for uniform scales and unit rotations. What falls short of that moves
something, by a share of how far what hangs at the joint reaches; where that would be
seen, the joint counts as one of non-uniform scale, or takes the delta of its parent.

Source: docs/exactness.md, "Scale" and "Quaternions that are not unit".
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from rigtri.frames.error_bounds import LeverArm, bearable
from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.maths.arrays import Integers
from rigtri.maths.quaternions import IDENTITY, norm
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import key_values
from rigtri.model.bindings import NodeConstraint
from rigtri.model.rig import Rig

# How much of the tolerance all that is nearly uniform along a line of joints may use up, and all
# that is nearly unit: both are bounds that only the worst of deltas in the worst of poses reaches.
SCALES_MAY, ROTATIONS_MAY = 0.9, 0.3
# Half a unit in the last place of float32 numbers near 1, of squares and of scales.
ROUNDING = 1.2e-7

# Squares of numbers of six digits.
SIX_DIGITS = 4e-6
# Turns whose numbers differ by less are one.
SAME_TURN = 1e-6


def same_scales(
    rig: Rig, joints: Collection[int], scales: ScaleTable, reach: LeverArm, tolerance: float
) -> Floats:
    """How far apart the components of each scale may be to count as one number, (n,).

    reach: how far what hangs at each node reaches; tolerance: how far anything may move, as a share of
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
    if np.isinf(bearable(rig, _effect(2.0 * off, reach.at_most), ROTATIONS_MAY * tolerance)):
        return ()
    effect = 2.0 * off * reach.exact
    tied = np.flatnonzero(effect > bearable(rig, effect, ROTATIONS_MAY * tolerance)).tolist()
    return tuple(NodeConstraint("length", node, int(rig.parents[node]), np.zeros(3)) for node in tied)


def _effect(fault: Floats, far: Floats) -> Floats:
    """What faults move, (n,); nothing where there is none, however far anything reaches."""
    return np.where(fault > 0, fault * np.where(fault > 0, far, 0.0), 0.0)


def _off_unit(rig: Rig) -> Floats:
    """The largest | |q|² − 1 | of each node's rotations, at rest and at keys, (n,)."""
    off = np.where(rig.has_matrix, 0.0, _off(rig.rotation))
    for track in (t for clip in rig.clips for t in clip.tracks if t.path == "rotation"):
        off[track.node] = max(off[track.node], float(_off(key_values(track)).max(initial=0.0)))
    return np.asarray(off)


def _off(q: Floats) -> Floats:
    size = norm(q)
    away = np.abs(size * size - 1.0)
    return np.where(np.isfinite(away), away, 0.0)
