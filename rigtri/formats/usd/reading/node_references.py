"""Which nodes the metadata of rigtri refer to, on a stage that may be composed of many files.

A prim refers to others by relationships, which composition carries along: `rigtri:KEY:target` has the
prims, `rigtri:KEY:indices` which of them each reference means (where there are several), and of a Skeleton
`rigtri:KEY` names the joint. Metadata of joints, and files of older versions, have names alone: one that
several nodes have means the nearest to what has the metadata. Here names become addresses that no other
node has.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from rigtri.formats.usd.composition.stage import DEFAULT
from rigtri.formats.usd.reading.metadata_attributes import INDICES, PREFIX, TARGET, attribute_name
from rigtri.formats.usd.reading.node_keys import kind, parts
from rigtri.model.metadata import Place, with_references
from rigtri.model.rig import Rig

_CHILD = PREFIX + "child"
# Behind the name of what is beyond what a reference brings; no node is called so.
_ELSEWHERE = " (elsewhere)"


def resolved(rig: Rig, stage: Any) -> Rig:
    """The rig with metadata that address the nodes of a stage that they mean."""
    if not rig.metadata:
        return rig
    found = _Finder(rig)
    metadata = {}
    for node, stored in rig.metadata.items():
        is_prim = kind(rig.keys[node]) == "prim"
        prim = stage.GetPrimAtPath(parts(rig.keys[node])[1]) if is_prim else None
        targets = read_targets(prim) if prim else {}
        if prim and _shows_again(prim, targets):
            targets[_CHILD] = [None]
        metadata[node] = with_references(stored, _Meaning(found, stage, node, targets))
    return replace(rig, metadata=metadata)


def read_targets(prim: Any) -> dict[str, list[str | None]]:
    """The prims that a prim's metadata refer to: for each attribute the path of each of its references.

    None for one that is beyond what a reference brings, so that it is not on this stage; "" for none.
    """
    found = {}
    for relation in prim.GetAuthoredPropertiesInNamespace(PREFIX.rstrip(":")):
        name, is_target, _ = relation.GetName().rpartition(TARGET)
        if is_target and hasattr(relation, "GetTargets"):
            paths = _targets(relation)
            indices = prim.GetAttribute(name + INDICES).Get() if prim.HasAttribute(name + INDICES) else None
            numbers = indices if isinstance(indices, Iterable) else ()  # of another type they mean none
            found[name] = paths if indices is None else [_at(paths, index) for index in numbers]
    return found


def _targets(relation: Any) -> list[str | None]:
    """The targets as they were authored, those that composition has left out as None."""
    left = list(relation.GetTargets())
    (spec, *_) = relation.GetPropertyStack(DEFAULT)
    authored = spec.targetPathList.GetAddedOrExplicitItems()
    if len(authored) <= len(left):
        return list(map(str, left))
    # Those that stay keep their order, and but for the root of a reference their names.
    found = [str(left.pop(0)) if left and left[0].name == path.name else None for path in authored]
    return [None] * len(authored) if left else found


def _shows_again(prim: Any, targets: Mapping[str, Sequence[str | None]]) -> bool:
    """Whether a constraint's child lies outside of the prim that an arc within the stage shows again with it.

    Its source constrains that child already.
    """
    child, stage = targets.get(_CHILD), prim.GetStage()
    places = {spec.path for spec in prim.GetPrimStack() if stage.HasLocalLayer(spec.layer)} if child else ()
    sources = (stage.GetPrimAtPath(path) for path in places if path.IsPrimPath() and path != prim.GetPath())
    return any(source and read_targets(source).get(_CHILD) == child for source in sources)


def _at(paths: Sequence[str | None], index: Any) -> str | None:
    return paths[index] if isinstance(index, int) and 0 <= index < len(paths) else ""


class _Meaning:
    """The addresses that the references of one node mean. targets: what `read_targets` gives of it."""

    def __init__(
        self, finder: _Finder, stage: Any, node: int, targets: Mapping[str, Sequence[str | None]]
    ) -> None:
        self.finder, self.stage, self.node, self.targets = finder, stage, node, targets

    def __call__(self, place: Place, name: str) -> str:
        attribute, number = attribute_name(place)
        paths = self.targets.get(attribute, ())
        # One prim is what all references mean.
        path = paths[0] if len(paths) == 1 else _at(paths, number)
        if path is None or (path and not self.stage.GetPrimAtPath(path)):
            return name + _ELSEWHERE  # whatever has its name here is another one
        found = self.finder.at(path, name)
        if found is None:
            found = self.finder.beside(self.node, name)
        if found is None:
            found = self.finder.rig.known(name)
        return self.finder.nearest(self.node, name) if found is None else self.finder.rig.address(found)


class _Finder:
    """Nodes by what metadata call them: names, and tokens of joints."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self.names: dict[str, set[int]] = {}
        self.prims: dict[str, int] = {}
        # By Skeleton, for a crowd has joints of each name.
        self.joints: dict[tuple[str, str], list[int]] = {}
        self._near: dict[str, dict[tuple[str, ...], list[int]]] = {}
        for node, key in enumerate(rig.keys):
            if kind(key) == "prim":
                self.prims[parts(key)[1]] = node
            token = parts(key)[2:] if kind(key) == "joint" else ()
            label = rig.labels[node].rpartition(":")[2]
            for name in {rig.names[node], label, *token}:
                self.names.setdefault(name, set()).add(node)
                if token:
                    self.joints.setdefault((str(parts(key)[1]), name), []).append(node)

    def at(self, path: str, name: str) -> int | None:
        """The joint of a name in the Skeleton at a path, else the prim there; None where there is none."""
        if path not in self.prims:
            return None
        # A path of names or of the skeleton is one of the file that had it first; its last step is the joint.
        token = name.partition(":")[2] or name if name.startswith("/") else name
        for called in (token, token.rpartition("/")[2]):
            joints = self.joints.get((path, called), ())
            if len(joints) == 1:
                return joints[0]
        return self.prims[path]

    def beside(self, node: int, name: str) -> int | None:
        """The joint of a name in a joint's own Skeleton: joints have tokens, and prims may be called so."""
        own = parts(self.rig.keys[node])
        joints = self.joints.get((str(own[1]), name), ()) if own[:1] == ("joint",) else ()
        return joints[0] if len(joints) == 1 else None

    def nearest(self, node: int, name: str) -> str:
        """The address of the node of a name that shares the most steps with a node, else the name."""
        own = self._prim_path(node)
        if name not in self._near:
            near = self._near[name] = dict[tuple[str, ...], list[int]]()
            for there in self.names.get(name, ()):
                steps = self._prim_path(there)
                for count in range(len(steps) + 1):
                    near.setdefault(steps[:count], []).append(there)
        shared = (self._near[name].get(own[:count]) for count in range(len(own), -1, -1))
        best = next(filter(None, shared), [])
        joints = [there for there in best if self.rig.is_joint[there]]
        best = joints if len(joints) == 1 else best
        return self.rig.address(best[0]) if len(best) == 1 else name

    def _prim_path(self, node: int) -> tuple[str, ...]:
        """The path of the prim that a node is, or of its skeleton, step by step."""
        return tuple(str(parts(self.rig.keys[node])[1]).split("/"))
