"""Timelines: what plays at the same time in a file, and how new tracks are put into it.

A glTF animation plays alone. Animations of a USD stage share its time: their keys are
tuples, and what drives prims, skeletons and morphs together gives one pose.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from functools import cached_property

import numpy as np

from rigtri.errors import GeometryError, NameNotFoundError, UsageError
from rigtri.evaluation.sampling import clip_and_time, key_times, sample
from rigtri.maths.quaternions import dot
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Interpolation, Path, Track
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig

# float32 readers see no difference below this share; a second run must change no byte.
SAME_VALUE = 1e-6
# Formats that keep times as float32 can distinguish two keys this far apart, as a share of the time.
_SINGLE = np.float32
# The key of the clip that `played_at_once` makes.
PLAYED = ("played", "")
# Keys that evenly spaced times may come to in one clip.
MOST_KEYS = 1_000_000


@dataclass(frozen=True, eq=False)
class Timeline:
    """Clips that play together: all their tracks in ``clip``, their places in `Rig.clips` in ``members``."""

    clip: Clip
    members: tuple[int, ...]

    @property
    def name(self) -> str:
        """The name of the clip that new tracks go into, or its number."""
        return self.clip.name or f"#{self.members[0]}"

    def track(self, node: int, path: Path) -> Track | None:
        """What drives a property; None where nothing does."""
        return self._driving.get((node, path))

    @cached_property
    def _driving(self) -> Mapping[tuple[int, Path], Track]:
        """By what it drives; of several tracks the first."""
        return {(track.node, track.path): track for track in reversed(self.clip.tracks)}


def timelines(rig: Rig) -> list[Timeline]:
    """All that can be played, in the file's order; clips without tracks, and what is idle, are left out."""
    alone = [k for k, clip in enumerate(rig.clips) if not isinstance(clip.key, tuple)]
    together = [
        k
        for k, clip in enumerate(rig.clips)
        if isinstance(clip.key, tuple) and (not clip.idle or clip.without_idle.tracks)
    ]
    found = [Timeline(rig.clips[k], (k,)) for k in alone if rig.clips[k].without_idle.tracks]
    for shown in _in_step(rig, together):
        # Defaults are seen only where no samples are, so they come first and samples go over them.
        order = sorted(shown, key=lambda k: not _is_default(rig.clips[k]))
        tracks = {(t.node, t.path): t for k in order for t in rig.clips[k].without_idle.tracks}
        first = min(shown, key=lambda k: _is_default(rig.clips[k]))
        members = (first, *(k for k in shown if k != first))
        found.append(Timeline(Clip(rig.clips[first].name, as_played(rig, tuple(tracks.values()))), members))
    return found


def _in_step(rig: Rig, together: Sequence[int]) -> Iterator[list[int]]:
    """Clips of a stage that play at the same time, by their numbers.

    Instances of one character play an animation each, which move the same nodes: every one of them plays
    with all that moves other nodes.
    """
    movers: dict[tuple[int, Path], dict[Hashable, None]] = {}
    for clip in (rig.clips[k] for k in together):
        # The stage's own keys of prims are no animation that an instance plays.
        for track in clip.without_idle.tracks if clip.animation != PLAYED[1:] else ():
            movers.setdefault((track.node, track.path), {})[clip.animation] = None
    ways = {tuple(animations) for animations in movers.values()}
    shown = any(rig.clips[k].without_idle.tracks for k in together)
    for turn in range(max(map(len, ways), default=int(shown))):
        others = {a for way in ways for k, a in enumerate(way) if k != min(turn, len(way) - 1)}
        yield [k for k in together if rig.clips[k].animation not in others]


def played_at_once(rig: Rig, name: str) -> Rig:
    """The rig with all that shares its time in one clip called ``name``: a prim's keys stand in other clips
    of a stage than a joint's, and one pose is all that is seen of them.

    What is seen without a time, or not at all, stays in clips of its own. Without keys nothing changes.
    """
    every = [t for t in timelines(rig) if isinstance(rig.clips[t.members[0]].key, tuple)]
    found = next(iter(every), None)
    if found is None or _is_default(rig.clips[found.members[0]]):
        return rig
    # What moves prims is seen with whatever instances of a character play.
    others = {k for each in every for k in each.members}.difference(found.members)
    loose = {(t.node, t.path): t for k in sorted(others) for t in rig.clips[k].tracks if _is_loose(rig, t)}
    apart = [
        replace(clip, tracks=tuple(t for t in clip.tracks if not _is_loose(rig, t))) if k in others else clip
        for k, clip in enumerate(rig.clips)
        if k not in found.members or _is_default(clip) or (clip.idle and clip.tracks)
    ]
    tracks = loose | {(t.node, t.path): t for t in found.clip.tracks}
    shown = replace(found.clip, name=name, key=PLAYED, tracks=tuple(tracks.values()))
    return replace(rig, clips=(shown, *apart))


