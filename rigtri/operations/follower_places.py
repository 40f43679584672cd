"""What follows what, and how far off its keys are: each follower against what its metadata says of it.

Rivets, children of constraints, twist joints and pose readers with all that they drive. Only the nodes that
one of them counts from are evaluated, by their keys alone.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import field, replace
from functools import partial
from typing import Any, TypeVar

import numpy as np

from rigtri.errors import RigtriError
from rigtri.evaluation.active_controls import skeleton_size
from rigtri.evaluation.constraint_solver import evaluate_constraint
from rigtri.evaluation.pose_cache import PoseCache, sample_parts
from rigtri.evaluation.pose_readers import PoseReader, weights
from rigtri.evaluation.sampling import key_times, sample, sorted_unique, thinned
from rigtri.evaluation.skinning import SkinnedPoints
from rigtri.evaluation.timelines import Timeline
from rigtri.evaluation.twist_joints import twist_of
from rigtri.evaluation.written_meshes import as_bound_in_file, as_in_file
from rigtri.maths.matrices import multiply
from rigtri.maths.quaternions import angle_between
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import PATHS, Track
from rigtri.model.constraints import Constraint, constraints_of
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import PoseReaderRecord, PoseWeightRecord, Record, RivetRecord, TwistRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_posereader.corrective_joints import driven_paths, joint_tracks

# Of a long clip so many keys are looked at, evenly over it.
_MOST_TIMES = 512
T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class Moments:
    """A rig at some times of a timeline, (f,), or at rest, where it is None; f is 1 there.

    made: what several followers count from, by what it is.
    """

    rig: Rig
    timeline: Timeline | None
    times: Floats
    posed: PoseCache
    made: dict[Hashable, Any] = field(default_factory=dict)

    def local(self, node: int) -> Floats:
        """The local matrices of a node, (f, 4, 4)."""
        return np.broadcast_to(self.posed.local(node), (len(self.times), 4, 4))

    def world(self, node: int) -> Floats:
        """Its world matrices, (f, 4, 4); of −1 the world's own."""
        return np.broadcast_to(self.posed.world(node), (len(self.times), 4, 4))

    def once(self, what: Hashable, make: Callable[[], T]) -> T:
        """What ``make`` makes, which is called for the first follower that needs it."""
        if what not in self.made:
            self.made[what] = make()
        found: T = self.made[what]
        return found


@dataclass(frozen=True, eq=False)
class Follower:
    """What follows by the metadata of the node ``keeper``.

    node: which follows, and is named. own: the nodes whose places follow. needs: all nodes of which its place
    is made, its own among them. off: how far it is from there, in shares of the size, or radians, (f,).
    """

    keeper: int
    node: int
    own: tuple[int, ...]
    needs: frozenset[int]
    off: Callable[[Moments], Floats]

    def measure(self, at: Moments) -> Floats:
        """How far off it is, (f,): inf where its own place is no number, 0 where it cannot be told."""
        try:
            with np.errstate(all="ignore"):
                found = np.broadcast_to(self.off(at), at.times.shape)
        except RigtriError:  # there is nothing to be on any more
            found = np.zeros(at.times.shape)
        found = np.where(np.isfinite(found), found, 0.0)
        for node in self.own:
            found = np.where(np.isfinite(at.local(node)).all(axis=(1, 2)), found, np.inf)
        return found


def off_at_rest(rig: Rig, known: Sequence[Follower]) -> Floats:
    """How far off each of k followers of a rig is at rest, (k,)."""
    at = Moments(rig, None, np.zeros(1), PoseCache(rig))
    return np.array([float(each.measure(at)[0]) for each in known])


def keys_of(timeline: Timeline, one: Follower) -> Floats:
    """The times, (f,), at which a timeline has keys of what a follower is made of."""
    return key_times(timeline.clip, list(one.needs))


def off_in_clip(
    rig: Rig, timeline: Timeline, known: Sequence[Follower], times: Floats | None = None
) -> tuple[Floats, Floats]:
    """Times, (f,), and how far off each of k followers is there, (k, f): 0 where it has no keys.

    times: where to look; all keys of these followers, where they are not too many. There must be some.
    """
    keys = [keys_of(timeline, each) for each in known]
    if times is None:
        times = thinned(sorted_unique(np.concatenate(keys)), _MOST_TIMES)
    # All at once: what they count from is sampled once.
    parts = sample_parts(rig, timeline.clip, times, only=frozenset().union(*(one.needs for one in known)))
    at = Moments(rig, timeline, times, PoseCache(rig, parts))
    rows = [np.where(np.isin(times, own), one.measure(at), 0.0) for one, own in zip(known, keys, strict=True)]
    return times, np.stack(rows)


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
    for made, kind in kinds:
        for node, record in rig.records(kind).items():
            with suppress(RigtriError):  # metadata of what is not there any more
                yield from made(rig, node, record, size)


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
    return Follower(keeper, rule.child, (rule.child,), needs, off)


