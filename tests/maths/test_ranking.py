"""Orders, and choices of the largest, that rounding does not turn."""

from __future__ import annotations

import numpy as np
import pytest

from rigtri.maths.ranking import axis_across, first_largest, largest, ranked


@pytest.mark.parametrize(
    ("values", "order"),
    [
        ([], []),
        ([1.0], [0]),
        ([1.0, 3.0, 2.0], [1, 2, 0]),
        ([1.0, 1.05, 1.2], [2, 0, 1]),  # the first two are one
        ([1.05, 1.0, 0.93, 0.0], [0, 1, 2, 3]),  # 0.93 is no more one with the largest
        ([0.93, 1.0, 1.05], [1, 2, 0]),
        ([1.0, 1.1], [1, 0]),
        ([-1.0, -0.95], [0, 1]),
        ([1.0, np.nan, np.inf, 2.0], [1, 2, 3, 0]),
    ],
)
def test_values_that_differ_by_less_stay_in_order(values: list[float], order: list[int]) -> None:
    assert ranked(range(len(values)), lambda k: values[k], 0.1) == order


@pytest.mark.parametrize("noise", [1e-9, -1e-9])
def test_rounding_does_not_choose_the_largest(noise: float) -> None:
    assert first_largest([1.0, 50.0, 50.0 + noise]) == 1
    assert first_largest([-3.0, -2.0 + noise, -2.0]) == 1
    assert largest("abc", {"a": 0.0, "b": 7.0 + noise, "c": 7.0}.__getitem__) == "b"
    assert first_largest([0.0, 50.0, 50.1]) == 2


def test_what_is_infinite_is_the_largest() -> None:
    assert first_largest([1.0, np.inf, np.inf]) == 1


@pytest.mark.parametrize("noise", [1e-9, -1e-9])
def test_rounding_does_not_choose_the_axis_across_a_direction(noise: float) -> None:
    assert axis_across([[noise, -1.0, 0.0], [1.0, noise, 0.0]]).tolist() == [[1, 0, 0], [0, 1, 0]]
