"""Key times that an edit makes and glTF cannot have."""

from __future__ import annotations

import numpy as np

from rigtri.errors import GeometryError
from rigtri.formats.gltf.float32_rounding import Singles
from rigtri.model.animation import Track, Tracks
from rigtri.model.rig import Rig


def refuse_early(before: Rig, after: Rig) -> None:
    """GeometryError for a key before 0 that an edit makes, which glTF does not have; old ones stay."""
    olds = {clip.key: clip.columns for clip in before.clips}
    early: list[tuple[str, Track]] = []
    for k, clip in enumerate(after.clips):
        old = [column for column in olds.get(clip.key, ()) if len(column.times)]
        times = {id(column.times) for column in old}
        first = min((float(column.times[0]) for column in old), default=0.0)
        made = (c for c in clip.columns if id(c.times) not in times and len(c.times))
        sooner = Tracks(c for c in made if c.times[0] < min(first, 0.0))
        early += [(clip.name or f"#{k}", track) for track in sooner]
    # The tracks of all clips are looked at once, and only where one of them can be at fault.
    known = {id(track) for clip in before.clips for track in clip.tracks} if early else ()
    for name, track in early:
        if id(track) not in known:
            raise GeometryError(
                f"'{after.title(track.node)}' would get a key at {track.times[0]:g} s in clip "
                f"'{name}', and glTF has no time before 0. Choose a later time, or move the keys of the clip"
            )


def refuse_ties(track: Track, stored: Singles, name: str) -> None:
    """GeometryError where keys are not in order as they are stored: in glTF each is later than the last.

    stored: their times, (k,). name: of the node.
    """
    if len(found := np.flatnonzero(stored[1:] <= stored[:-1])):
        k = int(found[0])
        why = "the same 32-bit number" if stored[k] == stored[k + 1] else "not in order"
        raise GeometryError(
            f"'{name}' would get keys of its {track.path} at {track.times[k]:.12g} s and "
            f"{track.times[k + 1]:.12g} s, which are {why}; in glTF each key is later than the one before. "
            "Leave one out, or move it"
        )
