from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rigs import random_rig

from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.pose_cache import PoseCache
from rigtri.maths.matrices import compose, multiply


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
