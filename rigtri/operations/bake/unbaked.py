"""Motion that controls have and joints do not: it would go with the controls."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.active_controls import controls_at_work, moved_at_rest, skeleton_size
from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.curve_refinement import JointCurve
from rigtri.evaluation.pose_cache import PoseCache, sample_parts
from rigtri.evaluation.rig_space import seen_alone
from rigtri.evaluation.sampling import key_times
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.timelines import Timeline, keys_and_between, timelines
from rigtri.limits import TOLERANCE
from rigtri.maths.arrays import Booleans
from rigtri.maths.ranking import largest
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.animation import Path as TrackPath
from rigtri.model.constraints import constraints_of
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import PIVOTS, ControlRecord
from rigtri.model.rig import Rig
from rigtri.operations.controls_check import where_else, why_carried
from rigtri.operations.options.bake import BETWEEN
from rigtri.recognition.joint_tree import helpers
from rigtri.recognition.one_character import about
from rigtri.report import Report
from rigtri.text import and_more

# A joint whose position, as a share of the size, or whose axes differ by more at its own keys from what
# controls do has motion that is not baked. A bake to controls holds keys ten times as well.
UNBAKED = 1e-4
# Three times what a bake leaves where other joints alone have keys: thinned keys add to it.
_BETWEEN_KEYS = 3 * BETWEEN


def refuse_unbaked(rig: Rig, going: Container[int]) -> None:
    """GeometryError where controls move joints at rest or in a clip, and the joints' own keys do not.

    going: joints that are to go themselves, as those of limbs do.
    """
    _refuse(unbaked(rig, going))


def unbaked(rig: Rig, going: Container[int] = ()) -> str:
    """Where controls move joints at rest or in a clip as the joints' own keys do not, in words; "" for none.

    Constraints alone are no motion that somebody has made: they count where controls have keys.
    going: joints that do not count.
    """
    rig, _ = seen_alone(rig)
    size = skeleton_size(rig)
    posed = moved_at_rest(rig, size)
    found = ""
    if posed:
        solver = Solver(rig, posed)
        found = _difference(solver, solver.run({}), PoseCache(rig, {}), "at rest", size, going=going)
    shown: list[str] = []
    for timeline in timelines(rig) if not found else ():
        lost = ""
        if driven := controls_at_work(rig, timeline):
            keys = _Keys(rig, timeline.clip)
            sampled = sample_parts(rig, timeline.clip, keys.times)
            where = f"in clip '{timeline.name}'"
            solver, kept = Solver(rig, driven), PoseCache(rig, sampled)
            there = solver.run(sampled)
            lost = _difference(solver, there, kept, where, size, going=going)
            if lost:
                curve = JointCurve(solver, timeline.clip, size)
                far = curve.apart(there, kept, len(keys.times)).far.max(initial=0.0)
                if far <= _BETWEEN_KEYS * size:
                    lost = _difference(solver, there, kept, where, size, keys=keys, going=going)
        if lost and not isinstance(rig.clips[timeline.members[0]].key, tuple):
            return lost
        shown.append(lost)
    # Of several animations that instances of one character play, controls have the motion of one.
    return found or (shown[0] if shown and all(shown) else "")


def away_from_keys(rig: Rig, timeline: Timeline | None, node: int, times: Floats | None = None) -> Floats:
    """Where controls and constraints have a node in a clip, less where its keys do, worlds, (1 or f, 4, 4).

    timeline: None for the rest pose. times: (f,), those of keys of joints where none are given.
    """
    rig, _ = seen_alone(rig)
    driven = moved_at_rest(rig, skeleton_size(rig)) if timeline is None else controls_at_work(rig, timeline)
    solver = Solver(rig, driven)
    if set(solver.sets).isdisjoint(rig.path_to_root(node)):
        return np.zeros((1, 4, 4))
    sampled: Mapping[int, Parts] = {}
    if timeline is not None:
        sampled = sample_parts(rig, timeline.clip, _times(rig, timeline.clip) if times is None else times)
    return solver.run(sampled).world(node) - PoseCache(rig, sampled).world(node)


def moved_otherwise(
    rig: Rig, timeline: Timeline, taken: frozenset[tuple[int, TrackPath]]
) -> dict[int, float]:
    """How far, as a share of the size, controls move nodes in a clip from where their own keys have them.

    taken: nodes and properties whose keys are asked about. Only of nodes that controls at work in the clip
    move, and only where these keys of a node and of those above it are at once: between keys of one of them,
    joints go otherwise than controls and IK do. Keys of their other properties may lie between these.
    """
    rig, _ = seen_alone(rig)
    driven = controls_at_work(rig, timeline)
    solver = Solver(rig, driven) if driven else None
    if solver is None or not (found := {node for node, _ in taken}.intersection(solver.sets)):
        return {}
    keys = _Keys(rig, timeline.clip)
    sampled = sample_parts(rig, timeline.clip, keys.times)
    kept, posed, size = PoseCache(rig, sampled), solver.run(sampled), skeleton_size(rig)
    return {node: _deviation(kept, posed, node, size, keys.enough(node, taken)) for node in sorted(found)}


@dataclass(frozen=True, eq=False)
class _Keys:
    """Times of a clip, (f,), and where nodes have keys at these."""

    rig: Rig
    clip: Clip

    @cached_property
    def times(self) -> Floats:
        return _times(self.rig, self.clip)

    def where_known(self, node: int) -> Booleans:
        """Where a node and those above it have keys at once, or none before or after, (f,)."""
        tracks = self._moving(node, None)
        keyed = np.concatenate([track.times for track in tracks] or [self.times])
        before, after = self.times < keyed.min(initial=np.inf), self.times > keyed.max(initial=-np.inf)
        return np.asarray(
            self._at_once([np.isin(self.times, track.times) for track in tracks]) | before | after
        )

    def enough(self, node: int, taken: Container[tuple[int, TrackPath]]) -> Booleans:
        """Where the keys of ``taken`` are at once that a node and those above it have, (f,).

        Everywhere where too few keys, less than a quarter, are shared to tell by them: of clips of 30 frames
        a second that were edited at 24, a track may have keys of both.
        """
        keyed = [np.isin(self.times, track.times) for track in self._moving(node, taken)]
        at_once, most = self._at_once(keyed), max(map(np.count_nonzero, keyed), default=0)
        return at_once if 4 * np.count_nonzero(at_once) >= most else np.ones_like(at_once)

    def _at_once(self, keyed: Sequence[Booleans]) -> Booleans:
        found: Booleans = np.logical_and.reduce([np.ones(len(self.times), dtype=bool), *keyed])
        return found

    def _moving(self, node: int, taken: Container[tuple[int, TrackPath]] | None) -> list[Track]:
        line = self.rig.path_to_root(node)
        tracks = (track for track in self.clip.tracks if track.node in line and track.path != "weights")
        return [
            track
            for track in tracks
            if len(track.times) > 2
            and (track.node not in helpers(self.rig) if taken is None else (track.node, track.path) in taken)
        ]


def refuse_replaced(
    before: Rig, after: Rig, timeline: Timeline, times: Floats, size: float, bound: float, report: Report
) -> None:
    """GeometryError where keys of controls move joints, or what is below controls, otherwise.

    times: where both are compared, (f,). bound: by how much, as a share of the size. What constraints make of
    joints is in both; what else follows controls by them is warned of, as where an IK end that its limb did
    not reach is put on its joint.
    """
    (now,) = (each for each in timelines(after) if each.members == timeline.members)
    _refuse_carried(before, after, (timeline, now), times, size)
    driven = controls_at_work(before, timeline)
    if not driven:
        return
    sampled = sample_parts(after, now.clip, times)
    posed = Solver(after, driven | controls_at_work(after, now)).run(sampled)
    was = Solver(before, driven)
    old = was.run(sample_parts(before, timeline.clip, times))
    _refuse(_difference(was, old, posed, f"in clip '{timeline.name}'", size, bound))
    children = {rule.child for rule in constraints_of(before).values()} - before.own
    off = {node: _deviation(old, posed, node, size) for node in sorted(children) if not before.is_joint[node]}
    if off and off[worst := largest(off, lambda node: off[node])] > bound:
        names = and_more([f"'{before.title(node)}'" for node, far in off.items() if far > bound], 6)
        text = (
            f"{names} will move otherwise in clip '{timeline.name}' when constraints are baked, by up to "
            f"{off[worst]:.2g} of the size: controls that they follow are put where their joints are. To "
            "keep that motion, constrain to joints, or bake --to joints and strip"
        )
        report.warn("followers-go-along", text, joint=before.title(worst))


def _refuse_carried(
    before: Rig, after: Rig, timelines: tuple[Timeline, Timeline], times: Floats, size: float
) -> None:
    """GeometryError where what others have put on or below a control moves with its new keys."""
    hung = [node for k in before.own for node in before.children[k] if node not in before.own]
    if not (carried := sorted({*hung, *before.showing})):
        return
    was, now = (
        PoseCache(rig, sample_parts(rig, each.clip, times))
        for rig, each in zip((before, after), timelines, strict=True)
    )
    for node in carried:
        if _deviation(was, now, node, size) > TOLERANCE:
            raise GeometryError(
                f"{why_carried(before, node)}, and that would move otherwise in clip "
                f"'{timelines[0].name}'. In the program that put it there, {where_else(before, node)}; then "
                "bake again"
            )


def refuse_followed(
    rig: Rig, nodes: frozenset[int], name: str, moments: Iterable[Timeline | None], child: int | None = None
) -> None:
    """GeometryError where a character follows another one, which controls move as its own keys do not.

    nodes: those of the character, called ``name``, that is to be evaluated alone. moments: in which clips,
    whole or as that character has them, and None for the rest pose. child: only what moves this node.
    """
    size, whole = skeleton_size(rig), {member: each for each in timelines(rig) for member in each.members}
    every = [None if each is None else whole.get(each.members[0], each) for each in moments]
    line = None if child is None else rig.path_to_root(child)
    for rule in constraints_of(rig).values():
        if not _within(rig, rule.child, nodes) or not (line is None or rule.child in line):
            continue
        for node in rule.sources:
            for timeline in every if not _within(rig, node, nodes) else ():
                if _moves_away(rig, timeline, node, size):
                    where = "at rest" if timeline is None else f"in clip '{timeline.name}'"
                    raise GeometryError(
                        f"'{rig.title(rule.child)}' of {name} follows '{rig.title(node)}', which controls of "
                        f"another character move {where} as its own keys do not. Leave out --character, or "
                        "take that motion to the joints of the other first, with rigtri bake --to joints"
                    )


def _moves_away(rig: Rig, timeline: Timeline | None, node: int, size: float) -> bool:
    """Whether controls move a node as its own keys do not: at keys, or between them by more than a bake."""
    keys = np.zeros(1) if timeline is None else _times(rig, timeline.clip)
    times = keys_and_between(keys)
    away = np.abs(away_from_keys(rig, timeline, node, times)).max(axis=(1, 2))
    bounds = np.where(np.isin(times, keys), UNBAKED, _BETWEEN_KEYS)
    return bool((away > size * bounds).any())


def refuse_leading(rig: Rig, nodes: frozenset[int], name: str, *, every: bool = False) -> None:
    """GeometryError where another character follows controls that move as those of a character get values.

    nodes: those of the character, called ``name``, that is edited alone. every: all its controls get keys,
    not those alone by which IK or FK takes over a limb.
    """
    records = rig.records(ControlRecord)
    limbs = [record.chain for record in records.values() if record.kind == "ik"]
    ends = {joint for chain in limbs for joint in chain}
    taken = {node for node, one in records.items() if every or (one.kind != "root" and one.joint in ends)}
    taken |= {*rig.nodes_of("poleVector"), *(node for node, one in records.items() if one.kind in PIVOTS)}
    why = (
        "moves otherwise once it has keys of its own" if every else "moves otherwise once IK or FK takes over"
    )
    then = "" if every else ", which then warns of how far joints move"
    for rule in constraints_of(rig).values():
        if _within(rig, rule.child, nodes):
            continue
        for node in rule.sources:
            if _within(rig, node, nodes) and not taken.isdisjoint(rig.path_to_root(node)):
                raise GeometryError(
                    f"'{rig.title(rule.child)}' follows '{rig.title(node)}' of {name}, which {why}. Leave "
                    f"out --character{then}, or take the constraint out first"
                )


def _within(rig: Rig, node: int, nodes: frozenset[int]) -> bool:
    """Whether a node is of a character, or built for it; ``nodes``: the character's."""
    return node in nodes or not nodes.isdisjoint(about(rig, node))


