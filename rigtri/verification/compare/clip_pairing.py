"""What two files show while a clip plays, where only one of them has the clip, or plays it.

Players choose among the clips of a glTF: one more changes nothing that was there. An animation of a
USD stage is the pose of what it is bound to at all times, so a new one stands in for what was seen.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import replace

import numpy as np

from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.verification.compare.correspondence import Correspondence, timeline


def side_by_side(before: Rig, after: Rig, m: Correspondence, *, added: bool = False) -> tuple[Rig, Rig]:
    """Both rigs with the same clips in the same order: what each shows while one of them plays.

    A clip that is idle on one side only is rest there; idle on both sides it is taken for played,
    so that it fits when it will be. added: with what only ``after`` has and plays by itself.
    """
    mine: list[Clip] = []
    theirs: list[Clip] = []
    for k, partner in enumerate(m.clip.tolist()):
        if partner >= 0:
            one, other = before.clips[k], after.clips[partner]
            if one.idle != other.idle:
                one, other = one.played, other.played
            mine.append(replace(one, name=one.name or f"#{k}"))
            theirs.append(other)
    known = set(m.clip.tolist())
    for k, clip in enumerate(after.clips if added else ()):
        if k in known or timeline(clip) is None or not clip.played.tracks:
            continue
        shown = _instead(before, clip)
        if shown is not None:
            mine.append(replace(shown, name=clip.name or f"#{k}"))
            theirs.append(clip.played)
    return replace(before, clips=tuple(mine)), replace(after, clips=tuple(theirs))


def joined(before: Rig, after: Rig) -> Rig:
    """All nodes of both as one rig, those of ``after`` behind, and their clips as one each: to be posed."""
    count = len(before)
    return Rig(
        names=before.names + after.names,
        parents=np.concatenate([before.parents, np.where(after.parents < 0, -1, after.parents + count)]),
        translation=np.concatenate([before.translation, after.translation]),
        rotation=np.concatenate([before.rotation, after.rotation]),
        scale=np.concatenate([before.scale, after.scale]),
        matrix=np.concatenate([before.matrix, after.matrix]),
        has_matrix=np.concatenate([before.has_matrix, after.has_matrix]),
        attachment=np.full(count + len(after), -1),
        keys=before.keys + after.keys,
        labels=before.labels + after.labels,
        clips=tuple(
            Clip(one.name, one.tracks + tuple(_behind(track, count) for track in other.tracks))
            for one, other in zip(before.clips, after.clips, strict=True)
        ),
    )


def _behind(track: Track, count: int) -> Track:
    return Track(count + track.node, track.path, track.interpolation, track.times, track.values)


def _instead(rig: Rig, clip: Clip) -> Clip | None:
    """What a rig shows where another plays a clip that this one has not; None if that is never seen.

    Keys without a time are seen where there are none with one: then, and only then.
    """
    of_same = {timeline(c): c.played for c in rig.clips if _animation(c) == _animation(clip)}
    if timeline(clip) == "default" and "samples" in of_same:
        return None
    return of_same.get("default", Clip(clip.name, ()))


def _animation(clip: Clip) -> Hashable:
    """What the clips of one animation have in common."""
    return clip.key[1:] if isinstance(clip.key, tuple) else None
