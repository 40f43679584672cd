"""Which nodes of a rig can stand elsewhere in another, and the part of a rig that places them.

Comparing costs in proportion to what changed: what is the same to the bit is not evaluated.
"""

from __future__ import annotations

import numpy as np

from rigtri.maths.arrays import Booleans, Integers
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.verification.compare.correspondence import Correspondence, by_target, partner_track, same_array


def changed_nodes(before: Rig, after: Rig, m: Correspondence) -> Booleans:
    """Which nodes may stand elsewhere, (n,): anything of them or above them differs by a bit."""
    partner = np.maximum(m.node, 0)
    if not len(after):
        return np.ones(len(before), dtype=bool)
    differs = m.node < 0
    for mine, theirs in (
        (before.translation, after.translation),
        (before.rotation, after.rotation),
        (before.scale, after.scale),
        (before.matrix.reshape(-1, 16), after.matrix.reshape(-1, 16)),
        (before.has_matrix[:, np.newaxis], after.has_matrix[:, np.newaxis]),
    ):
        differs = differs | (mine != theirs[partner]).any(axis=1)
    above = np.where(before.parents >= 0, m.node[before.parents], -1)
    differs |= above != after.parents[partner]
    parents = before.parents.tolist()
    found = _with_below(differs.tolist(), parents)
    for k in np.flatnonzero(m.clip >= 0).tolist():
        _mark_tracks(before.clips[k], after.clips[m.clip[k]], m, found)
    return np.array(_with_below(found, parents), dtype=bool)


def _with_below(marked: list[bool], parents: list[int]) -> list[bool]:
    """Nodes that are marked, and all below them."""
    found: list[bool] = []
    for mark, parent in zip(marked, parents, strict=True):
        found.append(mark or (parent >= 0 and found[parent]))
    return found


def _mark_tracks(mine: Clip, theirs: Clip, m: Correspondence, differs: list[bool]) -> None:
    """Mark the nodes whose tracks are others; of those that are marked nothing is compared."""
    others = by_target(theirs)
    partners = m.node.tolist()
    back = {partner: node for node, partner in enumerate(partners)}
    ours = {(partners[track.node], track.path) for track in mine.tracks}
    for track in mine.tracks:
        if track.path == "weights" or differs[track.node]:
            continue
        now = partner_track(track, others, m)
        if now is None or not _same_track(track, now):
            differs[track.node] = True
    for node, path in others.keys() - ours:
        if path != "weights" and node in back:
            differs[back[node]] = True


def _same_track(a: Track, b: Track) -> bool:
    return a is b or (
        a.interpolation == b.interpolation and same_array(a.times, b.times) and same_array(a.values, b.values)
    )


def part_of(rig: Rig, nodes: Integers) -> tuple[Rig, Integers]:
    """A part of a rig that places ``nodes``, and where each node went, (n,)."""
    keep = np.zeros(len(rig), dtype=bool)
    keep[nodes] = True
    for node in range(len(rig) - 1, -1, -1):
        if keep[node] and rig.parents[node] >= 0:
            keep[rig.parents[node]] = True
    if 5 * int(keep.sum()) >= 4 * len(rig):  # to pose the rest costs less than to leave it out
        return rig, np.arange(len(rig))
    place = np.where(keep, np.cumsum(keep) - 1, -1)
    return rig.part(np.flatnonzero(keep).tolist())[0], place
