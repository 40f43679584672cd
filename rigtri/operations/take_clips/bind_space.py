"""The space of bind poses in a file's world, and what of it is the file's axes or where a body was put."""

from __future__ import annotations

import numpy as np

from rigtri.maths.matrices import from_frame, inverse, multiply, nearest_rotation, transform_directions
from rigtri.maths.similarity_fit import upright_turn
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle
from rigtri.model.rig import Rig

# Of the size; shorter bones have no direction and no length that counts.
SHORT = 1e-2
# Degrees. One skeleton after a DCC is off by 0.1 at most (joints that move a little against their parents),
# other characters with the same names by up to 157. At 5, the end of a limb is a tenth of its length beside.
MOST_DEGREES = 5.0


def largest_angle(ours: Floats, theirs: Floats, turn: Floats) -> float:
    """The largest angle, in degrees, between directions, (k, 3), and others that are turned by (3, 3)."""
    seen = transform_directions(theirs, from_frame(turn, np.zeros(3)))
    return float(np.degrees(angle(ours, seen)).max(initial=0.0))


def bind_poses(rig: Rig) -> dict[int, Floats]:
    """Where joints stand in their skins' bind poses, (4, 4) each."""
    found: dict[int, Floats] = {}
    for skin in rig.skins:
        if skin.stored:
            for joint, matrix in zip(skin.joints.tolist(), skin.bind, strict=True):
                if np.isfinite(matrix).all():
                    found.setdefault(joint, matrix)
    return found


def world_turns(rig: Rig, other: Rig, bind_turn: Floats) -> list[Floats]:
    """Which rotations, (3, 3), may take the world of ``other`` to that of ``rig``: its world as its bind pose
    sees it, that as the one of ``rig`` (bind_turn), and that as the world of ``rig``.
    """
    between = from_frame(bind_turn, np.zeros(3))
    return [
        np.asarray(multiply(multiply(inverse(there), between), here)[:3, :3])
        for there in (from_frame(turn, np.zeros(3)) for turn in placings(other))
        for here in (from_frame(turn, np.zeros(3)) for turn in placings(rig))
    ]


def placed(rig: Rig) -> Floats:
    """How the world sees bind poses turned, a rotation, (3, 3).

    As what stands above the topmost joints turns them, or not at all, whichever these are nearer to at rest:
    some programs bind below that node, others in the world. What is posed below the topmost tells nothing.
    """
    return placings(rig)[0]


def placings(rig: Rig) -> tuple[Floats, Floats]:
    """How the world sees bind poses turned, (3, 3), and how it would if nobody had turned the body.

    Of what stands above the topmost joints, the smallest of the 24 rotations that sets its up axis upright
    belongs to the axes of the file; all else, such as a turn about up, may be where the body was put.
    """
    binds = bind_poses(rig)
    under = rig.under(binds)
    tops = [n for n in binds if not under[n]]
    tops = [n for n in tops if np.isfinite(rig.world[n]).all() and rig.parents[n] >= 0]
    if not tops:
        return np.eye(3), np.eye(3)
    above = from_frame(nearest_rotation(rig.world[rig.parents[tops[0]]]), np.zeros(3))
    up = np.array(rig.rules.up)
    lies = upright_turn(np.rint(transform_directions(up, inverse(above))), up)
    bound = from_frame(nearest_rotation([binds[n] for n in tops]), np.zeros(3))
    rest = nearest_rotation(rig.world[tops])
    # Traces of how far each candidate is from what is seen: the larger, the nearer.
    near = [
        float((multiply(bound, turn)[:, :3, :3] * rest).ravel().cumsum()[-1]) for turn in (np.eye(4), above)
    ]
    if near[1] > near[0]:
        return np.asarray(above[:3, :3]), lies
    return np.eye(3), np.asarray(multiply(inverse(above), from_frame(lies, np.zeros(3)))[:3, :3])
