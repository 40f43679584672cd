"""Weights of points limited, fitted to a type, and shared anew along a bone, by hand."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from rigtri.model.skin import WeightLimit
from rigtri.model.skin_weights import folded, limited, within

JOINTS = np.array([[4, 7, 1, 9, 2]])


def one(weights: list[float], limit: WeightLimit, full: int = 0) -> tuple[list[int], list[float]]:
    joints, found = limited(JOINTS, np.array([weights]), limit, full=full)
    return joints[0].tolist(), found[0].tolist()


def test_the_largest_weights_stay_and_sum_to_what_they_did() -> None:
    joints, weights = one([0.1, 0.4, 0.2, 0.05, 0.05], WeightLimit(2, normalise=False))
    assert joints == [7, 1, 0, 0]
    assert_allclose(weights, [0.8 * 2 / 3, 0.8 / 3, 0, 0])
    joints, weights = one([0.1, 0.4, 0.2, 0.05, 0.05], WeightLimit(2, normalise=True))
    assert joints == [7, 1, 0, 0]
    assert_allclose(weights, [2 / 3, 1 / 3, 0, 0])


def test_points_with_so_few_joints_keep_theirs_but_for_their_sum_on_request() -> None:
    few = [0.0, 0.25, 0.0, 0.25, 0.0]
    assert one(few, WeightLimit(2, normalise=False)) == ([4, 7, 1, 9], few[:4])
    joints, weights = one(few, WeightLimit(2, normalise=True))
    assert joints[:2] == [7, 9]
    assert weights == [0.5, 0.5, 0.0, 0.0]
    # One in the last column moves to where it is kept.
    assert one([0.0, 0.0, 0.0, 0.0, 1.0], WeightLimit(2, normalise=False)) == (
        [2, 0, 0, 0],
        [1.0, 0.0, 0.0, 0.0],
    )
    assert one([0.0] * 5, WeightLimit(2, normalise=True))[1] == [0.0] * 4


def test_a_joint_that_is_named_twice_counts_once() -> None:
    joints = np.array([[4, 7, 4, 9, 2]])
    found = limited(joints, np.array([[0.25, 0.3, 0.25, 0.1, 0.1]]), WeightLimit(1, normalise=False))
    assert found[0][0, 0] == 4
    assert_allclose(found[1][0], [1.0, 0, 0, 0])


def test_weights_that_are_no_numbers_stay_as_they_are() -> None:
    weights = [np.nan, 0.5, 0.5, 0.5, 0.5]
    joints, found = one(weights, WeightLimit(2, normalise=True))
    assert joints == JOINTS[0].tolist()
    np.testing.assert_array_equal(found, weights)


def test_whole_weights_stay_whole_and_sum_to_all() -> None:
    joints, weights = one([100.0, 80.0, 40.0, 25.0, 10.0], WeightLimit(3, normalise=False), 255)
    assert joints == [4, 7, 1, 0]
    # 255/220 of each is 115.9, 92.7 and 46.4.
    assert weights == [116.0, 93.0, 46.0, 0.0]
    assert one([250.0, 5.0, 0.0, 0.0, 0.0], WeightLimit(3, normalise=True), 255)[1] == [250.0, 5.0, 0.0, 0.0]
    assert sum(one([200.0, 5.0, 0.0, 0.0, 0.0], WeightLimit(3, normalise=True), 255)[1]) == 255.0


@pytest.mark.parametrize(
    ("weights", "fitting"),
    [
        ([200.0, 55.0, 0.0], [200.0, 55.0, 0.0]),
        ([255.0, 255.0, 255.0], [255.0, 255.0, 255.0]),
        ([300.0, 100.0, 110.0], [150.0, 50.0, 55.0]),
        ([256.0, 1.0, 0.0], [254.0, 1.0, 0.0]),  # 254.008 and 0.992
        ([400.0, 300.0, 299.0], [102.0, 77.0, 76.0]),  # 102.10, 76.58 and 76.32
    ],
)
def test_whole_weights_above_what_their_type_holds_keep_their_shares(
    weights: list[float], fitting: list[float]
) -> None:
    others = [10.0, 20.0, 30.0]
    found = within(np.array([weights, others]), 255)
    assert found.tolist() == [fitting, others]


@pytest.mark.parametrize(
    ("joints", "at", "out"),
    [
        # Along no bone the place of the joint that was listed first; along one that of the first along it.
        ([[0, 1]], [0.0, 0.0], ([[0]], [[0.75]])),
        ([[1, 0]], [0.0, 0.0], ([[0, 0]], [[0.0, 0.75]])),
        ([[0, 1]], [0.5, 0.25], ([[0, 0]], [[0.0, 0.75]])),
        ([[1, 0]], [0.5, 0.25], ([[0]], [[0.75]])),
    ],
)
def test_what_is_folded_together_stays_in_the_place_of_the_first(
    joints: list[list[int]], at: list[float], out: tuple[object, object]
) -> None:
    found = folded(np.array([0, 0]), np.array(at), np.array(joints), np.array([[0.25, 0.5]]))
    assert tuple(each.tolist() for each in found) == out
