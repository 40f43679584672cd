"""The joint tree: parents, bone lengths and chain lengths; which joints are of it, and which within bones."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from copy import copy
from functools import cached_property

import numpy as np

from rigtri.maths.ranking import SAME_SHARE
from rigtri.maths.scalar_vector import Vector
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.metadata import LimbRecord
from rigtri.model.rig import Rig
from rigtri.recognition.limb_words import AXES, limb_words
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.naming_schemes import is_bone, is_segment, roles_in_name
from rigtri.text import is_number

# So many chains without branches, of so many joints, are the fingers of a hand.
_HAND, _FINGER = 4, (2, 3, 4)
# A path longer than this is not a limb: what comes after is of no interest, and paths stay short.
_LONGEST = 15
# A segment of a bone bends no further than this, as a cosine (25°): rest poses are not quite straight.
_IN_LINE = 0.9
# One that is called a twist joint may be off by noise, too: 45°.
_TWISTED = 0.7
# Nearer than this part of the bone that it is in, a node stands where the joint does.
SAME_POSITION = 1e-3

# Of what robots call axes of joints, the one that others call twist joints.
_ROLL = "roll"
# What riggers call a node that only holds another, with whose name: ``forearm_L_offset``, ``arm_grp``.
HOLDERS = frozenset(["offset", "grp", "group", "zero"])


class Tree:
    """Some joints of a rig, with what is above them, and where they stand in one pose.

    nodes: node indices, parents first. above: for each node of the rig, (n,), the nearest of ``nodes``
    above it, −1 for none and for nodes that are not of the tree; given where the rig's hierarchy is not
    what is meant. places: (n, 3), where all nodes stand.
    """

    def __init__(
        self, rig: Rig, nodes: Sequence[int], places: Floats, above: Sequence[int] | None = None
    ) -> None:
        self.rig = rig
        self.nodes = list(nodes)
        self.places = places
        self.is_own = above is not None
        self.above = _nearest(rig, frozenset(nodes)) if above is None else list(above)
        self.below: dict[int, list[int]] = {node: [] for node in [-1, *self.nodes]}
        for node in self.nodes:
            self.below[self.above[node]].append(node)

    def without(self, nodes: Collection[int]) -> Tree:
        """The tree of the rig's hierarchy without some nodes: what is below them is below what is above."""
        return Tree(self.rig, [k for k in self.nodes if k not in nodes], self.places) if nodes else self

    def of(self, rig: Rig) -> Tree:
        """The same tree, with all that is known of it, of a rig that differs in names alone."""
        if rig is self.rig:
            return self
        other = copy(self)
        other.rig = rig
        return other

    @cached_property
    def at(self) -> Mapping[int, Vector]:
        """Where each node stands."""
        return _Places(self.places)

    def heights(self, nodes: Iterable[int], up: Vector) -> list[float]:
        """How far each of some nodes stands along a direction."""
        x, y, z = up.x, up.y, up.z
        return [at.x * x + at.y * y + at.z * z for at in map(self.at.__getitem__, nodes)]

    @cached_property
    def span(self) -> float:
        """The diagonal of the box around all nodes, in file units."""
        places = self.places[self.nodes]
        return float(length(places.max(axis=0) - places.min(axis=0))) if len(places) else 0.0

    @cached_property
    def bone(self) -> list[float]:
        """How far each node stands from the one above it; 0 where there is none, (n,)."""
        bone = [0.0] * len(self.rig)
        below = [node for node in self.nodes if self.above[node] >= 0]
        apart = length(self.places[below] - self.places[[self.above[node] for node in below]])
        for node, far in zip(below, apart.tolist(), strict=True):
            bone[node] = far
        return bone

    @cached_property
    def reach(self) -> list[float]:
        """The length of the longest way down from each node, (n,)."""
        reach = [0.0] * len(self.rig)
        for node in reversed(self.nodes):
            over = self.above[node]
            if over >= 0:
                reach[over] = max(reach[over], reach[node] + self.bone[node])
        return reach

    @cached_property
    def size(self) -> list[int]:
        """How many nodes of the tree there are from each node down, itself included, (n,)."""
        size = [0] * len(self.rig)
        for node in reversed(self.nodes):
            size[node] += 1
            if self.above[node] >= 0:
                size[self.above[node]] += size[node]
        return size

    @cached_property
    def depth(self) -> list[int]:
        """How many nodes of the tree are above each node, (n,)."""
        depth = [0] * len(self.rig)
        for node in self.nodes:
            if self.above[node] >= 0:
                depth[node] = depth[self.above[node]] + 1
        return depth

    @cached_property
    def paths(self) -> dict[int, tuple[int, ...]]:
        """From each node down the longest way to a leaf, the node first; past nothing that ends in fingers.

        What hangs at an arm, a shield or a wing, may be longer than the way to its hand.
        """
        paths: dict[int, tuple[int, ...]] = {}
        hands = self._hands
        for node in reversed(self.nodes):
            below = self.below[node]
            if hands[node] == 1 and len(below) > 1:
                below = [k for k in below if hands[k]] or below
            ways = [self.bone[k] + self.reach[k] for k in below]
            least = max(ways, default=0.0) * (1.0 - SAME_SHARE)
            equal = [k for k, way in zip(below, ways, strict=True) if way >= least]
            longest = max(equal, key=self.size.__getitem__, default=-1)
            paths[node] = (node, *paths[longest][:_LONGEST]) if below else (node,)
        return paths

    @cached_property
    def along(self) -> dict[int, float]:
        """From each node down the length of its way of `paths`."""
        along: dict[int, float] = {}
        for node in reversed(self.nodes):
            after = self.paths[node][1:2]
            along[node] = self.bone[after[0]] + along[after[0]] if after else 0.0
        return along

    @cached_property
    def _hands(self) -> list[int]:
        """How many joints there are from each node down at which fingers begin, (n,)."""
        hands, straight = [0] * len(self.rig), [0] * len(self.rig)  # of a chain without branches, its joints
        for node in reversed(self.nodes):
            below = self.below[node]
            if not below:
                straight[node] = 1
            elif len(below) == 1 and straight[below[0]]:
                straight[node] = 1 + straight[below[0]]
            fingers = sum(straight[k] in _FINGER for k in below)
            hands[node] = sum(hands[k] for k in below) + (fingers >= _HAND)
        return hands

    def is_below(self, node: int, other: int) -> bool:
        """Whether ``node`` is ``other`` or under it; everything is below −1."""
        if other < 0 or not self.is_own:
            return other < 0 or self.rig.is_below(node, other)
        while node >= 0 and node != other:
            node = self.above[node]
        return node == other

    def branch(self, node: int) -> list[int]:
        """A node and all of the tree under it."""
        found = [node]
        for k in found:  # it grows as it is walked
            found += self.below[k]
        return found

    def way(self, node: int, end: int) -> list[int]:
        """The nodes from ``end`` up to ``node``, turned round: both included; ``end``'s whole line for −1."""
        line = [end]
        while line[-1] != node and self.above[line[-1]] >= 0:
            line.append(self.above[line[-1]])
        return line[::-1]

    def common(self, a: int, b: int) -> int:
        """The lowest node that both are below or are, −1 where there is none."""
        line = set(self.way(-1, a))
        while b >= 0 and b not in line:
            b = self.above[b]
        return b


