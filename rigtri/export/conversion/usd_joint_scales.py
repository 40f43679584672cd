"""Scales of joints, which SkelAnimations have as half floats: eleven bits, each sample by itself.

One that never changes and is the same along all axes need not be there at all: what is below a joint, and
what it moves, can have it instead. An armature of 0.01, as exporters leave it, would be 2e-4 off.

Source: UsdSkelAnimation (half3[] scales).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from rigtri.evaluation.sampling import sample
from rigtri.maths.matrices import from_frame, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.text import and_more

# Scales that a half float holds to this share need no word: it is half of what a conversion may be off.
HELD = 5e-6
# By which share of a scale OpenUSD is off between two samples: it rounds both factors, both products and
# their sum, and the worst of 4e6 random ones is 9.5e-4 off.
_BETWEEN = "9.8e-4"
# Scales are one within this share: float32's noise.
_SAME = 1e-6


def half_scales(
    rig: Rig, joints: Collection[int], clip: Clip, played: Mapping[int, Track] | None = None
) -> list[int]:
    """Joints that a clip moves whose scales a half float does not hold.

    played: how those of joints play that a SkelAnimation holds, by joint: at the keys of others, too.
    """
    moved = {track.node for track in clip.tracks if track.path != "weights"}
    scales = {track.node: track for track in clip.tracks if track.path == "scale"}

    def held(node: int) -> bool:
        track = scales.get(node)
        if track is None:
            return _held(rig.scale[node])
        shared = played is None or node not in played or _held(sample(track, played[node].times))
        return shared and _held(np.asarray(track.values))

    return [node for node in joints if node in moved and not held(node)]


def with_half_scales(
    rig: Rig, clip: Clip, joints: Collection[int], played: Mapping[int, Track]
) -> tuple[Rig, Clip]:
    """The rig and the clip with the scales of some joints as half floats hold them.

    played: how those of joints play that a SkelAnimation holds, by joint.
    """

    def half(values: Floats) -> Floats:
        return values.astype(np.float16).astype(np.float64)

    def halved(track: Track) -> Track:
        if track.path != "scale" or track.node not in joints:
            return track
        return played[track.node] if track.node in played else track.having(half(track.values))

    scale = rig.scale.copy()
    scale[list(joints)] = half(scale[list(joints)])
    return replace(rig, scale=scale), replace(clip, tracks=tuple(map(halved, clip.tracks)))


def lost_scales(rig: Rig, joints: Collection[int], halves: Iterable[Collection[int]]) -> Iterator[str]:
    """What half floats lose, in words. halves: `half_scales`, by clip."""
    if stored := set[int]().union(*halves):
        yield f"scales of {_titles(rig, stored)} in full: UsdSkel has those of animations as half floats"
    if changing := _changing(joints, rig.clips):
        between = f"between keys: OpenUSD rounds them there, by up to {_BETWEEN}"
        yield f"scales of {_titles(rig, changing)} {between}"


def unshown_scales(rig: Rig, joints: Collection[int], clips: Iterable[Clip]) -> Iterator[str]:
    """What other formats do not show of joints as OpenUSD does between samples, in words."""
    if changing := _changing(joints, clips):
        yield (
            f"how OpenUSD rounds scales of {_titles(rig, changing)} between samples, to half floats: "
            f"by up to {_BETWEEN} of them"
        )


def _changing(joints: Collection[int], clips: Iterable[Clip]) -> set[int]:
    """Joints whose scales, as half floats, change between samples."""
    return {
        track.node
        for clip in clips
        for track in clip.tracks
        if track.path == "scale" and track.node in joints and track.interpolation != "STEP"
        if np.ptp(track.values.astype(np.float16), axis=0).any()
    }


def _titles(rig: Rig, nodes: Collection[int]) -> str:
    return and_more([f"'{rig.title(node)}'" for node in sorted(nodes)], 3)


def _held(scales: Floats) -> bool:
    rounded = scales.astype(np.float16).astype(np.float64)
    return bool((np.abs(rounded - scales) <= HELD * np.abs(scales).max()).all())


def without_steady_scales(rig: Rig, joints: Collection[int]) -> tuple[Rig, Floats]:
    """The rig with scale 1 for joints whose scale is steady, even and not held by a half float.

    Returns it and by how much, (n,), the axes of each node are longer in the rig as it was. What is below
    such joints has other translations, skins have other bind poses, and all nodes stay where they are.
    """
    halved = {node for clip in rig.clips for node in half_scales(rig, joints, clip)}
    tracks: dict[int, list[Track]] = {node: [] for node in halved}
    for track in (track for clip in rig.clips for track in clip.tracks):
        if track.path == "scale" and track.node in halved:
            tracks[track.node].append(track)
    steady, sizes = np.ones(len(rig)), np.ones(len(rig))
    for node in halved:
        steady[node] = _steady(rig.scale[node], tracks[node])
    if (steady == 1.0).all():
        return rig, sizes
    factors: dict[int, list[float]] = {-1: []}  # those that are not 1 alone: chains can be long
    for node, (parent, size) in enumerate(zip(rig.parents.tolist(), steady.tolist(), strict=True)):
        factors[node] = factors[parent] if size == 1.0 else [size, *factors[parent]]
    for node in joints:
        sizes[node] = np.prod(factors[node])
    above = np.where(rig.parents >= 0, sizes[rig.parents], 1.0)
    matrix = rig.matrix.copy()
    matrix[:, 3, :3] *= above[:, np.newaxis]
    clips = (
        replace(clip, tracks=tuple(_resized(track, steady, above) for track in clip.tracks))
        for clip in rig.clips
    )
    skins = (
        replace(skin, inverse_bind=multiply(skin.inverse_bind, scalings(sizes[skin.joints])))
        for skin in rig.skins
    )
    changed = replace(
        rig,
        translation=rig.translation * above[:, np.newaxis],
        scale=rig.scale / steady[:, np.newaxis],
        matrix=matrix,
        clips=tuple(clips),
        skins=tuple(skins),
    )
    return changed, sizes


def scalings(sizes: Floats) -> Floats:
    """Matrices that scale alike along all axes, (...) → (..., 4, 4)."""
    return from_frame(np.eye(3) * sizes[..., np.newaxis, np.newaxis], np.zeros((*sizes.shape, 3)))


def _steady(scale: Floats, tracks: Sequence[Track]) -> float:
    """The scale of a joint at rest and in all clips, 1 where it changes or is uneven."""
    found = np.abs(np.concatenate([scale, *(track.values.ravel() for track in tracks)]))
    size = float(found[0])
    spline = any(track.interpolation == "CUBICSPLINE" for track in tracks)
    return 1.0 if spline or not size or (np.abs(found - size) > _SAME * size).any() else size


def _resized(track: Track, steady: Floats, above: Floats) -> Track:
    by = {"translation": above[track.node], "scale": 1.0 / steady[track.node]}.get(track.path, 1.0)
    return track if by == 1.0 else track.having(track.values * by)
