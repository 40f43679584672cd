"""Chains along the limbs that names or a humanoid map know: trousers, armour and sleeves are worn there."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import pairwise

from rigtri.maths.scalar_vector import Vector
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.layout import BENDS
from rigtri.recognition.name_readings import Reading
from rigtri.recognition.pose_samples import Poses

# Joints of what is worn stand nearer to those of a limb than this part of its length; further arms do not.
_ALONG = 0.2


def worn_in(tree: Tree, poses: Poses, reading: Reading | None, certain: Mapping[str, int]) -> frozenset[int]:
    """The joints of chains of which three stand, in order, where those of a known limb do, and what is below.

    They hang where the limb does, or above. Beside a limb that moves no point stand its bones.
    """
    bones = certain or (reading.bones if reading is not None else {})
    own = {*bones.values(), *(node for limb in _limbs(reading, certain) for node in limb)}
    found = set[int]()
    for limb in _limbs(reading, certain):
        if poses.has_weights and not all(map(poses.moves_points, limb[:2])):
            continue
        for over in tree.way(-1, limb[0])[:-1]:
            for child in tree.below[over]:
                branch = {child, *tree.branch(child)}
                if not branch & own and runs_along(tree, child, limb):
                    found |= branch
    return frozenset(found)


def _limbs(reading: Reading | None, certain: Mapping[str, int]) -> Iterator[tuple[int, ...]]:
    """The known limbs of three joints: arms and legs."""
    if certain:
        for parts in BENDS.values():
            for which in ("left", "right"):
                joints = tuple(certain[which + part] for part in parts if which + part in certain)
                if len(joints) == 3:
                    yield joints
    elif reading is not None:
        yield from reading.limbs.values()


def lies_along(tree: Tree, joints: Sequence[int], limb: Collection[int]) -> bool:
    """Whether the joints of a limb stand, in order, beside the bones between others.

    Joints of cloth part an arm at other places than its elbow does.
    """
    chain = [tree.at[node] for node in joints]
    places = [tree.at[node] for node in limb]
    near = _ALONG * sum(b.distance(a) for a, b in pairwise(places))
    reached = 0.0
    for place in places if len(chain) > 2 else ():
        ways = ((k, *_beside(place, a, b)) for k, (a, b) in enumerate(pairwise(chain)))
        found = [k + far for k, far, apart in ways if apart <= near and k + far >= reached]
        if not found:
            return False
        reached = min(found)
    return reached > 1.0


def _beside(place: Vector, a: Vector, b: Vector) -> tuple[float, float]:
    """How far along a bone a place is, 0 to 1, and how far from there."""
    bone = b - a
    far = max(0.0, min(1.0, (place - a).dot(bone) / max(bone.dot(bone), 1e-30)))
    return far, (place - a - bone * far).length


def runs_along(tree: Tree, start: int, limb: Collection[int]) -> bool:
    """Whether joints of one chain at or below ``start`` stand near those of a limb, one after another."""
    places = [tree.at[node] for node in limb]
    near = _ALONG * sum(b.distance(a) for a, b in pairwise(places))
    reached = tree.branch(start)
    for place in places:
        reached = [node for node in reached if tree.at[node].distance(place) <= near]
        if place is not places[-1]:
            reached = [below for node in reached for below in tree.branch(node) if below != node]
    return bool(reached)
