"""What follows what, and how far off its keys are: each follower against what its metadata says of it.

Rivets, children of constraints, twist joints and pose readers with all that they drive. Only the nodes that
one of them counts from are evaluated, by their keys alone.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import field, replace
from functools import partial
from typing import Any, TypeVar

import numpy as np

from rigtri.errors import RigtriError
from rigtri.evaluation.active_controls import skeleton_size
from rigtri.evaluation.constraint_solver import Parts, evaluate_constraint
from rigtri.evaluation.pose_cache import PoseCache
from rigtri.evaluation.pose_readers import PoseReader, weights
from rigtri.evaluation.sampling import Motion, key_times, sample, sorted_unique, thinned
from rigtri.evaluation.skinned_points import SkinnedPoints
from rigtri.evaluation.timelines import Timeline
from rigtri.evaluation.twist_joints import twist_of
from rigtri.evaluation.written_meshes import as_bound_in_file, as_in_file
from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import multiply
from rigtri.maths.quaternions import angle_between, unit
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import PATHS, Clip, Track, Tracks
from rigtri.model.constraints import Constraint, constraints_of
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import PoseReaderRecord, PoseWeightRecord, Record, RivetRecord, TwistRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_posereader.corrective_joints import driven_paths, joint_tracks

# Of a long clip so many keys are looked at, evenly over it: of a minute and more at 60 a second all; of those
# that an edit has changed as many.
_MOST_TIMES = 4096
# So many times of short clips are evaluated at once.
_MOST_AT_ONCE = 2048
T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class Moments:
    """A rig at some times, (f,), of timelines, or at rest, where there are none; f is 1 there.

    spans: which times are those of each timeline. made: what several followers count from, by what it is.
    """

    rig: Rig
    spans: Sequence[tuple[Timeline, slice]]
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
    at = Moments(rig, (), np.zeros(1), PoseCache(rig))
    return np.array([float(each.measure(at)[0]) for each in known])


def keys_of(timeline: Timeline, one: Follower) -> Floats:
    """The times, (f,), at which a timeline has keys of what a follower is made of."""
    return key_times(timeline.clip, list(one.needs))


@dataclass(frozen=True, eq=False)
class Look:
    """Where to look at followers: in a timeline, at ``times``, or at all their keys, if not too many.

    keys: the times of each, (f,), as `keys_of`. There must be some. also: says at which of too many to look.
    """

    timeline: Timeline
    known: Sequence[Follower]
    keys: Sequence[Floats]
    times: Floats | None = None
    also: Callable[[], Floats] | None = None

    def at(self) -> Floats:
        """The times to look at, (f,)."""
        if self.times is not None:
            return self.times
        every = sorted_unique(np.concatenate(self.keys))
        if self.also is None or len(every) <= _MOST_TIMES:
            return thinned(every, _MOST_TIMES)
        certain = thinned(np.intersect1d(every, self.also()), _MOST_TIMES)
        return sorted_unique(np.concatenate([thinned(every, _MOST_TIMES), certain]))


# The tracks of a node before and after an edit, where they differ.
Changes = Mapping[int, Sequence[tuple[Track | None, Track | None]]]


def changed_tracks(earlier: Timeline | None, timeline: Timeline, of: Mapping[int, int]) -> Changes | None:
    """The nodes that have not the keys that they had in a clip; None where it is new."""
    if earlier is None:
        return None
    back = {was: node for node, was in of.items()}
    was = {(back.get(t.node, -1), t.path): t for t in earlier.clip.tracks}
    now = {(t.node, t.path): t for t in timeline.clip.tracks}
    changes: dict[int, list[tuple[Track | None, Track | None]]] = {}
    for both in was.keys() | now.keys():
        one, other = was.get(both), now.get(both)
        if one is None or other is None or _identity(one) != _identity(other):
            changes.setdefault(both[0], []).append((one, other))
    return changes


def _identity(track: Track) -> tuple[str, int, int]:
    return track.interpolation, id(track.times), id(track.stored)


def changed_times(changes: Changes) -> Floats:
    """The times of keys that are others than before, or new, or gone, (f,)."""
    found = [np.zeros(0)]
    for one, other in (pair for pairs in changes.values() for pair in pairs):
        if one is None or other is None or one.values.shape[1:] != other.values.shape[1:]:  # or no spline now
            found += [track.times for track in (one, other) if track is not None]
            continue
        _, mine, theirs = np.intersect1d(one.times, other.times, return_indices=True)
        differ = (one.values[mine] != other.values[theirs]).reshape(len(mine), -1).any(axis=1)
        found += [one.times[mine[differ]], np.setxor1d(one.times, other.times)]
    return np.unique(np.concatenate(found))


def off_in_clips(rig: Rig, looks: Sequence[Look]) -> Iterator[tuple[Floats, Floats]]:
    """For each look its times, (f,), and how far off each of its followers is there, (k, f).

    That is 0 where a follower has no keys. Of many short clips most time goes into the number of arrays:
    they are evaluated as one.
    """
    some, count = list[tuple[Look, Floats]](), 0
    for look in looks:
        times = look.at()
        if some and count + len(times) > _MOST_AT_ONCE:
            yield from _off_at_once(rig, some)
            some, count = [], 0
        some.append((look, times))
        count += len(times)
    if some:
        yield from _off_at_once(rig, some)


def _off_at_once(rig: Rig, looks: Sequence[tuple[Look, Floats]]) -> Iterator[tuple[Floats, Floats]]:
    known = {id(each): each for look, _ in looks for each in look.known}
    needs = frozenset[int]().union(*(each.needs for each in known.values()))
    place = np.array([node if node in needs else -1 for node in range(len(rig))])
    motion = Motion(rig, *(_of_nodes(look.timeline.clip, place) for look, _ in looks))
    if any(motion.still) and len(looks) > 1:  # parts cannot say how a node rests in one of these clips
        for one in looks:
            yield from _off_at_once(rig, [one])
        return
    translation, rotation, scale = motion.parts_at(*(times for _, times in looks))
    parts = {
        node: Parts(translation[k], unit(rotation[k]), scale[k])
        for k, node in enumerate(motion.driven.tolist())
    }
    spans, start = list[tuple[Timeline, slice]](), 0
    for look, times in looks:
        spans.append((look.timeline, slice(start, start := start + len(times))))
    at = Moments(rig, spans, np.concatenate([times for _, times in looks]), PoseCache(rig, parts))
    found = {key: each.measure(at) for key, each in known.items()}
    for (look, times), (_, span) in zip(looks, spans, strict=True):
        rows = [
            np.where(np.isin(times, own, assume_unique=True), found[id(each)][span], 0.0)
            for each, own in zip(look.known, look.keys, strict=True)
        ]
        yield times, np.stack(rows)


def _of_nodes(clip: Clip, place: Integers) -> Clip:
    """The motion of some nodes in a clip; place: of these their numbers, of others −1, (n,)."""
    some = (column.moved(place) for column in clip.columns if column.path != "weights")
    return Clip(clip.name, Tracks(column for column in some if column is not None))


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
        if not at.spans:
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
    for output in (each for each in record.outputs if each.morph):
        node = at.rig.find(output.mesh)
        mesh = next((mesh for mesh in at.rig.meshes if mesh.node == node and len(mesh.morphs)), None)
        column = mesh.morph_column(output.morph) if mesh is not None else None
        far = np.zeros(len(at.times))
        for timeline, span in at.spans if column is not None else ():
            if (track := timeline.track(node, "weights")) is not None:
                share = found[span, names.index(output.target)]
                far[span] = sample(track, at.times[span])[:, column] - share
        yield far


def _rivet(rig: Rig, node: int, record: RivetRecord, size: float) -> Iterator[Follower]:
    """Nothing where its mesh has no such triangle any more."""
    shown = rig.find(record.mesh)
    primitives = [each for each in rig.meshes if each.node == shown]
    if not 0 <= record.primitive < len(primitives) or len(record.vertices) != 3:
        return
    mesh = primitives[record.primitive]
    if not all(0 <= vertex < len(mesh.points) for vertex in record.vertices):
        return
    rows = np.array(record.vertices, dtype=np.int64)
    held = SkinnedPoints(as_bound_in_file(rig), as_in_file(mesh, rig), rows)

    def off(at: Moments) -> Floats:
        rows = [held.sample(held.affecting(timeline), at.times[span]) for timeline, span in at.spans]
        corners = np.concatenate(rows) if rows else held.at_rest()[np.newaxis]
        a, b, c = record.barycentric
        places = a * corners[:, 0] + b * corners[:, 1] + c * corners[:, 2]
        return np.asarray(length(places - at.world(node)[:, 3, :3]) / size)

    yield Follower(node, node, (node,), _needs(rig, (node, *held.nodes)), off)
