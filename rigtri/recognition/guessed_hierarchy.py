"""Why a limb may be another one where the file does not say which joint follows which."""

from __future__ import annotations

from collections.abc import Sequence

from rigtri.recognition.arms_legs import Found
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.limb_words import NO_WORDS
from rigtri.recognition.naming_schemes import parse_name, roles_in_name

# What is so long a part of an upper bone, and further beside it than this part of its own length, may be
# another upper bone; what is nearer corrects the shape or twists.
_LONG, _BESIDE = 0.3, 0.3


def lost_third(draft: Draft, each: Found) -> str:
    """A limb of two joints of which a third may have been taken for another's, or for a part of its bone."""
    rig = draft.tree.rig
    parts = [node for node in draft.segments if rig.is_below(node, each.joints[-1])]
    if len(parts) > 1:
        return f"'{rig.title(min(parts))}' and others follow, which may be its bones and no parts of one"
    named = draft.reading is not None and each.joints in draft.reading.limbs.values()
    guessed = draft.tree.is_own and not named
    return "no third joint follows, and the file has no hierarchy" if guessed else ""


def named_twice(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """A limb by names whose joints are not below each other, where another is called as its start is."""
    rig, (start, middle, end) = draft.tree.rig, each.joints
    own, side = draft.words.get(start, NO_WORDS), parse_name(rig.names[start]).side
    if own.levels != {"upper": 1.0} or (rig.is_below(middle, start) and rig.is_below(end, middle)):
        return ""
    taken = {joint for limb in found for joint in limb.joints}
    for node in (k for k in draft.tree.nodes if k not in taken and not roles_in_name(rig.names[k])):
        words = draft.words.get(node, NO_WORDS)
        alike = (words.levels, words.kind, words.place) == (own.levels, own.kind, own.place)
        if alike and parse_name(rig.names[node]).side == side:
            return f"'{rig.title(node)}' may be its start as well as '{rig.title(start)}'"
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
