"""How far the result of an edit looks otherwise than its source, on purpose: one measurement for all edits.

Source against result, at rest and in every clip, at keys and between them, whatever it is that an edit
declares to change: joints, skin weights, or morph targets. What is the same to the bit is not evaluated.
Joints are bounded by the corners of what they move; points that other joints, weights or morphs move
are compared one by one.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

import numpy as np

from rigtri.frames.rig_size import sizes_of
from rigtri.maths.arrays import Booleans
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.verification.compare.changed_points import changed_points, some_points
from rigtri.verification.compare.compare import Source, box_probes, measurable, mesh_pairs
from rigtri.verification.compare.correspondence import Correspondence, match, played_together, same_track
from rigtri.verification.compare.deviation import measure, side_by_side
from rigtri.verification.compare.probe_selection import (
    changed_nodes,
    instances,
    like_skins,
    origins,
    rotations,
)
from rigtri.verification.compare.probes import MeshPoints, in_places
from rigtri.verification.compare.verdict import Motion


def motion_between(
    before: Source,
    after: Source,
    *,
    by_key: bool = True,
    axes: bool = True,
    free: Collection[int] = (),
    other_points: bool = True,
) -> Motion:
    """How far joints, points and nodes of one file are from where they are in another, with keys alike.

    Not the lenses of cameras, nor what rigtri itself has added. by_key: nodes are known by keys, as after an
    edit in place, else by names. axes: also the axes of nodes that show nothing; not where joints get
    others. free: nodes that may move, as far as they show nothing. other_points: also points that have other
    joints, weights or morph weights.
    """
    mine, theirs = played_together(_with_keys(before.rig), after.rig, by_key=by_key)
    found = match(mine, theirs, by_key=by_key)
    meshes = measurable(before, before.outlines)
    sizes = sizes_of(mine, meshes)
    pairs, _ = mesh_pairs(mine, found, measurable(before, before.meshes), measurable(after, after.meshes))
    if not other_points:  # nor do these make the boxes larger of what joints move
        meshes = [
            some_points(a, ~rows) for a, b in pairs if not (rows := _changed(mine, theirs, found, a, b)).all()
        ]
    moving = changed_nodes(mine, theirs, found)
    watched = moving.copy()
    watched[list(free)] = False
    probes = [
        *box_probes(mine, theirs, found, meshes, moving, free),
        *(rotations(mine, found, meshes, watched, sizes) if axes else ()),
        *instances(mine, theirs, found, moving, sizes),
        origins(mine, found, watched),
    ]
    probes += _changed_points(mine, theirs, found, pairs) if other_points else ()
    result = measure(*side_by_side(mine, theirs, found), probes, sizes)
    return Motion(result.largest, result.worst, result.clips, result.owners)


def _with_keys(rig: Rig) -> Rig:
    """The rig with a key also for nodes that went: points move with them, as with others."""
    return replace(rig, keys=tuple(("gone", k) if key is None else key for k, key in enumerate(rig.keys)))


def _changed_points(
    mine: Rig, theirs: Rig, m: Correspondence, pairs: Sequence[tuple[Mesh, Mesh]]
) -> Iterator[MeshPoints]:
    """The points of meshes that other joints, weights or morphs move now, or that are others themselves."""
    for (mesh, other), others in in_places(mine, pairs):
        rows = _changed(mine, theirs, m, mesh, other)
        morphs = len(mesh.morphs) and mesh.morphs.shape == other.morphs.shape
        if morphs and _morphs_otherwise(mine, theirs, m, mesh, other):
            rows = rows | (mesh.morphs != 0).any(axis=(0, 2))
        if rows.any():
            some = some_points(mesh, rows), some_points(other, rows)
            yield MeshPoints((mine, theirs), some, instances=others)


def _changed(mine: Rig, theirs: Rig, m: Correspondence, mesh: Mesh, other: Mesh) -> Booleans:
    """Which points of a mesh are others now, or have other influences, (v,)."""
    if mesh.skin is None or other.skin is None:
        return changed_points(mesh, other)
    if like_skins(mine, theirs, m, mesh.skin) is None:  # whose joints are not bounded by boxes
        return np.ones(len(mesh.points), dtype=bool)
    was, now = mine.skins[mesh.skin], theirs.skins[other.skin]
    return changed_points(mesh, other, (m.node[was.joints], now.joints))


def _morphs_otherwise(mine: Rig, theirs: Rig, m: Correspondence, mesh: Mesh, other: Mesh) -> bool:
    """Whether the morph weights of a mesh are others, at rest or in a clip that both have."""
    if not np.array_equal(mesh.morph_weights, other.morph_weights):
        return True
    return any(
        not same_track(clip.weights.get(mesh.node), theirs.clips[partner].weights.get(other.node))
        for clip, partner in zip(mine.clips, m.clip.tolist(), strict=True)
        if partner >= 0
    )
