"""Hinges that a body gives its joints: of trunk, hands, feet and clavicles, whatever a single triple says.

A hinge n is the direction about which a positive rotation flexes: n = AB × BC of a bent limb. Knees bend
forward and elbows back, fingers close towards the palm, and a trunk bends about the lateral axis.

Source: docs/presets.md, "One body, one sense"; measured on real characters.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from rigtri.errors import UsageError
from rigtri.maths.angle_limits import cosine_below, radians_below
from rigtri.maths.matrices import nearest_rotation
from rigtri.maths.quaternions import conjugate, from_axes, from_axis_angle, multiply, rotate, rotation_angle
from rigtri.maths.triangle import bend_angle
from rigtri.maths.trigonometry import Floats, arc_tangent
from rigtri.maths.vectors import angle, cross, dot, length, normalise, perpendicular, triple
from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import Side
from rigtri.model.rig import Rig
from rigtri.recognition.bend_direction import facing_along
from rigtri.recognition.hand_hinges import Hinge, hand_hinges, with_palms
from rigtri.recognition.layout import Chain, Character, Direction
from rigtri.recognition.pose_samples import bind_pose
from rigtri.report import Report

# A bone nearer to the lateral axis than this (a cosine) takes its hinge across the facing direction.
LATERAL = cosine_below(45)
# Hips that rotate by no more than this (radians) stand as they did.
SAME_POSE = 1e-3
# A direction nearer to the up direction than this sine says nothing about where a body looks.
ALONG_UP = 0.1
# Hips and chest whose lines are further apart than this (a cosine) are turned against each other: shoulders
# that are drawn ahead lean the line less.
TURNED = cosine_below(20)
# … and beyond this (a cosine) by more than a walk or a stance turns them: it may be an error of a pose.
FAR_TURNED = cosine_below(60)
# A knee that bends by more than this (radians) about an axis that is further from the lateral one than this
# (a cosine) is turned out or in with its whole leg.
CROSSED, TURNED_OUT = radians_below(45), cosine_below(45)
# Feet whose plane with the shin is further from the lateral axis than this (a cosine) are turned with the
# leg, if they stand off the shin by this (radians) at least.
FOOT_TURNED, FOOT_BENT = cosine_below(30), radians_below(30)
# A front leg that bends by less than this (radians) does not show that it is spread aside.
STRAIGHT = radians_below(10)
_TRUNK = ("spine", "neck", "head")


@dataclass(frozen=True, eq=False)
class Body:
    """A character as it stands in a pose: unit directions of the world, (3,) each.

    hips, chest: where these face, which is elsewhere where one is turned against the other. nodes: all joints
    of the character, upper: those at the end of the spine and below it. limbs: those whose limbs say it.
    unsure: joints of what may be limbs, further: of what may be a pair besides the arms and legs of a body on
    two or four of them, or is worn. hinges: what it says of the others. feet: where those with toes point, by
    their ankles.
    """

    facing: Floats
    hips: Floats
    chest: Floats
    up: Floats
    left: Floats
    nodes: frozenset[int]
    upper: frozenset[int]
    limbs: frozenset[int]
    unsure: frozenset[int]
    further: frozenset[int]
    hinges: Mapping[int, Hinge]
    feet: Mapping[int, Floats]

    def facing_of(self, points: Floats, *, arm: bool) -> Floats:
        """Where hips or chest face as a limb at ``points``, (3, 3), has it, unit, (3,)."""
        return facing_along(points[2] - points[0], self.chest if arm else self.hips, self.up)

    def default(self, bone: Floats, joint: int) -> Floats:
        """The hinge of a bone of which nothing else is known: lateral, or for lateral bones across them."""
        facing = self.chest if joint in self.upper else self.facing
        left = cross(self.up, facing)
        lateral = abs(float(dot(bone, left))) > LATERAL
        return normalise(cross(bone, facing)) if lateral else normalise(perpendicular(left, bone))


def bodies(rig: Rig, characters: Sequence[Character], world: Floats, facing: ArrayLike | None) -> list[Body]:
    """What the characters say of their joints in a pose, world (n, 4, 4).

    facing: where they look by the user's word, (3,), instead of what was recognised. Characters that are not
    sure are left out; of hands alone, and of parts whose facing direction nothing shows, there are the hinges
    of hands, and no directions (NaN). A hand alone is one by its shape: fingers side by side close together,
    whatever they are of.
    """
    found = []
    for character in (k for k in characters if k.gives_axes):
        frame = _frame(rig, character, world, facing)
        if frame is None and character.form in ("hand", "partial"):
            found.append(_hands_alone(rig, character, world[:, 3, :3]))
        if frame is not None:
            ahead, up, mirrored = frame
            left = cross(up, ahead)
            nodes = frozenset(part.joint for part in character.parts)
            limbs = frozenset(k for chain in character.limbs if chain.is_sure for k in chain.bend[:2])
            doubted = [chain for chain in character.limbs if not chain.is_sure]
            worn = [k for k in doubted if k.kind == "limb" and character.form in ("biped", "quadruped")]
            further = frozenset(k for chain in worn for k in chain.joints)
            unsure = frozenset(k for chain in doubted for k in chain.joints) - further
            at = world[:, 3, :3]
            ends = None if facing is not None else _turned(character, at, up, mirrored=mirrored)
            hips, chest = ends or (ahead, ahead)
            hinges = dict(_hinges(rig, character, at, (hips, chest), up, mirrored=mirrored))
            toed = [k.joints for k in character.chains if k.kind == "foot" and len(k.joints) > 1]
            feet = {ankle: normalise(at[toes] - at[ankle]) for ankle, toes, *_ in toed}
            top = next((k.joints[-1] for k in character.sure_chains if k.kind == "spine"), -1)
            upper = frozenset(k for k in nodes if top >= 0 and rig.is_below(k, top))
            found.append(
                Body(ahead, hips, chest, up, left, nodes, upper, limbs, unsure, further, hinges, feet)
            )
    return found


def _hands_alone(rig: Rig, character: Character, at: Floats) -> Body:
    """The hands of a character of which nobody knows where it faces; of an arm, nothing but its hand."""
    unknown, none = np.full(3, np.nan), frozenset[int]()
    chains, alone = character.sure_chains, character.form == "hand"
    hands = [chain.side for chain in chains if chain.kind == "hand"]
    sides: dict[Side, bool | None] = {side: side == "left" if side else None for side in hands}
    hinges = dict(with_palms(rig.parents, chains, dict(hand_hinges(chains, sides, at, None))))
    nodes = frozenset(part.joint for part in character.parts if alone or part.joint in hinges)
    return Body(unknown, unknown, unknown, unknown, unknown, nodes, none, none, none, none, hinges, {})


def turned_facings(rig: Rig, character: Character) -> tuple[Direction, Direction] | None:
    """Where hips and chest of a character face that are turned against each other by more than `TURNED`."""
    for body in bodies(rig, [character], rig.world, None):
        if dot(body.hips, body.chest) < TURNED:  # of a hand alone both are unknown
            return triple(body.hips + 0.0), triple(body.chest + 0.0)
    return None


def warn_both(rig: Rig, characters: Sequence[Character], report: Report) -> None:
    """Warn that one facing direction, which the user has given, counts for hips and chest that face apart."""
    for character in characters:
        turned = turned_facings(rig, character) if character.gives_axes else None
        if turned is not None:
            hips, chest = map(np.array, turned)
            report.warn(
                "facing-of-both",
                f"Hips and chest are turned against each other by {np.degrees(angle(hips, chest)):.0f}°; "
                "--facing counts for both alike. Without it each faces where its limbs begin",
                geometry=True,
            )


def warn_turned(known: Sequence[Body], report: Report) -> None:
    """Warn of bodies of which one half faces far from where the other does: axes follow each half."""
    for body in known:
        if dot(body.hips, body.chest) < FAR_TURNED:  # of a hand alone both are unknown
            turned = np.degrees(angle(body.hips, body.chest))
            report.warn(
                "turned-chest",
                f"Hips and chest are turned against each other by {turned:.0f}°: "
                "legs and feet bend as the hips face, arms, hands and head as the chest does, and the spine "
                "shares the turn. Both directions: rigtri recognise FILE; --facing counts for both alike",
            )


def lone_feet(characters: Sequence[Character], bodies: Sequence[Body], at: Floats) -> dict[int, Floats]:
    """Where feet of one joint point, unit, (3,): ahead, level. at: the places of all nodes, (n, 3).

    Not where their skin does: files of one skeleton, and clips without a mesh, have the same axes.
    """
    found = {}
    for character in (character for character in characters if character.form == "biped"):
        knees = {chain.side: chain.bend[1] for chain in character.limbs if chain.kind == "leg"}
        feet = [k for k in character.chains if k.kind == "foot" and k.is_sure and len(k.joints) == 1]
        for foot in (foot for foot in feet if foot.side in knees):
            (joint,), body = foot.joints, body_of(bodies, foot.joints[0])
            if body is not None:
                shin = at[joint] - at[knees[foot.side]]
                found[joint] = facing_along(shin, body.hips, body.up)
    return found


def body_of(bodies: Sequence[Body], node: int) -> Body | None:
    """The body that a joint belongs to."""
    return next((body for body in bodies if node in body.nodes), None)


def _frame(
    rig: Rig, character: Character, world: Floats, facing: ArrayLike | None
) -> tuple[Floats, Floats, bool] | None:
    """Where a character looks in a pose and where its up is, (3,) each; None where nothing shows it.

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
    there, here = from_axes(nearest_rotation(np.stack([posed[hips], world[hips]])))
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
    lines = _lines(character, at)
    total = sum((normalise(line) for line in lines.values()), np.zeros(3))
    return normalise(total) if length(total) > 0.5 else None


