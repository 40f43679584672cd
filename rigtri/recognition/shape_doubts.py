"""Shapes that may be another limb, or none: wings, clavicles taken for upper bones, guns, things."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import fsum, inf

from rigtri.maths.scalar_vector import Vector
from rigtri.recognition.body_shape import Body, height, lowest
from rigtri.recognition.bone_noise import STRAIGHT
from rigtri.recognition.character_draft import Draft, once
from rigtri.recognition.facing import long_feet
from rigtri.recognition.found_limb import Found
from rigtri.recognition.front_or_hind import head_end
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_ends import HAND, branches, moves_a_bone
from rigtri.recognition.limb_pairs import Limbs
from rigtri.recognition.limb_triples import SAME_PLACE, begin_as_one, beside, within_upper
from rigtri.recognition.limb_words import NO_WORDS, Level
from rigtri.recognition.naming_schemes import roles_in_name
from rigtri.recognition.pose_samples import how_far

# A further chain at the chest that is so long a part of the arms may be an arm as well.
_RIVAL = 0.2
# A limb bends clearly by this (a cosine, 15°).
CLEAR = 0.966
# A bone after the wrist that is so long a part of the lower arm is rather the lower arm itself.
_NEXT = 0.6
# One that is so small a part of the whole limb is a hand with its tip; half of a lower arm is more.
_TIP = 0.36
# A first bone that is so long a part of the next one is a clavicle of none but very broad shoulders.
_BROAD = 0.8
# A shin that goes down by less than this (a cosine) is level.
_LEVEL = 0.3
# A trunk that rises by less than this (a cosine) lies.
_LYING = 0.6
# Five fingers of three joints each are a hand: birds have fewer toes, and others shorter ones.
_DIGITS, _PHALANGES = 5, 3
# A middle that leads by less over the next best, of bones that are less like those of a limb than this: so
# it is in straight chains of many joints, where crooked places (2 % of a bone) choose it.
_NARROW, _HARDLY = 0.16, 0.45
# Bones of a longer chain that are less like those of a limb than this.
_NO_LIMB = 0.25
# Front and hind legs end as low as each other up to this part of a leg.
ENDS_LOW = 0.2
# A bone that is so small a part of the next one is hardly any.
_HARDLY_ANY = 0.2
# Ankles and most hocks stand lower than this part of the height of the hips; and legs bend at them by more
# than this (a cosine, 35°).
_HIGH, _NO_HOCK = 0.4, 0.82
# First joints are so near to each other, of what the next ones are, that they may be in the middle.
_INNER = 0.3
# A bone goes on into the next one up to 25° (a cosine), and is a part of it if it is so long a part of that.
GOES_ON, _HALF = 0.906, 0.5
# What a foot moves goes less far beyond it than this part of the lower bone.
_SOLE = 0.5
# A joint of a leg with a hock stands so far beside the line of its neighbours, as a part of that.
ZIGZAG = 0.08
_THREE: tuple[Level, Level, Level] = ("upper", "lower", "end")
# Names that say so far which three joints bend: those of all three, one of them vague; and half of that.
CALLED, _HALF_CALLED = 0.8, 0.5


def of_twin(each: Found, found: Sequence[Found], doubts: Mapping[int, str]) -> str:
    """What speaks against the twin of a limb without names (by its id): one choice of joints made both."""
    mine = each.pair
    twins = (k for k in found if mine is not None and mine.named <= 0.0 and k.pair is mine)
    twins = (k for k in twins if len(k.joints) == len(each.joints))  # names tell of one that has an elbow
    return next(filter(None, (doubts[id(k)] for k in twins)), "")


def upside_down(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """Legs that begin above arms, as the file says what is up, are no legs; without knees none tell it."""
    legs, arms = ([k for k in found if k.kind == kind and k.side] for kind in ("leg", "arm"))
    if len(legs) != 2 or len(arms) != 2:
        return ""
    up, at = Vector(*draft.tree.rig.rules.up), draft.tree.at
    low, high = (at[one.joints[0]].dot(up) + at[other.joints[0]].dot(up) for one, other in (legs, arms))
    if low > high and draft.up.dot(up) < -0.5:
        return "its legs begin above its arms"
    if draft.up.dot(up) < 0.5 and min(len(leg.joints) for leg in legs) < 3:
        return "the file has another up, and legs without knees do not tell it"
    return ""


def at_the_top(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """What looks like arms without hands where the trunk ends: ears or hair, of a body that has no arms."""
    mine, tree, up = each.pair, draft.tree, draft.up
    if each.kind != "arm" or mine is None or mine.named > 0.0 or mine.fingers >= 2 or mine.pair.above < 0:
        return ""
    starts = [path[0] for path in mine.pair.paths]
    high = max(tree.at[start].dot(up) for start in starts)
    beside = [k for k in tree.below[mine.pair.above] if k not in starts]
    above = [k for one in beside for k in tree.branch(one) if tree.at[k].dot(up) > high]
    if any(tree.below[k] or draft.poses.moves_anything(k) for k in above):
        return ""  # a neck or a head, and not what says where one ends
    return "nothing is above them, and no head beside"


def arm_as_leg(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """What looks like legs in a body that has none: its arms, where hair passes for arms."""
    mine, body, tree = each.pair, draft.shape.body, draft.tree
    arms = body.arms if body is not None and body.form == "biped" else None
    if each.kind != "leg" or mine is None or arms is None or arms is mine or arms.fingers >= 2:
        return ""
    if mine.kind == "leg" and mine.named > CALLED:
        return ""
    at, _ = branches(tree, mine.pair.paths[0])
    hand = mine.pair.paths[0][at]
    tips = [k for k in tree.branch(hand) if not tree.below[k] and len(tree.way(hand, k)) > _PHALANGES]
    if len(tips) >= _DIGITS:
        return "it ends in a hand, and the arms do not"
    if any(rival(draft, k) or not k.is_sure for k in found if k.pair is arms):
        if mine.at[0] == 1:
            return "it may be an arm below its clavicle, for the arms are not sure"
        if mine.pair.above == arms.pair.above >= 0 and len(arms.at) == 3:
            return "it starts at the joint at which the arms do, and these are not sure"
        if _leads_up(draft, mine.pair.above) and _leads_up(draft, tree.above[mine.pair.above]):
            return "it may be an arm, for a trunk leads up to it and the arms are not sure"
    return ""


def _leads_up(draft: Draft, node: int) -> bool:
    """Whether a bone leads up to a joint: a root on the ground, which moves no points, is none."""
    above = draft.tree.above[node] if node >= 0 else -1
    if above < 0 or not draft.poses.moves_points(above):
        return False
    return (draft.tree.at[node] - draft.tree.at[above]).dot(draft.up) > 0.0


def folded(draft: Draft, each: Found) -> str:
    """Four legs of which the hind ones are folded: so sits a person, in a file with another up."""
    body = draft.shape.body
    if body is None or body.form != "quadruped" or body.legs is None or len(body.legs.at) < 3:
        return ""
    at = draft.tree.at
    shins = [at[middle] - at[end] for _, middle, end in map(body.legs.joints, (0, 1))]
    if each.kind != "leg" or body.legs.place or any(shin.unit.dot(body.up) > _LEVEL for shin in shins):
        return ""
    return "its hind legs are folded, so it may be a body that sits"


def other_bend(draft: Draft, each: Found) -> str:
    """Shape, and names that half say it, that hardly tell which joint bends; at a hock either is right."""
    mine, body = each.pair, draft.shape.body
    if mine is None or len(mine.pair.paths[0]) < 4 or mine.named > _HALF_CALLED:
        return ""
    hind = body is not None and body.form == "quadruped" and mine is body.legs
    even = mine.named <= 0.0 and not hind and mine.lead < _NARROW and mine.quality < _HARDLY
    unclear = mine.quality < _NO_LIMB or even
    return "another joint of its chain may be the one that bends" if unclear else ""


def goes_on(draft: Draft, each: Found) -> str:
    """A limb that ends before a bone longer than its lower one: it may end, and bend, a joint later.

    So are the legs of machines, with an axle each at the hip, and hands never. Names tell it apart, but of
    no bone that is all but none: there a wrist is called that turns the forearm at the elbow.
    """
    mine, tree = each.pair, draft.tree
    if mine is None or len(mine.at) < 3 or mine.fingers >= HAND:
        return ""
    path, (_, middle, end) = mine.pair.paths[0], mine.at
    lower = tree.at[path[end]].distance(tree.at[path[middle]])
    further = _next_bone(tree, path[end + 1 :], lower)
    longer = further > (lower if mine.named <= 0.0 else lower / _HARDLY_ANY)
    if mine.named <= 0.0 and _ends_at_the_knee(draft, mine):
        return "its end stands high, and what follows goes straight on: it may be the knee"
    if longer and has_hock(draft, each.joints, path[end + 1]):
        return ""
    return "a longer bone follows its end, so another joint may bend" if longer else ""


def _ends_at_the_knee(draft: Draft, mine: Limbs) -> bool:
    """Whether legs of a body on two end high, before a bone in line with the lower one, which is no foot."""
    body, tree = draft.shape.body, draft.tree
    if body is None or body.form != "biped" or mine is not body.legs or draft.shape.legs:
        return False
    path, (_, middle, end) = mine.pair.paths[0], mine.at
    knee = tree.at[path[end]]
    after = tree.at[path[min(end + 1, len(path) - 1)]] - knee
    high = (knee.dot(body.up) - lowest(tree, mine, body.up)) / height(tree, mine, body.up)
    return high > _HIGH and (knee - tree.at[path[middle]]).unit.dot(after.unit) > _NO_HOCK


def _next_bone(tree: Tree, after: Sequence[int], lower: float) -> float:
    """How long the bone after a limb is, its lower one so long; bones between axles of one joint are none."""
    return next((tree.bone[k] for k in after if tree.bone[k] > _HARDLY_ANY * lower), 0.0)


def has_hock(draft: Draft, joints: Sequence[int], after: int) -> bool:
    """Whether a hind leg of a body on four bends ahead at its knee and back at its end: that is a hock.

    A rigger takes the bones above the knee and below it for the limb, or those below it; either is right.
    """
    body, tree = draft.shape.body, draft.tree
    if body is None or body.form != "quadruped" or body.legs is None:
        return False
    if not any(set(joints) <= set(path) for path in body.legs.pair.paths):
        return False
    start, knee, hock = joints
    knee_ahead, hock_ahead = (
        beside(tree, three).dot(draft.facing) for three in ((start, knee, hock), (knee, hock, after))
    )
    return knee_ahead > 0.0 and hock_ahead < -ZIGZAG


def later_start(draft: Draft, each: Found) -> str:
    """A leg of a body on two that begins two joints from the middle: the one between may be its hip.

    Or one with a bone before it that is nearly as long as the upper one and goes on into it: a part of that.
    And a front leg whose upper bone has a joint within it, below what may be a shoulder blade.
    """
    mine, body = each.pair, draft.shape.body
    if each.kind != "leg" or mine is None or body is None or mine.named > 0.0:
        return ""
    path, start = mine.pair.paths[0], mine.at[0]
    led = fsum(draft.tree.bone[k] for k in path[1 : start + 1]) > SAME_PLACE * mine.size
    node = within_upper(draft.tree, path, mine.at) if not led else -1
    if body.form == "quadruped" and mine is body.arms and node >= 0:
        inner = draft.tree.rig.title(node)
        return f"'{inner}' in its upper bone may be where it begins, below a shoulder blade"
    if body.form != "biped":
        return ""
    first = 1 if start > 1 and begin_as_one(draft.tree, mine.pair.paths) else -1
    if first < 0 and start > 0 and _leads_on(draft.tree, [path[k] for k in (start - 1, *mine.at[:2])]):
        first = start - 1
    return f"'{draft.tree.rig.title(path[first])}' before it may be where it begins" if first >= 0 else ""


def _leads_on(tree: Tree, joints: Sequence[int]) -> bool:
    """Whether the first of two bones goes on into the second and is more than half as long."""
    a, b, c = (tree.at[k] for k in joints)
    return (b - a).unit.dot((c - b).unit) > GOES_ON and b.distance(a) > _HALF * c.distance(b)


def middle_bone(draft: Draft, each: Found) -> str:
    """A limb of three joints that begins where its twin does: its first bone leads to the hip or shoulder."""
    mine, tree = each.pair, draft.tree
    if mine is None or len(mine.at) < 3 or mine.named > 0.0 or mine.at[0] > 0:
        return ""
    path = mine.pair.paths[0]
    if (len(path) > 3 or tree.below[path[-1]]) and begin_as_one(tree, mine.pair.paths, _INNER):
        return "its first bone may lead from the middle"
    if mine.fingers >= 2:
        return ""
    if mine.at[2] < len(path) - 1 or not begin_as_one(tree, mine.pair.paths):
        return ""
    return "its first bone leads from the middle, and nothing shows where it ends"


def reaches_further(draft: Draft, each: Found) -> str:
    """A limb whose last joint moves points so far beyond it that a further bone has to be there: a shin."""
    mine, tree = each.pair, draft.tree
    if mine is None or len(mine.at) < 3 or mine.named > 0.0 or tree.below[each.joints[2]]:
        return ""
    further = moves_a_bone(tree, draft.poses, each.joints[1:], mine.size)
    return "what its end moves reaches as far as a further bone" if further else ""


def other_end(draft: Draft, each: Found) -> str:
    """Legs of a body on four whose head may be at either end: front and hind ones are told by it."""
    mine, body, plane = each.pair, draft.shape.body, draft.shape.plane
    if mine is None or body is None or plane is None or mine not in (body.legs, body.arms):
        return ""
    return "" if mine.kind == "leg" and _is_head_ahead(draft) else _no_head_end(draft)


@once
def _is_head_ahead(draft: Draft) -> bool:
    """Whether a joint that names call the head of a body on four is beyond its front legs."""
    body, head = draft.shape.body, draft.known_bones.get("head", -1)
    if head < 0 or body is None or body.legs is None or body.arms is None:
        return False
    trunk = body.arms.starts - body.legs.starts
    return (draft.tree.at[head] - body.arms.starts).dot(trunk) > 0.0


@once
def _no_head_end(draft: Draft) -> str:
    """That nothing shows of a body on four which end of it has the head."""
    body, plane = draft.shape.body, draft.shape.plane
    if body is None or plane is None or head_end(draft.tree, body, plane, draft.poses, draft.shape.limbs):
        return ""
    return "nothing shows which end of its trunk has the head"


def rival(draft: Draft, each: Found) -> str:
    """What else the arms may be where shape alone tells: wings beside them, the next joints of the chain."""
    mine, tree, body = each.pair, draft.tree, draft.shape.body
    front = body is not None and body.form == "quadruped" and mine is body.arms
    if mine is None or not (each.kind == "arm" or front) or len(mine.at) < 3 or mine.named > CALLED:
        return ""
    path, start, end = mine.pair.paths[0], mine.at[0], mine.at[2]
    a, b, c = (tree.at[k] for k in mine.joints(0))
    upper, lower = b.distance(a), c.distance(b)
    further = _next_bone(tree, (*path[end + 1 :], *tree.paths[path[-1]][1:]), lower)
    bend = (b - a).unit.dot((c - b).unit)
    at, fingers = branches(tree, path)
    hand = at == end and fingers >= HAND  # no elbow has so many below it
    if start == 0 and further > _NEXT * lower and not hand and (not front or bend > CLEAR):
        return "its first bone may be a clavicle, as a long bone follows"
    if start > 0 and further > _TIP * (upper + lower) and not hand and bend > STRAIGHT:
        return "its middle may be a twist joint of its upper bone, as a long bone follows"
    ends = start > 0 and end == len(path) - 1 and not fingers and not _has_names_of_three(draft, each)
    if (
        ends
        and hangs_from_a_lying_trunk(body, mine)
        and not (_stands_below_its_blade(tree, body, mine) or (start == 1 and _moves_a_foot(draft, mine)))
    ):
        return "its first bone may be a shoulder blade or an upper bone, and nothing shows where its foot is"
    if front:
        return ""
    if mine.fingers >= 2 or draft.shape.plane is None:
        return ""
    if start == 1 and tree.bone[path[1]] > _BROAD * upper:
        return "its first bone may be an upper arm or a clavicle, and nothing shows where its hand is"
    for node in (*_beside(draft, mine), *_beyond(draft, mine)):
        aside = [abs(draft.shape.plane.side_of(tree.at[k])) for k in tree.paths[node][:2]]
        long = len(tree.paths[node]) > 2 and tree.reach[node] > _RIVAL * mine.size
        if long and aside[0] > 0.01 * mine.size and aside[1] > 0.05 * mine.size:
            return f"the chain from '{draft.tree.rig.title(node)}' may be an arm as well"
    return ""


def _has_names_of_three(draft: Draft, each: Found) -> bool:
    """Whether words call the three joints upper, lower and end."""
    words = (draft.words.get(joint, NO_WORDS).levels for joint in each.joints)
    return all(own.get(level) == 1.0 for own, level in zip(words, _THREE, strict=True))


def hangs_from_a_lying_trunk(body: Body | None, arms: Limbs) -> bool:
    """Whether arms are those of a body whose trunk lies, as of a turtle: they need no shoulder blades."""
    legs = body.legs if body is not None else None
    return body is not None and legs is not None and (arms.starts - legs.starts).unit.dot(body.up) < _LYING


def _stands_below_its_blade(tree: Tree, body: Body | None, arms: Limbs) -> bool:
    """Whether front legs end as low as the hind ones, after one bone from the middle: that is the blade."""
    legs = body.legs if body is not None else None
    if body is None or legs is None or arms.at[0] != 1 or not begin_as_one(tree, arms.pair.paths):
        return False
    return abs(lowest(tree, arms, body.up) - lowest(tree, legs, body.up)) < ENDS_LOW * legs.size


def _moves_a_foot(draft: Draft, mine: Limbs) -> bool:
    """Whether what the ends of both limbs move goes less far beyond them than a shin does."""
    for which in (0, 1):
        _, middle, end = mine.joints(which)
        on = draft.tree.at[end] - draft.tree.at[middle]
        points = draft.poses.box_of([end], draft.tree.places)
        far = max(how_far(points, draft.tree.at[end], on.unit), default=inf)
        if far > _SOLE * on.length:
            return False
    return True


def _beside(draft: Draft, mine: Limbs) -> list[int]:
    """What hangs where the arms do, or a joint from there, and has no name that tells what it is."""
    tree, chest = draft.tree, mine.pair.above
    body = draft.shape.body
    legs = body.legs.pair.above if body is not None and body.legs is not None else -1
    over = tree.above[chest] if chest >= 0 else -1
    near = [k for k in (chest, over, *tree.below[chest]) if k >= 0 and k not in mine.pair.nodes]
    hanging = [k for at in near if at == chest or at != legs for k in tree.below[at]]
    return [
        k
        for k in hanging
        if k not in mine.pair.nodes
        and chest not in tree.paths[k]
        and not any(roles_in_name(tree.rig.names[n]) for n in tree.paths[k])
    ]


def _beyond(draft: Draft, mine: Limbs) -> list[int]:
    """Where further pairs that bend as arms do hang from the trunk beyond the arms, below a neck and head.

    Arms hang there, and cloth or cables below them; hair hangs from the end of it, and fingers from an arm.
    """
    tree, chest, found = draft.tree, mine.pair.above, list[int]()
    first = {path[0] for path in mine.pair.paths}
    for other in (k for k in draft.shape.limbs if k is not mine and len(k.at) == 3):
        over, starts = other.pair.above, [path[0] for path in other.pair.paths]
        way = tree.way(-1, over)
        if chest < 0 or over == chest or chest not in way or not first.isdisjoint(way):
            continue
        on = [k for k in tree.below[over] if k not in starts and len(tree.paths[k]) > 1]
        high = max(tree.at[k].dot(draft.up) for k in starts)
        if any(tree.at[node].dot(draft.up) > high for k in on for node in tree.paths[k][1:]):
            found += [k for k in starts if not any(roles_in_name(tree.rig.names[n]) for n in tree.paths[k])]
    return found


def ankle_as_knee(draft: Draft, each: Found) -> str:
    """Legs that stand straight down to what is taken for knees, and end with what may be long feet."""
    mine, body = each.pair, draft.shape.body
    if each.kind != "leg" or mine is None or body is None or mine is not body.legs or mine.named > CALLED:
        return ""
    feet = long_feet(draft.tree, mine, body.up, draft.facing) if body.form == "biped" else 0.0
    return "its knee may be the ankle of a long foot" if feet else ""
