"""The facing direction of a character: weighed from feet, thumbs, knees, elbows, head and motion."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from math import acos, fsum

import numpy as np

from rigtri.maths.angle_limits import radians_below
from rigtri.maths.arrays import Booleans
from rigtri.maths.quaternions import between, rotate
from rigtri.maths.scalar_vector import Vector
from rigtri.maths.triangle import bend_angle
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length, normalise
from rigtri.recognition.body_shape import Body
from rigtri.recognition.hocks import from_the_hips
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_ends import moves_a_bone, thumb_of
from rigtri.recognition.limb_pairs import Limbs
from rigtri.recognition.limb_triples import IN_LINE, SET_OFF, offset
from rigtri.recognition.many_legs import ends_of_trunk
from rigtri.recognition.naming_schemes import roles_in_name
from rigtri.recognition.pose_samples import Poses, finite, how_far
from rigtri.recognition.symmetry import Plane

# Votes of less weight than this together are not sure, however they agree.
_ENOUGH = 1.0
# What the format says is a custom: it decides where nothing else does, and makes nothing sure.
_CUSTOM = 0.4
# Who travels by less than this part of the body goes nowhere.
_STEP = 0.25
# Bends from 10° on are no noise; smaller ones count less, and where twins have them alike, up to this part.
_CLEAR, _ALIKE = radians_below(10), 0.25
# Alone they tell facing where they bend so far, and one bone is so long a part of the other: what axles of
# robots are set off by, up to 15 % of a bone, bends a limb less, and no axle is half as long as a bone.
_BENT, _BALANCED = radians_below(30), 0.5
# What names and the format say to this part (a cosine) the other way denies a small bend.
_DENIED = 0.5
# Robots' joints are offset alike on both sides: a small bend counts if anything else says so by this weight.
_BACKED = 0.25
# So far beside its line, a part of the whole limb, is a middle that is bent by 10°, or by 5°.
_FULL, _SLIGHT = 0.04, 0.02
# What a foot moves reaches this part of the leg further ahead than back to count in full, or a third at all.
_SOLE = 0.1
# Feet that make something sure point ahead by so much, in votes: an axle behind an ankle is shorter.
_FEET, _TOES = "the feet point there", 1.4
_KNEES, _THIGHS = "the knees bend there", "the thighs go there, as of one who sits"
# What legs tell, and the trunk from there on.
_LEANING = "the trunk leans there"
BY_LEGS = (_FEET, _KNEES, _THIGHS, _LEANING)
# A foot so long, as a part of the leg, counts in full; where so many toes or more agree, half as long a one.
_FOOT, _TOED, _PAW = 0.2, 0.1, 3
# What denies no names of sides: arms turn about themselves at the shoulder, and take their thumbs with them.
THUMBS, _SAID = "the thumbs are there", "the format says so"
UNSURE = frozenset((THUMBS, _SAID))
_REACH = "the arms are stretched there"
# A thumb stands aside by this much (a sine) to count; hands that are raised beyond this may turn either way.
_ASIDE, _RAISED = 0.3, 0.5
# The thumb of three fingers goes so far another way (40°), and so many times as far as the others do.
_OPPOSED, _ODD = radians_below(40), 2.0
# Where hind and front legs bend the same way by so much (the product of their votes), elbows tell which: no
# front leg bends ahead there; hind legs bend back at their hocks, and those of robots at their knees.
_ONE_WAY = 0.25
# A trunk that leans so far from its up (a sine) leans ahead, and from the second on it lies.
_LEANS, _LIES = 0.35, 0.7
# So far ahead feet point (a cosine).
_AHEAD = 0.5
# Thighs that go so far ahead (a sine, 45°) are those of someone who sits: hips do not bend back so far.
_SITS = 0.7
# Arms of which each bone goes ahead by this (a cosine, 45°) are stretched.
_STRETCHED = 0.7
# The trunk of a body with one leg in line with it, up to 45° (a cosine), is upright, or not, up to the same.
_IN_LINE = 0.7
# A face stands so far ahead of the trunk or skull, as a part of a limb, to count in full.
_FACE = 0.15
_ENDS = ("face", "skull", "tail")


def facing_of(
    tree: Tree,
    body: Body,
    plane: Plane,
    poses: Poses,
    *,
    bends: bool = True,
    named: Vector | None = None,
    legs: Sequence[Limbs] = (),
) -> tuple[Vector, float, tuple[str, ...]]:
    """Where a body looks, unit, how sure that is, 0 to 1, and why, in words.

    bends: ask knees and elbows, too: it is known which joints these are. named: where it looks, unit, by
    the names of its sides. Bends below 10° are sure of nothing that these and the format deny. legs: of a
    body with more than two pairs of them.
    """
    ahead = plane.normal.cross(body.up)
    ahead = (ahead - body.up * ahead.dot(body.up)).unit
    body = body if legs else from_the_hips(tree, body, ahead)
    votes = _votes(tree, body, ahead, poses) if not legs else ends_of_trunk(tree, legs, plane, ahead)
    evidence = [*_moving(tree, body, ahead, poses), *votes]
    slight = [(weight, words) for weight, words in evidence if words == _FEET and abs(weight) <= _TOES]
    clear = [each for each in evidence if each not in slight]
    custom = Vector(*(tree.rig.rules.facing or ())).dot(ahead)
    stated = custom + (named.dot(ahead) if named is not None else 0.0)
    bent = list(_bends(tree, body, plane, ahead, poses)) if bends and not legs else []
    seen_so_far = [weight for weight, _ in clear]
    for k, (weight, small, noise, words, _) in enumerate(bent):
        others = [stated - custom, *seen_so_far, *(each[0] + each[1] for each in (*bent[:k], *bent[k + 1 :]))]
        backed = any(small * other > _BACKED * abs(small) for other in others)
        trusted = backed and small * stated >= -_DENIED * abs(small)
        clear.append((weight + small if trusted else weight, words))
        slight.append((noise if trusted else noise + small, words))
    slight.append((_CUSTOM * custom, _SAID))
    seen, most = fsum(weight for weight, _ in clear), fsum(abs(weight) for weight, _ in clear)
    total = seen + fsum(weight for weight, _ in slight)
    backed = fsum(abs(weight) for weight in seen_so_far if weight * total > 0) > _BACKED
    alone = any(far and weight * total > 0 for weight, _, _, _, far in bent)
    sure = abs(seen) / max(most, _ENOUGH) if seen * total > 0 and (backed or alone) else 0.0
    why = tuple(dict.fromkeys(words for weight, words in (*clear, *slight) if weight * total > 0))
    return (ahead if total >= 0 else -ahead), sure, why


def up_of_stretched(
    tree: Tree, legs: Sequence[Sequence[int]], arms: Sequence[Sequence[int]], across: Vector
) -> Vector | None:
    """The up direction, unit, of a body with one leg that lies or stands on its hands; None for any other.

    legs, arms: joints from start to end. across: from right to left, unit. The leg is in line with the trunk.
    """
    if len(legs) != 1 or len(arms) != 2:
        return None
    ((hip, *_, ankle),) = legs
    shoulders = (tree.at[arms[0][0]] + tree.at[arms[1][0]]) * 0.5
    ways = (shoulders - tree.at[hip], tree.at[hip] - tree.at[ankle])
    trunk, leg = ((way - across * way.dot(across)).unit for way in ways)
    stands = trunk.dot(Vector(*tree.rig.rules.up)) > _IN_LINE
    return None if stands or trunk.dot(leg) < _IN_LINE else trunk


def _moving(tree: Tree, body: Body, ahead: Vector, poses: Poses) -> Iterator[tuple[float, str]]:
    """What says that a body looks ahead: weights, negative for the other way, with words."""
    yield 3.0 * _named(tree, body, ahead), "what its names call the head is there"
    way = poses.travel(tree.nodes)
    yield 1.5 * way.dot(ahead) / max(way.length, _STEP * tree.span, 1e-30), "it goes there"


def _votes(tree: Tree, body: Body, ahead: Vector, poses: Poses) -> Iterator[tuple[float, str]]:
    """As `_moving`, of how the limbs of a body of two or four legs stand."""
    if body.legs and body.arms:
        along = (body.arms.starts - body.legs.starts).unit.dot(ahead)
        if body.form == "quadruped" and body.lead > 0.02:
            yield 3.0 * along, "the front legs are ahead of the hind legs"
        elif body.form == "biped" and abs(along) > _LEANS:
            yield 3.0 * along, _LEANING
    if body.legs:
        yield 2.0 * feet_ahead(tree, body, ahead, poses), _FEET
        yield 2.0 * _thighs(tree, body, ahead), _THIGHS
    if body.arms and body.form == "biped":
        yield _thumbs(tree, body.arms, body.up, ahead), THUMBS
        yield 2.0 * _reach(tree, body.arms, ahead), _REACH


def _named(tree: Tree, body: Body, ahead: Vector) -> float:
    """How far what is called head, eye or snout is ahead of what is called tail or of the trunk: −1 to 1."""
    at = {
        role: [tree.at[k] for k in tree.nodes if role in roles_in_name(tree.rig.names[k])] for role in _ENDS
    }
    size = max((k.size for k in (body.legs, body.arms) if k is not None), default=tree.span)
    starts = [k.starts for k in (body.legs, body.arms) if k is not None]
    front, back = _middle(at["face"]), _middle(at["tail"]) or _middle(at["skull"]) or _middle(starts)
    front = front or (_middle(at["skull"]) if at["tail"] or body.form == "quadruped" else None)
    if front is None or back is None:
        return 0.0
    along = (front - back).dot(ahead)
    return max(-1.0, min(1.0, along / (_FACE * size))) if abs(along) > 0.2 * _FACE * size else 0.0


def _middle(places: Sequence[Vector]) -> Vector | None:
    total = Vector()
    for place in places:
        total = total + place
    return total * (1.0 / len(places)) if places else None


def _bends(
    tree: Tree, body: Body, plane: Plane, ahead: Vector, poses: Poses
) -> Iterator[tuple[float, float, float, str, bool]]:
    """As `_votes`, of knees and elbows: of clear bends, of small ones of twins, and of what may be noise.

    And whether they bend so far that they tell something alone.
    """
    moments = np.concatenate([tree.places[np.newaxis], poses.rest[np.newaxis], poses.moving], axis=0)
    bent = list(_bent(body, plane.normal, ahead, moments))
    if body.form == "quadruped" and len(bent) == 2 and bent[0][1] * bent[1][1] > _ONE_WAY:
        bent = [each for each in bent if each[0] is body.arms]
    for limbs, clear, small, all_, far in bent:
        feet = long_feet(tree, limbs, body.up, ahead) if limbs is body.legs and body.form == "biped" else 0.0
        if feet:
            yield feet, 0.0, 0.0, _FEET, True
            continue
        weight = -0.5 if limbs is body.arms else 0.3 if _goes_on(tree, limbs) else 1.0
        words = "the elbows bend away from there" if limbs is body.arms else _KNEES
        yield weight * clear, weight * small, weight * (all_ - clear - small), words, far


def long_feet(tree: Tree, legs: Limbs, up: Vector, ahead: Vector) -> float:
    """How far long feet point ahead, −1 to 1, where what is taken for knees may be ankles; 0 where not.

    Then legs stand upright and straight down to these, with a joint between, and all below is one line.
    """
    if len(legs.at) < 3 or legs.at[1] < 2:
        return 0.0
    total, (_, middle, end) = 0.0, legs.at
    for path in legs.pair.paths:
        hip, knee, ankle, toe = (tree.at[path[k]] for k in (0, middle - 1, middle, end))
        leg, foot = (ankle - hip).unit, (toe - ankle).unit
        tip = tree.at[tree.paths[path[end]][-1]]
        if any(tip - toe) and (tip - toe).unit.dot(foot) < IN_LINE:
            return 0.0
        upright = leg.dot(up) < -IN_LINE and (knee - hip).unit.dot((ankle - knee).unit) > IN_LINE
        if not upright or leg.dot(foot) > SET_OFF:
            return 0.0
        total += 0.5 * foot.dot(ahead)
    return total if abs(total) > _AHEAD else 0.0


def _goes_on(tree: Tree, legs: Limbs) -> bool:
    """Whether what follows the ankle is long: which joint of an animal's leg is the knee is not plain."""
    return tree.reach[legs.joints(0)[-1]] > 0.6 * 0.5 * legs.size


