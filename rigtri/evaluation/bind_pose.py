"""Bind poses: the world matrices of a skin's joints for which its points are as the mesh stores them."""

from __future__ import annotations

import numpy as np

from rigtri.evaluation.sampling import world_of
from rigtri.maths.matrices import multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin


def bind_worlds(rig: Rig, skin: Skin) -> Floats:
    """World matrices, (n, 4, 4), with the joints of ``skin`` in its bind pose.

    The whole is placed where the skin's topmost joint stands at rest, so that
    directions of the world mean the same as at rest. Nodes outside the skin
    follow their parents. NaN for joints whose inverse bind matrix is singular.

    A scale that a file hides in all inverse binds alike (dequantisation) cancels. Found once for a skin;
    not to be changed.
    """
    if skin not in rig.bind_poses:
        rig.bind_poses[skin] = _bind_worlds(rig, skin) if len(skin.joints) else rig.world
        rig.bind_poses[skin].flags.writeable = False
    return rig.bind_poses[skin]


def _bind_worlds(rig: Rig, skin: Skin) -> Floats:
    world = rig.local.copy()
    world[skin.joints] = bind_frames(rig, skin)
    outside = np.ones(len(rig), dtype=bool)
    outside[skin.joints] = False
    for level in rig.levels[1:]:
        follow = level[outside[level]]
        if len(follow):
            world[follow] = multiply(rig.local[follow], world[rig.parents[follow]])
    return world


def bind_frames(rig: Rig, skin: Skin) -> Floats:
    """The world matrices of the joints of ``skin``, (m, 4, 4), in its bind pose; see `bind_worlds`."""
    joints = skin.joints.tolist()
    if not joints:
        return np.zeros((0, 4, 4))
    # What holds a joint's axes is not where the skin begins: its place came with a split.
    top = min(set(joints) - rig.holders, default=min(joints))
    to_world = multiply(skin.inverse_bind[joints.index(top)], world_of(rig, top))
    return multiply(skin.bind, to_world)
