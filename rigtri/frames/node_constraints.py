"""VRM node constraints in reoriented frames: what they require, and their new axes.

A constraint keeps its meaning, for every motion and every weight, exactly when

* rotation, tail: source and node get the same delta (their parents do not matter);
* roll: the parents of source and node get the same delta, and in the new frame of the node
  the roll axis is again one of its axes (the delta of the source does not matter);
* aim: in the new frame of the node the aim axis is again one of the six.

Then nothing but the letter of the axis is to be written anew.

Source: derived from the pseudocode of VRMC_node_constraint 1.0; docs/exactness.md.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.maths.quaternions import IDENTITY, between, conjugate, multiply, rotate
from rigtri.maths.trigonometry import Floats
from rigtri.model.bindings import NodeConstraint
from rigtri.model.metadata import ConstraintRecord
from rigtri.model.rig import Rig

# Turns and axes that differ by less (radians) are one: what float64 leaves over.
SAME = 1e-9


def alike(rig: Rig, constraint: NodeConstraint) -> tuple[int, int] | None:
    """The two nodes that must take one delta, the leading one first; −1 is the world, which takes none."""
    if constraint.kind == "aim":
        return None
    first, second = constraint.source, constraint.node
    if constraint.kind == "roll":
        first, second = int(rig.parents[first]), int(rig.parents[second])
    return (first, second) if first != second else None


def broken(rig: Rig, delta: Floats) -> list[NodeConstraint]:
    """The constraints that would not do the same after the deltas, (n, 4)."""
    return [c for c in rig.node_constraints if not (_alike(rig, c, delta) and axis_fits(c, delta[c.node]))]


def _alike(rig: Rig, constraint: NodeConstraint, delta: Floats) -> bool:
    pair = alike(rig, constraint)
    if pair is None:
        return True
    a, b = (delta[node] if node >= 0 else IDENTITY for node in pair)
    return bool(min(np.abs(a - b).max(), np.abs(a + b).max()) <= SAME)


def axis_fits(constraint: NodeConstraint, delta: Floats) -> bool:
    """Whether the axis of a constraint is again an axis in the new frame of its node."""
    axis = _seen(constraint, delta)
    return bool((np.abs(axis - np.rint(axis)) <= SAME).all())


def axis_straightened(constraint: NodeConstraint, delta: Floats, noise: float) -> Floats:
    """A delta, (4,), that makes it an axis again, where ``delta`` misses that by ``noise`` (radians)."""
    axis = _seen(constraint, delta)
    nearest = np.rint(axis)
    if not nearest.any() or axis_fits(constraint, delta) or np.abs(axis - nearest).max() > noise:
        return delta
    return np.asarray(multiply(delta, between(nearest, axis)))


def reoriented_constraints(rig: Rig, delta: Floats) -> tuple[NodeConstraint, ...]:
    """The constraints of a rig, with their axes in the reoriented frames."""
    return tuple(
        replace(c, axis=np.rint(_seen(c, delta[c.node])) + 0.0) if (delta[c.node] != IDENTITY).any() else c
        for c in rig.node_constraints
    )


def constraints_from_metadata(rig: Rig) -> dict[int, str]:
    """The nodes with a constraint of rigtri's that is also stored as a VRM constraint, and of which kind.

    The record has ``vrm`` then: such a constraint is intended to move its node, and comes and goes with
    the record.
    """
    found: dict[int, str] = {}
    for record in rig.records(ConstraintRecord).values():
        child = rig.known(record.child)
        if record.vrm is not None and child is not None:
            found[child] = record.vrm
    return found


def _seen(constraint: NodeConstraint, delta: Floats) -> Floats:
    return rotate(conjugate(delta), constraint.axis)
