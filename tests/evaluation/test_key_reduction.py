"""How far keys may be off, and which of them straight lines need, by hand and by a plain loop."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rigs import chain

from rigtri.evaluation.key_reduction import key_tolerances, lever_arms, parent_sizes, reduce_keys
from rigtri.maths.quaternions import angle_between, from_axis_angle, slerp
from rigtri.maths.trigonometry import Floats

Z = np.array([0.0, 0.0, 1.0])


def test_a_node_reaches_as_far_as_the_nodes_below_it_and_a_twentieth_at_least() -> None:
    rig = chain((0, 0, 0), (3, 0, 0), (3, 4, 0), (3, 4, 1))
    assert_allclose(lever_arms(rig, 10.0), [8.5, 5.5, 1.5, 0.5])
    rig = chain((0, 0, 0), (0.1, 0, 0))
    assert_allclose(lever_arms(rig, 10.0), [0.6, 0.5])


def test_keys_may_be_off_by_an_equal_share_of_all_joints_in_a_line() -> None:
    rig = chain((0, 0, 0), (3, 0, 0), (3, 4, 0))
    rig.scale[0], rig.scale[1] = 2.0, (1.0, 3.0, 1.0)
    assert_allclose(parent_sizes(rig), [1, 2, 6])
    moves, turns = key_tolerances(rig, 0.6, 10.0)
    assert_allclose(moves, np.array([0.1, 0.05, 0.1 / 6]))
    assert_allclose(turns, 0.1 / lever_arms(rig, 10.0))


def lines(times: Floats, values: Floats, keys: Any) -> Floats:
    """Straight lines between keys, or great arcs."""
    right = np.clip(np.searchsorted(keys, np.arange(len(times)), side="right"), 1, len(keys) - 1)
    start, end = keys[right - 1], keys[right]
    share = (times - times[start]) / (times[end] - times[start])
    if values.shape[1] == 4:
        return slerp(values[start], values[end], share)
    found: Floats = values[start] + (values[end] - values[start]) * share[:, np.newaxis]
    return found


def far(a: Floats, b: Floats) -> Floats:
    found: Floats = angle_between(a, b) if a.shape[1] == 4 else np.abs(a - b).max(axis=1)
    return found


def test_a_line_needs_its_ends_and_what_stands_still_one_key() -> None:
    times = np.array([0.0, 0.1, 0.5, 0.7, 2.0])
    assert reduce_keys(times, times[:, np.newaxis] * [[1.0, -2.0]], 1e-9).tolist() == [0, 4]
    assert reduce_keys(times, np.ones((5, 3)), 1e-9).tolist() == [0]
    assert reduce_keys(times[:1], np.ones((1, 3)), 1e-9).tolist() == [0]
    nearly = np.array([[0.0], [0.01], [-0.01], [0.0], [0.01]])
    assert reduce_keys(times, nearly, 0.02).tolist() == [0]
    assert reduce_keys(times, nearly, 0.005)[0] == 0
    assert len(reduce_keys(times, nearly, 0.005)) > 2


def test_a_corner_is_a_key_and_a_small_one_is_none() -> None:
    times = np.arange(5.0)
    corner = np.array([[0.0], [1.0], [2.0], [1.0], [0.0]])
    assert reduce_keys(times, corner, 0.1).tolist() == [0, 2, 4]
    late = np.array([[0.0], [0.0], [0.0], [0.0], [5.0]])
    assert reduce_keys(times, late, 0.1).tolist() == [0, 3, 4]
    small = np.array([[0.0], [1.0], [2.05], [3.0], [4.0]])
    assert reduce_keys(times, small, 0.1).tolist() == [0, 4]
    assert 2 in reduce_keys(times, small, 0.01)


@pytest.mark.parametrize("kind", ["moves", "turns"])
@pytest.mark.parametrize("bound", [1e-3, 0.05, 0.3])
@pytest.mark.parametrize("seed", range(3))
def test_lines_between_keys_come_as_near_as_asked(kind: str, bound: float, seed: int) -> None:
    made = np.random.default_rng(seed)
    times = np.cumsum(made.uniform(0.01, 0.1, 60))
    waves = np.cumsum(made.normal(size=60) * 0.05)
    if kind == "turns":
        values = from_axis_angle(Z, waves * 3.0)
        values[::7] *= -1.0
    else:
        values = np.stack([waves, np.sin(7 * times), 0.0 * times], axis=1)
    keys = reduce_keys(times, values, bound)
    assert keys[0] == 0
    if len(keys) > 1:
        assert keys[-1] == 59
        assert (far(lines(times, values, keys), values) <= bound + 1e-9).all()
    else:
        assert (far(values, np.repeat(values[:1], 60, axis=0)) <= bound).all()
    assert len(keys) < 60 or bound < 0.01


def test_a_turn_that_one_arc_would_make_the_other_way_round_gets_more_keys() -> None:
    times = np.linspace(0.0, 1.0, 101)
    values = from_axis_angle(Z, times * 5.0)
    keys = reduce_keys(times, values, 1e-6)
    angles = np.diff(times[keys]) * 5.0
    assert angles.max() < 2.0
    assert len(keys) <= 7
    assert (far(lines(times, values, keys), values) < 1e-6).all()