def feet_ahead(tree: Tree, body: Body, ahead: Vector, poses: Poses) -> float:
    """How far feet point ahead, by their toes or else by what they move: −1 to 1."""
    assert body.legs is not None
    toes = _toes(tree, body.legs, ahead)
    # What goes on far is no foot but a shin, with the calf behind it.
    if 2.0 * abs(toes) > _TOES or body.form != "biped" or _goes_on(tree, body.legs):
        return toes
    soles = _soles(tree, body.legs, ahead, poses)
    return soles if abs(soles) > abs(toes) else toes


def _thighs(tree: Tree, body: Body, ahead: Vector) -> float:
    """How far both thighs of two legs go ahead, −1 to 1; 0 of one who stands, or of whom it is not plain."""
    assert body.legs is not None
    if body.form != "biped" or body.arms is None:
        return 0.0
    thighs = (body.legs.joints(k)[:2] for k in (0, 1))
    return _all_ahead(tree, thighs, ahead, _SITS)


def _soles(tree: Tree, legs: Limbs, ahead: Vector, poses: Poses) -> float:
    """How much further ahead of ankles than behind them the points reach that feet move: −1 to 1.

    Square to the shin: a leg that ends in a stump, along it, has no foot that points anywhere.
    """
    total = 0.0
    for path in legs.pair.paths:
        ankle = path[legs.at[-1]]
        ends = poses.box_of(tree.branch(ankle), tree.places)
        shin = (tree.at[ankle] - tree.at[path[legs.at[-2]]]).unit
        across = ahead - shin * shin.dot(ahead)
        reached = how_far(ends, tree.at[ankle], across)
        if not reached or moves_a_bone(tree, poses, [path[k] for k in legs.at[-2:]], legs.size):
            return 0.0
        further = (max(reached) + min(reached)) / max(_SOLE * legs.size, 1e-30)
        total += 0.5 * max(-1.0, min(1.0, further)) if abs(further) > 1.0 / 3.0 else 0.0
    return total


