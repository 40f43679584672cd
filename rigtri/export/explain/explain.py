"""explain: three points step by step, as the talk has it and as rigtri calls it.

Each step is a slide of R. Katz, "Rigging with Triangles", GDC 2018: vectors and their lengths, dot and
cross product, the matrix that aims A at B with C for up, the projection of B on AC, the pole vector; then
matrices, their products and inverses (`matrix_steps`), with the articles on arms and parent constraints.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rigtri.errors import GeometryError
from rigtri.export.explain.matrix_steps import Worlds, matrix_steps, worlds_of
from rigtri.export.explain.steps import Step, plain_numbers, short, step
from rigtri.maths.matrices import from_frame, identity, local
from rigtri.maths.triangle import (
    DEGENERATE_SINE,
    STRAIGHT_SINE,
    bend_angle,
    bend_direction,
    bend_sine,
    frame,
    hinge,
    limb_length,
    pole_position,
)
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, as_vectors, cross, dot, length, normalise, project
from rigtri.model.dataclass import dataclass

_DEGREES = 180.0 / np.pi
AIM, ARM = "Aiming node A at node B", "Using Vector Math to Rig an Arm"
# How far the article puts the pole vector off the shoulder unless options say otherwise, in file units.
_DISTANCE = 5.0
# Sides, in file units, whose fourth powers keep their digits.
_SQUARED = (1e-70, 1e70)


@dataclass(frozen=True, eq=False)
class Explanation:
    """All steps of three points. names: what A, B and C are called. points: (3, 3), in file units."""

    names: tuple[str, str, str]
    points: Floats
    steps: tuple[Step, ...]
    trouble: str

    def as_json(self) -> dict[str, Any]:
        """The same for machines, as schemas/explain.schema.json describes it."""
        return {
            "points": {
                letter: {"name": name, "position": plain_numbers(point)}
                for letter, name, point in zip("ABC", self.names, self.points, strict=True)
            },
            "degenerate": self.trouble or None,
            "steps": [each.as_json() for each in self.steps],
        }


def explain_points(
    a: ArrayLike,
    b: ArrayLike,
    c: ArrayLike,
    *,
    names: tuple[str, str, str] = ("A", "B", "C"),
    worlds: Worlds | None = None,
) -> Explanation:
    """The vectors, the triangle and the matrices of three points, (3,) each, in file units, step by step.

    worlds: the matrices of joints that stand there; else points have the frames that the article gives them.
    Points that are equal or lie on one line have steps without value, and ``trouble`` is why.
    GeometryError for points that are no numbers.

    >>> found = explain_points([0, 0, 0], [3, 4, 0], [6, 0, 0])
    >>> [step.value for step in found.steps if step.talk == "P"]
    [(3.0, 0.0, 0.0)]
    """
    points = np.stack([as_vectors(a), as_vectors(b), as_vectors(c)])
    if not np.isfinite(points).all():
        raise GeometryError(
            f"{', '.join(names)} are not three points: not all of their coordinates are numbers"
        )
    with np.errstate(all="ignore"):
        made = _Maker(points)
        # What needs squares has none then, instead of zeros and infinities that look like answers.
        squared = made if _can_be_squared(points) else _Maker(np.full((3, 3), np.nan), made.trouble)
        at = worlds or worlds_of(points)
        steps = (*_vectors(made, squared), *_products(squared), *_matrix(squared, at.p))
        steps += (*_pole(squared), *_arm(squared))
        trouble = made.trouble or "the frame of a joint has an axis without length"
        steps += tuple(matrix_steps(at, trouble))
    return Explanation(names, points, steps, _trouble(points))


def _trouble(points: Floats) -> str:
    """Why three points make no triangle; "" where they do."""
    a, b, c = points
    same = [
        f"{x} and {y}"
        for x, p, y, q in (("A", a, "B", b), ("B", b, "C", c), ("A", a, "C", c))
        if (p == q).all()
    ]
    if not _can_be_squared(points):
        how = "too near to each other" if _largest(points) < 1 else "too far apart"
        return f"A, B and C are {how}: float64 has no squares of such lengths. Give them in another unit"
    if len(same) == 3:
        return "A, B and C are one point: there is no vector, no triangle and nothing to aim at"
    if same:
        return f"{same[0]} are the same point: two points make a line, and no plane to bend in"
    sine = float(bend_sine(a, b, c))
    if sine < DEGENERATE_SINE:
        folded = float(dot(b - a, c - b)) < 0
        how = "folded back onto itself" if folded else "straight"
        return f"A, B and C lie on one line: the limb is {how}, and nothing says to which side it bends"
    if sine < STRAIGHT_SINE:
        return "the limb is nearly straight: rounding in a file may turn its plane by a degree or more"
    return ""


def _sides(points: Floats) -> Floats:
    """The largest component of AB, BC and AC, (3,)."""
    a, b, c = points
    sides: Floats = np.abs(np.stack([b - a, c - b, c - a])).max(axis=1)
    return sides


def _largest(points: Floats) -> float:
    return float(_sides(points).max())


def _can_be_squared(points: Floats) -> bool:
    """Whether areas, which have the sides' fourth power under a root, are numbers of full precision."""
    sides = _sides(points)
    return bool(((sides == 0) | ((sides > _SQUARED[0]) & (sides < _SQUARED[1]))).all())