def _is_loose(rig: Rig, track: Track) -> bool:
    return track.path != "weights" and not rig.is_joint[track.node]


def chosen_timelines(rig: Rig, patterns: Sequence[str]) -> list[Timeline]:
    """The timelines with clips that globs match, by name or ``#NUMBER``; all where there is no glob.

    Raises NameNotFoundError for a glob that matches none.
    """
    every = timelines(rig)
    found: list[Timeline] = []
    for pattern in patterns:
        matching = matching_clips(rig, pattern)
        hits = [t for t in every if not matching.isdisjoint(t.members)]
        if not hits:
            raise NameNotFoundError("clip", pattern, rig.clip_titles)
        found += [t for t in hits if t not in found]
    return found if patterns else every


def matching_clips(rig: Rig, pattern: str) -> set[int]:
    """The numbers of the clips that a glob matches, by name or ``#NUMBER``; a clip's own name is no glob."""
    pattern = rig.clip_name(pattern)
    named = any(clip.name == pattern for clip in rig.shown_clips)
    return {
        k
        for k, clip in enumerate(rig.clips)
        if pattern in (clip.name, f"#{k}") or (not named and fnmatchcase(clip.name, pattern))
    }


def timeline_and_time(rig: Rig, text: str) -> tuple[Timeline | None, float]:
    """The timeline and the time that ``CLIP@TIME`` names, the last @ splits; None and 0 for ``rest``.

    A time that is printed as that of a key names the key. Raises UsageError, NameNotFoundError, and
    GeometryError for a clip that plays nothing.
    """
    if text.lower() == "rest":
        return None, 0.0
    named = clip_and_time(text)
    if named is None:
        units = "seconds" if rig.rules.per_second == 1.0 else f"time codes, {rig.rules.per_second:g} a second"
        # A USD animation's values without time are the clip NAME@default.
        example = f"{text}@0" if any(clip.name == text for clip in rig.shown_clips) else "walk@0.5"
        raise UsageError(f"'{text}' is not a valid pose: use CLIP@TIME in {units}, e.g. {example}, or rest")
    name, at = named
    clip = rig.clip(name)
    number = next((k for k, known in enumerate(rig.clips) if known is clip or known.without_idle is clip), -1)
    found = next((t for t in timelines(rig) if number in t.members), None)
    if found is None:
        raise GeometryError(f"Clip '{name}' has no keys")
    keys = key_times(found.clip)
    near = float(keys[np.argmin(np.abs(keys - at))])
    # Times are printed with six digits; a second key beside the one that is meant would be a jump.
    return found, near if f"{near:g}" == f"{at:g}" else at


def as_played(rig: Rig, tracks: Sequence[Track]) -> Sequence[Track]:
    """The tracks with keys for what their format shows where their values end: blocked samples (USD).

    A value stays until the block and does not go over to the next one. From there to the next sample of that
    path UsdSkel shows the rest pose in all that places the node, or no blend shape (measured with OpenUSD
    26.11). Jumps take the last bit of their times in float32.
    """
    ending = rig.rules.resting
    if not any(track.node in ending for track in tracks):
        return tracks
    spans: dict[tuple[int, bool], list[tuple[float, float]]] = {}
    for track in tracks:
        if track.node in ending:
            found = spans.setdefault((track.node, track.path == "weights"), [])
            found += _spans(track, ending[track.node].since.get(track.path, ()))
    return [
        _interrupted(rig, track, ending[track.node].since.get(track.path, ()), held)
        if (held := spans.get((track.node, track.path == "weights")))
        else track
        for track in tracks
    ]


def _spans(track: Track, since: Sequence[float]) -> list[tuple[float, float]]:
    """From when to when a track has no values; before its first key it has those of that."""
    ends = [next(iter(track.times[track.times > time].tolist()), np.inf) for time in since]
    first = float(track.times[0]) if len(track.times) else np.inf
    return [(-np.inf if time < first else time, end) for time, end in zip(since, ends, strict=True)]


