"""Bodies whose chest is turned against the hips, seen without that: one plane is between both sides then."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import permutations

import numpy as np

from rigtri.maths.quaternions import between as rotation_between
from rigtri.maths.quaternions import rotate
from rigtri.maths.scalar_vector import Vector
from rigtri.maths.trigonometry import Floats
from rigtri.model.dataclass import dataclass
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.symmetry import SQUARE, Pair
from rigtri.recognition.symmetry import between as line_of

# Pairs of branches that are tried, the longest.
_TRIED = 6
# Shorter ones, as a part of the longest, are no limbs.
_LIMB = 0.35
# A chest turned by half a turn (a cosine) has no shortest way back.
_BACK = -0.98


@dataclass(frozen=True, eq=False)
class Twist:
    """How the lines between two limbs of hips and chest lie, and the tree without that.

    tree: with the chest turned back, and all that is below it. hips, between: the line between the legs, and
    what is half-way to that of the arms, unit. pairs: of legs and arms. turned: joints that were turned
    back, by the rotation ``turn``, (4,), about ``centre``.
    """

    tree: Tree
    hips: Vector
    between: Vector
    pairs: tuple[Pair, Pair]
    turned: Sequence[int]
    turn: Floats
    centre: Floats


def twists(tree: Tree, pairs: Sequence[Pair]) -> Iterator[Twist]:
    """The ways to see a chest as turned: for each two pairs of limbs both, as lines have no direction."""
    long = [pair for pair in pairs if pair.reach > _LIMB * pairs[0].reach][:_TRIED]
    for legs, arms in permutations(long, 2):
        chest = arms.above
        if chest < 0 or legs.above == chest or not tree.is_below(chest, legs.above):
            continue
        if any(tree.is_below(chest, path[0]) for path in legs.paths):
            continue
        (low, one), (high, other) = line_of(tree, legs), line_of(tree, arms)
        spine = (high - low).unit
        one, other = (line - spine * line.dot(spine) for line in (one, other))
        one, other = one.unit, other.unit
        if not (any(one) and any(other)) or abs(one.dot(other)) > SQUARE:
            continue
        other = other if one.dot(other) >= 0 else -other
        for line in (other, -other):  # the smaller turn first
            if line.dot(one) > _BACK:
                yield _turned_back(tree, (legs, arms), one, line, high)


def _turned_back(tree: Tree, pairs: tuple[Pair, Pair], hips: Vector, chest: Vector, centre: Vector) -> Twist:
    nodes = tree.branch(pairs[1].above)
    turn, about = rotation_between(np.array([*chest]), np.array([*hips])), np.array([*centre])
    places = tree.places.copy()
    places[nodes] = rotate(turn, places[nodes] - about) + about
    above = tree.above if tree.is_own else None
    back = Tree(tree.rig, tree.nodes, places, above)
    return Twist(back, hips, (hips + chest).unit, pairs, nodes, turn, about)
