"""Nodes without a partner get one by key or place, where nobody else claims it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from rigs import rig_of

from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.verification.compare.correspondence import Correspondence
from rigtri.verification.diff.renames import renamed


def tree(names: str, parents: Sequence[int], *, shows: Sequence[int] = (), joints: Sequence[int] = ()) -> Rig:
    """Nodes by the words of ``names``; those of ``shows`` show something."""
    rig = rig_of(names.split(), list(parents), np.zeros((len(parents), 3)))
    attachment = np.array([k if k in shows else -1 for k in range(len(parents))])
    skin = Skin("skin", np.array(joints, dtype=np.int64), np.tile(np.eye(4), (len(joints), 1, 1)))
    return replace(rig, attachment=attachment, skins=(skin,) if len(joints) else ())


def partners(before: Rig, after: Rig, known: Sequence[int]) -> tuple[list[int], list[int]]:
    none = np.full(len(before), -1)
    m = Correspondence(np.array(known), none.copy(), none[:0], none[:0], (), (), ())
    found = renamed(before, after, m)
    return found.node.tolist(), found.shown.tolist()


BODY = tree("root hat arm", [-1, 0, 0], shows=[1])


def test_the_only_two_without_a_partner_below_one_parent_are_one_with_what_it_shows() -> None:
    after = tree("root arm cap", [-1, 0, 0], shows=[2])
    assert partners(BODY, after, [0, -1, 1]) == ([0, 2, 1], [-1, 2, -1])
    assert partners(BODY, replace(after, attachment=np.full(3, -1)), [0, -1, 1])[1] == [-1, -1, -1]


def test_roots_and_what_is_below_them_follow_each_other() -> None:
    after = tree("hero cap limb", [-1, 0, 0], shows=[1])
    assert partners(BODY, after, [-1, -1, -1]) == ([0, 1, 2], [-1, 1, -1])


@pytest.mark.parametrize(
    "after",
    [
        tree("root arm", [-1, 0]),  # it is gone
        tree("root arm cap bag", [-1, 0, 0, 0]),  # or one of two
        tree("root arm cap tip", [-1, 0, 0, 2]),  # has children
        tree("root arm cap", [-1, 0, 0], joints=[2]),  # is a joint
        tree("root arm cap", [-1, 0, 1]),  # hangs elsewhere
    ],
)
def test_others_are_no_partners(after: Rig) -> None:
    assert partners(BODY, after, [0, -1, 1])[0] == [0, -1, 1]


def test_of_several_the_one_with_the_same_key_is() -> None:
    after = replace(tree("root arm cap bag", [-1, 0, 0, 0]), keys=(None, None, 8, 7))
    assert partners(replace(BODY, keys=(None, 7, None)), after, [0, -1, 1])[0] == [0, 3, 1]


def test_what_shows_only_is_found_for_nodes_that_had_no_partner() -> None:
    after = tree("root hat arm", [-1, 0, 0], shows=[0, 1])
    assert partners(BODY, after, [0, 1, 2])[1] == [-1, -1, -1]
