"""Two-bone IK, analytic, all frames at once: a triangle that reaches a target and bends to a pole's side.

Source: R. Katz, "Rigging with Triangles", GDC 2018 (the triangle of a limb, pole vector); the law
of cosines; A. Nicholas, "Soft IK", 2009 (the reach that never quite becomes straight).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigtri.evaluation.pole_lean import ON_LINE, STRAIGHT, leaned, leaning
from rigtri.maths.arrays import Booleans
from rigtri.maths.quaternions import from_axes, multiply
from rigtri.maths.ranking import axis_across
from rigtri.maths.trigonometry import Floats, exponential, sin_cos
from rigtri.maths.vectors import cross, dot, length, normalise

# As a share of the limb: a target nearer than this to the root gives no direction.
NOWHERE = 1e-6
# A limb that rests straight bends by the root of what rounding does to its reach: by 2e-4 radians for 3e-8.
# Up to how far a target is taken to be where the limb ends at rest, some roundings of float32, and up to
# how many times that this is felt.
_SETTLES, _FELT = 2e-7, 4.0
# Up to how near to straight a limb gets a target beyond its end, by as much, however later edits round it.
_PAST = 2e-6
# How many ways of slowing down a target may be off; steps of Newton's method that reach it in all digits.
BEYOND, _NEWTON = 5.0, 12


class Solved(NamedTuple):
    """The frames, xyzw (f, 4), of the upper and the lower bone: x along the bone, z about which it
    bends; how much longer bones are made, (f,); how far short of the target the end stays, (f,), in
    file units; and where target or pole gives no direction, (f,) bool.
    """

    upper: Floats
    lower: Floats
    stretch: Floats
    short: Floats
    lost: Booleans


def two_bone(
    root: Floats,
    lengths: tuple[Floats, Floats],
    target: Floats,
    pole: Floats,
    *,
    root_to_end: Floats,
    side: Floats,
    soft: float = 0.0,
    stretch: bool = False,
    at_rest: float = 0.0,
    lean: float = 0.0,
) -> Solved:
    """Solve a limb that starts at ``root``, (f, 3), and whose bones have ``lengths``, (f,) each.

    target, pole: (f, 3), in the world. root_to_end, side: (f, 3), what holds where the target stands at
    the root, or the pole on the line to the target. soft: as a share of the limb, how far before
    it is straight it slows down. stretch: bones grow so that the end reaches the target. at_rest: how far
    the end is from the root at rest, as a share of the limb. lean: by how much the limb is bent beside its
    pole there, in radians (`leaning`).
    """
    first, second = lengths
    total = first + second
    away = target - root
    distance = _settled(length(away), total, at_rest)
    near = distance <= NOWHERE * total
    along = np.where(near[..., np.newaxis], normalise(root_to_end), normalise(away))
    reach = np.maximum(_reach(distance, total, soft), np.abs(first - second))
    growth = np.ones_like(reach)
    if stretch:
        grows = (distance > reach) & (reach > 0)
        growth = np.where(grows, distance / np.where(grows, reach, 1.0), 1.0)
    bends, poleless = sides(along, pole - root, side, total)
    leans = leaning(reach, total, at_rest, lean)
    bends = leaned(bends, along, leans)
    high = _height(first, second, reach)
    with np.errstate(invalid="ignore", divide="ignore"):
        projection = (reach * reach + first * first - second * second) / (2.0 * reach)
    projection = np.where(reach > 0, projection, 0.0)  # both bones as long, and folded: all the way aside
    high = np.where(reach > 0, high, first)
    mid = projection[..., np.newaxis] * along + high[..., np.newaxis] * bends
    hinge = cross(along, bends)
    rest = reach[..., np.newaxis] * along - mid
    return Solved(
        bone_frame(mid, hinge, leans),
        bone_frame(rest, hinge, leans),
        growth,
        np.maximum(distance - reach * growth, 0.0),
        np.asarray(near | poleless),
    )


def _settled(distance: Floats, total: Floats, at_rest: float) -> Floats:
    """How far off targets are, (f,); of a straight limb those beside where it rests are there."""
    if at_rest < 1.0 - STRAIGHT:
        return distance
    off = distance / total - at_rest
    beside = np.abs(off)
    felt = (beside - _SETTLES) * (_FELT / (_FELT - 1.0))
    settled = at_rest + np.where(off < 0, -1.0, 1.0) * np.maximum(felt, 0.0)
    return np.where(beside < _FELT * _SETTLES, settled * total, distance)


def _reach(distance: Floats, total: Floats, soft: float) -> Floats:
    """How far the end goes, (f,): as far as the target, at most the whole limb."""
    if soft <= 0:
        return np.minimum(distance, total)
    last = soft * total
    first = total - last
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        slow = first + last * (1.0 - exponential(-np.maximum(distance - first, 0.0) / last))
    return np.where((distance > first) & (last > 0), np.minimum(slow, total), np.minimum(distance, total))


def distance_for(reach: Floats, total: Floats, soft: float, at_rest: float = 0.0) -> Floats:
    """How far off, (f,), a target is for which a limb's end goes as far as ``reach``, (f,).

    The inverse of what `two_bone` makes of the distance. A limb that is nearly straight would need a
    target at any distance: it is at most `BEYOND` of the ways over which the limb slows down, from
    where it begins to. A hard limb that is straight, but not at rest (`_settled`), has its target a little
    beyond it. at_rest: how far the end is from the root at rest, as a share of the limb.
    """
    if soft <= 0:
        straight = (reach > (1.0 - _PAST) * total) & (at_rest < 1.0 - STRAIGHT)
        return np.where(straight, np.maximum(reach, (1.0 + _PAST) * total), reach)
    last = soft * total
    first = total - last
    with np.errstate(invalid="ignore", divide="ignore"):
        left = np.where(last > 0, (total - reach) / last, 1.0)
    left = np.clip(left, exponential(-BEYOND), 1.0)
    ways = np.zeros_like(left)
    for _ in range(_NEWTON):  # e^-ways = left, by Newton's method, which comes from below
        ways = ways + 1.0 - left / exponential(-ways)
    return np.where(reach > first, first + last * ways, reach)


def sides(along: Floats, pole: Floats, side: Floats, total: Floats) -> tuple[Floats, Booleans]:
    """Unit directions, (f, 3), square to ``along``, on the pole's side; and where the pole gives none."""
    across = pole - dot(pole, along)[..., np.newaxis] * along
    lost = length(across) <= ON_LINE * total
    own = side - dot(side, along)[..., np.newaxis] * along
    # A limb that points where its side was: any direction is as good, the same one every time.
    aside = cross(along, axis_across(along))
    own = np.where((length(own) <= NOWHERE)[..., np.newaxis], aside, own)
    return normalise(np.where(lost[..., np.newaxis], own, across)), lost


def _height(first: Floats, second: Floats, reach: Floats) -> Floats:
    """The height of the triangle over the side ``reach``, (f,).

    Source: W. Kahan, "Miscalculating area and angles of a needle-like triangle", 2014: from
    products of sums, so that a nearly straight limb keeps its digits.
    """
    around = (
        (first + second + reach)
        * (first + second - reach)
        * (reach + first - second)
        * (reach - first + second)
    )
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.sqrt(np.maximum(around, 0.0)) / (2.0 * reach)


def bone_frame(bone: Floats, hinge: Floats, leans: Floats | None = None) -> Floats:
    """The turn, (f, 4), whose x axis lies along a bone and z along the hinge, square to it.

    leans: radians, (f,), by how much the hinge is turned about the line from root to end. The bone does not
    roll with it.
    """
    x = normalise(bone)
    x = np.where(np.isfinite(x), x, np.array([1.0, 0.0, 0.0]))
    turn = from_axes(np.stack([x, cross(hinge, x), hinge], axis=-2))
    if leans is None:
        return turn
    sines, cosines = sin_cos(-0.5 * leans)
    none = np.zeros_like(sines)
    return multiply(turn, np.stack([sines, none, none, cosines], axis=-1))
