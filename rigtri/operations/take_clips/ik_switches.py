"""Limbs whose IK is switched on in Blender without keys, as the script of ``export-blender`` stores it.

Below each IK end the script puts an empty node, whose scale is that of a switch: half where IK is off, one
and a half where it is on, one where nothing drives. A scale comes through every exporter, as custom
properties do not; and so does the name of the end, where an exporter has no nodes below joints.

Source: docs/blender.md.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from rigtri.evaluation.solver import Solver
from rigtri.evaluation.timelines import Timeline, as_float32, put_tracks, timelines
from rigtri.evaluation.zero_pose import ControlsAtZero, IkLimb
from rigtri.maths.matrices import decompose
from rigtri.model.animation import Path, Track
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import ControlRecord, OffsetRecord
from rigtri.model.rig import Rig
from rigtri.model.script_nodes import DRIVE, IK, controls_of, is_script_node
from rigtri.report import Report
from rigtri.text import list_names

_PATH: Path = "translation"
# Scales between off and none, and between none and on.
_OFF, _ON = 0.75, 1.25


@dataclass(frozen=True)
class Switches:
    """The IK ends whose IK was on while somebody animated, and those whose IK was off.

    drives: whether controls and pose readers drove, which the switches of IK ends or one of its own say.
    """

    on: frozenset[int]
    off: frozenset[int]
    drives: bool = False


def switches(edited: Rig, ends: Mapping[int, int]) -> Switches:
    """The switches of a file's IK ends: ``ends`` has their nodes there, and what they are in the rig."""
    sizes = {
        ends[end]: _size(edited, node) for node, end in controls_of(edited.names, edited, ends, IK).items()
    }
    on = frozenset(end for end, size in sizes.items() if size > _ON)
    off = frozenset(end for end, size in sizes.items() if size < _OFF)
    alone = (k for k, name in enumerate(edited.names) if is_script_node(name, DRIVE))
    return Switches(on, off, bool(on or off) or any(_size(edited, node) > _ON for node in alone))


def _size(rig: Rig, node: int) -> float:
    x, y, z = decompose(rig.local[node])[2]
    return float(x + y + z) / 3


def switches_of(rig: Rig, edited: Rig, of: Mapping[int, int], report: Report) -> Switches:
    """The switches of a rig's IK ends in a file, with a warning of those that are lost.

    of: what nodes of the rig are there.
    """
    ends = {node: of[node] for node in ik_ends(rig) if node in of}
    warn_lost_switches(rig, edited, ends, report)
    return switches(edited, {theirs: node for node, theirs in ends.items()})


def warn_lost_switches(rig: Rig, edited: Rig, ends: Mapping[int, int], report: Report) -> None:
    """Warn of IK ends that are bones in a file without their switches, which an export may have left out.

    ends: their nodes in the rig, and what they are there. Where the setup has made bones of controls, Blender
    exports keys of what its constraints did to joints and offsets.
    """
    found = set(controls_of(edited.names, edited, set(ends.values()), IK).values())
    lost = [
        rig.title(node)
        for node, theirs in ends.items()
        if edited.is_joint[theirs] > rig.is_joint[node] and theirs not in found
    ]
    if lost:
        report.warn(
            "ik-switches-lost",
            f"{list_names(lost)}: controls that are bones, without the node rigtri_ik that says whether "
            "their IK was on. Keys of their limbs count as edits, and no IK end gets a key where IK held it "
            "without one. If the script of rigtri export-blender set them up, export with Limit to: Visible "
            "Objects, not Selected Objects",
            geometry=True,
            names=lost,
        )


def ik_ends(rig: Rig) -> list[int]:
    """The controls that IK reaches for."""
    return [node for node, record in rig.records(ControlRecord).items() if record.kind == "ik"]


def follow_controls(rig: Rig) -> frozenset[int]:
    """The joints and offsets that controls move in Blender by constraints; exporters write keys of them."""
    moved = {node for step in Solver(rig).steps for node in step.sets}
    return frozenset(moved.union(rig.nodes_of(OffsetRecord.type)))


def as_switched(
    rig: Rig, switched: Switches, taken: Collection[str], changed: Collection[str], report: Report
) -> Rig:
    """The rig with keys of IK ends as they were switched, in clips that were taken or changed, by name."""
    rig = drop_switched_off_ik_keys(rig, switched, [t for t in timelines(rig) if t.name in taken], report)
    return hold_switched_on_ik(rig, switched, [t for t in timelines(rig) if t.name in changed])


def hold_switched_on_ik(rig: Rig, switched: Switches, every: Sequence[Timeline]) -> Rig:
    """The rig with a key of each IK end that is on, where it stands at rest, in each timeline without keys
    of it and of its pole."""
    limbs = _limbs(rig, switched.on)
    done = rig
    for timeline in every:
        tracks = [track for k in timeline.members for track in rig.clips[k].tracks]
        keyed = {track.node for track in tracks}
        times = [track.times[:1] for track in tracks if len(track.times)]
        if times:
            start = np.min(times, axis=0)
            fresh = [
                Track(limb.control, _PATH, "STEP", start, as_float32(rig.translation[[limb.control]]))
                for limb in limbs
                if keyed.isdisjoint((limb.control, limb.pole, *limb.pivots))
            ]
            done = put_tracks(done, timeline, fresh)
    return done


def drop_switched_off_ik_keys(rig: Rig, switched: Switches, every: Sequence[Timeline], report: Report) -> Rig:
    """The rig without keys of IK ends that are off, and of their poles, in the timelines, with a notice."""
    limbs = _limbs(rig, switched.off)
    gone = {node for limb in limbs for node in (limb.control, limb.pole, *limb.pivots)}
    members = {k for timeline in every for k in timeline.members}
    lost = {track.node for k in members for track in rig.clips[k].tracks} & gone
    if not lost:
        return rig
    names = [rig.title(node) for node in sorted(lost)]
    text = f"IK was switched off in Blender (rigtri_ik): the keys of {list_names(names)} are left out"
    report.warn("ik-off", text, names=names)
    clips = (
        replace(clip, tracks=tuple(track for track in clip.tracks if track.node not in lost))
        if k in members
        else clip
        for k, clip in enumerate(rig.clips)
    )
    return replace(rig, clips=tuple(clips))


def _limbs(rig: Rig, ends: frozenset[int]) -> list[IkLimb]:
    return [limb for limb in ControlsAtZero(rig).limbs if limb.control in ends] if ends else []
