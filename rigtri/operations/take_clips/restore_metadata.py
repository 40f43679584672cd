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
from rigtri.evaluation.twist_joints import with_twist_of
from rigtri.maths.matrices import inverse, multiply
from rigtri.maths.vectors import length
from rigtri.model.metadata import (
    ADDED,
    EXPORT_WARNINGS,
    ControlRecord,
    Place,
    PoleVectorRecord,
    damage,
    with_references,
)
from rigtri.model.rig import Rig
from rigtri.operations.operation import operation
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.operations.take_clips.bind_space import bind_poses
from rigtri.operations.take_clips.clip_matching import Taken
from rigtri.operations.take_clips.ik_switches import (
    drop_switched_off_ik_keys,
    hold_switched_on_ik,
    ik_ends,
    switches,
    warn_lost_switches,
)
from rigtri.operations.take_clips.restore_constraints import (
    check_constraints,
    in_world,
    with_group,
)
from rigtri.operations.take_clips.restore_rest import with_rest_of
from rigtri.operations.take_clips.restore_rivets import with_rivets_of
from rigtri.operations.take_clips.standing import stood_up
from rigtri.operations.take_clips.unkeyed_poses import key_unkeyed_poses
from rigtri.recognition.one_character import titles
from rigtri.report import Report
from rigtri.text import list_names

# Matrices that differ by less, moves as a share of the largest, went through another program's float32.
_SAME = 1e-4


@operation(None)
def as_described(rig: Rig, described: Rig, *, report: Report) -> Rig:
    """The rig with the metadata of ``described`` on nodes of the same names, at rest where they are there.

    A warning of the report names nodes that are not there, and joints that are bound otherwise, whose
    controls keep their own rest. GeometryError where no node is there, a control or pole vector is not, a
    control does not find its joint, or a constraint would be left out. A group that constraints follow is
    added.
    """
    added = described.nodes_of(*ADDED)
    if not added:
        raise GeometryError("The file of --rig has nothing of rigtri's: no controls, poles or constraints")
    both = _stood(Counterparts(described, rig))
    rig, of = with_group(rig, described, both)
    told = in_world(both).metadata
    stored = {node: told[node] for node in added}
    shared = {node: of[node] for node in stored if node in of}
    as_stored = {node: stored[theirs] for theirs, node in shared.items()}
    found = _with_names_of(rig, as_stored, described, of)
    # A group only holds the others; as a Scope without metadata it is no node.
    others = [node for node in stored if described.type_of(node) != "group"]
    missing = [node for node in others if node not in both.of]
    if missing == others:
        raise GeometryError(_why_none(rig, described, both, missing))
    if missing:
        _refuse_lost_keys(rig, both, found, [described.names[node] for node in missing])
        _refuse_lost_controls(rig, described, missing)
        names = [described.names[node] for node in missing]
        report.warn(
            "not-in-this-file",
            f"This file does not have {list_names(names)} of the file of --rig",
            names=names,
        )
    elif not any(damage(stored) for node, stored in rig.metadata.items() if node not in found):
        report.answer(*EXPORT_WARNINGS)
    _warn_other_metadata(rig, as_stored, found, report)
    check_constraints(rig, described, of, report)
    whole = with_rivets_of(replace(rig, metadata={**rig.metadata, **found}), described, of, report)
    _refuse_strange_joints(whole, found, described)
    bound = _bound_otherwise(rig, described, of)
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
    ends = {node: of[node] for node in ik_ends(described) if node in of}
    warn_lost_switches(described, whole, ends, report)
    rested = with_twist_of(with_rest_of(whole, described, shared, report, both.turned), described, of)
    whole = key_unkeyed_poses(whole, rested, described, of, report)
    whole = drop_switched_off_ik_keys(whole, switched, timelines(whole), report)
    return hold_switched_on_ik(whole, switched, timelines(whole))


