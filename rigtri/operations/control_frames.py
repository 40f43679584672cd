"""The axes of controls: aimed by themselves, whatever axes their joints have or must keep.

They are what `orient-joints` would give the joint, in the rest pose, also where a format or an extension
lets no joint have axes of its own. A joint stands to its control as ``joint_world = rest_offset ·
control_world``; both are at one place, so what is stored of the offset is a rotation.

Source: R. Katz, "Using Vector Math to Rig an Arm" (rest offset); `rigtri.operations.orient_joints`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from rigtri.maths.matrices import transform_directions
from rigtri.maths.quaternions import to_axes
from rigtri.maths.triangle import axis_of, frame
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.metadata import OffsetRecord
from rigtri.model.rig import Rig
from rigtri.operations.axis_presets import AxisStyle
from rigtri.operations.options.orient_joints import OrientJointsOptions
from rigtri.operations.orient_joints.orient import plan_frames
from rigtri.report import Report

# What a record has for axes along the world.
_WORLD = "world"


def control_axes(
    rig: Rig, joints: Sequence[int], style: AxisStyle, limbs: tuple[Any, ...], root: str | None
) -> dict[int, Floats]:
    """The axes, (3, 3) rows in the world at rest, of controls over joints; without those that have none.

    limbs: as users name them, whose hinges count. A joint whose scale is not uniform gets the nearest of its
    own axes: no others share its scale. Raises UsageError and NameNotFoundError for what ``style`` names.
    """
    free = replace(rig, rules=replace(rig.rules, fixed={}, orient_locked="", world_aligned=frozenset()))
    options = OrientJointsOptions(
        **_request(style), joints=tuple(map(rig.address, joints)), limb=limbs, pose="nodes", root=root
    )
    plan = plan_frames(free, options)
    delta = plan.policy.allowed(plan.requested.delta, plan.targets.styles, Report())
    aim, up = (style.aim[-1], style.up[-1])
    world, found = plan.targets.ref.world, dict[int, Floats]()
    for joint in plan.requested.joints:
        rows = normalise(transform_directions(to_axes(delta[joint]), world[joint]))
        # Right-handed, also over a joint that mirrors.
        found[joint] = frame(rows[axis_of(aim)[0]], rows[axis_of(up)[0]], aim_axis=aim, up_axis=up)
    return found


def _request(style: AxisStyle) -> dict[str, Any]:
    """The options that stand for a style."""
    if style.world:
        return {"world": True}
    if style.held:
        return {"preset": "maya", "aim": style.aim, "up": style.up}
    return {"aim": style.aim, "up": style.up, "up_from": style.up_from}


def stored_style(record: OffsetRecord) -> AxisStyle | None:
    """What a control was aimed by; None where it has the axes of its joint."""
    if record.up_from == _WORLD:
        return AxisStyle(world=True)
    if not record.aim:
        return None
    return AxisStyle(record.aim, record.up, record.up_from, held=record.held)


def with_style(record: OffsetRecord, style: AxisStyle | None) -> OffsetRecord:
    """A record that says what its control is aimed by."""
    if style is None or style.world:
        return replace(record, aim="", up="", up_from="" if style is None else _WORLD, held=False)
    return replace(record, aim=style.aim, up=style.up, up_from=style.up_from, held=style.held)


def frame_options(record: OffsetRecord) -> Mapping[str, Any]:
    """The options of add-controls that give another control axes of the same kind."""
    style = stored_style(record)
    if style is None:
        return {"frame": "joint"}
    given = _request(style)
    return {"preset": "vrm"} if "world" in given else given
