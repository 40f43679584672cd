"""Which way the up axis of each joint points: the stated source, else a ladder of fallbacks.

Steps: 1 the stated source, 2 the limb's own triple, 3 its hinge in clips or the
other pose, 4 the other side, 5 side, name and facing, 6 an adjoining triple,
7 the neighbour's normal carried along, 8 the joint's own present axis, 9 the
world axis least parallel to the bone. Steps 7 to 9 are invented: nothing in the
file says so.

Source: "Rigging with Triangles" and "Using Vector Math to Rig an Arm" (hinge of
the limb's own triple); A. J. Hanson, "Parallel transport approach to curve
framing", 1995 (step 7).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import sqrt

import numpy as np

from rigtri.errors import UsageError
from rigtri.frames.skeleton import ZERO_LENGTH, ReferencePose, Skeleton
from rigtri.maths.quaternions import between, rotate
from rigtri.maths.scalar_vector import Vector
from rigtri.maths.triangle import STRAIGHT_SINE, axis_of
from rigtri.maths.trigonometry import Floats, arc_tangent
from rigtri.maths.vectors import normalise, unit_of
from rigtri.model.joint_names import twin
from rigtri.operations.aim_targets import Aim, chain_child, limb_path
from rigtri.operations.declaration.kinds import vector
from rigtri.recognition.bend_plane import Bend, area_and_sine, bend, direction_of, in_pose
from rigtri.recognition.limbs import Limb
from rigtri.report import Report

_STEP = {"pose": 2, "given": 2, "clips": 3, "other pose": 3, "other side": 4, "facing": 5}


@dataclass(frozen=True, eq=False)
class Up:
    """A direction in the world, (3,), the ladder's step and the words for it; ``sine`` bounds noise."""

    vector: Floats
    step: int
    source: str
    sine: float = 1.0


