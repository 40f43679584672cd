"""Hinges that a body gives its joints: of trunk, hands, feet and clavicles, whatever a single triple says.

A hinge n is the direction about which a positive rotation flexes: n = AB × BC of a bent limb. Knees bend
forward and elbows back, fingers close towards the palm, and a trunk bends about the lateral axis.

Source: design notes, "One body, one sense"; measured on real characters.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rigtri.maths.matrices import nearest_rotation
from rigtri.maths.quaternions import conjugate, from_axes, multiply, rotate, rotation_angle
from rigtri.maths.triangle import bend_angle
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length, normalise, perpendicular
from rigtri.model.rig import Rig
from rigtri.recognition.layout import Chain, Character

# Fingers that bend by more than this at rest (radians, 20°) say themselves about which axis they close.
CURLED = 0.3490658503988659
# A bone nearer to the lateral axis than this (cosine of 45°) takes its hinge across the facing direction.
LATERAL = 0.7071067811865476
# A thumb that bends by more than this at rest (radians, 10°) shows its own hinge.
THUMB_BENT = 0.17453292519943295
# Hips that rotate by no more than this (radians) stand as they did.
SAME_POSE = 1e-3
_TRUNK = ("spine", "neck", "head")


@dataclass(frozen=True, eq=False)
class Body:
    """A character as it stands in a pose: unit directions of the world, (3,) each.

    nodes: all joints of the character. hinges: what it says of joints, by node: the rule, and a direction,
    (3,), that is not yet square to the bone; None where it is across bone and facing direction.
    """

    facing: Floats
    up: Floats
    left: Floats
    nodes: frozenset[int]
    limbs: frozenset[int]
    hinges: Mapping[int, tuple[str, Floats | None]]

    def across(self, bone: Floats) -> Floats:
        """The hinge of a bone, unit (3,), about which its end moves where the body faces; NaN along that."""
        return normalise(cross(bone, self.facing))

    def default(self, bone: Floats) -> Floats:
        """The hinge of a bone of which nothing else is known: lateral, or for lateral bones across them."""
        lateral = abs(float(dot(bone, self.left))) > LATERAL
        return self.across(bone) if lateral else normalise(perpendicular(self.left, bone))


def bodies(rig: Rig, characters: Sequence[Character], world: Floats, facing: Floats | None) -> list[Body]:
    """What the characters say of their joints in a pose, world (n, 4, 4).

    facing: where they look by the user's word, (3,), instead of what was recognised. Characters whose
    facing direction nothing tells are left out.
    """
    found = []
    for character in characters:
        frame = _frame(rig, character, world, facing)
        if frame is not None:
            ahead, up = frame
            left = cross(up, ahead)
            nodes = frozenset(part.joint for part in character.parts)
            limbs = frozenset(k for chain in character.limbs if chain.is_sure for k in chain.bend[:2])
            hinges = dict(_hinges(character, world[:, 3, :3], left))
            found.append(Body(ahead, up, left, nodes, limbs, hinges))
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
) -> tuple[Floats, Floats] | None:
    """Where a character looks in a pose, and where its up is; None where nothing tells."""
    up = np.array(character.up)
    ahead = np.array(character.facing) if facing is None else normalise(facing)
    if not up.any() or not ahead.any():
        return None
    if facing is None:
        ahead, up = _in_pose(rig, character, world, ahead, up)
    ahead = perpendicular(ahead, up)
    return (normalise(ahead), up) if length(ahead) > 0.1 else None


def _in_pose(
    rig: Rig, character: Character, world: Floats, ahead: Floats, up: Floats
) -> tuple[Floats, Floats]:
    """Facing and up directions taken from the rest pose to another, by the hips."""
    hips = character.hips
    if character.pose != "rest" or hips < 0:
        return ahead, up
    there, here = (from_axes(nearest_rotation(each[hips])) for each in (rig.world, world))
    turned = multiply(here, conjugate(there))
    if rotation_angle(turned) < SAME_POSE:
        return ahead, up
    ahead, up = rotate(turned, ahead), rotate(turned, up)
    lateral = _lateral(character, world[:, 3, :3])
    if lateral is None:
        return ahead, up
    lateral = lateral if dot(lateral, cross(up, ahead)) >= 0 else -lateral
    ahead = normalise(perpendicular(ahead, lateral))
    return ahead, cross(ahead, lateral)


def _lateral(character: Character, at: Floats) -> Floats | None:
    """From one side to the other, unit, (3,), as both legs and both arms begin; None without a pair."""
    total = np.zeros(3)
    for kind in ("leg", "arm"):
        starts = {chain.side: at[chain.bend[0]] for chain in character.limbs if chain.kind == kind}
        if starts.keys() >= {"left", "right"}:
            total = total + normalise(starts["left"] - starts["right"])
    return normalise(total) if length(total) > 0.5 else None


def _hinges(
    character: Character, at: Floats, left: Floats
) -> Iterator[tuple[int, tuple[str, Floats | None]]]:
    """What a character says of its joints; later ones count."""
    chains = [chain for chain in character.chains if chain.is_sure]
    if character.hips >= 0:
        yield character.hips, ("lateral axis of the body", left)
    for chain in chains:
        if chain.kind in (*_TRUNK, "tail") or (chain.kind == "foot" and character.form == "biped"):
            for joint in chain.joints:
                yield joint, ("lateral axis of the body", left)
    bones = character.bones
    for side in ("left", "right"):
        if f"{side}Shoulder" in bones:
            yield bones[f"{side}Shoulder"], ("facing direction of the body", None)
        # Of a body whose names say left where it faces right, the place says which hand it is.
        mirrored = float(dot(np.array(character.normal), left)) < 0
        yield from _hand(chains, side, at, is_left=(side == "left") != mirrored)


def _hand(
    chains: Sequence[Chain], side: str, at: Floats, *, is_left: bool
) -> Iterator[tuple[int, tuple[str, Floats | None]]]:
    """The hinge that the fingers of a hand and its wrist share, and the thumb's own."""
    fingers = [k for k in chains if k.kind == "finger" and k.side == side]
    thumb = next((k for k in fingers if "thumb" in k.name), None)
    named = {name: k for k in fingers for name in ("index", "middle", "ring", "little") if name in k.name}
    four = list(named.values())
    wrist = next((k.joints[-1] for k in chains if k.kind == "hand" and k.side == side), -1)
    palm = _palm(four, at, is_left=is_left)
    if palm is None:
        return
    rule, hinge = palm
    for joint in (wrist, *(joint for finger in four for joint in finger.joints)):
        if joint >= 0:
            yield joint, (rule, hinge)
    if thumb is not None and len(thumb.joints) > 1:
        own = _thumb(thumb.joints, four, at, hinge)
        for joint in thumb.joints:
            yield joint, own


