"""A rig in many poses at once; world matrices are computed when they are first needed."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from rigtri.evaluation.constraint_solver import Parts, mirrored_as, nearest_rotation_of, to_parts
from rigtri.evaluation.sampling import sample
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import (
    compose,
    determinant,
    inverse,
    multiply,
    unsheared_axes,
)
from rigtri.maths.quaternions import from_axes, unit
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import by_component
from rigtri.model.animation import Clip
from rigtri.model.rig import Rig

# What stands for a scale of zero, as a share of the largest beside it, where the turn of a flat frame is
# needed: near enough to the limit, and what the iteration of the nearest rotation can take.
FLAT = 1e-3


class PoseCache:
    """Local parts and world matrices of a rig's nodes, one row a frame; a single row where nothing moves.

    A node's world matrices are computed when they are first needed, so its parts, and those of the nodes
    above it, must be set before.
    """

    def __init__(self, rig: Rig, parts: Mapping[int, Parts] | None = None) -> None:
        self.rig = rig
        self.parts = dict(parts or {})
        self._worlds: dict[int, Floats] = {}

    def local(self, node: int) -> Floats:
        """The local matrices of a node, (1 or f, 4, 4)."""
        if node in self.parts:
            return compose(*self.parts[node])
        rest: Floats = self.rig.normalised_local[node][np.newaxis]
        return rest

    def part(self, node: int) -> Parts:
        """Translation, rotation and scale of a node, one row or f."""
        if node in self.parts:
            return self.parts[node]
        rig = self.rig
        if rig.has_matrix[node]:
            return mirrored_as(to_parts(rig.normalised_local[node][np.newaxis]), rig.scale[node])
        rows = slice(node, node + 1)
        return Parts(rig.translation[rows], unit(rig.rotation[rows]), rig.scale[rows])

    def set(self, node: int, parts: Parts, *, again: bool = False) -> None:
        """Give a node its local parts; ValueError where its position was already used.

        again: it was used by what moved the node first, and by nothing else.
        """
        if again:
            self._worlds.pop(node, None)
        if node in self._worlds:
            raise ValueError(f"'{self.rig.title(node)}' is moved after its position was used")
        self.parts[node] = parts

    def forget(self) -> None:
        """Drop world matrices, and their memory; they are computed again when they are needed."""
        self._worlds.clear()

    def world(self, node: int) -> Floats:
        """The world matrices of a node, (1 or f, 4, 4); of −1 the world's own."""
        if node < 0:
            return np.eye(4)[np.newaxis]
        line = []
        above = node
        while above >= 0 and above not in self._worlds:
            line.append(above)
            above = int(self.rig.parents[above])
        for each in reversed(line):
            above, local = int(self.rig.parents[each]), self.local(each)
            self._worlds[each] = local if above < 0 else multiply(local, self._worlds[above])
        return self._worlds[node]

    def unflattened(self, node: int, least: float) -> Floats:
        """The world matrices of a node as if no scale on its way were zero, (1 or f, 4, 4).

        A zero is this share of the largest scale beside it; where all three are zero, they are one.
        """
        world = np.eye(4)[np.newaxis]
        while node >= 0:
            local = self.local(node)
            if (determinant(local) == 0).any():
                part = self.part(node)
                most = np.abs(part.scale).max(axis=1, keepdims=True)
                instead = np.where(most == 0, 1.0, least * most)
                local = compose(*part._replace(scale=np.where(part.scale == 0, instead, part.scale)))
            world = multiply(world, local)
            node = int(self.rig.parents[node])
        return world

    def mended(self, found: Parts, start: Floats, carrier: int, above: int) -> Parts:
        """Local parts below ``above`` of what stands at ``start``, (4, 4), seen from its carrier.

        found: the parts of the matrices, (1 or f, ·). The rotation of a flat one is that without zero scales;
        and all of it where ``above`` is flat, which hides what is below it anyway.
        """
        if all(np.isfinite(each).all() for each in found):
            return found
        turned = multiply(multiply(start, self.unflattened(carrier, FLAT)), inverse(self.world(above)))
        whole = inverse(self.unflattened(above, 1.0))
        hidden = to_parts(multiply(multiply(start, self.unflattened(carrier, 1.0)), whole))
        near = found._replace(rotation=nearest_rotation_of(turned))
        sure = _finite(near.translation) & _finite(near.rotation) & _finite(near.scale)
        fine = _finite(found.rotation) & sure
        parts = zip(found, near, hidden, strict=True)
        return Parts(*(np.where(fine, a, np.where(sure, b, c)) for a, b, c in parts))

    def world_rotation(self, node: int) -> Floats:
        """How a node is turned in the world, (1 or f, 4), without scale.

        Of a sheared one the nearest rotation, which turns with its axes when those become others.
        """
        return from_axes(unsheared_axes(self.world(node)))

    def turn(self, node: int) -> Floats:
        """As `world_rotation`, by rotations alone where a scale of zero leaves no axes; −1: not at all."""
        if node < 0:
            return np.array([[0.0, 0.0, 0.0, 1.0]])
        found = self.world_rotation(node)
        whole = np.isfinite(found).all(axis=-1, keepdims=True)
        if whole.all():
            return found
        above = self.turn(int(self.rig.parents[node]))
        return np.where(whole, found, product(above, self.part(node).rotation))


