"""T-pose and A-pose of a recognised body: each bone turns by the shortest way to where it should point.

Trunk and clavicles stay as they are: their joints stand where a rigger wants the flesh to bend, and the
pose is defined by how a body looks there ("standing straight", "relaxed shoulders").

Source: VRMC_vrm 1.0, tpose.md (arms along the lateral axis, palms down, legs down, feet ahead; fingers along
the arm, thumbs between there and ahead).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from rigtri.errors import GeometryError
from rigtri.maths.angle_limits import cosine_below
from rigtri.maths.matrices import orthonormal_axes
from rigtri.maths.quaternions import IDENTITY, between, conjugate, from_axes, multiply, rotate
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length, normalise, perpendicular
from rigtri.model.rig import Rig
from rigtri.operations.option_kinds import StandardPose
from rigtri.recognition.layout import CONFIDENT, FINGER_BONES, FINGERS, THUMB, Character

# Shoulders and hips that lie along an axis of the world but for this (a sine, 1.1°) are meant to: hand-made
# characters are not quite even, and those that face one way get the very same pose.
ASKEW = 0.02
# Arms that are farther (a cosine) from the lateral axis are in no T-pose.
STRETCHED = cosine_below(20)
# A body does not face its own side, its head or its feet: a direction that is nearer to one (a cosine).
_ALONG = cosine_below(30)
# How far arms of an A-pose are below the horizontal: 45°.
_DOWN = {"tpose": 0.0, "apose": float(np.sqrt(0.5)), "godot": 0.0}
FACE = ("jaw", "leftEye", "rightEye")


class Directions(NamedTuple):
    """Where a body has its left, its up, and what is ahead of it: unit directions of the world, (3,)."""

    left: Floats
    up: Floats
    ahead: Floats

    def arm(self, side: str, pose: StandardPose) -> Floats:
        """Where an arm points in a pose."""
        down, out = _DOWN[pose], self.left if side == "left" else -self.left
        return normalise(out * np.sqrt(1.0 - down * down) - self.up * down)

    def thumb(self, side: str, pose: StandardPose) -> Floats:
        """Where a thumb points in a pose: between its arm and ahead."""
        return normalise(self.arm(side, pose) + self.ahead)

    def palm(self, side: str, pose: StandardPose) -> Floats:
        """Where a palm faces in a pose."""
        across = cross(self.arm(side, pose), self.ahead)
        # Names may say left where a body has its right: palms face down all the same.
        return across if dot(across, self.up) < 0 else -across


def directions(
    rig: Rig, world: Floats, character: Character, facing: tuple[float, float, float] | None
) -> Directions | None:
    """The directions of a body in a pose, world (n, 4, 4); None where nothing says where it faces.

    GeometryError where it is said to face one of its sides, up or down.
    """
    up = np.array(character.up if any(character.up) else rig.rules.up)
    left = _left(world, sure_bones(character), character, up)
    ahead = np.array(facing if facing is not None else character.facing, dtype=np.float64)
    if not any(left) or not any(ahead):
        return None
    if facing is None:
        return Directions(left, up, normalise(perpendicular(ahead, left)))
    ahead = normalise(ahead)
    _refuse_along(ahead, {"left": left, "right": -left, "up": up, "down": -up})
    return Directions(left, up, ahead)


def _refuse_along(ahead: Floats, sides: Mapping[str, Floats]) -> None:
    for side, way in sides.items():
        if dot(ahead, way) > _ALONG:
            from rigtri.recognition.layout_output import direction_text

            faces, there = (direction_text(tuple(k.tolist())) for k in (ahead, way))
            text = f"This body cannot face {faces}: {there} is its {side}"
            raise GeometryError(f"{text}. Give another direction with --facing")


def stands_in_tpose(rig: Rig, character: Character, facing: tuple[float, float, float] | None) -> bool:
    """Whether the arms of a body are stretched out to its sides at rest, as far as they are known."""
    found = directions(rig, rig.world, character, facing)
    bones, at = sure_bones(character), rig.world[:, 3, :3]
    sides = [k for k in ("left", "right") if {f"{k}UpperArm", f"{k}Hand"} <= bones.keys()]
    if found is None:
        return not sides
    arms = {k: normalise(at[bones[f"{k}Hand"]] - at[bones[f"{k}UpperArm"]]) for k in sides}
    return all(dot(arms[k], found.arm(k, "tpose")) >= STRETCHED for k in sides)


def sure_bones(character: Character, without: Collection[str] = ()) -> dict[str, int]:
    """The joints that are surely bones of the VRM 1.0 humanoid."""
    return {
        part.bone: part.joint
        for part in character.parts
        if part.bone and part.confidence >= CONFIDENT and part.bone not in without
    }


def posed(
    rig: Rig,
    world: Floats,
    character: Character,
    pose: StandardPose,
    facing: tuple[float, float, float] | None,
    *,
    straight_fingers: bool,
) -> dict[int, Floats]:
    """The local rotations, (4,), that joints get in a pose, from where they stand, ``world`` (n, 4, 4).

    Only joints that are surely bones turn. Raises GeometryError for a body without arms or legs, or of which
    nothing says where it faces.
    """
    bones = sure_bones(character)
    if not {"leftUpperArm", "rightUpperArm"} <= bones.keys() and "leftUpperLeg" not in bones:
        raise GeometryError(
            "No arms or legs are recognised with enough confidence. See why: rigtri recognise FILE"
        )
    found = directions(rig, world, character, facing)
    if found is None:
        raise GeometryError("The direction that this body faces is unclear: give it with --facing")
    body, up, ahead = _Body(rig, world, bones), found.up, found.ahead
    for side in ("left", "right"):
        arm = found.arm(side, pose)
        for bone, end in (("UpperArm", "LowerArm"), ("LowerArm", "Hand"), ("Hand", "MiddleProximal")):
            body.point(side + bone, side + end, arm)
        body.turn_palm(side, arm, ahead)
        if straight_fingers:
            for finger in FINGERS[1:]:
                for bone, end in pairwise(FINGER_BONES[finger]):
                    body.point(side + bone, side + end, arm)
            for bone, end in pairwise(THUMB):
                body.point(side + bone, side + end, found.thumb(side, pose))
        for bone, end in (("UpperLeg", "LowerLeg"), ("LowerLeg", "Foot")):
            body.point(side + bone, side + end, -up)
        body.point_ahead(side + "Foot", side + "Toes", ahead, up)
    return body.rotations()


def _left(world: Floats, bones: Mapping[str, int], character: Character, up: Floats) -> Floats:
    """Where a body has its left, level, unit, (3,): by where its limbs begin, which no name changes."""
    total = np.zeros(3)
    for bone in ("UpperLeg", "UpperArm"):
        if {"left" + bone, "right" + bone} <= bones.keys():
            left, right = (world[bones[side + bone], 3, :3] for side in ("left", "right"))
            total = total + normalise(left - right)
    total = perpendicular(total, up)
    if not length(total) > 0.5:
        return np.array(character.normal)
    total = normalise(total)
    axis = np.where(np.abs(total) > 0.5, np.sign(total), 0.0)
    return axis if length(total - axis) < ASKEW else total


class _Body:
    """Where joints are while bones turn, one after the other from the root on."""

    def __init__(self, rig: Rig, world: Floats, bones: Mapping[str, int]) -> None:
        self.rig, self.bones = rig, bones
        self.at = world[:, 3, :3].copy()
        self.axes = from_axes(orthonormal_axes(world))
        self.turned = np.tile(IDENTITY, (len(rig), 1))

    def point(self, bone: str, end: str, direction: Floats) -> None:
        """Let a bone point at where ``end`` is to be seen from it."""
        if bone in self.bones and end in self.bones:
            here, there = self.bones[bone], self.bones[end]
            along = self.at[there] - self.at[here]
            if length(along) > 0:
                self._turn(here, between(along, direction))

    def point_ahead(self, bone: str, end: str, ahead: Floats, up: Floats) -> None:
        """Let a bone point ahead, as far up or down as it does."""
        if bone in self.bones and end in self.bones:
            along = normalise(self.at[self.bones[end]] - self.at[self.bones[bone]])
            steep = float(dot(along, up))
            flat = np.sqrt(max(0.0, 1.0 - steep * steep))
            if flat > 0.1:
                self.point(bone, end, ahead * flat + up * steep)

    def turn_palm(self, side: str, arm: Floats, ahead: Floats) -> None:
        """Turn a forearm about itself until the index finger is ahead of the little one, the palm down."""
        names = [f"{side}LowerArm", f"{side}IndexProximal", f"{side}LittleProximal"]
        if all(name in self.bones for name in names):
            lower, index, little = (self.bones[name] for name in names)
            across = self.at[index] - self.at[little]
            across = across - arm * dot(across, arm)
            target = ahead - arm * dot(ahead, arm)
            if length(across) > 0 and length(target) > 0:
                self._turn(lower, between(across, target))

    def _turn(self, node: int, rotation: Floats) -> None:
        below = self.rig.below(node)
        self.at[below] = self.at[node] + rotate(rotation, self.at[below] - self.at[node])
        self.turned[below] = multiply(rotation, self.turned[below])

    def rotations(self) -> dict[int, Floats]:
        """The local rotations of the joints that turned against their parents."""
        found = {}
        for node in sorted(self.bones.values()):
            parent = int(self.rig.parents[node])
            above = self.turned[parent] if parent >= 0 else IDENTITY
            change = multiply(conjugate(above), self.turned[node])
            if parent >= 0:
                change = multiply(conjugate(self.axes[parent]), multiply(change, self.axes[parent]))
                local = multiply(conjugate(self.axes[parent]), self.axes[node])
            else:
                local = self.axes[node]
            found[node] = np.asarray(multiply(change, local))
        return found