def _reach(tree: Tree, arms: Limbs, ahead: Vector) -> float:
    """How far both arms are stretched ahead, −1 to 1; 0 of other arms: none can be stretched back so far."""
    return _all_ahead(tree, (arms.joints(k) for k in (0, 1)), ahead, _STRETCHED)


def _all_ahead(tree: Tree, chains: Iterable[Sequence[int]], ahead: Vector, far: float) -> float:
    """How far all bones of some chains go ahead, −1 to 1, as that which goes least; 0 unless each by more."""
    ways = [(tree.at[b] - tree.at[a]).unit.dot(ahead) for chain in chains for a, b in pairwise(chain)]
    least, most = min(ways), max(ways)
    return least if least > far else most if most < -far else 0.0


def _thumbs(tree: Tree, arms: Limbs, up: Vector, ahead: Vector) -> float:
    """How far thumbs stand ahead of the fingers: they do unless palms are turned out; −1 to 1.

    As if elbows were straight: bent by more than a right angle they turn thumbs to the back.
    """
    total = 0.0
    for path in arms.pair.paths:
        wrist = path[arms.at[-1]]
        fingers = [tree.paths[k] for k in tree.below[wrist] if len(tree.paths[k]) > 1]
        which = thumb_of(tree, wrist, fingers) if len(fingers) > 2 else -1
        along = _middle([tree.at[k[0]] - tree.at[wrist] for j, k in enumerate(fingers) if j != which])
        if which < 0 or along is None or along.unit.dot(up) > _RAISED:
            return 0.0
        if not _stands_out(tree, fingers, which):
            return 0.0
        aside = tree.at[fingers[which][1]] - tree.at[wrist]
        aside = (aside - along.unit * aside.dot(along.unit)).unit
        total += 0.5 * _with_straight_elbow(tree, [path[k] for k in arms.at], aside).dot(ahead)
    return total if abs(total) > _ASIDE else 0.0


