"""How the clips of two rigs differ: which tracks, which keys, by how much."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rigtri.maths.quaternions import unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.verification.compare.correspondence import Correspondence, by_target, partner_track
from rigtri.verification.diff.change import Change, furthest, same_numbers

GROUP = "clips"


def clip_changes(before: Rig, after: Rig, m: Correspondence, tolerance: float) -> Iterator[Change]:
    """Clips that are gone or new, and the tracks of the others."""
    partners = m.clip.tolist()
    loose = [k for k in range(len(after.clips)) if k not in partners]
    for k, now in enumerate(partners):
        clip, title = before.clips[k], _title(before.clips[k], k)
        twin = next((j for j in loose if after.clips[j].key == clip.key and clip.key is not None), -1)
        if now < 0 and twin >= 0:
            loose.remove(twin)
            yield Change(GROUP, "changed", title, f"renamed to {_title(after.clips[twin], twin)}")
            now = twin
        if now < 0:
            yield Change(GROUP, "removed", title, f"{len(clip.tracks)} tracks")
        else:
            if clip.idle != after.clips[now].idle:
                yield Change(GROUP, "changed", title, f"is played {'now' if clip.idle else 'no longer'}")
            yield from _tracks(before, after, m, (clip, after.clips[now]), title, tolerance)
    for k in loose:
        yield Change(GROUP, "added", _title(after.clips[k], k), f"{len(after.clips[k].tracks)} tracks")


def _title(clip: Clip, number: int) -> str:
    return clip.name or f"#{number}"


def _tracks(
    before: Rig, after: Rig, m: Correspondence, clips: tuple[Clip, Clip], title: str, tolerance: float
) -> Iterator[Change]:
    there = by_target(clips[1].tracks)
    found = set()
    for track in clips[0].tracks:
        where = f"{title}: {track.path} of {before.title(track.node)}"
        now = partner_track(track, there, m)
        if now is None:
            yield Change(GROUP, "removed", where, f"{len(track.times)} keys")
            continue
        found.add((now.node, now.path))
        yield from _track(track, now, where, tolerance)
    for target, track in there.items():
        if target not in found:
            where = f"{title}: {track.path} of {after.title(track.node)}"
            yield Change(GROUP, "added", where, f"{len(track.times)} keys")


def _track(track: Track, now: Track, where: str, tolerance: float) -> Iterator[Change]:
    if track.interpolation != now.interpolation:
        yield Change(GROUP, "changed", where, f"interpolation {track.interpolation} → {now.interpolation}")
    if len(track.times) != len(now.times):
        yield Change(GROUP, "changed", where, f"keys {len(track.times)} → {len(now.times)}")
        return
    if not same_numbers(track.times, now.times, tolerance):
        yield Change(GROUP, "changed", where, f"times: {furthest(track.times, now.times)}")
    if track.values.shape != now.values.shape:
        return
    if not same_numbers(track.values, now.values, tolerance):
        yield Change(GROUP, "changed", where, f"values: {_largest_difference(track, now)}")


def _largest_difference(track: Track, now: Track) -> str:
    """How far the keys of two tracks are apart, rotations in degrees."""
    text = furthest(track.values, now.values)
    if track.path != "rotation" or not len(track.times):
        return text
    keys = [t.values[:, 1] if t.interpolation == "CUBICSPLINE" else t.values for t in (track, now)]
    if keys[0].shape != keys[1].shape:
        return text
    with np.errstate(invalid="ignore", divide="ignore"):
        degrees = _degrees(unit(keys[0]), unit(keys[1]))
    count = int((keys[0] != keys[1]).any(axis=1).sum())
    return f"{count} of {len(degrees)} keys differ, by up to {float(np.nanmax(degrees)):.3g}°"


def _degrees(one: Floats, other: Floats) -> Floats:
    """Angles between unit quaternions; a quaternion and its negative are one rotation."""
    near = np.minimum(np.sqrt(((one - other) ** 2).sum(axis=1)), np.sqrt(((one + other) ** 2).sum(axis=1)))
    return np.asarray(np.degrees(4.0 * np.arcsin(np.clip(near / 2.0, 0.0, 1.0))))
