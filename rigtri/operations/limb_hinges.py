"""How joints that make-limb builds roll: by the hinge, carried from bone to bone, or as --up-from says."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from rigtri.errors import UsageError
from rigtri.maths.triangle import axis_of
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, normalise, perpendicular
from rigtri.model.metadata import LimbRecord
from rigtri.model.rig import Rig
from rigtri.operations.option_kinds import vector
from rigtri.operations.orient_joints.up_direction import crossing, transport_up


def transported(normal: Floats, before: Floats, aim: Floats) -> Floats:
    """What goes from a bone to the next without rolling, across that one."""
    turned = transport_up(normal, normalise(before), normalise(aim))
    across = perpendicular(turned, aim)
    return normalise(across) if np.isfinite(across).all() and crossing(turned, aim) else normal


def joints_of_limb(rig: Rig, title: str) -> list[int]:
    """The joints of a limb that an earlier run has made, root first."""
    parts = {node: limb.part for node, limb in rig.records(LimbRecord).items() if limb.limb == title}
    return sorted(parts, key=lambda node: (parts[node], node))


def hinge_from(rig: Rig, joint: int, bone: Floats) -> Floats | None:
    """The hinge of the limb that a joint is of, carried to a bone, (3,), of its own or of a child.

    None where no such limb is known.
    """
    records = rig.records(LimbRecord)
    if joint not in records:
        return None
    joints = joints_of_limb(rig, records[joint].limb)
    seen = records[joints[0]].hinge
    if seen is None or len(joints) < 2:
        return None
    x, y, z = normalise(rig.world[joints[0], :3, :3])
    hinge = seen[0] * x + seen[1] * y + seen[2] * z
    places = rig.world[joints, 3, :3]
    bones = [*(places[1:] - places[:-1]), places[-1] - places[-2]]
    for before, aim in pairwise([*bones[: joints.index(joint) + 1], bone]):
        hinge = transported(hinge, before, aim)
    return hinge if crossing(hinge, bone) else None


def up_direction(aim: Floats, normal: Floats, source: str) -> Floats:
    """The direction of the up axis: the hinge, the side the limb bends to, or one of the world."""
    if source == "plane":
        return normal
    if source == "pole":
        return cross(aim, normal)
    kind, _, text = source.partition(":")
    try:
        if kind == "vector":
            return np.array(vector(text))
        if kind == "world":
            letter, sign = axis_of(text)
            return np.asarray(sign * np.eye(3)[letter])
    except ValueError as error:
        raise UsageError(f"--up-from {source}: {error}") from error
    raise UsageError(f"--up-from {source} is none of plane, pole, world:AXIS and vector:X,Y,Z")
