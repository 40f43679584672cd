"""The draft of a character: chains found so far, and to which each joint belongs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from functools import cached_property, wraps
from typing import Any, TypeVar

from rigtri.maths.matrices import handedness
from rigtri.maths.scalar_vector import Vector
from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import Side
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.layout import BENDS, UNLIKELY, Chain, Kind, LimbKind
from rigtri.recognition.limb_words import LimbWords, limb_words
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.name_readings import Reading
from rigtri.recognition.naming_schemes import Scheme
from rigtri.recognition.pose_samples import Poses
from rigtri.recognition.shape_analysis import Shape

A = TypeVar("A")


@dataclass
class Draft:
    """What is known of a character so far.

    reading: what names say, None where nothing. words: what single words of names say of limbs.
    certain: bones of a humanoid map, bones: those found so far, both by their names. controls: joints that
    are known to be none of the body. segments: joints that are parts of the bones above them, groups: those
    that only hold the one below, worn: those of chains along known limbs, all three none of the tree. rival:
    the first joint of another skeleton in the same places that may be the body as well, −1 for none. up,
    facing, left: unit directions of the world, zero where unknown. hips, chest: where legs and arms hang, −1
    where unknown. four: whether it stands on four legs. remarks: sentences for users. answers: see `once`.
    """

    shape: Shape
    poses: Poses
    reading: Reading | None
    certain: dict[str, int]
    words: Mapping[int, LimbWords] = field(default_factory=dict)
    controls: frozenset[int] = frozenset()
    segments: frozenset[int] = frozenset()
    groups: frozenset[int] = frozenset()
    worn: frozenset[int] = frozenset()
    rival: int = -1
    up: Vector = field(default_factory=Vector)
    facing: Vector = field(default_factory=Vector)
    left: Vector = field(default_factory=Vector)
    hips: int = -1
    chest: int = -1
    four: bool = False
    chains: list[Chain] = field(default_factory=list)
    bones: dict[str, int] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)
    answers: dict[Any, Any] = field(default_factory=dict)

    @cached_property
    def tree(self) -> Tree:
        return self.shape.tree

    @property
    def taken(self) -> frozenset[int]:
        """The joints that a chain has."""
        return frozenset(joint for chain in self.chains for joint in chain.joints)

    @property
    def known_bones(self) -> dict[str, int]:
        """Nodes by bone as a humanoid map or names have them."""
        return self.certain or (self.reading.bones if self.reading else {})

    @property
    def wholeness(self) -> float:
        """How sure the surer of its pairs of limbs is, 0 to 1, of a body with legs and arms, or four legs.

        0 for what has less: a part of a body, and a thing.
        """
        pairs: dict[LimbKind, list[float]] = {}
        for kind in BENDS:
            sides = (
                sorted((k.confidence for k in self.chains if (k.kind, k.side) == (kind, side)), reverse=True)
                for side in ("left", "right")
            )
            pairs[kind] = [min(pair) for pair in zip(*sides, strict=False) if min(pair) >= UNLIKELY]
        every = [*pairs["leg"], *pairs["arm"]]
        return max(every) if pairs["leg"] and len(every) > 1 else 0.0

    def add_chain(
        self,
        kind: Kind,
        words: str,
        side: Side,
        joints: Sequence[int],
        confidence: float,
        evidence: Sequence[str],
        bend: Sequence[int] = (),
        is_front: bool = False,
    ) -> None:
        """One more chain; words: its name without its side."""
        name = f"{side} {words}" if side else words
        sure = round(max(0.0, min(0.99, confidence)), 2)
        self.chains.append(
            Chain(kind, name, side, tuple(joints), tuple(bend), sure, tuple(evidence), is_front)
        )

    def call(self, bone: str, node: int) -> None:
        """A joint gets a bone's name, unless either is taken."""
        if bone not in self.bones and node not in self.bones.values():
            self.bones[bone] = node

    def way(self, start: int, end: int) -> list[int]:
        """The nodes from one down to another of its branch, with the segments of bones between them."""
        found, parents = [end], self.tree.rig.parents
        over = self.tree.way(start, end)
        for node in reversed(over[:-1]):
            above = int(parents[found[-1]])
            while above in self.segments or above in self.groups:
                found += [above] if above in self.segments else []
                above = int(parents[above])
            found.append(node)
        return found[::-1]

    @property
    def is_mirrored(self) -> bool:
        """Whether most of its joints have left-handed axes, as below a root with a scale of −1."""
        hands: list[float] = handedness(self.tree.rig.world[list(self.tree.nodes)]).tolist()
        return 2 * len([hand for hand in hands if hand < 0.0]) > len(hands)

    def side_in_names(self, joints: Sequence[int]) -> Side:
        """The side that names of joints say, "" where they say none or both.

        Words that the scheme of most names alone takes for sides count where no others are said.
        """
        names = self.tree.rig.names
        sides = {parse_name(names[joint]).side for joint in joints} - {""}
        if not sides and self.reading is not None and self.reading.scheme.own_sides:
            sides = {_own_side(names[joint], self.reading.scheme) for joint in joints} - {""}
        return sides.pop() if len(sides) == 1 else ""

    def named_side(self, joints: Sequence[int], others: Sequence[int]) -> Side:
        """The side that names of joints say, or those of their twins: the other one."""
        own, twin = self.side_in_names(joints), self.side_in_names(others)
        return own or ("right" if twin == "left" else "left" if twin else "")

    def side_of(self, nodes: Sequence[int]) -> Side:
        """The side of the body that joints stand on, "" where left and right are not known."""
        plane = self.shape.plane
        if plane is None or not any(self.left):
            return ""
        at = max(((self.tree.at[k] - plane.point).dot(self.left) for k in nodes), key=abs)
        return "left" if at > 0 else "right" if at < 0 else ""

    def stand(self, up: Vector, ahead: Vector) -> None:
        """Which way is up, which is ahead, and so which is left."""
        self.answers.clear()
        self.up = up.unit
        self.facing = (ahead - self.up * ahead.dot(self.up)).unit
        self.left = self.up.cross(self.facing)


def _own_side(name: str, scheme: Scheme) -> Side:
    """The side for which a scheme alone takes a word of a name.

    That may be a letter, which codes have, too: it counts in names of bones and of limbs.
    """
    parsed = scheme.read(parse_name(name))
    return parsed.side if scheme.bone(parsed)[0] or limb_words(name).levels else ""


def once(question: Callable[[Draft], A]) -> Callable[[Draft], A]:
    """A question about a whole draft that is answered once, however many limbs ask it.

    For what names, shape and the directions of a draft decide, and not its chains, which grow.
    """

    @wraps(question)
    def asked(draft: Draft) -> A:
        if question not in draft.answers:
            draft.answers[question] = question(draft)
        answer: A = draft.answers[question]
        return answer

    return asked
