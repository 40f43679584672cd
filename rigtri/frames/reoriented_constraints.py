"""Constraints in reoriented frames: VRM's, rigtri's own, and the axes of twist joints and pose readers.

A VRM node constraint keeps its meaning, for every motion and every weight, exactly when

* rotation, tail: source and node get the same delta (their parents do not matter);
* roll: the parents of source and node get the same delta, and in the new frame of the node
  the roll axis is again one of its axes (the delta of the source does not matter);
* aim: in the new frame of the node the aim axis is again one of the six.

Then nothing but the letter of the axis is to be written anew.

Of rigtri's own, with row matrices, C of the child, D of a driver and the parent's P: where ``world' =
C·world``, an offset becomes ``C·offset·D⁻¹``, axes of the child are seen from its new frame, and local
rotations take the parent's delta off. What the axes themselves define (skipped channels, lengths of axes,
rotations in own axes) cannot be expressed in others: `axes_compared` ties those nodes as VRM's constraints
do.

Source: derived from `rigtri.model.constraints` and the pseudocode of VRMC_node_constraint
1.0; docs/exactness.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import rotate_after, rotate_before
from rigtri.maths.quaternions import IDENTITY, between, conjugate, multiply, quadruple, rotate, to_axes
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length, triple
from rigtri.model.bindings import NodeConstraint
from rigtri.model.constraints import Constraint, constraint_record, constraints_of
from rigtri.model.metadata import (
    ConstraintRecord,
    OffsetRecord,
    OutputRecord,
    PoseReaderRecord,
    Quaternion,
    Record,
    RollAxis,
    TargetRecord,
    Triple,
    TwistRecord,
)
from rigtri.model.rig import Rig

# Turns and axes that differ by less (radians) are one: what float64 leaves over.
_SAME = 1e-9
# What float32 leaves of the axes of a node below many others, as differences of unit vectors.
SAME_AXES = 1e-4
POINTS = "points in another direction"
_AXES: tuple[RollAxis, ...] = ("x", "y", "z")
_NONE = np.zeros(3)
# What a change of frames gives new numbers; the rest of a record stays as it was written.
_REORIENTED = ("offsets", "joint_orient", "rest", "aim", "up", "world_up_vector", "roll_axis")


def coupled_nodes(rig: Rig, constraint: NodeConstraint) -> tuple[int, int] | None:
    """The two nodes that must take one delta, the leading one first; −1 is the world, which takes none."""
    if constraint.kind == "aim":
        return None
    first, second = constraint.source, constraint.node
    if constraint.kind == "roll":
        first, second = int(rig.parents[first]), int(rig.parents[second])
    return (first, second) if first != second else None


def changed_meaning(
    before: Rig, constraint: NodeConstraint, now: NodeConstraint, nodes: Integers, axes: tuple[Floats, Floats]
) -> str:
    """What is otherwise of a constraint than it was, in words; "" where it does the same.

    now: the same constraint after an edit. nodes: where each node is then, −1 where it is gone. axes: of the
    nodes in the world at rest before and then, (n, 3, 3).
    """
    was, seen = constraint.axis @ axes[0][constraint.node], now.axis @ axes[1][now.node]
    ways = (seen, -seen) if constraint.kind == "roll" else (seen,)
    if all(length(was - way) > SAME_AXES for way in ways):
        return POINTS
    first, second = (
        axes[0][node] @ axes[1][nodes[node]].T if node >= 0 and nodes[node] >= 0 else np.eye(3)
        for node in coupled_nodes(before, constraint) or (-1, -1)
    )
    return "compares axes that no longer correspond" if np.abs(first - second).max() > SAME_AXES else ""


def axes_compared(rig: Rig) -> tuple[NodeConstraint, ...]:
    """All that compares axes: the node constraints of a rig, and what its own constraints tie together."""
    found = list(rig.node_constraints)
    for rule in constraints_of(rig).values():
        if rule.kind == "scale":
            found += [_kept(node) for node in (rule.child, *rule.drivers)]
        elif rule.skip:
            above = int(rig.parents[rule.child])
            found += [_kept(node) for node in (rule.child, above) if node >= 0]
        elif rule.space == "local":
            found += [NodeConstraint("rotation", rule.child, node, _NONE) for node in rule.drivers]
        elif rule.space == "roll":
            axis = np.eye(3)["xyz".index(rule.roll)]
            found += [NodeConstraint("roll", rule.child, node, axis) for node in rule.drivers]
    for reader in rig.records(PoseReaderRecord).values():
        # Its scale is along its own axes.
        grown = (rig.known(output.joint) for output in reader.outputs if output.scale is not None)
        found += [_kept(node, "grown") for node in grown if node is not None]
    return tuple(found)


def _kept(node: int, kind: Literal["channels", "grown"] = "channels") -> NodeConstraint:
    return NodeConstraint(kind, node, -1, _NONE)


def broken(rig: Rig, delta: Floats) -> list[NodeConstraint]:
    """What compares axes and would not do the same after the deltas, (n, 4)."""
    return [c for c in axes_compared(rig) if not (_ends_agree(rig, c, delta) and axis_fits(c, delta[c.node]))]


def _ends_agree(rig: Rig, constraint: NodeConstraint, delta: Floats) -> bool:
    pair = coupled_nodes(rig, constraint)
    if pair is None:
        return True
    a, b = (delta[node] if node >= 0 else IDENTITY for node in pair)
    return _equal_rotations(a, b)


def axis_fits(constraint: NodeConstraint, delta: Floats) -> bool:
    """Whether the axis of a constraint is again an axis in the new frame of its node."""
    axis = _axis_in(constraint, delta)
    return bool((np.abs(axis - np.rint(axis)) <= _SAME).all())


def axis_straightened(constraint: NodeConstraint, delta: Floats, noise: float) -> Floats:
    """A delta, (4,), that makes it an axis again, where ``delta`` misses that by ``noise`` (radians)."""
    axis = _axis_in(constraint, delta)
    nearest = np.rint(axis)
    if not nearest.any() or axis_fits(constraint, delta) or np.abs(axis - nearest).max() > noise:
        return delta
    return np.asarray(multiply(delta, between(nearest, axis)))


def reoriented_constraints(rig: Rig, delta: Floats) -> tuple[NodeConstraint, ...]:
    """The constraints of a rig, with their axes in the reoriented frames."""
    return tuple(
        replace(c, axis=np.rint(_axis_in(c, delta[c.node])) + 0.0) if (delta[c.node] != IDENTITY).any() else c
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


def _axis_in(constraint: NodeConstraint, delta: Floats) -> Floats:
    return rotate(conjugate(delta), constraint.axis)


def reoriented_metadata(
    rig: Rig, delta: Floats, outside: Floats = IDENTITY
) -> Mapping[int, Mapping[str, Any]]:
    """The metadata of a rig, with its constraints expressed in frames reoriented by ``delta``, (n, 4).

    outside: (4,), of the world, which stands above the roots.
    """
    delta = np.concatenate([delta, outside[np.newaxis]])  # −1 is the parent of a root
    found: dict[int, Record] = {}
    for node, rule in constraints_of(rig).items():
        if _touched(rig, rule, delta):
            new = constraint_record(rig, _reoriented(rig, rule, delta))
            numbers = {key: value for key in _REORIENTED if (value := getattr(new, key)) is not None}
            found[node] = replace(rig.records(ConstraintRecord)[node], **numbers)
    for node, reader in rig.records(PoseReaderRecord).items():
        found[node] = _reoriented_reader(rig, reader, delta)
    for node, twist in rig.records(TwistRecord).items():
        found[node] = _reoriented_twist(rig, node, twist, delta)
    for node, offset in rig.records(OffsetRecord).items():
        joint = rig.known(offset.joint)
        if offset.kind != "root" and joint is not None and (_of(delta, joint) != IDENTITY).any():
            turn = _of(delta, joint)
            axes = quadruple(multiply(np.array(offset.axes or IDENTITY), turn))
            scale = None if offset.scale is None else triple(_shared(offset.scale, turn))
            found[node] = replace(offset, axes=axes, scale=scale)
    return {**rig.metadata, **{node: record.to_dict() for node, record in found.items()}}


def _shared(scale: Triple, turn: Floats) -> Floats:
    """A scale along turned axes: of the one that it has where axes are axes again, else by their shares."""
    x, y, z = scale
    shares = to_axes(turn) * to_axes(turn)
    return np.asarray(np.array(scale) if x == y == z else sum(scale[k] * shares[:, k] for k in range(3)))


def _seen(vector: Triple, own: Floats) -> Triple:
    """A vector of a node's axes, seen from its new ones; the very numbers where it keeps its frame."""
    if not (own != IDENTITY).any():
        return vector
    return triple(rotate(conjugate(own), np.array(vector, dtype=np.float64)))


