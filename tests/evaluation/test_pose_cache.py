from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rigs import chain, random_rig

from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.pose_cache import PoseCache, cut, joined, sample_parts
from rigtri.maths.matrices import compose, multiply
from rigtri.model.animation import Clip, Track


@pytest.mark.parametrize("seed", range(5))
def test_worlds_are_those_of_the_rig_where_nothing_moves(seed: int) -> None:
    rig = random_rig(seed)
    posed = PoseCache(rig)
    for node in reversed(range(len(rig))):
        assert_allclose(posed.world(node)[0], rig.world[node], atol=1e-9)


def test_what_is_set_moves_what_is_below_until_it_was_used() -> None:
    rig = random_rig(1)
    child = next(node for node in range(len(rig)) if rig.parents[node] == 0)
    posed = PoseCache(rig)
    parts = Parts(np.ones((2, 3)), np.array([[0.0, 0, 0, 1], [0, 0, 1, 0]]), np.full((2, 3), 2.0))
    posed.set(0, parts)
    assert_allclose(posed.world(child), multiply(rig.local[child], compose(*parts)), atol=1e-9)
    with pytest.raises(ValueError, match="after its position was used"):
        posed.set(0, parts)
    posed.forget()
    posed.set(0, parts)


def test_blocks_of_frames_are_joined_and_what_is_the_same_in_all_keeps_one_row() -> None:
    still = Parts(np.ones((1, 3)), np.array([[0.0, 0, 0, 1]]), np.ones((1, 3)))
    moves = np.arange(15.0).reshape(5, 3)
    begins = Parts(moves, still.rotation, still.scale)
    blocks = [cut({0: still, 1: begins}, rows) for rows in (slice(0, 2), slice(2, 4), slice(4, 5))]
    assert [len(block[1].translation) for block in blocks] == [2, 2, 1]
    assert blocks[1][0] == still
    found = joined(blocks, 5, block=2)
    for part, given in zip(found[0], still, strict=True):
        np.testing.assert_array_equal(part, given)
    np.testing.assert_array_equal(found[1].translation, moves)
    assert len(found[1].rotation) == len(found[1].scale) == 1
    assert joined(blocks[:1], 2) == blocks[0]


def test_a_row_that_holds_for_a_block_is_repeated_where_other_blocks_differ() -> None:
    rows = [np.zeros((1, 3)), np.ones((1, 3)), np.array([[7.0, 8, 9]])]
    one = np.array([[0.0, 0, 0, 1]])
    found = joined([{0: Parts(each, one, np.ones((1, 3)))} for each in rows], 5, block=2)
    np.testing.assert_array_equal(found[0].translation, [[0] * 3, [0] * 3, [1] * 3, [1] * 3, [7, 8, 9]])


def test_zero_scales_are_a_share_of_the_others_where_a_way_without_them_is_asked() -> None:
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0, 0))
    posed = PoseCache(rig)
    one = np.array([[0.0, 0, 0, 1]])
    posed.set(0, Parts(np.zeros((2, 3)), one, np.array([[2.0, 0.0, 4.0], [0, 0, 0]])))
    posed.set(1, Parts(np.array([[1.0, 1, 1]]), one, np.array([[3.0, 3, 3]])))
    found = posed.unflattened(1, 0.125)
    assert_allclose(found[0], [[6, 0, 0, 0], [0, 1.5, 0, 0], [0, 0, 12, 0], [2, 0.5, 4, 1]])
    assert_allclose(found[1], [[3, 0, 0, 0], [0, 3, 0, 0], [0, 0, 3, 0], [1, 1, 1, 1]])
    assert_allclose(PoseCache(rig).unflattened(2, 0.125)[0], rig.world[2])


def test_parts_of_a_clip_are_sampled_where_its_keys_are_not() -> None:
    rig = chain((0, 0, 0), (1, 0, 0))
    times, turns = np.array([0.0, 2.0]), np.array([[0.0, 0, 0, 2], [0, 0, 2, 0]])
    moves = Track(1, "translation", "LINEAR", times, np.array([[0.0, 0, 0], [4, 0, 0]]))
    clip = Clip(
        "c", (moves, Track(0, "rotation", "LINEAR", times, turns), replace(moves, node=0, path="weights"))
    )
    there = sample_parts(rig, clip, times)
    assert there[1].translation.tolist() == [[0, 0, 0], [4, 0, 0]]
    assert there[0].rotation.tolist() == [[0, 0, 0, 1], [0, 0, 1, 0]]
    between = sample_parts(rig, clip, times + 0.5)  # as many times, all others
    assert between[1].translation.tolist() == [[1, 0, 0], [4, 0, 0]]
    assert set(sample_parts(rig, clip, times, only=[0])) == {0}
    alone = Clip("c", (Track(1, "translation", "LINEAR", times[:1], moves.values[1:]),))
    assert sample_parts(rig, alone, times)[1].translation.tolist() == [[4, 0, 0]]
