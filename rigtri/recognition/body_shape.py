"""Body shape: which pairs of branches are legs and arms.

Every way to take one pair of branches for legs and another for arms, or none, is weighed by what bodies
have in common: legs carry and are longest, arms begin higher in the tree, a head stands beyond them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import fsum
from typing import Literal

from rigtri.maths.ranking import SAME_SCORE, ranked
from rigtri.maths.scalar_vector import Vector
from rigtri.model.dataclass import dataclass
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_pairs import TRIED, Limbs
from rigtri.recognition.naming_schemes import roles_in_name
from rigtri.recognition.symmetry import SQUARE, Plane, between
from rigtri.recognition.up_of_legs import axis_of, on_axis, up_of_trunk

# Another file's up than the one it says counts so much less.
_OTHER_UP = 0.8
# No pair without another scores so much.
_ALONE = 0.76
# What a body loses beside which another pair stands on the ground.
_LEFT_OVER = 0.1
# Of many legs each is so long a part of the longest, and so limb-like.
SIMILAR, LEG = 0.6, 0.2
# Legs that go down by this (a cosine), as the file has it, or a trunk that goes up leave no doubt what is up.
_STANDS = 0.7
# Legs go aside from a trunk that lies, or leans as dinosaurs do (cosines). Their tails, in legs, at least.
_ASIDE, _LEANING, _TAIL = 0.5, 0.8, 0.2
# Limbs that both go less than this part of their size the same way go apart.
_APART = 0.02
# What goes aside by less than this part of its way is in the middle.
_MIDMOST = 0.1
# Legs that go down an axis of the file by this (a cosine, 15°) stand on it, however the trunk leans; and so
# upright is the trunk of a body that sits.
_ALONG_AXIS = 0.966
# Up to wrist and hock an animal's legs lean by up to this (a cosine, 30°); another up turns by right angles.
_LEANS = 0.866
# Legs that are stretched ahead are square to the trunk up to this (a sine), and bend by less than 25°.
# Arms smaller than this part of legs are those of a dinosaur.
_LEVEL, _STRETCHED, _SMALL = 0.35, 0.906, 0.3
# Legs that go down by less than this (a cosine) as the file has it do not stand on its ground; those that go
# along a tail by this trail behind who flies.
_LYING, _TRAILING = 0.3, 0.8
# Hands so far behind shoulders (a sine, 24°) hold no trunk that lies.
_BEHIND = 0.4
# Hands, knees and toes that stand on one ground differ by less than this part of a leg: flesh and heels do.
_GROUND = 0.08
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
    widest = max((tree.at[a] - tree.at[b]).length for a, b in zip(*limbs.pair.paths, strict=True))
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


def _ups(tree: Tree, legs: Limbs, arms: Limbs) -> list[tuple[Vector, float]]:
    """Directions that may be up for a pair as legs and another as arms, unit, with how far each is trusted.

    The file's, and others where neither legs nor trunk stand on that: the axis that legs go down, else what
    trunk or limbs show; not what goes from left to right. Where a trunk goes on in a tail, or has both pairs
    beside it, legs go down from it, however the file stands.
    """
    standing, spine = Vector(*tree.rig.rules.up), arms.starts - legs.starts
    on, down, out = spine.unit, _way(legs), _way(arms)
    if _sits_upright(tree, legs, arms, on):
        seat = axis_of(on)
        return [(seat, 1.0 if seat.dot(standing) > _STANDS else _OTHER_UP)]
    limbs = arms.starts - arms.ends + legs.starts - legs.ends
    loose = down.dot(-standing) < _ASIDE
    four = loose and down.dot(out) > _STANDS and max(abs(down.dot(on)), abs(out.dot(on))) < _ASIDE
    seat = axis_of(on)
    # Who crouches with the arms ahead has such limbs, too: along no axis of the file, below a trunk that is.
    rise = (limbs if four else legs.starts - legs.ends).unit
    crouches = loose and on_axis(rise, _LEANS) is rise and on.dot(seat) > _LEANING
    crouches = crouches and (four or rise.dot(on) > _ASIDE)
    loose = loose and not crouches
    if loose and (four or (abs(down.dot(on)) < _LEANING and has_tail(tree, legs, arms, on))):
        return [(on_axis(rise, _LEANS), _OTHER_UP)]
    turned = [on_axis(rise := -down, _ALONG_AXIS)]
    if turned[0] is rise or not turned[0].dot(on) > 0:
        turned = [spine.unit, limbs.unit]
        if -down.dot(on) < _ALONG_AXIS:
            # Legs that go otherwise than the trunk are posed, and files stand along an axis.
            turned = [axis for k in turned if (axis := on_axis(k, _LEANING)) is not k] or turned
    others = [(up, _OTHER_UP) for up in turned if any(up)]
    if _kneels_on_hands(tree, legs, arms, standing):
        return [(standing, 1.0)]
    ahead = (on - standing * on.dot(standing)).unit
    trails = down.dot(ahead) < -_ASIDE and out.dot(ahead) < -_BEHIND
    if trails and on.dot(standing) < _LEVEL and on.dot(seat) > _LEANS and seat.dot(standing) == 0.0:
        # Neither feet nor hands are below a trunk that lies, so as the file has it the body falls.
        return [(seat, _OTHER_UP)]
    # Legs of a body that sits go as far ahead as down, by 45°, and its trunk up, or it leans over arms that
    # hang straight; of one that crawls the arms hang down, too, and the feet trail behind.
    rises = on.dot(seat) > (_LEANS if out.dot(-seat) > _ALONG_AXIS else _ALONG_AXIS)
    sits = rises and down.dot(-seat) > _ASIDE
    if sits := sits and (out.dot(-standing) < _ASIDE or _feet_stand(tree, legs, seat)):
        others = [(seat, _OTHER_UP)]
    if abs(between(tree, legs.pair)[1].dot(standing)) > _STANDS:
        return others
    if not sits and (down.dot(-standing) > _STANDS or on.dot(standing) > _STANDS):
        others = []
    return [(standing, 1.0), *others]


def _way(limbs: Limbs) -> Vector:
    """Where both limbs of a pair go together, unit; nowhere where they go apart: what is left is noise."""
    way = limbs.ends - limbs.starts
    return way.unit if way.length > _APART * limbs.size else Vector()


def _sits_upright(tree: Tree, legs: Limbs, arms: Limbs, on: Vector) -> bool:
    """Whether a trunk goes along an axis of the file and straight legs go square to it, as arms do not.

    So sits who stretches their legs ahead. What stands with a trunk that lies has a tail, bent legs, or front
    legs. Who bows has the same shape, with a trunk that goes down in the file, or is level: then only arms
    that hang along it say that the body sits, in a file with another up.
    """
    down, out = _way(legs), _way(arms)
    rise, hangs = on.dot(Vector(*tree.rig.rules.up)), out.dot(on) < -_ASIDE
    if rise < -_STANDS or (rise < _STANDS and not hangs):
        return False
    if axis_of(on).dot(on) < _ALONG_AXIS or abs(down.dot(on)) > _LEVEL or out.dot(down) > _ASIDE:
        return False
    if len(legs.at) < 3 or arms.size < _SMALL * legs.size or has_tail(tree, legs, arms, on):
        return False
    knees = [[tree.at[joint] for joint in legs.joints(which)] for which in (0, 1)]
    return all((b - a).unit.dot((c - b).unit) > _STRETCHED for a, b, c in knees)


def _feet_stand(tree: Tree, legs: Limbs, seat: Vector) -> bool:
    """Whether feet are square to shins that go down, and go where the thighs go."""
    found = []
    for which in (0, 1):
        places = [tree.at[joint] for joint in legs.joints(which)]
        tip = tree.at[tree.paths[legs.joints(which)[-1]][-1]]
        thigh = (places[1] - places[0]) - seat * (places[1] - places[0]).dot(seat)
        foot, shin = tip - places[-1], places[-1] - places[1]
        found.append(shin.unit.dot(-seat) > _STANDS and foot.unit.dot(thigh.unit) > _STANDS)
    return len(legs.at) == 3 and all(found)


def _kneels_on_hands(tree: Tree, legs: Limbs, arms: Limbs, up: Vector) -> bool:
    """Whether hands, knees and toes stand on one ground, below hips and shoulders; no arms go back there.

    So crawls who tucks the toes, with limbs as those of a driver, whose toes are ahead of the knees.
    """
    if len(legs.at) < 3 or len(arms.at) < 3 or _way(arms).dot((arms.starts - legs.starts).unit) < -_ASIDE:
        return False
    joints = [(*arms.joints(which), *legs.joints(which)) for which in (0, 1)]
    parts = [part for k in joints for part in (tree.branch(k[2]), [k[4]], tree.branch(k[5]))]
    lows = [min(tree.at[node].dot(up) for node in part) for part in parts]
    above = min(legs.starts.dot(up), arms.starts.dot(up)) - min(lows)
    return max(lows) - min(lows) < _GROUND * legs.size < above


def has_tail(tree: Tree, legs: Limbs, arms: Limbs, on: Vector) -> bool:
    """Whether what hangs in the middle where legs do, and is no limb, goes the other way than the trunk."""
    limbs = {path[0] for pair in (legs, arms) for path in pair.pair.paths}
    free = [k for k in tree.below[legs.pair.above] if not any(tree.is_below(first, k) for first in limbs)]
    across, down = between(tree, legs.pair)[1], _way(legs)
    ways = [tree.at[node] - legs.starts for k in free for node in tree.branch(k)]
    ways = [way for way in ways if abs(way.dot(across)) < _MIDMOST * way.length]
    # What goes off square to the trunk, as legs that are stretched ahead do, is no more behind than ahead.
    behind = (-way.dot(on) for way in ways if -way.dot(on) > abs(way.dot(down)))
    return max(behind, default=0.0) > _TAIL * legs.size


def are_disjoint(tree: Tree, legs: Limbs, arms: Limbs) -> bool:
    """Whether neither pair is a part of the other."""
    if legs.pair.nodes & arms.pair.nodes:
        return False
    firsts = [(path[0], limbs) for limbs in (legs, arms) for path in limbs.pair.paths]
    return not any(tree.is_below(a, b) for a, one in firsts for b, other in firsts if one is not other)


def _both(tree: Tree, legs: Limbs, arms: Limbs, others: Sequence[Limbs], longest: float) -> Body:
    """A pair as legs and another as arms, up as suits them best: what supports it, as a weighted mean."""
    spine = arms.starts - legs.starts
    on, down, out = spine.unit, _way(legs), _way(arms)
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
        (1.0, 0.0 if _passed_over(tree, arms, others, common) else 1.0),
    ]
    cost = _DEEPER if tier < 0 else 0.0
    cost += _MISNAMED * (legs.place == "front" or arms.place == "hind")
    front_legs = _are_front_and_hind(arms, legs) or (arms.kind == "leg" and arms.place == "front")
    beyond = _beyond(tree, legs, arms)
    seen: list[Body] = []
    for up, trust in _ups(tree, legs, arms):
        tall, stands, hangs = on.dot(up), down.dot(-up), out.dot(-up)
        if front_legs and trust < 1.0 and abs(tall) > _LEANING and seen:
            continue  # from hind to front legs it goes ahead
        above = abs(lowest(tree, legs, up) - lowest(tree, arms, up)) / height(tree, legs, up)
        lies = abs(tall) < 0.6 and hangs > 0.75 and stands > 0.75
        four = front_legs or (lies and above < LEVEL)
        turned = [
            (1.0, trust * within(stands, 0.0, 0.7)),
            (0.8, trust * (0.9 if four else within(tall, 0.3, 0.8))),
            (0.8, _head(beyond, arms, on + up)),
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
    return min(tree.at[k].dot(up) for path in limbs.pair.paths for k in path)


def _low(tree: Tree, limbs: Limbs, up: Vector) -> float:
    """How high the lowest joint of two limbs and all below them stands."""
    return min(tree.at[k].dot(up) for path in limbs.pair.paths for k in tree.branch(path[0]))


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
    """Whether a pair is at the spine, below the arms, that would be arms as well: they are hair, or ears."""
    high = arms.pair.above
    between = set(tree.way(common, high)[1:-1]) if high >= 0 else set()
    return any(
        k.pair.above in between and len(k.at) == 3 and k.quality > 0.45 and k.size > 0.3 * arms.size
        for k in others
    )


def _legs_alone(tree: Tree, legs: Limbs, longest: float) -> Body:
    """A pair as legs, and no arms: a bird, or the lower part of a body."""
    down = legs.ends - legs.starts
    ups = [(Vector(*tree.rig.rules.up), 1.0), ((-down).unit, _OTHER_UP)]
    if any(axis := up_of_trunk(tree, legs)):
        ups = [(axis, _OTHER_UP)]
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