def _twist(rig: Rig, node: int, record: TwistRecord, size: float) -> Iterator[Follower]:
    twist = twist_of(rig, node, record)
    path, about = twist.path, (twist.path, tuple(twist.rest.tolist()), tuple(twist.axis.tolist()))

    def off(at: Moments) -> Floats:
        # Those along one bone take shares of one twist.
        angles = at.once(about, lambda: twist.angles_of([at.posed.local(each) for each in path]))
        return angle_between(twist.turned(angles), at.posed.part(node).rotation)

    yield Follower(node, node, (node,), frozenset({*path, node}), off)


def _reader(rig: Rig, keeper: int, record: PoseReaderRecord, size: float) -> Iterator[Follower]:
    """The reader, where it has values or drives morph targets, and each joint that it drives."""
    reader, names = PoseReader.of_record(record), [target.name for target in record.targets]
    driver, frame = rig.find(record.driver), rig.find(record.frame) if record.frame else -1
    seen = {target.node: rig.find(target.node) for target in record.targets if target.node}
    values = {
        node: names.index(weight.target)
        for node, weight in rig.records(PoseWeightRecord).items()
        if weight.reader == record.name and weight.target in names
    }

    def read(at: Moments) -> Floats:
        nodes = {address: at.world(node) for address, node in seen.items()}
        return at.once(("reader", keeper), lambda: weights(reader, at.world(driver), at.world(frame), nodes))

    def off(at: Moments) -> Floats:
        found = read(at)
        far = [np.abs(at.local(node)[:, 3, 0] - found[:, column]) for node, column in values.items()]
        far += [np.abs(each) for each in _morphs_off(at, record, names, found)]
        return np.max(np.stack(far), axis=0) if far else np.zeros(len(at.times))

    def joint_off(at: Moments, joint: int) -> Floats:
        # What joints do counts from how they rest, whatever the weights are there.
        if at.timeline is None:
            return np.zeros(1)
        tracks = at.once(("driven", keeper), lambda: [*joint_tracks(rig, record, names, at.times, read(at))])
        far = [_track_off(at, each, size) for each in tracks if each.node == joint]
        return np.asarray(np.max(np.stack(far), axis=0))

    if values or any(output.morph for output in record.outputs):
        needs = _needs(rig, (driver, frame, *seen.values(), *values))
        yield Follower(keeper, keeper, tuple(values), needs, off)
    for joint, paths in driven_paths(record, rig).items():
        if paths:
            needs = _needs(rig, (driver, frame, *seen.values(), joint))
            yield Follower(keeper, joint, (joint,), needs, partial(joint_off, joint=joint))


def _track_off(at: Moments, track: Track, size: float) -> Floats:
    """How far a joint is from the values of a track at the same times, (f,)."""
    here = at.posed.part(track.node)[PATHS.index(track.path)]
    if track.path == "rotation":
        return angle_between(here, track.values)
    # How long in the world what is one long for a node's translation is.
    above = int(at.rig.parents[track.node])
    unit = float(length(at.rig.world[above, 0, :3])) or 1.0 if above >= 0 else 1.0
    return np.asarray(length(here - track.values) / (size / unit if track.path == "translation" else 1.0))


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


def _rivet(rig: Rig, node: int, record: RivetRecord, size: float) -> Iterator[Follower]:
    """Nothing where its mesh has no such triangle any more."""
    node_of_mesh, rows = rig.find(record.mesh), np.array(record.vertices, dtype=np.int64)
    primitives = [each for each in rig.meshes if each.node == node_of_mesh]
    if not 0 <= record.primitive < len(primitives) or len(rows) != 3 or rows.min() < 0:
        return
    mesh = primitives[record.primitive]
    if rows.max() >= len(mesh.points):
        return
    held = SkinnedPoints(as_bound_in_file(rig), as_in_file(mesh, rig), rows)

    def off(at: Moments) -> Floats:
        if at.timeline is None:
            corners = held.at_rest()[np.newaxis]
        else:
            corners = held.sample(held.affecting(at.timeline), at.times)
        a, b, c = record.barycentric
        places = a * corners[:, 0] + b * corners[:, 1] + c * corners[:, 2]
        return np.asarray(length(places - at.world(node)[:, 3, :3]) / size)

    yield Follower(node, node, (node,), _needs(rig, (node, *held.nodes)), off)