def _finite(rows: Floats) -> Booleans:
    """Which rows are numbers, (f, 1)."""
    return np.asarray(np.isfinite(rows).all(axis=-1, keepdims=True))


def sample_parts(
    rig: Rig, clip: Clip, times: Floats, *, only: Collection[int] | None = None
) -> dict[int, Parts]:
    """The local parts of all nodes that a clip moves, or of some of them, at ``times``, (f,)."""
    found: dict[int, dict[str, Floats]] = {}
    for track in clip.tracks:
        if track.path == "weights" or (only is not None and track.node not in only):
            continue
        same = track.times is times or (len(track.times) == len(times) and bool((track.times == times).all()))
        plain = same and track.interpolation != "CUBICSPLINE"
        values = track.values if plain else sample(track, times)
        if len(track.times) == 1:
            values = values[:1]
        found.setdefault(track.node, {})[track.path] = unit(values) if track.path == "rotation" else values
    still = PoseCache(rig)
    return {
        node: still.part(node)._replace(**own) if own else still.part(node) for node, own in found.items()
    }


# Frames evaluated at once: enough that numpy's calls cost little, and a hundred joints 100 MB.
BLOCK = 4096


def frames(parts: Mapping[int, Parts]) -> int:
    """How many frames there are; 1 where nothing moves."""
    return max((len(each) for of in parts.values() for each in of), default=1)


def blocks(count: int, block: int = BLOCK) -> list[slice]:
    """All of ``count`` frames, so many at a time."""
    return [slice(start, min(start + block, count)) for start in range(0, count, block)]


def cut(parts: Mapping[int, Parts], rows: slice) -> dict[int, Parts]:
    """Some frames of what moves; what does not has one row, and keeps it."""
    return {
        node: Parts(*(part if len(part) == 1 else part[rows] for part in of)) for node, of in parts.items()
    }


def joined(found: Sequence[Mapping[int, Parts]], count: int, block: int = BLOCK) -> dict[int, Parts]:
    """The parts of the blocks of ``count`` frames, one after another."""
    if len(found) == 1:
        return dict(found[0])
    sizes = [rows.stop - rows.start for rows in blocks(count, block)]
    return {
        node: Parts(*(_joined([part[node][k] for part in found], sizes) for k in range(3)))
        for node in found[0]
    }


def _joined(pieces: Sequence[Floats], sizes: Sequence[int]) -> Floats:
    """Pieces of ``sizes`` rows, or of one that holds for all of them, one after another."""
    if all(len(piece) == 1 and np.array_equal(piece, pieces[0]) for piece in pieces):
        return pieces[0]
    together, start = by_component((sum(sizes), pieces[0].shape[1])), 0
    for piece, size in zip(pieces, sizes, strict=True):
        together[start : start + size] = piece
        start += size
    return together
