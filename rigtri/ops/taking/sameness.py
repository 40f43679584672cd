"""Whether a track says what another says, as far as a DCC's arithmetic and sampling let one tell.

A DCC writes its own keys: one a frame, with quaternions that it has interpolated number by number.
So two tracks are compared at the keys of the edited one.
"""

from __future__ import annotations

import numpy as np

from rigtri.ops.taking.counterparts import SAME_PLACE, SAME_SIZE
from rigtri.pose import sample
from rigtri.quaternions import conjugate, slerp, turn_angle, unit
from rigtri.quaternions import multiply as product
from rigtri.records import Track, key_values
from rigtri.trigonometry import Floats
from rigtri.vectors import length

# Turns in radians (0.03°): so far off are frames that Blender writes between the keys of USD transforms.
_SAME_POSE = 5e-4
# Morph weights that differ by less look alike.
SAME_WEIGHT = 1e-4
# Seconds by which a frame of a DCC may miss the time of a key.
_MISSED = 1e-4
# Gaps between keys this much longer than a frame were made by hand.
_GAP = 1.5


def bound_of(track: Track, size: float) -> float:
    """How far values of a kind may be apart and count as the same; size: of the rig in the track's unit."""
    known = {"rotation": _SAME_POSE, "translation": SAME_PLACE * size, "scale": SAME_SIZE}
    return known.get(track.path, SAME_WEIGHT)


def apart(path: str, a: Floats, b: Floats) -> Floats:
    """How far values, (k, c), are apart, (k,): turns in radians."""
    if path == "rotation":
        return turn_angle(product(conjugate(unit(a)), unit(b)))
    return np.asarray(length(a - b)) if path == "translation" else np.abs(a - b).max(axis=1, initial=0.0)


def off(was: Track, now: Track, missed: float = _MISSED) -> Floats:
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


def _straight(track: Track, times: Floats) -> Floats:
    """Turns interpolated number by number, each on the side of the one before, and made unit."""
    values = unit(track.values)
    both = values[1:] * values[:-1]
    ahead = both[:, 0] + both[:, 1] + both[:, 2] + both[:, 3]
    values = values.copy()
    values[1:] *= np.cumprod(np.where(ahead < 0, -1.0, 1.0))[:, np.newaxis]
    columns = [np.interp(times, track.times, values[:, k]) for k in range(4)]
    return unit(np.stack(columns, axis=-1))


def lacks_keys(was: Track, now: Track, frame: float, bound: float) -> bool:
    """Whether keys were taken out: where the keys left are farther apart than frames, the other has some."""
    if len(was.times) < 2 or "CUBICSPLINE" in (now.interpolation, was.interpolation):
        return False
    if len(now.times) == 1:
        inside = np.ones(len(was.times), dtype=bool)
    else:
        left = np.clip(np.searchsorted(now.times, was.times, side="right") - 1, 0, len(now.times) - 2)
        within = (was.times >= now.times[0]) & (was.times <= now.times[-1])
        inside = within & (np.diff(now.times)[left] > _GAP * frame) & ~np.isin(was.times, now.times)
    if not inside.any():
        return False
    times, told = was.times[inside], key_values(was)[inside]
    said = [sample(now, times + missed) for missed in (0.0, -_MISSED, _MISSED)]
    return bool((np.min([apart(was.path, told, each) for each in said], axis=0) > bound).any())


def _nearest(known: Floats, times: Floats) -> Floats:
    """The nearest of some times, (k, 1)."""
    right = np.clip(np.searchsorted(known, times), 1, len(known) - 1)
    left = known[right - 1]
    nearer = np.where(times - left <= known[right] - times, left, known[right])
    return np.asarray(nearer[:, np.newaxis])


def same_knots(was: Track, now: Track, bound: float) -> float | None:
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
    on_frame = np.abs(_nearest(now.times, knots)[:, 0] - knots) <= _MISSED
    bend = np.where(on_frame, 0.0, apart(now.path, line, values[at]))
    if (apart(now.path, sample(now, knots), sample(was, knots)) > bound + bend).any():
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
