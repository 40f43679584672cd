"""Hinges that a body gives its joints: of trunk, hands, feet and clavicles, whatever a single triple says.

A hinge n is the direction about which a positive rotation flexes: n = AB × BC of a bent limb. Knees bend
forward and elbows back, fingers close towards the palm, and a trunk bends about the lateral axis.

Source: design notes, "One body, one sense"; measured on real characters.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rigtri.errors import UsageError
from rigtri.maths.matrices import nearest_rotation
from rigtri.maths.quaternions import between, conjugate, from_axes, multiply, rotate, rotation_angle
from rigtri.maths.triangle import bend_angle
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length, normalise, perpendicular
from rigtri.model.rig import Rig
from rigtri.recognition.hands_feet import BY_PLACE
from rigtri.recognition.layout import CONFIDENT, Chain, Character
from rigtri.recognition.pose_samples import bind_pose

# Fingers that bend by more than this at rest (radians, 20°) say themselves about which axis they close.
CURLED = 0.3490658503988659
# A bone nearer to the lateral axis than this (cosine of 45°) takes its hinge across the facing direction.
LATERAL = 0.7071067811865476
# A thumb that bends by more than this at rest (radians, 10°) shows its own hinge.
THUMB_BENT = 0.17453292519943295
# Hips that rotate by no more than this (radians) stand as they did.
SAME_POSE = 1e-3
# A direction nearer to the up direction than this sine says nothing about where a body looks.
ALONG_UP = 0.1
# A thumb points by more than this to the side of the fingers (the cosine of 20°).
THUMB_APART = 0.9396926207859084
# Fingers that all bend to one side by more than this (radians, 2°) say which side the palm is on.
SHOWN = 0.03490658503988659
FOUR = ("index", "middle", "ring", "little")
_TRUNK = ("spine", "neck", "head")


class Hinge(NamedTuple):
    """What a body says of a joint: the rule, and a direction of the world, (3,), not yet square to the bone.

    ahead: the direction is where the bone's end moves as the joint flexes, else it is the hinge.
    """

    rule: str
    direction: Floats
    ahead: bool = False

    def of(self, bone: Floats) -> Floats:
        """The hinge of a bone, unit, (3,) each; NaN where the bone runs along the direction."""
        across = cross(bone, self.direction) if self.ahead else perpendicular(self.direction, bone)
        return normalise(across)


@dataclass(frozen=True, eq=False)
class Body:
    """A character as it stands in a pose: unit directions of the world, (3,) each.

    nodes: all joints of the character. limbs: those whose limbs say it. unsure: joints of what may be limbs.
    hinges: what it says of the others.
    """

    facing: Floats
    up: Floats
    left: Floats
    nodes: frozenset[int]
    limbs: frozenset[int]
    unsure: frozenset[int]
    hinges: Mapping[int, Hinge]

    def facing_of(self, points: Floats) -> Floats:
        """Where the body looks as a limb at ``points``, (3, 3), has it, unit, (3,).

        For one that runs along it, the direction that swung with the limb: of a leg that is stretched out
        ahead the knee is above, of an arm the elbow below.
        """
        chord = normalise(points[2] - points[0])
        along = abs(float(dot(chord, self.facing))) > LATERAL
        return rotate(between(-self.up, chord), self.facing) if along else self.facing

    def default(self, bone: Floats) -> Floats:
        """The hinge of a bone of which nothing else is known: lateral, or for lateral bones across them."""
        lateral = abs(float(dot(bone, self.left))) > LATERAL
        return normalise(cross(bone, self.facing)) if lateral else normalise(perpendicular(self.left, bone))


def bodies(rig: Rig, characters: Sequence[Character], world: Floats, facing: Floats | None) -> list[Body]:
    """What the characters say of their joints in a pose, world (n, 4, 4).

    facing: where they look by the user's word, (3,), instead of what was recognised. Characters that are not
    sure, or whose facing direction nothing tells, are left out.
    """
    found = []
    for character in (character for character in characters if character.confidence >= CONFIDENT):
        frame = _frame(rig, character, world, facing)
        if frame is not None:
            ahead, up, mirrored = frame
            left = cross(up, ahead)
            nodes = frozenset(part.joint for part in character.parts)
            limbs = frozenset(k for chain in character.limbs if chain.is_sure for k in chain.bend[:2])
            unsure = frozenset(k for chain in character.limbs if not chain.is_sure for k in chain.joints)
            hinges = dict(_hinges(character, world[:, 3, :3], left, up, mirrored=mirrored))
            found.append(Body(ahead, up, left, nodes, limbs, unsure, hinges))
    return found


def body_of(bodies: Sequence[Body], node: int) -> Body | None:
    """The body that a joint belongs to."""
    return next((body for body in bodies if node in body.nodes), None)


def sockets(rig: Rig, characters: Sequence[Character]) -> frozenset[int]:
    """The joints that only hold what hangs at them: in no chain of a character, no weight on or below them.

    None where no skin has weights: there meshes that hang at joints are the body.
    """
    weighted = [skin.joints[skin.weighted] for skin in rig.skins]
    if not any(len(joints) for joints in weighted):
        return frozenset()
    moves = np.zeros(len(rig), dtype=bool)
    for joints in weighted:
        moves[joints] = True
    for character in characters:
        moves[[joint for chain in character.chains for joint in chain.joints]] = True
        moves[[part.joint for part in character.parts if part.bone]] = True
    for level in reversed(rig.levels[1:]):
        inside = level[moves[level]]
        moves[rig.parents[inside]] = True
    known = [part.joint for character in characters for part in character.parts]
    return frozenset(joint for joint in known if not moves[joint])


def _frame(
    rig: Rig, character: Character, world: Floats, facing: Floats | None
) -> tuple[Floats, Floats, bool] | None:
    """Where a character looks in a pose and where its up is, (3,) each; None where nothing tells.

    And whether its names say left where it has its right.
    """
    up, ahead, normal = (np.array(k) for k in (character.up, character.facing, character.normal))
    if not up.any() or not (ahead.any() or facing is not None):
        return None
    ahead, up, normal = _in_pose(rig, character, world, ahead, up, normal)
    if facing is not None:
        ahead = normalise(facing)
    ahead = perpendicular(ahead, up)
    if not length(ahead) > ALONG_UP:
        if facing is not None:
            raise UsageError("--facing runs along the character; give the direction in which it looks")
        return None
    ahead = normalise(ahead)
    return ahead, up, float(dot(normal, cross(up, ahead))) < 0


def _in_pose(
    rig: Rig, character: Character, world: Floats, ahead: Floats, up: Floats, normal: Floats
) -> tuple[Floats, Floats, Floats]:
    """Directions of a character taken from the pose that they were recognised in to another, by the hips."""
    hips = character.hips
    if hips < 0:
        return ahead, up, normal
    bind = bind_pose(rig) if character.pose == "bind" else None
    posed = rig.world if bind is None else bind
    there, here = (from_axes(nearest_rotation(each[hips])) for each in (posed, world))
    turned = multiply(here, conjugate(there))
    if rotation_angle(turned) < SAME_POSE or not np.isfinite(turned).all():
        return ahead, up, normal
    ahead, up, normal = (rotate(turned, k) for k in (ahead, up, normal))
    lateral = _lateral(character, world[:, 3, :3])
    if lateral is None:
        return ahead, up, normal
    lateral = lateral if dot(lateral, cross(up, ahead)) >= 0 else -lateral
    ahead = normalise(perpendicular(ahead, lateral))
    return ahead, cross(ahead, lateral), normal


def _lateral(character: Character, at: Floats) -> Floats | None:
    """From one side to the other, unit, (3,), as both legs and both arms begin; None without a pair."""
    total = np.zeros(3)
    for kind in ("leg", "arm"):
        starts = {chain.side: at[chain.bend[0]] for chain in character.limbs if chain.kind == kind}
        if starts.keys() >= {"left", "right"}:
            total = total + normalise(starts["left"] - starts["right"])
    return normalise(total) if length(total) > 0.5 else None


def _hinges(
    character: Character, at: Floats, left: Floats, up: Floats, *, mirrored: bool
) -> Iterator[tuple[int, Hinge]]:
    """What a character says of its joints; later ones count."""
    # Fingers belong to their hand as surely as that is one, even where it is a guess which finger each is.
    hands = {chain.side for chain in character.chains if chain.kind == "hand" and chain.is_sure}
    chains = [k for k in character.chains if k.is_sure or (k.kind == "finger" and k.side in hands)]
    if character.hips >= 0:
        yield character.hips, Hinge("lateral axis of the body", left)
    for chain in chains:
        if chain.kind in (*_TRUNK, "tail") or (chain.kind == "foot" and character.form == "biped"):
            for joint in chain.joints:
                yield joint, Hinge("lateral axis of the body", left)
    bones = character.bones
    chest = cross(left, _up_of_chest(chains, at, up))
    for side in ("left", "right"):
        if f"{side}Shoulder" in bones:
            yield bones[f"{side}Shoulder"], Hinge("facing direction of the chest", chest, ahead=True)
        # Of a body whose names say left where it faces right, the place says which hand it is.
        yield from _hand(chains, side, at, up, is_left=(side == "left") != mirrored)


def _up_of_chest(chains: Sequence[Chain], at: Floats, up: Floats) -> Floats:
    """The direction of the trunk where the arms begin, unit, (3,); the body's up for a spine of one joint."""
    spine = next((k.joints for k in chains if k.kind == "spine"), ())
    above = next((k.joints[0] for kind in ("neck", "head") for k in chains if k.kind == kind), None)
    line = [*spine, *([] if above is None else [above])]
    return normalise(at[line[-1]] - at[line[-2]]) if len(line) > 1 else up


