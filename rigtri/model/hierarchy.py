"""Nodes below nodes: what follows from the parents of a rig's nodes alone."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property

import numpy as np

from rigtri.maths.arrays import Booleans, Integers


class Hierarchy:
    """Nodes parents first. parents: (n,), −1 for a root, each smaller than its own index."""

    parents: Integers

    def __len__(self) -> int:
        return len(self.parents)

    @cached_property
    def levels(self) -> tuple[Integers, ...]:
        """Node indices by depth, roots first: each level's parents lie in the level before."""
        levels: list[list[int]] = [[] for _ in range(max(self.depth, default=-1) + 1)]
        for node, depth in enumerate(self.depth):
            levels[depth].append(node)
        return tuple(np.array(level, dtype=np.int64) for level in levels)

    @cached_property
    def depth(self) -> list[int]:
        """How many nodes are above each node."""
        depth: list[int] = []
        for parent in self.parents.tolist():
            depth.append(depth[parent] + 1 if parent >= 0 else 0)
        return depth

    @cached_property
    def children(self) -> tuple[tuple[int, ...], ...]:
        """The children of every node, in the file's order."""
        lists: list[list[int]] = [[] for _ in range(len(self))]
        for node, parent in enumerate(self.parents.tolist()):
            if parent >= 0:
                lists[parent].append(node)
        return tuple(map(tuple, lists))

    def path_to_root(self, node: int) -> list[int]:
        """A node and all above it, itself first; none for −1."""
        path = []
        while node >= 0:
            path.append(node)
            node = int(self.parents[node])
        return path

    def with_ancestors(self, nodes: Iterable[int]) -> set[int]:
        """Nodes and all above them; −1 is none."""
        found = set[int]()
        for node in nodes:
            while node >= 0 and node not in found:
                found.add(node)
                node = int(self.parents[node])
        return found

    def below(self, node: int) -> list[int]:
        """A node and everything under it, parents first."""
        inside = [node]
        for k in inside:  # it grows as it is walked
            inside += self.children[k]
        return sorted(inside)

    def is_below(self, node: int, other: int) -> bool:
        """Whether ``node`` is ``other`` or anywhere under it."""
        first, count = self._walk
        return first[other] <= first[node] < first[other] + count[other]

    def at_or_below(self, marked: Booleans) -> Booleans:
        """Which nodes are marked or below one that is, (n,)."""
        found = marked.copy()
        for level in self.levels[1:]:
            found[level] |= found[self.parents[level]]
        return found

    def under(self, nodes: Iterable[int]) -> Booleans:
        """Which nodes are below one of ``nodes``, (n,)."""
        marked = np.zeros(len(self), dtype=bool)
        marked[list(nodes)] = True
        return np.asarray((self.parents >= 0) & self.at_or_below(marked)[self.parents])

    @cached_property
    def _walk(self) -> tuple[list[int], list[int]]:
        """Where each node comes in a walk branch by branch, and how many nodes its branch has."""
        parents = self.parents.tolist()
        count = [1] * len(self)
        for node in range(len(self) - 1, -1, -1):
            if parents[node] >= 0:
                count[parents[node]] += count[node]
        first, free, after = [0] * len(self), [0] * len(self), 0
        for node, parent in enumerate(parents):
            first[node] = free[parent] if parent >= 0 else after
            free[node] = first[node] + 1
            if parent >= 0:
                free[parent] += count[node]
            else:
                after += count[node]
        return first, count
