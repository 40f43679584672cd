"""Quaternions: group laws, two ways to the same matrix, and values kept as they are."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from strategies import directions, quaternions, vectors

from rigtri.maths import quaternions as q
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length, normalise

shares = st.floats(0, 1)


def same_turn(a: Floats, b: Floats, atol: float = 1e-12) -> None:
    """q and −q are one turn."""
    assert_allclose(q.to_axes(a), q.to_axes(b), rtol=0, atol=atol)


@given(quaternions, quaternions, vectors)
def test_a_product_rotates_by_the_second_first(a: Floats, b: Floats, v: Floats) -> None:
    assert_allclose(q.rotate(q.multiply(a, b), v), q.rotate(a, q.rotate(b, v)), atol=1e-9)


@given(quaternions)
def test_a_rotation_and_its_conjugate_cancel(a: Floats) -> None:
    assert_allclose(q.multiply(a, q.conjugate(a)), q.IDENTITY, atol=1e-15)


@given(quaternions, quaternions, quaternions)
def test_products_are_associative_and_keep_the_norm(a: Floats, b: Floats, c: Floats) -> None:
    left, right = q.multiply(q.multiply(a, b), 3 * c), q.multiply(a, q.multiply(b, 3 * c))
    assert_allclose(left, right, atol=1e-14)
    assert_allclose(q.norm(left), 3, rtol=1e-14)


@given(quaternions)
def test_axes_become_the_rotation_they_came_from(a: Floats) -> None:
    back = q.from_axes(q.to_axes(a))
    assert back[3] >= 0
    same_turn(back, a)


@given(quaternions)
def test_the_axes_of_a_rotation_are_right_handed_and_orthonormal(a: Floats) -> None:
    x, y, z = q.to_axes(a)
    assert_allclose(cross(x, y), z, atol=1e-14)
    assert_allclose([length(x), length(y), dot(x, y)], [1, 1, 0], atol=1e-14)


@given(st.lists(st.tuples(quaternions, quaternions, directions, shares), min_size=1, max_size=5))
def test_one_and_many_are_the_same_call(rows: list[tuple[Floats, Floats, Floats, float]]) -> None:
    a, b, v, t = (np.stack(column) for column in zip(*rows, strict=True))
    for function, arguments in (
        (q.multiply, (a, b)),
        (q.conjugate, (a,)),
        (q.norm, (a,)),
        (q.unit, (a,)),
        (q.rotate, (a, v)),
        (q.to_axes, (a,)),
        (q.from_axes, (q.to_axes(a),)),
        (q.from_axis_angle, (v, t)),
        (q.between, (v, v[::-1])),
        (q.rotation_angle, (a,)),
        (q.slerp, (a, b, t)),
    ):
        together = function(*arguments)
        assert_array_equal(together, [function(*row) for row in zip(*arguments, strict=True)])


@given(directions, st.floats(-3.1, 3.1))
def test_a_rotation_about_an_axis_leaves_the_axis_and_rotates_by_its_angle(
    axis: Floats, angle: float
) -> None:
    turn = q.from_axis_angle(axis, angle)
    assert_allclose(q.rotate(turn, axis), axis, atol=1e-9)
    assert_allclose(q.rotation_angle(turn), abs(angle), atol=1e-14)


@given(directions, directions)
def test_the_rotation_between_two_directions_takes_one_to_the_other(a: Floats, b: Floats) -> None:
    assert_allclose(q.rotate(q.between(a, b), normalise(a)), normalise(b), atol=1e-9)


@given(directions)
def test_opposite_directions_get_a_half_turn(a: Floats) -> None:
    turn = q.between(a, -a)
    assert_allclose(q.rotation_angle(turn), np.pi, rtol=1e-12)
    assert_allclose(q.rotate(turn, normalise(a)), -normalise(a), atol=1e-12)


@given(quaternions, quaternions)
def test_slerp_starts_and_ends_where_it_should_and_stays_unit(a: Floats, b: Floats) -> None:
    same_turn(q.slerp(a, b, 0), a)
    same_turn(q.slerp(a, b, 1), b)
    assert_allclose(q.norm(q.slerp(a, b, 0.3)), 1, atol=1e-12)


@given(quaternions, quaternions, quaternions, quaternions, shares)
def test_reoriented_keys_slerp_to_the_reoriented_pose(
    a: Floats, b: Floats, before: Floats, after: Floats, share: float
) -> None:
    """Why no key has to be resampled: slerp(p·a·q, p·b·q) = p·slerp(a, b)·q."""
    if abs((a * b).sum()) < 1e-6:  # a half turn apart: both ways round are the shortest
        return

    def sandwich(x: Floats) -> Floats:
        return q.multiply(q.multiply(before, x), after)

    turned = q.slerp(sandwich(a), sandwich(b), share)
    assert_allclose(turned, sandwich(q.slerp(a, b, share)), atol=1e-8)


def test_slerp_half_way_is_half_the_angle() -> None:
    quarter = q.from_axis_angle([0, 0, 1], np.pi / 2)
    eighth = q.slerp(q.IDENTITY, quarter, 0.5)
    assert_allclose(eighth, q.from_axis_angle([0, 0, 1], np.pi / 4), atol=1e-15)
    # q and −q are one turn: the way round is the shorter one.
    same_turn(q.slerp(q.IDENTITY, -quarter, 0.5), eighth)


def test_slerp_of_many_times_is_slerp_of_each_to_the_bit() -> None:
    random = np.random.default_rng(5)
    keys = q.unit(random.normal(size=(6, 3, 4)))
    keys[1, 0], keys[2, 1], keys[3, 2] = keys[0, 0], -keys[1, 1], keys[2, 2] + 1e-9
    rows = np.array([0, 0, 1, 1, 2, 3, 3, 4, 4])
    share = np.array([0.0, 0.29, 0.5, 1.0, 0.0, 1e-9, 0.5, 0.29, 1.0])
    together = q.slerp_rows(keys[:-1], keys[1:], rows, share)
    each = [q.slerp(keys[row], keys[row + 1], part) for row, part in zip(rows, share, strict=True)]
    assert_array_equal(together, each)


def test_how_far_quaternions_are_from_unit_is_the_same_in_blocks() -> None:
    many = q.unit(np.random.default_rng(6).normal(size=(3, 9000, 4)))
    many[2, 8999] *= 3.0
    many[0, 5] = np.nan
    assert q.off_unit(many) == np.nanmax(np.abs(q.norm(many) - 1.0))
    assert q.off_unit(many[:0]) == 0.0


def test_a_quarter_turn_about_z_takes_x_to_y() -> None:
    assert_allclose(q.rotate([0, 0, np.sqrt(0.5), np.sqrt(0.5)], [1, 0, 0]), [0, 1, 0], atol=1e-15)


def test_the_identity_rotates_nothing_to_the_bit() -> None:
    v = np.array([0.1, 0.2, 0.3])
    assert_array_equal(q.rotate(q.IDENTITY, v), v)
    assert_array_equal(q.multiply(q.IDENTITY, [0.1, 0.2, 0.3, 0.4]), [0.1, 0.2, 0.3, 0.4])


@pytest.mark.parametrize("axes", [np.diag(d) for d in ([1, -1, -1], [-1, 1, -1], [-1, -1, 1])])
def test_half_turns_about_the_axes_survive(axes: Floats) -> None:
    """w is 0 here: a formula that divides by it fails."""
    assert_allclose(q.to_axes(q.from_axes(axes)), axes, atol=1e-15)


def test_a_zero_quaternion_is_no_rotation() -> None:
    assert np.isnan(q.unit([0, 0, 0, 0])).all()


def test_three_numbers_are_no_quaternion() -> None:
    with pytest.raises(ValueError, match=r"shape \(3,\)"):
        q.as_quaternions([1, 2, 3])


def test_the_axes_of_a_rotation_are_the_rotated_axes_to_the_bit() -> None:
    random = np.random.default_rng(3)
    turns = np.concatenate([random.normal(size=(500, 4)), random.choice([0.0, -0.0, 1.0, -1.0], (200, 4))])
    turned = q.rotate(turns[:, np.newaxis, :], np.eye(3))
    assert q.to_axes(turns).tobytes() == turned.tobytes()


def test_the_mean_of_one_rotation_is_the_rotation() -> None:
    turn = q.unit(np.array([[[0.1, 0.2, 0.3, 0.4]], [[0.4, 0.3, -0.2, -0.1]]]))
    assert_array_equal(q.average(turn, np.array([0.7])), q.unit(turn)[:, 0])
    assert np.isnan(q.average(turn, np.array([0.0]))).all()


@pytest.mark.parametrize(("size", "stored"), [(1 + 9e-7, 1.0), (1 - 9e-7, 1.0), (1 + 2e-6, 1 + 2e-6), (3, 3)])
def test_rotations_are_stored_with_length_1_where_they_nearly_have_it(size: float, stored: float) -> None:
    unit = np.array([0.1, 0.7, -0.5, 0.5])
    assert_allclose(
        q.normalise_for_storage([size * unit, [0, 0, 0, -size]]),
        [stored * unit, [0, 0, 0, -stored]],
        rtol=1e-15,
    )
