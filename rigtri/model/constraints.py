"""Constraints by which nodes follow others: records of type ``constraint``, as arrays.

``child_world = offset · driver_world`` and ``child_local = child_world · inverse(child_parent_world)``,
each kind with its part of the matrices; `evaluation.constraint_solver` evaluates them. VRM's own constraints,
which compare local axes, are another matter: `rigtri.frames.reoriented_constraints`.

Source: "Matrix parent constraint" (article).
"""

from __future__ import annotations

from dataclasses import field
from typing import Any, get_args

import numpy as np

from rigtri.maths import RotateOrder
from rigtri.maths.quaternions import IDENTITY
from rigtri.maths.trigonometry import Floats
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import (
    CHANNELS,
    ConstraintKind,
    ConstraintRecord,
    ConstraintSpace,
    RollAxis,
    Triple,
    WorldUp,
)
from rigtri.model.rig import Rig

KINDS: tuple[ConstraintKind, ...] = get_args(ConstraintKind)
_X, _Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)


@dataclass(frozen=True, eq=False)
class Constraint:
    """How ``child`` follows ``drivers``; nodes are indices of a rig.

    weights: (d,), ≥ 0, their ratio counts; all 0: the child keeps its own. weight_nodes: (d), or none: nodes
    whose translation x is the weight instead, by which clips can change it. offsets: (d, 4, 4), of
    ``aim`` (1, 4, 4). skip: channels that stay the child's own; of its rotation the angles in
    ``order`` of ``rotate``, where local rotation = rotate · joint_orient. joint_orient, rest: (4,),
    rest is the local rotation that ``roll`` and an aim without up start from. space: of ``orient``,
    what is compared: world axes; ``local``, the driver's turn from rest in its own axes; ``roll``,
    of its turn seen from the two parents the part about the axis ``roll``. aim, up: (3,), in the
    child's axes. up_vector: (3,), in the world, of ``objectrotation`` in the axes of ``up_object``.
    chain: of ``polevector``, root, middle and end joint.
    """

    kind: ConstraintKind
    child: int
    drivers: tuple[int, ...]
    weights: Floats
    offsets: Floats
    weight_nodes: tuple[int, ...] = ()
    skip: frozenset[str] = frozenset()
    order: RotateOrder = "xyz"
    joint_orient: Floats = field(default_factory=IDENTITY.copy)
    rest: Floats = field(default_factory=IDENTITY.copy)
    space: ConstraintSpace = "world"
    roll: RollAxis = ""
    aim: Triple = _X
    up: Triple = _Y
    world_up: WorldUp = "none"
    up_vector: Triple = _Y
    up_object: int = -1
    chain: tuple[int, ...] = ()

    @property
    def sets(self) -> frozenset[str]:
        """The channels of the child that it sets."""
        return frozenset(CHANNELS[self.kind]) - self.skip

    @property
    def active(self) -> bool:
        """Whether a driver has weight, or may get some in a clip."""
        return bool(self.weight_nodes) or bool(self.weights.any())

    @property
    def sources(self) -> tuple[int, ...]:
        """All nodes that it looks at."""
        return (*self.drivers, self.up_object) if self.up_object >= 0 else self.drivers


def constraint_record(rig: Rig, constraint: Constraint) -> ConstraintRecord:
    """What a node stores of a constraint: nodes by address, matrices as 16 numbers, row by row."""
    kind, chain, rotates = constraint.kind, constraint.chain, "rx" in CHANNELS[constraint.kind]
    aims, rolls = kind == "aim", constraint.space == "roll"
    vector = aims and constraint.world_up in ("vector", "objectrotation")
    return ConstraintRecord(
        kind=kind,
        child=rig.address(constraint.child),
        drivers=tuple(map(rig.address, constraint.drivers)),
        weights=_numbers(constraint.weights),
        weight_nodes=tuple(map(rig.address, constraint.weight_nodes)),
        offsets=_numbers(constraint.offsets),
        chain=tuple(map(rig.address, chain)),
        skip=tuple(channel for channel in CHANNELS[kind] if channel in constraint.skip),
        rotate_order=constraint.order if rotates else None,
        joint_orient=_numbers(constraint.joint_orient) if rotates else None,
        rest=_numbers(constraint.rest) if aims or rolls else None,
        space=constraint.space if kind == "orient" else None,
        roll_axis=constraint.roll if rolls else None,
        aim=_numbers(constraint.aim) if aims else None,
        up=_numbers(constraint.up) if aims else None,
        world_up=constraint.world_up if aims else None,
        world_up_vector=_numbers(constraint.up_vector) if vector else None,
        world_up_object=rig.address(constraint.up_object) if aims and constraint.up_object >= 0 else "",
    )


def constraints_of(rig: Rig) -> dict[int, Constraint]:
    """The constraints of a rig by the nodes that keep them, without damaged ones and those of unknown nodes.

    Another program, or somebody, may have changed what a file stores.
    """
    found = {}
    for node, record in rig.records(ConstraintRecord).items():
        names = (record.child, *record.drivers, *record.chain, *record.weight_nodes)
        names += (record.world_up_object,) if record.world_up_object else ()
        if _fits(record) and all(rig.known(name) is not None for name in names):
            found[node] = constraint_of(rig, record)
    return found


def _fits(record: ConstraintRecord) -> bool:
    """Whether the values of a record fit each other, as schemas/node.schema.json has it."""
    count = len(record.drivers)
    return (
        0 < count == len(record.weights)
        and min(record.weights) >= 0
        and len(record.weight_nodes) in (0, count)
        and len(record.offsets) == 16 * (1 if record.kind == "aim" else count)
        and bool(record.roll_axis) == (record.space == "roll")
        and (record.kind != "polevector" or len(record.chain) == 3)
    )


def constraint_of(rig: Rig, record: ConstraintRecord) -> Constraint:
    """The constraint of a record.

    Raises NameNotFoundError or AmbiguousNameError where a node is no longer called so.
    """
    return Constraint(
        kind=record.kind,
        child=rig.find(record.child, "node"),
        drivers=tuple(rig.find(name, "node") for name in record.drivers),
        weights=np.array(record.weights, dtype=np.float64),
        weight_nodes=tuple(rig.find(name, "node") for name in record.weight_nodes),
        offsets=np.array(record.offsets, dtype=np.float64).reshape(-1, 4, 4),
        skip=frozenset(record.skip),
        order=record.rotate_order or "xyz",
        joint_orient=np.array(record.joint_orient or IDENTITY, dtype=np.float64),
        rest=np.array(record.rest or IDENTITY, dtype=np.float64),
        space=record.space or "world",
        roll=record.roll_axis or "",
        aim=record.aim or _X,
        up=record.up or _Y,
        world_up=record.world_up or "none",
        up_vector=record.world_up_vector or _Y,
        up_object=rig.find(record.world_up_object, "node") if record.world_up_object else -1,
        chain=tuple(rig.find(name) for name in record.chain),
    )


def _numbers(values: Any) -> Any:
    """As a flat tuple; −0 is written as 0."""
    return tuple(float(value) + 0.0 for value in np.asarray(values, dtype=np.float64).ravel())