def _lines(character: Character, at: Floats) -> dict[str, Floats]:
    """From where the right one of two limbs begins to where the left one does, (3,): of legs and of arms."""
    found = {}
    for kind in ("leg", "arm"):
        starts = {chain.side: at[chain.bend[0]] for chain in character.limbs if chain.kind == kind}
        if starts.keys() >= {"left", "right"}:
            found[kind] = starts["left"] - starts["right"]
    return found


def _turned(character: Character, at: Floats, up: Floats, *, mirrored: bool) -> tuple[Floats, Floats] | None:
    """Where hips and chest of a body on two legs face, (3,) each, that are turned against each other.

    Square to the lines between both legs and both arms. None where they are not turned.
    """
    lines = [perpendicular(line, up) * (-1.0 if mirrored else 1.0) for line in _lines(character, at).values()]
    if character.form != "biped" or len(lines) < 2:
        return None
    hips, chest = (normalise(cross(line, up)) for line in lines)
    return (hips, chest) if dot(hips, chest) < TURNED else None


def _hinges(
    rig: Rig, character: Character, at: Floats, facing: tuple[Floats, Floats], up: Floats, *, mirrored: bool
) -> Iterator[tuple[int, Hinge]]:
    """What a character says of its joints; later ones count. facing: of hips and chest, (3,) each."""
    hips, left = (cross(up, ahead) for ahead in facing)
    chains = character.sure_chains
    if character.hips >= 0:
        yield character.hips, Hinge("lateral axis of the body", hips)
    for chain in chains:
        if chain.kind in (*_TRUNK, "tail") or (chain.kind == "foot" and character.form == "biped"):
            for k, joint in enumerate(chain.joints, 1):
                # A spine shares what the chest is turned against the hips.
                share = k / len(chain.joints) if chain.kind == "spine" else chain.kind in _TRUNK
                yield joint, Hinge("lateral axis of the body", _between(hips, left, up, float(share)))
    for leg, foot in _legs_and_feet(character):
        hip, knee, ankle = (at[joint] for joint in leg.bend)
        hinge = normalise(cross(knee - hip, ankle - knee))
        # A leg that is turned out, as of who sits with legs crossed, takes its foot with it.
        if bend_angle(hip, knee, ankle) > CROSSED and abs(float(dot(hinge, hips))) < TURNED_OUT:
            for joint in foot.joints:
                yield joint, Hinge("hinge of the knee", hinge)
            continue
        # So does one that is stretched aside, or turned out straight.
        shin = ankle - knee
        toes = at[foot.joints[1]] - ankle if len(foot.joints) > 1 else facing_along(shin, facing[0], up)
        own = normalise(cross(toes, shin))
        lateral = normalise(perpendicular(hips, normalise(toes)))
        if angle(shin, toes) > FOOT_BENT and abs(float(dot(own, lateral))) < FOOT_TURNED:
            for joint in foot.joints:
                yield joint, Hinge("plane of shin and foot", own * (1.0 if dot(own, hips) >= 0 else -1.0))
    for joint in _front_paws(character, at, left):
        yield joint, Hinge("lateral axis of the body", left)
    bones = character.bones
    chest = cross(left, _up_of_chest(chains, at, up))
    shoulders = [bones[f"{side}Shoulder"] for side in ("left", "right") if f"{side}Shoulder" in bones]
    for joint in (*shoulders, *_further_shoulders(rig, character)):
        yield joint, Hinge("facing direction of the chest", chest, ahead=True)
    # Of a body whose names say left where it faces right, the place says which hand it is.
    sides: dict[Side, bool | None] = {"left": not mirrored, "right": mirrored}
    yield from with_palms(rig.parents, chains, dict(hand_hinges(chains, sides, at, (facing[1], up, chest))))