def _reoriented_reader(rig: Rig, reader: PoseReaderRecord, delta: Floats) -> PoseReaderRecord:
    """What a pose reader looks for, seen from the new axes of its driver and of its frame."""
    driver, frame = rig.known(reader.driver), rig.known(reader.frame)
    if driver is None or (frame is None and reader.frame):
        return reader
    own, above = _of(delta, driver), _of(delta, -1 if frame is None else frame)

    def target(one: TargetRecord) -> TargetRecord:
        direction = None if one.direction is None else _seen(one.direction, above)
        return replace(one, direction=direction, rotation=_rotation_seen(one.rotation, own, above))

    def output(one: OutputRecord) -> OutputRecord:
        joint = rig.known(one.joint) if one.joint else None
        if joint is None:
            return one
        mine, over = _of(delta, joint), _of(delta, int(rig.parents[joint]))
        moved = None if one.translation is None else _seen(one.translation, over)
        return replace(one, translation=moved, rotation=_rotation_seen(one.rotation, mine, mine))

    outputs = tuple(map(output, reader.outputs))
    targets = tuple(map(target, reader.targets))
    rest = _rotation_seen(reader.rest, own, above)
    return replace(reader, axis=_seen(reader.axis, own), targets=targets, rest=rest, outputs=outputs)


