"""Keys of an edited track where it was edited, and the rig's own keys everywhere else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.evaluation.key_reduction import reduce_keys
from rigtri.evaluation.sampling import sample
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.quaternions import STRAIGHT, angle_between, dot, make_continuous, unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Path, Track


def merged(
    was: Track, now: Track, changed: Booleans, *, missed: float, bound: float, frames: bool = False
) -> Track:
    """``now`` from each changed key to the next one that agrees with ``was``, which stays elsewhere.

    changed: (k,), of the keys of ``now``. missed: times that differ by less are one. bound: how far
    keys that are left out of ``now`` may be off. frames: see `thinned`. Tracks of two kinds are not mixed:
    then it is ``now``.
    """
    if was.interpolation != now.interpolation or len(was.times) < 2:
        return thinned(now, bound, frames=frames)
    if len(was.times) == len(now.times) and np.abs(was.times - now.times).max() <= missed:
        values = was.values.copy()
        values[changed] = now.values[changed]
        return replace(now, times=was.times, values=values)
    if now.interpolation == "CUBICSPLINE":
        return now
    kept = np.ones(len(was.times), dtype=bool)
    fresh: list[tuple[Floats, Floats]] = []
    for first, last in _runs(changed):
        inside, times, values = _stretch(was, now, first, last, missed, bound, frames)
        kept &= ~inside
        fresh.append((times, values))
    times = np.concatenate([was.times[kept], *(each for each, _ in fresh)])
    values = np.concatenate([was.values[kept], *(each for _, each in fresh)])
    order = np.argsort(times, kind="stable")
    return replace(now, times=times[order], values=values[order])


def _stretch(
    was: Track, now: Track, first: int, last: int, missed: float, bound: float, frames: bool
) -> tuple[Booleans, Floats, Floats]:
    """What a run of changed keys replaces, (k,) of ``was``, and the keys that take its place.

    At both ends a key of ``was``, so that what lies beyond stays: its own, or one more on its curve.
    """
    start, end = max(first - 1, 0), min(last + 1, len(now.times) - 1)
    times, values = now.times[start : end + 1], now.values[start : end + 1].copy()
    low, high = -np.inf, np.inf
    if first > start:
        low = times[0]
        values[0] = sample(was, times[:1])[0]
    if last < end:
        high = times[-1]
        values[-1] = sample(was, times[-1:])[0]
    if now.path == "rotation":
        values = make_continuous(values)
    inside = (was.times > low + missed) & (was.times < high - missed)
    keys = np.arange(len(times))
    if now.interpolation == "LINEAR":
        keys = _needed(now.path, times, values, bound, frames)
    ends = [t for t in (low, high) if np.isfinite(t) and bool((np.abs(was.times - t) <= missed).any())]
    keys = keys[~np.isin(times[keys], ends)]
    return inside, times[keys], values[keys]


def _runs(changed: Booleans) -> list[tuple[int, int]]:
    """The first and the last of each run of changed keys; runs with one key between them are one."""
    at = np.flatnonzero(changed)
    cuts = np.flatnonzero(np.diff(at) > 2)
    firsts, lasts = at[[0, *(cuts + 1)]], at[[*cuts, -1]]
    return list(zip(firsts.tolist(), lasts.tolist(), strict=True))


def thinned(track: Track, bound: float, *, frames: bool = False) -> Track:
    """A track without the keys that the others interpolate within a bound; its first and its last stay.

    frames: a rotation is the orient op of a prim, and times are time codes, whole ones frames: these stay
    where OpenUSD would evaluate them from the keys beside them by more than the bound off.
    """
    if track.interpolation != "LINEAR" or len(track.times) < 3:
        return track
    keys = _needed(track.path, track.times, track.values, bound, frames)
    if len(keys) == len(track.times):
        return track
    return replace(track, times=track.times[keys], values=track.values[keys])


def _needed(path: Path, times: Floats, values: Floats, bound: float, frames: bool) -> Integers:
    if path == "rotation":
        values = unit(values)
    elif values.shape[-1] == 4:  # weights, which are no turns
        values = np.pad(values, ((0, 0), (0, 1)))
    keys = np.union1d(reduce_keys(times, values, bound), [0, len(times) - 1])
    return (
        np.union1d(keys, _slow_frames(times, values, keys, bound)) if frames and path == "rotation" else keys
    )


def _slow_frames(times: Floats, turns: Floats, keys: Integers, bound: float) -> Integers:
    """Which of the values at whole times, no keys, OpenUSD would show by more than a bound off.

    Where it goes straight it evaluates an orient op wrongly, by up to half of the angle between the keys.
    """
    at = np.setdiff1d(np.flatnonzero(times == np.round(times)), keys)
    right = np.searchsorted(keys, at)
    start, end = turns[keys[right - 1]], turns[keys[right]]
    return at[(np.abs(dot(start, end)) > 1.0 - STRAIGHT) & (angle_between(start, end) > 2.0 * bound)]
