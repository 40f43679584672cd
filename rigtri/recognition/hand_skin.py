"""Whether the skin of a hand is flat where the palm is said to be: axes do not follow it, doubts do."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import sqrt

import numpy as np

from rigtri.errors import FileError
from rigtri.maths.angle_limits import cosine_below
from rigtri.maths.matrices import multiply, transform_points
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, normalise, perpendicular
from rigtri.model.mesh import Mesh, each_place
from rigtri.model.rig import Rig

# A hand is flat that is thinner than this part of its width. Of real hands with fingers the part is
# 0.3 to 0.7, of mittens 0.8 to 0.9 (as deviations from the middle of their points).
FLAT = 0.9
# … and flat skin agrees with a palm within this of it (a cosine).
AGREES = cosine_below(30)
# Fewer points are no hand.
_FEW = 8


def agrees_with_skin(rig: Rig, joints: Sequence[int], world: Floats, hinge: Floats) -> bool:
    """Whether the skin of a hand's joints, wrist first, is flat, and widest along the hinge, (3,).

    world: the pose in which both are, (n, 4, 4). False where nothing shows it. Meshes count each by itself,
    as what a hand holds may be one of them.
    """
    along = normalise(world[joints[-1], 3, :3] - world[joints[0], 3, :3])
    wide = normalise(perpendicular(hinge, along))
    if not np.isfinite(wide).all():
        return False
    return any(_is_flat(points, wide, cross(along, wide)) for points in _moved(rig, joints, world))


def _is_flat(points: Floats, wide: Floats, thick: Floats) -> bool:
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) < _FEW:
        return False
    flat = np.stack([dot(points, wide), dot(points, thick)])
    flat -= flat.cumsum(axis=1)[:, -1:] / len(points)
    wider, thicker, both = (float(k) for k in (flat[[0, 1, 0]] * flat[[0, 1, 1]]).cumsum(axis=1)[:, -1])
    # The axes of an ellipse: their difference is twice as far from the first as the longer one is turned.
    spread = sqrt((wider - thicker) ** 2 + 4.0 * both**2)
    is_flat = wider + thicker - spread < FLAT**2 * (wider + thicker + spread)
    return is_flat and wider - thicker > (2.0 * AGREES**2 - 1.0) * spread


def _moved(rig: Rig, joints: Sequence[int], world: Floats) -> Iterator[Floats]:
    """The points that joints move more than all others do, as they are in a pose, (v, 3) each."""
    try:
        meshes = [mesh for mesh in each_place(rig.content.outlines) if mesh.fits(rig.skins)]
    except FileError:
        return
    for mesh in meshes:
        if mesh.skin is None or not mesh.weights.size:
            if mesh.node in joints:
                yield transform_points(mesh.points, world[mesh.node])
        else:
            yield _skinned(rig, mesh, joints, world)


def _skinned(rig: Rig, mesh: Mesh, joints: Sequence[int], world: Floats) -> Floats:
    """As if one joint held each point, that with the most weight."""
    assert mesh.skin is not None
    skin = rig.skins[mesh.skin]
    most = np.take_along_axis(mesh.joints, mesh.weights.argmax(axis=1)[:, np.newaxis], axis=1)[:, 0]
    row = np.minimum(np.maximum(most, 0), len(skin.joints) - 1)
    held = np.isin(skin.joints[row], joints)
    row, points = row[held], transform_points(mesh.points[held], mesh.bind)
    return transform_points(points, multiply(skin.inverse_bind, world[skin.joints])[row])
