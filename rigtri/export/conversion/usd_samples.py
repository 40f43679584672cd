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
from rigtri.maths.matrices import decompose
from rigtri.maths.quaternions import angle_between, slerp
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track

# The rates at which programs play; the first that has all keys on whole frames is taken.
RATES = (24.0, 30.0, 60.0, 25.0, 50.0, 48.0, 120.0, 100.0)
# A key this share of its time from a whole frame is on it: what float32 leaves of a time in seconds.
_ROUNDING = 2e-7
# A model is not taken for smaller than this share of how far it is from the origin, which would be rounding.
_FAR = 1e-4
# Samples that are nearer to each other than this, in frames, are where rounding one would show.
_CROWDED = 1e-2
# Where rotation and scale begin among the ten numbers of a frame's parts.
PARTS = (3, 7)


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


def sample_times(tracks: Sequence[Track], sizes: Floats) -> Floats:
    """At which seconds tracks that share their samples need some.

    sizes: of what nodes move, (n,), in the space that the translation of each is in.
    """
    times = [np.zeros(0)]
    for track in tracks:
        spline = track.interpolation == "CUBICSPLINE"
        times.append(straight_times(track, sizes[track.node]) if spline else track.times)
        if track.interpolation == "STEP":
            times.append(track.times[1:] - step_before(track.times[1:]))
    return sorted_unique(np.concatenate(times))


def step_before(times: Floats) -> Floats:
    """How long before a step the sample stands that holds what was before: USD's own smallest step."""
    return np.maximum(np.abs(times) * 1e-12, float(Usd.TimeCode.SafeStep()) / RATES[-2])


def frame_times(sampled: Callable[[Floats], Floats], times: Floats, within: float, most: float) -> Floats:
    """As many times as translations and scales in straight lines and rotations along arcs need to follow a
    frame, (f, 4, 4).

    within: a share of ``most``, the size of the model by which it is judged, which may be far out, or where
    that has none of its distance from the origin; radians; and a share of its scale.
    """

    def parts(times: Floats) -> Floats:
        return np.concatenate(decompose(sampled(times)), axis=1)

    if len(times) < 2:
        return times
    moves, _, scales = np.split(parts(times), PARTS, axis=1)
    goes = max(float(np.abs(moves).max()), 1e-9)
    size, large = max(most or goes, _FAR * goes), float(np.abs(scales).max()) or 1.0

    def error(found: Floats, left: Floats, right: Floats, share: Floats, _: Floats) -> Floats:
        return np.asarray(sum(parts_apart(found, left, right, share, size, large)))

    return adaptive_key_times(parts, error, times, within=within)


def parts_apart(
    found: Floats, left: Floats, right: Floats, share: Floats, size: float, large: float | Floats
) -> tuple[Floats, Floats, Floats]:
    """How far parts are, (f,) each, from what lines and arcs between two others give: shares of ``size``,
    radians, and shares of ``large``.

    found, left, right: translation, rotation and scale of a frame, (f, 10).
    """
    one, two = PARTS
    off = np.abs(found - left - (right - left) * share[:, np.newaxis])
    turned = angle_between(found[:, one:two], slerp(left[:, one:two], right[:, one:two], share))
    return off[:, :one].max(axis=1) / size, turned, off[:, two:].max(axis=1) / large
