"""The triangle: frames, hinges and pole vectors of the talk and of the article."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import assume, given
from numpy.testing import assert_allclose, assert_array_equal
from strategies import directions, quaternions, vectors

from rigtri.maths import triangle
from rigtri.maths.matrices import from_frame, inverse, multiply
from rigtri.maths.quaternions import from_axis_angle, rotate
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, cross, dot, length, normalise
from rigtri.recognition.bend_direction import in_pose
from rigtri.recognition.limbs import Limb

AXES = ["x", "y", "z", "-x", "-y", "-z"]
PAIRS = [(a, u) for a, u in itertools.product(AXES, AXES) if a[-1] != u[-1]]

# The arm of samples/arm.gltf: |AB| = 37, |BC| = 20, |AC| = 51.
SHOULDER, ELBOW, WRIST = np.array([[20, 140, 0], [55, 140, -12], [71, 140, 0]], dtype=float)


def clear(a: Floats, b: Floats, c: Floats) -> bool:
    """Whether three points are far enough from one line for a plane."""
    return bool(triangle.bend_sine(a, b, c) > 1e-2)


@given(aim=directions, up=directions)
def test_all_24_axis_pairs_are_right_handed(aim: Floats, up: Floats) -> None:
    assume(length(cross(normalise(aim), normalise(up))) > 1e-3)
    for aim_axis, up_axis in PAIRS:
        axes = triangle.frame(aim, up, aim_axis=aim_axis, up_axis=up_axis)
        assert_allclose(np.linalg.det(axes), 1, atol=1e-12)
        assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
        (a, a_sign), (u, u_sign) = triangle.axis_of(aim_axis), triangle.axis_of(up_axis)
        assert_allclose(axes[a] * a_sign, normalise(aim), atol=1e-12)
        assert dot(axes[u] * u_sign, up) > 0


def test_there_are_24_axis_pairs() -> None:
    assert len(PAIRS) == 24


@given(vectors, vectors, vectors, quaternions, vectors)
def test_a_triangle_that_moves_takes_its_plane_and_pole_along(
    a: Floats, b: Floats, c: Floats, turn: Floats, move: Floats
) -> None:
    assume(clear(a, b, c))
    there = [rotate(turn, p) + move for p in (a, b, c)]
    assert_allclose(triangle.hinge(*there), rotate(turn, triangle.hinge(a, b, c)), atol=1e-9)
    expected = rotate(turn, triangle.pole_position(a, b, c)) + move
    assert_allclose(triangle.pole_position(*there), expected, atol=1e-6)


@given(vectors, vectors, vectors)
def test_a_positive_rotation_about_the_hinge_flexes(a: Floats, b: Floats, c: Floats) -> None:
    assume(clear(a, b, c) and triangle.bend_angle(a, b, c) < 3)
    flexed = b + rotate(from_axis_angle(triangle.hinge(a, b, c), 0.01), c - b)
    before, after = triangle.bend_angle(a, b, c), triangle.bend_angle(a, b, flexed)
    assert_allclose(after - before, 0.01, atol=1e-9)


@given(vectors, vectors, vectors)
def test_both_methods_point_from_the_root_to_end_line_to_the_bend_in_its_plane(
    a: Floats, b: Floats, c: Floats
) -> None:
    assume(clear(a, b, c))
    normal = triangle.hinge(a, b, c)
    across = triangle.bend_direction(a, b, c)
    ratio = triangle.bend_direction(a, b, c, method="ratio")
    assert_allclose([dot(across, normal), dot(ratio, normal)], 0, atol=1e-6)
    assert_allclose(dot(across, normalise(c - a)), 0, atol=1e-6)
    assert dot(across, ratio) > 0


@given(vectors, vectors, vectors)
def test_one_triangle_and_many_are_the_same_call(a: Floats, b: Floats, c: Floats) -> None:
    assume(clear(a, b, c))
    points = [np.stack([p, SHOULDER + q]) for p, q in zip((a, b, c), np.eye(3), strict=True)]
    for function in (
        triangle.frame,
        triangle.hinge,
        triangle.bend_sine,
        triangle.bend_angle,
        triangle.bend_direction,
        triangle.limb_length,
        triangle.pole_position,
    ):
        rows = points[:2] if function is triangle.frame else points
        assert_array_equal(function(*rows), [function(*row) for row in zip(*rows, strict=True)])


@given(vectors, vectors, vectors, vectors)
def test_barycentric_weights_rebuild_a_point_of_the_plane(
    a: Floats, b: Floats, c: Floats, share: Floats
) -> None:
    assume(clear(a, b, c) and min(length(b - a), length(c - b), length(c - a)) > 1)
    u, v = share[0] / 1e3, share[1] / 1e3
    point = a + (b - a) * u + (c - a) * v
    weights = triangle.barycentric(point, a, b, c)
    assert_allclose(weights, [1 - u - v, u, v], atol=1e-6)
    assert_allclose(weights @ np.stack([a, b, c]), point, atol=1e-6)


def test_the_talks_aim_of_a_at_b_with_c_as_up() -> None:
    """GDC 2018, "Aiming node A at node B": M = [aim_X, aim_Y, aim_Z, A_pos]."""
    a, b, c = np.array([[1, 2, 3], [4, 6, 3], [1, 7, 5]], dtype=float)
    aim_x = (b - a) / 5
    aim_z = np.cross(aim_x, (c - a) / np.sqrt(29))
    aim_z /= np.linalg.norm(aim_z)
    aim_y = np.cross(aim_z, aim_x)
    m = from_frame(triangle.frame(b - a, c - a), a)
    assert_allclose(m, [[*aim_x, 0], [*aim_y, 0], [*aim_z, 0], [*a, 1]], atol=1e-15)
    # "If P is the parent of A: A.matrix = P.worldMatrix.inverse() * M"
    parent = from_frame(np.eye(3), [1, 1, 1])
    assert_allclose(multiply(m, inverse(parent))[3], [0, 1, 2, 1])


def test_the_talks_pole_vector_stands_half_the_limb_from_the_elbow() -> None:
    """P = A + (AB·AC)/(AC·AC)·AC is right under the elbow: x = 20 + 35. Half of 37 + 20 is 28.5."""
    assert_allclose(triangle.bend_direction(SHOULDER, ELBOW, WRIST), [0, 0, -1], atol=1e-15)
    assert_allclose(triangle.pole_position(SHOULDER, ELBOW, WRIST), [55, 140, -40.5], atol=1e-12)


def test_the_articles_arm_by_its_own_rules() -> None:
    """Ratio method, from the shoulder, 5 away; the wrist copies the elbow's axes."""
    up = triangle.bend_direction(SHOULDER, ELBOW, WRIST, method="ratio")
    # planeP divides 51 as 37 : 20, so it lies at x = 20 + 51 * 37 / 57 = 53.105263.
    assert_allclose(up, np.array([55 - 53.1052632, 0, -12]) / 12.1486640, atol=1e-8)
    pole = triangle.pole_position(SHOULDER, ELBOW, WRIST, direction=up, origin="root", far=5.0)
    assert_allclose(pole, [20.7798128, 140, -4.9388148], atol=1e-6)
    hinge = triangle.hinge(SHOULDER, ELBOW, WRIST)
    assert_allclose(hinge, [0, -1, 0], atol=1e-15)
    shoulder = triangle.frame(ELBOW - SHOULDER, hinge)
    elbow = triangle.frame(WRIST - ELBOW, hinge)
    # x along the bone, y = up × x the hinge, z towards the bend.
    expected = np.array([[35, 0, -12], [0, -37, 0], [-12, 0, -35]]) / 37
    assert_allclose(shoulder, expected, atol=1e-15)
    assert_allclose(normalise(cross(up, shoulder[0])), shoulder[1], atol=1e-15)
    assert_allclose(elbow, np.array([[16, 0, 12], [0, -20, 0], [12, 0, -16]]) / 20, atol=1e-15)
    wrist = from_frame(elbow, WRIST)
    assert_allclose(wrist[:3, :3], elbow)
    assert_allclose(wrist[3, :3], WRIST)


