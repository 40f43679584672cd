"""Times of samples: the rate that keys fit, whole frames, steps, and as many as straight lines need."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from pxr import Usd

from rigtri.evaluation.adaptive_sampling import WITHIN
from rigtri.evaluation.sampling import sample
from rigtri.export.conversion.usd_samples import (
    frame_times,
    rate_of,
    sample_times,
    step_before,
    time_codes,
)
from rigtri.maths.matrices import compose
from rigtri.maths.quaternions import from_axis_angle, slerp, unit
from rigtri.model.animation import Clip, Track
from rigtri.verification.compare.across_formats import at_keys_of

STEP = float(Usd.TimeCode.SafeStep())
# The size of what the only node moves.
ONE = np.ones(1)


def track(*times: float, way: Any = "LINEAR", path: Any = "scale", values: Any = None) -> Track:
    keys = np.array(times)
    given = np.zeros((len(keys), 3)) if values is None else np.array(values, dtype=np.float64)
    return Track(0, path, way, keys, given)


@pytest.mark.parametrize(
    ("times", "rate"),
    [
        ([0.0, 0.5, 1.0], 24),
        ([0.0, 1 / 24], 24),
        ([0.0, 0.1], 30),
        ([1 / 60, 0.25], 60),
        ([0.04], 25),
        ([0.02], 50),
        ([1 / 48], 48),
        ([1 / 120], 120),
        ([0.01], 100),
        ([0.0123], 24),
        ([np.float32(1 / 30), np.float32(100 / 30)], 30),
        ([], 24),
    ],
)
def test_the_rate_is_the_first_that_has_all_keys_on_whole_frames(times: list[float], rate: float) -> None:
    half = len(times) // 2
    clips = [Clip("a", (track(*times[:half]),)), Clip("b", (track(*times[half:]),))]
    assert rate_of(clips) == rate


def test_what_is_on_a_whole_frame_but_for_rounding_is_made_so() -> None:
    seconds = np.array([0.0, np.float32(0.1), 0.2, 0.21, 1e6 + 1e-2], dtype=np.float64)
    assert_allclose(time_codes(seconds, 30.0), [0, 3, 6, 6.3, 30_000_000], rtol=0, atol=1e-12)
    # Samples that are nearer to each other than a hundredth of a frame stay where they are.
    near = np.array([0.1 + 1e-9, 0.1 + 2e-4, 0.2 + 1e-9])
    assert_allclose(time_codes(near, 30.0), [near[0] * 30, near[1] * 30, 6.0], rtol=0, atol=1e-12)


def test_the_sample_before_a_step_stays_right_before_it() -> None:
    keys = np.array([0.5, 1.0 / 3.0])
    for at in keys:
        seconds = np.array([0.0, at - step_before(np.array([at]))[0], at])
        zero, before, there = time_codes(seconds, 24.0).tolist()
        assert (zero, there) == (0.0, round(at * 24))
        assert 0 < there - before < 2 * STEP


def test_the_sample_before_a_step_that_is_not_put_on_its_frame_stays_before_it() -> None:
    """Another sample stands so near behind the step that this keeps its time: just below a whole frame."""
    there = float(np.float32(34.0 / 24.0))
    seconds = np.array([0.0, there - step_before(np.array([there]))[0], there, there + 2e-4])
    codes = time_codes(seconds, 24.0)
    assert (np.diff(codes) > 0).all()
    assert codes[2] == there * 24.0


def test_a_step_of_two_keys_in_float32_is_on_its_frame() -> None:
    """As glTF stores a jump at 22 frames of USD, and the sample before it."""
    there = np.float32(22.0 / 24.0)
    before = np.nextafter(np.nextafter(there, np.float32(0)), np.float32(0))
    codes = time_codes(np.array([0.0, before, there, 1.0], dtype=np.float64), 24.0)
    assert_allclose(codes, [0.0, 22.0 - STEP, 22.0, 24.0], rtol=0, atol=1e-12)


def test_lines_need_samples_at_their_keys_and_steps_one_more_before_each() -> None:
    assert sample_times([track(0.0, 1.0), track(0.5, 1.0)], ONE).tolist() == [0.0, 0.5, 1.0]
    found = sample_times([track(0.0, 1.0, 2.0, way="STEP")], ONE)
    assert found[[0, 2, 4]].tolist() == [0.0, 1.0, 2.0]
    assert_allclose(found[[2, 4]] - found[[1, 3]], STEP / 120.0, rtol=1e-3)
    spline = track(0.5, way="CUBICSPLINE", values=np.zeros((1, 3, 3)))
    assert sample_times([spline], ONE).tolist() == [0.5]
    assert len(sample_times([], ONE)) == 0
    assert_allclose(step_before(np.array([-1e6, 0.0, 1e6])), [1e-6, STEP / 120.0, 1e-6])


def curved(path: Any) -> Track:
    width = 4 if path == "rotation" else 3
    values = np.zeros((2, 3, width))
    if path == "rotation":
        values[:, 1] = from_axis_angle(np.array([0.0, 0.0, 1.0]), np.array([0.0, 2.0]))
        values[0, 2], values[1, 0] = (0.5, 0, 1.0, 0.2), (-1.0, 0.3, 0, 0)
    else:
        values[1, 1], values[0, 2] = (1, 2, 3), (3, 0, -2)
    return track(0.0, 2.0, way="CUBICSPLINE", path=path, values=values)


@pytest.mark.parametrize(("path", "size"), [("translation", 50.0), ("scale", 50.0), ("rotation", 50.0)])
def test_splines_get_as_many_samples_as_keep_the_motion(path: Any, size: float) -> None:
    one = curved(path)
    times = sample_times([one], np.array([size]))
    assert times[[0, -1]].tolist() == [0.0, 2.0]
    between = np.linspace(0.0, 2.0, 400)
    left = np.clip(np.searchsorted(times, between, side="right") - 1, 0, len(times) - 2)
    share = (between - times[left]) / (times[left + 1] - times[left])
    values, exact = sample(one, times), sample(one, between)
    if path == "rotation":
        lines = slerp(unit(values)[left], unit(values)[left + 1], share)
        exact = unit(exact)
        off = 2.0 * np.minimum(np.abs(lines - exact), np.abs(lines + exact)).max()
    else:
        lines = values[left] + (values[left + 1] - values[left]) * share[:, np.newaxis]
        off = np.abs(lines - exact).max()
    within = WITHIN * {"translation": size, "rotation": 1.0, "scale": np.abs(values).max()}[path]
    assert off < 1.5 * within
    # No more than are needed: with a third of them it is not.
    assert off > 0.02 * within
    assert len(sample_times([one], ONE)) >= len(times)
    if path == "translation":
        assert len(sample_times([one], ONE)) > 2 * len(times)


def test_small_scales_are_followed_as_closely_as_large_ones() -> None:
    one = curved("scale")
    small = one.having(one.values * 0.01)
    assert sample_times([small], ONE).tolist() == sample_times([one], ONE).tolist()


def test_a_frame_gets_samples_where_lines_and_arcs_do_not_follow_it_whatever_its_unit_and_scale() -> None:
    def bent(times: Any, unit: float, scale: float) -> Any:
        zero, one = np.zeros_like(times), np.ones_like(times)
        moves = np.stack([np.abs(times - 0.25), 3.0 * times, zero], axis=1) * unit
        turns = from_axis_angle([0.0, 1.0, 0.0], 2.0 * times)
        return compose(moves, turns, np.stack([one] * 3, axis=1) * scale)

    for size in (1e-4, 1.0, 1e4):
        for scale in (1e-4, 1.0, 1e4):
            found = frame_times(partial(bent, unit=size, scale=scale), np.array([0.0, 1.0]), 1e-3, size)
            assert 0.25 in found
            assert len(found) <= 5
    assert frame_times(partial(bent, unit=1.0, scale=1.0), np.array([0.5]), 1e-3, 1.0).tolist() == [0.5]


def test_samples_beside_a_key_stay_where_motion_is_fast_and_move_to_it_before_a_step() -> None:
    """Before, two samples that both lay near a key were one moment's, which a fast joint is not at twice."""
    key, near = 1.5, 1.5 - 1.2e-7
    moves = [[0.0], [200 * near], [200 * key], [600.0]]
    steps = [[0.0], [0.0], [1.0], [1.0]]

    def beside(values: list[list[float]]) -> Clip:
        return Clip(
            "clip", (Track(0, "translation", "LINEAR", np.array([0.0, near, key, 3.0]), np.array(values)),)
        )

    other = Clip("clip", (Track(0, "translation", "LINEAR", np.array([0.0, key, 3.0]), np.zeros((3, 1))),))
    (moving,), (stepping,) = (at_keys_of(beside(values), other).tracks for values in (moves, steps))
    assert moving.times.tolist() == [0.0, near, key, 3.0]
    assert stepping.times.tolist() == [0.0, np.nextafter(key, 0.0), key, 3.0]
