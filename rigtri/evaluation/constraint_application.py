"""What one constraint gives its child, from the matrices of a whole rig; of its own: `constraint_solver`."""

from __future__ import annotations

from rigtri.evaluation.constraint_solver import evaluate_constraint
from rigtri.maths.matrices import identity
from rigtri.maths.trigonometry import Floats
from rigtri.model.constraints import Constraint
from rigtri.model.rig import Rig


def constrained_local(rig: Rig, rule: Constraint, world: Floats, local: Floats, own: Floats) -> Floats:
    """The local matrices, (f, 4, 4), that a constraint gives its child; world, local: (f, n, 4, 4)."""
    above = int(rig.parents[rule.child])
    parent = world[:, above] if above >= 0 else identity(len(world))
    drivers = (world if rule.space == "world" else local)[:, list(rule.drivers)]
    up = world[:, rule.up_object] if rule.up_object >= 0 else None
    return evaluate_constraint(rule, drivers, parent, own, up)
