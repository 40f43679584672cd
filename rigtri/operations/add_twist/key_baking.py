"""Baked keys of twist joints in clips: between keys they follow the driver within a bound."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from operator import itemgetter

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
from rigtri.model.animation import Clip, Path, Track, key_values
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


# What was found, by clip: the largest angle between a joint and what it should be between keys, in
# radians, and whether keys could have been added to make it less.
Found = dict[str, tuple[float, bool]]


def keyed(rig: Rig, twists: Sequence[TwistJoint]) -> tuple[Rig, list[Found]]:
    """The rig with rotation keys for twist joints in every clip that turns their drivers; and what was found.

    One after the other: a driver may be below a twist joint.
    """
    tracks = _TracksOfNodes(rig, {node for twist in twists for node in (twist.node, *twist.path)})
    still, every = replace(rig, clips=()), list[Found]()
    for twist in counted(twists, "twist joints"):
        small, place = still.subset(twist.path)
        local = replace(twist, path=tuple(place[k] for k in twist.path))
        found: Found = {}
        for number in tracks.clips((twist.node, *twist.path)):
            clip, old = rig.clips[number], tracks.of(number, (twist.node,), "rotation")
            driving = tracks.of(number, twist.path, "rotation")
            if not (driving or old):
                continue
            part = tuple(replace(t, node=place[t.node]) for t in tracks.of(number, twist.path))
            follower = _Follower(local, small, replace(clip, tracks=part))
            if driving:
                track, off = follower.track(driving, fixed=clip.fixed_times)
                found[clip.name or f"#{number}"] = off, not clip.fixed_times
            else:  # Its driver has keys no more: a joint that had some keeps them, for one pose.
                track = follower.still(old[0].times)
            track = replace(track, node=twist.node)
            if not old:
                tracks.set(number, None, track)
            elif not _same(old[0], track):
                tracks.set(number, old[0], replace(track, key=old[0].key))
        every.append(found)
    return tracks.rig(), every


class _TracksOfNodes:
    """The tracks of some nodes in all clips, found by the node, and what changes of them."""

    def __init__(self, rig: Rig, nodes: Collection[int]) -> None:
        self._rig = rig
        # By node and clip, each with its place among the tracks of the clip.
        self._found: dict[int, dict[int, list[tuple[int, Track]]]] = {node: {} for node in nodes}
        self._changed: dict[int, dict[int, Track]] = {}
        for number, clip in enumerate(rig.clips):
            for place, track in enumerate(clip.tracks):
                if track.node in self._found:
                    self._found[track.node].setdefault(number, []).append((place, track))

    def clips(self, nodes: Iterable[int]) -> list[int]:
        """The numbers of the clips that have tracks of any of the nodes."""
        return sorted({number for node in nodes for number in self._found[node]})

    def of(self, number: int, nodes: Iterable[int], path: Path | None = None) -> list[Track]:
        """The tracks of nodes in a clip as they are now, in its order; those of one path alone if given."""
        placed = sorted(
            (each for node in nodes for each in self._found[node].get(number, ())), key=itemgetter(0)
        )
        return [track for _, track in placed if path in (None, track.path)]

    def set(self, number: int, old: Track | None, new: Track) -> None:
        """Put a track in the place of an old one; without an old one at the end."""
        node = new.node
        mine, changed = self._found[node].setdefault(number, []), self._changed.setdefault(number, {})
        here = [place for place, track in mine if track is old]
        place = here[0] if here else len(self._rig.clips[number].tracks) + len(changed)
        changed[place] = new
        self._found[node][number] = [*(each for each in mine if each[0] != place), (place, new)]

    def rig(self) -> Rig:
        """The rig with all changes."""
        if not self._changed:
            return self._rig
        clips = list(self._rig.clips)
        for number, changed in self._changed.items():
            placed = {**dict(enumerate(clips[number].tracks)), **changed}
            tracks = tuple(track for _, track in sorted(placed.items(), key=itemgetter(0)))
            clips[number] = replace(clips[number], tracks=tracks)
        return replace(self._rig, clips=tuple(clips))


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

    def still(self, times: Floats) -> Track:
        """A track of keys that all hold what the joint has while nothing turns its driver."""
        return Track(-1, "rotation", "LINEAR", times, self.at(times))

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


def _same(old: Track, new: Track) -> bool:
    if old.interpolation != new.interpolation and len(old.times) > 1:
        return False
    if len(old.times) != len(new.times) or np.abs(old.times - new.times).max(initial=0.0) > _SAME:
        return False
    turns = multiply(conjugate(key_values(old)), key_values(new))
    return bool(rotation_angle(turns).max(initial=0.0) < _SAME)
