"""Legs by shape that may be worn, or hang as cloth does: skirts, and the strips of a ghost."""

from __future__ import annotations

from rigtri.recognition.body_shape import SIMILAR, lowest
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.facing import feet_ahead
from rigtri.recognition.found_limb import Found
from rigtri.recognition.shape_doubts import CLEAR, GOES_ON

# Pairs as long as each other up to this part are alike.
_SIMILAR = 0.15
# What a foot moves goes so far ahead, of how far a long foot does.
_FOOT = 0.35


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
