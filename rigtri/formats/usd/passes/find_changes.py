"""Find what differs between the rig that was read and the one to write: rest poses, and keys of whom.

Only what changed is written: rows of matrices, columns of animation arrays. Everything else keeps its bits.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rigtri.formats.usd.passes.usd_edit import Changes, UsdEdit, is_rigtri_prim, sets_transform
from rigtri.formats.usd.reading.node_keys import kind
from rigtri.maths.arrays import Booleans
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig

# The track of a mesh's morph weights before and after an edit; None for none.
Weights = tuple[Track | None, Track | None]


def find_changes(edit: UsdEdit) -> None:
    """Set the changes of an edit. ValueError for a rig whose first nodes are not those of the source."""
    before, rig = edit.source.rig, edit.rig
    if before.keys != rig.keys[: len(before)]:
        raise ValueError("nodes of a file keep their order, and new ones come last")
    moved = np.asarray((before.local != rig.local[: len(before)]).any(axis=(1, 2)))
    keyed = _keyed_prims(before, rig, moved)
    clips, tracks, weights = _divided(before, rig, lambda n: n in keyed or _is_rigtri_prim(before, n))
    rekeyed = {track.node for track in tracks if track.node not in keyed} | _unkeyed(before, rig)
    moved[list(keyed)] = False  # their new keys place them
    edit.changes = Changes(moved, clips, [t for t in tracks if t.node in keyed], rekeyed, weights)


def _is_rigtri_prim(before: Rig, node: int) -> bool:
    """Whether a node is a prim of rigtri, new or known; a joint with metadata is none."""
    return node >= len(before) or (kind(before.keys[node]) == "prim" and is_rigtri_prim(before, node))


def _unkeyed(before: Rig, rig: Rig) -> set[int]:
    """Prims of rigtri that a track moved, and none does any more."""
    was, now = (
        {(t.node, t.path) for clip in each.clips for t in clip.tracks if t.path != "weights"}
        for each in (before, rig)
    )
    return {node for node, _ in was - now if _is_rigtri_prim(before, node)}


def _keyed_prims(before: Rig, rig: Rig, moved: Booleans) -> set[int]:
    """Prims of others with new keys. Those that are reoriented keep theirs: ops of rigtri reorient them."""
    found = set()
    every = {(track.node, track.path): track for old in before.clips for track in old.tracks}
    for track in (t for clip in rig.clips for t in clip.tracks if t.path != "weights"):
        node, was = track.node, every.get((track.node, track.path))
        if was is track or node >= len(before) or kind(before.keys[node]) != "prim":
            continue
        if was is not None and np.array_equal(was.times, track.times):
            above = int(before.parents[node])
            reoriented = moved[node] or (above >= 0 and moved[above])
            if was.interpolation == track.interpolation and (
                reoriented or np.array_equal(was.values, track.values)
            ):
                continue
        if not sets_transform(before, rig, node):
            found.add(node)
    return found


def _is_same(was: Track | None, now: Track) -> bool:
    """Whether two tracks are equal, though passes before have read the stage again and made new ones."""
    return (
        was is not None
        and (was.interpolation, was.unlisted) == (now.interpolation, now.unlisted)
        and np.array_equal(was.times, now.times)
        and np.array_equal(was.values, now.values)
    )


def _divided(
    before: Rig, rig: Rig, prim: Callable[[int], bool]
) -> tuple[tuple[Clip, ...], list[Track], list[Weights]]:
    """The clips without new keys of prims; their tracks; morph weights, what they were and are.

    prim: whether a node is one whose keys may be new, and no joint.
    """
    clips: list[Clip] = []
    prims: list[Track] = []
    weights: list[Weights] = []
    every = {(track.node, track.path): track for old in before.clips for track in old.tracks}
    for old, new in zip(before.clips, rig.clips, strict=False):
        if new is old:
            clips.append(new)
            continue
        known = {(track.node, track.path): track for track in old.tracks}
        kept: list[Track] = []
        for now in new.tracks:
            was = known.get((now.node, now.path))
            weighs = now.path == "weights"
            if now is was or not (weighs or prim(now.node)) or _is_same(was, now):
                kept.append(now)
                continue
            if weighs:
                weights.append((every.get((now.node, now.path)), now))
            else:
                prims.append(now)
            kept += [was] if was is not None else []
        driven = {(track.node, track.path) for track in new.tracks}
        lost = [
            t for t in old.tracks if (t.node, t.path) not in driven and (t.path == "weights" or prim(t.node))
        ]
        weights += [(track, None) for track in lost if track.path == "weights"]
        kept += lost
        clips.append(replace(new, tracks=tuple(kept)))
    return (*clips, *rig.clips[len(before.clips) :]), prims, weights
