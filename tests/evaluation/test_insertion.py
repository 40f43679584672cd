"""Keys put into tracks: splines keep their curve, and only the neighbourhood of a new key changes."""

from __future__ import annotations

import numpy as np
import pytest

from rigtri.evaluation.key_insertion import insert_keys, subdivide_spline
from rigtri.evaluation.sampling import sample
from rigtri.maths.quaternions import from_axis_angle, multiply, rotation_angle
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Path, Track

TIMES = np.array([0.0, 0.5, 2.0, 2.25])


def spline(path: Path = "translation") -> Track:
    made = np.random.default_rng(5)
    if path == "rotation":
        turns = from_axis_angle([0.2, 1.0, 0.4], np.array([0.0, 0.8, -0.5, 1.1]))
        values = np.stack([made.normal(size=(4, 4)), turns, made.normal(size=(4, 4))], axis=1)
    else:
        values = made.normal(size=(4, 3, 3))
    return Track(0, path, "CUBICSPLINE", TIMES, values)


def between(start: float, end: float) -> Floats:
    return np.linspace(start, end, 101)


@pytest.mark.parametrize("path", ["translation", "rotation"])
def test_a_spline_that_is_split_anywhere_is_the_same_spline(path: Path) -> None:
    track = spline(path)
    times = np.union1d(TIMES, [-1.0, 0.1, 0.3, 1.9, 2.1, 5.0])
    again = Track(0, path, "CUBICSPLINE", times, subdivide_spline(track, times))
    at = between(-2.0, 6.0)
    np.testing.assert_allclose(sample(again, at), sample(track, at), atol=1e-13)


@pytest.mark.parametrize("path", ["translation", "rotation"])
def test_a_new_key_of_a_spline_moves_nothing_beyond_its_neighbours(path: Path) -> None:
    track = spline(path)
    now = sample(track, [1.0])
    wanted = multiply(now, from_axis_angle([1.0, 0.0, 0.0], 0.3)) if path == "rotation" else now + 0.5
    done = insert_keys(track, np.array([1.0]), wanted)
    np.testing.assert_allclose(sample(done, [1.0]), wanted, atol=1e-15)
    np.testing.assert_array_equal(done.times, [0.0, 0.5, 1.0, 2.0, 2.25])
    for at in (between(-1.0, 0.5), between(2.0, 3.0)):
        np.testing.assert_array_equal(sample(done, at), sample(track, at))
    # The old keys keep their numbers, and the curve is as fast through the new key as before.
    np.testing.assert_array_equal(done.values[[0, 1, 3, 4]], track.values)
    step = np.array([0.999999, 1.000001])
    if path == "translation":
        fast = [np.diff(sample(each, step), axis=0) for each in (track, done)]
        np.testing.assert_allclose(fast[0], fast[1], atol=1e-10)
    else:
        assert abs(np.linalg.norm(done.values[2, 1]) - 1.0) < 1e-15
        speed = [
            float(rotation_angle(multiply(b * [-1, -1, -1, 1], a)))
            for a, b in (sample(each, step) for each in (track, done))
        ]
        assert speed[0] == pytest.approx(speed[1], rel=1e-3)


def test_a_spline_halved_by_hand() -> None:
    # x = 3u² − 2u³ over two seconds: at one second 0.5, and 0.75 a second fast.
    values = np.array([[[0.0] * 3] * 3, [[0.0] * 3, [1.0, 0, 0], [0.0] * 3]])
    found = subdivide_spline(
        Track(0, "translation", "CUBICSPLINE", np.array([0.0, 2.0]), values), np.arange(3.0)
    )
    np.testing.assert_allclose(found[1], [[0.75, 0, 0], [0.5, 0, 0], [0.75, 0, 0]])


