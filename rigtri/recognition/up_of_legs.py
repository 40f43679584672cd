"""The up direction of a body of which only legs are known: by the trunk that rises from them."""

from __future__ import annotations

from math import copysign

from rigtri.maths.scalar_vector import Vector
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_pairs import Limbs
from rigtri.recognition.symmetry import between

# A trunk leans from an axis of the file by up to this (a cosine, 30°).
_LEANS = 0.866
# Legs that go down by this as the file has it stand on it; they go down from a trunk by more than the second.
_STANDS, _DOWN = 0.8, 0.5
# What stands aside of their middle by less than this part of legs is of the trunk.
_MIDMOST = 0.1
# What goes down between legs by more than this part of them is a tail, and its trunk may lie.
_TAIL = 0.2


def axis_of(way: Vector) -> Vector:
    """The axis of the file that is nearest to a direction, with its sign."""
    most = max(way, key=abs)
    return Vector(*(copysign(1.0, each) if each == most else 0.0 for each in way))


def on_axis(way: Vector, along: float) -> Vector:
    """The axis of the file that a direction goes along, by a cosine, itself where it goes along none."""
    axis = axis_of(way)
    return axis if axis.dot(way) > along else way


def up_of_trunk(tree: Tree, legs: Limbs) -> Vector:
    """The axis of the file along which a trunk rises from legs that stand on no ground of it; or nothing.

    So sits and crouches who has one arm, or none that is known, in a file with another up.
    """
    standing, down = Vector(*tree.rig.rules.up), (legs.ends - legs.starts).unit
    firsts = [path[0] for path in legs.pair.paths]
    own = {node for first in firsts for node in (*tree.way(-1, first), *tree.branch(first))}
    ways = [tree.at[node] - legs.starts for node in tree.nodes if node not in own]
    across = between(tree, legs.pair)[1]
    midmost = [way for way in ways if abs(way.dot(across)) < _MIDMOST * legs.size]
    trunk = Vector()
    for way in midmost:
        trunk = trunk + way
    up = axis_of(trunk)
    rises = trunk.unit.dot(up) > _LEANS and -down.dot(up) > _DOWN
    tail = any(-way.dot(up) > _TAIL * legs.size for way in midmost)
    return up if rises and not tail and -down.dot(standing) < _STANDS else Vector()
