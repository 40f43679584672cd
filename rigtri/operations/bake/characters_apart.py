"""Characters that bake by themselves: what one of them does gives the others no keys."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import reduce

import numpy as np

from rigtri.evaluation.curve_refinement import RefinedSamples
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.timelines import Timeline
from rigtri.maths.ranking import largest
from rigtri.model.animation import Track
from rigtri.model.characters import characters
from rigtri.model.constraints import constraints_of
from rigtri.model.rig import Rig
from rigtri.recognition.one_character import about

Nodes = frozenset[int]
# A solver of some controls, and what of a timeline it is for.
Part = tuple[Solver, Timeline]
# Where it was sampled, and its tracks.
Baked = tuple[RefinedSamples, list[Track]]


def characters_apart(
    rig: Rig, timeline: Timeline, at_work: Nodes, solver_of: Callable[[Nodes], Solver]
) -> list[Part]:
    """The controls at work in a timeline, those of each character by themselves; all as one where something
    ties them together: a constraint, or a control that is of two."""
    whole = [(solver_of(at_work), timeline)]
    if len(rig.skins) < 2 or constraints_of(rig):
        return whole
    groups = [frozenset(nodes) for nodes in characters(rig)]
    if len(groups) < 2:
        return whole
    controls: dict[Nodes, set[int]] = {}
    for control in sorted(at_work):
        joints = about(rig, control)
        own = next((group for group in groups if joints and joints <= group), None)
        if own is None:
            return whole
        controls.setdefault(own, set()).add(control)
    parts = [(solver_of(frozenset(own)), group) for group, own in controls.items()]
    used = [group | _used(solver) for solver, group in parts]
    if len(parts) < 2 or any(
        not nodes.isdisjoint(other)
        for (_, group), nodes in zip(parts, used, strict=True)
        for other in groups
        if other != group
    ):
        return whole
    return [
        (solver, _of_nodes(rig, timeline, nodes, group))
        for (solver, group), nodes in zip(parts, used, strict=True)
    ]


def _used(solver: Solver) -> Nodes:
    """The nodes that controls at work read or move, and all above them."""
    steps = [step for step in solver.steps if any(solver.rig.type_of(node) != "twist" for node in step.sets)]
    nodes = [node for step in steps for node in (*step.sets, *step.reads, *step.needs)]
    return frozenset(solver.rig.with_ancestors([*nodes, *(solver.driven or ())]))


def _of_nodes(rig: Rig, timeline: Timeline, nodes: Nodes, joints: Nodes) -> Timeline:
    """What a timeline has of some nodes, called as the clip in which the joints of a character have keys."""
    named = (
        rig.clips[k].name for k in timeline.members if any(t.node in joints for t in rig.clips[k].tracks)
    )
    tracks = tuple(track for track in timeline.clip.tracks if track.node in nodes)
    name = next(named, timeline.clip.name)
    return replace(timeline, clip=replace(timeline.clip, name=name, tracks=tracks))


def moved_nodes(solver: Solver) -> list[int]:
    """The nodes that a solver gives keys; twist joints get theirs afterwards."""
    return [node for node in solver.sets if solver.rig.type_of(node) != "twist"]


def together(baked: Sequence[Baked]) -> Baked:
    """What parts were given as in one run: all samples, the worst of what is between them, and all tracks."""
    samples = [each for each, _ in baked]
    worst = largest(samples, lambda each: each.off)
    times = reduce(np.union1d, [each.times for each in samples])
    limited = any(each.limited for each in samples)
    return worst._replace(times=times, limited=limited), [track for _, made in baked for track in made]
