"""Controls and poles posed without keys, or whose keys an exporter dropped because they are all equal.

Where a clip has keys of a node, a DCC stores as the node's rest what the current frame shows. What no clip
has keys of stands as it stood all the time.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.key_reduction import parent_sizes
from rigtri.evaluation.pose_cache import PoseCache
from rigtri.evaluation.sampling import sample
from rigtri.evaluation.timelines import as_float32, put_tracks, timelines
from rigtri.maths.quaternions import angle_between
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import PATHS, Path, Track
from rigtri.model.metadata import ADDED, PoleVectorRecord
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.restore_rest import POSED, with_rest_of
from rigtri.report import Report
from rigtri.text import list_names

# What went through another program's float32; moves as a share of the size.
_ROUNDED = 1e-5
# A track is looked at so often, and comes past what is so near, as a share of its values.
_LOOKS, _NEAR = 1001, 1e-4


def key_unkeyed_poses(rig: Rig, rested: Rig, described: Rig, of: Mapping[int, int], report: Report) -> Rig:
    """``rested`` with a key in each clip for what no clip moves of controls and poles that stand otherwise in
    ``rig``.

    rested: the same rig with these at rest. described: the rig that a DCC was given; ``of``: the
    nodes of ``rig`` by its. What one of its clips moves past where a node stands is
    left over from a frame of that.
    """
    fresh = unkeyed(rig, {node: node for node in rested.nodes_of(*POSED)}, rested, described, of)
    done = rested
    for timeline in timelines(rested):
        times = [track.times[:1] for track in timeline.clip.tracks if len(track.times)]
        if times:
            start = np.min(times, axis=0)
            tracks = [Track(node, path, "STEP", start, as_float32(value)) for node, path, value in fresh]
            done = put_tracks(done, timeline, tracks)
    if done is not rested:
        posed = list_channels(rested, fresh)
        text = f"No clip has keys of {posed}, whose pose differs from that in the file of --rig"
        names = dict.fromkeys(rested.title(node) for node, *_ in fresh)
        report.warn("held-without-keys", f"{text}: held so in all clips", names=names)
    return done


def warn_unkeyed(rig: Rig, edited: Rig, of: Mapping[int, int], report: Report) -> None:
    """Warn of controls and poles that EDITED poses without keys, so that no clip takes the pose home."""
    posed = {of[node]: node for node in rig.nodes_of(*POSED) if node in of}
    if not (edited.clips and posed):
        return
    # What moves them is theirs as they rest in RIG: other parents, axes and units of a DCC are no pose.
    shared = {node: of[node] for node in rig.nodes_of(*ADDED) if node in of}
    known = {theirs: rig.metadata[node] for node, theirs in shared.items()}
    whole = replace(edited, metadata={**edited.metadata, **known})
    rested = with_rest_of(whole, rig, shared, Report())
    if left := unkeyed(whole, {node: node for node in posed}, rested, rig, shared):
        ours = [(posed[node], path, value) for node, path, value in left]
        text = f"No clip of EDITED has keys of {list_channels(rig, ours)}, whose pose differs from RIG's"
        names = dict.fromkeys(rig.title(node) for node, *_ in ours)
        report.warn(
            "held-without-keys", f"{text}: not taken; key them, or use rigtri bake --rig", names=names
        )


def unkeyed(
    edited: Rig, of: Mapping[int, int], rested: Rig, described: Rig, others: Mapping[int, int]
) -> list[tuple[int, Path, Floats]]:
    """The nodes and channels, with (1, c) values, that stand in ``edited`` otherwise than in ``rested``,
    and that no clip of it has keys of.

    of: the nodes to look at of ``rested``, with those of ``edited``. described, others: see
    `key_unkeyed_poses`.
    """
    keyed = {(track.node, track.path) for clip in edited.clips for track in clip.tracks}
    tracks = [track for clip in described.clips for track in clip.tracks if track.node in others]
    moving = [replace(track, node=others[track.node]) for track in tracks]
    now, rest = PoseCache(edited), PoseCache(rested)
    size = float(np.abs(rested.world[:, 3, :3]).max(initial=0.0)) or 1.0
    units = [unit or 1.0 for unit in parent_sizes(rested).tolist()]
    return [
        (node, path, value)
        for node, there in of.items()
        for path, value in _otherwise(now.part(there), rest.part(node), size / units[node]).items()
        if (there, path) not in keyed
        and (path == "translation" or rested.type_of(node) != PoleVectorRecord.type)  # a pole is a place
        and not any((t.node, t.path) == (there, path) and _passes(t, value) for t in moving)
    ]


def list_channels(rig: Rig, channels: Iterable[tuple[int, Path, Floats]]) -> str:
    """Nodes by name, each with its channels."""
    paths = dict[int, list[str]]()
    for node, path, _ in channels:
        paths.setdefault(node, []).append(path)
    return list_names(f"{rig.title(node)} ({', '.join(each)})" for node, each in paths.items())


def _passes(track: Track, value: Floats) -> bool:
    """Whether a track that moves comes past a value, (1, c), on its way."""
    times = np.union1d(track.times, np.linspace(track.times[0], track.times[-1], _LOOKS))
    way = sample(track, times)
    if np.abs(way - way[0]).max() <= _ROUNDED:
        return False
    if track.path == "rotation":
        way = way * np.where(_dot(way, value) < 0, -1.0, 1.0)[:, np.newaxis]
    step, gone = way[1:] - way[:-1], value - way[:-1]
    whole = _dot(step, step)
    share = np.clip(_dot(gone, step) / np.where(whole > 0, whole, 1.0), 0.0, 1.0)
    off = gone - share[:, np.newaxis] * step
    return bool(np.sqrt(_dot(off, off)).min() <= _NEAR * float(np.abs(way).max()))


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray(sum((a * b).T))


def _otherwise(now: Parts, rest: Parts, size: float) -> dict[Path, Floats]:
    """What of a node is not as at rest. size: that of the rig, in the units of the node's translation."""
    turned = float(angle_between(rest.rotation, now.rotation)[0])
    apart: dict[Path, float] = {
        "translation": float(np.abs(now.translation - rest.translation).max()) / size,
        "rotation": turned,
        "scale": float(np.abs(now.scale - rest.scale).max()),
    }
    return {path: now[PATHS.index(path)] for path, far in apart.items() if far > _ROUNDED}