@dataclass(eq=False)
class Hinges:
    """The plane normal of every joint that has one, found chain by chain, parents first."""

    tree: Skeleton
    ref: ReferencePose
    aims: Mapping[int, Aim]
    limbs: Sequence[Limb]
    facing: Floats | None
    per_joint: bool
    report: Report
    found: dict[int, Up] = field(default_factory=dict)
    straight: dict[int, tuple[str, float]] = field(default_factory=dict)

    def collect(self) -> None:
        """Fill `found` from limbs, then from chains without a limb."""
        taken: set[int] = set()
        for limb, posed in zip(self.limbs, in_pose(self.limbs, self.ref.world), strict=True):
            members = self._members(limb)
            taken.update(members)
            self._of_limb(limb, members, posed)
        chains = self._chains(taken)
        for chain in chains:
            self._of_chain(chain)
        known: dict[str, list[int]] = {}
        for joint, up in self.found.items():
            if up.step <= 3:
                known.setdefault(self.tree.rig.names[joint], []).append(joint)
        for chain in chains:
            self._from_twin(chain, known)

    def _members(self, limb: Limb) -> list[int]:
        """The limb, the clavicle above it, and for a leg the foot and toes below it."""
        members = limb_path(self.tree, limb)
        above = self.tree.above.get(limb.start, -1)
        aim = self.aims.get(above)
        if aim is not None and aim.node == limb.start:
            members.insert(0, above)
        node = limb.end
        while limb.kind == "leg" and (aim := self.aims.get(node)) is not None:
            if aim.node is None or aim.node not in self.aims:
                break
            node = aim.node
            if node in members:
                break
            members.append(node)
        return [joint for joint in members if joint in self.aims]

    def _of_limb(self, limb: Limb, members: list[int], posed: Bend) -> None:
        rig, found = self.tree.rig, posed if posed.sine >= STRAIGHT_SINE else self._of_straight(limb)
        name = f"{rig.title(limb.start)} - {rig.title(limb.middle)} - {rig.title(limb.end)}"
        for joint in members:
            if found is not None:
                self.found[joint] = _up(found)
            if posed.sine < STRAIGHT_SINE:
                self.straight[joint] = (name, posed.sine)

    def _of_straight(self, limb: Limb) -> Bend | None:
        return bend(
            self.tree.rig,
            limb,
            self.ref.world,
            least_sine=STRAIGHT_SINE,
            others=self.limbs,
            facing=self.facing,
            other_pose=self.ref.other,
        )

    def _chains(self, taken: set[int]) -> list[list[int]]:
        chains, done = [], set(taken)
        for joint in self.aims:
            if joint in done:
                continue
            chain = {joint: None}
            last = joint
            while (node := self.aims[last].node) is not None and node in self.aims:
                if node in done or node in chain:
                    break
                chain[node], last = None, node
            done.update(chain)
            chains.append(list(chain))
        return chains

    def _points(self, chain: Sequence[int]) -> list[int]:
        """A chain's joints, the kept joint that leads into it, and what its last one aims at."""
        above, last = self.tree.above[chain[0]], self.aims[chain[-1]].node
        leads = above >= 0 and above not in self.aims
        leads = leads and chain_child(self.tree, self.ref, above) == chain[0]
        ends = last is not None and last not in chain
        return [*([above] if leads else []), *chain, *([int(last)] if ends and last is not None else [])]

    def _of_chain(self, chain: list[int]) -> None:
        nodes = self._points(chain)
        if len(nodes) < 3:
            return
        points = [self._place(node) for node in nodes]
        bends = [area_and_sine(*triple) for triple in zip(points, points[1:], points[2:], strict=False)]
        areas, sines = [area for area, _ in bends], [sine for _, sine in bends]
        if max(sines) < STRAIGHT_SINE:
            found = self._moving(nodes)
            name = f"{self.tree.rig.title(nodes[0])} … {self.tree.rig.title(nodes[-1])}"
            for joint in chain:
                self.straight[joint] = (name, max(sines))
                if found is not None:
                    self.found[joint] = found
            return
        if self.per_joint:
            self._per_joint(nodes, areas, sines)
            return
        normal = _area_weighted(areas)
        for joint in chain:
            self.found[joint] = Up(normal, 2, "plane of the chain", max(sines))

    def _place(self, node: int) -> Vector:
        return Vector(*self.ref.places[node])

    def _per_joint(self, nodes: list[int], areas: Sequence[Vector], sines: Sequence[float]) -> None:
        """Each inner joint its own plane; the first and last take their neighbour's."""
        for place, joint in enumerate(nodes):
            k = min(max(place - 1, 0), len(areas) - 1)
            if joint in self.aims and sines[k] >= STRAIGHT_SINE:
                self.found[joint] = Up(direction_of(areas[k]), 2, "plane of the joint", sines[k])

    def _moving(self, nodes: list[int]) -> Up | None:
        """The hinge of a straight chain as its clips show it, at the first joint that they bend."""
        apart = [nodes[0]]
        for node in nodes[1:]:
            if (self._place(node) - self._place(apart[-1])).length > ZERO_LENGTH * self.ref.extent:
                apart.append(node)
        for triple in zip(apart, apart[1:], apart[2:], strict=False):
            limb = Limb(*triple)
            # No sine reaches 2: the pose itself has no say here.
            found = bend(self.tree.rig, limb, self.ref.world, least_sine=2.0, other_pose=self.ref.other)
            if found is not None:
                return _up(found)
        return None

    def _from_twin(self, chain: list[int], known: Mapping[str, list[int]]) -> None:
        """The other side's hinge for joints without one. known: joints that have their own, by name."""
        rig = self.tree.rig
        for joint in chain:
            other = rig.names[joint] and twin(rig.names[joint])
            if joint in self.found or not other or other == rig.names[joint]:
                continue
            for there in known.get(other, [])[:1]:
                apart = np.abs(self.ref.position(joint) - self.ref.position(there))
                mirror = np.where(np.arange(3) == int(np.argmax(apart)), 1.0, -1.0)
                # A normal is mirrored as a turn is: across the plane and backwards.
                normal = self.found[there].vector * mirror
                self.found[joint] = Up(normal, 4, "other side", self.found[there].sine)

    def normal(
        self,
        joint: int,
        aim: Floats,
        up_axis: str,
        above: Callable[[], Up | None],
        *,
        present: bool = True,
    ) -> Up:
        """The plane normal of a joint, for a bone along ``aim`` (3,), by the first step that holds.

        above: asked for what the joint above got, carried along, for step 7. present: whether
        step 8 counts.
        """
        asked: list[Callable[[], Up | None]] = [
            lambda: self.found.get(joint),
            lambda: self._adjoining(joint),
            above,
        ]
        for step in asked:
            candidate = step()
            if candidate is not None and crossing(candidate.vector, aim):
                return candidate
        letter, sign = axis_of(up_axis)
        own = normalise(self.ref.world[joint, letter, :3]) * sign
        if present and crossing(own, aim):
            return Up(own, 8, "its present axis")
        # The first axis of those that are about the least parallel: rounding is not to choose.
        off = np.abs(normalise(aim))
        least = np.eye(3)[int(np.argmax(off <= off.min() + 0.1))]
        return Up(least, 9, "world axis least parallel to the bone")

    def _adjoining(self, joint: int) -> Up | None:
        """The plane of parent, joint and aim; of the joint, what it aims at, and what that aims at."""
        aim = self.aims.get(joint)
        if aim is None or aim.node is None:
            return None
        after = self.aims[aim.node].node if aim.node in self.aims else None
        for triple in ((self.tree.above[joint], joint, aim.node), (joint, aim.node, after)):
            if None in triple or -1 in triple:
                continue
            area, sine = area_and_sine(*(self._place(k) for k in triple if k is not None))
            if sine >= STRAIGHT_SINE:
                return Up(direction_of(area), 6, "adjoining plane", sine)
        return None


