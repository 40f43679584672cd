"""Weights of a pose reader over time: as many keys as they need, and tracks of values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cached_property

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.adaptive_sampling import adaptive_key_times
from rigtri.evaluation.pose_readers import PoseReader, weights
from rigtri.evaluation.sampling import Motion, worlds
from rigtri.evaluation.timelines import Timeline, just_before, steps_only, times_and_jumps
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Interpolation, Track
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig

# Weights that differ by less stay the same all the time, and get one key.
STILL = 1e-9
# So much of the bound is tested: gaps are, at quarters, and a corner elsewhere in one, such as where a weight
# begins, may be off by a third more than at the nearest of these.
_SEEN = 0.75


@dataclass(frozen=True, eq=False)
class ReaderMotion:
    """The driver, the frame (−1: the world) and the nodes of targets, by address, at given times."""

    rig: Rig
    driver: int
    frame: int
    nodes: Mapping[str, int]

    @cached_property
    def _part(self) -> tuple[Rig, dict[int, int]]:
        """A rig of these nodes and all above them, and the number of each in it."""
        required = self.rig.with_ancestors([self.driver, self.frame, *self.nodes.values()])
        return replace(self.rig, clips=()).subset(sorted(required))

    def affecting(self, timeline: Timeline) -> Timeline:
        """The timeline with only those tracks that can change what is read."""
        number = self._part[1]
        tracks = [t for t in timeline.clip.tracks if t.path != "weights" and t.node in number]
        return replace(timeline, clip=replace(timeline.clip, tracks=tuple(tracks)))

    def weights(self, reader: PoseReader, timeline: Timeline, times: Floats) -> Floats:
        """The weights of the targets, (f, t), at ``times``, (f,), of a timeline of `affecting` tracks."""
        rig, number = self._part
        tracks = tuple(replace(t, node=number[t.node]) for t in timeline.clip.tracks)
        motion = Motion(rig, replace(timeline.clip, tracks=tracks))
        return self._weights(reader, worlds(rig, motion.locals_at(times)), number)

    def weights_at_rest(self, reader: PoseReader) -> Floats:
        """The weights of the targets in the rest pose, (t,)."""
        every = {node: node for node in range(len(self.rig))}
        return np.asarray(self._weights(reader, self.rig.world[np.newaxis], every)[0])

    def _weights(self, reader: PoseReader, world: Floats, number: Mapping[int, int]) -> Floats:
        fixed = np.broadcast_to(np.eye(4), (len(world), 4, 4))
        frame = world[:, number[self.frame]] if self.frame >= 0 else fixed
        nodes = {address: world[:, number[node]] for address, node in self.nodes.items()}
        return weights(reader, world[:, number[self.driver]], frame, nodes)


def reader_keys(
    motion: ReaderMotion,
    reader: PoseReader,
    timeline: Timeline,
    name: str,
    *,
    within: float,
    fps: float | None,
) -> tuple[Floats, Floats]:
    """Times, (k,), and weights, (k, t), of as many keys as they need to be off by ``within`` at most.

    fps: additional keys a second. name: of the reader. GeometryError where too many would be needed.
    """
    rig, moving = motion.rig, motion.affecting(timeline)

    def read(times: Floats) -> Floats:
        return motion.weights(reader, moving, times)

    times = times_and_jumps(moving if moving.clip.tracks else timeline, fps, rig.rules.per_second)
    if not steps_only(moving):
        of = f"'{name}' in clip '{timeline.name}'"
        try:
            times = adaptive_key_times(read, _error, times, within=_SEEN * within, of=of)
        except GeometryError as error:
            raise GeometryError(f"{error}. Or allow more with --between") from None
    found = read(times)
    if np.abs(found - found[0]).max() <= STILL:
        return times[:1], found[:1]
    if steps_only(moving) and not isinstance(rig.clips[timeline.members[0]].key, tuple):
        # Weights are interpolated linearly: a key just before the next one holds each value.
        ends = just_before(times[1:])
        kept = ends > times[:-1]
        together = np.concatenate([times, ends[kept]])
        return np.sort(together), np.concatenate([found, found[:-1][kept]])[np.argsort(together)]
    return times, found


def _error(values: Floats, left: Floats, right: Floats, share: Floats, times: Floats) -> Floats:
    line = left + (right - left) * share[:, np.newaxis]
    return np.asarray(np.abs(values - line).max(axis=1))


def value_tracks(values: Mapping[int, int], times: Floats, found: Floats) -> Iterable[Track]:
    """Translations along x of nodes, ``values`` by target, that are the weights ``found``, (k, t)."""
    way: Interpolation = "LINEAR" if len(times) > 1 else "STEP"
    for column, node in values.items():
        places = np.zeros((len(times), 3))
        places[:, 0] = found[:, column]
        if np.abs(places - places[0]).max() <= STILL:
            yield Track(node, "translation", "STEP", times[:1], places[:1])
        else:
            yield Track(node, "translation", way, times, places)
