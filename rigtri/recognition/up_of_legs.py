"""The up direction of a body: the file's, or where it does not stand on that, what legs and trunk show."""

from __future__ import annotations

from math import copysign

from rigtri.maths.scalar_vector import Vector
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_pairs import Limbs
from rigtri.recognition.symmetry import between

# Another file's up than the one it says counts so much less.
OTHER_UP = 0.8
# A trunk, or an animal's legs up to wrist and hock, lean from an axis of the file by up to this (a cosine,
# 30°); another up turns by right angles.
_LEANS = 0.866
# Legs alone that go down by this, as the file has it, stand on it. They go down from a trunk by more than
# the second.
_STAND_ALONE, _DOWN = 0.8, 0.5
# What stands aside of the middle by less than this part, of legs or of its way, is of the trunk, or a tail.
_MIDMOST = 0.1
# What goes down between legs, or back, by more than this part of them is a tail, and its trunk may lie.
_TAIL = 0.2
# The tail of a reptile that sprawls is longer than this part of its legs, and no coat is.
REPTILE = 1.0
# Limbs of what sprawls go down by this (a cosine) where all four end on one ground, or nearly, beside a tail.
SPRAWLS = 0.5
# Legs that go down by this (a cosine), as the file has it, or a trunk that goes up leave no doubt what is up.
_STANDS = 0.7
# Legs go aside from a trunk that lies, or leans as dinosaurs do (cosines).
_ASIDE, _LEANING = 0.5, 0.8
# Limbs that both go less than this part of their size the same way go apart.
_APART = 0.02
# Legs that go down an axis of the file by this (a cosine, 15°) stand on it, however the trunk leans; and so
# upright is the trunk of a body that sits.
ALONG_AXIS = 0.966
# Legs that are stretched ahead are square to the trunk up to this (a sine), and bend by less than 25°.
# Arms smaller than this part of legs are those of a dinosaur.
_LEVEL, _STRETCHED, _SMALL = 0.35, 0.906, 0.3
# Hands so far behind shoulders (a sine, 24°) hold no trunk that lies.
_BEHIND = 0.4
# Hands, knees and toes that stand on one ground differ by less than this part of a leg: flesh and heels do.
_GROUND = 0.08


def axis_of(way: Vector) -> Vector:
    """The axis of the file that is nearest to a direction, with its sign."""
    most = max(way, key=abs)
    return Vector(*(copysign(1.0, each) if each == most else 0.0 for each in way))


def on_axis(way: Vector, along: float) -> Vector:
    """The axis of the file that a direction goes along, by a cosine, itself where it goes along none."""
    axis = axis_of(way)
    return axis if axis.dot(way) > along else way


def up_of_trunk(tree: Tree, legs: Limbs) -> Vector:
    """The axis of the file along which a trunk rises from legs that stand on no ground of it; or nothing.

    So sits and crouches who has one arm, or none that is known, in a file with another up.
    """
    standing, down = Vector(*tree.rig.rules.up), (legs.ends - legs.starts).unit
    firsts = [path[0] for path in legs.pair.paths]
    own = {node for first in firsts for node in (*tree.way(-1, first), *tree.branch(first))}
    ways = [tree.at[node] - legs.starts for node in tree.nodes if node not in own]
    across = between(tree, legs.pair)[1]
    midmost = [way for way in ways if abs(way.dot(across)) < _MIDMOST * legs.size]
    trunk = sum(midmost, Vector())
    up = axis_of(trunk)
    rises = trunk.unit.dot(up) > _LEANS and -down.dot(up) > _DOWN
    tail = any(-way.dot(up) > _TAIL * legs.size for way in midmost)
    return up if rises and not tail and -down.dot(standing) < _STAND_ALONE else Vector()