def carried(up: Up, bone: Floats, along: Floats) -> Up:
    """Step 7: a normal carried from one bone to the next without twisting."""
    return Up(rotate(between(bone, along), up.vector), 7, "carried from the joint above", up.sine)


def stated(tree: Skeleton, ref: ReferencePose, joint: int, source: str, up_axis: str) -> Floats | None:
    """The up direction of ``world:``, ``vector:``, ``node:``, ``noderot:`` and ``keep``: no planes.

    In the world, (3,), of any length. None for ``plane``, ``pole``, ``parent`` and ``child``.
    Raises UsageError for anything else.
    """
    kind, _, rest = source.partition(":")
    rig = tree.rig
    try:
        if kind == "world" and rest:
            letter, sign = axis_of(rest)
            return np.asarray(np.eye(3)[letter] * sign)
        if kind == "vector":
            return np.array(vector(rest))
        if kind == "node" and rest:
            return ref.position(rig.find(rest, "node")) - ref.position(joint)
        if kind == "noderot":
            letter, sign = axis_of(rest.partition(":")[0])
            node = rig.find(rest.partition(":")[2], "node")
            return np.asarray(normalise(ref.world[node, letter, :3]) * sign)
    except ValueError as error:
        raise UsageError(f"--up-from {source}: {error}") from error
    if source == "keep":
        letter, sign = axis_of(up_axis)
        return np.asarray(ref.world[joint, letter, :3] * sign)
    if source in ("plane", "pole", "parent", "child"):
        return None
    raise UsageError(
        f"--up-from {source} is none of plane, pole, world:AXIS, vector:X,Y,Z, node:NAME, "
        "noderot:AXIS:NAME, parent, child, keep"
    )


def crossing(up: Floats, aim: Floats) -> bool:
    """Whether an up direction is clear of the bone: at least `STRAIGHT_SINE` off it."""
    a, b = unit_of(up.tolist()), unit_of(aim.tolist())
    if a is None or b is None:
        return False
    x, y, z = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
    return sqrt(x * x + y * y + z * z) >= STRAIGHT_SINE


def _up(found: Bend) -> Up:
    names = {"pose": "plane of the limb", "facing": "side, name and facing"}
    return Up(found.hinge, _STEP[found.source], names.get(found.source, found.source), found.sine)


def _area_weighted(areas: Sequence[Vector]) -> Floats:
    """The common normal of a chain, unit, (3,): areas summed, each on the side of the largest.

    Of areas that differ by less than a tenth the first counts as the largest, so that
    rounding does not choose between them.
    """
    sizes = [area.length for area in areas]
    least = 0.9 * max(sizes)
    largest = next((area for area, size in zip(areas, sizes, strict=True) if size >= least), areas[0])
    total, *others = (-area if area.dot(largest) < 0 else area for area in areas)
    for area in others:
        total = total + area
    return direction_of(total)


def degrees(sine: float) -> float:
    """A bend from its sine, in degrees, for messages about nearly straight limbs."""
    return float(arc_tangent(sine, np.sqrt(max(0.0, 1.0 - sine * sine)))) * 57.29577951308232
