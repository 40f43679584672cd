"""Where limbs end: in fingers, of which one may be a thumb, in toes, or in a joint elsewhere.

Feet and hands of flat IK rigs are children of the root: `loose_ends` finds these.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations

from rigtri.maths.angle_limits import cosine_below
from rigtri.recognition.bone_noise import STRAIGHT
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_words import NO_WORDS, LimbWords, other_words
from rigtri.recognition.name_parsing import numbers_in, parse_name
from rigtri.recognition.naming_schemes import roles_in_name
from rigtri.recognition.pose_samples import Poses, how_far
from rigtri.recognition.symmetry import Pair
from rigtri.text import is_number

# So many fingers make a hand, and so many joints a finger.
HAND, _FINGER = 4, (2, 3, 4)
# Nearer to each other than this part of the bone before them, two ends are one.
_ONE_PLACE = 0.02
# A thumb begins this much nearer to the wrist than fingers do, or points this far aside (a cosine).
_NEAR, _APART = 0.7, cosine_below(20)
# The outer toes of a paw spread less far than this (a cosine).
_SPREAD = cosine_below(30)
# So many toes make a paw, of those that reach ahead by this part of the furthest one, at least.
# One is as near to the middle as another if that is nearer by less than this part of what the outermost are.
PAW, _REACHING, _AS_NEAR = 3, 0.6, 0.3
# The lower bone is as long as this, of the upper one, at least and at most.
_SHORTEST, _LONGEST = 0.5, 1.7
# It goes on, as a cosine: a limb at rest is not folded.
_ONWARD = 0.5
# Joints nearer to each other than this part of the bone before them may be one middle of a limb.
_BESIDE = 0.3
# Hands, feet, and the cannon bone and hoof of a horse (0.7), reach less far beyond the limb, of its length.
_FURTHER = 0.75


def next_toe(tree: Tree, ahead: Mapping[int, float], slack: float, past: float) -> int:
    """The toe that a foot goes on with: the first of those that reach furthest ahead, to ``slack``.

    Of a paw the midmost: its toes are alike, which reaches furthest is noise, and the outer ones go aside.

    ahead: how far toes reach. past: how far the joint above them does, for paws; for other feet infinite.
    """
    furthest = max(ahead.values())
    toes = [k for k, far in ahead.items() if 0.0 < _REACHING * (furthest - past) <= far - past]
    if len(toes) < PAW:
        return next(k for k, far in ahead.items() if far >= furthest - slack)
    apart = [max(tree.at[k].distance(tree.at[other]) for other in toes) for k in toes]
    near = min(apart) + _AS_NEAR * (max(apart) - min(apart))
    return next(k for k, far in zip(toes, apart, strict=True) if far <= near)


def moves_as_finger(tree: Tree, poses: Poses, root: int) -> bool:
    """Whether a chain has as many joints as a finger, which all move points but for its end."""
    chain = tree.paths[root]
    chain = chain if poses.moves_points(chain[-1]) else chain[:-1]
    return len(chain) in _FINGER and all(map(poses.moves_points, chain))


def thumb_of(tree: Tree, hand: int, chains: Sequence[Sequence[int]], apart: float = _APART) -> int:
    """Which chain begins clearly nearer to the wrist than the others; −1 for none.

    Fingers with metacarpals all begin there: of these the one whose first bone goes another way than any
    other, and that of fewer joints where one has.

    apart: the cosine of how far another way that is.
    """
    at = tree.at
    far = [at[chain[0]].distance(at[hand]) for chain in chains]
    usual = sorted(far)[len(far) // 2]
    near = [k for k, size in enumerate(far) if size < _NEAR * usual]
    if len(near) == 1 and _leaves_row(tree, chains, near[0]):
        return near[0]
    least = min(len(chain) for chain in chains)
    short = [k for k, chain in enumerate(chains) if len(chain) == least]
    if len(chains) < 2 or (len(chains) == 2 and len(short) == 2):
        return -1  # of two, each goes another way than the other
    first = [(at[(*chain, chain[0])[1]] - at[chain[0]]).unit for chain in chains]
    alike = [max(bone.dot(k) for k in first if k is not bone) for bone in first]
    other = min(short if len(short) == 1 else range(len(chains)), key=lambda k: alike[k])
    return other if alike[other] < apart else -1


def _leaves_row(tree: Tree, chains: Sequence[Sequence[int]], which: int) -> bool:
    """Whether a chain begins beside the row in which the others begin, or is beside them further on.

    A thumb may begin within the breadth of the knuckles, as the metacarpal of a middle finger does, which
    stays between the others. Along the row of the first joints, for a fist turns that of later ones.
    """
    at, others = tree.at, [chain for k, chain in enumerate(chains) if k != which]
    if len(others) < 2:
        return True
    one, other = max(combinations([at[k[0]] for k in others], 2), key=lambda two: two[0].distance(two[1]))
    along = (other - one).unit
    for joint in range(min(len(chain) for chain in chains)):
        places = [at[chain[joint]].dot(along) for chain in others]
        if not min(places) < at[chains[which][joint]].dot(along) < max(places):
            return True
    return False


def _is_within_row(tree: Tree, chains: Sequence[Sequence[int]], which: int, joint: int = 0) -> bool:
    """Whether a joint of a chain, the first or a later one, is between those of the others.

    As the metacarpal of a middle finger begins.
    """
    row = [tree.at[chain[joint]] for k, chain in enumerate(chains) if k != which]
    if len(row) < 2:
        return False
    one, other = max(combinations(row, 2), key=lambda two: two[0].distance(two[1]))
    along = (tree.at[chains[which][joint]] - one).dot((other - one).unit)
    return 0.0 < along < other.distance(one)


def branches(tree: Tree, path: Sequence[int]) -> tuple[int, int]:
    """Where a limb ends in fingers or toes: place in the path and how many; (last, 0) for none."""
    gone = 0.0
    for at, node in enumerate(path[1:], 1):
        gone += tree.bone[node]
        if not gone > 0.0 or len(tree.below[node]) < 2:
            continue
        below = sorted((tree.bone[k] + tree.reach[k] for k in _ways_on(tree, node)), reverse=True)
        jointed = sum(bool(tree.below[k]) and tree.bone[k] + tree.reach[k] > 0 for k in tree.below[node])
        for held, least in ((0, 2), (1, HAND)):  # one longer than the fingers of a hand is what it holds
            ways = below[held:]
            alike = sum(k > 0.35 * ways[0] for k in ways)
            if alike >= least and ways[0] < 0.75 * gone:
                return at, max(alike, jointed - held)
    return len(path) - 1, 0


def has_thumb(tree: Tree, path: Sequence[int]) -> bool:
    """Whether one of the chains that a limb ends in stands apart, beside the row of the others.

    The toes of a paw are a row, of which the middle ones may begin nearer to the wrist.
    """
    hand = path[branches(tree, path)[0]]
    chains = [tree.paths[k] for k in tree.below[hand] if len(tree.paths[k]) > 1]
    thumb = thumb_of(tree, hand, chains, _SPREAD) if len(chains) > 2 else -1
    # Beside a row that is aslant, as of curled fingers, a thumb may begin to stand apart at its end.
    least = min(map(len, chains), default=0)
    return thumb >= 0 and not all(_is_within_row(tree, chains, thumb, joint=k) for k in (1, least - 1))


def _ways_on(tree: Tree, node: int) -> list[int]:
    """The joints below one, without twist joints, which stand along a bone to another, and second ends."""
    below = tree.below[node]
    return [
        one
        for one in below
        if tree.below[one]
        or not any(_is_along(tree, one, other) or _is_second(tree, one, other) for other in below)
    ]


def _is_along(tree: Tree, one: int, other: int) -> bool:
    """Whether a joint stands within the bone to another joint below the same one."""
    at = tree.at[tree.above[one]]
    straight = (tree.at[one] - at).unit.dot((tree.at[other] - at).unit) > STRAIGHT
    return tree.bone[one] < tree.bone[other] and straight


def _is_second(tree: Tree, one: int, other: int) -> bool:
    """Whether a joint stands where another below the same one does, as a wrist beside a hand."""
    near = tree.at[one].distance(tree.at[other]) < _ONE_PLACE * tree.bone[other]
    return one != other and near and (other < one or bool(tree.below[other]))


def loose_ends(tree: Tree, pair: Pair, poses: Poses, names: Mapping[int, LimbWords]) -> Pair:
    """A pair of two joints each, with the joints elsewhere that end it; as it is where none do.

    Only joints that move points, or have such below, are taken: a control stands in the same place. And no
    joint that more hangs from than from a hand or a foot, or that has a name of the other kind of limb:
    another limb begins there.
    """
    ends = [_loose_end(tree, path[:2], poses, names) if len(path) >= 2 else -1 for path in pair.paths]
    if min(ends) < 0 or ends[0] == ends[1] or pair.nodes.intersection(ends):
        return pair
    (a, b) = (path[:2] for path in pair.paths)
    middles = [_bone_beside(tree, path, poses, names) for path in (a, b)]
    if min(middles) >= 0:
        a, b = (a[0], middles[0]), (b[0], middles[1])
    reach = min(
        tree.at[path[1]].distance(tree.at[path[0]]) + tree.at[end].distance(tree.at[path[1]])
        for path, end in zip((a, b), ends, strict=True)
    )
    return replace(pair, paths=((*a, ends[0]), (*b, ends[1])), reach=reach)


def counted_on(tree: Tree, pair: Pair) -> Pair:
    """A pair with the joints elsewhere that its names count on to; as it is where they do not on both sides.

    So hang the hands of flat IK rigs at the root, below arms that have a clavicle: ``Arm.L.002``.
    """
    (a, b), names = pair.paths, tree.rig.names
    if not (numbers_in(names[a[-1]]) and numbers_in(names[b[-1]])):
        return pair
    one, other = counted_next(tree, a), counted_next(tree, b)
    if min(one, other) < 0 or one == other:
        return pair
    more = min(tree.at[a[-1]].distance(tree.at[one]), tree.at[b[-1]].distance(tree.at[other]))
    return replace(pair, paths=((*a, one), (*b, other)), reach=pair.reach + more)


def counted_next(tree: Tree, path: Sequence[int]) -> int:
    """The joint whose name goes on with the count of the last two of a chain, and that hangs elsewhere; −1.

    Blender counts from a name without a number on: ``Arm.L``, ``Arm.L.001``.
    """
    names, last = tree.rig.names, path[-1]
    count = numbers_in(names[last])
    if len(count) != 1 or len(path) < 2 or tree.below[last]:
        return -1
    name, before = parse_name(names[last]), parse_name(names[path[-2]])
    lower = numbers_in(names[path[-2]]) or (0,)
    if (before.plain, before.side) != (name.plain, name.side) or lower != (count[0] - 1,):
        return -1
    for node in tree.nodes:
        other = parse_name(names[node]) if numbers_in(names[node]) == (count[0] + 1,) else None
        same = other is not None and (other.plain, other.side) == (name.plain, name.side) and other.plain
        if same and not roles_in_name(names[node]) and not tree.is_below(path[0], node):
            return -1 if tree.is_below(node, last) else node
    return -1


def _bone_beside(tree: Tree, path: Sequence[int], poses: Poses, names: Mapping[int, LimbWords]) -> int:
    """The joint beside the second of two that is called as their bone is; −1 for none, or more than one."""
    start, middle = path
    if _is_called(tree, start, middle, names):
        return -1
    near = [k for k in beside_middle(tree, start, middle, poses) if _is_called(tree, start, k, names)]
    return near[0] if len(near) == 1 else -1


def beside_middle(tree: Tree, start: int, middle: int, poses: Poses) -> list[int]:
    """The joints that move points beside the second joint of a limb, so near that they may be that."""
    near = _BESIDE * tree.at[middle].distance(tree.at[start])
    beside = [k for k in tree.below[start] if k != middle and poses.moves_points(k)]
    return [k for k in beside if tree.at[k].distance(tree.at[middle]) < near]


def middle_beside(tree: Tree, joints: Sequence[int], poses: Poses, names: Mapping[int, LimbWords]) -> int:
    """A joint that may be the middle of a limb, too, whose end the file parents elsewhere; −1 for none."""
    start, middle, end = joints
    if tree.is_below(end, middle) or tree.above[middle] != start:
        return -1
    called = _is_called(tree, start, middle, names)
    near = beside_middle(tree, start, middle, poses)
    return next((k for k in near if not called or _is_called(tree, start, k, names)), -1)


def _is_called(tree: Tree, start: int, node: int, names: Mapping[int, LimbWords]) -> bool:
    """Whether a joint is called a lower bone, and nothing else that the start of its limb is not.

    What helps a knee has its word and others: ``knee_helper`` reaches as far as the shin beside it.
    """
    lower = "lower" in names.get(node, NO_WORDS).levels and not roles_in_name(tree.rig.names[node])
    first, own = (
        [word for word in other_words(tree.rig.names[k]) if not is_number(word)] for k in (start, node)
    )
    return lower and own == first


def ends_in_muscle(tree: Tree, joints: Sequence[int], names: Mapping[int, LimbWords]) -> bool:
    """Whether a limb ends at a joint that is called as the lower bone before it is, and leads to nothing."""
    below = tree.below[joints[-1]]
    return not below and all(names.get(k, NO_WORDS).levels == {"lower": 1.0} for k in joints[1:])


def _loose_end(tree: Tree, path: tuple[int, ...], poses: Poses, names: Mapping[int, LimbWords]) -> int:
    kinds = {names.get(k, NO_WORDS).kind for k in path} - {""}
    middle = tree.at[path[1]]
    bone = middle - tree.at[path[0]]
    top = tree.way(-1, path[0])[0]
    nodes = [k for k in tree.nodes if tree.depth[k] <= 2 and k != top and not tree.is_below(k, path[0])]
    nodes = [k for k in nodes if not tree.is_below(path[0], k) and tree.reach[k] < bone.length]
    far = {k: tree.at[k] - middle for k in nodes}
    size, on = bone.length, bone.unit
    found = [
        (way.length, k)
        for k, way in far.items()
        if _SHORTEST * size < way.length < _LONGEST * size and way.unit.dot(on) > _ONWARD
    ]
    for _, node in sorted(found):
        if kinds and names.get(node, NO_WORDS).kind not in ("", *kinds):
            continue
        if any(poses.moves_points(k) for k in tree.branch(node)):
            return node
    return -1


def moves_a_bone(tree: Tree, poses: Poses, joints: Sequence[int], size: float) -> bool:
    """Whether the last of two joints moves points so far beyond it that a further bone has to be there.

    So does what is taken for an ankle and is a knee, whose foot hangs elsewhere. size: of the limb.
    """
    middle, end = (tree.at[joint] for joint in joints)
    points = poses.box_of([joints[1]], tree.places)
    return max(how_far(points, end, (end - middle).unit), default=0.0) > _FURTHER * size