def warn_overruled(rig: Rig, timeline: Timeline, solver: Solver, report: Report) -> None:
    """A warning for each joint that a constraint moves in a clip as its own keys do not, and IK will instead.

    solver: with the controls that get keys. rig: as it was before.
    """
    now = Solver(rig, controls_at_work(rig, timeline))
    nodes = sorted(solver.overruled - now.overruled)
    if not nodes:
        return
    sampled = sample_parts(rig, timeline.clip, _times(rig, timeline.clip))
    kept, posed, size = PoseCache(rig, sampled), now.run(sampled), skeleton_size(rig)
    for node in nodes:
        if _deviation(kept, posed, node, size) > UNBAKED:
            name = rig.title(node)
            text = (
                f"'{name}' follows a constraint in clip '{timeline.name}', which does nothing once IK moves "
                "its limb: controls get the motion of its own keys. Take what the constraint does to the "
                "joints first, with rigtri bake --to joints"
            )
            report.warn("constraint-overruled", text, joint=name, geometry=True)


def _times(rig: Rig, clip: Clip) -> Floats:
    """The times, (f,), of the keys of joints, and of all others before those and after them.

    Not those of another character, among whose keys are those of its controls and of what follows it.
    """
    every = key_times(clip)
    without = helpers(rig) | rig.others
    own = [t for t in clip.tracks if t.path != "weights" and t.node not in without]
    keyed = key_times(replace(clip, tracks=tuple(own)))
    before, after = every < keyed.min(initial=np.inf), every > keyed.max(initial=-np.inf)
    found: Floats = every[np.isin(every, keyed) | before | after]
    return found


