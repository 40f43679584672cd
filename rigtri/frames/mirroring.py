"""Mirroring: twins of the two sides of a character, how their axes mirror each other, and in which plane.

Rows of R are a frame's axes in the world, M is the reflection. ``behavior``: −R·M, equal rotations of a joint
and its twin mirror the motion (Maya, Unreal, mGear). ``orientation``: R, equal rotations turn both
alike. ``blender``: diag(−1, 1, 1)·R·M, as its X-mirror editing and flipped poses expect.

The plane between the sides is one of the space of the joints: of what holds the skeleton, a USD Skeleton
prim or the node above the root joints of a glTF file. A character that is placed, turned or scaled by it
keeps its plane.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Literal, get_args

import numpy as np

from rigtri.frames.skeleton import ReferencePose, Skeleton
from rigtri.maths.matrices import from_frame, orthonormal_axes
from rigtri.maths.quaternions import IDENTITY, from_axes
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot, length, triple
from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import Side, side, twin
from rigtri.model.rig import Rig
from rigtri.report import Report

Mirror = Literal["behavior", "orientation", "blender"]
MIRRORS: tuple[Mirror, ...] = get_args(Mirror)
# What the axes of twins may be, besides: mirrored but for y or z, which is reversed, as both sides have them
# where they follow one rule (orient-joints with the hinge on y or z; ``blender`` is that of x).
Convention = Literal["behavior", "orientation", "blender", "y-reversed", "z-reversed"]
CONVENTIONS: tuple[Convention, ...] = get_args(Convention)
_SIGNS: Mapping[Convention, tuple[float, float, float]] = {
    "behavior": (-1.0, -1.0, -1.0),
    "blender": (-1.0, 1.0, 1.0),
    "y-reversed": (1.0, -1.0, 1.0),
    "z-reversed": (1.0, 1.0, -1.0),
}
Plane = Literal["yz", "xz", "xy"]
PLANES: tuple[Plane, ...] = get_args(Plane)
_BONE = {"left": "right", "right": "left"}
# Shares of a character's size: what tools leave of symmetry, what an artist does, and what no one would
# call standing on the plane.
TOLERANCE, LOOSE, AWAY = 1e-4, 1e-2, 1e-1
# An axis this near to one of the world's is that one but for the rounding of rotations.
_SAME_AXIS = 4e-6


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


def side_of(rig: Rig, node: int) -> Side:
    """The side of a node by its VRM bone or its name, "" where they say none."""
    return side(_bone(rig, node)) or side(rig.names[node])


def twin_of(rig: Rig, node: int) -> int | None:
    """The node of the other side: of the mirrored VRM bone, else of the mirrored name, of the same character.

    Of several of that name it is the one that has most nodes above it in common with this one.
    """
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
    if len(same_kind) > 1:
        above = set(rig.path_to_root(node))
        common = [len(above.intersection(rig.path_to_root(k))) for k in same_kind]
        most = max(common)
        same_kind = [k for k, count in zip(same_kind, common, strict=True) if count == most]
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


@dataclass(frozen=True)
class Parting:
    """A mirror plane: in the world, and where it is on the axis across it in the space in which it was found.

    own: the space is the character's, not the world. found: ``at`` was found, and is not 0.
    fits: most pairs of joints lie about it.
    """

    across: Across
    at: float
    own: bool
    found: bool
    fits: bool


def parting(
    tree: Skeleton, ref: ReferencePose, plane: Plane, from_side: Side, at: float | None = None
) -> Parting:
    """The plane between the sides; ``at`` as asked for, or where it is between most pairs of joints.

    The world's plane is taken where most pairs lie about that, and not about the character's own.
    """
    found, _ = pairs(tree.rig, tree.joints, from_side)
    points = ref.world[list(found), 3, :3], ref.world[list(found.values()), 3, :3]
    own = _tried(_space(tree, found), plane, points, ref.extent, at, own=True)
    if own.fits or at is not None:
        return own
    world = _tried(np.eye(4), plane, points, ref.extent, None, own=False)
    return world if world.fits else own


def warn_plane(plane: Plane, requested: float | None, parted: Parting, report: Report) -> None:
    """Say where the plane was found, or that there is none."""
    where = f"--plane {plane} --plane-at {parted.at:g}"
    if not parted.fits:
        text = (
            f"The joints of the two sides lie about no {plane} plane: most are over {LOOSE:.0%} of the "
            f"size from their mirror images about {where}. See --check; name another plane, or a --pose "
            "in which both sides are alike"
        )
        report.warn("no-mirror-plane", text, geometry=requested is None)
    elif parted.found or not parted.own:
        space = "its own space" if parted.own else "the world"
        report.warn("mirror-plane", f"Most pairs of joints lie about {where} in {space}: mirrored there")


def _space(tree: Skeleton, found: Mapping[int, int]) -> Floats:
    """The world matrix of what holds the root joint of most pairs, (4, 4)."""
    rig = tree.rig
    roots = [tree.root_of[joint] for joint in found] or list(tree.roots)
    above = int(rig.parents[max(dict.fromkeys(roots), key=roots.count)])
    while above in rig.holders:
        above = int(rig.parents[above])
    space = rig.world[above] if above >= 0 else np.eye(4)
    flat = not np.isfinite(space).all() or not length(space[:3, :3]).min() > 0
    return np.eye(4) if flat else space


def _tried(
    space: Floats, plane: Plane, points: tuple[Floats, Floats], size: float, at: float | None, *, own: bool
) -> Parting:
    axis = space[normal_of(plane).argmax(), :3]
    unit = float(length(axis))
    normal = axis / unit
    whole = np.rint(normal)
    normal = whole if np.abs(normal - whole).max() <= _SAME_AXIS else normal
    origin = float(dot(space[3, :3], normal))
    origin = origin if abs(origin) > 1e-6 * size else 0.0
    requested = at is not None
    if at is None:
        at = _between(points, normal, origin, size) / unit
        at = _rounded(at, size / unit)
    across = Across(triple(normal), origin + at * unit)
    return Parting(across, at, own, not requested and at != 0.0, _most(points, across, LOOSE * size))


def _between(points: tuple[Floats, Floats], normal: Floats, origin: float, size: float) -> float:
    """How far from ``origin`` along the normal the middle of most pairs is; 0 where they may lie about it."""
    here, there = points
    if not len(here):
        return 0.0
    middle = float(np.median(dot(here + there, normal))) / 2.0 - origin
    about = Across(triple(normal), origin + middle)
    # A guess that only some pairs bear out has to be far from the plane that everyone expects.
    tight, loose = (_most(points, about, share * size) for share in (TOLERANCE, LOOSE))
    least = TOLERANCE if tight else LOOSE if loose else AWAY
    return middle if abs(middle) > least * size else 0.0


def _most(points: tuple[Floats, Floats], across: Across, least: float) -> bool:
    """Whether more than half of the pairs are that near to each other's mirror images; so it is of none."""
    here, there = points
    off = length(across.points(here) - there)
    return not len(off) or bool(2 * np.count_nonzero(off <= least) > len(off))


def _rounded(at: float, size: float) -> float:
    """A place to a hundred-thousandth of the size, in tens: so that the next run finds the same."""
    if not np.isfinite(size) or size <= 0:
        return at
    return round(at, 5 - int(f"{size:e}".partition("e")[2])) + 0.0
