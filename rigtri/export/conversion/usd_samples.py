"""Tracks of glTF as time samples of USD, which goes in straight lines (rotations: along arcs) from one to
the next.

LINEAR keys are samples as they are. STEP keys get a second sample right before them. Splines get as many
samples as keep the motion. Source: glTF 2.0 appendix C; UsdTimeCode (SafeStep); UsdAttribute (interpolation).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from pxr import Usd

from rigtri.evaluation.adaptive_sampling import adaptive_key_times, straight_times
from rigtri.evaluation.sampling import sorted_unique
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Clip, Track

# The rates at which programs play; the first that has all keys on whole frames is taken.
RATES = (24.0, 30.0, 60.0, 25.0, 50.0, 48.0, 120.0, 100.0)
# A key this share of its time from a whole frame is on it: what float32 leaves of a time in seconds.
_ROUNDING = 2e-7
# A model is not taken for smaller than this share of how far it is from the origin, which would be rounding.
_FAR = 1e-4
# Samples that are nearer to each other than this, in frames, are where rounding one would show.
_CROWDED = 1e-2


def rate_of(clips: Sequence[Clip]) -> float:
    """The frames a second of USD's time: the first rate at which all keys are on whole frames, else 24."""
    times = [track.times for clip in clips for track in clip.tracks]
    every = sorted_unique(np.concatenate([*times, np.zeros(1)]))
    for rate in RATES:
        codes = every * rate
        if (np.abs(codes - np.round(codes)) <= _ROUNDING * np.maximum(np.abs(codes), 1.0)).all():
            return rate
    return RATES[0]


def time_codes(seconds: Floats, rate: float) -> Floats:
    """Times in USD's unit; what is on a whole frame but for float32's rounding is made so."""
    codes, step = seconds * rate, float(Usd.TimeCode.SafeStep())
    whole = np.round(codes)
    near = np.abs(codes - whole) <= _ROUNDING * np.maximum(np.abs(codes), 1.0)
    # The sample before a step stays before it, alone one or two numbers of float32 away, and samples of what
    # is fast stay where they are.
    gaps = np.diff(codes)
    close = np.concatenate([[False], gaps < np.minimum(2 * _ROUNDING * np.abs(codes[1:]), _CROWDED), [False]])
    alone = close[1:] & ~close[:-1] & ~np.append(close[2:], False)
    before = np.append(gaps < 2 * step, False) | alone
    crowded = np.append(gaps < _CROWDED, False) | np.append(False, (gaps < _CROWDED) & ~before[:-1])
    snapped = near & ~crowded & ~before
    # A step that stays where it is has the sample before it where that is.
    follows = near & before & np.append(snapped[1:], False)
    return np.where(snapped, whole, np.where(follows, whole - step, codes))


def sample_times(tracks: Sequence[Track], size: float) -> Floats:
    """At which seconds tracks that share their samples need some. size: of what they move, in file units."""
    times = [np.zeros(0)]
    for track in tracks:
        spline = track.interpolation == "CUBICSPLINE"
        times.append(straight_times(track, size) if spline else track.times)
        if track.interpolation == "STEP":
            times.append(track.times[1:] - step_before(track.times[1:]))
    return sorted_unique(np.concatenate(times))


def step_before(times: Floats) -> Floats:
    """How long before a step the sample stands that holds what was before: USD's own smallest step."""
    return np.maximum(np.abs(times) * 1e-12, float(Usd.TimeCode.SafeStep()) / RATES[-2])


def motion_times(sampled: Callable[[Floats], Floats], times: Floats, within: float) -> Floats:
    """As many times, those given among them, as straight lines need to follow what is sampled, (f, c)."""

    def error(found: Floats, left: Floats, right: Floats, share: Floats, _: Floats) -> Floats:
        return np.asarray(np.abs(found - left - (right - left) * share[:, np.newaxis]).max(axis=1))

    return adaptive_key_times(sampled, error, times, within=within) if len(times) > 1 else times


def frame_times(sampled: Callable[[Floats], Floats], times: Floats, within: float, most: float) -> Floats:
    """As many times as straight lines need to follow a frame, (f, 4, 4).

    within: a share of its distance from the origin, or of ``most`` where that is less: the size of the model
    by which it is judged, which may be far out. Short axes, as below an armature of 0.01, are as exact.
    """
    frames = sampled(times)
    goes = max(float(np.abs(frames).max()), 1e-9)
    size = min(goes, max(most, _FAR * goes))
    longest = float(length(frames[:, :3, :3]).max())
    scale = longest if 0.0 < longest < 0.5 else 1.0

    def rows(times: Floats) -> Floats:
        found = sampled(times)
        return np.concatenate([found[:, :3] / scale, found[:, 3:]], axis=1).reshape(-1, 16)

    return motion_times(rows, times, within * size)
