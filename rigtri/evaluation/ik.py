"""IK of a limb: its end follows a control, its bend a pole vector; and the positions that both need.

The solver turns the rest pose of the limb, moved by the node above the limb, from the triangle
that its joints make there to the one that reaches the target. A control that rounding has put beside its
joint is taken to be on it, so that a hard limb's rest pose stays as it is. FK controls of the limb's joints
work below the solver: their channels come on top of what it has found. An end joint that is no descendant of
the mid joint (a flat rig) stands where the control is, whether the limb reaches it or not.
"""

from __future__ import annotations

from collections.abc import Collection
from functools import cached_property
from typing import NamedTuple

import numpy as np

from rigtri.evaluation.constraint_solver import Parts, constraint_pole, to_parts
from rigtri.evaluation.fk import Fk
from rigtri.evaluation.pole_lean import NEARLY_STRAIGHT, SAME_SIDE, lean_at_rest, leaned, leaning
from rigtri.evaluation.pose_cache import PoseCache
from rigtri.evaluation.solver_steps import weighted
from rigtri.evaluation.two_bone_ik import NOWHERE, Solved, bone_frame, distance_for, sides, two_bone
from rigtri.evaluation.zero_pose import SAME_POSITION, ControlsAtZero, IkLimb
from rigtri.maths.arrays import level
from rigtri.maths.matrices import from_frame, inverse, multiply, transform_directions, transform_points
from rigtri.maths.quaternions import conjugate, rotate, to_axes
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.ranking import axis_across
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length, normalise
from rigtri.model.constraints import Constraint
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import ControlRecord
from rigtri.model.rig import Rig

# Sines of the bend from which on, and up to which, a pole is placed by the bend and by the bone.
_BENDS, _STRAIGHTENS = 0.15, 0.02


class _Rest(NamedTuple):
    """What stays the same in all frames. lines: of the bones, seen from the node above the limb, (3,) each.

    upper, lower: the frames of the bones, seen from its turn. between, last: how the parents of the
    mid and the end joint are turned, seen from its turn. side: the way it bends, in its axes.
    """

    lines: tuple[Floats, Floats]
    upper: Floats
    lower: Floats
    between: Floats
    last: Floats
    root_to_end: Floats
    side: Floats


