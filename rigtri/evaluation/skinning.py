"""Skinning: points of a mesh as joints and morph targets move them, by linear or dual-quaternion blending.

All is elementwise, so that the bits do not depend on the machine: rivets are baked from these points.
``f`` is the number of times, ``v`` of points, ``m`` of a skin's joints, ``k`` of influences per point.

Source: glTF 2.0 §3.7.3; UsdSkel; L. Kavan et al., "Skinning with dual quaternions", I3D 2007.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import from_frame, identity, inverse, multiply, nearest_rotation, transform_points
from rigtri.maths.quaternions import conjugate, dot, from_axes, norm, rotate
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.model.skin_weights import total_weights

# Points moved at once: their numbers stay in a processor's cache.
_POINTS = 1 << 13
# Matrices of one motion, as products of inverses, differ by less than this share of their largest number.
_ROUNDING = 1e-14
# Weights that sum to 1 but for this do so: those of float32, or four that are written with six digits.
_SUM_ROUNDING = 2.5e-6


def skin_matrices(skin: Skin, world: Floats) -> Floats:
    """``inverse_bind · world`` of a skin's joints, (..., m, 4, 4): bind-pose points to world."""
    return multiply(skin.inverse_bind, world[..., skin.joints, :, :])


def normalised_weights(weights: Floats) -> Floats:
    """Weights, (v, k), that sum to 1 in absolute value for each point; NaN stays NaN.

    A point without any weight follows its first joint, as in engines.
    """
    total = np.zeros((len(weights), 1))
    for start in range(0, len(weights), _POINTS):
        total[start : start + _POINTS, 0] = total_weights(np.abs(weights[start : start + _POINTS]))
    first = np.zeros(weights.shape[1])
    first[:1] = 1.0
    if total.all():  # NaN is any
        return np.asarray(weights / total)
    return np.where(total == 0, first, weights / np.where(total == 0, 1.0, total))


class Influences(NamedTuple):
    """What moves the points of a skinned mesh, in the sense of its format.

    joints: rows of ``nodes``, (v, k). weights: (v, k), sums of 1 for each point. nodes: (m,).
    bind: matrices that take points of the mesh into the frames of the nodes, (m, 4, 4).
    """

    joints: Integers
    weights: Floats
    nodes: Integers
    bind: Floats


def influences(mesh: Mesh, rig: Rig) -> Influences:
    """The influences of a mesh with a skin.

    UsdSkel takes weights as they are when it blends linearly, in the space of the Skeleton: what a point
    lacks of 1 it has of that space's origin, which is one more row of nodes, behind those of the skin.
    Elsewhere weights are scaled to sum to 1; see `normalised_weights`.

    Source: UsdSkelSkinPoints, whose dual quaternions are normalised after they are blended.
    """
    assert mesh.skin is not None
    skin = rig.skins[mesh.skin]
    bind = multiply(mesh.bind, skin.inverse_bind)
    weights, short = normalised_weights(mesh.weights), _short_of_one(mesh)
    if not short.any():
        return Influences(mesh.joints, weights, skin.joints, bind)
    weights = np.where((short != 0)[:, np.newaxis], mesh.weights, weights)
    space = _space(rig, skin)
    if space < 0:  # the world, whose origin adds nothing
        return Influences(mesh.joints, weights, skin.joints, bind)
    to_origin = np.zeros((1, 4, 4))
    to_origin[0, 3, 3] = 1.0
    last = np.full((len(weights), 1), len(skin.joints))
    return Influences(
        np.concatenate([mesh.joints, last], axis=1),
        np.concatenate([weights, short[:, np.newaxis]], axis=1),
        np.append(skin.joints, space),
        np.concatenate([bind, to_origin]),
    )


def sums_to_one(mesh: Mesh) -> bool:
    """Whether the weights of each point of a mesh sum to 1, or are scaled to do so."""
    return not _short_of_one(mesh).any()


def most_weight(mesh: Mesh) -> float:
    """How much weight a point of a mesh has in all, signs apart, at most; 1 where it is less or scaled."""
    uneven = np.abs(mesh.weights[_short_of_one(mesh) != 0])
    return float(total_weights(uneven).max(initial=1.0))


def _short_of_one(mesh: Mesh) -> Floats:
    """What the weights of points lack of 1, (v,), where that is seen; 0 elsewhere."""
    found = np.zeros(len(mesh.weights))
    if not mesh.raw_weights or mesh.dual_quaternion or not mesh.weights.shape[1]:
        return found
    for start in range(0, len(found), _POINTS):
        short = 1.0 - total_weights(mesh.weights[start : start + _POINTS])
        seen = np.abs(short) > _SUM_ROUNDING  # NaN is never
        if seen.any():  # of zeros that nobody writes no memory is taken
            found[start : start + _POINTS][seen] = short[seen]
    return found


