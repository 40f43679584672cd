"""The mirror plane between the two sides of a character, in the space of its joints.

That is the space of what holds the skeleton: a USD Skeleton prim, the node above the root joints of a
glTF file. A character that is placed, turned or scaled by it keeps its plane.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rigtri.frames.mirror_modes import Across, Plane, normal_of, pairs
from rigtri.frames.skeleton import ReferencePose, Skeleton
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot, length
from rigtri.model.joint_names import Side
from rigtri.report import Report

# Shares of a character's size: what tools leave of symmetry, what an artist does, and what no one would
# call standing on the plane.
TOLERANCE, LOOSE, AWAY = 1e-4, 1e-2, 1e-1
# An axis this near to one of the world's is that one but for the rounding of rotations.
_SAME_AXIS = 4e-6


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
    x, y, z = normal.tolist()
    across = Across((x, y, z), origin + at * unit)
    return Parting(across, at, own, not requested and at != 0.0, _most(points, across, LOOSE * size))


def _between(points: tuple[Floats, Floats], normal: Floats, origin: float, size: float) -> float:
    """How far from ``origin`` along the normal the middle of most pairs is; 0 where they may lie about it."""
    here, there = points
    if not len(here):
        return 0.0
    middle = float(np.median(dot(here + there, normal))) / 2.0 - origin
    x, y, z = normal.tolist()
    about = Across((x, y, z), origin + middle)
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
