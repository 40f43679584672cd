"""Constraints as VRMC_node_constraint: which ones VRM can hold exactly, and as which kind.

It knows one source and no offset; rotation compares turns from rest in the nodes' own axes,
roll those that the parents see, aim turns the shortest way from rest.

Source: VRMC_node_constraint 1.0 (pseudocode of the three constraints).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rigtri.evaluation.constraint_application import constrained_local
from rigtri.evaluation.constraint_solver import nearest_rotation_of, to_parts
from rigtri.evaluation.sampling import worlds
from rigtri.maths.matrices import skew
from rigtri.maths.quaternions import angle_between, rotation_angle
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.bindings import NodeConstraint
from rigtri.model.constraints import Constraint
from rigtri.model.metadata import ConstraintRecord, NodeConstraintKind
from rigtri.model.rig import Rig

# Radians: what float32 leaves of axes that are one, or of an aim that is met at rest.
_SAME = 1e-5
_LOCAL = "--driver-space local compares those too"
# Axes of a scale that differ by less, as a share, are of one length.
_EVEN = 1e-5


def export_node_constraint(
    rig: Rig, rule: Constraint, known: Sequence[NodeConstraint]
) -> tuple[Rig, str, NodeConstraintKind | None]:
    """The rig with the rule as a node constraint too, "" and its kind; or the rig, why not, and None.

    known: constraints of the file; an equal one is used as it is.
    """
    kind = _kind(rule)
    why = _why_not(rig, rule) or _why_no_frame(rig, rule) or _why_elsewhere(rig, rule)
    if kind is None or why:
        return rig, why, None
    axis = np.zeros(3)
    if kind == "roll":
        axis["xyz".index(rule.roll)] = 1.0
    elif kind == "aim":
        axis = np.rint(normalise(rule.aim)) + 0.0
    new = NodeConstraint(kind, rule.child, rule.drivers[0], axis)
    for old in known:
        if (old.kind, old.node, old.source) == (kind, new.node, new.source) and (old.axis == axis).all():
            new = old
    return replace(rig, node_constraints=(*rig.node_constraints, new)), "", kind


def remove_node_constraint(rig: Rig, node: int) -> Rig:
    """The rig without the node constraint that a constraint of ours was exported to.

    Its metadata has ``vrm``: that there is one, and of which kind.
    """
    record = rig.records(ConstraintRecord)[node]
    child = rig.known(record.child)
    if record.vrm is None or child is None:
        return rig
    kept = tuple(c for c in rig.node_constraints if (c.kind, c.node) != (record.vrm, child))
    return replace(rig, node_constraints=kept)


def _kind(rule: Constraint) -> NodeConstraintKind | None:
    if rule.kind == "aim":
        return "aim"
    if rule.kind != "orient":
        return None
    return "roll" if rule.space == "roll" else "rotation"


def _why_not(rig: Rig, rule: Constraint) -> str:
    """Why no node constraint can hold a constraint, by its options alone; "" where one may."""
    if rig.rules.orient_locked:
        return "a VRM 0 file has none"
    if _kind(rule) is None:
        return "it has only rotation, roll and aim"
    if len(rule.drivers) != 1 or not rule.weights[0]:
        return "it takes one source, with a weight"
    if rule.skip:
        return "it skips no axes"
    if rule.kind == "aim" and rule.world_up != "none":
        return "it knows no up; give --world-up none"
    if rule.kind == "aim" and np.count_nonzero(rule.aim) != 1:
        return "it aims one of the six axes"
    return ""


def _why_no_frame(rig: Rig, rule: Constraint) -> str:
    """Why viewers would not rotate these nodes as the constraint does."""
    child, driver = rule.child, rule.drivers[0]
    if any(c.node == child and c.kind != "tail" for c in rig.node_constraints):
        return "the node has a node constraint already"
    if rig.has_matrix[child] or rig.has_matrix[driver]:
        return "one of the nodes keeps a matrix instead of a rotation"
    if child in rig.frame_of:
        return "the child's axes are held by a node of their own"
    scales = to_parts(rig.normalised_local[[child, driver]]).scale
    if not (rig.scale[[child, driver]] > 0).all() or not (scales > 0).all():
        return "one of the nodes is mirrored"
    compared = rule.kind == "aim" or rule.space == "world"
    world = rig.normalised_world
    above = [int(rig.parents[node]) for node in (child, driver) if rig.parents[node] >= 0]
    if compared and not all(_even(world[node]) for node in above):
        return "a node above is mirrored, or stretched unlike along its axes"
    return ""


def _why_elsewhere(rig: Rig, rule: Constraint) -> str:
    """Why the node constraint would turn the child otherwise than the rule."""
    if rule.kind == "orient" and rule.space == "world":
        if rig.parents[rule.child] != rig.parents[rule.drivers[0]]:
            return f"it compares own axes, and the nodes have two parents; {_LOCAL}"
        if rotation_angle(nearest_rotation_of(rule.offsets[0])) > _SAME:
            return f"it compares own axes, which differ at rest; {_LOCAL}"
    if rule.kind == "aim" and rotation_angle(nearest_rotation_of(rule.offsets[0])) > _SAME:
        return "it keeps no offset, and the axis does not point at the driver at rest"
    local = rig.normalised_local[np.newaxis]
    own = local[:, rule.child]
    found = constrained_local(rig, rule, worlds(rig, local), local, own)
    if _angle_between(found[0], own[0]) > _SAME:
        return "it would turn the child at rest"
    return ""


def _angle_between(a: Floats, b: Floats) -> float:
    return float(angle_between(nearest_rotation_of(a), nearest_rotation_of(b)))


def _even(world: Floats) -> bool:
    """Whether a matrix turns and scales alike in all directions, and mirrors nothing."""
    scale = to_parts(world).scale
    even = scale.max() - scale.min() <= _EVEN * scale.max()
    return bool(scale.min() > 0 and even and skew(world) <= _EVEN)
