"""Compare two files over all poses, by their vertices or by bounds of what each joint moves.

`verify` moves the vertices themselves, of any two files; `self_check` compares a file with what an edit made
of it, and looks only where something changed. Both look at rest and in every clip.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Mapping, Sequence, Set
from dataclasses import replace
from typing import Literal, Protocol

import numpy as np

from rigtri.errors import FileError
from rigtri.frames.rig_size import sizes_of
from rigtri.maths.arrays import Booleans
from rigtri.model.dataclass import dataclass
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.verification.compare.attachments import compare_attached
from rigtri.verification.compare.correspondence import Correspondence, match, pair_meshes, played_together
from rigtri.verification.compare.deviation import compared
from rigtri.verification.compare.probe_selection import (
    changed_nodes,
    frames,
    instances,
    origins,
    own_frames,
    rigid_corners,
    skin_corners,
)
from rigtri.verification.compare.probes import Probe, mesh_title, points_of
from rigtri.verification.compare.resting_children import left_their_rest
from rigtri.verification.compare.scene_facts import (
    SceneFacts,
    compare_scene_facts,
    compare_surfaces,
    newly_shown,
)
from rigtri.verification.compare.verdict import Comparison as Comparison

# How closely meshes are looked at: the boxes that a file states for its largest ones, boxes of all their
# points, or the points themselves, at the weights that their morphs have. Boxes have room for what all
# morphs add at once, which may be far more.
Detail = Literal["stated boxes", "boxes", "points"]
# Weights of morphs are 0 to 1, or a little beyond: boxes have no room for where larger ones carry points.
_MOST_WEIGHT = 10.0
# Which morph targets of which nodes, by the nodes' keys.
MorphChanges = Mapping[Hashable, Collection[int]]


class Source(Protocol):
    """What can be compared: any `rigtri.formats.Document`."""

    @property
    def rig(self) -> Rig: ...
    def meshes(self) -> Sequence[Mesh]: ...
    def outlines(self, *, closely: bool = False) -> Sequence[Mesh]: ...
    def scene_facts(self, *, closely: bool = False) -> SceneFacts: ...


@dataclass(frozen=True, eq=False)
class DocumentView:
    """A document as it looks with another rig: what ``document`` shows, moved by ``rig``."""

    document: Source
    rig: Rig

    def meshes(self) -> Sequence[Mesh]:
        return self.document.meshes()

    def outlines(self, *, closely: bool = False) -> Sequence[Mesh]:
        return self.document.outlines(closely=closely)

    def scene_facts(self, *, closely: bool = False) -> SceneFacts:
        return self.document.scene_facts(closely=closely)


def verify(before: Source, after: Source, *, sized_by: Sequence[Mesh] | None = None) -> Comparison:
    """Compare any two files by their vertices; nodes are known by keys, paths or names.

    Skinned (linear or dual quaternion), morphed and rigid vertices, frames of
    cameras and lights, origins of all nodes, faces and normals, and what else of
    the two files shows (`rigtri.verification.compare.scene_facts`). Vertices that are not a number must
    be none in both.
    """
    mine, theirs = played_together(before.rig, after.rig, by_key=False)
    found = match(mine, theirs, by_key=False)
    meshes, others = measurable(before, before.meshes), measurable(after, after.meshes)
    sizes = sizes_of(mine, meshes if sized_by is None else sized_by)
    everything = np.ones(len(mine), dtype=bool)
    bodies, lost = _mesh_probes(mine, theirs, found, meshes, others)
    probes: list[Probe] = [
        *bodies,
        *frames(mine, found, meshes, everything, sizes),
        *instances(mine, theirs, found, everything, sizes),
        origins(mine, found, everything),
    ]
    shown, now = before.scene_facts(closely=True), after.scene_facts(closely=True)
    different, changed = compare_scene_facts((mine, theirs), shown, now, found)
    if shown.format == now.format:
        different += compare_attached(mine, theirs, found)
        pairs, _ = mesh_pairs(mine, found, meshes, others)
        different += compare_surfaces(pairs, lambda mesh: mesh_title(mine, mesh))
        different += newly_shown(theirs, now, found)
    found = found.with_more(lost=lost, changed=changed)
    return compared(mine, theirs, found, probes, sizes, different, added=True)


def self_check(
    before: Source,
    after: Source,
    *,
    detail: Detail = "stated boxes",
    own_nodes: bool = False,
    behind: Set[str] = frozenset(),
) -> Comparison:
    """Compare a file with what an edit made of it; nodes are known by their keys.

    An upper bound: skin matrices move the corners of the box of the points that
    each joint moves. Nodes whose rest, tracks, ancestors and inverse binds are
    the same to the bit are not evaluated. Meshes that cannot be read are bounded
    by the box of their skin's joints. own_nodes: compare also the frames of what rigtri itself has added,
    which else may move. behind: what the edit says that it leaves behind, see `left_their_rest`.
    """
    mine, theirs = played_together(before.rig, after.rig, by_key=True)
    found = match(mine, theirs, by_key=True)
    added = theirs.holders.difference(found.node.tolist())
    if any(added.intersection(skin.joints.tolist()) for skin in theirs.skins):
        return verify(before, after)  # a split has counted the joints anew: look at the vertices themselves
    if _beyond_boxes(mine):
        detail = "points"
    meshes = measurable(
        before,
        before.meshes if detail == "points" else lambda: before.outlines(closely=detail == "boxes"),
    )
    sizes = sizes_of(mine, meshes)
    moving = changed_nodes(mine, theirs, found)
    bodies = box_probes(mine, theirs, found, meshes, moving)
    if detail == "points" and bodies:
        bodies, lost = _mesh_probes(mine, theirs, found, meshes, measurable(after, after.meshes))
        if len(meshes) < len(measurable(before, before.outlines)):
            lost.append("a mesh that is too large to move its vertices")
        found = found.with_more(lost=lost)
    probes: list[Probe] = [
        *bodies,
        *frames(mine, found, meshes, moving, sizes),
        *instances(mine, theirs, found, moving, sizes),
        *(own_frames(mine, found, moving, sizes) if own_nodes else ()),
        origins(mine, found, moving),
    ]
    different, changed = compare_scene_facts((mine, theirs), before.scene_facts(), after.scene_facts(), found)
    different += compare_attached(mine, theirs, found)
    different += left_their_rest(mine, theirs, found, behind)
    found = found.with_more(changed=changed)
    result = compared(mine, theirs, found, probes, sizes, different)
    boxed = tuple(mesh_title(mine, mesh) for mesh in meshes if mesh.box is not None)
    return replace(result, boxed=() if detail == "boxes" else boxed)


def _beyond_boxes(rig: Rig) -> bool:
    """Whether a clip gives morphs weights that carry points far out of the boxes of meshes."""
    columns = (column for clip in rig.clips for column in clip.columns if column.path == "weights")
    return any(np.abs(column.key_values).max(initial=0.0) > _MOST_WEIGHT for column in columns)


def box_probes(
    mine: Rig,
    theirs: Rig,
    m: Correspondence,
    meshes: Sequence[Mesh],
    moving: Booleans,
    free: Collection[int] = (),
) -> list[Probe]:
    """The corners of what each joint and each node moves."""
    return [*skin_corners(mine, theirs, m, meshes, moving, free), *rigid_corners(mine, m, meshes, moving)]


def _mesh_probes(
    mine: Rig, theirs: Rig, m: Correspondence, meshes: Sequence[Mesh], others: Sequence[Mesh]
) -> tuple[list[Probe], list[str]]:
    """The vertices of the meshes of both, and the meshes that the second lacks."""
    pairs, lost = mesh_pairs(mine, m, meshes, others)
    probes: list[Probe] = [*points_of(mine, theirs, pairs)]
    # Skins whose points nobody can read (Draco), by the places of their joints.
    read = {mesh.skin for mesh in meshes}
    hidden = [k not in read and (skin.drawn is True or not meshes) for k, skin in enumerate(mine.skins)]
    unseen = replace(m, skin=np.where(hidden, m.skin, -1))
    probes += skin_corners(mine, theirs, unseen, [], np.ones(len(mine), dtype=bool))
    return probes, lost


def measurable(source: Source, read: Callable[[], Sequence[Mesh]]) -> list[Mesh]:
    """The meshes that can be evaluated; none where they cannot be read.

    Not the lines of controls: what rigtri itself has added may move; but what others show with its nodes.
    """
    try:
        meshes = read()
    except FileError:
        return []
    rig = source.rig
    unseen = rig.own - rig.showing
    drawn = (mesh for mesh in meshes if mesh.skin is not None or mesh.node not in unseen)
    return [mesh for mesh in drawn if mesh.fits(rig.skins)]


def mesh_pairs(
    before: Rig, m: Correspondence, mine: Sequence[Mesh], theirs: Sequence[Mesh]
) -> tuple[list[tuple[Mesh, Mesh]], list[str]]:
    """Meshes of both files with as many points, and what of the first's is lost."""
    pairs, lost = [], []
    for mesh, partner in pair_meshes(m, mine, theirs)[0]:
        if partner is None:
            lost.append(f"mesh {mesh_title(before, mesh)}")
        elif len(partner.points) != len(mesh.points):
            count = f"{len(mesh.points)} points are {len(partner.points)}"
            lost.append(f"mesh {mesh_title(before, mesh)}: {count}")
        else:
            pairs.append((mesh, partner))
    return pairs, lost


def passing_over(view: Source, keys: Set[Hashable]) -> Source:
    """A document in which nobody looks for nodes, by their keys, nor for what clips do with them."""
    rig = view.rig
    nodes = {node for node, key in enumerate(rig.keys) if key in keys and key is not None}
    if not nodes:
        return view
    clips = tuple(
        replace(clip, tracks=tuple(t for t in clip.tracks if t.node not in nodes)) for clip in rig.clips
    )
    left = tuple(None if node in nodes else key for node, key in enumerate(rig.keys))
    return DocumentView(view, replace(rig, keys=left, clips=clips))
