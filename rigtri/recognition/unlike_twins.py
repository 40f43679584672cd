"""Why joints of a limb may be others than those of its twin: other bones, or a joint more on one side."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from rigtri.model.joint_names import Side
from rigtri.recognition.arms_legs import AGREED
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.found_limb import Found
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_words import LEVELS, NO_WORDS

# Bones of twins are alike up to this part of their length.
_TWINS = 0.15
# A joint is another than that of the other side if the next one is less than a third as far off; where it is
# off by less than bones of twins may be, and by more than this part of a bone, if the next one is by noise.
_NEARER, _OFF, _EXACT = 0.3, 0.03, 0.1


def unlike_twin(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """The limb of the other side has other bones, and shape does not tell that this one is right."""
    twin = _twin(each, found)
    if AGREED in each.evidence or twin is None or len(twin.joints) < 3 or _are_of_pair(each, twin):
        return ""
    tree = draft.tree
    for a, b in ((0, 1), (1, 2)):
        mine, other = (tree.at[k.joints[b]].distance(tree.at[k.joints[a]]) for k in (each, twin))
        steps = [len(tree.way(k.joints[a], k.joints[b])) for k in (each, twin)]
        if abs(mine - other) > _TWINS * max(mine, other) or steps[0] != steps[1]:
            return f"the {twin.side} {twin.kind} has other bones"
    return ""


def joint_more(draft: Draft, each: Found, found: Sequence[Found]) -> str:
    """A joint before or after one of a limb's stands as far along it as that of the other side does.

    So one side alone has a socket, a sleeve, or a twist joint that nobody has called so, or lacks a joint,
    and one is taken for another, whatever shape says: on the side where names say less of it, or on either.
    """
    twin = _twin(each, found)
    if twin is None or len(twin.joints) != len(each.joints) or _have_as_many(draft.tree, each, twin):
        return ""
    for one, other in ((each, twin), (twin, each)):
        beside = _beside_its_place(draft.tree, one.joints, other.joints)
        for node, k in (*beside, *_of_one_further(draft.tree, one.joints, other.joints)):
            if _says(draft, each.joints[k], k) <= _says(draft, twin.joints[k], k):
                title = draft.tree.rig.title
                return f"'{title(node)}' stands where '{title(other.joints[k])}' does"
    return ""


def _have_as_many(tree: Tree, each: Found, twin: Found) -> bool:
    """Whether both are one pair whose ways down to the tip have as many joints, so that none has one more."""
    if each.pair is None or not _are_of_pair(each, twin):
        return False
    one, other = (tree.paths[path[0]] for path in each.pair.pair.paths)
    return len(one) == len(other)


def _says(draft: Draft, joint: int, k: int) -> float:
    """How far the name of a limb's first, second or third joint says that it is that one."""
    return draft.words.get(joint, NO_WORDS).levels.get(LEVELS[k + 1], 0.0)


def _beside_its_place(tree: Tree, joints: Sequence[int], twins: Sequence[int]) -> list[tuple[int, int]]:
    """Which neighbours of a limb's joints stand where these do on the other side, by the bones, and of which.

    Those that are none of the limb's come first.
    """
    found, at, last = list[tuple[bool, int, int]](), tree.at, len(joints) - 1
    for k, seen_from in [(k, k + 1) for k in range(last)] + [(k + 1, k) for k in range(last)]:
        node, start = joints[k], at[joints[seen_from]]
        meant = at[twins[k]].distance(at[twins[seen_from]])
        left = _left_of(abs(at[node].distance(start) - meant), meant)
        beside = [*tree.below[node], *([tree.above[node]] if tree.above[node] >= 0 else [])]
        found += [(n in joints, n, k) for n in beside if abs(at[n].distance(start) - meant) < left]
    return [(node, k) for _, node, k in sorted(found, key=lambda one: one[0])]


def _of_one_further(tree: Tree, joints: Sequence[int], twins: Sequence[int]) -> list[tuple[int, int]]:
    """The joint where a limb would begin whose bones are those of the other side, one joint further, and 0.

    A limb of two joints has one bone: that of its neighbour tells more than how far off each joint is.
    """
    above = tree.common(joints[0], twins[0])
    further = [(*joints[1:], node) for node in tree.below[joints[-1]]]
    further += [(tree.above[joints[0]], *joints[:-1])] if tree.above[joints[0]] not in (above, -1) else []
    meant = _bones(tree, above, twins)

    def most_off(each: Sequence[int]) -> float:
        bones = zip(_bones(tree, above, each), meant, strict=True)
        return max(abs(bone - other) / max(other, 1e-30) for bone, other in bones)

    left = _left_of(most_off(joints), 1.0)
    return [(each[0], 0) for each in further if most_off(each) < left]


def _bones(tree: Tree, above: int, joints: Sequence[int]) -> list[float]:
    """The lengths from a joint above the start of a limb, if any, to that, and on to each next joint."""
    chain = joints if above < 0 else (above, *joints)
    return [tree.at[b].distance(tree.at[a]) for a, b in pairwise(chain)]


def _left_of(off: float, meant: float) -> float:
    """How far off a joint may be that stands in the place of one which is `off` of a bone so long."""
    return (_NEARER if off > _TWINS * meant else _EXACT if off > _OFF * meant else 0.0) * off


def _are_of_pair(each: Found, twin: Found) -> bool:
    """Whether shape has found both limbs as one pair, which it has weighed how far their bones differ."""
    pair = each.pair
    return pair is not None and {each.joints, twin.joints} == {pair.joints(0), pair.joints(1)}


def _twin(each: Found, found: Sequence[Found]) -> Found | None:
    """The limb of the other side: of several legs the one of the same pair, if any."""
    sides: set[Side] = {"left", "right"}
    opposite = [k for k in found if k.kind == each.kind and {k.side, each.side} == sides]
    of_pair = [k for k in opposite if each.pair is not None and k.pair is each.pair]
    return (of_pair or opposite)[0] if of_pair or len(opposite) == 1 else None
