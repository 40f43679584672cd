"""Scales that controls and constraints give joints, which new axes of the joints have to keep, as their own.

A joint takes its control's scale along its own axes. So a scale that is not uniform allows only axes onto
axes, or a turn about the odd one where the control has the joint's axes. A parent constraint gives its child
the lengths of the child's axes, whatever is scaled between the two: axes onto axes again.
"""

from __future__ import annotations

from collections.abc import Container, Iterator

import numpy as np

from rigtri.evaluation.zero_pose import ControlsAtZero, FkControl
from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.frames.reoriented_constraints import axes_compared
from rigtri.maths.quaternions import conjugate, multiply, to_axes
from rigtri.maths.trigonometry import Floats
from rigtri.model.constraints import Constraint, constraints_of
from rigtri.model.rig import Rig

# Cosines whose squares are this near to 0 and 1 are of axes along axes: offsets are float32.
_ALONG = 1e-6
# A scale that only axes onto axes keep.
_ANY = np.array([[1.0, 2.0, 3.0]])


def scales_given(rig: Rig, scales: ScaleTable) -> tuple[ScaleTable, dict[int, int]]:
    """The scales, with those that controls and constraints give; and what gives one, by node."""
    rules = [rule for rule in constraints_of(rig).values() if rule.kind == "parent"]
    grown = {one.node for one in axes_compared(rig) if one.kind == "grown"}
    controlled, found = bool(rig.nodes_of("control")), dict[int, int]()
    while True:
        if controlled:
            scales, controls = scales_by_controls(rig, scales)
            found = {**controls, **found}
        uneven = grown.union(np.flatnonzero(scales.uneven).tolist())
        drivers = {rule.child: _odd_between(rig, rule, uneven) for rule in rules if rule.child not in found}
        drivers = {child: node for child, node in drivers.items() if node >= 0}
        if not drivers:
            return scales, found
        scales, found = scales.with_rows(dict.fromkeys(drivers, _ANY)), {**drivers, **found}


def _odd_between(rig: Rig, rule: Constraint, uneven: Container[int]) -> int:
    """A node between a child's parent and its drivers whose scale is not uniform, else −1."""
    above = rig.path_to_root(int(rig.parents[rule.child]))
    for driver in rule.drivers:
        path = rig.path_to_root(driver)
        for node in (*path, *above):
            if node in uneven and (node in path) != (node in above):
                return node
    return -1


def scales_by_controls(rig: Rig, scales: ScaleTable) -> tuple[ScaleTable, dict[int, int]]:
    """The scales, with those that controls give joints; and these controls, by joint."""
    reference = ControlsAtZero(rig)
    found, rows = dict[int, int](), dict[int, Floats]()
    for own in (*reference.fk.values(), *reference.roots):
        for control in _controls(reference, own):
            if scales.uneven[control]:
                if not scales.uneven[own.joint]:
                    found.setdefault(own.joint, control)
                given = _along_joint(reference, own.joint, control, scales.of_node(control))
                rows[own.joint] = np.concatenate([rows.get(own.joint, np.empty((0, 3))), given])
    return scales.with_rows(rows), found


def _controls(reference: ControlsAtZero, own: FkControl) -> Iterator[int]:
    """The controls whose scale a joint takes: its own, and those above where no joint above takes theirs."""
    rig = reference.rig
    yield own.control
    carrier = reference.control_of.get(own.above, own.above)
    if carrier >= 0 and not rig.is_below(own.joint, carrier):
        yield from (node for node in rig.path_to_root(own.above) if rig.type_of(node) == "control")


def _along_joint(reference: ControlsAtZero, joint: int, control: int, scales: Floats) -> Floats:
    """Scales of a control, (k, 3), along the axes of its joint; any that differ where the axes differ."""
    seen = multiply(conjugate(reference.world_rotation(joint)), reference.world_rotation(control))
    shares = to_axes(seen) ** 2
    if np.abs(shares - np.rint(shares)).max() > _ALONG:
        return _ANY
    return np.asarray(np.abs(scales)[:, shares.argmax(axis=0)])
