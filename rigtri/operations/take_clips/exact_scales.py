"""Scales of controls as an animator has keyed them, where USD from Blender has lost them.

A SkelAnimation has scales as half floats, and Blender's exporter leaves out samples that change by less than
a hundredth. So the script of ``export-blender`` puts an empty beside the armature for each control, whose
place is the control's scale, which the exporter writes in full.

Source: UsdSkelAnimation, `scales`; docs/blender.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.sampling import sample
from rigtri.evaluation.timelines import Timeline, as_float32, put_tracks, timelines
from rigtri.model.animation import Path, Track, key_values
from rigtri.model.metadata import ControlRecord
from rigtri.model.rig import Rig
from rigtri.model.script_nodes import SCALE, controls_of
from rigtri.text import list_names

_PATH: Path = "scale"
# What Blender's exporter takes for the same half float, and by what share these are rounded, with room.
_LEFT_OUT, _ROUNDED = 0.01, 1e-3


def with_exact_scales(edited: Rig, rig: Rig, of: Mapping[int, int], *, drives: bool) -> Rig:
    """The edited rig with the scale keys of the controls of ``rig`` as they were before they were exported.

    of: what nodes of ``rig`` are there. drives: whether the script was at work. GeometryError for scale keys
    that Blender has thinned, where the script's node is missing, as after an older script, or does not fit.
    """
    controls = {of[node] for node in rig.records(ControlRecord) if node in of}
    bones = {node for node in controls if edited.is_joint[node] and edited.rules.raw_quaternions}
    if not bones:
        return edited
    carriers = {end: node for node, end in controls_of(edited.names, edited, bones, SCALE).items()}
    done, lost, unlike = edited, list[int](), list[Track]()
    for timeline in timelines(edited):
        fresh = list[Track]()
        for bone in sorted(bones):
            old = timeline.track(bone, _PATH)
            if bone not in carriers:
                lost += [bone] if drives and old is not None and np.ptp(key_values(old), axis=0).any() else []
            elif (now := _carried(edited, timeline, carriers[bone], bone)) is not None:
                (fresh if _is_near(edited, old, now) else unlike).append(now)
        done = put_tracks(done, timeline, fresh) if fresh else done
    if lost := [*lost, *(track.node for track in unlike)]:
        names = list_names(map(edited.title, dict.fromkeys(lost)))
        raise GeometryError(
            f"The scale keys of {names} are lost in USD: Blender leaves out samples that change by less than "
            "0.01. The script of rigtri export-blender gives each control a node that has them "
            "(rigtri_scale): set the scene up with it once more, and export all visible objects, or export "
            "glTF in place of USD"
        )
    return done


def _carried(edited: Rig, timeline: Timeline, node: int, bone: int) -> Track | None:
    """The scale keys of a control that a node of the script has as its place; None where it rests."""
    if (keys := timeline.track(node, "translation")) is not None:
        return replace(keys, node=bone, path=_PATH, key=None)
    place = edited.translation[[node]]
    if (place == edited.scale[bone]).all() and timeline.track(bone, _PATH) is None:
        return None
    start = min(float(track.times[0]) for track in timeline.clip.tracks if len(track.times))
    return Track(bone, _PATH, "STEP", np.array([start]), as_float32(place))


def _is_near(edited: Rig, old: Track | None, now: Track) -> bool:
    """Whether keys can be those of which Blender has written ``old``."""
    written = key_values(old) if old is not None else edited.scale[[now.node]]
    keyed = sample(now, old.times) if old is not None else key_values(now)
    return bool((np.abs(keyed - written) <= _LEFT_OUT + _ROUNDED * np.maximum(1.0, np.abs(keyed))).all())
