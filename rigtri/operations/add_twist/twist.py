"""add-twist: twist joints along a bone, each with a share of the twist (avoids the candy-wrapper effect).

Source: "Matrix parent constraint" (twist distribution, announced); `rigtri.evaluation.twist_joints`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError, NoLimbError, UsageError
from rigtri.evaluation.twist_joints import bone, driver_path, refuse_parted, twist_of
from rigtri.frames.skeleton import ZERO_LENGTH
from rigtri.maths.matrices import nearest_rotation, transform_points
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.metadata import TwistRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_rivet.rebind import rebind_rivets_on_new_weights
from rigtri.operations.add_twist.key_baking import BOUND, Found, keyed
from rigtri.operations.add_twist.split_weights import Bone, BoneTwist, split_weights
from rigtri.operations.operation import operation
from rigtri.operations.options.add_twist import NAME as NAME
from rigtri.operations.options.add_twist import AddTwistOptions as AddTwistOptions
from rigtri.operations.rigtri_nodes import (
    NewNodes,
    seen_from,
    unposed,
    with_record,
)
from rigtri.operations.skin_joints import join_skins, move_joint
from rigtri.progress import counted
from rigtri.recognition.limbs import along, named_limbs, recognise
from rigtri.report import Report


@operation(AddTwistOptions)
def add_twist(rig: Rig, *, options: AddTwistOptions, report: Report) -> Rig:
    """Put twist joints along bones, with keys in every clip that turns their drivers.

    A second run finds them by the bone and their number and sets them anew. The record of each
    goes to ``report.added``. Rivets on meshes whose weights are split are baked anew.

    Raises NameNotFoundError, UsageError, GeometryError (a bone without length, a driver elsewhere).
    """
    bones = _bones(rig, options, report)
    if options.name != NAME:
        _check_names(rig, bones, options)
    for apart in _with_ends_apart(bones):
        rig = _build(rig, apart, options, report)
    return rebind_rivets_on_new_weights(rig, report) if options.split_weights else rig


def _check_names(rig: Rig, bones: list[Bone], options: AddTwistOptions) -> None:
    """UsageError where a user's rule gives two new twist joints one name, or that of another node."""
    names: dict[int, set[str]] = {}
    taken: dict[int, set[str]] = {}
    there = {(record.joint, record.to, record.number) for record in rig.records(TwistRecord).values()}
    for of in bones:
        ends, skeleton = _ends(rig, of), rig.skeleton_of[of.joint]
        if skeleton not in taken:
            names[skeleton], taken[skeleton] = set(), rig.names_beside(of.joint)
        for number in range(1, options.count + 1):
            if (*ends, number) not in there:
                name = _name(rig, of, number, options)
                valid = rig.rules.valid_name(name)
                if valid in taken[skeleton]:
                    raise UsageError(f"--name {name}: another node is called so")
                if valid in names[skeleton]:
                    raise UsageError(f"--name {options.name}: several twist joints would be called '{name}'")
                names[skeleton].add(valid)


def _name(rig: Rig, of: Bone, number: int, options: AddTwistOptions) -> str:
    return options.name.format(joint=rig.names[of.joint] or f"joint_{of.joint}", number=number)


def _bones(rig: Rig, options: AddTwistOptions, report: Report) -> list[Bone]:
    both = options.upper == options.lower
    named = named_limbs(rig, options.limb)
    limbs = [*named, *(recognise(rig) if options.limbs else ())]
    if options.limbs and not limbs:
        raise NoLimbError
    found = []
    for limb in limbs:
        mine = limb in named
        found += [Bone(limb.start, limb.middle, True, mine)] if both or options.upper else []
        if (both or options.lower) and rig.is_below(limb.end, limb.middle):
            found.append(Bone(limb.middle, limb.end, False, mine))
        elif both or options.lower:
            report.warn(
                "twist-left-out",
                f"'{rig.title(limb.end)}' is not a descendant of '{rig.title(limb.middle)}', whose bone gets "
                "no twist joints",
                joint=rig.title(limb.middle),
            )
    starts = {(limb.start, limb.middle) for limb in (recognise(rig) if options.bones else ())}
    for name, child in options.bones:
        joint, to = rig.find(name), rig.find(child)
        found.append(Bone(joint, to, (joint, to) in starts if both else options.upper))
    return list(dict.fromkeys(found))


