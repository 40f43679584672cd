"""Inverse evaluation: the controls that give the motion which joints have.

Every control gets values that a file can hold, and those after it are found from what these make of
the rig, so that rounding and reduced keys do not add up along chains. What an IK limb cannot hold
(twist, a nearly straight bend in float32) goes to the FK controls of its joints, below the solver.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Generator, Mapping, Sequence
from dataclasses import field, fields, replace
from functools import cached_property
from itertools import zip_longest
from typing import NamedTuple

import numpy as np

from rigtri.evaluation.constraint_solver import Parts, to_parts
from rigtri.evaluation.dependency_graph import in_order
from rigtri.evaluation.fk import Fk
from rigtri.evaluation.ik import Ik
from rigtri.evaluation.pose_cache import BLOCK, PoseCache, blocks, cut, frames, joined
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.solver_steps import ConstraintStep, Step
from rigtri.maths.matrices import inverse, multiply, transform_points
from rigtri.maths.quaternions import rotation_angle
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import PATHS
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig


@dataclass(frozen=True, eq=False)
class FindControl:
    """A control, IK end or pole. needs: the nodes from whose places it is found; −1 is none.

    find: its local parts, of the rig as far as controls make it, and of the motion as it was. below: what
    is below it, and counts.
    """

    control: int
    above: tuple[int, ...]
    find: Callable[[PoseCache, PoseCache], Parts]
    below: tuple[int, ...] = ()

    @property
    def sets(self) -> tuple[int, ...]:
        return (self.control,)

    @property
    def reads(self) -> tuple[int, ...]:
        return self.below

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
            else _beneath_rules(step)
        )
        placed |= {each.control: each for each in own}
        if isinstance(step, Ik):
            own_parts = {key.name: getattr(step, key.name) for key in fields(Ik)}
            step = FindLimb(**own_parts, still=solver.still)
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


def _beneath_rules(step: Step) -> list[FindControl]:
    """The FK control of a constrained joint, for what its rules leave of the joint's own motion."""
    if not isinstance(step, ConstraintStep) or not isinstance(step.base, Fk):
        return []
    fk, left = step.base, step.left
    if not left:
        return []

    def find(built: PoseCache, source: PoseCache) -> Parts:
        found, zero = fk.channels(built, source.part(fk.joint)), PoseCache(fk.rig).part(fk.own.control)
        return Parts(*(a if path in left else b for path, a, b in zip(PATHS, found, zero, strict=True)))

    return [FindControl(fk.own.control, fk.needs, find)]


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
                limb.pivot_path,
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


# Takes a node and its target parts, and gives those that will be read from the file again.
Keep = Callable[[int, Parts], Parts]


class KeepRequest(NamedTuple):
    """Parts of a node to be kept in some frames. free: where they are not finite, the node stays as it is."""

    node: int
    parts: Parts
    free: bool = False


# Asks for one node after another, and is answered with what is kept of it; None: nothing.
Requests = Generator[KeepRequest, Parts | None, None]


@dataclass(frozen=True, eq=False)
class Residual:
    """What the FK controls of a limb hold beside IK, at most. turn: radians. move: file units."""

    limb: Ik
    turn: float
    move: float


@dataclass(eq=False)
class SolvedControls:
    """Parts of each control, and of the offsets that follow a limb. posed: the rig as they make it."""

    posed: PoseCache
    controls: dict[int, Parts] = field(default_factory=dict)
    offsets: dict[int, Parts] = field(default_factory=dict)
    residuals: list[Residual] = field(default_factory=list)


class Block(NamedTuple):
    """Some of the frames: the motion as it was, and what the controls make of it."""

    source: PoseCache
    found: SolvedControls


def solve_controls(solver: Solver, parts: Mapping[int, Parts], keep: Keep, block: int = BLOCK) -> list[Block]:
    """The controls' parts for a motion, node → (f, ·) each, by the joints that they move; in blocks.

    keep: rounds and thins out what is to be stored of a control, and returns what is read from it; it
    is given all frames at once. From one control to the next places are forgotten where there are
    several blocks, so that no more is held than what goes in and comes out.
    """
    count = frames(parts)
    each = []
    for rows in blocks(count, block):
        some = cut(parts, rows)
        each.append(Block(PoseCache(solver.rig, some), SolvedControls(PoseCache(solver.rig, some))))
    steps = inverse_steps(solver)
    walks = [_all_steps(solver, steps, found, source) for source, found in each]
    _serve(walks, keep, each if len(each) > 1 else (), count, block)
    return each


