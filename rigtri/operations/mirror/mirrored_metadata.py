"""Mirrored metadata: names, positions and records of the other side, for every part of `mirror`.

Nodes that rigtri added are known by their metadata: the twin of a control is the control of the twin joint,
whatever either is called.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from rigtri.frames.mirroring import side_of, twin_of
from rigtri.maths.matrices import nearest_rotation
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot, length
from rigtri.model.joint_names import Side, twin
from rigtri.model.rig import Rig
from rigtri.operations.options.mirror import WHAT as WHAT
from rigtri.operations.options.mirror import MirrorOptions as MirrorOptions
from rigtri.operations.options.mirror import What as What
from rigtri.operations.rigtri_nodes import find
from rigtri.report import Report

# What the notes of a type are known by, beside their joints.
_KNOWN_BY = {
    "control": ("kind", "joint"),
    "offset": ("kind", "joint"),
    "poleVector": ("chain",),
    "twist": ("joint", "to", "number"),
    "constraint": ("child", "kind"),
}
_DEEPEST = 4
# Numbers of a note that differ by less are what float32 and a re-oriented parent leave of the same.
ALIKE = 4e-6


def side(rig: Rig, node: int) -> Side:
    """The side of a node: of the joints that its note is about, else what it or its bone is called."""
    note = rig.metadata.get(node, {})
    sides = {side_of(rig, k) for name in joints_of(note) if (k := rig.known(name)) is not None and k != node}
    sides -= {""}
    if len(sides) == 1:
        return sides.pop()
    return side_of(rig, node)


def other(rig: Rig, node: int, deep: int = 0) -> int | None:
    """The twin of a node, itself where it is on neither side; None where there is none.

    deep: how many notes have led here; those of a broken file may name each other in a circle.
    """
    note = rig.metadata.get(node, {})
    keys = _KNOWN_BY.get(str(note.get("type")), ())
    if keys and deep < _DEEPEST and side(rig, node):
        there = twin_note(rig, note, deep + 1)
        if there is None:
            return None
        return find(rig, type=note["type"], **{key: there[key] for key in keys if key in there})
    return twin_of(rig, node) if side(rig, node) else node


def joints_of(note: Mapping[str, Any]) -> list[str]:
    """The nodes that a note is about, and that show its side."""
    if note.get("type") == "limb":
        return list(note.get("chain", ()))
    if note.get("type") == "poseReader":
        return [str(note.get("driver"))]
    names = [*note.get("chain", ()), *(note[key] for key in ("joint", "to") if key in note)]
    return [*names, *([note["child"]] if "child" in note else ())]


def of_side(rig: Rig, options: MirrorOptions, kind: str) -> Iterator[tuple[int, Mapping[str, Any]]]:
    """The nodes with notes of a type, about joints of the side that is copied alone."""
    for node, note in list(rig.metadata.items()):
        if note.get("type") == kind:
            nodes = (rig.known(name) for name in joints_of(note))
            sides = {side(rig, k) for k in nodes if k is not None} - {""}
            if sides == {options.from_side}:
                yield node, note


def twin_note(rig: Rig, note: Mapping[str, Any], deep: int = 0) -> dict[str, Any] | None:
    """The note of the twin: the same of the twins of its joints; None where one of those is missing."""
    twins: dict[str, str] = {}
    for name in joints_of(note):
        node = rig.known(name)
        there = None if node is None else other(rig, node, deep)
        if there is None:
            return None
        twins[name] = rig.address(there)
    found = dict(note)
    for key in ("joint", "to", "driver", "child"):
        if key in note:
            node = rig.known(note[key])
            found[key] = twins.get(note[key]) or _address(rig, node, deep)
    if "chain" in note:
        found["chain"] = [twins[name] for name in note["chain"]]
    if "side" in note:
        found["side"] = {"left": "right", "right": "left", "": ""}[str(note["side"])]
    return found


def _address(rig: Rig, node: int | None, deep: int) -> str:
    there = None if node is None else other(rig, node, deep)
    return "" if there is None else rig.address(there)


def twin_name(name: str, fallback: str) -> str:
    """The name of the other side, or ``fallback`` where the name says no side."""
    return fallback if twin(name) == name else twin(name)


def lone(rig: Rig, node: int, report: Report, what: str, why: str = "") -> None:
    """Say that something of one side is not mirrored, and why."""
    reason = why or "the other side has no such joint"
    report.warn("not-mirrored", f"{what} '{rig.title(node)}' is not mirrored: {reason}")


def direction(rig: Rig, here: int, there: int, own: Floats, options: MirrorOptions) -> Floats:
    """A direction in the axes of a node, (3,), as the mirrored direction in the axes of its twin."""
    world = rig.world
    axes, twins = nearest_rotation(world[[here, there]])
    seen = own[0] * axes[0] + own[1] * axes[1] + own[2] * axes[2]
    return tidy(np.array([dot(options.across.directions(seen), row) for row in twins]))


def tidy(direction: Floats) -> Floats:
    """A direction with the parts that are an axis up to rounding made so."""
    whole = np.rint(direction)
    return np.where(np.abs(direction - whole) < ALIKE, whole, direction) + 0.0


def alike(one: Any, other_one: Any, size: float) -> bool:
    """Whether two notes, or parts of them, say the same but for rounding; ``size``: of the rig."""
    if isinstance(one, Mapping) and isinstance(other_one, Mapping):
        return one.keys() == other_one.keys() and all(alike(one[k], other_one[k], size) for k in one)
    if isinstance(one, list | tuple) and isinstance(other_one, list | tuple):
        if len(one) != len(other_one):
            return False
        if (
            len(one) >= 16
            and len(one) % 16 == 0
            and all(isinstance(x, float | int) for x in (*one, *other_one))
        ):
            return _matrices_alike(np.array(one, float), np.array(other_one, float), size)
        return all(alike(a, b, size) for a, b in zip(one, other_one, strict=True))
    number = isinstance(one, float | int) and isinstance(other_one, float | int)
    if number and not isinstance(one, bool):
        return bool(abs(one - other_one) <= ALIKE * max(1.0, abs(one)))
    return bool(one == other_one)


def _matrices_alike(one: Floats, two: Floats, size: float) -> bool:
    a, b = one.reshape(-1, 4, 4), two.reshape(-1, 4, 4)
    longest = max(1.0, float(length(a[:, :3, :3]).max()))
    near = np.abs(a[:, :3] - b[:, :3]).max() <= ALIKE * longest
    return bool(near and np.abs(a[:, 3] - b[:, 3]).max() <= ALIKE * max(size, 1e-30) * longest)


def size_of(rig: Rig) -> float:
    """How far joints stand from the origin: what their rounding is a share of."""
    found = rig.world[rig.is_joint, 3, :3]
    return float(length(found).max()) if len(found) else 1.0
