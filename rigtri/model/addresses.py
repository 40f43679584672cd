"""What nodes are called beside their names, kept while a rig grows."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import TypeVar
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
        fresh.find(named(self.names))
        return [*fresh._first]


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

    def begins(self, names: tuple[str, ...]) -> bool:
        """Whether the nodes of another rig begin with these, or are these."""
        return self.names == names[: len(self.names)]


# Those of rigs in use.
_named: list[ref[Named]] = []
_known: list[ref[Addresses]] = []
# The last one: what a rig is called is often asked when that before it is gone.
_last: list[Addresses] = []

T = TypeVar("T", Named, Addresses)


def named(names: tuple[str, ...]) -> Named:
    """The nodes of each name, found from what is known of rigs before."""
    before = _longest(_named, lambda each: each.begins(names))
    if before is None or len(before.names) < len(names):
        before = _kept(_named, Named(names, before))
    return before


def addresses_of(new: Addresses, by_name: Mapping[str, Sequence[int]]) -> Addresses:
    """What the nodes of a rig are called, found from what is known of rigs before."""
    before = _longest(_known, lambda each: each.begins(new))
    if before is None or len(before.names) < len(new.names):
        new.find(by_name, before)
        before = _kept(_known, new)
    _last[:] = [before]
    return before


def _longest(known: Iterable[ref[T]], begins: Callable[[T], bool]) -> T | None:
    """Of what is still in use that of the most nodes with which another rig begins."""
    fitting = (each for one in known if (each := one()) is not None and begins(each))
    return max(fitting, key=lambda each: len(each.names), default=None)


def _kept(known: list[ref[T]], new: T) -> T:
    """What is new, which is known from now on."""
    known.append(ref(new))
    known[:] = [one for one in known if one() is not None][-_KEPT:]
    return new
