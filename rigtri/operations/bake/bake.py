"""bake: controls and constraints evaluated into joint keys, and the other way round.

Source: R. Katz, "Rigging with Triangles", GDC 2018 (controls, pole vector); docs/evaluation.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.active_controls import (
    NOTHING,
    controls_and_poles,
    controls_at_work,
    moved_at_rest,
    of_one_motion,
    skeleton_size,
)
from rigtri.evaluation.constraint_solver import Parts, mirrored_as
from rigtri.evaluation.curve_refinement import ControlCurve, JointCurve, RefinedSamples, refine_samples
from rigtri.evaluation.inverse_solver import solve_controls
from rigtri.evaluation.key_reduction import key_tolerances
from rigtri.evaluation.pose_cache import PoseCache, sample_parts
from rigtri.evaluation.rig_space import in_rig_space
from rigtri.evaluation.sampling import key_times, sample
from rigtri.evaluation.shared_key_times import times_of, with_shared_times
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.timelines import (
    Timeline,
    chosen_timelines,
    jumps,
    put_tracks,
    same_curves,
    steps_only,
    timelines,
    times_and_jumps,
)
from rigtri.evaluation.twist_joints import twist_joints
from rigtri.evaluation.zero_pose import ControlsAtZero
from rigtri.maths.quaternions import unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import PATHS, Path, Track, key_values
from rigtri.model.constraints import constraints_of
from rigtri.model.metadata import ControlRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_twist.key_baking import keyed
from rigtri.operations.bake.bake_rig import with_rig
from rigtri.operations.bake.characters_apart import Baked, characters_apart, moved_nodes, together
from rigtri.operations.bake.dependents import (
    rebake_followers,
    refuse_cycles,
    rivets_and_readers,
    rivets_of_constraints,
    without_followers,
)
from rigtri.operations.bake.reduced_tracks import (
    is_still_valid,
    key_counts,
    posed_ends,
    reduced_tracks,
    with_rest_held,
)
from rigtri.operations.bake.unbaked import (
    UNBAKED,
    refuse_followed,
    refuse_leading,
    refuse_replaced,
    warn_overruled,
)
from rigtri.operations.bake.warnings import fidelity, warn_idle, warn_of_result, why_nothing
from rigtri.operations.operation import operation
from rigtri.operations.options.bake import BETWEEN as BETWEEN
from rigtri.operations.options.bake import BakeOptions as BakeOptions
from rigtri.operations.pose import KEPT, at_rest
from rigtri.operations.rigtri_nodes import with_record
from rigtri.operations.solver_warnings import (
    clip_solver_warnings,
    moment_of,
    refuse_overstretch,
    solver_warnings,
)
from rigtri.operations.take_clips.ik_switches import ik_ends
from rigtri.progress import as_share, count_done, counted
from rigtri.recognition.one_character import alone
from rigtri.report import Report

# Followers that are joints bring times to each other at most so often: an interval is halved until it fits.
_ROUNDS = 8
# What follows rivets has come to rest after so many passes for each of them, or forms a cycle.
_PASSES = 6
# The share of a clip's work that goes into finding its samples, about.
_SAMPLED = 0.7


def _refuse_alone(rig: Rig, nodes: frozenset[int], name: str, options: BakeOptions) -> None:
    refuse_followed(rig, nodes, name, chosen_timelines(alone(rig, nodes), options.clip))
    if options.to == "controls":
        refuse_leading(rig, nodes, name, every=True)


@operation(BakeOptions, alone=_refuse_alone)
def bake(rig: Rig, *, options: BakeOptions, report: Report) -> Rig:
    """Evaluate controls and constraints into joint keys, or give joints' motion to their controls.

    A control with keys in a clip moves its joints there; one without leaves them their own. What was
    done in each clip goes to ``report.added``.

    Raises UsageError, NameNotFoundError (a clip), GeometryError (a cycle; nothing to bake).
    """
    if options.rig_ is not None:
        rig = with_rig(rig, options.rig_, options, report)
    rig = _with_limits(rig, options)
    return in_rig_space(rig, lambda seen: _Baker(seen, options, report).baked())


def _with_limits(rig: Rig, options: BakeOptions) -> Rig:
    """The rig with another soft or stretch for its IK controls."""
    for node in ik_ends(rig):
        own = rig.records(ControlRecord)[node]
        soft = own.soft if options.soft is None else options.soft
        stretch = own.stretch if options.stretch is None else options.stretch
        rig = with_record(rig, node, replace(own, soft=soft, stretch=stretch))
    return rig


class _Baker:
    """One run: the rig as it changes."""

    def __init__(self, rig: Rig, options: BakeOptions, report: Report) -> None:
        self.rig, self.options, self.report, self.start = rig, options, report, rig
        self.solvers: dict[frozenset[int] | None, Solver] = {}
        self.reference = ControlsAtZero(rig)
        follows = options.to == "joints" and (rivets_and_readers(rig) or twist_joints(rig))
        own = self.reference
        if not (own.fk or own.limbs or own.roots or constraints_of(rig) or follows):
            raise GeometryError(f"There is nothing to bake: {why_nothing(rig)}")

    def baked(self) -> Rig:
        if self.options.to == "controls":
            if not timelines(self.rig):
                text = "The file has no clips, so there is no motion that controls could be given"
                self.report.warn("no-clips", text)
            chosen = of_one_motion(self.rig, chosen_timelines(self.rig, self.options.clip), made=True)
            for timeline in counted(chosen, "clips"):
                self._to_controls(timeline)
            warn_of_result(self.start, self.options, self.report)
            return self.rig
        self.report.reposed = True
        held = rivets_of_constraints(self.rig)
        reported = len(self.report.added)
        refuse_cycles(self.rig)
        # What follows a rivet comes to rest once everything before it in the chain has; and then its keys,
        # as other nodes' key times depend on them: a few passes each.
        for _ in range(_PASSES * (len(held) + 1)):
            before = self.rig
            del self.report.added[reported:]
            self._once()
            if not held or _same_motion(before, self.rig):
                warn_of_result(self.start, self.options, self.report)
                return self.rig
        names = ", ".join(f"'{self.rig.title(node)}'" for node in sorted(held))
        raise GeometryError(
            f"Constraints follow {names}, on meshes that they move themselves through pose readers: they "
            "form a cycle"
        )

    def _once(self) -> None:
        """Joints from controls and constraints, and all that follows joints, with rivets as they are."""
        self.reference, self.solvers = ControlsAtZero(self.rig), {}
        chosen = of_one_motion(self.rig, chosen_timelines(self.rig, self.options.clip), made=False)
        for timeline in counted(chosen, "clips"):
            self._to_joints(timeline)
        self._rest(self.rig)
        self._follow(frozenset(member for timeline in chosen for member in timeline.members))

    def _follow(self, clips: frozenset[int]) -> None:
        """All that follows joints, from the joints' keys as a reader will find them.

        Where joints share their key times those of followers come to them, too, so it is done again until
        there are no more times.
        """
        reported, mine = len(self.report.added), twist_joints(self.rig)
        seen = with_shared_times(self.rig, without=[twist.node for twist in mine])
        for _ in range(_ROUNDS):
            del self.report.added[reported:]
            rig, _ = keyed(seen.rig, mine)
            self.rig = seen.undone(rebake_followers(rig, clips, self.report), self.rig)
            last, seen = seen, with_shared_times(self.rig)
            if last.same_times(seen):
                break
        for twist in mine:
            self.report.added.append({"node": self.rig.names[twist.node], "type": "twist", "new": False})

    @cached_property
    def size(self) -> float:
        """The diagonal of the box of the joints at rest, in file units."""
        return skeleton_size(self.rig)

    @cached_property
    def bounds(self) -> tuple[Floats, Floats]:
        """How far thinned keys of each node may be off, (n,): moves in its parent's units, and radians."""
        return key_tolerances(self.rig, self.options.tolerance * self.size, self.size)

    def _bound(self, node: int, path: Path) -> float:
        """How far thinned keys of a node may be off: moves in its parent's units, and radians."""
        moves, turns = self.bounds
        found = {"translation": moves[node], "rotation": turns[node]}.get(path, self.options.tolerance / 2)
        return float(found)

    def _solver(self, driven: frozenset[int] | None) -> Solver:
        if driven not in self.solvers:
            self.solvers[driven] = Solver(self.rig, driven, self.reference)
        return self.solvers[driven]

    @cached_property
    def movers(self) -> frozenset[int]:
        """The nodes whose keys make a control active: controls and pole vectors."""
        return controls_and_poles(self.rig)

    def _samples(self, curve: JointCurve | ControlCurve, timing: Timeline) -> RefinedSamples:
        """Where they get keys: also where what lies between these would else be off."""
        times = times_and_jumps(timing, self.options.fps, self.rig.rules.per_second)
        if steps_only(timing) or not curve.nodes:
            return RefinedSamples(times, curve.at(times), 0.0, limited=False)
        bound = np.inf if self.options.fps else max(self.options.between, NOTHING) * self.size
        return refine_samples(curve, times, bound=bound, per_second=self.rig.rules.per_second)

    # --- to joints

    def _to_joints(self, timeline: Timeline) -> None:
        at_work, before = controls_at_work(self.rig, timeline), self.rig
        parts = characters_apart(before, timeline, at_work, self._solver)
        baked = [found for part in parts if (found := self._part_to_joints(*part))]
        if not baked:
            return
        warn_idle(before, timeline, at_work, self.report)
        solver, (samples, tracks) = self._solver(at_work), together(baked)
        self.report.added.append(self._record(timeline, solver, samples, tracks, moved_nodes(solver)))

    def _part_to_joints(self, solver: Solver, timeline: Timeline) -> Baked | None:
        """Put tracks of what a solver moves in a timeline into the rig; None where it moves nothing."""
        nodes = moved_nodes(solver)
        if not nodes:
            return None
        replaced = {
            (node, path) for node, paths in solver.writes.items() for path, all_of_it in paths if all_of_it
        }
        replaced |= {(node, path) for node in solver.offsets for path in PATHS}
        timing = without_followers(self.rig, timeline, replaced)
        with as_share(0, _SAMPLED):
            samples = self._samples(JointCurve(solver, timeline.clip, self.size), timing)
        times, scales = samples.times, self.rig.scale
        parts = {node: mirrored_as(each, scales[node]) for node, each in samples.parts.items()}
        held = times if steps_only(timing) else jumps(timing)
        refuse_overstretch(solver, PoseCache(self.rig, parts), moment_of(timeline.name, times))
        tracks = [
            track
            for node in nodes
            for track in self._tracks(
                timeline, times, held, node, parts[node], PoseCache(self.rig).part(node)
            )
            if track.path in {path for path, _ in solver.writes[node]}
        ]
        self.report.extend(clip_solver_warnings(solver, timeline, times, parts))
        room = times_of(put_tracks(self.rig, timeline, tracks))
        fresh = [
            track
            for track in tracks
            if not is_still_valid(
                timeline.track(track.node, track.path),
                track,
                times,
                dict(zip(PATHS, parts[track.node], strict=True))[track.path],
                bound=self._bound(track.node, track.path),
                room=room.get((track.node, track.path), track.times),
            )
        ]
        fresh += posed_ends(self.rig, timeline, solver.limbs, fresh)
        self.rig = put_tracks(self.rig, timeline, fresh)
        return samples, tracks

    def _tracks(
        self, timeline: Timeline, times: Floats, held: Floats, node: int, parts: Parts, rest: Parts
    ) -> list[Track]:
        """Keys for a node; ``held``: the times up to which values may be held. See `reduced_tracks`."""
        bounds = [self._bound(node, path) for path in PATHS]
        return reduced_tracks(timeline, times, held, node, parts, rest, bounds=bounds, size=self.size)

    def _rest(self, rig: Rig) -> None:
        """Joints at rest where controls at rest were moved, and where constraints put their children."""
        solver = self._solver(moved_at_rest(rig, self.size))
        if not solver.steps:
            return
        posed = solver.run({})
        self.report.extend(solver_warnings(solver, posed, lambda _: "the rest pose"))
        # A limb without FK controls turns from where its joints rest to where its pole vector does.
        bare = {limb.pole for limb in self.reference.limbs if self.reference.fk.keys().isdisjoint(limb.chain)}
        kept = {*rig.nodes_of(*KEPT, "twist")} - bare
        parts = {node: posed.parts[node] for node in solver.sets if node not in kept}
        self.rig, found = at_rest(self.rig, parts, np.minimum(self.bounds[0], NOTHING * self.size))
        if found:
            chosen = chosen_timelines(self.rig, self.options.clip)
            self.rig = with_rest_held(self.rig, rig, found, chosen)
            self.report.added.append({"type": "rest", "nodes": [self.rig.title(node) for node in found]})

    # --- to controls

    def _to_controls(self, timeline: Timeline) -> None:
        # A joint that only the root control carries keeps its own keys; that control gets none.
        carrying = {own.control for own in self.reference.roots if own.joint not in self.reference.fk}
        # What an animator has put on pivots of feet stays there, and the IK control counts from it.
        pivots = frozenset(node for limb in self.reference.limbs for node in limb.pivots)
        moved = controls_at_work(self.rig, timeline) | moved_at_rest(self.rig, self.size)
        solver = self._solver(self.movers - carrying - (pivots - moved))
        # So does what is on a root control: what is below it counts from that, unless it makes all of it
        # flat.
        flat = {t.node for t in timeline.clip.tracks if t.path == "scale" and not key_values(t).all()}
        kept = {own.control for own in self.reference.roots} - flat
        made = (self.movers | solver.offsets).difference(kept, pivots)
        timing = without_followers(self.rig, timeline, {(node, path) for node in made for path in PATHS})
        joints = tuple(t for t in timeline.clip.tracks if t.node not in made)
        clip = replace(timeline.clip, tracks=joints)
        with as_share(0, _SAMPLED):
            samples = self._samples(ControlCurve(solver, clip, self.size), timing)
        times = samples.times
        held = times if steps_only(timing) else jumps(timing)
        tracks: list[Track] = []
        solved: set[int] = set()

        def keep(node: int, parts: Parts) -> Parts:
            """Tracks for a control, and their values at all times."""
            count_done(len(solved), len(made | solved), "controls")
            solved.add(node)
            at_zero = PoseCache(self.rig).part(node)
            own = self._tracks(timeline, times, held, node, parts, at_zero)
            tracks.extend(own)
            read = dict(zip(PATHS, at_zero, strict=True))
            for track in own:
                read[track.path] = track.values if track.times is times else sample(track, times)
            return Parts(read["translation"], unit(read["rotation"]), read["scale"])

        with as_share(_SAMPLED, 1):
            found = solve_controls(solver, sample_parts(self.rig, clip, times), keep)
        warn_overruled(self.rig, timeline, solver, self.report)
        before, self.rig = self.rig, put_tracks(self.rig, timeline, tracks)
        if not self.options.discard_motion:
            # Whatever may lie between keys, at those motion is lost that is far above what a bake leaves.
            bound = max(min(self.options.between, BETWEEN), UNBAKED)
            # What only follows, such as a rivet, has keys where no joint or control has any.
            compared = key_times(without_followers(self.rig, timeline, ()).clip)
            refuse_replaced(before, self.rig, timeline, compared, self.size, bound, self.report)
        controls = sorted({node for block in found for node in block.found.controls})
        fidelity_record, notices = fidelity(
            self.rig, found, times, clip=timeline.name, size=self.size, tolerance=self.options.tolerance
        )
        self.report.extend(notices)
        record = self._record(timeline, solver, samples, tracks, controls)
        self.report.added.append(record | fidelity_record)

    def _record(
        self,
        timeline: Timeline,
        solver: Solver,
        samples: RefinedSamples,
        tracks: Sequence[Track],
        nodes: Sequence[int],
    ) -> dict[str, Any]:
        """What the report has of a clip, but how far controls are off."""
        counts = key_counts(self.start, timeline, tracks)
        return {
            "type": "clip",
            "clip": timeline.name,
            "to": self.options.to,
            "frames": len(samples.times),
            "nodes": len(nodes),
            "limbs": len(solver.limbs),
            "keys": sum(now for now, _ in counts.values()),
            "keys_before": sum(before for _, before in counts.values()),
            "keys_of": {self.rig.title(node): list(counts[node]) for node in sorted(counts)},
            "between_samples": samples.off / self.size,
            "between_after": samples.after,
            "between_node": self.rig.title(samples.node) if samples.node >= 0 else None,
            "limited": samples.limited,
        }


def _same_motion(a: Rig, b: Rig) -> bool:
    """Whether two states of a rig have, but for rounding, the same clips and the same rest pose.

    Of curves, not objects: what a control and a pose reader both move is written twice in each pass.
    """
    clips = all(same_curves(one, other) for one, other in zip(a.clips, b.clips, strict=True))
    return clips and bool(
        np.abs(a.world - b.world).max(initial=0.0) <= 1e-9 * np.abs(a.world).max(initial=1.0)
    )
