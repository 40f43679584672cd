"""Morph targets of two files that correspond, by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np

from rigtri.evaluation.sampling import sample
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig


class MorphNames:
    """The morph targets of the meshes of a rig."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig

    @cached_property
    def _meshes(self) -> dict[int, Mesh]:
        """Of each node the mesh with most targets: parts of one mesh share them."""
        found: dict[int, Mesh] = {}
        for mesh in self.rig.meshes:
            if len(mesh.morph_weights) > len(found[mesh.node].morph_weights if mesh.node in found else ()):
                found[mesh.node] = mesh
        return found

    def at_rest(self, node: int) -> Floats | None:
        """The weights of a node's mesh as stored, (t,); None where it has none."""
        mesh = self._meshes.get(node)
        return None if mesh is None else mesh.morph_weights

    def of(self, node: int) -> tuple[str, ...]:
        """The names of the targets of a node; none where they are not known."""
        mesh = self._meshes.get(node)
        return () if mesh is None else mesh.morph_names

    def merged_track(
        self,
        node: int,
        track: Track,
        theirs: MorphNames,
        was: Track | None,
        ours: Callable[[Floats], Floats],
    ) -> Track | None:
        """A track of another file's weights as one of a node here; None where the targets are others.

        What the other file lacks stays as in ``was``, or as it rests. theirs: the targets of that file;
        ours: its times as those of ``was``.
        """
        rest = self.at_rest(node)
        names, others = self.of(node), theirs.of(track.node)
        width = track.values.shape[-1]
        if rest is None:
            return None
        if not names or not others or names == others:
            return replace(track, node=node, key=None) if width == len(rest) else None
        columns = [others.index(name) if name in others else -1 for name in names]
        if max(columns) < 0:
            return None
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
        return replace(track, node=node, values=values, key=None)
