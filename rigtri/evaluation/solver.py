"""The solver of a rig: which controls, limbs and constraints are active, and in which order they work.

Source: docs/evaluation.md, which describes the same in words.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cached_property

from rigtri.errors import GeometryError
from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.dependency_graph import channel_order, in_order, steps_for
from rigtri.evaluation.fk import Fk
from rigtri.evaluation.ik import Ik
from rigtri.evaluation.pose_cache import BLOCK, PoseCache, blocks, cut, frames, joined
from rigtri.evaluation.solver_steps import CHANNELS, ConstraintStep, RootStep, Step, TwistStep
from rigtri.evaluation.twist_joints import twist_joints
from rigtri.evaluation.zero_pose import ControlsAtZero
from rigtri.model.animation import Path
from rigtri.model.constraints import Constraint, constraints_of
from rigtri.model.metadata import ControlRecord
from rigtri.model.rig import Rig


class Solver:
    """The steps of a rig, in the order in which they can be taken.

    driven: the controls, IK ends and poles that are at work; None: all of them. reference: that of a rig
    which differs in nothing but its clips. Raises ControlCycleError, and GeometryError for a driver whose
    motion could not be read.
    """

    def __init__(
        self, rig: Rig, driven: Collection[int] | None = None, reference: ControlsAtZero | None = None
    ) -> None:
        self.rig = rig
        self.reference = ControlsAtZero(rig) if reference is None else reference
        self.driven = driven
        # What another character has that follows this one is evaluated with that one.
        rules = [rule for rule in constraints_of(rig).values() if rule.child not in rig.others]
        _refuse_unread(rig, rules)
        self.poles = {rule.chain: rule for rule in rules if rule.kind == "polevector"}
        self.rules: dict[int, list[Constraint]] = {}
        for rule in rules:
            if rule.kind != "polevector":
                self.rules.setdefault(rule.child, []).append(rule)

    def _works(self, *controls: int) -> bool:
        rules = set(self.rules)
        return self.driven is None or any(node in self.driven or node in rules for node in controls)

    @cached_property
    def limbs(self) -> list[Ik]:
        """The limbs whose IK end or pole is at work."""
        found, taken = [], set[int]()
        for limb in self.reference.limbs:
            rule = self.poles.get(limb.chain)
            rolls = limb.toe >= 0 and self._works(*limb.pivots)
            poles = (limb.pole,) if limb.pole >= 0 else ()
            works = self._works(limb.control, *poles, *limb.pivots)
            if works and taken.isdisjoint(limb.chain):
                taken.update(limb.chain)
                moved = (*limb.chain, limb.toe) if rolls else limb.chain
                fk = {
                    node: Fk(self.reference, self.reference.fk[node])
                    for node in moved
                    if node in self.reference.fk
                }
                offsets = {each.own.offset for each in fk.values()}
                found.append(
                    Ik(
                        self.reference,
                        limb,
                        fk,
                        rule,
                        tuple(sorted((offsets & self._looked_at) - self.still)),
                        rolls,
                    )
                )
        return found

    @cached_property
    def _looked_at(self) -> set[int]:
        """The nodes that constraints, IK controls, poles and indirect FK controls use, and all above."""
        own = self._of_limbs
        looking = [node for rule in constraints_of(self.rig).values() for node in rule.sources]
        looking += [int(self.rig.parents[child]) for child in self.rules if child not in own]
        for limb in self.reference.limbs:
            looking += [limb.holder, limb.pole]
        looking += [node for own in self.reference.fk.values() for node in Fk(self.reference, own).needs]
        return self.rig.with_ancestors(looking)

    @cached_property
    def _of_limbs(self) -> frozenset[int]:
        """The FK controls of limbs, and their offsets."""
        joints = [node for limb in self.reference.limbs for node in limb.chain if node in self.reference.fk]
        owns = [self.reference.fk[node] for node in joints]
        return frozenset(node for own in owns for node in (own.control, own.offset))

    @cached_property
    def still(self) -> frozenset[int]:
        """The FK controls of limbs, and offsets, that rules move or that hold such: IK leaves them alone."""
        return self._of_limbs & self.rig.with_ancestors(self._of_limbs.intersection(self.rules))

    @cached_property
    def offsets(self) -> frozenset[int]:
        """The offsets of FK controls that follow their limbs while IK solves these."""
        return frozenset(fk.own.offset for limb in self.limbs for fk in limb.fk.values())

    @cached_property
    def steps(self) -> list[Step]:
        """All that moves a joint or another node, each after what it uses."""
        found: list[Step] = list(self.limbs)
        taken = {node for limb in self.limbs for node in limb.sets}
        for joint, own in self.reference.fk.items():
            if joint not in taken and self._works(own.control):
                found.append(Fk(self.reference, own))
                taken.add(joint)
        for own in self.reference.carried:
            if own.joint not in taken and self._works(own.control):
                found.append(RootStep(self.reference, own))
                taken.add(own.joint)
        found += [TwistStep(self.rig, twist) for twist in twist_joints(self.rig) if twist.node not in taken]
        return in_order(self.rig, self._with_rules(found))

    def _with_rules(self, steps: Sequence[Step]) -> list[Step]:
        """Rules come on top of what else moves their children; what moves a whole limb stays as it is."""
        moved = {node: step for step in steps for node in step.sets}
        result = [step for step in steps if len(step.sets) > 1 or step.sets[0] not in self.rules]
        for child, rules in self.rules.items():
            if child in self.overruled:
                continue
            base, order = moved.get(child), sorted(rules, key=channel_order)
            rolls = isinstance(base, Ik)
            own = None if rolls else base
            result.append(ConstraintStep(self.rig, tuple(order), own, self._riders(child), rolls))
        return result

    @cached_property
    def overruled(self) -> frozenset[int]:
        """The joints whose rules do nothing: IK moves their limbs, which a rule of one joint would tear.

        A toe that rolls with its foot is beyond the limb.
        """
        moved = {node for ik in self.limbs for node in ik.sets if node != ik.limb.toe}
        return frozenset(moved & self.rules.keys())

    @cached_property
    def counted_from_rest(self) -> frozenset[int]:
        """The FK controls of limbs that IK moves whose rules count from where they rest, not from where IK
        has put their joints; neither a scale nor the turn of an end does."""
        found = set[int]()
        for ik in self.limbs:
            for joint, fk in ik.fk.items():
                free = {"scale", "orient"} if joint == ik.limb.chain[-1] else {"scale"}
                if any(rule.kind not in free for rule in self.rules.get(fk.own.control, ())):
                    found.add(fk.own.control)
        return frozenset(found)

    def _riders(self, joint: int) -> tuple[Fk, ...]:
        """The FK controls below a joint's own that something looks at, but those that another step moves."""
        taken = {offset for limb in self.limbs for offset in limb.carries} | self.rules.keys()
        return tuple(
            Fk(self.reference, own)
            for own in self.reference.fk.values()
            if self.reference.control_of.get(own.above) == joint
            and own.offset in self._looked_at
            and own.offset not in taken
        )

    def steps_for(self, nodes: Collection[int]) -> list[Step]:
        """The steps that what becomes of some nodes needs, in order."""
        return steps_for(self.rig, self.steps, nodes)

    def run(self, sampled: Mapping[int, Parts], steps: Sequence[Step] | None = None) -> PoseCache:
        """The rig with all steps taken, or some. sampled: the parts of what a clip moves, (f, ·) each."""
        posed = PoseCache(self.rig, sampled)
        for step in self.steps if steps is None else steps:
            step.run(posed)
        return posed

    def solved(self, sampled: Mapping[int, Parts], block: int = BLOCK) -> dict[int, Parts]:
        """What becomes of the nodes that are moved, (1 or f, ·) each.

        So many frames at a time that memory does not grow with their number, but for what goes in and
        comes out; the block changes no bit.
        """
        count = frames(sampled)
        found = []
        for rows in blocks(count, block):
            parts = self.run(cut(sampled, rows)).parts
            found.append({node: parts[node] for node in self.sets})
        return joined(found, count, block)

    @cached_property
    def writes(self) -> dict[int, list[tuple[Path, bool]]]:
        """What is set of each node; and whether all of it is, so that its own keys count no more."""
        return {
            node: step.writes
            if isinstance(step, ConstraintStep)
            else [(path, True) for path in CHANNELS.values()]
            for step in self.steps
            for node in step.sets
        }

    @cached_property
    def sets(self) -> list[int]:
        """The nodes that are moved, parents first."""
        return sorted({node for step in self.steps for node in step.sets})


def _refuse_unread(rig: Rig, rules: Iterable[Constraint]) -> None:
    """GeometryError for what follows a node whose motion no track can hold."""
    for rule in rules if rig.rules.unread else ():
        for node in rig.with_ancestors(rule.sources).intersection(rig.rules.unread):
            raise GeometryError(
                f"'{rig.title(rule.child)}' cannot follow '{rig.title(rule.sources[0])}': "
                f"{rig.rules.unread[node]}, being flat or sheared"
            )


def refuse_cycles(rig: Rig) -> None:
    """ControlCycleError where controls and constraints depend on each other, whichever are active."""
    fk = {node for node, record in rig.records(ControlRecord).items() if record.kind in ("fk", "root")}
    for driven in (None, fk):
        _ = Solver(rig, driven).steps
