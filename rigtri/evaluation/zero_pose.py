"""The pose of a rig while all its controls are zero, which controls move joints from.

A joint with a control is where the control's offset is, and has the scale that is stored with that, so
that a pose which has once been baked into the joints is not added to itself. Where the two differ by no
more than rounding, the joint's own numbers are the truth.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.constraint_solver import Parts, to_parts
from rigtri.evaluation.rig_space import shearing_node
from rigtri.evaluation.sampling import worlds
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import (
    SKEW,
    compose,
    decompose,
    determinant,
    from_frame,
    inverse,
    multiply,
    nearest_rotation,
    skew,
    unsheared_axes,
)
from rigtri.maths.quaternions import conjugate, from_axes, to_axes
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats, cube_root
from rigtri.maths.vectors import length, triple
from rigtri.model.constraints import constraints_of
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import (
    PIVOTS,
    ControlRecord,
    OffsetRecord,
    PoleVectorRecord,
    Quaternion,
    Triple,
)
from rigtri.model.rig import Rig

# Offsets are float32 and some nodes deep; a pose that anybody has set is farther off than this.
SAME_POSITION = 2e-6
_WORLD = np.eye(4)
# What is wrong with a control that is `adrift`.
COUNTS_FROM_NOTHING = (
    "nothing is above it that it counts from: parent it to its offset again; in USD without !resetXformStack!"
)


@dataclass(frozen=True, eq=False)
class FkControl:
    """A control over one joint. above: the control that its offset is a child of, −1 for none.

    axes: how the joint is turned seen from the offset, where it is not turned as that.
    """

    control: int
    offset: int
    joint: int
    above: int
    axes: Quaternion | None = None


@dataclass(frozen=True, eq=False)
class IkLimb:
    """A limb with an IK end. chain: root, mid and end joint. pole: −1 where there is none.

    detached: the end joint is no descendant of the mid joint, as the foot of a flat rig; it stands where
    its control does, and the lower bone aims at it. pivots: of the foot, below the control, which carry the
    end joint; the last but one carries the toe, −1 for none. pivot_path: all nodes from the last one up to
    the control, without that.
    """

    chain: tuple[int, int, int]
    control: int
    pole: int
    soft: float = 0.0
    stretch: bool = False
    detached: bool = False
    pivots: tuple[int, ...] = ()
    pivot_path: tuple[int, ...] = ()
    toe: int = -1

    @property
    def holder(self) -> int:
        """What the end joint follows: the control, or the last pivot of the foot."""
        return self.pivots[-1] if self.pivots else self.control


def adrift(rig: Rig) -> list[int]:
    """Controls of joints and of roots that count from nothing, for no node is above them any more.

    Somebody has parented them to the scene, or reset their stack of ops in USD.
    """
    return [
        node
        for node, record in sorted(rig.records(ControlRecord).items())
        if rig.parents[node] < 0
        and record.kind not in ("ik", *PIVOTS)
        and rig.known(record.joint) is not None
    ]


class ControlsAtZero:
    """The controls of a rig, and its pose while they are zero. rig: its joints have their scales then."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig = _with_scales_at_zero(rig)
        self.fk: dict[int, FkControl] = {}  # by joint
        self.limbs: list[IkLimb] = []
        self.roots: list[FkControl] = []
        offsets = rig.records(OffsetRecord)
        poles = {_chain(rig, record.chain): node for node, record in rig.records(PoleVectorRecord).items()}
        controls = sorted(rig.records(ControlRecord).items())
        by_limb: dict[tuple[int, int, int] | None, dict[str, tuple[int, ControlRecord]]] = {}
        for node, record in controls:
            if record.chain:
                by_limb.setdefault(_chain(rig, record.chain), {})[record.kind] = node, record
        for node, record in controls:
            joint = rig.known(record.joint)
            if joint is None:
                continue
            offset = int(rig.parents[node])
            if record.kind == "ik":
                chain = _chain(rig, record.chain)
                if chain is not None and not ik_obstacle(rig, chain):
                    pole, soft, stretch = poles.get(chain, -1), record.soft or 0.0, bool(record.stretch)
                    detached = not rig.is_below(chain[2], chain[1])
                    limb = IkLimb(chain, node, pole, soft, stretch, detached)
                    self.limbs.append(_with_foot(rig, limb, by_limb[chain]))
            elif offset >= 0 and record.kind not in PIVOTS:
                axes = offsets[offset].axes if offset in offsets else None
                own = FkControl(node, offset, joint, int(rig.parents[offset]), axes)
                if record.kind == "fk":
                    self.fk[joint] = own
                else:
                    self.roots.append(own)

    def growth(self, limb: IkLimb, world: Callable[[int], Floats]) -> Floats:
        """How many times as large as now what pivots of a foot are on is in a pose, (1 or f, 1).

        world: of a node in that pose, (1 or f, 4, 4). What somebody has scaled the control or its pivots by
        does not count, and a limb without pivots has nothing that grows.
        """
        above = int(self.rig.parents[limb.control])
        if not limb.pivots or above < 0:
            return np.ones((1, 1))
        grown = cube_root(np.abs(determinant(world(above)) / determinant(self.world[above])))
        return np.where(grown > 0, grown, 1.0)[:, np.newaxis]

    @cached_property
    def control_of(self) -> Mapping[int, int]:
        """The joint that each FK control moves, by the control."""
        return {own.control: joint for joint, own in self.fk.items()}

    @cached_property
    def carried(self) -> list[FkControl]:
        """The joints that a root control carries, each with that control: its own, and all whose FK controls
        are right below it, as those of other arms or characters. What is below one of them follows that."""
        rig, found = self.rig, list[FkControl]()
        for root in self.roots:
            tops = [own.joint for own in self.fk.values() if own.above == root.control]
            others = (joint for joint in tops if not rig.is_below(joint, root.joint))
            found += [root, *(replace(root, joint=joint) for joint in others)]
        return found

    @cached_property
    def world(self) -> Floats:
        """The world matrices of all nodes while controls are zero, (n, 4, 4)."""
        rig = self.rig
        world = np.empty((len(rig), 4, 4))
        controls = set(rig.nodes_of("control"))
        moved = self._posed(controls)
        for node in range(len(rig)):
            above = int(rig.parents[node])
            parent = world[above] if above >= 0 else _WORLD
            if node in controls and not rig.is_joint[node]:
                world[node] = parent
            elif node in moved:
                world[node] = moved[node]
            else:
                world[node] = multiply(rig.normalised_local[node], parent)
                # It rests where its offset is, and what is above it does not.
                if node in self.fk and self._apart(world[node], rig.normalised_world[node]):
                    world[node] = rig.normalised_world[node]
        return world

    def _apart(self, a: Floats, b: Floats) -> bool:
        """Whether two matrices, (4, 4), differ by more than rounding."""
        axes = np.abs(a - b)[:3, :3].max() / np.abs(b[:3, :3]).max(initial=1e-30)
        apart = float(length(a[3, :3] - b[3, :3])) > SAME_POSITION * self._size
        return apart or bool(axes > 4.0 * SAME_POSITION)

    @cached_property
    def _size(self) -> float:
        return float(np.abs(self.rig.normalised_world[:, 3, :3]).max(initial=0.0)) or 1.0

    def _posed(self, controls: set[int]) -> dict[int, Floats]:
        """Where joints stand by their offsets that do not stand there by themselves."""
        rig, found = self.rig, dict[int, Floats]()
        if not self.fk:
            return found
        still = rig.normalised_local.copy()
        still[list(controls)] = _WORLD
        at_zero = worlds(rig, still)
        for joint, own in self.fk.items():
            there = at_zero[own.offset]
            here = rig.normalised_world[joint]
            axes = nearest_rotation(here)
            turned = unsheared_axes(there)
            if own.axes is not None:
                turned = to_axes(product(from_axes(turned), np.array(own.axes)))
            apart = float(length(there[3, :3] - here[3, :3])) > SAME_POSITION * self._size
            if apart or np.abs(turned - axes).max() > 4.0 * SAME_POSITION:
                stretch = multiply(here, inverse(from_frame(axes, here[3, :3])))
                found[joint] = multiply(stretch, from_frame(turned, there[3, :3]))
        return found

    @cached_property
    def local(self) -> Floats:
        """The local matrices while controls are zero, (n, 4, 4)."""
        rig = self.rig
        parents = np.where((rig.parents >= 0)[:, np.newaxis, np.newaxis], self.world[rig.parents], _WORLD)
        local = multiply(self.world, inverse(parents))
        kept = np.abs(local - rig.normalised_local).max(axis=(1, 2)) <= 1e-9 * np.maximum(
            1.0, np.abs(rig.normalised_local).max(axis=(1, 2))
        )
        return np.where(kept[:, np.newaxis, np.newaxis], rig.normalised_local, local)

    def carried_parts(self, joint: int, carrier: int, local: Floats) -> Parts:
        """The parts of what a joint's carrier makes of its local matrix, (1 or f, 4, 4).

        Where a scale that is not uniform parts the two, the joint is sheared as it turns, which no scale
        along its axes can follow: then it keeps its own, and grows as much as its volume does.
        """
        parts, parent = to_parts(local), int(self.rig.parents[joint])
        above, own = (self.world[k] if k >= 0 else _WORLD for k in (carrier, parent))
        between = multiply(above, inverse(own))
        sizes = length(between[:3, :3])
        if not (sizes.max() - sizes.min() > SKEW * sizes.max() or skew(between) > SKEW):
            return parts  # as of flat ones, too
        zero = multiply(self.world[joint], inverse(own))
        grown = cube_root(determinant(local) / determinant(zero))
        return parts._replace(scale=to_parts(zero).scale * grown[:, np.newaxis])

    def world_rotation(self, node: int) -> Floats:
        """How a node is turned in the world while controls are zero, (4,), without scale; −1: not at all."""
        return from_axes(unsheared_axes(self.world[node] if node >= 0 else _WORLD))

    def turn_below(self, turn: Floats, node: int, below: int) -> Floats:
        """How what is below a node is turned, (f, 4), while the node is turned so and controls are zero."""
        if below == node:
            return turn
        return product(turn, product(conjugate(self.world_rotation(node)), self.world_rotation(below)))


