"""add-socket: a node on a joint that something can be attached to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from rigtri.errors import UsageError
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import determinant, from_frame, inverse, multiply, orthonormal_axes
from rigtri.maths.quaternions import IDENTITY, from_axes, to_axes
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, length, normalise, perpendicular
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.joint_records import joint_record
from rigtri.operations.operation import operation
from rigtri.operations.options.add_socket import AddSocketOptions as AddSocketOptions
from rigtri.operations.rigtri_nodes import given_name, refuse_taken
from rigtri.recognition.limbs import forward, upright
from rigtri.report import Report

# A place that differs by less, as a share of its distance, is the one that is there.
_SAME = 1e-6


@operation(AddSocketOptions)
def add_socket(rig: Rig, *, options: AddSocketOptions, report: Report) -> Rig:
    """The rig with a node below a joint, or with the one of that name below it in its new place.

    In glTF it is a plain node, in USD, where only joints follow joints, a joint without weight. Raises
    NameNotFoundError for a joint that is not there, UsageError for a name that another node has.
    """
    joint, name = rig.find(options.on), given_name(rig, options.name, report)
    known = [node for node in rig.children[joint] if rig.names[node] == name]
    if not known:
        refuse_taken(rig, name, parent=joint)
    place, rotation = np.array(options.at), _rotation(rig, joint, options)
    if known:
        placed = stood(rig, known[0], place, rotation)
        if placed is not rig:
            report.joints.append(joint_record(rig, known[0], "posed"))
            report.reposed = True
        return placed
    made = rig.with_nodes([name], [joint], place[np.newaxis], rotation[np.newaxis])
    node = len(rig)
    if rig.rules.sized_binding:
        local = from_frame(to_axes(rotation), place)
        skins = []
        for skin in made.skins:
            if joint in skin.joints:
                row = skin.joints.tolist().index(joint)
                bind = multiply(skin.inverse_bind[row], inverse(local))
                matrices = np.concatenate([skin.inverse_bind, bind[np.newaxis]])
                skin = with_joint(skin, node, matrices)
            skins.append(skin)
        made = replace(made, skins=tuple(skins))
    report.joints.append(joint_record(made, node, "added"))
    # Springs of VRM 0 have all that is below a joint, those of VRM 1 the joints that they list.
    if joint in rig.rules.swinging and any(one.kind == "tail" for one in rig.node_constraints):
        text = f"A spring of VRM 0 swings '{rig.title(joint)}' with all below it, so viewers swing '{name}'"
        ends = "" if rig.children[joint] else f", and '{rig.title(joint)}' towards it"
        report.warn("spring-grows", f"{text}, too{ends}: put it on a joint above, or convert to VRM 1.0")
    return made


def with_joint(skin: Skin, node: int, inverse_bind: Floats) -> Skin:
    """A skin with one more joint behind the others, which weighs nothing; inverse_bind: of all."""
    weigh = None if skin.weigh is None else partial(_and_none, skin.weigh)
    return replace(skin, joints=np.append(skin.joints, node), inverse_bind=inverse_bind, weigh=weigh)


def _and_none(weigh: Callable[[], Booleans]) -> Booleans:
    return np.append(weigh(), False)


def _rotation(rig: Rig, joint: int, options: AddSocketOptions) -> Floats:
    """The rotation of a socket, seen from its joint."""
    if options.aim is None:
        return IDENTITY
    x = normalise(np.array(options.aim))
    up = upright(rig) if options.up is None else np.array(options.up)
    if options.up is None and length(cross(x, up)) < _SAME:
        lies = length(cross(up, np.array(rig.rules.up))) > _SAME
        up = forward(rig) if lies else np.roll(up, 1)  # from y to z, from z to x
    if length(cross(x, up)) < _SAME:
        raise UsageError("--aim and --up are parallel: give another --up")
    y = normalise(perpendicular(up, x))
    # Mirrored axes of a joint come out negated: x and y are to point there once the joint has mirrored them.
    sign = -1.0 if determinant(rig.world[joint]) < 0 else 1.0
    axes = np.stack([sign * x, sign * y, cross(x, y)])
    own = orthonormal_axes(rig.world[joint])
    seen = multiply(from_frame(axes, np.zeros(3)), inverse(from_frame(own, np.zeros(3))))
    return np.asarray(from_axes(orthonormal_axes(seen)))


def stood(rig: Rig, node: int, place: Floats, rotation: Floats, size: float = 0.0) -> Rig:
    """The rig with a node in another place, seen from its parent; the same where it stands there already.

    size: what float32 has rounded, besides the way to the parent.
    """
    far = float(np.abs(rig.translation[node] - place).max())
    turn = min(float(np.abs(rig.rotation[node] - sign * rotation).max()) for sign in (1, -1))
    if far <= _SAME * max(1e-9, size, float(np.abs(place).max())) and turn <= _SAME:
        return rig
    if rig.has_matrix[node]:
        rig = rig.with_parts([node])
    translation, rotations = rig.translation.copy(), rig.rotation.copy()
    translation[node], rotations[node] = place, rotation
    matrix = rig.matrix.copy()
    matrix[node] = from_frame(to_axes(rotation), place)
    return replace(rig, translation=translation, rotation=rotations, matrix=matrix)