def _hand(
    chains: Sequence[Chain], side: str, at: Floats, up: Floats, *, is_left: bool
) -> Iterator[tuple[int, Hinge]]:
    """The hinge that the fingers of a hand and its wrist share, and the thumb's own."""
    own = [k for k in chains if k.kind in ("finger", "hand", "arm") and k.side == side]
    fingers = [k for k in own if k.kind == "finger"]
    thumb = next((k.joints for k in fingers if "thumb" in k.name), ())
    # From the index finger to the little one, in whatever order the file has them.
    four = list({name: k for name in FOUR for k in fingers if name in k.name}.values())
    four = four or [k for k in fingers if k.joints != thumb]
    wrist = next((k.joints for k in own if k.kind == "hand"), ())
    arm = next((k.bend for k in own if k.kind == "arm" and len(k.bend) == 3), wrist[:1])
    if not wrist or not fingers:
        return
    hand = _PosedHand([k.joints for k in four], thumb, wrist[0], at[wrist[0]] - at[arm[-2:][0]], at)
    palm = hand.palm(up, is_left=is_left, guessed=all(k.evidence[0] == BY_PLACE for k in four))
    if palm is None:
        return
    for joint in (*wrist, *(joint for finger in four for joint in finger.joints)):
        yield joint, palm
    if thumb:
        closing = hand.thumb_hinge(palm.direction)
        for joint in thumb:
            yield joint, closing


