"""Matrices: inverse and spaces, and that the talk and the article say the same thing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from strategies import directions, frames, quaternions, scales, vectors

from rigtri.maths import matrices as m
from rigtri.maths.quaternions import from_axis_angle, to_axes
from rigtri.maths.trigonometry import Floats

Z_TURN = np.array([[0.0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


@given(frames(), frames())
def test_products_and_inverses_are_numpys(a: Floats, b: Floats) -> None:
    assert_allclose(m.multiply(a, b), a @ b, atol=1e-9)
    assert_allclose(m.inverse(a), np.linalg.inv(a), atol=1e-9)
    assert_allclose(m.multiply(m.inverse(a), a), np.eye(4), atol=1e-9)


@given(vectors, quaternions, scales)
def test_what_was_composed_decomposes(t: Floats, r: Floats, s: Floats) -> None:
    translation, rotation, scale = m.decompose(m.compose(t, r, s))
    assert_allclose(translation, t)
    assert_allclose(to_axes(rotation), to_axes(r), atol=1e-12)
    assert_allclose(scale, s, rtol=1e-12)


@given(vectors, quaternions, scales)
def test_a_mirrored_matrix_recomposes_from_a_rotation_and_negative_scale(
    t: Floats, r: Floats, s: Floats
) -> None:
    mirrored = m.compose(t, r, s * np.array([-1.0, 1.0, 1.0]))
    translation, rotation, scale = m.decompose(mirrored)
    assert m.determinant(mirrored) < 0
    assert (scale < 0).all()
    assert_allclose(m.compose(translation, rotation, scale), mirrored, atol=1e-9)


@given(frames(), frames())
def test_local_and_world_undo_each_other(child: Floats, parent: Floats) -> None:
    assert_allclose(m.world(m.local(child, parent), parent), child, atol=1e-8)


@given(frames(), frames())
def test_the_talk_and_the_article_mean_the_same_parent_inverse(child: Floats, parent: Floats) -> None:
    """The talk: P.inverse() * M with columns. The article: childWorld * parentWorld.inverse()."""
    columns = np.linalg.inv(parent.T) @ child.T
    rows = child @ np.linalg.inv(parent)
    assert_allclose(m.local(child, parent), rows, atol=1e-8)
    assert_allclose(m.local(child, parent), columns.T, atol=1e-8)


@given(frames(), frames(), frames())
def test_a_parent_constraint_keeps_its_offset(driver: Floats, driver_now: Floats, child: Floats) -> None:
    """The article: offset = child * driver.inverse(); child = offset * driver, all in the world."""
    offset = m.local(child, driver)
    assert_allclose(m.world(offset, driver), child, atol=1e-8)
    moved = m.world(offset, driver_now)
    assert_allclose(m.local(moved, driver_now), offset, atol=1e-8)


@given(st.lists(st.tuples(frames(), frames(), quaternions), min_size=1, max_size=4))
def test_one_and_many_are_the_same_call(rows: list[tuple[Floats, Floats, Floats]]) -> None:
    a, b, turn = (np.stack(column) for column in zip(*rows, strict=True))
    for function, arguments in (
        (m.multiply, (a, b)),
        (m.inverse, (a,)),
        (m.determinant, (a,)),
        (m.local, (a, b)),
        (m.orthonormal_axes, (a,)),
        (m.skew, (a,)),
        (m.rotate_before, (turn, a)),
        (m.rotate_after, (a, turn)),
    ):
        together = function(*arguments)
        assert_array_equal(together, [function(*row) for row in zip(*arguments, strict=True)])


@given(frames(), quaternions)
def test_rotations_before_and_after_are_products_with_a_rotation_matrix(a: Floats, turn: Floats) -> None:
    c = m.from_frame(to_axes(turn), [0, 0, 0])
    assert_allclose(m.rotate_before(turn, a), c @ a, atol=1e-9)
    assert_allclose(m.rotate_after(a, turn), a @ c, atol=1e-9)


@given(directions, quaternions)
def test_a_matrix_moves_a_point_as_its_row_states(position: Floats, turn: Floats) -> None:
    matrix = m.compose(position, turn, [1, 1, 1])
    assert_allclose(np.array([0, 0, 0, 1]) @ matrix, [*position, 1])


def test_the_identity_is_the_worlds_axes_at_the_origin() -> None:
    assert_array_equal(m.identity(), np.eye(4))
    assert m.identity(2, 3).shape == (2, 3, 4, 4)


def test_rows_are_axes_and_the_last_is_the_position() -> None:
    """GDC 2018, slide "Transformation Matrix": translation -2, 2, 0 is the fourth row."""
    matrix = m.from_frame(np.eye(3), [-2, 2, 0])
    flat = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -2, 2, 0, 1]
    assert matrix.ravel().tolist() == flat


def test_the_order_of_a_product_matters() -> None:
    """GDC 2018: AM*BM != BM*AM. First turn, then move; or first move, then turn."""
    move = m.from_frame(np.eye(3), [1, 0, 0])
    assert_allclose(m.multiply(Z_TURN, move)[3], [1, 0, 0, 1])
    assert_allclose(m.multiply(move, Z_TURN)[3], [0, 1, 0, 1])


def test_lengths_of_rows_are_scale_and_angles_between_them_skew() -> None:
    """GDC 2018: lengths and angles of the x, y and z vectors."""
    scaled = np.diag([2.0, 3.0, 4.0, 1.0])
    assert_allclose(m.decompose(scaled)[2], [2, 3, 4])
    assert m.skew(scaled) == 0
    skewed = np.eye(4)
    skewed[1, :3] = [1, 1, 0]
    assert_allclose(m.skew(skewed), np.sqrt(0.5))


def test_a_flat_matrix_has_no_inverse_and_warns_nobody() -> None:
    assert not np.isfinite(m.inverse(np.diag([1.0, 1.0, 0.0, 1.0]))[:3, :3]).all()


def test_nine_numbers_are_no_matrix() -> None:
    with pytest.raises(ValueError, match=r"shape \(3, 3\)"):
        m.as_matrices(np.eye(3))


def test_axes_are_the_nearest_rotation_where_they_are_sheared_and_else_as_they_are() -> None:
    sheared, straight = (
        np.eye(4),
        m.compose(np.zeros(3), from_axis_angle([0.6, 0.0, 0.8], 0.7), (1.0, 2.0, 3.0)),
    )
    sheared[1, 0] = 0.5
    found = m.unsheared_axes([sheared, straight])
    assert_array_equal(found, [m.nearest_rotation(sheared), m.orthonormal_axes(straight)])
    assert np.abs(found[0] - m.orthonormal_axes(sheared)).max() > 0.1


def test_flat_axes_have_no_nearest_rotation_whatever_rounding_leaves_of_them() -> None:
    """A scale of 0 in turned axes leaves a determinant of 1e-17 and either sign."""
    turn = from_axis_angle([0.6, 0.0, 0.8], 0.7)
    flat = m.compose(np.zeros(3), turn, (0.0, 1.0, 1.0))
    turned = m.multiply(m.compose(np.zeros(3), from_axis_angle([0.0, 0.6, 0.8], 1.1), np.ones(3)), flat)
    assert np.isnan(m.nearest_rotation(np.stack([flat, turned]))).all()
    thin = m.compose(np.zeros(3), turn, (1e-3, 1.0, 1.0))
    assert_allclose(m.nearest_rotation(thin), to_axes(turn), atol=1e-9)
