"""Sine, cosine, arc tangent and exponential from + − × ÷ √ alone.

The C library's versions differ in the last bit between platforms and numpy
builds (its SIMD kernels too). What rigtri writes must be the same bytes
everywhere, so whatever can reach a file goes through these.

Source: Taylor series after argument reduction; the truncation error of each is
stated beside its terms.
"""

from __future__ import annotations

from math import factorial, sqrt
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

# pi/2 in two parts: n·HIGH is exact for |n| < 2**20, LOW carries the rest.
_HALF_PI_HIGH = 1.5707963267341256
_HALF_PI_LOW = 6.077100506506192e-11
_HALF_PI = 1.5707963267948966

_SINE = tuple(1.0 / factorial(2 * k + 1) for k in range(9))
_COSINE = tuple(1.0 / factorial(2 * k) for k in range(10))
# ln 2 in two parts: n·HIGH is exact for |n| < 2**11, LOW carries the rest.
_LN_2_HIGH = 0.693147180369123816490
_LN_2_LOW = 1.90821492927058770002e-10
_LN_2 = 0.6931471805599453
_EXPONENTIAL = tuple((-1) ** k / factorial(k) for k in range(16))
_ARC_TANGENT = tuple(1.0 / (2 * k + 1) for k in range(12))


def sin_cos(angle: ArrayLike) -> tuple[Floats, Floats]:
    """Sine and cosine of angles, shape (...), in radians; NaN and inf give NaN.

    Within 4e-16 for |angle| < 1e6 (the two-part pi/2 is exact up to there).

    >>> s, c = sin_cos([0.0, 1.0])
    >>> s.round(12).tolist(), c.round(12).tolist()
    ([0.0, 0.841470984808], [1.0, 0.540302305868])
    """
    rest, quarters = _quartered(np.asarray(angle, dtype=np.float64))
    turn, square = _last_turn(quarters), rest * rest
    # |rest| <= pi/4: the first omitted terms are below 1e-19 and 1e-18.
    sine = rest * _series(square, _SINE)
    cosine = _series(square, _COSINE)
    odd = (turn == 1) | (turn == 3)
    s = np.where(odd, cosine, sine)
    c = np.where(odd, sine, cosine)
    return np.where(turn >= 2, -s, s), np.where((turn == 1) | (turn == 2), -c, c)


def sine(angle: ArrayLike) -> Floats:
    """The sine of `sin_cos` alone, the same to the bit.

    >>> float(sine(1.0).round(12))
    0.841470984808
    """
    rest, quarters = _quartered(np.asarray(angle, dtype=np.float64))
    square = rest * rest
    found = rest * _series(square, _SINE)
    if not quarters.any():  # up to an eighth of a circle; NaN is any
        return np.asarray(found)
    turn = _last_turn(quarters)
    odd = (turn == 1) | (turn == 3)
    s = np.where(odd, _series(square, _COSINE), found)
    return np.where(turn >= 2, -s, s)


def _quartered(x: Floats) -> tuple[Floats, Floats]:
    """What is left of angles without whole quarters, and how many of these they have."""
    with np.errstate(invalid="ignore"):
        quarters = np.rint(x / _HALF_PI)
        return (x - quarters * _HALF_PI_HIGH) - quarters * _HALF_PI_LOW, quarters


def _last_turn(quarters: Floats) -> Floats:
    """How many of some quarters are no whole turn, 0 to 3."""
    with np.errstate(invalid="ignore"):
        return np.asarray(np.mod(quarters, 4.0))


def arc_tangent(y: ArrayLike, x: ArrayLike) -> Floats:
    """The angle of the point (x, y), shape (...), in radians from −π to π; 0 at the origin.

    >>> arc_tangent([1.0, 0.0], [1.0, -1.0]).round(12).tolist()
    [0.785398163397, 3.14159265359]
    """
    if isinstance(y, float) and isinstance(x, float):
        return cast(Floats, np.float64(_arc_tangent_of(y, x)))
    y, x = np.broadcast_arrays(np.asarray(y, dtype=np.float64), np.asarray(x, dtype=np.float64))
    across, along = np.abs(y), np.abs(x)
    steep = across > along
    small, large = np.where(steep, along, across), np.where(steep, across, along)
    ratio = small / np.where(large == 0, 1.0, large)
    # Two half angles bring the ratio to at most tan(pi/16) = 0.199.
    for _ in range(2):
        ratio = ratio / (1.0 + np.sqrt(1.0 + ratio * ratio))
    # The first omitted term is 0.199**25 / 25 < 2e-19.
    angle = 4.0 * ratio * _series(ratio * ratio, _ARC_TANGENT)
    angle = np.where(steep, _HALF_PI - angle, angle)
    angle = np.where(x < 0, 2.0 * _HALF_PI - angle, angle)
    return np.asarray(np.where(y < 0, -angle, angle))


def _arc_tangent_of(y: float, x: float) -> float:
    """`arc_tangent` of one point in Python's numbers, which are far faster for one.

    The same operations in the same order, so the same bits.
    """
    y, x = float(y), float(x)
    across, along = abs(y), abs(x)
    steep = across > along
    small, large = (along, across) if steep else (across, along)
    ratio = small / (large or 1.0)
    for _ in range(2):
        ratio = ratio / (1.0 + sqrt(1.0 + ratio * ratio))
    square, total = ratio * ratio, _ARC_TANGENT[-1]
    for term in _ARC_TANGENT[-2::-1]:
        total = term - square * total
    angle = 4.0 * ratio * total
    angle = _HALF_PI - angle if steep else angle
    angle = 2.0 * _HALF_PI - angle if x < 0 else angle
    return -angle if y < 0 else angle


def exponential(x: ArrayLike) -> Floats:
    """e to the power of numbers up to 0, shape (...); larger ones count as 0.

    Within 4e-16 of the result; 0 below −700.

    >>> exponential([-1.0, 0.0]).round(12).tolist()
    [0.367879441171, 1.0]
    """
    x = np.clip(np.asarray(x, dtype=np.float64), -700.0, 0.0)
    halvings = np.rint(x / _LN_2)
    rest = (x - halvings * _LN_2_HIGH) - halvings * _LN_2_LOW
    # |rest| <= ln(2)/2: the first omitted term is below 1e-20.
    power = np.ldexp(_series(rest, _EXPONENTIAL), halvings.astype(np.int64))
    return np.asarray(np.where(x <= -700.0, 0.0, power))


def cube_root(x: ArrayLike) -> Floats:
    """The cube root of numbers, by Newton's iteration.

    >>> cube_root([8.0, -0.125, 0.0]).tolist()
    [2.0, -0.5, 0.0]
    """
    x = np.asarray(x, dtype=np.float64)
    size = np.where(x == 0, 1.0, np.abs(x))
    root = np.maximum(size, 1.0)  # from above it falls, until rounding ends that
    while ((lower := (2.0 * root + size / (root * root)) / 3.0) < root).any():
        root = np.where(lower < root, lower, root)
    return np.where(x == 0, 0.0, np.where(x < 0, -root, root))


def _series(square: Floats, terms: tuple[float, ...]) -> Floats:
    """Alternating series in ``square`` by Horner's rule."""
    total = np.full_like(square, terms[-1])
    for term in terms[-2::-1]:
        np.multiply(square, total, out=total)
        np.subtract(term, total, out=total)
    return total