def _space(rig: Rig, skin: Skin) -> int:
    """The node in whose space a skin's joints are, the nearest above them that is none; −1 is the world."""
    joints = {*skin.joints.tolist(), *rig.holders}
    node = int(skin.joints[0]) if len(skin.joints) else -1
    while node in joints:
        node = int(rig.parents[node])
    return node


def deformed(mesh: Mesh, rig: Rig, world: Floats, morph: Floats) -> Floats:
    """The points of a mesh in the world, (f, v, 3).

    world: (f, n, 4, 4). morph: (f, t). Weights that do not sum to 1 count as in the mesh's format; see
    `influences`. IndexError for a joint that the skin does not have.
    """
    points = mesh.points
    if morph.shape[-1] and morph.any():
        points = points + np.tensordot(morph, mesh.morphs, axes=(1, 0))
    if mesh.skin is None or not mesh.joints.shape[1]:
        return transform_points(points, world[:, mesh.node, np.newaxis])
    joints, weights, nodes, bind = influences(mesh, rig)
    matrices = multiply(bind, world[:, nodes])
    return blended(points, matrices, joints, weights, dual_quaternion=mesh.dual_quaternion)


def deformed_parts(mesh: Mesh, rig: Rig, world: Floats, morph: Floats) -> Iterator[Floats]:
    """The same at one time, some points after the other, (p, 3) each. world: (n, 4, 4). morph: (t,)."""
    skinned = mesh.skin is not None and mesh.joints.shape[1]
    if not skinned or mesh.dual_quaternion or morph.any() or not sums_to_one(mesh):
        yield deformed(mesh, rig, world[np.newaxis], morph[np.newaxis])[0]
        return
    assert mesh.skin is not None
    skin = rig.skins[mesh.skin]
    matrices = multiply(multiply(mesh.bind, skin.inverse_bind), world[skin.joints])
    # Scaled by and by: large meshes have as many weights as all else together.
    yield from _linear_parts(mesh.points, matrices, mesh.joints, mesh.weights, normalised_weights)


def blended(
    points: Floats, matrices: Floats, joints: Integers, weights: Floats, *, dual_quaternion: bool = False
) -> Floats:
    """Points, (v, 3) or (f, v, 3), moved by matrices, (f, m, 4, 4): (f, v, 3). joints, weights: (v, k).

    A point takes nothing from a joint without weight, also where that is not a number.
    """
    if dual_quaternion:
        return _dual_quaternion(points, matrices, joints, weights)
    if points.ndim == 2:
        return _linear_still(points, matrices, joints, weights)
    moved = np.zeros(points.shape)
    for column in range(joints.shape[1]):
        live = np.flatnonzero(weights[:, column])
        if len(live):
            part = transform_points(points[:, live], matrices[:, joints[live, column]])
            moved[:, live] += weights[live, column, np.newaxis] * part
    return moved


def _linear_still(points: Floats, matrices: Floats, joints: Integers, weights: Floats) -> Floats:
    """The same points, (v, 3), at all times: joint by joint, all of its points at once."""
    times = len(matrices)
    if times == 1:
        return np.concatenate(list(_linear_parts(points, matrices[0], joints, weights)))[np.newaxis]
    # Row i of a joint's matrices at all times side by side: what coordinate i is multiplied by.
    beside = matrices[..., :3].transpose(1, 2, 0, 3).reshape(matrices.shape[1], 4, times * 3)
    moved = np.zeros((len(points), times * 3))
    for column in range(joints.shape[1]):
        order = np.argsort(joints[:, column], kind="stable")
        order = order[weights[order, column] != 0]
        of = joints[order, column]
        edges = [*np.flatnonzero(np.diff(of, prepend=-1)).tolist(), len(of)]
        for start, end in pairwise(edges):
            rows, matrix = order[start:end], beside[of[start]]
            part = points[rows, 0, np.newaxis] * matrix[0]
            part += points[rows, 1, np.newaxis] * matrix[1]
            part += points[rows, 2, np.newaxis] * matrix[2]
            part += matrix[3]
            part *= weights[rows, column, np.newaxis]
            moved[rows] += part
    return moved.reshape(len(points), times, 3).transpose(1, 0, 2)


