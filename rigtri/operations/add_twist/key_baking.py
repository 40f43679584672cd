"""Baked keys of twist joints in clips: between keys they follow the driver within a bound."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.evaluation.sampling import Motion
from rigtri.evaluation.timelines import as_float32, just_before
from rigtri.evaluation.twist_joints import TwistJoint
from rigtri.maths.arrays import Booleans
from rigtri.maths.quaternions import (
    angle_between,
    conjugate,
    make_continuous,
    multiply,
    rotation_angle,
    slerp,
)
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track, key_values
from rigtri.model.rig import Rig
from rigtri.progress import counted

# Between two keys a twist joint is off by less than this (0.02°): the twist of an interpolated turn
# is not the interpolated twist.
BOUND = 3.5e-4
# An interval is halved at most so often: a twist that jumps needs no more.
HALVINGS = 8
# Where an interval is looked at.
_SHARES = (0.25, 0.5, 0.75)
# Keys that differ by less are the ones that were there.
_SAME = 1e-6


def keyed(rig: Rig, twist: TwistJoint) -> tuple[Rig, dict[str, tuple[float, bool]]]:
    """The rig with rotation keys for a twist joint in every clip that turns its driver.

    Also what was found, by clip: the largest angle between the joint and what it should be between
    keys, in radians, and whether keys could have been added to make it less.
    """
    small, place = rig.subset(twist.path)
    found: dict[str, tuple[float, bool]] = {}
    clips = []
    for number, (clip, part) in enumerate(counted([*zip(rig.clips, small.clips, strict=True)], "clips")):
        driving = [track for track in part.tracks if track.path == "rotation"]
        old = [t for t in clip.tracks if t.node == twist.node and t.path == "rotation"]
        if not driving:
            clips.append(clip if not old else _without(clip, old))
            continue
        local = _Follower(replace(twist, path=tuple(place[k] for k in twist.path)), small, part)
        track, off = local.track(driving, fixed=clip.fixed_times)
        found[clip.name or f"#{number}"] = off, not clip.fixed_times
        clips.append(_with(clip, replace(track, node=twist.node), old[:1]))
    same = all(a is b for a, b in zip(clips, rig.clips, strict=True))
    return (rig if same else replace(rig, clips=tuple(clips))), found


class _Follower:
    """A twist joint in one clip."""

    def __init__(self, twist: TwistJoint, small: Rig, clip: Clip) -> None:
        self.twist, self.motion = twist, Motion(small, clip)

    def at(self, times: Floats) -> Floats:
        """Rotations at times, (f, 4), each on the side of the one before."""
        return make_continuous(self.twist.rotations(self.motion.locals_at(times)))

    def track(self, driving: list[Track], *, fixed: bool) -> tuple[Track, float]:
        """The track, and the largest angle off it between keys."""
        times = np.unique(np.concatenate([track.times for track in driving]))
        steps = [track.interpolation == "STEP" for track in driving]
        if all(steps):
            turns = self.at(times)
            return Track(-1, "rotation", "STEP", times, turns), 0.0
        if any(steps) and not fixed:
            times = _before_steps(times, driving)
        turns, off = self._off(times)
        for _ in range(0 if fixed else HALVINGS):
            bad = off > BOUND
            if not bad.any():
                break
            times = _halved(times, bad)
            turns, off = self._off(times)
        return Track(-1, "rotation", "LINEAR", times, make_continuous(turns)), float(off.max(initial=0.0))

    def _off(self, times: Floats) -> tuple[Floats, Floats]:
        """Rotations at times, (k, 4), and how far the interpolation is off in each interval, (k − 1,), if
        float32 has times between."""
        span = np.diff(times)
        inside = [times[:-1] + share * span for share in _SHARES]
        every = self.twist.rotations(self.motion.locals_at(np.concatenate([times, *inside])))
        turns, trues = every[: len(times)], every[len(times) :]
        start, end = (np.tile(side, (len(_SHARES), 1)) for side in (turns[:-1], turns[1:]))
        shown = slerp(start, end, np.repeat(_SHARES, len(span)))
        off = angle_between(shown, trues).reshape(len(_SHARES), len(span)).max(axis=0)
        middle = as_float32(times[:-1] + 0.5 * span)
        return turns, np.where((middle <= times[:-1]) | (middle >= times[1:]), 0.0, off)


def _before_steps(times: Floats, driving: list[Track]) -> Floats:
    """Key times with one just before each step of a joint that is keyed so."""
    steps = np.concatenate([t.times for t in driving if t.interpolation == "STEP"])
    before = just_before(steps)
    return np.unique(np.concatenate([times, before[before > times[0]]]))


def _halved(times: Floats, bad: Booleans) -> Floats:
    """Key times with one in the middle of each interval that is bad, as float32 can hold it."""
    middle = (times[:-1] + 0.5 * np.diff(times))[bad]
    return np.unique(np.concatenate([times, as_float32(middle)]))


def _with(clip: Clip, track: Track, old: list[Track]) -> Clip:
    """The clip with a track of ours, in the place of its old one; the clip itself where they are the same."""
    if not old:
        return replace(clip, tracks=(*clip.tracks, track))
    if _same(old[0], track):
        return clip
    new = replace(track, key=old[0].key)
    return replace(clip, tracks=tuple(new if t is old[0] else t for t in clip.tracks))


def _same(old: Track, new: Track) -> bool:
    if old.interpolation != new.interpolation and len(old.times) > 1:
        return False
    if len(old.times) != len(new.times) or np.abs(old.times - new.times).max(initial=0.0) > _SAME:
        return False
    turns = multiply(conjugate(key_values(old)), key_values(new))
    return bool(rotation_angle(turns).max(initial=0.0) < _SAME)


def _without(clip: Clip, tracks: list[Track]) -> Clip:
    return replace(clip, tracks=tuple(t for t in clip.tracks if not any(t is k for k in tracks)))
