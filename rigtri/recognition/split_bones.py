"""Why joints of a limb may be parts of a bone: of one that was split, or twist joints without a hand."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from rigtri.maths.scalar_vector import Vector
from rigtri.recognition.bone_noise import STRAIGHT
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.found_limb import Found
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_triples import CLAVICLES, IN_LINE, SAME_PLACE, TIE
from rigtri.recognition.limb_words import NO_WORDS, limb_words
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.naming_schemes import PARTS, is_segment, roles_in_name

# Where a twist joint parts a bone that has one, as a part of the bone before.
_PARTED = 0.7
# Parts of one bone are as long as each other up to this part of their length.
_SIMILAR_LENGTH = 0.25
# Bones that are so much like those of a limb, and lead so far, say by themselves where it bends.
_LIKE, _LEADS = 0.25, 3.0 * TIE
# Where both bones of a straight arm have so many parts, two thirds of it are as like an arm.
_MANY = 3
# How Blender numbers the further parts of a bone that was split.
_PART = re.compile(r"(.+)\.\d{3}")
# And how that is written in USD, which has no dots in names.
_NUMBER = re.compile(r"[._]\d{3}")


def split_bone(draft: Draft, each: Found) -> str:
    """A bone that begins at what its name calls a further part of the joint above: ``shoulder.001``.

    Or below a joint of the same name. So programs number what nobody has named (``Bone``, ``Bone.001``), too,
    in one branch and in another.
    """
    tree, names = draft.tree, draft.tree.rig.names
    if _is_counted_on(draft, each):
        return ""
    start, middle, end = each.joints
    piece = _NUMBER.fullmatch(names[middle].removeprefix(names[start]))
    if piece and not tree.rig.is_below(end, middle):
        return f"'{tree.rig.title(middle)}' may be a part of its upper bone, as nothing of it follows there"
    for joint, bone in zip(each.joints, ("upper", "lower"), strict=False):
        part, whole = tree.above[joint], _whole(names[joint])
        if part >= 0 and (_is_twist_of(draft, part, joint) or _is_part(draft, joint)):
            return f"'{tree.rig.title(part)}' may be the first part of its {bone} bone"
        if part >= 0 and names[part] != whole and _is_next_piece(names[joint], names[part]):
            return f"'{tree.rig.title(part)}' may be the first part of its {bone} bone"
        if part < 0 or names[part] not in (names[joint], whole) or not parse_name(whole).plain:
            continue
        parts = (k for k in tree.nodes if k != joint and names[k] != whole == _whole(names[k]))
        if not any(not tree.is_below(k, joint) and not tree.is_below(joint, k) for k in parts):
            return f"'{tree.rig.title(part)}' may be the first part of its {bone} bone"
    return ""


def _is_twist_of(draft: Draft, part: int, joint: int) -> bool:
    """Whether a joint is called a twist joint of the bone that follows, and is no axis of a robot."""
    own, after = (draft.words.get(k, NO_WORDS) for k in (part, joint))
    same = bool(own.levels) and (own.levels, own.kind) == (after.levels, after.kind)
    return same and not own.joint and "twist" in roles_in_name(draft.tree.rig.names[part])


def _is_part(draft: Draft, joint: int) -> bool:
    """Whether a joint is called a part of one of those above it: ``ShoulderPart2`` of ``Shoulder``."""
    names = draft.tree.rig.names
    own = parse_name(names[joint]).plain
    above = [parse_name(names[k]).plain for k in draft.tree.way(-1, joint)[:-1]]
    return any(over and own == over + word for over in above for word in PARTS)


def _is_next_piece(name: str, above: str) -> bool:
    """Whether two joints have the name of one bone but for their numbers: ``thigh.L.01``, ``thigh.L.02``."""
    return parse_name(name).plain == parse_name(above).plain and is_segment(name, above)


def _is_counted_on(draft: Draft, each: Found) -> bool:
    """Whether a limb is a chain that was duplicated, ``Arm.L``, ``Arm.L.001``, ``Arm.L.002``, and bends so.

    Its joints are called as the limb and not as one of its bones, or the last as a hand or foot is; its shape
    by itself has to say the same.
    """
    names = [draft.tree.rig.names[joint] for joint in each.joints]
    counted = names[1:] == [f"{names[0]}.{number:03}" for number in (1, 2)]
    levels = limb_words(names[0]).levels
    counted = counted and bool(levels) and max(levels.values()) < 1.0
    ends = names[1] == f"{names[0]}.001" and _is_hand_or_foot(draft, names[2])
    if not (counted or ends) or each.pair is None:
        return False
    return each.pair.quality > _LIKE and each.pair.lead > _LEADS


def _is_hand_or_foot(draft: Draft, name: str) -> bool:
    """Whether a name is that of a hand or foot, by its words or in the scheme, or language, of the others."""
    scheme = draft.reading.scheme if draft.reading is not None else None
    known = scheme is not None and scheme.bone(scheme.read(parse_name(name)))[0] in ("Hand", "Foot")
    return known or "end" in limb_words(name).levels


def _whole(name: str) -> str:
    """The name of the bone that a joint is a part of."""
    part = _PART.fullmatch(name)
    return part[1] if part else name


def no_hand(draft: Draft, each: Found) -> str:
    """A last joint that parts the lower bone as another leaf parts the upper one, without any below it.

    Or one with nothing but a leaf below, like that which parts the lower bone, after what may be a clavicle.
    """
    tree, (start, middle, end) = draft.tree, each.joints
    bones = tree.at[middle].distance(tree.at[start]), tree.at[end].distance(tree.at[middle])
    if not tree.below[end] and bones[1] <= _PARTED * bones[0] and _is_parted(draft, start, middle):
        return f"'{tree.rig.title(end)}' may be a twist joint, like that of the upper bone"
    mine, below = each.pair, tree.below[end]
    if each.kind != "arm" or mine is None or len(below) != 1 or tree.below[below[0]]:
        return ""
    near = tree.at[mine.joints(0)[0]].distance(tree.at[mine.joints(1)[0]]) < CLAVICLES * sum(bones)
    if near and _is_parted(draft, middle, end):
        return f"'{tree.rig.title(below[0])}' may be a twist joint, and its first bone a clavicle"
    return ""


def clavicle_part(draft: Draft, each: Found) -> str:
    """An arm without names whose upper bone has more parts than the lower one, and is too long by these.

    The first of them may as well be a second bone of the clavicle. So may that of a straight arm where both
    bones have three: two of each may be the arm, with another middle.
    """
    tree, mine = draft.tree, each.pair
    if each.kind != "arm" or mine is None or mine.named > 0.0 or len(mine.at) < 3:
        return ""
    path, at = mine.pair.paths[0], mine.at
    upper, lower = (_parts(tree, path[a : b + 1]) for a, b in pairwise(at))
    start, middle, end = (tree.at[path[k]] for k in at)
    more, length = len(upper) - len(lower), end.distance(middle)
    whole, rest = (middle.distance(place) for place in (start, tree.at[upper[max(0, more)]]))
    too_long = min(rest, length) * max(whole, length) > min(whole, length) * max(rest, length)
    straight = (middle - start).unit.dot((end - middle).unit) > IN_LINE
    if too_long or (straight and more == 0 and len(upper) >= _MANY):
        later = tree.rig.title(upper[max(1, more)])
        return f"'{later}' in its upper bone may be where it begins, after a clavicle of two bones"
    return ""


def _parts(tree: Tree, bone: Sequence[int]) -> list[int]:
    """The joints at which the parts of a bone begin, from its start on: those apart from the one before."""
    least, found = SAME_PLACE * tree.at[bone[-1]].distance(tree.at[bone[0]]), [bone[0]]
    for node in bone[1:-1]:
        if min(tree.at[node].distance(tree.at[k]) for k in (found[-1], bone[-1])) > least:
            found.append(node)
    return found


def further_part(draft: Draft, each: Found) -> str:
    """An arm that ends in nothing, where its upper bone has more parts than its lower one, or goes on above.

    Then its last joint may be one of those parts, and its hand is missing; not if it is called a hand.
    """
    tree, (start, middle, end) = draft.tree, each.joints
    if draft.words.get(end, NO_WORDS).levels == {"end": 1.0}:
        return ""
    if each.kind != "arm" or tree.below[end] or not tree.is_below(end, start):
        return ""
    upper, lower = len(tree.way(start, middle)) - 1, len(tree.way(middle, end)) - 1
    above, size = tree.above[start], tree.at[middle].distance(tree.at[start]) / max(upper, 1)
    before = tree.at[start] - tree.at[above] if above >= 0 else Vector()
    in_line = before.unit.dot((tree.at[middle] - tree.at[start]).unit) > STRAIGHT
    goes_on = upper > 1 and in_line and abs(before.length - size) < _SIMILAR_LENGTH * size
    goes_on = goes_on and not _at_the_trunk(draft, each)
    if upper > lower or goes_on:
        return f"'{tree.rig.title(end)}' may be a twist joint, as the upper bone has more of them"
    return ""


def _at_the_trunk(draft: Draft, each: Found) -> bool:
    """Whether the joint before a limb begins as near to the one across as clavicles do."""
    tree, mine = draft.tree, each.pair
    if mine is None or mine.at[0] < 1:
        return False
    (start, _, end), (one, other) = mine.joints(0), (path[mine.at[0] - 1] for path in mine.pair.paths)
    return tree.at[one].distance(tree.at[other]) < CLAVICLES * tree.at[end].distance(tree.at[start])


def _is_parted(draft: Draft, start: int, end: int) -> bool:
    """Whether a leaf beside ``end`` stands on the bone that goes there."""
    tree = draft.tree
    bone = tree.at[end] - tree.at[start]
    ways = (tree.at[k] - tree.at[start] for k in tree.below[start] if k != end and not tree.below[k])
    return any(way.unit.dot(bone.unit) > STRAIGHT and way.length < bone.length for way in ways)
