"""Branches that are alike, and the plane between left and right.

What is alike is told by lengths of bones, which no pose changes; only the plane is told by places.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from rigtri.recognition.tree import Tree, span
from rigtri.trigonometry import Floats
from rigtri.vectors import dot, length, normalise

# Branches shorter than this part of the whole are no limbs.
SHORT = 0.06
# Bones are alike up to this part of their length: hand-made characters are not quite even.
ALIKE = 0.15
# Short bones may differ by this part of the whole branch.
SLACK = 0.02
# Pairs shorter than this part of the longest have no say in where the plane is.
_HEARD = 0.35
# Of more branches at one node the longest are compared; of more joints the mirror image of so many is.
_MOST, _MANY = 16, 160


@dataclass(frozen=True)
class Pair:
    """Two branches that are alike: the node above both, −1 for none, and their longest ways down.

    paths: as far as they are alike, equally long. reach: the length of the shorter one.
    """

    above: int
    paths: tuple[tuple[int, ...], tuple[int, ...]]
    reach: float

    @property
    def nodes(self) -> frozenset[int]:
        return frozenset(self.paths[0]) | frozenset(self.paths[1])


@dataclass(frozen=True, eq=False)
class Plane:
    """The plane between left and right: a point and a unit normal, (3,) each.

    share: how much of the body is its own mirror image in it, 0 to 1.
    """

    point: Floats
    normal: Floats
    share: float

    def side_of(self, points: Floats) -> Floats:
        """How far points, (..., 3), are from the plane, to the side of the normal positive."""
        return dot(points - self.point, self.normal)


def pairs_of(tree: Tree) -> list[Pair]:
    """The pairs of branches below one node, or without any above, that are alike; longest first."""
    whole = span(tree.places, tree.nodes)
    found = []
    for above, below in tree.below.items():
        long = [k for k in below if tree.bone[k] + tree.reach[k] > SHORT * whole]
        long.sort(key=lambda k: -(tree.bone[k] + tree.reach[k]))
        for a, b in combinations(long[:_MOST], 2):
            pair = _alike(tree, above, a, b)
            if pair is not None and pair.reach > SHORT * whole:
                found.append(pair)
    return sorted(found, key=lambda pair: -pair.reach)


def _alike(tree: Tree, above: int, a: int, b: int) -> Pair | None:
    if above >= 0 and not _near(tree.bone[a], tree.bone[b], max(tree.reach[a], tree.reach[b])):
        return None
    same, reach = 1, 0.0
    for left, right in zip(tree.paths[a][1:], tree.paths[b][1:], strict=False):
        if not _near(tree.bone[left], tree.bone[right], tree.reach[a]):
            break
        same, reach = same + 1, reach + min(tree.bone[left], tree.bone[right])
    if reach < 0.6 * min(tree.reach[a], tree.reach[b]):
        return None
    paths = tree.paths[a][:same], tree.paths[b][:same]
    apart = tree.places[list(paths[0])] - tree.places[list(paths[1])]
    return Pair(above, paths, reach) if float(np.abs(apart).max()) > 0.01 * reach else None


def _near(a: float, b: float, reach: float) -> bool:
    return abs(a - b) <= ALIKE * max(a, b) + SLACK * reach


def plane_of(tree: Tree, pairs: Sequence[Pair]) -> Plane | None:
    """The plane that most of the body is alike on both sides of; None without pairs."""
    if not pairs:
        return None
    whole = span(tree.places, tree.nodes)
    up = np.asarray(tree.rig.up, dtype=np.float64)
    # Fingers are alike, too: they have no say beside arms.
    pairs = [pair for pair in pairs[:24] if pair.reach > _HEARD * pairs[0].reach]
    lines = [between(tree, pair) for pair in pairs]
    points, normals = (np.stack(each) for each in zip(*lines, strict=True))
    reaches = np.array([pair.reach for pair in pairs])
    most = 0.0
    for reach in reaches.tolist():
        most += reach
    best, which = -1.0, 0
    shares = []
    for k in range(min(len(lines), 10)):
        agree = np.abs(dot(normals, normals[k])) > 0.93
        agree &= np.abs(dot(points - points[k], normals[k])) < 0.06 * whole
        weight = 0.0
        for reach in reaches[agree].tolist():
            weight += reach
        mirrored = _mirrored(tree, points[k], normals[k], 0.02 * whole)
        shares.append(mirrored)
        upright = 0.1 * (1.0 - abs(float(dot(normals[k], up))))
        score = weight / most + mirrored + upright
        if score > best + 1e-9:
            best, which = score, k
    return Plane(points[which], normals[which], shares[which])


def between(tree: Tree, pair: Pair) -> tuple[Floats, Floats]:
    """The middle between a pair and the direction from one to the other, where they first part."""
    left, right = (tree.places[list(path)] for path in pair.paths)
    apart = length(left - right)
    far = apart > 0.1 * pair.reach
    at = int(np.argmax(far)) if far.any() else int(np.argmax(apart))
    return 0.5 * (left[at] + right[at]), normalise(left[at] - right[at])


def _mirrored(tree: Tree, point: Floats, normal: Floats, near: float) -> float:
    """The share of joints that have another, or themselves, at their mirror image."""
    nodes = sorted(tree.nodes, key=lambda k: -(tree.bone[k] + tree.reach[k]))[:_MANY]
    places = tree.places[nodes]
    image = places - 2.0 * dot(places - point, normal)[:, np.newaxis] * normal
    apart = image[:, np.newaxis] - places[np.newaxis]
    squares = dot(apart, apart)
    return float(np.count_nonzero(squares.min(axis=1) < near * near)) / len(nodes)
