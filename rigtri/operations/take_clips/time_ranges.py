"""The time range of a clip that is longer or shorter in EDITED than in RIG, and RIG's keys in its range."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from rigtri.errors import FileError, GeometryError
from rigtri.evaluation.key_insertion import subdivide_spline
from rigtri.evaluation.sampling import sample
from rigtri.evaluation.timelines import Timeline, as_float32, just_before
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.clip_matching import Taken
from rigtri.operations.take_clips.generated_names import frame_of, span
from rigtri.operations.take_clips.messages import moves
from rigtri.operations.take_clips.track_comparison import MISSED

# Frames: ends that are nearer are one. A DCC begins and ends a clip up to a frame beside its own frames.
_NEAR = 1.5
# No DCC has fewer frames a second: what is farther apart has keys by hand, which give no frame rate.
_FEWEST = 12.0


class Clock:
    """Times of the edited file as times of the rig: in its unit, and from its start where lengths are one."""

    def __init__(self, rig: Rig, edited: Rig, taken: Taken) -> None:
        if not edited.rules.per_second > 0.0:
            raise FileError(
                "--from: the file has 0 time codes per second; set its timeCodesPerSecond, e.g. to 24"
            )
        self.factor = rig.rules.per_second / edited.rules.per_second
        self.shift = 0.0
        # USD has times in float64, glTF in float32.
        self._rounds = edited.rules.raw_quaternions and not rig.rules.raw_quaternions
        # Why the two may differ in speed alone: the file came back with another frame rate.
        self.lost_rate = ""
        if taken.home is not None and edited.rules.raw_quaternions and self.factor != 1.0:
            both = zip(span(taken.clip), span(taken.home.clip), strict=True)
            if rig.rules.raw_quaternions and all(abs(a - b) <= MISSED for a, b in both):
                self.lost_rate = (
                    f"it has the time codes of RIG, at {edited.rules.per_second:g} a second instead of "
                    f"{rig.rules.per_second:g}, so it plays at another speed: give the scene the frame rate "
                    f"{rig.rules.per_second:g} and export it again"
                )
        # Where the clip may be moved to when its start and its length are others: to RIG's start first.
        self.choices: tuple[float, ...] = ()
        # Where it may be moved to by less than that: Blender's NLA tracks come out one frame late.
        self.beside: tuple[float, ...] = ()
        self._known = {clip_times.tobytes(): clip_times for clip_times in _times_of(taken.home)}
        self._times_of_rig: dict[int, tuple[Floats, Floats]] = {}
        frame = frame_of(taken.clip)
        if taken.home is not None and frame:
            (start, end), (ours, last) = span(taken.clip), span(taken.home.clip)
            late = start * self.factor - ours
            length, own = (end - start) * self.factor, last - ours
            if abs(late) > 1.5 * frame * self.factor:
                if abs(length - own) <= frame * self.factor:
                    self.shift = -late
                else:
                    self.choices = (-late, 0.0, last - end * self.factor)
            elif abs(late) > MISSED * rig.rules.per_second:
                self.beside = (0.0, -late)

    def settle(self, shift: float) -> None:
        """Move EDITED's times by so much of the rig's unit."""
        self.shift = shift
        self._times_of_rig.clear()

    def times(self, theirs: Floats) -> Floats:
        """Times of the edited file as those of the rig, (k,)."""
        if self.factor == 1.0 and not self.shift and not self._rounds:
            return theirs
        return _rounded(theirs * self.factor + self.shift)

    def moved(self, track: Track) -> Track:
        """A track where the clip lies, in EDITED's own unit."""
        return replace(track, times=_rounded(track.times + self.shift / self.factor))

    def to_rig_time(self, track: Track) -> Track:
        """A track at the rig's times; arrays that are one stay one."""
        if id(track.times) not in self._times_of_rig:
            times = self.times(track.times)
            times = self._known.get(times.tobytes(), times)
            self._times_of_rig[id(track.times)] = track.times, times
        times, values = self._times_of_rig[id(track.times)][1], track.values
        if track.interpolation == "CUBICSPLINE" and self.factor != 1.0:
            values = values * np.array([1.0 / self.factor, 1.0, 1.0 / self.factor])[:, np.newaxis]
        return replace(track, times=times, values=values)

    def to_edited_unit(self, track: Track) -> Track:
        """A track of the rig's, where it lies, with its times in EDITED's unit."""
        if self.factor == 1.0:
            return track
        values = track.values
        if track.interpolation == "CUBICSPLINE":
            values = values * np.array([self.factor, 1.0, self.factor])[:, np.newaxis]
        return replace(track, times=_rounded(track.times / self.factor), values=values)


def _rounded(times: Floats) -> Floats:
    """Times as float32 keeps them, (k,). Those of a step, which USD holds nearer than that, stay two."""
    stored = as_float32(times)
    later = times[1:] > times[:-1]
    if (later & (stored[1:] <= stored[:-1])).any():
        for k in np.flatnonzero(later)[::-1]:
            if stored[k] >= stored[k + 1]:
                stored[k] = just_before(stored[k + 1])
    return stored


def _times_of(home: Timeline | None) -> list[Floats]:
    tracks = home.clip.tracks if home is not None else ()
    return list({id(t.times): t.times for t in tracks}.values())


# A track of RIG and the one of EDITED that drives the same, at EDITED's times.
Pair = tuple[Track, Track]


