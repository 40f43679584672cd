"""Vectors: directions and positions, shape (..., 3); one and many are the same call.

Everything here is elementwise, so that the same input gives the same bits on
every machine (no BLAS, no reduction whose order numpy may choose).

Source: R. Katz, "Rigging with Triangles", GDC 2018, slides "Vectors" to "The
Cross Product" and the appendices.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from rigtri.maths.trigonometry import Floats, arc_tangent

# The public mathematics; the rest of the module serves rigtri alone.
__all__ = [
    "angle",
    "cross",
    "distance",
    "dot",
    "length",
    "normalise",
    "perpendicular",
    "project",
]


def as_vectors(v: ArrayLike) -> Floats:
    """Anything array-like as float64, shape (..., 3); ValueError for another last axis."""
    if type(v) is np.ndarray and v.dtype == np.float64 and v.shape[-1:] == (3,):
        return v  # the common case, thousands of times in a run
    array = np.asarray(v, dtype=np.float64)
    if array.shape[-1:] != (3,):
        raise ValueError(f"vectors have three numbers, these have shape {array.shape}")
    return array


def by_component(shape: tuple[int, ...], kept: int = 1) -> Floats:
    """An array of a shape, not filled, whose last ``kept`` axes are the slowest in memory.

    So each component of many vectors, turns or matrices lies in one row, which is what elementwise
    work on components wants; numpy's own operations keep the order of what they are given.
    """
    if len(shape) <= kept:
        return np.empty(shape)
    many = len(shape) - kept
    found: Floats = np.empty((*shape[many:], *shape[:many]))
    return found.transpose((*range(kept, len(shape)), *range(kept)))


def dot(a: ArrayLike, b: ArrayLike) -> Floats:
    """Dot products, (..., 3) · (..., 3) → (...).

    For normalised vectors: 1 in the same direction, 0 perpendicular, −1 opposite.

    Source: GDC 2018, slide "The Dot Product".

    >>> float(dot([1, 2, 3], [4, 5, 6]))
    32.0
    """
    a, b = as_vectors(a), as_vectors(b)
    if a.ndim == b.ndim == 1:
        (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()  # as in `unit_of`
        return cast(Floats, np.float64(ax * bx + ay * by + az * bz))
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def cross(a: ArrayLike, b: ArrayLike) -> Floats:
    """Cross products, (..., 3) × (..., 3) → (..., 3): perpendicular to both, right-handed.

    Source: GDC 2018, slide "The Cross Product, Definition".

    >>> cross([1, 0, 0], [0, 1, 0]).tolist()
    [0.0, 0.0, 1.0]
    """
    a, b = as_vectors(a), as_vectors(b)
    if a.ndim == b.ndim == 1:
        (x, y, z), (u, v, w) = a.tolist(), b.tolist()  # as in `unit_of`
        return np.array([y * w - z * v, z * u - x * w, x * v - y * u])
    result = by_component(a.shape if a.shape == b.shape else np.broadcast_shapes(a.shape, b.shape))
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    result[..., 0] = ay * bz - az * by
    result[..., 1] = az * bx - ax * bz
    result[..., 2] = ax * by - ay * bx
    return result


def length(v: ArrayLike) -> Floats:
    """Lengths, (..., 3) → (...), in the unit of the vectors.

    Source: GDC 2018, slide "Vector Length".

    >>> float(length([2, 3, 6]))
    7.0
    """
    return np.sqrt(dot(v, v))


def distance(a: ArrayLike, b: ArrayLike) -> Floats:
    """Distances between points, (..., 3), (..., 3) → (...).

    Source: GDC 2018, slide "Distance between two Vectors".

    >>> float(distance([1, 1, 1], [1, 4, 5]))
    5.0
    """
    return length(as_vectors(b) - as_vectors(a))


def normalise(v: ArrayLike) -> Floats:
    """Vectors of length 1 in the same directions, (..., 3) → (..., 3); NaN for a zero vector.

    Scaled by the largest component first, so that neither 1e-200 nor 1e200 is lost.

    Source: GDC 2018, slide "Vectors, Normalize".

    >>> normalise([0, 3, 4]).tolist()
    [0.0, 0.6, 0.8]
    """
    v = as_vectors(v)
    if v.ndim == 1:
        one = unit_of(v.tolist())
        return np.array(one) if one is not None else np.full(3, np.nan)
    x, y, z = v[..., 0], v[..., 1], v[..., 2]
    largest = np.maximum(np.maximum(np.abs(x), np.abs(y)), np.abs(z))
    with np.errstate(divide="ignore", invalid="ignore"):
        x, y, z = x / largest, y / largest, z / largest
        size = np.sqrt(x * x + y * y + z * z)
        result = by_component(v.shape)
        result[..., 0], result[..., 1], result[..., 2] = x / size, y / size, z / size
    return result


def unit_of(numbers: Sequence[float]) -> list[float] | None:
    """`normalise` of one vector in Python's numbers, which are far faster for one; None for its NaN.

    The same operations in the same order, so the same bits.
    """
    x, y, z = numbers
    largest = max(x, y, z, -x, -y, -z)
    if not largest > 0.0:
        return None
    x, y, z = x / largest, y / largest, z / largest
    size = sqrt(x * x + y * y + z * z)
    # Infinity and NaN have become NaN, which is not equal to itself.
    return [x / size, y / size, z / size] if size == size else None


def triple(v: Floats) -> tuple[float, float, float]:
    """A vector, (3,), as three plain numbers."""
    x, y, z = v.tolist()
    return x, y, z


def project(point: ArrayLike, start: ArrayLike, end: ArrayLike) -> Floats:
    """The point of the line through ``start`` and ``end`` nearest to ``point``, (..., 3).

    NaN where ``start`` and ``end`` coincide.

    Source: GDC 2018, slide "Pole Vector" (the point P along AC).

    >>> project([3, 4, 0], [0, 0, 0], [6, 0, 0]).tolist()
    [3.0, 0.0, 0.0]
    """
    point, start, end = as_vectors(point), as_vectors(start), as_vectors(end)
    line = end - start
    with np.errstate(divide="ignore", invalid="ignore"):
        along = dot(point - start, line) / dot(line, line)
        return start + line * along[..., np.newaxis]


def perpendicular(v: ArrayLike, to: ArrayLike) -> Floats:
    """The part of ``v`` at a right angle to ``to``, (..., 3); ``v`` itself where ``to`` is zero.

    Source: GDC 2018, slide "Pole Vector": the elbow minus its projection.

    >>> perpendicular([3, 4, 0], [1, 0, 0]).tolist()
    [0.0, 4.0, 0.0]
    """
    v, to = as_vectors(v), as_vectors(to)
    square = dot(to, to)
    share = dot(v, to) / np.where(square == 0, 1.0, square)
    return v - to * share[..., np.newaxis]


def angle(a: ArrayLike, b: ArrayLike) -> Floats:
    """Angles between vectors, (..., 3), (..., 3) → (...), in radians, 0 to π; 0 where one has no length.

    Lengths need not be alike; their product has to be above 1e-300.

    By arc tangent of cross over dot: near 0 and π the talk's arc cosine of the
    dot product loses half the digits (1e-8 rad), this loses none.

    Source: GDC 2018, slide "The Dot Product" (acos(v1 dot v2)).

    >>> float(np.degrees(angle([1, 0, 0], [0, 5, 0])).round(6))
    90.0
    """
    return arc_tangent(length(cross(a, b)), dot(a, b))
