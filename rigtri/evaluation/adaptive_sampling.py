"""Adaptive sampling: times as near to each other as what happens between them needs.

An interval whose deviation is above a bound is divided, and its parts are looked at again. What is sampled,
how far it is off and how often it may be divided, the caller decides: `adaptive_key_times` for values
with a bound of their own, `straight_times` for splines, `rigtri.evaluation.curve_refinement` for a rig that a
solver moves.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.sampling import sample
from rigtri.evaluation.timelines import as_float32
from rigtri.maths.arrays import Integers
from rigtri.maths.quaternions import dot, slerp, unit
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Track
from rigtri.model.rig import Rig

# Where a gap is tested: quarters, and one share where two curves do not meet by chance.
TESTED = (0.25, 0.5, 0.75, 0.29)
# A gap is halved so often at most: float32 has no times in between any more.
_DEEPEST = 24
# More keys than this are a bound below the rounding of what is sampled.
MOST_KEYS = 100_000
# Halves of what is smooth are off by a quarter, at a corner by half. Where, in three rounds, so many gaps
# become nearly eight times as many and stay about as far off, it is rounding that is sampled.
_MANY, _ROUNDS, _MORE, _AS_FAR = 1024, 3, 5.0, 0.2

# How far splines may be off between two straight keys: rotations in radians, translations as a share of the
# size of what they move, scales of their largest, weights as numbers. Chains of joints add them up, so it is
# a part of what an edit may be off.
WITHIN = 1.5e-6

Sampled = Callable[[Floats], Floats]
Error = Callable[[Floats, Floats, Floats, Floats, Floats], Floats]
Deviations = Callable[[Floats, Integers], Floats]
Division = Callable[[Floats, Floats, Floats], Integers]


def refine_times(times: Floats, deviations: Deviations, division: Division) -> Floats:
    """Times, (k,): those given, rising, and as many between them as intervals are divided for.

    deviations: from all times and the numbers, (m,), of those that intervals start at → (m,).
    division: from starts, spans and deviations, (m,) each → into how many equal parts each interval goes, 1
    for none. Times are rounded to float32; an interval that has no such time inside stays.
    """
    left = np.arange(len(times) - 1)
    while len(left):
        off = deviations(times, left)
        start, span = times[left], times[left + 1] - times[left]
        new = _inside(start, span, division(start, span, off))
        if not len(new):
            break
        times = np.sort(np.concatenate([times, new]))
        places = np.searchsorted(times, new)
        left = np.unique(np.concatenate([places - 1, places]))
    return times


def _inside(start: Floats, span: Floats, pieces: Integers) -> Floats:
    """The times between so many pieces of each interval, each once, as far as float32 has them."""
    many = np.maximum(pieces - 1, 0)
    which = np.repeat(np.arange(len(start)), many)
    step = np.arange(len(which)) - np.repeat(np.cumsum(many) - many, many) + 1
    inside = as_float32(start[which] + step / pieces[which] * span[which])
    return np.unique(inside[(inside > start[which]) & (inside < start[which] + span[which])])


def adaptive_key_times(
    sample: Sampled, error: Error, times: Floats, *, within: float, of: str = "A clip"
) -> Floats:
    """Times of keys, (k,): those given, and halves between them until no error is above ``within``.

    sample: times (f,) → values (f, c). error: how far values (f, c) are from what keys give there,
    from (values, left values, right values, share (f,), times) → (f,). of: what is sampled, for a message.
    GeometryError where the rounding of large numbers is more than ``within``, so that no keys would do, and
    where more than `MOST_KEYS` would be needed.
    """
    rounds: list[
        tuple[int, float]
    ] = []  # how many intervals were divided in each, and how far these were off

    def deviations(times: Floats, left: Integers) -> Floats:
        start, end, worst = times[left], times[left + 1], np.zeros(len(left))
        inside = [start + share * (end - start) for share in TESTED]
        # All in one call: a few times take as long as many.
        every, rows = np.unique(np.concatenate([start, end, *inside]), return_inverse=True)
        values = sample(every)
        before, after, *places = rows.reshape(-1, len(left))
        for share, at, row in zip(TESTED, inside, places, strict=True):
            shares = np.full(len(left), share)
            worst = np.maximum(worst, error(values[row], values[before], values[after], shares, at))
        return worst

    def halved(start: Floats, span: Floats, off: Floats) -> Integers:
        wide = (off > within) & (len(rounds) < _DEEPEST)
        many = int(np.count_nonzero(wide))
        rounds.append((many, float(np.median(off[wide])) if many else 0.0))
        fewer, far = rounds[-1 - _ROUNDS] if len(rounds) > _ROUNDS else (many, 0.0)
        if many >= max(_MANY, _MORE * fewer) and not rounds[-1][1] < _AS_FAR * far:
            raise GeometryError(
                f"{of}: rounding alone is more than keys may be off, {within:.1g}, for numbers there are too "
                "large. Remove such keys: rigtri check lists those that are far away"
            )
        if many > MOST_KEYS:
            raise GeometryError(f"{of}: more than {MOST_KEYS} keys would be needed")
        return np.where(wide, 2, 1)

    return refine_times(times, deviations, halved)


def straight_times(track: Track, size: float) -> Floats:
    """Times of keys, (k,), with which straight lines, of rotations arcs, follow a spline within `WITHIN`.

    size: of what a translation moves, in the space that it is in (`sizes_above`).
    """

    def error(found: Floats, left: Floats, right: Floats, share: Floats, _: Floats) -> Floats:
        if track.path == "rotation":
            between = slerp(left, right, share)
            apart = np.abs(found - np.where(dot(found, between)[:, np.newaxis] < 0, -between, between))
            return np.asarray(2.0 * apart.max(axis=1))
        return np.asarray(np.abs(found - left - (right - left) * share[:, np.newaxis]).max(axis=1))

    far = size if track.path == "translation" else 1.0
    if track.path == "scale":
        far = float(np.abs(_shown(track, track.times)).max(initial=0.0)) or 1.0
    return adaptive_key_times(partial(_shown, track), error, track.times, within=WITHIN * far)


def sizes_above(rig: Rig, size: float) -> Floats:
    """How long ``size``, a length in the world, is in the space that each node's translation is in, (n,)."""
    # With one row more for no parent, which -1 is.
    grown = np.append(length(rig.normalised_world[:, :3, :3]).max(axis=1, initial=0.0), 1.0)[rig.parents]
    return size / np.where(np.isfinite(grown) & (grown > 0.0), grown, 1.0)


def without_splines(rig: Rig, size: float) -> Rig:
    """The rig with straight keys where clips have splines; see `straight_times`. size: in the world."""
    if not any(track.interpolation == "CUBICSPLINE" for clip in rig.clips for track in clip.tracks):
        return rig
    sizes = sizes_above(rig, size)
    clips = (
        replace(clip, tracks=tuple(_straight(track, sizes[track.node]) for track in clip.tracks))
        for clip in rig.clips
    )
    return replace(rig, clips=tuple(clips))


def _straight(track: Track, size: float) -> Track:
    if track.interpolation != "CUBICSPLINE":
        return track
    times = straight_times(track, size)
    return replace(track, interpolation="LINEAR", times=times, values=_shown(track, times))


def _shown(track: Track, times: Floats) -> Floats:
    """What a track shows, (f, c): splines of rotations leave the unit sphere between keys."""
    found = sample(track, times)
    return unit(found) if track.path == "rotation" else found