def _legs_and_feet(character: Character) -> Iterator[tuple[Chain, Chain]]:
    """The sure legs of a body on two with their feet."""
    legs = [k for k in character.sure_chains if k.kind == "leg" and len(k.bend) == 3]
    feet = [k for k in character.sure_chains if k.kind == "foot" and character.form == "biped"]
    return ((leg, foot) for leg in legs for foot in feet if foot.joints[0] == leg.bend[2])


def _front_paws(character: Character, at: Floats, left: Floats) -> Iterator[int]:
    """The joints of front feet, which fold back as hind ones do, though the elbows above bend the other way.

    Of legs that are spread aside, as a lizard's, nothing is known. left: the lateral axis of the chest, (3,).
    """
    if character.form != "quadruped":
        return
    feet = {chain.joints[0]: chain.joints for chain in character.chains if chain.kind == "foot"}
    for leg in (k for k in character.limbs if k.is_front and len(k.bend) == 3):
        shoulder, elbow, wrist = at[list(leg.bend)]
        across = float(dot(normalise(cross(elbow - shoulder, wrist - elbow)), left))
        is_straight = bend_angle(shoulder, elbow, wrist) < STRAIGHT
        # Of a leg that is not sure an elbow that is bent back shows that it is one.
        if (is_straight or abs(across) > LATERAL) if leg.is_sure else (not is_straight and across < -LATERAL):
            yield from feet.get(leg.bend[2], ())


