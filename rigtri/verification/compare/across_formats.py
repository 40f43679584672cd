"""Compare rigs of two formats, where whoever converted one says what of it is what of the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from rigtri.evaluation.sampling import Motion as ClipMotion
from rigtri.evaluation.sampling import between_keys, key_times, worlds
from rigtri.frames.rig_size import sizes_of
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.matrices import looking_frames
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.dataclass import dataclass
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.progress import counted
from rigtri.verification.compare.correspondence import Correspondence
from rigtri.verification.compare.deviation import Deviation
from rigtri.verification.compare.probe_selection import box_corners, frames, origins
from rigtri.verification.compare.probes import FramePoints, Probe, SampledPoses, points_of
from rigtri.verification.compare.unit_rotations import denormalisation
from rigtri.verification.compare.verdict import Comparison, Motion

# Matrices and points of so many numbers are evaluated at once.
_BLOCK = 1 << 22
# Times of two formats are one where they are so near, as a share: float32's rounding, in other units.
SAME_TIME = 3e-7
# What changes so many times as fast as before and after is a step, not motion.
STEP = 100.0


@dataclass(frozen=True, eq=False)
class PlayedClip(Clip):
    """A clip of which a format itself says where nodes are. places: from seconds, (f,), the local matrices,
    (f, 4, 4), by node; its tracks hold for all others, and where a matrix is none of numbers.
    """

    places: Callable[[Floats], Mapping[int, Floats]] = lambda seconds: {}


@dataclass(frozen=True, eq=False)
class Converted:
    """Two rigs in the same unit and axes, and what is what. node: (n,), the partner of each node, −1 for
    none.

    shown: (n,), the node that shows what this one shows. clips: what plays at once, times in seconds, the
    first as it is meant to be after the conversion. sources: those of the first as they were, where they
    are others; source_meshes: the same of ``meshes``, none where all are as they were. lost: what has no
    partner, though it should. of_first: nodes that show what they show as the first clip has it alone.
    looking: nodes whose cameras and lights are to stand and look as they do, without their shear and scale.
    """

    before: Rig
    after: Rig
    node: Integers
    shown: Integers
    meshes: Sequence[tuple[Mesh, Mesh]]
    clips: Sequence[tuple[Clip, Clip]]
    sources: Sequence[Clip | None] = ()
    source_meshes: Sequence[tuple[Mesh, Mesh]] = ()
    lost: Sequence[str] = ()
    of_first: frozenset[int] = frozenset()
    looking: frozenset[int] = frozenset()

    @property
    def from_sources(self) -> list[tuple[Clip, Clip]]:
        """``clips``, the first of each as it was before the conversion."""
        sources = [*self.sources, *[None] * (len(self.clips) - len(self.sources))]
        return [(source or clip, other) for source, (clip, other) in zip(sources, self.clips, strict=True)]


@dataclass(frozen=True, eq=False)
class _LookingFrames(FramePoints):
    """Points of the frames of cameras and lights, which before count without shear and scale."""

    def distances(self, poses: SampledPoses) -> Floats:
        world = poses.before.copy()
        world[:, self.nodes[0]] = looking_frames(world[:, self.nodes[0]])
        return super().distances(replace(poses, before=world))


def compare_converted(pair: Converted, *, at_all_keys: bool = False) -> Comparison:
    """Every point of every mesh, frames of cameras and lights, and origins of nodes, at rest and in every
    clip.

    Looked at at the keys of the first, and between and beyond them: the second, which was just made of it,
    has many more where motion is a spline. at_all_keys: at those of the second, too, which may have been
    edited since. What a clip is meant to be, and how a mesh is meant to be skinned, where it is not what it
    was, is `Comparison.motion`.
    """
    sizes = sizes_of(pair.before, [mesh for mesh, _ in pair.meshes])
    found = _measured(pair, sizes, pair.clips, at_all_keys)
    motion = None
    others = [
        one
        for one, (clip, _) in zip(pair.from_sources, pair.clips, strict=True)
        if pair.source_meshes or one[0] is not clip
    ]
    if others or pair.source_meshes:
        moved = _measured(replace(pair, meshes=pair.source_meshes or pair.meshes), sizes, others, at_all_keys)
        motion = Motion(moved.largest, moved.worst, moved.clips)
    return Comparison(
        deviation=found.largest,
        absolute=found.distance,
        diagonal=found.size if found.largest > 0 else float(sizes.max(initial=0.0)) or 1.0,
        raw_deviation=found.largest,
        denormalisation=denormalisation(pair.before),
        worst=found.worst,
        per_mesh=found.owners,
        per_clip=found.clips,
        lost=tuple(pair.lost),
        added=(),
        changed=(),
        different=(),
        poses=found.poses,
        motion=motion,
    )


def _measured(
    pair: Converted, sizes: Floats, clips: Sequence[tuple[Clip, Clip]], at_all_keys: bool
) -> Deviation:
    before, after = pair.before, pair.after
    mine = [mesh for mesh, _ in pair.meshes]
    points = points_of(before, after, pair.meshes)
    none = np.full(len(before.skins), -1), np.full(len(before.clips), -1)
    kinds = []
    for hidden in ([], list(pair.of_first)):
        m = Correspondence(pair.node, pair.shown.copy(), *none, (), (), ())
        m.shown[[*hidden, *pair.looking]] = -1
        nodes = pair.node >= 0
        nodes[hidden] = False
        shown = [*frames(before, m, mine, nodes, sizes), origins(before, m, pair.node >= 0)]
        looking = [node for node in sorted(pair.looking - {*hidden}) if pair.shown[node] >= 0]
        probes: list[Probe] = [*points, *shown, *_looking(pair, looking, sizes)]
        kinds.append([probe for probe in probes if len(probe.titles)])
    found = Deviation(kinds[0], [sizes[probe.placed] for probe in kinds[0]])
    if not kinds[0]:
        return found
    rest = [_worlds(rig, rig.normalised_local) for rig in (before, after)]
    found.add(SampledPoses(rest[0], rest[1], (None, None), np.zeros(1)), "")
    most = max((len(mesh.points) for mesh in mine), default=1)
    block = max(1, _BLOCK // (16 * (len(before) + len(after)) + 8 * most))
    for clip, other in counted(clips, "clips"):
        first = bool(pair.clips) and other is pair.clips[0][1]
        found.probes = kinds[0] if first else kinds[1]
        found.sizes = [sizes[probe.placed] for probe in found.probes]
        if found.probes:
            other = at_keys_of(other, clip)
            keys = key_times(clip)
            if at_all_keys:
                keys = np.union1d(keys, key_times(other))
            _add_clip(found, pair, (clip, other), keys, block)
    return found


def _looking(pair: Converted, nodes: Sequence[int], sizes: Floats) -> Iterator[Probe]:
    if nodes:
        points = box_corners(*(np.outer(sign * sizes[nodes], np.ones(3)) for sign in (-1.0, 1.0)))
        titles = [f"frame of {pair.before.title(node)}" for node in nodes]
        here = np.array(nodes)
        yield _LookingFrames((here, pair.shown[here]), (points, points), titles, [""] * len(nodes))


def _worlds(rig: Rig, local: Floats) -> Floats:
    return worlds(rig, local)[np.newaxis]


def _add_clip(found: Deviation, pair: Converted, clips: tuple[Clip, Clip], keys: Floats, block: int) -> None:
    clip, other = clips
    motions = ClipMotion(pair.before, clip), ClipMotion(pair.after, other)
    times = between_keys(keys)
    times = times[~in_a_step(times, keys)]
    for start in counted(range(0, len(times), block), "moments"):
        some = times[start : start + block]
        # Of rotations that are not unit each side shows what its format does.
        local = [
            motion.locals_at(some, normalised=not rig.rules.raw_quaternions)
            for motion, rig in zip(motions, (pair.before, pair.after), strict=True)
        ]
        if isinstance(clip, PlayedClip):
            for node, matrices in clip.places(some).items():
                known = np.isfinite(matrices).all(axis=(1, 2))
                local[0][known, node] = matrices[known]
        moved = [worlds(rig, each) for rig, each in zip((pair.before, pair.after), local, strict=True)]
        found.add(SampledPoses(moved[0], moved[1], (clip, other), some), clip.name)


def at_keys_of(clip: Clip, other: Clip) -> Clip:
    """A clip whose keys stand exactly where another's do that are there but for rounding."""
    keys, own = key_times(other), key_times(clip)
    known: dict[int, tuple[Booleans, Booleans, Floats]] = {}
    tracks = []
    for track in clip.tracks:
        if id(track.times) not in known:
            known[id(track.times)] = _nearest(track.times, keys, own)
        tracks.append(replace(track, times=_snapped(track, *known[id(track.times)])))
    return replace(clip, tracks=tuple(tracks))


