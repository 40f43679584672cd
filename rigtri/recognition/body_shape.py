"""Body shape: which pairs of branches are legs and arms.

Every way to take one pair of branches for legs and another for arms, or none, is weighed by what bodies
have in common: legs carry and are longest, arms begin higher in the tree, a head stands beyond them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain
from math import fsum
from typing import Literal

from rigtri.maths.ranking import SAME_SCORE, ranked
from rigtri.maths.scalar_vector import Vector
from rigtri.model.dataclass import dataclass
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_pairs import TRIED, Limbs
from rigtri.recognition.naming_schemes import roles_in_name
from rigtri.recognition.symmetry import SQUARE, Plane, between
from rigtri.recognition.up_of_legs import (
    OTHER_UP,
    REPTILE,
    SPRAWLS,
    go_aside,
    has_tail,
    up_of_trunk,
    ups_of_pairs,
    way_of,
)

# No pair without another scores so much.
_ALONE = 0.76
# What a body loses beside which another pair stands on the ground.
_LEFT_OVER = 0.1
# Of many legs each is so long a part of the longest, and so limb-like.
SIMILAR, LEG = 0.6, 0.2
# Legs that go down by less than this (a cosine) as the file has it do not stand on its ground; those that go
# along a tail by this trail behind who flies.
_LYING, _TRAILING = 0.3, 0.8
# A trunk that goes up, or down, by more than this (a cosine) is not one of front legs ahead of hind ones.
_UPRIGHT = 0.8
# What legs lose that begin deeper in the tree than arms.
_DEEPER = 0.15
# What legs lose that go the way of the spine.
_UPWARDS = 0.4
# What legs lose that are called front legs, or where arms are called hind legs.
_MISNAMED = 0.4
# The limbs of a body on four legs reach the ground: they end as low, up to this part of a leg.
LEVEL = 0.3


@dataclass(frozen=True, eq=False)
class Body:
    """One way to see a body. legs, arms: either may be missing. score: 0 to 1. lead: over the same pairs
    the other way round. up: unit. doubt: its trunk lies, so that arms may be front legs, or these arms."""

    legs: Limbs | None
    arms: Limbs | None
    form: Literal["biped", "quadruped"]
    up: Vector
    score: float
    lead: float = 0.0
    doubt: bool = False


def bodies(tree: Tree, limbs: Sequence[Limbs], plane: Plane | None) -> list[Body]:
    """The ways to take pairs for legs and arms, the likeliest first; one alone where it may be that."""
    if plane is None:
        return []
    even = [pair for pair in limbs if pair.kind != "other" and across(tree, pair, plane)][:TRIED]
    both = [_with_arms(tree, legs, even) for legs in even]
    clear = any(way.score > _ALONE for ways in both for way in ways)
    alone = [() if clear else _alone(tree, legs, even) for legs in even]
    ways = [way for each in zip(alone, both, strict=True) for ways in each for way in ways]
    ways = [replace(k, score=k.score - _LEFT_OVER) if stands_too(tree, k, even) else k for k in ways]
    if any(k.legs and k.arms and _are_front_and_hind(k.arms, k.legs) for k in ways):
        ways = [k for k in ways if k.legs and k.arms]
    ways = ranked(ways, lambda body: body.score, SAME_SCORE)
    if not ways:
        return []
    best = ways[0]
    turned = [k.score for k in ways if k.legs is best.arms and k.arms is best.legs]
    return [replace(best, lead=best.score - max(turned, default=0.0)), *ways[1:]]


def across(tree: Tree, limbs: Limbs, plane: Plane) -> bool:
    """Whether the plane lies between the two."""
    middle, line = between(tree, limbs.pair)
    if not abs(line.dot(plane.normal)) > SQUARE:
        return False
    widest = max(tree.at[a].distance(tree.at[b]) for a, b in zip(*limbs.pair.paths, strict=True))
    return widest > 3.0 * abs(plane.side_of(middle))


def _longest(limbs: Limbs, others: Sequence[Limbs]) -> float:
    """The size of the largest of all that are like limbs, or of these."""
    return max([limbs.size, 1e-30, *(k.size for k in others if k.quality > 0.3)])


def _with_arms(tree: Tree, legs: Limbs, others: Sequence[Limbs]) -> list[Body]:
    """A pair as legs, with each other that is apart from it as arms."""
    longest = _longest(legs, others)
    arms = [k for k in others if k is not legs and are_disjoint(tree, legs, k)]
    return [_both(tree, legs, k, others, longest) for k in arms]


def _alone(tree: Tree, limbs: Limbs, others: Sequence[Limbs]) -> tuple[Body, Body]:
    """A pair as legs without arms, and as arms without legs."""
    longest = _longest(limbs, others)
    return _legs_alone(tree, limbs, longest), _arms_alone(tree, limbs, longest)


def are_disjoint(tree: Tree, legs: Limbs, arms: Limbs) -> bool:
    """Whether neither pair is a part of the other."""
    if legs.pair.nodes & arms.pair.nodes:
        return False
    firsts = [(path[0], limbs) for limbs in (legs, arms) for path in limbs.pair.paths]
    return not any(tree.is_below(a, b) for a, one in firsts for b, other in firsts if one is not other)


def _both(tree: Tree, legs: Limbs, arms: Limbs, others: Sequence[Limbs], longest: float) -> Body:
    """A pair as legs and another as arms, up as suits them best: what supports it, as a weighted mean."""
    spine = arms.starts - legs.starts
    on, down, out = spine.unit, way_of(legs), way_of(arms)
    common = tree.common(legs.pair.above, arms.pair.above)
    tier = _tier(tree, arms.pair.above, common) - _tier(tree, legs.pair.above, common)
    tier = 1 if _are_front_and_hind(arms, legs) else tier
    ratio = spine.length / max(legs.size, 1e-30)
    points = [
        (1.0, 1.0 if tier > 0 else 0.4 if tier == 0 else 0.0),
        (0.6, within(ratio, 0.05, 0.4) * (1.0 - within(ratio, 2.5, 5.0))),
        (0.6, within(min(arms.size / max(legs.size, 1e-30), legs.size / max(arms.size, 1e-30)), 0.2, 0.55)),
        (0.5, within(legs.quality, 0.2, 0.6)),
        (0.5, within(arms.quality, 0.2, 0.6)),
        (0.6, 0.5 if arms.fingers == legs.fingers else 1.0 if arms.fingers > legs.fingers else 0.0),
        (0.5, within(max(legs.size, arms.size) / longest, 0.2, 0.6)),
        (0.8, within(legs.pair.reach / _most_beside(legs, others), 0.4, 1.0)),
    ]
    passed = _passed_over(tree, arms, others, common)
    cost = _DEEPER if tier < 0 else 0.0
    cost += _MISNAMED * (legs.place == "front" or arms.place == "hind")
    front_legs = _are_front_and_hind(arms, legs) or (arms.kind == "leg" and arms.place == "front")
    beyond = _beyond(tree, legs, arms)
    seen: list[Body] = []
    for up, trust in ups_of_pairs(tree, legs, arms):
        tall, stands, hangs = on.dot(up), down.dot(-up), out.dot(-up)
        if front_legs and trust < 1.0 and abs(tall) > _UPRIGHT and seen:
            continue  # from hind to front legs it goes ahead
        above = abs(lowest(tree, legs, up) - lowest(tree, arms, up)) / height(tree, legs, up)
        flat = abs(tall) < 0.6
        level = flat and (above < LEVEL or (above < 2.0 * LEVEL and has_tail(tree, legs, arms, on, REPTILE)))
        level = level and go_aside(tree, legs, arms)
        lies = flat and min(hangs, stands) > (SPRAWLS if level else 0.75)
        four = front_legs or (lies and above < LEVEL)
        turned = [
            (1.0, trust * within(stands, 0.0, 0.7)),
            (0.8, trust * (0.9 if four else within(tall, 0.3, 0.8))),
            (0.8, _head(beyond, arms, on + up)),
            (1.0, 0.0 if passed and not (four and above < LEVEL) else 1.0),  # no hair stands on the ground
        ]
        # Branches that grow upwards are no legs, but for a trunk on four that goes down to the front.
        upwards = _UPWARDS if down.dot(on) > 0.3 and not four else 0.0
        score = _mean([*points, *turned]) - cost - upwards
        form: Literal["biped", "quadruped"] = "quadruped" if four else "biped"
        seen.append(Body(legs, arms, form, up, score, doubt=lies and not front_legs))
    return ranked(seen, lambda body: body.score, SAME_SCORE)[0]


def _are_front_and_hind(arms: Limbs, legs: Limbs) -> bool:
    """Whether names say that two pairs are the front and the hind legs; front ones have elbows, too."""
    return legs.kind == "leg" and arms.place == "front" and legs.place == "hind"


def lowest(tree: Tree, limbs: Limbs, up: Vector) -> float:
    """How high the lowest joint of two limbs stands."""
    return min(tree.heights(chain.from_iterable(limbs.pair.paths), up))


def _low(tree: Tree, limbs: Limbs, up: Vector) -> float:
    """How high the lowest joint of two limbs and all below them stands."""
    return min(tree.heights([k for path in limbs.pair.paths for k in tree.branch(path[0])], up))


def height(tree: Tree, legs: Limbs, up: Vector) -> float:
    """How high legs begin over the lowest joint of them, above 0."""
    return max(legs.starts.dot(up) - lowest(tree, legs, up), 1e-30)


def stands_too(tree: Tree, body: Body, limbs: Sequence[Limbs]) -> bool:
    """Whether another pair reaches as low as a body's legs do, and is as long: it may be legs, too."""
    if (legs := body.legs) is None:
        return False
    ground = lowest(tree, legs, body.up)
    return any(
        len(k.at) == 3
        and k not in (legs, body.arms)
        and k.kind in ("leg", "")
        and k.quality > LEG
        and k.size > SIMILAR * legs.size
        and k.pair.above not in (*legs.pair.nodes, legs.pair.above)
        and _low(tree, k, body.up) < ground + LEVEL * legs.size
        for k in limbs
    )


