"""Pairs of branches as limbs: where they bend, what ends them, and what names say that they are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Literal

from rigtri.maths.scalar_vector import Vector
from rigtri.model.dataclass import dataclass
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.layout import LimbKind
from rigtri.recognition.limb_ends import HAND, branches, counted_on, ends_in_muscle, has_thumb, loose_ends
from rigtri.recognition.limb_triples import CLAVICLES, Triple, sharpest_of, triple_of
from rigtri.recognition.limb_words import LEVELS, NO_WORDS, LimbWords, Place
from rigtri.recognition.naming_schemes import BESIDE, NO_LIMB, roles_in_name
from rigtri.recognition.pose_samples import Poses
from rigtri.recognition.symmetry import Pair

# So many of the longest pairs are tried as legs and as arms.
TRIED = 10
# How far names say three joints of which they call two clearly, and the third nothing, but for rounding.
_TWO_OF_THREE = 0.66
# A first bone that is shorter than this part of the next may be a clavicle.
_COLLAR = 0.5


@dataclass(frozen=True, eq=False)
class Limbs:
    """Two limbs that are alike. at: places of start, middle and end in ``pair.paths``; of two joints where
    there is no end. starts, ends: where they are, in the middle between both. size: of both bones,
    file units. fingers: how many chains there are at the end. thumb: whether one of three or more stands
    apart. quality: how limb-like, 0 to 1. lead: over other places to bend. named: how far names say the
    same three joints, −1 to 1. kind, place: what names say that it is, ``other`` for no limb at all.
    is_noisy: noise may take another middle for this one. others: places of three that are much more
    limb-like, so that names alone have led to these; () where there are none."""

    pair: Pair
    at: tuple[int, ...]
    starts: Vector
    ends: Vector
    size: float
    fingers: int
    thumb: bool
    quality: float
    lead: float
    named: float = 0.0
    kind: LimbKind | Literal["other", ""] = ""
    place: Place = ""
    is_noisy: bool = False
    others: tuple[int, ...] = ()

    def joints(self, which: int) -> tuple[int, ...]:
        """Start, middle and end of one of the two, or start and end."""
        return self._both[which]

    @cached_property
    def _both(self) -> list[tuple[int, ...]]:
        return [tuple([path[k] for k in self.at]) for path in self.pair.paths]


def _like_clavicles(tree: Tree, limbs: Limbs) -> bool:
    """Whether the first bones of two arms are short, or begin as near to each other, as clavicles do."""
    (start, middle, end), twin = limbs.joints(0), limbs.joints(1)[0]
    short = tree.bone[middle] < _COLLAR * tree.bone[end]
    return short or tree.at[start].distance(tree.at[twin]) < CLAVICLES * limbs.size


def ends_in_hand(limbs: Limbs) -> bool:
    """Whether both limbs bend and end in fingers with a thumb: arms, whatever body they are of."""
    return len(limbs.at) == 3 and limbs.thumb and limbs.fingers >= HAND and not limbs.kind


def lacks_hand(tree: Tree, limbs: Limbs) -> bool:
    """Whether arms of no more than three joints may be clavicle, upper arm and forearm, without a hand.

    Or their hands are joints elsewhere that only stand in the right place.
    """
    if len(limbs.at) < 3 or limbs.named > 0:
        return False
    _, middle, end = limbs.joints(0)
    whole = limbs.at[0] == 0 and limbs.at[2] == len(limbs.pair.paths[0]) - 1
    return (whole and _like_clavicles(tree, limbs)) or not tree.is_below(end, middle)


def limbs_of(
    tree: Tree,
    pairs: Sequence[Pair],
    poses: Poses,
    names: Mapping[int, LimbWords],
    towards: Vector | None = None,
    kind: LimbKind | Literal[""] = "",
) -> list[Limbs]:
    """The pairs as limbs, with where each bends by its shape and by names.

    towards: where their knees, or elbows, point, where that is known. kind: as `triple_of` has it.
    """
    tried, found = pairs[: 3 * TRIED], []
    sharpest = sharpest_of(tree, poses) if any(len(pair.paths[0]) > 3 for pair in tried) else []
    for each in tried:
        pair = counted_on(tree, each) if names.get(each.paths[0][-1], NO_WORDS).kind else each
        bend = triple_of(tree, pair.paths, sharpest, names, towards, kind)
        muscle = len(pair.paths[0]) == 3 and all(ends_in_muscle(tree, path, names) for path in pair.paths)
        if bend is None or muscle or (len(pair.paths[0]) <= 3 and bend.quality < 0.3):
            pair = loose_ends(tree, pair, poses, names)
            bend = triple_of(tree, pair.paths, sharpest, names) if len(pair.paths[0]) > 2 else None
        if bend is not None or len(pair.paths[0]) > 1:
            limbs = _limbs(tree, pair, bend)
            words = [names[k] for k in (*limbs.joints(0), *limbs.joints(1)) if k in names]
            limbs = replace(limbs, kind=_kind_of(limbs, words, poses), place=_place_of(limbs, names))
            found.append(replace(limbs, named=1.0) if _is_armed(tree, limbs, names) else limbs)
    return found


def _is_armed(tree: Tree, limbs: Limbs, names: Mapping[int, LimbWords]) -> bool:
    """Whether names say upper and lower arm, and a gun alone follows: a machine's, in place of a hand.

    What is only held moves no points, and is of no limb.
    """
    if limbs.kind != "arm" or len(limbs.at) < 3 or limbs.named < _TWO_OF_THREE:
        return False
    for *bones, end in (limbs.joints(0), limbs.joints(1)):
        words = [names.get(joint, NO_WORDS) for joint in bones]
        clear = all(word.levels == {level: 1.0} for word, level in zip(words, LEVELS[1:3], strict=True))
        beside = {k: BESIDE.intersection(roles_in_name(tree.rig.names[k])) for k in tree.below[bones[1]]}
        follow = [k for k, roles in beside.items() if not roles or "attachment" in roles]
        if not clear or follow != [end] or "attachment" not in beside[end]:
            return False
    return True


def _limbs(tree: Tree, pair: Pair, bend: Triple | None) -> Limbs:
    at = bend.at if bend else (0, branches(tree, pair.paths[0])[0])
    pair = _middlemost(tree, pair, at[-1]) if bend else pair
    one, other = pair.paths
    starts, ends = ((tree.at[one[k]] + tree.at[other[k]]) * 0.5 for k in (at[0], at[-1]))
    count = min(branches(tree, path)[1] for path in pair.paths)
    size = bend.size if bend else pair.reach
    quality, lead, named = (bend.quality, bend.lead, bend.named) if bend else (0.2, 0.0, 0.0)
    thumb = count > 2 and all(has_thumb(tree, path) for path in pair.paths)
    noisy, others = (bend.is_noisy, bend.others) if bend else (False, ())
    found = starts, ends, size, count, thumb, quality, lead, named
    return Limbs(pair, at, *found, is_noisy=noisy, others=others)


def _kind_of(limbs: Limbs, words: Sequence[LimbWords], poses: Poses) -> LimbKind | Literal["other", ""]:
    """What names say that two limbs are; ``other`` where one says a trunk, a wing, or something worn.

    The arm of a machine may end in its gun. What is called a control and moves points is a bone, as in rigs
    whose joints all are (``CTRL_FK_Thigh_L``).
    """
    kinds: set[LimbKind] = {word.kind for word in words if word.kind}
    kind = kinds.pop() if len(kinds) == 1 else ""
    for *bones, end in (limbs.joints(0), limbs.joints(1)):
        armed = kind and len(bones) == 2 and poses.moves_anything(end)
        roles = {role for joint in bones for role in poses.roles_of(joint)}
        roles |= {role for role in poses.roles_of(end) if not (armed and role == "attachment")}
        if NO_LIMB & roles:
            return "other"
    return "other" if any(word.trunk for word in words) else kind


def _place_of(limbs: Limbs, names: Mapping[int, LimbWords]) -> Place:
    """Whether names say that a limb is one in front or behind.

    A foreleg that follows a leg is a shin, as a forearm follows an arm.
    """
    places: list[set[Place]] = []
    for joints in (limbs.joints(0), limbs.joints(1)):
        start, *rest = (names.get(k, NO_WORDS) for k in joints)
        shin = start.kind == "leg" and not start.place and rest[0].place == "front"
        places.append({word.place for word in (start, *rest[shin:]) if word.place})
    # ``lf`` is front left where ``rf`` is front right, and left where ``rt`` is right.
    return places[0].pop() if places[0] == places[1] and len(places[0]) == 1 else ""


def _middlemost(tree: Tree, pair: Pair, at: int) -> Pair:
    """The pair with the middle one for its end, where several joints begin at that place: of a palm."""
    ends = [_middle_of(tree, path[at]) for path in pair.paths]
    if [path[at] for path in pair.paths] == ends:
        return pair
    one, other = ((*path[:at], end, *tree.paths[end][1:]) for path, end in zip(pair.paths, ends, strict=True))
    same = min(len(one), len(other))  # the finger of one hand may have a joint more
    return replace(pair, paths=(one[:same], other[:same]))


def _middle_of(tree: Tree, node: int) -> int:
    """Of the joints that stand where ``node`` does, under one, the one whose branch ends midmost."""
    near = 0.01 * (tree.bone[node] + tree.reach[node])
    same = [
        k for k in tree.below[tree.above[node]] if tree.below[k] and tree.at[k].distance(tree.at[node]) < near
    ]
    if len(same) < 3:
        return node
    tips = [tree.at[tree.paths[k][-1]] for k in same]
    spread = [max(other.distance(tip) for other in tips) for tip in tips]
    return same[spread.index(min(spread))]
