"""Arms and legs without a twin, by the words of their names: of who has one arm, or two that differ."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal

from rigtri.recognition.character_draft import Draft
from rigtri.recognition.found_limb import Found
from rigtri.recognition.inanimate import has_hips_or_spine
from rigtri.recognition.layout import NAMES, LimbKind
from rigtri.recognition.limb_triples import triple_of
from rigtri.recognition.limb_words import NO_WORDS, LimbWords
from rigtri.recognition.naming_schemes import NO_LIMB, roles_in_name

# How sure words of all three joints make a limb without a twin: where a trunk is named, and elsewhere.
_SURE, _UNSURE = 0.85, 0.6
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
        path = list(tree.paths[node])
        words = [draft.words.get(joint, NO_WORDS) for joint in path]
        triple = triple_of(tree, [path], [], draft.words) if taken.isdisjoint(path) else None
        if triple is None or triple.named < 1.0:
            continue
        joints = tuple(path[k] for k in triple.at)
        kind, side = _kind([words[k] for k in triple.at]), draft.side_in_names(joints)
        same = [each for each in found if (each.kind, each.side) == (kind, side)]
        if not kind or not side or (same and not (kind == "leg" and len(same) >= _SEVERAL)):
            continue
        if draft.poses.has_weights and not any(map(draft.poses.moves_points, joints)):
            continue  # controls
        if not _NO_ARM.isdisjoint(role for joint in joints for role in draft.poses.roles_of(joint)):
            continue  # a wing, ``wing_upper_L``
        taken.update(path)
        sure = _SURE if trunk else _UNSURE
        yield Found(kind, side, joints, tuple(path[: triple.at[0]]), sure, (f"{NAMES}: words of limbs",))


def _starts(draft: Draft, node: int) -> bool:
    """Whether words of a limb begin with a joint, and it is a bone."""
    levels = draft.words.get(node, NO_WORDS).levels
    above = draft.words.get(draft.tree.above[node], NO_WORDS)
    if not {"before", "upper"} & levels.keys() or (above.levels and not above.trunk):
        return False
    return _NO_BONES.isdisjoint(roles_in_name(draft.tree.rig.names[node]))


def _kind(words: Sequence[LimbWords]) -> LimbKind | Literal[""]:
    """What the words of three joints are of, "" where they do not say or disagree."""
    kinds = {word.kind for word in words if word.kind}
    return kinds.pop() if len(kinds) == 1 else ""
