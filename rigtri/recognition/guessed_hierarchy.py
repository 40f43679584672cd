"""Why a limb may be another one where the file does not say which joint follows which."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import inf

from rigtri.recognition.arms_legs import FACES
from rigtri.recognition.character_draft import Draft, once
from rigtri.recognition.facing import BY_LEGS
from rigtri.recognition.found_limb import Found
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_ends import counted_next
from rigtri.recognition.limb_pairs import Limbs
from rigtri.recognition.limb_words import NO_WORDS, in_order, other_words
from rigtri.recognition.name_parsing import numbers_in, parse_name
from rigtri.recognition.names_of_several import alike
from rigtri.recognition.naming_schemes import roles_in_name

# What is so long a part of an upper bone, and further beside it than this part of its own length, may be
# another upper bone; what is nearer corrects the shape or twists.
_LONG, _BESIDE = 0.3, 0.3
# A joint further before the start of a limb than this part of it is an upper bone rather than a clavicle.
_BEFORE = 0.5
# The role of joints beside those of a limb.
_HELPS = frozenset(["helper"])
# Further pairs that are so long a part of the arms may be limbs as well.
_RIVAL = 0.2
# Names of all three joints, one of them vague, say so far which follow which.
_CALLED = 0.8
# It stands so far beside the middle, as a part of how far what follows does.
_ASIDE = 0.2
# A limb that ends nearer to where it hangs than this part of the way to another of its joints is turned
# round, as is a leg whose lower bone goes up by this (a cosine): no elbow and no knee bends so far.
_BACK, _UP_AGAIN = 0.5, 0.5
# What goes on with a bone does so within this (a cosine, 37°).
_ALONG = 0.8
# Legs down to an ankle and feet on from there, as cosines with up (37°, and feet on high heels).
_DOWN, _LEVEL = 0.8, 0.6
# So many joints that stand alone, so far apart (of the longest limb), may be the bones of one; what hangs at
# one of them reaches less far than this part of the way to the next.
_ALONE, _APART, _SHORT = 3, 0.5, 0.7
# What stands less far from the plane between both sides, as a part of a limb, is of the trunk or a tail.
_MIDDLE = 0.02
# What stands lower than a leg by so large a part of it may be its foot: heels and noise are less.
_LOWER = 0.1
# A finger is at most so long a part of a whole body with its arms spread.
_FINGER = 0.1


def lost_third(draft: Draft, each: Found, found: Sequence[Found] = ()) -> str:
    """A limb of two joints of which a third may have been taken for another's, or for a part of its bone."""
    rig = draft.tree.rig
    parts = [node for node in draft.segments if rig.is_below(node, each.joints[-1])]
    if len(parts) > 1:
        return f"'{rig.title(min(parts))}' and others follow, which may be its bones and no parts of one"
    words = [draft.words.get(joint, NO_WORDS) for joint in each.joints]
    if words[-1].levels == {"upper": 1.0}:
        return f"'{rig.title(each.joints[-1])}' is called as its start is"
    first = in_order(words)[0].keys()
    if first in ({"before"}, {"end"}, {"after"}):
        other = "what leads to a limb" if first == {"before"} else "the end of a limb"
        return f"'{rig.title(each.joints[0])}' is called as {other} is"
    if other := _called_so(draft, each, found):
        return other
    named = draft.reading is not None and each.joints in draft.reading.limbs.values()
    guessed = draft.tree.is_own and not named
    return "no third joint follows, and the file has no hierarchy" if guessed else ""


