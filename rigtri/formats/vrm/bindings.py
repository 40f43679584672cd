"""What an extension binds to the axes of nodes, in the file's own node numbers, and node constraints.

Source: VRMC_node_constraint 1.0.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import field
from typing import Literal

from rigtri.formats.json_values import Value
from rigtri.model.dataclass import dataclass
from rigtri.report import Notice
from rigtri.text import and_more

Pointer = tuple[str | int, ...]
Kind = Literal["rotation", "roll", "aim", "tail"]
CONSTRAINT = "VRMC_node_constraint"
_AIM_AXES = {
    f"{word}{letter}": tuple(sign if k == axis else 0.0 for k in range(3))
    for axis, letter in enumerate("XYZ")
    for word, sign in (("Positive", 1.0), ("Negative", -1.0))
}
_ROLL_AXES = {letter: _AIM_AXES[f"Positive{letter}"] for letter in "XYZ"}
# Kind of constraint → the property of its axis, and its values.
_KINDS: tuple[Kind, ...] = ("roll", "aim", "rotation")
_AXES: dict[str, tuple[str, dict[str, tuple[float, ...]]]] = {
    "roll": ("rollAxis", _ROLL_AXES),
    "aim": ("aimAxis", _AIM_AXES),
    "rotation": ("", {}),
}


@dataclass(frozen=True)
class Follows:
    """A `rigtri.model.bindings.NodeConstraint` in the file's own node numbers. pointer: where it stands."""

    kind: Kind
    node: int
    source: int
    axis: tuple[float, ...] = (0.0, 0.0, 0.0)
    pointer: Pointer | None = None


@dataclass
class Bindings:
    """humanoid: bone → node. fixed: node → reason. bound: node, vector and where it stands in the JSON.

    split_locked: why no joint may be split, "" where they may.
    orient_locked: why joints may have no axes of their own, "" where they may; bones: the nodes, then,
    that have to be aligned with the world, or whose children have to. data_nodes: nodes that hold
    data in place of a transform. swinging: nodes that springs rotate, counted from how they rest.
    """

    humanoid: dict[str, int] = field(default_factory=dict)
    fixed: dict[int, str] = field(default_factory=dict)
    bound: list[tuple[int, list[float], Pointer]] = field(default_factory=list)
    facing: tuple[float, float, float] = (0.0, 0.0, 1.0)
    orient_locked: str = ""
    split_locked: str = ""
    bones: set[int] = field(default_factory=set)
    data_nodes: set[int] = field(default_factory=set)
    swinging: set[int] = field(default_factory=set)
    constraints: list[Follows] = field(default_factory=list)
    notices: list[Notice] = field(default_factory=list)

    def fix(self, node: int, reason: str) -> None:
        """Freeze a node; the first reason stays. −1, the parent of a root, is nothing to freeze."""
        if node >= 0:
            self.fixed.setdefault(node, reason)


def line(node: int, above: Sequence[int]) -> Iterator[int]:
    """A node and all above it."""
    while node >= 0:
        yield node
        node = above[node]


# --- VRMC_node_constraint: what drives a node, and about which of its axes


def read_constraint(extension: Value, node: int, above: Sequence[int], found: Bindings) -> None:
    """The constraints of a node; it should have one, and viewers take the first they know."""
    constraint = extension.need("constraint")
    for kind in _KINDS:
        item = constraint.get(kind)
        if item is None:
            continue
        source, (key, words) = item.need("source").index(len(above), "node"), _AXES[kind]
        axis: tuple[float, ...] = (0.0, 0.0, 0.0)
        if key:
            # Where it is not written viewers take the first.
            word = item.object().get(key, next(iter(words)))
            if not isinstance(word, str) or word not in words:
                item.need(key).fail(f"one of {', '.join(words)} should stand here, not {word!r}")
            axis = words[word]
        pointer: Pointer = ("nodes", node, "extensions", CONSTRAINT, "constraint", kind)
        found.constraints.append(Follows(kind, node, source, axis, pointer))


def report_cycles(above: Sequence[int], found: Bindings) -> None:
    """Say which constraints form a cycle, or depend on one: viewers refuse or ignore them."""
    if all(c.kind == "tail" for c in found.constraints):
        return
    # A node stands where it stands once its parent does and what drives it.
    edges = [(parent, node) for node, parent in enumerate(above) if parent >= 0]
    edges += [(c.source, c.node) for c in found.constraints if c.kind != "tail"]
    waits, frees = [0] * len(above), [list[int]() for _ in above]
    for first, then in edges:
        waits[then] += 1
        frees[first].append(then)
    free = [node for node, count in enumerate(waits) if not count]
    while free:
        for node in frees[free.pop()]:
            waits[node] -= 1
            if not waits[node]:
                free.append(node)
    cycle = sorted({c.node for c in found.constraints if waits[c.node]})
    if cycle:
        names = ", ".join(f"#{node}" for node in cycle[:6])
        text = f"The constraints of nodes {names} form a cycle, so viewers do not evaluate them"
        found.notices.append(Notice("constraint-circle", text))


def report_shared_bones(found: Bindings) -> None:
    """Say which bones of the humanoid have a node in common, where VRM has one for each."""
    bones_of: dict[int, list[str]] = {}
    for bone, node in found.humanoid.items():
        bones_of.setdefault(node, []).append(bone)
    for node, bones in bones_of.items():
        if len(bones) > 1:
            text = f"The humanoid has node #{node} for {and_more(bones, 4)}: these are recognised without it"
            found.notices.append(Notice("shared-bone", text))


def stored_axis(kind: str, axis: Sequence[float]) -> tuple[str, str]:
    """The property of a constraint's axis and the word for it; of a roll axis the sign does not matter."""
    key, words = _AXES[kind]
    numbers = tuple(abs(x) if kind == "roll" else x for x in axis)
    return key, next(word for word, known in words.items() if known == numbers)


def stored(kind: str, source: int, axis: Sequence[float]) -> dict[str, object]:
    """The extension of a node that follows ``source``, a file index, in full."""
    data: dict[str, object] = {"source": source, "weight": 1.0}
    if kind != "rotation":  # which has no axis
        key, word = stored_axis(kind, axis)
        data = {key: word, **data}
    return {"specVersion": "1.0", "constraint": {kind: data}}
