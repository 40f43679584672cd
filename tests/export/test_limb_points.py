"""The limb of a joint that is of none: it, the joint above it, and the one that its longest bone goes to."""

from __future__ import annotations

import numpy as np
import pytest
from rigs import chain, rig_of

from rigtri.errors import UsageError
from rigtri.export.explain.limb_points import limb_with


@pytest.mark.parametrize(
    ("places", "end"),
    [
        ([[0, 0, 2.0], [0, 3.0, 0], [1.0, 0, 0]], 3),
        ([[0, 0, 2.0], [0, 1.0, 0], [-4.0, 0, 0]], 4),
        ([[0, 2.0, 0], [2.0, 0, 0], [0, 0, 2.0]], 2),  # of equal ones the first
    ],
)
def test_the_longest_bone_goes_on(places: list[list[float]], end: int) -> None:
    rig = rig_of(["a", "b", "c", "d", "e"], [-1, 0, 1, 1, 1], np.array([[9.0, 9, 9], [10, 0, 0], *places]))
    assert limb_with(rig, "b") == (0, 1, end)


@pytest.mark.parametrize("name", ["a", "c"])
def test_a_joint_without_one_above_or_below_belongs_to_none(name: str) -> None:
    with pytest.raises(UsageError, match=f"'{name}' belongs to no limb, nor has it joints above and below"):
        limb_with(chain((0, 0, 0), (1, 0, 0), (2, 0, 0)), name)
