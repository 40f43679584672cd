"""What the description of a rig shows of its nodes: bones, bends, directions, what is unusual.

All nodes are computed at once: of ten thousand a call each would take seconds.
"""

from __future__ import annotations

from collections import Counter
from functools import cached_property

import numpy as np

from rigtri.export.drawing.view import View, view_of
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import SKEW, determinant, skew
from rigtri.maths.quaternions import norm
from rigtri.maths.triangle import bend_angle, bend_sine
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, length, normalise
from rigtri.model.bindings import NodeConstraint
from rigtri.model.rig import Rig
from rigtri.model.skin import moving_points

# Scales nearer to 1 are 1 that was stored as float32 or half.
SAME_SCALE = 1e-4
# A bone shorter than this share of the rig has no direction.
ZERO_LENGTH = 1e-6
_DEGREES = 180.0 / np.pi
LETTERS = "xyz"


class SeenNodes:
    """What the description shows of each node, computed once for all of them."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self.world = rig.world
        self.position = self.world[:, 3, :3]
        with np.errstate(invalid="ignore", divide="ignore"):
            self.axes = normalise(self.world[:, :3, :3])
        self.scale = np.where(rig.has_matrix[:, np.newaxis], length(rig.matrix[:, :3, :3]), rig.scale)
        # Without a skin, as in a file of locators, every node is what a rigger works on.
        self.counts = rig.is_joint if rig.is_joint.any() else np.ones(len(rig), dtype=bool)
        self.weighted = moving_points(rig.skins, len(rig))
        points = self.position[np.isfinite(self.position).all(axis=1)]
        self.follows: dict[int, list[str]] = {}
        for constraint in rig.node_constraints:
            self.follows.setdefault(constraint.node, []).append(_constraint_words(rig, constraint))
        self.size = float(length(np.ptp(points, axis=0))) if len(points) else 0.0

    @cached_property
    def front(self) -> View:
        """How the character is seen from the front."""
        return view_of(self.rig)

    @cached_property
    def children(self) -> dict[int, tuple[int, int, float]]:
        """For each node the child nearest to an axis, the axis (0–5: +x +y +z −x −y −z), degrees between.

        Joints come before other nodes; nothing for a node that no child lies away from.
        """
        parents = self.rig.parents
        nodes = np.flatnonzero(parents >= 0)
        with np.errstate(invalid="ignore", over="ignore"):
            bones = self.position[nodes] - self.position[parents[nodes]]
            away = length(bones) > ZERO_LENGTH * self.size
            nodes, bones = nodes[away], bones[away]
            axes = self.axes[parents[nodes]]
            angles = angle(np.concatenate([axes, -axes], axis=1), bones[:, np.newaxis]) * _DEGREES
        fine = np.isfinite(angles).all(axis=1)
        nodes, angles = nodes[fine], angles[fine]
        # Rounded, so that equal angles stay equal: the file's order decides, not the last bit.
        rounded = np.round(angles, 3)
        best: dict[int, tuple[bool, float, int, int]] = {}
        axis = rounded.argmin(axis=1)
        rows = (parents[nodes], ~self.counts[nodes], rounded[np.arange(len(nodes)), axis], nodes, axis)
        for over, *found in zip(*(column.tolist() for column in rows), strict=True):
            if over not in best or tuple(found[:2]) < best[over][:2]:
                best[over] = tuple(found)
        return {over: (child, axis, degrees) for over, (_, degrees, child, axis) in best.items()}

    @cached_property
    def bends(self) -> dict[int, tuple[float, float]]:
        """The bend at nodes between their parents and `children`: degrees and |sine|."""
        parents, counts = self.rig.parents, self.counts
        nodes = [node for node in self.children if parents[node] >= 0 and counts[parents[node]]]
        ends = [self.children[node][0] for node in nodes]
        limbs = [self.position[np.array(k, dtype=np.int64)] for k in (parents[nodes], nodes, ends)]
        with np.errstate(invalid="ignore", over="ignore"):
            long = length(limbs[1] - limbs[0]) > ZERO_LENGTH * self.size
            start, middle, end = (points[long] for points in limbs)
            degrees, sines = bend_angle(start, middle, end) * _DEGREES, bend_sine(start, middle, end)
        bent = [node for node, far in zip(nodes, long.tolist(), strict=True) if far]
        return dict(zip(bent, zip(degrees.tolist(), sines.tolist(), strict=True), strict=True))

    @cached_property
    def axis_words(self) -> list[tuple[str, str]]:
        """For each node where its axes point: as seen from the front, and in the world."""
        arrows, words = self.front.arrows(self.axes.reshape(-1, 3)), directions(self.axes.reshape(-1, 3))
        letters = [LETTERS[k % 3] for k in range(len(words))]
        seen = [f"{letter}{arrow}" for letter, arrow in zip(letters, arrows, strict=True)]
        parts = [f"{letter}:{word}" for letter, word in zip(letters, words, strict=True)]
        return [("".join(seen[k : k + 3]), " ".join(parts[k : k + 3])) for k in range(0, len(words), 3)]

    @cached_property
    def scaled(self) -> list[bool]:
        """Whether each node has a scale of its own."""
        one: Booleans = np.isclose(self.scale, 1.0, rtol=0, atol=SAME_SCALE)
        return [not all(row) for row in one.tolist()]

    @cached_property
    def frames(self) -> list[tuple[bool, bool, bool]]:
        """For each node whether it is no number, mirrored, sheared."""
        with np.errstate(invalid="ignore", over="ignore"):
            mirrored, sheared = determinant(self.world) < 0, skew(self.world) > SKEW
        odd: Booleans = np.asarray(~np.isfinite(self.world).all(axis=(1, 2)))
        return list(zip(odd.tolist(), mirrored.tolist(), sheared.tolist(), strict=True))

    @cached_property
    def turns(self) -> list[float]:
        """How long the rotation of each node is; 1 for those with a matrix."""
        found: list[float] = np.where(self.rig.has_matrix, 1.0, norm(self.rig.rotation)).tolist()
        return found

    @cached_property
    def bound(self) -> Counter[int]:
        """How many offsets are bound to each node."""
        return Counter(bound.node for bound in self.rig.bound)

    @cached_property
    def bones(self) -> dict[int, list[str]]:
        """The VRM bones that each node is."""
        found: dict[int, list[str]] = {}
        for bone, node in self.rig.humanoid.items():
            found.setdefault(node, []).append(f"vrm:{bone}")
        return found


def _constraint_words(rig: Rig, constraint: NodeConstraint) -> str:
    """``rolls about y with hand``."""
    source, axis = rig.title(constraint.source), direction(constraint.axis)
    return {
        "rotation": f"turns with {source}",
        "roll": f"rolls about {axis[1:]} with {source}",
        "aim": f"aims {axis} at {source}",
        "tail": f"is attached to {source}",
    }[constraint.kind]


def direction(v: Floats) -> str:
    """A unit vector: ``+x`` or ``-z`` where it is one to four decimals, else its numbers."""
    return directions(v[np.newaxis])[0]


def directions(v: Floats) -> list[str]:
    """`direction` of each of many, (n, 3)."""
    fine: Booleans = np.isfinite(v)
    rounded = (np.round(v, 4) + 0.0).tolist()
    return [_words(row) if all(each) else "none" for row, each in zip(rounded, fine.tolist(), strict=True)]


def _words(row: list[float]) -> str:
    main = [k for k, x in enumerate(row) if x]
    if len(main) == 1 and abs(row[main[0]]) == 1.0:
        return f"{'+' if row[main[0]] > 0 else '-'}{LETTERS[main[0]]}"
    return f"({' '.join(f'{x:.4g}' for x in row)})"
