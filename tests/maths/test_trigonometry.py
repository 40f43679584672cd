"""Sine, cosine and arc tangent: as good as the C library's, and the same everywhere."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from rigtri.maths.trigonometry import arc_tangent, sin_cos

angles = st.floats(-1e4, 1e4)


@given(angles)
def test_sine_and_cosine_are_the_c_librarys(angle: float) -> None:
    sine, cosine = sin_cos(angle)
    assert_allclose([sine, cosine], [math.sin(angle), math.cos(angle)], rtol=0, atol=4e-16)


@given(angles)
def test_sine_is_odd_and_cosine_is_even_to_the_bit(angle: float) -> None:
    (sine, cosine), (other, same) = sin_cos(angle), sin_cos(-angle)
    assert (sine, cosine) == (-other, same)


@given(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6))
def test_the_arc_tangent_is_the_c_librarys(y: float, x: float) -> None:
    expected = 0.0 if x == y == 0 else math.atan2(y + 0.0, x + 0.0)
    assert_allclose(arc_tangent(y, x), expected, rtol=1e-15, atol=0)


@given(st.floats(-math.pi, math.pi))
def test_an_angle_comes_back_from_its_sine_and_cosine(angle: float) -> None:
    # Near pi the sign of the sine decides between pi and -pi.
    difference = abs(float(arc_tangent(*sin_cos(angle))) - angle)
    assert min(difference, 2 * math.pi - difference) < 1e-15


@given(st.lists(angles, min_size=1, max_size=9))
def test_one_angle_and_many_are_the_same_call(many: list[float]) -> None:
    assert_array_equal(sin_cos(many), np.transpose([sin_cos(angle) for angle in many]))
    assert_array_equal(
        arc_tangent(many, many[::-1]),
        [arc_tangent(y, x) for y, x in zip(many, many[::-1], strict=True)],
    )


def test_quarter_turns_have_the_values_one_knows() -> None:
    sine, cosine = sin_cos(np.arange(5) * (math.pi / 2))
    assert_allclose(sine, [0, 1, 0, -1, 0], atol=4e-16)
    assert_allclose(cosine, [1, 0, -1, 0, 1], atol=4e-16)
    tangents = arc_tangent([0, 1, 0, -1, 0], [1, 0, -1, 0, 0])
    assert_array_equal(tangents, [0, math.pi / 2, math.pi, -math.pi / 2, 0])


def test_nan_and_infinity_give_nan_and_no_warning() -> None:
    assert np.isnan(sin_cos([np.nan, np.inf, -np.inf])).all()


def test_the_arc_tangent_of_one_point_is_that_of_many_to_the_bit() -> None:
    odd = [0.0, -0.0, 1.0, -1.0, 1e-320, -1e308, math.inf, -math.inf, math.nan]
    y, x = np.repeat(odd, len(odd)), np.tile(odd, len(odd))
    with np.errstate(all="ignore"):
        many = arc_tangent(y, x)
    assert_array_equal(many, [arc_tangent(*pair) for pair in zip(y, x, strict=True)])
    assert_array_equal(np.signbit(many), np.signbit([arc_tangent(*pair) for pair in zip(y, x, strict=True)]))
