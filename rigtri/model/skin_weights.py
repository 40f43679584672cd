"""Weights of a bone's points shared anew among joints along it; what each point has of them stays."""

from __future__ import annotations

import numpy as np

from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot
from rigtri.model.skin import WeightLimit, WeightRedistribution

# A share this near to none or all is none or all: it would cost an influence and show nothing.
NEGLIGIBLE_SHARE = 1e-3
# Weights that differ by less are the ones that were there.
SAME = 1e-6


def along(redistribution: WeightRedistribution, points: Floats) -> Floats:
    """Where points, (v, 3), stand along the bone, (v,): 0 at its start, 1 at its end."""
    line = redistribution.end - redistribution.start
    return np.asarray(dot(points - redistribution.start, line) / dot(line, line))


def shared(
    redistribution: WeightRedistribution,
    points: Floats,
    joints: Integers,
    weights: Floats,
    *,
    units: bool = False,
) -> tuple[Integers, Floats]:
    """Joints (v, k) and weights (v, k), k as before or one more, after a redistribution.

    points: (v, 3), as ``Mesh.bind`` leaves them. What a point has of the redistribution's joints together
    goes to the two nearest along the bone, linear between them: the first of the two takes
    the place that the first of them had, by which `folded` finds it again. units: weights are whole
    numbers and stay so. What was so already keeps its bits and its place.
    """
    mine = np.isin(joints, redistribution.joints) & (weights != 0)
    touched = mine.any(axis=1)
    total = total_weights(np.where(mine, weights, 0.0))
    near, far, share = _neighbours(redistribution, along(redistribution, points))
    others = np.count_nonzero((weights != 0) & ~mine, axis=1)
    if redistribution.most:
        share = np.where(others + 2 > redistribution.most, np.where(share < 0.5, 0.0, 1.0), share)
    # The larger part is rounded: the rest is then a float32 too, so that both add up to the total exactly.
    larger = total * np.maximum(share, 1.0 - share)
    rounded = np.rint(larger) if units else larger.astype(np.float32).astype(np.float64)
    larger = np.where(larger < total, rounded, total)
    first = np.where(share < 0.5, larger, total - larger)
    second = total - first
    out_joints = np.where(mine, 0, joints)
    out_weights = np.where(mine, 0.0, weights)
    home = _first(redistribution, joints, mine)
    for joint, weight in ((near, first), (far, second)):
        out_joints, out_weights = _put(out_joints, out_weights, joint, weight, touched & (weight != 0), home)
    return _kept(joints, weights, out_joints, out_weights, 0.5 if units else SAME)


def folded(
    rows: Integers, at: Floats, joints: Integers, weights: Floats, width: int = 0
) -> tuple[Integers, Floats]:
    """Joints (v, k) and weights (v, k) after a fold; what no joint that goes had a part in keeps its bits.

    rows, at: as in `JointMerge`. What a point has of a joint and of those that it inherits is added up in
    the place of the first of them along the bone, which a redistribution has put there. A joint that the skin
    does not have stays one that it has not. Of columns at the end, those that held something and do no longer
    go, and those behind them, but for the first ``width``.
    """
    inside = np.clip(joints, 0, len(rows) - 1)
    live, heirs = weights != 0, np.where(inside == joints, rows[inside], joints)
    out_joints, out_weights = np.where(live | (rows[inside] == joints), heirs, 0), weights.copy()
    for later in range(1, joints.shape[1]):
        for first in range(later):
            both = (out_weights[:, first] != 0) & (out_weights[:, later] != 0)
            both &= (out_joints[:, first] == out_joints[:, later]) & (joints[:, first] != joints[:, later])
            one, two = at[inside[:, first]], at[inside[:, later]]
            ahead = (one < two) | ((one == two) & (joints[:, first] < joints[:, later]))
            total = out_weights[:, first] + out_weights[:, later]
            for into, from_, own in ((first, later, ahead), (later, first, ~ahead)):
                out_weights[both & own, into] = total[both & own]
                out_weights[both & own, from_], out_joints[both & own, from_] = 0.0, 0
    now = _width(out_weights)
    kept = max(now, width, 1) if now < _width(weights) else joints.shape[1]
    return out_joints[:, :kept], out_weights[:, :kept]


