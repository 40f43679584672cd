"""add-controls: a hierarchy of FK and IK controls over joint chains.

Source: R. Katz, "Rigging with Triangles", GDC 2018, "Build finger": for each joint an
offset at the joint's frame, the control under it with zero channels, the next offset
under the control.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.sampling import world_of
from rigtri.evaluation.zero_pose import ik_obstacle, moved_controls
from rigtri.frames.skeleton import ReferencePose, Skeleton, reference, skeleton
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import from_frame, nearest_rotation, transform_directions
from rigtri.maths.quaternions import (
    angle_between,
    conjugate,
    from_axes,
    multiply,
    rotation_angle,
    to_axes,
)
from rigtri.maths.triangle import axis_of
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot, normalise
from rigtri.model.control_shapes import COLORS, Kind
from rigtri.model.joint_names import Side, side
from rigtri.model.metadata import ControlKind, ControlRecord, OffsetRecord, PoleVectorRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_polevector import AddPolevectorOptions, add_polevector
from rigtri.operations.aim_targets import Aim, Rules, aim_targets, limb_children
from rigtri.operations.axis_presets import AxisStyle
from rigtri.operations.control_drawing import Drawing, draw, draw_anew
from rigtri.operations.control_frames import control_axes, stored_style, with_style
from rigtri.operations.joint_selection import chosen
from rigtri.operations.operation import operation
from rigtri.operations.options.add_controls import NAME as NAME
from rigtri.operations.options.add_controls import TOKENS as TOKENS
from rigtri.operations.options.add_controls import AddControlsOptions as AddControlsOptions
from rigtri.operations.rigtri_nodes import (
    add,
    built_at_zero,
    call,
    find,
    group,
    home,
    remembered,
    stand,
    with_record,
)
from rigtri.operations.skin_joints import add_joint, beside, is_joint_kind, move_joint
from rigtri.operations.skin_sections import SkinSections
from rigtri.recognition.limbs import Limb, forward, named_limbs, with_recognised
from rigtri.report import Report

# Axes of a control and a joint that differ by less (radians) are the same: rotations are float32.
SAME_AXES = 2e-6
# What {kind} stands for in a name, by the kind of control.
_WORDS = {"fk": "ctl", "ik": "ik_ctl", "root": "root_ctl"}
_SHAPES: dict[str, Kind] = {"fk": "circle", "ik": "cube", "root": "arrow", "pole": "diamond"}
# The radius of a shape as a share of how far the skin reaches around the joint; at least, and without skin,
# as a share of the bone. Bones shorter than this share of the median count as that.
MARGIN = 1.2
LEAST, RADIUS = 0.25, 0.5
SHORTEST = 0.5


def idle_ik(rig: Rig, chain: tuple[int, int, int], carries: Booleans) -> str:
    """Why an IK end of a limb would move nothing; "" where it would. carries: as `Skeleton` has it."""
    if carries[chain[0]]:
        return ik_obstacle(rig, chain)
    return f"no mesh follows '{rig.title(chain[0])}'"


@operation(AddControlsOptions)
def add_controls(rig: Rig, *, options: AddControlsOptions, report: Report) -> Rig:
    """Put controls over joints; a second run finds its controls and sets their offsets anew.

    Each control stands at its joint at rest, in its axes or aimed as the options say, its own channels zero;
    what a user has since set or drawn on it stays. The record of each goes to ``report.added``.

    Raises NameNotFoundError, UsageError, GeometryError (a joint without a frame), FileError.
    """
    return built_at_zero(rig, lambda rig: _Builder(rig, options, report).build())


class _Builder:
    """One run: the rig as it grows, and what is known of its joints from the start."""

    def __init__(self, rig: Rig, options: AddControlsOptions, report: Report) -> None:
        self.rig, self.options, self.report = rig, options, report
        self.tree: Skeleton = skeleton(rig, options.root)
        self.ref: ReferencePose = reference(self.tree, "nodes")
        self.world = rig.world
        named = tuple(named_limbs(rig, options.ik))
        self.limbs = (*named, *self._recognised(named)) if self._all_limbs else named
        rules = Rules(limb_child=limb_children(self.tree, self.limbs))
        self.aims = aim_targets(self.tree, self.ref, self.tree.joints, rules)
        bones = [aim.length for aim in self.aims.values() if aim.length > 0]
        self.typical = float(np.median(bones)) if bones else self.ref.extent or 1.0
        self.frames: dict[tuple[int, ControlKind], Floats] = {}
        self.sections = SkinSections(rig)
        # Of earlier runs; what this run makes has neither keys nor been moved.
        self.moved = moved_controls(rig)
        self.controls: dict[int, int] = {}
        self.above_controls = set[int]()
        # The controls of this run: node, kind and joint.
        self.made: list[tuple[int, ControlKind, int]] = []

    @property
    def _all_limbs(self) -> bool:
        return self.options.whole_character or self.options.limbs is not None

    def _recognised(self, named: tuple[Limb, ...]) -> Iterator[Limb]:
        """The recognised limbs beside those that are named, but those where IK has nothing to move."""
        for limb in with_recognised(self.rig, named)[len(named) :]:
            if why := idle_ik(self.rig, limb.triple, self.tree.carries):
                title = self.rig.title(limb.end)
                self.report.warn("no-ik", f"No IK end for '{title}': {why}", joint=title)
            else:
                yield limb

    def build(self) -> Rig:
        options = self.options
        self.rig, holder = group(self.rig)
        self.above_controls = self.rig.with_ancestors([holder])
        if options.root_control or options.whole_character:
            self._root()
        joints = self._joints()
        self._aim([*((joint, "fk") for joint in joints), *((limb.end, "ik") for limb in self.limbs)])
        for joint in joints:
            self.controls[joint] = self._control(joint, "fk", {"joint": self.rig.address(joint)})
        for limb in dict.fromkeys(self.limbs):
            chain = tuple(map(self.rig.address, limb.triple))
            self._ik(limb, {"joint": chain[-1], "chain": chain})
        self._poles()
        self._give_names()
        for control, kind, joint in self.made:
            self._record(control, kind, joint)
        return self.rig

    def _give_names(self) -> None:
        """Names by the user's rule, and a record of those that new controls have."""
        if self.options.name is not None:
            names = {c: self._name(joint, kind, self.options.name) for c, kind, joint in self.made}
            self.rig = call(self.rig, names, self.options.name, self.report)
        self.rig = remembered(self.rig, [c for c, _, _ in self.made if self.rig.keys[c] is None])

    def _joints(self) -> list[int]:
        """The joints that get FK controls, parents first; twist joints follow by themselves.

        Those of limbs with IK always do, whatever carries weight: theirs hold what IK cannot.
        """
        options, found = self.options, list[int]()
        if options.selection.named or options.whole_character:
            found = [k for k in chosen(self.tree, options.selection) if self.rig.type_of(k) != "twist"]
            if not options.selection.named:
                idle = self.above_controls.union(np.flatnonzero(~self.tree.carries).tolist())
                found = [joint for joint in found if joint not in idle]
        missing = {node for limb in self.limbs for node in limb.triple}.difference(found)
        return sorted({*found, *missing}) if missing else found

    def _root(self) -> None:
        """The control over all: below the first root joint, as low as the lowest joint, along the world."""
        # A prim that holds the controls, as with --root, cannot follow one of them.
        free = (joint for joint in self.tree.joints if joint not in self.above_controls)
        top = next(free, self.tree.roots[0])
        points = self.ref.world[list(self.tree.joints), 3, :3]
        up = np.asarray(self.rig.rules.up, dtype=np.float64)
        place = self.ref.position(top).copy()
        low = float(dot(points, up).min())
        place = place + up * (low - float(dot(place, up)))
        about = {"joint": self.rig.address(top)}
        control = self._find("root", about)
        front = forward(self.rig)
        drawing = self._drawing("root", top, self.ref.extent * 0.25, up, front)
        if control is None:
            self.rig, parent = group(self.rig)
            control = self._new("root", top, parent, about, drawing)
        else:
            self._again(control, "root", top, drawing)
        self.rig = stand(self.rig, int(self.rig.parents[control]), place, np.eye(3))
        self.made.append((control, "root", top))

    def _aim(self, controls: Sequence[tuple[int, ControlKind]]) -> None:
        """Find the axes of controls that are to be aimed, all of one style at once."""
        groups: dict[AxisStyle, dict[int, list[ControlKind]]] = {}
        for joint, kind in controls:
            style = self._style(joint, kind)
            if style is not None:
                groups.setdefault(style, {}).setdefault(joint, []).append(kind)
        for style, kinds in groups.items():
            found = control_axes(self.rig, list(kinds), style, self.options.ik, self.options.root)
            self.frames |= {(joint, kind): axes for joint, axes in found.items() for kind in kinds[joint]}

    def _style(self, joint: int, kind: ControlKind) -> AxisStyle | None:
        """What a control is aimed by; None where it has the axes of its joint.

        A control that has been moved or has keys stays as it is.
        """
        known = find(self.rig, OffsetRecord, kind=kind, joint=self.rig.address(joint))
        if known is not None:
            stored = stored_style(self.rig.records(OffsetRecord)[known])
            if self.options.style is None and self.options.frame is None:
                return stored
            if self.moved.intersection(self.rig.children[known]):
                return stored
        return self.options.style

    def _find(self, kind: ControlKind, about: Mapping[str, Any]) -> int | None:
        return find(self.rig, ControlRecord, kind=kind, **about)

    def _control(self, joint: int, kind: ControlKind, about: Mapping[str, Any]) -> int:
        """The control of a kind over a joint, found again or new, its offset in the joint's frame."""
        control = self._find(kind, about)
        style, parent = self._style(joint, kind), self._parent(joint, kind)
        drawing = self._drawing(kind, joint, *self._size(joint, self.frames.get((joint, kind)), style))
        if control is None:
            control = self._new(kind, joint, parent, about, drawing)
        else:
            self._again(control, kind, joint, drawing, style)
        offset = int(self.rig.parents[control])
        if int(self.rig.parents[offset]) != parent:
            self._report_kept(control)
        axes = self._offset_axes(control, joint, kind, style)
        self.rig = stand(self.rig, offset, self.world[joint, 3, :3], axes)
        self.made.append((control, kind, joint))
        return control

    def _offset_axes(self, control: int, joint: int, kind: ControlKind, style: AxisStyle | None) -> Floats:
        """The axes of a control's offset, (3, 3): its own, the joint's, or those in which it has been moved.

        Their record: how the joint is turned against them.
        """
        offset = int(self.rig.parents[control])
        record = self.rig.records(OffsetRecord).get(offset)
        own = self._frame(joint)
        if record is None:
            return own
        if control in self.moved:
            if record.axes is None:
                return own
            return to_axes(multiply(from_axes(own), conjugate(np.array(record.axes))))
        axes = self.frames.get((joint, kind), own)
        rest = multiply(conjugate(from_axes(axes)), from_axes(own))
        same = float(rotation_angle(rest)) <= SAME_AXES
        if record.axes is None or float(angle_between(np.array(record.axes), rest)) > SAME_AXES:
            x, y, z, w = rest.tolist()
            record = replace(record, axes=(x, y, z, w))
        record = with_style(replace(record, axes=None) if same else record, style)
        self.rig = with_record(self.rig, offset, record)
        return own if same else axes

    def _ik(self, limb: Limb, about: Mapping[str, Any]) -> None:
        """The IK end of a limb, a control or a joint as an earlier run has made it, or as is wanted."""
        if obstacle := ik_obstacle(self.rig, limb.triple):
            raise GeometryError(f"IK cannot move this limb: {obstacle}. Name other joints, or leave it out")
        known, kind = self._find("ik", about), self.options.as_
        if kind == "joint" if known is None else is_joint_kind(self.rig, known, kind):
            self._ik_joint(limb, known, about)
        else:
            self._control(limb.end, "ik", about)
        self._limits(about)

    def _limits(self, about: Mapping[str, Any]) -> None:
        """How an IK limb reaches, in its control's record; what is zero is not stored."""
        control = self._find("ik", about)
        if control is None:
            return
        own, given = self.rig.records(ControlRecord)[control], self.options
        soft = own.soft if given.soft is None else given.soft or None
        stretch = own.stretch if given.stretch is None else given.stretch or None
        self.rig = with_record(self.rig, control, replace(own, soft=soft, stretch=stretch))

    def _ik_joint(self, limb: Limb, known: int | None, about: Mapping[str, Any]) -> None:
        """A joint beside a limb, in the frame of its end; nothing is drawn, engines show bones themselves."""
        place, axes = self.world[limb.end, 3, :3], self._frame(limb.end)
        if known is None:
            parent, like = beside(self.rig, limb.start)
            record = ControlRecord(kind="ik", **about, side=self._side(limb.end))
            name = self._name(limb.end, "ik")
            self.rig, node = add_joint(self.rig, name, parent, record, place, axes, like=like)
        else:
            self.rig, node = move_joint(self.rig, known, place, axes), known
        self.made.append((node, "ik", limb.end))

    def _frame(self, joint: int) -> Floats:
        axes = nearest_rotation(self.world[joint])
        if not np.isfinite(axes).all():
            raise GeometryError(f"'{self.rig.title(joint)}' has no frame: a scale on or above it is zero")
        return axes

    def _name(self, joint: int, kind: ControlKind, rule: str = NAME) -> str:
        name = self.rig.names[joint] or f"joint_{joint}"
        return rule.format(joint=name, side=self._side(joint), kind=_WORDS[kind])

    def _new(
        self, kind: ControlKind, joint: int, parent: int, about: Mapping[str, Any], drawing: Drawing
    ) -> int:
        name = self._name(joint, kind)
        record = ControlRecord(kind=kind, **about, side=self._side(joint))
        offset_record = OffsetRecord(kind=kind, joint=record.joint)
        self.rig, offset = add(self.rig, f"{name}_offset", parent, offset_record)
        self.rig, control = add(self.rig, name, offset, record)
        self.rig = draw(self.rig, control, drawing)
        return control

    def _again(
        self,
        control: int,
        kind: ControlKind,
        joint: int,
        drawing: Drawing,
        style: AxisStyle | None = None,
    ) -> None:
        """A control that is there already gets what was asked for; drawn anew where its axes are others."""
        requested, offset = self._requested(kind, joint), int(self.rig.parents[control])
        record = self.rig.records(OffsetRecord).get(offset)
        turned = record is not None and stored_style(record) != style
        self.rig = draw_anew(self.rig, control, drawing, requested, self.report, turned=turned)

    def _drawing(
        self, kind: str, joint: int, size: float, normal: Floats, front: Floats | None = None
    ) -> Drawing:
        options, which = self.options, self._side(joint)
        size = size * (1.0 if options.size is None else options.size)
        shape = cast("Kind", options.shape.get(kind, _SHAPES[kind]))
        return Drawing(shape, size, options.color.get(which, COLORS[which]), normal, front)

    def _requested(self, kind: str, joint: int) -> frozenset[str]:
        """What of a drawing the options name."""
        options = self.options
        requested = {
            "shape": kind in options.shape,
            "size": options.size is not None,
            "color": self._side(joint) in options.color,
        }
        return frozenset(key for key, given in requested.items() if given)

    def _parent(self, joint: int, kind: ControlKind) -> int:
        """The control of the nearest joint above that has one; IK ends hang under the root control."""
        above = self.tree.above.get(joint, -1) if kind == "fk" else -1
        while above >= 0:
            found = self.controls.get(above)
            found = found if found is not None else self._find("fk", {"joint": self.rig.address(above)})
            if found is not None:
                return found
            above = self.tree.above[above]
        self.rig, parent = home(self.rig)
        return parent

    def _size(
        self, joint: int, axes: Floats | None = None, style: AxisStyle | None = None
    ) -> tuple[float, Floats]:
        """The radius of a joint's shape, and which axis of its control lies along the bone, (3,).

        axes: of a control that has its own, aimed by ``style``.
        """
        aim = self.aims.get(joint, Aim("keep"))
        above = self.aims.get(self.tree.above.get(joint, -1), Aim("keep"))
        bone = aim.length or 0.5 * above.length
        direction = aim.direction if aim.direction is not None else above.direction
        normal = np.array([1.0, 0.0, 0.0])
        if axes is not None and style is not None and not style.world:
            letter, sign = axis_of(style.aim)
            normal = np.where(np.arange(3) == letter, sign, 0.0)
        elif direction is not None:
            axis = int(np.argmax(np.abs(direction)))
            normal = np.where(np.arange(3) == axis, np.sign(direction[axis]), 0.0)
        stand = self.world[joint] if axes is None else from_frame(axes, self.world[joint, 3, :3])
        along = normalise(transform_directions(normal, stand))
        around = self.sections.radius(joint, stand[3, :3], along)
        bone = max(bone, SHORTEST * self.typical)
        return max(MARGIN * around, LEAST * bone) if around > 0 else RADIUS * bone, normal

    def _side(self, joint: int) -> Side:
        """The side that a VRM bone or a name says, of the joint or the nearest above that says one."""
        bones = {node: bone for bone, node in self.rig.humanoid.items()}
        node = joint
        while node >= 0:
            found = side(bones.get(node, "")) or side(self.rig.names[node])
            if found:
                return found
            node = self.tree.above.get(node, -1)
        return ""

    def _poles(self) -> None:
        """A pole vector for every IK limb, drawn where it is new."""
        if not self.limbs:
            return
        before = set(self.rig.metadata)
        limbs = tuple(dict.fromkeys(self.limbs))
        pole_options = AddPolevectorOptions(
            limb=limbs,
            reach=self.options.reach,
            facing=self.options.facing,
            bend=self.options.bend,
            as_=self.options.as_,
        )
        self.rig = add_polevector(self.rig, options=pole_options, report=self.report)
        for node in self._drawn_poles(limbs):
            record = self.rig.records(PoleVectorRecord)[node]
            middle = self.rig.find(record.chain[1])
            drawing = self._drawing("pole", middle, 0.5 * self._size(middle)[0], np.array([1.0, 0.0, 0.0]))
            if node not in before:
                self.rig = draw(self.rig, node, drawing)
            elif record.shape:
                requested = self._requested("pole", middle)
                self.rig = draw_anew(self.rig, node, drawing, requested, self.report)

    def _drawn_poles(self, limbs: tuple[Limb, ...]) -> list[int]:
        """The pole vectors of limbs that are no joints."""
        chains = (tuple(map(self.rig.address, limb.triple)) for limb in limbs)
        found = [find(self.rig, PoleVectorRecord, chain=chain) for chain in chains]
        return [node for node in found if node is not None and not self.rig.is_joint[node]]

    def _report_kept(self, control: int) -> None:
        self.report.warn(
            "control-kept-in-place",
            f"'{self.rig.names[control]}' was made before the controls above it and stays under "
            f"'{self.rig.title(int(self.rig.parents[self.rig.parents[control]]))}'; to rebuild the tree, "
            "strip the file first",
        )

    def _record(self, control: int, kind: ControlKind, joint: int) -> None:
        offset = control if self.rig.is_joint[control] else int(self.rig.parents[control])
        parent = int(self.rig.parents[offset])
        place = world_of(self.rig, offset)[3, :3]
        self.report.added.append(
            {
                "node": self.rig.names[control],
                "type": "control",
                "kind": kind,
                "joint": self.rig.title(joint),
                "parent": self.rig.names[parent],
                "new": self.rig.keys[control] is None,
                "position": [float(x) for x in place],
            }
        )
