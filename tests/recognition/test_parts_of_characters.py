"""One character of a crowd, and what rigtri has made for others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from calls import lines
from rigs import rig_of

from rigtri.maths.matrices import inverse
from rigtri.model.metadata import GroupRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.recognition.one_character import within


def crowd(count: int) -> Rig:
    """Characters of one joint, each with a group of its own, all below one node."""
    names = ["world", *(f"{kind}{k}" for k in range(count) for kind in ("joint", "group"))]
    rig = rig_of(names, [-1, *[0] * (2 * count)], np.zeros((len(names), 3)))
    joints = [np.array([node]) for node in range(1, len(names), 2)]
    skins = tuple(Skin(f"{k}", own, inverse(rig.world[own])) for k, own in enumerate(joints))
    stored = GroupRecord().to_dict()
    return replace(rig, skins=skins, metadata=dict.fromkeys(range(2, len(names), 2), stored))


def test_an_edit_of_one_character_sees_no_metadata_below_what_does_not_hold_it() -> None:
    rig = crowd(3)
    inner = replace(rig, parents=np.array([-1, 0, 1, 0, 3, 0, 5]))  # each group below its own joint
    seen: list[Rig] = []

    def edit(small: Rig) -> Rig:
        seen.append(small)
        return small

    for one in (rig, inner):
        assert within(one, frozenset({3}), edit) is one
    assert [sorted(small.metadata) for small in seen] == [[2, 4, 6], [4]]


def test_what_is_of_others_in_four_times_as_large_a_crowd_is_found_in_four_times_as_long() -> None:
    """Before, each group looked at all that is below the node that holds it."""

    def work(count: int) -> int:
        rig = crowd(count)
        return lines(lambda: within(rig, frozenset({1}), lambda small: small))

    work(2)
    assert work(80) < 4.5 * work(20)
