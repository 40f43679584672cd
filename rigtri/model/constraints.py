"""Rules by which a node follows others: what a note of type ``constraint`` says, as arrays.

``child_world = offset · driver_world`` and ``child_local = child_world · inverse(child_parent_world)``,
each kind with its part of the matrices; `evaluation.constraint_solver` evaluates them. VRM's own constraints,
which compare local axes, are another matter: `rigtri.frames.node_constraints`.

Source: "Matrix parent constraint" (article).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

import numpy as np

from rigtri.maths.euler import ORDERS, Order
from rigtri.maths.quaternions import IDENTITY
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig

Kind = Literal["parent", "point", "orient", "scale", "aim", "polevector"]
KINDS: tuple[Kind, ...] = get_args(Kind)
Space = Literal["world", "local", "roll"]
WorldUp = Literal["vector", "object", "objectrotation", "none"]
WORLD_UPS: tuple[WorldUp, ...] = get_args(WorldUp)
TRANSLATION, ROTATION, SCALE = ("tx", "ty", "tz"), ("rx", "ry", "rz"), ("sx", "sy", "sz")
# What each kind sets on its child.
CHANNELS: dict[Kind, tuple[str, ...]] = {
    "parent": TRANSLATION + ROTATION + SCALE,
    "point": TRANSLATION,
    "orient": ROTATION,
    "scale": SCALE,
    "aim": ROTATION,
    "polevector": (),
}
_WORLD_Y = (0.0, 1.0, 0.0)


@dataclass(frozen=True, eq=False)
class Rule:
    """How ``child`` follows ``drivers``; nodes are indices of a rig.

    weights: (d,), ≥ 0, their ratio counts; all 0: the child keeps its own. offsets: (d, 4, 4), of
    ``aim`` (1, 4, 4). skip: channels that stay the child's own; of its rotation the angles in
    ``order`` of ``rotate``, where local rotation = rotate · joint_orient. joint_orient, rest: (4,),
    rest is the local rotation that ``roll`` and an aim without up start from. space: of ``orient``,
    what is compared: world axes; ``local``, the driver's turn from rest in its own axes; ``roll``,
    of its turn seen from the two parents the part about the axis ``roll``. aim, up: (3,), in the
    child's axes. up_vector: (3,), in the world, of ``objectrotation`` in the axes of ``up_object``.
    chain: of ``polevector``, root, middle and end joint.
    """

    kind: Kind
    child: int
    drivers: tuple[int, ...]
    weights: Floats
    offsets: Floats
    skip: frozenset[str] = frozenset()
    order: Order = "xyz"
    joint_orient: Floats = field(default_factory=IDENTITY.copy)
    rest: Floats = field(default_factory=IDENTITY.copy)
    space: Space = "world"
    roll: str = ""
    aim: tuple[float, float, float] = (1.0, 0.0, 0.0)
    up: tuple[float, float, float] = _WORLD_Y
    world_up: WorldUp = "none"
    up_vector: tuple[float, float, float] = _WORLD_Y
    up_object: int = -1
    chain: tuple[int, ...] = ()

    @property
    def sets(self) -> frozenset[str]:
        """The channels of the child that it sets."""
        return frozenset(CHANNELS[self.kind]) - self.skip

    @property
    def sources(self) -> tuple[int, ...]:
        """All nodes that it looks at."""
        return (*self.drivers, self.up_object) if self.up_object >= 0 else self.drivers


def note_of(rig: Rig, rule: Rule) -> dict[str, Any]:
    """What is stored of a rule: nodes by address, matrices as rows of 16 numbers one after another."""
    note: dict[str, Any] = {
        "v": 1,
        "type": "constraint",
        "kind": rule.kind,
        "child": rig.address(rule.child),
        "drivers": [rig.address(node) for node in rule.drivers],
        "weights": _numbers(rule.weights),
        "offsets": _numbers(rule.offsets),
    }
    if rule.kind == "polevector":
        return note | {"chain": [rig.address(node) for node in rule.chain]}
    if rule.skip:
        note["skip"] = [channel for channel in CHANNELS[rule.kind] if channel in rule.skip]
    if set(CHANNELS[rule.kind]) & set(ROTATION):
        note |= {"rotateOrder": rule.order, "jointOrient": _numbers(rule.joint_orient)}
    if rule.kind == "aim" or rule.space == "roll":
        note["rest"] = _numbers(rule.rest)
    if rule.kind == "orient":
        note["space"] = rule.space
        note |= {"rollAxis": rule.roll} if rule.space == "roll" else {}
    if rule.kind == "aim":
        note |= {"aim": _numbers(rule.aim), "up": _numbers(rule.up), "worldUp": rule.world_up}
        if rule.world_up in ("vector", "objectrotation"):
            note["worldUpVector"] = _numbers(rule.up_vector)
        if rule.up_object >= 0:
            note["worldUpObject"] = rig.address(rule.up_object)
    return note


def rules_of(rig: Rig) -> dict[int, Rule]:
    """The rules of a rig by the nodes that keep them; what is no whole rule, or of no node here, is none.

    Notes are what a file says: another program, or somebody, may have changed them.
    """
    found = {}
    for node, note in rig.metadata.items():
        if note.get("type") == "constraint" and _whole(note):
            names = (note["child"], *note["drivers"], *note.get("chain", ()))
            names += (note["worldUpObject"],) if "worldUpObject" in note else ()
            if all(rig.known(name) is not None for name in names):
                found[node] = rule_of(rig, note)
    return found


def _whole(note: Mapping[str, Any]) -> bool:
    """Whether a note says all that a rule needs, as schemas/node.schema.json has it."""
    kind, drivers = note.get("kind"), note.get("drivers")
    if kind not in KINDS or not _words(drivers) or not drivers:
        return False
    roll = note.get("space") == "roll"
    return (
        isinstance(note.get("child"), str)
        and _row(note.get("weights"), len(drivers))
        and min(note["weights"]) >= 0
        and _row(note.get("offsets"), 16 * (1 if kind == "aim" else len(drivers)))
        and _words(note.get("skip", []))
        and note.get("rotateOrder", "xyz") in ORDERS
        and note.get("space", "world") in get_args(Space)
        and note.get("rollAxis", "") in (("x", "y", "z") if roll else ("",))
        and note.get("worldUp", "none") in WORLD_UPS
        and all(_row(note[key], 4) for key in ("jointOrient", "rest") if key in note)
        and all(_row(note[key], 3) for key in ("aim", "up", "worldUpVector") if key in note)
        and _words(note.get("chain", []))
        and (kind != "polevector" or len(note.get("chain", ())) == 3)
    )


def _words(value: Any) -> bool:
    return isinstance(value, list | tuple) and all(isinstance(item, str) for item in value)


def _row(value: Any, count: int) -> bool:
    """Whether a value is a list of so many finite numbers."""
    return (
        isinstance(value, list | tuple)
        and len(value) == count
        and all(isinstance(x, int | float) and abs(x) < 1e300 for x in value)
    )


def rule_of(rig: Rig, note: Mapping[str, Any]) -> Rule:
    """The rule that a note of type ``constraint`` tells.

    Raises NameNotFoundError or AmbiguousNameError where a node is no longer called so.
    """
    aim, up, up_vector = (
        _triple(note.get(key, default))
        for key, default in (("aim", (1.0, 0.0, 0.0)), ("up", _WORLD_Y), ("worldUpVector", _WORLD_Y))
    )
    return Rule(
        kind=note["kind"],
        child=rig.find(note["child"], "node"),
        drivers=tuple(rig.find(name, "node") for name in note["drivers"]),
        weights=np.array(note["weights"], dtype=np.float64),
        offsets=np.array(note["offsets"], dtype=np.float64).reshape(-1, 4, 4),
        skip=frozenset(note.get("skip", ())),
        order=note.get("rotateOrder", "xyz"),
        joint_orient=np.array(note.get("jointOrient", IDENTITY), dtype=np.float64),
        rest=np.array(note.get("rest", IDENTITY), dtype=np.float64),
        space=note.get("space", "world"),
        roll=note.get("rollAxis", ""),
        aim=aim,
        up=up,
        world_up=note.get("worldUp", "none"),
        up_vector=up_vector,
        up_object=rig.find(note["worldUpObject"], "node") if "worldUpObject" in note else -1,
        chain=tuple(rig.find(name) for name in note.get("chain", ())),
    )


def _triple(values: Sequence[float]) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return x, y, z


def _numbers(values: Any) -> list[float]:
    """As a flat list; −0 is written as 0."""
    return [float(value) + 0.0 for value in np.asarray(values, dtype=np.float64).ravel()]