def _further_shoulders(rig: Rig, character: Character) -> Iterator[int]:
    """The joints between the spine and arms beyond the first two that lead to one of these alone."""
    deforming = [part.joint for part in character.parts if part.role == "deform"]
    spine = {joint for chain in character.sure_chains if chain.kind == "spine" for joint in chain.joints}
    bones = {*character.bones.values()}
    for chain in (chain for chain in character.sure_chains if chain.kind == "arm" and chain.bend):
        over = int(rig.parents[chain.bend[0]])
        if over < 0 or over in bones or int(rig.parents[over]) not in spine:
            continue
        if [joint for joint in deforming if rig.parents[joint] == over] == [chain.bend[0]]:
            yield over


def _between(one: Floats, other: Floats, up: Floats, share: float) -> Floats:
    """A level direction turned by a share of the way to another about the up direction, unit, (3,)."""
    if share in (0.0, 1.0) or not (one != other).any():
        return other if share == 1.0 else one
    turn = arc_tangent(dot(cross(one, other), up), dot(one, other))
    return rotate(from_axis_angle(up, share * turn), one)


def _up_of_chest(chains: Sequence[Chain], at: Floats, up: Floats) -> Floats:
    """The direction of the trunk where the arms begin, unit, (3,); the body's up for a spine of one joint."""
    spine = next((k.joints for k in chains if k.kind == "spine"), ())
    above = next((k.joints[0] for kind in ("neck", "head") for k in chains if k.kind == kind), None)
    line = [*spine, *([] if above is None else [above])]
    return normalise(at[line[-1]] - at[line[-2]]) if len(line) > 1 else up
