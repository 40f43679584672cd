"""Whether the controls of a rig do what they are for: each is moved, and what follows it is measured.

Many are moved at once, each in a row of its own, but for those that move nothing in common, as of several
characters: they share rows. What each has to move:

* an FK control: its joint by the same rotation, and what is below that;
* the root control: all joints with weight that no constraint moves, rigidly; of several characters its own;
* an IK control: the end joint to its place, in its rotation, and the limb;
* a pivot of a foot: the end joint by the same rotation, and the toe, but the ball's, which leaves that;
* a pole vector: the limb, while the end joint stays.

And the mesh, but no other joint, unless that is constrained to what moves.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import chain

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.active_controls import skeleton_size
from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.dependency_graph import moved_by
from rigtri.evaluation.pose_cache import PoseCache
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.two_bone_ik import distance_for
from rigtri.evaluation.zero_pose import ControlsAtZero, IkLimb
from rigtri.frames.skeleton import Skeleton, skeleton
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.disjoint_sets import DisjointSets
from rigtri.maths.matrices import inverse, transform_directions
from rigtri.maths.quaternions import conjugate, from_axis_angle, multiply, rotation_angle
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, length, normalise
from rigtri.model.constraints import constraints_of
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import PIVOTS, ControlRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import moving_points
from rigtri.recognition.one_character import bodies
from rigtri.text import list_names

# Radians by which controls are rotated, about no axis of their own; shares of the limb by which an IK
# control is moved towards the root, or away from it by a limb too folded to follow, and a pole vector aside.
_TURN = 0.35
_AXIS = normalise(np.array([0.5, 0.6, 0.7]))
_NEARER, _ASIDE = 0.1, 0.5
# How far off may be what follows: radians, and shares of the size. Scales that are not quite uniform, as
# exporters write them, turn by 1e-4; soft limbs end short of their control. What does nothing is off by all.
_ANGLE, _PLACE = 0.02, 0.01
# What is tried while IK is on.
_WITH_IK = ("root", "ik", "pole", *PIVOTS)
# What moves less, as a share of the size and in the axes of a joint, stands still: float32, some nodes deep.
_STILL, _STILL_AXES = 1e-5, 1e-4


@dataclass(frozen=True)
class CheckedControl:
    """A control, the joint that it is for, how many joints it moves, and what is wrong; "" for nothing.

    mesh: whether anything that is drawn moves with it. Joints of a skin that draws nothing move alone.
    """

    control: str
    kind: str
    joint: str
    moves: int
    fault: str
    mesh: bool = True


@dataclass(frozen=True, eq=False)
class _Trial:
    """A control that is moved, in a row. joint: what it is for. limb: of an IK end or a pole."""

    control: int
    kind: str
    joint: int
    parts: Parts
    limb: IkLimb | None = None
    row: int = 0


def check_controls(rig: Rig, root: str | None = None) -> tuple[CheckedControl, ...]:
    """Move each control and pole vector of a rig, and say what follows; not those that constraints move.

    root: the node below which joints are, as `skeleton` has it. Raises ControlCycleError.
    """
    records = rig.records(ControlRecord)
    roots = {node for node, record in records.items() if record.kind == "root"}
    fk = roots.union(node for node, record in records.items() if record.kind == "fk")
    found: dict[int, CheckedControl] = {}
    reference, tree = ControlsAtZero(rig), skeleton(rig, root)
    # As clips have them that key these alone: FK controls while IK is off, root controls while nothing else
    # is on. And all others, and root controls, while IK is on.
    for kinds, driven in ((("fk",), fk), (("root",), roots), (_WITH_IK, None)):
        solver = Solver(rig, driven, reference)
        run = _Run(solver, [each for each in _trials(solver) if each.kind in kinds], tree)
        for each in run.trials:
            if not (each.control in found and found[each.control].fault):
                found[each.control] = run.checked(each)
    for node, record in sorted(records.items()):
        joint = rig.known(record.joint)
        if node not in found and not _is_ruled(solver, node, *(() if joint is None else (joint,))):
            why = "its limb is not solved" if record.chain else "its joint is not in the file"
            found[node] = CheckedControl(rig.title(node), record.kind, record.joint, 0, why)
    return tuple(found[node] for node in sorted(found))


def refuse_idle_controls(checked: Iterable[CheckedControl]) -> None:
    """GeometryError where controls do not do what they are for, with what is wrong with each."""
    wrong = [each for each in checked if each.fault]
    if wrong:
        each = "; ".join(f"'{one.control}': {one.fault}" for one in wrong[:8])
        more = f"; and {len(wrong) - 8} more" if len(wrong) > 8 else ""
        one = len(wrong) == 1
        count = (
            "1 control does not do what it is" if one else f"{len(wrong)} controls do not do what they are"
        )
        raise GeometryError(f"{count} for. {each}{more}")


def _is_added(rig: Rig, node: int) -> bool:
    """Whether a node is one that rigtri has put beside the joints."""
    return node in rig.metadata and rig.type_of(node) not in ("twist", "frame")


def _drawn(rig: Rig) -> set[int]:
    """The nodes at or below which something is drawn that is none of our own."""
    drawn = (rig.attachment >= 0) | moving_points((k for k in rig.skins if k.drawn is not False), len(rig))
    added = rig.own.difference(rig.nodes_of("twist"))
    return rig.with_ancestors(set(np.flatnonzero(drawn).tolist()) - added)


def _is_ruled(solver: Solver, *nodes: int) -> bool:
    """Whether a constraint moves some of the nodes, or a node above them."""
    return not solver.rig.with_ancestors(nodes).isdisjoint(solver.rules)


def _trials(solver: Solver) -> Iterator[_Trial]:
    """All controls and poles that no constraint moves, each moved from where it is."""
    return (each for each in _every_trial(solver) if not _is_ruled(solver, each.control, each.joint))


def _every_trial(solver: Solver) -> Iterator[_Trial]:
    reference, still = solver.reference, PoseCache(solver.rig)
    turn = from_axis_angle(_AXIS, np.float64(_TURN))
    for own in (*reference.fk.values(), *reference.roots):
        parts = still.part(own.control)
        kind = "fk" if reference.fk.get(own.joint) is own else "root"
        yield _Trial(own.control, kind, own.joint, parts._replace(rotation=multiply(parts.rotation, turn)))
    for limb in reference.limbs:
        start, mid, end = (reference.world[node, 3, :3] for node in limb.chain)
        upper, lower = float(length(mid - start)), float(length(end - mid))
        size = upper + lower
        folded = float(length(end - start)) - _NEARER * size < abs(upper - lower)
        way = _direction(end - start if folded else start - end)
        parts = _shifted(still, limb.control, _NEARER * size * way)
        turned = parts._replace(rotation=multiply(parts.rotation, turn))
        yield _Trial(limb.control, "ik", limb.chain[2], turned, limb)
        for kind, pivot in zip(PIVOTS, limb.pivots, strict=False):
            parts = still.part(pivot)
            turned = parts._replace(rotation=multiply(parts.rotation, turn))
            yield _Trial(pivot, kind, limb.chain[2], turned, limb)
        if limb.pole >= 0:
            line = _direction(end - start)
            aside = _direction(cross(line, reference.world[limb.pole, 3, :3] - start))
            parts = _shifted(still, limb.pole, _ASIDE * size * aside)
            yield _Trial(limb.pole, "pole", limb.chain[1], parts, limb)


def _direction(vector: Floats) -> Floats:
    """The direction of a vector, (3,); any for one without length."""
    return normalise(vector) if length(vector) > 0 else np.array([1.0, 0.0, 0.0])


def _shifted(still: PoseCache, node: int, move: Floats) -> Parts:
    """A node's local parts, moved by a vector, (3,), in the world."""
    parts, above = still.part(node), still.world(int(still.rig.parents[node]))
    return parts._replace(translation=parts.translation + transform_directions(move, inverse(above)))


