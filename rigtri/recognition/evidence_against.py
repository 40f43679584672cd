"""Counter-evidence: why a found arm or leg is shown, but never edited."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from rigtri.maths.scalar_vector import Vector
from rigtri.recognition.arms_legs import AGREED, Found
from rigtri.recognition.body_shape import SIMILAR, Body, lowest
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.hands_feet import finger_in_name
from rigtri.recognition.layout import CONFIDENT
from rigtri.recognition.limb_pairs import Limbs
from rigtri.recognition.limb_triples import HAND, STRAIGHT, branches
from rigtri.recognition.limb_words import NO_WORDS, limb_words
from rigtri.recognition.naming_schemes import limb_kind_in_name, parse_name, roles_in_name
from rigtri.recognition.split_bones import further_part, no_hand, split_bone
from rigtri.recognition.things import only_things

# What a contradiction leaves of a confidence: less than `CONFIDENT`.
_UNSURE = 0.6
# Bones of twins are alike up to this part of their length.
_TWINS = 0.15
# Bones of one limb are at least so long a part of each other.
_BALANCE = 0.4
# Of a body without legs and without a second arm, so many bones beside the arm's own, or fingers, are named.
_ENOUGH = 3
# A further chain at the chest that is so long a part of the arms may be an arm as well.
_RIVAL = 0.2
# Of a body one of these names alone does not tell: planes have tails.
_HEADS = frozenset(["skull", "tail"])
# A limb bends clearly by this (a cosine, 15°).
_CLEAR = 0.966
# A bone after the wrist that is so long a part of the lower arm is rather the lower arm itself.
_NEXT = 0.6
# Names that say so far which three joints bend: those of all three, one of them vague.
_CALLED = 0.8
# A first bone that is so long a part of the next one is a clavicle of none but very broad shoulders.
_BROAD = 0.8
# A trunk that rises by less than this (a cosine) lies.
_LYING = 0.6
# Five fingers of three joints each are a hand: birds have fewer toes, and others shorter ones.
_DIGITS, _PHALANGES = 5, 3
# A middle that leads by less over the next best, of bones that are less like those of a limb than this: so
# it is in straight chains of many joints, where crooked places (2 % of a bone) choose it.
_NARROW, _HARDLY = 0.16, 0.45


def doubted(draft: Draft, found: Sequence[Found]) -> list[Found]:
    """The limbs, those that evidence contradicts less than sure; a remark says each contradiction."""
    if draft.certain:
        return list(found)
    weighed = []
    for each in found:
        why = _contradiction(draft, each, found) if len(each.joints) == 3 else _no_trunk(draft, each)
        weighed.append(unsure(draft, each, why) if why and _is_sure(each) else each)
    return weighed


def _is_sure(each: Found) -> bool:
    return round(each.confidence, 2) >= CONFIDENT  # as it is written


def unsure(draft: Draft, each: Found, why: str) -> Found:
    """A limb that is not sure, for a reason, which a remark gives."""
    words = f"the {each.side} {each.kind}".replace("  ", " ")
    draft.remarks.append(f"{words} is not sure: {why}")
    return replace(each, confidence=_UNSURE, evidence=(*each.evidence, f"but {why}"))


def _contradiction(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    by_name = _is_named(draft, each)
    return (
        _other_limb(draft, each)
        or _trunk_aside(draft, each)
        or _other_side(draft, each)
        or _against_the_tree(draft, each)
        or (by_name and (_unnamed_between(draft, each) or _unlike_twin(draft, each, found)))
        or (by_name and _counted(draft, each))
        or _upside_down(draft, each, found)
        or _no_trunk(draft, each)
        or _no_body(draft, each, found)
        or (not by_name and _arm_as_leg(draft, each, found))
        or (not by_name and (_misnamed(draft, each) or _other_bend(each) or no_hand(draft, each)))
        or split_bone(draft, each)
        or (not by_name and only_things(draft, each.joints))
        or (not by_name and further_part(draft, each))
        or (not by_name and (_skirt(draft, each) or _rival(draft, each)))
        or (not by_name and _by_the_legs(draft, each, found))
        or ""
    )


def _title(draft: Draft, node: int) -> str:
    return f"'{draft.tree.rig.title(node)}'"


def _other_limb(draft: Draft, each: Found) -> str:
    """A name of another kind of limb in the middle of this one; front legs are called arms, too."""
    kinds = [(k, limb_kind_in_name(draft.tree.rig.names[k])) for k in each.joints]
    named_kinds = {kind for _, kind in kinds if kind}
    if len(named_kinds) < 2:
        return ""
    other = next(k for k, kind in kinds if kind and kind != each.kind)
    return f"the name of {_title(draft, other)} is of another limb"


def _trunk_aside(draft: Draft, each: Found) -> str:
    """A joint of one side before the limb that is called as the trunk is: names may be one joint off."""
    paths = each.pair.pair.paths if each.pair is not None else ()
    for path in (path for path in paths if each.joints[0] in path):
        for node in path[: path.index(each.joints[0])]:
            if draft.words.get(node, NO_WORDS).trunk:
                return f"{_title(draft, node)} before it has a name of the trunk"
    return ""


def _other_side(draft: Draft, each: Found) -> str:
    """A name that says another side than the limb has."""
    for node in each.joints:
        which = parse_name(draft.tree.rig.names[node]).side
        if which and which != each.side:
            return f"the name of {_title(draft, node)} says {which}"
    return ""


def _against_the_tree(draft: Draft, each: Found) -> str:
    """Joints that are not below each other: so it may be in IK rigs, where they are below the trunk."""
    tree = draft.tree
    start, middle, end = each.joints
    for node, over in ((middle, start), (end, middle)):
        if tree.is_below(node, over) or (tree.is_own and AGREED in each.evidence):
            continue
        words = f"{_title(draft, node)} is not a descendant of {_title(draft, over)}"
        above = tree.above[node]
        at_trunk = above < 0 or (above != start and tree.is_below(start, above))
        if not at_trunk or tree.is_below(start, node) or _goes_on(draft, over, node):
            return words
        upper, lower = ((tree.at[b] - tree.at[a]).length for a, b in ((start, middle), (middle, end)))
        if min(upper, lower) < _BALANCE * max(upper, lower):
            return f"{words} and is not where it should be"
    return ""


def _goes_on(draft: Draft, over: int, node: int) -> bool:
    """Whether another joint than ``node`` follows one, so that none is missing there."""
    names = draft.tree.rig.names
    return any(k != node and not roles_in_name(names[k]) for k in draft.tree.below[over])


def _unnamed_between(draft: Draft, each: Found) -> str:
    """A joint without a name between those that have one, where shape does not tell what it is."""
    if AGREED in each.evidence:
        return ""
    start, middle, end = each.joints
    names = draft.tree.rig.names
    for low, high in ((middle, start), (end, middle)):
        if draft.tree.is_below(low, high):
            for node in draft.tree.way(high, low)[1:-1]:
                if not parse_name(names[node]).plain and not roles_in_name(names[node]):
                    ends = f"{_title(draft, high)} and {_title(draft, low)}"
                    return f"a joint without a name is between {ends}"
    return ""


def _unlike_twin(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """The limb of the other side has other bones, and shape does not tell that this one is right."""
    twin = _twin(each, found)
    if AGREED in each.evidence or twin is None:
        return ""
    tree = draft.tree
    for a, b in ((0, 1), (1, 2)):
        mine, other = ((tree.at[k.joints[b]] - tree.at[k.joints[a]]).length for k in (each, twin))
        steps = [len(tree.way(k.joints[a], k.joints[b])) for k in (each, twin)]
        if abs(mine - other) > _TWINS * max(mine, other) or steps[0] != steps[1]:
            return f"the {twin.side} {twin.kind} has other bones"
    return ""


def _counted(draft: Draft, each: Found) -> str:
    """An arm of joints that names only count, more than three, where shape does not tell which bend.

    The first may be a clavicle; of legs it is the hip.
    """
    if each.kind != "arm" or AGREED in each.evidence:
        return ""
    names, below = draft.tree.rig.names, draft.tree.below[each.joints[2]]
    words = {parse_name(names[joint]).plain for joint in each.joints}
    more = [k for k in below if words == {parse_name(names[k]).plain} and _numbers(names[k])]
    return f"its joints are counted on to {_title(draft, more[0])}, and any three may bend" if more else ""


def _twin(each: Found, found: Sequence[Found]) -> Found | None:
    """The limb of the other side that bends, too."""
    others = (k for k in found if k.kind == each.kind and {k.side, each.side} == {"left", "right"})
    return next((k for k in others if len(k.joints) == 3), None)


def _upside_down(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """Legs that begin above arms, as the file says what is up, are no legs."""
    legs, arms = ([k for k in found if k.kind == kind and k.side] for kind in ("leg", "arm"))
    if len(legs) != 2 or len(arms) != 2 or _is_named(draft, each):
        return ""
    up, at = Vector(*draft.tree.rig.rules.up), draft.tree.at
    low, high = (at[one.joints[0]].dot(up) + at[other.joints[0]].dot(up) for one, other in (legs, arms))
    if low > high and draft.up.dot(up) < -0.5:
        return "its legs begin above its arms"
    return ""


def _is_named(draft: Draft, each: Found) -> bool:
    return draft.reading is not None and each.joints in draft.reading.limbs.values()


def _no_body(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """An arm by itself, or four legs that carry nothing: cranes and tables are like that, too."""
    bones = draft.reading.bones if draft.reading is not None else {}
    beside = [bone for bone, node in bones.items() if node not in each.joints]
    alone = (
        len(found) == 1
        and each.kind == "arm"
        and not each.side
        and len(draft.tree.nodes) > len(each.joints) + 1
    )
    if alone and len(beside) < _ENOUGH and not _has_fingers(draft, each):
        return "no other part of a body is named"
    body = draft.shape.body
    four = len(found) == 4 and all(k.kind == "leg" for k in found) and not {"head", "hips"} & set(bones)
    if four and body and body.legs and body.arms and body.legs.pair.above == body.arms.pair.above:
        return "no trunk is between its front and its hind legs"
    return ""


def _no_trunk(draft: Draft, each: Found) -> str:
    """A limb by names where no trunk or head is named: chairs have arms and legs, too, and scales a head.

    Not one that a naming scheme knows, of clear words for all three joints.
    """
    named = _is_named(draft, each)
    words = [draft.words.get(joint, NO_WORDS).levels for joint in each.joints]
    clear = [levels for levels in words if 1.0 in levels.values()]
    if (
        not (named or _by_words(each))
        or _has_fingers(draft, each)
        or (named and all(words) and len(clear) > 1)
    ):
        return ""
    names = [draft.tree.rig.names[k] for k in draft.tree.nodes if draft.words.get(k, NO_WORDS).trunk]
    heads = [name for name in names if not _HEADS.isdisjoint(roles_in_name(name))]
    return "" if len(names) > min(1, len(heads)) else "nothing else of a body is named"


def _by_words(each: Found) -> bool:
    """Whether single words of names say of a pair what it is."""
    return each.pair is not None and each.pair.kind == each.kind


def _arm_as_leg(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """What looks like legs in a body that has none: its arms, where hair passes for arms."""
    mine, body, tree = each.pair, draft.shape.body, draft.tree
    arms = body.arms if body is not None and body.form == "biped" else None
    if each.kind != "leg" or mine is None or arms is None or arms is mine or arms.fingers >= 2:
        return ""
    fingers = [k for k in tree.below[each.joints[-1]] if len(tree.paths[k]) >= _PHALANGES]
    if len(fingers) >= _DIGITS:
        return "it ends in a hand, and the arms do not"
    if any(_rival(draft, k) or not _is_sure(k) for k in found if k.pair is arms):
        if mine.at[0] == 1:
            return "it may be an arm below its clavicle, for the arms are not sure"
        if _leads_up(draft, mine.pair.above) and _leads_up(draft, tree.above[mine.pair.above]):
            return "it may be an arm, for a trunk leads up to it and the arms are not sure"
    return ""


def _leads_up(draft: Draft, node: int) -> bool:
    """Whether a bone leads up to a joint: a root on the ground, which moves no points, is none."""
    above = draft.tree.above[node] if node >= 0 else -1
    if above < 0 or not draft.poses.moves_points(above):
        return False
    return (draft.tree.at[node] - draft.tree.at[above]).dot(draft.up) > 0.0


def _misnamed(draft: Draft, each: Found) -> str:
    """Names of a limb whose hand is missing: a forearm at its end, or bones that count from the middle."""
    names = [draft.tree.rig.names[node] for node in each.joints]
    last = limb_words(names[2]).levels
    if each.kind == "arm" and last.get("lower") == 1.0 and len(last) == 1:  # hocks are called so, too
        return f"{_title(draft, each.joints[2])} is called as a lower bone is"
    first, second, third = (parse_name(name) for name in names)
    counts = second.plain == third.plain != first.plain and second.key != third.key
    if counts and second.plain and _numbers(second.key) == [1] and _numbers(third.key) == [2]:
        return f"its bones are counted from {_title(draft, each.joints[1])} on"
    return ""


def _numbers(name: str) -> list[int]:
    return [int(digits) for digits in re.findall("[0-9]+", name)]


def _other_bend(each: Found) -> str:
    """Shape that hardly tells which joint of a chain bends."""
    mine = each.pair
    if mine is None or len(mine.pair.paths[0]) < 4 or mine.named > 0.0:
        return ""
    unclear = mine.lead < _NARROW and mine.quality < _HARDLY
    return "another joint of its chain may be the one that bends" if unclear else ""


def _skirt(draft: Draft, each: Found) -> str:
    """Legs beside which another pair hangs that is as long, or stands where they do: a skirt, a chair."""
    mine, body = each.pair, draft.shape.body
    if mine is None or body is None or body.form != "biped" or mine is not body.legs or mine.named > 0.0:
        return ""
    if mine in draft.shape.legs and mine.kind == "leg":
        return ""  # an insect's
    ground = lowest(draft.tree, mine, body.up)
    for other in draft.shape.limbs:
        if other is mine or other.pair.above != mine.pair.above or len(other.at) != len(mine.at):
            continue
        apart, like = abs(lowest(draft.tree, other, body.up) - ground), abs(other.size - mine.size)
        if like < _TWINS * mine.size or (other.size > SIMILAR * mine.size and apart < _TWINS * mine.size):
            return f"the chain from {_title(draft, other.joints(0)[0])} is as long: both may be a skirt"
    return ""


def _by_the_legs(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """Arms are told by the legs: where evidence denies these, they are not sure; chairs have both."""
    body = draft.shape.body
    if body is None or each.pair is None or each.pair is not body.arms or _by_words(each):
        return ""
    for leg in (k for k in found if k.pair is body.legs):
        if _skirt(draft, leg) or (len(leg.joints) == 3 and _contradiction(draft, leg, found)):
            return "its legs are not sure"
    return ""


def _has_fingers(draft: Draft, arm: Found) -> bool:
    """Whether several joints below an arm's end are called as fingers are."""
    below = draft.tree.branch(arm.joints[-1]) if arm.kind == "arm" else []
    return (
        len({finger for node in below if (finger := finger_in_name(draft.tree.rig.names[node]))}) >= _ENOUGH
    )


