"""Two bones that reach for a target: laws first, then triangles that can be checked by hand."""

from __future__ import annotations

import numpy as np
import pytest

from rigtri.evaluation.two_bone_ik import distance_for, sides, two_bone
from rigtri.maths.quaternions import rotate

X = np.array([1.0, 0.0, 0.0])


def solved(target, pole, *, lengths=(1.0, 1.0), count=1, **more):
    target, pole = np.atleast_2d(target).astype(float), np.atleast_2d(pole).astype(float)
    count = max(len(target), len(pole))
    wide = [np.broadcast_to(v, (count, 3)) for v in (np.zeros(3), target, pole)]
    sizes = tuple(np.full(count, size) for size in lengths)
    given = {
        "root_to_end": np.broadcast_to([0.0, -1.0, 0.0], (count, 3)),
        "side": np.broadcast_to([0.0, 0.0, 1.0], (count, 3)),
    }
    found = two_bone(wide[0], sizes, wide[1], wide[2], **given, **more)
    grown = [size * found.stretch for size in sizes]
    middle = rotate(found.upper, X) * grown[0][:, np.newaxis]
    end = middle + rotate(found.lower, X) * grown[1][:, np.newaxis]
    return found, middle, end


def test_the_end_reaches_every_target_within_reach_and_bends_to_the_pole():
    rng = np.random.default_rng(5)
    lengths = (1.3, 0.8)
    directions = rng.normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    target = directions * rng.uniform(0.55, 2.05, size=(500, 1))
    pole = rng.normal(size=(500, 3)) * 3
    _, middle, end = solved(target, pole, lengths=lengths)
    assert np.abs(end - target).max() < 1e-12
    across = pole - (pole * directions).sum(axis=1, keepdims=True) * directions
    bend = middle - (middle * directions).sum(axis=1, keepdims=True) * directions
    assert ((across * bend).sum(axis=1) > 0).all()
    assert np.abs(np.cross(across, bend)).max() < 1e-12 * 100


def test_a_right_angle_by_hand():
    _, middle, end = solved([np.sqrt(2.0), 0, 0], [0, 5, 0])
    np.testing.assert_allclose(middle[0], [np.sqrt(0.5), np.sqrt(0.5), 0], atol=1e-12)
    np.testing.assert_allclose(end[0], [np.sqrt(2.0), 0, 0], atol=1e-12)


def test_a_target_out_of_reach_is_pointed_at_and_reported():
    found, _, end = solved([3.0, 0, 0], [0, 1, 0])
    np.testing.assert_allclose(end[0], [2.0, 0, 0], atol=1e-12)
    assert found.short[0] == pytest.approx(1.0)


def test_stretch_reaches_it_and_keeps_the_ratio_of_the_bones():
    found, middle, end = solved([4.0, 0, 0], [0, 1, 0], lengths=(1.0, 0.5), stretch=True)
    np.testing.assert_allclose(end[0], [4.0, 0, 0], atol=1e-12)
    np.testing.assert_allclose(middle[0], [4.0 / 1.5, 0, 0], atol=1e-7)
    assert found.short[0] == pytest.approx(0.0, abs=1e-12)


def test_soft_never_becomes_straight_and_meets_the_hard_one_where_it_begins():
    distances = np.linspace(0.5, 6.0, 200)
    target = distances[:, np.newaxis] * X
    _, _, end = solved(target, [0.0, 9.0, 0.0], soft=0.1)
    reach = np.linalg.norm(end, axis=1)
    assert (np.diff(reach) > -1e-12).all()
    assert reach.max() < 2.0
    hard = distances <= 1.8
    np.testing.assert_allclose(reach[hard], distances[hard], atol=1e-12)


@pytest.mark.parametrize("soft", [0.0, 0.01, 0.2, 0.9])
def test_the_distance_of_a_target_follows_from_how_far_the_end_goes(soft):
    # Up to 5 ways of slowing down after the start, 2 (1 - soft); a hard limb is not straight.
    distances = np.linspace(0.1, 2.0 * (1.0 - soft) + 9.9 * soft, 300, endpoint=soft > 0)
    _, _, end = solved(distances[:, np.newaxis] * X, [0.0, 9.0, 0.0], soft=soft)
    reach = np.linalg.norm(end, axis=1)
    np.testing.assert_allclose(distance_for(reach, np.full(300, 2.0), soft), distances, atol=1e-11)


