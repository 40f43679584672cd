"""A character by its shape: its most symmetric pose, its mirror plane, and candidates for its limbs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from rigtri.maths.arrays import Integers
from rigtri.maths.ranking import SAME_LENGTH, SAME_SCORE, ranked
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot, length
from rigtri.model.dataclass import dataclass
from rigtri.recognition.biped_or_quadruped import settled
from rigtri.recognition.body_shape import Body, bodies
from rigtri.recognition.facing import facing_of
from rigtri.recognition.front_or_hind import before_wings, turned
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.layout import LimbKind, PoseName
from rigtri.recognition.limb_ends import HAND
from rigtri.recognition.limb_pairs import Limbs, limbs_of
from rigtri.recognition.limb_triples import first_bend
from rigtri.recognition.limb_words import LimbWords
from rigtri.recognition.many_legs import many_legs
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.order_in_names import joined
from rigtri.recognition.pose_samples import Measured, Poses
from rigtri.recognition.symmetry import Pair, Plane, named_pairs, opposite, parted_by_names, plane_of
from rigtri.recognition.untwisted import Twist, twists

# Where a body looks has to be so sure, 0 to 1, before knees and elbows are taken to point as they should.
_LOOKS = 0.5
# Larger groups are read by names alone: no body has so many joints.
MOST = 3000


@dataclass(frozen=True, eq=False)
class Shape:
    """tree: in the pose ``pose``. bodies: the likeliest first, () where it is none. legs: of a body with more
    than two pairs of them. is_rough: its pairs are alike only if noise is allowed for. twist: of a chest that
    is turned against the hips; ``tree`` is without it."""

    tree: Tree
    pose: PoseName
    pairs: tuple[Pair, ...]
    plane: Plane | None
    limbs: tuple[Limbs, ...]
    bodies: tuple[Body, ...]
    legs: tuple[Limbs, ...] = ()
    is_rough: bool = False
    twist: Twist | None = None

    @cached_property
    def body(self) -> Body | None:
        return self.bodies[0] if self.bodies else None


def taken_for_limbs(shape: Shape) -> list[Limbs]:
    """The pairs of a shape that are arms or legs of its likeliest body, or are called so."""
    body = shape.body
    mine = {body.legs, body.arms, *shape.legs} if body is not None else {*shape.legs}
    return [limbs for limbs in shape.limbs if limbs in mine or limbs.kind in ("arm", "leg")]


def tree_of(nodes: Sequence[int], poses: Poses, pose: PoseName) -> Tree:
    """The tree of joints; where all are children of one, each is a child of its neighbour.

    And of the one before it where names tell that, see `Poses.after`.
    """
    return _measured(nodes, poses, pose).tree.of(poses.rig)


def _measured(nodes: Sequence[int], poses: Poses, pose: PoseName) -> Measured:
    known = poses.measured.get((pose, tuple(nodes)))
    if known is None:
        tree = Tree(poses.rig, nodes, poses.named(pose))
        tree = _neighbours(tree) if len(nodes) <= MOST and is_flat(tree) else tree
        known = Measured(joined(tree, poses.after) if poses.after else tree)
        poses.measured[pose, tuple(nodes)] = known
    return known


def shape_of(nodes: Sequence[int], poses: Poses, names: Mapping[int, LimbWords]) -> Shape:
    """The shape of joints in the pose, of rest and bind, that shows a body best.

    names: what names of joints say about limbs.
    """
    rest = _seen(nodes, poses, "rest", names)
    if poses.bind is None or len(nodes) > MOST or bool(np.abs(poses.bind - poses.rest).max() < 1e-6):
        return rest
    bind = _seen(nodes, poses, "bind", names)
    return bind if _worth(bind) > _worth(rest) + 1e-6 else rest


def _worth(shape: Shape) -> float:
    score = shape.body.score if shape.body else 0.0
    return score + (0.2 * shape.plane.share if shape.plane else 0.0)


def _seen(nodes: Sequence[int], poses: Poses, pose: PoseName, names: Mapping[int, LimbWords]) -> Shape:
    if len(nodes) > MOST:
        return Shape(tree_of(nodes, poses, pose), pose, (), None, (), ())
    measured, tree = _measured(nodes, poses, pose), tree_of(nodes, poses, pose)
    exact = _with_pairs(measured.pairs, measured.plane, tree, poses, pose, names)
    if _is_whole(exact):
        return exact
    if (untwisted := _untwisted(exact, measured.pairs, poses, names)) is not None:
        return untwisted
    if len(measured.rough_pairs) == len(measured.pairs):
        return exact
    rough = _with_pairs(measured.rough_pairs, measured.rough_plane, tree, poses, pose, names)
    found = rough if _is_whole(rough) else _untwisted(rough, measured.rough_pairs, poses, names)
    return exact if found is None else replace(found, is_rough=True)


def _is_whole(shape: Shape) -> bool:
    """Whether a body has legs and arms, or legs in front and behind."""
    return bool(shape.legs) or (shape.body is not None and bool(shape.body.legs and shape.body.arms))


def _untwisted(
    shape: Shape, known: Sequence[Pair], poses: Poses, names: Mapping[int, LimbWords]
) -> Shape | None:
    """The same, with the chest turned back to the hips, where that makes a body on two legs with arms of it.

    known: pairs that turning changes nothing of. Of both ways to turn it back the one after which more tells
    where the body looks: knees, elbows, feet and thumbs agree then.
    """
    best, found = 0.0, None
    for twist in twists(shape.tree, shape.pairs):
        poses.turn(twist, shape.pose)
        plane = plane_of(twist.tree, known)
        other = _with_pairs(known, plane, twist.tree, poses, shape.pose, names)
        body = other.body
        if other.plane is None or body is None or not (body.legs and body.arms) or body.form != "biped":
            continue
        if (body.legs.pair.nodes, body.arms.pair.nodes) != tuple(pair.nodes for pair in twist.pairs):
            continue
        _, sure, _ = facing_of(twist.tree, body, other.plane, poses)
        if body.score + sure > best + SAME_SCORE:
            best, found = body.score + sure, replace(other, twist=twist)
    return found


def _with_pairs(
    known: Sequence[Pair],
    plane: Plane | None,
    tree: Tree,
    poses: Poses,
    pose: PoseName,
    names: Mapping[int, LimbWords],
) -> Shape:
    """The shape of a tree in a pose by the pairs of its branches that are known, and their plane."""
    pairs = [pair for pair in known if not (_of_one_side(tree, pair) or parted_by_names(tree, pair))]
    plane = plane if len(pairs) == len(known) else plane_of(tree, pairs)
    if more := named_pairs(tree, pairs):
        pairs = ranked([*pairs, *more], lambda pair: pair.reach, SAME_LENGTH * tree.span)
        plane = plane or plane_of(tree, pairs)
    pairs = opposite(tree, pairs, plane)
    limbs = limbs_of(tree, pairs, poses, names)
    ways = bodies(tree, limbs, plane)
    if ways and not (ways[0].legs and ways[0].arms) and any(each.fingers >= HAND for each in limbs):
        paws = limbs_of(tree, pairs, poses, names, kind="leg")
        others = bodies(tree, paws, plane)
        if others and others[0].form == "quadruped" and others[0].score > ways[0].score:
            limbs, ways = paws, others
    ways = [settled(tree, way, poses, names) for way in ways]
    if plane is not None:
        ways = before_wings(tree, turned(tree, ways, limbs, plane, poses), plane, poses)
    legs, up = many_legs(tree, limbs, plane)
    if legs and ways:
        ways = [replace(ways[0], up=up), *ways[1:]]
    if plane is not None and ways and not legs:
        again = _pointed(tree, ways[0], plane, poses, names)
        limbs = [again.get(one, one) for one in limbs]
        ways = [
            replace(way, legs=again.get(way.legs, way.legs), arms=again.get(way.arms, way.arms))
            for way in ways
        ]
    return Shape(tree, pose, tuple(pairs), plane, tuple(limbs), tuple(ways), legs)


def _of_one_side(tree: Tree, pair: Pair) -> bool:
    """Whether names put two branches on one side: so fingers are, and a front and a hind leg."""
    sides = [{parse_name(tree.rig.names[node]).side for node in path} - {""} for path in pair.paths]
    return sides[0] == sides[1] and len(sides[0]) == 1


def _pointed(
    tree: Tree, body: Body, plane: Plane, poses: Poses, names: Mapping[int, LimbWords]
) -> dict[Limbs | None, Limbs]:
    """The limbs of a body again: knowing where it looks, its knees point there and its elbows back.

    Of animals with blades and hocks that tells which joint is knee or elbow; of what stands upright, that
    clavicles are no part of its arms; and legs do not end where toes begin.
    """
    ahead, sure, _ = facing_of(tree, body, plane, poses, bends=False)
    found: dict[Limbs | None, Limbs] = {}
    for limbs, side in ((body.legs, ahead), (body.arms, -ahead)):
        if limbs is None or len(limbs.at) < 3:
            continue
        kind: LimbKind = "arm" if limbs is body.arms and body.form == "biped" else "leg"
        towards = side if sure >= _LOOKS else None
        if towards is None and limbs is body.legs:
            towards = first_bend(tree, limbs.pair.paths[0], limbs.at, plane.normal)
        if kind == "arm" or towards is not None or limbs.fingers >= HAND:
            again = limbs_of(tree, [limbs.pair], poses, names, towards, kind)
            found |= {limbs: again[0]} if again else {}
    return found


def is_flat(tree: Tree) -> bool:
    """Whether all joints are below one node, so that none follows another."""
    loose = [k for k in tree.nodes if not tree.below[k]]
    return 8 <= len(loose) <= MOST // 4 and len(loose) >= len(tree.nodes) - 2


def _neighbours(tree: Tree) -> Tree:
    """The shortest tree that joins joints which all are children of one, from the one in their middle.

    No joint follows one of the other side, and those in the middle follow one another, so that both sides
    come out alike. Source: R. C. Prim, "Shortest connection networks and some generalizations", 1957.
    """
    nodes = [k for k in tree.nodes if tree.rig.is_joint[k] or not tree.below[k]]
    places = tree.places[nodes]
    apart = np.stack([dot(places - place, places - place) for place in places])
    side = _sides(places)
    # From row to column: what may not follow is far away.
    apart = np.where((side[:, np.newaxis] != side) & (side[:, np.newaxis] != 0), np.inf, apart)
    middle = np.flatnonzero(side == 0)
    choice = middle if len(middle) else np.arange(len(nodes))
    centre = 0.5 * (places.max(axis=0) + places.min(axis=0))
    first = int(choice[int(np.argmin(length(places[choice] - centre)))])
    order, over = [first], np.full(len(nodes), first)
    near, left = apart[first].copy(), np.ones(len(nodes), dtype=bool)
    left[first] = False
    above = [-1] * len(tree.rig)
    while left.any():
        reached = np.where(left, near, np.inf)
        nearest = int(np.argmin(reached))
        if not np.isfinite(reached[nearest]):
            # The middle has no joint, as of a body that runs: sides follow, too.
            free = np.stack([dot(places[order] - place, places[order] - place) for place in places])
            near, over = free.min(axis=1), np.array(order)[free.argmin(axis=1)]
            nearest = int(np.argmin(np.where(left, near, np.inf)))
        left[nearest] = False
        order.append(nearest)
        above[nodes[nearest]] = nodes[int(over[nearest])]
        closer = left & (apart[nearest] < near)
        near[closer], over[closer] = apart[nearest][closer], nearest
    return Tree(tree.rig, [nodes[k] for k in order], tree.places, above)


def _sides(places: Floats) -> Integers:
    """Which side of the plane of an axis, the one with most mirror images, places are on: −1, 0 or 1."""
    centre = 0.5 * (places.max(axis=0) + places.min(axis=0))
    size = float(length(places.max(axis=0) - places.min(axis=0)))
    best, found = -1, np.zeros(len(places), dtype=np.int64)
    for axis in range(3):
        image = places.copy()
        image[:, axis] = 2.0 * centre[axis] - image[:, axis]
        offsets = image[:, np.newaxis] - places
        count = int(np.count_nonzero(dot(offsets, offsets).min(axis=1) < 4e-4 * size * size))
        far = places[:, axis] - centre[axis]
        side = np.where(np.abs(far) < 0.01 * size, 0, np.where(far > 0, 1, -1))
        # A flat body is its own image in its plane, too: that one parts nothing.
        if count > best and np.count_nonzero(side) > len(places) // 2:
            best, found = count, side
    return found
