"""A file as an edit means it to be: what its result is compared with, where that is not the file itself."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rigtri.evaluation.timelines import PLAYED, played_at_once, timelines
from rigtri.frames.rig_size import size_of
from rigtri.model.animation import Clip, Track
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.verification.compare.compare import Motion, Source, motion_between
from rigtri.verification.compare.driven_weights import Driven, moved
from rigtri.verification.compare.scene_facts import Scenery


@dataclass(frozen=True)
class Intended:
    """What a document shows, moved as another rig with its nodes moves it; ``after`` is the result.

    redrawn: nodes of ours whose lines are others on purpose. keys: of the document's nodes in the result.
    place: where the rig has the document's nodes, (n,).
    """

    document: Source
    rig: Rig
    after: Source
    redrawn: frozenset[int] = frozenset()
    keys: tuple[Hashable, ...] = ()
    place: Sequence[int] = ()

    def meshes(self) -> Sequence[Mesh]:
        return self._placed(self.document.meshes())

    def outlines(self, *, closely: bool = False) -> Sequence[Mesh]:
        return self._placed(self.document.outlines(closely=closely))

    def _placed(self, meshes: Sequence[Mesh]) -> list[Mesh]:
        """Meshes at the nodes of the rig, with the morph weights that it has at rest."""
        found = []
        for mesh in meshes:
            node = self.place[mesh.node]
            weights = self.rig.pending.morph_weights.get(node, mesh.morph_weights)
            if node != mesh.node or weights is not mesh.morph_weights:
                mesh = replace(mesh, node=node, morph_weights=weights)
            found.append(mesh)
        return found

    def scenery(self, *, closely: bool = False) -> Scenery:
        found = self.document.scenery(closely=closely)
        nodes = dict(found.nodes)
        if self.redrawn:
            now = self.after.scenery(closely=closely).nodes
            there = {key: node for node, key in enumerate(self.after.rig.keys)}
            nodes |= {node: now.get(there.get(self.keys[node], -1), {}) for node in self.redrawn}
        moved = {self.place[node]: shown for node, shown in nodes.items()}
        return replace(found, nodes=moved, own={self.place[node]: own for node, own in found.own.items()})


def intended(document: Source, rig: Rig, after: Source, *, reposed: bool) -> tuple[Source, Source]:
    """The document, as the edit to ``rig`` means it, and the result, to be compared with each other.

    reposed: what the document shows is to move as ``rig`` does. Then both have one clip for all that plays
    at once: it shows one pose, whichever of a stage's clips holds which keys.
    """
    before = document.rig
    old = {key: node for node, key in enumerate(before.keys)}
    redrawn = frozenset(old[rig.keys[node]] for node in rig.pending.shapes if rig.keys[node] in old)
    keyed = _keyed(before, rig, after.rig)
    if keyed is before and not redrawn and not reposed:
        return document, after
    if not reposed:
        return Intended(document, keyed, after, redrawn, keyed.keys, range(len(before))), after
    # Nodes that the edit has added have no keys: nobody looks for them, as after any other edit.
    now = dict(zip(before.keys, keyed.keys, strict=True))
    keys = tuple(now.get(key) for key in rig.keys)
    new = {key: node for node, key in enumerate(rig.keys) if key is not None}
    moved = rig if keys == rig.keys else replace(rig, keys=keys)
    name = next((t.name for t in reversed(timelines(rig))), "")
    meant, made = played_at_once(moved, name), played_at_once(after.rig, name)
    place = [new[key] for key in before.keys]
    return (
        Intended(document, meant, after, redrawn, keyed.keys, place),
        Intended(after, made, after, frozenset(), after.rig.keys, range(len(made))),
    )


def motion(document: Source, meant: Source, made: Source, driven: Driven) -> Motion:
    """How far what the document shows moves otherwise in a result; meant, made: of `intended`.

    At rest and in the clips that both have, at keys and between them. driven: morph weights that are
    told elsewhere.
    """
    rig = document.rig
    keys = meant.keys if isinstance(meant, Intended) else rig.keys
    played = next((clip for clip in made.rig.clips if clip.key == PLAYED), None)
    if played is not None:
        rig = played_at_once(rig, played.name)
        if all(clip.key != PLAYED for clip in rig.clips):  # nothing played
            rig = replace(rig, clips=(replace(played, tracks=()), *rig.clips))
    # What the result knows as rigtri's is no more looked at where the document, exported, lacks the notes.
    told = {made.rig.keys[node]: made.rig.notes[node] for node in made.rig.own & made.rig.notes.keys()}
    notes = {**{node: told[key] for node, key in enumerate(keys) if key in told}, **rig.notes}
    was = Intended(document, replace(rig, keys=keys, notes=notes), made, keys=keys, place=range(len(rig)))
    found = motion_between(was, made)
    others = {key: () for key in _other_weights(was.rig, made.rig) if key not in driven}
    if not others:
        return found
    far = moved((was.rig, made.rig), (was.meshes(), made.meshes()), others)
    size = size_of(was.rig, was.outlines())
    return replace(found, morphs={name: value / size for name, value in far.items() if value > 0})


def _other_weights(before: Rig, after: Rig) -> set[Hashable]:
    """The keys of the nodes whose morph weights are driven otherwise in a clip that both have."""
    found: set[Hashable] = set()
    theirs = {(clip.key, clip.name): clip for clip in after.clips}
    for clip in before.clips:
        other = theirs.get((clip.key, clip.name))
        if other is not None:
            was, now = _weights(before, clip), _weights(after, other)
            found |= {key for key in was.keys() | now.keys() if not _alike(was.get(key), now.get(key))}
    return found


def _weights(rig: Rig, clip: Clip) -> dict[Hashable, Track]:
    return {rig.keys[t.node]: t for t in clip.tracks if t.path == "weights"}


def _alike(a: Track | None, b: Track | None) -> bool:
    """Whether two tracks are the same to the bit."""
    if a is None or b is None:
        return a is b
    same = np.array_equal(a.times, b.times) and np.array_equal(a.values, b.values)
    return same and a.interpolation == b.interpolation


def _keyed(before: Rig, rig: Rig, after: Rig) -> Rig:
    """The rig that was read, with the result's keys of renamed nodes of ours: keys may be names."""
    new = {key: node for node, key in enumerate(rig.keys) if key is not None}
    ours = [node for node in before.own if before.keys[node] in new]
    renamed = [node for node in ours if rig.names[new[before.keys[node]]] != before.names[node]]
    if not renamed:
        return before
    places = {after.path(node): key for node, key in enumerate(after.keys)}
    keys = list(before.keys)
    for node in ours:  # also those below a node that was renamed
        keys[node] = places.get(rig.path(new[before.keys[node]]), keys[node])
    return replace(before, keys=tuple(keys))
