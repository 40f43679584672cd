"""Whether two tracks give the same motion, within what a DCC's arithmetic and sampling change.

A DCC writes its own keys: one a frame, with quaternions that it has interpolated number by number.
So two tracks are compared at the keys of the edited one, and between them where no DCC has made these.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from rigtri.evaluation.sampling import sample
from rigtri.maths.arrays import Booleans
from rigtri.maths.quaternions import angle_between, dot, make_continuous, norm, slerp, unit
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Track, key_values

# Seconds by which a frame of a DCC may miss the time of a key.
MISSED = 1e-4
# Of a frame: Blender's curves have one key there. Where a track does not show its frames, of 24 a second.
_ONE_KEY, _FRAME = 1e-2, 1.0 / 24.0
# Gaps between keys this much longer than a frame were made by hand.
_GAP = 1.5
# Seconds between keys that no DCC has sampled: none shows fewer than ten frames in a second.
BY_HAND = 0.1
# Exporters leave out all keys between the first and the last where no number moves by more than this,
# in EDITED's units: Blender's does, unless it is set to keep them.
_STILL = 1e-4
# Tangents that differ by less, as a share of the larger, are one: float32, twice divided by a frame rate.
SAME_TANGENT = 1e-3
# How much steeper than a natural spline the tangents may be that a DCC makes of keys.
_STEEPER = 1.5


def differences(path: str, a: Floats, b: Floats) -> Floats:
    """How far values, (k, c), are apart, (k,): turns in radians."""
    if path == "rotation":
        return angle_between(unit(a), unit(b))
    return np.asarray(length(a - b)) if path == "translation" else np.abs(a - b).max(axis=1, initial=0.0)


def off(was: Track, now: Track, missed: float = MISSED) -> Floats:
    """How far a track is at its keys from the other one, or from what a DCC makes of that, (k,)."""
    found = _off(was, now, missed)
    lean = without_near_keys(was, now.times)
    return found if lean is was else np.minimum(found, _off(lean, now, missed))


def same_at_keys(a: Track, b: Track, bound: float) -> bool:
    """Whether numbers of two tracks differ by no more at the keys of both."""
    times = np.union1d(a.times, b.times)
    return bool(np.abs(sample(a, times) - sample(b, times)).max(initial=0.0) <= bound)


def without_near_keys(track: Track, frames: Floats) -> Track:
    """A track as Blender's importer makes it: a key within a hundredth of a frame of one before it gives that
    one its value."""
    if track.interpolation == "CUBICSPLINE" or len(track.times) < 2:
        return track
    frame = min(float(np.median(np.diff(frames))), _FRAME) if len(frames) > 1 else _FRAME
    if float(np.diff(track.times).min()) > _ONE_KEY * frame:
        return track
    firsts, lasts = [0], [0]
    for k, time in enumerate(track.times.tolist()):
        if time - track.times[firsts[-1]] > _ONE_KEY * frame:
            firsts.append(k)
            lasts.append(k)
        lasts[-1] = k
    return replace(track, times=track.times[firsts], values=track.values[lasts])


def _off(was: Track, now: Track, missed: float) -> Floats:
    values, times = key_values(now), now.times
    if np.array_equal(was.times, times) and np.array_equal(was.values, now.values):
        return np.zeros(len(times))
    ours = [sample(was, times)]
    if was.interpolation == "STEP":
        ours += [sample(was, times - missed), sample(was, times + missed)]
    if was.path == "rotation" and was.interpolation == "LINEAR" and len(was.times) > 1:
        ours.append(_straight(was, times))
    return np.asarray(np.min([differences(now.path, values, each) for each in ours], axis=0))


def differing(was: Track, now: Track, bound: Floats) -> Booleans:
    """The keys, (k,), at which a track differs; of splines also beside a curve that does."""
    found = ~(off(was, now) <= bound)  # what a flat matrix says, NaN, is no motion at all
    splines = was.interpolation == now.interpolation == "CUBICSPLINE" and len(now.times) > 1
    if splines or reinterpolated(was, now):
        for share in (0.25, 0.5, 0.75):
            between = now.times[:-1] + share * np.diff(now.times)
            far = differences(now.path, sample(now, between), sample(was, between))
            bent = far > np.maximum(bound[:-1], bound[1:])
            found[:-1] |= bent
            found[1:] |= bent
    return np.asarray(found)


def reinterpolated(was: Track, now: Track) -> bool:
    """Whether a track has the keys of the other with another interpolation, which no DCC has given it.

    One that samples gives lines to keys that are near; steps are made by hand.
    """
    if was.interpolation == now.interpolation or not 1 < len(was.times) == len(now.times):
        return False
    by_hand = now.interpolation == "STEP" or float(np.median(np.diff(now.times))) > BY_HAND
    return bool(by_hand and np.abs(was.times - now.times).max() <= MISSED)


def _straight(track: Track, times: Floats) -> Floats:
    """Turns interpolated number by number, each on the side of the one before, and made unit."""
    values = make_continuous(unit(track.values))
    columns = [np.interp(times, track.times, values[:, k]) for k in range(4)]
    return unit(np.stack(columns, axis=-1))


def lacking(
    was: Track,
    now: Track,
    frames: Floats,
    bound: Floats,
    unit_of: float = 1.0,
    by_hand: float = BY_HAND,
) -> Booleans:
    """The keys, (k,), beside which keys were taken out: farther apart than frames, where the other has some.

    frames: all times of the edited clip. bound: (k,). unit_of: how large a number of the edited file is here.
    by_hand: `BY_HAND` in the unit of times. Keys taken out of all tracks leave no frames that show it.
    """
    found = np.zeros(len(now.times), dtype=bool)
    if len(was.times) < 2:
        return found
    wide = by_hand + MISSED
    if "CUBICSPLINE" not in (now.interpolation, was.interpolation) and len(frames) > 1:
        wide = min(wide, _GAP * float(np.median(np.diff(frames))))
    left = np.zeros(len(was.times), dtype=np.int64)
    inside = np.ones(len(was.times), dtype=bool)
    if len(now.times) > 1:
        left = np.clip(np.searchsorted(now.times, was.times, side="right") - 1, 0, len(now.times) - 2)
        within = (was.times >= now.times[0]) & (was.times <= now.times[-1])
        inside = within & (np.diff(now.times)[left] > wide) & ~np.isin(was.times, now.times)
    times, ours = was.times[inside], key_values(was)[inside]
    if not len(times) or _left_out(was, now, frames, unit_of, by_hand):
        return found
    their_values = [sample(now, times + missed) for missed in (0.0, -MISSED, MISSED)]
    far = np.min([differences(was.path, ours, each) for each in their_values], axis=0)
    gone = left[inside][far > bound[left[inside]]]
    found[gone] = True
    found[np.minimum(gone + 1, len(found) - 1)] = True
    return found


def _left_out(was: Track, now: Track, frames: Floats, unit_of: float, by_hand: float) -> bool:
    """Whether an exporter has left out keys of what hardly moves: what it saw at its frames is one value."""
    if len(now.times) > 2:
        return False
    seen = frames[(frames >= now.times[0]) & (frames <= now.times[-1])]
    if len(seen) <= 2 or float(np.median(np.diff(seen))) > by_hand + MISSED:
        seen = was.times
    values = sample(was, seen)
    if was.path == "rotation":
        values = np.where(dot(values, values[:1]) < 0, -1.0, 1.0)[:, np.newaxis] * values
    size = unit_of if was.path != "rotation" else 1.0
    wide = float((values.max(axis=0) - values.min(axis=0)).max(initial=0.0))
    # A box of EDITED's axes, which a turn makes wider along ours.
    return bool(wide <= _STILL * size * np.sqrt(values.shape[-1]))


def _nearest(known: Floats, times: Floats) -> Floats:
    """The nearest of some times, (k, 1)."""
    right = np.clip(np.searchsorted(known, times), 1, len(known) - 1)
    left = known[right - 1]
    nearer = np.where(times - left <= known[right] - times, left, known[right])
    return np.asarray(nearer[:, np.newaxis])


def tangents_dropped(pairs: Iterable[tuple[Track, Track]]) -> bool:
    """Whether none of the splines of a clip came back with a tangent that it had, though some were not flat.

    A DCC keeps tangents or drops them all, and makes its own; a hand moves some. Two, at least, are evidence.
    Of a spline that came back with all of them nobody can tell whether it was taken from EDITED before.
    """
    bent = 0
    for was, now in pairs:
        if was.interpolation != "CUBICSPLINE" or now.interpolation != "CUBICSPLINE":
            continue
        if not 2 < len(was.times) == len(now.times) or np.abs(was.times - now.times).max() > MISSED:
            continue
        a, b = was.values[1:-1], now.values[1:-1]
        if was.path == "rotation":  # q and −q are one rotation
            b = np.where((dot(a[:, 1], b[:, 1]) < 0)[:, np.newaxis, np.newaxis], -b, b)
        a, b = a[:, (0, 2)], b[:, (0, 2)]
        large = np.maximum(np.abs(a).max(axis=2), np.abs(b).max(axis=2))
        same = (np.abs(a - b).max(axis=2) <= SAME_TANGENT * large)[large > 0]
        if same.all():
            continue
        if same.any():
            return False
        bent += int(np.count_nonzero(large[:, 0] > 0))
    return bent > 1


def same_knots(
    was: Track, now: Track, bound: Floats, *, dropped: bool = False, by_hand: float = BY_HAND
) -> float | None:
    """Of a spline that a DCC has replaced by a key a frame: how far it is off between its own keys.

    dropped: it may as well have replaced the tangents alone. by_hand: see `lacking`.
    None where it is off at its keys too, or farther
    between them than curves through the same keys go.
    """
    if reinterpolated(was, now):
        return None
    keys = now.times
    if dropped and now.interpolation == "CUBICSPLINE" and len(now.times) > 2:
        shares = (0.25, 0.5, 0.75)
        between = [now.times[:-1] + share * np.diff(now.times) for share in shares]
        times = np.unique(np.concatenate([now.times, *between]))
        bound = np.interp(times, now.times, bound)
        now = Track(now.node, now.path, "LINEAR", times, sample(_on_one_side(now), times))
    if was.interpolation != "CUBICSPLINE" or now.interpolation == "CUBICSPLINE" or len(now.times) < 3:
        return None
    knots = was.times[(was.times >= now.times[0]) & (was.times <= now.times[-1])]
    at = np.clip(np.searchsorted(now.times, knots), 1, len(now.times) - 2)
    # A key between two frames: the frames give it no nearer than the curve bends at either.
    on_frame = np.abs(_nearest(now.times, knots)[:, 0] - knots) <= MISSED
    segment = np.clip(np.searchsorted(keys, knots, side="right") - 1, 0, len(keys) - 2)
    on_frame |= np.diff(keys)[segment] > by_hand + MISSED  # no frames: the curve itself is EDITED's
    bends = _bends(now)
    bend = np.where(on_frame, 0.0, np.maximum(bends[at - 1], bends[at]))
    near = np.interp(knots, now.times, bound)
    if (differences(now.path, sample(now, knots), sample(was, knots)) > near + bend).any():
        return None
    far = off(was, now)
    segment = np.clip(np.searchsorted(was.times, now.times, side="right") - 1, 0, len(was.times) - 2)
    own = key_values(was)
    reach = differences(was.path, own[:-1], own[1:])
    chord = _linear(was)
    bulge = np.zeros(len(reach))
    np.maximum.at(bulge, segment, differences(was.path, sample(was, now.times), sample(chord, now.times)))
    swing = np.maximum(0.5 * reach, _swing(was))
    return None if (far > bound + bulge[segment] + swing[segment]).any() else float(far.max())


def _on_one_side(track: Track) -> Track:
    """A spline of turns without keys that jump to −q: Blender writes such, and shows them without."""
    if track.path != "rotation":
        return track
    keys = key_values(track)
    flipped = (make_continuous(keys) != keys).any(axis=1)
    return replace(track, values=np.where(flipped[:, None, None], -track.values, track.values))


def _bends(track: Track) -> Floats:
    """How far keys are from the middle between their neighbours, (k,); the ends as those beside them."""
    values = key_values(track)
    line = _between(track.path, values[:-2], values[2:])
    found = differences(track.path, line, values[1:-1])
    return np.concatenate([found[:1], found, found[-1:]])


def _swing(was: Track) -> Floats:
    """How far from lines between its keys, (k − 1,), a curve through them may go that a DCC has made.

    A cubic with the slopes m of its ends is off its chord d by t(1 − t)²(m₀ − d) − t²(1 − t)(m₁ − d), and
    t(1 − t)² is 4/27 at most. Blender's own tangents make a curve without jumps of acceleration, which
    also swings where keys beside a move are alike.
    """
    values = key_values(was)
    turn = was.path == "rotation"
    values = make_continuous(unit(values)) if turn else values
    gaps = np.diff(was.times)[:, np.newaxis]
    chords = np.diff(values, axis=0)
    slopes = _smooth(gaps, chords / gaps)
    ends = (gaps * side - chords for side in (slopes[:-1], slopes[1:]))
    far = (2.0 * norm(side) if turn else np.abs(side).max(axis=1) for side in ends)
    widest = 1.0 if turn else np.sqrt(values.shape[1])  # of a box, across
    return np.asarray(_STEEPER * 4.0 / 27.0 * widest * sum(far))


def _smooth(gaps: Floats, chords: Floats) -> Floats:
    """The slopes, (k, c), at the keys of a natural cubic spline; gaps: (k − 1, 1), chords: their slopes.

    Each second derivative has one value from both sides, and the outermost are 0: three numbers a row,
    eliminated from the first key to the last.
    """
    count = len(gaps) + 1
    weight = 1.0 / gaps
    diagonal, right = np.empty((count, 1)), np.empty((count, chords.shape[1]))
    diagonal[0], right[0] = 2.0 * weight[0], 3.0 * weight[0] * chords[0]
    diagonal[-1], right[-1] = 2.0 * weight[-1], 3.0 * weight[-1] * chords[-1]
    diagonal[1:-1] = 2.0 * (weight[:-1] + weight[1:])
    right[1:-1] = 3.0 * (weight[:-1] * chords[:-1] + weight[1:] * chords[1:])
    for k in range(1, count):
        share = weight[k - 1] / diagonal[k - 1]
        diagonal[k] -= share * weight[k - 1]
        right[k] -= share * right[k - 1]
    found = np.empty_like(right)
    found[-1] = right[-1] / diagonal[-1]
    for k in range(count - 2, -1, -1):
        found[k] = (right[k] - weight[k] * found[k + 1]) / diagonal[k]
    return found


def _linear(track: Track) -> Track:
    """The keys of a spline with straight lines between them."""
    return Track(track.node, track.path, "LINEAR", track.times, key_values(track))


def _between(path: str, a: Floats, b: Floats) -> Floats:
    if path == "rotation":
        return slerp(unit(a), unit(b), np.full(len(a), 0.5))
    return (a + b) / 2.0
