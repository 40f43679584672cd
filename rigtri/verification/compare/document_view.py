"""A document as it looks with another rig: what a comparison shows in place of a file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.verification.compare.compare import Source
from rigtri.verification.compare.scene_facts import Scenery


@dataclass(frozen=True, eq=False)
class DocumentView:
    """What ``document`` shows, moved by ``rig``."""

    document: Source
    rig: Rig

    def meshes(self) -> Sequence[Mesh]:
        return self.document.meshes()

    def outlines(self, *, closely: bool = False) -> Sequence[Mesh]:
        return self.document.outlines(closely=closely)

    def scenery(self, *, closely: bool = False) -> Scenery:
        return self.document.scenery(closely=closely)
