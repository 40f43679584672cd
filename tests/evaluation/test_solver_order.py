"""Steps of the solver are taken in the order in which they need each other, whatever that of the nodes."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rigs import rig_of

from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.solver_steps import ConstraintStep
from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.constraints import Constraint
from rigtri.operations.constrain.constrain import ConstrainOptions, constrain


@pytest.mark.parametrize("space", ["local", "world"])
@pytest.mark.parametrize("order", list(permutations("abc")))
def test_a_constraint_waits_for_the_constraint_of_its_driver(order: tuple[str, ...], space: str) -> None:
    rig = rig_of(["root", *"abc"], [-1, 0, 0, 0], np.zeros((4, 3)), np.tile([0.0, 0, 0, 1], (4, 1)))
    last, middle, first = order
    for child, driver in ((last, middle), (middle, first)):
        options = ConstrainOptions(type="orient", child=child, driver=((driver, 1.0),), driver_space=space)
        rig = constrain(rig, options=options)
    turned = from_axis_angle([0.0, 0.0, 1.0], np.array([0.3, 0.6]))
    moved = Parts(np.zeros((2, 3)), turned, np.ones((2, 3)))
    posed = Solver(rig).run({rig.find(first): moved})
    for node in (middle, last):
        assert_allclose(posed.part(rig.find(node)).rotation, turned, atol=1e-9)


@pytest.mark.parametrize(
    ("skips", "weights", "writes", "left"),
    [
        ((), (1.0,), [("rotation", True)], {"translation", "scale"}),
        (("rx",), (1.0,), [("rotation", False)], {"translation", "rotation", "scale"}),
        # Two rules set an axis each, which is not all of them; one without weight sets none.
        (("rx", "ry"), (1.0, 1.0), [("rotation", False)], {"translation", "rotation", "scale"}),
        ((), (0.0,), [], {"translation", "rotation", "scale"}),
    ],
)
def test_a_child_has_a_say_in_what_no_rule_sets_whole(
    skips: tuple[str, ...], weights: tuple[float, ...], writes: list[object], left: set[str]
) -> None:
    rig = rig_of(["root", "a", "b"], [-1, 0, 0], np.zeros((3, 3)))
    rules = tuple(
        Constraint("orient", 1, (2,), np.array([weight]), np.eye(4)[np.newaxis], skip=frozenset(skips))
        for weight in weights
    )
    step = ConstraintStep(rig, rules)
    assert step.needs == (*(2 for _ in rules), 0)  # its drivers, and what it hangs on
    assert step.reads == ()
    assert step.writes == writes
    assert step.left == left
