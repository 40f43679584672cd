"""Tracks of baked values: no more keys than a tolerance needs, and none where nothing moves."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

import numpy as np

from rigtri.evaluation.active_controls import NOTHING, joints_of, posed_in
from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.ik import Ik
from rigtri.evaluation.key_reduction import is_reduction_of, reduce_keys
from rigtri.evaluation.old_rest import with_old_rest
from rigtri.evaluation.pose_cache import PoseCache
from rigtri.evaluation.sampling import key_times, sample
from rigtri.evaluation.timelines import SAME_VALUE, Timeline, as_float32, put_tracks, timelines
from rigtri.maths.quaternions import make_continuous
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import PATHS, Interpolation, Path, Track
from rigtri.model.rig import Rig


def reduced_tracks(
    timeline: Timeline,
    times: Floats,
    held: Floats,
    node: int,
    parts: Parts,
    rest: Parts,
    *,
    bounds: Sequence[float],
    size: float,
) -> list[Track]:
    """Tracks of a node for values at ``times``, (f,); none for a channel at ``rest`` that had no track.

    held: the times up to which values may be held. bounds: how far keys of each of `PATHS` may be off,
    in the parent's units, radians and shares. size: of the rig, in file units.
    """
    found = []
    for path, values, still, bound in zip(PATHS, parts, rest, bounds, strict=True):
        values = as_float32(make_continuous(values) if path == "rotation" else values)
        if path != "rotation" and timeline.track(node, path) is None:
            noise = NOTHING * (1.0 if path == "scale" else size)
            if np.abs(values - still).max() <= min(noise, max(bound, 1e-30)):
                continue
        found.append(_track(node, path, times, held, values, bound))
    return found


def with_rest_held(rig: Rig, before: Rig, nodes: Collection[int], chosen: Sequence[Timeline]) -> Rig:
    """The rig with keys of where nodes rested in ``before``, in timelines that have none of what has moved.

    There `reduced_tracks` has left out what is at rest, and joints that IK moves turn alone. Timelines that
    were not ``chosen`` look as before, but for joints whose controls stay posed there: a bake of them would
    move these joints to their new rest. So do clips that nothing plays yet.
    """
    baked = {timeline.members for timeline in chosen}
    was, now = PoseCache(before), PoseCache(rig)
    moved = [
        Track(node, path, "STEP", np.zeros(1), one)
        for node in nodes
        for path, one, other in zip(PATHS, was.part(node), now.part(node), strict=True)
        if not np.array_equal(one, other)
    ]
    for timeline in timelines(rig):
        start = key_times(timeline.clip)[:1]
        posed = joints_of(rig, () if timeline.members in baked else posed_in(rig, timeline))
        fresh = [
            replace(t, times=start)
            for t in moved
            if t.node not in posed and timeline.track(t.node, t.path) is None
        ]
        rig = put_tracks(rig, timeline, fresh) if len(start) else rig
    idle = (with_old_rest(clip, before, rig, nodes) if clip.idle else clip for clip in rig.clips)
    return replace(rig, clips=tuple(idle))


def posed_ends(rig: Rig, timeline: Timeline, limbs: Sequence[Ik], keyed: Iterable[Track]) -> list[Track]:
    """Keys of the pose of IK controls that are at work in a timeline because neither they nor their limbs
    have keys there: where limbs get keys, IK would else let go of them in the next bake, to constraints."""
    posed, moved = posed_in(rig, timeline), {track.node for track in keyed}
    return [
        Track(node, path, "STEP", key_times(timeline.clip)[:1], one)
        for limb in limbs
        for node in sorted(posed.intersection((limb.limb.control, *limb.limb.pivots)))
        if not moved.isdisjoint(limb.sets)
        for path, one in zip(PATHS[:2], PoseCache(rig).part(node)[:2], strict=True)
    ]


def _track(node: int, path: Path, times: Floats, held: Floats, values: Floats, bound: float) -> Track:
    if len(values) == 1:
        return Track(node, path, "STEP", times[:1], values)
    fresh = np.append(True, (values[1:] != values[:-1]).any(axis=1))
    if fresh.any() and np.isin(times[fresh][1:], held).all():
        return Track(node, path, "STEP", times[fresh], values[fresh])
    keys = reduce_keys(times, values, bound)
    way: Interpolation = "LINEAR" if len(keys) > 1 else "STEP"
    return Track(node, path, way, times if len(keys) == len(times) else times[keys], values[keys])


def key_counts(start: Rig, timeline: Timeline, tracks: Sequence[Track]) -> dict[int, tuple[int, int]]:
    """How many keys each node gets, and how many the file had of the same channels in ``start``."""
    channels = {(track.node, track.path) for track in tracks}
    before, now = Counter[int](), Counter[int]()
    for track in (t for k in timeline.members for t in start.clips[k].without_idle.tracks):
        before[track.node] += len(track.times) if (track.node, track.path) in channels else 0
    for track in tracks:
        now[track.node] += len(track.times)
    return {node: (now[node], before[node]) for node in now}


def is_still_valid(
    old: Track | None, new: Track, times: Floats, values: Floats, *, bound: float, room: Floats
) -> bool:
    """Whether a track is what thinning the values, (f, c) at ``times``, may have left, as ``new`` is.

    What differs by rounding can turn the choice of keys, and a second run must change nothing. But no key
    stays where a reader finds none with the new ones: ``room``, the times at which one does. bound: how
    far thinned keys may be off, in the values' unit or radians.
    """
    if old is None or not old.interpolation == new.interpolation == "LINEAR":
        return False
    if not (np.isin(old.times, room).all() and np.isin(old.times, times).all()):
        return False
    # Radians: of turns by the unit quaternions that differ so.
    size = 2.0 if new.path == "rotation" else float(np.abs(values).max(initial=0.0))
    return is_reduction_of(times, values, sample(old, times), bound, SAME_VALUE * size)