def test_where_a_pole_stands_is_a_choice() -> None:
    def pole(**choice: object) -> list[float]:
        return triangle.pole_position(SHOULDER, ELBOW, WRIST, **choice).tolist()  # type: ignore[arg-type]

    assert_allclose(pole(reach=1.0), [55, 140, -69])
    assert_allclose(pole(reach_of="chord"), [55, 140, -37.5])
    assert_allclose(pole(origin="foot", far=10.0), [55, 140, -10])
    assert_allclose(pole(origin="root", far=5.0), [20, 140, -5])


def test_the_bend_of_a_right_angle_is_a_quarter_turn() -> None:
    assert_allclose(triangle.bend_angle([0, 0, 0], [1, 0, 0], [1, 1, 0]), np.pi / 2)
    assert triangle.bend_sine([0, 0, 0], [1, 0, 0], [1, 1, 0]) == 1
    assert triangle.limb_length([0, 0, 0], [1, 0, 0], [1, 1, 0]) == 2
    assert_array_equal(triangle.hinge([0, 0, 0], [1, 0, 0], [1, 1, 0]), [0, 0, 1])


@pytest.mark.parametrize("end", [[2, 0, 0], [0.5, 0, 0], [1, 0, 0], [2, 1e-9, 0]])
def test_a_straight_limb_gives_nan_and_never_noise(end: list[float]) -> None:
    limb = ([0, 0, 0], [1, 0, 0], end)
    assert np.isnan(triangle.hinge(*limb)).all()
    assert np.isnan(triangle.bend_direction(*limb)).all()
    assert np.isnan(triangle.bend_direction(*limb, method="ratio")).all()
    assert np.isnan(triangle.pole_position(*limb)).all()
    assert np.isfinite(triangle.bend_sine(*limb))


