"""Keys of the rest pose that joints had, in clips that do not move them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from rigtri.model.animation import PATHS, Clip, Track
from rigtri.model.rig import Rig


def with_old_rest(clip: Clip, rig: Rig, taken: Rig, moved: Collection[int]) -> Clip:
    """The clip with a key of the old rest pose for what it does not move."""
    # Samples and defaults of a USD animation are two clips, and play at once.
    home = clip.animation
    together = [each for each in rig.clips if each is clip or (home is not None and each.animation == home)]
    driven = {(track.node, track.path) for each in together for track in each.tracks}
    fresh: list[Track] = []
    times = next((track.times[:1] for track in clip.tracks if len(track.times)), None)
    # Of a stage only samples of joints: what it holds without time is its rest pose, and prims are no joints.
    other = isinstance(clip.key, tuple) and clip.key[0] != "samples"
    if times is None and home is None and not isinstance(clip.key, tuple):
        times = np.zeros(1)  # a glTF animation of other things, such as a colour: its joints rest
    # An animation of a stage is none of joints of skeletons that others are bound to.
    mine = {node for node, _ in driven}
    # One that lacks an array would not play if it were bound, either.
    whole = not clip.idle or any(all((node, path) in driven for path in PATHS) for node in mine)
    if times is None or not whole or other:
        return clip
    joints = [set(skin.joints.tolist()) for skin in rig.skins]
    strange = set().union(*(each for each in joints if home is not None and mine.isdisjoint(each)))
    for node in (node for node in moved if node not in strange):
        for path in PATHS:
            was, now = (getattr(each, path)[node] for each in (rig, taken))
            if (node, path) not in driven and (was != now).any():
                fresh.append(Track(node, path, "STEP", times, was[np.newaxis]))
    return replace(clip, tracks=(*clip.tracks, *fresh)) if fresh else clip