@dataclass(frozen=True, eq=False)
class _PosedHand:
    """A hand in a pose. fingers: from the index finger on, without the thumb. arm: of the lower arm, (3,).

    at: the places of all nodes, (n, 3).
    """

    fingers: Sequence[Sequence[int]]
    thumb: Sequence[int]
    wrist: int
    arm: Floats
    at: Floats

    def line(self, finger: Sequence[int]) -> Floats:
        """Where a finger points, unit, (3,); one of a single joint as the hand does there."""
        start = finger[0] if len(finger) > 1 else self.wrist
        return normalise(self.at[finger[-1]] - self.at[start])

    @property
    def along(self) -> Floats:
        """Where the fingers point together, unit, (3,); without any as the lower arm does."""
        lines = [self.line(finger) for finger in self.fingers]
        return normalise(np.nan_to_num(lines).cumsum(axis=0)[-1]) if lines else normalise(self.arm)

    def palm(self, up: Floats, *, is_left: bool, guessed: bool) -> Hinge | None:
        """About which axis the hand closes; None for one finger that is straight, without a thumb.

        guessed: which finger is the first is known by place alone.
        """
        across = self._across(is_left=is_left)
        known = across is not None and (self._is_apart or not guessed)
        curl = _curl(self.fingers, self.at)
        if curl is not None:
            # Knuckles may be bent back more than fingers are bent, and a hand closes all the same.
            turned = known and not guessed and across is not None and dot(curl, across) < 0
            return Hinge("plane of the bent fingers", -curl if turned else curl)
        if across is None:
            return None
        if not known:  # a bend of all shows the palm, else it faces down
            shown = _shown(self.fingers, self.at)
            away = dot(shown, across) if shown is not None else -dot(cross(across, self.along), up)
            across = -across if away < 0 else across
        return Hinge("palm of the hand", across)

    def _across(self, *, is_left: bool) -> Floats | None:
        """The hinge by the order of the fingers, unit, (3,); None for one finger without a thumb, or none."""
        if len(self.fingers) > 1:
            across = self.at[self.fingers[-1][0]] - self.at[self.fingers[0][0]]
        elif self.fingers and self.thumb:  # as if the thumb were the first of two fingers
            (finger,) = self.fingers
            across = perpendicular(self.at[finger[0]] - self.at[self.thumb[-1]], self.along)
        else:
            return None
        across = normalise(across)
        # Seen along the fingers of a left hand with its palm down, the little finger is to the left.
        return (across if is_left else -across) if np.isfinite(across).all() else None

    @property
    def _is_apart(self) -> bool:
        """Whether the thumb points elsewhere than the fingers do, so that it surely is one."""
        return len(self.thumb) > 1 and float(dot(self.line(self.thumb), self.along)) < THUMB_APART

    def thumb_hinge(self, palm: Floats) -> Hinge:
        """A thumb closes over the palm: by its own bend, else towards the root of the little finger."""
        at, thumb = self.at, self.thumb
        bone = self.line(thumb)
        towards = at[self.fingers[-1][0]] - at[thumb[0]] if self.fingers else self.arm
        along = [finger[:2] for finger in self.fingers if len(finger) > 1]
        ahead = normalise(at[along[0][1]] - at[along[0][0]]) if along else normalise(towards)
        inside = cross(palm, ahead)  # where finger tips move as they close
        closing = normalise(cross(bone, normalise(towards) + inside))
        if len(thumb) > 2:
            a, b, c = (at[joint] for joint in thumb[:3])
            own = normalise(cross(b - a, c - b))
            if float(bend_angle(a, b, c)) > THUMB_BENT and dot(own, closing) > 0:
                return Hinge("plane of the thumb", own)
        return Hinge("palm of the hand", closing if np.isfinite(closing).all() else palm)


