"""Constraints of another file's rig as they mean the same in the axes that exporters give this."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError
from rigtri.frames.rescale import SAME_SIZE, metadata_in_world
from rigtri.maths.matrices import decompose, inverse, multiply, nearest_rotation
from rigtri.maths.quaternions import IDENTITY, from_axes
from rigtri.maths.similarity_fit import nearest_axis_turn
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.metadata import ConstraintRecord, GroupRecord, references
from rigtri.model.rig import Rig
from rigtri.operations.rigtri_nodes import add
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.report import Report
from rigtri.text import list_names


def with_group(rig: Rig, described: Rig, both: Counterparts) -> tuple[Rig, dict[int, int]]:
    """The rig with the group of the other file where constraints follow it as the world; and all pairs.

    Exporters leave out what holds nothing visible.
    """
    (group, *_) = described.nodes_of("group") or [-1]
    if group < 0 or group in both.of or group not in _needed(described, both.of):
        return rig, both.of
    rig, node = add(rig, described.names[group], rig.rules.group_parent, GroupRecord())
    place, parent = multiply(described.world[group], inverse(both.space)), int(rig.parents[node])
    place = multiply(place, inverse(rig.world[parent])) if parent >= 0 else place
    translation, rotation, scale = rig.translation.copy(), rig.rotation.copy(), rig.scale.copy()
    translation[node], rotation[node], scale[node] = decompose(place)
    return replace(rig, translation=translation, rotation=rotation, scale=scale), {**both.of, group: node}


def in_world(both: Counterparts) -> Rig:
    """The first rig with what its constraints and pose readers count in the world and in objects, as the
    other has these: exporters turn objects in their own axes where up is another there, but not bones, and
    controls that were bones have the size of their armature.
    """
    rig = both.rig
    turns = np.tile(IDENTITY, (len(rig), 1))
    objects = [node for node in both.turns if node not in rig.own and not rig.is_joint[node]]
    found_turns = nearest_rotation(np.reshape([both.turns[node] for node in objects], (-1, 4, 4)))
    found_turns = np.where(np.isfinite(found_turns).all(axis=(1, 2), keepdims=True), found_turns, np.eye(3))
    # What somebody has turned by hand is no such turn.
    common = nearest_axis_turn(found_turns)
    for node, found in zip(objects, found_turns, strict=True):
        if np.abs(found - common).max() < np.abs(found - np.eye(3)).max():
            turns[node] = from_axes(common.T)
    _, rotation, scale = decompose(inverse(both.space))
    sizes = _sizes(both, float(scale[0]))
    if (turns == IDENTITY).all() and (both.space == np.eye(4)).all() and (sizes == 1.0).all():
        return rig
    return replace(rig, metadata=metadata_in_world(rig, rotation, float(scale[0]), turns, sizes))


def _sizes(both: Counterparts, world: float) -> Floats:
    """How large the first rig's nodes are in the other, whose world is ``world`` times as large, (n,).

    Of what rigtri has added, the size of most controls there below the same root, or 1, whichever is
    nearer: controls may rest as a frame shows them.
    """
    rig, other = both.rig, both.other
    sizes = np.ones(len(rig))
    shares: dict[int, list[float]] = {}
    own, theirs = (length(each.world[:, 0, :3]) for each in (rig, other))
    found = {
        node: float(theirs[of] / (own[node] * world))
        for node, of in both.of.items()
        if node in rig.own and 0.0 < own[node] < np.inf and 0.0 < theirs[of] < np.inf
    }
    homes = {node: other.path_to_root(both.of[node])[-1] for node in found}
    for node in rig.nodes_of("control"):
        if node in found:
            shares.setdefault(homes[node], []).append(found[node])
    for node, share in found.items():
        same = sorted(shares.get(homes[node], [1.0]))
        usual = same[len(same) // 2]
        if abs(usual - 1.0) > SAME_SIZE and max(share / usual, usual / share) < max(share, 1.0 / share):
            sizes[node] = usual
    return sizes


def check_constraints(rig: Rig, described: Rig, of: Mapping[int, int], report: Report) -> None:
    """GeometryError where constraints of both files need a node that this one has not.

    A warning where such a node is an object that moves there in clips, and stands still here.
    """
    needed = sorted(_needed(described, of))
    if lost := [node for node in needed if node not in of]:
        called = list_names(described.names[node] for node in lost)
        raise GeometryError(
            f"Constraints of the file of --rig follow {called}, which this file does not have: they would be "
            "left out. Export these nodes too, or: rigtri take-clips RIG --from IN"
        )
    moving, still = ({t.node for clip in each.clips for t in clip.tracks} for each in (described, rig))
    lost = [
        node
        for node in needed
        if node in moving.difference(described.own) and not described.is_joint[node] and of[node] not in still
    ]
    if lost and rig.clips:
        names = [described.names[node] for node in lost]
        report.warn(
            "keys-lost",
            f"Constraints follow {list_names(names)}, which the file of --rig has keys of, and this file has "
            "none. To keep them: rigtri take-clips RIG --from IN",
            geometry=True,
            names=names,
        )


def _needed(described: Rig, of: Mapping[int, int]) -> set[int]:
    """What constraints that both files have, with their children, name besides: drivers, weights, joints."""
    named = {
        described.known(name)
        for node, record in described.records(ConstraintRecord).items()
        if node in of and described.known(record.child) in of
        for name in references(record.to_dict())
    }
    return {node for node in named if node is not None}
