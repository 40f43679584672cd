"""Morph targets that a pose reader drives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from rigtri.errors import GeometryError, NameNotFoundError, UsageError
from rigtri.model.mesh import Mesh
from rigtri.model.mesh_triangles import meshes_named
from rigtri.model.rig import Rig
from rigtri.report import Report


@dataclass(frozen=True, eq=False)
class MorphDrive:
    """Which weights go to which morph targets of one node: columns (morph) by columns (target)."""

    meshes: Sequence[Mesh]
    columns: dict[int, int] = field(default_factory=dict)

    @property
    def mesh(self) -> Mesh:
        return self.meshes[0]


def morph_drives(
    rig: Rig, morphs: Sequence[tuple[str, str, str]], targets: Sequence[str], reader: str, report: Report
) -> list[MorphDrive]:
    """The morph targets that a reader drives, by the node that shows them. targets: the reader's, by name.

    morphs: (target, mesh, morph target) each. Raises NameNotFoundError, UsageError, GeometryError.
    """
    found: dict[int, MorphDrive] = {}
    for target, name, morph in morphs:
        meshes = [mesh for mesh in meshes_named(rig, name) if len(mesh.morphs)]
        if not meshes:
            raise GeometryError(f"Mesh '{name}' has no morph targets{_with_morphs(rig)}")
        drive = found.setdefault(meshes[0].node, MorphDrive(meshes))
        column = _column(meshes[0], morph)
        if column in drive.columns:
            raise UsageError(f"morph target '{morph}' of '{name}' can follow one target, not two")
        drive.columns[column] = targets.index(target)
        _warn_shared(rig, meshes[0], column, morph, reader, report)
    return list(found.values())


def _warn_shared(rig: Rig, mesh: Mesh, column: int, morph: str, reader: str, report: Report) -> None:
    """Warn where another reader drives a morph target too: the keys will be this one's."""
    for note in rig.metadata.values():
        if note.get("type") != "poseReader" or note.get("name") == reader:
            continue
        for output in note.get("outputs", ()):
            if rig.known(output.get("mesh")) == mesh.node and output.get("morph") in (
                str(column),
                *mesh.morph_names[column : column + 1],
            ):
                report.warn(
                    "morph-driven-twice",
                    f"Morph target '{morph}' of '{mesh.name}' is driven by reader '{note['name']}' too; "
                    f"its keys are now those of '{reader}'",
                    geometry=True,
                )


def _with_morphs(rig: Rig) -> str:
    """Which meshes have some, for a message."""
    have = list(dict.fromkeys(rig.title(m.node) for m in rig.meshes if len(m.morphs)))
    return f"; {', '.join(have[:6])} have some" if have else ", and no other mesh of this file has any"


def _column(mesh: Mesh, name: str) -> int:
    """The column of a morph target, by its name or its number."""
    if name in mesh.morph_names:
        return mesh.morph_names.index(name)
    if name.isdecimal() and int(name) < len(mesh.morphs):
        return int(name)
    if not mesh.morph_names:
        raise NameNotFoundError("morph target", name, map(str, range(len(mesh.morphs))))
    raise NameNotFoundError("morph target", name, mesh.morph_names)
