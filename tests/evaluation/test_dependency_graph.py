"""The order of steps, each after those that set what it uses, and the cycle that leaves none."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest
from rigs import chain, rig_of

from rigtri.evaluation.dependency_graph import ControlCycleError, dependencies, in_order, steps_for
from rigtri.model.bindings import NodeConstraint
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls

# a, with b and c below each other, and d beside them with e below.
NAMES, PARENTS = list("abcde"), [-1, 0, 1, 0, 3]


@dataclass
class Uses:
    """A step. reads: nodes whose own values it uses; needs: those whose place in the world it uses."""

    name: str
    sets: tuple[int, ...]
    reads: tuple[int, ...] = ()
    needs: tuple[int, ...] = ()
    carries: tuple[int, ...] = ()
    through: dict[int, tuple[int, ...]] = field(default_factory=dict)


@pytest.fixture
def rig() -> Rig:
    return rig_of(NAMES, PARENTS, np.zeros((5, 3)))


@pytest.mark.parametrize("kind", ["rotation", "aim", "roll"])
def test_constraints_that_the_format_has_make_nodes_depend_on_their_sources(kind: Any, rig: Rig) -> None:
    rule = NodeConstraint(kind, 4, 1, np.array([1.0, 0.0, 0.0]), ("nodes", 4))
    assert dependencies(replace(rig, node_constraints=(rule,)))[4] == {3, 1}


def ordered(rig: Rig, *steps: Any) -> list[str]:
    return [step.name for step in in_order(rig, steps)]


def test_steps_that_use_nothing_stay_in_order(rig: Rig) -> None:
    assert ordered(rig, Uses("x", (4,)), Uses("y", (0,)), Uses("z", (2,))) == ["x", "y", "z"]


def test_what_a_step_reads_is_set_before_and_right_before(rig: Rig) -> None:
    steps = [Uses("x", (4,)), Uses("y", (1,), reads=(3,)), Uses("z", (2,)), Uses("w", (3,))]
    assert ordered(rig, *steps) == ["x", "w", "y", "z"]


def test_a_place_in_the_world_depends_on_all_above_and_a_value_does_not(rig: Rig) -> None:
    first = Uses("above", (0,))
    assert ordered(rig, Uses("user", (4,), needs=(2,)), first) == ["above", "user"]
    assert ordered(rig, Uses("user", (4,), reads=(2,)), first) == ["user", "above"]
    assert ordered(rig, Uses("user", (4,), needs=(-1,)), first) == ["user", "above"]


def test_nodes_that_a_step_takes_along_count_as_set_by_it(rig: Rig) -> None:
    carrier = Uses("carrier", (1,), carries=(3,))
    assert ordered(rig, Uses("user", (4,), reads=(3,)), carrier) == ["carrier", "user"]


def test_only_the_steps_that_some_nodes_depend_on_are_taken(rig: Rig) -> None:
    steps: list[Any] = [
        Uses("x", (0,)),
        Uses("y", (3,)),
        Uses("z", (1,), reads=(3,)),
        Uses("w", (4,), reads=(1,)),
    ]
    assert [step.name for step in steps_for(rig, steps, [1])] == ["y", "z"]
    assert [step.name for step in steps_for(rig, steps, [4])] == ["y", "z", "w"]
    assert [step.name for step in steps_for(rig, steps, [0, 3])] == ["x", "y"]
    assert steps_for(rig, steps, [2]) == []


@pytest.mark.parametrize(
    ("steps", "names"),
    [
        # c reads e, e needs where c is: by c itself.
        ([Uses("x", (2,), reads=(4,)), Uses("y", (4,), needs=(2,))], "'c' → 'e' → 'c'"),
        # d needs where c is, which is below b; b needs where e is, which is below d.
        ([Uses("x", (3,), needs=(2,)), Uses("y", (1,), needs=(4,))], "'b' → 'e' → 'd' → 'c' → 'b'"),
        ([Uses("x", (2,), needs=(2,))], "'c' → 'c'"),
        # By way of a control.
        ([Uses("x", (3,), needs=(1,), through={1: (4,)}), Uses("y", (1,), reads=(3,))],
         "'b' → 'd' → 'e' → 'b'"),
        ([Uses("x", (1,), reads=(2,)), Uses("y", (2,), reads=(3,)), Uses("z", (3,), reads=(1,))],
         "'b' → 'c' → 'd' → 'b'"),
    ],
)  # fmt: skip
def test_a_cycle_is_named_from_its_first_node_in_the_rig(rig: Rig, steps: list[Any], names: str) -> None:
    with pytest.raises(ControlCycleError, match=f"each of these needs the next: {re.escape(names)}"):
        in_order(rig, steps)


def test_joints_depend_on_the_controls_and_poles_that_move_them() -> None:
    options = AddControlsOptions(ik=(("a", "b", "c"),), joints=("d",))
    rig = add_controls(chain((0, 0, 0), (1, 0.2, 0), (2, 0, 0), (3, 0, 0)), options=options)
    needs = dependencies(rig)
    of = {(rig.type_of(node), rig.metadata[node].get("joint")): node for node in rig.nodes_of("control")}
    (pole,), end, tip = rig.nodes_of("poleVector"), of["control", "c"], of["control", "d"]
    for joint in "abc":
        assert {end, pole} <= needs[rig.find(joint)]
    assert tip in needs[rig.find("d")]
    assert not {end, pole}.intersection(needs[rig.find("d")])
    assert tip not in dependencies(rig, tip)[rig.find("d")]
