"""Unify the values of skeletons that are the same but for rounding.

Instances and references of one character stand in different places, and axes
worked out there differ in their last bits. What they share (a prototype, an
animation) can stay shared only if their new values are equal.
"""

from __future__ import annotations

import hashlib
from collections.abc import Hashable, Mapping
from dataclasses import replace

import numpy as np

from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.node_keys import parts
from rigtri.formats.usd.reading.skeleton_reader import Skeleton
from rigtri.maths.arrays import Integers
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Path, Track
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin

# Values that differ by less, as a share of the largest of them, are one value.
ROUNDING = 1e-9


def unify_rounding(edit: UsdEdit) -> None:
    """Give joints of equal skeletons that were reoriented alike the same values."""
    rig = edit.rig
    leader = _leaders(edit.source.rig, rig, edit.source.skeletons)
    if (leader == np.arange(len(leader))).all():
        return
    number = {joints.tobytes(): k for k, joints in enumerate(skin.joints for skin in rig.skins)}
    skins = []
    for skin in rig.skins:
        first = rig.skins[number.get(leader[skin.joints].tobytes(), number[skin.joints.tobytes()])]
        skins.append(skin if first is skin else replace(skin, inverse_bind=first.inverse_bind))
    clips = []
    copies: dict[tuple[int, Path, Hashable], Track] = {}  # of one motion, each in an animation of its own
    sources = {clip.key: clip for clip in edit.source.rig.clips}
    for clip in rig.clips:
        known: dict[tuple[int, Path, Hashable], Track] = {}
        read = {(t.node, t.path): t for t in (sources[clip.key].tracks if clip.key in sources else ())}
        tracks = []
        for track in clip.tracks:
            head = int(leader[track.node])
            track = _unified_track(track, known, head, track.key)
            if (was := read.get((track.node, track.path))) is not None:
                track = _unified_track(track, copies, head, _content(was))
            tracks.append(track)
        clips.append(replace(clip, tracks=tuple(tracks)))
    edit.rig = replace(
        rig,
        translation=rig.translation[leader],
        rotation=rig.rotation[leader],
        scale=rig.scale[leader],
        matrix=rig.matrix[leader],
        has_matrix=rig.has_matrix[leader],
        skins=tuple(skins),
        clips=tuple(clips),
    )


def _leaders(before: Rig, rig: Rig, skeletons: Mapping[str, Skeleton]) -> Integers:
    """For each node, whose values it takes: (n,), its own number in most cases."""
    leader = np.arange(len(rig))
    firsts: list[tuple[Skeleton, Skin]] = []
    for old, new in zip(before.skins, rig.skins, strict=False):  # new ones come last
        skeleton = skeletons.get(parts(old.key)[1]) if parts(old.key)[0] == "skeleton" else None
        if skeleton is None:
            continue
        for known, first in firsts:
            values = _close(first.inverse_bind, new.inverse_bind) and _close(
                rig.local[first.joints], rig.local[new.joints]
            )
            if values and _same_skeleton(known, skeleton):
                leader[new.joints] = first.joints
                break
        else:
            firsts.append((skeleton, new))
    return leader


def _same_skeleton(one: Skeleton, other: Skeleton) -> bool:
    return (
        one.tokens == other.tokens
        and np.array_equal(one.bind, other.bind)
        and np.array_equal(one.rest, other.rest)
    )


def _close(one: Floats, other: Floats) -> bool:
    size = float(np.abs(one).max(initial=1.0))
    return one.shape == other.shape and bool(np.abs(one - other).max(initial=0.0) <= ROUNDING * size)


def _content(track: Track) -> bytes:
    """A digest of the keys of a track, wherever they are stored."""
    found = hashlib.blake2b(track.interpolation.encode(), digest_size=16)
    for array in (track.times, track.values):
        found.update(repr(array.shape).encode() + np.ascontiguousarray(array).tobytes())
    return found.digest()


def _unified_track(
    track: Track, known: dict[tuple[int, Path, Hashable], Track], leader: int, motion: Hashable
) -> Track:
    """A track, or with the values of the first of the same motion: a column of one animation, or equal keys.

    The skeleton whose values all take may play another animation.
    """
    first = known.setdefault((leader, track.path, motion), track)
    if first is track or not _close(first.values, track.values):
        return track
    return replace(track, values=first.values)
