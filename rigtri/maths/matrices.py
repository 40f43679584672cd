"""Transformation matrices, shape (..., 4, 4), **row vectors**: ``v_world = v_local @ M``.

Row 0 is the X axis, row 1 Y, row 2 Z, row 3 the position; the fourth column is
0, 0, 0, 1. The flat list of 16 numbers is the same in Maya, in USD and in glTF.
``world = local · parent_world`` and ``local = world · inverse(parent_world)``:
the constraint article's notation. The talk writes ``P.inverse() * M`` for the
same thing with column vectors; docs/conventions.md has both side by side.

Elementwise throughout, for the reason given in `rigtri.maths.vectors`.

Source: R. Katz, "Rigging with Triangles", GDC 2018, slides "Transformation
Matrix" to "Inverse matrix"; "Matrix parent constraint" (article).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from rigtri.maths.quaternions import from_axes, rotate, to_axes
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import as_vectors, by_component, cross, dot, length, normalise

# The public mathematics; the rest of the module serves rigtri alone.
__all__ = [
    "compose",
    "decompose",
    "determinant",
    "from_frame",
    "identity",
    "inverse",
    "local",
    "multiply",
    "nearest_rotation",
    "orthonormal_axes",
    "skew",
    "transform_directions",
    "transform_points",
    "world",
]

# Of each of three axes the one after it and the one before.
_NEXT, _LAST = np.array([1, 2, 0]), np.array([2, 0, 1])
# For each row and column of a 3×3 matrix the next two: what its minors are made of.
_NEXT_TWO = np.ix_((1, 2, 0, 1), (1, 2, 0, 1))
# Axes that span a smaller share of the product of their lengths are flat but for rounding.
_FLAT = 1e-13
# Axes that should meet at right angles do so within this cosine after float32 storage.
SKEW = 1e-5


def as_matrices(m: ArrayLike) -> Floats:
    """Anything array-like as float64, shape (..., 4, 4); ValueError for another shape."""
    array = np.asarray(m, dtype=np.float64)
    if array.shape[-2:] != (4, 4):
        raise ValueError(f"matrices are 4 by 4, these have shape {array.shape}")
    return array


def identity(*shape: int) -> Floats:
    """Matrices aligned to the world, at the origin, (..., 4, 4), with ``shape`` in front.

    Source: GDC 2018, slide "Identity Matrix".

    >>> identity(2).shape, identity()[3].tolist()
    ((2, 4, 4), [0.0, 0.0, 0.0, 1.0])
    """
    return np.broadcast_to(np.eye(4), (*shape, 4, 4)).copy()


def multiply(a: ArrayLike, b: ArrayLike) -> Floats:
    """Products a·b, (..., 4, 4): first ``a``, then ``b``. The order matters.

    >>> moved = from_frame(np.eye(3), [1, 2, 3])
    >>> multiply(moved, moved)[3].tolist()
    [2.0, 4.0, 6.0, 1.0]

    Source: GDC 2018, slide "Matrix Multiplication".
    """
    a, b = as_matrices(a), as_matrices(b)
    with np.errstate(invalid="ignore", over="ignore"):  # inf and NaN go through as they are
        total = a[..., :, 0, np.newaxis] * b[..., np.newaxis, 0, :]
        for k in (1, 2, 3):
            total += a[..., :, k, np.newaxis] * b[..., np.newaxis, k, :]
    return np.asarray(total)


def inverse(m: ArrayLike) -> Floats:
    """Inverses, (..., 4, 4): ``multiply(inverse(m), m)`` is the identity; NaN or inf if singular.

    For matrices whose fourth column is 0, 0, 0, 1 (anything with a position and
    axes, sheared or not); a perspective column is not looked at.

    Source: GDC 2018, slide "Inverse matrix"; adjugate over determinant.

    >>> there = from_frame([[0, 1, 0], [-1, 0, 0], [0, 0, 1]], [1, 2, 3])
    >>> multiply(inverse(there), there).tolist() == identity().tolist()
    True
    """
    m = as_matrices(m)
    axes = m[..., :3, :3]
    crossed = cross(axes[..., _NEXT, :], axes[..., _LAST, :])
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        volume = dot(crossed[..., 2, :], m[..., 2, :3])
        linear = crossed.swapaxes(-1, -2) / volume[..., np.newaxis, np.newaxis]
        result = by_component(m.shape, 2)
        result[..., :3, :3] = linear
        result[..., 3, :3] = -_row_times(m[..., 3, :3], linear)
    result[..., :3, 3], result[..., 3, 3] = 0.0, 1.0
    return result


def determinant(m: ArrayLike) -> Floats:
    """The volume of the three axes, (..., 4, 4) → (...); negative for a mirrored frame.

    Source: GDC 2018, slide "The Cross Product": right-handed, so x × y · z is positive.

    >>> float(determinant(from_frame([[2, 0, 0], [0, 1, 0], [0, 0, -1]], [0, 0, 0])))
    -2.0
    """
    m = as_matrices(m)
    return dot(cross(m[..., 0, :3], m[..., 1, :3]), m[..., 2, :3])


def local(world: ArrayLike, parent_world: ArrayLike) -> Floats:
    """Local matrices: ``world · inverse(parent_world)``, (..., 4, 4); `world` is the inverse of this.

    >>> local(from_frame(np.eye(3), [5, 0, 0]), from_frame(np.eye(3), [2, 0, 0]))[3].tolist()
    [3.0, 0.0, 0.0, 1.0]

    Source: GDC 2018, slide "Inverse matrix"; "Matrix parent constraint",
    childLocal = childWorld · parentWorld⁻¹.
    """
    return multiply(world, inverse(parent_world))


def world(local: ArrayLike, parent_world: ArrayLike) -> Floats:
    """World matrices: ``local · parent_world``, (..., 4, 4).

    Source: "Matrix parent constraint", childWorld = childLocal · childParent.

    >>> world(from_frame(np.eye(3), [3, 0, 0]), from_frame(np.eye(3), [2, 0, 0]))[3].tolist()
    [5.0, 0.0, 0.0, 1.0]
    """
    return multiply(local, parent_world)


def transform_points(points: ArrayLike, m: ArrayLike) -> Floats:
    """Points p·M, (..., 3), (..., 4, 4) → (..., 3).

    Source: GDC 2018, slide "Transformation Matrix": a point is its axes' sum, and the fourth row.

    >>> transform_points([1, 1, 1], from_frame(2 * np.eye(3), [0, 0, 5])).tolist()
    [2.0, 2.0, 7.0]
    """
    m = as_matrices(m)
    return _row_times(as_vectors(points), m[..., :3, :3]) + m[..., 3, :3]


def transform_directions(directions: ArrayLike, m: ArrayLike) -> Floats:
    """Directions d·M without the position, (..., 3), (..., 4, 4) → (..., 3); lengths scale along.

    Source: GDC 2018, slide "Fourth value in each row is 0": a direction is not moved.

    >>> transform_directions([1, 1, 1], from_frame(2 * np.eye(3), [0, 0, 5])).tolist()
    [2.0, 2.0, 2.0]
    """
    return _row_times(as_vectors(directions), as_matrices(m)[..., :3, :3])


def from_frame(axes: ArrayLike, position: ArrayLike) -> Floats:
    """A matrix from three axes (rows), (..., 3, 3), and a position, (..., 3).

    Source: GDC 2018, slide "Aiming node A at node B": M = [aim_X, aim_Y, aim_Z, A_pos].

    >>> from_frame(np.eye(3), [1, 2, 3])[3].tolist()
    [1.0, 2.0, 3.0, 1.0]
    """
    axes, position = np.asarray(axes, dtype=np.float64), as_vectors(position)
    shape = np.broadcast_shapes(axes.shape[:-2], position.shape[:-1])
    m = by_component((*shape, 4, 4), 2)
    m[..., :3, :3], m[..., 3, :3] = axes, position
    m[..., :3, 3], m[..., 3, 3] = 0.0, 1.0
    return m


def compose(translation: ArrayLike, rotation: ArrayLike, scale: ArrayLike) -> Floats:
    """Matrices that scale, then rotate, then translate: (..., 3), (..., 4), (..., 3) → (..., 4, 4).

    The rotation is taken as unit; `rigtri.evaluation.sampling` says what becomes of one that is not.

    Source: glTF 2.0 §3.5.3; UsdSkel joint-local transforms.

    >>> half_turn_about_z = [0, 0, 1, 0]
    >>> compose([5, 0, 0], half_turn_about_z, [1, 2, 1])[:, :3].tolist()
    [[-1.0, 0.0, 0.0], [0.0, -2.0, 0.0], [0.0, 0.0, 1.0], [5.0, 0.0, 0.0]]
    """
    axes, position, scale = to_axes(rotation), as_vectors(translation), as_vectors(scale)
    m = by_component((*np.broadcast_shapes(axes.shape[:-2], position.shape[:-1], scale.shape[:-1]), 4, 4), 2)
    np.multiply(axes, scale[..., :, np.newaxis], out=m[..., :3, :3])
    m[..., 3, :3], m[..., :3, 3], m[..., 3, 3] = position, 0.0, 1.0
    return m


def decompose(m: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Translation (..., 3), rotation xyzw (..., 4) and scale (..., 3) of matrices, (..., 4, 4).

    A mirrored matrix gets three negative scales, so that the rotation is a
    rotation. Skew cannot be kept: ask `skew` first. NaN where an axis is zero.

    Source: GDC 2018, slides on scale and skew: lengths and angles of the rows.

    >>> [part.tolist() for part in decompose(compose([5, 0, 0], [0, 0, 1, 0], [1, 2, 1]))]
    [[5.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [1.0, 2.0, 1.0]]
    """
    m = as_matrices(m)
    sign = handedness(m)[..., np.newaxis]
    scale = length(m[..., :3, :3]) * sign
    return m[..., 3, :3].copy(), from_axes(orthonormal_axes(m)), scale


