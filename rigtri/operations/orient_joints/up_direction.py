"""Up directions: where the up axis of each joint points, by a stated source or a ladder of fallbacks.

Steps: 1 the stated source, 2 the limb's own triple, 3 its hinge in clips or the
other pose, 4 the other side, 5 side, name and facing, 6 an adjoining triple,
7 the parent joint's normal by parallel transport, 8 the joint's own current axis, 9 the
world axis least parallel to the bone. Steps 7 to 9 are invented: nothing in the
file determines them.

Source: "Rigging with Triangles" and "Using Vector Math to Rig an Arm" (hinge of
the limb's own triple); A. J. Hanson, "Parallel transport approach to curve
framing", 1995 (step 7).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from rigtri.errors import UsageError
from rigtri.maths.arrays import Booleans
from rigtri.maths.quaternions import between, rotate
from rigtri.maths.ranking import axis_across
from rigtri.maths.triangle import STRAIGHT_SINE, axis_of
from rigtri.maths.trigonometry import Floats, arc_tangent
from rigtri.maths.vectors import cross, length, normalise
from rigtri.model.rig import Rig
from rigtri.operations.option_kinds import vector
from rigtri.operations.orient_joints.bend_planes import BendPlanes, UpDirections
from rigtri.operations.orient_joints.joints_to_orient import Targets
from rigtri.recognition.hand_hinges import AS_ARMS_SWING, AS_ARMS_SWING_AHEAD, AS_ELBOWS_BEND, AS_PAWS_SWING
from rigtri.report import Report

# The steps whose direction is an axis as it is, and no hinge that left-handed axes reverse.
STATED, PRESENT = 1, 8
# Words for sources of up directions that files and reports keep, as messages have them.
_TEXT = {
    "clips": "the animation clips",
    "other pose": "the other pose of the file",
    "carried from the joint above": "the parent joint (parallel transport)",
    "its present axis": "the joint's current axis",
    AS_ARMS_SWING: "the arm, as if it hung at the side",
    AS_ARMS_SWING_AHEAD: "the arm, as if it had hung at the side and was raised ahead",
    AS_ELBOWS_BEND: "the arm, as its elbow bends",
    AS_PAWS_SWING: "the arm, as if its hand or paw hung at the side",
}


def up_text(source: str) -> str:
    """A source of `UpDirections` as messages call it."""
    return _TEXT.get(source, source if ":" in source else f"the {source}")


class UpLadder:
    """The up directions of joints, found for some after others.

    ups: as the styles ask for them. normals: of the bend planes, before ``pole`` takes the bend direction.
    present: whether step 8 counts.
    """

    def __init__(self, targets: Targets, planes: BendPlanes, *, present: bool, report: Report) -> None:
        self._targets, self._planes, self._present, self._report = targets, planes, present, report
        self.ups = UpDirections.none(len(targets.tree.rig))
        self.normals = UpDirections.none(len(targets.tree.rig))

    def find(self, joints: Sequence[int], related: Mapping[int, Floats]) -> None:
        """Find the up directions of ``joints``, parents first.

        related: the direction, (3,), of those whose up axis is that of another joint.
        """
        targets = self._targets
        held = [joint for joint in joints if targets.styles[joint].held]
        if held:
            self._hold(held)
            joints = [joint for joint in joints if not targets.styles[joint].held]
        sources = {joint: related.get(joint, _stated(targets, joint)) for joint in joints}
        stated = {joint: source for joint, source in sources.items() if source is not None}
        open_ = set(joints)
        if stated:
            vectors = np.stack(list(stated.values()))
            clear = crossing(vectors, targets.bone[list(stated)])
            for joint, vector in zip(np.array(list(stated))[clear].tolist(), vectors[clear], strict=True):
                self.ups.set([joint], vector, STATED, targets.styles[joint].up_from)
                open_.discard(joint)
        left = [joint for joint in joints if joint in open_]
        self._find_normals(left)
        self.ups.copy_from(self.normals, left)
        for joint in left:
            up_from = targets.styles[joint].up_from
            if up_from == "pole":
                self._take_pole(joint)
                continue
            if targets.mirrored[joint] and self.normals.step[joint] != PRESENT:
                # A positive rotation about an axis of a left-handed frame turns the other way.
                self.ups.vector[joint] = -self.ups.vector[joint]
            if joint in stated:
                name, source = targets.tree.rig.title(joint), up_text(self.normals.source[joint])
                self._report.warn(
                    "up-parallel",
                    f"'{name}': {up_from} runs along the bone; up axis: from {source}.",
                    joint=name,
                    geometry=True,
                )

    def _hold(self, joints: Sequence[int]) -> None:
        """A stated direction where a chain begins, held along it; a known hinge, reversed, goes before it."""
        targets = self._targets
        hinges = self._planes.normals
        for joint in joints:
            bone, above = targets.bone[joint], targets.tree.above[joint]
            if hinges.step[joint] and crossing(hinges.vector[joint], bone):
                self.normals.copy_from(hinges, [joint])
                self.ups.copy_from(hinges, [joint])
                self.ups.vector[joint] = hinges.vector[joint] * (1.0 if targets.mirrored[joint] else -1.0)
                continue
            goes_on = above in targets.aims and targets.aims[above].node == joint and self.ups.step[above]
            up: Floats | None
            if goes_on:
                up = transport_up(self.ups.vector[above], targets.bone[above], bone)
                step, source = int(self.ups.step[above]), self.ups.source[above]
                sine = float(self.ups.sine[above])
            else:
                up, step, source, sine = _stated(targets, joint), STATED, targets.styles[joint].up_from, 1.0
            if up is not None and crossing(up, bone):
                self.ups.set([joint], up, step, source, sine)
            else:
                self._find_normals([joint])
                self.ups.copy_from(self.normals, [joint])

    def _find_normals(self, joints: list[int]) -> None:
        """The plane normals of joints, by the first step of the ladder that is clear of the bone."""
        for found in (self._planes.normals, self._planes.adjoining):
            some = [joint for joint in joints if found.step[joint]]
            clear = crossing(found.vector[some], self._targets.bone[some])
            taken = np.array(some, dtype=np.int64)[clear].tolist()
            self.normals.copy_from(found, taken)
            left = set(joints).difference(taken)
            joints = [joint for joint in joints if joint in left]
        for joint in joints:
            self._invent(joint)

    def _invent(self, joint: int) -> None:
        """Steps 7 to 9: what nothing in the file determines."""
        bone = self._targets.bone[joint]
        above = self._targets.tree.above[joint]
        if above >= 0 and self.normals.step[above]:
            known = self._planes.normals if self._planes.normals.step[above] else self.normals
            normal = transport_up(known.vector[above], self._targets.bone[above], bone)
            if crossing(normal, bone):
                self.normals.set([joint], normal, 7, "carried from the joint above", known.sine[above])
                return
        own = _present_axis(self._targets, joint)
        if self._present and crossing(own, bone):
            # For ``pole`` it is an up direction already, not a normal.
            pole = self._targets.styles[joint].up_from == "pole"
            self.normals.set([joint], cross(own, bone) if pole else own, PRESENT, "its present axis")
            return
        self.normals.set([joint], axis_across(bone), 9, "world axis least parallel to the bone")

    def _take_pole(self, joint: int) -> None:
        """``pole``: up is the side that the limb bends to, in its plane."""
        present = self.normals.step[joint] == PRESENT
        bone, normal = self._targets.bone[joint], self.normals.vector[joint]
        self.ups.vector[joint] = _present_axis(self._targets, joint) if present else cross(bone, normal)


def transport_up(up: Floats, bone: Floats, along: Floats) -> Floats:
    """Parallel transport: an up direction, (3,), of one bone taken to the next without twisting."""
    return rotate(between(bone, along), up)


def _present_axis(targets: Targets, joint: int) -> Floats:
    """The direction in the world of the axis that is to be the up axis of a joint, (3,), as it is."""
    letter, sign = axis_of(targets.styles[joint].up)
    return normalise(targets.ref.world[joint, letter, :3]) * sign


def _stated(targets: Targets, joint: int) -> Floats | None:
    """The up direction of a joint by ``world:``, ``vector:``, ``node:``, ``noderot:`` and ``keep``.

    In the world, (3,), of any length. None for ``plane``, ``pole``, ``parent`` and ``child``.
    Raises UsageError for anything else.
    """
    ref = targets.ref
    source = UpSource.read(targets.tree.rig, targets.styles[joint].up_from)
    letter, sign = axis_of(targets.styles[joint].up) if source.kind == "keep" else source.axis
    match source.kind:
        case "world":
            return np.asarray(np.eye(3)[letter] * sign)
        case "vector":
            return np.array(source.vector)
        case "node":
            return ref.position(source.node) - ref.position(joint)
        case "noderot":
            return np.asarray(normalise(ref.world[source.node, letter, :3]) * sign)
        case "keep":
            return np.asarray(ref.world[joint, letter, :3] * sign)
    return None


class UpSource(NamedTuple):
    """Where an up direction comes from, read. kind: its first word.

    axis: its index and sign, of ``world:`` and ``noderot:``. node: of ``node:`` and ``noderot:``.
    """

    kind: str
    axis: tuple[int, float] = (0, 1.0)
    vector: tuple[float, float, float] = (0.0, 0.0, 0.0)
    node: int = -1

    @classmethod
    def read(cls, rig: Rig, text: str) -> UpSource:
        """A value of ``--up-from``. Raises UsageError for none, NameNotFoundError for an unknown node."""
        kind, _, rest = text.partition(":")
        try:
            if kind == "world" and rest:
                return cls(kind, axis_of(rest))
            if kind == "vector":
                return cls(kind, vector=vector(rest))
            if kind == "node" and rest:
                return cls(kind, node=rig.find(rest, "node"))
            if kind == "noderot":
                axis, _, name = rest.partition(":")
                return cls(kind, axis_of(axis), node=rig.find(name, "node"))
        except ValueError as error:
            raise UsageError(f"--up-from {text}: {error}") from error
        if text in ("plane", "pole", "parent", "child", "keep"):
            return cls(text)
        raise UsageError(
            f"--up-from {text} is none of plane, pole, world:AXIS, vector:X,Y,Z, node:NAME, "
            "noderot:AXIS:NAME, parent, child, keep"
        )


def crossing(up: Floats, aim: Floats) -> Booleans:
    """Which up directions are clear of their bones, (..., 3) each: at least `STRAIGHT_SINE` off them."""
    with np.errstate(invalid="ignore", over="ignore"):
        return np.asarray(length(cross(normalise(up), normalise(aim))) >= STRAIGHT_SINE)


def degrees(sine: float) -> float:
    """A bend from its sine, in degrees, for messages about nearly straight limbs."""
    return float(arc_tangent(sine, np.sqrt(max(0.0, 1.0 - sine * sine)))) * 57.29577951308232