def _called_so(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """That a joint of no limb is called as a bone of one, on the side of a limb of two joints."""
    names = draft.tree.rig.names
    # Sides in other languages are none here: then joints of either side count.
    sides = {parse_name(names[k]).side for k in each.joints} - {""} or {""}
    place = draft.words.get(each.joints[0], NO_WORDS).place
    taken = {joint for limb in found for joint in (*limb.joints, *limb.before)}
    for node in (k for k in draft.tree.nodes if k not in taken and parse_name(names[k]).side in sides):
        words = draft.words.get(node, NO_WORDS)
        bone = words.levels.keys() & {"upper", "lower", "end"} and words.kind in ("", each.kind)
        bone = bone and (not place or words.place in ("", place))
        if bone and not roles_in_name(names[node]) and not draft.tree.is_below(node, each.joints[-1]):
            return f"'{draft.tree.rig.title(node)}' is called as a joint of it"
    return ""


def start_beside(draft: Draft, each: Found) -> str:
    """A limb of the shape beside whose start another joint stands alone, at the distance of a bone."""
    tree, (start, middle, _) = draft.tree, each.joints
    if not tree.is_own:
        return ""
    upper = tree.at[middle] - tree.at[start]
    for node in tree.below[start]:
        way = tree.at[node] - tree.at[start]
        if tree.is_below(middle, node) or tree.below[node] or way.length < _LONG * upper.length:
            continue
        beside = (way - upper.unit * way.dot(upper.unit)).length > _BESIDE * way.length
        if beside or way.dot(upper) < 0.0:
            return f"the file has no hierarchy, and it may start at '{tree.rig.title(node)}'"
    return ""


def out_of_order(draft: Draft, each: Found) -> str:
    """A limb of the shape whose bones the file may parent to one another in another order, or not at all.

    Exporters parent upper arm, forearm and hand to the chest: what follows in the file is a finger.
    """
    mine = each.pair
    far = mine is not None and each.kind == "leg" and mine.at[0] > 1  # a leg hangs at the hips
    if mine is not None and mine.named < _CALLED and draft.tree.is_own and (far or not _is_plain(draft)):
        return "the file has no hierarchy, and names do not say which joint follows which"
    if mine is None or mine.named > 0.0 or mine.pair.above < 0:
        return _called_upper(draft, each)
    return (
        _called_upper(draft, each)
        or _loose_before(draft, each, mine)
        or _loose_within(draft, each)
        or _turned_round(draft, each, mine)
        or _stands_on(draft, each)
    )


def _is_plain(draft: Draft) -> bool:
    """Whether a body without names is upright, with one pair of legs, one of arms, and no other such pair.

    Then nearest joints follow one another; beside further limbs, or on four legs, others may be nearer.
    """
    body, tree = draft.shape.body, draft.tree
    if draft.reading is not None or body is None or body.form != "biped" or not body.legs or not body.arms:
        return False
    mine = {k for pair in (body.legs, body.arms) for path in pair.pair.paths for k in tree.branch(path[0])}
    others = [each.size for each in draft.shape.limbs if mine.isdisjoint(each.pair.nodes)]
    if draft.shape.plane is not None:  # a wing need not be a limb that bends
        others += [abs(draft.shape.plane.side_of(tree.at[k])) for k in tree.nodes if k not in mine]
    return max(others, default=0.0) < _RIVAL * body.arms.size


def _called_upper(draft: Draft, each: Found) -> str:
    """A limb by single words below whose start another joint is called as its upper bone.

    Or one with a joint that corrects by its name, where another has the words of the bone.
    """
    words, names, (start, middle, _) = draft.words, draft.tree.rig.names, each.joints
    if words.get(start, NO_WORDS).levels.get("upper", 0.0) < 1.0:
        for node in (k for k in draft.tree.below[start] if k != middle and not roles_in_name(names[k])):
            if words.get(node, NO_WORDS).levels == {"upper": 1.0}:
                return f"'{draft.tree.rig.title(node)}' is called as its upper bone"
    for joint in (k for k in each.joints if not _HELPS.isdisjoint(roles_in_name(names[k]))):
        own, side = words.get(joint, NO_WORDS), parse_name(names[joint]).side
        for node in (k for k in draft.tree.nodes if k not in each.joints and not roles_in_name(names[k])):
            if alike(own, words.get(node, NO_WORDS)) and own.levels and side == parse_name(names[node]).side:
                return (
                    f"'{draft.tree.rig.title(joint)}' is called as what helps '{draft.tree.rig.title(node)}'"
                )
    return ""


def _loose_before(draft: Draft, each: Found, mine: Limbs) -> str:
    """Bones on the way to a limb that stand beside it in the file, with little or nothing below them."""
    tree = draft.tree
    path = next((k for k in mine.pair.paths if each.joints[0] in k), mine.pair.paths[0])
    above, top, plane = mine.pair.above, tree.at[path[0]], draft.shape.plane
    if plane is None:
        return ""
    for node in (k for k in tree.below[above] if k not in mine.pair.nodes):
        if plane.side_of(tree.at[node]) / (plane.side_of(top) or inf) < _ASIDE:
            continue  # of the trunk, or of the other side
        way, on = tree.at[node] - tree.at[above], top - tree.at[node]
        if way.dot(on) <= 0.0 or on.length < max(_BEFORE * mine.size, tree.reach[node]):
            continue
        if _may_be_bone(draft, node):
            return f"'{tree.rig.title(node)}' stands before it and is not above it: it may be its upper bone"
    return ""


def _loose_within(draft: Draft, each: Found) -> str:
    """A leg that goes on level after bones that stand alone along its upper one: its knee is an ankle."""
    tree, (start, middle, end) = draft.tree, each.joints
    upper, lower = tree.at[middle] - tree.at[start], tree.at[end] - tree.at[middle]
    falls, level = -upper.unit.dot(draft.up) > _DOWN, abs(lower.unit.dot(draft.up)) < _LEVEL
    if each.kind != "leg" or not (falls and level):
        return ""
    for node in (k for k in tree.below[start] if not tree.below[k] and draft.poses.moves_points(k)):
        if _LONG < (tree.at[node] - tree.at[start]).dot(upper) / upper.dot(upper) < 1.0:
            return f"'{tree.rig.title(node)}' may be its knee, and its knee an ankle"
    return ""


def _turned_round(draft: Draft, each: Found, mine: Limbs) -> str:
    """A limb that ends near where it hangs, or a leg that goes up again: its hand is above its arm."""
    tree = draft.tree
    *others, end = (tree.at[k].distance(tree.at[mine.pair.above]) for k in each.joints)
    lower = tree.at[each.joints[2]] - tree.at[each.joints[1]]
    if end < _BACK * max(others) or (each.kind == "leg" and lower.unit.dot(draft.up) > _UP_AGAIN):
        return "it comes back to where it hangs, so it may be parented the wrong way round"
    return ""


def _stands_on(draft: Draft, each: Found) -> str:
    """A limb whose end the file has elsewhere, beside another joint that stands on beyond it."""
    tree, (_, middle, end) = draft.tree, each.joints
    if draft.tree.rig.is_below(end, middle):
        return ""
    lower = tree.at[end] - tree.at[middle]
    for node in tree.below[int(tree.rig.parents[end])] if tree.rig.parents[end] in tree.below else ():
        way = tree.at[node] - tree.at[end]
        if way.length > _LONG * lower.length and way.unit.dot(lower.unit) > _ALONG:
            return f"'{tree.rig.title(node)}' stands beyond its end and may be that"
    return ""


def called_end(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """A limb by names whose end is not called as an end, where a joint on its side is that is of no limb.

    Of joints that hang side by side a shield is nearer to the elbow than the wrist is, and toes may be nearer
    to the knee than a foot with a name of its own.
    """
    tree, end, names = draft.tree, each.joints[2], draft.tree.rig.names
    own = [draft.words.get(joint, NO_WORDS) for joint in each.joints]
    if not own[1].levels or "end" in own[2].levels:
        return ""
    if tree.is_own and own[2].levels.keys() == {"after"}:
        return f"the file has no hierarchy, and {_title(draft, end)} is called as what follows an end is"
    taken, key = {joint for limb in found for joint in limb.joints}, other_words(names[each.joints[1]])
    for node in (k for k in tree.nodes if k not in taken and not tree.is_below(k, end)):
        words, side = draft.words.get(node, NO_WORDS), parse_name(names[node]).side
        is_end = words.levels == {"end": 1.0} and words.kind in ("", each.kind)
        same = (side, words.place, other_words(names[node])) == (each.side, own[1].place, key)
        if is_end and same and not roles_in_name(names[node]):
            return f"{_title(draft, node)} is called as its end is"
    return ""


def end_elsewhere(draft: Draft, each: Found) -> str:
    """A limb of the shape whose end the file parents elsewhere, where another joint stands alone along it.

    So stands a knee that hangs at the hips as its foot does, beside what helps it below the thigh.
    """
    mine, tree, (start, middle, end) = each.pair, draft.tree, each.joints
    over = int(tree.rig.parents[end])
    if mine is None or mine.named > 0.0 or tree.is_below(end, middle) or over not in tree.below:
        return ""
    for node in (k for k in tree.below[over] if k != end and not tree.is_below(start, k)):
        for one, other in ((start, middle), (middle, end)):
            bone, way = tree.at[other] - tree.at[one], tree.at[node] - tree.at[one]
            along = min(max(way.dot(bone) / (bone.dot(bone) or inf), 0.0), 1.0)
            if (way - bone * along).length < _BESIDE * bone.length and _may_be_bone(draft, node):
                return f"{_title(draft, node)} stands alone along it and may be its middle"
    return ""


def loose_joints(draft: Draft, each: Found) -> str:
    """A limb of the shape in a body of which joints stand alone, as far apart as the bones of a limb are.

    So hang the joints of a leg that are all children of the hips: what stands there as a limb is a part of
    one, or another limb than it seems.
    """
    return "" if each.pair is None or each.pair.named > 0.0 else _bones_alone(draft)


@once
def _bones_alone(draft: Draft) -> str:
    """Joints of a body that stand alone beside each other, in words."""
    body, tree, plane = draft.shape.body, draft.tree, draft.shape.plane
    if body is None or plane is None:
        return ""
    pairs = [limbs for limbs in (body.legs, body.arms) if limbs is not None]
    size = max(limbs.size for limbs in pairs)
    # Along its own bones a limb has pistons; a group that stands where the hips do is no bone.
    own = {k for limbs in pairs for way in (0, 1) for k in limbs.joints(way) if tree.bone[k] > 0.01 * size}
    hold = (nodes for over, nodes in tree.below.items() if over >= 0 and over not in own)
    for below in (nodes for nodes in hold if len(nodes) >= _ALONE):
        for way in (1.0, -1.0):
            aside = [k for k in below if way * plane.side_of(tree.at[k]) > _MIDDLE * size]
            aside = [k for k in aside if _may_be_bone(draft, k)]
            alone = [k for k in aside if _stands_alone(tree, k, aside)]
            far = max((tree.at[a].distance(tree.at[b]) for a in alone for b in alone), default=0.0)
            if len(alone) >= _ALONE and far > _APART * size:
                return f"{_title(draft, alone[0])} and others stand alone, and may be the bones of a limb"
    return ""


def _may_be_bone(draft: Draft, node: int) -> bool:
    """Whether a joint moves points, or nothing shows which ones do."""
    return not draft.poses.has_weights or draft.poses.moves_points(node)


def _stands_alone(tree: Tree, node: int, others: Sequence[int]) -> bool:
    """Whether what hangs at a joint reaches less far than to the next of those beside it."""
    apart = (tree.at[k].distance(tree.at[node]) for k in others if k != node)
    return tree.reach[node] < _SHORT * min(apart, default=0.0)


def lower_elsewhere(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """A leg of the shape that ends above a joint of its side that belongs to no limb and moves points.

    So hang feet at the root, and shins with them: what is left looks like a leg, and ends at its knee, or at
    a twist joint of the shin.
    """
    mine, tree, plane, up = each.pair, draft.tree, draft.shape.plane, draft.up
    if each.kind != "leg" or mine is None or mine.named > 0.0 or plane is None:
        return ""
    own, *others = ({k for joint in one.joints for k in tree.branch(joint)} for one in (each, *found))
    low = min(tree.heights(own, up)) - _LOWER * mine.size
    ours, limbs = plane.side_of(tree.at[each.joints[0]]), frozenset[int]().union(*others)
    for node, high in zip(tree.nodes, tree.heights(tree.nodes, up), strict=True):
        if node in limbs or not high < low:
            continue
        aside = plane.side_of(tree.at[node])
        if aside * ours > 0.0 and abs(aside) > _MIDDLE * mine.size and _may_be_bone(draft, node):
            return f"{_title(draft, node)} stands lower and hangs elsewhere: it may be its foot or its shin"
    return ""


def miscounted(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """A limb whose names count down as its twin's do, or go on with the count of a joint that is elsewhere.

    Of one arm alone names may count down where the other's count up.
    """
    names, step = draft.tree.rig.names, _step(draft, each)
    if not step:
        node = counted_next(draft.tree, each.joints)
        return (
            f"its joints are counted on to {_title(draft, node)}, which hangs elsewhere" if node >= 0 else ""
        )
    twins = (k for k in found if k is not each and k.kind == each.kind)
    if -1 in step:
        down = any(-1 in _step(draft, twin) for twin in twins)
        return (
            f"its names count down, so {_title(draft, each.joints[-1])} may be where it begins"
            if down
            else ""
        )
    first, last = each.joints[0], each.joints[-1]
    key = parse_name(names[last])
    before, after = (
        tuple(a + way * b for a, b in zip(numbers_in(names[k]), step, strict=True))
        for k, way in ((first, -1), (last, 1))
    )
    for node in draft.tree.nodes:
        name = parse_name(names[node])
        if (name.plain, name.side) != (key.plain, key.side) or roles_in_name(names[node]):
            continue
        at = numbers_in(names[node])
        goes_on = at == after and not draft.tree.is_below(node, last)
        if goes_on or (at == before and not draft.tree.is_below(first, node)):
            return f"its joints are counted with {_title(draft, node)}, which hangs elsewhere"
    return ""


def _step(draft: Draft, each: Found) -> list[int]:
    """By how much one of the numbers in the names of a limb, otherwise alike, goes on; [] if none does."""
    names = [draft.tree.rig.names[joint] for joint in each.joints]
    plain = {parse_name(name).plain for name in names}
    if "" in plain or len(plain) > 1 or draft.words.get(each.joints[0], NO_WORDS).kind != each.kind:
        return []
    counts = [numbers_in(name) for name in names]
    if len({len(each) for each in counts}) > 1:
        return []
    steps = [[b - a for a, b in zip(*pair, strict=True)] for pair in pairwise(counts)]
    regular = all(step == steps[0] for step in steps)
    return steps[0] if regular and sorted(map(abs, steps[0])) == [0] * (len(steps[0]) - 1) + [1] else []


def small_part(draft: Draft, each: Found) -> str:
    """A limb of the shape that is hardly as long as a finger of the body: others may be its limbs."""
    mine = each.pair
    if mine is None or mine.named > 0.0 or mine.size > _FINGER * draft.tree.span:
        return ""
    return "it is as small beside the whole as a finger is"


def _title(draft: Draft, node: int) -> str:
    return f"'{draft.tree.rig.title(node)}'"


def turned_in_file(draft: Draft, each: Found) -> str:
    """A limb by its names that the file parents the wrong way round: its first joint below its second."""
    start, middle, end = each.joints
    for over, node in ((start, middle), (middle, end)):
        if draft.tree.rig.is_below(over, node):
            return f"the file parents {_title(draft, over)} to {_title(draft, node)}"
    return ""


def is_told_by_legs(arm: Found) -> bool:
    """Whether first of all legs tell where a body without names looks, and so which arm is the left one."""
    return any(f"{FACES}{words}" in arm.evidence for words in BY_LEGS)