def _interrupted(
    rig: Rig, track: Track, since: Sequence[float], spans: Sequence[tuple[float, float]]
) -> Track:
    """A track that keeps its values until each of ``since`` and shows the rest pose during the spans."""
    still = np.zeros(track.values.shape[-1])
    rest = still if track.path == "weights" else getattr(rig, track.path)[track.node]
    times = np.union1d(track.times, since)
    last = np.maximum(np.searchsorted(track.times, times, side="right") - 1, 0)
    kept = replace(track, times=times, values=track.values[last])
    bounds = np.array([bound for span in spans for bound in span])
    bounds = bounds[np.isfinite(bounds)]
    times = np.unique(np.concatenate([times, bounds, just_before(bounds)]))
    values = sample(kept, times)
    for start, end in spans:
        values[(times >= start) & (times < end)] = rest
    return replace(track, times=times, values=values)


def _is_default(clip: Clip) -> bool:
    return isinstance(clip.key, tuple) and clip.key[0] == "default"


def put_tracks(rig: Rig, timeline: Timeline, tracks: Iterable[Track]) -> Rig:
    """The rig with tracks put into a timeline: each takes the place of the one that drove the same.

    A track with the same curve as the one before it leaves that as it is, to the bit. See `Rig.with_parts`
    for nodes with a matrix, and what is refused of them.
    """
    tracks = list(tracks)
    rig = rig.with_parts(track.node for track in tracks if track.path != "weights")
    made = {k: list(rig.clips[k].tracks) for k in timeline.members}
    places: dict[tuple[int, Path], tuple[int, int]] = {}
    for k in timeline.members:
        for at, known in enumerate(() if _is_default(rig.clips[k]) else made[k]):
            places.setdefault((known.node, known.path), (k, at))
    changed, first = set(), timeline.members[0]
    for track in tracks:
        home, at = places.get((track.node, track.path), (first, -1))
        if at < 0:
            if not _is_default(rig.clips[first]):
                places[track.node, track.path] = first, len(made[first])
            made[first].append(track)
        elif _same_curve(made[home][at], track):
            continue
        else:
            made[home][at] = replace(track, key=made[home][at].key, raw=made[home][at].raw)
        changed.add(home)
    if not changed:
        return rig
    clips = (replace(c, tracks=tuple(made[k])) if k in changed else c for k, c in enumerate(rig.clips))
    return replace(rig, clips=tuple(clips))


def same_curves(was: Clip, now: Clip) -> bool:
    """Whether two clips have the same tracks in the same order, but for rounding."""
    if was is now:
        return True
    return len(was.tracks) == len(now.tracks) and all(
        one is other or ((one.node, one.path) == (other.node, other.path) and _same_curve(one, other))
        for one, other in zip(was.tracks, now.tracks, strict=True)
    )


def _same_curve(was: Track, now: Track) -> bool:
    if was.interpolation != now.interpolation and "CUBICSPLINE" in (was.interpolation, now.interpolation):
        return False
    if was.interpolation == "LINEAR":
        now = without_steps(now)  # what formats without steps made of it
    if was.interpolation != now.interpolation and len(was.times) > 1 < len(now.times):
        return False
    if len(now.times) < len(was.times) and np.isin(now.times, was.times).all():
        # Where all joints share their key times, a track has those of the others, too.
        if was.interpolation == "CUBICSPLINE":
            return False
        now = replace(now, times=was.times, values=sample(now, was.times))
    if not np.array_equal(was.times, now.times) or was.values.shape != now.values.shape:
        return False
    values = now.values
    if now.path == "rotation":  # q and −q are one rotation
        values = np.where(dot(was.values, values)[..., np.newaxis] < 0, -values, values)
    size = max(1.0, float(np.abs(values).max(initial=0.0))) if now.path != "translation" else _size(values)
    return bool(np.abs(was.values - values).max(initial=0.0) <= SAME_VALUE * size)


def _size(values: Floats) -> float:
    return max(float(np.abs(values).max(initial=0.0)), 1e-30)


