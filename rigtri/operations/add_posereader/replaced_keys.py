"""Keys of morph targets that a pose reader replaces, kept in its metadata, so that strip restores them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.evaluation.sampling import sample
from rigtri.evaluation.timelines import Timeline, put_tracks, timelines
from rigtri.model.animation import Track
from rigtri.model.metadata import PoseReaderRecord
from rigtri.model.rig import Rig
from rigtri.report import Report

# What a record keeps in ``before``: {clip, mesh, morphs, times, values, interpolation} each; no
# times where nothing drove the mesh; unlisted: those of the morphs that the clip had no word for.


def timelines_by_title(rig: Rig) -> dict[str, Timeline]:
    """What can be played, each by its name, or by the number of its clip where several share one."""
    every = timelines(rig)
    names = [timeline.name for timeline in every]
    return {
        timeline.name if names.count(timeline.name) == 1 else f"#{timeline.members[0]}": timeline
        for timeline in every
    }


def add_replaced_keys(
    old: Sequence[Mapping[str, Any]], clip: str, mesh: str, was: Track | None, morphs: Collection[int]
) -> tuple[Mapping[str, Any], ...]:
    """What is kept of all clips, with the columns of a track that are driven from now on.

    old: what an earlier run has kept, which stays. was: the track as it is now; None for none.
    """
    entry = next((e for e in old if (e["clip"], e["mesh"]) == (clip, mesh)), None)
    others = [e for e in old if e is not entry]
    if entry is None:
        entry = {"clip": clip, "mesh": mesh, "morphs": []}
        if was is not None:
            spline = was.interpolation == "CUBICSPLINE"  # of one key, which holds
            entry |= {
                "interpolation": "STEP" if spline else was.interpolation,
                "times": [float(time) for time in was.times],
                "values": [[] for _ in was.times],
            }
    new = [column for column in morphs if column not in entry["morphs"]]
    if not new:
        return tuple(old)
    entry = {**entry, "morphs": [*entry["morphs"], *new]}
    unlisted = [] if was is None else [*entry.get("unlisted", ()), *(k for k in new if k in was.unlisted)]
    if unlisted:
        entry["unlisted"] = unlisted
    if "times" in entry and was is not None:
        rows = sample(was, np.array(entry["times"], dtype=np.float64))[:, new]
        pairs = zip(entry["values"], rows.tolist(), strict=True)
        entry["values"] = [[*values, *row] for values, row in pairs]
    return (*others, entry)


def restore_replaced_keys(
    rig: Rig, nodes: Collection[int], report: Report
) -> tuple[Rig, dict[int, set[int]]]:
    """The rig with the keys back that the pose readers ``nodes`` have replaced, and which those are.

    The last reader first, as each keeps what the one before it has left. Keys of clips and meshes
    that are not there any more are not restored, with a warning (``keys-gone``).
    """
    driven: dict[int, set[int]] = {}
    for node in sorted(nodes, reverse=True):
        for entry in rig.records(PoseReaderRecord)[node].before:
            mesh, timeline = rig.known(entry["mesh"]), timelines_by_title(rig).get(entry["clip"])
            now = None if mesh is None or timeline is None else timeline.track(mesh, "weights")
            if mesh is None or timeline is None or now is None:
                if mesh is None or timeline is None or "times" in entry:
                    _warn_lost_keys(rig.title(node), entry, report, lost=mesh is None)
                continue
            driven.setdefault(mesh, set()).update(entry["morphs"])
            rig = _put_back(rig, timeline, now, entry)
    return rig, driven


def _warn_lost_keys(reader: str, entry: Mapping[str, Any], report: Report, *, lost: bool) -> None:
    what = f"mesh '{entry['mesh']}'" if lost else f"clip '{entry['clip']}'"
    report.warn(
        "keys-gone",
        f"Pose reader '{reader}' keeps keys of morph targets of '{entry['mesh']}' in '{entry['clip']}' from "
        f"before it, but {what} does not have them any more: they do not come back",
    )


def _put_back(rig: Rig, timeline: Timeline, now: Track, entry: Mapping[str, Any]) -> Rig:
    if "times" not in entry:
        clips = [replace(c, tracks=tuple(t for t in c.tracks if t is not now)) for c in rig.clips]
        same = [len(c.tracks) == len(was.tracks) for c, was in zip(clips, rig.clips, strict=True)]
        every = zip(rig.clips, clips, same, strict=True)
        return replace(rig, clips=tuple(was if keeps else clip for was, clip, keeps in every))
    times = np.array(entry["times"], dtype=np.float64)
    values = sample(now, times)
    values[:, list(entry["morphs"])] = np.array(entry["values"]).reshape(len(times), -1)
    unlisted = now.unlisted.union(entry.get("unlisted", ()))
    way = entry["interpolation"]
    before = replace(now, interpolation=way, times=times, values=values, unlisted=unlisted)
    return put_tracks(rig, timeline, [before])
