"""snap: FK controls take over from IK at a frame, or IK from FK; the joints stay where they are.

A limb is solved by IK in a clip where its IK end or pole has keys (docs/evaluation.md). So IK's keys go
where FK takes over, and the keys of the limb's FK controls where IK does. What takes over gets keys at all
of the clip's keys, so that the rest of the motion stays; what is at work already, at the moments alone.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.active_controls import NOTHING, controls_at_work, moved_at_rest, skeleton_size
from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.fk import Fk
from rigtri.evaluation.ik import Ik
from rigtri.evaluation.inverse_solver import SolvedControls, match_limb
from rigtri.evaluation.key_insertion import insert_keys
from rigtri.evaluation.pose_cache import PoseCache, sample_parts
from rigtri.evaluation.rig_space import in_rig_space
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.solver_steps import depending
from rigtri.evaluation.timelines import (
    Timeline,
    as_float32,
    jumps,
    just_before,
    keys_and_between,
    steps_only,
    timeline_and_time,
    timelines,
    times_within,
)
from rigtri.evaluation.zero_pose import ControlsAtZero
from rigtri.maths.quaternions import angle_between
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import PATHS, Clip, Interpolation, Path, Track
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.operations.bake.unbaked import refuse_followed, refuse_leading
from rigtri.operations.operation import operation
from rigtri.operations.options.snap import IkOrFk
from rigtri.operations.options.snap import SnapOptions as SnapOptions
from rigtri.operations.pose import at_rest, warn_outside_clip
from rigtri.progress import counted
from rigtri.recognition.limbs import given
from rigtri.recognition.one_character import alone
from rigtri.report import Report
from rigtri.text import and_more

# Joints that move by more, as a share of the size, are reported.
NEAR = 1e-5
# Values that differ by less, in radians or as a share of the size, were found from the same pose.
SAME = 1e-5


def _refuse_alone(rig: Rig, nodes: frozenset[int], name: str, options: SnapOptions) -> None:
    seen = alone(rig, nodes)  # which knows clips by shorter names
    refuse_followed(rig, nodes, name, [timeline_and_time(seen, text)[0] for text in options.at])
    refuse_leading(rig, nodes, name)


@operation(SnapOptions, alone=_refuse_alone)
def snap(rig: Rig, *, options: SnapOptions, report: Report) -> Rig:
    """Give IK ends and poles, or FK controls, the values with which joints stand as they do at some moments.

    What was done to each limb goes to ``report.added``, with how far its joints have moved. Raises
    UsageError, NameNotFoundError, GeometryError (no such limb, no FK controls,
    an IK end that follows a constraint, one below what it moves).
    """
    return in_rig_space(rig, lambda seen: _snapped(seen, options, report))


def _snapped(rig: Rig, options: SnapOptions, report: Report) -> Rig:
    chains = _chains(rig, options)
    moments: dict[tuple[int, ...], list[tuple[str, float]]] = {}
    for text in options.at:
        timeline, time = timeline_and_time(rig, text)
        if timeline is not None:
            time = warn_outside_clip(timeline, time, report)
        moments.setdefault(timeline.members if timeline else (), []).append((text, time))
    for together, chain in counted([(one, chain) for one in moments.values() for chain in chains], "limbs"):
        if chain is chains[0]:
            at, reference = as_float32(np.unique([time for _, time in together])), ControlsAtZero(rig)
        timeline, _ = timeline_and_time(rig, together[0][0])
        before, rig = rig, _Limb(rig, chain, timeline, at, options.to, report, reference).snapped()
        if timeline is None and rig is not before:
            reference = ControlsAtZero(rig)
    return rig


def _chains(rig: Rig, options: SnapOptions) -> list[tuple[int, int, int]]:
    """The limbs, as nodes. GeometryError for one without an IK end."""
    known = [limb.chain for limb in ControlsAtZero(rig).limbs]
    chains = [(rig.find(a), rig.find(b), rig.find(c)) for a, b, c in options.limb] or known
    for chain in chains:
        if chain not in known:
            given(rig, *map(rig.address, chain))
            names = ", ".join(f"'{rig.title(node)}'" for node in chain)
            raise GeometryError(f"The limb {names} has no IK end; make one with: rigtri add-controls --ik")
    if not chains:
        raise GeometryError(
            "No limb here has an IK end; make some with: rigtri add-controls --whole-character"
        )
    return chains


@dataclass(frozen=True, eq=False)
class _Limb:
    """One limb at some times of a timeline, or at rest where there is none."""

    rig: Rig
    chain: tuple[int, int, int]
    timeline: Timeline | None
    times: Floats
    to: IkOrFk
    report: Report
    reference: ControlsAtZero

    def snapped(self) -> Rig:
        ik = self._ik()
        ends = [node for node in (ik.limb.control, ik.limb.pole) if node >= 0]
        pivots = ik.limb.pivots if self.to == "fk" else ()
        fks = self._fks(ik)
        controls = [fk.own.control for fk in fks.values()]
        offsets = [fk.own.offset for fk in ik.fk.values()]
        at_work = self._at_work(self.rig)
        was_ik = bool(at_work.intersection((*ends, *ik.limb.pivots)))
        already = was_ik if self.to == "ik" else not was_ik and at_work.issuperset(controls)
        # What takes over is to show all of the motion that it had without.
        times = self.times if already or self.timeline is None else self._all_times(self.timeline)
        before = self._posed(self._solver(self.rig), times, self._looked_at(ik, fks))
        channels = self._to_ik(ik, before) if self.to == "ik" else self._to_fk(ik, fks, before)
        if not all(np.isfinite(each).all() for parts in channels.values() for each in parts):
            raise GeometryError(
                f"The limb that ends in '{self.rig.title(self.chain[2])}' has a scale of zero at one of the "
                "moments, or above it; no control can match joints without axes"
            )
        if self.timeline is None:
            if self.to == "fk" and was_ik:
                zero = Parts(np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]), np.ones((1, 3)))
                channels |= dict.fromkeys((ik.limb.control, *pivots), zero)
            rig, _ = at_rest(
                self.rig, channels, np.full(len(self.rig), 0.1 * NOTHING * skeleton_size(self.rig))
            )
        elif already:
            rig = self._set(channels)
        else:
            working = ends if self.to == "ik" else controls
            rig = self._replaced(channels, times, {*ends, *controls, *offsets, *pivots}, working)
        rig = rig if self.timeline is None else rig.with_parts(channels)
        # What controls show, and tracks that go, are so on purpose.
        self.report.reposed |= rig is not self.rig
        self._record(rig, times, {*ends, *controls, *pivots, *ik.sets, *offsets})
        return rig

    def _all_times(self, timeline: Timeline) -> Floats:
        """The moments, and where the clip has keys; splines are sampled as `bake` does."""
        splines = any(t.interpolation == "CUBICSPLINE" and len(t.times) > 1 for t in timeline.clip.tracks)
        times = np.union1d(
            self.times, times_within(timeline, 60.0 if splines else None, self.rig.rules.per_second)
        )
        if steps_only(timeline):
            return times
        before = just_before(jumps(timeline))
        return np.union1d(times, before[before > times[0]])

    def _at_work(self, rig: Rig) -> frozenset[int]:
        timeline = self._now(rig)
        return controls_at_work(rig, timeline) if timeline else moved_at_rest(rig, skeleton_size(rig))

    def _now(self, rig: Rig) -> Timeline | None:
        """The timeline, with the tracks that a later state of the rig has in it."""
        if self.timeline is None:
            return None
        first = self.timeline.members[0]
        empty = replace(self.timeline, clip=Clip(self.timeline.name, ()))
        return next((each for each in timelines(rig) if first in each.members), empty)

    @cached_property
    def _resting(self) -> Solver:
        """The rig's solver with no control at work."""
        return Solver(self.rig, (), self.reference)

    @property
    def _rules(self) -> Mapping[int, Any]:
        """The constraints, by the node that follows."""
        return self._resting.rules

    def _solver(self, rig: Rig) -> Solver:
        """The solver of a state of the rig; its rest pose is this one's but after a snap at rest."""
        same_rest = self.timeline is not None or rig is self.rig
        return Solver(rig, self._at_work(rig), self.reference if same_rest else None)

    def _posed(self, solver: Solver, times: Floats, nodes: Collection[int]) -> PoseCache:
        """The rig as the solver poses some nodes and what is above them; others may be elsewhere."""
        rig, timeline = solver.rig, self._now(solver.rig)
        steps = solver.steps_for(rig.with_ancestors(nodes))
        used = [node for step in steps for node in (*step.sets, *step.reads, *step.needs)]
        only = rig.with_ancestors([*nodes, *used])
        return solver.run(sample_parts(rig, timeline.clip, times, only=only) if timeline else {}, steps)

    def _looked_at(self, ik: Ik, fks: Mapping[int, Fk]) -> set[int]:
        """The nodes whose poses give the limb's controls their values."""
        of = [*fks.values(), *ik.fk.values()]
        nodes = [node for fk in of for node in (fk.own.control, fk.own.offset, fk.own.above, *fk.needs)]
        drivers = ik.rule.drivers if ik.rule is not None else ()
        nodes += [*ik.sets, *ik.needs, *drivers, ik.limb.control, ik.limb.pole]
        return {node for node in nodes if node >= 0}

    def _ik(self) -> Ik:
        limb = next(limb for limb in self.reference.limbs if limb.chain == self.chain)
        rolling = self._at_work(self.rig).intersection(limb.pivots)
        solver = Solver(self.rig, {limb.control, *rolling}, self.reference)
        _ = solver.steps  # ControlCycleError where the end depends on what it moves
        return next(ik for ik in solver.limbs if ik.limb.chain == self.chain)

    def _fks(self, ik: Ik) -> dict[int, Fk]:
        """The FK controls of what IK moves, by joint, parents first."""
        nodes = (self.chain[0], *ik.paths[0], *ik.paths[1], ik.limb.toe)
        moved = [node for node in nodes if node in ik.sets and node in ik.reference.fk]
        return {node: Fk(ik.reference, ik.reference.fk[node]) for node in moved}

    def _to_ik(self, ik: Ik, before: PoseCache) -> dict[int, Parts]:
        found = SolvedControls(PoseCache(self.rig, before.parts))
        match_limb(found, ik, before, self._rules, lambda node, parts: _single(parts))
        channels = dict(found.controls)
        if self.timeline is not None:  # at rest the controls' channels start from their offsets
            # Those that constraints move, or that hold such, stay where they are, as IK leaves them.
            taken = self._resting.still.union(ik.carries)
            for fk in ik.below({fk.own.offset for fk in ik.fk.values()} - taken):
                stand = _single(fk.beneath(found.posed))
                if all(np.isfinite(each).all() for each in stand):
                    found.posed.set(fk.own.offset, stand)
                    channels[fk.own.offset] = stand
            channels |= found.offsets
        return channels

    def _to_fk(self, ik: Ik, fks: Mapping[int, Fk], before: PoseCache) -> dict[int, Parts]:
        missing = [node for node in self.chain if node not in fks]
        if missing:
            raise GeometryError(
                f"'{self.rig.title(missing[0])}' has no FK control; make one with: rigtri add-controls"
            )
        for node in (ik.limb.control, ik.limb.pole):
            if node in self._rules:
                raise GeometryError(
                    f"'{self.rig.title(node)}' follows a constraint, so IK always moves the limb that ends "
                    f"in '{self.rig.title(self.chain[2])}'; take the constraint out first"
                )
        built = PoseCache(self.rig, before.parts)
        return {fk.own.control: _single(fk.channels(built, before.part(node))) for node, fk in fks.items()}

    def _set(self, channels: Mapping[int, Parts]) -> Rig:
        """The rig with other values at the moments, where one of them is another."""
        timeline = self._now(self.rig)
        assert timeline is not None
        now = PoseCache(self.rig, sample_parts(self.rig, timeline.clip, self.times))
        size = skeleton_size(self.rig)
        if all(_is_close(now.part(node), parts, size) for node, parts in channels.items()):
            return self.rig
        clips, target = list(self.rig.clips), _channel_values(channels)
        for k in self.timeline.members if self.timeline else ():
            tracks = []
            for track in clips[k].tracks:
                values = target.pop((track.node, track.path), None)
                rows = None if values is None else _rows(values, len(self.times))
                tracks.append(track if rows is None else insert_keys(track, self.times, rows))
            clips[k] = replace(clips[k], tracks=tuple(tracks))
        fresh = [self._nearby(timeline, *which, values) for which, values in target.items()]
        home = timeline.members[0]
        clips[home] = replace(clips[home], tracks=(*clips[home].tracks, *(t for t in fresh if t is not None)))
        return replace(self.rig, clips=tuple(clips))

    def _nearby(self, timeline: Timeline, node: int, path: Path, values: Floats) -> Track | None:
        """A track for what had none: between the keys around the moments it is what it is at rest."""
        rest = _part(self.rig, node, path)
        if np.abs(values - rest).max() <= NOTHING or self.rig.type_of(node) == "offset":
            return None
        keys = times_within(timeline, None)
        outer = [keys[keys < self.times[0]][-1:], keys[keys > self.times[-1]][:1]]
        inner = keys[(keys > self.times[0]) & (keys < self.times[-1])]
        times = np.union1d(self.times, np.concatenate([*outer, inner]))
        rows = _rows(rest, len(times))
        rows[np.searchsorted(times, self.times)] = values
        return Track(node, path, "LINEAR" if len(times) > 1 else "STEP", times, rows)

    def _replaced(
        self, channels: Mapping[int, Parts], times: Floats, gone: Collection[int], working: Collection[int]
    ) -> Rig:
        """The rig with new tracks. gone: nodes that lose theirs. working: nodes that get some in any case."""
        timeline = self.timeline
        assert timeline is not None
        clips, held, made = list(self.rig.clips), steps_only(timeline), dict[tuple[int, Path], Track]()
        for (node, path), values in _channel_values(channels).items():
            needs = node in working and path == ("rotation" if self.to == "fk" else "translation")
            if needs or np.abs(values - _part(self.rig, node, path)).max() > NOTHING:
                still = len(values) == 1 or bool((values == values[0]).all())
                way: Interpolation = "STEP" if still or held else "LINEAR"
                made[node, path] = Track(
                    node, path, way, times[:1] if still else times, values[:1] if still else values
                )
        # New tracks stand where those that go were.
        left = [k for k in timeline.members if any(t.node in gone for t in clips[k].tracks)]
        for k in left:
            kept = []
            for track in clips[k].tracks:
                now = made.pop((track.node, track.path), None)
                if now is not None:
                    kept.append(replace(now, key=track.key))
                elif track.node not in gone:
                    kept.append(track)
            clips[k] = replace(clips[k], tracks=tuple(kept))
        home = left[0] if left else timeline.members[0]
        clips[home] = replace(clips[home], tracks=(*clips[home].tracks, *made.values()))
        return replace(self.rig, clips=tuple(clips))

    def _record(self, rig: Rig, times: Floats, changed: Collection[int]) -> None:
        solvers = self._solver(self.rig), self._solver(rig)
        ends = rig.nodes_of("control", "poleVector")
        moved = sorted(depending(rig, changed, [s for each in solvers for s in each.steps]).difference(ends))
        joints = [node for node in moved if rig.is_joint[node]]
        self._warn_followers(solvers, [node for node in moved if node in self._rules], times)
        # Keys set at the moments alone change what the clip shows between them and its other keys.
        all_times = times if self.timeline is None else np.union1d(times, self._all_times(self.timeline))
        far, elsewhere = (
            self._deviation(solvers, joints, each) for each in (self.times, keys_and_between(all_times))
        )
        name = self.rig.title(self.chain[2])
        if not far <= NEAR:
            text = f"The limb that ends in '{name}' moves by {far:.2g} of the size"
            if self.to == "fk" and (led := [node for node in self.chain if node in self._rules]):
                text += f": '{rig.title(led[-1])}' follows a constraint, which IK had overruled"
            self.report.warn("snap-off", text, geometry=True)
        self.report.added.append(
            {
                "type": "snap",
                "limb": [rig.title(node) for node in self.chain],
                "to": self.to,
                "clip": self.timeline.name if self.timeline else None,
                "times": self.times.tolist() if self.timeline else [],
                "deviation": far,
                "elsewhere": elsewhere,
            }
        )

    def _warn_followers(self, solvers: tuple[Solver, Solver], moved: Sequence[int], times: Floats) -> None:
        """A warning for what follows controls of the limb, and moves with them where its joints stay."""
        rig = solvers[1].rig
        loose = [node for node in moved if not rig.is_joint[node] and node not in rig.own]
        for node, far in self._deviations(solvers, loose, times).items():
            if not far <= NEAR:
                led = sorted({f"'{rig.title(k)}'" for rule in self._rules[node] for k in rule.sources})
                text = (
                    f"'{rig.title(node)}' follows {and_more(led, 3)} and moves by {far:.2g} of the size: "
                    "controls that no longer move a limb do not go along with it. Let it follow the joint"
                )
                self.report.warn("snap-off", text, geometry=True)

    def _deviation(self, solvers: tuple[Solver, Solver], joints: Sequence[int], times: Floats) -> float:
        """How far joints are from where they were, at most, as a share of the size."""
        return max(self._deviations(solvers, joints, times).values(), default=0.0)

    def _deviations(
        self, solvers: tuple[Solver, Solver], joints: Sequence[int], times: Floats
    ) -> dict[int, float]:
        """How far each node is from where it was, as a share of the size."""
        if not joints:
            return {}
        before, after = (self._posed(solver, times, joints) for solver in solvers)
        rig, found = solvers[1].rig, dict[int, float]()
        size = skeleton_size(rig)
        for joint in joints:
            off = length((after.world(joint) - before.world(joint))[:, :, :3])
            apart = off[:, 3]
            if not rig.is_joint[list(rig.children[joint])].any():
                # No joint below shows how it turns: what it moves is about as long as the bone above it.
                apart = apart + off[:, :3].max(axis=1) * float(length(rig.translation[joint]))
            found[joint] = max(0.0, float(np.nan_to_num(apart).max())) / size
        return found


def _channel_values(channels: Mapping[int, Parts]) -> dict[tuple[int, Path], Floats]:
    return {
        (node, path): values
        for node, parts in channels.items()
        for path, values in zip(PATHS, parts, strict=True)
    }


def _part(rig: Rig, node: int, path: Path) -> Floats:
    """What a node has at rest, (1, c)."""
    return PoseCache(rig).part(node)[PATHS.index(path)]


def _is_close(now: Parts, target: Parts, size: float) -> bool:
    """Whether the two differ by no more than rounding."""
    moved = float(np.abs(target.translation - now.translation).max())
    turned = float(angle_between(now.rotation, target.rotation).max())
    grown = float(np.abs(target.scale - now.scale).max())
    return moved <= SAME * size and turned <= SAME and grown <= SAME


def _single(parts: Parts) -> Parts:
    return Parts(*(as_float32(each) for each in parts))


def _rows(values: Floats, count: int) -> Floats:
    return np.broadcast_to(values, (count, values.shape[-1])).copy()
