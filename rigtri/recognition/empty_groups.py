"""Empty groups among the joints of a skin: what stands where the joint below does, and moves no point itself.

Importers write one or more above each joint, for parts of its transform. Source: Assimp, ``FBXConverter``,
``Hand_$AssimpFbx$_Translation``, ``Hand_$AssimpFbx$_PreRotation``, ``Hand``.
"""

from __future__ import annotations

from rigtri.recognition.joint_tree import SAME_POSITION, Tree
from rigtri.recognition.limb_words import limb_words
from rigtri.recognition.pose_samples import Poses


def empty_groups(tree: Tree, poses: Poses) -> frozenset[int]:
    """The joints that move no point and only hold the one below, in its place: limbs start and end at that.

    It moves points, or its name is in that of the joint that holds it. Not what all others are below, nor
    what is called a bone of a limb where the joint below is not.
    """
    found = set[int]()
    for node in reversed(tree.nodes):
        if len(tree.below[node]) != 1 or tree.above[node] < 0:
            continue
        below = tree.below[node][0]
        if tree.bone[below] > SAME_POSITION * tree.span or poses.moves_points(node):
            continue
        held, name = tree.rig.names[below], tree.rig.names[node]
        if (held and held in name) or below in found or poses.moves_points(below):
            found.update([node] if _is_called_like(name, held) else [])
    return frozenset(found)


def _is_called_like(name: str, held: str) -> bool:
    """Whether a name says no part of a limb that the name of the joint below does not say."""
    return limb_words(name).levels.keys() <= limb_words(held).levels.keys()
