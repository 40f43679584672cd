"""How far what hangs at a node itself reaches at rest: points from the joints that move them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.matrices import multiply, transform_directions, transform_points
from rigtri.records import Integers, Mesh
from rigtri.rig import Rig
from rigtri.trigonometry import Floats
from rigtri.vectors import length


def reach_of_points(rig: Rig, world: Floats, mesh: Mesh, reach: Floats) -> None:
    """Raise ``reach``, (n,), in file units, to what the points of a mesh ask of the nodes that move them."""
    if mesh.skin is None or not mesh.joints.shape[1]:
        _raise(reach, np.full(len(mesh.points), mesh.node), mesh.points, world)
        return
    skin = rig.skins[mesh.skin]
    into = multiply(mesh.bind, skin.inverse_bind)
    with np.errstate(invalid="ignore", over="ignore"):
        # From a point to its direction from each joint, as the joint stands: rows, components, joints.
        seen = transform_directions(into[..., :3], world[skin.joints][:, np.newaxis]).transpose(1, 2, 0)
        joints, rows = mesh.moved
        points = [mesh.points[:, k][rows] for k in range(3)]
        square = np.zeros(len(rows))
        for axis in range(3):
            along = seen[3, axis][joints]
            for k in range(3):
                along += points[k] * seen[k, axis][joints]
            square += along * along
        far = np.sqrt(np.where(np.isfinite(square), square, 0.0))
    if len(joints):
        starts = np.flatnonzero(np.diff(joints, prepend=-1))
        np.maximum.at(reach, skin.joints[joints[starts]], np.maximum.reduceat(far, starts))
    if mesh.box is not None:
        corners = np.broadcast_to(mesh.box.reshape(2, -1, 3), (2, len(skin.joints), 3))
        for picked in np.ndindex(2, 2, 2):
            corner = np.stack([corners[low, :, axis] for axis, low in enumerate(picked)], axis=1)
            _raise(reach, skin.joints, transform_points(corner, into), world)


def reach_of_box(rig: Rig, world: Floats, mesh: Mesh, box: Floats, reach: Floats) -> None:
    """As `reach_of_points`, for points anywhere in a box, (2, 3), that any joint of the skin may move."""
    corners = np.array([[box[low, axis] for axis, low in enumerate(k)] for k in np.ndindex(2, 2, 2)])
    if mesh.skin is None or not mesh.joints.shape[1]:
        _raise(reach, np.full(len(corners), mesh.node), corners, world)
        return
    skin = rig.skins[mesh.skin]
    with np.errstate(invalid="ignore", over="ignore"):
        seen = transform_points(corners[:, np.newaxis], multiply(mesh.bind, skin.inverse_bind))
        far = length(transform_directions(seen, world[skin.joints]))
    np.maximum.at(reach, skin.joints, far.max(axis=0))


def is_plain(mesh: Mesh, rig: Rig) -> bool:
    """Whether a mesh has points, all of them, and only joints that its skin has."""
    if not len(mesh.points) or mesh.box is not None:
        return False
    count = 0 if mesh.skin is None else len(rig.skins[mesh.skin].joints)
    return not mesh.joints.size or (int(mesh.joints.min()) >= 0 and int(mesh.joints.max()) < count)


def part_of_mesh(mesh: Mesh, rows: Integers) -> Mesh:
    """Some points of a mesh."""
    joints, weights, morphs = mesh.joints, mesh.weights, mesh.morphs
    if joints.size:
        joints, weights = joints[rows], weights[rows]
    if morphs.size:
        morphs = morphs[:, rows]
    return replace(mesh, points=mesh.points[rows], joints=joints, weights=weights, morphs=morphs)


def _raise(reach: Floats, node: Integers, points: Floats, world: Floats) -> None:
    """points: (k, 3), each in the space of its ``node``, (k,)."""
    if len(points):
        with np.errstate(invalid="ignore", over="ignore"):
            far = length(transform_directions(points, world[node]))
        np.maximum.at(reach, node, np.where(np.isfinite(far), far, 0.0))
