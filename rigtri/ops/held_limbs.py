"""Limbs that IK holds in Blender without keys, as the script of ``export-blender`` tells it.

Below each IK end the script puts an empty node, whose scale is that of a switch: half where IK is off, one
and a half where it is on, one where nothing drives. A scale comes through every exporter, as custom
properties do not.

Source: docs/blender.md.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.matrices import decompose
from rigtri.ops.taking.notices import some
from rigtri.records import Path, Track
from rigtri.report import Report
from rigtri.rig import SWITCH, Rig
from rigtri.solve.reference import IkLimb, Reference
from rigtri.timelines import placed, single, timelines

_PATH: Path = "translation"
# Scales that tell off from nothing, and nothing from on.
_OFF, _ON = 0.75, 1.25


def held_limbs(rig: Rig, report: Report) -> Rig:
    """The rig with keys for limbs that IK held without any; limbs whose IK was off lose theirs."""
    on, off = set[int](), set[int]()
    for node, end in _switches(rig).items():
        x, y, z = decompose(rig.local[node])[2]
        size = float(x + y + z) / 3
        if size > _ON:
            on.add(end)
        elif size < _OFF:
            off.add(end)
    if not on | off:
        return rig
    limbs = Reference(rig).limbs
    rig = _let_go(rig, [limb for limb in limbs if limb.control in off], report)
    return _holding(rig, [limb for limb in limbs if limb.control in on])


def _switches(rig: Rig) -> dict[int, int]:
    """The nodes that tell of a switch, and the IK ends that they hang below."""
    ends = {node for node, note in rig.notes.items() if note.get("kind") == "ik"}
    return {
        node: int(above)
        for node, above in enumerate(rig.parents.tolist())
        if above in ends and SWITCH.fullmatch(rig.names[node])
    }


def _holding(rig: Rig, limbs: list[IkLimb]) -> Rig:
    """A key of the IK end, where it stands at rest, in each clip that has none of it or of its pole."""
    done = rig
    for timeline in timelines(rig):
        keyed = {track.node for track in timeline.clip.tracks}
        times = [track.times[:1] for track in timeline.clip.tracks if len(track.times)]
        if times:
            start = np.min(times, axis=0)
            tracks = [
                Track(limb.control, _PATH, "STEP", start, single(rig.translation[[limb.control]]))
                for limb in limbs
                if keyed.isdisjoint((limb.control, limb.pole))
            ]
            done = placed(done, timeline, tracks)
    return done


def _let_go(rig: Rig, limbs: list[IkLimb], report: Report) -> Rig:
    """No keys of IK ends and poles in any clip, with a notice."""
    gone = {node for limb in limbs for node in (limb.control, limb.pole)}
    lost = {track.node for clip in rig.clips for track in clip.tracks} & gone
    if not lost:
        return rig
    names = some(rig.title(node) for node in sorted(lost))
    report.warn("ik-off", f"IK was switched off in Blender (rigtri_ik): the keys of {names} are left out")
    clips = (
        replace(clip, tracks=tuple(track for track in clip.tracks if track.node not in lost))
        for clip in rig.clips
    )
    return replace(rig, clips=tuple(clips))
