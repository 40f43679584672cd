"""Key times that joints of one animation share, as USD stores them.

An array of a USD animation has all its joints at each of its times, so a reader finds keys at the times of
every other joint, too, rounded to float32. What is made to follow joints is made of these keys.
"""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterable
from dataclasses import replace

import numpy as np

from rigtri.evaluation.sampling import sample, sorted_unique
from rigtri.evaluation.timelines import as_float32, without_steps
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Path, Track
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig

# One array: the animation that holds it, and the path that it drives.
Array = tuple[Hashable, Path]


@dataclass(frozen=True, eq=False)
class Shared:
    """rig: with the keys that a reader finds. times: of each array. was: by id, each track that got more
    keys with what it was before."""

    rig: Rig
    times: dict[Array, Floats]
    was: dict[int, tuple[Track, Track]]

    def same_times(self, other: Shared) -> bool:
        """Whether all arrays have the same times in another state."""
        if self.times.keys() != other.times.keys():
            return False
        return all(np.array_equal(times, other.times[array]) for array, times in self.times.items())

    def undone(self, rig: Rig, before: Rig) -> Rig:
        """What was made of the rig, with the tracks as they were ``before`` where nobody gave them others."""
        if not self.was:
            return rig
        known = {clip.key: clip for clip in before.clips if clip.key is not None}
        return replace(rig, clips=tuple(self._undone(clip, known.get(clip.key)) for clip in rig.clips))

    def _undone(self, clip: Clip, before: Clip | None) -> Clip:
        tracks = tuple(self.was[id(t)][0] if id(t) in self.was else t for t in clip.tracks)
        for same in (clip, *([before] if before is not None else [])):
            if len(tracks) == len(same.tracks) and all(
                a is b for a, b in zip(tracks, same.tracks, strict=True)
            ):
                return same
        return replace(clip, tracks=tracks)


def with_shared_times(rig: Rig, without: Iterable[int] = ()) -> Shared:
    """The rig as a reader finds it; the keys of some nodes, ``without``, do not count, nor get others.

    Where clips stand alone, as in glTF, it is the rig itself.
    """
    mine = _arrays(rig, frozenset(without))
    times = {array: _together(tracks) for array, tracks in mine.items()}
    wide = {id(t): _wide(t, times[array]) for array, tracks in mine.items() for t in tracks}
    clips = tuple(_with(clip, wide) for clip in rig.clips)
    was = {id(wide[id(t)]): (t, wide[id(t)]) for each in mine.values() for t in each if wide[id(t)] is not t}
    return Shared(replace(rig, clips=clips) if was else rig, times, was)


def times_of(rig: Rig) -> dict[tuple[int, Path], Floats]:
    """The times, (k,), at which a reader finds keys of each joint that shares its times with others."""
    found: dict[tuple[int, Path], Floats] = {}
    for tracks in _arrays(rig).values():
        times = _together(tracks)
        found.update(((track.node, track.path), times) for track in tracks)
    return found


def _arrays(rig: Rig, without: Collection[int] = ()) -> dict[Array, list[Track]]:
    """The tracks of each array."""
    homes, mine = _homes(rig), dict[Array, list[Track]]()
    for clip in rig.clips:
        for track in clip.tracks if _shares(clip) else ():
            if track.node in homes and track.node not in without and track.path != "weights":
                mine.setdefault((homes[track.node], track.path), []).append(track)
    return mine


def _shares(clip: Clip) -> bool:
    """Whether joints share their times there: not what is seen without a time."""
    return isinstance(clip.key, tuple) and clip.key[0] != "default"


def _homes(rig: Rig) -> dict[int, Hashable]:
    """Which animation holds the keys of each joint: its skin's, or one that is to be made for it."""
    played = {t.node: clip.key for clip in rig.clips if _holds_joints(clip) for t in clip.tracks}
    found: dict[int, Hashable] = {}
    for number, skin in enumerate(rig.skins):
        joints = skin.joints.tolist()
        home = next((played[node] for node in joints if node in played), number)
        found.update(dict.fromkeys(joints, home))
    return found


def _holds_joints(clip: Clip) -> bool:
    return isinstance(clip.key, tuple) and clip.key[0] == "samples"


def _together(tracks: Iterable[Track]) -> Floats:
    """All times at which one of the tracks has a key, (k,)."""
    distinct = {id(t): without_steps(t).times for t in tracks}
    return sorted_unique(np.concatenate(list(distinct.values())))


def _wide(track: Track, times: Floats) -> Track:
    """The track with keys at all those times, as float32; itself where it has them."""
    if track.interpolation == "CUBICSPLINE" or np.array_equal(track.times, times):
        return track
    linear = without_steps(track)
    values = as_float32(sample(linear, times))
    at = np.clip(np.searchsorted(linear.times, times), 0, len(linear.times) - 1)
    own = linear.times[at] == times
    values[own] = linear.values[at[own]]
    return replace(linear, interpolation="LINEAR" if len(times) > 1 else "STEP", times=times, values=values)


def _with(clip: Clip, wide: dict[int, Track]) -> Clip:
    tracks = tuple(wide.get(id(t), t) for t in clip.tracks)
    same = all(a is b for a, b in zip(tracks, clip.tracks, strict=True))
    return clip if same else replace(clip, tracks=tracks)