def in_a_step(seconds: Floats, keys: Floats) -> Booleans:
    """Which times, (f,), are between two keys that stand for a step, which takes no time there."""
    if len(keys) < 2:
        return np.zeros(len(seconds), dtype=bool)
    right = np.clip(np.searchsorted(keys, seconds), 1, len(keys) - 1)
    start, end = keys[right - 1], keys[right]
    short = end - start <= SAME_TIME * np.maximum(np.abs(end), 1e-3)
    return np.asarray(short & (seconds > start) & (seconds < end))


def _nearest(times: Floats, keys: Floats, own: Floats) -> tuple[Booleans, Booleans, Floats]:
    """Which times are those of keys but for rounding, which of these are so for a step alone, and the keys.

    own: the key times of the whole clip. (k,) each.
    """
    none = np.zeros(len(times), dtype=bool)
    if not len(keys) or not len(times):
        return none, none, times
    # A key right before a step, which a track that was brought here has, is none that others are near to.
    keys = keys[np.append(np.nextafter(keys[:-1], np.inf) != keys[1:], True)]
    right = np.clip(np.searchsorted(keys, times), 0, len(keys) - 1)
    left = np.maximum(right - 1, 0)
    nearest = np.where(np.abs(times - keys[left]) < np.abs(keys[right] - times), keys[left], keys[right])
    near = np.abs(nearest - times) <= SAME_TIME * np.maximum(np.abs(times), 1e-3)
    # A clip that has a key itself has others beside it where motion is fast, and the last key before a step.
    return near, near & (times != nearest) & np.isin(nearest, own), nearest


def _snapped(track: Track, near: Booleans, beside: Booleans, nearest: Floats) -> Floats:
    """The times of a track, those that are near to keys at these; the first of two is before a step."""
    if beside.any():
        steps = _steps(track)
        near = near & ~(beside & ~np.append(False, steps) & ~np.append(steps, False))
    first = np.append(near[1:] & near[:-1] & (nearest[:-1] == nearest[1:]), False)
    return np.where(near, np.where(first, np.nextafter(nearest, -np.inf), nearest), track.times)


def _steps(track: Track) -> Booleans:
    """Between which keys, (k − 1,), a track changes far faster than before and after them."""
    values = track.values.reshape(len(track.times), -1)
    with np.errstate(divide="ignore", invalid="ignore"):
        speed = np.abs(np.diff(values, axis=0)).max(axis=1) / np.diff(track.times)
    around = np.maximum(np.append(0.0, speed[:-1]), np.append(speed[1:], 0.0))
    return np.asarray(~(speed <= STEP * around))
