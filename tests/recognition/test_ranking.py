"""An order of the best first that rounding does not turn."""

from __future__ import annotations

import pytest

from rigtri.recognition.ranking import ranked


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
    ],
)
def test_values_that_differ_by_less_stay_in_order(values: list[float], order: list[int]) -> None:
    assert ranked(range(len(values)), lambda k: values[k], 0.1) == order
