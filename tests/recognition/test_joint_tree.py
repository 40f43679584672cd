"""A tree of some joints of a rig: what it says of them, without a look at all others."""

from __future__ import annotations

import numpy as np
from rigs import random_rig

from rigtri.recognition.joint_tree import Tree


def test_the_joint_above_is_the_nearest_of_the_tree() -> None:
    random = np.random.default_rng(4)
    for seed in range(20):
        rig = random_rig(seed, joints=12)
        nodes = sorted(random.choice(len(rig), 7, replace=False).tolist())
        above = Tree(rig, nodes, rig.world[:, 3, :3]).above
        for node in range(len(rig)):
            line = rig.path_to_root(node)[1:] if node in nodes else []
            assert above[node] == next((k for k in line if k in nodes), -1)


def test_places_are_read_for_those_that_are_asked_for() -> None:
    """In a crowd a character is a small part."""
    rig = random_rig(1, joints=12)
    tree = Tree(rig, [1, 2, 3], rig.world[:, 3, :3])
    assert tuple(tree.at[2]) == tuple(rig.world[2, 3, :3])
    assert list(tree.at) == [2]