def times_within(timeline: Timeline, fps: float | None, per_second: float = 1.0) -> Floats:
    """The times to start from, (f,): all keys, and with ``fps`` so many evenly spaced ones a second.

    per_second: units of the clip's time in a second. UsageError where that would be too many, and where
    there are none in a second.
    """
    distinct = {id(track.times): track.times for track in timeline.clip.tracks if len(track.times) > 1}
    keys = np.unique(np.concatenate([*distinct.values(), np.zeros(0)]))
    keys = keys[np.isfinite(keys)]
    firsts = np.array([track.times[0] for track in timeline.clip.tracks if len(track.times)])
    firsts = firsts[np.isfinite(firsts)]
    if not len(keys):
        return np.sort(firsts)[:1] if len(firsts) else np.zeros(1)
    # One key is held at all times: it makes no clip longer, but somebody looks at what is there.
    keys = np.union1d(keys, firsts[(keys[0] < firsts) & (firsts < keys[-1])])
    if fps is None:
        return keys
    if not per_second > 0.0:
        raise UsageError(
            f"--fps {fps:g}: the file has {per_second:g} time codes per second, so clip '{timeline.name}' "
            "has no length in seconds; leave --fps out"
        )
    needed = (float(keys[-1]) - float(keys[0])) / per_second * fps
    if not needed <= MOST_KEYS:
        raise UsageError(
            f"--fps {fps:g}: that would be {needed:.6g} keys in clip '{timeline.name}', and "
            f"{MOST_KEYS} are the most"
        )
    step = per_second / fps
    count = int((keys[-1] - keys[0]) / step)
    even = as_float32(keys[0] + step * np.arange(1, count + 1))
    return np.unique(np.concatenate([keys, even[even < keys[-1]]]))


def times_and_jumps(timeline: Timeline, fps: float | None, per_second: float = 1.0) -> Floats:
    """See `times_within`; and, where something moves between keys, the last times before jumps."""
    times = times_within(timeline, fps, per_second)
    if steps_only(timeline):
        return times
    before = just_before(jumps(timeline))
    return np.unique(np.concatenate([times, before[before > times[0]]]))


def as_float32(times: Floats) -> Floats:
    """Times as float32 keeps them."""
    return np.asarray(times.astype(_SINGLE).astype(np.float64))


def just_before(times: Floats) -> Floats:
    """The last float32 times before these."""
    return np.asarray(np.nextafter(times.astype(_SINGLE), _SINGLE(-np.inf)).astype(np.float64))


def keys_and_between(keys: Floats) -> Floats:
    """Keys and two places between each two, as far as float32 has times there.

    Across a jump, between a key and the one just before it, there is nothing to look at.
    """
    inside = as_float32(np.concatenate([keys[:-1] + share * np.diff(keys) for share in (0.29, 0.5)]))
    return np.unique(np.concatenate([keys, inside]))


def jumps(timeline: Timeline) -> Floats:
    """The times, (k,), at which a track that holds its values goes on to the next one."""
    held = {id(t.times): t.times[1:] for t in timeline.clip.tracks if t.interpolation == "STEP"}
    return np.unique(np.concatenate([*held.values(), np.zeros(0)]))


def steps_only(timeline: Timeline) -> bool:
    """Whether nothing of it moves between keys."""
    return all(t.interpolation == "STEP" or len(t.times) == 1 for t in timeline.clip.tracks)


def without_steps(track: Track) -> Track:
    """The same curve without held values: a key just before each jump keeps it.

    The jump then takes the last bit of its time in float32. Other tracks are as they were.
    """
    if track.interpolation != "STEP" or len(track.times) < 2:
        return track
    jumps = (track.values[1:] != track.values[:-1]).any(axis=1)
    before = just_before(track.times[1:])
    before = before[jumps & (before > track.times[:-1])]
    times = np.unique(np.concatenate([track.times, before]))
    return replace(track, interpolation="LINEAR", times=times, values=sample(track, times))


def merged_weights(was: Track, times: Floats, columns: Sequence[int], values: Floats) -> Track:
    """A weights track with some of its columns replaced: keys at the union of both times.

    values: (f, len(columns)) at ``times``, linear between. The other columns keep the values that
    they had: exactly, but for the rounding of values that new keys repeat between old ones.
    ValueError for splines, whose curves no union of keys can keep.
    """
    if was.interpolation == "CUBICSPLINE" and len(was.times) > 1:
        raise ValueError("splines cannot take keys of another track")
    was = without_steps(was)
    # One key holds at all times.
    old = was.times if len(was.times) > 1 else was.times[:0]
    together = np.unique(np.concatenate([old, times]))
    rows = sample(was, together)
    new = Track(was.node, "weights", "LINEAR", times, values)
    rows[:, list(columns)] = sample(new, together)
    unlisted = was.unlisted.difference(columns)
    return replace(was, interpolation=_linear(together), times=together, values=rows, unlisted=unlisted)


def _linear(times: Floats) -> Interpolation:
    return "LINEAR" if len(times) > 1 else "STEP"