def test_keys_beyond_the_ends_leave_what_lies_between_the_old_ones() -> None:
    track = spline()
    done = insert_keys(track, np.array([-1.0, 4.0]), np.array([[1.0, 2, 3], [4.0, 5, 6]]))
    at = between(0.0, 2.25)
    np.testing.assert_array_equal(sample(done, at), sample(track, at))
    np.testing.assert_array_equal(sample(done, [-1.0, 4.0]), [[1, 2, 3], [4, 5, 6]])


def test_lines_and_steps_take_keys_too() -> None:
    for way in ("LINEAR", "STEP"):
        track = Track(0, "scale", way, np.array([0.0, 2.0]), np.array([[1.0] * 3, [3.0] * 3]))
        done = insert_keys(track, np.array([1.0]), np.array([[5.0] * 3]))
        assert done.interpolation == way
        np.testing.assert_array_equal(done.values[:, 0], [1, 5, 3])
    alone = Track(0, "scale", "CUBICSPLINE", np.array([0.0]), np.ones((1, 3, 3)))
    assert insert_keys(alone, np.array([0.0]), np.array([[2.0] * 3])).interpolation == "STEP"
    assert insert_keys(alone, np.array([1.0]), np.array([[2.0] * 3])).interpolation == "LINEAR"


def test_a_track_of_one_key_becomes_a_line_and_one_of_none_a_step() -> None:
    for way in ("STEP", "CUBICSPLINE"):
        values = np.array([[[9.0, 9, 9], [1, 2, 3], [9, 9, 9]]] if way == "CUBICSPLINE" else [[1.0, 2, 3]])
        done = insert_keys(
            Track(0, "translation", way, np.array([0.5]), values), np.array([2.0]), np.ones((1, 3))
        )
        assert done.interpolation == "LINEAR"
        assert done.times.tolist() == [0.5, 2.0]
        assert done.values.tolist() == [[1.0, 2.0, 3.0], [1.0, 1.0, 1.0]]
        same = insert_keys(
            Track(0, "translation", way, np.array([0.5]), values), np.array([0.5]), np.ones((1, 3))
        )
        assert (same.interpolation, same.values.tolist()) == ("STEP", [[1.0, 1.0, 1.0]])


def test_a_key_of_a_spline_that_turns_keeps_its_tangents_in_the_turned_frame() -> None:
    """A key twice as long as a unit one; the new value is given with the other sign."""
    still = np.array([0.0, 0.0, 0.0, 1.0])
    rows = np.zeros((2, 3, 4))
    rows[1, 1] = still
    rows[0, [0, 2]] = [[2.0, 0, 0, 0], [0, 6.0, 0, 0]]
    rows[0, 1] = 2.0 * still
    half = np.array([0.0, 0.0, 1.0, 0.0])  # half a turn about z
    done = insert_keys(
        Track(0, "rotation", "CUBICSPLINE", np.array([0.0, 1.0]), rows), np.zeros(1), half[np.newaxis]
    )
    # z times x is y, z times y is -x, of tangents half as long.
    assert done.values[0].tolist() == [[0.0, 1.0, 0.0, 0.0], half.tolist(), [-3.0, 0.0, 0.0, 0.0]]
    near = np.array([0.0, 0.0, -0.6, -0.8])
    done = insert_keys(
        Track(0, "rotation", "CUBICSPLINE", np.array([0.0, 1.0]), rows), np.zeros(1), near[np.newaxis]
    )
    assert done.values[0, 1].tolist() == [0.0, 0.0, 0.6, 0.8]


def test_a_key_of_a_spline_that_is_no_rotation_takes_the_value_as_it_is() -> None:
    rows = np.zeros((2, 3, 4))
    rows[1, 1] = [0.0, 0.0, 0.0, 1.0]
    turned = np.array([[0.0, 0.6, 0.0, 0.8]])
    done = insert_keys(Track(0, "rotation", "CUBICSPLINE", np.array([0.0, 1.0]), rows), np.zeros(1), turned)
    assert np.isfinite(done.values).all()