@dataclass(frozen=True, eq=False)
class Ik:
    """One limb of a rig. fk: the FK controls of its joints, by joint. rule: what moves its pole besides.

    carries: offsets of those controls that must stand where the limb has come to, parents first,
    because something looks at what is below them. rolls: whether pivots of its foot are at work, so that
    one of them carries the toe.
    """

    reference: ControlsAtZero
    limb: IkLimb
    fk: dict[int, Fk]
    rule: Constraint | None = None
    carries: tuple[int, ...] = ()
    rolls: bool = False

    @property
    def rig(self) -> Rig:
        return self.reference.rig

    @cached_property
    def paths(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """The nodes below the root down to the mid joint, and below that down to the end."""
        a, b, c = self.limb.chain
        return self._path(a, b), (c,) if self.limb.detached else self._path(b, c)

    def _path(self, start: int, end: int) -> tuple[int, ...]:
        path = [end]
        while int(self.rig.parents[path[-1]]) != start:
            path.append(int(self.rig.parents[path[-1]]))
        return tuple(path[::-1])

    @property
    def sets(self) -> tuple[int, ...]:
        a, _, _ = self.limb.chain
        upper, lower = self.paths
        limb = (a, *upper, *lower) if self.limb.stretch else self.limb.chain
        return (*limb, self.limb.toe) if self.rolls else limb

    @cached_property
    def controls(self) -> tuple[int, ...]:
        """The FK controls of its joints."""
        return tuple(fk.own.control for fk in self.fk.values())

    @cached_property
    def reads(self) -> tuple[int, ...]:
        # Offsets are put on the joints, seen from all nodes above them.
        above = self.rig.with_ancestors(fk.own.above for fk in self.below(self.carries))
        weights = self.rule.weight_nodes if self.rule else ()
        return (*self.controls, *sorted(above.difference(self.carries, self.controls)), *weights)

    @property
    def needs(self) -> tuple[int, ...]:
        nodes = [self.above, self.limb.holder, self.limb.pole, *(self.rule.sources if self.rule else ())]
        if self.limb.detached:
            nodes.append(int(self.rig.parents[self.limb.chain[2]]))
        return tuple(node for node in nodes if node >= 0)

    @property
    def above(self) -> int:
        """The node above the limb, −1 for none."""
        return int(self.rig.parents[self.limb.chain[0]])

    @cached_property
    def _points(self) -> Floats:
        """Root, mid and end joint while controls are zero, (3, 3), in the world."""
        return self.reference.world[list(self.limb.chain), 3, :3]

    @cached_property
    def _size(self) -> float:
        """How long both bones are while controls are zero, in the world."""
        a, b, c = self._points
        return float(length(b - a) + length(c - b))

    @cached_property
    def _line(self) -> Floats:
        """The direction from root to end while controls are zero, (3,); of a folded limb, any that fits."""
        a, b, c = self._points
        square = cross(b - a, axis_across(b - a))
        for line in (c - a, square):
            if length(line) > NOWHERE * self._size:
                return normalise(line)
        return np.array([1.0, 0.0, 0.0])

    @cached_property
    def _seat(self) -> Floats:
        """From what holds the limb to its target, seen from how that is turned, (3,), whatever its scale.

        The target is the control, but the end joint, where but rounding parts the two.
        """
        target, end = self.reference.world[self.limb.control, 3, :3], self._points[2]
        if length(end - target) <= SAME_POSITION * float(np.abs(self.rig.world[:, 3, :3]).max(initial=0.0)):
            target = end
        holder = self.limb.holder
        turn = conjugate(self.reference.world_rotation(holder))
        return rotate(turn, target - self.reference.world[holder, 3, :3])

    @cached_property
    def _aside(self) -> tuple[Floats, Floats]:
        """From the line of root and end to the mid joint and to the pole vector at zero, (3,) each."""
        a, b, _ = self._points
        pole = self.reference.world[self.limb.pole, 3, :3] if self.limb.pole >= 0 else b
        bend, across = (way - dot(way, self._line) * self._line for way in (b - a, pole - a))
        return bend, across

    @cached_property
    def lean(self) -> float:
        """By how much it is bent beside its pole while controls are zero, in radians; if opposed, by side."""
        lean = lean_at_rest(*self._aside, self._line, self._size) if self.limb.pole >= 0 else 0.0
        right = self.rig.records(ControlRecord)[self.limb.control].side == "right"
        return -lean if right and lean > np.pi - SAME_SIDE else lean

    @cached_property
    def _pole(self) -> Floats:
        """The pole of the rest pose, (3,): the pole vector, or a point in the limb's plane."""
        a, b, _ = self._points
        bend, across = self._aside
        straight = length(bend) <= NEARLY_STRAIGHT * self._size
        if self.limb.pole >= 0:
            near = length(cross(normalise(across), normalise(bend))) <= SAME_SIDE
            if straight or self.lean or (near and dot(across, bend) > 0):
                return np.asarray(self.reference.world[self.limb.pole, 3, :3])
        if straight:  # no direction to bend to: an axis of its own, the same one every time
            return np.asarray(a + cross(self._line, axis_across(self._line)))
        return np.asarray(b + normalise(bend) * self._size)

    @cached_property
    def rest(self) -> _Rest:
        """The triangle is the one of the joints, in the plane of the pole: turns are counted from it, so
        bones lie where the solver expects them. What parts the mid joint from that plane, which is
        rounding, is not seen."""
        world, above = self.reference.world, self.above
        a, b, c = self._points
        root_to_end, side = self._line, self._pole - a
        leans = np.asarray(self.lean) if self.lean else None
        bends, _ = sides(root_to_end, side, side, np.asarray(self._size))
        hinge = cross(root_to_end, leaned(bends, root_to_end, leans))
        upper, lower = (bone - dot(bone, hinge) * hinge for bone in (b - a, c - b))
        start = conjugate(self.reference.world_rotation(above))
        back = inverse(world[above]) if above >= 0 else np.eye(4)
        _, mid, end = self.limb.chain
        return _Rest(
            lines=(transform_directions(upper, back), transform_directions(lower, back)),
            upper=product(start, bone_frame(upper, hinge, leans)),
            lower=product(start, bone_frame(lower, hinge, leans)),
            between=product(start, self.reference.world_rotation(int(self.rig.parents[mid]))),
            last=product(start, self.reference.world_rotation(int(self.rig.parents[end]))),
            root_to_end=rotate(start, root_to_end),
            side=rotate(start, side),
        )

    def _own(self, node: int) -> Parts:
        """Local parts of a joint of the limb while controls are zero, one row."""
        if node in self.fk:
            return self.fk[node].rest
        return to_parts(self.reference.local[node][np.newaxis])

    @cached_property
    def reach_at_rest(self) -> float:
        """How far the end is from the root while controls are zero, as a share of the limb."""
        a, _, c = self._points
        return float(length(c - a)) / self._size if self._size > 0 else 0.0

    @cached_property
    def start(self) -> Floats:
        """Where the limb's root is, (1, 3), seen from the node above it."""
        return self._own(self.limb.chain[0]).translation

    def lengths(self, posed: PoseCache) -> tuple[Floats, Floats]:
        """How long the two bones are, (1 or f,) each, in the world."""
        world = posed.world(self.above)
        upper, lower = self.rest.lines
        return length(transform_directions(upper, world)), length(transform_directions(lower, world))

    def solve(self, posed: PoseCache, target: Floats, place: Floats) -> Solved:
        """The limb's triangle for a target and a pole, (f, 3) each, in the world."""
        rest, turn = self.rest, posed.turn(self.above)
        root = transform_points(self.start, posed.world(self.above))
        root, target, place, first, second = level(root, target, place, *self.lengths(posed))
        return two_bone(
            root,
            (first, second),
            target,
            place,
            root_to_end=rotate(turn, rest.root_to_end),
            side=rotate(turn, rest.side),
            soft=self.limb.soft,
            stretch=self.limb.stretch,
            at_rest=self.reach_at_rest,
            lean=self.lean,
        )

    def solved(self, posed: PoseCache, target: Floats, place: Floats, hand: Floats) -> dict[int, Parts]:
        """Local parts of the limb's joints, before their FK controls. hand: the turn of the end, (f, 4)."""
        found = self.solve(posed, target, place)
        rest, turn = self.rest, posed.turn(self.above)
        start, mid, end = self.limb.chain
        upper = product(product(conjugate(turn), found.upper), conjugate(rest.upper))
        fold = product(product(conjugate(found.upper), found.lower), conjugate(rest.lower))
        bent = product(product(conjugate(rest.between), product(rest.upper, fold)), rest.between)
        parts = {node: self._own(node) for node in (start, mid, end)}
        result = {
            start: parts[start]._replace(rotation=product(upper, parts[start].rotation)),
            mid: parts[mid]._replace(rotation=product(bent, parts[mid].rotation)),
        }
        if self.limb.detached:
            parent = int(self.rig.parents[end])
            place = transform_points(target, inverse(posed.world(parent)))
            turned = product(conjugate(posed.turn(parent)), hand)
            result[end] = parts[end]._replace(translation=place, rotation=turned)
        else:
            below = product(product(found.lower, conjugate(rest.lower)), rest.last)
            result[end] = parts[end]._replace(rotation=product(conjugate(below), hand))
        if self.rolls:
            toe, turned = self._own(self.limb.toe), product(posed.turn(self.limb.pivots[-2]), self._toe)
            hand = self.reference.turn_below(hand, end, int(self.rig.parents[self.limb.toe]))
            result[self.limb.toe] = toe._replace(rotation=product(conjugate(hand), turned))
        if self.limb.stretch:
            for node in (*self.paths[0], *(() if self.limb.detached else self.paths[1])):
                own = result.get(node) or self._own(node)
                grown = own.translation * found.stretch[:, np.newaxis]
                result[node] = own._replace(translation=grown)
        return result

    @cached_property
    def grip(self) -> Floats:
        """The end joint's turn seen from what holds it, (4,): ``hand = holder · grip``."""
        return self._seen_from(self.limb.holder, self.limb.chain[2])

    @cached_property
    def _toe(self) -> Floats:
        """The toe's turn seen from the pivot that carries it, (4,)."""
        return self._seen_from(self.limb.pivots[-2], self.limb.toe)

    def _seen_from(self, holder: int, node: int) -> Floats:
        joint = product(
            self.reference.world_rotation(int(self.rig.parents[node])), self._own(node).rotation[0]
        )
        return product(conjugate(self.reference.world_rotation(holder)), joint)

    def run(self, posed: PoseCache) -> None:
        """Move the limb's joints to where control and pole vector direct them."""
        found = self.solved(posed, self.target(posed), self.pole_position(posed), self.hand(posed))
        for node, parts in found.items():
            if node in self.fk:
                parts = self.fk[node].moved(parts, posed.part(self.fk[node].own.control))
            posed.set(node, parts)
        for fk in self.below(self.carries):
            posed.set(fk.own.offset, fk.beneath(posed))

    def below(self, offsets: Collection[int]) -> list[Fk]:
        """The FK controls below some of the limb's offsets, parents first."""
        found = [fk for fk in self.fk.values() if fk.own.offset in offsets]
        return sorted(found, key=lambda fk: fk.own.offset)

    def target(self, posed: PoseCache) -> Floats:
        """Where the limb is to end, (1 or f, 3), by its control."""
        holder, grown = self.limb.holder, self.reference.growth(self.limb, posed.world)
        return posed.world(holder)[:, 3, :3] + grown * rotate(posed.turn(holder), self._seat)

    def hand(self, posed: PoseCache) -> Floats:
        """How the end is to be turned, (1 or f, 4), by its control."""
        return product(posed.turn(self.limb.holder), self.grip)

    def pole_position(self, posed: PoseCache) -> Floats:
        """Where the pole is, (1 or f, 3)."""
        own = self._own_pole_position(posed)
        if self.rule is None:
            return own
        rule = weighted(self.rule, posed)
        held = [posed.world(node) for node in rule.drivers]
        count = max(*map(len, (*held, own)), len(rule.weights) if rule.weights.ndim > 1 else 1)
        drivers = np.stack([np.broadcast_to(m, (count, 4, 4)) for m in held], axis=1)
        found = constraint_pole(rule, drivers)
        return np.where(np.isfinite(found).all(axis=-1, keepdims=True), found, own)

    def _own_pole_position(self, posed: PoseCache) -> Floats:
        """Where the pole is without a rule that moves it, (1 or f, 3)."""
        if self.limb.pole >= 0:
            return posed.world(self.limb.pole)[:, 3, :3]
        # Without a pole it bends to where it bends at rest.
        root = transform_points(self.start, posed.world(self.above))
        return root + rotate(posed.turn(self.above), self.rest.side)

    def grasp(self, built: PoseCache, source: PoseCache) -> Floats:
        """World matrices, (f, 4, 4), of a control with which the limb's end stands as in ``source``.

        built: the rig above the limb as controls make it. The end of a soft or straight limb is nearer than
        its target.
        """
        end = self.limb.chain[2]
        parent = source.turn(int(self.rig.parents[end]))
        turn = product(product(parent, source.part(end).rotation), conjugate(self.grip))
        place = source.world(end)[:, 3, :3]
        if not self.limb.stretch and not self.limb.detached:
            first, second = self.lengths(built)
            away = place - transform_points(self.start, built.world(self.above))
            reach = length(away)
            target_distance = distance_for(reach, first + second, self.limb.soft, self.reach_at_rest)
            share = np.where(reach > 0, target_distance / np.where(reach > 0, reach, 1.0), 1.0)
            place = place + away * (share - 1.0)[:, np.newaxis]
        grown = self.reference.growth(self.limb, built.world)
        holder = from_frame(to_axes(turn) * grown[..., np.newaxis], place - grown * rotate(turn, self._seat))
        for node in self.limb.pivot_path:
            holder = multiply(inverse(built.local(node)), holder)
        return holder

    def side(self, source: PoseCache) -> Floats:
        """The pole position for the bend that the joints have in ``source``, (f, 3), in the world.

        By the triangle where it bends to the side that it bends to at rest; where it is nearly
        straight, or bends the other way, by how the upper bone is turned, whose side goes along from the
        bone to the line from root to end by the shortest way. So a pole never flips.
        """
        a, b, c = (source.world(node)[:, 3, :3] for node in self.limb.chain)
        a, b, c = level(a, b, c)
        size = length(b - a) + length(c - b)
        line = normalise(c - a)
        bend = (b - a) - dot(b - a, line)[:, np.newaxis] * line
        start = self.limb.chain[0]
        turned = product(source.turn(self.above), source.part(start).rotation)
        inside = rotate(conjugate(self._own(start).rotation[0]), self.rest.side)
        as_turned = rotate(turned, inside)
        bone = normalise(b - a)
        own = as_turned - dot(as_turned, bone)[:, np.newaxis] * bone
        both = bone + line
        spread = np.maximum(1.0 + dot(bone, line), 1e-12)  # 0: folded onto itself, and no way is the shortest
        own = normalise(own - (dot(own, line) / spread)[:, np.newaxis] * both)
        # A bone or a limb without length has no line; where scale has left no axes, there is no side, either.
        sized = np.min(length(source.world(start)[:, :3, :3]), axis=1, keepdims=True) > 0
        own = np.where(sized & ~np.isfinite(own), as_turned, own)
        leans = leaning(length(c - a), size, self.reach_at_rest, -self.lean)
        bend_side = leaned(normalise(bend), line, leans)
        sine = 2.0 * length(bend) / size * np.maximum(dot(bend_side, own), 0.0)
        share = np.clip((sine - _STRAIGHTENS) / (_BENDS - _STRAIGHTENS), 0.0, 1.0)
        share = np.where(np.isfinite(share), share * share * (3.0 - 2.0 * share), 0.0)[:, np.newaxis]
        mixed = normalise(np.where(share > 0, share * bend_side, 0.0) + (1.0 - share) * own)
        return b + mixed * self._distance

    @cached_property
    def _distance(self) -> float:
        """How far the pole stands from the mid joint, at rest as always."""
        place = self.reference.world[self.limb.pole, 3, :3] if self.limb.pole >= 0 else self._pole
        return float(length(place - self._points[1]))
