"""Meshes of two files whose morph targets correspond, and their targets, by name.

A mesh may be a node in one file and a node below one of its name in the other (USD), one mesh or several
parts of one. So meshes are matched among meshes with targets: as their nodes are, else by name, else by the
nearest node above that is matched.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TypeVar

import numpy as np

from rigtri.evaluation.sampling import sample
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track, key_values
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.node_matching import SPELLINGS, nearest

# Morph weights that differ by less look alike.
SAME_WEIGHT = 1e-4
T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class MorphTargets:
    """The morph targets of a mesh. names: none where they are not known. rest: weights as stored, (t,)."""

    names: tuple[str, ...]
    rest: Floats


def morph_targets(rig: Rig) -> dict[int, MorphTargets]:
    """The morph targets of each node that has any, of its mesh with most: parts of one mesh share them."""
    found: dict[int, MorphTargets] = {}
    for mesh in rig.meshes:
        if len(mesh.morph_weights) > (len(found[mesh.node].rest) if mesh.node in found else 0):
            found[mesh.node] = MorphTargets(mesh.morph_names, mesh.morph_weights)
    # Of a mesh that nobody can read, its weights say how many there are.
    for track in (track for clip in rig.clips for track in clip.tracks if track.path == "weights"):
        found.setdefault(track.node, MorphTargets((), np.zeros(track.values.shape[-1])))
    return found


class MorphPairs:
    """The meshes with morph targets of two rigs, whose nodes correspond by ``of``."""

    def __init__(self, rig: Rig, other: Rig, of: Mapping[int, int]) -> None:
        self.rig, self.other, self._of = rig, other, of

    @cached_property
    def ours(self) -> dict[int, MorphTargets]:
        return morph_targets(self.rig)

    @cached_property
    def theirs(self) -> dict[int, MorphTargets]:
        return morph_targets(self.other)

    @cached_property
    def homes(self) -> dict[int, list[int]]:
        """By the node of each mesh of the other file, those of the rig's meshes with its targets."""
        same = ((node, self._of.get(node)) for node in self.ours)
        found = {theirs: [ours] for ours, theirs in same if theirs is not None and self._alike(theirs, ours)}
        for spell in SPELLINGS:
            free = [node for node in self.ours if [node] not in found.values()]
            here = _grouped(free, [spell(name) for name in self.rig.names])
            left = [node for node in self.theirs if node not in found]
            for name, nodes in _grouped(left, [spell(name) for name in self.other.names]).items():
                one = here.get(name, [])
                if name and len(nodes) == len(one) == 1 and self._alike(nodes[0], one[0]):
                    found[nodes[0]] = one
        found |= self._by_branch(found)
        if len(self.theirs) == 1:  # of all parts that the rig's mesh has
            found = {node: [own for own in self.ours if self._alike(node, own)] for node in found}
        return found

    def _by_branch(self, found: Mapping[int, list[int]]) -> dict[int, list[int]]:
        """The meshes that are left, by the nearest pair that they are, or are below.

        Where the rig has one mesh alone, there is no other.
        """
        ours, theirs = nearest(self.rig, self._of), nearest(self.other, self._of.values())
        here = _grouped(self.ours, ours)
        left = [node for node in self.theirs if node not in found]
        made: dict[int, list[int]] = {}
        back = {theirs: ours for ours, theirs in self._of.items()}
        for above, nodes in _grouped(left, theirs).items():
            beside = list(self.ours) if len(self.ours) == 1 else here.get(back.get(above, -1), [])
            free = [node for node in beside if [node] not in found.values()] or beside
            for node in nodes:
                alike = [own for own in free if self._alike(node, own)]
                if len(alike) == 1 or len(nodes) == 1:
                    made[node] = alike
        return {node: homes for node, homes in made.items() if homes}

    def _alike(self, theirs: int, ours: int) -> bool:
        """Whether a mesh of the other file and one of the rig have a target in common."""
        if theirs not in self.theirs:
            return False
        own, other = self.ours[ours], self.theirs[theirs]
        if own.names and other.names:
            return not set(own.names).isdisjoint(other.names)
        return len(own.rest) == len(other.rest)

    def lost(self, track: Track) -> list[str]:
        """The targets whose weights a track of the other file changes, and that no mesh of the rig has."""
        targets, values = self.theirs[track.node], key_values(track)
        changed = np.flatnonzero((np.abs(values - targets.rest) > SAME_WEIGHT).any(axis=0)).tolist()
        homes = self.homes.get(track.node, [])
        kept = {name for home in homes for name in self.ours[home].names}
        if homes and not (kept and targets.names):
            return []  # they correspond by their numbers
        names = targets.names or tuple(f"#{k}" for k in range(len(targets.rest)))
        return [names[k] for k in changed if names[k] not in kept]

    def merged(
        self,
        home: int,
        track: Track,
        was: Track | None,
        ours: Callable[[Floats], Floats],
        kept: Collection[int] = (),
    ) -> Track:
        """A track of the other file's weights as one of the mesh ``home``, which is one of `homes`.

        What the other file lacks stays as in ``was``, or as it rests, and so do the columns ``kept``. ours:
        its times as those of ``was``.
        """
        rest, names, others = self.ours[home].rest, self.ours[home].names, self.theirs[track.node].names
        columns = [others.index(name) if name in others else -1 for name in names]
        if not names or not others or names == others:
            if not kept:
                return replace(track, node=home, key=None)
            columns = list(range(len(rest)))
        columns = [-1 if own in kept else column for own, column in enumerate(columns)]
        shape = (*track.values.shape[:-1], len(rest))
        values = np.zeros(shape)
        base = sample(was, ours(track.times)) if was is not None else np.tile(rest, (len(track.times), 1))
        if len(shape) == 3:
            values[:, 1] = base
        else:
            values[:] = base
        for own, column in enumerate(columns):
            if column >= 0:
                values[..., own] = track.values[..., column]
        return replace(track, node=home, values=values, key=None)


def _grouped(nodes: Iterable[int], by: Sequence[T]) -> dict[T, list[int]]:
    """Nodes by what stands for each of them in ``by``."""
    found: dict[T, list[int]] = {}
    for node in nodes:
        found.setdefault(by[node], []).append(node)
    return found
