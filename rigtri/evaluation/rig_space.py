"""Evaluate a rig in its own space, where what it stands in is scaled unevenly.

Below a node with a scale that is not uniform limbs are sheared as they turn: in the world no bone keeps its
length, and no rotation gives a pose back. Seen from that node they are rigid. All that is baked is seen from
its parent, so nothing changes where such a node stands still at the origin while a rig below it is evaluated.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace

import numpy as np

from rigtri.evaluation.constraint_solver import to_parts
from rigtri.maths.matrices import skew
from rigtri.maths.quaternions import IDENTITY
from rigtri.maths.ranking import first_largest
from rigtri.maths.vectors import dot, length
from rigtri.model.animation import Clip, key_values
from rigtri.model.rig import Rig

# What places a node.
_PLACE = ("translation", "rotation", "scale", "has_matrix")
# A scale is uniform where its factors differ by no more of the largest.
_UNIFORM = 1e-5


def uneven_above(rig: Rig) -> list[int]:
    """The nodes above skeletons with a scale that is not uniform, or a shear, at rest or in a clip."""
    above = rig.with_ancestors(np.flatnonzero(rig.is_joint).tolist())
    nodes = sorted(node for node in above if not rig.is_joint[node] and node not in rig.own)
    x, y, z = (rig.local[nodes, axis, :3] for axis in range(3))
    squares = np.stack([dot(x, x), dot(y, y), dot(z, z)])
    sizes = (squares[0] + squares[1] + squares[2]) / 3.0
    off = np.abs(np.stack([*(squares - sizes), dot(x, y), dot(y, z), dot(z, x)])).max(axis=0)
    found = {node for node, odd in zip(nodes, off > 2.0 * _UNIFORM * sizes, strict=True) if odd}
    moving = [clip for clip in rig.clips if not clip.nodes.isdisjoint(nodes)]
    for track in (t for clip in moving for t in clip.tracks if t.path == "scale" and t.node in nodes):
        scales = np.abs(key_values(track))
        if (np.ptp(scales, axis=1) > _UNIFORM * scales.max(axis=1)).any():
            found.add(track.node)
    return sorted(found)


def shearing_node(rig: Rig, node: int) -> int:
    """The node above another whose local matrix is the least uniform at rest: what shears it as it turns."""
    path = rig.path_to_root(node)[:0:-1] or [node]
    sizes = length(rig.local[path, :3, :3])
    with np.errstate(divide="ignore", invalid="ignore"):
        uneven = sizes.max(axis=1) / sizes.min(axis=1) - 1.0
    return path[first_largest(np.maximum(uneven, skew(rig.local[path])))]


def seen_alone(rig: Rig, *, building: bool = False) -> tuple[Rig, list[int]]:
    """The rig whose uneven nodes, with all of the rig below them, stand still at the origin; and these nodes.

    building: new nodes are below them, too, and they keep their rotations, so that up and ahead stay.
    """
    nodes = [node for node in uneven_above(rig) if _holds_all(rig, node)]
    if building and not rig.nodes_of("group"):
        nodes = [node for node in nodes if node in rig.path_to_root(rig.rules.group_parent)]
    if not nodes:
        return rig, nodes
    translation, rotation, scale = rig.translation.copy(), rig.rotation.copy(), rig.scale.copy()
    has_matrix = rig.has_matrix.copy()
    translation[nodes], scale[nodes], has_matrix[nodes] = 0.0, 1.0, False
    rotation[nodes] = to_parts(rig.local[nodes]).rotation if building else IDENTITY
    clips = tuple(_without(clip, nodes) for clip in rig.clips)
    seen = replace(
        rig, translation=translation, rotation=rotation, scale=scale, has_matrix=has_matrix, clips=clips
    )
    return seen, nodes


def in_rig_space(rig: Rig, evaluate: Callable[[Rig], Rig], *, building: bool = False) -> Rig:
    """What ``evaluate`` makes of a rig that is `seen_alone`, with what holds that where it stood.

    It may change clips and nodes, and add nodes.
    """
    seen, nodes = seen_alone(rig, building=building)
    made = evaluate(seen)
    if made is seen or not nodes:
        return rig if made is seen else made
    values = {name: getattr(made, name).copy() for name in _PLACE}
    for name, value in values.items():
        value[nodes] = getattr(rig, name)[nodes]
    whole = list(made.clips)
    for k, (was, own) in enumerate(zip(seen.clips, rig.clips, strict=True)):
        kept = [track for track in own.tracks if track.node in nodes]
        whole[k] = own if whole[k] is was else replace(whole[k], tracks=(*kept, *whole[k].tracks))
    return replace(made, **values, clips=tuple(whole))


def _holds_all(rig: Rig, node: int) -> bool:
    """Whether nothing of rigtri's beside a node is about anything below it, nor the other way round."""
    below = set(rig.below(node))
    for own in rig.own & rig.metadata.keys():
        about = rig.named_by(rig.metadata[own]) | {own}
        if about & below and about - below:
            return False
    return True


def _without(clip: Clip, nodes: Collection[int]) -> Clip:
    """A clip without what moves some nodes."""
    kept = tuple(track for track in clip.tracks if track.node not in nodes)
    return clip if len(kept) == len(clip.tracks) else replace(clip, tracks=kept)
