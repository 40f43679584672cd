"""Sets of numbers that are joined pair by pair."""

import numpy as np

from rigtri.maths.disjoint_sets import DisjointSets


def test_joined_numbers_have_one_leader_and_the_first_of_a_join_leads():
    sets = DisjointSets()
    sets.join(3, 5)
    sets.join(7, 8)
    sets.join(1, 8)
    assert [sets.leader(k) for k in (1, 3, 5, 7, 8, 9)] == [1, 3, 3, 1, 1, 9]
    assert set(sets) == {1, 3, 5, 7, 8, 9}


def test_sets_are_those_that_can_be_walked_between():
    random = np.random.default_rng(4)
    pairs = random.integers(0, 400, (250, 2)).tolist()
    sets = DisjointSets()
    near = {k: {k} for k in range(400)}
    for one, other in pairs:
        sets.join(one, other)
        near[one].add(other)
        near[other].add(one)
    for start in range(400):
        reached, left = {start}, [start]
        while left:
            left += (new := near[left.pop()] - reached)
            reached |= new
        assert {k for k in range(400) if sets.leader(k) == sets.leader(start)} == reached
