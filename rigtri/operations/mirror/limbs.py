"""Mirroring limbs of make-limb: created or updated on the other side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.frames.mirroring import mirrored_axes
from rigtri.maths.matrices import determinant, handedness, nearest_rotation
from rigtri.maths.triangle import axis_of
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import triple
from rigtri.model.joint_names import twin
from rigtri.model.metadata import ConstraintRecord, LimbRecord, Triple
from rigtri.model.rig import Rig
from rigtri.operations.mirror.counterparts import (
    SUFFIX,
    NotMirroredError,
    direction,
    mirror_each,
    of_side,
    other,
    twin_address,
    twin_name,
)
from rigtri.operations.moved_chain import move_chain
from rigtri.operations.option_kinds import vector
from rigtri.operations.options.mirror import MirrorOptions
from rigtri.operations.rigtri_nodes import group, with_record
from rigtri.operations.skin_joints import add_joint, new_skin
from rigtri.recognition.sides import twin_of
from rigtri.report import Report

_LETTERS = "xyz"


def mirror_limbs(rig: Rig, options: MirrorOptions, report: Report) -> Rig:
    """Stand the joints of the other side's limbs where the mirror image of this side's is."""

    def build(rig: Rig, node: int, report: Report) -> Rig:
        return _limb(rig, rig.records(LimbRecord)[node], options, report)

    return mirror_each(rig, of_side(rig, options, LimbRecord), "limb", build, report)


def _limb(rig: Rig, record: LimbRecord, options: MirrorOptions, report: Report) -> Rig:
    chain = [k for name in record.chain if (k := rig.known(name)) is not None]
    if len(chain) < len(record.chain):
        raise NotMirroredError("not all of its joints are there")
    world = rig.world[chain]
    places = options.across.points(world[:, 3, :3])
    axes = mirrored_axes(nearest_rotation(world), options.mode, options.across)
    joints = [there for k in chain if (there := twin_of(rig, k)) is not None]
    new = not joints
    if joints and len(joints) < len(chain):
        raise NotMirroredError("some of its joints have twins, and some have none")
    if joints and not all(rig.type_of(k) == "limb" for k in joints):
        return rig  # the other side has joints of its own, whose places are not ours to change
    if new:
        rig, joints = _built(rig, chain, record.limb, places, axes)
    else:
        rig = move_chain(rig, joints, places, axes, report, _rebuilt(rig, options))
    title = twin_name(record.limb, f"{record.limb}{SUFFIX[options.from_side]}")
    for part, joint in enumerate(joints):
        twin_limb = LimbRecord(limb=title, part=part)
        if part == 0:
            twin_limb = _first_record(rig, chain, joints, replace(record, limb=title), options)
        rig = with_record(rig, joint, twin_limb)
        report.added.append(_reported(rig, joint, new=new))
    return rig


def _rebuilt(rig: Rig, options: MirrorOptions) -> set[int]:
    """The nodes with constraints of the other side that are mirrored from this side's later on."""
    if options.what and "constraints" not in options.what:
        return set()
    records = rig.records(ConstraintRecord)
    twins = {
        (other(rig, child), records[node].kind)
        for node in of_side(rig, options, ConstraintRecord)
        if (child := rig.known(records[node].child)) is not None
    }
    return {node for node, record in records.items() if (rig.known(record.child), record.kind) in twins}


def _parent(rig: Rig, joint: int) -> int | None:
    """The parent of a limb's twin: −1 for the group, None where that has no twin."""
    parent = int(rig.parents[joint])
    if rig.is_joint[parent]:
        return other(rig, parent)
    above = int(rig.parents[parent]) if parent >= 0 else -1
    # In USD a skeleton of its own stands between.
    if parent < 0 or "group" in {rig.type_of(k) for k in (parent, above)}:
        return -1
    return other(rig, parent)