def _with_scales_at_zero(rig: Rig) -> Rig:
    """The rig, whose joints have the scales that are stored with their offsets."""
    stored = _scales_at_zero(rig)
    if not stored:
        return rig
    scale, matrix = rig.scale.copy(), rig.matrix.copy()
    for joint, own in stored.items():
        if rig.has_matrix[joint]:
            translation, rotation, _ = decompose(matrix[joint])
            matrix[joint] = compose(translation, rotation, own)
        scale[joint] = own
    return replace(rig, scale=scale, matrix=matrix)


def _scales_at_zero(rig: Rig) -> dict[int, Triple]:
    """The scales that joints have while their controls are zero and do not have at rest, by joint."""
    found = ((rig.known(record.joint), record) for record in rig.records(OffsetRecord).values())
    return {joint: record.scale for joint, record in found if joint is not None and record.scale is not None}


def with_stored_scales(rig: Rig, before: Rig) -> Rig:
    """The rig, whose rest pose is another than that of ``before``, with scale counted from the old one."""
    metadata, stored = dict(rig.metadata), _scales_at_zero(before)
    for node, record in rig.records(OffsetRecord).items():
        joint = rig.known(record.joint)
        if record.kind != "fk" or joint is None:
            continue
        was, now = (decompose(each.normalised_local[joint])[2] for each in (before, rig))
        zero = np.asarray(stored.get(joint, was))
        apart = bool((now != was).any() and np.abs(now - zero).max() > SAME_POSITION * np.abs(zero).max())
        if (now != was).any():
            metadata[node] = replace(record, scale=triple(zero) if apart else None).to_dict()
    return rig if metadata == rig.metadata else replace(rig, metadata=metadata)