def test_an_up_along_the_aim_gives_nan() -> None:
    assert np.isnan(triangle.frame([1, 2, 3], [2, 4, 6])).any()


def test_an_axis_is_named_by_one_letter_and_a_sign() -> None:
    assert [triangle.axis_of(name) for name in ("x", "+y", "-Z")] == [(0, 1), (1, 1), (2, -1)]
    for wrong in ("", "w", "--x", "xy"):
        with pytest.raises(ValueError, match="not a valid axis"):
            triangle.axis_of(wrong)
    with pytest.raises(ValueError, match="same letter"):
        triangle.frame([1, 0, 0], [0, 1, 0], aim_axis="x", up_axis="-x")


def test_the_angle_of_the_triangle_is_the_angle_of_its_sides() -> None:
    assert_allclose(triangle.bend_angle(SHOULDER, ELBOW, WRIST), angle(ELBOW - SHOULDER, WRIST - ELBOW))


def test_one_limb_is_computed_to_the_bit_as_many_triangles() -> None:
    chance = np.random.default_rng(6)
    points = chance.normal(size=(40, 3, 3))
    points[0, 2], points[1, 1], points[2] = points[0, 0], points[1, 0], points[2, 0]  # coincide
    points[3, 1] = 0.5 * (points[3, 0] + points[3, 2])  # straight
    points[4] *= 1e-9
    world = np.tile(np.eye(4), (120, 1, 1))
    world[:, 3, :3] = points.reshape(-1, 3)
    told = in_pose([Limb(3 * k, 3 * k + 1, 3 * k + 2) for k in range(40)], world)
    a, b, c = points[:, 0], points[:, 1], points[:, 2]
    assert_array_equal([one.direction for one in told], triangle.bend_direction(a, b, c))
    assert_array_equal([one.hinge for one in told], triangle.hinge(a, b, c))
    assert_array_equal([one.sine for one in told], triangle.bend_sine(a, b, c))
