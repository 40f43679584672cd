"""How far the two sides of a rig are from being mirror images: places, axes, and what is missing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rigtri.matrices import nearest_rotation
from rigtri.naming import Side, twin
from rigtri.ops.mirror import Options
from rigtri.ops.select import chosen
from rigtri.ops.twins import mirrored_axes, pairs, reflection, side_of
from rigtri.pose import worlds
from rigtri.quaternions import conjugate, from_axes, multiply, turn_angle
from rigtri.rig import Rig
from rigtri.skeleton import reference, skeleton
from rigtri.trigonometry import Floats
from rigtri.vectors import length

# What tools leave of a symmetric character: a share of its size, and degrees.
TOLERANCE = 1e-4
DEGREES = 0.1


@dataclass(frozen=True)
class Pair:
    """A node and its twin: how far the twin is from the mirror image, as a share of the size, in degrees."""

    node: str
    twin: str
    distance: float
    degrees: float

    def symmetric(self, tolerance: float = TOLERANCE, degrees: float = DEGREES) -> bool:
        """Whether both are within what is allowed."""
        return self.distance <= tolerance and self.degrees <= degrees

    def as_json(self) -> dict[str, Any]:
        """For machines."""
        return {"node": self.node, "twin": self.twin, "distance": self.distance, "degrees": self.degrees}


@dataclass(frozen=True)
class Asymmetry:
    """All pairs of joints and of nodes that rigtri made, and those without a twin."""

    pairs: tuple[Pair, ...]
    alone: tuple[str, ...]

    def worse(self, tolerance: float = TOLERANCE, degrees: float = DEGREES) -> list[Pair]:
        """The pairs that are not symmetric, worst place first."""
        found = [pair for pair in self.pairs if not pair.symmetric(tolerance, degrees)]
        return sorted(found, key=lambda pair: (-pair.distance, -pair.degrees))


def asymmetry(rig: Rig, *, options: Options | None = None) -> Asymmetry:
    """Compare each joint and node of ours on one side with the mirror image of its twin.

    In the pose of the options (the bind pose by default) for joints, at rest for other nodes. Ends
    that carry nothing are left out: they have no axes to speak of, and glTF does not call them joints.
    """
    options = options or Options()
    tree = skeleton(rig, options.root)
    ref = reference(tree, options.pose)
    joints = [k for k in chosen(tree, options.selection) if tree.carries[k] or tree.below[k]]
    found, alone = pairs(rig, joints, options.from_side)
    other_side: Side = "left" if options.from_side == "right" else "right"
    alone += pairs(rig, joints, other_side)[1]
    compared = _compared(rig, found, ref.world, ref.extent, options)
    made = [node for node, note in rig.notes.items() if note.get("type") != "frame" and side_of(rig, node)]
    ours, single = pairs(rig, made, options.from_side)
    single += pairs(rig, made, other_side)[1]
    compared += _compared(rig, ours, worlds(rig), ref.extent, options)
    return Asymmetry(
        tuple(compared), tuple(f"{rig.title(k)} (no {twin(rig.names[k])})" for k in alone + single)
    )


def _compared(rig: Rig, found: dict[int, int], world: Floats, size: float, options: Options) -> list[Pair]:
    if not found:
        return []
    reflect = reflection(options.plane)
    here, there = list(found), list(found.values())
    apart = length(world[here, 3, :3] * reflect - world[there, 3, :3]) / (size or 1.0)
    wanted = from_axes(mirrored_axes(nearest_rotation(world[here]), options.mode, reflect))
    now = from_axes(nearest_rotation(world[there]))
    angles = np.degrees(turn_angle(multiply(conjugate(wanted), now)))
    return [
        Pair(rig.title(a), rig.title(b), float(d), float(angle))
        for a, b, d, angle in zip(here, there, apart, angles, strict=True)
    ]