def _apart(solver: Solver, controls: Iterable[int]) -> Integers:
    """Numbers for nodes, (n,): those with another can never move each other, whatever the controls do."""
    rig, marked = solver.rig, np.zeros(len(solver.rig), dtype=bool)
    moved = [moved_by(step) for step in solver.steps]
    marked[[*controls, *chain.from_iterable(moved)]] = True
    moving = rig.at_or_below(marked).tolist()
    sets = DisjointSets()
    linked: list[tuple[int, ...]] = [
        (node, parent) for node, parent in enumerate(rig.parents.tolist()) if parent >= 0
    ]
    linked += [(*nodes, *step.needs, *step.reads) for step, nodes in zip(solver.steps, moved, strict=True)]
    linked += [(rule.child, *rule.sources) for rule in constraints_of(rig).values()]
    for nodes in linked:
        some = [node for node in nodes if moving[node]]  # what holds all and never moves links nobody
        for other in some[1:]:
            sets.join(some[0], other)
    return np.array([sets.leader(node) for node in range(len(rig))], dtype=np.int64)


class _Run:
    """The rig with each control moved in a row, alone of those that could move the same; in row 0 none is."""

    def __init__(self, solver: Solver, trials: Sequence[_Trial], tree: Skeleton) -> None:
        rig = self.rig = solver.rig
        self.solver = solver
        self.apart = _apart(solver, [trial.control for trial in trials])
        taken = Counter[int]()
        self.trials = []
        for trial in trials:
            group = int(self.apart[trial.control])
            taken[group] += 1
            self.trials.append(replace(trial, row=taken[group]))
        self.size, self.bodies = skeleton_size(rig), bodies(rig)
        # What holds the controls cannot follow them; --root may name a node that holds them and joints.
        holding, self.carries = rig.with_ancestors(rig.nodes_of("control")), tree.carries
        self.drawn = _drawn(rig)
        self.watched = [node for node in tree.joints if node not in holding and not _is_added(rig, node)]
        rows, still = max(taken.values(), default=0) + 1, PoseCache(rig)
        parts = {}
        for trial in self.trials:
            own = [np.repeat(each, rows, axis=0) for each in still.part(trial.control)]
            for each, moved in zip(own, trial.parts, strict=True):
                each[trial.row] = moved[0]
            parts[trial.control] = Parts(*own)
        self.posed = solver.run(parts)
        # What each row moves, of the nodes that are watched, (f, n).
        self.moved = np.zeros((rows, len(self.watched)), dtype=bool)
        for place, node in enumerate(self.watched):
            self.moved[:, place] = self._moved(node)  # one row where nothing moves it
        self._angles: dict[int, Floats] = {}

    def _moved(self, node: int) -> Booleans:
        """In which rows a node is moved, (f,)."""
        world = self.posed.world(node)
        places = length(world[:, 3, :3] - world[:1, 3, :3]) > _STILL * self.size
        axes = np.abs(world[:, :3, :3] - world[:1, :3, :3]).max(axis=(1, 2))
        return np.asarray(places | (axes > _STILL_AXES * np.abs(world[0, :3, :3]).max()))

    def checked(self, trial: _Trial) -> CheckedControl:
        rig = self.rig
        mine = self.moved[trial.row] & (self.apart[self.watched] == self.apart[trial.control])
        found = [self.watched[place] for place in np.flatnonzero(mine).tolist()]
        fault = self._unfollowed(trial) or self._unmoved(trial, found) or self._others(trial, found)
        names = rig.title(trial.control), trial.kind, rig.title(trial.joint)
        return CheckedControl(*names, len(found), fault, not self.drawn.isdisjoint(found))

    def _unfollowed(self, trial: _Trial) -> str:
        """What does not follow that has to."""
        rig, joint = self.rig, trial.joint
        if trial.limb is not None and trial.kind == "pole":
            start, _, end = trial.limb.chain
            if self._turned(start, trial) < _ANGLE:
                return f"'{rig.title(start)}' does not turn to it"
            return f"'{rig.title(end)}' is moved by it" if self._off(end, trial) > _PLACE * self.size else ""
        joints = [joint]
        if trial.kind == "root":
            body = next((body for body in self.bodies if joint in body), frozenset(self.watched))
            joints = [node for node in self.watched if self.carries[node] and node in body]
            joints = [node for node in joints if not _is_ruled(self.solver, node)]  # aimed, they turn less
        toe = -1 if trial.limb is None else trial.limb.toe
        if trial.kind in PIVOTS and toe >= 0:
            if trial.kind == "ball" and self._turned(toe, trial) > _ANGLE:
                return f"'{rig.title(toe)}' turns with it"
            joints += [toe] if trial.kind != "ball" else []
        lazy = [node for node in joints if abs(self._turned(node, trial) - _TURN) > _ANGLE]
        if trial.kind == "ik":
            goal = self.posed.world(trial.control)[:, 3, :3]
            way = goal[trial.row] - goal[0]
            apart = float(length(self._reached(trial) - way))
            lazy = lazy or ([joint] if apart > _PLACE * self.size else [])
        if lazy:
            follow = "does" if len(lazy) == 1 else "do"
            return f"{list_names(rig.title(node) for node in lazy)} {follow} not follow it"
        return ""

    def _unmoved(self, trial: _Trial, moved: list[int]) -> str:
        """Whether the mesh stands still. FK controls of limb and toe hold what IK cannot, weight or not."""
        limbs = [k for k in self.solver.reference.limbs if trial.joint in (*k.chain, k.toe)]
        with_mesh = any(self.carries[node] for node in (*moved, *(limb.chain[0] for limb in limbs)))
        return "" if with_mesh else "the mesh does not move with it"

    def _others(self, trial: _Trial, moved: list[int]) -> str:
        """What moves that is no business of a control's."""
        rig = self.rig
        if trial.kind == "root":
            return ""
        top = trial.joint if trial.limb is None else trial.limb.chain[0]
        mine = set(rig.below(top)) | set(rig.below(trial.joint))
        if mine.issuperset(moved):
            return ""
        for step in self.solver.steps:
            if len(step.sets) == 1 and not mine.isdisjoint((*step.needs, *step.reads)):
                mine.update(rig.below(step.sets[0]))
        mine |= self._led(mine.union(rig.below(trial.control)))
        others = [node for node in moved if node not in mine]
        return f"it moves {list_names(rig.title(node) for node in others)}, too" if others else ""

    def _led(self, moving: set[int]) -> set[int]:
        """What moves with nodes because somebody has constrained it to them, or something above it."""
        led, rules = set[int](), constraints_of(self.rig).values()
        while True:
            found = {rule.child for rule in rules if not (moving | led).isdisjoint(rule.sources)}
            for step in self.solver.steps:
                if not led.isdisjoint((*step.needs, *step.reads)):
                    found.update(moved_by(step))
            if found <= led:
                return led
            led.update(*map(self.rig.below, found))

    def _row(self, node: int, trial: _Trial, rows: int) -> int:
        """In which of so many rows a node is as a trial has it: none, of a node that it cannot move."""
        return min(trial.row, rows - 1) if self.apart[node] == self.apart[trial.control] else 0

    def _way(self, node: int, trial: _Trial) -> Floats:
        """How far a trial moves a node, (3,)."""
        places = self.posed.world(node)[:, 3, :3]
        return np.asarray(places[self._row(node, trial, len(places))] - places[0])

    def _reached(self, trial: _Trial) -> Floats:
        """How far the target that the end of a limb answers to has moved, (3,): a soft limb's end lags."""
        limb = trial.limb
        if limb is None or not limb.soft or limb.stretch:
            return self._way(trial.joint, trial)
        start, mid, end = (self.posed.world(node)[:, 3, :3] for node in limb.chain)
        away = end - start
        upper, lower = (length(b - a) for a, b in ((start, mid), (mid, end)))
        reach = length(away)
        share = distance_for(reach, upper + lower, limb.soft) / np.where(reach > 0, reach, 1.0)
        places = start + away * share[:, np.newaxis]
        return np.asarray(places[self._row(trial.joint, trial, len(places))] - places[0])

    def _off(self, node: int, trial: _Trial) -> float:
        return float(length(self._way(node, trial)))

    def _turned(self, node: int, trial: _Trial) -> float:
        """The angle in radians by which a trial turns a node."""
        if node not in self._angles:
            turns = self.posed.world_rotation(node)
            self._angles[node] = rotation_angle(multiply(conjugate(turns[0]), turns))
        angles = self._angles[node]
        return float(angles[self._row(node, trial, len(angles))])
