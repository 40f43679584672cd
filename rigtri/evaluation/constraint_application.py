"""Constraints applied to the nodes of a rig, all frames at once; one constraint: `constraint_solver`."""

from __future__ import annotations

from rigtri.evaluation.constraint_solver import evaluate_constraint
from rigtri.evaluation.dependency_graph import constraints_in_order
from rigtri.evaluation.sampling import worlds
from rigtri.maths.matrices import identity
from rigtri.maths.trigonometry import Floats
from rigtri.model.constraints import Constraint
from rigtri.model.rig import Rig


def apply_constraints(rig: Rig, local: Floats) -> Floats:
    """Local matrices, (f, n, 4, 4), with every child where its constraints put it.

    Controls and IK are not evaluated, nor are ``polevector`` constraints, which only IK reads.
    Raises ControlCycleError.
    """
    local = local.copy()
    for rule in constraints_in_order(rig):
        if rule.kind == "polevector":
            continue
        world = worlds(rig, local)
        own = local[:, rule.child]
        local[:, rule.child] = constrained_local(rig, rule, world, local, own)
    return local


def constrained_local(rig: Rig, rule: Constraint, world: Floats, local: Floats, own: Floats) -> Floats:
    """The local matrices, (f, 4, 4), that a constraint gives its child; world, local: (f, n, 4, 4)."""
    above = int(rig.parents[rule.child])
    parent = world[:, above] if above >= 0 else identity(len(world))
    drivers = (world if rule.space == "world" else local)[:, list(rule.drivers)]
    up = world[:, rule.up_object] if rule.up_object >= 0 else None
    return evaluate_constraint(rule, drivers, parent, own, up)
