"""Solver steps that move nodes: root controls, constraints, twist joints; FK and IK have their own modules.

Source: docs/evaluation.md.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Protocol

import numpy as np

from rigtri.evaluation.constraint_solver import evaluate_constraint, to_parts
from rigtri.evaluation.dependency_graph import Uses, moved_by
from rigtri.evaluation.fk import Fk
from rigtri.evaluation.pose_cache import PoseCache
from rigtri.evaluation.twist_joints import TwistJoint
from rigtri.evaluation.zero_pose import ControlsAtZero, FkControl
from rigtri.maths.matrices import inverse, multiply
from rigtri.model.animation import Path
from rigtri.model.constraints import Constraint
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig

CHANNELS: dict[str, Path] = {"t": "translation", "r": "rotation", "s": "scale"}


class Step(Uses, Protocol):
    """Something that moves nodes."""

    def run(self, posed: PoseCache) -> None: ...


def depending(rig: Rig, nodes: Iterable[int], steps: Iterable[Step]) -> set[int]:
    """The nodes whose places depend on some nodes: these, all below them, and what steps make of them.

    steps: in the order in which they are done.
    """
    found = np.zeros(len(rig), dtype=bool)
    found[list(nodes)] = True
    for step in steps:
        if found[list(rig.with_ancestors((*step.reads, *step.needs)))].any():
            found[[*moved_by(step)]] = True
    return set(np.flatnonzero(rig.at_or_below(found)).tolist())


@dataclass(frozen=True, eq=False)
class RootStep:
    """The control over all, for a joint that no control of its own moves: it is carried along."""

    reference: ControlsAtZero
    own: FkControl

    @property
    def sets(self) -> tuple[int, ...]:
        return (self.own.joint,)

    @property
    def reads(self) -> tuple[int, ...]:
        return ()

    @property
    def needs(self) -> tuple[int, ...]:
        above = int(self.reference.rig.parents[self.own.joint])
        return (self.own.control, above) if above >= 0 else (self.own.control,)

    def run(self, posed: PoseCache) -> None:
        joint, control = self.own.joint, self.own.control
        world = self.reference.world
        start = multiply(world[joint], inverse(world[control]))
        above = int(self.reference.rig.parents[joint])
        seen = multiply(multiply(start, posed.world(control)), inverse(posed.world(above)))
        found = self.reference.carried_parts(joint, control, seen)
        posed.set(joint, posed.mended(found, start, control, above))


@dataclass(frozen=True, eq=False)
class ConstraintStep:
    """Rules of one child, in the order in which they come on top of each other.

    riders: FK controls below the child's own control, and ride on the child wherever rules
    have it, because something looks at what is below them. rolls: the child is a toe that IK moves first.
    """

    rig: Rig
    rules: tuple[Constraint, ...]
    base: Step | None = None
    riders: tuple[Fk, ...] = ()
    rolls: bool = False

    @property
    def child(self) -> int:
        return self.rules[0].child

    @property
    def sets(self) -> tuple[int, ...]:
        return self.base.sets if self.base is not None else (self.child,)

    @property
    def reads(self) -> tuple[int, ...]:
        own = self.base.reads if self.base is not None else ()
        local = [node for rule in self.rules if rule.space != "world" for node in rule.drivers]
        return (*own, *local, *(node for rule in self.rules for node in rule.weight_nodes))

    @property
    def needs(self) -> tuple[int, ...]:
        own = self.base.needs if self.base is not None else ()
        world = [node for rule in self.rules if rule.space == "world" for node in rule.sources]
        above = int(self.rig.parents[self.child])
        return (*own, *world, *((above,) if above >= 0 else ()), *(fk.own.above for fk in self.riders))

    @property
    def carries(self) -> tuple[int, ...]:
        """The offsets that ride on the child; they get no keys."""
        return tuple(fk.own.offset for fk in self.riders)

    @property
    def left(self) -> frozenset[Path]:
        """What the child itself has a say in: the paths of which no rule with weight sets all channels."""
        whole = [rule.sets for rule in self.rules if rule.weights.any() and not rule.weight_nodes]
        return frozenset(
            path for c, path in CHANNELS.items() if not any({f"{c}{k}" for k in "xyz"} <= s for s in whole)
        )

    @property
    def writes(self) -> list[tuple[Path, bool]]:
        """See `Solver.writes`. A rule without weights leaves its child alone, or some channels."""
        whole = [rule for rule in self.rules if rule.active]
        found: list[tuple[Path, bool]] = []
        for letter, path in CHANNELS.items():
            set_by = [{c for c in rule.sets if c[0] == letter} for rule in whole]
            moved = self.rolls or self.base is not None
            if moved or any(set_by):
                found.append((path, moved or any(len(each) == 3 for each in set_by)))
        return found

    def run(self, posed: PoseCache) -> None:
        if self.base is not None:
            self.base.run(posed)
        for rule in (weighted(rule, posed) for rule in self.rules):
            of = posed.world if rule.space == "world" else posed.local
            drivers = [of(node) for node in rule.drivers]
            parent, own = posed.world(int(self.rig.parents[self.child])), posed.local(self.child)
            up = posed.world(rule.up_object) if rule.up_object >= 0 else None
            held = [*drivers, parent, own, *([up] if up is not None else [])]
            count = max(*map(len, held), len(rule.weights) if rule.weights.ndim > 1 else 1)
            wide = [np.broadcast_to(m, (count, 4, 4)) for m in held]
            there = np.stack(wide[: len(drivers)], axis=1)
            found = evaluate_constraint(
                rule, there, wide[len(drivers)], wide[len(drivers) + 1], wide[-1] if up is not None else None
            )
            posed.set(self.child, to_parts(found), again=self.rolls)
        for fk in self.riders:
            posed.set(fk.own.offset, fk.riding(posed))


def weighted(rule: Constraint, posed: PoseCache) -> Constraint:
    """A rule with the weights that its nodes have in some poses, (1 or f, d)."""
    if not rule.weight_nodes:
        return rule
    own = np.broadcast_arrays(*(posed.part(node).translation[:, 0] for node in rule.weight_nodes))
    return replace(rule, weights=np.maximum(np.stack(own, axis=1), 0.0))


@dataclass(frozen=True, eq=False)
class TwistStep:
    """A twist joint."""

    rig: Rig
    twist: TwistJoint

    @property
    def sets(self) -> tuple[int, ...]:
        return (self.twist.node,)

    @property
    def reads(self) -> tuple[int, ...]:
        return self.twist.path

    @property
    def needs(self) -> tuple[int, ...]:
        return ()

    def run(self, posed: PoseCache) -> None:
        local = [posed.local(node) for node in self.twist.path]
        count = max(map(len, local))
        matrices = np.stack([np.broadcast_to(m, (count, 4, 4)) for m in local], axis=1)
        turn = replace(self.twist, path=tuple(range(len(local)))).rotations(matrices)
        posed.set(self.twist.node, posed.part(self.twist.node)._replace(rotation=turn))
