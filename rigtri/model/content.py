"""What a rig can read of its file when it is needed, and what it knows of that file."""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

from rigtri.maths.arrays import Integers
from rigtri.model.control_shapes import Lines, nothing
from rigtri.model.dataclass import dataclass
from rigtri.model.mesh import Mesh


class RigSource(Protocol):
    """The file that a rig was read from; only `rigtri.pipeline` looks inside."""

    def after(self, report: Any) -> RigSource: ...

    def needed(self) -> list[tuple[Path, str]]: ...


@dataclass(frozen=True, eq=False)
class Content:
    """What a file draws, read only when needed.

    read_lines: the lines drawn at the node of a key, None where something else is drawn there.
    read_outlines: meshes to measure, of large ones only some points. read_meshes: the same with all points.
    """

    read_lines: Callable[[Hashable], Lines | None] = nothing
    read_outlines: Callable[[], Sequence[Mesh]] = tuple
    read_meshes: Callable[[], Sequence[Mesh]] = tuple

    @cached_property
    def outlines(self) -> Sequence[Mesh]:
        """What to measure of all that is drawn. Kept, as rigs made one from another share it."""
        return self.read_outlines()

    @cached_property
    def meshes(self) -> Sequence[Mesh]:
        """All that is drawn and can be read; none for a rig that no file was read for."""
        return self.read_meshes()

    def without_skins(self, hidden: Collection[int]) -> Content:
        """The content without meshes of some skins, by number."""
        return replace(
            self,
            read_outlines=lambda: [mesh for mesh in self.outlines if mesh.skin not in hidden],
            read_meshes=lambda: [mesh for mesh in self.meshes if mesh.skin not in hidden],
        )

    def with_rows(self, rows: Mapping[int, Integers]) -> Content:
        """The content for skins, by number, of which joint k of a mesh is called ``rows[skin][k]``."""

        def called(meshes: Sequence[Mesh]) -> Sequence[Mesh]:
            found = ((mesh, None if mesh.skin is None else rows.get(mesh.skin)) for mesh in meshes)
            return [mesh if new is None else replace(mesh, joints=new[mesh.joints]) for mesh, new in found]

        return replace(
            self,
            read_outlines=lambda: called(self.outlines),
            read_meshes=lambda: called(self.meshes),
        )

    def reordered(self, new: Sequence[int]) -> Content:
        """The content with node k called ``new[k]``."""
        return replace(
            self,
            read_outlines=lambda: [replace(mesh, node=new[mesh.node]) for mesh in self.outlines],
            read_meshes=lambda: [replace(mesh, node=new[mesh.node]) for mesh in self.meshes],
        )