@dataclass(frozen=True, eq=False)
class Ranges:
    """The ranges, in RIG's unit, of a clip: RIG's, EDITED's as it is there, and as it is taken.

    whole: RIG's clip is to have the range that EDITED's has, as EDITED moves most of what RIG moves.
    reported: whether the user is to know of it.
    """

    ours: tuple[float, float]
    theirs: tuple[float, float]
    taken: tuple[float, float]
    whole: bool
    reported: bool
    lost_rate: str = ""

    def fitted(self, track: Track, own: tuple[float, float] | None) -> Track:
        """A track in the clip's range, or in that which EDITED's track has, ``own``: cut on its own curve, or
        with one more key where it holds; all other keys bit for bit.
        """
        own = own if own is not None and own[0] < own[1] else None
        track = cut(track, *(own or self.taken))
        return with_end_keys(track, *own) if own is not None else track

    def notice(self, name: str) -> str:
        """The warning about it."""
        (a, b), (c, d), (e, f) = self.theirs, self.ours, self.taken
        now = "" if (a, b) == (e, f) else f", moved to {e:.6g} to {f:.6g}"
        what = "it was taken as a whole" if self.whole else "what it has keys of was taken"
        return (
            f"'{name}' runs from {a:.6g} to {b:.6g} in EDITED and from {c:.6g} to {d:.6g} in RIG; {what}{now}"
            f"{'; ' * bool(self.lost_rate)}{self.lost_rate}"
        )


def ranges(
    rig: Rig, taken: Taken, clock: Clock, pairs: Callable[[], Sequence[Pair]], same: Callable[[Pair], bool]
) -> Ranges | None:
    """Settle where EDITED's clip lies, and if RIG's is to have its range; None where both have one range.

    pairs: what drives the same in both. same: whether a track agrees with RIG's, by the clock as set.
    Raises GeometryError where EDITED has a part of the motion, and its time is not known.
    """
    assert taken.home is not None  # a new clip has its own range
    ours, there = span(taken.home.clip), span(taken.clip)
    theirs = (there[0] * clock.factor, there[1] * clock.factor)
    near = _NEAR * min(frame_of(taken.clip) * clock.factor, rig.rules.per_second / _FEWEST)

    def differ() -> bool:
        return any(abs(a - b) > near for a, b in zip(clock.times(np.array(there)), ours, strict=True))

    if not clock.choices and not clock.beside and not differ():
        return None
    moving = {(t.node, t.path) for t in taken.home.clip.tracks if t.path != "weights" and moves(t)}
    shared = [(was, now) for was, now in pairs() if (was.node, was.path) in moving]
    most = 2 * len(shared) >= len(moving)
    if clock.beside:
        found = [_agreeing(clock, shift, shared, same) for shift in clock.beside]
        clock.settle(clock.beside[int(np.argmax(found))])
        if not differ():
            return None
    if clock.choices:
        found = [_agreeing(clock, shift, shared, same) for shift in clock.choices]
        inside = ours[0] - near <= theirs[0] and theirs[1] <= ours[1] + near
        if not max(found) and not most and not inside:
            raise GeometryError(
                f"EDITED moves little of what moves in '{taken.name}', from {theirs[0]:.6g} to "
                f"{theirs[1]:.6g}, where RIG has {ours[0]:.6g} to {ours[1]:.6g}, and no track of both says "
                "which time is which. "
                "Export the whole clip, or let it start where RIG's does"
            )
        clock.settle(clock.choices[int(np.argmax(found))] if max(found) or most else 0.0)
    first, last = clock.times(np.array(there)).tolist()
    whole = differ() and most
    return Ranges(ours, theirs, (first, last), whole, whole or bool(clock.choices), clock.lost_rate)


def _agreeing(clock: Clock, shift: float, pairs: Sequence[Pair], same: Callable[[Pair], bool]) -> int:
    """How many tracks that move give the motion of RIG where the clip is moved by ``shift``."""
    clock.settle(shift)
    return sum(moves(pair[1]) and same(pair) for pair in pairs)


def cut(track: Track, start: float, end: float) -> Track:
    """A track between two times, where it has keys outside of them: with one more at the end that was cut."""
    times = track.times
    early, late = times < start - MISSED, times > end + MISSED
    if not (early.any() or late.any()):
        return track
    ends = [time for time, beyond in ((start, early), (end, late)) if beyond.any()]
    kept = np.union1d(times[~early & ~late], _between(ends, times, start, end))
    return replace(track, times=kept, values=_on_curve(track, kept))


def with_end_keys(track: Track, start: float, end: float) -> Track:
    """A track with several keys up to two times, with a key at each that it does not reach."""
    times = track.times
    ends = [
        time for time, short in ((start, times[0] > start + MISSED), (end, times[-1] < end - MISSED)) if short
    ]
    if not ends or len(times) < 2:
        return track
    more = np.union1d(times, ends)
    return replace(track, times=more, values=_on_curve(track, more))


def _between(ends: Sequence[float], times: Floats, start: float, end: float) -> Floats:
    """The cut ends, (k,), at which there is no key: of what lies outside altogether the nearer one."""
    if times[-1] < start - MISSED or times[0] > end + MISSED:
        ends = [start if times[-1] < start else end]
    return np.array([t for t in ends if not (np.abs(times - t) <= MISSED).any()], dtype=np.float64)


def _on_curve(track: Track, times: Floats) -> Floats:
    """The keys of a track at other times, as its curve has them; its own to the bit."""
    if track.interpolation == "CUBICSPLINE":
        if len(track.times) < 2:
            return track.values
        every = np.union1d(track.times, times)
        return np.asarray(subdivide_spline(track, every)[np.isin(every, times)])
    values = sample(track, times)
    at = np.clip(np.searchsorted(track.times, times), 0, len(track.times) - 1)
    own = track.times[at] == times
    values[own] = track.values[at[own]]
    return values
