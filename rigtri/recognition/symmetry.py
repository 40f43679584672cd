"""Symmetric branches, and the plane between left and right.

Symmetry is measured by lengths of bones, which no pose changes; only the plane is measured by positions.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from itertools import combinations
from math import fsum

import numpy as np

from rigtri.maths.ranking import SAME_LENGTH, ranked
from rigtri.maths.scalar_vector import Vector
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot
from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import Side, twin
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_words import Place, limb_words
from rigtri.recognition.name_parsing import parse_name

# Branches shorter than this part of the whole are no limbs.
SHORT = 0.06
# Bones are alike up to this part of their length: hand-made characters are not quite even.
SIMILAR_LENGTH = 0.15
# Short bones may differ by this part of the whole branch.
SLACK = 0.02
# Where no two pairs of limbs are found so, noise of a hundredth of the body is allowed for: bones may differ
# by so much of their length, and by so much of the branch.
_ROUGH_LENGTH, _ROUGH_SLACK = 0.25, 0.1
# Bones whose names are each other's on the other side are alike up to this part.
_NAMED = 0.4
# Pairs shorter than this part of the longest have no say in where the plane is.
_VOTING = 0.35
# The line between two limbs of a pair lies across the plane: the cosine, which allows for a turned chest.
SQUARE = 0.8
# By so much a plane through two pairs has to be better than that of one.
_BETTER = 0.02
# A pair agrees with a plane that is no further from its middle than this part of the whole, and along which
# its limbs are no further from each other: a front leg and the hind one of the other side are.
_ASIDE = 0.06
# Directions nearer to each other than this (a cosine) are one.
_SAME_WAY = 0.93
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

    @cached_property
    def nodes(self) -> frozenset[int]:
        return frozenset(self.paths[0]) | frozenset(self.paths[1])


@dataclass(frozen=True, eq=False)
class Plane:
    """The plane between left and right: a point and a unit normal.

    share: how much of the body is its own mirror image in it, 0 to 1.
    """

    point: Vector
    normal: Vector
    share: float

    def side_of(self, point: Vector) -> float:
        """How far a point is from the plane, to the side of the normal positive."""
        on, across = self.point, self.normal
        return (point.x - on.x) * across.x + (point.y - on.y) * across.y + (point.z - on.z) * across.z


def pairs_of(tree: Tree, *, rough: bool = False) -> list[Pair]:
    """The pairs of branches below one node, or without any above, that are alike; longest first.

    rough: noise may have changed the lengths of their bones.
    """
    whole = tree.span
    found = []
    for above, below in tree.below.items():
        long = [k for k in below if tree.bone[k] + tree.reach[k] > SHORT * whole]
        long = ranked(long, lambda k: tree.bone[k] + tree.reach[k], SAME_LENGTH * whole)
        for a, b in combinations(long[:_MOST], 2):
            pair = _mirrored_pair(tree, above, a, b, rough)
            if pair is not None and pair.reach > SHORT * whole:
                found.append(pair)
    return ranked(found, lambda pair: pair.reach, SAME_LENGTH * whole)


def _mirrored_pair(tree: Tree, above: int, a: int, b: int, rough: bool) -> Pair | None:
    if above >= 0 and not _near(tree.bone[a], tree.bone[b], max(tree.reach[a], tree.reach[b]), rough):
        return None
    same, reach = 1, 0.0
    for left, right in zip(tree.paths[a][1:], tree.paths[b][1:], strict=False):
        if not _near(tree.bone[left], tree.bone[right], tree.reach[a], rough):
            break
        same, reach = same + 1, reach + min(tree.bone[left], tree.bone[right])
    if reach < 0.6 * min(tree.along[a], tree.along[b]):
        return None
    paths = tree.paths[a][:same], tree.paths[b][:same]
    ends = [(tree.at[left], tree.at[right]) for left, right in zip(*paths, strict=True)]
    apart = max(abs(far) for left, right in ends for far in left - right)
    return Pair(above, paths, reach) if apart > 0.01 * reach else None


def named_pairs(tree: Tree, pairs: Sequence[Pair]) -> list[Pair]:
    """Further pairs of branches: those that names say are twins, ``humerus_L`` and ``humerus_R``.

    Noise and sculpted poses make bones of twins less alike than those that shape alone has for such.
    """
    names, known = tree.rig.names, [pair.nodes for pair in pairs]
    found: list[Pair] = []
    for above, below in tree.below.items():
        by_name = {names[k]: k for k in below if names[k]}
        by_words = {words_of(names[k]): k for k in below if names[k]}
        for name, a in by_name.items():
            b = by_name.get(twin(name, by_name), _twin_by_words(name, by_words, a))
            if a == b or any(a in nodes and b in nodes for nodes in known):
                continue
            paths = _named_alike(tree, a, b)
            reach = min(fsum(tree.bone[k] for k in path[1:]) for path in paths)
            if reach > max(SHORT * tree.span, 0.6 * min(tree.reach[a], tree.reach[b])):
                found.append(Pair(above, paths, reach))
                known.append(found[-1].nodes)
    return found


def parted_by_names(tree: Tree, pair: Pair) -> bool:
    """Whether names say that both branches have another twin each: an insect's legs all are alike."""
    names = tree.rig.names
    one, other = (names[path[0]] for path in pair.paths)
    if not (one and other) or _are_twins(one, other):
        return False
    beside = [names[k] for k in tree.below[pair.above] if names[k]]
    return all(any(_are_twins(mine, name) for name in beside if name != mine) for mine in (one, other))


