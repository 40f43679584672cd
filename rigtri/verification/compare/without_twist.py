"""Skin weights that go to twist joints: everything else must look as before while no twist joint rotates.

Weights that move from a joint to its twist joints change how a twisted pose looks, on purpose. While
the twist joints stand still, at rest and in every clip, nothing may.
"""

from __future__ import annotations

from collections.abc import Sequence, Set
from dataclasses import replace

from rigtri.evaluation.twist_joints import untwisted
from rigtri.model.dataclass import dataclass
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.verification.compare.changed_points import changed_points, some_points
from rigtri.verification.compare.compare import Comparison, DocumentView, Source, self_check, verify


@dataclass(frozen=True, eq=False)
class _SomeVertices(DocumentView):
    """A document with other meshes instead of its own."""

    vertices: Sequence[Mesh]

    def meshes(self) -> Sequence[Mesh]:
        return self.vertices


def without_twist(document: Source) -> DocumentView:
    """The document with its twist joints frozen as they stand without twist: no clip rotates them."""
    rig = untwisted(document.rig)
    frozen = _twist_joints(rig)
    clips = (
        replace(clip, tracks=tuple(t for t in clip.tracks if t.path != "rotation" or t.node not in frozen))
        for clip in rig.clips
    )
    return DocumentView(document, replace(rig, clips=tuple(clips)))


def compare_without_twist(before: Source, after: Source, *, behind: Set[str] = frozenset()) -> Comparison:
    """Compare two views `without_twist`, the second with skin weights redistributed.

    What all joints move is bounded as in `compare.self_check`; the vertices whose influences changed are
    compared one by one.
    """
    result = self_check(before, after, behind=behind)
    pairs = _pairs(before, after)
    changed = [
        (some_points(a, rows), some_points(b, rows)) for a, b in pairs if (rows := changed_points(a, b)).any()
    ]
    if not changed:
        return result
    mine, theirs = zip(*changed, strict=True)
    some = _SomeVertices(before, before.rig, mine), _SomeVertices(after, after.rig, theirs)
    vertices = verify(*some, sized_by=[mesh for mesh, _ in pairs])
    return _worse(result, vertices)


def _pairs(before: Source, after: Source) -> list[tuple[Mesh, Mesh]]:
    """The meshes of two files, each with itself; lines of controls are nobody's, and may be new.

    One that names joints beyond its skin cannot be read before twist joints are added to the skin, but after.
    """
    left: dict[str, list[Mesh]] = {}
    for mesh in after.meshes():
        if mesh.node not in after.rig.own:
            left.setdefault(mesh.name, []).append(mesh)
    mine = [mesh for mesh in before.meshes() if mesh.node not in before.rig.own]
    return [(mesh, left[mesh.name].pop(0)) for mesh in mine if left.get(mesh.name)]


def _twist_joints(rig: Rig) -> set[int]:
    return set(rig.nodes_of("twist"))


def _worse(bounds: Comparison, vertices: Comparison) -> Comparison:
    """The worse of a comparison by bounds and one of some vertices of the same files.

    What else is different says the first one, which knows what is rigtri's and may be drawn anew.
    """
    lost = tuple(dict.fromkeys((*bounds.lost, *vertices.lost)))
    both = replace(bounds, lost=lost, poses=max(bounds.poses, vertices.poses))
    if not vertices.deviation > bounds.deviation:
        return both
    return replace(
        both,
        deviation=vertices.deviation,
        diagonal=vertices.diagonal,
        absolute=vertices.absolute,
        worst=vertices.worst,
        raw_deviation=vertices.deviation,
    )
