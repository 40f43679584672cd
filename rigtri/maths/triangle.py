"""Three points make a triangle; a triangle makes a frame, a bend plane, a pole vector.

The one idea of the system. A, B, C are the root, middle and end of a limb
(shoulder, elbow, wrist), or the node that aims, what it aims at, and its up.
Points have shape (..., 3), in file units; one limb and many are the same call.

Source: R. Katz, "Rigging with Triangles", GDC 2018, slides "Aiming node A at
node B" and "Pole Vector"; "Using Vector Math to Rig an Arm" (article).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from rigtri.maths import PoleMethod, PoleOrigin, ReachOf
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import (
    angle,
    as_vectors,
    cross,
    distance,
    dot,
    length,
    normalise,
    perpendicular,
    project,
)

# The public mathematics; the rest of the module serves rigtri alone.
__all__ = [
    "axis_of",
    "barycentric",
    "bend_angle",
    "bend_direction",
    "bend_sine",
    "frame",
    "hinge",
    "limb_length",
    "pole_position",
]

# Below this sine three points lie on one line: what is left of the normal is rounding.
DEGENERATE_SINE = 1e-6
# Below this sine a limb is nearly straight: float32 files hold its plane to a degree or worse.
STRAIGHT_SINE = 1e-2


def axis_of(name: str) -> tuple[int, float]:
    """The index and sign of an axis name: ``x``, ``+x`` or ``-x`` and so on.

    ValueError for anything else.

    >>> axis_of("-z")
    (2, -1.0)
    """
    letter = name[-1:].lower()
    if name[:-1] not in ("", "+", "-") or letter not in ("x", "y", "z"):
        raise ValueError(f"'{name}' is not a valid axis: use x, y, z, -x, -y or -z")
    return "xyz".index(letter), -1.0 if name[0] == "-" else 1.0


def frame(aim: ArrayLike, up: ArrayLike, *, aim_axis: str = "x", up_axis: str = "y") -> Floats:
    """Right-handed axes (rows), (..., 3, 3): one points along ``aim``, one as near as it can to ``up``.

    aim, up: directions, (..., 3), of any length. ``aim_axis`` and ``up_axis``
    say which axis goes where, e.g. ``x`` and ``-y``: 24 pairs, determinant +1
    for each. NaN where ``aim`` and ``up`` are parallel or one of them is zero.
    ValueError when both name the same letter.

    Source: GDC 2018, slide "Aiming node A at node B": aim_Z = aim × up,
    aim_Y = aim_Z × aim.

    >>> frame([0, 0, 2], [0, 1, 1]).tolist()
    [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]
    """
    (a, a_sign), (u, u_sign) = axis_of(aim_axis), axis_of(up_axis)
    if a == u:
        raise ValueError(f"aim axis {aim_axis} and up axis {up_axis} are the same letter")
    first = normalise(aim)
    second = normalise(perpendicular(up, first))
    first, second = np.broadcast_arrays(first * a_sign, second * u_sign)
    third = 3 - a - u
    handed = 1.0 if (a, u) in ((0, 1), (1, 2), (2, 0)) else -1.0
    axes = np.empty((*first.shape[:-1], 3, 3))
    axes[..., a, :], axes[..., u, :] = first, second
    axes[..., third, :] = cross(first, second) * handed
    return axes


def hinge(start: ArrayLike, middle: ArrayLike, end: ArrayLike) -> Floats:
    """The unit normal n = AB × BC of limbs, (..., 3): a positive turn about it flexes.

    NaN where the points lie on one line (`bend_sine` below 1e-6).

    Source: "Using Vector Math to Rig an Arm", shdYAxis; glossary in docs/conventions.md.

    >>> hinge([0, 0, 0], [1, 1, 0], [2, 0, 0]).tolist()
    [0.0, 0.0, -1.0]
    """
    a, b, c = as_vectors(start), as_vectors(middle), as_vectors(end)
    clear = (bend_sine(a, b, c) >= DEGENERATE_SINE)[..., np.newaxis]
    return np.where(clear, normalise(cross(b - a, c - b)), np.nan)


def bend_sine(start: ArrayLike, middle: ArrayLike, end: ArrayLike) -> Floats:
    """|sin| of the bend at the middle of limbs, (...): 0 where straight, or where points coincide.

    Source: GDC 2018, slide "The Cross Product".

    >>> float(bend_sine([0, 0, 0], [1, 0, 0], [1, 1, 0])), float(bend_sine([0, 0, 0], [1, 0, 0], [2, 0, 0]))
    (1.0, 0.0)
    """
    a, b, c = as_vectors(start), as_vectors(middle), as_vectors(end)
    with np.errstate(invalid="ignore"):
        sine = length(cross(normalise(b - a), normalise(c - b)))
    return np.where(np.isnan(sine), 0.0, sine)


def bend_angle(start: ArrayLike, middle: ArrayLike, end: ArrayLike) -> Floats:
    """How far limbs bend at the middle, (...), in radians: 0 for a straight limb, π folded back.

    0 where points coincide, as `bend_sine` says.

    Source: GDC 2018, slide "The Dot Product": acos(v1 dot v2).

    >>> float(np.degrees(bend_angle([0, 0, 0], [1, 0, 0], [1, 1, 0])).round(6))
    90.0
    """
    a, b, c = as_vectors(start), as_vectors(middle), as_vectors(end)
    return angle(b - a, c - b)


def bend_direction(
    start: ArrayLike,
    middle: ArrayLike,
    end: ArrayLike,
    *,
    method: PoleMethod = "perpendicular",
) -> Floats:
    """The unit direction that limbs bend to: from a point P of AC to B, (..., 3).

    ``perpendicular`` takes the point of AC nearest to B (the talk), ``ratio``
    divides AC as AB and BC divide the limb (the article); the two differ when
    the halves differ in length. NaN where the limb is straight.

    Source: GDC 2018, slide "Pole Vector"; article, planeP and upNode.

    >>> bend_direction([0, 0, 0], [3, 4, 0], [6, 0, 0]).tolist()
    [0.0, 1.0, 0.0]
    """
    a, b, c = as_vectors(start), as_vectors(middle), as_vectors(end)
    if method == "perpendicular":
        projection = project(b, a, c)
    else:
        upper, lower = distance(a, b), distance(b, c)
        with np.errstate(divide="ignore", invalid="ignore"):
            projection = a + (c - a) * (upper / (upper + lower))[..., np.newaxis]
    off = b - projection
    # A limb folded back onto itself has no side either, however far B lies from the projection.
    clear = length(off) > DEGENERATE_SINE * limb_length(a, b, c)
    clear &= bend_sine(a, b, c) >= DEGENERATE_SINE
    return np.where(clear[..., np.newaxis], normalise(off), np.nan)


def limb_length(start: ArrayLike, middle: ArrayLike, end: ArrayLike) -> Floats:
    """|AB| + |BC|, (...), in file units.

    Source: GDC 2018, slide "Pole Vector": shldr-elbow + elbow-wrist.

    >>> float(limb_length([0, 0, 0], [3, 4, 0], [6, 0, 0]))
    10.0
    """
    return distance(start, middle) + distance(middle, end)


def pole_position(
    start: ArrayLike,
    middle: ArrayLike,
    end: ArrayLike,
    *,
    direction: ArrayLike | None = None,
    origin: PoleOrigin = "middle",
    reach: float = 0.5,
    reach_of: ReachOf = "limb",
    far: float | None = None,
) -> Floats:
    """Where pole vectors stand, (..., 3), in file units.

    direction: unit vectors, (..., 3), `bend_direction` unless given. The pole
    stands ``reach`` times |AB| + |BC| (or times |AC| with ``chord``) from its
    origin, or ``far`` file units. NaN where the direction is.

    Source: GDC 2018, slide "Pole Vector": B + normalise(B − P) · 0.5 · (|AB| + |BC|);
    the article stands at the root, 5 units away.

    >>> pole_position([0, 0, 0], [3, 4, 0], [6, 0, 0]).tolist()
    [3.0, 9.0, 0.0]
    """
    a, b, c = as_vectors(start), as_vectors(middle), as_vectors(end)
    side = bend_direction(a, b, c) if direction is None else as_vectors(direction)
    from_ = {"middle": b, "root": a, "foot": project(b, a, c)}[origin]
    size = limb_length(a, b, c) if reach_of == "limb" else distance(a, c)
    away = np.broadcast_to(far if far is not None else reach * size, size.shape)
    return np.asarray(from_ + side * away[..., np.newaxis])


def barycentric(point: ArrayLike, a: ArrayLike, b: ArrayLike, c: ArrayLike) -> Floats:
    """The weights of A, B and C whose average is the point of their plane nearest to ``point``.

    (..., 3) → (..., 3), summing to 1. NaN where the triangle has no area.

    Source: C. Ericson, "Real-Time Collision Detection", §3.4.

    >>> barycentric([1, 1, 5], [0, 0, 0], [4, 0, 0], [0, 4, 0]).tolist()
    [0.5, 0.25, 0.25]
    """
    point, a, b, c = (as_vectors(p) for p in (point, a, b, c))
    ab, ac, ap = b - a, c - a, point - a
    bb, bc, cc, pb, pc = dot(ab, ab), dot(ab, ac), dot(ac, ac), dot(ap, ab), dot(ap, ac)
    with np.errstate(divide="ignore", invalid="ignore"):
        area = bb * cc - bc * bc
        v = (cc * pb - bc * pc) / area
        w = (bb * pc - bc * pb) / area
    return np.stack([1.0 - v - w, v, w], axis=-1)
