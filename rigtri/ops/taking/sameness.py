"""Whether a track says what another says, as far as a DCC's arithmetic and sampling let one tell.

A DCC writes its own keys: one a frame, with quaternions that it has interpolated number by number.
So two tracks are compared at the keys of the edited one.
"""

from __future__ import annotations

import numpy as np

from rigtri.pose import sample
from rigtri.quaternions import conjugate, slerp, turn_angle, unit
from rigtri.quaternions import multiply as product
from rigtri.records import Booleans, Track, key_values
from rigtri.trigonometry import Floats
from rigtri.vectors import length

# Seconds by which a frame of a DCC may miss the time of a key.
MISSED = 1e-4
# Gaps between keys this much longer than a frame were made by hand.
_GAP = 1.5
# Exporters leave out all keys between the first and the last where no number moves by more than this,
# in EDITED's units: Blender's does, unless it is told to keep them.
_STILL = 1e-4


def apart(path: str, a: Floats, b: Floats) -> Floats:
    """How far values, (k, c), are apart, (k,): turns in radians."""
    if path == "rotation":
        return turn_angle(product(conjugate(unit(a)), unit(b)))
    return np.asarray(length(a - b)) if path == "translation" else np.abs(a - b).max(axis=1, initial=0.0)


def off(was: Track, now: Track, missed: float = MISSED) -> Floats:
    """How far a track is at its keys from what the other says there, or from what a DCC makes of it, (k,)."""
    values, times = key_values(now), now.times
    if np.array_equal(was.times, times) and np.array_equal(was.values, now.values):
        return np.zeros(len(times))
    told = [sample(was, times)]
    if was.interpolation == "STEP" and len(was.times) > 1:
        told += [sample(was, times - missed), sample(was, times + missed)]
    if was.path == "rotation" and was.interpolation == "LINEAR" and len(was.times) > 1:
        told.append(_straight(was, times))
    return np.asarray(np.min([apart(now.path, values, each) for each in told], axis=0))


def differing(was: Track, now: Track, bound: Floats) -> Booleans:
    """The keys, (k,), at which a track says something else; of splines also beside a curve that does."""
    found = off(was, now) > bound
    if was.interpolation == now.interpolation == "CUBICSPLINE" and len(now.times) > 1:
        for share in (0.25, 0.5, 0.75):
            between = now.times[:-1] + share * np.diff(now.times)
            far = apart(now.path, sample(now, between), sample(was, between))
            bent = far > np.maximum(bound[:-1], bound[1:])
            found[:-1] |= bent
            found[1:] |= bent
    return np.asarray(found)


def _straight(track: Track, times: Floats) -> Floats:
    """Turns interpolated number by number, each on the side of the one before, and made unit."""
    values = unit(track.values)
    both = values[1:] * values[:-1]
    ahead = both[:, 0] + both[:, 1] + both[:, 2] + both[:, 3]
    values = values.copy()
    values[1:] *= np.cumprod(np.where(ahead < 0, -1.0, 1.0))[:, np.newaxis]
    columns = [np.interp(times, track.times, values[:, k]) for k in range(4)]
    return unit(np.stack(columns, axis=-1))


def lacking(was: Track, now: Track, frames: Floats, bound: Floats, unit_of: float = 1.0) -> Booleans:
    """The keys, (k,), beside which keys were taken out: farther apart than frames, where the other has some.

    frames: all times of the edited clip. bound: (k,). unit_of: how large a number of the edited file is here.
    """
    found = np.zeros(len(now.times), dtype=bool)
    if len(was.times) < 2 or "CUBICSPLINE" in (now.interpolation, was.interpolation):
        return found
    left = np.zeros(len(was.times), dtype=np.int64)
    inside = np.ones(len(was.times), dtype=bool)
    if len(now.times) > 1:
        frame = float(np.median(np.diff(frames)))
        left = np.clip(np.searchsorted(now.times, was.times, side="right") - 1, 0, len(now.times) - 2)
        within = (was.times >= now.times[0]) & (was.times <= now.times[-1])
        inside = within & (np.diff(now.times)[left] > _GAP * frame) & ~np.isin(was.times, now.times)
    times, told = was.times[inside], key_values(was)[inside]
    if not len(times) or _left_out(was, now, frames, unit_of):
        return found
    said = [sample(now, times + missed) for missed in (0.0, -MISSED, MISSED)]
    far = np.min([apart(was.path, told, each) for each in said], axis=0)
    gone = left[inside][far > bound[left[inside]]]
    found[gone] = True
    found[np.minimum(gone + 1, len(found) - 1)] = True
    return found


def _left_out(was: Track, now: Track, frames: Floats, unit_of: float) -> bool:
    """Whether an exporter has left out keys of what hardly moves: what it saw at its frames is one value."""
    if len(now.times) > 2:
        return False
    seen = frames[(frames >= now.times[0]) & (frames <= now.times[-1])]
    if len(seen) <= 2:
        seen = was.times
    values = sample(was, seen)
    if was.path == "rotation":
        both = values * values[:1]
        ahead = both[:, 0] + both[:, 1] + both[:, 2] + both[:, 3]
        values = np.where(ahead < 0, -1.0, 1.0)[:, np.newaxis] * values
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


def same_knots(was: Track, now: Track, bound: Floats) -> float | None:
    """Of a spline that a DCC has replaced by a key a frame: how far it is off between its own keys.

    None where it is off at its keys too, or farther between them than curves through the same keys go.
    """
    if was.interpolation != "CUBICSPLINE" or now.interpolation == "CUBICSPLINE" or len(now.times) < 3:
        return None
    knots = was.times[(was.times >= now.times[0]) & (was.times <= now.times[-1])]
    at = np.clip(np.searchsorted(now.times, knots), 1, len(now.times) - 2)
    values = key_values(now)
    # A key between two frames: the frames tell it no nearer than the curve bends there.
    line = _between(now.path, values[at - 1], values[at + 1])
    on_frame = np.abs(_nearest(now.times, knots)[:, 0] - knots) <= MISSED
    bend = np.where(on_frame, 0.0, apart(now.path, line, values[at]))
    near = np.interp(knots, now.times, bound)
    if (apart(now.path, sample(now, knots), sample(was, knots)) > near + bend).any():
        return None
    far = off(was, now)
    segment = np.clip(np.searchsorted(was.times, now.times, side="right") - 1, 0, len(was.times) - 2)
    own = key_values(was)
    reach = apart(was.path, own[:-1], own[1:])
    chord = _linear(was)
    bulge = np.zeros(len(reach))
    np.maximum.at(bulge, segment, apart(was.path, sample(was, now.times), sample(chord, now.times)))
    return None if (far > bound + bulge[segment] + 0.5 * reach[segment]).any() else float(far.max())


def _linear(track: Track) -> Track:
    """The keys of a spline with straight lines between them."""
    return Track(track.node, track.path, "LINEAR", track.times, key_values(track))


def _between(path: str, a: Floats, b: Floats) -> Floats:
    if path == "rotation":
        return slerp(unit(a), unit(b), np.full(len(a), 0.5))
    return (a + b) / 2.0
