"""Arms and legs without a twin, by the words of their names: of who has one arm, or two that differ."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Literal

from rigtri.recognition.character_draft import Draft
from rigtri.recognition.found_limb import Found
from rigtri.recognition.inanimate import has_hips_or_spine
from rigtri.recognition.layout import NAMES, LimbKind
from rigtri.recognition.limb_pairs import Limbs
from rigtri.recognition.limb_triples import triple_of
from rigtri.recognition.limb_words import NO_WORDS, LimbWords
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.naming_schemes import NO_LIMB, roles_in_name

# How sure words of all three joints make a limb without a twin: where a trunk is named, and elsewhere.
_SURE, _UNSURE = 0.85, 0.6
_STUMP = "but its twin is longer by its names"
_HALF = "but it has an upper bone alone by its names"
# Bodies with more legs of a side than this have several of the same words.
_SEVERAL = 2
# An arm may be a gun.
_NO_ARM = NO_LIMB - {"control", "attachment"}
_NO_BONES = frozenset(["control", "helper", "twist", "end"])


def limbs_alone(draft: Draft, found: Sequence[Found]) -> Iterator[Found]:
    """The limbs whose three joints words name, of a side on which none of the kind was found.

    Insects have several legs of a side: of these each that is not found yet.
    """
    if draft.certain:
        return
    tree, taken = draft.tree, {joint for each in found for joint in (*each.before, *each.joints)}
    trunk = has_hips_or_spine(draft)
    for node in tree.nodes:
        if not _starts(draft, node):
            continue
        path = tree.paths[node]
        joints = _named_by_words(draft, path) if taken.isdisjoint(path) else ()
        if not joints:
            continue
        kind = _kind([draft.words.get(joint, NO_WORDS) for joint in joints])
        side = draft.side_in_names(joints)
        same = [each for each in found if (each.kind, each.side) == (kind, side)]
        if not kind or not side or (same and not (kind == "leg" and len(same) >= _SEVERAL)):
            continue
        if draft.poses.has_weights and not any(map(draft.poses.moves_points, joints)):
            continue  # controls
        if not _NO_ARM.isdisjoint(role for joint in joints for role in draft.poses.roles_of(joint)):
            continue  # a wing, ``wing_upper_L``
        taken.update(path)
        sure = _SURE if trunk else _UNSURE
        before = tuple(path[: path.index(joints[0])])
        yield Found(kind, side, joints, before, sure, (f"{NAMES}: words of limbs",))


def without_stumps(draft: Draft, named: Sequence[Found], pairs: Sequence[Found]) -> Iterator[Found]:
    """The limbs of pairs, but those of two joints that are alike only as a thigh is like half a leg.

    Where names tell all three joints on one side alone, the other one is a stump: not sure, and no limb if an
    end joint ends it. What is whole is found by its names. Two thighs that end joints end are two stumps, not
    sure. named: the limbs that a naming scheme knows.
    """
    for each in pairs:
        if each.pair is None or len(each.joints) > 2:
            yield each
            continue
        one, other = each.pair.joints(0), each.pair.joints(1)
        mine, twin = (one, other) if each.joints == one else (other, one)
        own, whole = _is_whole(draft, named, mine), _is_whole(draft, named, twin)
        ends = "end" in roles_in_name(draft.tree.rig.names[mine[-1]])
        half = ends and draft.words.get(mine[0], NO_WORDS).levels == {"upper": 1.0}
        if own == whole and half:
            yield replace(each, confidence=min(each.confidence, _UNSURE), evidence=(*each.evidence, _HALF))
        elif own == whole:
            yield each
        elif whole and not ends:
            yield replace(each, confidence=min(each.confidence, _UNSURE), evidence=(*each.evidence, _STUMP))


def is_half_whole(draft: Draft, named: Sequence[Found], limbs: Limbs) -> bool:
    """Whether two limbs of two joints are alike only so far: names tell three joints of one of them alone."""
    if len(limbs.at) > 2:
        return False
    return _is_whole(draft, named, limbs.joints(0)) != _is_whole(draft, named, limbs.joints(1))


def _is_whole(draft: Draft, named: Sequence[Found], joints: Sequence[int]) -> bool:
    """Whether names tell three joints of the limb that begins with these."""
    known = any(len(each.joints) == 3 and set(joints) <= set(each.joints) for each in named)
    return known or bool(_named_by_words(draft, draft.tree.paths[joints[0]]))


def _named_by_words(draft: Draft, path: Sequence[int]) -> tuple[int, ...]:
    """The three joints of a path that words name, () where they do not name all."""
    triple = triple_of(draft.tree, [path], [], draft.words)
    return tuple(path[k] for k in triple.at) if triple is not None and triple.named >= 1.0 else ()


def _starts(draft: Draft, node: int) -> bool:
    """Whether words of a limb begin with a joint, and it is a bone.

    What says no side above one that does is of the body: a ``root`` is of a limb on its side alone.
    """
    names, over = draft.tree.rig.names, draft.tree.above[node]
    own, above = (draft.words.get(joint, NO_WORDS) for joint in (node, over))
    if not {"before", "upper"} & own.levels.keys():
        return False
    of_body = above.trunk or (parse_name(names[node]).side and not parse_name(names[over]).side)
    return (not above.levels or bool(of_body)) and _NO_BONES.isdisjoint(roles_in_name(names[node]))


def _kind(words: Sequence[LimbWords]) -> LimbKind | Literal[""]:
    """What the words of three joints are of, "" where they do not say or disagree."""
    kinds = {word.kind for word in words if word.kind}
    return kinds.pop() if len(kinds) == 1 else ""
