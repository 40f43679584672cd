"""Axes that make no sense on a recognised character: hands, limbs and trunk whose joints do not agree.

Nothing is broken by them, but animators and solvers meet them in each file of a library. Which axis aims is
found, not presumed: the one along the bones of a chain. Where the joints have the axes of the world (VRM 0,
the preset ``vrm``) no axis is meant to follow a bone, and nothing is said.

Source: docs/presets.md, "One body, one sense".
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import cached_property
from itertools import combinations, pairwise, product

import numpy as np

from rigtri.errors import RigtriError
from rigtri.frames.skeleton import Skeleton, reference, skeleton
from rigtri.maths.angle_limits import cosine_below
from rigtri.maths.matrices import handedness
from rigtri.maths.ranking import largest
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, cross, dot, length, normalise, perpendicular
from rigtri.model.dataclass import dataclass
from rigtri.model.limb import Limb
from rigtri.model.rig import Rig
from rigtri.recognition.body_hinges import Body, bodies
from rigtri.recognition.layout import Chain, Character
from rigtri.recognition.limb_bends import LimbBends
from rigtri.recognition.limbs import recognise as recognised
from rigtri.recognition.recognise import recognise
from rigtri.report import Report
from rigtri.verification.checks.axis_rolls import Signed, roll_between, roll_within
from rigtri.verification.checks.cycle_check import title_and_pointer
from rigtri.verification.checks.findings import Findings
from rigtri.verification.checks.pole_check import pole_findings

# No hand and no body has fewer joints.
LEAST_JOINTS = 8
# An axis this near to its bone (a cosine) aims along it.
AIMS = cosine_below(20)
# Degrees: of the axes of fingers, of the two bones of a limb, of neighbours in the trunk, and of the trunk's
# axes off the facing direction.
FINGERS, LIMB, TRUNK, FORWARD = 30.0, 20.0, 30.0, 35.0
# Degrees: hands are in one pose where thumb and fingers are as far apart on both sides but for this.
POSED = 20.0
# A bone shorter than this share of the longest of its chain has no direction.
TINY = 1e-3
# About an axis that flexes, a joint moves its bone within this (a cosine) of the way in which it bends.
FLEXES = cosine_below(60)
# Joints have the same axes that differ by less than this (a cosine); a character has, of which most do.
PARALLEL, MOST = cosine_below(2), 0.5
# An axis about which a trunk or a knee bends is within this (a cosine) of the hinge, and no other one is.
ALONG = cosine_below(35)
# A thumb closes over the palm in many ways: by so much (a cosine) at least.
THUMB = cosine_below(75)
_BENDS = {"arm": "elbow", "leg": "knee"}
# Bodies whose trunk and limbs have one sense.
_BODIES = ("biped", "quadruped")
# And parts of them, whose limbs have.
_LIMBED = (*_BODIES, "partial")
Found = tuple[str, int, str]


def check_axes(rig: Rig, findings: Findings) -> None:
    """Note the axes of a rig's characters that make no sense."""
    with suppress(RigtriError):  # of a rig that cannot be judged there are other findings
        for rule, node, text in axis_findings(rig):
            findings.add(rule, *title_and_pointer(rig, node), text)


def axis_findings(rig: Rig) -> Iterator[Found]:
    """The rules ``axes.*`` that a rig breaks: the id, the node and a sentence about it."""
    characters = [k for k in recognise(rig).characters if k.gives_axes]
    if not characters or not rig.is_joint.any() or not np.isfinite(rig.world).all():
        return
    tree = skeleton(rig)
    ref, limbs = reference(tree, None), recognised(rig)
    for character in characters:
        known = bodies(rig, [character], ref.world, None)
        seen = _Seen(tree, character, known[0] if known else None, ref.world, ref.other, limbs)
        if not seen.parallel:
            yield from seen.findings()
        if character.form in _LIMBED:
            yield from pole_findings(rig, character, limbs)


