"""Expected changes of morph weights: excluded from a comparison, and measured by themselves.

With the expected changes taken out of both rigs, everything else must be the same; how far they
move the vertices is reported beside it.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from rigtri.evaluation import sampling, skinning
from rigtri.evaluation.timelines import Timeline, keys_and_between, timelines
from rigtri.frames.rig_size import placing_node, sizes_of
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Clip, Track
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.verification.compare.compare import DocumentView, MorphChanges, Source

# Poses of a timeline in which changed vertices are measured: those with the largest weights.
_POSES = 64


def without_changes(before: Source, after: Source, changes: MorphChanges) -> tuple[Source, Source]:
    """Both documents with all morph weights at common times and those of ``changes`` 0."""
    if not changes:
        return before, after
    resting = {mesh.node: mesh.morph_weights for mesh in before.outlines()}
    place = {key: node for node, key in enumerate(after.rig.keys) if key is not None}
    mine, theirs = list(before.rig.clips), list(after.rig.clips)
    for k, clip in enumerate(mine):
        partner = next((j for j, c in enumerate(theirs) if c.key == clip.key and c.name == clip.name), -1)
        if partner < 0:
            continue
        was, now = _weights(clip), _weights(theirs[partner])
        for node, key in enumerate(before.rig.keys):
            there = place.get(key, -1)
            tracks = was.get(node), now.get(there)
            if tracks == (None, None) or there < 0:
                continue
            pair = _resampled(tracks, node, there, changes.get(key, ()), resting.get(node))
            mine[k] = _with(mine[k], tracks[0], pair[0])
            theirs[partner] = _with(theirs[partner], tracks[1], pair[1])
    return (
        DocumentView(before, replace(before.rig, clips=tuple(mine))),
        DocumentView(after, replace(after.rig, clips=tuple(theirs))),
    )


def _weights(clip: Clip) -> dict[int, Track]:
    return {track.node: track for track in clip.tracks if track.path == "weights"}


def _with(clip: Clip, old: Track | None, new: Track) -> Clip:
    kept = tuple(track for track in clip.tracks if track is not old)
    return replace(clip, tracks=(*kept, new))


def _resampled(
    tracks: tuple[Track | None, Track | None],
    node: int,
    there: int,
    columns: Collection[int],
    resting: Floats | None,
) -> tuple[Track, Track]:
    """Both tracks sampled at one set of times, with ``columns`` at 0."""
    known = [track for track in tracks if track is not None]
    keys = np.unique(np.concatenate([track.times for track in known]))
    times = keys_and_between(keys)
    width = known[0].values.shape[-1]
    still = np.zeros(width) if resting is None or len(resting) != width else resting
    found = []
    for track, where in zip(tracks, (node, there), strict=True):
        values = np.tile(still, (len(times), 1)) if track is None else sampling.sample(track, times)
        values[:, list(columns)] = 0.0
        found.append(Track(where, "weights", "LINEAR" if len(times) > 1 else "STEP", times, values))
    return found[0], found[1]


def morph_movement(before: Source, after: Source, changes: MorphChanges) -> dict[str, float]:
    """How far ``changes`` move vertices of each mesh in any pose, as a share of its character, by mesh."""
    rig, others = after.rig, {mesh.name: mesh for mesh in after.meshes()}
    sizes = sizes_of(rig, list(after.meshes()))
    old = {before.rig.clips[k].key: t for t in timelines(before.rig) for k in t.members}
    found: dict[str, float] = {}
    for mesh in before.meshes():
        if before.rig.keys[mesh.node] not in changes or mesh.name not in others or not len(mesh.morphs):
            continue
        far = max(
            (
                _farthest(old.get(rig.clips[now.members[0]].key), rig, now, mesh, others[mesh.name])
                for now in timelines(rig)
            ),
            default=0.0,
        )
        found[mesh.name] = far / float(sizes[placing_node(rig, others[mesh.name])])
    return found


def _at(then: Timeline, mesh: Mesh, other: Mesh) -> Clip:
    """The old clip with its weights at the node that shows the mesh now."""
    moved = (replace(t, node=other.node) for t in then.clip.tracks if t.node == mesh.node)
    return replace(then.clip, tracks=tuple(t for t in moved if t.path == "weights"))


def _farthest(then: Timeline | None, after: Rig, now: Timeline, mesh: Mesh, other: Mesh) -> float:
    """The largest distance between the vertices with the old and with the new weights."""
    tracks = now.track(other.node, "weights"), None if then is None else then.track(mesh.node, "weights")
    keys = [track.times for track in tracks if track is not None]
    if not keys:
        return 0.0
    times = np.unique(np.concatenate(keys))
    old = sampling.morph_weights(mesh, None if then is None else then.clip, times)
    apart = np.abs(sampling.morph_weights(other, now.clip, times) - old).max(axis=1)
    best = np.sort(np.argsort(-apart, kind="stable")[:_POSES])
    times = times[best]
    world = sampling.worlds(after, sampling.locals_at(after, now.clip, times))
    farthest = 0.0
    for k, time in enumerate(times):
        here = np.array([time])
        rows = [
            skinning.deformed(m, rig, world[k : k + 1], sampling.morph_weights(m, t, here))
            for m, rig, t in (
                (replace(mesh, node=other.node), after, None if then is None else _at(then, mesh, other)),
                (other, after, now.clip),
            )
        ]
        with np.errstate(invalid="ignore"):
            farthest = max(farthest, float(np.nan_to_num(length(rows[1] - rows[0])).max(initial=0.0)))
    return farthest
