"""Solver warnings: targets out of reach, poles on the line of their limb, uneven scale."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.fk import Fk
from rigtri.evaluation.ik import Ik
from rigtri.evaluation.pose_cache import PoseCache, blocks, cut, sample_parts
from rigtri.evaluation.sampling import sample
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.solver_steps import ConstraintStep, RootStep, Step
from rigtri.evaluation.timelines import Timeline
from rigtri.evaluation.two_bone_ik import BEYOND
from rigtri.evaluation.zero_pose import COUNTS_FROM_NOTHING, SAME_POSITION, adrift
from rigtri.maths.matrices import transform_points
from rigtri.maths.quaternions import rotate
from rigtri.maths.ranking import first_largest
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, dot, length
from rigtri.model.animation import Track
from rigtri.model.metadata import ConstraintRecord, ControlRecord, Record, damage
from rigtri.model.rig import Rig
from rigtri.report import Notice
from rigtri.text import list_names

# As a share of the limb: nearer than this to what it can reach, rounding or a bake has put the IK end.
REACHED = 1e-3
# Scales that differ by less are one.
EVEN = 1e-4
# Degrees. A pole that stands beside the plane of its limb by less does not turn it visibly.
TURNED = 1.0

# So many times its length a bone may be: float32 has seven digits, and the pose is to have some of them.
MOST = 1e4

# What moves other nodes, and what to call it.
_DRIVING: Mapping[type[Record], str] = {ConstraintRecord: "Constraint", ControlRecord: "Control"}

# Names the moment of a row.
Moment = Callable[[int], str]


def solver_warnings(solver: Solver, posed: PoseCache, at: Moment) -> Iterator[Notice]:
    """Notices of a rig that ``solver`` has run: of each kind of trouble, the moment where it is worst."""
    for ik in solver.limbs:
        yield from _limb(ik, posed, at)
    for node in sorted(solver.overruled):
        text = f"'{solver.rig.title(node)}' does not follow its constraints in {at(0)}, where IK moves its "
        text += "limb: constrain its IK control instead, or take its keys away with rigtri snap --to fk"
        yield Notice("constraint-overruled", text, solver.rig.title(node), geometry=True)
    for node in sorted(solver.counted_from_rest):
        text = (
            f"'{solver.rig.title(node)}' follows a constraint in {at(0)}, where IK moves its limb: it turns "
        )
        text += "or moves its joint on top of IK by as much as it leaves where it rests. Constrain the IK "
        text += "control instead, or let FK move the limb with rigtri snap --to fk"
        yield Notice("constraint-below-ik", text, solver.rig.title(node), geometry=True)
    scaled = {node for step in solver.steps for node in _scaled(step)}
    scaled |= {fk.own.control for ik in solver.limbs for fk in ik.fk.values()}
    for node in sorted(scaled):
        yield from _scale(solver.rig.title(node), posed.part(node).scale, at)


def lost_notices(rig: Rig) -> Iterator[Notice]:
    """Notices of controls and constraints that move nothing: no one node is called what they name, or none is
    above them."""
    for kind, called in _DRIVING.items():
        for node, record in rig.records(kind).items():
            lost = rig.lost_by(record)
            if lost and not damage(rig.metadata[node]):
                text = f"{called} '{rig.title(node)}' is left out, for no one node is {list_names(lost)}: "
                text += "was it renamed, is there another of that name, or is another variant selected?"
                yield Notice(f"{called.lower()}-lost", text, geometry=True, names=tuple(lost))
    for node in adrift(rig):
        text = f"Control '{rig.title(node)}' is left out, for {COUNTS_FROM_NOTHING}"
        yield Notice("control-lost", text, geometry=True, names=(rig.title(node),))


def clip_solver_warnings(
    solver: Solver, timeline: Timeline, times: Floats, solved: Mapping[int, Parts]
) -> list[Notice]:
    """The notices of a timeline, of each node's troubles the first. solved: what ``solver`` makes of it at
    ``times``, node → (1 or f, ·) each."""
    rig = solver.rig
    used = rig.with_ancestors(n for step in solver.steps for n in (*step.sets, *step.reads, *step.needs))
    tracks = tuple(t for t in timeline.clip.tracks if t.node in used and t.node not in solved)
    parts = {**sample_parts(rig, replace(timeline.clip, tracks=tracks), times), **solved}
    as_shown = {
        rig.title(control)
        for control, joint in solver.reference.control_of.items()
        if joint in solved and _shown(timeline.track(joint, "scale"), times, solved[joint].scale)
    }
    found: dict[tuple[str, str | None], Notice] = {}
    for rows in blocks(len(times)):
        moment = moment_of(timeline.name, times[rows])
        for notice in solver_warnings(solver, PoseCache(rig, cut(parts, rows)), moment):
            if notice.code != "control-scale" or notice.joint not in as_shown:
                found.setdefault((notice.code, notice.joint), notice)
    return list(found.values())


def _shown(track: Track | None, times: Floats, scale: Floats) -> bool:
    """Whether a joint's own keys scale it as its control does, so that the file shows nothing new."""
    if track is None:
        return False
    return bool(np.abs(sample(track, times) - scale).max() <= EVEN * np.abs(scale).max())


