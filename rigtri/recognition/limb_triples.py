"""The three joints of a limb: shoulder, elbow and wrist in a chain of clavicles, twist joints and fingers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations, pairwise
from math import fsum, sqrt
from typing import Literal

import numpy as np

from rigtri.maths.angle_limits import sine_below
from rigtri.maths.scalar_vector import Vector
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot, normalise
from rigtri.model.dataclass import dataclass
from rigtri.recognition.bone_noise import STRAIGHT, straight_within
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.layout import LimbKind
from rigtri.recognition.limb_ends import HAND, branches
from rigtri.recognition.limb_words import NO_WORDS, LimbWords, agreement, in_order
from rigtri.recognition.pose_samples import Poses, finite

# What joints within a bone cost, and what it costs where they do not part it evenly.
_WITHIN, _UNEVEN = 0.08, 0.25
# Joints nearer than this part of a limb to each other are in one place.
SAME_PLACE = 0.01
# What it costs where only one of both bones has as many parts.
_UNLIKE = 0.05
# What a first bone costs that is too long for a clavicle, and from which part of the upper bone on: a joint
# is skipped.
_LED, _SHORT = 0.25, 0.45
# Arms that begin so near to each other, as a part of their length, run aside there (a cosine, 45°) and have
# a whole limb behind their first bone begin with clavicles, however long these are.
CLAVICLES, _ASIDE, _WHOLE = 0.35, 0.7, 0.65
# Joints of twins so near to each other, as a part of how far apart the next ones are, stand in the middle;
# and what follows is a limb where its bones are so much like those of one.
_TOGETHER, _LIMB = 0.1, 0.45
# What a middle costs that is bent as an ankle is at rest, and how far that is, as a cosine (70°).
_FOLD, _FOLDED = 0.1, 0.34
# Bones in line bend by less than 15°, and a foot is set off from its shin by more than 25° (cosines).
IN_LINE, SET_OFF = 0.966, 0.906
# A joint within a bone bends no further than this, as a cosine (25°).
_WITHIN_BONE = 0.9
# What a joint that clips bend gains as the middle, and how sharp that has to be, as a cosine (15°).
_MOVES, _SHARP = 0.1, 0.966
# What it costs to end elsewhere than where the fingers of a hand begin.
_HANDLESS = 0.25
# What names of all three joints weigh against the shape of a limb.
_NAMED = 0.6
# What a middle costs that points where no knee, or elbow, does, and how far off the line that is in full.
_WRONG_WAY, _BENT = 0.35, 0.08
# Knees and hocks bend less far aside than this (a sine).
_SIDEWAYS = sine_below(30)
# Axes of one joint stand so far apart along a bone, as a part of it, where one of them turns the bone.
_AXIS_WITHIN = 0.3
# What is left of a shape that is hardly a limb's where names tell all three joints.
_LITTLE = 0.01
# Three joints so much less limb-like than others of the chain are not what names say, or names are wrong.
_DISPUTED = 0.25
# Longer chains are looked at as far as this: no limb has so many joints.
_MOST = 11
# Noise that explains bends of more than 10° (a cosine), where another middle is as limb-like but for so much.
_NOISY, _DOUBTED = 0.985, 0.4
# Clips bend a joint clearly by more than this (a cosine, 45°), and further than what noise may take for it.
_SHOWN = 0.7
# Where a chain could bend at two places almost as well, it is not clear which.
TIE = 0.05


@dataclass(frozen=True)
class Triple:
    """Three places within a path: start, middle, end. quality: how limb-like, 0 to 1; lead: over the
    next best; size: the length of both bones, file units; named: how far names say the same, −1 to 1.
    is_noisy: noise may take another middle for this one. others: three that are much more limb-like, so that
    names alone have led to these; () where there are none."""

    at: tuple[int, int, int]
    quality: float
    lead: float
    size: float
    named: float = 0.0
    is_noisy: bool = False
    others: tuple[int, ...] = ()


def sharpest_of(tree: Tree, poses: Poses) -> list[float]:
    """The cosine of the bend at the joint above each node, (n,), where clips bend it most; [] without any.

    1 where either bone has no length; of no meaning for what has less than two nodes above it.
    """
    if not len(poses.moving):
        return []
    # Of a crowd each character has a tree: what the others do is not looked at.
    nodes = np.array(tree.nodes, dtype=np.int64)
    above, row = np.array(tree.above, dtype=np.int64), np.zeros(len(tree.above), dtype=np.int64)
    row[nodes] = np.arange(len(nodes))
    along = normalise(poses.moving[:, nodes] - poses.moving[:, above[nodes]])
    sharpest = np.ones(len(above))
    sharpest[nodes] = finite(dot(along, along[:, row[above[nodes]]]), 1.0).min(axis=0)
    return sharpest.tolist()


def triple_of(
    tree: Tree,
    paths: Sequence[Sequence[int]],
    sharpest: Sequence[float],
    names: Mapping[int, LimbWords],
    towards: Vector | None = None,
    kind: LimbKind | Literal[""] = "",
) -> Triple | None:
    """Where a path bends like an arm or leg; None for one of fewer than three joints.

    paths: of the limb and its twin, whose names say as much of it.

    sharpest: as `sharpest_of`. It counts for paths of more than three joints, which follow the tree.
    names: what the names of joints say. towards: where knees, or elbows, of this limb point, unit. kind: the
    arms of what stands upright, which may begin with clavicles, or legs, which toes do not end: they are
    those of a paw, or begin behind the ball of a foot.
    """
    stop, fingers = branches(tree, paths[0])
    path = list(paths[0][: min(stop + 1, _MOST)])
    if len(path) < 3:
        return None
    moves = len(path) > 3 and len(sharpest) > 0
    now = _cosines(tree, path)
    least = (min(now[k], sharpest[after]) for k, after in enumerate(path[2:], 1))
    ever = [1.0, *least, 1.0] if moves else now
    bones = [tree.bone[node] for node in path]
    straight = straight_within(tree, paths, bones, STRAIGHT)
    every = ([names.get(node, NO_WORDS) for node in each[: len(path)]] for each in paths)
    words_of = [words for words in every if any(word.levels for word in words)]
    levels_of = [in_order(words) for words in words_of]
    axes_of = [words for words in words_of if any(word.joint for word in words)]  # of robots
    further = {k for words in axes_of for k in range(1, len(path) - 1) if _is_axis_apart(words, bones, k)}
    straight = [-1.0 if k in further else least for k, least in enumerate(straight)]
    places, first, found = list(combinations(range(len(path)), 3)), 0, []
    whole = _LIMB if begin_as_one(tree, paths) else _WHOLE
    if whole < _WHOLE or (kind == "arm" and _leads_aside(tree, paths, len(path))):
        behind = (_quality(bones, at, now, ever, straight, moves, 1) for at in places if at[0])
        first = int(max(behind, default=0.0) > whole)
    for at in places:
        quality = _quality(bones, at, now, ever, straight, moves, min(first, at[0]))
        if quality == 0.0 or any(_is_of_axes(tree, path, words, at) for words in axes_of):
            continue  # a joint between bends, a bone has no length, or is between axes of one joint
        quality -= _LED if at[0] < first else 0.0
        led = fsum(bones[first + 1 : at[0] + 1]) > SAME_PLACE * _size(bones, at)  # by no group
        quality -= _LED if kind == "leg" and led and now[at[0]] > STRAIGHT else 0.0
        quality -= _HANDLESS if fingers >= HAND and at[2] < len(path) - 1 and kind != "leg" else 0.0
        named = fsum([agreement(levels, at) for levels in levels_of]) / max(1, len(levels_of))
        if towards is not None:
            quality -= _WRONG_WAY * _away(tree, [path[k] for k in at], towards)
        quality = _LITTLE if quality < _LITTLE and named == 1.0 else quality
        if quality > 0:
            found.append((quality + _NAMED * named, at, quality, named))
    if not found:
        return None
    order = sorted(found, key=lambda one: one[0], reverse=True)
    # Of axes in one place the start is the last one and the end the first, unless names say otherwise.
    same = [one for one in order if _are_in_one_place(bones, order[0][1], one[1])]
    best, at, quality, named = max(same, key=lambda one: (round(one[3], 9), *one[1][:2], -one[1][2]))
    others = [one for one in order if one[1] != at]
    likest = max(found, key=lambda one: one[2])
    disputed = likest[1] if likest[2] - quality > _DISPUTED else ()
    named -= 1.0 if disputed else 0.0  # shape says otherwise: names alone make nothing sure
    second = next((one[0] for one in others if not _are_in_one_place(bones, at, one[1])), 0.0)
    rivals = [one for one in others if one[1][1] != at[1]]
    noisy = quality - max((one[2] for one in rivals), default=0.0) < _DOUBTED
    noisy = noisy and min(straight[1 : at[2] + 1]) < _NOISY
    shown = moves and ever[at[1]] < min([_SHOWN, *(ever[one[1][1]] for one in rivals)])
    return Triple(at, quality, best - second, _size(bones, at), named, noisy and not shown, disputed)


def _size(bones: list[float], at: Sequence[int]) -> float:
    """The length of a limb along its bones, from its start to its end."""
    return fsum(bones[at[0] + 1 : at[2] + 1])


def _are_in_one_place(bones: list[float], at: Sequence[int], other: Sequence[int]) -> bool:
    """Whether three joints stand where three others of a path do: other axes of the same joints."""
    apart = (fsum(bones[min(a, b) + 1 : max(a, b) + 1]) for a, b in zip(at, other, strict=True))
    return max(apart) <= SAME_PLACE * _size(bones, at)


def _is_of_axes(tree: Tree, path: Sequence[int], words: Sequence[LimbWords], at: Sequence[int]) -> bool:
    """Whether a limb has two axes of one joint, or starts or ends at one that is within a bone."""
    return _are_axes(words, at) or _is_axis_within(tree, path, words, at)


def _are_axes(words: Sequence[LimbWords], at: Sequence[int]) -> bool:
    """Whether names call two of three joints in turn axes of one: ``hip_roll`` and ``hip_pitch``."""
    called = [words[k].joint for k in at]
    return any(one and one == other for one, other in pairwise(called))


def _is_axis_apart(words: Sequence[LimbWords], bones: Sequence[float], at: int) -> bool:
    """Whether names call a joint an axis of the one before or after it, which stands elsewhere.

    It may stand aside of a bone.
    """
    least = SAME_PLACE * fsum(bones[1:])
    apart = (words[k] for k, bone in ((at - 1, bones[at]), (at + 1, bones[at + 1])) if bone > least)
    return bool(words[at].joint) and any(each.joint == words[at].joint for each in apart)


def _is_axis_within(tree: Tree, path: Sequence[int], words: Sequence[LimbWords], at: Sequence[int]) -> bool:
    """Whether a limb starts or ends at an axis that robots have within a bone, of a joint at its far end.

    Shoulders that pitch and roll often yaw in the upper arm, and wrists yaw in the forearm.
    """
    start, middle, end = (tree.at[path[k]] for k in at)
    upper, lower = middle - start, end - middle
    before = (start - tree.at[path[k]] for k in range(at[0]) if words[k].joint == words[at[0]].joint != "")
    after = range(at[2] + 1, len(path))
    beyond = (tree.at[path[k]] - end for k in after if words[k].joint == words[at[2]].joint != "")
    early = any(way.dot(upper.unit) > _AXIS_WITHIN * upper.length for way in before)
    return early or any(way.dot(lower.unit) > _AXIS_WITHIN * lower.length for way in beyond)


def begin_as_one(tree: Tree, paths: Sequence[Sequence[int]], together: float = _TOGETHER) -> bool:
    """Whether a limb begins where its twin does, in the middle: with a bone to the hip or shoulder."""
    if len(paths) < 2:
        return False
    (one, on), (other, off) = ((tree.at[path[0]], tree.at[path[1]]) for path in paths)
    return one.distance(other) < together * on.distance(off)


def _leads_aside(tree: Tree, paths: Sequence[Sequence[int]], count: int) -> bool:
    """Whether the first of ``count`` joints of both paths stand where clavicles begin, and lead aside."""
    if len(paths) < 2 or count < 4:
        return False
    (one, on), (other, off) = ((tree.at[path[0]], tree.at[path[1]]) for path in paths)
    size = fsum(tree.bone[node] for node in paths[0][1:count])
    across = (on - off).unit
    aside = min((on - one).unit.dot(across), (off - other).unit.dot(-across))
    return aside > _ASIDE and one.distance(other) < CLAVICLES * size


def _away(tree: Tree, joints: Sequence[int], towards: Vector) -> float:
    """How far the middle of three joints stands to the other side than knees, or elbows, do: 0 to 1."""
    return max(0.0, min(1.0, -beside(tree, joints).dot(towards) / _BENT))


def beside(tree: Tree, joints: Sequence[int]) -> Vector:
    """How far the middle of three joints stands beside the line of both ends, as a part of that."""
    start, middle, end = (tree.at[k] for k in joints)
    line, arm = end - start, middle - start
    return (arm - line.unit * arm.dot(line.unit)) * (1.0 / max(line.length, 1e-30))


def first_bend(tree: Tree, path: Sequence[int], at: Sequence[int], lateral: Vector) -> Vector | None:
    """Where a leg that bends to and fro bends first, unit: its knee points there, and its hock back.

    at: start, middle and end that it is taken to have in its path. None where no long bone comes before
    these, or it bends aside, along ``lateral``, or on.
    """
    start, middle, end = at
    if start == 0 or tree.bone[path[start]] < _SHORT * tree.bone[path[middle]]:
        return None
    first = beside(tree, [path[start - 1], path[start], path[middle]])
    second = beside(tree, [path[start], path[middle], path[end]])
    aside = any(abs(bend.unit.dot(lateral)) > _SIDEWAYS for bend in (first, second))
    to_and_fro = min(first.length, second.length) > _BENT and first.dot(second) < 0.0
    return first.unit if to_and_fro and not aside else None


def _cosines(tree: Tree, path: Sequence[int]) -> list[float]:
    """The cosine of the bend at each joint of a path; 1 at both ends, and above a bone without length.

    Of joints in one place, a group and what it holds, the bend is that of the last: bones so short point
    wherever noise does.
    """
    bones = [tree.at[b] - tree.at[a] for a, b in pairwise(path)]
    least, along = SAME_PLACE * fsum(bone.length for bone in bones), list[Vector]()
    for bone in bones:
        along.append(bone.unit if bone.length > least else along[-1] if along else Vector())
    inner = [a.dot(b) if any(a) and any(b) else 1.0 for a, b in pairwise(along)]
    return [1.0, *inner, 1.0]


def _quality(
    bones: list[float],
    at: tuple[int, int, int],
    now: list[float],
    ever: list[float],
    straight: list[float],
    moves: bool,
    first: int,
) -> float:
    """How limb-like three places of a path are: two long bones about as long as each other.

    first: the place where the limb begins, after a clavicle. straight: see
    `straight_within`.
    """
    start, middle, end = at
    if any(ever[k] < straight[k] for k in range(start + 1, end) if k != middle):
        return 0.0
    parts = bones[start + 1 : middle + 1], bones[middle + 1 : end + 1]
    a, b = map(fsum, parts)
    # Axes of one joint in one place part no bone.
    upper, lower = ([bone for bone in each if bone > SAME_PLACE * (a + b)] for each in parts)
    if min(a, b) <= 0.0:
        return 0.0
    balance, cover = min(a, b) / max(a, b), (a + b) / fsum(bones[first + 1 :])
    cost = 0.0
    for bone in (upper, lower):
        if len(bone) > 1:
            cost += _WITHIN + _UNEVEN * (1.0 - min(bone) / max(bone))
    cost += _UNLIKE if len(upper) != len(lower) and len(upper) + len(lower) > 2 else 0.0
    # What comes before an upper bone is a clavicle, and shorter.
    before = fsum(bones[first + 1 : start + 1]) / a
    led = min(1.0, max(0.0, (before - _SHORT) / 0.6))
    # Where a long bone goes straight on into the upper one, a bend is that of an ankle, before a long foot.
    led *= 2.0 if now[start] > IN_LINE and now[middle] < SET_OFF else 1.0
    cost += _LED * led
    cost += _FOLD if now[middle] < _FOLDED else 0.0
    gain = _MOVES if moves and ever[middle] < _SHARP else 0.0
    return sqrt(balance) * cover - cost + gain


def offset(start: Floats, middle: Floats, end: Floats) -> Floats:
    """From the line of start and end to the middle, (..., 3), in file units: where a limb bends to."""
    line, arm = finite(normalise(end - start)), middle - start
    return arm - dot(arm, line)[..., np.newaxis] * line


def within_upper(tree: Tree, path: Sequence[int], at: Sequence[int]) -> int:
    """The one joint within the upper bone of a limb, groups that stand where another does aside; or −1."""
    start, middle = (tree.at[path[k]] for k in at[:2])
    least = SAME_PLACE * middle.distance(start)
    inner = [
        k
        for k in path[at[0] + 1 : at[1]]
        if min(tree.at[k].distance(start), tree.at[k].distance(middle), tree.bone[k]) > least
    ]
    return inner[0] if len(inner) == 1 else -1


def bends_within(tree: Tree, joints: Sequence[int]) -> bool:
    """Whether one of the joints between start, middle and end bends, so that it is none within a bone."""
    at = tree.at
    for start, end in pairwise(joints):
        if tree.is_below(end, start):
            way = tree.way(start, end)
            for over, node, under in zip(way, way[1:], way[2:], strict=False):
                one, other = at[node] - at[over], at[under] - at[node]
                if any(one) and any(other) and one.unit.dot(other.unit) < _WITHIN_BONE:
                    return True
    return False
