"""Which joint follows which where the hierarchy does not say it and names do.

Some exporters parent all joints to one, or all joints of an arm to the chest, or all of a hand to the wrist.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.layout import BENDS, FINGER_BONES, TRUNK, LimbKind

_LIMBS: Mapping[LimbKind, tuple[str, ...]] = {
    "arm": ("Shoulder", *BENDS["arm"]),
    "leg": (*BENDS["leg"], "Toes"),
}
# Where limbs begin, the lowest first: arms at what is the highest of these.
_HOLD: Mapping[LimbKind, tuple[str, ...]] = {"arm": ("spine", "chest", "upperChest"), "leg": ("hips",)}


def followers(tree: Tree, bones: Mapping[str, int]) -> dict[int, int]:
    """For each joint that is beside the one before it, not below it, that one; tree: as the file has it.

    bones: nodes by their names in the VRM 1.0 humanoid. Limbs and trunk have a hierarchy or none: what is
    parented elsewhere alone, as the foot of a flat IK rig, stays there.
    """
    found: dict[int, int] = {}
    for side in ("left", "right"):
        flat_hand = False
        for kind, names in _LIMBS.items():
            joints = [bones[side + name] for name in names if side + name in bones]
            bend = [bones.get(side + name, -1) for name in BENDS[kind]]
            if min(bend) < 0 or not (_beside(tree, *bend[:2]) and _beside(tree, *bend[1:])):
                continue
            flat_hand |= kind == "arm"
            found |= {b: a for a, b in pairwise(joints) if _hangs_above(tree, a, b)}
            hold = next((bones[k] for k in reversed(_HOLD[kind]) if k in bones), -1)
            if hold >= 0 and _hangs_above(tree, hold, joints[0]):
                found[joints[0]] = hold
        for finger in _fingers(bones, side):
            found |= {b: a for a, b in pairwise(finger) if _beside(tree, a, b)}
            hand = bones.get(f"{side}Hand", -1)
            if flat_hand and hand >= 0 and _hangs_above(tree, hand, finger[0]):
                found[finger[0]] = hand
    if any(bones.get(side + BENDS[kind][0], -1) in found for kind in _LIMBS for side in ("left", "right")):
        trunk = [bones[name] for name in TRUNK if name in bones]
        found |= {b: a for a, b in pairwise(trunk) if _beside(tree, a, b)}
    return found


def _fingers(bones: Mapping[str, int], side: str) -> Iterator[list[int]]:
    """The joints of each finger that names know, from the hand on."""
    for names in FINGER_BONES.values():
        joints = [bones[side + name] for name in names if side + name in bones]
        if joints:
            yield joints


def _beside(tree: Tree, one: int, other: int) -> bool:
    return tree.above[one] == tree.above[other]


def _hangs_above(tree: Tree, one: int, other: int) -> bool:
    """Whether a joint is a child of what another is parented to, or of something above that."""
    return not tree.is_below(other, one) and tree.is_below(one, tree.above[other])


def joined(tree: Tree, after: Mapping[int, int]) -> Tree:
    """The tree with each joint of ``after`` below the one that it follows; those that are in it."""
    above = list(tree.above)
    for node, over in after.items():
        if node not in tree.below or over not in tree.below:
            continue
        line = [over]
        while line[-1] >= 0 and line[-1] != node:
            line.append(above[line[-1]])
        if line[-1] == node:  # what is to be above hangs below: it takes the place
            above[over] = above[node]
        above[node] = over
    return Tree(tree.rig, _parents_first(tree.nodes, above), tree.places, above)


def _parents_first(nodes: Sequence[int], above: Sequence[int]) -> list[int]:
    below: dict[int, list[int]] = {}
    for node in nodes:
        below.setdefault(above[node], []).append(node)
    order = [*below.get(-1, ())]
    for node in order:  # it grows as it is walked
        order += below.get(node, ())
    return order
