"""Expected changes of morph weights: excluded from a comparison.

With the expected changes taken out of both rigs, everything else must be the same; how far they
move the vertices is measured beside it (`motion`).
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from rigtri.evaluation import sampling
from rigtri.evaluation.timelines import keys_and_between
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.verification.compare.compare import DocumentView, MorphChanges, Source


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
