"""The matrices of the talk and of both articles, for three nodes A, B and C.

Both notations: the talk multiplies columns, ``A.inverse() * B``; rigtri and the articles multiply rows,
``B · A⁻¹``. The four numbers of a row are an axis, or the position, in both.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from rigtri.export.explain.steps import Step, step
from rigtri.maths.euler import to_angles
from rigtri.maths.matrices import (
    decompose,
    from_frame,
    identity,
    inverse,
    local,
    multiply,
    skew,
    transform_directions,
)
from rigtri.maths.quaternions import IDENTITY, conjugate, from_axis_angle, to_axes, twist_angle
from rigtri.maths.quaternions import multiply as after
from rigtri.maths.triangle import frame, hinge
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot, length, normalise
from rigtri.model.dataclass import dataclass

_DEGREES = 180.0 / np.pi
# How far the talk moves an object in another space, and how far the driver of a constraint is turned here.
_MOVE, _TURN = np.array([1.0, 0.5, 1.0]), 30.0
# Of angles in degrees, and of cosines: what float64 leaves of nothing, with room.
_ROUNDING = 1e-9
# Degrees: what the float32 rotations of a file leave of nothing.
_STORED = 2e-5
CONSTRAINT = "Matrix parent constraint (article)"


@dataclass(frozen=True, eq=False)
class Worlds:
    """World matrices of A, B and C, (4, 4) each, and what belongs to them where they are joints of a file.

    p, q: the parents of A and of C; None is the world, and B. q_name: what the latter is called.
    rest: B seen from A at rest, if it differs.
    orient: the rotation, (4,), after which C is rotated. of_file: they are not made of three points.
    """

    a: Floats
    b: Floats
    c: Floats
    p: Floats | None = None
    q: Floats | None = None
    q_name: str = ""
    rest: Floats | None = None
    orient: Floats | None = None
    of_file: bool = False


def worlds_of(points: Floats) -> Worlds:
    """The frames that the article gives shoulder, elbow and wrist; NaN where the points make no triangle.

    X lies along the bone, Y is the hinge; the wrist has the axes of the elbow.
    Source: "Using Vector Math to Rig an Arm", shldM, elbowM, wristM.
    """
    a, b, c = points
    normal = hinge(a, b, c)
    upper, lower = frame(b - a, normal), frame(c - b, normal)
    if not np.isfinite(normal).all():
        upper = lower = np.full((3, 3), np.nan)
    return Worlds(from_frame(upper, a), from_frame(lower, b), from_frame(lower, c))


def _clear(values: Floats) -> Floats:
    """Angles and cosines, with 0 for what only rounding has left."""
    return np.where(np.abs(values) < _ROUNDING, 0.0, values)


def matrix_steps(at: Worlds, trouble: str) -> Iterator[Step]:
    """One step after the other; without numbers, and ``trouble`` as the reason, where there are none."""
    row = partial(step, trouble=trouble)
    yield from _grid(at, trouble)
    product = partial(row, "Matrix Multiplication")
    why = "the order matters: first A, then B"
    yield product("BM * AM", "multiply(A, B)", multiply(at.a, at.b), why)
    yield product("AM * BM", "multiply(B, A)", multiply(at.b, at.a), "first B, then A: not the same")
    inverted = partial(row, "Inverse matrix")
    yield inverted("A.inverse()", "inverse(A)", inverse(at.a))
    yield inverted("A.inverse() * A", "multiply(A, inverse(A))", multiply(at.a, inverse(at.a)), "identity")
    seen = local(at.b, at.a)
    yield inverted("A.inverse() * B", "local(B, A) = B · A⁻¹", seen, "B seen from A: its local matrix")
    yield inverted("A * B.local", "world(B.local, A)", multiply(seen, at.a), "local · parent: B again")
    yield from _elsewhere(at, trouble)
    yield from _constraint(at, trouble)
    yield from _readers(at, trouble)


def _grid(at: Worlds, trouble: str) -> Iterator[Step]:
    """What a matrix is: four vectors, whose lengths are the scale and whose right angles can be lost."""
    row = partial(step, trouble=trouble)
    whose = "A as the file has it" if at.of_file else "A as the article aims it: X the bone, Y the hinge"
    yield row("Transformation Matrix", "A.worldMatrix", "A", at.a, f"X, Y, Z axis and translation: {whose}")
    for name, matrix in (("B", at.b), ("C", at.c)):
        yield row("Transformation Matrix", f"{name}.worldMatrix", name, matrix)
    yield row("Identity Matrix", "[1,0,0] [0,1,0] [0,0,1] [0,0,0]", "identity()", identity())
    rows = at.a[:3, :3]
    yield row("Scale", "lengths of x, y, z", "length(A[:3, :3])", length(rows), "1 where nothing is scaled")
    yield row(
        "Skew",
        "x, y, z non-orthogonal",
        "skew(A)",
        _clear(skew(at.a)),
        "largest cosine between two axes; 0: none",
    )


def _elsewhere(at: Worlds, trouble: str) -> Iterator[Step]:
    """C moved in the space of B, and returned."""
    row = partial(step, "Operation on object in local space", trouble=trouble)
    seen = local(at.c, at.b)
    moved = seen.copy()
    moved[3, :3] += _MOVE
    slide = "C in the space of B, which are A and P on the slide"
    yield row("M = B.inverse() * C", "M = local(C, B)", seen, slide)
    yield row("move(M, [1, 0.5, 1])", "M[3, :3] += 1, 0.5, 1", moved[3, :3], "its position there, moved")
    yield row("B * M", "world(M, B)[3, :3]", multiply(moved, at.b)[3, :3], "and back: C in the world")


def _constraint(at: Worlds, trouble: str) -> Iterator[Step]:
    """C follows A, which is turned about its Y axis; Q is the parent of C. With offset and joint orient."""
    row = partial(step, CONSTRAINT, trouble=trouble)
    offset, above, parent = local(at.c, at.a), *(("B", at.b) if at.q is None else ("Q", at.q))
    who = (
        "driver A, child C, whose parent is B"
        if at.q is None
        else f"driver A, child C; Q is C's parent, {at.q_name}"
    )
    yield row("offset = child₀ · parent₀⁻¹", "local(C, A)", offset, who)
    about_y = from_axis_angle([0.0, 1.0, 0.0], _TURN / _DEGREES)
    driver = multiply(from_frame(to_axes(about_y), np.zeros(3)), at.a)
    child = multiply(offset, driver)
    turned = f"A turned by {_TURN:g}° about its Y"
    yield row("childWorld = offset · parent", "multiply(offset, A′)", child, turned)
    inside = local(child, parent)
    yield row("childLocal = childWorld · childParent⁻¹", f"local(C′, {above})", inside, "what C gets")
    orient, rotation = IDENTITY if at.orient is None else at.orient, decompose(inside)[1]
    angles = _clear(_DEGREES * to_angles(orient, "xyz"))
    yield row("jointOrient", "to_angles(C.rest, 'xyz')", angles, f"degrees: C seen from {above} at rest")
    rotate = _clear(_DEGREES * to_angles(after(conjugate(orient), rotation), "xyz"))
    yield row(
        "rotate = childLocal · jointOrient⁻¹", "to_angles(…, 'xyz')", rotate, "degrees, before the orient"
    )


def _readers(at: Worlds, trouble: str) -> Iterator[Step]:
    """How far a joint is twisted about its bone, and how much another aims at something."""
    bone = transform_directions(normalise(at.c[3, :3] - at.b[3, :3]), inverse(at.b))
    rotation = decompose(local(at.b, at.a))[1]
    rest = rotation if at.rest is None else decompose(at.rest)[1]
    twist = _DEGREES * twist_angle(after(conjugate(rest), rotation), normalise(bone))
    yield step(
        "Twist",
        "",
        "twist_angle(B.local · B.rest⁻¹, norm(BC · B⁻¹))",
        np.where(np.abs(twist) < _STORED, 0.0, twist),
        "degrees of B about its bone since rest, seen from A",
        trouble=trouble,
    )
    aim = normalise(at.a[0, :3])
    for name, node in (("B", at.b), ("C", at.c)):
        there = normalise(node[3, :3] - at.a[3, :3])
        talk, ours = f"A.x · norm({name} − A)", f"dot(A[0], normalise({name} - A))"
        yield step("PSD node", talk, ours, dot(aim, there), f"1: A's X points at {name}", trouble=trouble)