def _with_ends_apart(bones: list[Bone]) -> list[list[Bone]]:
    """The bones in lists without two of the same ends: the later one finds the twist joints of the first."""
    seen, lists = Counter[tuple[int, int]](), dict[int, list[Bone]]()
    for of in bones:
        lists.setdefault(seen[of.joint, of.to], []).append(of)
        seen[of.joint, of.to] += 1
    return list(lists.values())


def _build(rig: Rig, bones: list[Bone], options: AddTwistOptions, report: Report) -> Rig:
    """The twist joints of bones with different ends, in one change of the rig: one by one would cost their
    number squared."""
    new, made = NewNodes(rig), list[BoneTwist]()
    extent = float(length(np.ptp(rig.world[rig.is_joint, 3, :3], axis=0))) if rig.is_joint.any() else 0.0
    by_ends: dict[tuple[str, str], dict[int, TwistRecord]] = {}
    for node, record in rig.records(TwistRecord).items():
        by_ends.setdefault((record.joint, record.to), {})[node] = record
    for of in counted(bones, "bones"):
        there = by_ends.get(_ends(rig, of), {})
        if why := _why_kept(rig, of, options, there):
            if of.named:
                raise UsageError(why)
            report.warn("twist-kept", f"{why}; they stay as they are", joint=rig.title(of.joint))
            continue
        line, above = _line(rig, of, extent), unposed(rig, of.joint)
        for number in range(1, options.count + 1):
            found = next((node for node, record in there.items() if record.number == number), None)
            rig, joint = _joint(rig, new, of, number, line, above, found, options)
            made.append(joint)
    rig = join_skins(new.added(rig), {joint.node: joint.of.joint for joint in made if joint.new})
    rig = _with_keys(rig, made, options, report)
    return split_weights(rig, made, options, report) if options.split_weights else rig


def _line(rig: Rig, of: Bone, extent: float) -> Floats:
    """Where a bone ends as its joint sees it, (3,). extent: the diagonal of the box of all joints."""
    if of.joint == of.to:
        raise UsageError(f"'{rig.title(of.joint)}' is both ends of the bone; a bone has two")
    along(rig, of.joint, of.to)  # UsageError where the one does not lie below the other
    driver_path(rig, of.driver, -1 if of.upper else of.joint)
    line = bone(rig, of.joint, of.to)
    size = float(np.abs(rig.world[of.joint, :3, :3]).max()) * float(length(line))
    if not np.isfinite(size) or size <= ZERO_LENGTH * extent:
        raise GeometryError(
            f"'{rig.title(of.joint)}' and '{rig.title(of.to)}' are at one place: there is no bone to "
            "twist about"
        )
    return line


def _why_kept(rig: Rig, of: Bone, options: AddTwistOptions, there: Mapping[int, TwistRecord]) -> str:
    """Why the twist joints that a bone has cannot be set anew as the options say; "" where they can."""
    title = rig.title(of.joint)
    most = max((record.number for record in there.values()), default=0)
    if most > options.count:
        return (
            f"'{title}' has {most} twist joints already; "
            f"give add-twist --count {most} or more, or strip the file first"
        )
    other = {
        node
        for node, record in there.items()
        if _settings(record) != _settings(_record(rig, of, record.number, options, record))
    }
    bearing = (skin for skin in rig.skins if skin.weigh is not None and other and not options.split_weights)
    if any(other.intersection(skin.joints[skin.weighted].tolist()) for skin in bearing):
        return (
            f"'{title}' has twist joints with weight, and other settings would move its vertices; give "
            "add-twist --split-weights, which distributes the weight again, or strip the file first"
        )
    return ""


