"""The order in which controls are solved for a motion: each after the nodes that its parts are relative to.

A step of its own finds each control, so that what follows a control, or is below it, comes after.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from functools import cached_property

from rigtri.evaluation.constraint_solver import Parts, to_parts
from rigtri.evaluation.dependency_graph import in_order
from rigtri.evaluation.fk import Fk
from rigtri.evaluation.ik import Ik
from rigtri.evaluation.pose_cache import PoseCache
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.solver_steps import ConstraintStep, Step
from rigtri.maths.matrices import inverse, multiply, transform_points
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig


@dataclass(frozen=True, eq=False)
class FindControl:
    """A control, IK end or pole. needs: the nodes from whose places it is found; −1 is none.

    find: its local parts, of the rig as far as controls make it, and of the motion as it was.
    """

    control: int
    above: tuple[int, ...]
    find: Callable[[PoseCache, PoseCache], Parts]

    @property
    def sets(self) -> tuple[int, ...]:
        return (self.control,)

    @property
    def reads(self) -> tuple[int, ...]:
        return ()

    @property
    def needs(self) -> tuple[int, ...]:
        return tuple(node for node in self.above if node >= 0)

    def run(self, posed: PoseCache) -> None:
        """The control has been set to what was found."""


@dataclass(frozen=True, eq=False)
class FindLimb(Ik):
    """A limb that finds what its FK controls hold below the solver, but for those that keep still."""

    still: frozenset[int] = frozenset()

    @cached_property
    def found(self) -> tuple[int, ...]:
        """The controls that it finds."""
        return tuple(node for node in self.controls if node not in self.still)

    @property
    def sets(self) -> tuple[int, ...]:
        return (*super().sets, *self.found)

    @cached_property
    def reads(self) -> tuple[int, ...]:
        return tuple(node for node in super().reads if node not in self.found)


def inverse_steps(solver: Solver) -> list[Step]:
    """The solver's steps with those that find controls, in order; rules come on top of what is found.

    Raises ControlCycleError where a control would be found from the place of what follows it.
    """
    found: list[Step] = []
    placed: dict[int, FindControl] = {}
    ruled = frozenset(solver.rules)
    for step in solver.steps:
        own = (
            find_limb_ends(step, ruled)
            if isinstance(step, Ik)
            else [_fk(step)]
            if isinstance(step, Fk)
            else []
        )
        placed |= {each.control: each for each in own}
        if isinstance(step, Ik):
            step = FindLimb(step.reference, step.limb, step.fk, step.rule, step.carries, solver.still)
        found.append(step)
    steps = [
        replace(step, base=placed.pop(step.child))
        if isinstance(step, ConstraintStep) and step.child in placed
        else step
        for step in found
    ]
    return in_order(solver.rig, [*placed.values(), *steps])


def _fk(fk: Fk) -> FindControl:
    return FindControl(
        fk.own.control, fk.needs, lambda built, source: fk.channels(built, source.part(fk.joint))
    )


def find_limb_ends(ik: Ik, ruled: Collection[int]) -> list[FindControl]:
    """A limb's IK end and pole, but those that rules move."""
    rig, limb, found = ik.rig, ik.limb, list[FindControl]()
    above = int(rig.parents[limb.control])
    if limb.control not in ruled:
        found.append(
            FindControl(
                limb.control,
                (above, ik.above),
                lambda built, source: _seen(built, above, ik.grasp(built, source)),
            )
        )
    if limb.pole >= 0 and limb.pole not in ruled:
        found.append(
            FindControl(
                limb.pole,
                (int(rig.parents[limb.pole]),),
                lambda built, source: _stands(rig, built, limb.pole, ik.side(source)),
            )
        )
    return found


def _seen(built: PoseCache, parent: int, world: Floats) -> Parts:
    """World matrices, (f, 4, 4), as local parts below a node."""
    return to_parts(multiply(world, inverse(built.world(parent))))


def _stands(rig: Rig, built: PoseCache, pole: int, place: Floats) -> Parts:
    """A pole's local parts at a place, (f, 3), in the world."""
    above = inverse(built.world(int(rig.parents[pole])))
    return built.part(pole)._replace(translation=transform_points(place, above))
