"""Key reduction: the fewest keys between which interpolation stays within a tolerance."""

from __future__ import annotations

import numpy as np

from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.quaternions import angle_between, dot, slerp
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.rig import Rig

# Keys of turns are no farther apart than this where there is one between them to be kept, in radians: below
# a quarter turn, with room. The way of a half turn is ambiguous; players that go straight from one to the
# next quaternion are within 0.7° of the arc at 80°, and 8° off near a half turn.
WIDEST_TURN = 80.0 * np.pi / 180.0
# Of that: so much more is rounding, so that a second run finds the same keys.
_ROUNDING = 1e-4
# Below the cosine of half of that, with room, turns are wide; below the other, arcs are near a right angle.
_LEAST_COSINE, _RIGHT = 0.767, 0.1


def key_tolerances(rig: Rig, far: float, size: float) -> tuple[Floats, Floats]:
    """How far keys of each node may be off, (n,), so that nothing moves by more than ``far`` in the world.

    Moves, in units of the node's parent, and turns, in radians. far, size: in file units, size that of
    the rig, a twentieth of which a node reaches at least.
    """
    # Errors add up along a chain; each of its joints gets an equal share.
    share = far / (2.0 * (max(rig.depth, default=0) + 1))
    turns = share / lever_arms(rig, size)
    sizes = parent_sizes(rig)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(sizes > 0, share / np.where(sizes > 0, sizes, 1.0), share), turns


def lever_arms(rig: Rig, size: float) -> Floats:
    """How far the nodes below each node reach from it at rest, (n,), a twentieth of ``size`` at least."""
    world, parents = rig.world[:, 3, :3], rig.parents.tolist()
    with np.errstate(invalid="ignore"):
        bones = np.nan_to_num(length(world - world[rig.parents])).tolist()
    reach = [0.05 * size] * len(rig)
    for node in range(len(rig) - 1, -1, -1):
        if (parent := parents[node]) >= 0:
            reach[parent] = max(reach[parent], reach[node] + bones[node])
    return np.array(reach)


def parent_sizes(rig: Rig) -> Floats:
    """How large each node's parent makes it at rest, (n,): units of the world in one of its translation."""
    parents = np.where((rig.parents >= 0)[:, np.newaxis, np.newaxis], rig.world[rig.parents], np.eye(4))
    return np.asarray(length(parents[:, :3, :3]).max(axis=1))


