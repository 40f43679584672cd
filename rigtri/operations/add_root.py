"""add-root: a root joint on the ground, above all joints of a character."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rigtri.errors import NO_SKELETON, GeometryError, UsageError
from rigtri.evaluation.bind_pose import placed_bind, with_unit_rotations
from rigtri.maths.matrices import compose, from_frame, inverse, multiply, orthonormal_axes
from rigtri.maths.quaternions import conjugate, from_axes, rotate
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot, perpendicular
from rigtri.model.animation import Track
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.add_socket import with_joint
from rigtri.operations.ik_bones import with_ik_bones
from rigtri.operations.joint_records import joint_record
from rigtri.operations.operation import operation
from rigtri.operations.options.add_root import AddRootOptions as AddRootOptions
from rigtri.operations.prune_joints import weighted_joints
from rigtri.operations.rigtri_nodes import given_name
from rigtri.recognition.limbs import upright
from rigtri.recognition.one_character import listed
from rigtri.recognition.recognise import recognise
from rigtri.report import Report

# The lowest joint stands on the ground of the scene if it is no higher than this share of the height.
_ON_GROUND = 0.15
# So much of the height of a body's start a joint may be above the ground to be its root.
_LOW = 0.25


@operation(AddRootOptions)
def add_root(rig: Rig, *, options: AddRootOptions, report: Report) -> Rig:
    """The rig with a joint on the ground, with the world's axes, between a top joint and its parent.

    It is a joint of each skin that has the top joint, and moves no vertex. A joint of the name above the body
    is the root already. In USD the paths of all joints below it begin with it. GeometryError where no body is
    known, UsageError for a name that is taken.
    """
    options = replace(options, name=given_name(rig, options.name, report))
    start = rig.find(options.above) if options.above is not None else _start(rig)
    if not any(rig.is_joint[node] for node in rig.below(start)):
        raise UsageError(f"--above {rig.title(start)}: this is not a joint, and no joint is below it")
    # Where no hips are known, a root that is there is the first of the body's joints.
    is_root = options.above is None and rig.names[start] == options.name and not weighted_joints(rig)[start]
    if is_root:
        return rig if options.profile is None else with_ik_bones(rig, start, options.profile, report)
    if (root := root_above(rig, start)) >= 0 and rig.names[root] != options.name:
        report.joints.append(joint_record(rig, root, "kept", reason="is the root already"))
        return rig if options.profile is None else with_ik_bones(rig, root, options.profile, report)
    joints = [node for node in rig.path_to_root(start) if rig.is_joint[node]]
    top = start if options.above is not None or not joints else joints[-1]
    if rig.names[start] == options.name:
        raise UsageError(f"--name {options.name}: the joint below the new root has this name already")
    rig, root = _rooted(rig, top, options, report)
    return rig if options.profile is None else with_ik_bones(rig, root, options.profile, report)


def root_above(rig: Rig, start: int) -> int:
    """The joint above the first of a body that is its root, whatever its name; -1 where there is none.

    A root moves no vertex of the body itself, and stands near the ground.
    """
    weighted, up = weighted_joints(rig), upright(rig)
    low = float(dot(_ground(rig, start), up))
    most = low + _LOW * (float(dot(rig.world[start, 3, :3], up)) - low)
    above = [node for node in rig.path_to_root(start)[1:] if rig.is_joint[node] and not weighted[node]]
    return next((node for node in above if float(dot(rig.world[node, 3, :3], up)) <= most), -1)


def _rooted(rig: Rig, top: int, options: AddRootOptions, report: Report) -> tuple[Rig, int]:
    """The rig with a root joint above the top joint, and which it is."""
    for node in rig.path_to_root(top):
        if rig.names[node] == options.name and rig.is_joint[node]:
            return rig, node
        # A prim above a skeleton is no joint of it, and can be none: joints are elsewhere, of whatever name.
        if rig.names[node] == options.name and not rig.rules.sized_binding:
            return _made_joint(rig, node, top, report), node
    if (parent := rig.rules.unlisted.get(top)) is not None:
        raise GeometryError(
            f"'{rig.title(top)}' is below '{parent}', which the clips here do not list: add the root to the "
            "character, and look whether it has one"
        )
    named = [node for node in rig.beside(int(rig.parents[top])) if rig.names[node] == options.name]
    if any(rig.is_joint[node] or not rig.rules.sized_binding for node in named):
        text = f"Another node is called '{options.name}'"
        raise UsageError(f"{text}: rename it first, with rigtri rename-joints")
    # It takes the number of the top joint, which is the next one then.
    return _with_root(rig, top, options.name, report), top


def _made_joint(rig: Rig, root: int, top: int, report: Report) -> Rig:
    """The rig with a node above the top joint as a joint of its skins."""
    report.joints.append(joint_record(rig, root, "added"))
    return replace(rig, skins=_joined(rig.skins, rig, top, root, rig.world[root]))


def _joined(skins: Sequence[Skin], rig: Rig, top: int, root: int, world: Floats) -> tuple[Skin, ...]:
    """The skins that have ``top`` with the root as their last, or where none has, what is below it.

    rig: where these stand.
    """
    unit = with_unit_rotations(rig)
    found, below = [], [top] if rig.is_joint[top] else rig.below(top)
    for number, (old, skin) in enumerate(zip(rig.skins, skins, strict=True)):
        rows = {joint: row for row, joint in enumerate(old.joints.tolist())}
        if (near := next((node for node in below if node in rows), -1)) >= 0:
            # The root is bound where it stands, however the joints below it rest.
            bound = multiply(old.inverse_bind[rows[near]], placed_bind(unit, number).world[near])
            first = multiply(bound, inverse(world))
            skin = with_joint(skin, root, np.concatenate([skin.inverse_bind, first[np.newaxis]]))
        found.append(skin)
    return tuple(found)


def _start(rig: Rig) -> int:
    """The first joint of the body: its hips, where they are known."""
    layout = recognise(rig)
    if len(layout.characters) != 1:
        found = "No character is recognised here: name"
        if count := len(layout.characters):
            found = f"There are {count} characters here, {listed(rig)}: take one with --character, or name"
        raise GeometryError(f"{found} the joint below the root with --above")
    (body,) = layout.characters
    joints = [part.joint for part in body.parts if rig.is_joint[part.joint]]
    if not joints:
        raise GeometryError(
            f"{NO_SKELETON}. Add the root to the character that "
            "its clips are for: these need no root of their own"
        )
    return body.hips if body.hips >= 0 else min(joints)


def _with_root(rig: Rig, top: int, name: str, report: Report) -> Rig:
    parent = int(rig.parents[top])
    above = with_unit_rotations(rig).world[parent] if parent >= 0 else np.eye(4)
    place = _ground(rig, top)
    local = multiply(from_frame(np.eye(3), place), inverse(from_frame(orthonormal_axes(above), np.zeros(3))))
    position = multiply(from_frame(np.eye(3), place), inverse(above))[3, :3]
    still = position, from_axes(orthonormal_axes(local))
    grown = rig.insert_above({top: name})
    root, child = top, top + 1
    translation, rotation = grown.translation.copy(), grown.rotation.copy()
    translation[root], rotation[root] = still
    back = conjugate(still[1])
    translation[child] = rotate(back, rig.translation[top] - position)
    rotation[child] = product(back, rig.rotation[top])
    matrix = grown.matrix.copy()
    matrix[child] = multiply(rig.matrix[top], inverse(compose(*still, np.ones(3))))

    def seen(track: Track) -> Track:
        return _below_root(track, position, back) if track.node == child else track

    moved = tuple(replace(clip, tracks=tuple(map(seen, clip.tracks))) for clip in grown.clips)
    made = replace(
        grown,
        translation=translation,
        rotation=rotation,
        matrix=matrix,
        clips=moved,
        skins=_joined(grown.skins, rig, top, root, _world(position, still[1], above)),
    )
    report.joints.append(joint_record(made, root, "added"))
    return made


def _world(position: Floats, rotation: Floats, above: Floats) -> Floats:
    return multiply(compose(position, rotation, np.ones(3)), above)


def _ground(rig: Rig, top: int) -> Floats:
    """Below the top joint on the ground: of the scene, or as low as the lowest joint."""
    up = upright(rig)
    joints = [node for node in rig.below(top) if rig.is_joint[node]]
    heights = dot(rig.world[joints, 3, :3], up)
    low, high = float(heights.min()), float(heights.max())
    place = perpendicular(rig.world[top, 3, :3], up)
    on_ground = abs(low) <= _ON_GROUND * max(high - low, 1e-12)
    return np.asarray(place + up * (0.0 if on_ground else low))


def _below_root(track: Track, position: Floats, back: Floats) -> Track:
    """A track of the top joint, seen from the root: tangents rotate, and values move, too."""
    if track.path == "rotation":
        return track.having(product(back, track.values))
    if track.path != "translation":
        return track
    values = track.values.copy()
    if track.interpolation == "CUBICSPLINE":
        values[:, 1] -= position
    else:
        values -= position
    return track.having(rotate(back, values))