def _refuse(found: str) -> None:
    """GeometryError about motion that is lost, where there is some."""
    if found:
        raise GeometryError(
            f"{found}: that motion would be lost. Take it to the joints with rigtri bake --to joints first, "
            "or give --discard-motion"
        )


def _difference(
    solver: Solver,
    posed: PoseCache,
    kept: PoseCache,
    where: str,
    size: float,
    bound: float = UNBAKED,
    *,
    keys: _Keys | None = None,
    going: Container[int] = (),
) -> str:
    """Where what a solver makes of a pose, ``posed``, is not what is kept of it, in words; "" where it is.

    keys: of the clip. With these each node counts only where it and those above it have keys at once.
    going: joints that do not count.
    """
    rig = solver.rig
    found = dict[int, float]()
    for node in (node for node in _joints(rig, set(solver.sets) - helpers(rig)) if node not in going):
        rows = None if keys is None else keys.where_known(node)
        if (far := _deviation(kept, posed, node, size, rows)) > bound:
            found[node] = far
    if not found:
        return ""
    worst = largest(found, lambda node: found[node])
    title, far = rig.title(worst), found[worst]
    return f"Controls move '{title}' {where} as its own keys do not ({far:.2g} of the size)"


def _joints(rig: Rig, nodes: Iterable[int]) -> list[int]:
    return sorted(node for node in nodes if rig.is_joint[node] or not rig.is_joint.any())


def _deviation(
    own: PoseCache, posed: PoseCache, node: int, size: float, rows: Booleans | None = None
) -> float:
    """How far a node is from where its own keys have it: its position by the size, or its axes by theirs.

    rows: the frames that count, (f,); all, else.
    """
    kept = own.world(node)
    apart = np.abs(posed.world(node) - kept)
    off = (apart if rows is None or len(apart) == 1 else apart[rows]).max(axis=0, initial=0.0)
    axes = off[:3, :3].max() / (np.abs(kept[:, :3, :3]).max() or 1.0)
    return float(np.nan_to_num(max(off[3, :3].max() / size, axes), nan=np.inf))
