"""Mirror modes: twins of the two sides of a character, and how their axes mirror each other.

Rows of R are a frame's axes in the world, M is the reflection. ``behavior``: −R·M, equal rotations of a joint
and its twin mirror the motion (Maya, Unreal, mGear). ``orientation``: R, equal rotations turn both
alike. ``blender``: diag(−1, 1, 1)·R·M, as its X-mirror editing and flipped poses expect.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from rigtri.maths.matrices import from_frame, orthonormal_axes
from rigtri.maths.quaternions import IDENTITY, from_axes
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot
from rigtri.model.joint_names import Side, side, twin
from rigtri.model.rig import Rig

Mirror = Literal["behavior", "orientation", "blender"]
MIRRORS: tuple[Mirror, ...] = ("behavior", "orientation", "blender")
Plane = Literal["yz", "xz", "xy"]
PLANES: tuple[Plane, ...] = ("yz", "xz", "xy")
_BONE = {"left": "right", "right": "left"}


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


def mirrored_axes(axes: Floats, mirror: Mirror, across: Across) -> Floats:
    """The axes (rows, (…, 3, 3)) of the twin of a frame with these axes."""
    if mirror == "behavior":
        return -across.directions(axes)
    if mirror == "blender":
        return np.asarray(np.array([[-1.0], [1.0], [1.0]]) * across.directions(axes))
    return axes


def world_rotation(rig: Rig, node: int) -> Floats:
    """The axes of a node in the world as a rotation, (4,); −1: the world's own."""
    return from_axes(orthonormal_axes(rig.world[node])) if node >= 0 else IDENTITY.copy()


def side_of(rig: Rig, node: int) -> Side:
    """The side of a node by its VRM bone or its name, "" where they say none."""
    return side(_bone(rig, node)) or side(rig.names[node])


def twin_of(rig: Rig, node: int) -> int | None:
    """The node of the other side: of the mirrored VRM bone, else of the one mirrored name."""
    bone = _bone(rig, node)
    for one, other in _BONE.items():
        if bone.startswith(one):
            return rig.humanoid.get(other + bone.removeprefix(one))
    name = rig.names[node]
    other_name = twin(name)
    if other_name == name or not rig.has(other_name):
        return None
    alike = [k for k, known in enumerate(rig.names) if known == other_name]
    same_kind = [k for k in alike if rig.is_joint[k] == rig.is_joint[node]]
    return same_kind[0] if len(same_kind) == 1 else None


def pairs(rig: Rig, nodes: Iterable[int], from_side: Side) -> tuple[dict[int, int], list[int]]:
    """Those of ``nodes`` on a side with their twins, and those that have none."""
    found: dict[int, int] = {}
    alone = []
    for node in nodes:
        if side_of(rig, node) == from_side:
            other = twin_of(rig, node)
            if other is None:
                alone.append(node)
            else:
                found[node] = other
    return found, alone


def _bone(rig: Rig, node: int) -> str:
    return next((bone for bone, known in rig.humanoid.items() if known == node), "")
