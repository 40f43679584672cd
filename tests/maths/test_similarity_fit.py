from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from rigtri.maths.matrices import transform_points
from rigtri.maths.quaternions import from_axis_angle, to_axes
from rigtri.maths.similarity_fit import AXIS_TURNS, fit_similarity, nearest_axis_turn, upright_turn

POINTS = np.array([[0, 0, 0], [0, 3, 0], [1, 2, 0], [-1, 2, 0.5], [0.5, 1, -2]], dtype=float)


def test_there_are_24_rotations_of_axes_onto_axes() -> None:
    assert AXIS_TURNS.shape == (24, 3, 3)
    assert len(np.unique(AXIS_TURNS, axis=0)) == 24
    assert_allclose(np.linalg.det(AXIS_TURNS), 1.0)
    assert np.array_equal(AXIS_TURNS[0], np.eye(3))


@given(
    st.integers(0, 23), st.sampled_from([0.01, 0.5, 1.0, 2.54, 100.0]), st.tuples(*[st.floats(-50, 50)] * 3)
)
def test_axes_units_and_places_are_found(number: int, scale: float, offset: tuple[float, ...]) -> None:
    ours = POINTS @ AXIS_TURNS[number] * scale + offset
    fit = fit_similarity(POINTS, ours, about_origin=False)
    assert fit.residual < 1e-9
    assert_allclose(transform_points(POINTS, fit.matrix), ours, atol=1e-4 * scale + 1e-9)


def test_any_rotation_is_found_by_three_points() -> None:
    axes = to_axes(from_axis_angle([1.0, 2.0, 3.0], 0.7))
    fit = fit_similarity(POINTS, POINTS @ axes + 5.0, about_origin=False)
    assert_allclose(transform_points(POINTS, fit.matrix), POINTS @ axes + 5.0, atol=1e-9)


def test_about_the_origin_axes_go_onto_axes_alone() -> None:
    """Another pose is no other frame: what no rotation of axes explains is left as it is."""
    axes = to_axes(from_axis_angle([0.0, 0.0, 1.0], 0.4))
    fit = fit_similarity(POINTS, POINTS @ axes, about_origin=True)
    assert np.array_equal(fit.matrix, np.eye(4))
    assert fit.residual > 0.1


@pytest.mark.parametrize(("about_origin", "number"), [(False, 19), (True, 0)])
def test_a_rotation_of_axes_that_fits_a_little_better_is_taken_where_no_pose_explains_it(
    about_origin: bool, number: int
) -> None:
    ours = POINTS @ to_axes(from_axis_angle([0.0, 0.0, 1.0], np.radians(60)))
    ours[4], ours[1] = -ours[4], ours[1] * 1.3
    fit = fit_similarity(POINTS, ours, about_origin=about_origin)
    assert np.array_equal(fit.matrix[:3, :3] / np.abs(fit.matrix[:3, :3]).max(), AXIS_TURNS[number])


@pytest.mark.parametrize("about_origin", [False, True])
def test_rounding_is_no_transform(about_origin: bool) -> None:
    ours = POINTS * (1.0 + 1e-7) + 1e-6
    assert np.array_equal(fit_similarity(POINTS, ours, about_origin=about_origin).matrix, np.eye(4))


def test_the_origin_stays_on_request() -> None:
    fit = fit_similarity(POINTS, POINTS * 100.0 + 1.0, about_origin=True)
    assert_allclose(fit.matrix[3, :3], 0.0)
    assert_allclose(fit.matrix[:3, :3], np.eye(3) * 100.0, rtol=0.02)
    known = fit_similarity(POINTS, POINTS * 100.0, about_origin=True, ratio=99.0)
    assert_allclose(known.matrix[:3, :3], np.eye(3) * 99.0)


