"""Counter-evidence: why a found arm or leg is shown, but never edited."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

from rigtri.recognition import rival_joints
from rigtri.recognition.arms_legs import AGREED, FACES
from rigtri.recognition.arms_on_the_ground import (
    arm_as_front_leg,
    arm_below_a_lying_trunk,
    arm_called_front,
    arm_on_the_ground,
)
from rigtri.recognition.character_draft import Draft, once
from rigtri.recognition.cloth import beside_known_legs, hangs_as_cable, hangs_as_cloth, skirt
from rigtri.recognition.denied_directions import denied_directions
from rigtri.recognition.doubled_chains import moves_nothing
from rigtri.recognition.found_limb import Found
from rigtri.recognition.guessed_hierarchy import (
    called_end,
    end_elsewhere,
    is_told_by_legs,
    loose_joints,
    lost_third,
    lower_elsewhere,
    miscounted,
    out_of_order,
    small_part,
    start_beside,
    turned_in_file,
)
from rigtri.recognition.inanimate import (
    may_be_a_thing,
    may_be_wings,
    of_machine,
    only_things,
    points_ahead,
)
from rigtri.recognition.limb_ends import HAND
from rigtri.recognition.limb_words import NO_WORDS, limb_words
from rigtri.recognition.map_doubts import denied_by_map
from rigtri.recognition.name_parsing import numbers_in, parse_name
from rigtri.recognition.name_readings import follows_in_line
from rigtri.recognition.names_of_several import named_twice, one_of_several
from rigtri.recognition.naming_schemes import limb_kind_in_name, roles_in_name
from rigtri.recognition.no_body import beside_things, by_words, ends_in_a_device, is_named, no_body, no_trunk
from rigtri.recognition.rival_joints import beside_another
from rigtri.recognition.shape_doubts import (
    ankle_as_knee,
    arm_as_leg,
    at_the_top,
    folded,
    goes_on,
    later_start,
    middle_bone,
    of_twin,
    other_bend,
    other_end,
    reaches_further,
    rival,
    upside_down,
)
from rigtri.recognition.split_bones import clavicle_part, further_part, no_hand, split_bone
from rigtri.recognition.unlike_twins import joint_more, unlike_twin

# What a contradiction leaves of a confidence: less than `CONFIDENT`.
_UNSURE = 0.6
# Bones of one limb are at least so long a part of each other.
_BALANCE = 0.4
# Joints that stand nearer to those of a limb than this part of its length are beside it.
_BESIDE = 0.1
# A bone that goes straight on by more than this part of itself beyond a joint may have that within it.
_WITHIN = 0.15
# Bones of counted joints are clearly those of a limb if they are so much alike.
_CLEARLY = 0.45
# What has so many limbs has all: both pairs of a body on two or four legs.
_ALL_LIMBS = 4


def doubted(draft: Draft, found: Sequence[Found]) -> list[Found]:
    """The limbs, those that evidence contradicts less than sure; a remark says each contradiction."""
    if draft.certain:
        return [unsure(draft, each, why) if (why := denied_by_map(draft, each)) else each for each in found]
    against = [_contradiction(draft, each, found) for each in found]
    doubts = {id(each): why for each, why in zip(found, against, strict=True)}
    denied, weighed = denied_directions(draft, found), []
    for each, first in zip(found, against, strict=True):
        why = first or of_twin(each, found, doubts) or _by_the_legs(draft, each, found, doubts)
        why = why or _by_what_is_worn(draft, each, found, doubts) or denied
        weighed.append(unsure(draft, each, why) if why and each.is_sure else each)
    return weighed


def unsure(draft: Draft, each: Found, why: str) -> Found:
    """A limb that is not sure, for a reason, which a remark gives."""
    words = f"the {each.side} {each.kind}".replace("  ", " ")
    draft.remarks.append(f"{words} is not sure: {why}")
    return replace(each, confidence=_UNSURE, evidence=(*each.evidence, f"but {why}"))


def _contradiction(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """The first doubt of a limb: of those of every limb, then of names or of shapes, whichever tell it."""
    if len(each.joints) != 3:
        doubts = (no_trunk, beside_things, lost_third, miscounted, joint_more, *_alone(_no_bend))
    else:
        doubts = (*_OF_ANY, *(_OF_NAMES if is_named(draft, each) else _OF_SHAPES), *_LAST)
    for doubt in doubts:
        if why := doubt(draft, each, found):
            return why
    return ""


def _no_bend(draft: Draft, each: Found) -> str:
    """A limb of two joints in a longer chain, no three of which bend as a limb does."""
    path = each.pair.pair.paths[0] if each.pair is not None else ()
    return f"{_title(draft, path[2])} follows, and no three of its joints bend" if len(path) > 2 else ""


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


def _moves_no_vertex(draft: Draft, each: Found) -> str:
    """A limb none of whose joints moves points, beside joints that do: controls stand so.

    In a file that has but a part of a body, such as its hair, nothing stands beside the limbs.
    """
    if not moves_nothing(draft, each.joints):
        return ""
    tree = draft.tree
    own = {*tree.branch(each.joints[0])}
    others = [k for k in tree.nodes if draft.poses.moves_points(k) and k not in own]
    places = [tree.at[joint] for joint in each.joints]
    near = _BESIDE * sum(b.distance(a) for a, b in pairwise(places))
    beside = all(any(tree.at[k].distance(place) <= near for k in others) for place in places)
    return "it moves no vertex, and joints beside it do" if beside else ""


def _has_a_rival(draft: Draft, each: Found) -> str:
    """A limb of one of two skeletons in the same places: of what moves the mesh and of what moves that."""
    if draft.rival < 0:
        return ""
    return f"another skeleton, from {_title(draft, draft.rival)} on, stands in the same places"


def _beyond_the_known(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """A limb that shape alone tells, of a kind and side of which names know another, or beside all limbs
    that a body has by its names: it may be worn, as stirrups are."""
    if each.pair is None or each.pair.named > 0.0 or each.pair in draft.shape.legs:
        return ""
    for other in (k for k in found if (k.kind, k.side) == (each.kind, each.side) and is_named(draft, k)):
        return f"names know {_title(draft, other.joints[0])} as the first joint of that"
    known = [k for k in found if k.pair is not each.pair and (is_named(draft, k) or by_words(k))]
    return f"names know {len(known)} other limbs, and not this one" if len(known) >= _ALL_LIMBS else ""


def _other_side(draft: Draft, each: Found) -> str:
    """A name that says another side than the limb has."""
    for node in each.joints:
        if (which := parse_name(draft.tree.rig.names[node]).side) and which != each.side:
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
        upper, lower = (tree.at[b].distance(tree.at[a]) for a, b in ((start, middle), (middle, end)))
        if min(upper, lower) < _BALANCE * max(upper, lower):
            return f"{words} and is not where it should be"
    return ""


def _goes_on(draft: Draft, over: int, node: int) -> bool:
    """Whether another joint than ``node`` follows one, so that none is missing there."""
    names = draft.tree.rig.names
    return any(k != node and not roles_in_name(names[k]) for k in draft.tree.below[over])


def _unnamed_between(draft: Draft, each: Found) -> str:
    """A joint without a name between, or after, those that have one, where shape does not tell what it is."""
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
    after = draft.tree.below[end] if not parse_name(names[end]).plain else []
    if len(after) == 1 and follows_in_line(draft.tree, middle, end, after[0]) > _WITHIN:
        return (
            f"{_title(draft, end)} has no name and may be within the bone that {_title(draft, after[0])} ends"
        )
    return ""


def _counted(draft: Draft, each: Found) -> str:
    """A limb of joints that names only count, more than three, where shape does not tell which bend.

    The first of an arm may be a clavicle, and any may be a segment of a bone: names have chosen those that
    shape has, too, so that has to be clearly a limb's.
    """
    if each.kind == "leg" and (each.pair is None or each.pair.quality > _CLEARLY):
        return ""  # the first is the hip
    if each.kind == "arm" and AGREED in each.evidence and not rival(draft, each):
        return ""
    names, below = draft.tree.rig.names, draft.tree.below[each.joints[2]]
    words = {parse_name(names[joint]).plain for joint in each.joints}
    more = [k for k in below if words == {parse_name(names[k]).plain} and numbers_in(names[k])]
    return f"its joints are counted on to {_title(draft, more[0])}, and any three may bend" if more else ""


def _named_to_bend_elsewhere(draft: Draft, each: Found) -> str:
    """A middle joint that is called as an upper bone, after one that is called as what comes before it.

    Or as a hand or foot, before which names tell no two bones: limbs of one have three with toes.
    """
    first, middle, last = (limb_words(draft.tree.rig.names[joint]).levels for joint in each.joints)
    if middle.keys() == {"upper"} and "before" in first and (not last or last.keys() == {"lower"}):
        return f"{_title(draft, each.joints[1])} is called as an upper bone is"
    if middle == {"end": 1.0}:
        before = [draft.words.get(k, NO_WORDS).levels for k in (*each.before, each.joints[0])]
        named = {level for levels in before for level, sure in levels.items() if sure == 1.0}
        if not named >= {"upper", "lower"}:
            return f"{_title(draft, each.joints[1])}, where it bends, is called as the end of a limb is"
    return ""


def _misnamed(draft: Draft, each: Found) -> str:
    """Names of a limb whose hand is missing: a forearm at its end, or bones that count from its middle."""
    names = [draft.tree.rig.names[node] for node in each.joints]
    if each.kind == "leg" and limb_words(names[0]).levels == {"end": 1.0}:
        return f"{_title(draft, each.joints[0])}, where it begins, is called as the end of a limb is"
    last = limb_words(names[2]).levels
    if each.kind == "arm" and last.get("lower") == 1.0 and len(last) == 1:  # hocks are called so, too
        return f"{_title(draft, each.joints[2])} is called as a lower bone is"
    between = draft.tree.way(*each.joints[1:])[1:-1]
    lower = [k for k in between if limb_words(draft.tree.rig.names[k]).levels == {"lower": 1.0}]
    if each.kind == "arm" and lower and not last:
        return f"{_title(draft, lower[-1])}, after which it ends, is called as a lower bone is"
    first, second, third = (parse_name(name) for name in names)
    counted = "" != second.plain == third.plain != first.plain
    numbers = numbers_in(second.key), numbers_in(third.key)
    blender = numbers == ((), (1,)) and each.kind == "arm" and "before" in limb_words(names[0]).levels
    if counted and (numbers == ((1,), (2,)) or blender):
        return f"its bones are counted from {_title(draft, each.joints[1])} on"
    return ""


def _by_the_legs(draft: Draft, each: Found, found: Sequence[Found], doubts: Mapping[int, str]) -> str:
    """Arms without hands are told by the legs: where evidence denies these, they are not sure.

    Chairs have both. Which joints of a leg bend does not matter. doubts: against each limb, by its id."""
    body = draft.shape.body
    if len(each.joints) != 3 or is_named(draft, each) or by_words(each):
        return ""
    if body is None or each.pair is None or each.pair is not body.arms:
        return ""
    legs = [k for k in found if k.pair is body.legs]
    whys = {id(leg): doubts[id(leg)] if len(leg.joints) == 3 else "" for leg in legs}
    denied = [k for k in legs if whys[id(k)] and all(whys[id(k)] != doubt(draft, k) for doubt in _OF_JOINTS)]
    if is_told_by_legs(each) and (denied or any(len(leg.joints) < 3 for leg in legs)):
        return "its side is told by legs that are not sure"
    hand = each.pair.thumb and each.pair.fingers >= HAND
    return "its legs are not sure" if not hand and (denied or any(skirt(draft, k) for k in legs)) else ""


def _by_what_is_worn(draft: Draft, each: Found, found: Sequence[Found], doubts: Mapping[int, str]) -> str:
    """A side that the body tells, where a pair of its limbs may be worn: that may be what turns it round.

    Names of other joints may tell the side as well.
    """
    if not any(words.startswith(FACES) for words in each.evidence) or draft.side_in_names(each.joints):
        return ""
    if _agrees_with_names(draft):
        return ""
    for other in found:
        mine = other.joints == each.joints or len(other.joints) != 3
        if not mine and (why := doubts[id(other)]) and why == beside_another(draft, other):
            return f"its side is told by a body of which {_title(draft, other.joints[0])} may be worn"
    return ""


@once
def _agrees_with_names(draft: Draft) -> bool:
    """Whether most joints that names put on a side stand on it."""
    sides = {node: parse_name(draft.tree.rig.names[node]).side for node in draft.tree.nodes}
    named = [(node, side) for node, side in sides.items() if side and draft.side_of([node])]
    right = len([node for node, side in named if draft.side_of([node]) == side])
    return 2 * right > len(named)


_Doubt = Callable[[Draft, Found, Sequence[Found]], str]


def _alone(*doubts: Callable[[Draft, Found], str]) -> tuple[_Doubt, ...]:
    """Doubts to which no other limb matters, in the form of those to which others do."""

    def one(doubt: Callable[[Draft, Found], str]) -> _Doubt:
        return lambda draft, each, _: doubt(draft, each)

    return tuple(map(one, doubts))


# Doubts that a leg bends at these joints, and not that it is a leg.
_OF_JOINTS = (other_bend, ankle_as_knee, later_start, goes_on, middle_bone, reaches_further)
# What is asked of every limb, of those whose three joints a naming scheme knows, and of those that shape or
# single words tell: each gives what speaks against a limb, in words, or "". What is plainer comes first.
_OF_ANY = (
    *_alone(_other_limb, _trunk_aside, _other_side, turned_in_file, _against_the_tree, folded),
    *_alone(_moves_no_vertex, _has_a_rival, *rival_joints.OF_ANY),
    miscounted,
    no_trunk,
    no_body,
    beside_things,
)
_LAST = (unlike_twin, joint_more, ends_in_a_device)
_OF_NAMES = (
    *_alone(_unnamed_between),
    called_end,
    *_alone(_counted, one_of_several, split_bone, *rival_joints.OF_NAMES),
    named_twice,
    arm_below_a_lying_trunk,
    arm_as_front_leg,
    *_alone(arm_called_front),
)
_OF_SHAPES = (
    _beyond_the_known,
    beside_known_legs,
    upside_down,
    at_the_top,
    arm_as_leg,
    arm_as_front_leg,
    arm_below_a_lying_trunk,
    *_alone(arm_called_front),
    *_alone(_named_to_bend_elsewhere, _misnamed, other_bend, no_hand, split_bone, only_things, of_machine),
    *_alone(
        further_part,
        clavicle_part,
        ankle_as_knee,
        skirt,
        hangs_as_cloth,
        rival,
        hangs_as_cable,
        later_start,
        goes_on,
        middle_bone,
        reaches_further,
        other_end,
        *rival_joints.OF_SHAPES,
    ),
    *_alone(
        points_ahead,
        arm_on_the_ground,
        may_be_wings,
        start_beside,
        out_of_order,
        end_elsewhere,
        loose_joints,
        small_part,
        may_be_a_thing,
    ),
    called_end,
    lower_elsewhere,
)