def ups_of_pairs(tree: Tree, legs: Limbs, arms: Limbs) -> list[tuple[Vector, float]]:
    """Directions that may be up for a pair as legs and another as arms, unit, with how far each is trusted.

    The file's, and others where neither legs nor trunk stand on that: the axis that legs go down, else what
    trunk or limbs show; not what goes from left to right. Where a trunk goes on in a tail, or has both pairs
    beside it, legs go down from it, however the file stands.
    """
    standing, spine = Vector(*tree.rig.rules.up), arms.starts - legs.starts
    on, down, out = spine.unit, way_of(legs), way_of(arms)
    seat = axis_of(on)
    if _sits_upright(tree, legs, arms, on):
        return [(seat, 1.0 if seat.dot(standing) > _STANDS else OTHER_UP)]
    limbs = arms.starts - arms.ends + legs.starts - legs.ends
    loose = down.dot(-standing) < _ASIDE
    four = loose and down.dot(out) > _STANDS and max(abs(down.dot(on)), abs(out.dot(on))) < _ASIDE
    # Who crouches with the arms ahead has such limbs, too: along no axis of the file, below a trunk that is.
    rise = (limbs if four else legs.starts - legs.ends).unit
    crouches = loose and on_axis(rise, _LEANS) is rise and on.dot(seat) > _LEANING
    crouches = crouches and (four or rise.dot(on) > _ASIDE)
    tail = loose and abs(down.dot(on)) < _LEANING and has_tail(tree, legs, arms, on)
    if crouches and tail and has_tail(tree, legs, arms, on, REPTILE):  # its feet are behind its hips
        rise, crouches = (limbs - on * limbs.dot(on)).unit, False
    loose = loose and not crouches
    if loose and (four or tail):
        return [(on_axis(rise, _LEANS), OTHER_UP)]
    turned = [on_axis(rise := -down, ALONG_AXIS)]
    if turned[0] is rise or not turned[0].dot(on) > 0:
        turned = [spine.unit, limbs.unit]
        if -down.dot(on) < ALONG_AXIS:
            # Legs that go otherwise than the trunk are posed, and files stand along an axis.
            turned = [axis for k in turned if (axis := on_axis(k, _LEANING)) is not k] or turned
    others = [(up, OTHER_UP) for up in turned if any(up)]
    if _kneels_on_hands(tree, legs, arms, standing):
        return [(standing, 1.0)]
    ahead = (on - standing * on.dot(standing)).unit
    trails = down.dot(ahead) < -_ASIDE and out.dot(ahead) < -_BEHIND
    trails = trails and on.dot(standing) < _LEVEL and on.dot(seat) > _LEANS and seat.dot(standing) == 0.0
    if trails and all(_end_below(tree, limbs, standing) for limbs in (legs, arms)):
        return [(standing, 1.0)]  # paws of an animal that braces itself: wrists and hocks are behind them
    if trails:
        # Neither feet nor hands are below a trunk that lies, so as the file has it the body falls.
        return [(seat, OTHER_UP)]
    # Legs of a body that sits go as far ahead as down, by 45°, and its trunk up, or it leans over arms that
    # hang straight; of one that crawls the arms hang down, too, and the feet trail behind.
    rises = on.dot(seat) > (_LEANS if out.dot(-seat) > ALONG_AXIS else ALONG_AXIS)
    sits = rises and down.dot(-seat) > _ASIDE
    if sits := sits and (out.dot(-standing) < _ASIDE or _feet_stand(tree, legs, seat)):
        others = [(seat, OTHER_UP)]
    if abs(between(tree, legs.pair)[1].dot(standing)) > _STANDS:
        return others
    if not sits and (down.dot(-standing) > _STANDS or on.dot(standing) > _STANDS):
        others = []
    sprawls = min(down.dot(-standing), out.dot(-standing)) > SPRAWLS and go_aside(tree, legs, arms)
    if sprawls and on.dot(standing) < _LEANING and has_tail(tree, legs, arms, on, REPTILE):
        others = []  # all limbs of an animal go down, as the file has it
    return [(standing, 1.0), *others]


