"""FK: what the channels of a control do to its joint, and which channels give a joint's pose.

A joint whose parent has the control above is moved in its parent's space, so nothing of the world
takes part: rotation = rest · channel, in the joint's own axes. Any other joint is carried
rigidly by the parent of its control's offset, and then moved by the channels.

Source: R. Katz, "Rigging with Triangles", GDC 2018, "Build finger"; "Matrix parent constraint"
(article): local = offset · driver · parent⁻¹.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from rigtri.evaluation.constraint_solver import Parts, to_parts
from rigtri.evaluation.pose_cache import PoseCache
from rigtri.evaluation.zero_pose import ControlsAtZero, FkControl
from rigtri.maths.matrices import from_frame, handedness, inverse, multiply, transform_directions
from rigtri.maths.quaternions import IDENTITY, conjugate, half_turn, rotate, to_axes, unit
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig

# Axes of a control this near to its joint's are the joint's: offsets are float32.
_SAME_AXES = 1e-6


@dataclass(frozen=True, eq=False)
class Fk:
    """One control and its joint in a rig, with what stays the same in all frames."""

    reference: ControlsAtZero
    own: FkControl

    @property
    def rig(self) -> Rig:
        return self.reference.rig

    @property
    def joint(self) -> int:
        return self.own.joint

    @property
    def sets(self) -> tuple[int, ...]:
        return (self.joint,)

    @property
    def reads(self) -> tuple[int, ...]:
        """The nodes whose local parts are read."""
        return (self.own.control,)

    @cached_property
    def needs(self) -> tuple[int, ...]:
        """The nodes whose places in the world are used."""
        if self._direct:
            return ()
        return tuple(node for node in (self._carrier, int(self.rig.parents[self.joint])) if node >= 0)

    @property
    def through(self) -> dict[int, tuple[int, int]]:
        """By node of `needs` that is not the joint's parent: the control and offset that depend on it."""
        parent = int(self.rig.parents[self.joint])
        return {node: (self.own.control, self.own.offset) for node in self.needs if node != parent}

    @property
    def _carrier(self) -> int:
        """What moves the joint while its channels are zero: the joint of the control above, else that."""
        return self.reference.control_of.get(self.own.above, self.own.above)

    @property
    def _direct(self) -> bool:
        return self._carrier == int(self.rig.parents[self.joint]) and self._carrier >= 0

    @cached_property
    def rest(self) -> Parts:
        """The joint's local parts while all controls are zero, one row."""
        rig, joint = self.rig, self.joint
        local = self.reference.local[joint]
        if not rig.has_matrix[joint] and np.array_equal(local, rig.normalised_local[joint]):
            row = slice(joint, joint + 1)
            return Parts(rig.translation[row], unit(rig.rotation[row]), rig.scale[row])
        return to_parts(local[np.newaxis])

    @cached_property
    def _axes(self) -> Floats | None:
        """The control's axes seen from the joint's stored rotation, (4,); None where they are the same."""
        above = int(self.rig.parents[self.joint])
        stored = product(self.reference.world_rotation(above), self.rest.rotation[0])
        axes = unit(product(conjugate(stored), self.reference.world_rotation(self.own.offset)))
        axes = axes if axes[3] >= 0 else -axes
        return None if np.abs(axes - IDENTITY).max() <= _SAME_AXES else axes

    @cached_property
    def _shares(self) -> Floats:
        """How much each axis of the control is along each of its joint's, (3, 3): squares of cosines.

        Where axes are axes again all is exact; other axes do not share a scale that is not uniform.
        """
        axes = to_axes(IDENTITY if self._axes is None else self._axes)
        return np.asarray(axes * axes)

    @cached_property
    def _moves(self) -> Floats:
        """What takes a move along the control's axes into the space of the joint's carrier, (4, 4)."""
        carrier = self.reference.world[self._carrier] if self._carrier >= 0 else np.eye(4)
        return multiply(self.reference.world[self.own.offset], inverse(carrier))

    @cached_property
    def _seen_from_parent(self) -> Floats:
        """The control's axes at rest in the space of its joint's parent, (4, 4), which may have another unit.

        Those in the carrier's space where the parent is flat: then the joint cannot be seen to move.
        """
        parent = int(self.rig.parents[self.joint])
        if parent < 0 or parent == self._carrier:
            return self._moves
        found = multiply(self.reference.world[self.own.offset], inverse(self.reference.world[parent]))
        return found if np.isfinite(found).all() else self._moves

    def _moves_on(self, rest: Parts) -> Floats:
        """What takes a move along the control's axes into the space of its joint's parent, (1 or f, 4, 4).

        rest: the joint's local parts while its channels are zero; the control stands on it, as below IK.
        """
        turn = rest.rotation if self._axes is None else product(rest.rotation, self._axes)
        seen = self._seen_from_parent
        # Rotations are of axes that are not mirrored: where one of the two is, they point the other way.
        sizes = length(seen[:3, :3])[:, np.newaxis] * handedness(seen)
        return from_frame(to_axes(turn) * sizes, np.zeros(3))

    def _rest_and_moves(self, posed: PoseCache) -> tuple[Parts, Floats]:
        """The joint's local parts while its channels are zero; what takes moves into its parent's space."""
        if self._direct:
            return self.rest, self._moves
        world, parent = self.reference.world, int(self.rig.parents[self.joint])
        carrier = self._carrier
        start = inverse(world[carrier]) if carrier >= 0 else np.eye(4)
        seen = multiply(posed.world(carrier), inverse(posed.world(parent)))
        still = _still(seen)
        start = multiply(world[self.joint], start)
        found = self.reference.carried_parts(self.joint, carrier, multiply(start, still))
        there = posed.mended(found, start, carrier, parent)
        if not np.isfinite(still).all():  # a parent that is flat hides the joint, wherever it is
            still = np.where(np.isfinite(still), still, np.eye(4))
        return there, multiply(self._moves, still)

    def run(self, posed: PoseCache) -> None:
        """Move the joint by the control's channels."""
        rest, moves = self._rest_and_moves(posed)
        posed.set(self.joint, self.moved(rest, posed.part(self.own.control), moves))

    def moved(self, rest: Parts, channels: Parts, moves: Floats | None = None) -> Parts:
        """Local parts of the joint, of those at ``rest`` and the channels of its control.

        moves: what takes moves into the space of its parent; None: where the control stands on the joint.
        """
        turn, size = channels.rotation, channels.scale
        if self._axes is not None:
            turn, size = _scaled_along(turn, size, self._shares)
            turn = product(product(self._axes, turn), conjugate(self._axes))
        move = transform_directions(channels.translation, self._moves_on(rest) if moves is None else moves)
        return Parts(rest.translation + move, product(rest.rotation, turn), rest.scale * size)

    def riding(self, posed: PoseCache) -> Parts:
        """Local parts of the offset where it rides on the joint of the control above, as that is posed."""
        world, carrier = self.reference.world, self._carrier
        start = multiply(world[self.own.offset], inverse(world[carrier]))
        return to_parts(multiply(multiply(start, posed.world(carrier)), inverse(posed.world(self.own.above))))

    def beneath(self, posed: PoseCache) -> Parts:
        """Local parts of the offset, with which the control stands on its joint, as both are posed."""
        channels, rig = posed.part(self.own.control), self.rig
        target = posed.part(self.joint).rotation
        above = int(rig.parents[self.joint])
        target = product(posed.world_rotation(above), target) if above >= 0 else target
        target = target if self._axes is None else product(target, self._axes)
        turn = product(target, conjugate(channels.rotation))
        size = self._grown(posed) / np.where(channels.scale == 0, 1.0, channels.scale)
        axes = to_axes(turn) * size[..., np.newaxis]
        place = posed.world(self.joint)[:, 3, :3] - rotate(turn, channels.translation * size)
        return to_parts(multiply(from_frame(axes, place), inverse(posed.world(self.own.above))))

    def _grown(self, posed: PoseCache) -> Floats:
        """How long the axes of a control on its joint are, (1 or f, 3): as the joint has grown."""
        own, joint = (length(self.reference.world[k, :3, :3]) for k in (self.own.offset, self.joint))
        grown = length(posed.world(self.joint)[:, :3, :3]) / np.where(joint == 0, 1.0, joint)
        if self._axes is not None:  # no axis of the one is that of the other
            grown = (grown[:, :1] + grown[:, 1:2] + grown[:, 2:]) / 3.0
        return own * grown

    def channels(self, posed: PoseCache, target: Parts) -> Parts:
        """The channels that give the joint its local parts ``target``."""
        rest, moves = self._rest_and_moves(posed)
        return self.needed(rest, target, moves)

    def needed(self, rest: Parts, target: Parts, moves: Floats | None = None) -> Parts:
        """The channels that take the joint from ``rest`` to its local parts ``target``; see `moved`."""
        turn = product(conjugate(rest.rotation), target.rotation)
        back = inverse(self._moves_on(rest) if moves is None else moves)
        move = transform_directions(target.translation - rest.translation, back)
        with np.errstate(divide="ignore", invalid="ignore"):
            size = np.where(rest.scale == 0, 1.0, target.scale / rest.scale)
        if self._axes is not None:
            turn, size = _scaled_along(turn, size, self._shares.T)
            turn = product(product(conjugate(self._axes), turn), self._axes)
        # One matrix is inverted otherwise than many: the sign of a zero must not tell.
        return Parts(move + 0.0, turn, size)


def _scaled_along(turn: Floats, scale: Floats, shares: Floats) -> tuple[Floats, Floats]:
    """The rotation and the scale along other axes, (f, 4) and (f, 3), of those along some: by their shares.

    Mirrored axes are exact: two that are reversed are half a turn about the third, in whatever axes.
    """
    if bool((scale[:, :1] == scale[:, 1:]).all()):
        return turn, scale
    reversed_ = scale < 0
    mirrors = reversed_[:, :1] ^ reversed_[:, 1:2] ^ reversed_[:, 2:]
    two = np.where(reversed_ ^ mirrors, -1.0, 1.0)
    sizes = np.abs(scale)
    shared = sum(sizes[:, k, np.newaxis] * shares[k] for k in range(3))
    return product(turn, half_turn(two)), np.where(mirrors, -1.0, 1.0) * shared


def _still(matrices: Floats) -> Floats:
    """One row where all rows are the same to the bit."""
    return matrices[:1] if len(matrices) > 1 and bool((matrices == matrices[0]).all()) else matrices
