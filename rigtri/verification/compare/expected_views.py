"""Documents as they are expected to look: in another unit, or moved as an edit in memory moves them."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import replace

import numpy as np

from rigtri.maths.matrices import multiply
from rigtri.model.dataclass import dataclass
from rigtri.model.mesh import Mesh
from rigtri.model.pending_edits import Conversion
from rigtri.verification.compare.compare import DocumentView, Source
from rigtri.verification.compare.converted_lenses import resized_lens
from rigtri.verification.compare.scene_facts import SceneFacts


@dataclass(frozen=True, eq=False)
class ConvertedView(DocumentView):
    """A document as it looks in a scene of another unit and up axis."""

    conversion: Conversion

    def scene_facts(self, *, closely: bool = False) -> SceneFacts:
        found = self.document.scene_facts(closely=closely)
        metrics = {"up axis": self.conversion.up.upper(), "metersPerUnit": self.conversion.metres}
        nodes = found.nodes
        if self.conversion.size != 1.0:
            nodes = {node: resized_lens(facts, self.conversion.size) for node, facts in nodes.items()}
        return replace(found, whole={**found.whole, **metrics}, nodes=nodes)


@dataclass(frozen=True, eq=False)
class PosedView(DocumentView):
    """What a document shows, moved as another rig with its nodes moves it.

    written: the result. keys: of the document's nodes in the result. position: where the rig has
    the document's nodes, (n,). redrawn: control shapes that are others on purpose, by node.
    """

    written: Source
    keys: tuple[Hashable, ...]
    position: Sequence[int]
    redrawn: frozenset[int] = frozenset()

    def meshes(self) -> Sequence[Mesh]:
        return self._placed(self.document.meshes())

    def outlines(self, *, closely: bool = False) -> Sequence[Mesh]:
        return self._placed(self.document.outlines(closely=closely))

    def _placed(self, meshes: Sequence[Mesh]) -> list[Mesh]:
        """Meshes at the nodes of the rig, with its morph weights at rest, bound in its sizes."""
        found = []
        for mesh in meshes:
            node = self.position[mesh.node]
            weights = self.rig.pending.morph_weights.get(node, mesh.morph_weights)
            if node != mesh.node or weights is not mesh.morph_weights:
                mesh = replace(mesh, node=node, morph_weights=weights)
            size = self.rig.pending.bind_sizes.get(mesh.skin) if mesh.skin is not None else None
            if size is not None:
                mesh = replace(mesh, bind=multiply(mesh.bind, np.diag([*size, 1.0])))
            found.append(mesh)
        return found

    def scene_facts(self, *, closely: bool = False) -> SceneFacts:
        found = self.document.scene_facts(closely=closely)
        nodes = dict(found.nodes)
        if self.redrawn:
            now = self.written.scene_facts(closely=closely).nodes
            there = {key: node for node, key in enumerate(self.written.rig.keys)}
            nodes |= {node: now.get(there.get(self.keys[node], -1), {}) for node in self.redrawn}
        moved = {self.position[node]: shown for node, shown in nodes.items()}
        return replace(found, nodes=moved, own={self.position[node]: own for node, own in found.own.items()})
