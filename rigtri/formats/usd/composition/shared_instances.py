"""Instances that share a prototype with a skeleton or an animation: one of them stands for all.

What lies below instances of one prototype is the same in each, and an edit of one is an edit of all
(`opinions.instance_edits`). So it is read once, from the first; the others differ by where they stand,
and by the animations that their skeletons inherit from above.

Source: OpenUSD glossary, "Instancing".
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pxr import Sdf, Usd, UsdGeom

_SKEL = ("Skeleton", "SkelAnimation")
# The custom data of the classes through which prototypes are edited: what a later edit may write into.
CLASS = {"rigtri": "instances"}


def is_own_class(spec: Any) -> bool:
    """Whether a prim spec is a class of rigtri, or lies below one: no prim that a user made."""
    (root, *_) = spec.path.GetPrefixes()
    top = spec.layer.GetPrimAtPath(root)
    return bool(top.specifier == Sdf.SpecifierClass and top.customData.get("rigtri") == CLASS["rigtri"])


class SharedInstances:
    """The instances of a stage. skeletons: Skeleton prims of all, by the path of the one that is read."""

    def __init__(self, stage: Any) -> None:
        self._stage = stage
        self._first: dict[Any, Any] = {}  # by prototype, the path of its first instance
        self._below: dict[Any, list[tuple[Any, Any]]] = {}  # the skeletons of a first instance
        self._twins: dict[Any, Any] = {}
        self.skeletons: dict[str, list[Any]] = {}
        every: list[tuple[Any, Any]] = []
        for prim in self._walk():
            if prim.GetPath() in self._twins:
                every += self._skeletons_of(prim.GetPath(), every)
            elif prim.GetTypeName() == "Skeleton":
                every.append((prim.GetPath(), prim.GetPath()))
        for path, first in every:
            self.skeletons.setdefault(str(first), []).append(stage.GetPrimAtPath(path))

    def prims(self) -> Iterator[Any]:
        """Every prim in order, in instances too, without what lies below those that are not read."""
        walk = iter(Usd.PrimRange(self._stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()))
        for prim in walk:
            if prim.GetPath() in self._twins:
                walk.PruneChildren()
            yield prim

    def stands_for(self, path: Any) -> Any:
        """The path at which a prim is read: that in the first instance of its prototype."""
        for above in path.GetPrefixes() if self._twins else ():
            if above in self._twins and above != path:
                return self.stands_for(path.ReplacePrefix(above, self._twins[above]))
        return path

    def each(self, path: Any) -> list[Any]:
        """All paths at which what is read at one is seen: that in the first instance, and in its twins."""
        twins: dict[Any, list[Any]] = {}
        for twin, first in self._twins.items():
            twins.setdefault(first, []).append(twin)
        found = {path: None}
        waiting = [path]
        while waiting:
            one = waiting.pop()
            above = one.GetPrefixes()[:-1]
            more = [one.ReplacePrefix(first, twin) for first in above for twin in twins.get(first, ())]
            waiting += [path for path in more if path not in found]
            found |= dict.fromkeys(more)
        return list(found)

    def twins(self) -> Mapping[Any, Any]:
        """The instances that are not read, each with the one that is read in their place."""
        return self._twins

    def placeless(self) -> set[Any]:
        """Instances without a transform of their own that share a prototype with some that have one."""
        groups: dict[Any, list[Any]] = {}
        for twin, first in self._twins.items():
            groups.setdefault(first, [first]).append(twin)
        found: set[Any] = set()
        for group in groups.values():
            bare = [at for at in group if not self._stage.GetPrimAtPath(at).IsA(UsdGeom.Xformable)]
            found.update(bare if len(bare) < len(group) else ())
        return found

    def is_twin(self, path: Any) -> bool:
        """Whether another instance is read in the place of this one."""
        return path in self._twins

    def _walk(self) -> Iterator[Any]:
        holds: dict[Any, bool] = {}
        walk = iter(Usd.PrimRange(self._stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()))
        for prim in walk:
            if prim.IsInstance():
                prototype = prim.GetPrototype()
                at = prototype.GetPath()
                if at not in holds:
                    below = Usd.PrimRange(prototype, Usd.TraverseInstanceProxies())
                    holds[at] = any(one.GetTypeName() in _SKEL for one in below)
                first = self._first.setdefault(at, prim.GetPath())
                if holds[at] and first != prim.GetPath():
                    self._twins[prim.GetPath()] = first
                    walk.PruneChildren()
            yield prim

    def _skeletons_of(self, twin: Any, known: list[tuple[Any, Any]]) -> list[tuple[Any, Any]]:
        """The skeletons below an instance that is not read, and those that are read in their place."""
        first = self._twins[twin]
        if first not in self._below:
            self._below[first] = [entry for entry in known if entry[0].HasPrefix(first)]
        return [(path.ReplacePrefix(first, twin), read) for path, read in self._below[first]]
