"""What there is to see of a rig in a pose: its bones, axes, limbs, controls and constraints as marks.

Source: R. Katz, "Rigging with Triangles", GDC 2018: a matrix is a red, a green and a blue arrow, a
limb a triangle (slides "Transformation Matrix" and "Pole Vector").
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Literal

import numpy as np

from rigtri.evaluation import sampling
from rigtri.evaluation.pose_cache import PoseCache
from rigtri.export.drawing.bones import Bones
from rigtri.export.drawing.primitives import Mark
from rigtri.frames.skeleton import Skeleton, skeleton
from rigtri.maths.matrices import transform_points
from rigtri.maths.triangle import bend_angle, bend_direction, pole_position
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length, normalise, project
from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import without_prefix
from rigtri.model.metadata import ConstraintRecord, PoleVectorRecord
from rigtri.model.rig import Rig
from rigtri.operations.joint_selection import chosen
from rigtri.operations.option_kinds import Selection
from rigtri.operations.prune_joints import sockets
from rigtri.recognition.body_hinges import bodies
from rigtri.recognition.limb_bends import LimbBends
from rigtri.recognition.limbs import recognise
from rigtri.recognition.pose_samples import bind_pose
from rigtri.recognition.recognise import recognise as characters_of
from rigtri.report import Report

_DEGREES = 180.0 / np.pi
# A joint's dot and the corner of a right angle, as shares of the bone; no arrow is longer than the last
# share of the figure.
_DOT, _CORNER, _LONG = 0.06, 0.08, 0.12
_LETTERS: tuple[Literal["x", "y", "z"], ...] = ("x", "y", "z")


def worlds(rig: Rig, posed: PoseCache) -> Floats:
    """World matrices, (n, 4, 4), of a pose of one row."""
    if not posed.parts:
        return rig.world
    local = rig.local.copy()
    for node in posed.parts:
        local[node] = posed.local(node)[0]
    return sampling.worlds(rig, local)


def joints_of(rig: Rig) -> Skeleton:
    """The joints of a rig; of one without joints all nodes, but for those that rigtri has added."""
    if not len(rig):
        return Skeleton(rig, (), {}, {}, np.zeros(0, dtype=bool))
    if rig.is_joint.any() or "hips" in rig.humanoid:
        return skeleton(rig)
    every = [node for node in range(len(rig)) if node not in rig.own and node not in rig.rules.data_nodes]
    return skeleton(rig, joints=every or range(len(rig)))


@dataclass(frozen=True, eq=False)
class Scene:
    """A rig as it stands: world (n, 4, 4). joints: those to be seen, of all that ``tree`` has."""

    rig: Rig
    world: Floats
    tree: Skeleton
    joints: tuple[int, ...]

    @staticmethod
    def of(rig: Rig, posed: PoseCache, selection: Selection) -> Scene:
        """The joints that a selection names; all nodes of a rig without joints.

        Raises NameNotFoundError and UsageError as `chosen` does.
        """
        tree = joints_of(rig)
        found = tuple(chosen(tree, selection)) if len(rig) else ()
        return Scene(rig, worlds(rig, posed), tree, found)

    @property
    def places(self) -> Floats:
        """Where the nodes stand, (n, 3)."""
        place: Floats = self.world[:, 3, :3]
        return place

    @property
    def all(self) -> bool:
        """Whether nothing of the rig is left out."""
        return len(self.joints) == len(self.tree.joints)

    def size(self) -> float:
        """The diagonal of the box of the joints seen, in file units; 1 for none and for a point."""
        points = self.places[list(self.joints)]
        points = points[np.isfinite(points).all(axis=1)]
        size = float(length(points.max(axis=0) - points.min(axis=0))) if len(points) else 0.0
        return size or 1.0

    @cached_property
    def bones(self) -> Bones:
        """The bones of all joints."""
        return Bones(self.tree, self.world, self.size(), self.joints)


def marks(scene: Scene, *, arrows: float = 0.35) -> list[Mark]:
    """All that is to be seen of a scene, far things first where order matters.

    arrows: the length of the axes as a share of the joint's bone; 0 leaves them out.
    """
    found = [*_follows(scene), *_limbs(scene), *_bones(scene)]
    with np.errstate(invalid="ignore"):
        axes = normalise(scene.world[list(scene.joints), :3, :3])
    for joint, name, own in zip(scene.joints, _names(scene), axes, strict=True):
        found += _joint(scene, joint, name, own, arrows)
    found += _sockets(scene, arrows)
    return [mark for mark in [*found, *_controls(scene)] if mark.clear]


def _names(scene: Scene) -> list[str]:
    """What to call the joints in a picture: without what all names of the skeleton begin with."""
    rig = scene.rig
    joints = [node for node in scene.tree.joints if rig.names[node]]
    short = dict(zip(joints, without_prefix([rig.names[node] for node in joints]), strict=True))
    return [short.get(node) or rig.names[node] or rig.labels[node] for node in scene.joints]


def _joint(scene: Scene, joint: int, name: str, axes: Floats, arrows: float) -> Iterator[Mark]:
    """The dot of a joint and the arrows of its axes, (3, 3); an axis without direction has none."""
    rig, place, bones = scene.rig, scene.places[joint], scene.bones
    known, address = bool(rig.is_joint[joint]) or not rig.is_joint.any(), rig.address(joint)
    text, reach, size = rig.title(joint), bones.reach(joint), bones.size
    if (miss := bones.misses.get(joint)) is not None:
        text += f": {miss.axis} is {miss.degrees:.1f}° off the bone to {rig.title(miss.child)}"
    yield from _arrows(place, axes, address, min(arrows * reach, _LONG * size))
    dot = _DOT * min(reach, _LONG * size / 0.35)
    kind: Literal["joint", "node"] = "joint" if known else "node"
    crooked = bones.crooked(joint)
    yield Mark("dot", kind, place[np.newaxis], address, name, text, dot, crooked=crooked)


def _sockets(scene: Scene, arrows: float) -> Iterator[Mark]:
    """Nodes below joints that are there to hold something, and hold nothing: in glTF they are no joints."""
    rig, seen, long = scene.rig, set(scene.joints), _LONG * scene.bones.size
    bare = np.flatnonzero((rig.attachment < 0) & ~rig.is_joint).tolist()
    bare = [node for node in bare if rig.parents[node] in seen and not rig.children[node]]
    for node in sorted(sockets(rig).intersection(bare) - rig.own) if bare and rig.is_joint.any() else ():
        above, place, address = int(rig.parents[node]), scene.places[node], rig.address(node)
        reach = scene.bones.reach(above)
        yield Mark("line", "link", scene.places[[above, node]], rig.address(above))
        with np.errstate(invalid="ignore"):
            axes = normalise(scene.world[node, :3, :3])
        yield from _arrows(place, axes, address, min(arrows * reach, long))
        dot = _DOT * min(reach, long / 0.35)
        yield Mark("dot", "node", place[np.newaxis], address, rig.names[node], rig.title(node), dot)


def _arrows(place: Floats, axes: Floats, address: str, long: float) -> Iterator[Mark]:
    """The arrows of axes, (3, 3), that are so long; an axis without direction has none."""
    for letter, axis in zip(_LETTERS, axes, strict=True):
        if long > 0 and np.isfinite(axis).all():
            yield Mark("arrow", letter, np.stack([place, place + axis * long]), address, size=long)


def _bones(scene: Scene) -> Iterator[Mark]:
    """A bone from each joint to every joint below it, one of which is to be seen."""
    rig, seen = scene.rig, set(scene.joints)
    for joint in scene.tree.joints:
        above = scene.tree.above[joint]
        if above >= 0 and (joint in seen or above in seen):
            ends = scene.places[[above, joint]]
            bone = bool(rig.is_joint[joint] and rig.is_joint[above])
            yield Mark("bone" if bone else "line", "bone" if bone else "link", ends, rig.address(above))


def _limbs(scene: Scene) -> Iterator[Mark]:
    """The triangles of the limbs that names or pole vectors describe."""
    rig, seen = scene.rig, set(scene.joints)
    bends = dict(bend_directions(rig, scene.world))
    for triple, pole in limbs(rig).items():
        middle = triple[1]
        if middle in seen:
            yield from triangle(*scene.places[[*triple]], node=rig.address(middle))
            if pole >= 0:
                yield from _located(scene, middle, pole)
            elif triple in bends:
                yield from pole_arrow(*scene.places[[*triple]], side=bends[triple], node=rig.address(middle))


def bend_directions(rig: Rig, world: Floats) -> Iterator[tuple[tuple[int, int, int], Floats]]:
    """Where recognised limbs bend to, unit, (3,), as add-polevector takes it; in a pose, world (n, 4, 4)."""
    found = recognise(rig)
    known = bodies(rig, characters_of(rig).characters, world, None)
    bends = LimbBends(rig, world, bind_pose(rig), found, known)
    for limb in found:
        bend = bends.of(limb, Report())
        if bend is not None:
            yield limb.triple, bend.direction


def _located(scene: Scene, middle: int, pole: int) -> Iterator[Mark]:
    """A pole vector that the file has, and the way to it from the joint that bends towards it."""
    ends, address = scene.places[[middle, pole]], scene.rig.address(pole)
    far = float(length(ends[1] - ends[0]))
    name = scene.rig.names[pole] or scene.rig.labels[pole]
    yield Mark("arrow", "pole", ends, address, size=far)
    text = f"pole vector {scene.rig.title(pole)}"
    # The joint may have no place: then the pole vector is drawn alone.
    dot = _DOT * float(np.fmin(far, scene.size() * _LONG))
    yield Mark("dot", "locator", ends[1:], address, name, text, size=dot)


def limbs(rig: Rig) -> dict[tuple[int, int, int], int]:
    """Root, middle and end of limbs, recognised or with a pole vector; and that, or −1."""
    found = {limb.triple: -1 for limb in recognise(rig)}
    for node, record in sorted(rig.records(PoleVectorRecord).items()):
        known = [joint for joint in map(rig.known, record.chain) if joint is not None]
        if len(known) >= 3 and len(known) == len(record.chain):
            found[known[0], known[1], known[-1]] = node
    return found


def follows(rig: Rig) -> Iterator[tuple[str, int, int]]:
    """Kind of a constraint, what a node follows, and the node: of the file's constraints and of ours."""
    for constraint in rig.node_constraints:
        if constraint.kind != "length" and constraint.source != constraint.node:
            yield constraint.kind, constraint.source, constraint.node
    for record in rig.records(ConstraintRecord).values():
        child = rig.known(record.child)
        for driver in map(rig.known, record.drivers):
            if driver is not None and child is not None and driver != child:
                yield record.kind, driver, child


