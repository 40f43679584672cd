"""Vectors: the arithmetic of the talk, one and many."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from strategies import directions, quaternions, vectors

from rigtri.maths import vectors as v
from rigtri.maths.quaternions import rotate
from rigtri.maths.scalar_vector import Vector
from rigtri.maths.trigonometry import Floats

# GDC 2018, appendices "The Dot Product" and "The Cross Product".
FIRST, SECOND = [-3.132, -4.317, 6.369], [-6.032, 5.884, 1.618]

OF_TWO = [v.dot, v.cross, v.distance, v.perpendicular, v.angle]


@pytest.mark.parametrize("function", OF_TWO)
@given(pairs=st.lists(st.tuples(directions, directions), min_size=1, max_size=5))
def test_one_pair_and_many_are_the_same_call(
    function: Callable[[Floats, Floats], Floats], pairs: list[tuple[Floats, Floats]]
) -> None:
    a, b = (np.stack(side) for side in zip(*pairs, strict=True))
    assert_array_equal(function(a, b), [function(one, other) for one, other in pairs])


@pytest.mark.parametrize("function", [v.length, v.normalise])
@given(many=st.lists(directions, min_size=1, max_size=5))
def test_one_vector_and_many_are_the_same_call(
    function: Callable[[Floats], Floats], many: list[Floats]
) -> None:
    assert_array_equal(function(np.stack(many)), [function(one) for one in many])


@given(directions, directions)
def test_a_cross_product_is_perpendicular_to_both(a: Floats, b: Floats) -> None:
    normal, size = v.cross(a, b), v.length(a) * v.length(b)
    assert abs(v.dot(normal, a)) <= 1e-12 * size * v.length(a)
    assert abs(v.dot(normal, b)) <= 1e-12 * size * v.length(b)
    assert_array_equal(v.cross(b, a), -normal)


@given(directions)
def test_a_normalised_vector_has_length_one_and_the_same_direction(a: Floats) -> None:
    unit = v.normalise(a)
    assert_allclose(v.length(unit), 1, rtol=4e-16)
    assert_allclose(unit * v.length(a), a, rtol=1e-14, atol=1e-14)


@given(directions, directions, quaternions)
def test_turning_both_vectors_keeps_length_distance_dot_and_angle(a: Floats, b: Floats, turn: Floats) -> None:
    turned_a, turned_b = rotate(turn, a), rotate(turn, b)
    scale = float(v.length(a) * v.length(b))
    assert_allclose(v.length(turned_a), v.length(a), rtol=1e-13)
    assert_allclose(v.distance(turned_a, turned_b), v.distance(a, b), atol=1e-9)
    assert_allclose(v.dot(turned_a, turned_b), v.dot(a, b), atol=1e-13 * scale)
    assert_allclose(v.angle(turned_a, turned_b), v.angle(a, b), atol=1e-7)


@given(directions, vectors)
def test_a_vector_is_its_part_along_another_and_its_part_across(a: Floats, b: Floats) -> None:
    across = v.perpendicular(b, a)
    assert abs(v.dot(across, a)) <= 1e-12 * v.length(a) * max(1.0, v.length(b))
    along = v.project(b, [0, 0, 0], a)
    assert_allclose(along + across, b, atol=1e-9)


def test_the_nearest_point_of_a_line_that_passes_the_origin_by() -> None:
    assert_allclose(v.project([4, 5, 1], [1, 1, 1], [3, 1, 1]), [4, 1, 1], rtol=0, atol=1e-15)
    many = v.project([[4, 5, 1], [0, 0, 7]], [1, 1, 1], [[3, 1, 1], [1, 1, 2]])
    assert_allclose(many, [[4, 1, 1], [1, 1, 7]], rtol=0, atol=1e-15)


def test_a_vector_from_one_point_to_another_is_destination_minus_origin() -> None:
    """GDC 2018, slide "Subtracting two vectors": from [2,3,1] to [5,4,3]."""
    destination, origin = v.as_vectors([5, 4, 3]), v.as_vectors([2, 3, 1])
    assert_array_equal(destination - origin, [3, 1, 2])
    assert v.distance(origin, destination) == np.sqrt(14)
    assert v.length([3, 1, 2]) == np.sqrt(14)


def test_vectors_are_reversed_added_and_averaged_number_by_number() -> None:
    """GDC 2018, slides "Reverse" and "Adding two vectors"."""
    a, b = v.as_vectors([5, 4, 3]), v.as_vectors([2, 3, 1])
    assert_array_equal(a * -1, [-5, -4, -3])
    assert_array_equal(a + b, [7, 7, 4])
    assert_array_equal((a + b) / 2, [3.5, 3.5, 2])


def test_the_talks_length_is_the_root_of_the_squares() -> None:
    """GDC 2018, appendix "Distance and Length": [1,2,3]."""
    assert v.length([1, 2, 3]) == np.sqrt(14)


def test_the_dot_product_of_the_appendix() -> None:
    # -3.132 * -6.032 - 4.317 * 5.884 + 6.369 * 1.618 = 18.892224 - 25.401228 + 10.305042
    assert_allclose(v.dot(FIRST, SECOND), 3.796038, rtol=0, atol=1e-12)
    normalised = v.dot(v.normalise(FIRST), v.normalise(SECOND))
    assert_allclose(normalised, 0.0532554, rtol=0, atol=1e-7)


def test_the_cross_product_of_the_appendix() -> None:
    # x = -4.317 * 1.618 - 6.369 * 5.884 = -6.984906 - 37.475196, and so on
    raw = [-44.460102, -33.350232, -44.468832]
    assert_allclose(v.cross(FIRST, SECOND), raw, rtol=0, atol=1e-12)
    normalised = v.cross(v.normalise(FIRST), v.normalise(SECOND))
    assert_allclose(normalised, [-0.6237396, -0.4678770, -0.6238621], rtol=0, atol=1e-7)


def test_the_dot_product_separates_same_perpendicular_and_opposite() -> None:
    """GDC 2018, slide "The Dot Product": 1, 0 and -1."""
    x = [1, 0, 0]
    assert [float(v.dot(x, other)) for other in ([1, 0, 0], [0, 1, 0], [-1, 0, 0])] == [1, 0, -1]


def test_right_crossed_with_up_comes_at_you() -> None:
    """GDC 2018, slide "right-handed coordinate system"."""
    assert_array_equal(v.cross([1, 0, 0], [0, 1, 0]), [0, 0, 1])


def test_an_angle_is_measured_where_the_arc_cosine_sees_none() -> None:
    assert_allclose(v.angle([1, 0, 0], [1, 1e-9, 0]), 1e-9, rtol=1e-12)
    assert np.arccos(np.dot([1, 0, 0], v.normalise([1, 1e-9, 0]))) == 0


@pytest.mark.parametrize("size", [1e-200, 1e200])
def test_a_tiny_and_a_huge_vector_still_have_a_direction(size: float) -> None:
    assert_allclose(v.normalise([3 * size, 4 * size, 0]), [0.6, 0.8, 0], rtol=1e-15)


def test_what_has_no_direction_is_nan_and_warns_nobody() -> None:
    assert np.isnan(v.normalise([0, 0, 0])).all()
    assert np.isnan(v.project([1, 2, 3], [1, 1, 1], [1, 1, 1])).all()
    assert_array_equal(v.perpendicular([1, 2, 3], [0, 0, 0]), [1, 2, 3])


def test_two_numbers_are_no_vector() -> None:
    with pytest.raises(ValueError, match=r"shape \(2,\)"):
        v.as_vectors([1, 2])


def test_components_of_many_vectors_lie_in_one_row_of_memory() -> None:
    for shape, kept in (((7, 3), 1), ((7, 5, 4, 4), 2), ((3,), 1), ((0, 3), 1)):
        made = v.by_component(shape, kept)
        assert made.shape == shape
        assert np.moveaxis(made, range(-kept, 0), range(kept)).flags.c_contiguous
    crossed = v.cross(np.ones((7, 3)), [1.0, 2.0, 3.0])
    assert crossed[:, 0].flags.c_contiguous


@given(vectors)
def test_one_vector_in_plain_numbers_is_normalised_to_the_same_bits(a: Floats) -> None:
    plain = v.unit_of(a.tolist())
    assert_array_equal(v.normalise(a), [np.nan] * 3 if plain is None else plain)


@given(vectors, vectors)
def test_one_place_in_plain_numbers_is_as_one_in_an_array_to_the_same_bits(a: Floats, b: Floats) -> None:
    one, other = Vector(*a.tolist()), Vector(*b.tolist())
    assert_array_equal([*(one - other)], a - b)
    assert_array_equal([*(one + other * 0.5)], a + b * 0.5)
    assert_array_equal([*one.cross(other)], v.cross(a, b))
    assert one.dot(-other) == -v.dot(a, b)
    assert one.length == v.length(a)
    assert one.distance(other) == v.distance(a, b)
    assert_array_equal([*one.unit], np.nan_to_num(v.normalise(a)))


def test_what_has_no_direction_is_none_in_plain_numbers() -> None:
    for numbers in ([0.0, 0.0, 0.0], [np.nan, 1.0, 0.0], [1.0, np.nan, 0.0], [1.0, np.inf, 0.0]):
        assert v.unit_of(numbers) is None
        assert np.isnan(v.normalise(np.array(numbers))).any()


@pytest.mark.parametrize("value", [np.zeros(2), np.zeros((3, 4)), [1.0, 2.0], 1.0], ids=repr)
def test_what_has_not_three_numbers_is_no_vector(value: Any) -> None:
    with pytest.raises(ValueError, match="vectors have three numbers"):
        v.as_vectors(value)
