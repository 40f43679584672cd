"""The axes of controls: aimed by themselves, whatever axes their joints have or must keep.

They are what `orient-joints` would give the joint, in the rest pose, also where a format or an extension
lets no joint have axes of its own. A joint stands to its control as ``joint_world = rest_offset ·
control_world``; both are at one place, so what is stored of the offset is a rotation.

Source: R. Katz, "Using Vector Math to Rig an Arm" (rest offset); `rigtri.operations.orient_joints`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from rigtri.errors import GeometryError, RigtriError
from rigtri.evaluation.sampling import world_of
from rigtri.frames.skeleton import Skeleton
from rigtri.maths.matrices import determinant, nearest_rotation, transform_directions
from rigtri.maths.quaternions import (
    angle_between,
    conjugate,
    from_axes,
    multiply,
    rotation_angle,
    to_axes,
)
from rigtri.maths.triangle import axis_of, frame
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.metadata import ControlKind, OffsetRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import moving_points
from rigtri.operations.aim_targets import EYES
from rigtri.operations.axis_presets import AxisStyle
from rigtri.operations.joint_selection import EYE, ROOT
from rigtri.operations.options.add_controls import AddControlsOptions
from rigtri.operations.options.orient_joints import OrientJointsOptions
from rigtri.operations.orient_joints.orient import FramePlan, plan_frames
from rigtri.operations.orient_joints.unknown_bodies import Wording, warn_unsure
from rigtri.operations.orient_joints.up_direction import PRESENT, STATED, UpSource
from rigtri.operations.rigtri_nodes import group
from rigtri.recognition.recognise import recognised_as
from rigtri.report import Notice, Report

# A joint and a kind of control over it.
Control = tuple[int, ControlKind]
# Axes of a control and a joint that differ by less (radians) are the same: rotations are float32.
SAME_AXES = 2e-6
# What a record has for axes along the world, and for those that mirror the axes of a control's twin.
_WORLD, _MIRRORED = "world", "mirrored"
_AXES = {sign + axis for sign in ("", "+", "-") for axis in "xyz"}
MIRRORED = AxisStyle("", "", _MIRRORED)
# Of a control whose record nobody can read: it keeps its axes and its record.
KEPT = AxisStyle("", "", "kept")
# How add-controls says what is not known of a body: its bones alone aim controls, too.
_WORDING = Wording(
    "controls",
    "--ik START MIDDLE END",
    "--frame joint gives them the axes of their joints",
    "Say --frame joint after rigtri orient-joints with --aim-at NODE=TARGET",
    "controls have the axes of their joints",
)


class ControlAxes:
    """What the controls of one run are aimed by, and their axes. moved: see `moved_controls`.

    styles, frames: by joint and kind, (3, 3) rows in the world at rest; of others those of their joints.
    unknown: what is not known of the body that they are aimed by. illegible: records that cannot be used.
    """

    def __init__(self, tree: Skeleton, options: AddControlsOptions, moved: frozenset[int]) -> None:
        self._tree, self._options, self._moved = tree, options, moved
        self._world = tree.rig.normalised_world
        self.styles: dict[Control, AxisStyle] = {}
        self.frames: dict[Control, Floats] = {}
        self.unknown: list[Notice] = []
        self.illegible: list[Notice] = []
        offsets = tree.rig.records(OffsetRecord)
        self._offsets = {(record.joint, record.kind): node for node, record in offsets.items()}

    def find(self, controls: Iterable[Control]) -> None:
        """Find what controls are aimed by, and their axes, all of one style at once."""
        groups: dict[AxisStyle, list[Control]] = {}
        for joint, kind in controls:
            style = self._style(joint, kind)
            if style is not None:
                groups.setdefault(style, []).append((joint, kind))
        for style, found in groups.items():
            self.styles |= dict.fromkeys(found, style)
            if style in (MIRRORED, KEPT):
                self.frames |= {(joint, kind): self._mirrored(joint, kind) for joint, kind in found}
                continue
            axes = self._aimed({joint for joint, _ in found}, style)
            self.frames |= {(joint, kind): axes[joint] for joint, kind in found if joint in axes}

    def of_joint(self, joint: int) -> Floats:
        """The axes of a joint in the world, (3, 3). Raises GeometryError where it has none."""
        known = self._nearest.get(joint)
        axes = np.asarray(nearest_rotation(self._world[joint]) if known is None else known)
        if not np.isfinite(axes).all():
            title = self._tree.rig.title(joint)
            raise GeometryError(f"'{title}' has no frame: a scale on or above it is zero")
        return axes

    @cached_property
    def _nearest(self) -> dict[int, Floats]:
        joints = list(self._tree.joints)
        return dict(zip(joints, nearest_rotation(self._world[joints]), strict=True))

    def of_offset(
        self, control: int, joint: int, kind: ControlKind, record: OffsetRecord | None
    ) -> tuple[Floats, OffsetRecord | None]:
        """The axes of a control's offset, (3, 3): its own, its joint's, or those in which it has been moved.

        And its record: how the joint is turned against them.
        """
        own = self.of_joint(joint)
        if record is None:
            return own, None
        if control in self._moved:
            return self._standing(joint, record), record
        record = replace(record, scale=None)  # it stands on the joint as that rests
        axes = self.frames.get((joint, kind), own)
        rest = multiply(conjugate(from_axes(axes)), from_axes(own))
        same = float(rotation_angle(rest)) <= SAME_AXES
        if record.axes is None or float(angle_between(np.array(record.axes), rest)) > SAME_AXES:
            x, y, z, w = rest.tolist()
            record = replace(record, axes=(x, y, z, w))
        style = self.styles.get((joint, kind))
        return own if same else axes, with_style(replace(record, axes=None) if same else record, style)

    def described(self, joint: int, kind: ControlKind) -> dict[str, str]:
        """For the report: the axes of what a control has, and why it has those of its joint."""
        style = self.styles.get((joint, kind))
        if style == KEPT:
            return {}
        if kind == "root" or (style is not None and style.world):
            return {"frame": "world"}
        if style is not None:
            return {"frame": "mirrored" if style == MIRRORED else "bone"}
        why = "" if self._options.frame == "joint" else self._steady.get(joint, "")
        return {"frame": "joint", **({"reason": why} if why else {})}

    def _style(self, joint: int, kind: ControlKind) -> AxisStyle | None:
        """What a control is aimed by; None where it has the axes of its joint.

        A control that has been moved or has keys stays as it is.
        """
        options, rig = self._options, self._tree.rig
        known = self._offsets.get((rig.address(joint), kind))
        stored = None if known is None else self._stored(known)
        if known is not None and not self._moved.isdisjoint(rig.children[known]):
            return stored
        if rig.address(joint) in options.axes:
            return MIRRORED
        if known is not None and options.style is None and options.frame is None:
            return stored
        if options.frame == "joint":
            return None
        return options.style or (None if joint in self._steady else AxisStyle())

    def _stored(self, offset: int) -> AxisStyle | None:
        """What the control below an offset was aimed by; warns where nobody can read that."""
        rig = self._tree.rig
        record = rig.records(OffsetRecord)[offset]
        style = stored_style(rig, record)
        if style == KEPT:
            title = next(map(rig.title, rig.children[offset]), rig.title(offset))
            said = ", ".join(f"{key} '{record.stored.get(key, '')}'" for key in ("aim", "up", "upFrom"))
            text = f"'{title}' keeps its axes: what '{rig.title(offset)}' stores of them cannot be used"
            text = f"{text} ({said}). --aim, --up and --up-from give it new ones"
            self.illegible.append(Notice("style-illegible", text, title))
        return style

    @cached_property
    def _steady(self) -> dict[int, str]:
        """Why joints give their controls their own axes, where nothing else is requested.

        What moves no vertex itself at the root is the motion of the whole character; eyes look.
        """
        rig = self._tree.rig
        moving = moving_points(rig.skins, len(rig))
        eyes = {rig.humanoid.get(eye) for eye in EYES}
        found = {joint: EYE for joint in self._tree.joints if joint in eyes}
        return found | {joint: ROOT for joint in self._tree.roots if not moving[joint]}

    def _mirrored(self, joint: int, kind: ControlKind) -> Floats:
        """The axes of a control that mirrors another: those that are given, or those that it has."""
        rig = self._tree.rig
        axes = self._options.axes.get(rig.address(joint))
        if axes is not None:
            return np.asarray(axes)
        return self._standing(joint, rig.records(OffsetRecord)[self._offsets[rig.address(joint), kind]])

    def _standing(self, joint: int, record: OffsetRecord) -> Floats:
        """The axes of an offset, as its joint stands to it."""
        own = self.of_joint(joint)
        if record.axes is None:
            return own
        return to_axes(multiply(from_axes(own), conjugate(np.array(record.axes))))

    def _aimed(self, joints: set[int], style: AxisStyle) -> dict[int, Floats]:
        """The axes of controls over joints; without those that have none.

        A joint whose scale is not uniform gets the nearest of its own axes: no others share its scale.
        Raises UsageError and NameNotFoundError for what ``style`` names.
        """
        rig, given = self._tree.rig, self._options
        rules = replace(rig.rules, fixed={}, orient_locked="", world_aligned=frozenset())
        free = recognised_as(replace(rig, rules=rules), rig)
        # All joints, whichever have controls: ends have the axes of the joints above them.
        all_joints = tuple(map(rig.address, self._tree.joints))
        options = OrientJointsOptions(
            **_request(style),
            joints=all_joints,
            limb=given.ik,
            facing=given.facing,
            pose="nodes",
            root=given.root,
        )
        plan = plan_frames(free, options)
        notes = Report()
        warn_unsure(plan.targets, notes, faces=given.facing is not None, wording=_WORDING)
        self.unknown += notes.warnings
        delta = plan.policy.allowed(plan.requested.delta, plan.targets.styles, Report())
        aim, up = (style.aim[-1], style.up[-1])
        world, found = plan.targets.ref.world, dict[int, Floats]()
        for joint in joints.intersection(plan.requested.joints):
            rows = normalise(transform_directions(to_axes(delta[joint]), world[joint]))
            ahead, hinge = rows[axis_of(aim)[0]], rows[axis_of(up)[0]]
            by_hinge, reversed_ = _hinge_of(plan, joint, style)
            # Right-handed, also over a joint that mirrors, whose hinge is reversed to mean the same.
            hinge = -hinge if reversed_ else hinge
            if self._held_mirrored:
                # All axes are negated there: what aims, and is stated, points where it should after that, and
                # the hinge is reversed, as that of a joint there.
                ahead, hinge = -ahead, hinge if by_hinge else -hinge
            found[joint] = frame(ahead, hinge, aim_axis=aim, up_axis=up)
        return found

    @cached_property
    def _held_mirrored(self) -> bool:
        """Whether the node that holds all controls is mirrored, so that controls have left-handed axes."""
        rig, holder = group(self._tree.rig)
        return bool(determinant(world_of(rig, holder)) < 0)


def _hinge_of(plan: FramePlan, joint: int, style: AxisStyle) -> tuple[bool, bool]:
    """Whether the up axis of a joint is its hinge, and whether left-handed axes reverse that."""
    targets, step = plan.targets, plan.requested.ups.step
    while joint in targets.aims and targets.aims[joint].how == "parent" and targets.tree.above[joint] >= 0:
        joint = targets.tree.above[joint]
    by_hinge = step[joint] not in (STATED, PRESENT) and style.up_from != "pole"
    return by_hinge, by_hinge and bool(targets.mirrored[joint])


def _request(style: AxisStyle) -> dict[str, Any]:
    """The options that stand for a style."""
    if style.world:
        return {"world": True}
    if style.held:
        return {"preset": "maya", "aim": style.aim, "up": style.up}
    return {"aim": style.aim, "up": style.up, "up_from": style.up_from}


def stored_style(rig: Rig, record: OffsetRecord) -> AxisStyle | None:
    """What a control was aimed by; None where it has the axes of its joint; `KEPT`: nobody can read it."""
    if not (record.aim or record.up or record.up_from):
        return None
    if record.up_from in (_WORLD, _MIRRORED):
        return AxisStyle(world=True) if record.up_from == _WORLD else MIRRORED
    if not {record.aim, record.up} <= _AXES or record.aim[-1:] == record.up[-1:]:
        return KEPT  # damaged ones may name one axis twice
    try:
        UpSource.read(rig, record.up_from)
    except RigtriError:
        return KEPT
    return AxisStyle(record.aim, record.up, record.up_from, held=record.held)


def with_style(record: OffsetRecord, style: AxisStyle | None) -> OffsetRecord:
    """A record that says what its control is aimed by."""
    if style == KEPT:
        return record
    style = AxisStyle("", "", "") if style is None else AxisStyle("", "", _WORLD) if style.world else style
    return replace(record, aim=style.aim, up=style.up, up_from=style.up_from, held=style.held)
