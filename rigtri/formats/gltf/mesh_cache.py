"""All that a glTF file draws, read once for all who measure it."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from rigtri.formats.gltf.mesh_reader import MeshReader
from rigtri.model.mesh import Mesh
from rigtri.model.skin import Skin


class Drawn:
    """What a reader finds to be drawn with some skins.

    It holds the reader and what was read, and neither holds it: a ring would keep the file open.
    """

    def __init__(self, reader: MeshReader, skins: Sequence[Skin]) -> None:
        self._reader, self._skins = reader, skins

    def meshes(self) -> Sequence[Mesh]:
        """Every primitive that can be read; the others are noticed."""
        return self._meshes

    @cached_property
    def _meshes(self) -> Sequence[Mesh]:
        return self._reader.read(self._skins)

    def outlines(self, *, closely: bool = False) -> Sequence[Mesh]:
        """The same; where a file has very many points, some of them and boxes for its largest meshes."""
        if not self._reader.crowd:
            return self._meshes
        return self._reader.outlines(self._skins, closely=closely)
