"""Active controls: at rest those whose channels are not zero; in a clip those with keys.

And those posed at rest that have no keys in a clip, of joints that have none there either: these stay as
they are posed.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from rigtri.errors import UsageError
from rigtri.evaluation.pose_cache import PoseCache, sample_parts
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.timelines import Timeline
from rigtri.maths.quaternions import rotation_angle
from rigtri.maths.vectors import length
from rigtri.model.animation import PATHS
from rigtri.model.constraints import constraints_of
from rigtri.model.metadata import ControlRecord
from rigtri.model.rig import Rig
from rigtri.text import and_more

# Channels of controls that differ from zero by less are zero: float32 readers see no difference.
NOTHING = 1e-6


def skeleton_size(rig: Rig) -> float:
    """The diagonal of the box of the joints at rest, of all nodes where there are none, in file units."""
    points = rig.world[rig.is_joint, 3, :3] if rig.is_joint.any() else rig.world[:, 3, :3]
    points = points[np.isfinite(points).all(axis=1)]
    size = float(length(points.max(axis=0) - points.min(axis=0))) if len(points) else 0.0
    return size or 1.0


def controls_and_poles(rig: Rig) -> frozenset[int]:
    """The nodes whose keys make a control active: controls and pole vectors."""
    kinds = ("control", "poleVector")
    return frozenset(rig.nodes_of(*kinds))


def controls_at_work(rig: Rig, timeline: Timeline) -> frozenset[int]:
    """The controls and poles with keys in a timeline, and those posed at rest of joints without any there."""
    keyed = timeline.clip.nodes
    return (keyed & controls_and_poles(rig)) | posed_in(rig, timeline)


def posed_in(rig: Rig, timeline: Timeline) -> frozenset[int]:
    """The controls posed at rest that stay so in a timeline: neither they nor their joints have keys."""
    keyed = timeline.clip.nodes
    posed = moved_at_rest(rig, skeleton_size(rig)) - keyed
    return frozenset(node for node in posed if keyed.isdisjoint(joints_of(rig, [node])))


def joints_of(rig: Rig, controls: Iterable[int]) -> frozenset[int]:
    """The joints that controls are for: each one's own, and those of its limb."""
    records = rig.records(ControlRecord)
    found = (records[node] for node in controls if node in records)
    names = (rig.known(name) for each in found for name in (each.joint, *each.chain))
    return frozenset(joint for joint in names if joint is not None)


def of_one_motion(rig: Rig, chosen: Sequence[Timeline], *, made: bool) -> Sequence[Timeline]:
    """The timelines, where controls have the motion that each asks for; made: they are to get one of each.

    UsageError for several that instances of one character play: controls of a stage have one motion. Those of
    another character, and props that follow it, have it in all of them, and get it in the first.
    """
    several = [each for each in chosen if isinstance(rig.clips[each.members[0]].key, tuple)]
    shared = {k for each in several for k in each.members if sum(k in other.members for other in several) > 1}
    constraints = constraints_of(rig).values()
    keyed = made or any(t.node in controls_and_poles(rig) for k in shared for t in rig.clips[k].tracks)
    if len(several) < 2 or not (keyed or constraints):
        return chosen
    first, *others = several

    def differs(nodes: Iterable[int]) -> bool:
        about = {above for node in nodes for above in rig.path_to_root(node)}
        each = ((n, path, other) for n in about for path in PATHS for other in others)
        return any(first.track(n, path) is not other.track(n, path) for n, path, other in each)

    names = {name for each in rig.records(ControlRecord).values() for name in (each.joint, *each.chain)}
    controlled = differs(node for node in map(rig.known, names) if node is not None)
    following = [each.child for each in constraints if differs((each.child, *each.sources))]
    if not controlled and not following:
        return [each for each in chosen if each not in others]
    one = keyed and controlled
    props = [node for node in following if not rig.is_joint[node]]
    if not one and not props:
        return chosen
    called = [rig.clips[next(k for k in each.members if k not in shared)].name for each in several]
    what = "their controls have" if one else f"'{rig.title(props[0])}', which follows one, has"
    raise UsageError(
        f"Instances of one character play {and_more(called, 4)}, and {what} one motion: "
        f"choose whose with --clip, e.g. --clip {called[0]}"
    )


def moved_at_rest(rig: Rig, size: float) -> frozenset[int]:
    """The controls whose channels are not zero at rest. size: of the rig, in file units."""
    nodes = [node for node in rig.nodes_of("control") if not rig.is_joint[node]]
    if not nodes:
        return frozenset()
    still = PoseCache(rig)
    translation, rotation, scale = map(np.concatenate, zip(*map(still.part, nodes), strict=True))
    moved = np.abs(translation).max(axis=1) > NOTHING * size
    moved |= (rotation_angle(rotation) > NOTHING) | (np.abs(scale - 1.0).max(axis=1) > NOTHING)
    return frozenset(node for node, each in zip(nodes, moved, strict=True) if each)


def pose_at(
    rig: Rig, timeline: Timeline | None, time: float, *, size: float, evaluate: bool = True
) -> PoseCache:
    """The rig at a moment of a timeline, or at rest, one row; ``evaluate``: as what is at work moves it."""
    parts = {} if timeline is None else sample_parts(rig, timeline.clip, np.array([time]))
    if not evaluate:
        return PoseCache(rig, parts)
    at_work = moved_at_rest(rig, size) if timeline is None else controls_at_work(rig, timeline)
    return Solver(rig, at_work).run(parts)
