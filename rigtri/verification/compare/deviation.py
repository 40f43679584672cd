"""The largest distances of probes between two rigs, at rest and in every clip: at keys, between and beyond.

Judged on unit rotations, as the formats mean them, and where a format's own viewer
takes quaternions as they are (UsdSkel), on those, too. In glTF they are unit by
specification; what viewers that do not normalise show is kept apart (docs/exactness.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from rigtri.evaluation import sampling
from rigtri.maths.quaternions import norm
from rigtri.model.rig import Rig
from rigtri.verification.compare.changed_nodes import part_of
from rigtri.verification.compare.clip_pairing import joined
from rigtri.verification.compare.correspondence import Correspondence
from rigtri.verification.compare.mesh_probes import MeshPoints
from rigtri.verification.compare.probes import FramePoints, Probe, SampledPoses
from rigtri.verification.compare.verdict import UNIT, Comparison, Worst

# Where quaternions are shown as they are: a rotation doubles their error, and a chain of joints adds it up.
UNIT_AS_SHOWN = 2e-7
# Numbers in one block of matrices: with its temporaries it stays in the cache.
_BLOCK = 1 << 16
# A deep rig is evaluated level by level, so that each step should have some matrices to multiply:
# this many numbers of a level, in a block of at most so many.
_LEVEL, _DEEP_BLOCK = 1 << 11, 1 << 19
# Numbers of the points and morph weights of one mesh at all times of a block: 64 MB.
_POINTS_BLOCK = 1 << 23


@dataclass
class Deviation:
    """The largest distances of ``probes`` so far, in file units."""

    probes: Sequence[Probe]
    worst: Worst | None = None
    largest: float = 0.0
    poses: int = 0
    owners: dict[str, float] = field(default_factory=dict)
    clips: dict[str, float] = field(default_factory=dict)

    def add(self, poses: SampledPoses, clip: str) -> None:
        self.poses += len(poses.times)
        for probe in self.probes:
            distances = probe.distances(poses)
            rows = distances.max(axis=1)
            for owner, row in zip(probe.owners, rows.tolist(), strict=True):
                if owner:
                    self.owners[owner] = max(self.owners.get(owner, 0.0), row)
            largest = float(rows.max())
            if clip:
                self.clips[clip] = max(self.clips.get(clip, 0.0), largest)
            if self.worst is None or largest > self.largest:
                self.largest = largest
                row, time = np.unravel_index(np.argmax(distances), distances.shape)
                self.worst = Worst(probe.titles[int(row)], clip, float(poses.times[time]))


def measure(before: Rig, after: Rig, probes: Sequence[Probe], *, normalised: bool = True) -> Deviation:
    """Evaluate two rigs with the same clips at rest and in each, a block of times at once.

    normalised: take rotations as unit, as glTF means them; else as they are stored.
    """
    found = Deviation([probe for probe in probes if len(probe.titles)])
    if not found.probes:
        return found
    (before, after), found.probes = _needed(before, after, found.probes)
    both, count = joined(before, after), len(before)  # one evaluation costs less than two
    still = sampling.worlds(both, both.normalised_local if normalised else both.local)[np.newaxis]
    found.add(SampledPoses(still[:, :count], still[:, count:], (None, None), np.zeros(1)), "")
    size = min(max(map(_times_at_once, (before, after))), _times_of_points(found.probes))
    for clip, *clips in zip(both.clips, before.clips, after.clips, strict=True):
        motion, times = sampling.Motion(both, clip), sampling.between_keys(sampling.key_times(clip))
        for start in range(0, len(times), size):
            some = times[start : start + size]
            worlds = sampling.worlds(both, motion.locals_at(some, normalised=normalised))
            poses = SampledPoses(worlds[:, :count], worlds[:, count:], (clips[0], clips[1]), some)
            found.add(poses, clip.name)
    return found


def compared(
    before: Rig,
    after: Rig,
    correspondence: Correspondence,
    probes: Sequence[Probe],
    diagonal: float,
    different: Sequence[str],
) -> Comparison:
    """What all probes find in two rigs with the same clips, as a `Comparison`."""
    was, now = denormalisation(before), denormalisation(after)
    found = measure(before, after, probes)
    raw = found.largest
    if max(was, now) > (UNIT_AS_SHOWN if before.rules.raw_quaternions else UNIT):
        raw = measure(before, after, probes, normalised=False).largest
    lost = correspondence.lost
    # Normalising hides it, but a renderer that does not normalise would show it.
    if now > 2.0 * was + UNIT:
        lost = (*lost, f"unit rotations: |q| is off 1 by {now:.2g}, was {was:.2g}")
    return Comparison(
        deviation=found.largest / diagonal,
        absolute=found.largest,
        diagonal=diagonal,
        raw_deviation=raw / diagonal,
        denormalisation=was,
        worst=found.worst,
        per_mesh={name: value / diagonal for name, value in found.owners.items()},
        per_clip={name: value / diagonal for name, value in found.clips.items()},
        lost=lost,
        added=correspondence.added,
        changed=correspondence.changed,
        different=tuple(different),
        poses=found.poses,
        raw_counts=before.rules.raw_quaternions,
    )


def denormalisation(rig: Rig) -> float:
    """The largest | |q|−1 | of a rig's rotations, at rest and at keys; tangents do not count."""
    tracks = [t for clip in rig.clips for t in clip.tracks if t.path == "rotation"]
    keys = [t.values[:, 1] if t.interpolation == "CUBICSPLINE" else t.values for t in tracks]
    off = np.abs(norm(np.concatenate([rig.rotation[~rig.has_matrix], *keys])) - 1.0)
    return float(off[np.isfinite(off)].max(initial=0.0))


def _times_at_once(rig: Rig) -> int:
    """How many times of a clip go into one block."""
    numbers, levels = 16 * max(len(rig), 1), max(len(rig.levels), 1)
    return max(1, max(_BLOCK, min(_DEEP_BLOCK, _LEVEL * levels)) // numbers)


def _times_of_points(probes: Sequence[Probe]) -> int:
    """At how many times the largest of the meshes can be moved at once."""
    meshes = [mesh for probe in probes if isinstance(probe, MeshPoints) for mesh in probe.meshes]
    largest = max((3 * len(mesh.points) + len(mesh.morphs) for mesh in meshes), default=1)
    return max(1, _POINTS_BLOCK // max(largest, 1))


def _needed(before: Rig, after: Rig, probes: Sequence[Probe]) -> tuple[tuple[Rig, Rig], list[Probe]]:
    """The parts of both rigs that the probes depend on, and the probes in their terms."""
    if not all(type(probe) is FramePoints for probe in probes):
        return (before, after), list(probes)
    sides = [np.concatenate([probe.nodes[side] for probe in probes]) for side in (0, 1)]
    (mine, place), (theirs, there) = part_of(before, sides[0]), part_of(after, sides[1])
    points = [probe for probe in probes if isinstance(probe, FramePoints)]
    return (mine, theirs), [replace(p, nodes=(place[p.nodes[0]], there[p.nodes[1]])) for p in points]
