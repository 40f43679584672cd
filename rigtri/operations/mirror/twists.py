"""Mirroring twist joints: created or updated along the bones of the other side."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from rigtri.model.metadata import Triple, TwistRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import moving_points
from rigtri.operations.add_twist.twist import NAME, AddTwistOptions, add_twist
from rigtri.operations.mirror.counterparts import (
    direction,
    mirror_each,
    of_side,
    same_values,
    twin_address,
    twin_name,
    twin_record,
)
from rigtri.operations.options.mirror import MirrorOptions
from rigtri.operations.rigtri_nodes import find, renamed
from rigtri.report import Report


def mirror_twists(rig: Rig, options: MirrorOptions, report: Report) -> Rig:
    """Put the twist joints of one side along the other side's bones, with the same settings."""
    records, bones = rig.records(TwistRecord), dict[tuple[str, str], list[int]]()
    for node in of_side(rig, options, TwistRecord):
        bones.setdefault((records[node].joint, records[node].to), []).append(node)
    by_first = {nodes[0]: nodes for nodes in bones.values()}

    def build(rig: Rig, node: int, report: Report) -> Rig:
        return _twists(rig, by_first[node], options, report)

    return mirror_each(rig, by_first, "twist joint", build, report)


def _twists(rig: Rig, nodes: list[int], options: MirrorOptions, report: Report) -> Rig:
    by_number = {rig.records(TwistRecord)[node].number: node for node in nodes}
    records = {number: rig.records(TwistRecord)[node] for number, node in sorted(by_number.items())}
    first = next(iter(records.values()))
    joint, to = twin_address(rig, first.joint), twin_address(rig, first.to)
    whole = len(records) == first.count and [*records] == list(range(1, first.count + 1))
    upper, axis = first.driver == first.joint, first.axis
    if axis is not None:
        axis = direction(rig, rig.find(first.joint), rig.find(joint), axis, options)
    known = {number: find(rig, TwistRecord, joint=joint, to=to, number=number) for number in by_number}
    there = [node for node in known.values() if node is not None]
    moving = moving_points(rig.skins, len(rig))
    split = bool(moving[nodes].any()) and not moving[there].any()
    if not split and all(_same_twist(rig, records[number], known[number], axis) for number in by_number):
        # They follow already, and have been carried along where axes turned: keys keep their bits.
        for node in there:
            report.added.append({"node": rig.names[node], "type": "twist", "new": False})
        return rig
    twist_options = AddTwistOptions(
        joint=(joint,),
        to=(to,),
        count=first.count,
        weights=tuple(record.weight for record in records.values()) if whole else (),
        upper=upper,
        lower=not upper,
        axis=axis,
        # Shared weight is shared already where joints of the other side have any.
        split_weights=split,
        keys=not rig.clips or any(t.node in nodes for clip in rig.clips for t in clip.tracks),
    )
    rig = add_twist(rig, options=twist_options, report=report)
    new = {number: node for number, node in by_number.items() if known[number] is None}
    return _named_as_twins(rig, new, (joint, to), report)


def _same_twist(rig: Rig, record: TwistRecord, there: int | None, axis: Triple | None) -> bool:
    """Whether a twist joint already has what its twin has; ``axis``: the mirrored one."""
    expected = twin_record(rig, record)
    if there is None or expected is None:
        return False
    own = rig.records(TwistRecord)[there]
    expected = replace(expected, axis=axis, rest=own.rest, standing=own.standing)
    return same_values(expected.to_dict(), own.to_dict(), 1.0)


def _named_as_twins(rig: Rig, new: Mapping[int, int], bone: tuple[str, str], report: Report) -> Rig:
    """New twist joints called as the source's twins would be, where a user has named those."""
    for number, node in new.items():
        joint = rig.records(TwistRecord)[node].joint
        found = find(rig, TwistRecord, joint=bone[0], to=bone[1], number=number)
        if found is not None and rig.names[node] != NAME.format(joint=joint, number=number):
            was = rig.names[found]
            rig = renamed(rig, found, twin_name(rig.names[node], was))
            for k, entry in enumerate(report.added):
                if entry["node"] == was:
                    report.added[k] = entry | {"node": rig.names[found]}
    return rig
