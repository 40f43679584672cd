"""Why a limb may be another one: joints of other branches have the names of its joints."""

from __future__ import annotations

from collections.abc import Sequence

from rigtri.model.joint_names import number
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.found_limb import Found
from rigtri.recognition.limb_words import NO_WORDS, LimbWords
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.naming_schemes import roles_in_name


def named_twice(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """A limb by names whose joints are not below each other, where another is called as its start is.

    Or as any of them is, number and all, of names that only count: ``leg_b_1``, ``leg_c_1``.
    """
    rig, (start, middle, end) = draft.tree.rig, each.joints
    own, side = draft.words.get(start, NO_WORDS), parse_name(rig.names[start]).side
    if rig.is_below(middle, start) and rig.is_below(end, middle):
        return ""
    if own.levels != {"upper": 1.0}:
        return _counted_twice(draft, each)
    taken = {joint for limb in found for joint in limb.joints}
    others = (k for k in draft.tree.nodes if k not in taken and not roles_in_name(rig.names[k]))
    for node in (k for k in others if not _is_denied(draft, k)):
        if alike(own, draft.words.get(node, NO_WORDS)) and parse_name(rig.names[node]).side == side:
            return f"'{rig.title(node)}' may be its start as well as '{rig.title(start)}'"
    return ""


def _is_denied(draft: Draft, node: int) -> bool:
    """Whether the names are of one maker whose scheme has no such bone: ``upperarm_bicep_l`` of Unreal."""
    scheme = draft.reading.scheme if draft.reading is not None else None
    return (
        scheme is not None
        and not scheme.is_common
        and not scheme.bone(parse_name(draft.tree.rig.names[node]))[0]
    )


def _counted_twice(draft: Draft, each: Found) -> str:
    """That another joint has the words, the number and the side of one of a limb."""
    names = draft.tree.rig.names
    own = {k: parse_name(names[k]) for k in each.joints if number(names[k]) is not None}
    mine = {(name.key, name.side): k for k, name in own.items()}
    for node in (k for k in draft.tree.nodes if k not in each.joints and not roles_in_name(names[k])):
        name = parse_name(names[node])
        if (joint := mine.get((name.key, name.side))) is not None:
            return f"'{draft.tree.rig.title(node)}' is counted as '{draft.tree.rig.title(joint)}' is"
    return ""


def alike(one: LimbWords, other: LimbWords) -> bool:
    """Whether names call two joints by the same words of a limb."""
    return (one.levels, one.kind, one.place) == (other.levels, other.kind, other.place)


def one_of_several(draft: Draft, each: Found) -> str:
    """A limb without a side where joints of other branches have its names but for their numbers."""
    tree, middle = draft.tree, each.joints[1]
    plain = parse_name(tree.rig.names[middle]).plain
    if each.side or not plain:
        return ""
    others = (k for k in tree.nodes if parse_name(tree.rig.names[k]).plain == plain)
    away = [k for k in others if not tree.is_below(k, each.joints[0])]
    return f"'{tree.rig.title(away[0])}' may be its middle as well" if away else ""