def moment_of(clip: str, times: Floats) -> Moment:
    return lambda row: f"{clip}@{times[row]:g}"


def _scaled(step: Step) -> Iterator[int]:
    """The controls whose scale a step uses: its own, and that of the root control above it."""
    base = step.base if isinstance(step, ConstraintStep) else step
    if isinstance(base, Fk | RootStep):
        yield base.own.control
        yield from (root.control for root in base.reference.roots if root.control == base.own.above)


def _scale(name: str, scale: Floats, at: Moment) -> Iterator[Notice]:
    sizes = np.abs(scale)
    most = sizes.max(axis=1)
    uneven = most - sizes.min(axis=1) - EVEN * most
    mirrored = np.count_nonzero(scale < 0, axis=1) % 2 == 1  # two are half a turn
    if most.min() == 0:
        text = f"'{name}' is scaled to zero in {at(int(most.argmin()))}: so is its joint, with all below it"
    elif uneven.max() > 0:
        text = (
            f"'{name}' is scaled unevenly in {at(first_largest(uneven))}: "
            "so is its joint, and what turns below it is sheared"
        )
    elif mirrored.any():
        text = f"'{name}' is mirrored in {at(int(mirrored.argmax()))}: so is its joint, with all below it"
    else:
        return
    yield Notice("control-scale", text, name)


def refuse_overstretch(solver: Solver, posed: PoseCache, at: Moment) -> None:
    """GeometryError where IK with stretch makes bones more than `MOST` times as long as at rest."""
    still = PoseCache(solver.rig)
    for limb in (ik.limb for ik in solver.limbs if ik.limb.stretch):
        for node in limb.chain[1:]:
            size = float(length(still.part(node).translation)[0])
            grown = length(posed.part(node).translation) / (size if size > 0 else np.inf)
            row = int(np.argmax(grown > MOST))
            if grown[row] > MOST:
                raise GeometryError(
                    f"'{solver.rig.title(limb.control)}' is so far away at {at(row)} that its limb would be "
                    f"{grown[row]:.2g} times as long; {MOST:g} times is the most. Bring it nearer, or bake "
                    "with --no-stretch"
                )


def turned_at_rest(ik: Ik) -> float:
    """Degrees by which IK turns a limb at rest to its pole, from the side that it bends to there.

    Only clearly bent limbs turn; others rest as they are (`rigtri.evaluation.pole_lean`).
    """
    if ik.limb.pole < 0:
        return 0.0
    turn, world = ik.reference.world_rotation(ik.above), ik.reference.world
    line, side = rotate(turn, ik.rest.root_to_end), rotate(turn, ik.rest.side)
    pole = world[ik.limb.pole, 3, :3] - world[ik.limb.chain[0], 3, :3]
    return float(np.degrees(angle(*(way - dot(way, line) * line for way in (side, pole)))))


def _limb(ik: Ik, posed: PoseCache, at: Moment) -> Iterator[Notice]:
    rig, limb = ik.rig, ik.limb
    target, place = ik.target(posed), ik.pole_position(posed)
    solved, lengths = ik.solve(posed, target, place), ik.lengths(posed)
    longest, shortest = lengths[0] + lengths[1], np.abs(lengths[0] - lengths[1])
    end = rig.title(limb.chain[2])
    if longest.max() <= SAME_POSITION * float(np.abs(rig.world[:, 3, :3]).max()):
        control = rig.title(limb.control)
        text = f"The limb that ends in '{end}' has no length in {at(0)}, so '{control}' does not move it"
        yield Notice("ik-no-length", text, end, geometry=True)
        return
    distance = length(target - transform_points(ik.start, posed.world(ik.above)))
    # The targets that matching gives a soft limb are beyond it, and meant.
    far = distance - longest * (1.0 + (BEYOND - 1.0) * limb.soft + REACHED)
    near = shortest - REACHED * longest - distance
    # The FK controls below the solver may have brought the end there all the same, as matching lets them
    # where bones change their length.
    away = length(target - posed.world(limb.chain[2])[:, 3, :3]) > REACHED * longest
    far = np.where(away & (not limb.stretch), far, -np.inf)
    near = np.where(away, near, -np.inf)
    for off, how in ((far, "too far away"), (near, "too near")):
        if off.max() > 0:
            yield Notice(
                "ik-unreachable",
                f"'{rig.title(limb.control)}' is {how} in {at(first_largest(off))} for the limb that ends in "
                f"'{end}' to reach it; the limb points there",
                end,
                geometry=True,
            )
            break
    if (degrees := turned_at_rest(ik)) > TURNED:
        yield Notice(
            "pole-elsewhere",
            f"The limb that ends in '{end}' turns by {degrees:.0f}° at rest while IK moves it, to its pole "
            f"'{rig.title(limb.pole)}', which is not on the side it bends to: place it with add-polevector",
            end,
            geometry=True,
        )
    if solved.lost.any():
        yield Notice(
            "ik-no-side",
            f"The limb that ends in '{end}' has its IK end at its root, or its pole on the line to it, in "
            f"{at(int(solved.lost.argmax()))}; it keeps the side it has at rest",
            end,
            geometry=True,
        )
