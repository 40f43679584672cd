"""Joints that hang at the root and belong to a limb all the same: the feet of flat IK rigs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.recognition.poses import Poses
from rigtri.recognition.symmetry import Pair
from rigtri.recognition.tree import Tree
from rigtri.vectors import dot, length, normalise

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
        float(length(tree.places[path[1]] - tree.places[path[0]]))
        + float(length(tree.places[end] - tree.places[path[1]]))
        for path, end in zip((a, b), ends, strict=True)
    )
    return replace(pair, paths=((*a, ends[0]), (*b, ends[1])), reach=reach)


def _loose_end(tree: Tree, path: tuple[int, ...], poses: Poses) -> int:
    start, middle = tree.places[path[0]], tree.places[path[1]]
    bone = float(length(middle - start))
    top = tree.way(-1, path[0])[0]
    nodes = [k for k in tree.nodes if tree.depth[k] <= 2 and k != top and not tree.is_below(k, path[0])]
    nodes = [k for k in nodes if not tree.is_below(path[0], k)]
    if not nodes or not bone > 0:
        return -1
    on = tree.places[nodes] - middle
    far = length(on)
    fits = (far > _SHORTEST * bone) & (far < _LONGEST * bone)
    fits &= dot(np.nan_to_num(normalise(on)), normalise(middle - start)) > _ONWARD
    found = [(d, k) for d, k, fit in zip(far.tolist(), nodes, fits.tolist(), strict=True) if fit]
    for _, node in sorted(found):
        if any(poses.moves_points(k) for k in tree.branch(node)):
            return node
    return -1
