"""Armatures that were moved in Blender after the script of ``export-blender`` had made controls their bones.

An armature object is a node above the first joints, and there above controls, too; bind poses go along.

Source: docs/blender.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from rigtri.maths.matrices import decompose, from_frame, inverse, multiply, nearest_rotation
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.rig import Rig
from rigtri.report import Report
from rigtri.text import list_names

# Of the largest number of a matrix; less went through another program's float32.
_SAME = 1e-4
# How Blender's glTF export turns the own axes of all that its USD import has made of a file with y up.
_OTHER_AXES = from_frame([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]], np.zeros(3))


def put_back(rig: Rig, described: Rig, of: Mapping[int, int], report: Report) -> Rig:
    """The rig with its armatures where ``described`` has them, and bind poses along with them, with a notice.

    of: the nodes of ``rig`` by those of ``described``. What a clip moves stays, and so does all of another
    up axis, where the axes of nodes are others.
    """
    keyed = {track.node for clip in rig.clips for track in clip.tracks}
    if tuple(rig.rules.up) != tuple(described.rules.up):
        return rig
    moves: dict[int, Floats] = {}
    for theirs, node in of.items():
        holds = {int(rig.parents[joint]) for joint in np.flatnonzero(rig.is_joint).tolist()}
        if node in holds and not rig.is_joint[node] and keyed.isdisjoint(rig.path_to_root(node)):
            here, unmoved = rig.world[node], _unmoved(rig, described, described.world[theirs])
            if not any(_same(here, there) for there in unmoved):
                there = max(unmoved, key=lambda there: _alike(here, there))
                moves[node] = multiply(inverse(here), there)
    if not moves:
        return rig
    names = [rig.title(node) for node in moves]
    text = f"{list_names(names)} was moved in Blender, without keys: that is not taken"
    report.warn("armature-moved", f"{text}. Move the root control instead", names=names)
    for node, back in moves.items():
        rig = _placed(rig, node, multiply(rig.world[node], back))
    return _bound(rig, moves)


def _unmoved(rig: Rig, described: Rig, there: Floats) -> list[Floats]:
    """Where an armature may stand in ``rig`` that nobody has moved and that is ``there`` in ``described``.

    Blender scales what it imports of a USD file to metres, by the nodes above all others.
    """
    unit = described.rules.metres_per_unit / rig.rules.metres_per_unit
    scales = [from_frame(np.eye(3) * scale, np.zeros(3)) for scale in dict.fromkeys((1.0, unit))]
    return [multiply(multiply(axes, there), scale) for scale in scales for axes in (np.eye(4), _OTHER_AXES)]


def _same(here: Floats, there: Floats) -> bool:
    unit = float(length(there[:3, :3]).max()) or 1.0
    return bool(np.abs(here - there).max() <= _SAME * max(unit, float(np.abs(there).max())))


def _alike(here: Floats, there: Floats) -> tuple[float, float]:
    """How near two places are to each other, in axes and in size; the larger, the nearer."""
    trace = float((nearest_rotation(here) * nearest_rotation(there)).ravel().cumsum()[-1])
    sizes = [float(length(place[0, :3])) or 1.0 for place in (here, there)]
    return round(trace, 6), min(sizes) / max(sizes)  # rounding of the axes decides nothing


def _placed(rig: Rig, node: int, world: Floats) -> Rig:
    """The rig with a node at a place in the world."""
    above = int(rig.parents[node])
    place = world if above < 0 else multiply(world, inverse(rig.world[above]))
    translation, rotation, scale = rig.translation.copy(), rig.rotation.copy(), rig.scale.copy()
    matrix = rig.matrix.copy()
    matrix[node] = place
    translation[node], rotation[node], scale[node] = decompose(place)
    return replace(rig, translation=translation, rotation=rotation, scale=scale, matrix=matrix)


def _bound(rig: Rig, moves: Mapping[int, Floats]) -> Rig:
    """The rig with the bind poses of all joints below moved nodes moved along."""
    skins = []
    for skin in rig.skins:
        binds = skin.inverse_bind.copy()
        for row, joint in enumerate(skin.joints.tolist()):
            node = joint
            while node >= 0 and node not in moves:
                node = int(rig.parents[node])
            if node >= 0:
                binds[row] = multiply(inverse(moves[node]), binds[row])
        skins.append(replace(skin, inverse_bind=binds))
    return replace(rig, skins=tuple(skins))
