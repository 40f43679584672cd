"""What an extension binds to the axes of nodes, in the file's own node numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal

from rigtri.report import Notice

Pointer = tuple[str | int, ...]
Kind = Literal["rotation", "roll", "aim", "tail"]


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
    data in place of a transform.
    """

    humanoid: dict[str, int] = field(default_factory=dict)
    fixed: dict[int, str] = field(default_factory=dict)
    bound: list[tuple[int, list[float], Pointer]] = field(default_factory=list)
    facing: tuple[float, float, float] = (0.0, 0.0, 1.0)
    orient_locked: str = ""
    split_locked: str = ""
    bones: set[int] = field(default_factory=set)
    data_nodes: set[int] = field(default_factory=set)
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
