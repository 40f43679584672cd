"""Clips whose keys are finite, and make joints larger than any number, or put them beyond all."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.sampling import locals_at, sorted_unique, worlds
from rigtri.maths.arrays import Booleans
from rigtri.model.animation import Clip, Track, key_values
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.operations.take_clips.clip_matching import Taken

# Numbers below are no slip of an exporter; so many joints in a row would have to be as large for more than
# float64 holds that no skeleton has them.
_LARGE = 1e6
_LARGEST = float(np.finfo(np.float32).max)


def refuse_infinite_motion(both: Counterparts, every: Sequence[Taken]) -> None:
    """GeometryError for a clip of EDITED that has no place that is a number for a node that RIG has.

    What was so in RIG may stay so.
    """
    for taken in every:
        found = _infinite(both.other, taken.clip, sorted(both.back))
        if found is None or (taken.home and _infinite(both.rig, taken.home.clip, sorted(both.of))):
            continue
        node, track, key = found
        largest = float(np.abs(key_values(track)[key]).max())
        raise GeometryError(
            f"'{taken.name}' of EDITED gives '{both.other.title(node)}' no finite position and size: "
            f"key {key} of '{both.other.names[track.node]}', at {track.times[key]:.6g}, has a {track.path} "
            f"of {largest:g}. Remove the key, or --clip without '{taken.name}'"
        )


def _infinite(rig: Rig, clip: Clip, nodes: Sequence[int]) -> tuple[int, Track, int] | None:
    """The first of some nodes that is nowhere at a key, the track of the largest number that moves it, and
    the number of the key.
    """
    large = [track for track in clip.tracks if track.path != "weights" and _large(track).any()]
    if not large:
        return None
    times = sorted_unique(np.concatenate([track.times[_large(track)] for track in large]))
    with np.errstate(over="ignore", invalid="ignore"):
        world = worlds(rig, locals_at(rig, clip, times))[:, list(nodes)]
        lost = ~(np.abs(world) <= _LARGEST).all(axis=(2, 3))
    if not lost.any():
        return None
    moment, place = divmod(int(lost.argmax()), len(nodes))
    node, time = nodes[place], times[moment]
    above = rig.path_to_root(node)
    causes = [
        (float(np.abs(key_values(track)[key]).max()), -above.index(track.node), track, int(key))
        for track in large
        if track.node in above
        for key in np.flatnonzero(track.times == time)
    ]
    if not causes:
        return None
    _, _, track, key = max(causes, key=lambda cause: cause[:2])
    return node, track, key


def _large(track: Track) -> Booleans:
    """Which keys of a track have large numbers, (k,)."""
    return np.asarray(~(np.abs(key_values(track)) <= _LARGE).all(axis=1))
