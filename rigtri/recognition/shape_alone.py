"""What shape alone says of a body whose joints have names: names and shape have to agree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from rigtri.maths.angle_limits import radians_below
from rigtri.maths.triangle import bend_angle
from rigtri.recognition.arms_legs import find_limbs
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.evidence_against import doubted, unsure
from rigtri.recognition.found_limb import Found
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_triples import SAME_PLACE, TIE
from rigtri.recognition.limb_words import NO_WORDS
from rigtri.recognition.naming_schemes import roles_in_name
from rigtri.recognition.shape_analysis import shape_of
from rigtri.recognition.shape_doubts import has_hock
from rigtri.text import a

# A joint within a bone bends by less than this (radians).
_BENDS = radians_below(6)


def agreed(draft: Draft, found: Sequence[Found]) -> list[Found]:
    """The limbs, those less than sure of which the shape without names says something else."""
    if draft.certain or not draft.words or not any(map(_is_sure, found)):
        return list(found)
    bare = _without_names(draft)
    alone = [each for each in doubted(bare, find_limbs(bare)) if _is_sure(each)]
    weighed = []
    for each in found:
        other = (
            (_surely(draft, bare, each, alone) or _clearly(draft, bare, each, found))
            if _is_sure(each)
            else ""
        )
        weighed.append(unsure(draft, each, f"by its shape alone {other}") if other else each)
    return weighed


def _is_sure(each: Found) -> bool:
    return len(each.joints) == 3 and each.is_sure


def _without_names(draft: Draft) -> Draft:
    """The same joints by their shape, those too that names call parts of bones.

    Names say no more than that they are of an animal.
    """
    nodes = sorted({*draft.tree.nodes, *draft.segments})
    words = {node: replace(NO_WORDS, animal=True) for node, word in draft.words.items() if word.animal}
    poses = draft.poses.without_names()
    return Draft(shape_of(nodes, poses, words), poses, None, {}, words, draft.controls, draft.segments)


def _surely(draft: Draft, bare: Draft, each: Found, alone: Sequence[Found]) -> str:
    """What else some of a limb's joints are where the shape is sure of it, in words."""
    for other in (k for k in alone if set(k.joints).intersection(each.joints)):
        # Where a limb forks at its end, no shape tells which branch goes on, and the bend is the same.
        (*bend, end), (*bends, ends) = each.joints, other.joints
        if (
            bend == bends
            and other.kind == each.kind
            and len({*draft.tree.rig.parents[[end, ends]].tolist()}) == 1
        ):
            continue
        if _parts_a_bone(draft, bare, other.joints[1]) or _share_a_hock(draft, each, other):
            continue
        if other.kind != each.kind or not _stand_in_one_place(draft.tree, other.joints, each.joints):
            return f"{_titles(draft, other.joints)} is {a(other.kind)}"
    return ""


def _stand_in_one_place(tree: Tree, one: Sequence[int], other: Sequence[int]) -> bool:
    """Whether three joints are three others, or other axes of these in the same places."""
    size = tree.at[one[0]].distance(tree.at[one[2]])
    return all(tree.at[a].distance(tree.at[b]) <= SAME_PLACE * size for a, b in zip(one, other, strict=True))


def _share_a_hock(draft: Draft, each: Found, other: Found) -> bool:
    """Whether two limbs are the two readings of a hind leg with a hock: one begins at the other's knee."""
    if each.kind != "leg" or other.kind != "leg":
        return False
    upper, lower = (each, other) if each.joints[1:] == other.joints[:2] else (other, each)
    return upper.joints[1:] == lower.joints[:2] and has_hock(draft, upper.joints, lower.joints[2])


def _parts_a_bone(draft: Draft, bare: Draft, node: int) -> bool:
    """Whether names call a joint a part of the bone above, and it bends in no pose.

    Along a straight limb no shape tells elbows from such joints.
    """
    tree, moving = bare.tree, draft.poses.moving
    if node not in draft.segments or not tree.below[node]:
        return False
    before, at, after = (moving[:, k] for k in (tree.above[node], node, tree.below[node][0]))
    return bool((bend_angle(before, at, after) < _BENDS).all())


def _clearly(draft: Draft, bare: Draft, each: Found, found: Sequence[Found]) -> str:
    """At which other joints a limb and its twin bend where names pass over one of them, in words.

    Clavicles, toes and twist joints are named, too: of a chain that is named throughout names tell more.
    """
    twins = [k.joints for k in found if k.kind == each.kind and {k.side, each.side} == {"left", "right"}]
    for limbs in bare.shape.limbs:
        for own, path in enumerate(limbs.pair.paths):
            across = set(limbs.pair.paths[1 - own])
            if set(each.joints) <= set(path) and any(across.issuperset(joints) for joints in twins):
                other = limbs.joints(own)
                if _is_held(draft, other[0]) and path.index(other[0]) > path.index(each.joints[2]):
                    return ""
                passed = any(
                    not draft.words.get(k, NO_WORDS).levels for k in other if k not in draft.segments
                )
                clear = len(other) == 3 and other != each.joints and limbs.lead > TIE
                return f"it bends at {_titles(draft, other)}" if clear and passed else ""
    return ""


def _is_held(draft: Draft, node: int) -> bool:
    """Whether names call a joint a weapon or prop, which has as many joints as a limb with a leaf bone."""
    return "attachment" in roles_in_name(draft.tree.rig.names[node])


def _titles(draft: Draft, joints: Sequence[int]) -> str:
    return draft.tree.rig.chain_title(joints)
