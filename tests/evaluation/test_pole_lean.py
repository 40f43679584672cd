"""Limbs that rest bent beside their pole: by how much, and how they turn to it, by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from rigtri.evaluation.pole_lean import lean_at_rest, leaned, leaning, turning_way

X, Y, Z = np.eye(3)


def off(degrees: float) -> Any:
    """A direction in the plane of y and z."""
    return np.cos(np.radians(degrees)) * Y + np.sin(np.radians(degrees)) * Z


@pytest.mark.parametrize(
    ("degrees", "height", "lean"),
    [
        (30, 0.05, 30),
        (-30, 0.05, -30),
        (150, 0.05, 150),
        (180, 0.05, 180),
        (-179.99, 0.05, 179.99),  # half a turn is one way round
        (0.05, 0.05, 0),  # rounding
        (0.06, 0.05, 0.06),
        (30, 0.07, 0),  # bent so much that its bend is meant
        (30, 0.002, 0),  # nearly straight, to the pole's half
        (150, 0.002, 150),
        (30, 0.0021, 30),
        (150, 5e-6, 0),  # a bend that is rounding
    ],
)
@pytest.mark.parametrize("size", [1.0, 20.0])
def test_a_lean_is_the_angle_from_the_pole_to_a_slight_bend(
    degrees: float, height: float, lean: float, size: float
) -> None:
    found = np.degrees(lean_at_rest(off(degrees) * height * size, Y * 3.0 * size, X, size))
    assert_allclose(found, lean, atol=1e-9)


def test_a_pole_on_the_line_gives_no_lean() -> None:
    assert lean_at_rest(off(30) * 0.05, Y * 1e-6, X, 1.0) == 0.0
    assert lean_at_rest(off(30) * 0.05, Y * 2e-5, X, 1.0) == pytest.approx(np.radians(30))


def test_a_limb_leans_as_at_rest_until_it_is_bent_more_and_then_turns_to_its_pole() -> None:
    # At rest its end is a hundredth short of straight; it has turned 8 of them nearer.
    assert turning_way(0.99) == pytest.approx(0.08)
    assert turning_way(1.0) == pytest.approx(8e-5)
    total = np.full(6, 2.0)
    reach = 2.0 * np.array([1.0, 0.99, 0.97, 0.95, 0.91, 0.5])
    quarter = 0.5 + 0.5 * np.cos(np.pi / 4)
    found = leaning(reach, total, 0.99, 0.4)
    assert_allclose(found, 0.4 * np.array([1.0, 1.0, quarter, 0.5, 0.0, 0.0]), atol=1e-12)
    assert leaning(reach, total, 0.99, 0.0) is None
    assert_allclose(leaning(np.zeros(1), np.zeros(1), 0.99, 0.4), [0.0], atol=1e-15)


def test_directions_turn_about_the_line() -> None:
    bends, along = np.array([Y, Y, Z]), np.array([X, X, X])
    assert leaned(bends, along, None) is bends
    found = leaned(bends, along, np.radians([30.0, -90.0, 90.0]))
    assert_allclose(found, [off(30), -Z, -Y], atol=1e-12)