@pytest.mark.parametrize("number", range(24))
def test_the_nearest_of_the_24_rotations_is_that_of_most_joints(number: int) -> None:
    axes = to_axes(from_axis_angle(np.array([[1.0, 2.0, 3.0], [0.0, 1.0, 0.0], [-1.0, 1.0, 0.0]]), 0.3))
    other = AXIS_TURNS[[(number + 7) % 24, (number + 11) % 24]]  # two in another pose
    turns = np.concatenate([axes @ AXIS_TURNS[number], other])
    assert np.array_equal(nearest_axis_turn(turns), AXIS_TURNS[number])


@pytest.mark.parametrize(
    ("degrees", "turns"), [(0, 0), (44, 0), (50, 0), (70, 1), (90, 1), (-70, 3), (180, 2)]
)
def test_another_rotation_than_none_is_taken_where_it_is_clearly_nearer(degrees: float, turns: int) -> None:
    """What the identity leaves, 1 - cos 50°, is less than twice 1 - cos 40°."""
    x = np.array([1.0, 0.0, 0.0])
    axes = to_axes(from_axis_angle(x, np.radians(degrees)))[np.newaxis]
    assert_allclose(nearest_axis_turn(axes), to_axes(from_axis_angle(x, np.radians(90 * turns))), atol=1e-12)
    assert np.array_equal(nearest_axis_turn(axes[:0]), np.eye(3))


def test_the_smallest_rotation_takes_one_up_axis_to_another() -> None:
    x, y, z = np.eye(3)
    for up, to, angle in ((y, y, 0), (z, y, 90), (y, z, 90), (x, -z, 90), (y, -y, 180), (x + y, y, 0)):
        turn = upright_turn(up, to)
        assert np.trace(turn) == pytest.approx(1 + 2 * np.cos(np.radians(angle)))
        assert np.array_equal(up @ turn, to) or (up == x + y).all()


def test_what_is_left_is_a_share_of_the_size_of_ours() -> None:
    ours = POINTS * 100.0
    ours[0, 0] += 1.0
    fit = fit_similarity(POINTS, ours, about_origin=False)
    middle = ours - ours.mean(axis=0)
    left = transform_points(POINTS, fit.matrix) - ours
    expected = np.sqrt((left**2).sum(axis=1).mean() / (middle**2).sum(axis=1).mean())
    assert fit.residual == pytest.approx(expected, rel=0.2)
    assert 1e-4 < fit.residual < 0.05


@pytest.mark.parametrize("about_origin", [True, False])
def test_points_at_one_place_have_no_size_to_fit(about_origin: bool) -> None:
    at_one_place = np.ones((len(POINTS), 3))
    for theirs, ours in ((at_one_place, POINTS), (POINTS, at_one_place)):
        fit = fit_similarity(theirs, ours, about_origin=about_origin)
        assert np.isfinite(fit.matrix).all()
        assert_allclose(np.linalg.norm(fit.matrix[:3, :3], axis=1), 1.0)


@pytest.mark.parametrize(
    ("about_origin", "ratio", "scale", "found"),
    [
        (False, None, 1.2, 1.2),
        (True, None, 1.2, 1.0),  # another pose of the same size
        (True, None, 1 / 1.2, 1.0),
        (True, None, 1.3, 1.3),
        (True, None, 1 / 1.3, 1 / 1.3),
        (True, 1.2, 1.2, 1.2),  # it is known
        (False, 1.2, 1.2, 1.2),
        (True, 1.00005, 1.00005, 1.0),
        (False, None, 1.00005, 1.0),
        (False, None, 1.0002, 1.0002),
        (False, None, 1 / 1.0002, 1 / 1.0002),
    ],
)
def test_nearly_one_size_is_one_by_how_much_is_known(
    about_origin: bool, ratio: float | None, scale: float, found: float
) -> None:
    fit = fit_similarity(POINTS, POINTS * scale, about_origin=about_origin, ratio=ratio)
    assert fit.matrix[0, 0] == pytest.approx(found, abs=1e-9)