def _with_straight_elbow(tree: Tree, arm: Sequence[int], way: Vector) -> Vector:
    """A direction of a hand, turned to where it is once the elbow is straight."""
    if len(arm) < 3:
        return way
    shoulder, elbow, wrist = (tree.at[joint] for joint in arm)
    turn = between(np.array([*(wrist - elbow).unit]), np.array([*(elbow - shoulder).unit]))
    return Vector(*finite(rotate(turn, np.array([*way]))).tolist())


def _stands_out(tree: Tree, fingers: Sequence[Sequence[int]], which: int) -> bool:
    """Whether a thumb is none of three fingers alike, of which noise and short bones make one another."""
    ways = [(tree.at[k[1]] - tree.at[k[0]]).unit for k in fingers]
    alike = [max(one.dot(k) for k in ways if k is not one) for one in ways]
    far, others = (acos(max(-1.0, min(1.0, k))) for k in (alike.pop(which), min(alike)))
    return len(fingers) > 3 or far > max(_OPPOSED, _ODD * others)


def _toes(tree: Tree, legs: Limbs, ahead: Vector) -> float:
    """How far what follows the ankle points ahead, −1 to 1: most toes, where a foot has as many as a paw."""
    total = 0.0
    for path in legs.pair.paths:
        ankle = path[legs.at[-1]]
        toes = next((tree.below[k] for k in tree.paths[ankle] if len(tree.below[k]) > 1), [])
        toed = len(toes) >= _PAW
        tips = [tree.paths[k][-1] for k in toes] if toed else [tree.paths[ankle][-1]]
        # The toe behind a bird's foot may be the longest, and is one of four.
        along = sorted((tree.at[tip] - tree.at[ankle]).dot(ahead) for tip in tips)[len(tips) // 2]
        total += 0.5 * max(-1.0, min(1.0, along / max((_TOED if toed else _FOOT) * legs.size, 1e-30)))
    return total


def _bent(
    body: Body, lateral: Vector, level: Vector, places: Floats
) -> Iterator[tuple[Limbs, float, float, float, bool]]:
    """How far the middles of limbs stand ahead, at rest and in motion, places (f, n, 3): −1 to 1.

    Of legs and arms: where both bend clearly, where they bend less, but alike, and in all; and whether both
    bend far in any pose. In each pose
    ahead is what lies across the line between both limbs and the spine; of a trunk that lies, the spine
    itself, on the side of ``level``.
    """
    pairs = [k for k in (body.legs, body.arms) if k is not None and len(k.at) == 3]
    if not pairs:
        return
    points = places[:, [(k.joints(0), k.joints(1)) for k in pairs]]  # pose, pair, limb, joint, 3
    start, middle, end = (points[..., k, :] for k in range(3))
    across = start[:, :, 0] - start[:, :, 1]
    signs = [1.0 if Vector(*each).dot(lateral) >= 0 else -1.0 for each in across[0].tolist()]
    across = across * np.array(signs)[:, np.newaxis]
    spine = _spine(body, places)[:, np.newaxis]
    lies = (
        body.arms is not None
        and body.legs is not None
        and abs((body.arms.starts - body.legs.starts).unit.dot(level)) > _LIES
    )
    if lies:
        spine = cross(spine * np.sign(dot(spine[:1], np.array([*level]))), across)
    ahead = normalise(cross(across, spine))[:, :, np.newaxis]
    aside = offset(start, middle, end)
    along = finite(dot(aside, ahead))
    bend, bones = bend_angle(start, middle, end), (length(middle - start), length(end - middle))
    clear = np.asarray((bend > _CLEAR).all(axis=-1, keepdims=True))
    bend = np.where(np.minimum(*bones) > _BALANCED * np.maximum(*bones), bend, 0.0)
    far = (bend.max(axis=0) > _BENT).all(axis=-1).tolist()
    small = _are_alike(aside, across) & ~clear
    for k, limbs in enumerate(pairs):
        plain, alike = (_share((along * which)[:, k], _FULL * limbs.size) for which in (clear, small))
        yield limbs, plain, alike, _share(along[:, k], _SLIGHT * limbs.size), far[k]


def _share(along: Floats, full: float) -> float:
    """The mean of how far something stands ahead: 1 from ``full`` on."""
    share = np.minimum(np.maximum(along / max(full, 1e-30), -1.0), 1.0)
    return fsum(share.ravel().tolist()) / share.size


def _are_alike(aside: Floats, across: Floats) -> Booleans:
    """Whether the middles of both limbs stand ``aside``, (f, k, 2, 3), by more than noise, (f, k, 1).

    Noise is not its own mirror image.
    """
    lateral = normalise(across)
    one, other = aside[:, :, 0], aside[:, :, 1]
    apart = length(one - (other - 2.0 * dot(other, lateral)[..., np.newaxis] * lateral))
    alike = apart <= _ALIKE * np.maximum(length(one), length(other))
    return np.asarray(alike)[..., np.newaxis]


def _spine(body: Body, places: Floats) -> Floats:
    """From the legs to the arms in each pose, unit, (f, 3); without arms where is up, (1, 3)."""
    if body.arms is None:
        return np.array([[*body.up]])
    ends = body.legs or body.arms, body.arms
    low, high = (places[:, k.joints(0)[0]] + places[:, k.joints(1)[0]] for k in ends)
    return normalise(high - low)
