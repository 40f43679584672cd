"""Controls that give a motion that joints have: the inverse of evaluating them.

Every control gets values that a file can hold, and those after it are found from what these make of
the rig, so that rounding and reduced keys do not add up along chains. What an IK limb cannot hold
(twist, a nearly straight bend in float32) goes to the FK controls of its joints, below the solver.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

import numpy as np

from rigtri.following import Parts, factored
from rigtri.matrices import inverse, multiply, transform_points
from rigtri.quaternions import multiply as product
from rigtri.quaternions import turn_angle
from rigtri.solve.evaluate import Solver
from rigtri.solve.fk import Fk
from rigtri.solve.ik import Ik
from rigtri.solve.posed import Posed
from rigtri.trigonometry import Floats
from rigtri.vectors import length

# Takes a node and its wanted parts, and gives those that will be read from the file again.
Keep = Callable[[int, Parts], Parts]


@dataclass(frozen=True, eq=False)
class Residual:
    """What the FK controls of a limb hold beside IK, at most. turn: radians. move: file units."""

    limb: Ik
    turn: float
    move: float


@dataclass(eq=False)
class Matched:
    """Parts of each control, and of the offsets that follow a limb. posed: the rig as they make it."""

    posed: Posed
    controls: dict[int, Parts] = field(default_factory=dict)
    offsets: dict[int, Parts] = field(default_factory=dict)
    residuals: list[Residual] = field(default_factory=list)


def matched(solver: Solver, parts: Mapping[int, Parts], keep: Keep) -> Matched:
    """The controls' parts for a motion, node → (f, ·) each, by the joints that they move.

    keep: rounds and thins out what is to be stored of a control, and says what is read from it.
    """
    source = Posed(solver.rig, parts)
    found = Matched(Posed(solver.rig, parts))
    for step in solver.steps:
        if isinstance(step, Fk):
            _store(found, step.own.control, step.channels(found.posed, source.part(step.joint)), keep)
            step.run(found.posed)
        elif isinstance(step, Ik):
            match_limb(found, step, source, solver.rules, keep)
        else:
            step.run(found.posed)
    carried = [fk for limb in solver.limbs for fk in limb.below(solver.offsets.difference(limb.carries))]
    for fk in sorted(carried, key=lambda fk: fk.own.offset):
        _carry(found, fk, keep)
    return found


def _carry(found: Matched, fk: Fk, keep: Keep) -> None:
    """Let an offset follow IK, so that whoever shows the file sees its control on the joint."""
    parts = fk.beneath(found.posed)
    if not all(np.isfinite(each).all() for each in parts):
        return  # a scale of zero: there is no frame to stand in, and the offset stays at rest
    kept = keep(fk.own.offset, parts)
    found.offsets[fk.own.offset] = kept
    found.posed.set(fk.own.offset, kept)


def _store(found: Matched, node: int, parts: Parts, keep: Keep) -> None:
    kept = keep(node, parts)
    found.controls[node] = kept
    found.posed.set(node, kept)


def match_limb(found: Matched, ik: Ik, source: Posed, ruled: Collection[int], keep: Keep) -> None:
    """The controls of one limb whose joints are to stand as in ``source``; ``found`` takes them up."""
    built, limb = found.posed, ik.limb
    if limb.control not in ruled:
        _store(found, limb.control, _seen(built, limb.control, ik.grasp(built, source)), keep)
    if limb.pole >= 0 and limb.pole not in ruled:
        above = inverse(built.world(int(ik.rig.parents[limb.pole])))
        place = transform_points(ik.side(source), above)
        _store(found, limb.pole, built.part(limb.pole)._replace(translation=place), keep)
    solved = ik.solved(
        built,
        ik.target(built),
        ik.place(built),
        product(built.turn(limb.control), ik.grip),
    )
    turn = move = 0.0
    for node, parts in solved.items():
        if node in ik.fk:
            fk = ik.fk[node]
            channels = fk.needed(parts, source.part(node))
            turn = max(turn, float(turn_angle(channels.rotation).max()))
            move = max(move, float(length(channels.translation).max()))
            kept = keep(fk.own.control, channels)
            found.controls[fk.own.control] = kept
            built.set(fk.own.control, kept)
            parts = fk.moved(parts, kept)
        built.set(node, parts)
    for fk in ik.below(ik.carries):
        _carry(found, fk, keep)
    found.residuals.append(Residual(ik, turn, move))


def _seen(built: Posed, node: int, world: Floats) -> Parts:
    """World matrices, (f, 4, 4), as local parts of a node."""
    parent = int(built.rig.parents[node])
    return factored(multiply(world, inverse(built.world(parent))))