def _rival(draft: Draft, each: Found) -> str:
    """What else the arms may be where shape alone tells: wings beside them, the next joints of the chain."""
    mine, tree, body = each.pair, draft.tree, draft.shape.body
    front = body is not None and body.form == "quadruped" and mine is body.arms
    if mine is None or not (each.kind == "arm" or front) or len(mine.at) < 3 or mine.named > _CALLED:
        return ""
    path, start, end = mine.pair.paths[0], mine.at[0], mine.at[2]
    long = end + 1 < len(path) and tree.bone[path[end + 1]] > _NEXT * tree.bone[path[end]]
    a, b, c = (tree.at[k] for k in mine.joints(0))
    bend = (b - a).unit.dot((c - b).unit)
    at, fingers = branches(tree, path)
    hand = at == end and fingers >= HAND  # no elbow has so many below it
    if start == 0 and long and not hand and (not front or bend > _CLEAR):
        return "its first bone may be a clavicle, as a long bone follows"
    if start > 0 and long and not hand and bend > STRAIGHT:
        return "its middle may be a twist joint of its upper bone, as a long bone follows"
    if start > 0 and end == len(path) - 1 and not fingers and _hangs_from_a_lying_trunk(body, mine):
        return "its first bone may be a shoulder blade or an upper bone, and nothing shows where its foot is"
    if front:
        return ""
    if mine.fingers >= 2 or draft.shape.plane is None:
        return ""
    if start == 1 and tree.bone[path[1]] > _BROAD * (b - a).length:
        return "its first bone may be an upper arm or a clavicle, and nothing shows where its hand is"
    for node in _beside(draft, mine):
        aside = [abs(draft.shape.plane.side_of(tree.at[k])) for k in tree.paths[node][:2]]
        long = len(tree.paths[node]) > 2 and tree.reach[node] > _RIVAL * mine.size
        if long and aside[0] > 0.01 * mine.size and aside[1] > 0.05 * mine.size:
            return f"the chain from {_title(draft, node)} may be an arm as well"
    return ""


def _hangs_from_a_lying_trunk(body: Body | None, arms: Limbs) -> bool:
    """Whether arms are those of a body whose trunk lies, as of a turtle: they need no shoulder blades."""
    legs = body.legs if body is not None else None
    return body is not None and legs is not None and (arms.starts - legs.starts).unit.dot(body.up) < _LYING


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
