"""Names of one character among several, and the lateral axes that its pairs of limbs give."""

from __future__ import annotations

from collections import defaultdict
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rigs import rig_of

from rigtri.recognition.body_hinges import _lateral
from rigtri.recognition.character_joints import _MANY, _alike_bodies, _tops
from rigtri.recognition.layout import BODY_JOINTS
from rigtri.recognition.one_character import of_character

NAMES = ["root", "man", "arm", "prop", "arm", "hand", "woman", "arm", "leg"]
PARENTS = [-1, 0, 1, 0, 3, 4, 0, 6, 7]


@pytest.mark.parametrize(
    ("character", "names"),
    [
        ("man", ["root", "man", "arm", "prop", "", "hand", "woman", "", "leg"]),
        ("woman", ["root", "man", "", "prop", "", "hand", "woman", "arm", "leg"]),
        ("root", NAMES),
    ],
)
def test_names_that_several_have_mean_those_of_the_character(character: str, names: list[str]) -> None:
    rig = rig_of(NAMES, PARENTS, np.zeros((len(NAMES), 3)))
    found = of_character(rig, character)
    assert list(found.names) == names
    assert rig.names == tuple(NAMES)


AT = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 3, 5], [0, 0, 1], [0, 0, -1]])


def limb(kind: str, side: str, start: int) -> Any:
    return SimpleNamespace(kind=kind, side=side, bend=(start, 9, 9))


@pytest.mark.parametrize(
    ("limbs", "lateral"),
    [
        ([limb("leg", "left", 0), limb("leg", "right", 1)], [1, 0, 0]),
        ([limb("leg", "right", 0), limb("leg", "left", 1)], [-1, 0, 0]),
        # Legs along x, arms along z: half way between.
        (
            [
                limb("leg", "left", 0),
                limb("leg", "right", 1),
                limb("arm", "left", 3),
                limb("arm", "right", 4),
            ],
            [np.sqrt(0.5), 0, np.sqrt(0.5)],
        ),
        # Against each other they say nothing, and one of a pair says nothing either.
        (
            [
                limb("leg", "left", 0),
                limb("leg", "right", 1),
                limb("arm", "left", 1),
                limb("arm", "right", 0),
            ],
            None,
        ),
        ([limb("leg", "left", 0), limb("arm", "right", 1)], None),
        ([], None),
    ],
)
def test_from_one_side_to_the_other_is_as_legs_and_arms_begin(limbs: list[Any], lateral: Any) -> None:
    character: Any = SimpleNamespace(limbs=limbs)
    found = _lateral(character, np.concatenate([AT, np.full((5, 3), 77.0)]))
    if lateral is None:
        assert found is None
    else:
        assert_allclose(found, lateral, atol=1e-12)


@pytest.mark.parametrize(
    ("sizes", "reaches", "alike"),
    [
        ((100, 100), (2.0, 2.0), True),
        ((100, 91), (2.0, 1.81), True),
        ((91, 100), (1.81, 2.0), True),
        ((100, 90), (2.0, 2.0), False),
        ((100, 100), (2.0, 1.8), False),
        ((80, 100), (2.0, 2.0), False),
        ((100, 100), (1.0, 2.0), False),
        ((BODY_JOINTS, BODY_JOINTS), (2.0, 2.0), True),
        ((BODY_JOINTS - 1, BODY_JOINTS - 1), (2.0, 2.0), False),
    ],
)
def test_two_branches_as_large_and_as_far_are_two_of_a_crowd(sizes: Any, reaches: Any, alike: bool) -> None:
    tree: Any = SimpleNamespace(size=sizes, reach=reaches)
    assert _alike_bodies(tree, 0, 1) is alike


@pytest.mark.parametrize(
    ("below", "joints", "tops"),
    [
        ({-1: [0], 0: [1, 2], 1: [], 2: []}, {1, 2}, [1, 2]),
        ({-1: [0], 0: [1], 1: []}, {1}, [0]),
        ({-1: [0], 0: [1, 2], 1: [], 2: []}, {0, 1, 2}, [0]),
        ({-1: [0], 0: [1, 2], 1: [], 2: []}, set(), [0]),
        # Containers in containers, and a root beside them.
        ({-1: [0, 6], 0: [1, 2], 1: [3, 4], 2: [5], 3: [], 4: [], 5: [], 6: []}, {3, 4, 5, 6}, [2, 3, 4, 6]),
        ({-1: [0], 0: [*range(1, _MANY + 1)]}, {5}, [*range(1, _MANY + 1)]),
        ({-1: [0], 0: [*range(1, _MANY + 2)]}, {5}, [0]),
    ],
)
def test_skeletons_begin_below_containers_of_several_things_that_are_no_joints(
    below: dict[int, list[int]], joints: set[int], tops: list[int]
) -> None:
    is_joint = np.isin(np.arange(_MANY + 2), list(joints))
    rig = SimpleNamespace(is_joint=is_joint, skins=[])
    tree: Any = SimpleNamespace(rig=rig, below=defaultdict(list, below), size=defaultdict(int), span=1.0)
    assert _tops(tree) == tops


@pytest.mark.parametrize(
    ("skins", "crowd"),
    [
        ("each", True),
        ("two for one", True),
        ("one without", False),
        ("one for two", False),
        ("none", False),
    ],
)
def test_a_container_of_many_is_a_crowd_where_each_branch_has_its_skins(skins: str, crowd: bool) -> None:
    """80 agents of USD that are no instances were one body, and 79 of their hips were roots that stay."""
    branches = [[1 + 2 * k, 2 + 2 * k] for k in range(_MANY + 1)]
    bound = {"two for one": [*branches, [1]], "one without": branches[1:], "none": []}.get(skins, branches)
    bound = [[*branches[0], 3], *branches[1:]] if skins == "one for two" else bound
    size = 1 + 2 * len(branches)
    rig = SimpleNamespace(
        is_joint=np.arange(size) > 0, skins=[SimpleNamespace(joints=np.array(joints)) for joints in bound]
    )
    below = {-1: [0], 0: [first for first, _ in branches], **{first: [second] for first, second in branches}}
    tree: Any = SimpleNamespace(rig=rig, below=defaultdict(list, below), size=defaultdict(int), span=1.0)
    tree.branch = lambda top: [top, *tree.below[top]]
    assert _tops(tree) == (below[0] if crowd else [0])
