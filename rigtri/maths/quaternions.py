"""Rotations as unit quaternions xyzw, shape (..., 4); one and many are the same call.

Hamilton's product: ``multiply(a, b)`` rotates by ``b`` first, then by ``a``.
glTF stores xyzw; ``Gf.Quat`` shows w first and keeps the same numbers.

Source: glTF 2.0, appendix C (slerp); K. Shoemake, "Animating rotation with
quaternion curves", SIGGRAPH 1985; S. W. Shepperd, "Quaternion from rotation
matrix", J. Guidance and Control 1 (1978).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rigtri.maths import vectors
from rigtri.maths.ranking import axis_across
from rigtri.maths.trigonometry import Floats, arc_tangent, sin_cos, sine
from rigtri.maths.vectors import as_vectors, by_component, cross, length

# The public mathematics; the rest of the module serves rigtri alone.
__all__ = [
    "angle_between",
    "average",
    "between",
    "conjugate",
    "dot",
    "from_axes",
    "from_axis_angle",
    "make_continuous",
    "multiply",
    "norm",
    "normalise",
    "rotate",
    "rotation_angle",
    "slerp",
    "to_axes",
    "twist_angle",
    "unit",
]

IDENTITY: Floats = np.array([0.0, 0.0, 0.0, 1.0])
# Stored rotations this near to unit were meant to be unit; float32 leaves 1e-7.
NEARLY_UNIT = 1e-6
# Between rotations whose cosine lacks less than this of 1, 0.51°, OpenUSD's `GfSlerp` goes straight.
STRAIGHT = 1e-5
# A rotation whose part about an axis is shorter than this swings by 180°: it has no twist.
HALF_ROUND = 1e-9
# Of four times the square of each component: the signs of xx, yy and zz.
_DIAGONAL_SIGNS = np.array([[1.0, -1.0, -1.0, 1.0], [-1.0, 1.0, -1.0, 1.0], [-1.0, -1.0, 1.0, 1.0]])
# Of a 3×3 matrix's nine numbers xy, yz, zx and yx, zy, xz.
_ABOVE, _BELOW = np.array([1, 5, 6]), np.array([3, 7, 2])
# The turn times four of its x, y, z, w (columns): which of the four squares, three sums, three differences.
_TIMES_FOUR = np.array([[0, 4, 6, 8], [4, 1, 5, 9], [6, 5, 2, 7], [8, 9, 7, 3]])
# Each step squares what is left for turns about one axis, and divides it by 10 or so at 60° apart.
_MEAN_STEPS = 16
# So many quaternions stay in the cache, with what is made of them.
_BLOCK = 1 << 13


def as_quaternions(q: ArrayLike) -> Floats:
    """Anything array-like as float64, shape (..., 4); ValueError for another last axis."""
    array = np.asarray(q, dtype=np.float64)
    if array.shape[-1:] != (4,):
        raise ValueError(f"quaternions have four numbers, these have shape {array.shape}")
    return array


def multiply(a: ArrayLike, b: ArrayLike) -> Floats:
    """Products a·b, (..., 4): the rotation ``b`` followed by the rotation ``a``.

    Bilinear and norm-preserving, so values that are not quite unit, and cubic
    tangents, go through it unharmed.

    Source: Shoemake 1985: Hamilton's product.

    >>> multiply([0, 0, 1, 0], [0, 0, 1, 0]).tolist()  # two half turns about z
    [0.0, 0.0, 0.0, -1.0]
    """
    a, b = as_quaternions(a), as_quaternions(b)
    ax, ay, az, aw = a[..., 0], a[..., 1], a[..., 2], a[..., 3]
    bx, by, bz, bw = b[..., 0], b[..., 1], b[..., 2], b[..., 3]
    result = by_component(np.broadcast_shapes(a.shape, b.shape))
    result[..., 0] = aw * bx + ax * bw + ay * bz - az * by
    result[..., 1] = aw * by - ax * bz + ay * bw + az * bx
    result[..., 2] = aw * bz + ax * by - ay * bx + az * bw
    result[..., 3] = aw * bw - ax * bx - ay * by - az * bz
    return result


def quadruple(q: Floats) -> tuple[float, float, float, float]:
    """A quaternion, (4,), as four plain numbers."""
    x, y, z, w = q.tolist()
    return x, y, z, w


def conjugate(q: ArrayLike) -> Floats:
    """The inverse rotations, (..., 4), for unit quaternions.

    Source: Shoemake 1985: the inverse of a unit quaternion.

    >>> multiply(conjugate([0.6, 0, 0, 0.8]), [0.6, 0, 0, 0.8]).tolist()
    [0.0, 0.0, 0.0, 1.0]
    """
    return np.asarray(as_quaternions(q) * np.array([-1.0, -1.0, -1.0, 1.0]))


def half_turn(signs: ArrayLike) -> Floats:
    """The rotations, (..., 4), that reverse the axes whose signs, (..., 3), are −1: of each two, or none.

    Two are half a turn about the third, exactly.

    >>> half_turn([-1, 1, -1]).tolist()
    [0.0, 1.0, 0.0, 0.0]
    """
    signs = np.asarray(signs)
    turned = (signs < 0).any(axis=-1, keepdims=True)
    return np.concatenate([(signs > 0) & turned, ~turned], axis=-1).astype(np.float64)


def dot(a: ArrayLike, b: ArrayLike) -> Floats:
    """Dot products of quaternions, (..., 4) · (..., 4) → (...).

    Of unit ones the cosine of half the angle from one rotation to the other; negative where the
    two lie on opposite sides, so that the short way goes to −b.

    Source: glTF 2.0, appendix C.4: its sign chooses the shorter arc.

    >>> float(dot([0, 0, 0, 1], [0, 0, 1, 0]))
    0.0
    """
    products = as_quaternions(a) * as_quaternions(b)
    return products[..., 0] + products[..., 1] + products[..., 2] + products[..., 3]


def norm(q: ArrayLike) -> Floats:
    """Lengths of quaternions, (..., 4) → (...); 1 for a rotation.

    Source: Shoemake 1985.

    >>> float(norm([0, 3, 0, 4]))
    5.0
    """
    q = as_quaternions(q)
    return np.sqrt(
        q[..., 0] * q[..., 0] + q[..., 1] * q[..., 1] + q[..., 2] * q[..., 2] + q[..., 3] * q[..., 3]
    )


def off_unit(q: ArrayLike) -> float:
    """How far lengths of quaternions, (..., 4), are from 1 at most; what is no number does not count.

    >>> off_unit([[0, 0, 0, 1], [0, 3, 0, 4], [0, 0, 0, float("nan")]])
    4.0
    """
    rows, largest = np.asarray(q).reshape(-1, 4), 0.0
    for first in range(0, len(rows), _BLOCK):
        off = np.abs(norm(rows[first : first + _BLOCK]) - 1.0)
        if not np.isfinite(most := off.max()):
            most = off[np.isfinite(off)].max(initial=0.0)
        largest = max(largest, float(most))
    return largest


def unit(q: ArrayLike) -> Floats:
    """Quaternions of length 1, (..., 4); NaN for a zero quaternion, unlike `normalise`.

    Source: Shoemake 1985: rotations are unit quaternions.

    >>> unit([0, 3, 0, 4]).tolist()
    [0.0, 0.6, 0.0, 0.8]
    """
    q = as_quaternions(q)
    with np.errstate(divide="ignore", invalid="ignore"):
        return q / norm(q)[..., np.newaxis]


def normalise(q: ArrayLike) -> Floats:
    """Quaternions of length 1, (..., 4), as viewers show stored rotations; zero stays zero.

    Source: glTF 2.0 §3.5.3: rotations are unit quaternions.

    >>> normalise([0, 0, 0, 2]).tolist(), normalise([0, 0, 0, 0]).tolist()
    ([0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 0.0])
    """
    q = as_quaternions(q)
    size = norm(q)[..., np.newaxis]
    return np.asarray(q / np.where(size == 0, 1.0, size))


def normalise_for_storage(q: ArrayLike) -> Floats:
    """Rotations, (..., 4), ready to be written: of length 1 within [−1, 1] where they are nearly so.

    Farther than `NEARLY_UNIT` from length 1 they stay as they are: their length has a meaning.
    """
    q = as_quaternions(q)
    size = norm(q)[..., np.newaxis]
    meant = np.abs(size - 1.0) <= NEARLY_UNIT
    return np.where(meant, np.clip(q / np.where(meant, size, 1.0), -1.0, 1.0), q)


def rotates(q: ArrayLike) -> NDArray[np.bool_]:
    """Which quaternions, (..., 4), are not exactly the identity, (...)."""
    return np.asarray((as_quaternions(q) != IDENTITY).any(axis=-1))


def rotate(q: ArrayLike, v: ArrayLike) -> Floats:
    """Vectors ``v``, (..., 3), rotated by unit quaternions ``q``, (..., 4): (..., 3), as long as before.

    Source: Shoemake 1985: q·v·q⁻¹, multiplied out with two cross products.

    >>> rotate([0, 0, 1, 0], [1, 2, 3]).tolist()
    [-1.0, -2.0, 3.0]
    """
    q, v = as_quaternions(q), as_vectors(v)
    axis = q[..., :3]
    twice = 2.0 * cross(axis, v)
    return v + q[..., 3:] * twice + cross(axis, twice)


def to_axes(q: ArrayLike) -> Floats:
    """The X, Y and Z axes after rotation by unit quaternions, as rows, (..., 4) → (..., 3, 3).

    Source: Shoemake 1985: the matrix of a quaternion.

    >>> to_axes([0, 0, 1, 0]).tolist()  # a half turn about z
    [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    q = as_quaternions(q)
    x, y, z, w = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    twice = x + x, y + y, z + z
    xx, yy, zz = x * twice[0], y * twice[1], z * twice[2]
    xy, yz, zx = y * twice[0], z * twice[1], x * twice[2]
    wx, wy, wz = w * twice[0], w * twice[1], w * twice[2]
    rows = by_component((*q.shape[:-1], 3, 3), 2)
    # 0 + makes no difference but to the sign of a zero: `rotate` adds to axes with two zeros.
    rows[..., 0, 0], rows[..., 0, 1], rows[..., 0, 2] = 1.0 - (yy + zz), (0.0 + wz) + xy, (0.0 - wy) + zx
    rows[..., 1, 0], rows[..., 1, 1], rows[..., 1, 2] = (0.0 - wz) + xy, 1.0 - (zz + xx), (0.0 + wx) + yz
    rows[..., 2, 0], rows[..., 2, 1], rows[..., 2, 2] = (0.0 + wy) + zx, (0.0 - wx) + yz, 1.0 - (xx + yy)
    return rows


def from_axes(axes: ArrayLike) -> Floats:
    """The rotation that takes X, Y, Z onto the rows of a right-handed orthonormal frame.

    axes: shape (..., 3, 3), rows are unit vectors. Returns unit quaternions
    (..., 4) with w ≥ 0. A left-handed or skewed frame is a programmer's mistake
    and gives a meaningless rotation.

    Source: Shepperd 1978: the largest of the four squares is never below 1/4.

    >>> from_axes([[-1, 0, 0], [0, -1, 0], [0, 0, 1]]).tolist()
    [0.0, 0.0, 1.0, 0.0]
    """
    m = np.asarray(axes, dtype=np.float64)
    many = m.shape[:-2]
    # Numbers first, (9, ...): an operation on one of the nine is one on a line of memory.
    m = m.reshape(*many, 9).transpose(-1, *range(len(many)))
    xx, yy, zz = _DIAGONAL_SIGNS.reshape(3, 4, *(1 for _ in many)) * m[::4, np.newaxis]
    above, below = m[_ABOVE], m[_BELOW]
    numbers = np.concatenate([1 + xx + yy + zz, above + below, above - below])
    largest = numbers[:4].argmax(axis=0)  # the first of equals, NaN before all
    q = np.take_along_axis(numbers, _TIMES_FOUR[:, largest], axis=0)
    q = unit(q.transpose(*range(1, q.ndim), 0))
    return np.where(q[..., 3:] < 0, -q, q)


def from_axis_angle(axis: ArrayLike, angle: ArrayLike) -> Floats:
    """Rotations by ``angle`` radians, (...), about ``axis``, (..., 3), of any length but 0: (..., 4).

    Source: Shoemake 1985: the axis times the sine of half the angle, and its cosine.

    >>> from_axis_angle([0, 0, 2], np.pi / 2).round(6).tolist()
    [0.0, 0.0, 0.707107, 0.707107]
    """
    sine, cosine = sin_cos(np.asarray(angle, dtype=np.float64) / 2.0)
    xyz = vectors.normalise(axis) * sine[..., np.newaxis]
    result = by_component((*xyz.shape[:-1], 4))
    result[..., :3], result[..., 3] = xyz, cosine
    return result


def between(a: ArrayLike, b: ArrayLike) -> Floats:
    """The shortest rotations that take direction ``a`` to direction ``b``, (..., 3) → (..., 4).

    Opposite directions have no shortest one; they get a half turn about an
    axis perpendicular to ``a``. NaN where a direction is zero.

    Source: GDC 2018, slides "The Dot Product" and "The Cross Product", with the vector halfway.

    >>> rotate(between([1, 0, 0], [0, 0, 5]), [1, 0, 0]).round(12).tolist()
    [0.0, 0.0, 1.0]
    """
    a, b = vectors.normalise(a), vectors.normalise(b)
    a, b = np.broadcast_arrays(a, b)
    halfway = a + b
    if halfway.ndim == 1 and vectors.dot(halfway, halfway) >= 1e-24:  # the common case of one
        half = vectors.normalise(halfway)
        return np.array([*cross(a, half).tolist(), vectors.dot(a, half)])
    opposite = vectors.dot(halfway, halfway) < 1e-24  # 1e-12 rad from opposite: the cross product is noise
    # The unit axis least parallel to a: crossing with it never degenerates.
    aside = cross(a, axis_across(a))
    half = vectors.normalise(np.where(opposite[..., np.newaxis], aside, halfway))
    turn = np.concatenate([cross(a, half), vectors.dot(a, half)[..., np.newaxis]], axis=-1)
    flip = np.concatenate([half, np.zeros((*half.shape[:-1], 1))], axis=-1)
    return np.where(opposite[..., np.newaxis], flip, turn)


def rotation_angle(q: ArrayLike) -> Floats:
    """Angles of the rotations of unit quaternions, (..., 4) → (...), in radians, 0 to π.

    Source: GDC 2018, slide "The Dot Product": acos, here by arc tangent, of half the angle.

    >>> float(rotation_angle([0, 0, -1, 0]).round(12))
    3.14159265359
    """
    q = as_quaternions(q)
    return 2.0 * arc_tangent(length(q[..., :3]), np.abs(q[..., 3]))


def make_continuous(q: ArrayLike) -> Floats:
    """Rotations in a row, (k, 4), each with the sign that keeps it next to the one before.

    q and −q are one rotation; between keys of opposite signs a player would go the long way round.

    Source: glTF 2.0, appendix C.4: the shorter arc.

    >>> make_continuous([[0, 0, 0, 1], [0, 0, 0, -1]]).tolist()
    [[0.0, 0.0, 0.0, 1.0], [-0.0, -0.0, -0.0, 1.0]]
    """
    q = as_quaternions(q)
    signs = np.cumprod(np.concatenate([[1.0], np.where(dot(q[1:], q[:-1]) < 0, -1.0, 1.0)]))
    return np.asarray(q * signs[:, np.newaxis])


def angle_between(a: ArrayLike, b: ArrayLike) -> Floats:
    """How far unit quaternions are apart, (..., 4), (..., 4) → (...), in radians, 0 to π.

    Source: GDC 2018, slide "The Dot Product": acos, here by arc tangent, of half the angle.

    >>> float(np.degrees(angle_between([0, 0, 0, 1], [0, 0, 1, 0])).round(6))
    180.0
    """
    return rotation_angle(multiply(conjugate(a), b))


def twist_angle(q: ArrayLike, axis: ArrayLike) -> Floats:
    """How far unit quaternions, (..., 4), twist about a unit axis, (..., 3): (...), in radians, −π to π.

    A rotation is ``multiply(swing, twist)``: first the twist about the axis, which leaves the axis where
    it is, then the swing, which takes the axis to where q takes it. 0 for rotations that swing by 180°,
    where every twist would do.

    Source: P. Dobrowolski, "Swing-twist decomposition in Clifford algebra", 2015.

    >>> q = multiply(from_axis_angle([0, 1, 0], 1.0), from_axis_angle([1, 0, 0], 0.5))
    >>> float(twist_angle(q, [1.0, 0.0, 0.0]).round(12))
    0.5
    """
    q = as_quaternions(q)
    along, w = vectors.dot(q[..., :3], axis), q[..., 3]
    # q and −q are one rotation: the one with w ≥ 0 has the shorter angle.
    sign = np.where(w < 0, -1.0, 1.0)
    angle = 2.0 * arc_tangent(along * sign, w * sign)
    return np.where(along * along + w * w < HALF_ROUND * HALF_ROUND, 0.0, angle)


def slerp(a: ArrayLike, b: ArrayLike, share: ArrayLike) -> Floats:
    """Rotations on the shorter arc from ``a`` to ``b``, (..., 4); ``share``, (...), from 0 to 1.

    The result is unit where ``a`` and ``b`` are.

    Source: glTF 2.0, appendix C.4.

    >>> slerp([0, 0, 0, 1], [0, 0, 1, 0], 0.5).round(6).tolist()
    [0.0, 0.0, 0.707107, 0.707107]
    """
    a, b = as_quaternions(a), as_quaternions(b)
    share = np.asarray(share, dtype=np.float64)
    b, total = _shorter(a, b)
    sines = sine((1.0 - share) * total), sine(share * total)
    return _along(a, b, share, sine(total), sines)


def slerp_rows(a: Floats, b: Floats, rows: NDArray[np.int64], share: Floats) -> Floats:
    """``slerp(a[rows], b[rows], share)`` to the bit, (f, t, 4), with what is alike of each arc found once.

    a, b: (k, t, 4). rows, share: (f,).
    """
    b, total = _shorter(a, b)
    # Turns before times, which then lie side by side in memory, as in a, b and what is given.
    whole, totals = (np.take(angles.T, rows, axis=1) for angles in (sine(total), total))
    here, there = share == 0, share == 1
    inside = np.flatnonzero(~here & ~there)
    part, some = share[inside], totals[:, inside]
    from_a, from_b = np.where(here, whole, 0.0), np.where(there, whole, 0.0)
    from_a[:, inside], from_b[:, inside] = sine((1.0 - part) * some), sine(part * some)
    start, end = (np.take(turns.transpose(), rows, axis=2).transpose() for turns in (a, b))
    return _along(start, end, share[:, np.newaxis], whole.T, (from_a.T, from_b.T))


def gf_slerp(a: Floats, b: Floats, share: Floats) -> Floats:
    """What OpenUSD has between two samples of an array of `quatf`, (n, 4); ``share``, (n,), from 0 to 1.

    The angle is that of the numbers as they are, whatever their length, and the result keeps the length that
    comes of it. Near each other they are on a straight line.

    Source: OpenUSD, pxr/base/gf/quatf.cpp, `GfSlerp`, whose dot product is in single precision.

    >>> gf_slerp(np.eye(4)[3:], np.array([[0.0, 0.0, 0.0, 0.98]]), np.array([0.5])).round(6).tolist()
    [[0.0, 0.0, 0.0, 0.994987]]
    """
    x, y, z, w = (a.astype(np.float32) * b.astype(np.float32)).T
    cosine = (x + y + z + w).astype(np.float64)
    sign, cosine = np.where(cosine < 0.0, -1.0, 1.0), np.abs(cosine)
    from_a, from_b = 1.0 - share, share.copy()
    far = np.flatnonzero(1.0 - cosine > STRAIGHT)
    cosine, some = cosine[far], share[far]
    whole = np.sqrt((1.0 - cosine) * (1.0 + cosine))
    angle = arc_tangent(whole, cosine)
    from_a[far], from_b[far] = sine((1.0 - some) * angle) / whole, sine(some * angle) / whole
    return np.asarray(a * from_a[:, np.newaxis] + b * (sign * from_b)[:, np.newaxis])


def _shorter(a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """``b`` or its opposite, the same turn, whichever is nearer to ``a``; the angle to it."""
    cosine = dot(a, b)
    if (cosine < 0).any():
        b = np.where(cosine[..., np.newaxis] < 0, -b, b)
    return b, 2.0 * arc_tangent(norm(b - a), norm(a + b))


def _along(a: Floats, b: Floats, share: Floats, whole: Floats, sines: tuple[Floats, Floats]) -> Floats:
    """A share of the way from ``a`` to ``b``: ``sines`` of the angles to both, ``whole`` of all."""
    from_a, from_b = sines
    close = whole < 1e-12  # the same turn twice: a straight line is exact to the last bit
    scale = 1.0 / np.where(close, 1.0, whole)
    weight_a = np.where(close, 1.0 - share, from_a * scale)
    weight_b = np.where(close, share, from_b * scale)
    return np.asarray(a * weight_a[..., np.newaxis] + b * weight_b[..., np.newaxis])


def average(q: ArrayLike, weights: ArrayLike) -> Floats:
    """The weighted mean of rotations, (..., d, 4), weights (..., d) ≥ 0 → (..., 4); NaN where all weigh 0.

    The mean on the sphere of rotations: from it the weighted rotations to all others cancel. Of two
    it is `slerp`, with the weights as shares of the angle. The order does not matter while all
    lie within a right angle of each other; farther apart there may be several means, and the one
    near the heaviest is taken.

    Source: X. Pennec, "Computing the mean of geometric features", 1998 (gradient descent).

    >>> average([[0, 0, 0, 1], [0, 0, 1, 0]], [1, 1]).round(6).tolist()
    [0.0, 0.0, 0.707107, 0.707107]
    """
    q, weights = as_quaternions(q), np.asarray(weights, dtype=np.float64)
    count = q.shape[-2]
    total = weights[..., 0]
    for k in range(1, count):
        total = total + weights[..., k]
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = weights / total[..., np.newaxis]
    heaviest = np.argmax(np.broadcast_to(shares, q.shape[:-1]), axis=-1)[..., np.newaxis, np.newaxis]
    mean = unit(np.take_along_axis(q, heaviest, axis=-2)[..., 0, :])
    if count == 1:
        return np.where((total > 0)[..., np.newaxis], mean, np.nan)
    for _ in range(_MEAN_STEPS):
        step = np.zeros((*mean.shape[:-1], 3))
        for k in range(count):
            turn = multiply(conjugate(mean), q[..., k, :])
            turn = np.where(turn[..., 3:] < 0, -turn, turn)
            size = length(turn[..., :3])
            half = arc_tangent(size, turn[..., 3]) / np.where(size == 0, 1.0, size)
            step = step + (shares[..., k] * half)[..., np.newaxis] * turn[..., :3]
        size = length(step)
        sine, cosine = sin_cos(size)
        xyz = step * (sine / np.where(size == 0, 1.0, size))[..., np.newaxis]
        mean = unit(multiply(mean, np.concatenate([xyz, cosine[..., np.newaxis]], axis=-1)))
    return mean
