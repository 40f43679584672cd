"""Keys that are needed: lines between them tell all others, and no player has to guess the way of a turn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from baked_rigs import control, rigged

from rigtri.evaluation.key_reduction import WIDEST_TURN, _off_their_neighbours, reduce_keys
from rigtri.maths.quaternions import conjugate, from_axis_angle, multiply, rotation_angle, slerp, unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.operations.bake.bake import BakeOptions, bake


def turning(degrees: float, count: int) -> Floats:
    """Quaternions of a steady turn about a slanted axis, (count, 4)."""
    axis = np.array([0.6, 0.8, 0.0])
    return np.array([from_axis_angle(axis, a) for a in np.linspace(0.0, np.radians(degrees), count)])


def widest(turns: Floats) -> float:
    return float(rotation_angle(multiply(conjugate(turns[:-1]), turns[1:])).max())


@pytest.mark.parametrize("degrees", [40.0, 79.0, 81.0, 90.0, 170.0, 360.0, 1000.0])
@pytest.mark.parametrize("count", [13, 100, 1001])
def test_rotations_between_keys_are_narrower_than_a_quarter_turn(degrees: float, count: int) -> None:
    assert np.radians(90.0) > WIDEST_TURN
    times, turns = np.linspace(0.0, 3.0, count), turning(degrees, count)
    keys = reduce_keys(times, turns, 1e-6)
    assert widest(turns[keys]) <= max(WIDEST_TURN * 1.001, np.radians(degrees) / (count - 1) * 1.001)
    assert {0, count - 1} <= set(keys.tolist())
    # No more than that asks for: any two gaps together would be too wide.
    if np.radians(degrees) / (count - 1) < WIDEST_TURN:
        pairs = rotation_angle(multiply(conjugate(turns[keys][:-2]), turns[keys][2:]))
        assert (pairs > WIDEST_TURN * 0.999).all()


@pytest.mark.parametrize("count", [2, 3, 5, 9])
def test_keys_that_are_wide_apart_in_the_source_all_stay(count: int) -> None:
    """Quarter turns: a player that finds the way between each would not between every second one."""
    turns = turning(90.0 * (count - 1), count)
    keys = reduce_keys(np.arange(count, dtype=np.float64), turns, 1e-6)
    np.testing.assert_array_equal(keys, np.arange(count))


@pytest.mark.parametrize("count", [10, 19, 37, 500])
def test_reduced_rotations_are_not_reduced_again(count: int) -> None:
    """Also where keys are exactly as far apart as may be, but for rounding."""
    times = np.linspace(0.0, 2.0, count)
    turns = turning(720.0, count).astype(np.float32).astype(np.float64)
    keys = reduce_keys(times, turns, 1e-6)
    np.testing.assert_array_equal(reduce_keys(times[keys], turns[keys], 1e-6), np.arange(len(keys)))


@pytest.mark.ci
def test_controls_of_a_spinning_character_rotate_less_than_a_quarter_between_keys() -> None:
    rig = rigged()
    hips = rig.find("hips")
    times = np.linspace(0.0, 2.0, 33)
    turns = multiply(rig.rotation[hips], turning(720.0, 33))
    spin = Track(hips, "rotation", "LINEAR", times, turns)
    done = bake(replace(rig, clips=(Clip("spin", (spin,)),)), options=BakeOptions(to="controls"))
    track = next(
        t for t in done.clips[0].tracks if (t.node, t.path) == (control(done, "hips", "fk"), "rotation")
    )
    assert widest(track.values) <= WIDEST_TURN * 1.001
    assert len(track.times) < 33


@pytest.mark.parametrize("bound", [0.0, 1e-6, 1e-3, 0.3, 1.0, 3.0])
@pytest.mark.parametrize("wild", [1e-6, 1e-3, 0.1, 1.0])
def test_distances_choose_the_same_keys_as_angles_do(wild: float, bound: float) -> None:
    random = np.random.default_rng(3)
    for _ in range(20):
        times = np.cumsum(random.uniform(0.01, 1.0, 40))
        turns = unit(np.cumsum(random.normal(size=(40, 4)) * wild, axis=0) + random.normal(size=4))
        turns = turns.astype(np.float32).astype(np.float64)
        share = (times[1:-1] - times[:-2]) / (times[2:] - times[:-2])
        line = slerp(turns[:-2], turns[2:], share)
        off = rotation_angle(multiply(conjugate(line), turns[1:-1]))
        np.testing.assert_array_equal(_off_their_neighbours(times, turns, bound), off > bound)