def lies(tree: Tree, body: Body, up: Vector) -> bool:
    """Whether legs alone, as a bird's, go nowhere near to down, as the file has it, nor back along a tail.

    Or do not stand on that, below a trunk that rises along another axis.
    """
    legs = body.legs
    if legs is None or body.arms is not None:
        return False
    if any(up_of_trunk(tree, legs)):
        return True
    down = (legs.ends - legs.starts).unit
    tail = (tree.at[k] - legs.starts for k in tree.nodes if "tail" in roles_in_name(tree.rig.names[k]))
    return -down.dot(up) < _LYING and not any(way.unit.dot(down) > _TRAILING for way in tail)


def _most_beside(legs: Limbs, others: Sequence[Limbs]) -> float:
    """The reach of the longest pair that hangs where these do: beside a skirt the legs are."""
    return max([legs.pair.reach, *(k.pair.reach for k in others if k.pair.above == legs.pair.above)])


def _passed_over(tree: Tree, arms: Limbs, others: Sequence[Limbs], common: int) -> bool:
    """Whether a pair is at the spine, below the arms, that would be arms as well: they are hair, or ears.

    What ends in fingers with a thumb is neither.
    """
    high = arms.pair.above
    between = set(tree.way(common, high)[1:-1]) if high >= 0 else set()
    return any(
        k.pair.above in between
        and len(k.at) == 3
        and (k.thumb or not arms.thumb)
        and k.quality > 0.45
        and k.size > 0.3 * arms.size
        for k in others
    )


