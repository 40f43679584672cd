"""Which nodes are of one character: joints of skins that share any, and all that is below them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rigs import rig_of

from rigtri.model.characters import characters
from rigtri.model.skin import Skin


@pytest.mark.parametrize(
    ("parents", "skins", "found"),
    [
        ([-1, 0, 1, 0, 3], [[1, 2], [3, 4]], [[1, 2], [3, 4]]),  # the node above is of neither
        ([-1, 0, 1, 0, 3], [[1, 2], [2, 4]], [[1, 2, 4]]),
        ([-1, 0, 1], [], []),
        ([-1, 0, 1, 1], [[0]], [[0, 1, 2, 3]]),  # props below a joint
        ([-1, 0, 1, 2], [[0, 1], [2, 3]], [[0, 1, 2, 3]]),  # another skeleton that a joint carries
        ([-1, -1, 1], [[1]], [[1, 2]]),
        ([-1, 0, 0, 2], [[1], [2], [1, 3]], [[1, 2, 3]]),  # the last skin shares a joint with the first
    ],
)
def test_characters_are_what_skins_with_common_joints_move(
    parents: list[int], skins: list[list[int]], found: list[list[int]]
) -> None:
    rig = rig_of([f"n{k}" for k in range(len(parents))], parents, np.zeros((len(parents), 3)))
    made = tuple(
        Skin(f"s{k}", np.array(joints), np.tile(np.eye(4), (len(joints), 1, 1)))
        for k, joints in enumerate(skins)
    )
    assert characters(replace(rig, skins=made)) == found
