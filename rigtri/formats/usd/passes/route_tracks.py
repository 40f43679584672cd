"""Route tracks that have no place in the file to the clip that the stage plays."""

from __future__ import annotations

from dataclasses import replace

from rigtri.evaluation.timelines import PLAYED
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.xform_hierarchy import XFORMS


def route_tracks(edit: UsdEdit) -> None:
    """Move tracks of prims and blend shapes from the clip of no place to the clip of the stage.

    A stage has one time, so what it plays at once has no place of its own in the file. Tracks of
    joints are in the clips of their animations by now.
    """
    rig = edit.rig
    unplaced = [clip for clip in rig.clips if clip.key == PLAYED]
    if not unplaced:
        return
    joints = {node for skin in rig.skins if skin.key is not None for node in skin.joints.tolist()}
    tracks = tuple(t for clip in unplaced for t in clip.tracks if t.path == "weights" or t.node not in joints)
    clips = tuple(clip for clip in rig.clips if clip.key != PLAYED)
    if all(clip.key != XFORMS.key for clip in clips):
        clips = (*clips, XFORMS)
        source = edit.source
        edit.source = replace(source, rig=replace(source.rig, clips=(*source.rig.clips, XFORMS)))
    clips = tuple(
        replace(clip, tracks=(*clip.tracks, *tracks)) if clip.key == XFORMS.key else clip for clip in clips
    )
    edit.rig = replace(rig, clips=clips)
