"""Mirroring: planes, and how the axes of the two sides of a character mirror each other.

Rows of R are a frame's axes in the world, M is the reflection. ``behavior``: −R·M, equal rotations of a joint
and its twin mirror the motion (Maya, Unreal, mGear). ``orientation``: R, equal rotations turn both
alike. ``blender``: diag(−1, 1, 1)·R·M, as its X-mirror editing and flipped poses expect.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, get_args

import numpy as np

from rigtri.frames import Mirror, Plane
from rigtri.maths.matrices import from_frame, orthonormal_axes
from rigtri.maths.quaternions import IDENTITY, from_axes
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig

MIRRORS: tuple[Mirror, ...] = get_args(Mirror)
# What the axes of twins may be, besides: mirrored but for y or z, which is reversed, as both sides have them
# where they follow one rule (orient-joints with the hinge on y or z; ``blender`` is that of x).
Convention = Literal[Mirror, "y-reversed", "z-reversed"]
CONVENTIONS: tuple[Convention, ...] = get_args(Convention)
_SIGNS: Mapping[Convention, tuple[float, float, float]] = {
    "behavior": (-1.0, -1.0, -1.0),
    "blender": (-1.0, 1.0, 1.0),
    "y-reversed": (1.0, -1.0, 1.0),
    "z-reversed": (1.0, 1.0, -1.0),
}
PLANES: tuple[Plane, ...] = get_args(Plane)


def normal_of(plane: Plane) -> Floats:
    """The axis across a plane of the coordinates, (3,)."""
    return np.where(np.arange(3) == {"yz": 0, "xz": 1, "xy": 2}[plane], 1.0, 0.0)


@dataclass(frozen=True)
class Across:
    """A mirror plane of the world: across the unit vector ``normal``, ``at`` from the origin along it."""

    normal: tuple[float, float, float] = (1.0, 0.0, 0.0)
    at: float = 0.0

    def directions(self, directions: Floats) -> Floats:
        """The mirror images of directions, (..., 3)."""
        normal = np.array(self.normal)
        return np.asarray(directions - 2.0 * dot(directions, normal)[..., np.newaxis] * normal)

    def points(self, points: Floats) -> Floats:
        """The mirror images of points, (..., 3)."""
        return self.directions(points) + 2.0 * self.at * np.array(self.normal)

    @property
    def matrix(self) -> Floats:
        """The same for row vectors with 1 behind them, (4, 4)."""
        return from_frame(self.directions(np.eye(3)), self.points(np.zeros(3)))

    def rotation(self, rotation: Floats) -> Floats:
        """The mirror image of a rotation of the world, (4,): the other way about the mirrored axis."""
        return np.concatenate([-self.directions(rotation[:3]), rotation[3:]])


def mirrored_axes(axes: Floats, mirror: Convention, across: Across) -> Floats:
    """The axes (rows, (…, 3, 3)) of the twin of a frame with these axes."""
    if mirror == "orientation":
        return axes
    return np.asarray(np.array(_SIGNS[mirror])[:, np.newaxis] * across.directions(axes))


def world_rotation(rig: Rig, node: int) -> Floats:
    """The axes of a node in the world as a rotation, (4,); −1: the world's own."""
    return from_axes(orthonormal_axes(rig.world[node])) if node >= 0 else IDENTITY.copy()