def _linear_parts(
    points: Floats,
    matrices: Floats,
    joints: Integers,
    weights: Floats,
    scaled: Callable[[Floats], Floats] = np.asarray,
) -> Iterator[Floats]:
    """At one time, matrices (m, 4, 4) → (p, 3) each: influence by influence, each point with its own joint.

    scaled: what weights count as.
    """
    beside = np.ascontiguousarray(matrices[..., :3].transpose(1, 2, 0))
    blocks = [slice(start, start + _POINTS) for start in range(0, max(len(points), 1), _POINTS)]
    if len(blocks) > 1 and _alike(matrices):
        # At rest, where rest and bind pose are one: Σ w·(p·M) is (Σ w)·(p·M).
        yield from (_together_block(points[k], scaled(weights[k]), matrices[0]) for k in blocks)
        return
    yield from (_linear_block(points[k], joints[k], scaled(weights[k]), beside) for k in blocks)


def _together_block(points: Floats, weights: Floats, matrix: Floats) -> Floats:
    """A block of points that all their joints move alike."""
    coordinates = np.ascontiguousarray(points.T)
    moved = np.empty((3, len(points)))
    for axis in range(3):
        np.multiply(coordinates[0], matrix[0, axis], out=moved[axis])
        moved[axis] += coordinates[1] * matrix[1, axis]
        moved[axis] += coordinates[2] * matrix[2, axis]
        moved[axis] += matrix[3, axis]
    total = weights[:, 0].copy()
    for column in weights.T[1:]:
        total += column
    moved *= total
    return moved.T


def _alike(matrices: Floats) -> bool:
    """Whether matrices differ by rounding alone."""
    with np.errstate(invalid="ignore"):
        size = np.abs(matrices[0]).max(initial=0.0)
        return bool((np.abs(matrices - matrices[0]) <= _ROUNDING * size).all())  # never NaN


def _linear_block(points: Floats, joints: Integers, weights: Floats, beside: Floats) -> Floats:
    """A block of points; beside: entry by entry of the matrices, of all joints, (4, 3, m)."""
    coordinates = np.ascontiguousarray(points.T)
    moved = np.zeros((3, len(points)))
    for column in range(joints.shape[1]):
        weight = weights[:, column]
        live = weight != 0
        if not live.any():
            continue
        some = slice(None) if live.all() else np.flatnonzero(live)
        of, share, mine = joints[some, column], weight[some], [each[some] for each in coordinates]
        for axis in range(3):
            part = mine[0] * beside[0, axis][of]
            part += mine[1] * beside[1, axis][of]
            part += mine[2] * beside[2, axis][of]
            part += beside[3, axis][of]
            moved[axis][some] += part * share
    return moved.T


def _dual_quaternion(points: Floats, matrices: Floats, joints: Integers, weights: Floats) -> Floats:
    """Dual-quaternion skinning: points stretched by each joint's scale, blended linearly, then
    moved by the blend of (rotation, translation) pairs.

    Source: Kavan 2007; UsdSkel, which adds the scale and blends on the side of the heaviest joint.
    """
    axes = nearest_rotation(matrices)
    rotation = from_axes(axes)
    stretch = multiply(_without_position(matrices), inverse(from_frame(axes, np.zeros(3))))
    moved = np.concatenate([matrices[..., 3, :3], np.zeros((*rotation.shape[:-1], 1))], axis=-1)
    dual = 0.5 * product(moved, rotation)
    heaviest = np.argmax(np.abs(weights), axis=1)
    pivot = rotation[:, joints[np.arange(len(joints)), heaviest]]
    real, other = np.zeros(pivot.shape), np.zeros(pivot.shape)
    stretched = np.zeros((*pivot.shape[:-1], 3))
    for k in range(joints.shape[1]):
        of, share = joints[:, k], weights[:, k, np.newaxis]
        stretched = stretched + share * transform_points(points, stretch[:, of])
        q = rotation[:, of]
        # q and −q are one rotation; on one side of the pivot they blend along the short way.
        share = share * np.where(dot(q, pivot)[..., np.newaxis] < 0, -1.0, 1.0)
        real = real + share * q
        other = other + share * dual[:, of]
    with np.errstate(divide="ignore", invalid="ignore"):
        size = norm(real)[..., np.newaxis]
        real, other = real / size, other / size
    return rotate(real, stretched) + 2.0 * product(other, conjugate(real))[..., :3]


def _without_position(matrices: Floats) -> Floats:
    """Matrices without their positions."""
    found = identity(*matrices.shape[:-2])
    found[..., :3, :3] = matrices[..., :3, :3]
    return found