def _built(rig: Rig, chain: list[int], title: str, places: Floats, axes: Floats) -> tuple[Rig, list[int]]:
    names, parent = [twin(rig.names[k]) for k in chain], _parent(rig, chain[0])
    used = rig.names_beside(-1 if parent is None else parent)
    if taken := [name for name in names if name in used]:
        raise NotMirroredError(f"another node is called '{taken[0]}'")
    if parent is None or (parent >= 0 and determinant(rig.world[parent]) < 0):
        raise NotMirroredError("its parent has no such twin")
    if parent < 0:
        rig, parent = group(rig)
    own_skin = rig.is_joint[chain[0]] and not rig.is_joint[parent]
    joints: list[int] = []
    for name, place, rows in zip(names, places, axes, strict=True):
        record = LimbRecord(limb=twin(title), part=len(joints))
        rig, parent = add_joint(rig, name, parent, record, place, rows)
        joints.append(parent)
    return (new_skin(rig, twin(title), joints) if own_skin else rig), joints


def _first_record(
    rig: Rig, chain: list[int], joints: list[int], record: LimbRecord, options: MirrorOptions
) -> LimbRecord:
    """What make-limb would store of the limb with its first joint; ``record``: of the mirrored one."""
    addresses = tuple(map(rig.address, joints))
    where = dict(zip(record.chain, addresses, strict=True))
    hinge = record.hinge
    if hinge is not None:
        # A turn that bends it mirrors as turns do: across the plane and the other way.
        # The axes of a mirrored joint turn as their opposites do.
        turned = float(np.prod(handedness(rig.world[[chain[0], joints[0]]])))
        x, y, z = (-turned * np.array(direction(rig, chain[0], joints[0], hinge, options)) + 0.0).tolist()
        hinge = x, y, z
    return replace(
        record,
        chain=addresses,
        middle=where.get(record.middle, record.middle),
        **_readable_style(record, options),
        hinge=hinge,
        locators=_locators(rig, record.locators),
        end_aim=_end_aim(rig, record.end_aim, options),
    )


def _locators(rig: Rig, names: Sequence[str]) -> tuple[str, ...]:
    """The nodes that a limb was made at, on the other side; none where not all are there."""
    try:
        return tuple(twin_address(rig, name) for name in names)
    except NotMirroredError:
        return ()


def _end_aim(rig: Rig, end: str | Triple | None, options: MirrorOptions) -> str | Triple | None:
    if isinstance(end, str):
        return next(iter(_locators(rig, [end])), None)
    if end is None:
        return None
    return triple(options.across.points(np.array(end, dtype=np.float64)))


def _readable_style(record: LimbRecord, options: MirrorOptions) -> dict[str, Any]:
    try:
        return _style(record, options)
    except ValueError as error:
        raise NotMirroredError(f"what is stored of its axes is damaged: {error}") from None


def _style(record: LimbRecord, options: MirrorOptions) -> dict[str, Any]:
    """Which axes of the mirrored joints point where; empty where none does, as with ``orientation``."""
    aim, up, source = record.aim, record.up, record.up_from
    if not (aim and up and source) or options.mode == "orientation" or source == "world":
        return {"aim": "", "up": "", "up_from": ""}
    # What mirroring makes of each axis of a frame: its mirror image, or the opposite of that.
    signs = np.array([-1.0, 1.0, 1.0]) if options.mode == "blender" else np.array([-1.0, -1.0, -1.0])
    if source not in ("plane", "pole"):
        kind, _, text = source.partition(":")
        letter, sign = axis_of(text) if kind == "world" else (0, 1.0)
        direction = sign * np.eye(3)[letter] if kind == "world" else np.array(vector(text))
        x, y, z = (options.across.directions(direction) + 0.0).tolist()
        source = f"vector:{x!r},{y!r},{z!r}"
    # The limb's hinge is what turns are about: its mirror image points the other way.
    return {
        "aim": _signed(aim, signs),
        "up": _signed(up, -signs if source == "plane" else signs),
        "up_from": source,
    }


def _signed(axis: str, signs: Floats) -> str:
    letter, sign = axis_of(axis)
    return ("-" if sign * signs[letter] < 0 else "") + _LETTERS[letter]


def _reported(rig: Rig, node: int, *, new: bool) -> dict[str, Any]:
    world = rig.world[node]
    return {
        "node": rig.names[node],
        "type": "limb",
        "parent": rig.title(int(rig.parents[node])) if rig.parents[node] >= 0 else "",
        "skins": [skin.name for skin in rig.skins if node in skin.joints],
        "new": new,
        "position": [float(x) for x in world[3, :3]],
        "axes": nearest_rotation(world).tolist(),
        "moved": 0.0,
    }