class _Maker:
    """The points and vectors that several steps need; what has no value is None with the reason."""

    def __init__(self, points: Floats, trouble: str | None = None) -> None:
        self.a, self.b, self.c = points
        self.ab, self.bc, self.ac = self.b - self.a, self.c - self.b, self.c - self.a
        self.trouble = _trouble(points) if trouble is None else trouble

    def step(
        self, slide: str, talk: str, ours: str, value: ArrayLike, why: str | Callable[[], str] = ""
    ) -> Step:
        """A step with its numbers, or without where they are none."""
        return step(slide, talk, ours, value, why, trouble=self.trouble)


def _vectors(made: _Maker, squared: _Maker) -> list[Step]:
    named = {"AB": made.ab, "BC": made.bc, "AC": made.ac}
    sized = {"AB": squared.ab, "BC": squared.bc, "AC": squared.ac}
    minus, plus = "Subtracting: destination − origin", "Adding Vectors"
    both = made.ab + made.bc
    return [
        *(
            made.step(minus, f"{n} = {n[1]} − {n[0]}", f"{n[1]} - {n[0]}".lower(), v)
            for n, v in named.items()
        ),
        made.step("Reversing a Vector", "AB * -1.0", "-AB", -made.ab, "from B to A"),
        made.step(plus, "AB + BC", "AB + BC", both, "from A over B to C: the same as AC"),
        made.step(plus, "(AB + BC) / 2", "(AB + BC) / 2", 0.5 * both, "their average"),
        *(squared.step("Vector Length", f"‖{n}‖", f"length({n})", length(v)) for n, v in sized.items()),
        *(
            squared.step("Normalize", f"{n}.normal()", f"normalise({n})", normalise(v))
            for n, v in sized.items()
        ),
    ]


def _products(made: _Maker) -> list[Step]:
    one, other, normal = normalise(made.ab), normalise(made.ac), cross(made.ab, made.ac)
    spread = angle(made.ab, made.ac) * _DEGREES if np.isfinite(one + other).all() else np.nan
    bend = bend_angle(made.a, made.b, made.c) * _DEGREES if made.ab.any() and made.bc.any() else np.nan
    of_dot, of_cross = partial(made.step, "The Dot Product"), partial(made.step, "The Cross Product")
    sides = [length(made.ab), length(made.ac)]
    law = dot(made.ab, made.ab) + dot(made.ac, made.ac) - 2.0 * sides[0] * sides[1] * dot(one, other)
    cosine = "cosine of the angle at A: 1 the same way, 0 at a right angle, −1 opposite"
    return [
        of_dot("AB · AC", "dot(AB, AC)", dot(made.ab, made.ac)),
        of_dot("norm AB · norm AC", "dot of the normalised", dot(one, other), cosine),
        of_dot("acos(norm AB · norm AC)", "angle(AB, AC)", spread, "degrees, at A"),
        made.step(
            "Linear Algebra",
            "c² = a² + b² − 2ab cos θ",
            "length(BC) ** 2",
            law,
            f"law of cosines: a = ‖AB‖, b = ‖AC‖, θ at A; c = ‖BC‖ = {short(float(np.sqrt(np.abs(law))))}",
        ),
        of_cross("AB × AC", "cross(AB, AC)", normal, "the normal of the plane, at right angles to both"),
        of_cross("‖AB × AC‖ / 2", "length(cross(AB, AC)) / 2", 0.5 * length(normal), "area of the triangle"),
        made.step("rigtri", "", "bend_angle(A, B, C)", bend, "degrees: 0 straight, 180 folded"),
    ]


