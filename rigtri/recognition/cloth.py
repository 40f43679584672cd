"""Limbs by shape that may be worn, or hang as cloth and cables do: skirts, the strips of a ghost, hoses."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from rigtri.recognition.body_shape import SIMILAR, lowest
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.facing import feet_ahead
from rigtri.recognition.found_limb import Found
from rigtri.recognition.limb_words import NO_WORDS
from rigtri.recognition.no_body import by_words, is_named
from rigtri.recognition.shape_doubts import CLEAR, GOES_ON

# Pairs as long as each other up to this part are alike.
_SIMILAR = 0.15
# What a foot moves goes so far ahead, of how far a long foot does.
_FOOT = 0.35
# Bones of a cable are as long as each other up to this part, and go down by this (a cosine, 25°).
_EVEN, _DOWN = 0.05, 0.906


def skirt(draft: Draft, each: Found) -> str:
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
        if like < _SIMILAR * mine.size or (other.size > SIMILAR * mine.size and apart < _SIMILAR * mine.size):
            return (
                f"the chain from '{draft.tree.rig.title(other.joints(0)[0])}' is as long: both may be a skirt"
            )
    return ""


def hangs_as_cloth(draft: Draft, each: Found) -> str:
    """Legs of a body with arms that hardly bend, and move no feet: so hang strips of cloth, below a ghost."""
    mine, body, tree = each.pair, draft.shape.body, draft.tree
    if each.kind != "leg" or mine is None or body is None or body.form != "biped" or mine is not body.legs:
        return ""
    if mine.named > 0.0 or len(mine.at) < 3 or body.arms is None:
        return ""
    for start, middle, end in map(mine.joints, (0, 1)):
        upper, lower = tree.at[middle] - tree.at[start], tree.at[end] - tree.at[middle]
        after = [tree.at[k] - tree.at[end] for k in tree.below[end]]
        turned = any(bone.unit.dot(lower.unit) < GOES_ON for bone in after)
        if upper.unit.dot(lower.unit) < CLEAR or turned or len(after) > 1:
            return ""
        if not draft.poses.box_of([end], tree.places):
            return ""  # nothing shows that it has no foot
    if not after and abs(feet_ahead(tree, body, draft.facing, draft.poses)) > _FOOT:
        return ""
    return "it hardly bends and moves no foot, as a strip of cloth does"


def hangs_as_cable(draft: Draft, each: Found) -> str:
    """Arms without names, clavicles or fingers that hang down in line, with bones as long as each other."""
    mine, tree = each.pair, draft.tree
    if each.kind != "arm" or mine is None or mine.named > 0.0 or mine.fingers >= 2 or mine.at[0] > 0:
        return ""
    path = mine.pair.paths[0]
    bones = [tree.at[node] - tree.at[over] for over, node in pairwise(path)]
    longest = max(bone.length for bone in bones)
    even = min(bone.length for bone in bones) > (1.0 - _EVEN) * longest
    straight = all(one.unit.dot(bones[0].unit) > CLEAR for one in bones)
    hangs = all(-bone.unit.dot(draft.up) > _DOWN for bone in bones)
    if not (even and straight and hangs):
        return ""
    return "it hangs down in line, with bones as long as each other, as a cable does"


def beside_known_legs(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """Arms without hands of which names say nothing, of a body whose legs they know: cables of a machine."""
    mine, tree = each.pair, draft.tree
    if each.kind != "arm" or mine is None or mine.fingers >= 2:
        return ""
    bones = {*draft.known_bones.values()}
    own = {*tree.branch(each.joints[0]), *each.before}
    if any(k in bones or draft.words.get(k, NO_WORDS) is not NO_WORDS for k in own):
        return ""
    legs = [k for k in found if k.kind == "leg" and (is_named(draft, k) or by_words(k))]
    return "names know its legs, and say nothing of this" if len(legs) > 1 else ""
