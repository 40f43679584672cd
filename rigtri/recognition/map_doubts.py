"""Why the limbs of a humanoid map may be others: entries that cannot be, by hierarchy, names or sides."""

from __future__ import annotations

from collections.abc import Mapping

from rigtri.recognition.character_draft import Draft, once
from rigtri.recognition.found_limb import Found
from rigtri.recognition.humanoid_order import below_others, misplaced
from rigtri.recognition.layout import BENDS
from rigtri.text import and_more

# A limb starts on a side where it stands further from the middle than this part of its length.
_ASIDE = 0.05


def denied_by_map(draft: Draft, each: Found) -> str:
    """The first reason why a limb is not what a humanoid map has it for, in words, or ""."""
    bones = [each.side + part for part in BENDS[each.kind]]
    entries = _impossible(draft)
    if denied := [entries[bone] for bone in bones if bone in entries]:
        return f"its humanoid map cannot be right, {denied[0]}"
    named = draft.side_in_names(each.joints)
    if named and named != each.side:
        title = draft.tree.rig.title(each.joints[0])
        return f"the humanoid map has '{title}' for {bones[0]}, and its names say {named}"
    start, middle, _ = (draft.tree.at[joint] for joint in each.joints)
    stands = draft.side_of([each.joints[0]])
    plane = draft.shape.plane
    far = abs((start - plane.point).dot(draft.left)) if plane is not None else 0.0
    if stands not in ("", each.side) and far > _ASIDE * middle.distance(start):
        return f"the humanoid map has it on the {each.side}, and it stands on the {stands}"
    mirrored = draft.up.cross(draft.facing).dot(draft.left) < 0.0 and not draft.is_mirrored
    return "what the humanoid map calls left is on the right of where it faces" if mirrored else ""


@once
def _impossible(draft: Draft) -> Mapping[str, str]:
    """What cannot be of the entries of a humanoid map, by their bones; a remark says all."""
    rig, bones = draft.tree.rig, draft.certain
    bone_of = {node: bone for bone, node in bones.items()}
    found = dict[str, str]()
    for pairs, words in ((misplaced(rig, bones), "not below"), (below_others(rig, bones), "below")):
        for node, other in pairs:
            both = f"{bone_of[node]} '{rig.title(node)}'", f"{bone_of[other]} '{rig.title(other)}'"
            found.setdefault(bone_of[node], f"for {both[0]} is {words} {both[1]}")
    if found:
        entries = [why.removeprefix("for ") for why in found.values()]
        draft.remarks.append(f"entries of the humanoid map that cannot be: {and_more(entries, 6)}")
    return found
