"""Detached limb ends: feet and hands of flat IK rigs that are children of the root."""

from __future__ import annotations

from dataclasses import replace

from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.pose_samples import Poses
from rigtri.recognition.symmetry import Pair

# The lower bone is as long as this, of the upper one, at least and at most.
_SHORTEST, _LONGEST = 0.5, 1.7
# It goes on, as a cosine: a limb at rest is not folded.
_ONWARD = 0.5


def loose_ends(tree: Tree, pair: Pair, poses: Poses) -> Pair:
    """A pair of two joints each, with the joints elsewhere that end it; as it is where none do.

    Only joints that move points, or have such below, are taken: a control stands in the same place.
    """
    ends = [_loose_end(tree, path[:2], poses) if len(path) >= 2 else -1 for path in pair.paths]
    if min(ends) < 0 or ends[0] == ends[1] or pair.nodes.intersection(ends):
        return pair
    (a, b) = (path[:2] for path in pair.paths)
    reach = min(
        (tree.at[path[1]] - tree.at[path[0]]).length + (tree.at[end] - tree.at[path[1]]).length
        for path, end in zip((a, b), ends, strict=True)
    )
    return replace(pair, paths=((*a, ends[0]), (*b, ends[1])), reach=reach)


def _loose_end(tree: Tree, path: tuple[int, ...], poses: Poses) -> int:
    middle = tree.at[path[1]]
    bone = middle - tree.at[path[0]]
    top = tree.way(-1, path[0])[0]
    nodes = [k for k in tree.nodes if tree.depth[k] <= 2 and k != top and not tree.is_below(k, path[0])]
    nodes = [k for k in nodes if not tree.is_below(path[0], k)]
    far = {k: tree.at[k] - middle for k in nodes}
    size, on = bone.length, bone.unit
    found = [
        (way.length, k)
        for k, way in far.items()
        if _SHORTEST * size < way.length < _LONGEST * size and way.unit.dot(on) > _ONWARD
    ]
    for _, node in sorted(found):
        if any(poses.moves_points(k) for k in tree.branch(node)):
            return node
    return -1
