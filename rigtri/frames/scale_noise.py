"""Scale noise: scales that exporters leave nearly uniform, made uniform so that joints can be re-oriented.

What such a scale S does beside the uniform s, the strain A = S·s⁻¹, is taken up by the numbers below it. With
row matrices, p the parent, and primes for what is written::

    world = A·world'      A = local·Ap·local'⁻¹      translation' = translation·Ap
    inverse_bind' = inverse_bind·A

which is exact at rest, and in every pose that rotates nothing below the joint: strains are constants, each
seen in the axes of a node. Where a joint below has another rotation than at rest, what is below that joint
moves, by no more than the strain times its reach; `moved` measures it in the poses of a file.

Source: docs/exactness.md, "Scale noise".
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from rigtri.frames.error_bounds import LeverArm, longest_stretch, posed_worlds
from rigtri.frames.nonuniform_scale import ROUNDING, ScaleTable
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.matrices import from_frame, inverse, multiply, transform_directions
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Track
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig

# Scale components that differ by no more (share of the largest) may be noise of an exporter: each is off by
# 1e-4 at most from a uniform scale between them.
NOISE = 2e-4
# Keys that differ from the scale at rest by no more than this are uniform multiples of it.
SAME_RATIO = 4 * ROUNDING


@dataclass(frozen=True, eq=False)
class Frozen:
    """A rig of uniform scales. joints: those that had others, with these at rest, (3,).

    strain: what is left out of the axes of each node, (n, 4, 4). spread: by how much their scales were not
    uniform at most. moved: how far anything moves at most in the poses of the file, as a share of the size;
    elsewhere: in any other pose that rotates joints.
    """

    rig: Rig
    joints: Mapping[int, Floats]
    strain: Floats
    spread: float
    moved: float = 0.0
    elsewhere: float = 0.0


def noisy_joints(rig: Rig, scales: ScaleTable) -> list[int]:
    """The joints whose scale is not uniform by noise alone, the same at rest and in all clips.

    Not where what rigtri has added stands on or below them: its offsets are from the scales as they are.
    """
    found = np.flatnonzero(rig.is_joint & scales.uneven & (scales.spread <= NOISE)).tolist()
    if not found:
        return []
    marked = np.zeros(len(rig), dtype=bool)
    marked[[node for node in rig.metadata if rig.type_of(node) != "frame" or node in rig.holders]] = True
    for level in reversed(rig.levels[1:]):
        marked[rig.parents[level[marked[level]]]] = True
    return [joint for joint in found if not marked[joint] and _is_still(scales.of_node(joint))]


def frozen(rig: Rig, joints: Sequence[int], scales: ScaleTable, tolerance: float) -> Frozen | None:
    """The rig with uniform scales of ``joints``; None where there is nothing that may be made uniform.

    Lines of joints whose strains would move anything by more than ``tolerance``, a share of the size, stay as
    they are, as a whole: of a part of them a second run would have less to bear, and take the rest.
    """
    top = _topmost(rig, joints)
    far = moved(rig, freeze(rig, joints, scales), LeverArm(rig))
    most = np.zeros(len(rig))
    below = np.flatnonzero(top >= 0)
    np.maximum.at(most, top[below], far[below])
    taken = [joint for joint in joints if most[top[joint]] <= tolerance]
    if not taken:
        return None
    within = max(float(most[top[joint]]) for joint in taken)
    return replace(freeze(rig, taken, scales), moved=within, elsewhere=_anywhere(rig, taken, scales))


def freeze(rig: Rig, joints: Sequence[int], scales: ScaleTable) -> Frozen:
    """The rig with uniform scales of ``joints``; points, joints and vectors stay where they are at rest."""
    factor = np.ones((len(rig), 3))
    touched: Booleans = np.zeros(len(rig), dtype=bool)
    uniform = np.array([[_uniform(scales.rows[joint])] for joint in joints])
    factor[joints] = uniform / np.abs(scales.rows[joints])
    touched[joints] = True
    touched = rig.at_or_below(touched)
    strain = _strain(rig, factor, touched)
    above = np.where((rig.parents >= 0)[:, np.newaxis, np.newaxis], strain[rig.parents], np.eye(4))
    moves = np.where(rig.parents >= 0, touched[rig.parents], False)
    translation, scale, matrix = rig.translation.copy(), rig.scale.copy(), rig.matrix.copy()
    translation[moves] = transform_directions(translation[moves], above[moves])
    scale[joints] = np.copysign(uniform, scale[joints])
    matrix[:, :3, :3] *= factor[:, :, np.newaxis]
    matrix[moves, 3, :3] = transform_directions(matrix[moves, 3, :3], above[moves])
    clips = tuple(
        replace(clip, tracks=tuple(_taken_up(track, factor, above, moves) for track in clip.tracks))
        for clip in rig.clips
    )
    skins = tuple(
        skin.rebound(lambda each: multiply(each.inverse_bind, strain[each.joints]))
        if touched[skin.ever.joints].any()
        else skin
        for skin in rig.skins
    )
    bound = tuple(
        replace(one, vector=transform_directions(one.vector, strain[one.node])) if touched[one.node] else one
        for one in rig.bound
    )
    after = replace(
        rig, translation=translation, scale=scale, matrix=matrix, clips=clips, skins=skins, bound=bound
    )
    before = {joint: scales.rows[joint] for joint in joints}
    return Frozen(after, before, strain, float(scales.spread[joints].max()))


def moved(rig: Rig, after: Frozen, arm: LeverArm) -> Floats:
    """How far at most what each node moves is off, (n,), at rest and in the clips, a share of the size.

    What a node shows itself has its strain to bear, for it has no inverse bind matrix.
    """
    strain = np.where((rig.attachment >= 0)[:, np.newaxis, np.newaxis], np.eye(4), after.strain)
    most = np.zeros(len(rig))
    for old, new in zip(_shown(rig), _shown(after.rig), strict=True):
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            seen = multiply(multiply(strain, new), inverse(old))[..., :3, :3] - np.eye(3)
            strained = longest_stretch([seen[..., k, :] for k in range(3)]) * arm.own
            away = length(new[..., 3, :3] - old[..., 3, :3]) / arm.sizes
        far = np.where(np.isfinite(strained), strained, 0.0) + np.where(np.isfinite(away), away, 0.0)
        most = np.maximum(most, far.max(axis=0))
    return most


def _shown(rig: Rig) -> Iterator[Floats]:
    """The worlds of all poses of a file, (f, n, 4, 4), a block at once."""
    yield rig.normalised_world[np.newaxis]
    yield from posed_worlds(rig, (clip for clip in rig.clips if clip.tracks))


def _is_still(rows: Floats) -> bool:
    """Whether all scales of a node, (k, 3), are uniform multiples of the first."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = rows / rows[0]
    apart = ratio.max(axis=1) - ratio.min(axis=1)
    return bool((apart <= SAME_RATIO * np.abs(ratio).max(axis=1)).all())


