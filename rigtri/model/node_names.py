"""What the nodes of a rig are called, and finding them by it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from fnmatch import fnmatchcase
from functools import cached_property
from typing import Self

from rigtri.errors import AmbiguousNameError, InstanceNameError, NameNotFoundError
from rigtri.maths.arrays import Booleans
from rigtri.model.addresses import DEEPEST_PATH, Addresses, addresses_of, named
from rigtri.model.format_rules import FormatRules
from rigtri.model.hierarchy import Hierarchy


class NodeNames(Hierarchy, ABC):
    """Nodes with names: what `rigtri.model.rig.Rig` finds its nodes by."""

    names: tuple[str, ...]
    labels: tuple[str, ...]
    humanoid: Mapping[str, int]
    rules: FormatRules

    @property
    @abstractmethod
    def is_joint(self) -> Booleans:
        """Which nodes are joints, (n,)."""

    @property
    @abstractmethod
    def holders(self) -> frozenset[int]:
        """Nodes that are no step of a path."""

    def path(self, node: int) -> str:
        """The names from the root down to a node, ``/root/hips/spine``; ``#index`` for a nameless one.

        The label alone for a node deeper than `DEEPEST_PATH`. A node that holds the axes of a joint
        is no step on the way to what is below it, so that paths stay what they were before the
        joint was split.
        """
        if known := vars(self).get("_addresses"):
            return str(known.paths[node])
        if self.depth[node] > DEEPEST_PATH:
            return self.labels[node]
        above = [each for each in self.path_to_root(node)[1:] if each not in self.holders]
        return "/" + "/".join(self.names[each] or self.labels[each] for each in reversed([node, *above]))

    def address(self, node: int) -> str:
        """What finds a node again, in this file and in others like it: name, path or label.

        The first of the three that no other node shares.
        """
        name = self.names[node]
        if name and len(self.by_name[name]) == 1:
            return name
        path = self._addresses.paths[node]
        return path if len(self._by_address(path)) == 1 else self.labels[node]

    def title(self, node: int) -> str:
        """What to call a node in a message: its name, with its label where several share it."""
        name = self.names[node]
        if not name:
            return self.labels[node]
        return f"{name} ({self.labels[node]})" if len(self.by_name[name]) > 1 else name

    def chain_title(self, nodes: Iterable[int]) -> str:
        """A chain, or a limb, in a message: the titles of its nodes, from the root on."""
        return " - ".join(map(self.title, nodes))

    def beside(self, node: int) -> list[int]:
        """The nodes that a child of a node (−1: a root) may not share its name with.

        All nodes, but for joints of a Skeleton prim (USD) those of other skeletons.
        """
        mine = self.skeleton_of[node] if node >= 0 else -1
        return [k for k, other in enumerate(self.skeleton_of) if mine < 0 or other in (mine, -1)]

    def names_beside(self, node: int) -> set[str]:
        """The names that a child of a node (−1: a root) may not have, see `beside`."""
        return {self.names[k] for k in self.beside(node)}

    @cached_property
    def skeleton_of(self) -> list[int]:
        """For each node the one of `FormatRules.skeletons` that it is or is below; −1 for none."""
        found: list[int] = []
        for node, parent in enumerate(self.parents.tolist()):
            above = found[parent] if parent >= 0 else -1
            found.append(node if node in self.rules.skeletons else above)
        return found

    @cached_property
    def by_name(self) -> Mapping[str, list[int]]:
        """The nodes of each name."""
        return named(self.names)

    @cached_property
    def _addresses(self) -> Addresses:
        """What the nodes are called beside their names, but for VRM bones."""
        addresses = Addresses(self.names, self.labels, self.parents, self.is_joint, self.holders)
        return addresses_of(addresses, self.by_name)

    def after(self, before: NodeNames) -> Self:
        """This rig, which begins as one that may be gone soon: what nodes are called follows from that."""
        if "_addresses" in vars(before):
            _ = self._addresses
        return self

    def _by_address(self, way: str) -> list[int]:
        found = self._addresses.get(way)
        bone = self.humanoid.get(way.removeprefix("vrm:")) if way.startswith("vrm:") else None
        return found if bone is None else [*found, bone]

    @property
    def _qualified(self) -> list[str]:
        """The labels, with what holds a joint in front where labels are paths: ``/Hero/Skel:hips/spine``.

        So are joints labelled that several skeletons of a file share: a script may name all of them alike.
        """
        return self._addresses.qualified

    @property
    def _hints(self) -> list[str]:
        """What nodes may be called, without the labels of those that no file has yet."""
        ways = {**dict.fromkeys(self._addresses.ways), **{f"vrm:{bone}": None for bone in self.humanoid}}
        return [*self.by_name, *(way for way in ways if not way.startswith("+"))]

    def find(self, name: str, kind: str = "joint") -> int:
        """The one node called ``name``: its name, its label (``#3``), its path, its `title`, or ``vrm:head``.

        A joint of USD is also called by its Skeleton and token, ``/Hero/Skel:hips/spine``.
        Raises NameNotFoundError, or AmbiguousNameError where several share the name.
        """
        _check_text(name)
        found = self._called(name)
        if not found:
            self.check_instances(name)
            raise NameNotFoundError(kind, name, self._hints)
        if len(found) > 1:
            raise AmbiguousNameError(kind, name, [self.labels[node] for node in found])
        return found[0]

    def _called(self, name: str) -> list[int]:
        """The nodes called ``name``, as `find` has it."""
        found = self.by_name.get(name, []) if name else []
        # A joint wins over a mesh node of the same name; nothing else is guessed.
        joints = [node for node in found if self.is_joint[node]]
        found = joints if len(joints) == 1 else found or self._by_address(name)
        return [node for node in found if node not in self.rules.others] or found

    def check_instances(self, name: str) -> None:
        """InstanceNameError for a name in an instance, where it names a node of the one that is read."""
        there = name
        for node, first in self.rules.instances.items():  # the outer ones come first
            label = self.labels[node]
            if there.startswith(f"{label}/"):
                there = f"{self.labels[first]}{there.removeprefix(label)}"
                if self.has(there):
                    raise InstanceNameError(name, label, self.labels[first], there)

    def has(self, name: str) -> bool:
        """Whether any node is called so, by name, label, path or VRM bone."""
        return bool(name and (self.by_name.get(name) or self._by_address(name)))

    def known(self, name: object) -> int | None:
        """The one node called so, as `find` has it; None where there is none, or several, or no name."""
        found = self._called(name) if isinstance(name, str) else []
        return found[0] if len(found) == 1 else None

    def match(self, pattern: str, among: Iterable[int] | None = None) -> list[int]:
        """All nodes that a glob such as ``*_L`` matches by name, label or path.

        An exact name wins over a pattern, so names with ``*`` or ``[`` in them can
        be given as they are. Of other characters than the one that is edited alone none is meant, but by
        a name that no node of that has. Raises NameNotFoundError when nothing matches.
        """
        _check_text(pattern)
        exact = self.by_name.get(pattern) or self._by_address(pattern)
        others = self.rules.others
        if exact:
            return sorted(node for node in exact if node not in others) or sorted(exact)
        found = [
            node
            for node in (range(len(self)) if among is None else among)
            if node not in others
            and any(
                fnmatchcase(text, pattern)
                for text in (self.names[node], self.labels[node], self._qualified[node], self.path(node))
                if text
            )
        ]
        if not found:
            raise NameNotFoundError("joint", pattern, self._hints, pattern=True)
        return found


def _check_text(name: object) -> None:
    """TypeError for what is no text."""
    if not isinstance(name, str):
        raise TypeError(f"a node is found by its name, or as text by its number ('#3'), not by {name!r}")
