"""Bodies on more than four legs, insects and spiders: which pairs are legs, what is up and what is ahead."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import fsum

from rigtri.maths.scalar_vector import Vector
from rigtri.recognition.body_shape import LEG, LEVEL, SIMILAR, across, lowest
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_pairs import Limbs
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.symmetry import Plane, pairs_of
from rigtri.recognition.up_of_legs import on_axis

# Legs go down by this (a cosine), as the file has it, all together.
_STANDS = 0.5
# A row of legs lies along an axis of the file up to this (a cosine, 30°).
_NEAR_AXIS = 0.866
# What goes so far along legs, as a part of these, is no row of them: those of insects go aside.
_ALONG_LEGS = 0.4
# Joints beside the plane by less than this part of the whole are in the middle.
_MIDDLE = 0.02
# An abdomen is longer than a head by more than the first, as a part of both, and by the second to count in
# full: of one joint each, which is longer is chance.
_AS_LONG, _LONGER = 0.1, 0.2
# They tell more than which end is longer: an abdomen of one joint may be as short as a head.
_FEELERS = 2.0
# A pair of feelers, of jaws or of eyes begins so far from the legs, as a part of one of them.
_FAR = 0.15
# Feelers begin ahead of legs and not over them, by this (a cosine, 45°); pincers end in so many branches.
_OVER, _PINCERS = 0.7, 2
# What names call the one end, and the other.
_HEAD = frozenset(["head"])
_ABDOMEN = frozenset(["abdomen", "gaster", "opisthosoma"])


def many_legs(tree: Tree, limbs: Sequence[Limbs], plane: Plane | None) -> tuple[tuple[Limbs, ...], Vector]:
    """Three pairs or more that are all alike and reach as low, and what is up there, unit.

    () for bodies with fewer. Up is what the file has as such, or else where the legs come from.
    """
    standing = Vector(*tree.rig.rules.up)
    if plane is None:
        return (), standing
    # Legs of two joints, as of small spiders, are none without a name: so is the suspension of a car.
    even = [k for k in limbs if across(tree, k, plane) and k.kind in ("leg", "")]
    even = [k for k in even if (k.quality > LEG if len(k.at) == 3 else k.kind == "leg")]
    even = [k for k in even if not any(k.pair.above in o.pair.nodes for o in even)]
    up = up_of_many(even, standing, plane.normal)
    for first in sorted(even, key=lambda k: -k.size) if len(even) > 2 else ():
        ground = lowest(tree, first, up)
        alike = [k for k in even if k.size > SIMILAR * first.size]
        alike = [k for k in alike if abs(lowest(tree, k, up) - ground) < LEVEL * first.size]
        # A root on the ground is below knees, and below what they hang from.
        over = tree.way(-1, first.pair.above)
        least = min(tree.heights([k for k in tree.nodes if k not in over], up))
        if len(alike) >= 3 and least > ground - LEVEL * first.size:
            return tuple(alike), up
    return (), standing


def up_of_many(legs: Sequence[Limbs], standing: Vector, lateral: Vector) -> Vector:
    """Where legs come from, all together, unit; what the file has as up where they stand on that."""
    total, longest = Vector(), max((k.size for k in legs), default=0.0)
    for k in legs:
        if k.size > SIMILAR * longest and len(k.at) == 3:
            total = total + k.starts - k.ends
    up = (total - lateral * total.dot(lateral)).unit
    return standing if up.dot(standing) > _STANDS or not any(up) else up


def up_of_row(legs: Sequence[Limbs], standing: Vector, lateral: Vector) -> Vector:
    """What is up of a row of legs, unit: square to where they begin and to the ground they end on.

    Where they come from, all together, does not tell it: of an insect some pairs may not be known, and the
    others go ahead or back. What the file has as up counts where that is near, or else its nearest axis.
    """
    along, rise = _along_row(legs), _rise_of(legs)
    up = lateral.cross(along).unit
    up = up if up.dot(rise) >= 0.0 else -up
    return standing if up.dot(standing) > _STANDS or not any(up) else on_axis(up, _NEAR_AXIS)


def is_row(legs: Sequence[Limbs]) -> bool:
    """Whether pairs of legs stand behind one another: from leg to leg it does not go along the legs, as from
    a short one to the foot of another."""
    along, rise = _along_row(legs).unit, _rise_of(legs)
    return abs(along.dot(rise)) < _ALONG_LEGS * fsum(k.size for k in legs)


def _along_row(legs: Sequence[Limbs]) -> Vector:
    """From leg to leg, where they begin and where they end, file units."""
    along = Vector()
    for k in legs:
        for other in legs:
            for way in (k.starts - other.starts, k.ends - other.ends):
                along = along + (way if way.dot(along) >= 0.0 else -way)
    return along


def _rise_of(legs: Sequence[Limbs]) -> Vector:
    """Where legs come from, all together, file units."""
    return sum((k.starts - k.ends for k in legs), Vector())


def is_feeler(legs: Sequence[Limbs], limbs: Limbs, up: Vector) -> bool:
    """Whether a pair beside many legs begins ahead of them, as feelers do: arms begin over them.

    up: of the body, unit.
    """
    return limbs.fingers < _PINCERS and (limbs.starts - _middle_of(legs)).unit.dot(up) < _OVER


def _middle_of(legs: Sequence[Limbs]) -> Vector:
    starts = Vector()
    for each in legs:
        starts = starts + each.starts * (1.0 / len(legs))
    return starts


def ends_of_trunk(
    tree: Tree, legs: Sequence[Limbs], plane: Plane, ahead: Vector
) -> Iterator[tuple[float, str]]:
    """What the trunk of many legs says of ahead: weights, negative for the other way, with words."""
    starts = _middle_of(legs)
    names = _named_ends(tree, starts).dot(ahead) / max(each.size for each in legs)
    yield 3.0 * max(-1.0, min(1.0, names / _FAR)), "what its names call the head is there"
    taken = frozenset[int]().union(*(each.pair.nodes for each in legs))
    free = [k for k in tree.nodes if not any(leg in taken for leg in tree.way(-1, k))]
    pairs = [pair for pair in pairs_of(tree) if taken.isdisjoint(pair.nodes)]
    # Feelers begin near the middle, and are longer than many an abdomen.
    free = [k for k in free if not any(k in pair.nodes for pair in pairs)]
    middle = [k for k in free if abs(plane.side_of(tree.at[k])) < _MIDDLE * tree.span]
    along = [(tree.at[k] - starts).dot(ahead) for k in middle]
    front, back = max([*along, 0.0]), -min([*along, 0.0])
    if front + back > _MIDDLE * tree.span:
        longer = (back - front) / (front + back)
        if abs(longer) > _AS_LONG:
            yield 1.5 * max(-1.0, min(1.0, longer / _LONGER)), "the abdomen is behind"
    size = max(each.size for each in legs)
    for pair in pairs:
        if pair.above in middle:
            far = (tree.at[pair.above] - starts).dot(ahead)
            if abs(far) > _FAR * size:
                yield _FEELERS if far > 0 else -_FEELERS, "feelers, jaws or eyes are there"
                return


def _named_ends(tree: Tree, middle: Vector) -> Vector:
    """From what names call the abdomen to what they call the head, each else in the middle."""
    way = Vector()
    for sign, words in ((1.0, _HEAD), (-1.0, _ABDOMEN)):
        called = [k for k in tree.nodes if parse_name(tree.rig.names[k]).words & words]
        for k in called:
            way = way + (tree.at[k] - middle) * (sign / len(called))
    return way
