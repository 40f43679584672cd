"""Keyframe insertion: keys at given times, with the curve elsewhere as it was, as far as keys allow.

Between a new key and its neighbours values go from the one to the other; beyond these nothing changes.
A spline is split where the new key comes, which changes nothing, and then its value there is
moved with its tangents, so that it goes through the key as fast as before.

Source: glTF 2.0 appendix C.5 (tangents are per unit of time, so those of the neighbours stay).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.evaluation.sampling import sample
from rigtri.maths.quaternions import conjugate, dot, multiply, norm
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Interpolation, Track


def insert_keys(track: Track, times: Floats, values: Floats) -> Track:
    """A track of a node's place with keys at ``times``, (k,), of ``values``, (k, c); rotations unit."""
    together = np.unique(np.concatenate([track.times, times]))
    at = np.searchsorted(together, times)
    if track.interpolation == "CUBICSPLINE" and len(track.times) > 1:
        rows = subdivide_spline(track, together)
        rows[at] = _moved(rows[at], values, turns=track.path == "rotation")
        return replace(track, times=together, values=rows)
    rows = sample(track, together)
    rows[at] = values
    way: Interpolation = track.interpolation if len(track.times) > 1 else "LINEAR"
    return replace(track, interpolation=way if len(together) > 1 else "STEP", times=together, values=rows)


def subdivide_spline(track: Track, times: Floats) -> Floats:
    """The keys, (k, 3, c), of the same spline at ``times``, (k,), which hold all of its own.

    Values of rotations are as long as the spline is there: made unit, the curve beside them would differ.
    """
    keys, rows = track.times, track.values.copy()
    # Outside of its keys a spline holds its value; there the outer tangents have no effect.
    if times[0] < keys[0]:
        rows[0, 0] = 0.0
    if times[-1] > keys[-1]:
        rows[-1, 2] = 0.0
    left = np.clip(np.searchsorted(keys, times, side="right") - 1, 0, len(keys) - 2)
    span = (keys[left + 1] - keys[left])[:, np.newaxis]
    u = (times[:, np.newaxis] - keys[left][:, np.newaxis]) / span
    start, leaving = rows[left, 1], span * rows[left, 2]
    end, arriving = rows[left + 1, 1], span * rows[left + 1, 0]
    # Newton's form of the cubic, as few roundings as there can be.
    first, second = leaving, 3.0 * (end - start) - 2.0 * leaving - arriving
    third = 2.0 * (start - end) + leaving + arriving
    value = start + u * (first + u * (second + u * third))
    slope = (first + u * (2.0 * second + 3.0 * u * third)) / span
    found = np.stack([slope, value, slope], axis=1)
    found[times < keys[0]] = rows[0, 1] * np.array([0.0, 1.0, 0.0])[:, np.newaxis]
    found[times > keys[-1]] = rows[-1, 1] * np.array([0.0, 1.0, 0.0])[:, np.newaxis]
    found[np.searchsorted(times, keys)] = rows
    return np.asarray(found)


def _moved(rows: Floats, values: Floats, *, turns: bool) -> Floats:
    """Keys of a spline, (k, 3, c), with other values; tangents of rotations are turned along."""
    if not turns:
        found = rows.copy()
        found[:, 1] = values
        return found
    size = norm(rows[:, 1])[:, np.newaxis]
    size = np.where(size == 0, 1.0, size)
    was = rows[:, 1] / size
    now = np.where(dot(values, was)[:, np.newaxis] < 0, -values, values)
    turn = multiply(now, conjugate(was))
    return np.stack([multiply(turn, rows[:, 0] / size), now, multiply(turn, rows[:, 2] / size)], axis=1)