def _reoriented_twist(rig: Rig, node: int, twist: TwistRecord, delta: Floats) -> TwistRecord:
    joint, driver = rig.known(twist.joint), rig.known(twist.driver)
    if joint is None or driver is None:
        return twist
    bone = _of(delta, joint)
    # The driver is seen from the bone's joint, or where it is that joint itself, from what is above it.
    above = _of(delta, int(rig.parents[rig.frame_of.get(joint, joint)])) if driver == joint else bone
    return replace(
        twist,
        axis=None if twist.axis is None else _seen(twist.axis, bone),
        rest=_rotation_seen(twist.rest, _of(delta, driver), above),
        standing=_rotation_seen(twist.standing, _of(delta, node), bone),
    )


def _rotation_seen(rotation: Quaternion | None, own: Floats, above: Floats) -> Quaternion | None:
    """A rotation of a node relative to another, in the new axes of both; the very numbers where they stay."""
    if rotation is None or not ((own != IDENTITY).any() or (above != IDENTITY).any()):
        return rotation
    return quadruple(multiply(conjugate(above), multiply(np.array(rotation), own)))


def _of(delta: Floats, node: int) -> Floats:
    return np.asarray(delta[node])


def _touched(rig: Rig, rule: Constraint, delta: Floats) -> bool:
    nodes = [rule.child, *rule.sources, -1]
    nodes += [int(rig.parents[node]) for node in nodes[:-1]]
    return any((_of(delta, node) != IDENTITY).any() for node in nodes)


def _equal_rotations(a: Floats, b: Floats) -> bool:
    return bool(min(np.abs(a - b).max(), np.abs(a + b).max()) <= _SAME)


def _reoriented(rig: Rig, rule: Constraint, delta: Floats) -> Constraint:
    own, above = _of(delta, rule.child), _of(delta, int(rig.parents[rule.child]))
    roll = rule.roll
    if roll:
        seen = np.abs(rotate(conjugate(own), np.eye(3)["xyz".index(roll)]))
        roll = _AXES[int(np.argmax(seen))]
    aim, up = (rotate(conjugate(own), np.array(axis)) for axis in (rule.aim, rule.up))
    up_vector = np.array(rule.up_vector)
    if rule.world_up in ("vector", "objectrotation"):
        seen_from = rule.up_object if rule.world_up == "objectrotation" else -1
        up_vector = rotate(conjugate(_of(delta, seen_from)), up_vector)
    return replace(
        rule,
        offsets=_offsets(rig, rule, delta, own, above),
        joint_orient=multiply(conjugate(above), multiply(rule.joint_orient, own)),
        rest=multiply(conjugate(above), multiply(rule.rest, own)),
        roll=roll,
        aim=tuple(aim.tolist()),
        up=tuple(up.tolist()),
        up_vector=tuple(up_vector.tolist()),
    )


def _offsets(rig: Rig, rule: Constraint, delta: Floats, own: Floats, above: Floats) -> Floats:
    drivers = np.stack([_of(delta, node) for node in rule.drivers])
    if rule.kind == "scale":
        return rule.offsets
    if rule.kind == "point":  # lengths along the axes of the world
        offsets = rule.offsets.copy()
        offsets[:, 3, :3] = rotate(conjugate(_of(delta, -1)), offsets[:, 3, :3])
        return offsets
    if rule.kind == "polevector":  # a place in the frame of the driver; its axes mean nothing
        return rotate_after(rotate_before(drivers, rule.offsets), conjugate(drivers))
    if rule.kind == "aim":
        return rotate_after(rotate_before(own, rule.offsets), conjugate(own))
    if rule.space == "local":
        parents = np.stack([_of(delta, int(rig.parents[node])) for node in rule.drivers])
        return rotate_after(rotate_before(parents, rule.offsets), conjugate(above))
    return rotate_after(rotate_before(own, rule.offsets), conjugate(drivers))
