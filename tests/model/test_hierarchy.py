"""Parents, children and depths of nodes, by a plain walk."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from rigtri.model.hierarchy import Hierarchy

#      0        7
#    1   4      8
#   2 3  5
#        6
PARENTS = [-1, 0, 1, 1, 0, 4, 5, -1, 7]
# The same with the branches mixed, parents first all the same.
MIXED = [-1, -1, 0, 1, 0, 2, 4, 2, 6]


def tree(parents: list[int] = PARENTS) -> Any:
    made = Hierarchy()
    made.parents = np.array(parents)
    return made


def test_levels_depths_and_children() -> None:
    assert [level.tolist() for level in tree().levels] == [[0, 7], [1, 4, 8], [2, 3, 5], [6]]
    assert tree().depth == [0, 1, 2, 2, 1, 2, 3, 0, 1]
    assert tree().children == ((1, 4), (2, 3), (), (), (5,), (6,), (), (8,), ())
    assert tree([]).levels == ()
    assert len(tree()) == 9


def test_ways_up_and_down() -> None:
    assert tree().path_to_root(6) == [6, 5, 4, 0]
    assert tree().path_to_root(-1) == []
    assert tree().with_ancestors([3, 8, -1]) == {3, 1, 0, 8, 7}
    assert tree().below(4) == [4, 5, 6]
    assert tree(MIXED).below(0) == [0, 2, 4, 5, 6, 7, 8]


@pytest.mark.parametrize("parents", [PARENTS, MIXED])
def test_what_is_below_what_is_as_the_ways_to_the_root_have_it(parents: list[int]) -> None:
    made = tree(parents)
    for node in range(9):
        above = set(made.path_to_root(node))
        assert [made.is_below(node, other) for other in range(9)] == [other in above for other in range(9)]


def test_marks_go_down() -> None:
    marked = np.zeros(9, dtype=bool)
    marked[[4, 7]] = True
    assert np.flatnonzero(tree().at_or_below(marked)).tolist() == [4, 5, 6, 7, 8]
    assert marked.sum() == 2
