"""make-limb: an oriented joint chain and its pole vector from points.

Source: "Using Vector Math to Rig an Arm" (makeIkPlaneSetup): one plane normal for all joints of
the limb, each aims at the next, the end has the axes of the one before. A chain keeps its curve, so that
its normal goes from bone to bone by parallel transport.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from rigtri.errors import GeometryError, UsageError
from rigtri.maths.matrices import determinant
from rigtri.maths.ranking import axis_across, first_largest
from rigtri.maths.triangle import axis_of, bend_angle, bend_sine, frame, hinge
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, distance, dot, length, normalise, perpendicular, project, triple
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import LimbRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_polevector import SHAKY, add_polevector, posed
from rigtri.operations.axis_presets import AxisStyle
from rigtri.operations.limb_guides import (
    SIDES,
    OpenDirectionError,
    continued,
    expanded,
    guided,
    in_guides,
    joint_names,
)
from rigtri.operations.limb_hinges import hinge_from, joints_of_limb, transported, up_direction
from rigtri.operations.moved_chain import move_chain
from rigtri.operations.operation import operation
from rigtri.operations.options.make_limb import MakeLimbOptions as MakeLimbOptions
from rigtri.operations.orient_joints.up_direction import crossing
from rigtri.operations.rigtri_nodes import given_name, group, with_record
from rigtri.operations.skin_joints import add_joint, new_skin
from rigtri.recognition.limb_bends import NO_PLANE
from rigtri.recognition.limbs import Limb
from rigtri.report import Report
from rigtri.text import straightness

# Points nearer to each other than this share of the limb are at one place.
ONE_PLACE = 1e-6
# A direction nearer to the chord than this sine says nothing about the side.
ALONG = 0.1
# Parts of unit vectors smaller than this are rounding.
_NOISE = 1e-12

Point = tuple[float, float, float]


@operation(MakeLimbOptions)
def make_limb(rig: Rig, *, options: MakeLimbOptions, report: Report) -> Rig:
    """Place joints at points, orient them, and add a limb's pole vector; a second run moves them.

    The record of each joint goes to ``report.added``, that of the pole vector to ``report.limbs``.
    Raises UsageError (a single point, a name that is taken), NameNotFoundError, and
    GeometryError where points coincide, or lie on a line and nothing says the side or what is up.
    """
    if options.guides is not None or options.guide_nodes is not None:
        limbs = list(guided(rig, options))
        for each in limbs:
            try:
                rig = _made(rig, each, report, continued(rig, each, limbs))
            except GeometryError as error:
                raise in_guides(error, options, each) from None
        return rig
    return _made(rig, options, report)


def _made(rig: Rig, options: MakeLimbOptions, report: Report, below: MakeLimbOptions | None = None) -> Rig:
    """The rig with one limb or chain. below: the limb that continues it, which is made after it."""
    options = expanded(rig, options)
    given_name(rig, options.name, report)
    for name in options.names:
        given_name(rig, name, report, "--names")
    shape = _shape(rig, options, report, below)
    known = joints_of_limb(rig, _title(options))
    if known:
        rig, joints = _update(rig, known, shape, options, report)
    else:
        rig, joints = _build(rig, shape, options, report)
    for part, node in enumerate(joints):
        rig = with_record(rig, node, _limb_record(rig, joints, part, shape, options))
    for part, node in enumerate(joints):
        report.added.append(_record(rig, node, shape, part, new=not known))
    if options.with_pole:
        limb = Limb(joints[0], joints[shape.middle], joints[-1])
        # Where the points themselves show no side, their joints, rounded, must not show one either.
        bends = {rig.address(limb.middle): triple(shape.side)} if shape.source == "given" else {}
        pole_options = replace(options.placement, limb=(limb,), chain=(), limbs=None, bend=bends)
        rig = add_polevector(rig, options=pole_options, report=report)
    return rig


def _title(options: MakeLimbOptions) -> str:
    """What the limb is called, by which a second run finds it."""
    return options.name + SIDES[options.side or ""]


@dataclass(frozen=True, eq=False)
class _Shape:
    """Where the joints stand and how.

    points, axes: (n, 3) and (n, 3, 3), rows, in the world. moved: (n,), how far --planar moved each.
    middle: the joint at which the limb bends. hinge, side: unit vectors, (3,): a positive turn about
    the one bends it, towards the other. source: ``pose``, by the points, or ``given``.
    """

    points: Floats
    axes: Floats
    moved: Floats
    middle: int
    hinge: Floats
    side: Floats
    source: str


def _shape(
    rig: Rig, options: MakeLimbOptions, report: Report, below: MakeLimbOptions | None = None
) -> _Shape:
    points = _points(rig, options)
    titles = options.locators or tuple(map(_written, options.points))
    size = sum(distance(points[:-1], points[1:]).tolist())
    _refuse_one_place(points, titles, size, chord=not options.is_chain)
    middle = _middle(points) if len(points) > 2 else 0
    if options.is_chain and (found := _chain_plane(rig, points, options, below)):
        normal, side, source = found
    else:
        normal, side, source = _plane(points[[0, middle, -1]], options, report)
    moved = np.zeros(len(points))
    if options.planar:
        off = dot(points - points[0], normal)
        off[[0, -1]] = 0.0
        off[middle] = 0.0 if source == "pose" else off[middle]  # it says where the plane is
        points = points - off[:, np.newaxis] * normal
        moved = np.abs(off)
        _refuse_one_place(points, titles, size)
    return _Shape(points, _axes(rig, points, normal, options, report), moved, middle, normal, side, source)


def _points(rig: Rig, options: MakeLimbOptions) -> Floats:
    """Where the joints are to stand, (n, 3): the points, or the locators in their pose."""
    places = options.points or [_read(rig, name, options.pose) for name in options.locators]
    return np.array(places, dtype=np.float64)


def _read(rig: Rig, name: str, pose: str) -> Floats:
    return np.asarray(posed(rig, pose).position(rig.find(name, "locator")))


def _written(point: Point) -> str:
    return ",".join(f"{number:g}" for number in point)


def _refuse_one_place(points: Floats, titles: Sequence[str], size: float, *, chord: bool = True) -> None:
    near = np.flatnonzero(~(distance(points[:-1], points[1:]) > ONE_PLACE * size))
    if len(near):
        one, other = titles[near[0]], titles[near[0] + 1]
        raise GeometryError(f"{one} and {other} are at one place, so there is no bone between them")
    if chord and not distance(points[0], points[-1]) > ONE_PLACE * size:
        ends = f"{titles[0]} and {titles[-1]}"
        raise GeometryError(f"{ends}, root and end, are at one place: there is no root-to-end line")


def _middle(points: Floats) -> int:
    """The inner point farthest from the chord, where the limb bends."""
    off = distance(points[1:-1], project(points[1:-1], points[0], points[-1]))
    return 1 + first_largest(off)


def _chain_plane(
    rig: Rig, points: Floats, options: MakeLimbOptions, below: MakeLimbOptions | None
) -> tuple[Floats, Floats, str] | None:
    """As `_plane`, of a chain: the mean plane of its triples, each as large as its triangle and turned the
    way of those before; where they have none, that of a limb beside it, or a direction of the world.
    None: --bend has to say it."""
    size = sum(distance(points[:-1], points[1:]).tolist())
    bones, normal = points[1:] - points[:-1], np.zeros(3)
    for one, other in pairwise(bones):
        found = cross(one, other)
        normal = normal + np.where(dot(found, normal) < 0, -1.0, 1.0) * found
    line = bones[0]
    if length(normal) > NO_PLANE * size * size:
        return normalise(normal), normalise(cross(line, normal)), "pose"
    if options.bend is not None:
        return None
    if not options.style.world and options.style.up_from in ("plane", "pole"):
        above = _hinge_beside(rig, line, options, below)
        if above is not None:
            return above, normalise(cross(line, above)), "given"
        raise OpenDirectionError(
            f"The points of {_title(options)} lie on a line, which leaves the up direction open. Give it "
            "with --up-from world:+y, or --bend 0,0,1 or another direction across it"
        )
    up = np.eye(3)[1] if options.style.world else up_direction(line, normal, options.style.up_from)
    if not crossing(up, line):
        up = axis_across(line)
    normal = normalise(perpendicular(up, line))
    return normal, normalise(cross(line, normal)), "given"


def _hinge_beside(
    rig: Rig, line: Floats, options: MakeLimbOptions, below: MakeLimbOptions | None
) -> Floats | None:
    """The hinge that a straight chain has from the limb that continues it, an earlier run, or its parent."""
    if below is not None:
        try:
            shape = _shape(rig, below, Report())
        except OpenDirectionError:
            pass
        else:
            hinge = transported(shape.hinge, shape.points[1] - shape.points[0], line)
            return hinge if crossing(hinge, line) else None
    known = joints_of_limb(rig, _title(options))
    parent = rig.find(options.parent, "parent") if options.parent is not None else -1
    return hinge_from(rig, known[0] if known else parent, line)


def _plane(triple: Floats, options: MakeLimbOptions, report: Report) -> tuple[Floats, Floats, str]:
    """The hinge, the side the limb bends to, and where they are from: the points, else --bend."""
    chord = normalise(triple[2] - triple[0])
    sine, degrees = float(bend_sine(*triple)), float(np.degrees(bend_angle(*triple)))
    if sine >= NO_PLANE:
        if sine < SHAKY:
            text = f"{_title(options)} is {straightness(degrees)}: the bend direction is not reliable."
            report.warn("nearly-straight", text, joint=_title(options), geometry=True)
        if options.bend is not None:
            text = f"--bend is for points on a line; those of {_title(options)} bend by {degrees:.4g}°."
            report.warn("bend-not-needed", text, joint=_title(options))
        normal = hinge(*triple)
        return normal, cross(chord, normal), "pose"
    if options.bend is None:
        raise OpenDirectionError(
            f"The points of {_title(options)} lie on a line, which leaves the bend direction open"
            f"{', also with --up-from' * (options.style.up_from not in ('plane', 'pole'))}. Give it with "
            "--bend 0,0,1 or another direction across it"
        )
    side = perpendicular(normalise(np.array(options.bend, dtype=np.float64)), chord)
    if not length(side) > ALONG:
        raise GeometryError(
            f"--bend {_written(options.bend)}: the direction runs along the limb; give one across it"
        )
    side = normalise(side)
    return normalise(cross(side, chord)), side, "given"


def _axes(rig: Rig, points: Floats, normal: Floats, options: MakeLimbOptions, report: Report) -> Floats:
    """The world axes of the joints as rows, (n, 3, 3): each aims at the next, all with one hinge."""
    style = options.style
    if style.world:
        return np.tile(np.eye(3), (len(points), 1, 1))
    aims = list(points[1:] - points[:-1])
    if options.end_aim is not None:
        aims.append(_end_point(rig, options.end_aim, options.pose) - points[-1])
        if not length(aims[-1]) > ONE_PLACE * float(length(points[-1] - points[0])):
            raise GeometryError("--end-aim: the end joint is at this position, so it cannot aim at it")
    found = []
    for part, aim in enumerate(aims):
        if options.is_chain:
            normal = transported(normal, aims[max(part - 1, 0)], aim)
        up = up_direction(aim, normal, style.up_from)
        if not crossing(up, aim):
            text = f"Joint {part + 1} of {_title(options)} points along {style.up_from}; its plane says up."
            report.warn("up-along-bone", text, geometry=True)
            up = normal
        if not crossing(up, aim):
            raise GeometryError("--end-aim: the end joint would aim along the limb's hinge; aim it elsewhere")
        found.append(frame(aim, up, aim_axis=style.aim, up_axis=style.up))
    return np.array([*found, *[found[-1]] * (len(points) - len(found))])


def _end_point(rig: Rig, end_aim: str | Point, pose: str) -> Floats:
    if isinstance(end_aim, str):
        return _read(rig, end_aim, pose)
    return np.array(end_aim, dtype=np.float64)


def _build(rig: Rig, shape: _Shape, options: MakeLimbOptions, report: Report) -> tuple[Rig, list[int]]:
    if options.parent is None:
        rig, parent = group(rig)
    elif rig.is_joint[parent := rig.find(options.parent, "parent")] and not options.skin:
        raise UsageError(
            f"--no-skin: children of '{rig.title(parent)}' join its skins; leave out --parent or --no-skin"
        )
    names = _names(rig, parent, options, len(shape.points))
    own = options.skin and not rig.is_joint[parent]
    axes = _handed(rig, parent, shape.axes, options, report)
    joints: list[int] = []
    for part, (name, place) in enumerate(zip(names, shape.points, strict=True)):
        record = LimbRecord(limb=_title(options), part=part)
        rig, parent = add_joint(rig, name, parent, record, place, axes[part])
        joints.append(parent)
    return (new_skin(rig, _title(options), joints) if own else rig), joints


def _names(rig: Rig, parent: int, options: MakeLimbOptions, count: int) -> list[str]:
    names, used = joint_names(rig, options, count), rig.names_beside(parent)
    if taken := [name for name in names if names.count(name) > 1 or name in used]:
        raise UsageError(f"another node is called '{taken[0]}'; give the joints --names of their own")
    return names


def _update(
    rig: Rig, joints: list[int], shape: _Shape, options: MakeLimbOptions, report: Report
) -> tuple[Rig, list[int]]:
    title = _title(options)
    if len(joints) != len(shape.points):
        raise UsageError(
            f"the limb '{title}' has {len(joints)} joints, and here are {len(shape.points)} points; give "
            "another --name, or take the old one out with rigtri strip"
        )
    parent = int(rig.parents[joints[0]])
    # A skeleton of its own may stand between.
    above = (parent, -1 if rig.is_joint[parent] else int(rig.parents[parent]))
    if options.parent is not None and rig.find(options.parent, "parent") not in above:
        raise UsageError(
            f"the limb '{title}' is a child of '{rig.title(parent)}' already; strip the file first"
        )
    for node, name in zip(joints, options.names, strict=False):
        if rig.rules.valid_name(name) != rig.names[node]:
            raise UsageError(f"joint {rig.title(node)} of the limb '{title}' keeps its name, not '{name}'")
    axes = _handed(rig, parent, shape.axes, options, report)
    return move_chain(rig, joints, shape.points, axes, report), joints


def _handed(rig: Rig, parent: int, axes: Floats, options: MakeLimbOptions, report: Report) -> Floats:
    """The axes as they can be below ``parent``: where that is mirrored, the third points the other way."""
    if determinant(rig.world[parent]) >= 0:
        return axes
    text = (
        f"'{rig.title(parent)}' is mirrored, and so are the joints of {_title(options)}: aim and up are kept."
    )
    report.warn("mirrored-parent", text, joint=_title(options))
    style = AxisStyle() if options.style.world else options.style
    third = 3 - axis_of(style.aim)[0] - axis_of(style.up)[0]
    return axes * np.where(np.arange(3) == third, -1.0, 1.0)[:, np.newaxis]


def _limb_record(
    rig: Rig, joints: list[int], part: int, shape: _Shape, options: MakeLimbOptions
) -> LimbRecord:
    """What a joint is of which limb; the first one has all that is known of the limb."""
    record = LimbRecord(limb=_title(options), part=part)
    if part > 0:
        return record
    style, end = options.style, options.end_aim
    # Seen from the root joint, so that it holds wherever the limb goes.
    seen = np.array([dot(shape.hinge, axis) for axis in shape.axes[0]])
    return replace(
        record,
        chain=tuple(map(rig.address, joints)),
        middle="" if options.is_chain else rig.address(joints[shape.middle]),
        aim=style.aim,
        up=style.up,
        up_from="world" if style.world else style.up_from,
        hinge=triple(np.where(np.abs(seen) < _NOISE, 0.0, seen)),
        lengths=tuple(length(shape.points[1:] - shape.points[:-1]).tolist()),
        planar=options.planar,
        source=shape.source,
        locators=tuple(rig.address(rig.find(name, "locator")) for name in options.locators),
        end_aim=rig.address(rig.find(end)) if isinstance(end, str) else end,
    )


def _record(rig: Rig, node: int, shape: _Shape, part: int, *, new: bool) -> dict[str, Any]:
    parent, world = int(rig.parents[node]), rig.world[node]
    return {
        "node": rig.names[node],
        "type": "limb",
        "parent": rig.title(parent) if parent >= 0 else "",
        "skins": [skin.name for skin in rig.skins if node in skin.joints],
        "new": new,
        "position": [float(x) for x in world[3, :3]],
        "axes": [[float(x) for x in axis] for axis in normalise(world[:3, :3])],
        "moved": float(shape.moved[part]),
    }