def _matrix(made: _Maker, parent: Floats | None) -> list[Step]:
    """A aimed at B, in the world and as A's parent sees it, which is the world's own for None."""
    x, y, z = normalise(made.ab), np.full(3, np.nan), np.full(3, np.nan)
    if np.isfinite(hinge(made.a, made.b, made.c)).all():
        x, y, z = frame(made.ab, made.ac)
    aimed = from_frame(np.stack([x, y, z]), made.a)
    row = partial(made.step, AIM)
    above = "A has no parent: P is the world" if parent is None else "A as it aims, seen from P"
    inside = local(aimed, identity() if parent is None else parent)
    nearest = "Y is as near to C as a right angle lets it be"
    return [
        row("aim_X = norm AB", "frame(AB, AC)[0]", x, "X aims at B"),
        row("aim_Z = norm(aim_X × norm AC)", "frame(AB, AC)[2]", z, "Z is the normal of the plane"),
        row("aim_Y = aim_Z × aim_X", "frame(AB, AC)[1]", y, nearest),
        row("A_pos", "a", made.a, "the fourth row: its position"),
        row("M", "from_frame(frame(AB, AC), A)", aimed, "[aim_X, aim_Y, aim_Z, A_pos]: A as it aims"),
        *([] if parent is None else [row("P.worldMatrix", "P", parent, "the parent of A")]),
        row("A.matrix = P.inverse() * M", "local(M, P) = M · P⁻¹", inside, above),
    ]


def _arm(made: _Maker) -> list[Step]:
    """The article, variable by variable. Its plane point shares AC as the bones share the limb."""
    a, b, c = made.a, made.b, made.c
    upper, lower = length(made.ab), length(made.bc)
    fraction = upper / (lower + upper)
    point = a + made.ac * fraction
    up = normalise(b - point)
    frames = worlds_of(np.stack([a, b, c]))
    pole = a + up * _DISTANCE
    standing = from_frame(frames.a[:3, :3], pole)
    row = partial(made.step, ARM)
    flexes = "n = AB × BC: a positive turn about it bends the limb more"
    shares = "P on AC by the lengths of the bones; the talk's is the nearest to B"
    return [
        row("planeX = wrist - shld", "C - A", made.ac),
        row("fraction = armDis/(foreArmDis+armDis)", "‖AB‖ / (‖BC‖ + ‖AB‖)", fraction),
        row("planeP = shld + planeX * fraction", "A + AC * fraction", point, shares),
        row("upNode = (elbow-planeP).normalize()", "normalise(B - planeP)", up, "where the limb bends to"),
        row("pvPos = shld + upNode * 5.0", "A + upNode * 5", pole, "off the shoulder"),
        row("shdYAxis = upNode ^ shdXAxis", "hinge(A, B, C)", hinge(a, b, c), flexes),
        row("shldM", "from_frame(frame(AB, n), A)", frames.a, "X the bone, Y the hinge"),
        row("elbowM", "from_frame(frame(BC, n), B)", frames.b, "the same Y: one hinge for the limb"),
        row("wristM", "from_frame(frame(BC, n), C)", frames.c, "the axes of the elbow"),
        row("pvM", "from_frame(frame(AB, n), pvPos)", standing, "the axes of the shoulder"),
    ]


def _pole(made: _Maker) -> list[Step]:
    a, b, c = made.a, made.b, made.c
    projection, reach = project(b, a, c), 0.5 * limb_length(a, b, c)
    share = dot(made.ab, made.ac) / dot(made.ac, made.ac)
    row = partial(made.step, "Pole Vector")

    def where() -> str:
        off = float(share)
        side = "between A and C" if 0 <= off <= 1 else "beyond C" if off > 1 else "behind A"
        return f"the point of AC nearest to B, at {short(100 * off)} % of the way, {side}"

    along, half = "how far along AC, from 0 to 1", "how far off the elbow: half of the arm"
    side, pole = bend_direction(a, b, c), pole_position(a, b, c)
    return [
        row("AB · AC / AC · AC", "dot(AB, AC) / dot(AC, AC)", share, along),
        row("P", "project(B, A, C)", projection, where),
        row("PB = B − P", "B - P", b - projection),
        row("‖PB‖", "length(PB)", length(b - projection), "how far the limb is from straight"),
        row("PB.normal()", "bend_direction(A, B, C)", side, "where the limb bends to"),
        row("(‖AB‖ + ‖BC‖) * 0.5", "limb_length(A, B, C) * reach", reach, half),
        row("B + PB.normal() * that", "pole_position(A, B, C)", pole, "the position of the pole vector"),
    ]
