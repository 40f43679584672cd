"""Nodes whose parents go are parented to what is above these, and stand and move as before."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError
from rigtri.maths.matrices import compose, decompose, multiply
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.quaternions import rotate
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track
from rigtri.model.rig import Rig

# Shares: scales that differ by less are uniform, and one that is nearer to 1 is 1: float32 rounding.
_UNIFORM = 1e-6


def reparented(rig: Rig, gone: Collection[int]) -> Rig:
    """The rig in which no node that stays has a parent that goes: the next one above that stays has it.

    Rest pose and keys are multiplied by the rest pose of what goes between, which changes nothing where that
    never moves. GeometryError where this has a scale that is not uniform.
    """
    if not any(int(rig.parents[node]) in gone for node in range(len(rig)) if node not in gone):
        return rig
    moved = dict[int, tuple[Floats, Floats, float]]()
    parents, matrix = rig.parents.copy(), rig.matrix.copy()
    translation, rotation, scale = rig.translation.copy(), rig.rotation.copy(), rig.scale.copy()
    for node in range(len(rig)):
        above = int(rig.parents[node])
        if node in gone or above not in gone:
            continue
        between = np.eye(4)
        while above in gone:
            between, above = multiply(between, rig.normalised_local[above]), int(rig.parents[above])
        parents[node] = above
        if (parts := uniform_parts(between)) is None:
            why = f"the scale of '{rig.title(int(rig.parents[node]))}' is not uniform. Leave that out"
            raise GeometryError(f"'{rig.title(node)}' cannot be parented anew: {why}")
        place, turn, size = moved[node] = parts
        matrix[node] = multiply(rig.matrix[node], between)
        translation[node] = place + rotate(turn, rig.translation[node] * size)
        rotation[node], scale[node] = product(turn, rig.rotation[node]), rig.scale[node] * size

    def seen(track: Track) -> Track:
        return _below(track, *moved[track.node]) if track.node in moved else track

    clips = tuple(
        replace(clip, tracks=tuple(map(seen, clip.tracks)))
        if any(track.node in moved for track in clip.tracks)
        else clip
        for clip in rig.clips
    )
    return replace(
        rig.with_parents(parents),
        translation=translation,
        rotation=rotation,
        scale=scale,
        matrix=matrix,
        clips=clips,
    )


def uniform_parts(local: Floats) -> tuple[Floats, Floats, float] | None:
    """Translation, rotation and scale of a matrix, (4, 4); None where its scale is not uniform."""
    place, turn, sizes = decompose(local)
    size, far = float(sizes[0]), float(np.abs(local).max())
    if not np.isfinite(sizes).all() or not np.abs(sizes - size).max() <= _UNIFORM * abs(size):
        return None
    if not np.abs(compose(place, turn, sizes) - local).max() <= _UNIFORM * far:  # sheared
        return None
    return place, turn, 1.0 if abs(size - 1.0) <= _UNIFORM else size


def _below(track: Track, place: Floats, turn: Floats, size: float) -> Track:
    """A track as what is above its parent sees it: tangents rotate and grow, and values move, too."""
    if track.path == "rotation":
        return track.having(product(turn, track.values))
    if track.path == "scale":
        return track.having(track.values * size)
    if track.path != "translation":
        return track
    values = rotate(turn, track.values * size)
    (values[:, 1] if track.interpolation == "CUBICSPLINE" else values)[:] += place
    return track.having(values)
