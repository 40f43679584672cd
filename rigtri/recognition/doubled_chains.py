"""Chains beside the bones of a body, in the same places, that move no point: of IK, FK and mechanisms.

And whole skeletons of controls.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigtri.maths.vectors import length
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.pose_samples import Poses

# Joints of a skeleton of controls stand so near to one of the body's, of its extent, and so many of them do.
_BESIDE, _MOST = 0.05, 0.8
# Nearer than this part of the longest chain, or of one itself, joints stand in one place.
_SAME_PLACE = 1e-3


def doubled_in(tree: Tree, poses: Poses) -> frozenset[int]:
    """The joints of chains that move no point and stand, three in a row, where bones that do so stand.

    They are what animators move instead of these, IK, FK and mechanism chains, whatever they are called.
    """
    inner = [node for node in tree.nodes if any(tree.below[child] for child in tree.below[node])]
    grid = _SAME_PLACE * max((tree.reach[node] for node in inner), default=0.0)
    if grid <= 0.0:
        return frozenset()
    same: dict[tuple[int, ...], list[int]] = {}
    for node, cell in zip(inner, np.rint(tree.places[inner] / grid).astype(int).tolist(), strict=True):
        same.setdefault(tuple(cell), []).append(node)
    groups = [nodes for nodes in same.values() if len(nodes) > 1]
    if not groups or not poses.weighed.any():
        return frozenset()
    moves = poses.weighed.tolist()
    for node in reversed(tree.nodes):  # itself, or what is below it
        moves[node] = moves[node] or any(moves[child] for child in tree.below[node])
    idle = [(k, other) for nodes in groups for k in nodes if not moves[k] for other in nodes if moves[other]]
    starts = {k for k, other in idle if _runs_along(tree, k, other)}
    found = set[int]()
    for node in tree.nodes:
        if node in starts or tree.above[node] in found:
            found.add(node)
    return frozenset(found)


def with_controls(
    tree: Tree, groups: Sequence[Sequence[int]], poses: Poses
) -> list[tuple[list[int], frozenset[int]]]:
    """The joints of each character, and those of a skeleton that only stands around it.

    What one skin lists with a body, moves no point, shows no mesh, and stands where the body does is what
    animators move instead, whatever it is called. Beside another body of a crowd a body stands elsewhere.
    """
    owner = {node: k for k, nodes in enumerate(groups) for node in nodes}
    shared = [{owner[k] for k in skin.joints.tolist() if k in owner} for skin in tree.rig.skins]
    shared = [together for together in shared if len(together) > 1]
    idle = {k for k in set().union(*shared) if not any(map(poses.moves_points, groups[k]))}
    idle = {k for k in idle if not any(map(poses.shows_mesh, groups[k]))}
    controls: dict[int, set[int]] = {k: set() for k in range(len(groups)) if k not in idle}
    for k in sorted(idle):
        bodies = sorted(set().union(*(together for together in shared if k in together)) - idle)
        beside = [body for body in bodies if _stands_beside(tree, groups[k], groups[body])]
        controls.setdefault(beside[0] if beside else k, set()).update(groups[k] if beside else ())
    return [(list(groups[k]), frozenset(found)) for k, found in sorted(controls.items())]


def _stands_beside(tree: Tree, nodes: Sequence[int], body: Sequence[int]) -> bool:
    """Whether nearly all of some joints stand where joints of a body do."""
    places = tree.places[list(body)]
    near = _BESIDE * float(np.ptp(places, axis=0).max())
    apart = (length(places - tree.places[node]).min() for node in nodes)
    return len([far for far in apart if far <= near]) >= _MOST * len(nodes)


def _runs_along(tree: Tree, start: int, other: int) -> bool:
    """Whether two further joints of a chain stand where two below ``other`` do, as both of these do."""
    near = _SAME_PLACE * tree.reach[start]
    pairs = [(start, other)]
    for _ in range(2):
        pairs = [
            (child, joint)
            for k, beside in pairs
            for child in tree.below[k]
            for joint in tree.paths[beside][1:]
            if tree.at[joint].distance(tree.at[child]) <= near
        ]
    return bool(pairs)


def moves_nothing(draft: Draft, joints: Sequence[int]) -> bool:
    """Whether none of some joints moves points or shows a mesh, in a file where others have weights."""
    if not draft.poses.has_weights or any(map(draft.poses.moves_points, joints)):
        return False
    return not any(map(draft.poses.shows_mesh, joints))