def triangle(a: Floats, b: Floats, c: Floats, *, node: str = "") -> Iterator[Mark]:
    """A limb as the talk draws it: triangle, chord, the projection of the middle and its right angle."""
    yield Mark("face", "limb", np.stack([a, b, c]), node, closed=True)
    yield Mark("line", "chord", np.stack([a, c]), node)
    foot, side = project(b, a, c), bend_direction(a, b, c)
    if not np.isfinite(side).all():  # three points on one line, which have no side
        return
    yield Mark("line", "upright", np.stack([foot, b]), node)
    corner = min(_CORNER * float(length(c - a)), 0.5 * float(length(b - foot)))
    along = normalise(c - a) * corner
    square = np.stack([foot + along, foot + along + side * corner, foot + side * corner])
    yield Mark("line", "square", square, node)
    text = f"projection of the mid joint on the root-to-end line; the limb bends by {_bend(a, b, c)}"
    yield Mark("dot", "foot", foot[np.newaxis], node, description=text, size=0.2 * corner)


def pole_arrow(
    a: Floats, b: Floats, c: Floats, *, side: Floats | None = None, node: str = ""
) -> Iterator[Mark]:
    """Where a limb's pole vector stands by the talk's rule, half the limb's length off the middle joint.

    side: to which it bends, (3,); None is where its triangle does.
    """
    ends = np.stack([b, pole_position(a, b, c, direction=side)])
    yield Mark("arrow", "pole", ends, node, size=float(length(ends[1] - ends[0])))


