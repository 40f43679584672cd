"""Changing the size of joint frames: what is in them follows, so that nothing that can be seen moves.

A frame that is s times as large as another has world' = s·world; with row matrices, p the parent::

    local' = s·local·sp⁻¹       inverse_bind' = inverse_bind·s⁻¹

so translations are multiplied by sp⁻¹ and scales by s·sp⁻¹, at rest and at every key, tangents too: linear
and constant in time. Rotations stay. An offset of a constraint becomes s·offset·sd⁻¹ for its driver d;
that of a pole vector, a place alone, its translation times sd⁻¹.
Where a format wants bind matrices of scale 1
(`FormatRules.sized_binding`), the points of a skin are bound in another size instead, as far as all of its
joints have one size.

Source: UsdSkel and glTF 2.0 §3.7.3 (skins).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from rigtri.frames.reframe import hand_over_attachments
from rigtri.frames.reoriented_constraints import reoriented_metadata
from rigtri.maths.matrices import compose, identity, inverse, multiply
from rigtri.maths.quaternions import IDENTITY, conjugate, half_turn, rotate
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot, length, triple
from rigtri.model.animation import Track
from rigtri.model.constraints import constraint_record, constraints_of
from rigtri.model.metadata import ConstraintRecord, OffsetRecord, OutputRecord, PoseReaderRecord, Record
from rigtri.model.pending_edits import Conversion
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin

# Sizes of joints that differ by no more are one, with what float32 has left of products along a chain.
SAME_SIZE = 1e-4


def rescale(rig: Rig, size: Floats) -> Rig:
    """Give the frame of each node ``size``, (n,), times the scale that it had, not 0; nothing moves.

    A negative size mirrors a frame, all three axes. Two negative scales that it leaves are half a turn.
    A node that itself shows a mesh, camera or light hands it to a new child ``<name>_payload`` of the scale
    that it had. Instances of one prototype get the size of the first of them, as in `reframe`.
    """
    size = rig.shared(size)
    if (size == 1.0).all():
        return rig
    above = np.where(rig.parents >= 0, size[rig.parents], 1.0)
    share = size / above
    matrix = rig.matrix.copy()
    matrix[:, :3, :3] *= share[:, np.newaxis, np.newaxis]
    matrix[:, 3, :3] /= above[:, np.newaxis]
    clips = tuple(
        replace(clip, tracks=tuple(_rescaled(track, above, share) for track in clip.tracks))
        for clip in rig.clips
    )
    skins, bound_sizes = list(rig.skins), dict(rig.pending.bind_sizes)
    for number, skin in enumerate(rig.skins):
        sizes = size[skin.joints]
        if (size[skin.ever.joints] == 1.0).all():
            continue
        points = np.ones(3)
        if rig.rules.sized_binding and skin.stored and (np.abs(sizes / sizes[0] - 1.0) <= SAME_SIZE).all():
            points = (_mirror(rig, skin) if sizes[0] < 0 else points) / abs(float(sizes[0]))
            bound_sizes[number] = bound_sizes.get(number, np.ones(3)) * points
        bound = np.diag([*1.0 / points, 1.0])
        skins[number] = skin.rebound(partial(_resized, bound=bound, size=size))
    smaller = replace(
        rig,
        pending=replace(rig.pending, bind_sizes=bound_sizes),
        translation=rig.translation / above[:, np.newaxis],
        scale=rig.scale * share[:, np.newaxis],
        matrix=matrix,
        skins=tuple(skins),
        clips=clips,
        metadata=_rescaled_metadata(rig, size),
        bound=tuple(
            replace(one, vector=one.vector / (np.sign if one.is_direction else np.array)(size[one.node]))
            if size[one.node] != 1.0
            else one
            for one in rig.bound
        ),
    )
    smaller = _half_turned(smaller, np.flatnonzero(share < 0).tolist())
    carriers = np.flatnonzero((size != 1.0) & (rig.attachment >= 0)).tolist()
    still = np.tile(IDENTITY, (len(carriers), 1))
    return hand_over_attachments(smaller, carriers, still, 1.0 / size[carriers])


def _mirror(rig: Rig, skin: Skin) -> Floats:
    """Which axes of the world are mirrored, (3,), from how a skin is bound to how its first joint stands.

    1 or −1 each, one or three of them −1: points that are mirrored so are bound where joints stand.
    """
    row = int(np.argmin(skin.joints))
    bound, stands = skin.bind[row, :3, :3], rig.world[skin.joints[row], :3, :3]
    alike = dot(np.nan_to_num(bound / length(bound)[:, np.newaxis]).T, stands.T)
    signs = np.where(alike < 0, -1.0, 1.0)
    if signs.prod() > 0:
        signs[np.argmin(np.abs(alike))] *= -1.0
    return signs


def _rescaled_metadata(rig: Rig, size: Floats, outside: float = 1.0) -> Mapping[int, Mapping[str, Any]]:
    """The metadata of a rig whose nodes get ``size``, (n,): what constraints and readers hold of lengths.

    Controls hold none, but scales of joints that do not rest with them: they move joints from where both
    stand in the world. outside: the size of the world.
    """
    size = np.append(size, outside)  # −1 is the parent of a root
    found: dict[int, Record] = {}
    for node, rule in constraints_of(rig).items():
        own, drivers = size[rule.child], size[list(rule.drivers)][:, np.newaxis]
        offsets = rule.offsets.copy()
        if rule.kind in ("parent", "scale"):
            offsets[:, :3, :3] *= own / drivers[..., np.newaxis]
        if rule.kind in ("parent", "polevector"):
            offsets[:, 3, :3] /= drivers
        elif rule.kind == "point":
            offsets[:, 3, :3] /= outside
        if (offsets != rule.offsets).any():
            record = constraint_record(rig, replace(rule, offsets=offsets))
            found[node] = replace(rig.records(ConstraintRecord)[node], offsets=record.offsets)
    for node, reader in rig.records(PoseReaderRecord).items():
        outputs = tuple(_rescaled_output(rig, output, size) for output in reader.outputs)
        if outputs != reader.outputs:
            found[node] = replace(reader, outputs=outputs)
    for node, offset in rig.records(OffsetRecord).items():
        joint = rig.known(offset.joint)
        if offset.scale is not None and joint is not None:
            share = size[joint] / size[rig.parents[joint]]
            found[node] = replace(offset, scale=triple(np.array(offset.scale) * share))
    return {**rig.metadata, **{node: record.to_dict() for node, record in found.items()}}


def _rescaled_output(rig: Rig, output: OutputRecord, size: Floats) -> OutputRecord:
    """What a pose reader does to a joint, in the units of the frame above that."""
    joint = rig.known(output.joint) if output.joint else None
    if joint is None or output.translation is None or size[rig.parents[joint]] == 1.0:
        return output
    return replace(output, translation=triple(np.array(output.translation) / size[rig.parents[joint]]))


def _half_turned(rig: Rig, nodes: list[int]) -> Rig:
    """The rig with rotations in place of the two negative scales of some nodes."""
    rotation, scale = rig.rotation.copy(), rig.scale.copy()
    half: dict[int, Floats] = {}
    sign: dict[int, Floats] = {}
    for node in nodes:
        signs = np.sign(scale[node])
        if np.count_nonzero(signs < 0) == 2:
            half[node], sign[node] = half_turn(signs), signs
            rotation[node], scale[node] = product(rotation[node], half[node]), np.abs(scale[node])

    def turned(track: Track) -> Track:
        if track.node in half and track.path == "rotation":
            return track.having(product(track.values, half[track.node]))
        if track.node in sign and track.path == "scale":
            return track.having(track.values * sign[track.node])
        return track

    clips = tuple(replace(clip, tracks=tuple(map(turned, clip.tracks))) for clip in rig.clips)
    return replace(rig, rotation=rotation, scale=scale, clips=clips) if half else rig


def _rescaled(track: Track, above: Floats, share: Floats) -> Track:
    if track.path == "translation" and above[track.node] != 1.0:
        return track.having(track.values / above[track.node])
    if track.path == "scale" and share[track.node] != 1.0:
        return track.having(track.values * share[track.node])
    return track


def _resized(skin: Skin, bound: Floats, size: Floats) -> Floats:
    """The inverse binds of a skin, its points bound in other sizes, (4, 4), for nodes of ``size``, (n,)."""
    return np.asarray(multiply(multiply(bound, skin.inverse_bind), _scaling(1.0 / size[skin.joints])))


def _scaling(sizes: Floats) -> Floats:
    matrices = identity(len(sizes))
    matrices[:, :3, :3] *= sizes[:, np.newaxis, np.newaxis]
    return matrices


def metadata_in_world(
    rig: Rig, rotation: Floats, size: float, turns: Floats | None = None, sizes: Floats | None = None
) -> Mapping[int, Mapping[str, Any]]:
    """The metadata of a rig in a world that is turned, (4,), and ``size`` times as large: offsets and
    directions that constraints and pose readers count in it.

    turns: (n, 4), how nodes are turned in their own axes besides. sizes: (n,), how large they are besides.
    """
    turns = np.tile(IDENTITY, (len(rig), 1)) if turns is None else turns
    turned = replace(rig, metadata=reoriented_metadata(rig, turns, conjugate(rotation)))
    return _rescaled_metadata(turned, np.ones(len(rig)) if sizes is None else sizes, 1.0 / size)


def convert(rig: Rig, conversion: Conversion) -> Rig:
    """The rig in a scene of another unit and up axis: all that stands in the world turns and scales.

    So do lengths and directions of the world that constraints and pose readers hold.
    """
    groups = rig.nodes_of("group")
    roots = (rig.parents < 0) | np.isin(rig.parents, [k for k in groups if rig.parents[k] < 0])
    roots[groups] = False  # what is in them turns
    size, rotation = conversion.size, conversion.rotation
    translation, turned, matrix = rig.translation.copy(), rig.rotation.copy(), rig.matrix.copy()
    translation[roots] = rotate(rotation, rig.translation[roots]) * size
    turned[roots] = product(rotation, rig.rotation[roots])
    matrix[roots] = multiply(rig.matrix[roots], compose(np.zeros(3), rotation, np.full(3, size)))
    scale = np.where(roots[:, np.newaxis], rig.scale * size, rig.scale)

    def moved(track: Track) -> Track:
        if not roots[track.node] or track.path == "weights":
            return track
        if track.path == "translation":
            return track.having(rotate(rotation, track.values) * size)
        turns = track.path == "rotation"
        return track.having(product(rotation, track.values) if turns else track.values * size)

    clips = tuple(replace(clip, tracks=tuple(map(moved, clip.tracks))) for clip in rig.clips)
    up = (0.0, 1.0, 0.0) if conversion.up == "y" else (0.0, 0.0, 1.0)
    made = replace(
        rig,
        metadata=metadata_in_world(rig, rotation, size),
        translation=translation,
        rotation=turned,
        scale=scale,
        matrix=matrix,
        clips=clips,
        rules=replace(rig.rules, up=up, metres_per_unit=conversion.metres),
        pending=replace(rig.pending, conversion=conversion),
    )
    # Joints that no skeleton binds are bound as they rest, which is elsewhere now.
    bound = (
        skin if skin.stored else replace(skin, inverse_bind=inverse(made.world[skin.joints]))
        for skin in made.skins
    )
    return replace(made, skins=tuple(bound))