def _legs_alone(tree: Tree, legs: Limbs, longest: float) -> Body:
    """A pair as legs, and no arms: a bird, or the lower part of a body."""
    down = legs.ends - legs.starts
    ups = [(Vector(*tree.rig.rules.up), 1.0), ((-down).unit, OTHER_UP)]
    if any(axis := up_of_trunk(tree, legs)):
        ups = [(axis, OTHER_UP)]
    stands = [(trust * within(down.unit.dot(-up), 0.2, 0.8), up) for up, trust in ups]
    upright, up = max(stands, key=lambda each: each[0])
    points = [(1.0, upright), (0.6, within(legs.quality, 0.3, 0.7)), (1.0, legs.size / longest), (1.0, 0.0)]
    return Body(legs, None, "biped", up, _mean(points) - _MISNAMED * (legs.kind == "arm"))


def _arms_alone(tree: Tree, arms: Limbs, longest: float) -> Body:
    """A pair as arms, and no legs: the upper part of a body."""
    up = Vector(*tree.rig.rules.up)
    points = [
        (1.0, within(_head(_beyond(tree, arms, arms), arms, up), 0.3, 1.0)),
        (0.6, within(arms.quality, 0.3, 0.7)),
        (0.6, 1.0 if arms.fingers > 1 else 0.5),
        (0.4, 1.0 if tree.depth[arms.pair.above] > 0 and arms.pair.above >= 0 else 0.0),
        (0.5, arms.size / longest),
        (1.0, 0.0),
    ]
    return Body(None, arms, "biped", up, _mean(points) - _MISNAMED * (arms.kind == "leg"))


def _tier(tree: Tree, node: int, common: int) -> int:
    return (tree.depth[node] if node >= 0 else -1) - (tree.depth[common] if common >= 0 else -1)


def _beyond(tree: Tree, legs: Limbs, arms: Limbs) -> list[Vector]:
    """From the arms to all joints of no limb that hang where the arms do, or up to two above."""
    limbs = {path[0] for pair in (legs, arms) for path in pair.pair.paths}
    above, found = arms.pair.above, []
    for _ in range(3):
        for child in tree.below.get(above, []):
            if not any(tree.is_below(first, child) for first in limbs):
                found += [tree.at[k] - arms.starts for k in tree.branch(child)]
        if above < 0 or above == legs.pair.above:
            break
        above = tree.above[above]
    return found


def _head(beyond: Sequence[Vector], arms: Limbs, over: Vector) -> float:
    """Whether something stands over the arms that is not a limb: 1, 0.3 where nothing does."""
    return 1.0 if any(place.dot(over) > 0.05 * arms.size for place in beyond) else 0.3


def within(value: float, low: float, high: float) -> float:
    """0 up to ``low``, 1 from ``high`` on, evenly between."""
    return min(1.0, max(0.0, (value - low) / (high - low)))


def _mean(points: Sequence[tuple[float, float]]) -> float:
    return fsum(weight * value for weight, value in points) / fsum(weight for weight, _ in points)
