"""What is measured while two rigs are compared: points in the frames of nodes.

A probe gives distances, (r, f), between where it is in one rig and
in the other: rows at times. Verification only, so matrix products are BLAS's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip


@dataclass(frozen=True, eq=False)
class SampledPoses:
    """Both rigs at some times of one clip: worlds (f, n, 4, 4), and what morphs need."""

    before: Floats
    after: Floats
    clips: tuple[Clip | None, Clip | None]
    times: Floats


class Probe(Protocol):
    """Things whose distance in the two rigs is asked for; ``owners`` are the meshes they are of."""

    @property
    def titles(self) -> Sequence[str]: ...
    @property
    def owners(self) -> Sequence[str]: ...
    @property
    def nodes(self) -> tuple[Integers, Integers]: ...
    def distances(self, poses: SampledPoses) -> Floats:
        """(r, f), in file units; inf where only one of the two is a number."""


@dataclass(frozen=True, eq=False)
class FramePoints:
    """Points fixed in the frames of nodes, before and after: (r, k, 4) homogeneous each."""

    nodes: tuple[Integers, Integers]
    points: tuple[Floats, Floats]
    titles: Sequence[str]
    owners: Sequence[str]

    def apart(self, poses: SampledPoses) -> Floats:
        """The points' differences, (r, k, 3, f): one matrix product a row and side."""
        mine, theirs = (
            _placed(world.transpose(1, 2, 3, 0)[nodes], points)
            for world, nodes, points in zip((poses.before, poses.after), self.nodes, self.points, strict=True)
        )
        # The same numbers give the same products, so what is equal is apart by exactly 0.
        with np.errstate(invalid="ignore"):
            mine -= theirs
        return mine

    def distances(self, poses: SampledPoses) -> Floats:
        apart = self.apart(poses)
        with np.errstate(invalid="ignore", over="ignore"):
            distance = np.sqrt(_squares(apart).max(axis=1))
        if np.isfinite(distance).all():
            return np.asarray(distance)
        broken = (
            _broken(world, nodes, points)
            for world, nodes, points in zip((poses.before, poses.after), self.nodes, self.points, strict=True)
        )
        gone = np.logical_and(*broken)
        return np.where(gone, 0.0, np.where(np.isfinite(distance), distance, np.inf))


def _placed(world: Floats, points: Floats) -> Floats:
    """Points (r, k, 4) in the frames of rows, (r, 4, 4, f) → (r, k, 3, f)."""
    rows, times = len(world), world.shape[3]
    with np.errstate(invalid="ignore", over="ignore"):
        placed = points @ world[:, :, :3].reshape(rows, 4, 3 * times)
    return np.asarray(placed.reshape(rows, -1, 3, times))


def _squares(apart: Floats) -> Floats:
    """The squares of the lengths of differences, (..., 3, f) → (..., f); these are overwritten."""
    apart *= apart
    square = apart[..., 0, :] + apart[..., 1, :]
    square += apart[..., 2, :]
    return square


def _broken(world: Floats, nodes: Integers, points: Floats) -> Booleans:
    """Where rows are not a number, (r, f)."""
    moves = np.isfinite(world[:, nodes]).all(axis=(2, 3)).T
    exists = np.isfinite(points).all(axis=(1, 2))
    return ~(moves & exists.reshape(-1, 1))
