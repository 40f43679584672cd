"""What the VRM family states besides axes, as plain facts: springs, expressions, bones, meta.

Vectors in the frames of nodes and axes of constraints are left out: they are compared in the
world (`compare.attachments`). Nodes are named by reference, meshes by the nodes that show them.

Source: VRM 0.0 and 1.0; VRMC_springBone, VRMC_node_constraint, VRMC_vrm_animation 1.0.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

from rigtri.formats.json_values import index_of
from rigtri.formats.vrm.bindings import CONSTRAINT, Pointer
from rigtri.model.scene_facts import Reference

BLOCKS = ("VRM", "VRMC_vrm", "VRMC_springBone", "VRMC_vrm_animation")
# The properties that name nodes; VRM 0 has −1 for none.
_NODES = ("node", "source", "center", "bones", "firstPersonBone")
# Among them those that mean what the node shows, by the list they stand in.
_SHOWN = ("morphTargetBinds", "meshAnnotations")
# Axes of constraints, which are compared in the world.
_AXES = ("rollAxis", "aimAxis")
# Deeper than any of these blocks is nested.
_DEEPEST = 24


def read_facts(
    gltf: Mapping[str, Any], place: Sequence[int], turned: Collection[Pointer]
) -> tuple[dict[str, Any], dict[int, dict[str, Any]]]:
    """Facts of the file, and of its nodes by place in the rig. place: of each node of the file.

    turned: where the vectors stand that are compared in the world.
    """
    reader = _Reader(gltf, place, {tuple(map(str, pointer[1:])) for pointer in turned})
    extensions = gltf.get("extensions")
    extensions = extensions if isinstance(extensions, dict) else {}
    whole = {
        fact: value
        for name in BLOCKS
        if name in extensions
        for fact, value in reader.facts(extensions[name], (name,))
    }
    nodes = {}
    for index, node in enumerate(gltf.get("nodes", [])):
        own = node.get("extensions")
        if isinstance(own, dict) and CONSTRAINT in own:
            nodes[place[index]] = dict(reader.facts(own[CONSTRAINT], (CONSTRAINT,)))
    return whole, nodes


class _Reader:
    def __init__(self, gltf: Mapping[str, Any], place: Sequence[int], turned: set[tuple[str, ...]]) -> None:
        self._turned = turned
        self._place, self._count = place, len(gltf.get("nodes", []))
        self._showing: dict[int, list[int]] = {}
        self._meshes = len(gltf.get("meshes", []))
        for index, node in enumerate(gltf.get("nodes", [])):
            if (mesh := index_of(node.get("mesh"), self._meshes)) is not None:
                self._showing.setdefault(mesh, []).append(index)

    def facts(self, value: Any, path: tuple[str, ...]) -> Iterator[tuple[str, Any]]:
        """Each number and word below ``value``, called by the way down to it."""
        nested = isinstance(value, dict | list) and len(path) < _DEEPEST
        if not nested:
            yield " ".join(path), value
            return
        if not value:
            yield " ".join(path), "empty"
        items = value.items() if isinstance(value, dict) else enumerate(value)
        for key, item in items:
            way = (*path, str(key))
            if key in _NODES:
                yield " ".join(way), self._nodes(item, any(part in _SHOWN for part in path))
            elif key == "mesh" and (mesh := index_of(item, self._meshes)) is not None:
                shown = [Reference(self._place[k], shows=True) for k in self._showing.get(mesh, ())]
                yield " ".join(way), shown or item
            elif way not in self._turned and key != "extras" and not (key in _AXES and CONSTRAINT in path):
                yield from self.facts(item, way)

    def _nodes(self, value: Any, shows: bool) -> Any:
        """References in place of the numbers of nodes; anything else as it stands."""
        if isinstance(value, list):
            return [self._nodes(item, shows) for item in value]
        node = index_of(value, self._count)
        return value if node is None else Reference(self._place[node], shows)
