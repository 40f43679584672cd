"""Keys of morph targets that a pose reader replaces, kept in its metadata, so that strip restores them."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from rigtri.evaluation.sampling import sample
from rigtri.evaluation.timelines import Timeline, put_tracks, timelines
from rigtri.model.animation import Track
from rigtri.model.metadata import PoseReaderRecord, ReplacedKeysRecord
from rigtri.model.rig import Rig
from rigtri.report import Report


def timelines_by_title(rig: Rig) -> dict[str, Timeline]:
    """What can be played, each by its name, or by the number of its clip where several share one."""
    every = timelines(rig)
    names = [timeline.name for timeline in every]
    return {
        timeline.name if names.count(timeline.name) == 1 else f"#{timeline.members[0]}": timeline
        for timeline in every
    }


def add_replaced_keys(
    old: Sequence[ReplacedKeysRecord], clip: str, mesh: str, was: Track | None, morphs: Collection[int]
) -> tuple[ReplacedKeysRecord, ...]:
    """What is kept of all clips, with the columns of a track that are driven from now on.

    old: what an earlier run has kept, which stays. was: the track as it is now; None for none.
    """
    entry = next((e for e in old if (e.clip, e.mesh) == (clip, mesh)), None)
    others = [e for e in old if e is not entry]
    if entry is None:
        entry = ReplacedKeysRecord(clip=clip, mesh=mesh, morphs=())
        if was is not None:
            entry = replace(
                entry,
                # A spline is of one key, which holds.
                interpolation="LINEAR" if was.interpolation == "LINEAR" else "STEP",
                times=tuple(was.times.tolist()),
                values=((),) * len(was.times),
            )
    new = [column for column in morphs if column not in entry.morphs]
    if not new:
        return tuple(old)
    entry = replace(entry, morphs=(*entry.morphs, *new))
    if was is not None:
        entry = replace(entry, unlisted=(*entry.unlisted, *(k for k in new if k in was.unlisted)))
    if entry.times is not None and entry.values is not None and was is not None:
        rows = sample(was, np.array(entry.times, dtype=np.float64))[:, new]
        pairs = zip(entry.values, rows.tolist(), strict=True)
        entry = replace(entry, values=tuple((*values, *row) for values, row in pairs))
    return (*others, entry)


def restore_replaced_keys(
    rig: Rig, nodes: Collection[int], report: Report
) -> tuple[Rig, dict[int, set[int]]]:
    """The rig with the keys back that the pose readers ``nodes`` have replaced, and which those are.

    The last reader first, as each keeps what the one before it has left. Keys of clips and meshes
    that are not there any more are not restored, with a warning (``keys-gone``).
    """
    driven: dict[int, set[int]] = {}
    records = rig.records(PoseReaderRecord)
    for node in sorted(records.keys() & set(nodes), reverse=True):
        for entry in records[node].before:
            mesh, timeline = rig.known(entry.mesh), timelines_by_title(rig).get(entry.clip)
            now = None if mesh is None or timeline is None else timeline.track(mesh, "weights")
            if mesh is None or timeline is None or now is None or not _fits(entry, now):
                if mesh is None or timeline is None or entry.times is not None:
                    _warn_lost_keys(rig.title(node), entry, report, lost=mesh is None)
                continue
            driven.setdefault(mesh, set()).update(entry.morphs)
            rig = _put_back(rig, timeline, now, entry)
    return rig, driven


def _fits(entry: ReplacedKeysRecord, now: Track) -> bool:
    """Whether the keys have a value for each morph at each time, and the track has these morphs."""
    if entry.times is None:
        return True
    values, times = entry.values or (), np.array(entry.times)
    inside = all(0 <= k < now.values.shape[-1] for k in entry.morphs)
    whole = len(values) == len(times) > 0 and {len(row) for row in values} == {len(entry.morphs)}
    return inside and whole and entry.interpolation is not None and bool((np.diff(times) > 0).all())


def _warn_lost_keys(reader: str, entry: ReplacedKeysRecord, report: Report, *, lost: bool) -> None:
    what = f"mesh '{entry.mesh}'" if lost else f"clip '{entry.clip}'"
    report.warn(
        "keys-gone",
        f"Pose reader '{reader}' keeps keys of morph targets of '{entry.mesh}' in '{entry.clip}' from "
        f"before it, but {what} does not have them any more: they do not come back",
    )


def _put_back(rig: Rig, timeline: Timeline, now: Track, entry: ReplacedKeysRecord) -> Rig:
    if entry.times is None:
        clips = [replace(c, tracks=tuple(t for t in c.tracks if t is not now)) for c in rig.clips]
        same = [len(c.tracks) == len(was.tracks) for c, was in zip(clips, rig.clips, strict=True)]
        every = zip(rig.clips, clips, same, strict=True)
        return replace(rig, clips=tuple(was if keeps else clip for was, clip, keeps in every))
    times = np.array(entry.times, dtype=np.float64)
    values = sample(now, times)
    values[:, list(entry.morphs)] = np.array(entry.values).reshape(len(times), -1)
    unlisted = now.unlisted.union(entry.unlisted)
    way = entry.interpolation or "LINEAR"
    before = replace(now, interpolation=way, times=times, values=values, unlisted=unlisted)
    return put_tracks(rig, timeline, [before])