def _bend(a: Floats, b: Floats, c: Floats) -> str:
    return f"{float(bend_angle(a, b, c)) * _DEGREES:.1f}°"


def _controls(scene: Scene) -> Iterator[Mark]:
    """The lines that the file draws at controls, poles and what else rigtri has put there."""
    rig = scene.rig
    for node in sorted(set(rig.metadata) | set(rig.pending.shapes)) if scene.all else ():
        drawn = rig.pending.shapes.get(node) or rig.content.read_lines(rig.keys[node])
        if drawn is None:
            continue
        text = f"{rig.metadata.get(node, {}).get('type', 'shape')} {rig.title(node)}"
        for strip in strips(transform_points(drawn.segments, scene.world[node])):
            color = tuple(map(float, drawn.color))
            yield Mark("line", "control", strip, rig.address(node), description=text, color=color)


def strips(segments: Floats) -> Iterator[Floats]:
    """Lines, (s, 2, 3), as few strips, (k, 3): each goes on while a line begins where the last one ends."""
    strip: list[Floats] = []
    for start, end in segments:
        if strip and not np.array_equal(strip[-1], start):
            yield np.stack(strip)
            strip = []
        strip += [end] if strip else [start, end]
    if strip:
        yield np.stack(strip)


def _follows(scene: Scene) -> Iterator[Mark]:
    """A line from what a node follows to the node, of the file's constraints and of ours."""
    rig = scene.rig
    for kind, source, node in follows(rig) if scene.all else ():
        text = f"{rig.title(node)} follows {rig.title(source)} ({kind})"
        yield Mark("line", "follows", scene.places[[source, node]], rig.address(node), description=text)
