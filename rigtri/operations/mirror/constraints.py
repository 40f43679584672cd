"""Mirroring constraints: created or updated on the other side; nothing moves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError, UsageError
from rigtri.evaluation.constraint_solver import to_parts
from rigtri.frames.mirroring import mirrored_axes, world_rotation
from rigtri.maths.matrices import identity
from rigtri.maths.quaternions import IDENTITY, angle_between, conjugate, from_axes, multiply, to_axes
from rigtri.maths.trigonometry import Floats
from rigtri.model.constraints import Constraint, constraints_of
from rigtri.model.rig import Rig
from rigtri.operations.constrain.constrain import follow
from rigtri.operations.mirror.mirrored_metadata import (
    ALIKE,
    MirrorOptions,
    alike,
    direction,
    lone,
    of_side,
    other,
    size_of,
)
from rigtri.report import Report


def mirror_rules(rig: Rig, options: MirrorOptions, report: Report) -> Rig:
    """Let the twins follow as this side does, by offsets that leave them where they are."""
    for node, note in of_side(rig, options, "constraint"):
        rule = constraints_of(rig).get(node)
        mirrored = None if rule is None else _mirrored(rig, rule, options)
        if rule is None or mirrored is None:
            lone(rig, node, report, "constraint", "the other side lacks a node that it is about")
            continue
        keep = bool(np.abs(rule.offsets - identity(len(rule.offsets))).max() > ALIKE)
        built_report = Report()
        try:
            built = follow(rig, mirrored, keep=keep, vrm="vrm" in note, report=built_report)
        except (UsageError, GeometryError) as error:
            lone(rig, node, report, "constraint", str(error))
            continue
        same = len(built) == len(rig) and all(
            alike(known, built.metadata[k], size_of(rig)) for k, known in rig.metadata.items()
        )
        rig = rig if same else built
        report.added.extend(built_report.added)
        report.extend(built_report.warnings)
    return rig


def _mirrored(rig: Rig, rule: Constraint, options: MirrorOptions) -> Constraint | None:
    """The rule of the other side, with offsets still to be measured; None where a node has no twin."""
    child, chain = other(rig, rule.child), [other(rig, node) for node in rule.chain]
    drivers = [other(rig, node) for node in rule.drivers]
    up_object = other(rig, rule.up_object) if rule.up_object >= 0 else -1
    if child is None or up_object is None or None in drivers or None in chain:
        return None
    up_vector = np.array(rule.up_vector, dtype=np.float64)
    if rule.world_up == "vector":
        up_vector = options.across.directions(up_vector) + 0.0
    elif rule.world_up == "objectrotation":
        up_vector = direction(rig, rule.up_object, up_object, up_vector, options)
    vectors = (
        direction(rig, rule.child, child, np.array(own, dtype=np.float64), options)
        for own in (rule.aim, rule.up)
    )
    aim, up, above = ((float(v[0]), float(v[1]), float(v[2])) for v in (*vectors, up_vector))
    return replace(
        rule,
        child=child,
        drivers=tuple(node for node in drivers if node is not None),
        chain=tuple(node for node in chain if node is not None),
        joint_orient=_joint_orient(rig, rule, child, options),
        rest=to_parts(rig.normalised_local[child]).rotation,
        aim=aim if rule.kind == "aim" else rule.aim,
        up=up if rule.kind == "aim" else rule.up,
        up_vector=above if rule.kind == "aim" else rule.up_vector,
        up_object=up_object,
    )


def _joint_orient(rig: Rig, rule: Constraint, child: int, options: MirrorOptions) -> Floats:
    """The twin's own rest rotation or none, where the rule's is that, else the mirrored one, (4,)."""
    local, given = rig.normalised_local, rule.joint_orient
    if _same(given, IDENTITY):
        return IDENTITY.copy()
    if _same(given, to_parts(local[rule.child]).rotation):
        return to_parts(local[child]).rotation
    here, there = (world_rotation(rig, int(rig.parents[node])) for node in (rule.child, child))
    seen = mirrored_axes(to_axes(multiply(here, given)), options.mode, options.across)
    return multiply(conjugate(there), from_axes(seen))


def _same(one: Floats, two: Floats) -> bool:
    return bool(angle_between(one, two) <= ALIKE)