def decompose_flat(m: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Like `decompose`; an axis of length zero stands upright on the other two. NaN where two are zero.

    >>> [part.tolist() for part in decompose_flat(np.diag([0.0, 2, 3, 1]))][1:]
    [[0.0, 0.0, 0.0, 1.0], [0.0, 2.0, 3.0]]
    """
    whole, scale = as_matrices(m).copy(), length(as_matrices(m)[..., :3, :3])
    for zero, one, other in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        upright = cross(whole[..., one, :3], whole[..., other, :3])
        flat = (scale[..., zero] == 0)[..., np.newaxis]
        whole[..., zero, :3] = np.where(flat, upright, whole[..., zero, :3])
    translation, rotation, sized = decompose(whole)
    return translation, rotation, np.where(scale == 0, 0.0, sized)


def orthonormal_axes(m: ArrayLike) -> Floats:
    """The axes of matrices without scale, skew and mirroring, rows, (..., 4, 4) → (..., 3, 3).

    X keeps its line, Y the plane of X and Y (Gram-Schmidt). A mirrored matrix has all
    three axes negated, which makes it right-handed. NaN where the axes do not span space.

    Source: GDC 2018, slide "Adjusting the Up Vector".

    >>> orthonormal_axes(from_frame([[2, 0, 0], [1, 1, 0], [0, 0, 3]], [0, 0, 0])).tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    m = as_matrices(m)
    sign = handedness(m)[..., np.newaxis]
    x = normalise(m[..., 0, :3]) * sign
    z = normalise(cross(x, m[..., 1, :3] * sign))
    return _side_by_side(x, cross(z, x), z)


def looking_frames(m: ArrayLike) -> Floats:
    """Where cameras and lights stand and look, without scale, skew and mirroring, (..., 4, 4) → (..., 4, 4).

    Z, against which they look, keeps its line, Y the plane of Y and Z (Gram-Schmidt). NaN where the axes do
    not span space.

    >>> looking_frames(from_frame([[1, 0, 0], [0, 1, 3], [0, 0, 2]], [0, 0, 5]))[1:].tolist()
    [[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 5.0, 1.0]]
    """
    m = as_matrices(m).copy()
    z = normalise(m[..., 2, :3])
    x = normalise(cross(m[..., 1, :3], z))
    m[..., :3, :3] = _side_by_side(x, cross(z, x), z)
    return m


def nearest_rotation(m: ArrayLike) -> Floats:
    """The rotations nearest to the axes of matrices, as rows, (..., 4, 4) → (..., 3, 3).

    Unlike `orthonormal_axes` no axis goes before another, so rotating a sheared frame
    rotates the result by just as much. A mirrored matrix has all axes negated first.
    NaN where the axes do not span space.

    Source: N. J. Higham, "Computing the polar decomposition", 1986 (Newton's iteration).

    >>> nearest_rotation(from_frame(np.diag([2, 3, 5]), [0, 0, 0])).round(12).tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    m = as_matrices(m)
    spanned = determinant(m)
    sign = np.where(spanned < 0, -1.0, 1.0)[..., np.newaxis, np.newaxis]
    # One factor for all axes: three would not turn with a sheared frame.
    size = np.abs(m[..., :3, :3]).max(axis=(-1, -2), keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        # (3, 3, ...), so that an operation on one of the nine numbers is one on a line of memory.
        rows = np.moveaxis(m[..., :3, :3] / size * sign, (-2, -1), (0, 1))
        # Quadratic near the end, halving the stretch before: 20 steps are enough for 1 to 1000.
        for _ in range(20):
            minors = rows[_NEXT_TWO]
            # Each row is the cross product of the next two; with its own row that is the determinant.
            opposite = minors[:3, :3] * minors[1:, 1:] - minors[:3, 1:] * minors[1:, :3]
            volume = opposite[2] * rows[2]
            rows = 0.5 * (rows + opposite / (volume[0] + volume[1] + volume[2]))
    flat = np.abs(spanned) <= _FLAT * length(m[..., :3, :3]).prod(axis=-1)
    return np.where(flat[..., np.newaxis, np.newaxis], np.nan, np.moveaxis(rows, (0, 1), (-2, -1)))


def unsheared_axes(m: ArrayLike) -> Floats:
    """The axes of matrices as rotations, rows, (..., 4, 4) → (..., 3, 3), which turn with the matrices' own.

    Those of `orthonormal_axes`, to the bit, but for sheared matrices: these have the `nearest_rotation`.
    """
    m = as_matrices(m)
    axes, sheared = orthonormal_axes(m), skew(m) > SKEW
    if sheared.any():
        axes[sheared] = nearest_rotation(m[sheared])
    return axes


def handedness(m: ArrayLike) -> Floats:
    """−1 where the axes of matrices are mirrored, else 1, (..., 4, 4) → (...).

    What `orthonormal_axes`, `unsheared_axes` and `nearest_rotation` multiply axes by: an axis of a
    mirrored frame is the opposite of theirs.

    >>> float(handedness(from_frame([[2, 0, 0], [0, 1, 0], [0, 0, -1]], [0, 0, 0])))
    -1.0
    """
    return np.where(determinant(m) < 0, -1.0, 1.0)


def skew(m: ArrayLike) -> Floats:
    """How far axes are from right angles: the largest |cosine| between two, (..., 4, 4) → (...).

    0 for a frame that translation, rotation and scale can hold; compare with `SKEW`.

    Source: GDC 2018, slide "We can Skew the object by making x, y, z non-orthogonal".

    >>> float(skew(from_frame([[1, 0, 0], [0.6, 0.8, 0], [0, 0, 1]], [0, 0, 0])).round(12))
    0.6
    """
    rows = normalise(as_matrices(m)[..., :3, :3])
    x, y, z = rows[..., 0, :], rows[..., 1, :], rows[..., 2, :]
    return np.maximum(np.abs(dot(x, y)), np.maximum(np.abs(dot(y, z)), np.abs(dot(z, x))))


def rotate_before(q: ArrayLike, m: ArrayLike) -> Floats:
    """C·M for the rotation C of ``q``: the same position, other axes, (..., 4), (..., 4, 4)."""
    m = as_matrices(m).copy()
    m[..., :3, :3] = _row_times(to_axes(q), m[..., np.newaxis, :3, :3])
    return m


def rotate_after(m: ArrayLike, q: ArrayLike) -> Floats:
    """M·C for the rotation C of ``q``: axes and position rotated, (..., 4, 4), (..., 4)."""
    m = as_matrices(m).copy()
    m[..., :, :3] = rotate(np.asarray(q, dtype=np.float64)[..., np.newaxis, :], m[..., :, :3])
    return m


def _side_by_side(x: Floats, y: Floats, z: Floats) -> Floats:
    """Three vectors, (..., 3) each, as the rows of one array, (..., 3, 3)."""
    rows = by_component((*x.shape, 3), 2)
    rows[..., 0, :], rows[..., 1, :], rows[..., 2, :] = x, y, z
    return rows


def _row_times(v: Floats, linear: Floats) -> Floats:
    return (
        v[..., 0, np.newaxis] * linear[..., 0, :]
        + v[..., 1, np.newaxis] * linear[..., 1, :]
        + v[..., 2, np.newaxis] * linear[..., 2, :]
    )
