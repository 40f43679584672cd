"""A file as an edit means it to be: what its result is compared with, where that is not the file itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from rigtri.compare import Source
from rigtri.records import Mesh
from rigtri.rig import Rig
from rigtri.scenery import Scenery


@dataclass(frozen=True)
class Intended:
    """What a document shows, moved as another rig of the same nodes moves it; ``after`` is the result.

    redrawn: nodes of ours whose lines are others on purpose.
    """

    document: Source
    rig: Rig
    after: Source
    redrawn: frozenset[int] = frozenset()

    def meshes(self) -> Sequence[Mesh]:
        return self.document.meshes()

    def outlines(self, *, closely: bool = False) -> Sequence[Mesh]:
        return self.document.outlines(closely=closely)

    def scenery(self, *, closely: bool = False) -> Scenery:
        found = self.document.scenery(closely=closely)
        if not self.redrawn:
            return found
        now = self.after.scenery(closely=closely).nodes
        place = {key: node for node, key in enumerate(self.after.rig.keys)}
        lines = {node: now.get(place.get(self.rig.keys[node], -1), {}) for node in self.redrawn}
        return replace(found, nodes={**found.nodes, **lines})


def intended(document: Source, rig: Rig, after: Source, *, reposed: bool) -> Source:
    """The document, as the edit to ``rig`` means it; reposed: what it shows is to move as ``rig`` does."""
    before = document.rig
    redrawn = frozenset(node for node in rig.shapes if node < len(before) and rig.keys[node] is not None)
    keyed = before if rig.names[: len(before)] == before.names else _keyed(before, rig, after.rig)
    if keyed is before and not redrawn and not reposed:
        return document
    return Intended(document, rig if reposed else keyed, after, redrawn)


def _keyed(before: Rig, rig: Rig, after: Rig) -> Rig:
    """The rig that was read, with the keys of the result where names have changed, and keys are names."""
    places = {after.path(node): key for node, key in enumerate(after.keys)}
    keys = [
        key if rig.path(node) == before.path(node) else places.get(rig.path(node), key)
        for node, key in enumerate(before.keys)
    ]
    return replace(before, keys=tuple(keys))