@dataclass(frozen=True, eq=False)
class _Seen:
    """A character in the pose of its axes. world: (n, 4, 4). body: None where nobody knows where it faces.
    all_limbs: of all characters.

    Joints without weight on or below them, which nobody sees, are left out.
    """

    tree: Skeleton
    character: Character
    body: Body | None
    world: Floats
    other: Floats | None
    all_limbs: list[Limb]

    @property
    def rig(self) -> Rig:
        return self.tree.rig

    @cached_property
    def at(self) -> Floats:
        return np.asarray(self.world[:, 3, :3])

    @cached_property
    def axes(self) -> Floats:
        """The unit axes of all nodes as rows, (n, 3, 3)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(normalise(self.world[:, :3, :3]))

    @cached_property
    def turning(self) -> Floats:
        """Which way a positive rotation turns, (n,): −1 in left-handed axes."""
        return handedness(self.world)

    @cached_property
    def chains(self) -> dict[str, Chain]:
        carries = self.tree.carries
        return {k.name: k for k in self.character.sure_chains if carries[list(k.joints)].all()}

    @cached_property
    def limbs(self) -> list[Limb]:
        """The sure arms and legs."""
        return [
            Limb(
                *chain.bend,
                kind="arm" if chain.kind == "arm" else "leg",
                side=chain.side,
                front=chain.is_front,
            )
            for chain in self.chains.values()
            if chain.kind in _BENDS and len(chain.bend) == 3
        ]

    @cached_property
    def bends(self) -> LimbBends:
        known = [] if self.body is None else [self.body]
        return LimbBends(self.rig, self.world, self.other, self.all_limbs, known)

    @cached_property
    def trunk(self) -> list[int]:
        """From hips to head, each below the one before."""
        found = [self.character.hips] if self.character.hips >= 0 else []
        for chain in (self.chains.get(name) for name in ("spine", "neck", "head")):
            for joint in chain.joints if chain else ():
                if not found or (joint not in found and self.rig.is_below(joint, found[-1])):
                    found.append(joint)
        return found

    @cached_property
    def hands(self) -> list[tuple[str, list[Chain]]]:
        """The fingers of each hand but the thumb, two at least."""
        names = ("index", "middle", "ring", "little")
        found = []
        for side in ("left", "right", ""):
            fingers = [self.chains.get(f"{side} {name} finger".strip()) for name in names]
            hand = [finger for finger in fingers if finger and len(finger.joints) > 1]
            if len(hand) > 1:
                found.append((side, hand))
        return found

    @property
    def parallel(self) -> bool:
        """Whether most joints of trunk and limbs have the same axes, or all but for mirrored ones."""
        joints = [*self.trunk, *(joint for limb in self.limbs for joint in limb.triple[:2])]
        if not joints:
            return False
        axes = self.axes[joints]
        cosines = np.nan_to_num(dot(axes[:, np.newaxis], axes))
        alike = (cosines > PARALLEL).all(axis=-1)
        mirrored = len(set(self.turning[joints])) > 1 and bool((np.abs(cosines) > PARALLEL).all())
        return mirrored or bool(alike.sum(axis=1).max() > MOST * len(joints))

    def findings(self) -> Iterator[Found]:
        off: list[int] = []
        closing, known = {}, set[int]()
        for side, hand in self.hands:
            yield from self._hand(side, hand, off)
            closing[hand[0].joints[0]] = self._closing_hand(hand)
            rolled = [*self._rolled_hand(side, hand, closing[hand[0].joints[0]])]
            known.update(joint for _, joint, _ in rolled)
            yield from rolled
            yield from self._rolled_fingers(hand)
        yield from self._unlike_thumbs(known)
        if len(closing) > 1 and all(closing.values()) and not set.intersection(*closing.values()):
            what = ", ".join(f"'{self.rig.title(joint)}' by {_text(axes)}" for joint, axes in closing.items())
            yield "axes.hands", next(iter(closing)), f"no one axis and sign closes both hands: {what}"
        if self.character.form in _BODIES:
            rolled = [*self._trunk(off)]
            yield from rolled
            yield from self._limbs(off)
            yield from () if rolled else self._rolled_trunk()
        elif self.character.form in _LIMBED:
            yield from self._limbs(off)
        if off:
            names = ", ".join(f"'{self.rig.title(joint)}'" for joint in off[:4])
            more = f" and {len(off) - 4} more" if len(off) > 4 else ""
            yield (
                "axes.aim",
                off[0],
                f"no one axis runs along the bones of the chains of {names}{more}, within 20°",
            )

    def _aim(self, bones: Sequence[tuple[int, int]], off: list[int]) -> Signed | None:
        """The axis along all of these bones, joint and target; those without it are added to ``off``.

        Joints that stand where the next one does have no bone and no vote.
        """
        sizes = {joint: float(length(self.at[target] - self.at[joint])) for joint, target in bones}
        bones = [bone for bone in bones if sizes[bone[0]] > TINY * max(sizes.values())]
        votes: dict[Signed, list[int]] = {}
        for joint, target in bones:
            cosines = dot(self.axes[joint], normalise(self.at[target] - self.at[joint]))
            if not np.isfinite(cosines).all():
                return None
            k = int(np.argmax(np.abs(cosines)))
            if abs(cosines[k]) >= AIMS:
                votes.setdefault((k, float(np.sign(cosines[k]))), []).append(joint)
        best = max(votes, key=lambda axis: len(votes[axis]), default=None)
        agreeing = votes[best] if best is not None else []
        odd = [joint for joint, _ in bones if joint not in agreeing]
        off += [joint for joint in odd if joint not in off]
        return None if odd else best

    def _hand(self, side: str, hand: Sequence[Chain], off: list[int]) -> Iterator[Found]:
        aim = self._aim([finger.joints[:2] for finger in hand], off)  # type: ignore[misc]
        if aim is None:
            return
        rolls = [
            (roll_between(self.axes, aim, a.joints[0], b.joints[0]), a, b) for a, b in combinations(hand, 2)
        ]
        most, a, b = largest(rolls, lambda roll: roll[0])
        if most > FINGERS:
            text = f"the fingers of the {f'{side} hand'.strip()} curl about axes up to {most:.0f}° apart"
            yield "axes.fingers", a.joints[0], f"{text}: {a.name} and {b.name}"

    def _closing_hand(self, hand: Sequence[Chain]) -> set[Signed]:
        """The axes about which a positive rotation closes all fingers; none where they do not agree."""
        axes = [self._about(finger.joints[0], finger.joints[1], FLEXES) for finger in hand]
        return set.intersection(*axes)

    def _about(self, joint: int, target: int, least: float) -> set[Signed]:
        """The axes about which a positive rotation moves a joint as its body has it move, by this cosine.

        None of them where no axis of the joint aims at the target.
        """
        hinge = None if self.body is None else self.body.hinges.get(joint)
        bone = normalise(self.at[target] - self.at[joint])
        along = np.abs(dot(self.axes[joint], bone))
        if hinge is None or not along.max() >= AIMS:
            return set()
        axes, direction = self.axes[joint] * self.turning[joint], hinge.of(bone)
        signed = product((k for k in range(3) if k != int(np.argmax(along))), (1.0, -1.0))
        return {(k, s) for k, s in signed if s * dot(axes[k], direction) > least}

    def _rolled_hand(self, side: str, hand: Sequence[Chain], closing: set[Signed]) -> Iterator[Found]:
        """The thumb and the wrist that another axis closes than the fingers."""
        thumb, wrist = (self.chains.get(f"{side} {part}".strip()) for part in ("thumb", "hand"))
        bones = [(*pair, THUMB) for pair in pairwise(thumb.joints if thumb else ())]
        bones += [(wrist.joints[0], finger.joints[0], FLEXES) for finger in hand[1:2] if wrist]
        for joint, target, least in bones:
            yield from self._rolled(joint, target, least, closing, "closes the fingers")

    def _unlike_thumbs(self, known: set[int]) -> Iterator[Found]:
        """The joints of a thumb that are rolled otherwise against the fingers than its twin's.

        Of hands in one pose: the same rule rolls them otherwise beside a fist than beside open fingers.
        """
        rolls, poses = list[list[tuple[int, float]]](), list[list[float]]()
        for side, hand in self.hands:
            thumb = self.chains.get(f"{side} thumb".strip())
            finger, bones = hand[0].joints[:2], [*pairwise(thumb.joints if thumb else ())]
            aim = self._aim([finger, *bones], []) if bones else None  # type: ignore[list-item]
            rolls.append([(k, roll_between(self.axes, aim, finger[0], k)) for k, _ in bones] if aim else [])
            poses.append(self._pose(finger, bones))
        if len(rolls) != 2 or any(abs(a - b) > POSED for a, b in zip(*poses, strict=False)):
            return
        for (joint, one), (twin, other) in zip(*rolls, strict=False):
            if abs(one - other) > FINGERS and not {joint, twin} & known:
                against = f"{one:.0f}° against the fingers, '{self.rig.title(twin)}' by {other:.0f}°"
                yield "axes.roll", joint, f"is rolled by {against}: no mirror image of it"

    def _pose(self, finger: Sequence[int], thumb: Sequence[tuple[int, int]]) -> list[float]:
        """How far the first bone of a finger is from the palm's and from the thumb's, degrees each."""
        others = [(int(self.rig.parents[finger[0]]), finger[0]), *thumb[:1]]
        bone = self.at[finger[1]] - self.at[finger[0]]
        return [float(np.degrees(angle(bone, self.at[end] - self.at[start]))) for start, end in others]

    def _rolled_fingers(self, hand: Sequence[Chain]) -> Iterator[Found]:
        """The joints within a finger that are rolled against the one above."""
        for finger in hand:
            aim = self._aim([*pairwise(finger.joints)], [])
            for above, joint in pairwise(finger.joints if aim else ()):
                roll = roll_within(self.axes, aim, above, joint) if aim else 0.0
                if roll > FINGERS:
                    yield "axes.roll", joint, f"is rolled by {roll:.0f}° against '{self.rig.title(above)}'"

    def _rolled(
        self, joint: int, target: int, least: float, flexing: set[Signed], what: str
    ) -> Iterator[Found]:
        own = self._about(joint, target, least)
        if flexing and own and not flexing & own:
            text = f"is rolled: {_text(flexing)} {what}, and {_text(own)} would have to turn this joint"
            yield "axes.roll", joint, text

    def _trunk(self, off: list[int]) -> Iterator[Found]:
        trunk = self.trunk
        aim = self._aim([*pairwise(trunk)], off) if len(trunk) > 1 else None
        if aim is None:
            return
        k, sign = aim
        bone = self.axes[:, k] * sign
        if len(trunk) > 2 and not dot(bone[trunk[-1]], bone[trunk[-2]]) > FLEXES:
            trunk = trunk[:-1]  # a head without a bone of its own
        for below, joint in pairwise(trunk):
            roll = roll_between(self.axes, aim, below, joint, None if self.body is None else self.body.left)
            if roll > TRUNK:
                yield "axes.trunk", joint, f"is rolled by {roll:.0f}° against '{self.rig.title(below)}'"
        if self.body is None:
            return
        for joint in trunk[1:]:
            hinge = self.body.hinges.get(joint)  # of a spine that is turned the facing direction is its own
            ahead = self.body.facing if hinge is None else cross(hinge.direction, self.body.up)
            facing = perpendicular(ahead, bone[joint])
            others = [self.axes[joint, j] * s for j in range(3) for s in (1.0, -1.0) if j != k]
            least = min(float(np.degrees(angle(axis, facing))) for axis in others)
            if length(facing) > FLEXES and least > FORWARD:
                text = f"no axis points where the character faces: the nearest is {least:.0f}° off"
                yield "axes.forward", joint, text

    def _rolled_trunk(self) -> Iterator[Found]:
        """The trunk that as a whole bends about another axis than the knees."""
        trunk = [(joint, self._letters(joint, self.body.left)) for joint in self.trunk[1:] if self.body]
        legs = [(limb, self.bends.of(limb, Report())) for limb in self.limbs if limb.kind == "leg"]
        knees = [self._letters(limb.middle, bend.hinge) for limb, bend in legs if bend is not None]
        alike = [set.intersection(*axes) if axes else set() for axes in ([k for _, k in trunk], knees)]
        if all(alike) and not alike[0] & alike[1]:
            spine, knee = ("xyz"[min(axes)] for axes in alike)
            text = f"is rolled with all of the trunk: it bends about {spine}, and the knees about {knee}"
            yield "axes.trunk", trunk[0][0], text

    def _letters(self, joint: int, direction: Floats) -> set[int]:
        """The axis of a joint, 0 to 2, that runs along a direction either way."""
        return {k for k in range(3) if abs(float(dot(self.axes[joint, k], direction))) > ALONG}

    def _limbs(self, off: list[int]) -> Iterator[Found]:
        flexing: list[tuple[Limb, set[Signed]]] = []
        for limb in self.limbs:
            aim = self._aim([limb.triple[:2], limb.triple[1:]], off)
            if aim is None:
                continue
            roll = roll_between(self.axes, aim, limb.start, limb.middle)
            if roll > LIMB:
                text = f"its hinge is rolled by {roll:.0f}° against that of '{self.rig.title(limb.start)}'"
                yield "axes.hinge", limb.middle, f"{text}: they are the two bones of one limb"
            axes = self._flexing(limb, aim)
            if axes is not None:
                flexing.append((limb, axes))
                foot = self.chains.get(f"{limb.side} foot") if limb.kind == "leg" else None
                if foot and len(foot.joints) > 1 and foot.joints[0] == limb.end:
                    ankle, toes = foot.joints[:2]
                    yield from self._rolled(ankle, toes, FLEXES, axes, "bends the knee")
        common = set.intersection(*(axes for _, axes in flexing)) if flexing else set()
        for limb, _ in flexing if common else ():
            clavicle = self.character.bones.get(f"{limb.side}Shoulder") if limb.kind == "arm" else None
            if clavicle is not None:
                yield from self._rolled(clavicle, limb.start, FLEXES, common, "bends the elbow")
        if flexing and not common:
            what = ", ".join(f"{self._joint_of(limb)} by {_text(axes)}" for limb, axes in flexing)
            yield "axes.flex", flexing[0][0].middle, f"no one axis and sign bends all limbs: {what}"

    def _joint_of(self, limb: Limb) -> str:
        """What bends, in words: an animal has two knees on each side."""
        if self.character.form == "biped":
            return f"{limb.side} {_BENDS[limb.kind]}"
        return f"'{self.rig.title(limb.middle)}'"

    def _flexing(self, limb: Limb, aim: Signed) -> set[Signed] | None:
        """The axes of the middle joint about which a positive rotation bends the limb; None: nobody knows."""
        found = self.bends.of(limb, Report())
        if found is None:
            return None
        axes = self.axes[limb.middle] * self.turning[limb.middle]
        signed = product((k for k in range(3) if k != aim[0]), (1.0, -1.0))
        return {(k, s) for k, s in signed if s * dot(axes[k], found.hinge) > FLEXES}


def _text(axes: set[Signed]) -> str:
    """Signed axes in words."""
    return " or ".join(f"{'-' if s < 0 else '+'}{'xyz'[k]}" for k, s in sorted(axes)) or "none"
