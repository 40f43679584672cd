"""What is in front: of four legs those before the head and below the arms of a centaur; arms before wings.

A skeleton may hang from the hips, from the shoulders or from the middle, so that the hierarchy does not tell.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import fsum, inf

from rigtri.maths.scalar_vector import Vector
from rigtri.recognition.body_shape import LEG, Body, are_disjoint
from rigtri.recognition.facing import facing_of
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_pairs import Limbs, ends_in_hand
from rigtri.recognition.limb_triples import TIE
from rigtri.recognition.pose_samples import Poses, how_far
from rigtri.recognition.symmetry import Pair, Plane

# Arms are so long a part of the legs of an animal, at least: a horse's are longer than those of its rider.
_ARMS = 0.4
# Wings begin so far behind arms, as a part of a leg, and score more than these by less than the second, where
# it is so sure, 0 to 1, that legs tell where the body looks.
_BEHIND, _AS_LIKELY, _LOOKS = 0.05, 0.1, 0.5
# Arms begin over the legs of one end of a trunk up to this part of it.
_OVER = 0.3
# What stands so far beyond legs, as parts of the trunk between them, are head and tail, and their tips; a
# joint of the head moves so much more from side to side than one of the tail.
_NEAR, _FAR, _BROADER = 0.1, 0.25, 1.5
# What begins farther from the middle than this part of the trunk is no neck and no tail: noise is less.
_BESIDE = 0.03


def is_further(tree: Tree, body: Body, limbs: Limbs) -> bool:
    """Whether a pair may be the arms of a body that stands on four legs: they begin above the front ones.

    No leg hangs from an arm. What hangs from the trunk where front legs do is a pair of wings.
    """
    return (
        _are_over(tree, body, limbs)
        and not is_beside_legs(body, limbs)
        and limbs.quality > LEG
        and limbs.lead > TIE
    )


def is_beside_legs(body: Body, limbs: Limbs) -> bool:
    """Whether a pair without fingers hangs from the joint where the front legs of a body on four do."""
    front = body.arms if body.form == "quadruped" else None
    return (
        front is not None
        and limbs.pair.above == front.pair.above
        and not ends_in_hand(limbs)
        and not limbs.kind
    )


def is_behind_arms(body: Body, limbs: Limbs, ahead: Vector) -> bool:
    """Whether a pair hangs where the arms of a body on two do, and begins behind these: wings, capes."""
    if body.form != "biped" or body.legs is None or body.arms is None:
        return False
    behind = (body.arms.starts - limbs.starts).dot(ahead) > _BEHIND * body.legs.size
    return behind and limbs.pair.above == body.arms.pair.above and not limbs.kind


def _are_over(tree: Tree, body: Body, limbs: Limbs) -> bool:
    """Whether a pair begins above the front legs, and is as long as arms are, wherever it bends."""
    front, hind = body.arms, body.legs
    if body.form != "quadruped" or not front or not hind or len(limbs.at) < 3 or limbs.kind == "other":
        return False
    if not all(are_disjoint(tree, pair, limbs) for pair in (front, hind)):
        return False
    high, least = (limbs.starts - front.starts).dot(body.up) > 0.0, _ARMS * min(front.size, hind.size)
    return high and limbs.size > least


def turned(
    tree: Tree, ways: Sequence[Body], limbs: Sequence[Limbs], plane: Plane, poses: Poses
) -> list[Body]:
    """The ways to see a body, the other way round first where arms or a head are over its hind legs.

    Where arms are, that one is as sure as its own score: the hierarchy denies it. Where a head is, the
    hierarchy only hangs from the shoulders.
    """
    if not ways:
        return []
    best, *others = ways
    led = head_end(tree, best, plane, poses, limbs) < 0
    if not led and not any(_over_hind_legs(tree, best, each) for each in limbs):
        return list(ways)
    for other in others:
        if other.form == best.form and other.legs is best.arms and other.arms is best.legs:
            score, less = (best.score, other.score) if led else (other.score, best.score)
            first = replace(other, lead=best.lead, score=score)
            return [first, replace(best, score=less), *(k for k in others if k is not other)]
    return list(ways)


def head_end(tree: Tree, body: Body, plane: Plane, poses: Poses, limbs: Sequence[Limbs]) -> int:
    """Where the head of a body on four legs is: 1 at its front ones, −1 at its hind ones, 0 unclear.

    limbs: what may be one: the hands of a centaur are neither head nor tail.

    What names call arms is in front of what they call legs. A head has jaws and ears; where it has none, it
    is broader than a tail and hangs no lower. What is at one end alone is rather a head.
    """
    hind, front = body.legs, body.arms
    if body.form != "quadruped" or hind is None or front is None or hind.place or front.place:
        return 1
    if {hind.kind, front.kind} == {"arm", "leg"}:
        return -1 if hind.kind == "arm" else 1
    ahead = front.starts - hind.starts
    ahead = ahead - body.up * ahead.dot(body.up)  # legs may begin at other heights
    back = -ahead
    aside = [each.pair for each in limbs if _are_over(tree, body, each)]
    tips, others = (_tips(tree, body, _beyond(tree, body, plane, way, _FAR, aside)) for way in (back, ahead))
    if tips != others and max(tips, others) > 1:
        return -1 if tips > others else 1
    one, other = (_beyond(tree, body, plane, way, _NEAR, aside) for way in (back, ahead))
    if not one and not other:
        return 0
    high, low = (max((tree.at[node].dot(body.up) for node in end), default=-inf) for end in (one, other))
    if not high > low:
        return 1
    broader = _breadth(tree, one, plane, poses)[0] > _BROADER * _breadth(tree, other, plane, poses)[1]
    return -1 if broader and low > -inf else 0


def _tips(tree: Tree, body: Body, nodes: Sequence[int]) -> int:
    """How many chains end there. What hangs from elsewhere than the trunk is none: flat copies for a skin."""
    trunk = _trunk(tree, body)
    return sum(not tree.below[node] and not trunk.isdisjoint(tree.way(-1, node)) for node in nodes)


def _trunk(tree: Tree, body: Body) -> set[int]:
    """The joints from the root to where each pair of legs hangs."""
    ends = [pair.pair.above for pair in (body.legs, body.arms) if pair is not None and pair.pair.above >= 0]
    return {k for end in ends for k in tree.way(-1, end)}


def _beyond(
    tree: Tree, body: Body, plane: Plane, way: Vector, share: float, aside: Sequence[Pair]
) -> list[int]:
    """The joints of no leg that are beyond the legs of one end by a share of the trunk.

    Nor those of what begins beside the trunk: wings reach back as far as a tail does.

    way: from the legs of the other end to these. aside: pairs that are left out, too.
    """
    pairs = [pair for pair in (body.legs, body.arms) if pair is not None]
    legs = {k for pair in pairs for path in pair.pair.paths for k in tree.branch(path[0])}
    start = max((pair.starts for pair in pairs), key=lambda place: place.dot(way))
    trunk = _trunk(tree, body)
    legs.update(k for pair in aside for path in pair.paths for k in tree.branch(path[0]))
    long = _BESIDE * way.length
    for node in (k for over in trunk for k in tree.below[over] if k not in trunk | legs):
        if abs(plane.side_of(tree.at[node])) > long:
            legs.update(tree.branch(node))
    free = [k for k in tree.nodes if k not in legs]
    return [k for k in free if (tree.at[k] - start).dot(way) > share * way.dot(way)]


def _breadth(tree: Tree, nodes: Sequence[int], plane: Plane, poses: Poses) -> tuple[float, float]:
    """How far what one joint moves goes from side to side, at the broadest: at least, and at most.

    A box around a long bone that lies across its own axes is broader than that: what it holds reaches from
    one face to the other along one of its edges, and lies anywhere between the others.
    """
    least, most = 0.0, 0.0
    for node in nodes:
        ends = poses.box_of([node], tree.places)
        for first in range(0, len(ends), 8):
            edges = [ends[first + k] for k in (4, 2, 1)]
            sides = [abs(far) for far in how_far(edges, Vector(*ends[first]), plane.normal)]
            least = max(least, 2.0 * max(sides) - fsum(sides))
            most = max(most, fsum(sides))
    return least, most


def before_wings(tree: Tree, ways: Sequence[Body], plane: Plane, poses: Poses) -> list[Body]:
    """The ways to see a body, that one first in which its arms begin ahead of other arms that are as likely.

    Wings and capes hang from the back, arms beside the spine. Feet and knees tell where that is.
    """
    if not ways or ways[0].form != "biped" or ways[0].legs is None or ways[0].arms is None:
        return list(ways)
    best, *others = ways
    legs, arms = ways[0].legs, ways[0].arms
    ahead, sure, _ = facing_of(tree, replace(best, arms=None), plane, poses)
    for other in others if sure > _LOOKS else ():
        as_likely = other.form == "biped" and other.legs is legs and best.score - other.score < _AS_LIKELY
        if (
            as_likely
            and other.arms
            and other.arms.size > _ARMS * arms.size
            and is_behind_arms(other, arms, ahead)
        ):
            return [replace(other, lead=best.lead), best, *(k for k in others if k is not other)]
    return list(ways)


def _over_hind_legs(tree: Tree, body: Body, limbs: Limbs) -> bool:
    """Whether a pair that may be arms begins over what is taken for hind legs."""
    if (
        body.legs is None
        or body.arms is None
        or limbs in (body.legs, body.arms)
        or not is_further(tree, body, limbs)
    ):
        return False
    spine = body.arms.starts - body.legs.starts
    return (limbs.starts - body.legs.starts).dot(spine) < _OVER * spine.dot(spine)
