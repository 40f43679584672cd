"""The plane between the two sides of a character, for ``mirror`` and what else mirrors axes.

It is one of the space of the joints: of what holds the skeleton, a USD Skeleton prim or the node above the
root joints of a glTF file. A character that is placed, turned or scaled by it keeps its plane.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from rigtri.errors import GeometryError
from rigtri.frames import Plane
from rigtri.frames.mirroring import PLANES, Across, normal_of
from rigtri.frames.skeleton import ReferencePose, Skeleton
from rigtri.maths.angle_limits import cosine_below
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot, length, triple
from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import Side
from rigtri.recognition.layout_output import direction_text
from rigtri.recognition.recognise import recognise
from rigtri.recognition.sides import twins
from rigtri.report import Report

# Shares of a character's size: what tools leave of symmetry, what an artist does, and what no one would
# call standing on the plane.
TOLERANCE, LOOSE, AWAY = 1e-4, 1e-2, 1e-1
# An axis this near to one of the world's is that one but for the rounding of rotations.
_SAME_AXIS = 4e-6
# A body that faces within this of an axis (a cosine, 15°) is meant to face along it.
_ALONG = cosine_below(15)


@dataclass(frozen=True)
class Parting:
    """A mirror plane: in the world, and where it is on the axis across it in the space in which it was found.

    plane: of that space. own: the space is the character's, not the world. found: plane or ``at`` was found,
    and is another than yz or 0. fits: most pairs of joints lie about it.
    """

    plane: Plane
    across: Across
    at: float
    own: bool
    found: bool
    fits: bool

    @property
    def where(self) -> str:
        """The plane in words."""
        across = "xyz"[int(normal_of(self.plane).argmax())]
        return f"the plane {self.plane} at {across} = {self.at:g}"


def parting(
    tree: Skeleton,
    ref: ReferencePose,
    joints: Sequence[int],
    plane: Plane | None,
    from_side: Side,
    at: float | None = None,
) -> Parting:
    """The plane between the sides of some joints; ``plane`` and ``at`` as requested, or where most pairs lie.

    The world's plane is taken where most pairs lie about that, and not about the character's own. Where they
    lie about none it is that between the sides of the recognised body. Raises GeometryError for a body
    that faces between the axes.
    """
    pairs = twins(tree.rig, joints, from_side)
    points = ref.world[list(pairs), 3, :3], ref.world[list(pairs.values()), 3, :3]
    spaces = [(_space(tree, pairs), True)] + [(np.eye(4), False)] * (at is None)
    planes = PLANES if plane is None else (plane,)
    tried = [
        _tried(space, each, points, ref.extent, at, own=own, found=plane is None and each != PLANES[0])
        for each in planes
        for space, own in spaces
    ]
    fitting = next((each for each in tried if each.fits), None)
    if fitting is not None or plane is not None:
        return fitting or tried[0]
    known = (k for k in recognise(tree.rig).characters if k.gives_axes and any(k.normal))
    body = next((k for k in known if not pairs.keys().isdisjoint(k.bones.values())), None)
    if body is None:
        return tried[0]
    square = [abs(float(dot(np.array(each.across.normal), np.array(body.normal)))) for each in tried]
    if max(square) < _ALONG:
        raise GeometryError(
            f"the body faces {direction_text(body.facing)}, between the axes, so no plane of the coordinates "
            "lies between its sides: let it face an axis (rotate it in a DCC and apply that), or give --plane"
        )
    return tried[square.index(max(square))]


def warn_plane(requested: float | None, parted: Parting, report: Report) -> None:
    """Say where the plane was found, or that there is none; requested: where on its axis."""
    if not parted.fits:
        text = (
            f"The joints of the two sides lie about no {parted.plane} plane: most are over {LOOSE:.0%} of "
            f"the size from their mirror images about {parted.where}. See mirror --check, and name a --pose "
            "in which both sides are alike, or another --plane"
        )
        report.warn("no-mirror-plane", text, geometry=requested is None)
    elif parted.found or not parted.own:
        space = "its own space" if parted.own else "the world"
        report.warn(
            "mirror-plane", f"Most pairs of joints lie about {parted.where} in {space}: mirrored there"
        )


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
    space: Floats,
    plane: Plane,
    points: tuple[Floats, Floats],
    size: float,
    at: float | None,
    *,
    own: bool,
    found: bool,
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
    found = found or (not requested and at != 0.0)
    return Parting(plane, across, at, own, found, _most(points, across, LOOSE * size))


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