class _Places(dict[int, Vector]):
    """Where nodes stand, for those that are asked for: a tree is a small part of a crowd."""

    def __init__(self, places: Floats) -> None:
        self._places = places

    def __missing__(self, node: int) -> Vector:
        place = self[node] = Vector(*self._places[node].tolist())
        return place


def _nearest(rig: Rig, nodes: frozenset[int]) -> list[int]:
    """The nearest of some nodes above each of them; −1 for none, and for all others."""
    above, parents = [-1] * len(rig), rig.parents
    over_others: dict[int, int] = {}
    for node in nodes:
        way, up = list[int](), int(parents[node])
        while up >= 0 and up not in nodes and up not in over_others:
            way.append(up)
            up = int(parents[up])
        over = over_others.get(up, up)
        over_others.update(dict.fromkeys(way, over))
        above[node] = over
    return above


def helpers(rig: Rig) -> frozenset[int]:
    """Nodes of ours that are no bones: all but the joints of limbs, which points may move with."""
    return rig.own.difference(rig.nodes_of(LimbRecord.type))


def joints_of(rig: Rig) -> list[int]:
    """The nodes that a body can be made of: joints, not ours, and bones above them; else all.

    Where every joint is of a limb that make-limb has built, the body is made of these.
    """
    every = np.flatnonzero(rig.is_joint).tolist()
    joints = [node for node in every if node not in rig.own]
    joints = joints or [node for node in every if node not in helpers(rig)]
    if not joints:
        apart = rig.own | rig.rules.data_nodes | _shapes_of_parents(rig)
        return [k for k in range(len(rig)) if k not in apart]
    inside = set(joints)
    for node, below in _branches(rig, joints).items():
        if node not in rig.holders and _may_be_bone(rig, node, below, inside):
            inside.add(node)
    lost = _unplaced_joints(rig)
    return sorted(inside - lost if len(lost) < len(inside) // 2 else inside)


def _shapes_of_parents(rig: Rig) -> frozenset[int]:
    """Nodes that hold the mesh of the node above, which shows none: without children, in its place."""
    shapes = [
        k for k in np.flatnonzero(rig.attachment >= 0).tolist() if not rig.children[k] and rig.parents[k] >= 0
    ]
    shapes = [k for k in shapes if rig.attachment[rig.parents[k]] < 0]
    places = rig.world[:, 3, :3]
    span = float(np.ptp(places, axis=0).max()) / 2.0 if len(rig) else 0.0
    near = [k for k in shapes if float(length(places[k] - places[rig.parents[k]])) <= SAME_POSITION * span]
    return frozenset(near) | (_unplaced_joints(rig) & frozenset(shapes))


def _branches(rig: Rig, joints: Sequence[int]) -> dict[int, list[int]]:
    """Of nodes above joints that are none, which of their children joints are, or are below."""
    below: dict[int, list[int]] = {}
    seen, parents = set(joints), rig.parents.tolist()
    for node in joints:
        over = parents[node]
        while over >= 0 and over not in seen:
            seen.add(over)
            below[over] = [node]
            node, over = over, parents[over]
        if over in below:
            below[over].append(node)
    return below


def _may_be_bone(rig: Rig, node: int, below: Sequence[int], joints: Collection[int]) -> bool:
    """Whether a node above joints, which is none, may be of the body: a bone that moves no point.

    What is above all joints holds several branches. Between two joints stand groups, too, which exporters
    write: one that stands where either does says nothing, nor does another that is not called as a bone.
    """
    over = int(rig.parents[node])
    while over >= 0 and over not in joints:
        over = int(rig.parents[over])
    if over < 0:
        return len(below) > 1
    if node in rig.humanoid.values():
        return True
    ends = [over, *below] if len(below) == 1 else [over]
    apart = length(rig.world[ends, 3, :3] - rig.world[node, 3, :3])
    span = max(float(length(rig.world[k, 3, :3] - rig.world[over, 3, :3])) for k in below)
    return bool((apart > SAME_POSITION * span).all()) and (len(below) > 1 or is_bone(rig.names[node]))


def _unplaced_joints(rig: Rig) -> frozenset[int]:
    """Joints that nobody has placed: three or more without children, of different parents, at the origin."""
    places = rig.world[:, 3, :3]
    still = np.flatnonzero(np.abs(places).max(axis=1) < 1e-9).tolist()
    still = [k for k in still if not rig.children[k] and rig.parents[k] >= 0]
    far = [k for k in still if float(np.abs(places[rig.parents[k]]).max()) > 1e-6]
    return frozenset(far) if len({int(rig.parents[k]) for k in far}) >= 3 else frozenset()


def segments_of(tree: Tree) -> frozenset[int]:
    """The joints that by their names are parts of the bones above them: they stand within, or are leaves.

    Twist and roll joints, and those that Rigify makes of a bone: ``DEF-forearm.L.001``. Of robots, whose
    joints have the names of their axes, ``elbow_roll`` is a joint like ``elbow_yaw``.
    """
    names, found = tree.rig.names, set[int]()
    called = {(parse_name(names[node]).side, parse_name(names[node]).kept) for node in tree.nodes}
    robot = any(not (AXES - {_ROLL}).isdisjoint(parse_name(names[node]).words) for node in tree.nodes)
    for node in tree.nodes:
        over = tree.above[node]
        while over in found:
            over = tree.above[over]
        if over >= 0 and (_held(names[node]) in called or _is_empty(tree, node) or _holds_below(tree, node)):
            found.add(node)
            continue
        if over < 0 or len(tree.below[node]) > 1 or not is_segment(names[node], names[over]):
            continue
        if robot and _ROLL in parse_name(names[node]).words:
            continue
        after = tree.below[node][0] if tree.below[node] else -1
        other = _is_lower(names, over, node, after) or _is_first(names, over, node, after)
        words = parse_name(names[node]).words
        least = _IN_LINE if _ROLL in words or "twist" not in roles_in_name(names[node]) else _TWISTED
        if after < 0 or (_is_between(tree, over, node, after, least) and not other):
            found.add(node)
    return frozenset(found)


def _is_empty(tree: Tree, node: int) -> bool:
    """Whether a joint is called a group and stands where the one above does, so that it is no bone."""
    group = not HOLDERS.isdisjoint(parse_name(tree.rig.names[node]).words)
    return group and bool(tree.below[node]) and tree.bone[node] <= SAME_POSITION * tree.span


def _holds_below(tree: Tree, node: int) -> bool:
    """Whether a joint is called to hold the one below it, in whose place it stands, but for numbers.

    Exporters number all nodes: ``lowerarm_l_offset_100`` holds ``lowerarm_l_101``.
    """
    held = _held(tree.rig.names[node])
    near = [k for k in tree.below[node] if held and tree.bone[k] <= SAME_POSITION * tree.span]
    below = [parse_name(tree.rig.names[k]) for k in near]
    return held is not None and (held[0], _letters(held[1])) in [(k.side, _letters(k.kept)) for k in below]


def _letters(words: Sequence[str]) -> list[str]:
    return [word for word in words if not is_number(word)]


def _held(name: str) -> tuple[str, tuple[str, ...]] | None:
    """The side and words of the joint that a node is called to hold; None without a word for a group."""
    parsed = parse_name(name)
    more = tuple(word for word in parsed.kept if word not in HOLDERS)
    return (parsed.side, more) if more and len(more) < len(parsed.kept) else None


def _is_lower(names: Sequence[str], start: int, node: int, end: int) -> bool:
    """Whether a numbered piece of an upper bone is the lower one, not renamed: a hand or foot follows."""
    upper, last = limb_words(names[start]).levels, limb_words(names[end]).levels
    return upper.keys() == {"upper"} and "end" in last and "twist" not in roles_in_name(names[node])


def _is_first(names: Sequence[str], start: int, node: int, end: int) -> bool:
    """Whether a twist joint is where its bone begins, not a part of a shoulder or hip before that.

    The joint after it says the same of a limb. Source: Auto-Rig Pro, ``shoulder``, ``arm_twist``,
    ``arm_stretch``.
    """
    own, after = limb_words(names[node]), limb_words(names[end])
    same = bool(own.levels) and (own.levels, own.kind) == (after.levels, after.kind)
    of_start = parse_name(names[node]).plain.startswith(parse_name(names[start]).plain)
    return same and not of_start and "before" in limb_words(names[start]).levels


def _is_between(tree: Tree, start: int, node: int, end: int, least: float) -> bool:
    """Whether a joint stands near the line between two others; least: the cosine of the bend there."""
    one, other = tree.at[node] - tree.at[start], tree.at[end] - tree.at[node]
    return not any(one) or not any(other) or one.unit.dot(other.unit) > least
