from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from rigtri.maths.matrices import transform_points
from rigtri.maths.quaternions import from_axis_angle, to_axes
from rigtri.maths.similarity_fit import AXIS_TURNS, fit_similarity

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