def _serve(
    walks: Sequence[Requests], keep: Keep, of: Sequence[Block] = (), count: int = 1, block: int = BLOCK
) -> None:
    """Take all blocks through their nodes, side by side: each node is kept for all frames at once.

    of: the blocks, where there are several, which are to hold no places from one node to the next.
    """
    requests = [_next_request(each, None, some) for each, some in zip_longest(walks, of)]
    while requests[0] is not None:
        node, parts, free = requests[0]
        if len(walks) > 1:
            pieces = [{node: each.parts} for each in requests if each is not None]
            parts = joined(pieces, count, block)[node]
        finite = not free or all(bool(np.isfinite(each).all()) for each in parts)
        kept = keep(node, parts) if finite else None
        answers = (
            kept if kept is None or len(walks) == 1 else cut({node: kept}, rows)[node]
            for rows in blocks(count, block)
        )
        requests = [_next_request(*each) for each in zip_longest(walks, answers, of)]


def _next_request(walk: Requests, kept: Parts | None, of: Block | None) -> KeepRequest | None:
    """The next request; None at the end. of: the block, where there are others besides."""
    try:
        return walk.send(kept)
    except StopIteration:
        return None
    finally:
        if of is not None:
            of.source.forget()
            of.found.posed.forget()


def _all_steps(solver: Solver, steps: Sequence[Step], found: SolvedControls, source: PoseCache) -> Requests:
    for step in steps:
        if isinstance(step, FindLimb):
            yield from _bend(found, step, source, step.still)
            continue
        place = step.base if isinstance(step, ConstraintStep) else step
        if isinstance(place, FindControl):
            yield from _store(found, place.control, place.find(found.posed, source))
        step.run(found.posed)
    left = solver.offsets - solver.still
    carried = [fk for limb in solver.limbs for fk in limb.below(left.difference(limb.carries))]
    for fk in sorted(carried, key=lambda fk: fk.own.offset):
        yield from _carry(found, fk)


def _carry(found: SolvedControls, fk: Fk) -> Requests:
    """Let an offset follow IK, so that whoever shows the file sees its control on the joint."""
    # Where a scale of zero leaves no frame to stand in, the offset stays at rest.
    kept = yield KeepRequest(fk.own.offset, fk.beneath(found.posed), free=True)
    if kept is not None:
        found.offsets[fk.own.offset] = kept
        found.posed.set(fk.own.offset, kept)


def _store(found: SolvedControls, node: int, parts: Parts) -> Requests:
    kept = yield KeepRequest(node, parts)
    if kept is not None:
        found.controls[node] = kept
        found.posed.set(node, kept)


def match_limb(found: SolvedControls, ik: Ik, source: PoseCache, ruled: Collection[int], keep: Keep) -> None:
    """The controls of one limb whose joints are to stand as in ``source``; ``found`` takes them up."""
    _serve([_limb(found, ik, source, ruled)], keep)


def _limb(found: SolvedControls, ik: Ik, source: PoseCache, ruled: Collection[int]) -> Requests:
    for place in find_limb_ends(ik, ruled):
        yield from _store(found, place.control, place.find(found.posed, source))
    yield from _bend(found, ik, source, ruled)


def _bend(found: SolvedControls, ik: Ik, source: PoseCache, still: Collection[int]) -> Requests:
    """What the limb's FK controls hold below the solver, but for those that keep ``still``; its joints."""
    built = found.posed
    solved = ik.solved(built, ik.target(built), ik.pole_position(built), ik.hand(built))
    turn = move = 0.0
    for node, parts in solved.items():
        if node in ik.fk:
            fk = ik.fk[node]
            if fk.own.control not in still:
                channels = fk.needed(parts, source.part(node))
                turn = max(turn, float(rotation_angle(channels.rotation).max()))
                move = max(move, float(length(channels.translation).max()))
                yield from _store(found, fk.own.control, channels)
            parts = fk.moved(parts, built.part(fk.own.control))
        built.set(node, parts)
    for fk in ik.below(ik.carries):
        yield from _carry(found, fk)
    found.residuals.append(Residual(ik, turn, move))
