"""What nodes are called beside their names, kept while a rig grows."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from weakref import ref

import numpy as np

from rigtri.maths.arrays import Booleans, Integers

# A node with more nodes above it has its label for a path: the paths of a chain of n nodes
# would need n² characters.
DEEPEST_PATH = 256
# Rigs of an edit that are looked at again: the one of the file, one of its characters, and the last ones.
_KEPT = 8
# New ways are kept apart until they are a share of all of them: what is apart is copied with each change.
_APART = 8


class Addresses:
    """The nodes of a rig by label, path, qualified path (`NodeNames`), and title where a name is shared.

    names, labels: of n nodes, parents first. parents, joints: (n,). holders: no steps of a path.
    """

    def __init__(
        self,
        names: tuple[str, ...],
        labels: tuple[str, ...],
        parents: Integers,
        joints: Booleans,
        holders: Collection[int],
    ) -> None:
        self.names, self.labels, self.parents, self.joints = names, labels, parents, joints
        self.holders = holders
        self.paths: list[str] = []
        self.qualified: list[str] = []
        self._depth: list[int] = []
        # What is in front of the path of a child; with holders among the steps; what holds joints below.
        self._above: list[str] = []
        self._wholes: list[str] = []
        self._held: list[str] = []
        self._first: dict[str, list[int]] = {}
        self._more: dict[str, list[int]] = {}

    def get(self, way: str) -> list[int]:
        """The nodes that are called so, in their order."""
        first, more = self._first.get(way), self._more.get(way)
        if first is None or more is None:
            return first or more or []
        return sorted([*first, *more])

    def begins(self, other: Addresses) -> bool:
        """Whether the nodes of another rig begin with these, or are these, as far as their ways go."""
        n = len(self.names)
        return (
            n <= len(other.names)
            and self.names == other.names[:n]
            and self.labels == other.labels[:n]
            and self.holders == other.holders
            and np.array_equal(self.parents, other.parents[:n])
            and np.array_equal(self.joints, other.joints[:n])
        )

    def find(self, by_name: Mapping[str, Sequence[int]], before: Addresses | None = None) -> None:
        """Find the ways of all nodes; before: those of a rig that these begin with."""
        known = 0
        if before is not None:
            known = len(before.names)
            self.paths, self.qualified, self._depth = [*before.paths], [*before.qualified], [*before._depth]
            self._above, self._wholes, self._held = [*before._above], [*before._wholes], [*before._held]
            self._first, self._more = before._first, {way: [*at] for way, at in before._more.items()}
            if len(self._more) * _APART > len(self._first):
                self._first = {way: self.get(way) for way in (*self._first, *self._more)}
                self._more = {}
        for node, parent in enumerate(self.parents[known:].tolist(), known):
            self._step(node, parent)
            name, label = self.names[node], self.labels[node]
            ways = {label: None, self.paths[node]: None, self.qualified[node]: None}
            if self.holders:
                ways[self._wholes[node]] = None
            if name and len(by_name[name]) > 1:
                ways[f"{name} ({label})"] = None
                first = by_name[name][0]
                if first < known <= by_name[name][1]:  # the one that had this name
                    self._add_title(first)
            for way in ways:
                self._more.setdefault(way, []).append(node)
        if not known:
            self._first, self._more = self._more, {}

    def _step(self, node: int, parent: int) -> None:
        """Find path, depth and qualified path of a node from its parent's."""
        root, label = parent < 0, self.labels[node]
        depth = 0 if root else self._depth[parent] + 1
        step = f"/{self.names[node] or label}"
        deep = depth > DEEPEST_PATH
        path = label if deep else ("" if root else self._above[parent]) + step
        self._depth.append(depth)
        self.paths.append(path)
        self._above.append(("" if root else self._above[parent]) if node in self.holders else path)
        if self.holders:
            self._wholes.append(label if deep else ("" if root else self._wholes[parent]) + step)
        above = "" if root else self._held[parent]
        is_path, joint = label.startswith("/"), bool(self.joints[node])
        self._held.append(above if joint or not is_path else label)
        # The token of a joint may begin as the path of a prim does.
        whole = not above or label.startswith(f"{above}:") or (is_path and not joint)
        self.qualified.append(label if whole else f"{above}:{label}")

    def _add_title(self, node: int) -> None:
        """Add the title of a node whose name has company now."""
        title = f"{self.names[node]} ({self.labels[node]})"
        if node not in self.get(title):
            self._more.setdefault(title, []).append(node)

    @property
    def ways(self) -> list[str]:
        """All ways, in the order of the nodes."""
        fresh = Addresses(self.names, self.labels, self.parents, self.joints, self.holders)
        by_name: dict[str, list[int]] = {}
        for node, name in enumerate(self.names):
            by_name.setdefault(name, []).append(node)
        fresh.find(by_name)
        return [*fresh._first]


# Those of rigs in use, and the last one: what a rig is called is often asked when that before it is gone.
_known: list[ref[Addresses]] = []
_last: list[Addresses] = []


class Named(dict[str, list[int]]):
    """The nodes of each name, in their order; their lists are shared with rigs that begin with these."""

    def __init__(self, names: tuple[str, ...], before: Named | None = None) -> None:
        super().__init__(before or {})
        self.names = names
        known = 0 if before is None else len(before.names)
        grown = dict[str, list[int]]()
        for node, name in enumerate(names[known:], known):
            grown.setdefault(name, []).append(node)
        for name, nodes in grown.items():
            self[name] = [*self[name], *nodes] if name in self else nodes


# Of rigs in use.
_named: list[ref[Named]] = []


def named(names: tuple[str, ...]) -> Named:
    """The nodes of each name, found from what is known of rigs before."""
    known = [each for one in _named if (each := one()) is not None]
    fitting = (each for each in known if each.names == names[: len(each.names)])
    before = max(fitting, key=lambda each: len(each.names), default=None)
    if before is None or len(before.names) < len(names):
        before = Named(names, before)
        _named[:] = map(ref, [*known, before][-_KEPT:])
    return before


def addresses_of(new: Addresses, by_name: Mapping[str, Sequence[int]]) -> Addresses:
    """What the nodes of a rig are called, found from what is known of rigs before."""
    known = [each for one in _known if (each := one()) is not None]
    fitting = (each for each in known if each.begins(new))
    before = max(fitting, key=lambda each: len(each.names), default=None)
    if before is None or len(before.names) < len(new.names):
        new.find(by_name, before)
        _known[:] = map(ref, [*known, new][-_KEPT:])
        before = new
    _last[:] = [before]
    return before
