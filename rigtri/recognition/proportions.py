"""Body proportions from limbs alone: trunk width and facing direction."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length
from rigtri.model.rig import Rig
from rigtri.recognition.limbs import Limb


def girths(rig: Rig, limbs: Sequence[Limb], world: Floats) -> dict[int, float]:
    """For each node that a left and a right limb hang below, half the widest way between two, file units.

    world: (n, 4, 4), the pose in which the starts of the limbs are taken.
    """
    found: dict[int, float] = {}
    for left, right in _pairs(limbs):
        wide = 0.5 * float(length(world[left.start, 3, :3] - world[right.start, 3, :3]))
        others = set(_above(rig, right.start))
        for node in _above(rig, left.start):
            if node in others:
                found[node] = max(found.get(node, 0.0), wide)
    return found


def forward(rig: Rig, limbs: Sequence[Limb], world: Floats) -> Floats:
    """The axis of the world, (3,), that a character looks along: its left limbs are on its left.

    Without limbs, as its format says; else the left is at +x, as in glTF and USD.
    """
    up = np.asarray(rig.rules.up, dtype=np.float64)
    usual = cross([1.0, 0.0, 0.0], up)
    facing = usual if rig.rules.facing is None else np.asarray(rig.rules.facing, dtype=np.float64)
    for left, right in _pairs(limbs):
        facing = cross(world[left.start, 3, :3] - world[right.start, 3, :3], up)
        break
    level = facing - up * float(dot(facing, up))
    if not np.abs(level).max() > 0:  # limbs one above the other
        level = usual
    axis = int(np.argmax(np.abs(level)))
    return np.where(np.arange(3) == axis, np.sign(level[axis]), 0.0)


def _pairs(limbs: Sequence[Limb]) -> Iterator[tuple[Limb, Limb]]:
    """Left and right limbs of one kind."""
    for left in limbs:
        for right in limbs:
            if left.side == "left" and right.side == "right" and left.kind == right.kind:
                yield left, right


def _above(rig: Rig, node: int) -> Iterator[int]:
    node = int(rig.parents[node])
    while node >= 0:
        yield node
        node = int(rig.parents[node])
