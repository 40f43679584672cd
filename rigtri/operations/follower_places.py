"""What follows what, and how far off its keys are: each follower against what its metadata says of it.

Rivets, children of constraints, twist joints and pose readers with all that they drive. Only the nodes that
one of them counts from are evaluated, by their keys alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.errors import RigtriError
from rigtri.evaluation.active_controls import skeleton_size
from rigtri.evaluation.constraint_solver import evaluate_constraint
from rigtri.evaluation.pose_cache import PoseCache, sample_parts
from rigtri.evaluation.pose_readers import PoseReader, weights
from rigtri.evaluation.sampling import key_times, sample, sorted_unique, thinned
from rigtri.evaluation.skinning import SkinnedPoints
from rigtri.evaluation.timelines import Timeline, timelines
from rigtri.evaluation.twist_joints import twist_of
from rigtri.evaluation.written_meshes import as_bound_in_file, as_in_file
from rigtri.maths.matrices import multiply
from rigtri.maths.quaternions import angle_between
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import PATHS
from rigtri.model.constraints import Constraint, constraints_of
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import PoseReaderRecord, PoseWeightRecord, Record, RivetRecord, TwistRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_posereader.corrective_joints import driven_paths, joint_tracks

# Of a long clip so many keys are looked at, evenly over it.
_MOST_TIMES = 512


@dataclass(frozen=True, eq=False)
class Moments:
    """A rig at some times of a timeline, (f,), or at rest, where it is None; f is 1 there."""

    rig: Rig
    timeline: Timeline | None
    times: Floats
    posed: PoseCache

    def local(self, node: int) -> Floats:
        """The local matrices of a node, (f, 4, 4)."""
        return np.broadcast_to(self.posed.local(node), (len(self.times), 4, 4))

    def world(self, node: int) -> Floats:
        """Its world matrices, (f, 4, 4); of −1 the world's own."""
        return np.broadcast_to(self.posed.world(node), (len(self.times), 4, 4))


@dataclass(frozen=True, eq=False)
class Follower:
    """What follows by the metadata of the node ``keeper``.

    node: which follows, and is named. needs: all nodes of which its place is made, its own among them.
    off: how far it is from there, in shares of the size, or radians, (f,).
    """

    keeper: int
    node: int
    needs: frozenset[int]
    off: Callable[[Moments], Floats]

    def worst(self, at: Moments, keys: Floats) -> float:
        """How far off it is at worst at those moments that are among ``keys``; 0 where it cannot be told."""
        try:
            with np.errstate(all="ignore"):
                found = np.broadcast_to(self.off(at), at.times.shape)
        except RigtriError:  # there is nothing to be on any more
            return 0.0
        found = found[np.isin(at.times, keys)]
        return float(np.nan_to_num(found, nan=0.0, posinf=0.0).max(initial=0.0))


def worst(rig: Rig, known: Sequence[Follower]) -> Floats:
    """How far off each of k followers of a rig is at rest, and at its keys in clips, at worst, (2, k)."""
    found = np.zeros((2, len(known)))
    still = Moments(rig, None, np.zeros(1), PoseCache(rig))
    found[0] = [each.worst(still, still.times) for each in known]
    for timeline in timelines(rig) if known else ():
        keys = [key_times(timeline.clip, list(each.needs)) for each in known]
        moved = [k for k, own in enumerate(keys) if len(own)]
        if not moved:
            continue
        # All at once: what they count from is sampled once.
        times = thinned(sorted_unique(np.concatenate(keys)), _MOST_TIMES)
        needs = frozenset[int]().union(*(known[k].needs for k in moved))
        parts = sample_parts(rig, timeline.clip, times, only=needs)
        at = Moments(rig, timeline, times, PoseCache(rig, parts))
        for k in moved:
            found[1, k] = max(found[1, k], known[k].worst(at, keys[k]))
    return found


def followers(rig: Rig) -> Iterator[Follower]:
    """All that follows something in a rig."""
    size = skeleton_size(rig)
    for keeper, rule in constraints_of(rig).items():
        if rule.kind != "polevector" and rule.active:
            yield _child(rig, keeper, rule, size)
    kinds: tuple[tuple[Any, type[Record]], ...] = (
        (_twist, TwistRecord),
        (_reader, PoseReaderRecord),
        (_rivet, RivetRecord),
    )
    for make, kind in kinds:
        for node, record in rig.records(kind).items():
            try:
                made = make(rig, node, record, size)
            except RigtriError:  # metadata of what is not there any more
                continue
            if made is not None:
                yield made


def _needs(rig: Rig, nodes: Iterable[int]) -> frozenset[int]:
    return frozenset(rig.with_ancestors(node for node in nodes if node >= 0))


