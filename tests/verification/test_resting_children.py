"""A child that its constraint would take from its rest place is a difference, though no vertex shows it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from calls import calls
from rigs import rig_of

import rigtri
from rigtri.maths.quaternions import IDENTITY
from rigtri.model.rig import Rig
from rigtri.verification.compare.correspondence import match
from rigtri.verification.compare.resting_children import left_their_rest


def held(kind: str, **options: bool) -> Rig:
    """A prop that follows a hand, above which an arm stands."""
    places = np.array([[0.0, 1, 0], [1.0, 0, 0], [3.0, 1, 0]])
    turns = np.stack([IDENTITY, IDENTITY, [0.6, 0.0, 0.0, 0.8]])
    rig = rig_of(["arm", "hand", "prop"], [-1, 0, -1], places, turns)
    return rigtri.constrain(rig, type=kind, child="prop", driver=("hand",), **options)


def turned(rig: Rig, name: str, by: float = 1.0) -> Rig:
    rotation = rig.rotation.copy()
    rotation[rig.find(name)] = 0.0, np.sin(by / 2), 0.0, np.cos(by / 2)
    return replace(rig, rotation=rotation)


def found(before: Rig, after: Rig) -> list[str]:
    return left_their_rest(before, after, match(before, after, by_key=False))


@pytest.mark.parametrize("kind", ["parent", "point", "orient"])
def test_a_driver_that_an_edit_turned_is_seen_by_its_child(kind: str) -> None:
    rig = held(kind)
    assert found(rig, rig) == []
    assert found(rig, turned(rig, "arm")) == [
        f"the {kind} constraint of prop no longer holds it where it rests"
    ]
    assert found(rig, turned(rig, "arm", 1e-6)) == []  # rounding
    assert found(turned(rig, "arm"), rig) == []  # which did not rest before


def test_another_constraint_or_none_is_no_difference() -> None:
    rig = held("parent")
    assert found(rig, replace(rig, metadata={})) == []
    assert found(rig, rigtri.constrain(rig, type="parent", child="prop", driver=("arm",))) == []
    assert found(rig, held("parent", maintain_offset=False)) == []


def followed(many: int) -> Rig:
    """A chain of joints, each followed by a prop."""
    places = np.array([[0.0, 1, 0]] * many + [[2.0, 0, 1]] * many)
    names = [f"{what}_{k}" for what in ("joint", "prop") for k in range(many)]
    rig = rig_of(names, [*range(-1, many - 1), *[-1] * many], places)
    for k in range(many):
        rig = rigtri.constrain(rig, type="parent", child=f"prop_{k}", driver=(f"joint_{k}",))
    return rig


def test_all_constraints_of_a_rig_are_measured_in_one_pose() -> None:
    """Before, each evaluated all nodes anew: twelve times as long for four times as many."""
    few, many = followed(6), followed(24)
    once = calls(lambda: found(few, replace(few)))
    assert calls(lambda: found(many, replace(many))) < 5 * once
