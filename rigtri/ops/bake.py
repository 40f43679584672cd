"""bake: controls and constraints worked out into joint keys, and the other way round.

Source: R. Katz, "Rigging with Triangles", GDC 2018 (controls, pole vector); docs/evaluation.md.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from functools import cached_property
from typing import Literal, get_args

import numpy as np

from rigtri.bounds import refuse_unworkable
from rigtri.errors import GeometryError, NameNotFoundError, UsageError
from rigtri.following import Parts
from rigtri.ops.twist_keys import keyed
from rigtri.pose import sample
from rigtri.quaternions import conjugate, turn_angle, unit
from rigtri.quaternions import multiply as product
from rigtri.records import Interpolation, Path, Track
from rigtri.report import Report
from rigtri.rig import Rig
from rigtri.rules import rules_of
from rigtri.solve.evaluate import Solver
from rigtri.solve.keys import needed
from rigtri.solve.match import Matched, matched
from rigtri.solve.posed import Posed, sampled
from rigtri.solve.reference import Reference
from rigtri.timelines import (
    Timeline,
    jumps,
    just_before,
    placed,
    single,
    steps_only,
    timelines,
    times_within,
)
from rigtri.trigonometry import Floats
from rigtri.twist import is_twist, twists
from rigtri.vectors import length

Direction = Literal["joints", "controls"]
DIRECTIONS: tuple[Direction, ...] = get_args(Direction)
# Channels of controls that differ from zero by less are zero: float32 readers see no difference.
_NOTHING = 1e-6
_PATHS: tuple[Path, ...] = ("translation", "rotation", "scale")


@dataclass(frozen=True)
class Options:
    """Everything that `bake` can be told; the defaults are the command's.

    to: ``joints`` or ``controls``. clips: globs of the clips, all of them where there is none.
    fps: so many samples a second besides the keys. tolerance: how far thinned keys may be off, as
    a share of the rig's size. soft, stretch: of all limbs, instead of what their controls say.
    """

    to: Direction = "joints"
    clips: tuple[str, ...] = ()
    fps: float | None = None
    tolerance: float = 1e-5
    soft: float | None = None
    stretch: bool | None = None

    def checked(self) -> Options:
        """These options. UsageError for what cannot be."""
        if self.to not in DIRECTIONS:
            raise UsageError(f"--to {self.to}: choose of {', '.join(DIRECTIONS)}")
        refuse_unworkable("--fps", self.fps)
        if self.fps is not None and not self.fps > 0:
            raise UsageError("--fps is a number above 0, e.g. 30")
        if not self.tolerance >= 0:
            raise UsageError("--tolerance is a share of the rig's size, 0 or more")
        if self.soft is not None and not 0 <= self.soft < 1:
            raise UsageError("--soft is a share of the limb, from 0 to below 1")
        return self


def bake(rig: Rig, *, options: Options, report: Report | None = None) -> Rig:
    """Evaluate controls and constraints into joint keys, or give joints' motion to their controls.

    A control with keys in a clip moves its joints there; one without leaves them their own. What was
    done in each clip goes to ``report.added``.

    Raises UsageError, NameNotFoundError (a clip), GeometryError (a circle; nothing to bake).
    """
    report = report if report is not None else Report()
    return _Baker(_with_limits(rig, options.checked()), options, report).baked()


def _with_limits(rig: Rig, options: Options) -> Rig:
    """The rig with another soft or stretch for its IK controls."""
    if options.soft is None and options.stretch is None:
        return rig
    notes = dict(rig.notes)
    for node, note in rig.notes.items():
        if note.get("type") == "control" and note.get("kind") == "ik":
            more = {} if options.soft is None else {"soft": options.soft}
            more |= {} if options.stretch is None else {"stretch": options.stretch}
            notes[node] = {**note, **more}
    return replace(rig, notes=notes)


class _Baker:
    """One run: the rig as it changes."""

    def __init__(self, rig: Rig, options: Options, report: Report) -> None:
        self.rig, self.options, self.report = rig, options, report
        self.solvers: dict[frozenset[int] | None, Solver] = {}
        self.reference = Reference(rig)
        if not (self.reference.fk or self.reference.limbs or self.reference.roots or rules_of(rig)):
            raise GeometryError(
                "There is nothing to bake: the file has no controls and no constraints of rigtri. "
                "Add some with: rigtri add-controls, or name a file that has them with --rig"
            )

    def baked(self) -> Rig:
        start = self.rig
        chosen = self._chosen()
        work = self._to_joints if self.options.to == "joints" else self._to_controls
        for timeline in chosen:
            work(timeline)
        if self.options.to == "joints":
            self.report.reposed = True
            self._rest(start)
            for twist in twists(self.rig):
                self.rig, _ = keyed(self.rig, twist)
        return self.rig

    def _chosen(self) -> list[Timeline]:
        """The timelines of the clips that were asked for."""
        every = timelines(self.rig)
        if not self.options.clips:
            return every
        shown = self.rig.shown_clips
        found: list[Timeline] = []
        for pattern in self.options.clips:
            names = {clip.name for clip in shown}
            hits = [
                t
                for t in every
                if any(
                    pattern in (self.rig.clips[k].name, f"#{k}")
                    or (pattern not in names and fnmatchcase(self.rig.clips[k].name, pattern))
                    for k in t.members
                )
            ]
            if not hits:
                raise NameNotFoundError("clip", pattern, [clip.name for clip in shown])
            found += [t for t in hits if t not in found]
        return found

    @cached_property
    def size(self) -> float:
        """The diagonal of the box of the joints at rest, in file units."""
        points = (
            self.rig.world[self.rig.is_joint, 3, :3] if self.rig.is_joint.any() else self.rig.world[:, 3, :3]
        )
        points = points[np.isfinite(points).all(axis=1)]
        size = float(length(points.max(axis=0) - points.min(axis=0))) if len(points) else 0.0
        return size or 1.0

    @cached_property
    def bounds(self) -> tuple[Floats, Floats]:
        """How far thinned keys of each node may be off, (n,): moves in its parent's units, and radians."""
        rig = self.rig
        world = rig.world[:, 3, :3]
        # Errors add up along a chain; each of its joints gets an equal share.
        share = self.options.tolerance * self.size / (2.0 * (max(rig.depth, default=0) + 1))
        reach = np.full(len(rig), 0.05 * self.size)
        for node in range(len(rig) - 1, -1, -1):
            parent = int(rig.parents[node])
            if parent >= 0:
                far = reach[node] + float(np.nan_to_num(length(world[node] - world[parent])))
                reach[parent] = max(reach[parent], far)
        parents = np.where((rig.parents >= 0)[:, np.newaxis, np.newaxis], rig.world[rig.parents], np.eye(4))
        unit_of = length(parents[:, :3, :3]).max(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            moves = np.where(unit_of > 0, share / np.where(unit_of > 0, unit_of, 1.0), share)
        return moves, share / reach

    def _solver(self, driven: frozenset[int] | None) -> Solver:
        if driven not in self.solvers:
            self.solvers[driven] = Solver(self.rig, driven)
        return self.solvers[driven]

    @cached_property
    def movers(self) -> frozenset[int]:
        """The nodes whose keys say that a control is at work: controls and poles."""
        kinds = ("control", "poleVector")
        return frozenset(node for node, note in self.rig.notes.items() if note.get("type") in kinds)

    def _times(self, timeline: Timeline) -> Floats:
        """Where joints, or controls, get keys."""
        if any(t.interpolation == "CUBICSPLINE" and len(t.times) > 1 for t in timeline.clip.tracks):
            fps: float | None = self.options.fps or 60.0
        else:
            fps = self.options.fps
        times = times_within(timeline, fps, self.rig.per_second)
        if not steps_only(timeline):
            before = just_before(jumps(timeline))
            times = np.unique(np.concatenate([times, before[before > times[0]]]))
        return times

    @staticmethod
    def _jumps(timeline: Timeline, times: Floats) -> Floats:
        """Those times at which what has changed has jumped: values were held up to them."""
        return times if steps_only(timeline) else jumps(timeline)

    # --- to joints

    def _to_joints(self, timeline: Timeline) -> None:
        driven = frozenset(t.node for t in timeline.clip.tracks) & self.movers
        solver = self._solver(driven)
        nodes = [node for node in solver.sets if not is_twist(self.rig.notes.get(node))]
        if not solver.steps or not nodes:
            return
        times = self._times(timeline)
        posed = solver.run(sampled(self.rig, timeline.clip, times))
        tracks = [track for node in nodes for track in self._tracks(timeline, times, node, posed.parts[node])]
        self.rig = placed(self.rig, timeline, tracks)
        self._record(timeline, solver, times, tracks, nodes)

    def _tracks(
        self, timeline: Timeline, times: Floats, node: int, parts: Parts, *, rest: Parts | None = None
    ) -> list[Track]:
        """Keys for what is moved of a node: what stays at rest, and nothing drove, gets none."""
        moves, turns = self.bounds
        rest = rest or Posed(self.rig).part(node)
        found = []
        for path, values, still in zip(_PATHS, parts, rest, strict=True):
            bound = {"translation": moves[node], "rotation": turns[node]}.get(
                path, self.options.tolerance / 2
            )
            values = single(_one_way_round(values) if path == "rotation" else values)
            if path != "rotation" and timeline.track(node, path) is None:
                noise = _NOTHING * (1.0 if path == "scale" else self.size)
                if np.abs(values - still).max() <= min(noise, max(float(bound), 1e-30)):
                    continue
            found.append(self._track(timeline, node, path, times, values, float(bound)))
        return found

    def _track(
        self, timeline: Timeline, node: int, path: Path, times: Floats, values: Floats, bound: float
    ) -> Track:
        if len(values) == 1:
            return Track(node, path, "STEP", times[:1], values)
        fresh = np.append(True, (values[1:] != values[:-1]).any(axis=1))
        if fresh.any() and np.isin(times[fresh][1:], self._jumps(timeline, times)).all():
            return Track(node, path, "STEP", times[fresh], values[fresh])
        keys = needed(times, values, bound)
        way: Interpolation = "LINEAR" if len(keys) > 1 else "STEP"
        return Track(node, path, way, times if len(keys) == len(times) else times[keys], values[keys])

    def _rest(self, start: Rig) -> None:
        """Joints at rest where controls at rest were moved, and where constraints put their children."""
        rig = start
        zero = Parts(np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]), np.ones((1, 3)))
        still = Posed(rig)
        moved = set()
        for node in self.movers:
            note = rig.notes[node]
            if note.get("type") == "control" and not rig.is_joint[node]:
                own = still.part(node)
                turned = float(turn_angle(product(conjugate(zero.rotation), own.rotation))[0])
                if (
                    np.abs(own.translation).max() > _NOTHING * self.size
                    or turned > _NOTHING
                    or np.abs(own.scale - 1.0).max() > _NOTHING
                ):
                    moved.add(node)
        solver = self._solver(frozenset(moved))
        if not solver.steps:
            return
        posed = solver.run({})
        translation, rotation, scale = (
            self.rig.translation.copy(),
            self.rig.rotation.copy(),
            self.rig.scale.copy(),
        )
        changed = False
        for node in solver.sets:
            if rig.has_matrix[node] or is_twist(rig.notes.get(node)):
                continue
            was, now = still.part(node), posed.parts[node]
            moves, _ = self.bounds
            if np.abs(now.translation - was.translation).max() > min(
                float(moves[node]), _NOTHING * self.size
            ):
                translation[node], changed = now.translation[0], True
            if float(turn_angle(product(conjugate(was.rotation), now.rotation))[0]) > _NOTHING:
                rotation[node], changed = now.rotation[0], True
            if np.abs(now.scale - was.scale).max() > _NOTHING:
                scale[node], changed = now.scale[0], True
        if changed:
            self.rig = replace(self.rig, translation=translation, rotation=rotation, scale=scale)

    # --- to controls

    def _to_controls(self, timeline: Timeline) -> None:
        solver = self._solver(None)
        times = self._times(timeline)
        tracks: list[Track] = []

        def keep(node: int, parts: Parts) -> Parts:
            """Tracks for a control, and what they say at all times."""
            at_zero = Posed(self.rig).part(node)
            own = self._tracks(timeline, times, node, parts, rest=at_zero)
            tracks.extend(own)
            read = dict(zip(_PATHS, at_zero, strict=True))
            for track in own:
                read[track.path] = track.values if track.times is times else sample(track, times)
            return Parts(read["translation"], unit(read["rotation"]), read["scale"])

        joints = replace(
            timeline,
            clip=replace(
                timeline.clip, tracks=tuple(t for t in timeline.clip.tracks if t.node not in self.movers)
            ),
        )
        parts = sampled(self.rig, joints.clip, times)
        found = matched(solver, parts, keep)
        self.rig = placed(self.rig, timeline, tracks)
        self._record(timeline, solver, times, tracks, sorted(found.controls), self._deviation(found, parts))

    def _deviation(self, found: Matched, parts: Mapping[int, Parts]) -> dict[str, float]:
        """How far the rig that the controls make is off, and what limbs hold beside IK."""
        source = Posed(self.rig, parts)
        joints = np.flatnonzero(self.rig.is_joint).tolist() or sorted(parts)
        far = 0.0
        for joint in joints:
            a, b = found.posed.world(joint), source.world(joint)
            far = max(far, float(np.nan_to_num(length(a[:, 3, :3] - b[:, 3, :3])).max()))
        turn = max((r.turn for r in found.residuals), default=0.0)
        move = max((r.move for r in found.residuals), default=0.0)
        return {
            "deviation": far / self.size,
            "residual_degrees": float(np.degrees(turn)),
            "residual_move": move / self.size,
        }

    def _record(
        self,
        timeline: Timeline,
        solver: Solver,
        times: Floats,
        tracks: Sequence[Track],
        nodes: Sequence[int],
        more: Mapping[str, float] | None = None,
    ) -> None:
        self.report.added.append(
            {
                "type": "clip",
                "clip": timeline.name,
                "to": self.options.to,
                "frames": len(times),
                "nodes": len(nodes),
                "limbs": len(solver.limbs),
                "keys": int(sum(len(track.times) for track in tracks)),
                **(more or {}),
            }
        )


def _one_way_round(turns: Floats) -> Floats:
    """Quaternions, (k, 4), of the signs that keep each next to the one before."""
    both = turns[1:] * turns[:-1]
    ahead = both[:, 0] + both[:, 1] + both[:, 2] + both[:, 3]
    signs = np.cumprod(np.concatenate([[1.0], np.where(ahead < 0, -1.0, 1.0)]))
    return np.asarray(turns * signs[:, np.newaxis])