def refuse_lost_zero(rig: Rig, before: Rig) -> None:
    """GeometryError where joints would stand elsewhere than ``before`` while their controls are zero.

    Offsets hold no shear: how one sheared joint rests says nothing of how it would in another pose.
    """
    was, now = ControlsAtZero(before), ControlsAtZero(rig)
    joints = [k for k in was.fk if k in now.fk and max(skew([before.world[k], rig.world[k]])) > SKEW]
    sizes = length(before.world[joints, :3, :3]).max(axis=1)
    apart = np.abs(was.world[joints] - now.world[joints])[:, :3, :3].max(axis=(1, 2))
    if lost := np.flatnonzero(apart > SKEW * sizes).tolist():
        node = joints[lost[0]]
        above = shearing_node(rig, node)
        raise GeometryError(
            f"The scale of '{rig.title(above)}' is not uniform and shears {len(lost)} joints, such as "
            f"'{rig.title(node)}', which would stand elsewhere by their controls with another rest pose. "
            "Apply that scale in the DCC, or bake --to joints and strip before"
        )


def moved_controls(rig: Rig) -> frozenset[int]:
    """The controls and pole vectors that somebody has moved at rest, or that have keys."""
    keyed = frozenset[int]().union(*(clip.nodes for clip in rig.clips))
    controls = rig.nodes_of(ControlRecord.type)
    moved = {k for k in controls if not rig.is_joint[k] and not np.array_equal(rig.local[k], _WORLD)}
    return frozenset(moved | keyed.intersection((*controls, *rig.nodes_of(PoleVectorRecord.type))))


