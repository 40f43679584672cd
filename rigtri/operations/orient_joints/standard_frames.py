"""Axes of a standard skeleton: joints aim where its bones point in a T-pose or A-pose, not at their children.

Joints of trunk, clavicles and feet stand elsewhere in every body. Axes along the bones of a standard skeleton
are the same in all that rest in its pose, so that rotations of clips mean the same.

Source: VRMC_vrm 1.0, tpose.md; Godot, SkeletonProfileHumanoid (the reference poses of its bones).
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import field

import numpy as np

from rigtri.maths.angle_limits import cosine_below
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.operations.body_pose import Directions, directions, sure_bones
from rigtri.operations.option_kinds import StandardPose
from rigtri.recognition.layout import CONFIDENT, FINGER_BONES, FINGERS, THUMB, TRUNK, Character
from rigtri.report import Report

# The bones of all fingers but the thumb.
_FINGERS = [bone for finger in FINGERS[1:] for bone in FINGER_BONES[finger]]
# How far ahead of the arm a thumb of SkeletonProfileHumanoid points, of the sine: a third of the square.
_GODOT_THUMB = float(np.sqrt(1.0 / 3.0))

# A body that faces farther aside than hand-made characters do by mistake (a cosine) faces another way.
_ASIDE = cosine_below(5)
# From here on a body stands on another axis than its format does.
_UPRIGHT = cosine_below(45)


@dataclass(frozen=True)
class StandardFrames:
    """bones: where joints aim and about what they flex, unit directions of the world, (3,) each.

    axes: the rows, (3, 3), that joints of a body have for those of the world: these turned about up as far as
    the body is from facing as its format has it. turned: where bodies that face elsewhere do, and should.
    """

    bones: Mapping[int, tuple[Floats, Floats]] = field(default_factory=dict)
    axes: Mapping[int, Floats] = field(default_factory=dict)
    turned: tuple[tuple[str, str], ...] = ()


def standard_frames(
    rig: Rig,
    world: Floats,
    characters: Sequence[Character],
    pose: StandardPose,
    facing: tuple[float, float, float] | None,
) -> StandardFrames:
    """The frames of recognised bodies, which stand in the pose in ``world``, (n, 4, 4)."""
    bones: dict[int, tuple[Floats, Floats]] = {}
    axes: dict[int, Floats] = {}
    turned: list[tuple[str, str]] = []
    for character in (character for character in characters if character.confidence >= CONFIDENT):
        found = directions(rig, world, character, facing)
        if found is None:
            continue
        known = sure_bones(character)
        table = godot_bones(found) if pose == "godot" else standard_bones(found, pose)
        mine = {known[bone]: (aim, up) for bone, aim, up in table if bone in known}
        for chain in (k for k in character.chains if k.kind in ("spine", "neck") and k.is_sure):
            mine |= dict.fromkeys(chain.joints, (found.up, cross(found.up, found.ahead)))
        bones |= mine | {joint: mine[bone] for joint, bone in _between(rig, mine)}
        rows = _turned_axes(rig, found)
        below = rig.below(character.hips) if character.hips >= 0 else []
        axes |= dict.fromkeys([*(part.joint for part in character.parts), *below], rows)
        if dot(found.ahead, _usual(rig)) < _ASIDE:
            from rigtri.recognition.layout_output import direction_text

            faces, ahead = (direction_text(tuple(k.tolist())) for k in (found.ahead, _usual(rig)))
            turned.append((faces, ahead))
    return StandardFrames(bones, axes, tuple(turned))


def _between(rig: Rig, bones: Collection[int]) -> Iterator[tuple[int, int]]:
    """The joints between a bone and the one above it, with the latter, whose axes they get.

    Metacarpals, twist joints in line, MMD's 肩P: no clip of a standard skeleton has keys for them, and the
    rest rotations of the bones below them have to be those of the standard skeleton all the same.
    """
    for node in bones:
        above = rig.path_to_root(node)[1:]
        bone = next((k for k in above if k in bones), -1)
        if bone >= 0:
            yield from ((joint, bone) for joint in above[: above.index(bone)])


def warn_facing(frames: StandardFrames, report: Report) -> None:
    """Say of bodies that face another way what it means for clips."""
    for faces, ahead in frames.turned:
        text = (
            f"The character faces {faces}, and not {ahead}: its joints have axes turned with it. Its own "
            f"clips look as before, and clips of characters that face {ahead} make it face {ahead}, too"
        )
        report.warn("facing", text)


def standard_bones(body: Directions, pose: StandardPose) -> Iterator[tuple[str, Floats, Floats]]:
    """Bones of the VRM 1.0 humanoid: where they aim, and about what a positive rotation flexes them."""
    left, up, ahead = body
    lateral = cross(up, ahead)  # names may say left where a body has its right
    for bone in TRUNK:
        yield bone, up, lateral
    for side, out in (("left", left), ("right", -left)):
        arm, palm, thumb = body.arm(side, pose), body.palm(side, pose), body.thumb(side, pose)
        yield f"{side}Shoulder", out, cross(out, ahead)
        for bone in ("UpperArm", "LowerArm"):
            yield side + bone, arm, cross(arm, ahead)
        for bone in ("Hand", *_FINGERS):
            yield side + bone, arm, cross(arm, palm)
        for bone in THUMB:
            # Its nail faces outwards, a quarter of a turn from those of the fingers.
            yield side + bone, thumb, cross(ahead, arm)
        for bone in ("UpperLeg", "LowerLeg"):
            yield side + bone, -up, lateral
        for bone in ("Foot", "Toes"):
            yield side + bone, ahead, lateral


def godot_bones(body: Directions) -> Iterator[tuple[str, Floats, Floats]]:
    """Bones of Godot's SkeletonProfileHumanoid: where their y axis points, and their x axis."""
    left, up, ahead = body
    lateral = cross(up, ahead)
    for bone in TRUNK:
        yield bone, up, lateral
    for bone, x in (("leftEye", lateral), ("rightEye", lateral), ("jaw", -lateral)):
        yield bone, ahead, x
    for side, out in (("left", left), ("right", -left)):
        yield f"{side}Shoulder", out, cross(out, up)
        yield f"{side}LowerArm", out, cross(out, ahead)
        for bone in ("UpperArm", "Hand", *_FINGERS):
            yield side + bone, out, cross(up, out)
        thumb = out * np.sqrt(1.0 - _GODOT_THUMB * _GODOT_THUMB) + ahead * _GODOT_THUMB
        for bone in THUMB:
            yield side + bone, thumb, cross(ahead, out)
        for bone, aim, x in (
            ("UpperLeg", -up, -lateral),
            ("LowerLeg", -up, lateral),
            ("Foot", ahead, -lateral),
            ("Toes", ahead, lateral),
        ):
            yield side + bone, aim, x


def _turned_axes(rig: Rig, body: Directions) -> Floats:
    """The world's axes, rows (3, 3), turned about up as the body is against its format.

    Of a body that stands on another axis than its format's up, turned as a whole.
    """
    up, usual = np.array(rig.rules.up), _usual(rig)
    if rig.rules.orient_locked and dot(body.ahead, usual) >= _ASIDE:
        return np.eye(3)  # which allows no other axes, and faces as it should
    stands = up if dot(body.up, up) >= _UPRIGHT else body.up
    aside, left = cross(up, usual), cross(stands, body.ahead)
    rows = [dot(e, usual) * body.ahead + dot(e, aside) * left + dot(e, up) * stands for e in np.eye(3)]
    return np.array(rows)


def _usual(rig: Rig) -> Floats:
    """Where characters of a format face, (3,): where it says nothing, as in programs with its up axis."""
    return np.array(rig.rules.facing or ((0.0, 0.0, 1.0) if rig.rules.up[1] else (0.0, -1.0, 0.0)))
