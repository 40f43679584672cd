"""Instances that share a prototype with a skeleton or an animation: one of them stands for all.

What lies below instances of one prototype is the same in each, and an edit of one is an edit of all
(`opinions.instance_edits`). So it is read once, from the first whose meshes are skinned, if they are in
any; the others differ by where they stand, and by the animations that their skeletons inherit from above.

Source: OpenUSD glossary, "Instancing"; UsdSkel (meshes are skinned below a SkelRoot alone).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pxr import Sdf, Usd, UsdGeom, UsdSkel

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

    def __init__(self, stage: Any, others: Mapping[Any, Any] | None = None) -> None:
        """others: `twins` of another stage, where one that stands for an instance may do so here, too."""
        self._stage, self._others = stage, others
        self._first = self._read_instances()  # by group, the path of the instance that is read
        self._below: dict[Any, list[tuple[Any, Any]]] = {}  # the skeletons of an instance that is read
        self._twins: dict[Any, Any] = {}
        self.skeletons: dict[str, list[Any]] = {}
        walked = [
            prim.GetPath()
            for prim in self._walk()
            if prim.GetPath() in self._twins or prim.GetTypeName() == "Skeleton"
        ]
        # Each at its own place comes before its twins.
        for path in sorted(walked, key=self._twins.__contains__):
            for place, first in self._skeletons_at(path, walked):
                self.skeletons.setdefault(str(first), []).append(stage.GetPrimAtPath(place))

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
                first = self._first[self._group(prim)]
                if holds[at] and first != prim.GetPath():
                    self._twins[prim.GetPath()] = first
                    walk.PruneChildren()
            yield prim

    def _group(self, prim: Any) -> tuple[Any, Any]:
        """What instances share of which one is read: prototype, and with `others` what is read there."""
        path = prim.GetPath()
        read = None if self._others is None else self._others.get(path, path)
        return prim.GetPrototype().GetPath(), read

    def _read_instances(self) -> dict[Any, Any]:
        """By group the path of the instance that is read: the first below a SkelRoot, or of all."""
        found: dict[Any, tuple[Any, bool]] = {}
        walk = iter(Usd.PrimRange(self._stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()))
        for prim in walk if self._stage.GetPrototypes() else ():
            if not prim.IsInstance():
                continue
            at = self._group(prim)
            skinned = bool(UsdSkel.Root.Find(prim))
            if at in found and found[at][1] >= skinned:
                walk.PruneChildren()
                continue
            if at in found:  # nor is what is inside the one that was taken before
                left = found[at][0]
                found = {each: one for each, one in found.items() if not one[0].HasPrefix(left)}
            found[at] = prim.GetPath(), skinned
        return {at: path for at, (path, _) in found.items()}

    def _skeletons_at(self, path: Any, walked: list[Any]) -> list[tuple[Any, Any]]:
        """The skeletons at a path, or below an instance that is not read, each with the one that is read."""
        first = self._twins.get(path)
        if first is None:
            return [(path, path)]
        if first not in self._below:
            below = (one for one in walked if one.HasPrefix(first))
            self._below[first] = [each for one in below for each in self._skeletons_at(one, walked)]
        return [(place.ReplacePrefix(first, path), read) for place, read in self._below[first]]
