"""Which nodes the metadata of rigtri refer to, on a stage that may be composed of many files.

Metadata name joints and controls as they are called in the file that rigtri wrote. A stage that refers to
it more than once, or to another character of the same joints, has several nodes of that name; the one
that is meant is the nearest to what has the metadata. Here names become addresses that no other node has.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import takewhile
from typing import Any

from rigtri.formats.usd.reading.node_keys import kind, parts
from rigtri.model.metadata import REFERENCES
from rigtri.model.rig import Rig


def with_references(rig: Rig) -> Rig:
    """The rig with metadata whose names of nodes are found where several nodes are called so."""
    if not rig.metadata:
        return rig
    found = _Finder(rig)
    metadata = {node: found.resolved(node, "", stored) for node, stored in rig.metadata.items()}
    return replace(rig, metadata=metadata)


class _Finder:
    """Nodes by what metadata call them: names, and tokens of joints."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self.names: dict[str, set[int]] = {}
        for node, key in enumerate(rig.keys):
            token = parts(key)[2:] if kind(key) == "joint" else ()
            for name in (rig.names[node], *token):
                self.names.setdefault(name, set()).add(node)

    def resolved(self, node: int, key: str, value: Any) -> Any:
        """A value of a node's metadata, with addresses for names that several nodes have."""
        if isinstance(value, str):
            several = value and key in REFERENCES and self.rig.known(value) is None
            return self._nearest(node, value) if several else value
        if isinstance(value, Mapping):
            return {inner: self.resolved(node, inner, item) for inner, item in value.items()}
        if isinstance(value, list):
            return [self.resolved(node, key, item) for item in value]
        return value

    def _nearest(self, node: int, name: str) -> str:
        """The address of the node of a name that shares the most steps with a node, else the name."""
        own = self._place(node)
        shared = {there: _shared(own, self._place(there)) for there in self.names.get(name, ())}
        best = [there for there, steps in shared.items() if steps == max(shared.values())]
        joints = [there for there in best if self.rig.is_joint[there]]
        best = joints if len(joints) == 1 else best
        return self.rig.address(best[0]) if len(best) == 1 else name

    def _place(self, node: int) -> list[str]:
        """The path of the prim that a node is, or of its skeleton, step by step."""
        return str(parts(self.rig.keys[node])[1]).split("/")


def _shared(one: list[str], other: list[str]) -> int:
    """How many steps two paths share from the root on."""
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(one, other, strict=False)))