def limited(
    joints: Integers, weights: Floats, limit: WeightLimit, *, full: int = 0
) -> tuple[Integers, Floats]:
    """Joints (v, k) and weights (v, k) of points with as many joints as allowed; k is no more than before.

    full: what weights are a whole number of, 0 for floats. What a point has of a joint that it names twice
    counts together. The weights of a point sum to what they did, or to 1. Points with so few joints, and with
    weights that are not numbers, keep theirs.
    """
    width = min(joints.shape[1], -(-limit.most // 4) * 4)
    one = float(full or 1)
    total = total_weights(weights)
    plain = np.isfinite(weights).all(axis=1) & (total > 0)
    over = (np.count_nonzero(weights, axis=1) > limit.most) & plain
    off = plain & (np.abs(total - one) > (0.5 if full else SAME)) if limit.normalise else over
    moved = over | off | ((weights[:, width:] != 0).any(axis=1) & plain)
    once = weights.copy()
    once[over | off] = added_up(joints[over | off], weights[over | off])
    order = np.argsort(-np.abs(once), axis=1, kind="stable")
    rows = np.arange(len(joints))[:, np.newaxis]
    most, heavy = joints[rows, order], once[rows, order]
    heavy[:, limit.most :] = 0.0
    aim = np.where(off, one, total) if limit.normalise else total
    kept = total_weights(heavy)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where((over | off)[:, np.newaxis], heavy * (aim / kept)[:, np.newaxis], heavy)
    if full:
        share = _whole(share, aim)
    most = np.where(share != 0, most, 0)
    out = np.where(moved[:, np.newaxis], most, joints), np.where(moved[:, np.newaxis], share, weights)
    lost = (out[1][:, width:] != 0).any()  # of points that are no numbers
    return out if lost else (out[0][:, :width], out[1][:, :width])


def within(weights: Floats, full: int) -> Floats:
    """Whole weights (v, k) that fit their type, whose largest is ``full``.

    A point with a weight above it keeps its shares, as whole numbers that sum to ``full``.
    """
    over = (weights > full).any(axis=1)
    if not over.any():
        return weights
    fitting, large = weights.copy(), weights[over]
    fitting[over] = _whole(
        large * (full / total_weights(large))[:, np.newaxis], np.full(len(large), float(full))
    )
    return fitting


def added_up(joints: Integers, weights: Floats) -> Floats:
    """Weights (v, k) with all that a point has of a joint in the first place that names it."""
    found = weights.copy()
    for first in range(joints.shape[1] - 1):
        again = (joints[:, first + 1 :] == joints[:, first, np.newaxis]) & (found[:, first, np.newaxis] != 0)
        if again.any():
            rest = found[:, first + 1 :]
            found[:, first] += total_weights(np.where(again, rest, 0.0))
            rest[again] = 0.0
    return found


def total_weights(weights: Floats) -> Floats:
    """What the weights (v, k) of each point sum to, (v,), added from left to right."""
    total = np.zeros(len(weights))
    for column in weights.T:
        total += column
    return total


def _whole(weights: Floats, total: Floats) -> Floats:
    """Weights (v, k) as whole numbers that sum to ``total`` (v,), each less than 1 from what it was.

    All are rounded down, and those that lose most by it get 1 more.
    """
    found = np.asarray(np.floor(weights))
    rank = np.argsort(np.argsort(found - weights, axis=1, kind="stable"), axis=1, kind="stable")
    return found + (rank < (total - total_weights(found))[:, np.newaxis])


def _width(weights: Floats) -> int:
    """The number of columns up to the last that holds something."""
    return int(np.flatnonzero((weights != 0).any(axis=0)).max(initial=-1)) + 1


def _neighbours(redistribution: WeightRedistribution, t: Floats) -> tuple[Integers, Integers, Floats]:
    """The joints before and after places along the bone, and the share of the one after, (v,) each."""
    last = len(redistribution.at) - 1
    after = np.searchsorted(redistribution.at, t, side="right")
    near, far = np.clip(after - 1, 0, last), np.clip(after, 0, last)
    span = redistribution.at[far] - redistribution.at[near]
    share = np.where(span > 0, (t - redistribution.at[near]) / np.where(span > 0, span, 1.0), 0.0)
    share = np.where(share < NEGLIGIBLE_SHARE, 0.0, np.where(share > 1.0 - NEGLIGIBLE_SHARE, 1.0, share))
    return redistribution.joints[near], redistribution.joints[far], share


def _first(redistribution: WeightRedistribution, joints: Integers, mine: Booleans) -> Integers:
    """The column, (v,), of those that are ``mine`` whose joint is first along the bone; 0 where none is."""
    if not joints.shape[1]:
        return np.zeros(len(joints), dtype=np.int64)
    last = len(redistribution.joints)
    place = np.full(joints.shape, last)
    for number, joint in enumerate(redistribution.joints.tolist()):
        place[mine & (joints == joint)] = number
    return np.asarray(place.argmin(axis=1))


def _put(
    joints: Integers, weights: Floats, joint: Integers, weight: Floats, where: Booleans, home: Integers
) -> tuple[Integers, Floats]:
    """One influence more for some points, in the column ``home`` (v,) if it is free there, else the first
    that is; a column more where one has none."""
    free = weights == 0
    if (where & ~free.any(axis=1)).any():
        joints = np.concatenate([joints, np.zeros((len(joints), 1), dtype=np.int64)], axis=1)
        weights = np.concatenate([weights, np.zeros((len(weights), 1))], axis=1)
        free = weights == 0
    rows = np.flatnonzero(where)
    column = np.where(free[rows, home[rows]], home[rows], np.argmax(free[rows], axis=1))
    joints[rows, column], weights[rows, column] = joint[rows], weight[rows]
    return joints, weights


def _kept(
    joints: Integers, weights: Floats, new_joints: Integers, new_weights: Floats, least: float
) -> tuple[Integers, Floats]:
    """The new influences, with the old bits of those points whose influences are as they were."""
    width = joints.shape[1]
    wider = (new_weights[:, width:] != 0).any(axis=1)
    alike = (new_joints[:, :width] == joints) | ((weights == 0) & (new_weights[:, :width] == 0))
    close = np.abs(new_weights[:, :width] - weights) <= least
    same = (alike & close).all(axis=1) & ~wider
    new_joints[same, :width], new_weights[same, :width] = joints[same], weights[same]
    return new_joints, new_weights
