"""The trunk: hips, spine, neck, head and tail."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from rigtri.maths.scalar_vector import Vector
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.found_limb import Found
from rigtri.recognition.inanimate import has_hips_or_spine
from rigtri.recognition.layout import MAP, NAMES
from rigtri.recognition.limb_words import NO_WORDS
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.naming_schemes import roles_in_name
from rigtri.recognition.standing import stand_by_twins

_SPINE = ("spine", "chest", "upperChest")
# A tail has so many joints, and is so long a part of the legs.
_TAIL_JOINTS, _TAIL = 3, 0.3
# From neck to head there are at most so many joints; of a longer chain, an elephant's trunk, none is sure.
_UP_TO_HEAD, _GOES_ON = 5, 0.6
# Ears and eyes go aside from a head by more than this (a sine).
_ASIDE = 0.1
# Of the trunk's bones, so many names make one; a crane may have a waist, too.
_ENOUGH = 3
# The last bone before a head is so long a part of the one above it; one to a face or a helmet is not.
_LEAST_EVEN, _MOST_EVEN = 0.7, 1.5
# What is of a head, or worn on one, and no head itself.
_ON_HEADS = frozenset(["face", "attachment", "ear", "feeler"])
_OF_FACES = frozenset(
    ["face", "brow", "brows", "cheek", "lip", "lips", "nostril", "tongue", "teeth", "whisker"]
)
# A head moves what is at least so large a part of what the neck moves; a jaw does not of what the head moves.
_JAW = 0.5
# How sure a head is of which nothing but its name is of a body: easels and hammers have one, too.
_ALONE = 0.6
_NOT_BODY = {"twist", "control", "attachment", "helper", "ear", "wing", "tail"}


def lay_trunk(draft: Draft, found: Sequence[Found]) -> None:
    """Find what stands between and beyond the limbs."""
    if not found:
        _named_trunk(draft)
        if any(chain.kind == "spine" for chain in draft.chains) and not draft.certain:
            stand_by_twins(draft)
            _head(draft, (), has_arms=False)
        _tail(draft, ())
        return
    legs, arms = pairs_of_limbs(draft, found)
    draft.hips, draft.chest = _hips(draft, legs, arms), _parent_of_limbs(draft, arms)
    _spine(draft, legs if 0 < len(legs) < 3 else found)
    _head(draft, arms or legs, has_arms=bool(arms))
    _tail(draft, legs)


def pairs_of_limbs(draft: Draft, found: Sequence[Found]) -> tuple[list[Found], list[Found]]:
    """The legs and the arms; of a quadruped the hind and the front legs."""
    body = draft.shape.body
    draft.four = body is not None and body.form == "quadruped" and all(k.kind == "leg" for k in found)
    if not draft.four or body is None or body.legs is None or body.arms is None:
        return [k for k in found if k.kind == "leg"], [k for k in found if k.kind == "arm"]
    low, high = body.legs, body.arms
    if (high.starts - low.starts).dot(draft.facing) < 0:
        low, high = high, low
    return (
        [k for k in found if low.pair.nodes.intersection(k.joints)],
        [k for k in found if high.pair.nodes.intersection(k.joints)],
    )


def _parent_of_limbs(draft: Draft, limbs: Sequence[Found]) -> int:
    """The lowest joint above all of some limbs, −1 for none."""
    tree = draft.tree
    if not limbs:
        return -1
    over = tree.above[limbs[0].joints[0]]
    for each in limbs[1:]:
        other = tree.above[each.joints[0]]
        over = tree.common(over, other) if over >= 0 and other >= 0 else -1
    if len(limbs) == 1:
        over = tree.above[(*limbs[0].before, *limbs[0].joints)[0]]
    return over


def _hips(draft: Draft, legs: Sequence[Found], arms: Sequence[Found]) -> int:
    tree = draft.tree
    named = draft.known_bones.get("hips", -1)
    low, high = _parent_of_limbs(draft, legs), _parent_of_limbs(draft, arms)
    if len(legs) < (1 if arms else 2) or low < 0:
        return named
    if named >= 0 and (draft.certain or all(tree.is_below(k.joints[0], named) for k in legs)):
        return named
    common = tree.common(low, high) if high >= 0 else low
    # What is a joint of the skeleton alone: a container above it is none.
    return common if common >= 0 and bool(tree.rig.is_joint[common]) else low


def _spine(draft: Draft, found: Sequence[Found]) -> None:
    """found: what it is as sure as: the legs, from which a spine leads to whatever hangs above them."""
    tree, bones = draft.tree, draft.known_bones
    if draft.hips >= 0:
        draft.call("hips", draft.hips)
    if draft.chest < 0 or draft.hips < 0 or not tree.is_below(draft.chest, draft.hips):
        _named_trunk(draft)
        return
    joints = tree.way(draft.hips, draft.chest)[1:]
    neck = _neck(draft)
    joints = joints[: joints.index(neck)] if neck in joints else joints
    named = {bone: bones[bone] for bone in _SPINE if bones.get(bone, -1) in joints}
    # A humanoid has its chest above a spine, and no joint of so few is none: names that say otherwise do not
    # say which joint is which.
    in_order = list(named.values()) == sorted(named.values(), key=joints.index)
    whole = len(named) >= min(len(joints), len(_SPINE))
    if draft.certain or ("spine" in named and in_order and whole):
        for bone, node in named.items():
            draft.call(bone, node)
    else:
        for bone, node in zip(_SPINE, [*joints[:2], *joints[2:][-1:]], strict=False):
            draft.call(bone, node)
    if joints:
        sure = min(each.confidence for each in found)
        draft.add_chain("spine", "spine", "", joints, sure, ("from the hips to where the arms begin",))


def _named_trunk(draft: Draft) -> None:
    """Spine, neck and head of a body without limbs, or without one of both pairs, by names alone."""
    tree, bones = draft.tree, draft.known_bones
    for bone in ("hips", *_SPINE):
        if bone in bones:
            draft.call(bone, bones[bone])
    joints = [draft.bones[bone] for bone in _SPINE if bone in draft.bones]
    if not all(tree.is_below(k, over) for over, k in pairwise(joints)):
        joints = []  # numbers may count towards the tail
    if joints and "hips" in draft.bones and tree.is_below(joints[-1], draft.bones["hips"]):
        joints = tree.way(draft.bones["hips"], joints[-1])[1:]  # whatever those between are called
    if joints and len([bone for bone in ("hips", *_SPINE, "neck", "head") if bone in bones]) >= _ENOUGH:
        sure = 0.99 if draft.certain else 0.85
        draft.add_chain("spine", "spine", "", joints, sure, (_whose(draft),))


def _whose(draft: Draft) -> str:
    if draft.certain:
        return MAP
    return f"{NAMES}: {draft.reading.scheme.title}" if draft.reading else "its shape"


def _head(draft: Draft, limbs: Sequence[Found], *, has_arms: bool) -> None:
    """limbs: beyond which neck and head are: arms, the front legs of a quadruped, or else legs."""
    bones = draft.known_bones
    neck, head = (_without_volume(draft, node) for node in (_neck(draft), bones.get("head", -1)))
    sure, why = (0.99 if draft.certain else 0.92), _whose(draft)
    if not (draft.certain or any(each.is_sure for each in limbs) or has_hips_or_spine(draft)):
        sure = _ALONE
    if head >= 0 and not draft.certain:
        head = _last_numbered(draft, head)
        if neck < 0 <= draft.chest and draft.tree.is_below(head, draft.chest):
            neck = _below_head(draft, head)
    if head < 0 or (neck >= 0 and not draft.tree.is_below(head, neck)):
        chain = _beyond(draft, limbs)
        if not chain:
            return
        if chain[-1] == neck and not _is_numbered(draft, neck):
            # What stands at the end and is called a neck is one: a head that moves nothing was left out.
            draft.add_chain("neck", "neck", "", chain, sure, (why,))
            draft.call("neck", chain[0])
            return
        neck, head = (chain[0] if len(chain) > 1 else -1), chain[-1]
        sure, why = 0.8 * min((k.confidence for k in limbs), default=0.5) + 0.1, _beyond_what(draft, has_arms)
        sure = sure if has_arms else min(sure, _ALONE)  # beyond legs may be a turret or a load
        ends = draft.poses.has_weights and not draft.tree.below[head] and not draft.poses.moves_points(head)
        if ends or (draft.tree.below[head] and len(chain) == _UP_TO_HEAD) or _is_small(draft, chain):
            sure = min(sure, _GOES_ON)
        if (len(chain) > 2 and not _is_head(draft, chain)) or _is_below_head(draft, head):
            sure = min(sure, _GOES_ON)
    between = draft.tree.way(neck, head) if neck >= 0 and draft.tree.is_below(head, neck) else [head]
    if len(between) > 1:
        draft.add_chain("neck", "neck", "", between[:-1], sure, (why,))
        draft.call("neck", between[0])
    draft.add_chain("head", "head", "", [head], sure, (why,))
    draft.call("head", head)
    for bone in ("jaw", "leftEye", "rightEye"):
        if bone in bones:
            draft.call(bone, bones[bone])


def _is_below_head(draft: Draft, node: int) -> bool:
    """Whether what shape takes for the head is called as the neck is, or a face hangs at a nose below it.

    OpenPose calls the head ``Nose``.
    """
    tree, names, neck = draft.tree, draft.tree.rig.names, draft.known_bones.get("neck", -1)
    called = parse_name(names[node]).plain if neck >= 0 and tree.below[node] else ""
    if called and called == parse_name(names[neck]).plain and not _is_numbered(draft, node):
        return True
    noses = (k for k in tree.below[node] if "nose" in parse_name(names[k]).words)
    return any(tree.below[k] for k in noses)


def _beyond_what(draft: Draft, has_arms: bool) -> str:
    return f"is beyond the {'legs' if not has_arms else 'front legs' if draft.four else 'arms'}"


def _neck(draft: Draft) -> int:
    """The neck by its name; of a trunk that is numbered throughout (Rigify), the first beyond the arms."""
    tree, neck, chest = draft.tree, draft.known_bones.get("neck", -1), draft.chest
    if (
        min(neck, chest) < 0
        or draft.certain
        or not _is_numbered(draft, neck)
        or not tree.is_below(chest, neck)
    ):
        return neck
    spine = parse_name(tree.rig.names[neck]).plain
    return next((k for k in tree.below[chest] if parse_name(tree.rig.names[k]).plain == spine), -1)


def _without_volume(draft: Draft, node: int) -> int:
    """The joint beside or above a leaf that has its words after one letter: the leaf is a volume of that.

    Source: Second Life, whose collision volumes ``HEAD`` and ``NECK`` hang at ``mHead`` and ``mNeck``.
    """
    tree, names = draft.tree, draft.tree.rig.names
    if node < 0 or draft.certain or tree.below[node] or tree.above[node] < 0:
        return node
    own, over = parse_name(names[node]).kept, tree.above[node]
    words = {k: parse_name(names[k]).kept for k in (over, *tree.below[over])}
    bones = [k for k, kept in words.items() if own and kept[1:] == own and len(kept[0]) == 1]
    return bones[0] if len(bones) == 1 else node


def _below_head(draft: Draft, head: int) -> int:
    """The first joint between the chest and a head that is known by name, whatever it is called; else −1."""
    between = draft.tree.way(draft.chest, head)[1:-1]
    return between[0] if 0 < len(between) < _UP_TO_HEAD else -1


def _is_numbered(draft: Draft, node: int) -> bool:
    """Whether a joint is called as one of the trunk, whatever its number stands for."""
    return roles_in_name(draft.tree.rig.names[node]) == ("trunk",)


def _last_numbered(draft: Draft, head: int) -> int:
    """The head of a trunk that is numbered throughout (Rigify) is its last joint, however many there are."""
    tree, names = draft.tree, draft.tree.rig.names
    spine = parse_name(names[head]).plain
    while _is_numbered(draft, head):
        more = [k for k in tree.below[head] if parse_name(names[k]).plain == spine]
        if len(more) != 1:
            break
        head = more[0]
    return head


def _beyond(draft: Draft, limbs: Sequence[Found]) -> list[int]:
    """Neck and head by shape: the middle branch that goes farthest beyond the arms."""
    tree, taken = draft.tree, {joint for each in limbs for joint in (*each.before, *each.joints)}
    taken |= set(draft.taken)
    over = draft.chest if draft.chest >= 0 else draft.hips
    if over < 0 or not limbs:
        return []
    starts = Vector()
    for each in limbs:
        starts = starts + tree.at[each.joints[0]] * (1.0 / len(limbs))
    size = max(tree.reach[k.joints[0]] for k in limbs)
    towards = draft.up + draft.facing if draft.four else draft.up
    best, found = 0.02 * size, -1
    for _ in range(3):
        for child in tree.below[over]:
            if child in taken or any(tree.is_below(k, child) for k in taken):
                continue
            if _NOT_BODY.intersection(draft.poses.roles_of(child)) or _is_of_limb(draft, child):
                continue
            # A wing goes as high, but aside.
            away = [tree.at[k] - starts for k in tree.branch(child)]
            far = max(k.dot(towards) - 2.0 * abs(k.dot(draft.left)) for k in away)
            if far > best:
                best, found = far, child
        if found >= 0 or over == draft.hips or tree.above[over] < 0:
            break
        over = tree.above[over]
    return _up_to_head(draft, found) if found >= 0 else []


def _is_of_limb(draft: Draft, node: int) -> bool:
    """Whether a name says arm or leg: one arm in the middle of a machine is no neck."""
    words = draft.words.get(node, NO_WORDS)
    return words.kind != "" and not words.trunk


def _up_to_head(draft: Draft, first: int) -> list[int]:
    """From the neck to the head: up to where the face begins, or the last joint that moves points."""
    tree, chain = draft.tree, [first]
    while len(below := tree.below[chain[-1]]) == 1 and len(chain) < _UP_TO_HEAD:
        if _is_on_head(draft, below[0]) or _is_of_limb(draft, below[0]):
            return chain
        chain.append(below[0])
    if len(chain) > 1 and not tree.below[chain[-1]] and _is_end(draft, chain[-1]):
        chain.pop()
    # Of two joints neither need be a neck: which is the head is left open.
    small = len(chain) > 2 and _is_small(draft, chain) and not _carries_pair(draft, chain[-1], _ASIDE)
    return chain[:-1] if small else chain


def _carries_pair(draft: Draft, node: int, by: float) -> bool:
    """Whether joints go to both sides of one, as ears or eyes do from a head and nothing does from a jaw.

    by: how far at least, a sine.
    """
    tree = draft.tree
    ways = [tree.at[k] - tree.at[node] for k in tree.below[node]]
    aside = [way.dot(draft.left) / (way.length or 1.0) for way in ways]
    return min(aside, default=0.0) < -by and max(aside, default=0.0) > by


def _is_on_head(draft: Draft, node: int) -> bool:
    """Whether a joint is called as what heads have or wear: a face, a hat, an ear."""
    name = draft.tree.rig.names[node]
    return bool(_ON_HEADS.intersection(roles_in_name(name)) or _OF_FACES.intersection(parse_name(name).words))


def _is_head(draft: Draft, chain: Sequence[int]) -> bool:
    """Whether the last of three joints or more is the head, not a jaw, a face or a hat of one before.

    Names of what it carries say so; or eyes or ears in a pair do, where no face may have these.
    """
    tree = draft.tree
    below = tree.below[chain[-1]]
    if any(_is_on_head(draft, node) for node in below):
        return True
    last, before = (tree.bone[node] for node in (chain[-1], chain[-2]))
    return _LEAST_EVEN * before < last < _MOST_EVEN * before and _carries_pair(draft, chain[-1], 0.0)


def _is_small(draft: Draft, chain: Sequence[int]) -> bool:
    """Whether the last of joints moves far less than the one above, as a jaw does that is all a head has."""
    if len(chain) < 2:
        return False
    size = []
    for node in chain[-2:]:
        ends = [Vector(*end) for end in draft.poses.box_of([node], draft.tree.places)]
        size.append(max([end.distance(ends[0]) for end in ends], default=0.0))
    return 0.0 < size[1] < _JAW * size[0]


def _is_end(draft: Draft, node: int) -> bool:
    if "end" in roles_in_name(draft.tree.rig.names[node]):
        return True
    return len(draft.tree.way(draft.chest, node)) > 3 and not draft.poses.moves_points(node)


def _tail(draft: Draft, legs: Sequence[Found]) -> None:
    """A chain at the hips that goes back and is no leg; by its shape no surer than the legs beside it."""
    tree = draft.tree
    named = [k for k in tree.nodes if "tail" in roles_in_name(tree.rig.names[k])]
    if named:
        chain = [k for k in tree.paths[named[0]] if k in named]
        draft.add_chain("tail", "tail", "", chain, 0.92, (NAMES,))
        return
    if draft.hips < 0 or not legs:
        return
    size = max(tree.reach[k.joints[0]] for k in legs)
    taken = draft.taken | {joint for each in legs for joint in each.joints}
    for child in tree.below[draft.hips]:
        path = tree.paths[child]
        if child in taken or len(path) < _TAIL_JOINTS or any(tree.is_below(k, child) for k in taken):
            continue
        if draft.chest >= 0 and tree.is_below(draft.chest, child):
            continue
        along = tree.at[path[-1]] - tree.at[draft.hips]
        if (
            along.unit.dot(-draft.facing) > 0.3
            and abs(along.dot(draft.left)) < 0.2 * along.length
            and tree.reach[child] > _TAIL * size
            and parse_name(tree.rig.names[child]).side == ""
        ):
            words = ("a chain from the hips backwards, in the middle",)
            sure = min(0.6 + 0.2 * draft.four, max(leg.confidence for leg in legs))
            draft.add_chain("tail", "tail", "", path, sure, words)
            return
