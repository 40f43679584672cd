"""Empty groups among the joints of a skin: what stands where the joint below does, and moves no point itself.

Importers write one or more above each joint, for parts of its transform. Source: Assimp, ``FBXConverter``,
``Hand_$AssimpFbx$_Translation``, ``Hand_$AssimpFbx$_PreRotation``, ``Hand``.
"""

from __future__ import annotations

from collections.abc import Mapping

from rigtri.recognition.joint_tree import SAME_POSITION, Tree
from rigtri.recognition.limb_words import limb_words
from rigtri.recognition.pose_samples import Poses


def empty_groups(tree: Tree, poses: Poses) -> frozenset[int]:
    """The joints that move no point and only hold the one below, in its place: limbs start and end at that.

    It moves points, or its name is in that of the joint that holds it, or it is an end without a name where
    others are held so. Or the bone above stands there, and moves some. Not what all others are below, nor
    what is called a bone of a limb where the other joint is not.
    """
    held = {k: tree.below[k][0] for k in reversed(tree.nodes) if _holds_one_in_place(tree, poses, k)}
    found = _of_these(tree, poses, held, frozenset())
    names = tree.rig.names
    ends = (below for k, below in held.items() if not (tree.below[below] or names[k] or names[below]))
    found = _of_these(tree, poses, held, frozenset(ends)) if found else found
    return found.union(k for k in tree.nodes if _is_below_its_bone(tree, poses, k))


def _of_these(tree: Tree, poses: Poses, held: Mapping[int, int], ends: frozenset[int]) -> frozenset[int]:
    """Which of these joints, by what each holds, are groups; above these ends, too."""
    names, found = tree.rig.names, set[int]()
    for node, below in held.items():
        inside = names[below] and names[below] in names[node]
        if inside or below in found or below in ends or poses.moves_points(below):
            found.update([node] if _is_called_like(names[node], names[below]) else [])
    return frozenset(found)


def _holds_one_in_place(tree: Tree, poses: Poses, node: int) -> bool:
    """Whether a joint moves no point and one alone is below it, in its place."""
    if len(tree.below[node]) != 1 or tree.above[node] < 0:
        return False
    in_place = tree.bone[tree.below[node][0]] <= SAME_POSITION * tree.span
    return in_place and not poses.moves_points(node)  # the weights of all meshes are read for that


def _is_below_its_bone(tree: Tree, poses: Poses, node: int) -> bool:
    """Whether a joint with others below moves no point, and the bone above, which holds it alone, moves some.

    It stands in its place. A spine without weight may stand in that of the hips, which hold legs, too.
    """
    over = tree.above[node]
    if over < 0 or not tree.below[node] or tree.below[over] != [node]:
        return False
    in_place = tree.bone[node] <= SAME_POSITION * tree.span
    called = _is_called_like(tree.rig.names[node], tree.rig.names[over])
    return in_place and called and poses.moves_points(over) and not poses.moves_points(node)


def _is_called_like(name: str, held: str) -> bool:
    """Whether a name says no part of a limb that the name of the other joint does not say."""
    return limb_words(name).levels.keys() <= limb_words(held).levels.keys()
