"""Bind poses: the world matrices of a skin's joints for which its points are as the mesh stores them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rigtri.evaluation.sampling import world_of
from rigtri.maths.matrices import from_frame, multiply, orthonormal_axes
from rigtri.maths.quaternions import conjugate, from_axes, norm, normalise, rotation_angle, to_axes
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.similarity_fit import AXIS_TURNS
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Track
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin

# Spaces that exporters bind in differ by quarter turns: what a topmost joint leans is less than half of one.
_LEAN = np.pi / 4
# Radians: a turn that is nearer to quarter turns is between two spaces, and no pose.
_QUARTER = np.radians(1.0)
# Radians, and shares: inverses of float32 leave as much, so that spaces that differ by less turn alike.
_ROUNDING = 3e-5
# Rotations whose length is off by more are not unit for other reasons than rounding.
_NOT_UNIT = 1e-5
# Keys farther from unit than what float32 leaves of them: UsdSkel shows these as a scale, of twice as much,
# and joints below each other add up.
_KEY_NOT_UNIT = 1e-6
# Sizes that differ by a larger share are meant: smaller ones are noise of exporters.
_UNEVEN = 0.01


def bind_worlds(rig: Rig, skin: Skin) -> Floats:
    """World matrices, (n, 4, 4), with the joints of ``skin`` in its bind pose.

    The whole is placed where the skin's topmost joint stands at rest, so that
    directions of the world mean the same as at rest. Nodes outside the skin
    follow their parents. NaN for joints whose inverse bind matrix is singular.

    A scale that a file hides in all inverse binds alike (dequantisation) cancels. Found once for a skin;
    not to be changed.
    """
    if skin not in rig.bind_poses:
        rig.bind_poses[skin] = bind_worlds_of(rig, [skin]) if len(skin.joints) else rig.world
        rig.bind_poses[skin].flags.writeable = False
    return rig.bind_poses[skin]


def bind_worlds_of(rig: Rig, skins: Sequence[Skin]) -> Floats:
    """`bind_worlds` with the joints of several skins, each in its own bind pose."""
    world = rig.local.copy()
    outside = np.ones(len(rig), dtype=bool)
    for skin in skins:
        world[skin.joints] = bind_frames(rig, skin)
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


def with_unit_rotations(rig: Rig) -> Rig:
    """The rig with rest rotations as viewers show them: what is not unit would come back as a scale."""
    off = np.abs(norm(rig.rotation) - 1.0) > _NOT_UNIT
    if not off.any() or rig.rules.raw_quaternions:
        return rig
    return replace(rig, rotation=np.where(off[:, np.newaxis], normalise(rig.rotation), rig.rotation))


def unit_rotations(tracks: Sequence[Track]) -> tuple[tuple[Track, ...], float]:
    """Tracks with rotations of length 1 where any is farther from that than rounding, and by how much."""
    found, worst = list(tracks), 0.0
    for k, track in enumerate(tracks):
        if track.path != "rotation" or track.interpolation == "CUBICSPLINE":  # tangents have any length
            continue
        off = float(np.abs(norm(track.values) - 1.0).max())
        if off > _KEY_NOT_UNIT:
            found[k], worst = replace(track, values=normalise(track.values)), max(worst, off)
    return tuple(found), worst


class PlacedBind(NamedTuple):
    """The bind pose of a skin, where it was bound.

    world: (n, 4, 4). leaning: the topmost joint, where it is left as it rests though it was bound otherwise,
    and by what angle, in radians; None where it stands as it was bound, or in a space by quarter turns from
    one that is known.
    """

    world: Floats
    leaning: tuple[int, float] | None = None


def placed_bind(rig: Rig, number: int) -> PlacedBind:
    """The bind pose of a skin as its topmost joint was bound, too, and not as that rests.

    Something that carries the skin says where the space that it is bound in stands: its mesh, a node above
    its joints, or the scene, by the exporter. It is the one that turns the whole least, and of those that
    turn it alike the one that moves it least: a character that is placed in its scene keeps its place. As
    `bind_worlds` where none is near, or the bind pose is not known.
    """
    skin = rig.skins[number]
    bound = bind_worlds(rig, skin)
    if (known := _as_bound(rig, number, bound)) is None:
        return PlacedBind(bound)
    top, frames, turns = known
    angles = rotation_angle(turns)
    least = float(angles.min())
    if not least <= _LEAN:
        beside = rotation_angle(product(turns[:, np.newaxis], conjugate(from_axes(AXIS_TURNS))))
        return PlacedBind(bound, None if beside.min() <= _QUARTER else (top, least))
    moves = length(frames[:, 3, :3] - bound[top, 3, :3])
    near = int(np.argmin(np.where(angles <= least + _ROUNDING, moves, np.inf)))
    if angles[near] <= _ROUNDING and moves[near] <= _ROUNDING * np.abs(bound[skin.joints, 3, :3]).max():
        return PlacedBind(bound)  # as it rests
    turn = from_frame(to_axes(turns[near]), np.zeros(3))
    sizes = length(frames[near][:3, :3]) / length(bound[top, :3, :3])
    # Where inverse binds hide a scale of points (dequantisation), their place is none of the scene.
    place = frames[near][3, :3] if np.abs(sizes - 1.0).max() <= _UNEVEN else bound[top, 3, :3]
    back, there = from_frame(np.eye(3), -bound[top, 3, :3]), from_frame(np.eye(3), place)
    return PlacedBind(np.asarray(multiply(bound, multiply(back, multiply(turn, there)))))


def _as_bound(rig: Rig, number: int, bound: Floats) -> tuple[int, Floats, Floats] | None:
    """The topmost joint of a skin, and its frames and turns as it was bound, in each space that may be it.

    None where the bind pose is not known.
    """
    skin = rig.skins[number]
    if not skin.stored or not len(skin.joints) or not np.isfinite(bound[skin.joints]).all():
        return None
    row = int(np.argmin(skin.joints))
    top = int(skin.joints[row])
    carriers = [*rig.path_to_root(top)[1:], *(mesh.node for mesh in rig.meshes if mesh.skin == number)]
    spaces = np.concatenate([np.eye(4)[np.newaxis], rig.world[carriers]])
    frames = multiply(skin.bind[row], spaces)
    turns = product(from_axes(orthonormal_axes(frames)), conjugate(from_axes(orthonormal_axes(bound[top]))))
    return top, frames, turns
