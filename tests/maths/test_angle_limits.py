"""Limits of angles are a hundredth of a degree below the round ones that people build and key."""

from __future__ import annotations

import math

import pytest

from rigtri.maths.angle_limits import cosine_below, radians_below, sine_below


@pytest.mark.parametrize("degrees", [1.0, 30.0, 60.0, 90.0, 135.0])
def test_limits_are_a_hundredth_of_a_degree_below_round_angles(degrees: float) -> None:
    below = math.radians(degrees - 0.01)
    assert radians_below(degrees) == pytest.approx(below, rel=1e-15)
    assert sine_below(degrees) == pytest.approx(math.sin(below), rel=1e-14)
    assert cosine_below(degrees) == pytest.approx(math.cos(below), rel=1e-12)
    assert cosine_below(degrees) > math.cos(math.radians(degrees))
