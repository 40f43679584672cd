"""Characters of a file: which joints belong to one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from rigtri.model.rig import Rig
from rigtri.recognition.joint_tree import Tree

# So many joints of the same names in two branches make two characters of one skin.
_SAME_NAMES = 3
# A body has at least so many joints.
_BODY = 12
# A container with more branches than this is a crowd or no container: it stays whole.
_MANY = 64


def groups_of(tree: Tree) -> list[list[int]]:
    """The joints of each character, largest first; what one skin moves is one, unless names repeat."""
    tops = _tops(tree)
    branches = {top: tree.branch(top) for top in tops}
    group = {top: top for top in tops}

    def first(top: int) -> int:
        while group[top] != top:
            top = group[top]
        return top

    owner = {node: top for top, branch in branches.items() for node in branch}
    shared = [sorted({owner[k] for k in skin.joints.tolist() if k in owner}) for skin in tree.rig.skins]
    shared = shared or [tops]
    for together in shared:
        for top in together[1:]:
            a, b = first(together[0]), first(top)
            repeats = _repeats(tree.rig, branches[a], branches[top]) or _alike(tree, a, top)
            if a != b and not repeats:
                group[b] = a
    found: dict[int, list[int]] = {}
    for top in tops:
        found.setdefault(first(top), []).extend(branches[top])
    if len(found) == 1:
        return [list(tree.nodes)]
    return sorted((sorted(nodes) for nodes in found.values()), key=len, reverse=True)


def _tops(tree: Tree) -> list[int]:
    """The nodes that skeletons begin at: roots, or what hangs below containers that are no joints."""
    joint, tops, left = tree.rig.is_joint, [], list(tree.below[-1])
    for node in left:  # it grows as it is walked
        below = tree.below[node]
        if not joint.any() or joint[node] or len(below) < 2 or len(below) > _MANY:
            tops.append(node)
        else:
            left += below
    return sorted(tops)


def _alike(tree: Tree, a: int, b: int) -> bool:
    """Whether two branches are as large as whole bodies, and alike: two of a crowd."""
    if min(tree.size[a], tree.size[b]) < _BODY:
        return False
    far, size = (tree.reach[a], tree.reach[b]), (tree.size[a], tree.size[b])
    return min(far) > 0.9 * max(far) and min(size) > 0.9 * max(size)


def _repeats(rig: Rig, one: Sequence[int], other: Sequence[int]) -> bool:
    mine = Counter(rig.names[k] for k in one if rig.names[k])
    return len([k for k in other if mine[rig.names[k]]]) >= _SAME_NAMES
