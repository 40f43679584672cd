"""Skeletons of a stage that a clip does not move: they show how they rest, whatever else plays."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from rigtri.maths.matrices import decompose, inverse, local, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import PATHS, Track
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin


def with_new_rest(rig: Rig, keys: Sequence[Hashable], made: Rig) -> Rig:
    """A stage with the rest pose of ``made`` in each of its clips for the skeletons that it does not move.

    They have no keys there that could hold the old rest pose: another clip plays on them, or none.
    keys: of the rig's nodes in ``made``.
    """
    theirs = {clip.key: {made.keys[track.node] for track in clip.tracks} for clip in made.clips}
    poses = [(frozenset(keys[n] for n in skin.joints), _held(rig, skin, keys, made)) for skin in rig.skins]
    clips = []
    for clip in rig.clips:
        moved = {keys[track.node] for track in clip.tracks} | theirs.get(clip.key, set())
        held = [track for joints, tracks in poses if moved.isdisjoint(joints) for track in tracks]
        clips.append(replace(clip, tracks=(*clip.tracks, *held)))
    return replace(rig, clips=tuple(clips))


def _held(rig: Rig, skin: Skin, keys: Sequence[Hashable], made: Rig) -> list[Track]:
    """The joints of a skin as ``made`` rests, in the axes that they have in ``rig``."""
    there = {key: node for node, key in enumerate(made.keys)}
    bound = _inverse_binds(made)
    worlds: dict[int, Floats] = {}
    found = []
    for joint, inverse_bind in zip(skin.joints.tolist(), skin.inverse_bind, strict=True):
        now = there.get(keys[joint], -1)
        if now not in bound:
            continue
        # A vertex stands where it does in `made`: inverse_bind · world is the same in both.
        worlds[joint] = multiply(multiply(inverse(inverse_bind), bound[now]), made.world[now])
        parent = int(rig.parents[joint])
        above = worlds.get(parent, rig.world[parent] if parent >= 0 else np.eye(4))
        pose = zip(PATHS, decompose(local(worlds[joint], above)), strict=True)
        found += [Track(joint, path, "STEP", np.zeros(1), value[np.newaxis]) for path, value in pose]
    return found


def _inverse_binds(rig: Rig) -> Mapping[int, Floats]:
    return {n: m for s in rig.skins for n, m in zip(s.joints.tolist(), s.inverse_bind, strict=True)}
