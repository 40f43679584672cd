"""take-clips: the motion of an edited file transferred by names and bind poses, and nothing else of it.

Source: docs/take-clips.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.active_controls import skeleton_size
from rigtri.evaluation.adaptive_sampling import without_splines
from rigtri.evaluation.bind_pose import unit_rotations
from rigtri.evaluation.constraint_solver import to_parts
from rigtri.evaluation.key_reduction import key_tolerances, parent_sizes
from rigtri.evaluation.timelines import put_tracks, timelines, without_steps
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import PATHS, Clip, Track, key_values
from rigtri.model.animation import Path as TrackPath
from rigtri.model.rig import Rig
from rigtri.operations.bake.warnings import free_offsets, warn_offset_keys
from rigtri.operations.operation import operation
from rigtri.operations.options.take_clips import TakeClipsOptions as TakeClipsOptions
from rigtri.operations.take_clips.armature_motion import put_back
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.operations.take_clips.bind_space import SHORT
from rigtri.operations.take_clips.bone_tails import BoneTails, with_held_in_place
from rigtri.operations.take_clips.clip_comparison import Comparison
from rigtri.operations.take_clips.clip_matching import ClipNames, Taken
from rigtri.operations.take_clips.crowds import refuse_lost_instances
from rigtri.operations.take_clips.driven_channels import Driven, driven_channels
from rigtri.operations.take_clips.exact_scales import with_exact_scales
from rigtri.operations.take_clips.generated_names import span
from rigtri.operations.take_clips.ik_switches import (
    Switches,
    as_switched,
    follow_controls,
    switches_of,
)
from rigtri.operations.take_clips.key_merging import merged, thinned
from rigtri.operations.take_clips.lost_motion import of_edited, one_character, refuse_lost, without
from rigtri.operations.take_clips.messages import (
    moves,
    warn_overruled,
    warn_tracks,
    why_nothing_matches,
)
from rigtri.operations.take_clips.morph_targets import SAME_WEIGHT
from rigtri.operations.take_clips.motion_check import MotionCheck, Resting, refuse_other_motion
from rigtri.operations.take_clips.node_matching import pairs
from rigtri.operations.take_clips.proportions import Proportions, warn_ik_bones
from rigtri.operations.take_clips.retargeting import rest_parts
from rigtri.operations.take_clips.skeleton_check import checked_bodies
from rigtri.operations.take_clips.still_parents import without_still_parents
from rigtri.operations.take_clips.time_ranges import Ranges
from rigtri.operations.take_clips.track_comparison import MISSED, same_at_keys
from rigtri.operations.take_clips.unkeyed_poses import warn_unkeyed
from rigtri.operations.take_clips.unsure_axes import AxesEvidence
from rigtri.progress import counted
from rigtri.recognition.one_character import of_character
from rigtri.report import Report


@operation(TakeClipsOptions)
def take_clips(rig: Rig, *, options: TakeClipsOptions, report: Report) -> Rig:
    """Put the motion of the rig ``from_`` into the clips of ``rig``; a track that it has not changed stays.

    What was taken of each clip goes to ``report.added``.
    Raises GeometryError (no common names, no clips), NameNotFoundError (a clip), AmbiguousNameError,
    UsageError (several clips for a format that has one), TypeError (``from_`` is no rig).
    """
    start, edited = rig, options.from_
    if edited is None:
        raise TypeError("take_clips: from_ must be a Rig, the one with the motion, not NoneType")
    if options.character is not None and options.character_of(rig) is None:
        edited = of_edited(rig, edited, options.character)
    elif options.character is not None:
        one = replace(options, from_=one_character(rig, edited, options.character), character=None)
        small = of_character(rig, options.character)
        made = take_clips(small, options=one, report=report)
        return rig if made is small else replace(made, names=rig.names)
    edited = without(edited, options.exclude)
    edited = without_splines(edited, skeleton_size(edited)) if rig.rules.linear else edited
    # Where Blender's IK was on or off, as the script of export-blender stores it.
    of = pairs(rig, edited).of
    refuse_lost_instances(rig, edited, of)
    switched = switches_of(rig, edited, of, report)
    edited = with_exact_scales(edited, rig, of, drives=switched.drives)
    if switched.on | switched.off:
        edited = put_back(edited, rig, of, report)
    warn_unkeyed(rig, edited, of, report)
    tails = BoneTails(rig)
    both = Counterparts(rig, edited := with_held_in_place(without_still_parents(edited, rig, of), tails, of))
    if not both.of:
        raise GeometryError(why_nothing_matches(rig, edited))
    names = ClipNames(rig, edited, options.as_, report)
    if not names.theirs:
        raise GeometryError(
            "EDITED has no clips, so there is no motion to take. Export it with its animations"
        )
    every = names.taken(options.clip)
    bodies = checked_bodies(both, every, report)
    axes, resting, moved = AxesEvidence(bodies), Resting(), set[int]()
    taken_all, changed = set[str](), set[str]()
    follow, driven = _moved_in_blender(rig, switched)
    for taken in counted(every, "clips"):
        taking = _Taking(rig, bodies, taken, options.tolerance, follow, driven, tails, report)
        if taking.is_a_pose():
            report.warn(
                "no-length",
                f"'{taken.name}' has no length in EDITED; RIG's clip of that name was left as it is",
            )
            continue
        before, rig = rig, taking.done()
        names.warn_new(taken.name, written=rig is not before)
        taking.refuse_other_motion(rig, axes, resting)
        moved.update(track.node for track in taking.changed)
        taken_all.add(taken.name)
        if rig is not before:
            changed.add(taken.name)
    axes.warn(moved, report)
    warn_ik_bones(bodies, moved, report)
    rig = as_switched(rig, switched, taken_all, changed, report)
    warn_overruled(start, rig, report)
    return rig


def _moved_in_blender(rig: Rig, switched: Switches) -> tuple[frozenset[int], Driven]:
    """What controls, readers and rivets move in a file that the script of export-blender was at work in."""
    follow = follow_controls(rig) if switched.on and not switched.off else frozenset[int]()
    return follow, driven_channels(rig) if switched.drives else Driven()


class _Taking:
    """One clip that is taken.

    follow: what only follows controls in EDITED, and is not taken where nobody has edited one; driven: what
    pose readers and rivets drive there, which is not taken.
    """

    def __init__(
        self,
        rig: Rig,
        bodies: Proportions,
        taken: Taken,
        tolerance: float,
        follow: frozenset[int],
        driven: Driven,
        tails: BoneTails,
        report: Report,
    ) -> None:
        self.rig, self.both, self.taken, self.report = rig, bodies.both, taken, report
        self.follow, self.driven, self.bodies, self.tails = follow, driven, bodies, tails
        self.seen = Comparison(bodies, taken, tolerance)
        self.clock, self.transfer = self.seen.clock, self.seen.transfer
        self.thin = tolerance
        self.changed: list[Track] = []
        self.same = 0
        self.sampled: list[str] = []
        self.kept: list[str] = []
        self.splines: list[tuple[str, TrackPath, float]] = []
        self.ranges: Ranges | None = None
        self.spans: dict[tuple[int, str], tuple[float, float]] = {}  # of EDITED's tracks, in the rig's time

    def done(self) -> Rig:
        """The rig with the clip."""
        home = self.taken.home
        refuse_lost(self.both, self.taken.clip, self.seen.shapes)
        moved = self.seen.nodes
        if home is not None:
            self.ranges = self.seen.settled()
        for node in sorted(moved, key=lambda node: (node in self.follow, node)):
            if node not in self.follow or any(track.node in self.seen.controls for track in self.changed):
                self._take(node)
        left = set(self.both.of).difference(moved)
        for node in sorted({node for node, path in self.seen.tracks if node in left and path in PATHS}):
            self._keep(node, ())
        hidden = free_offsets(self.rig) & self.follow & set(moved) if self.follow else frozenset[int]()
        posed = (track for node in sorted(hidden) for track in self.transfer.of(node).tracks)
        fresh = (track for track in posed if self._old(track.node, track.path) is None)
        warn_offset_keys(self.rig, fresh, self.taken.name, self.report)
        self._take_morphs()
        self._rest_of_joints()
        if home is None:
            rig = self._with_new_clip()
        else:
            self._one_range()
            if self.rig.rules.raw_quaternions:  # of USD, whose samples know no steps
                self.changed = [without_steps(track) for track in self.changed]
            rig = put_tracks(self.rig, home, self.changed) if self.changed else self.rig
        self._warn()
        if rig is not self.rig:
            self.report.reposed = True
        return rig

    def refuse_other_motion(self, rig: Rig, axes: AxesEvidence, resting: Resting) -> None:
        """GeometryError where the clip would not play in ``rig``, the result, as it does in EDITED.

        What it shows of EDITED's axes goes to ``axes``, and of joints that it does not move to ``resting``.
        """
        home = self.taken.home
        played = [
            t
            for t in timelines(rig)
            if (t.name == self.taken.name if home is None else not set(home.members).isdisjoint(t.members))
        ]
        if played and (home is not None or self.changed):
            splines = {name for name, *_ in self.splines}
            left = self.follow | self.driven.nodes | {n for n in self.both.of if self.rig.names[n] in splines}
            check = MotionCheck(self.seen, self.bodies, rig, played[-1].clip, left, resting)
            refuse_other_motion(check, self.kept, self.report)
            before = home.clip if home is not None else Clip("", ())
            axes.look(check.theirs, before, self.clock.times(check.times))

    def is_a_pose(self) -> bool:
        """Whether EDITED has but one moment of a clip that goes on here."""
        home, (start, end) = self.taken.home, span(self.taken.clip)
        ours = span(home.clip) if home is not None else (0.0, 0.0)
        return start == end and ours[0] < ours[1]

    # --- time

    def _one_range(self) -> None:
        """Give what stays of RIG's tracks the range of the clip, where EDITED's has another."""
        if self.ranges is None:
            return
        if self.ranges.whole:
            left = dict(self.seen.tracks)
            for track in self.changed:
                left.pop((track.node, track.path), None)
            for place, track in left.items():
                if (now := self.ranges.fitted(track, self.spans.get(place))) is not track:
                    self.changed.append(now)
        if self.changed and self.ranges.reported:
            self.report.warn("other-range", self.ranges.notice(self.taken.name))

    # --- nodes

    def _take(self, node: int) -> None:
        moved = self.transfer.of(node)
        tracks = [track for track in moved.tracks if (node, track.path) not in self.driven.channels]
        fresh = [now for track in tracks if (now := self._fresh(track)) is not None]
        if fresh and moved.sampled:
            self.sampled.append(self.rig.names[node])
        self.changed += fresh
        self._keep(node, [track.path for track in moved.tracks])

    def _keep(self, node: int, moved: Sequence[str]) -> None:
        """Note a node that moves by keys of ours alone."""
        old = [self._old(node, path) for path in PATHS if path not in moved]
        if any(track is not None and moves(track) for track in old):
            self.kept.append(self.rig.names[node])

    def _old(self, node: int, path: str) -> Track | None:
        return self.seen.tracks.get((node, path))

    def _fresh(self, theirs: Track) -> Track | None:
        """What a track at EDITED's times becomes here; None where the rig has it already."""
        now = self.clock.to_rig_time(theirs)
        raw = self.rig.rules.raw_quaternions
        if raw != self.both.other.rules.raw_quaternions:
            (now,), _ = unit_rotations([now])  # one of the formats would show others as a scale
        self.spans[now.node, now.path] = float(now.times[0]), float(now.times[-1])
        old = self._old(now.node, now.path)
        was = old or Track(now.node, now.path, "STEP", now.times[:1], self._rest(now))
        bound, frames = self._thin(now), raw and not self.rig.is_joint[now.node]
        if was.values.shape[-1] != now.values.shape[-1]:
            return thinned(now, bound, frames=frames)
        now, beside = self.tails.taken_out(was, now, self.seen.tolerances.of(theirs), self.both.size)
        changed, far = self.seen.changes(was, now, theirs)
        if not changed.any():
            self.same += 1
            return None
        if beside:
            names = [self.rig.names[now.node]]
            self.report.warn("beside-bone", f"In '{self.taken.name}' {beside}", names=names)
        if far is not None:
            if now.path == "translation":
                far *= float(parent_sizes(self.rig)[now.node]) / self.both.size
            self.splines.append((self.rig.names[now.node], now.path, far))
            self.same += 1
            return None
        if self.ranges is not None and self.ranges.whole:
            return thinned(now, bound, frames=frames)
        return merged(was, now, changed, missed=MISSED, bound=bound, frames=frames)

    def _thin(self, track: Track) -> float:
        """How far keys of a track that are left out may be off."""
        known = {"translation": self._shares[0], "rotation": self._shares[1]}.get(track.path)
        return float(known[track.node]) if known is not None else self.thin / 2.0

    @cached_property
    def _shares(self) -> tuple[Floats, Floats]:
        return key_tolerances(self.rig, self.thin * self.both.size, self.both.size)

    def _rest(self, track: Track) -> Floats:
        """The rig's values at rest, (1, c)."""
        rig, node = self.rig, track.node
        if track.path == "weights":
            return self.seen.shapes.ours[node].rest[np.newaxis]
        return rest_parts(rig, node)[track.path]

    def _rest_of_joints(self) -> None:
        """Joints where EDITED leaves them without keys, which is not RIG's rest.

        In a new clip all without any; and in every clip whatever carries the whole body, where EDITED has
        keys of any of that: its axes may be others than in RIG, so only all of it together places the body.
        """
        both, start = self.both, np.array([span(self.taken.clip)[0]])
        body = set(self.bodies.carriers)
        carried = body if any(both.of[node] in self.transfer.driven for node in body) else set[int]()
        for node in sorted(both.of):
            theirs = both.of[node]
            joint = self.rig.is_joint[node]
            own = self.transfer.driven.get(theirs, {})
            fresh = self.taken.home is None and not own and (joint or node in body)
            if not (node in carried or fresh) or self.transfer.is_carried(node):
                continue
            parts = to_parts(self.transfer.still(node)[np.newaxis])
            for path, values in zip(PATHS, parts, strict=True):
                if path in own or not np.isfinite(values).all():
                    continue
                if (old := self._old(node, path)) is None:
                    self._add(self._fresh(Track(node, path, "STEP", start, values)))
                elif path == "translation" and joint:
                    self._refuse_elsewhere(old, values[0])

    def _refuse_elsewhere(self, old: Track, place: Floats) -> None:
        """GeometryError where EDITED holds a joint, (3,), where none of RIG's keys is, which would stay."""
        keys, node = key_values(old), old.node
        off = place - np.clip(place, keys.min(axis=0), keys.max(axis=0))
        unit = float(length(self.rig.world[self.rig.parents[node], 0, :3]))
        if float(length(off)) * unit > SHORT * self.both.size:
            above = self.rig.title(self.both.line(node)[2])
            raise GeometryError(
                f"EDITED moves '{above}', but has no location keys of its child '{self.rig.title(node)}', "
                "which it holds where no key of RIG does: RIG's keys would move it away from where "
                f"EDITED has it. Key its location in EDITED, or --clip without '{self.taken.name}'"
            )

    # --- morphs

    def _take_morphs(self) -> None:
        shapes, made = self.seen.shapes, dict[int, Track]()
        for track in (track for track in self.taken.clip.tracks if track.path == "weights"):
            for home in shapes.homes.get(track.node, ()):
                kept, old = self.driven.morphs.get(home, ()), self._old(home, "weights")
                merged = shapes.merged(home, track, old, self.clock.times, kept)
                if home not in made:
                    made[home] = merged
                    self._add(self._fresh(merged))
                elif not same_at_keys(made[home], merged, SAME_WEIGHT):
                    raise GeometryError(
                        f"Several meshes of EDITED are one of RIG, '{self.rig.title(home)}', and their morph "
                        f"targets move differently in '{self.taken.name}': give "
                        f"'{self.both.other.title(track.node)}' the keys of the others"
                    )

    def _add(self, track: Track | None) -> None:
        if track is not None:
            self.changed.append(track)

    # --- the whole

    def _with_new_clip(self) -> Rig:
        if not self.changed:
            return self.rig
        clip = Clip(self.taken.name, tuple(self.changed), self.taken.key)
        rig = self.rig.with_parts(track.node for track in self.changed if track.path != "weights")
        for number, known in enumerate(rig.clips):
            if known.name == clip.name and not known.tracks and clip.key is None:
                filled = replace(known, tracks=clip.tracks)
                return replace(rig, clips=(*rig.clips[:number], filled, *rig.clips[number + 1 :]))
        return replace(rig, clips=(*rig.clips, clip))

    def _warn(self) -> None:
        name, report = self.taken.name, self.report
        warn_tracks(report, name, self.sampled, self.kept, self.splines)
        replaced = [self._old(track.node, track.path) for track in self.changed]
        report.added.append(
            {
                "type": "clip",
                "node": name,
                "new": self.taken.home is None and bool(self.changed),
                "clip": name,
                "from": list(self.taken.parts),
                "changed": sorted({self.rig.title(t.node) for t in self.changed}),
                "tracks": len(self.changed),
                "keys": sum(len(track.times) for track in self.changed),
                "keys_before": sum(len(old.times) for old in replaced if old is not None),
                "same": self.same,
            }
        )
