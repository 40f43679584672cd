"""One character of a crowd, and what rigtri has made for others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from calls import lines
from recognition_bodies.skeletons import HORSE, MAN, Joint, line, rig_with
from rigs import rig_of

from rigtri.maths.matrices import inverse
from rigtri.model.metadata import GroupRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.recognition.one_character import within
from rigtri.recognition.recognise import recognise


def _placed(joints: list[Joint], prefix: str, aside: float, turn: float) -> list[Joint]:
    """A body below ``root`` with a prefix on all names, aside along x, and turned round for −1."""
    return [
        (prefix + name, prefix + over if over else "root", (turn * x + aside, y, turn * z))
        for name, over, (x, y, z) in joints
    ]


@pytest.mark.parametrize(
    ("first", "second", "turn"), [(MAN, MAN, 1.0), (MAN, MAN, -1.0), (HORSE, MAN, 1.0), (HORSE, HORSE, 1.0)]
)
def test_bodies_below_one_root_joint_are_told_by_their_names(
    first: list[Joint], second: list[Joint], turn: float
) -> None:
    """Before, two people beside one another were a creature that faces up, at 0.86."""
    joints = [*_placed(first, "a_", 0.0, 1.0), *_placed(second, "b_", 2.5, turn)]
    found = recognise(rig_with([("root", "", (0.0, 0.0, 0.0)), *joints])).characters
    alone = [recognise(rig_with(body)).characters[0] for body in (first, second)]
    assert [each.form for each in found] == [each.form for each in alone]
    assert [sum(k.is_sure for k in each.limbs) for each in found] == [
        sum(k.is_sure for k in each.limbs) for each in alone
    ]
    assert [each.facing[2] for each in found] == pytest.approx([1.0, turn])


@pytest.mark.parametrize("second", [MAN, HORSE], ids=["man", "horse"])
def test_bodies_below_joints_below_the_root_are_told_beside_a_prop(second: list[Joint]) -> None:
    """Before, all of it was one creature, whose limbs were sure."""
    root = line("root all", "", (0.0, 0.0, 0.0), (0.0, 0.2, 0.0))
    prop = line("prop1 prop2 prop3", "root", (0.0, 0.1, 0.3), (0.2, 0.1, 0.3), (0.4, 0.1, 0.3))
    bodies = [*_placed(MAN, "a_", 0.0, 1.0), *_placed(second, "b_", 2.5, 1.0)]
    bodies = [(name, "all" if over == "root" else over, place) for name, over, place in bodies]
    found = recognise(rig_with([*root, *prop, *bodies])).characters
    assert sorted(each.form for each in found) == sorted(["biped", "biped" if second is MAN else "quadruped"])
    assert [sum(chain.is_sure for chain in each.limbs) for each in found] == [4, 4]


def test_a_rider_below_a_joint_of_the_animal_does_not_part_it() -> None:
    rider = [(f"rider_{name}", f"rider_{over}" if over else "spine", place) for name, over, place in MAN]
    rider = [(name, over, (x, y + 0.5, z)) for name, over, (x, y, z) in rider]
    animal = {name for name, _, _ in HORSE}
    rig = rig_with([*HORSE, *rider])
    found = recognise(rig).characters
    assert any(animal <= {rig.names[part.joint] for part in each.parts} for each in found)


def test_skeletons_of_controls_below_one_root_joint_are_no_bodies() -> None:
    joints = [*_placed(MAN, "DEF-", 0.0, 1.0), *_placed(MAN, "ORG-", 0.0, 1.0)]
    assert len(recognise(rig_with([("root", "", (0.0, 0.0, 0.0)), *joints])).characters) == 1


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