def words_of(name: str) -> tuple[Side, str, Place]:
    """The side that a name says, its words without it, and its place: ``FL_hip`` and ``FR_hip`` are twins."""
    parsed = parse_name(name)
    return parsed.side, parsed.raw, limb_words(name).place


def _twin_by_words(name: str, by_words: Mapping[tuple[Side, str, Place], int], node: int) -> int:
    """The twin of ``node``, whose name this is, by the words of names; itself where there is none.

    ``lf`` is the front left one, and of others the left of ``rt``.
    """
    which, plain, place = words_of(name)
    other: Side = "right" if which == "left" else "left"
    return by_words.get((other, plain, place), by_words.get((other, plain, ""), node)) if which else node


def _are_twins(one: str, other: str) -> bool:
    """Whether two names are each other's on the other side."""
    return twin(one, [other]) == other or _twin_by_words(one, {words_of(other): 1}, 0) == 1


def _named_alike(tree: Tree, a: int, b: int) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """The longest ways down from two twins, as far as names say that and bones do not deny it."""
    same, names, bone = 1, tree.rig.names, tree.bone
    for left, right in zip(tree.paths[a][1:], tree.paths[b][1:], strict=False):
        if not _are_twins(names[left], names[right]) or abs(bone[left] - bone[right]) > _NAMED * max(
            bone[left], bone[right]
        ):
            break
        same += 1
    return tree.paths[a][:same], tree.paths[b][:same]


def _near(a: float, b: float, reach: float, rough: bool) -> bool:
    similar, slack = (_ROUGH_LENGTH, _ROUGH_SLACK) if rough else (SIMILAR_LENGTH, SLACK)
    return abs(a - b) <= similar * max(a, b) + slack * reach


def plane_of(tree: Tree, pairs: Sequence[Pair]) -> Plane | None:
    """The plane that most of the body is alike on both sides of; None without pairs."""
    if not pairs:
        return None
    whole, up = tree.span, Vector(*tree.rig.rules.up)
    # Fingers are alike, too: they have no say beside arms.
    votes = [
        (*between(tree, pair), pair.reach) for pair in pairs[:24] if pair.reach > _VOTING * pairs[0].reach
    ]
    apart = [_apart(tree, pair) for pair in pairs[: len(votes)]]
    most = fsum(reach for _, _, reach in votes)
    long = ranked(tree.nodes, lambda k: tree.bone[k] + tree.reach[k], SAME_LENGTH * whole)
    places = tree.places[long[:_MANY]]

    def score(point: Vector, normal: Vector) -> tuple[float, Plane]:
        agree = fsum(
            reach
            for (other, across, reach), line in zip(votes, apart, strict=True)
            if abs(across.dot(normal)) > _SAME_WAY
            and abs((other - point).dot(normal)) < _ASIDE * whole
            and (line - normal * line.dot(normal)).length < _ASIDE * whole
        )
        share = _mirrored(places, point, normal, 0.02 * whole)
        return agree / most + share + 0.1 * (1.0 - abs(normal.dot(up))), Plane(point, normal, share)

    best, found = -1.0, None
    for point, normal, _ in votes[:10]:
        value, plane = score(point, normal)
        if value > best + 1e-9:
            best, found = value, plane
    for point, normal in (*_through_two(votes, found), *_averaged(tree, pairs[:24], votes[:10])):
        value, plane = score(point, normal)
        # Exact bodies keep the plane of one pair: rounding chooses nothing.
        if value > best + _BETTER:
            best, found = value, plane
    return found


