"""Adaptive sampling of a rig that a solver moves: until linear keys give what lies between samples.

FK of linear keys is linear; IK, constraints and splines are not. Where a line between two samples leaves what
it stands for by more than a bound, there is a sample in the middle, too. A limb that passes straight turns
like the square root of time, so samples may come very near each other there; all are so many a second.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np

from rigtri.errors import FileError
from rigtri.evaluation.adaptive_sampling import refine_times
from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.fk import Fk
from rigtri.evaluation.inverse_solver import Block, solve_controls
from rigtri.evaluation.pose_cache import PoseCache, blocks, joined, sample_parts
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.solver_steps import Step, TwistStep
from rigtri.evaluation.timelines import MOST_KEYS, as_float32
from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import transform_directions
from rigtri.maths.quaternions import slerp
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Clip
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.progress import as_share, counted

# Samples a second, at most and on average, where no number is given; a short clip has those of a second.
MOST_A_SECOND = 1024.0
# Times are float32: so much of a piece is a whole one.
_WHOLE = 1.001
# Seconds between samples that are not parted any more: beyond that, what float32 rounds decides.
FINEST = 2.0**-16
# USD allows 0 time codes per second; keys then lie as near as they may.
_SLOWEST = 1e-6
# Where an interval is looked at: the middle, and where two curves do not happen to meet.
_SHARES = (0.29, 0.5)
# How often an interval is halved before it is looked at again.
_HALVINGS = 3


class Deviation(NamedTuple):
    """How far the rig is from where it ought to be, (f,), in file units, and the worst node, (f,), or −1."""

    far: Floats
    node: Integers


class Curve(Protocol):
    """What is sampled. at: the parts of keys at some times, (f, ·) each. off: how far the rig is off
    while what is keyed has the parts ``shown``; it gets no more than one block of times.
    """

    def at(self, times: Floats) -> dict[int, Parts]: ...
    def off(self, times: Floats, shown: Mapping[int, Parts]) -> Deviation: ...


class RefinedSamples(NamedTuple):
    """Samples: their times, (f,), and parts. off: the largest deviation between them, in file units, the time
    before it, and the node that it is of. limited: whether it could not be made smaller.
    """

    times: Floats
    parts: dict[int, Parts]
    off: float
    limited: bool
    after: float = 0.0
    node: int = -1


def refine_samples(curve: Curve, times: Floats, *, bound: float, per_second: float) -> RefinedSamples:
    """Samples at ``times``, (f,), and between them, until no deviation is above ``bound``, in file units.

    per_second: units of the times in a second.
    """
    samples = _Refinement(curve, times, bound, per_second)
    refine_times(times, samples.deviations, samples.division)
    far, after, node = samples.worst
    return RefinedSamples(samples.times, samples.parts, far, samples.limited, after, node)


class _Refinement:
    """Samples while intervals are divided. worst: deviation of one that is not, its start, and the node."""

    def __init__(self, curve: Curve, times: Floats, bound: float, per_second: float) -> None:
        self.curve, self.times, self.parts, self.bound = curve, times, curve.at(times), bound
        per_second = max(per_second, _SLOWEST)
        self.finest = FINEST * per_second
        seconds = max(float(times[-1] - times[0]) / per_second, 1.0)
        self.most = int(min(seconds * MOST_A_SECOND + 1, MOST_KEYS))
        self.worst, self.limited = (0.0, 0.0, -1), False
        self.nodes = np.zeros(0, dtype=np.int64)
        self.rounds = 0

    def deviations(self, times: Floats, left: Integers) -> Floats:
        """The largest deviation in each interval, (m,), in file units."""
        if len(times) > len(self.times):
            new = np.setdiff1d(times, self.times, assume_unique=True)
            order = np.argsort(np.concatenate([self.times, new]), kind="stable")
            parts = self.curve.at(new)
            self.parts = _merged(self.parts, len(self.times), parts, len(new), order)
            self.times = times
        # How many rounds there will be nobody knows: each is half of what is left.
        with as_share(1 - 0.5**self.rounds, 1 - 0.5 ** (self.rounds + 1)):
            off, self.nodes = _off(self.curve, times, self.parts, left)
        self.rounds += 1
        return off

    def division(self, start: Floats, span: Floats, off: Floats) -> Integers:
        """Into how many pieces intervals go, (m,); those that stay whole are done."""
        room = np.maximum(np.floor(span / self.finest * _WHOLE), 1.0)
        pieces = np.minimum(_pieces(off, self.bound), room)
        pieces = _affordable(pieces, off, self.most - len(self.times))
        done = pieces < 2.0
        if off[done].max(initial=0.0) > self.worst[0]:
            k = np.flatnonzero(done)[off[done].argmax()]
            self.worst = (float(off[k]), float(start[k]), int(self.nodes[k]))
        self.limited = self.limited or bool((off[done] > self.bound).any())
        return pieces.astype(np.int64)


def _pieces(off: Floats, bound: float) -> Floats:
    """Into how many pieces intervals go, (m,): a deviation falls with the square of the length."""
    needed = np.sqrt(off / bound) if bound > 0 else np.where(off > 0, np.inf, 0.0)
    pieces = np.ones(len(off))
    for _ in range(_HALVINGS):
        pieces = np.where(pieces < needed, 2.0 * pieces, pieces)
    return pieces


def _affordable(pieces: Floats, off: Floats, room: int) -> Floats:
    """Those pieces, (m,), as far as there is room for the samples between them: the worst first."""
    order = np.argsort(-off, kind="stable")
    many = np.cumsum(pieces[order] - 1.0)
    pieces[order[many > room]] = 1.0
    return pieces


def _off(curve: Curve, times: Floats, parts: Mapping[int, Parts], left: Integers) -> Deviation:
    """The largest deviation in each of some intervals, (m,); 0 where float32 has no time inside."""
    start, span = times[left], times[left + 1] - times[left]
    found = Deviation(np.zeros(len(left)), np.full(len(left), -1))
    inside = np.concatenate([as_float32(start + share * span) for share in _SHARES])
    which = np.tile(np.arange(len(left)), len(_SHARES))
    real = np.flatnonzero((inside > start[which]) & (inside < start[which] + span[which]))
    for rows in counted([*blocks(len(real))], "moments"):
        some = real[rows]
        k = which[some]
        shown = _line(parts, left[k], (inside[some] - start[k]) / span[k])
        off = curve.off(inside[some], shown)
        order = np.argsort(off.far, kind="stable")  # of several in one interval the last one stays
        order = order[off.far[order] > found.far[k[order]]]
        found.far[k[order]], found.node[k[order]] = off.far[order], off.node[order]
    return found


def _line(parts: Mapping[int, Parts], left: Integers, share: Floats) -> dict[int, Parts]:
    """Lines and great arcs between samples ``left`` and the next ones, (m, ·) each."""

    def ends(values: Floats) -> tuple[Floats, Floats]:
        return np.take(values.T, left, axis=1).T, np.take(values.T, left + 1, axis=1).T

    def line(values: Floats) -> Floats:
        if len(values) == 1:
            return values
        start, end = ends(values)
        return start + (end - start) * share[:, np.newaxis]

    def arc(turns: Floats) -> Floats:
        if len(turns) == 1:
            return turns
        start, end = ends(turns)
        return slerp(start, end, share)

    return {node: Parts(line(t), arc(r), line(s)) for node, (t, r, s) in parts.items()}


def _merged(
    old: Mapping[int, Parts], count: int, new: Mapping[int, Parts], more: int, order: Integers
) -> dict[int, Parts]:
    """Parts of ``count`` and of ``more`` samples as those of all of them, in ``order``."""

    def together(a: Floats, b: Floats) -> Floats:
        if len(a) == 1 == len(b) and np.array_equal(a, b):
            return a
        wide = [np.broadcast_to(each, (k, a.shape[1])).T for each, k in ((a, count), (b, more))]
        return np.take(np.concatenate(wide, axis=1), order, axis=1).T

    return {
        node: Parts(*(together(a, b) for a, b in zip(of, new[node], strict=True))) for node, of in old.items()
    }


@dataclass(frozen=True, eq=False)
class _Curve:
    """A clip that a solver plays. size: of the rig, in file units."""

    solver: Solver
    clip: Clip
    size: float

    @property
    def rig(self) -> Rig:
        return self.solver.rig

    @cached_property
    def nodes(self) -> list[int]:
        """The nodes that go on curves while controls go on lines, or the other way round.

        Not twist joints, which get keys of their own.
        """
        tracks = [t for t in self.clip.tracks if t.path != "weights" and len(t.times) > 1]
        splines = {t.node for t in tracks if t.interpolation == "CUBICSPLINE"}
        moving = {t.node for t in tracks} | set(self.solver.sets)
        found = set[int]()
        for step in self.solver.steps:
            if isinstance(step, Fk):
                carried = bool(moving & self.rig.with_ancestors(step.needs))
                if carried or splines.intersection((step.joint, *step.reads)):
                    found.add(step.joint)
            elif not isinstance(step, TwistStep):
                found.update(step.sets)
        return sorted(found)

    @cached_property
    def lever_arms(self) -> dict[int, float]:
        """How far nodes and rigid meshes below each of the nodes are from it, up to the next of them, in file
        units.
        """
        rig, nodes = self.rig, set(self.nodes)
        far, mine = np.maximum(0.05 * self.size, rigid_reach(rig)), np.zeros(len(rig), dtype=bool)
        mine[list(nodes)] = True
        for node in np.flatnonzero(rig.at_or_below(mine))[::-1].tolist():
            parent = int(rig.parents[node])
            if parent >= 0 and node not in nodes:
                bone = float(np.nan_to_num(length(rig.world[node, 3, :3] - rig.world[parent, 3, :3])))
                far[parent] = max(far[parent], far[node] + bone)
        return {node: float(far[node]) for node in nodes}

    @cached_property
    def steps(self) -> list[Step]:
        """The steps that the places of the nodes need."""
        return self.solver.steps_for(self.rig.with_ancestors(self.nodes))

    def apart(self, a: PoseCache, b: PoseCache, count: int) -> Deviation:
        """How far the nodes, and what is below them, are apart, at most."""
        most = Deviation(np.zeros(count), np.full(count, -1))
        for node in self.nodes:
            one, other = a.world(node), b.world(node)
            with np.errstate(divide="ignore", invalid="ignore"):
                turned = length(one[:, :3, :3] - other[:, :3, :3]) / length(other[:, :3, :3])
            moved = length(one[:, 3, :3] - other[:, 3, :3])
            far = np.nan_to_num(moved + self.lever_arms[node] * turned.max(axis=1), posinf=0.0)
            most.node[far > most.far] = node
            np.maximum(most.far, far, out=most.far)
        return most


def rigid_reach(rig: Rig) -> Floats:
    """How far the points of meshes without a skin are at rest from the nodes that show them, (n,), in file
    units; 0 where nothing can be read. Shapes of controls do not count.
    """
    found = np.zeros(len(rig))
    try:
        shown = [mesh for mesh in rig.content.outlines if mesh.node not in rig.own]
    except FileError:
        return found
    for mesh in (mesh for mesh in shown if mesh.skin is None or not mesh.joints.shape[1]):
        far = length(transform_directions(mesh.points, rig.world[mesh.node]))
        found[mesh.node] = max(found[mesh.node], float(np.nan_to_num(far, posinf=0.0).max(initial=0.0)))
    return found


class JointCurve(_Curve):
    """What controls and constraints make of the joints in a clip."""

    def at(self, times: Floats) -> dict[int, Parts]:
        return self.solver.solved(sample_parts(self.rig, self.clip, times))

    @cached_property
    def _used(self) -> frozenset[int]:
        """The nodes whose keys take part in where the nodes come to."""
        own = [n for step in self.steps for n in (*step.sets, *step.reads, *step.needs)]
        return frozenset(self.rig.with_ancestors([*own, *self.nodes]))

    def off(self, times: Floats, shown: Mapping[int, Parts]) -> Deviation:
        there = self.solver.run(sample_parts(self.rig, self.clip, times, only=self._used), self.steps)
        seen = PoseCache(self.rig, {**there.parts, **{node: shown[node] for node in self.nodes}})
        return self.apart(there, seen, len(times))


class ControlCurve(_Curve):
    """The controls that give the motion which joints have in a clip."""

    def at(self, times: Floats) -> dict[int, Parts]:
        found = self._matched(times)
        return joined([block.found.controls for block in found], len(times))

    def _matched(self, times: Floats) -> list[Block]:
        return solve_controls(
            self.solver, sample_parts(self.rig, self.clip, times), lambda node, parts: parts
        )

    def off(self, times: Floats, shown: Mapping[int, Parts]) -> Deviation:
        ((source, found),) = self._matched(times)
        seen = self.solver.run({**source.parts, **shown}, self.steps)
        return self.apart(found.posed, seen, len(times))