def constrained_controls(rig: Rig) -> frozenset[int]:
    """The controls whose axes constraints count from: drivers, children, those whose offset is one."""
    rules = constraints_of(rig).values()
    tied = {node for rule in rules for node in (rule.child, *rule.drivers, rule.up_object)}
    controls = rig.nodes_of(ControlRecord.type)
    return frozenset(node for node in controls if not tied.isdisjoint({node, int(rig.parents[node])}))


def world_at_zero(rig: Rig, node: int, controls: set[int]) -> Floats:
    """The world matrix, (4, 4), that a node (−1: none) has while all controls are zero."""
    world = _WORLD
    while node >= 0:
        if node not in controls:
            world = multiply(world, rig.normalised_local[node])
        node = int(rig.parents[node])
    return world


def ik_obstacle(rig: Rig, chain: tuple[int, int, int]) -> str:
    """Why IK cannot move a limb, in words that name its joints; "" where it can.

    The mid joint has to be a descendant of the root. The end may be a child of any joint that the limb does
    not move itself: it is put where its control is.
    """
    a, b, c = chain
    start, mid, end = map(rig.title, chain)
    if len({a, b, c}) < 3:
        return f"'{start}', '{mid}' and '{end}' are not three joints"
    if not rig.is_below(b, a):
        return f"'{mid}' is not a descendant of '{start}', so it does not follow it"
    holder = rig.rules.group_parent
    if holder >= 0 and rig.is_below(holder, a):
        return f"'{start}' holds the controls, so it cannot follow one"
    if rig.is_below(a, c):
        return f"'{start}' is a descendant of '{end}', so the limb would move its own root"
    if rig.is_below(c, a) and not rig.is_below(c, b):
        return f"'{end}' is a descendant of '{start}', but not of '{mid}', so it does not follow the bend"
    return ""


def idle_ik(rig: Rig, chain: tuple[int, int, int], carries: Booleans) -> str:
    """Why an IK end of a limb would move nothing; "" where it would. carries: as `Skeleton` has it."""
    if carries[chain[0]]:
        return ik_obstacle(rig, chain)
    return f"no mesh follows '{rig.title(chain[0])}'"


def _with_foot(rig: Rig, limb: IkLimb, found: Mapping[str, tuple[int, ControlRecord]]) -> IkLimb:
    """A limb with the pivots of its foot, where all of them are there, each below the one before.

    found: its controls by their kind, the last of each.
    """
    if not found.keys() >= {*PIVOTS}:
        return limb
    pivots = tuple(found[kind][0] for kind in PIVOTS)
    line = (limb.control, *pivots)
    if not all(rig.is_below(node, above) for above, node in pairwise(line)):
        return limb
    toe = rig.known(found["ball"][1].joint)
    follows = toe is not None and toe != limb.chain[2] and rig.is_below(toe, limb.chain[2])
    path = rig.path_to_root(pivots[-1])
    pivot_path = tuple(path[: path.index(limb.control)])
    return replace(limb, pivots=pivots, pivot_path=pivot_path, toe=toe if toe is not None and follows else -1)


def _chain(rig: Rig, names: Sequence[str]) -> tuple[int, int, int] | None:
    """Root, mid and end of a limb; None where one is not there."""
    joints = [joint for joint in map(rig.known, names) if joint is not None]
    return (joints[0], joints[1], joints[2]) if len(joints) == len(names) == 3 else None