def reduce_keys(times: Floats, values: Floats, bound: float) -> Integers:
    """The keys, (k,), between which straight lines come as near as ``bound`` to all values.

    times: (f,), rising. values: (f, c); with four columns they are turns, xyzw, the bound is in
    radians and the lines are great arcs, no wider than `WIDEST_TURN` where there is a key between; else it
    is in the values' unit. The first key is always there; it is the only one where nothing moves.
    """
    last = len(times) - 1
    if last < 1 or (_constant(values[[last // 2, last]], values, bound) and _constant(values, values, bound)):
        return np.array([0])
    kept = np.ones(last + 1, dtype=bool)
    # A key that its neighbours do not interpolate stays; only between such keys others may go.
    kept[1:-1] = _off_their_neighbours(times, values, bound)
    gaps = _gaps(kept)
    while len(gaps):
        many = gaps[:, 1] - gaps[:, 0] - 1
        which = np.repeat(np.arange(len(gaps)), many)
        inner = np.arange(len(which)) + np.repeat(gaps[:, 0] + 1 - (np.cumsum(many) - many), many)
        off = _off(times, values, gaps[which, 0], gaps[which, 1], inner)
        starts = np.flatnonzero(np.diff(which, prepend=-1))
        worst = np.maximum.reduceat(off, starts)
        bad = np.flatnonzero(worst > bound)
        if not len(bad):
            break
        # The first of the worst in each gap that is bad.
        _, first = np.unique(which[places := np.flatnonzero(off == worst[which])], return_index=True)
        split = inner[places[first]][np.isin(which[places[first]], bad)]
        kept[split] = True
        halves = np.concatenate(
            [np.stack([gaps[bad, 0], split], axis=1), np.stack([split, gaps[bad, 1]], axis=1)]
        )
        gaps = halves[halves[:, 1] - halves[:, 0] > 1]
        gaps = gaps[np.argsort(gaps[:, 0], kind="stable")]
    found = np.flatnonzero(kept)
    return _narrow(times, values, found) if values.shape[1] == 4 else found


def _narrow(times: Floats, turns: Floats, keys: Integers) -> Integers:
    """Keys, (k,), and those between them that leave no arc too wide, as far as there are any.

    turns: (f, 4), on great arcs between the keys.
    """
    most = WIDEST_TURN * (1.0 + _ROUNDING)
    # The cosine of half the angle is cheaper than the angle.
    start, end = turns[keys[:-1]], turns[keys[1:]]
    wide = np.flatnonzero((np.abs(dot(start, end)) < _LEAST_COSINE) & (np.diff(keys) > 1))
    angles = _difference(start[wide], end[wide])
    more: list[int] = []
    for k, angle in zip(wide[angles > most].tolist(), angles[angles > most].tolist(), strict=True):
        at, end_ = int(keys[k]), int(keys[k + 1])
        step = (times[end_] - times[at]) * most / angle
        while times[end_] - times[at] > step and at + 1 < end_:
            at = max(at + 1, int(np.searchsorted(times, times[at] + step, side="right")) - 1)
            more.append(at)
    return np.union1d(keys, np.array(more, dtype=keys.dtype)) if more else keys


def _constant(rows: Floats, values: Floats, bound: float) -> bool:
    """Whether some of the values are what the first one is."""
    return bool((_difference(rows, values[:1]) <= bound).all())


def _off_their_neighbours(times: Floats, values: Floats, bound: float) -> Booleans:
    """Whether each inner value, (f − 2,), is farther than the bound from what its neighbours interpolate.

    Rotations are mostly decided by chords, without angles: a line between two quaternions is off the arc
    of φ between them by t(1 − t)(1 − 2t)φ³/6 and terms of φ⁵; up to a right angle by a quarter more at most.
    """
    last = len(times) - 1
    left, right, inner = np.arange(0, last - 1), np.arange(2, last + 1), np.arange(1, last)
    if values.shape[1] != 4:
        return np.asarray(_off(times, values, left, right, inner) > bound)
    q = np.ascontiguousarray(values.T)
    start, end, there = q[:, :-2], q[:, 2:], q[:, 1:-1]
    share = (times[1:-1] - times[:-2]) / (times[2:] - times[:-2])
    cosine = dot(start.T, end.T)
    line = start + (np.where(cosine < 0, -end, end) - start) * share
    line = line / np.sqrt(dot(line.T, line.T))
    apart = np.where(dot(line.T, there.T) < 0, there + line, there - line)
    chord = np.sqrt(dot(apart.T, apart.T))
    # φ² ≤ 2.5 (1 − cos φ) up to a right angle. The chord between unit quaternions is half of the turn x
    # between them, less x³/192 and less.
    arc = np.sqrt(2.5 * np.maximum(1.0 - np.abs(cosine), 0.0))
    bend = np.abs(share * (1.0 - share) * (1.0 - 2.0 * share)) * arc * arc * arc / 4.0
    half = 0.5 * bound
    unsure = bend + np.abs(dot(q.T, q.T) - 1.0).max() + half * half * half / 20.0 + 1e-12
    found: Booleans = chord > half
    open_ = (np.abs(chord - half) <= unsure) | (np.abs(cosine) < _RIGHT) | (chord > 0.5)
    rows = np.flatnonzero(open_)
    found[rows] = _off(times, values, left[rows], right[rows], inner[rows]) > bound
    return found


# In how many of the last bits of its time a value may be rounded, with all that is above it.
_UNCLEAR = 4.0


def is_reduction_of(times: Floats, values: Floats, there: Floats, bound: float, same: float) -> bool:
    """Whether ``there``, (f, c), is what thinning may make of values, though perhaps by other keys: some of
    the values themselves, lines between these, and nowhere farther off than ``bound``.

    same: how far what rounding alone parts may be off where nothing moves. All else is as for `reduce_keys`.
    """
    off, near = _difference(there, values), _rounded(times, values, bound, same)
    keys, last = np.flatnonzero(off <= near), len(times) - 1
    if len(keys) < 2 or keys[0] > 0 or keys[-1] < last or not bool((off <= bound + near).all()):
        return False
    right = np.clip(np.searchsorted(keys, np.arange(len(times)), side="right"), 1, len(keys) - 1)
    line = _line(times, values, keys[right - 1], keys[right], np.arange(len(times)))
    return bool((_difference(line, there) <= np.maximum(near[keys[right - 1]], near[keys[right]])).all())


def _rounded(times: Floats, values: Floats, bound: float, same: float) -> Floats:
    """How far rounding may part values, (f,): more where they go fast, as a limb's that passes straight, by
    what they go while float32 cannot distinguish times; but never more than the bound.
    """
    unclear = _UNCLEAR * float(np.spacing(np.float32(np.abs(times).max(initial=0.0))))
    speed = _difference(values[1:], values[:-1]) / np.diff(times)
    fastest = np.maximum(np.append(speed, 0.0), np.append(0.0, speed))
    return np.asarray(same + np.minimum(unclear * fastest, bound))


def _gaps(kept: Booleans) -> Integers:
    """Neighbouring kept keys with others between them, (g, 2); those others are given up."""
    keys = np.flatnonzero(kept)
    wide = np.diff(keys) > 1
    return np.stack([keys[:-1][wide], keys[1:][wide]], axis=1)


def _off(times: Floats, values: Floats, left: Integers, right: Integers, at: Integers) -> Floats:
    """How far values are from the line between two others, (m,)."""
    return _difference(_line(times, values, left, right, at), np.take(values.T, at, axis=1).T)


def _line(times: Floats, values: Floats, left: Integers, right: Integers, at: Integers) -> Floats:
    """Lines, or great arcs, between two values each, at the times ``at``, (m, c)."""
    share = (times[at] - times[left]) / (times[right] - times[left])
    start, end = (np.take(values.T, rows, axis=1).T for rows in (left, right))
    if values.shape[1] == 4:
        return slerp(start, end, share)
    return np.asarray(start + (end - start) * share[:, np.newaxis])


def _difference(a: Floats, b: Floats) -> Floats:
    """How far values are apart, (m,): turns in radians."""
    if a.shape[1] == 4:
        return angle_between(a, b)
    return np.asarray(length(a - b)) if a.shape[1] == 3 else np.abs(a - b).max(axis=1)