def _through_two(
    votes: Sequence[tuple[Vector, Vector, float]], plane: Plane | None
) -> Iterator[tuple[Vector, Vector]]:
    """Planes through the middles of the longest pair and of another, nearest to one that is known.

    The line between two limbs of a narrow body tells its direction badly: far away that is far off.
    """
    if plane is None:
        return
    first = votes[0][0]
    for middle, *_ in votes[1:10]:
        on = (middle - first).unit
        yield first, (plane.normal - on * plane.normal.dot(on)).unit


def _averaged(
    tree: Tree, pairs: Sequence[Pair], votes: Sequence[tuple[Vector, Vector, float]]
) -> Iterator[tuple[Vector, Vector]]:
    """One plane for each direction of votes: square to the lines between all joints of pairs along it.

    Of narrow bodies with noise the line of no single pair is good enough, and that of a limb and the one
    behind it, which is longer, would win.
    """
    known: list[Vector] = []
    across = [between(tree, pair)[1] for pair in pairs]
    for _, way, _ in votes:
        if any(abs(way.dot(other)) > _SAME_WAY for other in known):
            continue
        known.append(way)
        lines, middles, count = Vector(), Vector(), 0
        for pair, its in zip(pairs, across, strict=True):
            if abs(its.dot(way)) <= _SAME_WAY:
                continue
            for a, b in zip(*pair.paths, strict=True):
                line = tree.at[a] - tree.at[b]
                lines = lines + line * (1.0 if line.dot(way) > 0 else -1.0)
                middles, count = middles + (tree.at[a] + tree.at[b]) * 0.5, count + 1
        if count:
            yield middles * (1.0 / count), lines.unit


def opposite(tree: Tree, pairs: Sequence[Pair], plane: Plane | None) -> list[Pair]:
    """The pairs without those of a limb and another than its mirror image: the one behind it is alike, too.

    Of the pairs that a branch is in, the one stays whose other branch begins nearest to its image.
    """
    if plane is None:
        return list(pairs)
    off = {pair: _off(tree, pair, plane) for pair in pairs}
    nearest: dict[int, float] = {}
    for pair, far in off.items():
        for path in pair.paths:
            nearest[path[0]] = min(far, nearest.get(path[0], far))
    return [pair for pair in pairs if all(off[pair] <= nearest[path[0]] + 1e-9 for path in pair.paths)]


def _off(tree: Tree, pair: Pair, plane: Plane) -> float:
    """How far the start of one limb, and less so its end, is from the mirror image of the other's."""
    total = 0.0
    for k, weight in ((0, 1.0), (min(1, len(pair.paths[0]) - 1), 0.5), (-1, 0.25)):
        one, other = (tree.at[path[k]] for path in pair.paths)
        image = one - plane.normal * (2.0 * plane.side_of(one))
        total += weight * image.distance(other)
    return total


def between(tree: Tree, pair: Pair) -> tuple[Vector, Vector]:
    """The middle between a pair and the direction from one to the other, where they first part."""
    left, right = _first_apart(tree, pair)
    return (left + right) * 0.5, (left - right).unit


def _apart(tree: Tree, pair: Pair) -> Vector:
    """From one of a pair to the other, where they first part."""
    left, right = _first_apart(tree, pair)
    return left - right


def _first_apart(tree: Tree, pair: Pair) -> tuple[Vector, Vector]:
    at, most, found = tree.at, -1.0, (Vector(), Vector())
    for a, b in zip(*pair.paths, strict=True):
        apart = at[a].distance(at[b])
        if apart > 0.1 * pair.reach:
            return at[a], at[b]
        if apart > most:
            most, found = apart, (at[a], at[b])
    return found


def _mirrored(places: Floats, point: Vector, normal: Vector, near: float) -> float:
    """The share of places, (n, 3), that have another, or themselves, at their mirror image."""
    across = np.array([*normal])
    image = places - 2.0 * dot(places - [*point], across)[:, np.newaxis] * across
    x, y, z = (image[:, axis, np.newaxis] - places[:, axis] for axis in range(3))
    squares = x * x + y * y + z * z
    return float(np.count_nonzero(squares.min(axis=1) < near * near)) / len(places)
