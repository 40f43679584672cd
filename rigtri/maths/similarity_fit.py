"""The similarity transform (rotation, uniform scale, translation) that fits points onto others."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations, product

import numpy as np
from numpy.typing import ArrayLike

from rigtri.maths.matrices import (
    determinant,
    from_frame,
    inverse,
    multiply,
    transform_directions,
    transform_points,
)
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, length, normalise

# What float32 matrices that a DCC has inverted and multiplied leave: radians, and a share of a size.
SAME_TURN = 1e-4
SAME_SIZE = 1e-4
SAME_PLACE = 1e-5
# Skeletons whose joints lie farther apart, as a share of their size, have other proportions.
OTHER_SHAPE = 1e-3
# Worlds whose sizes differ by less have one unit: a pose makes that much of a difference.
ONE_UNIT = 1.25


def _axis_turns() -> Floats:
    """The 24 rotations that take axes onto axes, the identity first, (24, 3, 3)."""
    found = []
    for order in permutations(range(3)):
        for signs in product((1.0, -1.0), repeat=3):
            axes = np.zeros((3, 3))
            axes[[0, 1, 2], order] = signs
            if determinant(from_frame(axes, np.zeros(3))) > 0:
                found.append(axes)
    return np.array(found)


AXIS_TURNS = _axis_turns()


# Another rotation of the 24 than the identity is taken where it leaves less than this of what the identity
# leaves: joints in other poses are a little nearer to some other rotation by chance.
_CLEARLY = 0.5


def nearest_axis_turn(turns: Floats) -> Floats:
    """The one of the 24 rotations, (3, 3), that most of ``turns``, (k, 3, 3), are nearest to.

    By the median of angles: joints may be in any pose. The identity, unless another is clearly nearer.
    """
    if not len(turns):
        return np.asarray(AXIS_TURNS[0])
    products = (turns[:, np.newaxis] * AXIS_TURNS).reshape(len(turns), len(AXIS_TURNS), 9)
    # 3 - trace, which grows with the angle.
    off = np.median(3.0 - products.cumsum(axis=-1)[..., -1], axis=0)
    best = int(off.argmin())
    return np.asarray(AXIS_TURNS[best if off[best] < _CLEARLY * off[0] else 0])


def snapped_turn(turn: Floats) -> Floats:
    """The one of the 24 rotations that a rotation, (3, 3), is but for rounding; else that itself."""
    apart = np.abs(AXIS_TURNS - turn).max(axis=(1, 2))
    nearest = int(apart.argmin())
    return np.asarray(AXIS_TURNS[nearest] if apart[nearest] <= SAME_TURN else turn)


def upright_turn(theirs: ArrayLike, ours: ArrayLike) -> Floats:
    """The smallest of the 24 rotations, (3, 3), that takes one up axis, (3,), to another; else the identity.

    >>> upright_turn([0.0, 0.0, 1.0], [0.0, 1.0, 0.0])[2]
    array([0., 1., 0.])
    """
    up = transform_directions(np.asarray(theirs), from_frame(AXIS_TURNS, np.zeros((len(AXIS_TURNS), 3))))
    diagonals = AXIS_TURNS.reshape(len(AXIS_TURNS), 9)[:, ::4]
    traces = diagonals.cumsum(axis=-1)[:, -1]
    return np.asarray(AXIS_TURNS[np.where((up == np.asarray(ours)).all(axis=1), traces, -4.0).argmax()])


@dataclass(frozen=True, eq=False)
class Similarity:
    """A similarity transform, (4, 4); residual: what is left between the points, as a share of their size."""

    matrix: Floats
    residual: float


def fit_similarity(
    theirs: Floats,
    ours: Floats,
    *,
    about_origin: bool,
    ratio: float | None = None,
    turn: Floats | None = None,
) -> Similarity:
    """The transform that takes points ``theirs``, (k, 3), onto ``ours``, (k, 3).

    The identity where it fits, else one of the 24 rotations that take axes onto axes, or, where none of
    these does, one by three points. about_origin: the origin stays where it is. ratio: the scale, where it
    is known; it is 1 where it is nearly that, without it and about the origin up to `ONE_UNIT`. turn: the
    rotation, (3, 3), where it is known.
    """
    # About the centroids: where the points are must not count as a rotation.
    middle = np.array([_mean(theirs), _mean(ours)]) if len(ours) > 1 else np.zeros((2, 3))
    a, b = theirs - middle[0], ours - middle[1]
    sizes = [_spread(a), _spread(b)]
    near = ONE_UNIT if about_origin and ratio is None else 1.0 + SAME_SIZE
    if ratio is None:
        ratio = sizes[1] / sizes[0] if sizes[0] > 0 and sizes[1] > 0 else 1.0
    if 1.0 / near <= ratio <= near:
        ratio = 1.0
    size = sizes[1] or 1.0
    turns, chosen = AXIS_TURNS if turn is None else turn[np.newaxis], 0
    off = [_spread(transform_points(a * ratio, from_frame(axes, np.zeros(3))) - b) / size for axes in turns]
    for number, each in enumerate(off):
        # Of equals the first, which is the identity: points on a line define no rotation about it.
        clearly = _CLEARLY if about_origin and chosen == 0 else 0.99
        chosen = number if each < clearly * off[chosen] - SAME_PLACE else chosen
    best, least = turns[chosen], off[chosen]
    if least > OTHER_SHAPE and not about_origin and turn is None:
        axes = _three_point_turn(a, b)
        free = _spread(transform_points(a * ratio, from_frame(axes, np.zeros(3))) - b) / size
        if free < 0.1 * least:
            best, least = axes, free
    matrix = from_frame(best * ratio, np.zeros(3))
    if not about_origin:
        matrix[3, :3] = middle[1] - transform_points(middle[0], matrix)
    if np.abs(matrix[3, :3]).max() <= SAME_PLACE * size:
        matrix[3, :3] = 0.0
    return Similarity(matrix, float(least))


def _three_point_turn(theirs: Floats, ours: Floats) -> Floats:
    """The rotation, (3, 3), that lays the farthest of points and the one most aside onto others."""
    far = int(np.argmax(length(ours)))
    aside = int(np.argmax(length(cross(ours[far], ours))))
    frames = []
    for points in (theirs, ours):
        x = normalise(points[far])
        z = normalise(cross(x, points[aside]))
        frames.append(from_frame(np.stack([x, cross(z, x), z]), np.zeros(3)))
    return np.asarray(multiply(inverse(frames[0]), frames[1])[:3, :3])


def _mean(points: Floats) -> Floats:
    return np.asarray(_total(points) / max(len(points), 1))


def _spread(points: Floats) -> float:
    """The root of the mean square of lengths, (k, 3)."""
    return float(np.sqrt(_total(np.ravel(points * points)) / max(len(points), 1)))


def _total(values: Floats) -> Floats:
    """The sum over the first axis, added one by one: the same bits everywhere; 0 where there are none."""
    return np.asarray(values.cumsum(axis=0)[-1] if len(values) else np.zeros(values.shape[1:]))