def _palm(fingers: Sequence[Chain], at: Floats, *, is_left: bool) -> tuple[str, Floats] | None:
    """About which axis a hand closes, unit, (3,); None for a hand of one finger or none."""
    if len(fingers) < 2:
        return None
    knuckles = [finger.joints[0] for finger in fingers]
    across = normalise(at[knuckles[-1]] - at[knuckles[0]])
    # Seen along the fingers of a left hand with its palm down, the little finger is to the left.
    across = across if is_left else -across
    curl = _curl(fingers, at)
    if curl is not None:
        return "plane of the bent fingers", curl
    if not np.isfinite(across).all():
        return None
    return "palm of the hand", across


def _curl(fingers: Sequence[Chain], at: Floats) -> Floats | None:
    """The hinge that clearly bent fingers have in common, unit, (3,); None where they are nearly straight."""
    normals, most = [], []
    for finger in fingers:
        triples = list(zip(finger.joints, finger.joints[1:], finger.joints[2:], strict=False))
        if triples:
            a, b, c = (at[[triple[k] for triple in triples]] for k in range(3))
            most.append(float(bend_angle(a, b, c).max()))
            normals.append(normalise(cross(b - a, c - b).cumsum(axis=0)[-1]))
    if not most or sorted(most)[len(most) // 2] < CURLED:
        return None
    common = np.nan_to_num(np.array(normals)).cumsum(axis=0)[-1]
    return normalise(common) if length(common) > 0.7 * len(normals) else None


def _thumb(
    thumb: Sequence[int], fingers: Sequence[Chain], at: Floats, palm: Floats
) -> tuple[str, Floats | None]:
    """A thumb closes over the palm: by its own bend, else towards the root of the little finger."""
    bone = at[thumb[-1]] - at[thumb[0]]
    towards = at[fingers[-1].joints[0]] - at[thumb[0]]
    along = [finger.joints[:2] for finger in fingers if len(finger.joints) > 1]
    ahead = normalise(at[along[0][1]] - at[along[0][0]]) if along else towards
    inside = cross(palm, ahead)  # where finger tips move as they close
    closing = normalise(cross(bone, normalise(towards) + inside))
    if len(thumb) > 2:
        a, b, c = (at[joint] for joint in thumb[:3])
        own = normalise(cross(b - a, c - b))
        if float(bend_angle(a, b, c)) > THUMB_BENT and dot(own, closing) > 0:
            return "plane of the thumb", own
    return "palm of the hand", closing if np.isfinite(closing).all() else palm
