from __future__ import annotations

from typing import Any, get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from rigtri.maths import RotateOrder
from rigtri.maths.euler import from_angles, to_angles
from rigtri.maths.quaternions import from_axis_angle, multiply, to_axes

ORDERS = get_args(RotateOrder)
AXES = dict(zip("xyz", np.eye(3), strict=True))


def by_hand(angles: dict[str, float], order: RotateOrder) -> np.ndarray:
    """The axes after one rotation after the other, about fixed axes in the order."""
    first, second, third = (from_axis_angle(AXES[letter], angles[letter]) for letter in order)
    return to_axes(multiply(third, multiply(second, first)))


@pytest.mark.parametrize("order", ORDERS)
@given(whole=st.tuples(*[st.floats(-3.1, 3.1)] * 2), middle=st.floats(-1.5, 1.5))
def test_angles_come_back_from_their_rotation(
    order: RotateOrder, whole: tuple[float, ...], middle: float
) -> None:
    angles = dict(zip(order, (whole[0], middle, whole[1]), strict=True))
    row = [angles[letter] for letter in "xyz"]
    assert_allclose(to_angles(from_angles(row, order), order), row, atol=1e-9)
    assert_allclose(to_axes(from_angles(row, order)), by_hand(angles, order), atol=1e-12)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("middle", [np.pi / 2, -np.pi / 2])
def test_at_the_ends_of_the_middle_angle_the_last_is_zero(order: RotateOrder, middle: float) -> None:
    angles = dict(zip(order, (0.4, middle, 0.3), strict=True))
    rotation = from_angles([angles[letter] for letter in "xyz"], order)
    found = to_angles(rotation, order)
    assert found["xyz".index(order[2])] == 0.0
    assert_allclose(found["xyz".index(order[1])], middle, atol=1e-7)
    assert_allclose(to_axes(from_angles(found, order)), to_axes(rotation), atol=1e-7)


def test_a_quarter_about_x_takes_y_to_z() -> None:
    assert_allclose(to_axes(from_angles([np.pi / 2, 0.0, 0.0], "xyz"))[1], [0, 0, 1], atol=1e-15)


@pytest.mark.parametrize("order", ["abc", "xx", "xyx", ""])
def test_an_order_that_is_none_is_named(order: Any) -> None:
    for convert in (to_angles, from_angles):
        with pytest.raises(ValueError, match=f"'{order}' is not a valid order: use xyz, "):
            convert([0, 0, 0, 1][: 4 if convert is to_angles else 3], order)
