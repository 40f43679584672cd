"""Chains along the limbs that names or a humanoid map know, and beside them: what is worn hangs there.

Of a person whose four limbs are known these tell what else is a limb; nothing else tells of them.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import chain, pairwise

from rigtri.maths.scalar_vector import Vector
from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import Side
from rigtri.recognition.body_shape import Body
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.layout import BENDS, LimbKind
from rigtri.recognition.limb_pairs import Limbs
from rigtri.recognition.limb_words import limb_words
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.name_readings import Reading
from rigtri.recognition.naming_schemes import roles_in_name
from rigtri.recognition.pose_samples import Poses
from rigtri.recognition.standing import is_person

# The joints of limbs by kind and side.
_Known = Mapping[tuple[LimbKind, Side], tuple[int, ...]]
_SIDES: tuple[Side, Side] = ("left", "right")
# Joints of what is worn stand nearer to those of a limb than this part of its length; further arms do not.
_ALONG = 0.2
# Words name a limb where they agree so far with its three joints.
_NAMED = 0.66
# A person stands upright: the trunk goes on from the legs by this, and each leg goes down by it (cosines).
_UPRIGHT = 0.6
# What stands further from the middle of a person than this part of the legs is of one side.
_ASIDE = 0.02
# What is worn goes down by more than this (a cosine), or is shorter than this part of a person's limb.
_HANGS, _SHORT = 0.5, 0.5
# A further leg ends as low as the others do, and begins away from these, by parts of their length.
_GROUND, _APART = 0.2, 0.25


def worn_in(tree: Tree, poses: Poses, reading: Reading | None, certain: Mapping[str, int]) -> frozenset[int]:
    """The joints of chains of which three stand, in order, where those of a known limb do, and what is below.

    They hang where the limb does, or above. Beside a limb that moves no point stand its bones.
    """
    limbs = known_limbs(reading, certain)
    bones = certain or (reading.bones if reading is not None else {})
    own = {*bones.values(), *chain.from_iterable(limbs.values())}
    found = set[int]()
    for limb in limbs.values():
        if poses.has_weights and not all(map(poses.moves_points, limb[:2])):
            continue
        for over in tree.way(-1, limb[0])[:-1]:
            for child in tree.below[over]:
                branch = {child, *tree.branch(child)}
                if not branch & own and runs_along(tree, child, limb):
                    found |= branch
    return frozenset(found)


def worn_beside(tree: Tree, poses: Poses, limbs: _Known, bones: Mapping[str, int]) -> frozenset[int]:
    """The joints of further chains of a person, whose four limbs are these, that these do not explain.

    However it is called, what hangs at the hips, or is called a leg, is no leg unless it stands on the ground
    away from the legs; what is short, or hangs at the head, is no limb. Wings stay, and so do what is of the
    middle, as a tail, what is called as the limbs are, and what runs along one: either of both may be the
    limb. bones: by name, as far as they are known.
    """
    person = _person(tree, limbs)
    if person is None or (poses.has_weights and not all(map(poses.moves_points, person.starts))):
        return frozenset()
    own, names = {*bones.values(), *chain.from_iterable(limbs.values())}, tree.rig.names
    called = {_words(names[node]) for limb in limbs.values() for node in limb} - {("", "")}
    head = {bones[bone] for bone in ("head", "neck") if bones.get(bone) in tree.below}
    around = {over for node in (*person.starts, *head) for over in tree.way(-1, node)}
    found, queue = set[int](), [k for over in around for k in tree.below[over] if k not in around]
    for child in queue:  # it grows as it is walked: what branches in the middle holds what is of one side
        if child in own or _words(names[child]) in called:
            continue
        if person.is_in_the_middle(tree.at[child]):
            queue += tree.below[child] if len(tree.below[child]) > 1 else ()
        elif own.isdisjoint(branch := tree.branch(child)) and _is_worn(tree, child, person, head):
            found.update(() if any(runs_along(tree, child, limb) for limb in limbs.values()) else branch)
    return frozenset(found)


def _words(name: str) -> tuple[str, str]:
    """The words of a name, without its number, and its side."""
    parsed = parse_name(name)
    return parsed.plain, parsed.side


@dataclass(frozen=True)
class _Person:
    """Where someone stands whose four limbs are known. legs, arms: how long these are, in file units.

    starts: the joints where all four begin. thighs: where the legs do. up, across: unit directions.
    """

    starts: tuple[int, ...]
    thighs: tuple[Vector, Vector]
    hips: Vector
    shoulders: Vector
    feet: Vector
    up: Vector
    across: Vector
    legs: float
    arms: float

    def is_in_the_middle(self, place: Vector) -> bool:
        return abs((place - self.hips).dot(self.across)) < _ASIDE * self.legs

    def is_low(self, place: Vector) -> bool:
        """Whether a place is nearer to where the legs begin than to where the arms do, in height."""
        return (place - (self.hips + self.shoulders) * 0.5).dot(self.up) < 0.0

    def hangs(self, start: Vector, end: Vector) -> bool:
        return (start - end).unit.dot(self.up) > _HANGS

    def stands(self, start: Vector, path: Iterable[Vector]) -> bool:
        """Whether a chain ends as low as the legs do, and begins away from them."""
        lowest = min((place - self.feet).dot(self.up) for place in path)
        ways = [start - thigh for thigh in self.thighs]
        aside = min((way - self.up * way.dot(self.up)).length for way in ways)
        return lowest < _GROUND * self.legs and aside > _APART * self.legs


def _person(tree: Tree, limbs: _Known) -> _Person | None:
    """The person that two arms and two legs are of; None where there are not four, or it is not upright."""
    four = [limbs.get((kind, side), ()) for kind in BENDS for side in _SIDES]
    if not all(four) or any(node not in tree.below for limb in four for node in limb):
        return None
    places = {kind: [[tree.at[node] for node in limbs[kind, side]] for side in _SIDES] for kind in BENDS}
    hips, shoulders = (_middle(at[0] for at in places[kind]) for kind in ("leg", "arm"))
    feet = _middle(at[2] for at in places["leg"])
    up = (hips - feet).unit
    down = min((at[0] - at[2]).unit.dot(up) for at in places["leg"])
    if min(down, (shoulders - hips).unit.dot(up)) < _UPRIGHT:
        return None
    left, right = (at[0] for at in places["leg"])
    lengths = [sum(b.distance(a) for a, b in pairwise(places[kind][0])) for kind in ("leg", "arm")]
    starts = tuple(limb[0] for limb in four)
    return _Person(starts, (left, right), hips, shoulders, feet, up, (left - right).unit, *lengths)


def _middle(places: Iterable[Vector]) -> Vector:
    one, other = places
    return (one + other) * 0.5


def _is_worn(tree: Tree, start: int, person: _Person, head: Collection[int]) -> bool:
    """Whether a chain that begins here is no limb of a person, for where it begins and ends."""
    path = tree.paths[start]
    names = [tree.rig.names[node] for node in path]
    kinds = {limb_words(name).kind for name in names} - {""}
    if len(path) < 2 or (not kinds and (len(path) < 3 or tree.above[start] in head)):
        return False
    if any("wing" in roles_in_name(name) for name in names):
        return False
    first, end, along = tree.at[start], tree.at[path[-1]], tree.along[start]
    low = person.is_low(first)
    if along < _SHORT * (person.legs if low else person.arms) or tree.above[start] in head:
        return True
    if low or "leg" in kinds:
        return not person.stands(first, map(tree.at.__getitem__, path)) and (
            not low or person.hangs(first, end)
        )
    return False


def limbs_in_words(limbs: Sequence[Limbs]) -> _Known:
    """The two arms and the two legs of which single words name all three joints best; either side is left."""
    found: dict[tuple[LimbKind, Side], tuple[int, ...]] = {}
    for kind in BENDS:
        called = [each for each in limbs if each.kind == kind and len(each.at) == 3]
        best = max(called, key=lambda each: each.named, default=None)
        if best is None or best.named < _NAMED or sum(each.named == best.named for each in called) > 1:
            return {}
        found |= {(kind, "left"): best.joints(0), (kind, "right"): best.joints(1)}
    return found


def limbs_of_person(body: Body | None, limbs: Sequence[Limbs]) -> _Known:
    """The two arms and the two legs of a person by shape of which names say no more than which is which.

    Where single words name all joints of another pair there are two bodies: a rider has legs of its own.
    """
    if body is None or not is_person(body):
        return {}
    others = (k for k in limbs if k not in (body.legs, body.arms) and k.kind in BENDS)
    if any(k.named >= _NAMED for k in others):
        return {}
    both: tuple[tuple[LimbKind, Limbs | None], ...] = (("leg", body.legs), ("arm", body.arms))
    known = [(kind, limbs) for kind, limbs in both if limbs is not None and len(limbs.at) == 3]
    return {(kind, _SIDES[which]): limbs.joints(which) for kind, limbs in known for which in (0, 1)}


def known_limbs(reading: Reading | None, certain: Mapping[str, int]) -> _Known:
    """The known limbs of three joints, by kind and side."""
    if not certain:
        return reading.limbs if reading is not None else {}
    found = {
        (kind, side): tuple(certain[side + part] for part in parts if side + part in certain)
        for kind, parts in BENDS.items()
        for side in _SIDES
    }
    return {which: joints for which, joints in found.items() if len(joints) == 3}


def lies_along(tree: Tree, joints: Sequence[int], limb: Collection[int]) -> bool:
    """Whether the joints of a limb stand, in order, beside the bones between others.

    Joints of cloth part an arm at other places than its elbow does.
    """
    line = [tree.at[node] for node in joints]
    places = [tree.at[node] for node in limb]
    near = _ALONG * sum(b.distance(a) for a, b in pairwise(places))
    reached = 0.0
    for place in places if len(line) > 2 else ():
        ways = ((k, *_beside(place, a, b)) for k, (a, b) in enumerate(pairwise(line)))
        found = [k + far for k, far, apart in ways if apart <= near and k + far >= reached]
        if not found:
            return False
        reached = min(found)
    return reached > 1.0


def _beside(place: Vector, a: Vector, b: Vector) -> tuple[float, float]:
    """How far along a bone a place is, 0 to 1, and how far from there."""
    bone = b - a
    far = max(0.0, min(1.0, (place - a).dot(bone) / max(bone.dot(bone), 1e-30)))
    return far, (place - a - bone * far).length


def runs_along(tree: Tree, start: int, limb: Collection[int]) -> bool:
    """Whether joints of one chain at or below ``start`` stand near those of a limb, one after another."""
    places = [tree.at[node] for node in limb]
    near = _ALONG * sum(b.distance(a) for a, b in pairwise(places))
    reached = tree.branch(start)
    for place in places:
        reached = [node for node in reached if tree.at[node].distance(place) <= near]
        if place is not places[-1]:
            reached = [below for node in reached for below in tree.branch(node) if below != node]
    return bool(reached)