def _shown(fingers: Sequence[Sequence[int]], at: Floats) -> Floats | None:
    """The hinge about which all fingers bend a little, unit, (3,); None where they do not agree."""
    found = []
    for finger in fingers:
        if len(finger) < 3:
            return None
        a, b, c = (at[joint] for joint in finger[:3])
        if float(bend_angle(a, b, c)) < SHOWN:
            return None
        found.append(normalise(cross(b - a, c - b)))
    common = np.array(found).cumsum(axis=0)[-1]
    return normalise(common) if length(common) > 0.9 * len(found) else None


def _curl(fingers: Sequence[Sequence[int]], at: Floats) -> Floats | None:
    """The hinge that clearly bent fingers have in common, unit, (3,); None where they are nearly straight."""
    normals, most = [], []
    for finger in fingers:
        triples = list(zip(finger, finger[1:], finger[2:], strict=False))
        if triples:
            a, b, c = (at[[triple[k] for triple in triples]] for k in range(3))
            most.append(float(bend_angle(a, b, c).max()))
            normals.append(normalise(cross(b - a, c - b).cumsum(axis=0)[-1]))
    if not most or sorted(most)[len(most) // 2] < CURLED:
        return None
    common = np.nan_to_num(np.array(normals)).cumsum(axis=0)[-1]
    return normalise(common) if length(common) > 0.7 * len(normals) else None