def _child(rig: Rig, keeper: int, rule: Constraint, size: float) -> Follower:
    above = int(rig.parents[rule.child])

    def off(at: Moments) -> Floats:
        seen = at.world if rule.space == "world" else at.local
        drivers = np.stack([seen(node) for node in rule.drivers], axis=1)
        given = rule
        if rule.weight_nodes:
            shares = [np.maximum(at.local(node)[:, 3, 0], 0.0) for node in rule.weight_nodes]
            given = replace(rule, weights=np.stack(shares, axis=1))
        up = at.world(rule.up_object) if rule.up_object >= 0 else None
        own = at.local(rule.child)
        found = evaluate_constraint(given, drivers, at.world(above), own, up)
        moved = multiply(found, at.world(above))[:, 3, :3] - at.world(rule.child)[:, 3, :3]
        sizes = np.maximum(length(own[:, :3, :3]), length(found[:, :3, :3]))
        turned = length(found[:, :3, :3] - own[:, :3, :3]) / np.where(sizes > 0, sizes, 1.0)
        return np.asarray(np.maximum(length(moved) / size, turned.max(axis=1)))

    needs = _needs(rig, (rule.child, *rule.sources, *rule.weight_nodes))
    return Follower(keeper, rule.child, needs, off)


def _twist(rig: Rig, node: int, record: TwistRecord, size: float) -> Follower:
    twist = twist_of(rig, node, record)

    def off(at: Moments) -> Floats:
        local = np.zeros((len(at.times), len(rig), 4, 4))
        for each in twist.path:
            local[:, each] = at.local(each)
        return angle_between(twist.rotations(local), at.posed.part(node).rotation)

    return Follower(node, node, frozenset({*twist.path, node}), off)


def _reader(rig: Rig, keeper: int, record: PoseReaderRecord, size: float) -> Follower:
    reader, names = PoseReader.of_record(record), [target.name for target in record.targets]
    driver, frame = rig.find(record.driver), rig.find(record.frame) if record.frame else -1
    seen = {target.node: rig.find(target.node) for target in record.targets if target.node}
    values = {
        node: names.index(weight.target)
        for node, weight in rig.records(PoseWeightRecord).items()
        if weight.reader == record.name and weight.target in names
    }
    driven = driven_paths(record, rig)

    def off(at: Moments) -> Floats:
        nodes = {address: at.world(node) for address, node in seen.items()}
        found = weights(reader, at.world(driver), at.world(frame), nodes)
        far = [np.abs(at.local(node)[:, 3, 0] - found[:, column]) for node, column in values.items()]
        # What joints do counts from how they rest, whatever the weights are there.
        tracks = joint_tracks(rig, record, names, at.times, found) if at.timeline is not None else ()
        for track in tracks:
            here = at.posed.part(track.node)[PATHS.index(track.path)]
            if track.path == "rotation":
                far.append(angle_between(here, track.values))
            else:
                long = size / unit(track.node) if track.path == "translation" else 1.0
                far.append(length(here - track.values) / long)
        far += [np.abs(each) for each in _morphs_off(at, record, names, found)]
        return np.max(np.stack(far), axis=0) if far else np.zeros(len(at.times))

    def unit(node: int) -> float:
        """How long in the world what is one long for a node's translation is."""
        above = int(rig.parents[node])
        return float(length(rig.world[above, 0, :3])) or 1.0 if above >= 0 else 1.0

    return Follower(keeper, keeper, _needs(rig, (driver, frame, *seen.values(), *values, *driven)), off)


def _morphs_off(
    at: Moments, record: PoseReaderRecord, names: Sequence[str], found: Floats
) -> Iterator[Floats]:
    """How far the weights of morph targets that a reader drives are from its own, (f,) each."""
    outputs = [each for each in record.outputs if each.morph]
    for output in outputs if at.timeline is not None else ():
        node = at.rig.find(output.mesh)
        mesh = next((mesh for mesh in at.rig.meshes if mesh.node == node and len(mesh.morphs)), None)
        track = at.timeline.track(node, "weights") if at.timeline is not None else None
        column = mesh.morph_column(output.morph) if mesh is not None else None
        if track is not None and column is not None:
            yield sample(track, at.times)[:, column] - found[:, names.index(output.target)]


def _rivet(rig: Rig, node: int, record: RivetRecord, size: float) -> Follower | None:
    """None where its mesh has no such triangle any more."""
    node_of_mesh, rows = rig.find(record.mesh), np.array(record.vertices, dtype=np.int64)
    primitives = [each for each in rig.meshes if each.node == node_of_mesh]
    if not 0 <= record.primitive < len(primitives) or len(rows) != 3 or rows.min() < 0:
        return None
    mesh = primitives[record.primitive]
    if rows.max() >= len(mesh.points):
        return None
    held = SkinnedPoints(as_bound_in_file(rig), as_in_file(mesh, rig), rows)

    def off(at: Moments) -> Floats:
        if at.timeline is None:
            corners = held.at_rest()[np.newaxis]
        else:
            corners = held.sample(held.affecting(at.timeline), at.times)
        a, b, c = record.barycentric
        places = a * corners[:, 0] + b * corners[:, 1] + c * corners[:, 2]
        return np.asarray(length(places - at.world(node)[:, 3, :3]) / size)

    return Follower(node, node, _needs(rig, (node, *held.nodes)), off)
