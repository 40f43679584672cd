"""Keys where a motion bends: no more than a file should hold."""

from __future__ import annotations

import itertools
from collections.abc import Mapping

import numpy as np
import pytest

from rigtri.errors import GeometryError
from rigtri.evaluation.adaptive_sampling import MOST_KEYS, adaptive_key_times
from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.curve_refinement import Deviation, refine_samples
from rigtri.maths.trigonometry import Floats


def test_a_motion_that_no_keys_follow_is_an_error_of_the_geometry() -> None:
    """What halves are off falls to four tenths: a motion that is smooth nowhere."""
    fewer = itertools.count()
    with pytest.raises(GeometryError, match=f"'hand': more than {MOST_KEYS} keys would be needed"):
        adaptive_key_times(
            lambda times: times[:, np.newaxis],
            lambda values, left, right, share, times: np.full(len(times), 1e9 * 0.8 ** next(fewer)),
            np.arange(40.0),
            within=0.1,
            of="'hand'",
        )


@pytest.mark.parametrize("large", [1e11, 1e13])
def test_what_rounding_alone_moves_is_an_error_before_many_keys_are_made(large: float) -> None:
    asked: list[int] = []

    def sample(times: Floats) -> Floats:
        asked.append(len(times))
        far = large * np.sin(times)
        return (far + np.cos(times) - far)[:, np.newaxis]

    with pytest.raises(GeometryError, match=r"^'hand': rounding alone is more than keys may be off, 1e-06,"):
        adaptive_key_times(sample, _off_a_line, np.arange(4.0), within=1e-6, of="'hand'")
    assert sum(asked) < 20_000


@pytest.mark.parametrize("steps", [1, 70])
def test_corners_and_steps_are_no_rounding(steps: int) -> None:
    """Where a step is stays one gap, however often that is halved."""
    places = np.linspace(0.1, 3.9, steps)

    def sample(times: Floats) -> Floats:
        return np.stack([np.searchsorted(places, times), np.abs(times - 1.3), np.sin(9 * times)], axis=1)

    times = adaptive_key_times(sample, _off_a_line, np.arange(5.0), within=1e-6)
    assert len(times) < 30_000


def _off_a_line(values: Floats, left: Floats, right: Floats, share: Floats, _times: Floats) -> Floats:
    line = left + (right - left) * share[:, np.newaxis]
    return np.asarray(np.abs(values - line).max(axis=1))


class _Parabola:
    """A curve x = t², whose deviation from lines is known: a quarter of the square of an interval."""

    def at(self, times: Floats) -> dict[int, Parts]:
        places = np.stack([times**2, 0 * times, 0 * times], axis=1)
        return {3: Parts(places, np.tile([0.0, 0, 0, 1], (len(times), 1)), np.ones((len(times), 3)))}

    def off(self, times: Floats, shown: Mapping[int, Parts]) -> Deviation:
        return Deviation(np.abs(shown[3].translation[:, 0] - times**2), np.full(len(times), 3))


def test_intervals_are_divided_until_lines_are_near_enough_and_no_further() -> None:
    found = refine_samples(_Parabola(), np.array([0.0, 0.25, 2.25]), bound=0.02, per_second=1.0)
    spans = np.diff(found.times)
    assert found.times[[0, 1, -1]].tolist() == [0.0, 0.25, 2.25]
    assert spans[1:].tolist() == [0.25] * 8
    assert found.off == pytest.approx(0.25**2 / 4)
    assert (found.limited, found.node) == (False, 3)
    np.testing.assert_allclose(found.parts[3].translation[:, 0], found.times**2)


def test_time_codes_that_are_no_seconds_are_refined_all_the_same() -> None:
    """USD allows 0 time codes per second."""
    found = refine_samples(_Parabola(), np.array([0.0, 2.0]), bound=0.02, per_second=0.0)
    assert (len(found.times), found.limited) == (9, False)
