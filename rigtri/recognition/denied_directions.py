"""Why up or facing of a body may be wrong: head, feet, all its limbs or its chest deny it."""

from __future__ import annotations

from collections.abc import Sequence

from rigtri.maths.scalar_vector import Vector
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.facing import THUMBS, facing_of
from rigtri.recognition.found_limb import Found
from rigtri.recognition.up_of_legs import ALONG_AXIS, axis_of, way_of

# A head is lower than feet by more than this part of the way between them: what grazes has it on the ground.
_LOWER = 0.25
# A trunk and legs in line (a cosine, 37°) say what is up; another up is off by more than the second (60°).
_IN_LINE, _OFF = 0.8, 0.5
# Toes point back by this (a cosine), and limbs go across what is up by less than the second.
_BACK, _ACROSS = 0.5, 0.3
# Half of how far a chest is turned against its hips: by a quarter, or a third, of a turn (cosines).
_QUARTER, _THIRD = 0.7, 0.5
# Bones by which it is plain how a body stands, and where it faces.
_STANDING = frozenset(["head", "leftUpperLeg", "rightUpperLeg", "leftFoot", "rightFoot"])
_FEET = frozenset(["leftFoot", "rightFoot", "leftToes", "rightToes"])


def denied_directions(draft: Draft, found: Sequence[Found]) -> str:
    """That a body does not stand or face as its joints say: poles would stand behind its knees.

    Knees of insects are higher than their heads, and which legs of several names of people mean is not plain.
    """
    if len([limb for limb in found if limb.kind == "leg"]) > 2:
        return _by_limbs(draft)
    by_bones = _by_head_and_feet(draft) or _by_toes(draft)
    return by_bones or _by_limbs(draft) or _by_the_chest(draft, found)


def _by_head_and_feet(draft: Draft) -> str:
    """That the head that names know is not above the feet."""
    bones, tree, up = draft.known_bones, draft.tree, draft.up
    if not bones.keys() >= _STANDING:
        return ""
    at, head = tree.at, bones["head"]
    top, left, right = tree.heights((head, bones["leftFoot"], bones["rightFoot"]), up)
    if top - max(left, right) > _OFF * tree.span:
        return ""  # plainly upright
    hips = (at[bones["leftUpperLeg"]] + at[bones["rightUpperLeg"]]) * 0.5
    feet = (at[bones["leftFoot"]] + at[bones["rightFoot"]]) * 0.5
    tall, legs = at[head] - feet, hips - feet
    title = tree.rig.title(head)
    if tall.dot(up) < -_LOWER * tall.length:
        return f"'{title}' is lower than its feet, as it is taken to stand"
    trunk = (at[head] - hips).unit
    if trunk.dot(legs.unit) > _IN_LINE and tall.unit.dot(up) < _OFF:
        return f"'{title}' is not above its feet, as it is taken to stand"
    return ""


def _by_toes(draft: Draft) -> str:
    """That toes point away from ahead, where the file has another up, too."""
    bones, at = draft.known_bones, draft.tree.at
    if draft.up.dot(Vector(*draft.tree.rig.rules.up)) > _OFF or not bones.keys() >= _FEET:
        return ""
    left, right = (at[bones[f"{side}Toes"]] - at[bones[f"{side}Foot"]] for side in ("left", "right"))
    back = max(left.unit.dot(draft.facing), right.unit.dot(draft.facing)) < -_BACK
    return "its toes point away from where it faces, and the file has another up" if back else ""


def _by_limbs(draft: Draft) -> str:
    """That all four limbs go along one axis of the file, and it is taken to lean over another.

    Who leans back and stretches arms and legs ahead has the shape of what stands on four in a file with
    another up.
    """
    body = draft.shape.body
    if body is None or body.legs is None or body.arms is None:
        return ""
    if (body.arms.starts - body.legs.starts).unit.dot(draft.up) > ALONG_AXIS:
        return ""
    down, out = way_of(body.legs), way_of(body.arms)
    axis = axis_of(down)
    across = abs(axis.dot(draft.up)) < _ACROSS and min(axis.dot(down), axis.dot(out)) > ALONG_AXIS
    return "all its limbs go along another axis than the one it is taken to stand on" if across else ""


def _by_the_chest(draft: Draft, found: Sequence[Found]) -> str:
    """That its chest faces back, as its hips see it, where no names tell left from right.

    No body turns so far: more likely either is seen the wrong way round. Up to a third of a turn thumbs show
    where a chest faces.
    """
    twist, body, plane = draft.shape.twist, draft.shape.body, draft.shape.plane
    if twist is None or body is None or plane is None or twist.hips.dot(twist.between) > _QUARTER:
        return ""
    if all(draft.side_in_names(limb.joints) for limb in found):
        return ""
    _, _, why = facing_of(draft.tree, body, plane, draft.poses)
    plain = THUMBS in why and twist.hips.dot(twist.between) > _THIRD
    return "" if plain else "its chest faces further from where its hips face than a body turns"
