"""The frame that a pose reader sees its driver from: rotations and directions in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rigtri.errors import GeometryError, UsageError
from rigtri.evaluation.pose_readers import relative
from rigtri.evaluation.sampling import key_times, locals_at, worlds
from rigtri.evaluation.timelines import timeline_and_time
from rigtri.maths.matrices import orthonormal_axes
from rigtri.maths.quaternions import conjugate, from_axes, rotate
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.rig import Rig
from rigtri.report import Report


@dataclass(frozen=True, eq=False)
class ReaderFrame:
    """A driver and the node that it is seen from, ``frame`` (−1: the world)."""

    rig: Rig
    driver: int
    frame: int
    report: Report

    @cached_property
    def resting(self) -> Floats:
        """The driver's rotation in the frame at rest, (4,)."""
        return self._rotation(self.rig.world[np.newaxis])

    def _rotation(self, world: Floats) -> Floats:
        frame = world[:, self.frame] if self.frame >= 0 else np.eye(4)[np.newaxis]
        found = relative(world[:, self.driver], frame)[0]
        if not np.isfinite(found).all():
            raise GeometryError(
                f"'{self.rig.title(self.driver)}' has no axes: a scale on or above it is zero"
            )
        return np.asarray(found)

    def direction_in_frame(self, direction: Sequence[float] | None) -> Floats:
        required = np.array(direction, dtype=np.float64)
        if required.shape != (3,) or not np.isfinite(required).all() or not required.any():
            raise UsageError("a target is a direction other than 0,0,0, a pose or a node")
        if self.frame < 0:
            return normalise(required)
        axes = from_axes(orthonormal_axes(self.rig.world[self.frame]))
        return np.asarray(rotate(conjugate(axes), normalise(required)))

    def rotation_in_pose(self, text: str) -> Floats:
        """The driver's rotation in the frame in a pose, (4,)."""
        timeline, time = timeline_and_time(self.rig, text)
        if timeline is None:
            return self.resting
        keys = key_times(timeline.clip)
        if len(keys) and not keys[0] <= time <= keys[-1]:
            end = keys[0] if time < keys[0] else keys[-1]
            self.report.warn(
                "pose-clamped",
                f"'{text}' lies outside its clip, which runs from {keys[0]:g} to {keys[-1]:g}: its pose is "
                f"that at {end:g}",
            )
        return self._rotation(worlds(self.rig, locals_at(self.rig, timeline.clip, [time])))
