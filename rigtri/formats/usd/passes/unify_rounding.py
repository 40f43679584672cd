"""Unify the values of skeletons that are the same but for rounding.

Instances and references of one character stand in different places, and axes
worked out there differ in their last bits, or as much as the decimals that
recognised directions have. What they share (a prototype, an animation) can
stay shared only if their new values are equal.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.node_keys import parts
from rigtri.formats.usd.reading.skeleton_reader import Skeleton
from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.frames.reframe import reframe
from rigtri.frames.reoriented_constraints import broken
from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import inverse, multiply, orthonormal_axes
from rigtri.maths.quaternions import IDENTITY, from_axes, rotates, rotation_angle
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Path, Track
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin

# Values that differ by less, as a share of the largest of them, are one value.
ROUNDING = 1e-9
# Radians. Recognised directions have six decimals in the world: axes of equal characters that are turned
# against each other differ by no more.
AXES = 4e-6


def unify_rounding(edit: UsdEdit) -> None:
    """Give joints of equal skeletons that were reoriented alike the same values."""
    rig = _with_equal_axes(edit.source.rig, edit.rig, edit.source.skeletons)
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


def _with_equal_axes(before: Rig, rig: Rig, skeletons: Mapping[str, Skeleton]) -> Rig:
    """The rig with the axes of the first of equal skeletons in those whose axes are hardly others."""
    turn = np.tile(IDENTITY, (len(rig), 1))
    firsts: list[tuple[Skeleton, Skin]] = []
    for skeleton, skin in _skinned(before, rig, skeletons):
        for known, first in firsts:
            if first.inverse_bind.shape != skin.inverse_bind.shape or not _same_skeleton(known, skeleton):
                continue
            apart = from_axes(orthonormal_axes(multiply(inverse(first.inverse_bind), skin.inverse_bind)))
            angles = rotation_angle(apart)
            if (angles <= AXES).all():
                turn[skin.joints] = np.where((angles > ROUNDING)[:, np.newaxis], apart, IDENTITY)
                break
        else:
            firsts.append((skeleton, skin))
    if not rotates(turn).any() or broken(rig, turn):
        return rig
    scales = ScaleTable.of(rig)
    return reframe(rig, turn, scales=scales) if scales.allows(turn).all() else rig


def _skinned(before: Rig, rig: Rig, skeletons: Mapping[str, Skeleton]) -> Iterator[tuple[Skeleton, Skin]]:
    """The skeletons that were there, each with what the rig now has as its skin."""
    for old, new in zip(before.skins, rig.skins, strict=False):  # new ones come last
        skeleton = skeletons.get(parts(old.key)[1]) if parts(old.key)[0] == "skeleton" else None
        if skeleton is not None:
            yield skeleton, new


def _leaders(before: Rig, rig: Rig, skeletons: Mapping[str, Skeleton]) -> Integers:
    """For each node, whose values it takes: (n,), its own number in most cases."""
    leader = np.arange(len(rig))
    firsts: list[tuple[Skeleton, Skin]] = []
    for skeleton, new in _skinned(before, rig, skeletons):
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
    # Joints that an earlier pass has added, such as twist joints, have the noise in what is read here.
    return one.tokens == other.tokens and _close(one.bind, other.bind) and _close(one.rest, other.rest)


def _close(one: Floats, other: Floats) -> bool:
    size = float(np.abs(one).max(initial=1.0))
    return one.shape == other.shape and bool(np.abs(one - other).max(initial=0.0) <= ROUNDING * size)


def _content(track: Track) -> bytes:
    """A digest of the keys of a track, wherever they are stored."""
    import hashlib  # of a single skeleton nobody needs it

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