def go_aside(tree: Tree, *pairs: Limbs) -> bool:
    """Whether the upper bones of all limbs go aside, as those of what sprawls."""
    for limbs in pairs:
        one, other = (limbs.joints(which) for which in (0, 1))
        across = between(tree, limbs.pair)[1]
        ways = ((tree.at[a[1]] - tree.at[a[0]]).unit for a in (one, other))
        if min(abs(way.dot(across)) for way in ways) < _ASIDE:
            return False
    return True


def way_of(limbs: Limbs) -> Vector:
    """Where both limbs of a pair go together, unit; nowhere where they go apart: what is left is noise."""
    way = limbs.ends - limbs.starts
    return way.unit if way.length > _APART * limbs.size else Vector()


def _sits_upright(tree: Tree, legs: Limbs, arms: Limbs, on: Vector) -> bool:
    """Whether a trunk goes along an axis of the file and straight legs go square to it, as arms do not.

    So sits who stretches their legs ahead. What stands with a trunk that lies has a tail, bent legs, or front
    legs. Who bows has the same shape, with a trunk that goes down in the file, or is level: then only arms
    that hang along it say that the body sits, in a file with another up.
    """
    down, out = way_of(legs), way_of(arms)
    rise, hangs = on.dot(Vector(*tree.rig.rules.up)), out.dot(on) < -_ASIDE
    if rise < -_STANDS or (rise < _STANDS and not hangs):
        return False
    if axis_of(on).dot(on) < ALONG_AXIS or abs(down.dot(on)) > _LEVEL or out.dot(down) > _ASIDE:
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


def _end_below(tree: Tree, limbs: Limbs, up: Vector) -> bool:
    """Whether what is at the end of a pair stands below where its chains begin, whatever bends between."""
    way = Vector()
    for which, path in enumerate(limbs.pair.paths):
        lowest = min(tree.branch(limbs.joints(which)[-1]), key=lambda node: tree.at[node].dot(up))
        way += tree.at[lowest] - tree.at[path[0]]
    return way.unit.dot(-up) > _STAND_ALONE


def _kneels_on_hands(tree: Tree, legs: Limbs, arms: Limbs, up: Vector) -> bool:
    """Whether hands, knees and toes stand on one ground, below hips and shoulders; no arms go back there.

    So crawls who tucks the toes, with limbs as those of a driver, whose toes are ahead of the knees.
    """
    if len(legs.at) < 3 or len(arms.at) < 3 or way_of(arms).dot((arms.starts - legs.starts).unit) < -_ASIDE:
        return False
    joints = [(*arms.joints(which), *legs.joints(which)) for which in (0, 1)]
    parts = [part for k in joints for part in (tree.branch(k[2]), [k[4]], tree.branch(k[5]))]
    lows = [min(tree.heights(part, up)) for part in parts]
    above = min(legs.starts.dot(up), arms.starts.dot(up)) - min(lows)
    return max(lows) - min(lows) < _GROUND * legs.size < above


def has_tail(tree: Tree, legs: Limbs, arms: Limbs, on: Vector, part: float = _TAIL) -> bool:
    """Whether what hangs in the middle where legs do, and is no limb, goes the other way than the trunk.

    part: of legs, that it reaches beyond.
    """
    limbs = {path[0] for pair in (legs, arms) for path in pair.pair.paths}
    free = [k for k in tree.below[legs.pair.above] if not any(tree.is_below(first, k) for first in limbs)]
    across, down = between(tree, legs.pair)[1], way_of(legs)
    ways = [tree.at[node] - legs.starts for k in free for node in tree.branch(k)]
    ways = [way for way in ways if abs(way.dot(across)) < _MIDMOST * way.length]
    # What goes off square to the trunk, as legs that are stretched ahead do, is no more behind than ahead.
    behind = (-way.dot(on) for way in ways if -way.dot(on) > abs(way.dot(down)))
    return max(behind, default=0.0) > part * legs.size
