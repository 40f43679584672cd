"""Names of controls: from a user's naming rule, and found again by their metadata."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from rigtri.errors import UsageError
from rigtri.model.rig import Rig
from rigtri.operations.rigtri_nodes import free_name, noted, plain_name
from rigtri.report import Report

# Keys of notes, at any depth, that hold addresses of nodes.
_ADDRESSES = frozenset(
    [
        *("joint", "to", "driver", "child", "control", "mesh", "worldUpObject", "frame", "node", "middle"),
        *("endAim", "drivers", "chain", "locators"),
    ]
)


def refuse_taken(rig: Rig, name: str, own: int | None = None) -> None:
    """UsageError for a name that a user has given and another node has."""
    if free_name(rig, name, own) != plain_name(name):
        raise UsageError(f"--name {name}: another node is called so")


def call(rig: Rig, targets: Mapping[int, str], rule: str, report: Report) -> Rig:
    """Give controls the names that a rule makes, with their offsets; those that a user has renamed stay.

    UsageError where the rule gives several one name, or one that another node has.
    """
    names = {node: plain_name(name) for node, name in targets.items()}
    names = {node: name for node, name in names.items() if _may_change(rig, node, name, report)}
    for name, count in Counter(names.values()).items():
        if count > 1:
            raise UsageError(
                f"--name {rule}: {count} controls would be called '{name}'; {{joint}} tells them apart"
            )
    others = {rig.names[node]: node for node in range(len(rig)) if node not in names}
    for name in names.values():
        if name in others:
            raise UsageError(f"--name {rule}: another node is called '{name}'")
    before, offsets = rig, {}
    every = list(rig.names)
    for node, name in names.items():
        above = int(rig.parents[node])
        if rig.type_of(above) == "offset" and _goes_along(rig, node, above):
            offsets[above] = f"{name}_offset"
        every[node] = name
    rig = replace(rig, names=tuple(every))
    for offset, name in offsets.items():
        every[offset] = free_name(rig, name, offset)
        rig = replace(rig, names=tuple(every))
    rig = _addressed(before, rig, [*names, *offsets])
    return remembered(rig, names)


def remembered(rig: Rig, nodes: Any) -> Rig:
    """The rig with notes that say what nodes are called, so that another name is known as a user's."""
    for node in nodes:
        rig = noted(rig, node, {**rig.metadata[node], "named": rig.names[node]})
    return rig


def _may_change(rig: Rig, node: int, name: str, report: Report) -> bool:
    """Whether a control has the name that it was given, or none yet."""
    if rig.keys[node] is None or rig.names[node] == name:
        return True
    mine = rig.metadata[node].get("named") == rig.names[node]
    if not mine or rig.is_joint[node]:
        why = "joints keep their names" if mine else "that name was not given by rigtri"
        report.warn("name-kept", f"'{rig.title(node)}' is not renamed to '{name}': {why}")
    return mine and not rig.is_joint[node]


def _goes_along(rig: Rig, node: int, offset: int) -> bool:
    return rig.names[offset].startswith(f"{rig.names[node]}_offset")


def _addressed(before: Rig, rig: Rig, nodes: list[int]) -> Rig:
    """The rig with notes that find renamed nodes where they are now."""
    now = {before.address(node): rig.address(node) for node in nodes}
    now = {old: new for old, new in now.items() if old != new}
    if not now:
        return rig
    for node, note in list(rig.metadata.items()):
        rig = noted(rig, node, {key: _follow(key, value, now) for key, value in note.items()})
    return rig


def _follow(key: str, value: Any, now: Mapping[str, str]) -> Any:
    if isinstance(value, str):
        return now.get(value, value) if key in _ADDRESSES else value
    if isinstance(value, Mapping):
        return {inner: _follow(inner, item, now) for inner, item in value.items()}
    if isinstance(value, list):
        return [_follow(key, item, now) for item in value]
    return value
