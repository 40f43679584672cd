"""Files whose twist joints do not turn: what a change of their weights must leave as it was.

Weights that go from a joint to its twist joints change how a twisted pose looks, on purpose. While
the twist joints stand still, at rest and in every clip, nothing may.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rigtri.evaluation import sampling, skinning
from rigtri.evaluation.twist_joints import is_twist
from rigtri.maths.arrays import Booleans
from rigtri.maths.vectors import distance
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.verification.compare.compare import Comparison, Source, self_check, verify
from rigtri.verification.compare.driven_weights import Driven, set_aside
from rigtri.verification.compare.scene_facts import Scenery

# Times of a clip that are evaluated together.
_AT_ONCE = 64


class Stilled:
    """A document in which no clip turns a twist joint. meshes, rig: instead of its own."""

    def __init__(
        self,
        document: Source,
        meshes: Sequence[Mesh] | None = None,
        rig: Rig | None = None,
    ) -> None:
        self._document, self._meshes = document, meshes
        still = {node for node, note in document.rig.notes.items() if is_twist(note)}
        self._rig = replace(
            document.rig,
            clips=tuple(
                replace(
                    clip, tracks=tuple(t for t in clip.tracks if t.path != "rotation" or t.node not in still)
                )
                for clip in document.rig.clips
            ),
        )
        if rig is not None:
            self._rig = rig

    @property
    def rig(self) -> Rig:
        return self._rig

    def meshes(self) -> Sequence[Mesh]:
        return self._document.meshes() if self._meshes is None else self._meshes

    def outlines(self, *, closely: bool = False) -> Sequence[Mesh]:
        return self._document.outlines(closely=closely)

    def scenery(self, *, closely: bool = False) -> Scenery:
        return self._document.scenery(closely=closely)


def stilled(before: Source, after: Source, driven: Driven) -> tuple[Stilled, Stilled]:
    """Both documents without the turns of twist joints, and without the morph weights ``driven``.

    driven: morph targets by the addresses of nodes: where one file counts its nodes in another way, too.
    """
    pair = Stilled(before), Stilled(after)
    if not driven:
        return pair
    rigs = [replace(s.rig, keys=tuple(s.rig.address(node) for node in range(len(s.rig)))) for s in pair]
    resting = {mesh.node: mesh.morph_weights for mesh in before.meshes()}
    aside = set_aside(rigs[0], rigs[1], driven, resting)
    first, second = (
        Stilled(document, rig=replace(document.rig, clips=rig.clips))
        for document, rig in zip(pair, aside, strict=True)
    )
    return first, second


def check_split(before: Source, after: Source) -> Comparison:
    """Compare a file with what a split of weights made of it while no twist joint turns.

    What all joints move is bounded as in `compare.self_check`, and the points whose influences
    are others now are looked at one by one. ``moved`` says how far twist joints, turning, move points
    at the keys of all clips.
    """
    result = self_check(Stilled(before), Stilled(after))
    # Lines of controls are drawn with nobody's weights, and may be new.
    both = ([m for m in d.meshes() if m.node not in d.rig.own] for d in (before, after))
    pairs = zip(*both, strict=True)
    changed = [(_rows(a, rows), _rows(b, rows)) for a, b in pairs if (rows := _others(a, b)).any()]
    if changed:
        mine, theirs = zip(*changed, strict=True)
        points = verify(Stilled(before, mine), Stilled(after, theirs))
        result = _worse(result, points)
    return replace(result, moved=moved(after) / result.diagonal)


def _others(mine: Mesh, theirs: Mesh) -> Booleans:
    """Which points of a mesh are others now, or have other influences, (v,)."""
    if mine.points.shape != theirs.points.shape or mine.morphs.shape != theirs.morphs.shape:
        return np.ones(len(mine.points), dtype=bool)
    width = max(mine.joints.shape[1], theirs.joints.shape[1])
    one, other = (
        [np.pad(rows, ((0, 0), (0, width - rows.shape[1]))) for rows in (mesh.joints, mesh.weights)]
        for mesh in (mine, theirs)
    )
    changed = (mine.points != theirs.points).any(axis=1)
    if width:  # a rigid mesh has no influences
        changed |= (one[0] != other[0]).any(axis=1) | (one[1] != other[1]).any(axis=1)
    if len(mine.morphs):
        changed |= (mine.morphs != theirs.morphs).any(axis=(0, 2))
    return np.asarray(changed)


def _worse(one: Comparison, points: Comparison) -> Comparison:
    """The worse of a comparison and one of some points of the same files."""
    both = replace(
        one,
        lost=tuple(dict.fromkeys((*one.lost, *points.lost))),
        different=tuple(dict.fromkeys((*one.different, *points.different))),
        poses=max(one.poses, points.poses),
    )
    if not points.absolute > one.absolute:
        return both
    share = points.absolute / one.diagonal
    return replace(both, deviation=share, absolute=points.absolute, worst=points.worst, raw_deviation=share)


def moved(document: Source) -> float:
    """How far points move at most, in file units, because twist joints turn in clips."""
    rig, still = document.rig, Stilled(document).rig
    turning = {node for node, note in rig.notes.items() if is_twist(note)}
    meshes = [few for mesh in document.meshes() if (few := _weighing(rig, mesh, turning)) is not None]
    largest = 0.0
    for clip, held in zip(rig.clips, still.clips, strict=True) if meshes else ():
        if clip.idle or len(held.tracks) == len(clip.tracks):
            continue
        times = sampling.key_times(held)
        for start in range(0, len(times), _AT_ONCE):
            some = times[start : start + _AT_ONCE]
            worlds = [
                sampling.worlds(r, sampling.locals_at(r, c, some)) for r, c in ((rig, clip), (still, held))
            ]
            for mesh in meshes:
                morph = sampling.morph_weights(mesh, clip, some)
                one, other = (skinning.deformed(mesh, rig, world, morph) for world in worlds)
                largest = max(largest, float(distance(one, other).max(initial=0.0)))
    return largest


def _weighing(rig: Rig, mesh: Mesh, turning: set[int]) -> Mesh | None:
    """The points of a mesh that twist joints move, as a mesh; None where there are none."""
    if mesh.skin is None or not mesh.joints.shape[1]:
        return None
    of = np.isin(rig.skins[mesh.skin].joints, list(turning))
    rows = (of[mesh.joints] & (mesh.weights != 0)).any(axis=1)
    if not rows.any():
        return None
    return _rows(mesh, rows)


def _rows(mesh: Mesh, rows: Booleans) -> Mesh:
    """Some points of a mesh as a mesh; its faces stay behind."""
    return replace(
        mesh,
        surface=None,
        points=mesh.points[rows],
        joints=mesh.joints[rows],
        weights=mesh.weights[rows],
        morphs=mesh.morphs[:, rows] if len(mesh.morphs) else mesh.morphs,
    )
