"""Weights of points limited, fitted to a type, and shared anew along a bone, by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from rigtri.maths.arrays import Integers
from rigtri.maths.trigonometry import Floats
from rigtri.model.skin import JointMerge, WeightLimit
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
        ([[0, 2, 1]], [0.0] * 3, ([[0, 2]], [[0.75, 0.5]])),
    ],
)
def test_what_is_folded_together_stays_in_the_place_of_the_first(
    joints: list[list[int]], at: list[float], out: tuple[object, object]
) -> None:
    weights = np.array([[0.25, 0.5, 0.5]])[:, : len(joints[0])]
    found = folded(np.array([0, 0, 2])[: len(at)], np.array(at), np.array(joints), weights)
    assert tuple(each.tolist() for each in found) == out


def crowded(count: int = 300, width: int = 6, full: float = 0) -> tuple[Integers, Floats]:
    """Points of up to six influences, many of which name a joint twice or weigh nothing."""
    chance = np.random.default_rng(5)
    weights = chance.uniform(0.01, 1.0, (count, width)) * (chance.uniform(size=(count, width)) < 0.7)
    weights = np.rint(weights * full / 3) if full else weights
    return chance.integers(0, 5, (count, width)), weights


def by_joint(joints: Integers, weights: Floats) -> list[dict[int, float]]:
    """What each point has of each joint."""
    found = [dict[int, float]() for _ in joints]
    for mine, row, shares in zip(found, joints.tolist(), weights.tolist(), strict=True):
        for joint, weight in zip(row, shares, strict=True):
            if weight:
                mine[joint] = mine.get(joint, 0.0) + weight
    return found


@pytest.mark.parametrize("normalise", [False, True])
@pytest.mark.parametrize("most", [1, 2, 4])
def test_points_keep_the_joints_that_weigh_most_with_the_same_proportions(most: int, normalise: bool) -> None:
    joints, weights = crowded()
    out = limited(joints, weights, WeightLimit(most, normalise))
    assert (np.count_nonzero(out[1], axis=1) <= most).all()
    for before, after in zip(by_joint(joints, weights), by_joint(*out), strict=True):
        largest = sorted(before, key=lambda joint: -before[joint])[:most]
        kept = {joint: before[joint] for joint in largest}
        if set(after) != set(largest):  # a joint that is named twice, where no joint is too much
            assert sum(after.values()) == pytest.approx(1.0 if normalise and before else sum(before.values()))
            continue
        whole = 1.0 if normalise else sum(before.values())
        assert after == pytest.approx(
            {joint: each * whole / sum(kept.values()) for joint, each in kept.items()}
        )


@pytest.mark.parametrize("merged", [[0, 0, 2, 3, 4], [0, 1, 1, 1, 1], [0, 1, 2, 3, 0], [0, 1, 2, 3, 4]])
def test_what_points_have_of_joints_that_go_is_what_their_heirs_get(merged: list[int]) -> None:
    joints, weights = crowded()
    at = np.array([0.0, 0.2, 0.2, 0.9, 0.5])
    out = folded(np.array(merged), at, joints, weights)
    for row, after in zip(range(len(joints)), by_joint(*out), strict=True):
        inherited = [merged[joint] for joint in joints[row].tolist()]
        (before,) = by_joint(np.array([inherited]), weights[[row]])
        assert after == pytest.approx(before)
    once = np.sort(joints, axis=1)
    plain = (np.diff(once, axis=1) > 0).all(axis=1)  # these name no joint twice, and do not afterwards
    for row in np.flatnonzero(plain).tolist():
        left = out[0][row][out[1][row] != 0].tolist()
        assert len(set(left)) == len(left)


def test_what_is_not_folded_keeps_every_bit() -> None:
    joints, weights = crowded()
    joints[5, 2], weights[5, 2] = 99, 0.0  # no joint, and no part of it
    out = folded(np.arange(5), np.zeros(5), joints, weights)
    joints[5, 2] = 0
    assert np.array_equal(out[0], joints)
    assert np.array_equal(out[1], weights)


def test_two_folds_are_one() -> None:
    joints, weights = crowded()
    plain = (np.diff(np.sort(joints, axis=1), axis=1) > 0).all(axis=1)
    joints, weights = joints[plain], weights[plain]
    one = JointMerge(0, np.array([0, 0, 0, 1, 2]), np.array([0, 0.5, 0.25, 0, 0]), {3: 1, 4: 2}, idle=True)
    two = JointMerge(0, np.array([0, 1, 1]), np.array([0.75, 0.2, 0.5]), {4: 3, 5: 6}, idle=False)
    both = one.then(two)
    assert both.rows.tolist() == [0, 0, 0, 1, 1]
    assert both.at.tolist() == [0.75, 0.5, 0.25, 0.2, 0.5]
    assert (both.widths, both.idle, two.then(two).idle) == ({3: 1, 4: 2, 5: 6}, False, False)
    assert replace(one, idle=True).then(replace(two, idle=True)).idle
    after = folded(two.rows, two.at, *folded(one.rows, one.at, joints, weights))
    for twice, once in zip(
        by_joint(*after), by_joint(*folded(both.rows, both.at, joints, weights)), strict=True
    ):
        assert once == pytest.approx(twice)


def test_weights_that_sum_to_one_stay_where_they_are_to_do_so() -> None:
    almost = [0.5, 0.25, 0.25 + 1e-7, 0.0, 0.0]
    assert one(almost, WeightLimit(3, normalise=True))[1] == almost[:4]


def test_points_without_influences_have_none_afterwards() -> None:
    none = np.zeros((2, 0), dtype=np.int64), np.zeros((2, 0))
    assert [each.shape for each in limited(*none, WeightLimit(4))] == [(2, 0), (2, 0)]
    assert [each.shape for each in folded(np.arange(3), np.zeros(3), *none)] == [(2, 0), (2, 0)]


def test_a_joint_that_the_skin_does_not_have_stays_one_that_it_has_not() -> None:
    joints, weights = np.array([[0, 255, 2, 9]]), np.array([[0.25, 0.5, 0.25, 0.0]])
    found, kept = folded(np.array([0, 1, 0]), np.array([1.0, 0.0, 0.5]), joints, weights)
    assert found.tolist() == [[0, 255, 0, 0]]
    assert kept.tolist() == [[0.0, 0.5, 0.5, 0.0]]