def _settings(record: TwistRecord) -> tuple[object, ...]:
    """What the options say of a twist joint."""
    return record.driver, record.count, record.at, record.weight, record.axis


def _ends(rig: Rig, of: Bone) -> tuple[str, str]:
    """What the records of a bone's twist joints say of it: its joint, and where it ends."""
    return rig.address(of.joint), rig.address(of.to)


def _record(
    rig: Rig, of: Bone, number: int, options: AddTwistOptions, was: TwistRecord | None
) -> TwistRecord:
    """What is stored of a bone's twist joint. was: what is stored of the one that is there."""
    at = number / (options.count + 1)
    record = TwistRecord(
        joint=rig.address(of.joint),
        to=rig.address(of.to),
        driver=rig.address(of.driver),
        number=number,
        count=options.count,
        at=at,
        weight=options.weights[number - 1] if options.weights else at - 1.0 if of.upper else at,
        axis=options.axis,
    )
    if was is None:
        return record
    if was.rest is not None and options.axis is None:
        record = replace(record, axis=was.axis)  # the line of the rest pose that it counts from
    return replace(record, influences=was.influences, rest=was.rest, standing=was.standing)


def _joint(
    rig: Rig,
    new: NewNodes,
    of: Bone,
    number: int,
    line: Floats,
    above: Floats,
    node: int | None,
    options: AddTwistOptions,
) -> tuple[Rig, BoneTwist]:
    """One twist joint of a bone at its place: the one that is there, or a new one.

    line: as `_line` has it. above: where the bone's joint stands while controls are zero, (4, 4).
    """
    was = None if node is None else rig.records(TwistRecord)[node]
    if node is not None and was is not None:
        refuse_parted(rig, node, was)
    record = _record(rig, of, number, options, was)
    place = transform_points(line * record.at, rig.world[of.joint])
    axes = nearest_rotation(rig.world[of.joint])
    if node is None:
        name = _name(rig, of, number, options)
        return rig, BoneTwist(
            of, new.add(name, of.joint, record, *seen_from(above, place, axes)), record, place, True
        )
    rig = with_record(rig, node, record)
    if record.standing is None:  # else the rest pose is not the one that it was bound in
        rig = move_joint(rig, node, place, axes)
    return rig, BoneTwist(of, node, record, place, False)


def _with_keys(rig: Rig, made: list[BoneTwist], options: AddTwistOptions, report: Report) -> Rig:
    """The rig with keys for twist joints, if they are to have some; each goes to ``report.added``."""
    every: list[Found] = [{} for _ in made]
    if options.keys:
        rig, every = keyed(rig, [twist_of(rig, joint.node, joint.record) for joint in made])
    for joint, found in zip(made, every, strict=True):
        _warn_off(joint.record.driver, found, report)
        report.added.append(
            {
                "node": rig.names[joint.node],
                "type": "twist",
                "joint": rig.title(joint.of.joint),
                "to": rig.title(joint.of.to),
                "driver": rig.title(joint.of.driver),
                "at": joint.record.at,
                "weight": float(joint.record.weight),
                "new": joint.new,
                "position": [float(x) for x in joint.place],
                "clips": [{"clip": clip, "off": float(off)} for clip, (off, _) in found.items()],
            }
        )
    return rig


def _warn_off(driver: str, found: Found, report: Report) -> None:
    """Warn of clips where a twist joint does not follow its driver between keys."""
    for clip, (off, refined) in found.items():
        if off > BOUND and refined:
            report.warn(
                "twist-jumps",
                f"The twist of '{driver}' in clip '{clip}' jumps: it swings or twists by 180° there",
                joint=driver,
            )
        elif off > BOUND:
            report.warn(
                "twist-between-keys",
                f"Between the keys of clip '{clip}' the twist joints of '{driver}' are off by up to "
                f"{float(np.degrees(off)):.2g}°; its joints share their key times, so none were added",
                joint=driver,
            )
