"""Counterparts on the other side: of nodes, of records, of names and directions.

Nodes that rigtri added are known by their records: the twin of a control is the control of the twin joint,
whatever either is called.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from rigtri.errors import AmbiguousNameError, FileError, GeometryError, NameNotFoundError, UsageError
from rigtri.maths.matrices import handedness, nearest_rotation
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot, length, triple
from rigtri.model.joint_names import Side, twin
from rigtri.model.metadata import (
    ConstraintRecord,
    ControlRecord,
    FrameRecord,
    LimbRecord,
    OffsetRecord,
    PoleVectorRecord,
    PoseReaderRecord,
    Record,
    Triple,
    TwistRecord,
)
from rigtri.model.rig import Rig
from rigtri.operations.option_kinds import Selection
from rigtri.operations.options.mirror import MirrorOptions
from rigtri.operations.rigtri_nodes import find
from rigtri.recognition.one_character import bodies
from rigtri.recognition.sides import side_of, twin_of
from rigtri.report import Report

R = TypeVar("R", bound=Record)

# The fields of records with the joints that show on which side a node is.
_JOINTS: Mapping[type[Record], tuple[str, ...]] = {
    ConstraintRecord: ("chain", "child"),
    ControlRecord: ("chain", "joint"),
    FrameRecord: ("joint",),
    LimbRecord: ("chain",),
    OffsetRecord: ("joint",),
    PoleVectorRecord: ("chain",),
    PoseReaderRecord: ("driver",),
    TwistRecord: ("joint", "to"),
}
# The fields by which the twin of a node is found.
_KNOWN_BY: Mapping[type[Record], tuple[str, ...]] = {
    ConstraintRecord: ("child", "kind"),
    ControlRecord: ("kind", "joint"),
    OffsetRecord: ("kind", "joint"),
    PoleVectorRecord: ("chain",),
    TwistRecord: ("joint", "to", "number"),
}
OTHER: Mapping[Side, Side] = {"left": "right", "right": "left", "": ""}
SUFFIX = {"left": "_R", "right": "_L", "": ""}
_DEEPEST = 4
# Numbers of a record that differ by less are what float32 and a re-oriented parent leave of the same.
SAME_NUMBER = 4e-6


class NotMirroredError(GeometryError):
    """Why something has no counterpart, and none can be made."""


def sided_bodies(rig: Rig, selection: Selection) -> list[frozenset[int]]:
    """Of several characters the nodes of each that has sides: each is mirrored about its own plane.

    None for one character, and where the user names joints.
    """
    several = [] if selection.named else bodies(rig)
    return [nodes for nodes in several if any(side_of(rig, node) for node in nodes)]


def mirror_each(
    rig: Rig, nodes: Iterable[int], title: str, build: Callable[[Rig, int, Report], Rig], report: Report
) -> Rig:
    """The rig once ``build`` has made the twin of each node; a warning names each that has none."""
    for node in nodes:
        built_report = Report()
        try:
            rig = build(rig, node, built_report)
        # Its record's names may be wrong, too, in a file that another program has written since.
        except (AmbiguousNameError, FileError, GeometryError, NameNotFoundError, UsageError) as error:
            warn_not_mirrored(rig, node, report, title, str(error))
        else:
            report.merge(built_report)
    return rig


def warn_not_mirrored(rig: Rig, node: int, report: Report, title: str, why: str) -> None:
    report.warn("not-mirrored", f"{title} '{rig.title(node)}' is not mirrored: {why}")


def side(rig: Rig, node: int) -> Side:
    """The side of a node: of the joints that its record is about, else what it or its bone is called."""
    record = rig.record(node)
    joints = [] if record is None else [k for k in map(rig.known, joints_of(record)) if k != node]
    sides = {side_of(rig, k) for k in joints if k is not None} - {""}
    return sides.pop() if len(sides) == 1 else side_of(rig, node)


def refuse_without_sides(rig: Rig, joints: Iterable[int]) -> None:
    """GeometryError where no joint has a side: what is built on joints is on a side with them alone."""
    records = ((node, rig.record(node)) for node in rig.metadata)
    free = (node for node, record in records if record is None or not joints_of(record))
    if not any(side_of(rig, node) for node in (*joints, *free)):
        raise GeometryError(
            "no joint in this file says left or right, by its name or its VRM bone; rigtri rename-joints "
            "names them as they are recognised"
        )


def other(rig: Rig, node: int, deep: int = 0) -> int | None:
    """The twin of a node, itself where it is on neither side; None where there is none.

    deep: how many records have led here; those of a broken file may name each other in a cycle.
    """
    record, here = rig.record(node), side(rig, node)
    if not here:
        return node
    if record is None or type(record) not in _KNOWN_BY or deep >= _DEEPEST:
        return twin_of(rig, node)
    there = twin_record(rig, record, deep + 1)
    fields = _KNOWN_BY[type(record)]
    return None if there is None else find(rig, type(record), **{key: getattr(there, key) for key in fields})


def twin_address(rig: Rig, name: str, why: str = "the other side has no such joint") -> str:
    """The address of the twin of the node that is called so. Raises NotMirroredError where there is none."""
    node = rig.known(name)
    there = None if node is None else other(rig, node)
    if there is None:
        raise NotMirroredError(why)
    return rig.address(there)


def joints_of(record: Record) -> list[str]:
    """The joints that a record is about, and that show its side."""
    values = [getattr(record, field) for field in _JOINTS.get(type(record), ())]
    names = [name for value in values for name in ((value,) if isinstance(value, str) else value)]
    return [name for name in names if name]


def of_side(rig: Rig, options: MirrorOptions, kind: type[Record]) -> list[int]:
    """The nodes with records of a type, about joints of the side that is copied alone."""
    found = []
    for node, record in rig.records(kind).items():
        if isinstance(record, ConstraintRecord) and rig.known(record.child) in rig.others:
            continue  # mirrored with the character that it moves
        nodes = (rig.known(name) for name in joints_of(record))
        if {side(rig, k) for k in nodes if k is not None} - {""} == {options.from_side}:
            found.append(node)
    return found


def twin_record(rig: Rig, record: R, deep: int = 0) -> R | None:
    """The record of the twin: the same of the twins of its joints; None where one of those is missing."""
    twins: dict[str, str] = {}
    if not all(getattr(record, "chain", ())):  # of a file whose joints lost their names
        return None
    for name in joints_of(record):
        node = rig.known(name)
        there = None if node is None else other(rig, node, deep)
        if there is None:
            return None
        twins[name] = rig.address(there)
    changes: dict[str, Any] = {
        key: twins.get(name := getattr(record, key)) or _address(rig, rig.known(name), deep)
        for key in ("joint", "to", "driver", "child")
        if hasattr(record, key)
    }
    if hasattr(record, "chain"):
        changes["chain"] = tuple(twins[name] for name in record.chain)
    if isinstance(record, ControlRecord) and record.side is not None:
        changes["side"] = OTHER[record.side]
    return replace(record, **changes)


def existing_twin_record(rig: Rig, record: R) -> R:
    """See `twin_record`. Raises NotMirroredError where a joint has no twin."""
    found = twin_record(rig, record)
    if found is None:
        raise NotMirroredError("the other side has no such joint")
    return found


def _address(rig: Rig, node: int | None, deep: int) -> str:
    there = None if node is None else other(rig, node, deep)
    return "" if there is None else rig.address(there)


def twin_name(name: str, fallback: str) -> str:
    """The name of the other side, or ``fallback`` where the name says no side."""
    return fallback if twin(name) == name else twin(name)


def direction(rig: Rig, here: int, there: int, own: Iterable[float], options: MirrorOptions) -> Triple:
    """A direction in the axes of a node as the mirrored direction in the axes of its twin."""
    worlds = rig.world[[here, there]]
    axes, twins = nearest_rotation(worlds) * handedness(worlds)[:, np.newaxis, np.newaxis]
    x, y, z = np.array([*own], dtype=np.float64)
    seen = options.across.directions(x * axes[0] + y * axes[1] + z * axes[2])
    found = np.array([dot(seen, row) for row in twins])
    # What is an axis up to rounding is that axis.
    whole = np.rint(found)
    return triple(np.where(np.abs(found - whole) < SAME_NUMBER, whole, found) + 0.0)


def same_values(one: Any, other_one: Any, size: float) -> bool:
    """Whether two records' values, or parts of them, are the same but for rounding; ``size``: of the rig."""
    if isinstance(one, Mapping) and isinstance(other_one, Mapping):
        return one.keys() == other_one.keys() and all(same_values(one[k], other_one[k], size) for k in one)
    if isinstance(one, list | tuple) and isinstance(other_one, list | tuple):
        if len(one) != len(other_one):
            return False
        numbers = all(isinstance(x, float | int) for x in (*one, *other_one))
        if numbers and one and len(one) % 16 == 0:
            return _matrices_alike(np.array(one, float), np.array(other_one, float), size)
        return all(same_values(a, b, size) for a, b in zip(one, other_one, strict=True))
    number = isinstance(one, float | int) and isinstance(other_one, float | int)
    if number and not isinstance(one, bool):
        return bool(abs(one - other_one) <= SAME_NUMBER * max(1.0, abs(one)))
    return bool(one == other_one)


def _matrices_alike(one: Floats, two: Floats, size: float) -> bool:
    a, b = one.reshape(-1, 4, 4), two.reshape(-1, 4, 4)
    longest = max(1.0, float(length(a[:, :3, :3]).max()))
    near = np.abs(a[:, :3] - b[:, :3]).max() <= SAME_NUMBER * longest
    return bool(near and np.abs(a[:, 3] - b[:, 3]).max() <= SAME_NUMBER * max(size, 1e-30) * longest)


def farthest_joint(rig: Rig) -> float:
    """How far joints stand from the origin: what their rounding is a share of."""
    found = rig.world[rig.is_joint, 3, :3]
    return float(length(found).max()) if len(found) else 1.0