def test_a_straight_soft_limb_has_a_target_that_is_not_far_off():
    # 1.6 + 5 * 0.4
    np.testing.assert_allclose(distance_for(np.array([2.0, 2.1]), np.full(2, 2.0), 0.2), 3.6, atol=1e-12)


def test_a_hard_limb_that_is_straight_has_a_target_that_rounding_leaves_out_of_reach():
    nearly = 2.0 * (1.0 - np.array([0.0, 1e-6, 1e-5]))
    distances = distance_for(nearly, np.full(3, 2.0), 0.0)
    np.testing.assert_allclose(distances, [2.000004, 2.000004, 1.99998], rtol=1e-12)
    rounded = (distances[:1] * np.array([[1.0 - 1e-6], [1.0 + 1e-6]])) * X
    _, middle, _ = solved(rounded, [0.0, 9.0, 0.0])
    np.testing.assert_allclose(middle, [X, X], atol=1e-12)
    # What rests straight settles there.
    assert distance_for(nearly[:1], np.full(1, 2.0), 0.0, at_rest=1.0) == 2.0


@pytest.mark.parametrize("target", [[0, 0, 0], [1e-12, 0, 0]])
def test_a_target_at_the_root_folds_the_limb_and_reports_it(target):
    found, middle, end = solved(target, [0, 1, 0], lengths=(1.0, 0.6))
    assert found.lost[0]
    assert np.isfinite([*middle[0], *end[0]]).all()
    assert np.linalg.norm(end[0]) == pytest.approx(0.4)


def test_a_pole_on_the_line_keeps_the_side_of_the_rest_pose():
    found, middle, _ = solved([1.5, 0, 0], [7.0, 0, 0])
    assert found.lost[0]
    assert middle[0, 2] > 0.6
    assert abs(middle[0, 1]) < 1e-12


def test_bones_of_no_length_and_numbers_that_are_none_never_raise():
    found, middle, _ = solved([1.0, 0, 0], [0, 1, 0], lengths=(0.0, 0.0))
    assert np.isfinite(found.upper).all()
    assert np.isfinite(middle).all()


def test_one_is_the_same_as_many():
    rng = np.random.default_rng(1)
    targets, poles = rng.normal(size=(20, 3)), rng.normal(size=(20, 3)) * 4
    many, _, _ = solved(targets, poles, soft=0.05, stretch=True)
    for k in range(20):
        one, _, _ = solved(targets[k], poles[k], soft=0.05, stretch=True)
        assert np.array_equal(one.upper[0], many.upper[k])
        assert np.array_equal(one.lower[0], many.lower[k])


def test_rounding_of_a_target_does_not_bend_a_limb_that_rests_straight():
    def bend(share: float, at_rest: float) -> float:
        _, middle, _ = solved((0, 2.0 - 2.0 * share, 0), (1, 0, 0), at_rest=at_rest)
        return float(middle[0, 0])

    assert max(bend(share, 1.0) for share in (0.0, 0.5e-7, 1e-7, 1.9e-7)) < 1e-12
    assert bend(0.5e-7, 0.9) > 1e-4
    # It is felt without a jump, and a target farther off is reached as ever.
    steps = np.array([bend(share, 1.0) for share in np.linspace(0, 2e-6, 400)])
    assert (np.diff(steps) >= 0).all()
    assert bend(2e-6, 1.0) == bend(2e-6, 0.0)


@pytest.mark.parametrize(
    ("along", "pole", "side", "expected", "lost"),
    [
        ([1, 0, 0], [5, 2, 0], [0, 0, 1], [0, 1, 0], False),
        ([1, 0, 0], [5, -2, 0], [0, 0, 1], [0, -1, 0], False),
        # The pole lies on the line: the side that the limb has, square to where it points now.
        ([1, 0, 0], [5, 0, 0], [1, 0, -2], [0, 0, -1], True),
        # It points where its side was, too: one direction square to it.
        ([1, 0, 0], [-5, 0, 0], [3, 0, 0], [0, 0, 1], True),
        ([0, 0, -1], [0, 0, 2], [0, 0, 4], [0, -1, 0], True),
    ],
)
def test_a_limb_bends_to_its_pole_or_its_own_side_or_any(along, pole, side, expected, lost):
    given = (np.array([each], dtype=float) for each in (along, pole, side))
    found, nowhere = sides(*given, total=np.array([2.0]))
    np.testing.assert_allclose(found[0], expected, atol=1e-12)
    assert nowhere.tolist() == [lost]
