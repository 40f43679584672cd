"""Why arms may be front legs: they end as low as the legs do."""

from __future__ import annotations

from collections.abc import Sequence

from rigtri.recognition.arms_legs import AGREED
from rigtri.recognition.body_shape import lowest
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.found_limb import Found
from rigtri.recognition.limb_words import NO_WORDS
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.shape_doubts import ENDS_LOW

# A trunk lies that goes up by less than this from the hips to the shoulders (a cosine, 30°).
_LIES = 0.5


def arm_as_front_leg(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """Arms on the ground, below another pair of arms: names of bones are those of front legs, too."""
    body, mine = draft.shape.body, each.pair
    if each.kind != "arm" or body is None or body.legs is None or mine is body.legs:
        return ""
    at, up = draft.tree.at, draft.up
    first = mine.starts if mine is not None else at[each.joints[0]]
    # Of a centaur the upper pair are the arms, and strands of hair below what is called a head are not.
    over = any(
        k.kind == "arm"
        and k.pair is not mine
        and at[k.joints[0]].dot(up) > first.dot(up)
        and not _hangs_from_a_head(draft, k)
        for k in found
    )
    low = lowest(draft.tree, mine, up) if mine is not None else min(at[k].dot(up) for k in each.joints)
    high = abs(low - lowest(draft.tree, body.legs, up))
    return "it ends as low as the legs, below other arms" if over and high < ENDS_LOW * body.legs.size else ""


def _hangs_from_a_head(draft: Draft, arm: Found) -> bool:
    """Whether a joint above an arm is called head."""
    names, above = draft.tree.rig.names, draft.tree.above
    node = above[arm.joints[0]]
    while node >= 0 and "head" not in parse_name(names[node]).words:
        node = above[node]
    return node >= 0


def arm_below_a_lying_trunk(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """Arms by names alone that end as low as legs, below a trunk that lies, and have no thumb.

    Tools for people give front legs of animals the names of arms, and a file without a hierarchy no shape.
    """
    legs = [k for k in found if k.kind == "leg" and k.side and len(k.joints) == 3]
    if each.kind != "arm" or AGREED in each.evidence or not legs:
        return ""
    body = draft.shape.body
    if body is not None and body.arms is not None and body.arms.thumb:
        return ""  # hands, of who is on all fours
    at, up = draft.tree.at, draft.up
    for leg in legs:
        (start, middle, end), first = leg.joints, at[each.joints[0]]
        size = at[middle].distance(at[start]) + at[end].distance(at[middle])
        rises = (first - at[start]).unit.dot(up) > _LIES
        if rises or at[each.joints[2]].dot(up) > at[end].dot(up) + ENDS_LOW * size:
            return ""
    return "it ends as low as the legs, below a trunk that lies, so it may be a front leg"


def arm_called_front(draft: Draft, each: Found) -> str:
    """An arm of which a joint is called a front one: people have none behind."""
    words = [draft.words.get(joint, NO_WORDS) for joint in each.joints] if each.kind == "arm" else []
    front = any(word.place == "front" for word in words)
    return "its names say that it is in front, as a front leg is" if front else ""


def arm_on_the_ground(draft: Draft, each: Found) -> str:
    """Arms without names or hands that end as low as the legs: front legs, of an animal that sits."""
    body, mine = draft.shape.body, each.pair
    if each.kind != "arm" or mine is None or mine.kind or mine.fingers >= 2:
        return ""
    if body is None or body.legs is None or mine is not body.arms:
        return ""
    high = lowest(draft.tree, mine, body.up) - lowest(draft.tree, body.legs, body.up)
    return "it ends as low as the legs, as front legs do" if high < ENDS_LOW * mine.size else ""
