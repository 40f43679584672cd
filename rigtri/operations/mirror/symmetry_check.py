"""Symmetry check: how far positions and axes of the two sides differ, and what is missing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.frames import Plane
from rigtri.frames.mirroring import CONVENTIONS, PLANES, Convention, mirrored_axes
from rigtri.frames.skeleton import ReferencePose, Skeleton, reference, skeleton
from rigtri.maths.matrices import nearest_rotation
from rigtri.maths.quaternions import angle_between, from_axes
from rigtri.maths.ranking import SAME_LENGTH, ranked
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import twin
from rigtri.model.metadata import OffsetRecord, PoseReaderRecord, RivetRecord
from rigtri.model.rig import Rig
from rigtri.operations.joint_selection import chosen
from rigtri.operations.mirror.counterparts import other, refuse_without_sides, side, sided_bodies
from rigtri.operations.mirror.pose_readers import reader_twin
from rigtri.operations.mirror_plane import TOLERANCE, parting
from rigtri.operations.options.mirror import MirrorOptions
from rigtri.operations.rigtri_nodes import find
from rigtri.recognition.one_character import within

# Degrees that tools leave of symmetric axes.
DEGREES = 0.1
# Degrees by which noise of a millimetre or two turns axes that are aimed. Conventions are 90° or more apart.
_NOISE = 10.0
# Angles that differ by less are equal: rounding must not order pairs.
_SAME_DEGREES = 1e-3
# Nodes of ours that stand somewhere, and those whose axes say something.
_STANDING = ("control", "poleVector", "rivet")
_WITH_AXES = ("control", "poleVector")


@dataclass(frozen=True)
class Pair:
    """A node and its twin: how far the twin is from the mirror image, as a share of the size, in degrees."""

    node: str
    twin: str
    distance: float
    degrees: float

    def symmetric(self, tolerance: float = TOLERANCE, degrees: float = DEGREES) -> bool:
        """Whether both are within what is allowed."""
        return self.distance <= tolerance and self.degrees <= degrees

    def as_json(self) -> dict[str, Any]:
        """For machines."""
        return {"node": self.node, "twin": self.twin, "distance": self.distance, "degrees": self.degrees}


@dataclass(frozen=True)
class Asymmetry:
    """All pairs of joints and of nodes that rigtri made, and those without a twin.

    plane, at: the mirror, in the character's own space. better: another one that most pairs lie
    about, where they do not about that. mode: what the axes of the joints were compared by, or of controls
    where no joint has a twin. keeping: how many of these ``with_axes`` pairs keep it. characters: so many
    were compared, each about its own plane and by its own convention; plane, at and mode are then those of
    the first.
    """

    pairs: tuple[Pair, ...]
    alone: tuple[str, ...]
    plane: Plane = "yz"
    at: float = 0.0
    better: tuple[Plane, float] | None = None
    mode: Convention = "behavior"
    keeping: int = 0
    with_axes: int = 0
    characters: int = 1

    def worse(self, tolerance: float = TOLERANCE, degrees: float = DEGREES) -> list[Pair]:
        """The pairs that are not symmetric, worst place first."""
        found = [pair for pair in self.pairs if not pair.symmetric(tolerance, degrees)]
        by_angle = ranked(found, lambda pair: pair.degrees, _SAME_DEGREES)
        return ranked(by_angle, lambda pair: pair.distance, SAME_LENGTH)


def asymmetry(rig: Rig, *, options: MirrorOptions | None = None, mode: Convention | None = None) -> Asymmetry:
    """Compare each joint and node of ours on one side with the mirror image of its twin.

    mode: the convention that its axes keep; None: the one that most pairs keep, of equals the first of
    `CONVENTIONS`.

    In the pose of the options (the bind pose by default) for joints, at rest for other nodes.
    Ends of others that carry nothing are left out: they have no axes to speak of, and glTF does not
    call them joints. Of several characters each is compared by itself, as ``mirror`` mirrors them.
    """
    options = options or MirrorOptions()
    found = list[Asymmetry]()

    def compare(one: Rig) -> Rig:
        found.append(_of_one(one, options, mode))
        return one

    for nodes in sided_bodies(rig, options.selection):
        within(rig, nodes, compare)
    if not found:
        return _of_one(rig, options, mode)
    return replace(
        found[0],
        pairs=tuple(pair for each in found for pair in each.pairs),
        alone=tuple(name for each in found for name in each.alone),
        better=next((each.better for each in found if each.better is not None), None),
        keeping=sum(each.keeping for each in found),
        with_axes=sum(each.with_axes for each in found),
        characters=len(found),
    )


def _of_one(rig: Rig, options: MirrorOptions, mode: Convention | None) -> Asymmetry:
    """The same of a rig with one character."""
    tree = skeleton(rig, options.root)
    refuse_without_sides(rig, tree.joints)
    ref = reference(tree, options.pose)
    parted = parting(tree, ref, tree.joints, options.plane, options.from_side, options.plane_at)
    options = replace(options, across=parted.across)
    joints = [joint for joint in chosen(tree, options.selection) if _is_bone(tree, joint) or joint in rig.own]
    found, alone = _pairs(rig, joints, options)
    rest = rig.world
    kinds = {node: rig.type_of(node) for node in rig.metadata if node not in set(tree.joints)}
    standing, unpaired = _pairs(rig, (n for n, kind in kinds.items() if kind in _STANDING), options)
    rules = (n for n, kind in kinds.items() if kind in ("constraint", "poseReader"))
    alone += unpaired + _pairs(rig, rules, options)[1]
    # Joints, controls that are aimed by themselves, those that are not, and pole vectors may each keep a
    # convention of their own.
    aimed = {node for node, offset in rig.records(OffsetRecord).items() if offset.up_from}
    groups: dict[Any, dict[int, int]] = {}
    for node, there in standing.items():
        if kinds[node] in _WITH_AXES:
            groups.setdefault((kinds[node], int(rig.parents[node]) in aimed), {})[node] = there
    compared, modes, first = list[Pair](), list[Convention](), list[Pair]()
    for group, world in [(found, ref.world), *((group, rest) for group in groups.values())]:
        by_mode = {
            each: _compared(rig, group, world, ref.extent, options, each)
            for each in ([mode] if mode else CONVENTIONS)
        }
        kept = max(by_mode, key=lambda each: _fit(by_mode[each]))
        compared += by_mode[kept]
        modes += [kept] if group else []
        first = first or by_mode[kept]
    keeping, with_axes = _keeping(first), len(first)
    placed = {node: there for node, there in standing.items() if kinds[node] not in _WITH_AXES}
    compared += _compared(rig, placed, rest, ref.extent, options, None)
    missing = ((node, twin(rig.names[node])) for node in alone)
    titles = (rig.title(k) + (f" (no {name})" if name != rig.names[k] else "") for k, name in missing)
    better = None if parted.fits else _better(tree, ref, options)
    kept = (modes or ["behavior"])[0]
    plane, at = parted.plane, parted.at
    return Asymmetry(tuple(compared), tuple(titles), plane, at, better, kept, keeping, with_axes)


def _fit(pairs: Sequence[Pair]) -> tuple[int, int, float]:
    """How well a convention fits: the pairs that keep it but for noise, those that keep it, and how far off
    most are."""
    degrees = [pair.degrees for pair in pairs]
    near = sum(each <= _NOISE for each in degrees)
    return near, _keeping(pairs), -float(np.median(degrees or [0.0]))


def _keeping(pairs: Sequence[Pair]) -> int:
    """How many pairs keep the convention that they were compared by."""
    return sum(pair.degrees <= DEGREES for pair in pairs)


def _is_bone(tree: Skeleton, joint: int) -> bool:
    return bool(tree.carries[joint] or tree.below[joint])


def _pairs(rig: Rig, nodes: Iterable[int], options: MirrorOptions) -> tuple[dict[int, int], list[int]]:
    """Those on the side that is copied with their twins, and those of either that have none."""
    found: dict[int, int] = {}
    alone = []
    for node in nodes:
        mine = side(rig, node)
        there = _twin(rig, node) if mine else None
        if mine and there is None:
            alone.append(node)
        elif mine == options.from_side and there is not None:
            found[node] = there
    return found, alone


def _twin(rig: Rig, node: int) -> int | None:
    """The twin of a node; of rivets and readers, which have names of their own, the one called so."""
    record = rig.record(node)
    if isinstance(record, PoseReaderRecord):
        return reader_twin(rig, node)
    if isinstance(record, RivetRecord):
        names = {each.name for each in rig.records(RivetRecord).values()}
        return find(rig, RivetRecord, name=twin(record.name, names))
    return other(rig, node)


def _compared(
    rig: Rig,
    found: dict[int, int],
    world: Floats,
    size: float,
    options: MirrorOptions,
    mode: Convention | None,
) -> list[Pair]:
    """mode: None for nodes whose axes say nothing."""
    if not found:
        return []
    here, there = list(found), list(found.values())
    apart = length(options.across.points(world[here, 3, :3]) - world[there, 3, :3]) / (size or 1.0)
    angles = np.zeros(len(here))
    if mode is not None:
        mine, now = nearest_rotation(world[here]), from_axes(nearest_rotation(world[there]))
        expected = from_axes(mirrored_axes(mine, mode, options.across))
        angles = np.degrees(angle_between(expected, now))
    return [
        Pair(rig.title(a), rig.title(b), float(d), float(angle))
        for a, b, d, angle in zip(here, there, apart, angles, strict=True)
    ]


def _better(tree: Skeleton, ref: ReferencePose, options: MirrorOptions) -> tuple[Plane, float] | None:
    """A plane that most pairs lie about, where they do not about the given one."""
    for plane in PLANES:
        parted = parting(tree, ref, tree.joints, plane, options.from_side)
        if parted.own and parted.fits:
            return plane, parted.at
    return None
