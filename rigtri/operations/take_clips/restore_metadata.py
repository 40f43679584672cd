"""rigtri's metadata restored from another file, because exporters drop it.

They also store as rest what the current frame shows. So where controls, offsets and poles stand while
nobody has moved them is read from the other file, too; only the motion is this file's.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.timelines import timelines
from rigtri.maths.matrices import decompose, inverse, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.metadata import ADDED, ControlRecord
from rigtri.model.rig import Rig
from rigtri.operations.operation import operation
from rigtri.operations.take_clips.bind_space import bind_poses
from rigtri.operations.take_clips.ik_switches import (
    drop_switched_off_ik_keys,
    hold_switched_on_ik,
    ik_ends,
    switches,
)
from rigtri.operations.take_clips.messages import list_names
from rigtri.operations.take_clips.node_matching import Pairs, pairs
from rigtri.operations.take_clips.unkeyed_poses import key_unkeyed_poses
from rigtri.recognition.one_character import titles
from rigtri.report import Report

# Matrices that differ by less, moves as a share of the largest, went through another program's float32.
_SAME = 1e-4
# Where nothing stands otherwise than there but for rounding, there is nothing to report.
_SAME_PLACE = 1e-5


@operation(None)
def as_described(rig: Rig, described: Rig, *, report: Report) -> Rig:
    """The rig with the metadata of ``described`` on nodes of the same names, at rest where they are there.

    A warning names nodes that are not there, and joints that are bound otherwise, whose controls keep
    their own rest. GeometryError where no node is there, or no control finds its joint.
    """
    stored = {node: described.metadata[node] for node in described.nodes_of(*ADDED)}
    if not stored:
        raise GeometryError("The file of --rig has nothing of rigtri's: no controls, poles or constraints")
    both = pairs(described, rig)
    found = {both.of[node]: own for node, own in stored.items() if node in both.of}
    # A group only holds the others; as a Scope without metadata it is no node.
    others = [node for node in stored if described.type_of(node) != "group"]
    missing = [node for node in others if node not in both.of]
    if missing == others:
        many = [described.names[node] for node in missing if described.names[node] in both.unclear]
        lost = list_names(described.names[node] for node in missing)
        several = titles(rig)
        remedy = (
            f"bake one character at a time, with --character: {list_names(several)}"
            if len(several) > 1
            else "give each node a name of its own"
        )
        raise GeometryError(
            f"Several nodes match {list_names(many)} of the file of --rig; {remedy}"
            if many
            else f"Nothing that rigtri built in the file of --rig is in this file, none of {lost}, and "
            "--rig only restores what is stored on nodes that are here: add them with rigtri add-controls, "
            "or take the motion of this file to that rig with: rigtri take-clips RIG --from IN"
        )
    if missing:
        _refuse_lost_keys(rig, both, found, [described.names[node] for node in missing])
        names = [described.names[node] for node in missing]
        report.warn(
            "not-in-this-file",
            f"This file does not have {list_names(names)} of the file of --rig",
            names=names,
        )
    _warn_other_metadata(rig, found, report)
    whole = replace(rig, metadata={**rig.metadata, **found})
    _refuse_strange_joints(whole, found, described, report)
    bound = _bound_otherwise(rig, described, both.of)
    if bound:
        report.warn(
            "other-bind-poses",
            f"Joints have another bind pose than in the file of --rig ({list_names(bound)}): "
            "another character, "
            "or axes that a DCC has changed. Controls keep the rest of this file, which may be what a frame "
            "of a clip shows. For a file that a DCC has exported: rigtri take-clips RIG --from IN",
            geometry=True,
            names=bound,
        )
        return whole
    switched = switches(whole, {node: node for node in ik_ends(whole)})
    rested = _rested(whole, described, {node: both.of[node] for node in stored if node in both.of}, report)
    whole = key_unkeyed_poses(whole, rested, described, both.of, report)
    whole = drop_switched_off_ik_keys(whole, switched, timelines(whole), report)
    return hold_switched_on_ik(whole, switched, timelines(whole))


def _refuse_lost_keys(rig: Rig, both: Pairs, ours: Collection[int], missing: list[str]) -> None:
    """GeometryError where nodes among controls have keys and could be some that are missing."""
    keyed = {track.node for clip in rig.clips for track in clip.tracks}.difference(both.of.values())
    strange = [node for node in sorted(keyed) if int(rig.parents[node]) in ours and not rig.is_joint[node]]
    if strange:
        raise GeometryError(
            f"{list_names(rig.names[node] for node in strange)} of this file have keys, and are none of the "
            f"file of --rig, of which {list_names(missing)} are not here: keys would be lost. Give them the "
            "names that they have there"
        )


def _warn_other_metadata(rig: Rig, found: Mapping[int, Mapping[str, Any]], report: Report) -> None:
    """A warning where the file has other metadata of its own."""
    names = [rig.title(node) for node, own in found.items() if rig.metadata.get(node, own) != own]
    if names:
        text = f"The metadata of {list_names(names)} in this file is replaced by that of the file of --rig"
        report.warn("described-anew", text, names=names)


def _refuse_strange_joints(rig: Rig, nodes: Collection[int], described: Rig, report: Report) -> None:
    """Warn of controls whose joint is none of this file; GeometryError where all are such."""
    joints = [record.joint for node, record in rig.records(ControlRecord).items() if node in nodes]
    lost = [name for name in dict.fromkeys(joints) if rig.known(name) is None]
    if not lost:
        return
    name = lost[0]
    joint = described.known(name)
    called = name if joint is None else described.names[joint]
    there, here = described.names.count(called), rig.names.count(called)
    reason = "this file has no such joint"
    remedy = "Name a file that has this character alone, or at the same paths"
    if not called:
        reason = f"{there} nodes of that file have no names, and --rig finds joints by these"
        remedy = (
            "take-clips finds them by their places: rigtri take-clips RIG --from EDITED -o OUT. Or give them "
            "names before the rig is built, with rigtri rename-joints"
        )
    elif there > 1:
        reason = f"{there} nodes of that file are called '{called}', so it means each by its path"
    elif here > 1:
        reason = f"{here} nodes of this file are called '{called}', so the name is ambiguous"
    more = f" and {len(lost) - 1} more" if len(lost) > 1 else ""
    text = f"'{name}'{more}, which controls of the file of --rig move, is not found in this file: {reason}"
    if len(lost) == len(set(joints)):
        raise GeometryError(f"{text}. {remedy}")
    report.warn("not-in-this-file", text, names=lost)


def _bound_otherwise(rig: Rig, described: Rig, of: Mapping[int, int]) -> list[str]:
    """The names of joints of both that are bound otherwise, seen from the joint above them."""
    ours, theirs = bind_poses(rig), bind_poses(described)
    both = {node for node in theirs if of.get(node) in ours}
    seen = [node for node in both if int(described.parents[node]) in both]
    size = max((float(length(theirs[node][3, :3])) for node in both), default=1.0) or 1.0
    names = []
    for node in sorted(seen):
        above = int(described.parents[node])
        own = of[node]
        there = multiply(theirs[node], inverse(theirs[above]))
        here = multiply(ours[own], inverse(ours[of[above]]))
        turned = np.abs(here[:3, :3] - there[:3, :3]).max() > _SAME * max(1.0, np.abs(there[:3, :3]).max())
        # Below an armature of 0.01, as files that were FBX have it, places are in hundredths.
        unit = float(length(theirs[above][:3, :3]).max())
        if turned or np.abs(here[3, :3] - there[3, :3]).max() * unit > _SAME * size:
            names.append(rig.title(own))
    return names


def _rested(rig: Rig, described: Rig, of: Mapping[int, int], report: Report) -> Rig:
    """The rig with its nodes ``of`` (those of the other by theirs) at rest where they are there.

    Joints keep their own rest, and so does what no clip moves but controls, so that keys below it mean what
    they did; all where there are no clips; and, with a warning, what has another parent there.
    """
    moving = {track.node for clip in rig.clips for track in clip.tracks}
    ours, theirs_at = dict[int, Floats](), {node: _zero(described, node) for node in of}
    translation, rotation, scale = rig.translation.copy(), rig.rotation.copy(), rig.scale.copy()
    matrix, names, elsewhere = rig.matrix.copy(), [], []
    size = float(np.abs(described.world[:, 3, :3]).max(initial=0.0)) or 1.0
    for theirs, node in sorted(of.items(), key=lambda pair: pair[1]):
        is_control = rig.type_of(node) == "control"
        above = ours.get(int(rig.parents[node]), np.eye(4))
        ours[node] = above if is_control else multiply(rig.local[node], above)
        if not ((is_control and moving) or node in moving):  # of no clip, no frame is stored as rest
            continue
        if rig.is_joint[node] or rig.type_of(node) == "group":
            continue
        place, parent = described.local[theirs], theirs_at.get(int(described.parents[theirs]), np.eye(4))
        moved = not is_control and np.abs(above - parent).max() > _SAME_PLACE * size
        if moved:
            place = multiply(theirs_at[theirs], inverse(above))
        apart = np.abs(rig.local[node] - place)
        same = bool(apart[:3].max() <= _SAME_PLACE and apart[3].max() <= _SAME_PLACE * size)
        if not _same_above(rig, described, node, theirs):
            elsewhere += [] if same else [rig.title(node)]
            continue
        names += [] if same else [rig.title(node)]
        if not is_control:
            ours[node] = multiply(place, above)
        if moved or rig.has_matrix[node] or described.has_matrix[theirs]:
            matrix[node] = place
            translation[node], rotation[node], scale[node] = decompose(matrix[node])
        else:
            translation[node] = described.translation[theirs]
            rotation[node], scale[node] = described.rotation[theirs], described.scale[theirs]
    if names:
        report.reposed = True  # lines of controls go along
        report.added.append({"type": "described", "nodes": names})
    if elsewhere:
        text = f"The file of --rig has other parents for {list_names(elsewhere)}, and their rest pose is kept"
        more = "For a file that a DCC has exported: rigtri take-clips RIG --from IN"
        report.warn("rest-kept", f"{text}. {more}", geometry=True, names=elsewhere)
    return replace(rig, translation=translation, rotation=rotation, scale=scale, matrix=matrix)


def _zero(rig: Rig, node: int) -> Floats:
    """Where a node stands while all controls are zero, seen from what is not rigtri's, (4, 4)."""
    place = np.eye(4)
    while node >= 0 and rig.type_of(node) in ADDED:
        if rig.type_of(node) != "control":
            place = multiply(place, rig.local[node])
        node = int(rig.parents[node])
    return place


def _same_above(rig: Rig, described: Rig, node: int, theirs: int) -> bool:
    """Whether the parents of two nodes have one name; what changes no place is passed over."""
    return _placing(rig, node) == _placing(described, theirs)


def _placing(rig: Rig, node: int) -> str:
    """The name of the nearest node above that places what is below it; "" for none."""
    above = int(rig.parents[node])
    while above >= 0 and rig.type_of(above) in ("", "group"):
        if np.abs(rig.local[above] - np.eye(4)).max() > 1e-6:
            break
        above = int(rig.parents[above])
    return rig.names[above] if above >= 0 else ""