def _stood(both: Counterparts) -> Counterparts:
    """The pairs with this file's world as its clips show it, where these stand and the file rests lying.

    Blender's exporter writes the rest of joints below an armature object with a rotation of its own so.
    """
    homes = {timeline.name: timeline for timeline in timelines(both.rig)}
    every = [
        Taken(played.name, homes[played.name], played.clip, (played.name,))
        for played in timelines(both.other)
        if played.name in homes
    ]
    try:
        return stood_up(both, every, Report())
    except GeometryError:  # take-clips refuses such a file; here joints keep their own motion
        return both


def _why_none(rig: Rig, described: Rig, both: Counterparts, missing: Collection[int]) -> str:
    """Why nothing of the other file is in this one, and what to do."""
    many = [described.names[node] for node in missing if described.names[node] in both.unclear]
    lost = list_names(described.names[node] for node in missing)
    several = titles(rig)
    remedy = (
        f"bake one character at a time, with --character: {list_names(several)}"
        if len(several) > 1
        else "give each node a name of its own"
    )
    return (
        f"Several nodes match {list_names(many)} of the file of --rig; {remedy}"
        if many
        else f"Nothing that rigtri built in the file of --rig is in this file, none of {lost}, and "
        "--rig only restores what is stored on nodes that are here: add them with rigtri add-controls, "
        "or take the motion of this file to that rig with: rigtri take-clips RIG --from IN"
    )


def _refuse_lost_keys(rig: Rig, both: Counterparts, ours: Collection[int], missing: list[str]) -> None:
    """GeometryError where nodes among controls have keys and could be some that are missing."""
    keyed = {track.node for clip in rig.clips for track in clip.tracks}.difference(both.of.values())
    strange = [node for node in sorted(keyed) if int(rig.parents[node]) in ours and not rig.is_joint[node]]
    if strange:
        raise GeometryError(
            f"{list_names(map(rig.title, strange))} of this file have keys, and are none of the "
            f"file of --rig, of which {list_names(missing)} are not here: keys would be lost. Give them the "
            "names that they have there"
        )


def _refuse_lost_controls(rig: Rig, described: Rig, missing: Collection[int]) -> None:
    """GeometryError where controls or poles are missing: whoever animated them would lose the motion."""
    moved = described.records(ControlRecord).keys() | described.records(PoleVectorRecord).keys()
    if lost := [described.names[node] for node in missing if node in moved]:
        several = titles(rig)
        raise GeometryError(
            f"This file does not have {list_names(lost)} of the file of --rig, so what was animated there "
            "would be lost. Export these nodes, too, give them the names that they have there, or give a "
            "file of --rig without them"
            + (f". For one character: --character {list_names(several)}" if len(several) > 1 else "")
        )


def _with_names_of(
    rig: Rig, stored: Mapping[int, Mapping[str, Any]], described: Rig, of: Mapping[int, int]
) -> dict[int, Mapping[str, Any]]:
    """Metadata whose names and paths of the other file mean the same nodes in this one.

    A path of it leads nowhere here where an exporter has put a node above all.
    """

    def address(_: Place, name: str) -> str:
        theirs = described.known(name)
        node = None if theirs is None else of.get(theirs)
        return name if node is None or rig.known(name) == node else rig.address(node)

    return {node: with_references(each, address) for node, each in stored.items()}


def _warn_other_metadata(
    rig: Rig,
    stored: Mapping[int, Mapping[str, Any]],
    found: Mapping[int, Mapping[str, Any]],
    report: Report,
) -> None:
    """A warning where the file has other metadata of its own."""
    own = {node: rig.metadata[node] for node in found if node in rig.metadata}
    names = [
        rig.title(node)
        for node, each in own.items()
        if each not in (stored[node], found[node]) and not damage(each)
    ]
    if names:
        text = f"The metadata of {list_names(names)} in this file is replaced by that of the file of --rig"
        report.warn("described-anew", text, names=names)


def _refuse_strange_joints(rig: Rig, nodes: Collection[int], described: Rig) -> None:
    """GeometryError where the joint of a control is none of this file: its motion would be lost."""
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
    several = titles(rig)
    if here > 1 and len(several) > 1:
        remedy = f"For one character at a time: --character {list_names(several)}"
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
    raise GeometryError(f"{text}. {remedy}")


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