def _uniform(scale: Floats) -> float:
    """The one number for a scale: 1 where it lies between the components, else their middle."""
    low, high = float(np.abs(scale).min()), float(np.abs(scale).max())
    return 1.0 if low <= 1.0 <= high else 0.5 * (low + high)


def _strain(rig: Rig, factor: Floats, touched: Booleans) -> Floats:
    """A of every node, (n, 4, 4); the identity of what is scaled to nothing."""
    strain = np.broadcast_to(np.eye(4), (len(rig), 4, 4)).copy()
    linear = from_frame(rig.normalised_local[:, :3, :3], np.zeros(3))
    scaled = from_frame(linear[:, :3, :3] * factor[:, :, np.newaxis], np.zeros(3))
    for depth, level in enumerate(rig.levels):
        nodes = level[touched[level]]
        above = np.eye(4) if depth == 0 else strain[rig.parents[nodes]]
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            found = multiply(multiply(linear[nodes], above), inverse(scaled[nodes]))
        clear = np.asarray(np.isfinite(found).all(axis=(1, 2)))[:, np.newaxis, np.newaxis]
        strain[nodes] = np.where(clear, found, np.eye(4))
    return strain


def _taken_up(track: Track, factor: Floats, above: Floats, moves: Booleans) -> Track:
    """A track as it is below uniform scales."""
    if track.path == "translation" and moves[track.node]:
        return track.having(transform_directions(track.values, above[track.node]))
    if track.path == "scale" and (factor[track.node] != 1.0).any():
        return track.having(track.values * factor[track.node])
    return track


def _topmost(rig: Rig, joints: Sequence[int]) -> Integers:
    """The topmost of ``joints`` on the line from each node up to its root, (n,); -1 where there is none."""
    top = np.full(len(rig), -1)
    top[joints] = joints
    for level in rig.levels[1:]:
        above = top[rig.parents[level]]
        top[level] = np.where(above >= 0, above, top[level])
    return top


def _anywhere(rig: Rig, joints: Sequence[int], scales: ScaleTable) -> float:
    """How far anything moves at most in any pose that rotates joints, a share of the size."""
    reach, below, total = LeverArm(rig).exact, np.zeros(len(rig)), np.zeros(len(rig))
    children = np.flatnonzero(rig.parents >= 0)
    np.maximum.at(below, rig.parents[children], reach[children])
    total[joints] = scales.spread[joints] * below[joints]
    for level in rig.levels[1:]:
        total[level] += total[rig.parents[level]]
    return float(total.max(initial=0.0))
