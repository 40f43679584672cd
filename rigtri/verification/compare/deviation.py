"""The largest distances of probes between two rigs, at rest and in every clip: at keys, between and beyond.

Judged on unit rotations, as the formats mean them, and where a format's own viewer
takes quaternions as they are (UsdSkel), on those, too. In glTF they are unit by
specification; what viewers that do not normalise show is kept apart (docs/exactness.md).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import field, replace
from functools import reduce

import numpy as np

from rigtri.evaluation import sampling
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.quaternions import dot
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Clip, Tracks
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.progress import counted
from rigtri.verification.compare.correspondence import Correspondence, timeline
from rigtri.verification.compare.probes import FramePoints, MeshPoints, Probe, SampledPoses, in_few
from rigtri.verification.compare.unit_rotations import UNIT_AS_SHOWN, denormalisation, lost_unit_rotations
from rigtri.verification.compare.verdict import UNIT, Comparison, Worst

# Numbers in one block of matrices: with its temporaries it stays in the cache.
_BLOCK = 1 << 16
# A deep rig is evaluated level by level, so that each step should have some matrices to multiply:
# this many numbers of a level, in a block of at most so many.
_LEVEL, _DEEP_BLOCK = 1 << 13, 1 << 19
# But so many times at once where each level is one joint: else steps grow with the square of its length.
_LEAST_TIMES = 8
# From so many keys on only the widest gaps between them are looked into: so many for each kind of track.
_MANY_KEYS, _GAPS = 2000, 500
# 1 − cos of half a right angle.
_RIGHT_ANGLE = 1.0 - 0.5**0.5
# Numbers of the points and morph weights of one mesh at all times of a block: 64 MB.
_POINTS_BLOCK = 1 << 23


@dataclass
class Deviation:
    """The largest distances of ``probes`` so far, as shares of ``sizes``: of the rows of each, (r,).

    owners, clips: the largest of each, NaN where none could be measured.
    rest: of each row of each probe at rest, (r,) each.
    distance: the one that is the largest share, in file units. size: that of what it is of.
    """

    probes: Sequence[Probe]
    sizes: Sequence[Floats]
    worst: Worst | None = None
    largest: float = 0.0
    distance: float = 0.0
    size: float = 1.0
    poses: int = 0
    owners: dict[str, float] = field(default_factory=dict)
    clips: dict[str, float] = field(default_factory=dict)
    rest: list[Floats] = field(default_factory=list)

    def add(self, poses: SampledPoses, clip: str, part: _Part | None = None) -> None:
        """Measure all probes, or those of a part; first of all at rest, which is no clip."""
        self.poses += len(poses.times)
        probes, sizes = (self.probes, self.sizes) if part is None else (part.probes, part.sizes)
        for probe, size in zip(probes, sizes, strict=True):
            shares = probe.distances(poses) / size[:, np.newaxis]
            rows = np.fmax.reduce(shares, axis=1)
            if not clip:
                self.rest.append(rows)
            for owner, row in zip(probe.owners, rows.tolist(), strict=True):
                if owner:
                    self.owners[owner] = float(np.fmax(self.owners.get(owner, np.nan), row))
            largest = float(np.fmax.reduce(rows))
            if clip:
                self.clips[clip] = float(np.fmax(self.clips.get(clip, np.nan), largest))
            if largest > self.largest or (self.worst is None and not np.isnan(largest)):
                self.largest = largest
                row, time = np.unravel_index(np.nanargmax(shares), shares.shape)
                self.size = float(size[int(row)])
                self.distance = largest * self.size
                self.worst = Worst(probe.titles[int(row)], clip, float(poses.times[time]))

    def add_still(self, clip: str, part: _Part) -> None:
        """What a clip does not move is where it is at rest."""
        for rows, live in zip(self.rest, part.live, strict=True):
            held = float(np.fmax.reduce(rows[~live], initial=np.nan))
            self.clips[clip] = float(np.fmax(self.clips.get(clip, np.nan), held))


@dataclass(frozen=True, eq=False)
class _Part:
    """What of two rigs a clip moves.

    rig: the part that places it. nodes: which nodes of both together those are, (k,); None for all of them.
    probes, sizes: what is to be measured. live: which rows of all probes that is, (r,) each.
    """

    rig: Rig
    nodes: Integers | None
    probes: Sequence[Probe]
    sizes: Sequence[Floats]
    live: Sequence[Booleans]

    @classmethod
    def of(cls, found: Deviation, both: Rig, count: int, clip: Clip) -> _Part:
        """In a crowd each clip moves one character of many."""
        moved = _moved(both, clip)
        weighed = {node for c in clip.columns if c.path == "weights" for node in c.nodes.tolist()}
        live = [_live(probe, moved, count, weighed) for probe in found.probes]
        if all(rows.all() for rows in live):
            return cls(both, None, found.probes, found.sizes, live)
        probes: list[Probe] = []
        sizes: list[Floats] = []
        for probe, size, rows in zip(found.probes, found.sizes, live, strict=True):
            if rows.any():
                probes.append(probe.part(rows) if isinstance(probe, FramePoints) else probe)
                sizes.append(size[rows])
        points = [probe for probe in probes if isinstance(probe, FramePoints | MeshPoints)]
        sides = [side + behind for p in points for side, behind in zip(p.nodes, (0, count), strict=True)]
        kept = sorted(both.with_ancestors(np.concatenate([np.zeros(0, dtype=np.int64), *sides]).tolist()))
        if len(points) < len(probes) or _costs_as_much(kept, both):
            return cls(both, None, probes, sizes, live)
        return cls(
            replace(both, clips=(clip,)).subset(kept)[0], np.array(kept, dtype=np.int64), probes, sizes, live
        )

    def times_at_once(self) -> int:
        """How many times of its clip go into one block."""
        return min(_times_at_once(self.rig), _times_of_points(self.probes))

    def played(self, clip: Clip, step: int) -> list[tuple[sampling.Motion, Floats]]:
        """The clip, ready to be posed, and the times of each block, so many at most."""
        mine, (keys, others) = clip if self.nodes is None else self.rig.clips[0], _moments(clip)
        motions = [(sampling.Motion(self.rig, mine), others)]
        if len(keys):
            motions.append((sampling.Motion(self.rig, _stepped(mine)), keys))
        return [
            (motion, times[start : start + step])
            for motion, times in motions
            for start in range(0, len(times), step)
        ]

    def worlds(self, motion: sampling.Motion, times: Floats, every: int, *, normalised: bool) -> Floats:
        """World matrices of every node, (f, every, 4, 4); of those outside the part any numbers.

        motion: of the part's rig.
        """
        found = sampling.worlds(self.rig, motion.locals_at(times, normalised=normalised))
        if self.nodes is None:
            return found
        # The same order in memory; of rows that nobody writes and reads no memory is taken.
        whole: Floats = np.empty((every, 4, 4, len(times))).transpose(3, 0, 1, 2)
        whole[:, self.nodes] = found
        return whole


def _moved(rig: Rig, clip: Clip) -> Booleans:
    """Which nodes a clip moves, (n,), with all below them."""
    found = np.zeros(len(rig), dtype=bool)
    for column in clip.columns:
        if column.path != "weights":
            found[column.nodes] = True
    return rig.at_or_below(found)


def _live(probe: Probe, moved: Booleans, count: int, weighed: Collection[int]) -> Booleans:
    """Which rows of a probe a clip moves, (r,). weighed: the nodes whose morph weights it drives."""
    if isinstance(probe, FramePoints):
        return np.asarray(moved[probe.nodes[0]] | moved[probe.nodes[1] + count])
    if not isinstance(probe, MeshPoints):
        return np.ones(len(probe.titles), dtype=bool)
    (mine, theirs), (mesh, other) = probe.nodes, probe.meshes
    held = bool(moved[mine].any() or moved[theirs + count].any())
    weighs = mesh.node in weighed or other.node + count in weighed
    return np.full(len(probe.titles), held or weighs)


def measure(
    before: Rig, after: Rig, probes: Sequence[Probe], sizes: Floats, *, normalised: bool = True
) -> Deviation:
    """Evaluate two rigs with the same clips at rest and in each, a block of times at once.

    sizes: of the nodes of ``before``, (n,), in file units (`rig_size.sizes_of`).
    normalised: take rotations as unit, as glTF means them; else as they are stored.
    """
    titled = in_few([probe for probe in probes if len(probe.titles)], most=len(before))
    found = Deviation(titled, [sizes[probe.placed] for probe in titled])
    if not found.probes:
        return found
    (before, after), found.probes = _needed(before, after, found.probes)
    both, count = joined(before, after), len(before)  # one evaluation costs less than two
    still = sampling.worlds(both, both.normalised_local if normalised else both.local)[np.newaxis]
    found.add(SampledPoses(still[:, :count], still[:, count:], (None, None), np.zeros(1)), "")
    block = min(max(map(_times_at_once, (before, after))), _times_of_points(found.probes))
    for clip, *clips in counted([*zip(both.clips, before.clips, after.clips, strict=True)], "clips"):
        part = _Part.of(found, both, count, clip)
        step = block if part.nodes is None else part.times_at_once()
        for motion, some in counted(part.played(clip, step), "moments"):
            worlds = part.worlds(motion, some, len(both), normalised=normalised)
            sides = worlds[:, :count], worlds[:, count:]
            found.add(SampledPoses(*sides, (clips[0], clips[1]), some), clip.name, part)
        found.add_still(clip.name, part)
    return found


def compared(
    before: Rig,
    after: Rig,
    correspondence: Correspondence,
    probes: Sequence[Probe],
    sizes: Floats,
    different: Sequence[str],
    *,
    added: bool = False,
) -> Comparison:
    """What all probes find in two rigs `side_by_side`, as a `Comparison`."""
    before, after = side_by_side(before, after, correspondence, added=added)
    # Of any two files, what only the second has can have lost nothing.
    nodes = np.isin(np.arange(len(after)), correspondence.node) if added else np.ones(len(after), dtype=bool)
    was, now = denormalisation(before), denormalisation(after, nodes)
    found = measure(before, after, probes, sizes)
    raw = found.largest
    as_shown = before.rules.raw_quaternions
    if max(was, now) > (UNIT_AS_SHOWN if as_shown else UNIT):
        raw = measure(before, after, probes, sizes, normalised=False).largest
    return Comparison(
        deviation=found.largest,
        absolute=found.distance,
        diagonal=found.size if found.largest > 0 else float(sizes.max()) if len(sizes) else 1.0,
        raw_deviation=raw,
        denormalisation=was,
        worst=found.worst,
        per_mesh=found.owners,
        per_clip=found.clips,
        lost=(*correspondence.lost, *lost_unit_rotations(was, now, as_shown=as_shown)),
        added=correspondence.added,
        changed=correspondence.changed,
        different=tuple(different),
        poses=found.poses,
        raw_counts=as_shown,
    )


def _moments(clip: Clip) -> tuple[Floats, Floats]:
    """The times at which both rigs are posed in their `joined` clip: its keys, and some between and beyond.

    Apart are those at which all that moves has a key, as far as that is known.

    Between keys that both have, interpolations part the more, the farther it is from one to the next: of a
    clip with a great many the widest gaps tell, and all in which a joint rotates by a right angle.
    """
    keys = sampling.key_times(clip)
    moving = [c for c in clip.columns if c.path != "weights" and len(c.times) > 1]
    if len(keys) <= _MANY_KEYS or not all(
        c.interpolation == "LINEAR" and np.array_equal(c.times, keys) for c in moving
    ):
        return np.zeros(0), sampling.between_keys(keys)
    chosen = np.zeros(len(keys) - 1, dtype=bool)
    for column in moving:
        step = reduce(np.maximum, (_steps(column.path, v) for _, some in column.parts() for v in some))
        chosen[np.argpartition(step, -_GAPS)[-_GAPS:]] = True
        chosen |= (column.path == "rotation") & (step > _RIGHT_ANGLE)
    gaps = np.flatnonzero(chosen & ~sampling.jumps_at(keys))
    inside = [keys[gaps] + share * (keys[gaps + 1] - keys[gaps]) for share in (0.29, 0.5)]
    ends = sampling.between_keys(keys[[0, -1]])[[0, -1]]
    return keys, sampling.sorted_unique(np.concatenate([*inside, ends]))


def _stepped(clip: Clip) -> Clip:
    """A clip that is the same at the keys that all its tracks have, and costs less there: no arcs."""
    some = (c if len(c.times) == 1 else replace(c, interpolation="STEP", tracks={}) for c in clip.columns)
    return replace(clip, tracks=Tracks(some))


def _steps(path: str, values: Floats) -> Floats:
    """How far it is from each key to the next, (k − 1,): of rotations, (k, 4), 1 − cos of half the angle."""
    here, there = values[:-1], values[1:]
    return 1.0 - np.abs(dot(here, there)) if path == "rotation" else length(there - here)


def _times_at_once(rig: Rig) -> int:
    """How many times of a clip go into one block."""
    numbers, levels = 16 * max(len(rig), 1), max(len(rig.levels), 1)
    least = -(-_LEAST_TIMES * levels // max(len(rig), 1))
    return max(least, max(_BLOCK, min(_DEEP_BLOCK, _LEVEL * levels)) // numbers)


def _times_of_points(probes: Sequence[Probe]) -> int:
    """At how many times the largest of the meshes can be moved at once."""
    meshes = [mesh for probe in probes if isinstance(probe, MeshPoints) for mesh in probe.meshes]
    largest = max((3 * len(mesh.points) + len(mesh.morphs) for mesh in meshes), default=1)
    return max(1, _POINTS_BLOCK // max(largest, 1))


def _needed(before: Rig, after: Rig, probes: Sequence[Probe]) -> tuple[tuple[Rig, Rig], list[Probe]]:
    """The parts of both rigs that the probes depend on, and the probes in their terms."""
    points = [probe for probe in probes if isinstance(probe, FramePoints)]
    if len(points) < len(probes):
        return (before, after), list(probes)
    sides = [np.concatenate([probe.nodes[side] for probe in points]) for side in (0, 1)]
    (mine, place), (theirs, there) = _part_of(before, sides[0]), _part_of(after, sides[1])
    return (mine, theirs), [replace(p, nodes=(place[p.nodes[0]], there[p.nodes[1]])) for p in points]


def _part_of(rig: Rig, nodes: Integers) -> tuple[Rig, Integers]:
    """A part of a rig that places ``nodes``, and where each node went, (n,)."""
    kept = sorted(rig.with_ancestors(nodes.tolist()))
    if _costs_as_much(kept, rig):
        return rig, np.arange(len(rig))
    place = np.full(len(rig), -1)
    place[kept] = np.arange(len(kept))
    return rig.subset(kept)[0], place


def _costs_as_much(kept: Sequence[int], rig: Rig) -> bool:
    """Whether to pose the rest of a rig costs less than to leave it out."""
    return 5 * len(kept) >= 4 * len(rig)


def side_by_side(before: Rig, after: Rig, m: Correspondence, *, added: bool = False) -> tuple[Rig, Rig]:
    """Both rigs with the same clips in the same order: what each shows while one of them plays.

    Players choose among the clips of a glTF: one more changes nothing that was there. An animation of a
    USD stage is the pose of what it is bound to at all times, so a new one stands in for what was seen.
    A clip that is idle on one side only is rest there; idle on both sides it is taken for played,
    so that it fits when it will be. added: with what only ``after`` has and plays by itself.
    """
    mine: list[Clip] = []
    theirs: list[Clip] = []
    for k, partner in enumerate(m.clip.tolist()):
        if partner >= 0:
            one, other = before.clips[k], after.clips[partner]
            if one.idle != other.idle:
                one, other = one.without_idle, other.without_idle
            mine.append(replace(one.as_pose, name=one.name or f"#{k}"))
            theirs.append(other.as_pose)
    known = set(m.clip.tolist())
    for k, clip in enumerate(after.clips if added else ()):
        if k in known or timeline(clip) is None or not clip.without_idle.tracks:
            continue
        shown = _instead(before, clip)
        if shown is not None:
            mine.append(replace(shown, name=clip.name or f"#{k}"))
            theirs.append(clip.without_idle)
    return replace(before, clips=tuple(mine)), replace(after, clips=tuple(theirs))


def _instead(rig: Rig, clip: Clip) -> Clip | None:
    """What a rig shows where another plays a clip that this one has not; None if that is never seen.

    Keys without a time are seen where there are none with one: then, and only then.
    """
    of_same = {timeline(c): c.without_idle for c in rig.clips if c.animation == clip.animation}
    if timeline(clip) == "default" and "samples" in of_same:
        return None
    return of_same.get("default", Clip(clip.name, ()))


def joined(before: Rig, after: Rig) -> Rig:
    """All nodes of both as one rig, those of ``after`` behind, and their clips as one each: to be posed."""
    count = len(before)
    behind = count + np.arange(len(after))
    return Rig(
        names=before.names + after.names,
        parents=np.concatenate([before.parents, np.where(after.parents < 0, -1, after.parents + count)]),
        translation=np.concatenate([before.translation, after.translation]),
        rotation=np.concatenate([before.rotation, after.rotation]),
        scale=np.concatenate([before.scale, after.scale]),
        matrix=np.concatenate([before.matrix, after.matrix]),
        has_matrix=np.concatenate([before.has_matrix, after.has_matrix]),
        attachment=np.full(count + len(after), -1),
        keys=before.keys + after.keys,
        labels=before.labels + after.labels,
        clips=tuple(
            Clip(one.name, Tracks([*one.columns, *filter(None, (c.moved(behind) for c in other.columns))]))
            for one, other in zip(before.clips, after.clips, strict=True)
        ),
    )
