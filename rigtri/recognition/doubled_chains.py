"""Chains beside the bones of a body, in the same places, that move no point: of IK, FK and mechanisms.

And whole skeletons of controls.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.dataclass import dataclass
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.layout import BODY_JOINTS
from rigtri.recognition.naming_schemes import roles_in_name
from rigtri.recognition.pose_samples import Poses

# Joints of a skeleton of controls stand so near to one of the body's, of its extent, and so many of them do.
_BESIDE, _MOST = 0.05, 0.8
# By this part of that its bones may be longer or shorter.
_CLOSE = 0.1
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
    starts |= {k for k, other in idle if k not in starts and _is_posed_branch(tree, k, other)}
    found = set[int]()
    for node in tree.nodes:
        if node in starts or tree.above[node] in found:
            found.add(node)
    return frozenset(found)


@dataclass(frozen=True)
class JointGroup:
    """The joints of a character; around: those of skeletons of controls that only stand around it.

    rival: the first joint of another skeleton in the same places, which may be the body as well; −1 for none.
    """

    nodes: list[int]
    around: frozenset[int] = frozenset()
    rival: int = -1


def with_controls(tree: Tree, groups: Sequence[Sequence[int]], poses: Poses) -> list[JointGroup]:
    """The bodies among groups of joints, each with the skeletons of controls that only stand around it.

    What one skin lists with a body, moves no point, shows no mesh, and stands where the body does, or has
    its bones in another pose, is what animators move instead, whatever it is called; and so, wherever it
    stands, is what is called so. Beside another body of a crowd a body stands elsewhere.
    """
    if len(groups) > 1 and not _draws_anything(tree, poses):
        return _by_names(tree, groups, poses)
    owner = {node: k for k, nodes in enumerate(groups) for node in nodes}
    shared = [{owner[k] for k in skin.joints.tolist() if k in owner} for skin in tree.rig.skins]
    shared = [together for together in shared if len(together) > 1]
    idle = {k for k in set().union(*shared) if not any(map(poses.moves_points, groups[k]))}
    idle = {k for k in idle if not any(map(poses.shows_mesh, groups[k]))}
    controls: dict[int, set[int]] = {k: set() for k in range(len(groups)) if k not in idle}
    for k in sorted(idle):
        bodies = sorted(set().union(*(together for together in shared if k in together)) - idle)
        beside = [body for body in bodies if _stands_beside(tree.places, groups[k], groups[body])]
        beside = beside or [body for body in bodies if _is_posed_copy(tree, groups[k], groups[body])]
        beside = beside or _nearest_not_controls(tree, groups, k, bodies)
        controls.setdefault(beside[0] if beside else k, set()).update(groups[k] if beside else ())
    return [JointGroup(list(groups[k]), frozenset(found)) for k, found in sorted(controls.items())]


def _draws_anything(tree: Tree, poses: Poses) -> bool:
    """Whether a file has meshes, of a skin or of a node, or may have some that nobody can read."""
    skinned = any(skin.drawn is not False and skin.weighted.any() for skin in tree.rig.skins)
    return skinned or any(map(poses.shows_mesh, tree.nodes))


def _by_names(tree: Tree, groups: Sequence[Sequence[int]], poses: Poses) -> list[JointGroup]:
    """The bodies of a file in which nothing is moved: of two in the same places names tell the controls.

    Where they do not, either may be the body, unless clips move each its own way.
    """
    called = [_are_controls([tree.rig.names[k] for k in nodes]) for nodes in groups]
    moments = [tree.places, *poses.moving]
    controls: dict[int, set[int]] = {k: set() for k in range(len(groups)) if not called[k]}
    for k in (k for k, control in enumerate(called) if control):
        beside = [body for body in controls if not called[body]]
        beside = [body for body in beside if _stands_beside(tree.places, groups[k], groups[body])]
        controls.setdefault(beside[0] if beside else k, set()).update(groups[k] if beside else ())
    found = []
    for k, around in sorted(controls.items()):
        others = (other for other in controls if other != k and called[other] == called[k])
        rivals = (groups[other] for other in others if _are_in_one_place(moments, groups[k], groups[other]))
        found.append(JointGroup(list(groups[k]), frozenset(around), next((nodes[0] for nodes in rivals), -1)))
    return found


def _are_controls(names: Sequence[str]) -> bool:
    """Whether nearly all of some names are of controls or mechanism."""
    return len([name for name in names if "control" in roles_in_name(name)]) >= _MOST * len(names)


def _are_in_one_place(moments: Sequence[Floats], one: Sequence[int], other: Sequence[int]) -> bool:
    """Whether nearly all joints of two skeletons stand where some of the other do, at rest and as both move.

    A clip may move one alone: controls that nobody has baked.
    """
    rest = moments[0]
    both = [at for at in moments[1:] if all((at[list(k)] != rest[list(k)]).any() for k in (one, other))]
    return all(_stands_beside(at, one, other) and _stands_beside(at, other, one) for at in (rest, *both))


def _stands_beside(at: Floats, nodes: Sequence[int], body: Sequence[int]) -> bool:
    """Whether nearly all of some joints stand where joints of a body do; at: where each node is, (n, 3)."""
    places, mine = at[list(body)], at[list(nodes)]
    near = _BESIDE * float(np.ptp(places, axis=0).max())
    below, above = places.min(axis=0) - near, places.max(axis=0) + near
    if (mine.min(axis=0) > above).any() or (mine.max(axis=0) < below).any():
        return False
    apart = (length(places - place).min() for place in mine)
    return len([far for far in apart if far <= near]) >= _MOST * len(nodes)


def _nearest_not_controls(
    tree: Tree, groups: Sequence[Sequence[int]], k: int, bodies: Sequence[int]
) -> list[int]:
    """Of bodies that are not called controls the nearest to a skeleton that is; none for another one."""
    called = {each: _are_controls([tree.rig.names[node] for node in groups[each]]) for each in (k, *bodies)}
    others = [body for body in bodies if not called[body]] if called[k] else []
    middle = {each: _middle(tree.places[list(groups[each])]) for each in (k, *others)}
    return sorted(others, key=lambda body: float(length(middle[body] - middle[k])))


def _middle(at: Floats) -> Floats:
    """The middle of the box around some places."""
    middle: Floats = (at.min(axis=0) + at.max(axis=0)) / 2.0
    return middle


def _is_posed_branch(tree: Tree, node: int, other: int) -> bool:
    """Whether a branch as large as a body is a copy of another one in another pose."""
    return tree.size[node] >= BODY_JOINTS and _is_posed_copy(tree, tree.branch(node), tree.branch(other))


def _is_posed_copy(tree: Tree, nodes: Sequence[int], body: Sequence[int]) -> bool:
    """Whether a skeleton starts where a body does and has nearly all its bones, of whatever directions.

    Rest poses differ where bones were posed and controls were not. Lengths of bones stay, but for one scale.
    """
    inside, its_own, place = frozenset(nodes), frozenset(body), tree.places
    tops = [node for node in nodes if tree.above[node] not in inside]
    starts = [node for node in body if tree.above[node] not in its_own]
    near = _BESIDE * float(np.ptp(place[list(body)], axis=0).max())
    if not all(any(float(length(place[k] - place[top])) <= near for k in starts) for top in tops):
        return False
    mine, its = _bones_by_depth(tree, nodes), _bones_by_depth(tree, body)
    far = max((tree.reach[k] for k in starts), default=0.0), max((tree.reach[k] for k in tops), default=0.0)
    scales = (1.0, far[0] / far[1]) if min(far) > 0.0 else (1.0,)
    return any(_count_alike(mine, its, scale, near) >= _MOST * len(nodes) for scale in scales)


def _bones_by_depth(tree: Tree, nodes: Sequence[int]) -> dict[int, list[float]]:
    """The lengths of the bones of a skeleton by how many joints of it are above each; 0 for a first one."""
    inside, depth = frozenset(nodes), dict[int, int]()
    found: dict[int, list[float]] = {}
    for node in sorted(nodes):
        over = tree.above[node]
        depth[node] = depth.get(over, -1) + 1
        found.setdefault(depth[node], []).append(tree.bone[node] if over in inside else 0.0)
    return found


def _count_alike(mine: dict[int, list[float]], its: dict[int, list[float]], scale: float, near: float) -> int:
    """How many bones have one of the other skeleton, each its own, that is as long and hangs as deep."""
    count = 0
    for depth, lengths in mine.items():
        left = sorted(its.get(depth, ()))
        for bone in sorted(lengths):
            while left and left[0] < scale * bone - near * _CLOSE:
                left.pop(0)
            if left and left[0] <= scale * bone + near * _CLOSE:
                count += 1
                left.pop(0)
    return count


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
