"""Changing joint frames: bind matrices, children, clips and constraints follow. Only here do frames change.

The change of frame C of a joint is a rotation seen in the joint's own old
frame: a unit quaternion per node, identity where nothing changes. With row
matrices and p the parent::

    world' = C·world          local' = C·local·Cp⁻¹
    inverse_bind' = inverse_bind·C⁻¹

and the same for every key of every clip: the map is linear and constant in
time, so LINEAR, STEP and CUBICSPLINE stay exact with the same key times;
nothing is baked or resampled.

Source: docs/exactness.md; UsdSkel and glTF 2.0 §3.7.3 (skins), appendix C.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.frames.reoriented_constraints import broken, reoriented_constraints, reoriented_metadata
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.matrices import compose, decompose, from_frame, rotate_after, rotate_before
from rigtri.maths.quaternions import IDENTITY, conjugate, from_axes, multiply, rotate, rotates, to_axes
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Column, Track, Tracks, other_rows
from rigtri.model.metadata import FrameRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin

# So many keys go through the arithmetic at once: with what comes of them they stay in the cache.
_BLOCK = 1 << 14
# Tracks with so many rows are turned one by one: to gather and to scatter them costs more than the calls.
_LONG = 1 << 11


def reframe(rig: Rig, delta: Floats, *, scales: ScaleTable | None = None) -> Rig:
    """Turn the frame of each node by ``delta``, (n, 4), in its own old frame.

    Nothing that can be seen moves. A node that itself shows a mesh, camera or
    light hands it to a new child ``<name>_payload`` that keeps the old axes. Instances of one prototype
    turn as the first of them does (`FormatRules.instances`): what is below them is the same in all.
    ValueError where a node's scale does not allow the delta: ask `ScaleTable.allows` first; and
    where constraints would no longer mean the same: ask `rigtri.frames.reoriented_constraints.broken`.
    scales: those of ``rig``, where the caller has them.
    """
    delta = rig.shared(delta)
    own = rotates(delta)
    if not own.any():
        return rig
    scales = ScaleTable.of(rig) if scales is None else scales
    refused = np.flatnonzero(own & ~scales.allows(delta)).tolist()
    if refused:
        raise ValueError(f"{[rig.title(node) for node in refused]} would shear: non-uniform scale")
    if lost := broken(rig, delta):
        names = [rig.title(constraint.node) for constraint in lost]
        raise ValueError(f"the constraints of {names} compare axes that would get different deltas")
    above = np.where((rig.parents >= 0)[:, np.newaxis], delta[rig.parents], IDENTITY)
    fold = scales.fold(delta)
    rig = _reorient_rest(rig, delta, above, fold, scales)
    rig = _reorient_skins(rig, delta)
    rig = _reorient_clips(rig, delta, above, fold, scales)
    rig = replace(
        _reorient_bound(rig, delta),
        node_constraints=reoriented_constraints(rig, delta),
        metadata=reoriented_metadata(rig, delta),
    )
    carriers = np.flatnonzero(own & (rig.attachment[: len(delta)] >= 0)).tolist()
    return hand_over_attachments(rig, carriers, conjugate(delta[carriers]), np.ones(len(carriers)))


def split(rig: Rig, deltas: Mapping[int, Floats]) -> Rig:
    """Give nodes new axes, (4,) each, although their scales forbid it: by nodes above that hold them.

    The new node ``<name>_orient`` takes the translation and rotation of its node, turned; the
    node keeps the opposite rotation and its scale: ``S·R·T = (S·C⁻¹)·(C·R·T)``. Exact for any
    scale, also one that is animated. The delta is that of the rotation R: S may mirror, C·R
    does not. Nothing below moves, no inverse bind changes.
    """
    if not deltas:
        return rig
    signs = ScaleTable.of(rig).sign
    above = rig.insert_above({node: f"{rig.names[node] or 'joint'}_orient" for node in deltas})
    translations, rotations, matrices = above.translation.copy(), above.rotation.copy(), above.matrix.copy()
    metadata, lifted = dict(above.metadata), {}
    for before, node in enumerate(sorted(deltas)):
        delta, holder, old = deltas[node], node + before, node + before + 1
        translation, rotation, scale = _parts(rig, node, signs[node])
        translations[holder], rotations[holder] = translation, multiply(rotation, delta)
        translations[old], rotations[old] = 0.0, conjugate(delta)
        # What a matrix has beside rotation and scale stays with the node.
        whole = rig.matrix[node] if rig.has_matrix[node] else compose(translation, rotation, scale)
        back = conjugate(multiply(rotation, delta))
        matrices[old] = rotate_after(from_frame(whole[:3, :3], np.zeros(3)), back)
        metadata[holder] = FrameRecord(joint=rig.address(node)).to_dict()
        lifted[old] = delta
    clips = tuple(
        replace(clip, tracks=tuple(_lifted(t, lifted) for t in clip.tracks)) for clip in above.clips
    )
    return replace(
        above, translation=translations, rotation=rotations, matrix=matrices, clips=clips, metadata=metadata
    )


def _parts(rig: Rig, node: int, sign: Floats) -> tuple[Floats, Floats, Floats]:
    """Translation, rotation and scale of a node at rest; ``sign``: which axes a matrix mirrors."""
    if not rig.has_matrix[node]:
        return rig.translation[node], rig.rotation[node], rig.scale[node]
    translation, rotation, scale = decompose(rig.matrix[node])
    axes = to_axes(rotation) * np.where(scale * sign < 0, -1.0, 1.0)[:, np.newaxis]
    return translation, from_axes(axes), np.abs(scale) * sign


def _lifted(track: Track, deltas: Mapping[int, Floats]) -> Track:
    """A track of a split node on the node above it, where it moves or rotates."""
    delta = deltas.get(track.node)
    if delta is None or track.path not in ("translation", "rotation"):
        return track
    values = multiply(track.values, delta) if track.path == "rotation" else track.values
    return replace(track, node=track.node - 1, values=values)


def _rescaled(delta: Floats, fold: Floats, scales: ScaleTable) -> Booleans:
    """Which nodes, (n,), may have other scales after their deltas; the others keep theirs to the bit."""
    return np.asarray(rotates(delta) & (scales.uneven | scales.mixed) | rotates(fold))


def _reoriented_scale(
    scale: Floats, node: Integers | int, delta: Floats, fold: Floats, scales: ScaleTable
) -> Floats:
    """Scales, (..., 3), of nodes after their deltas: permuted, unsigned, or untouched to the bit."""
    squares = to_axes(delta[node]) ** 2
    mixed = np.asarray(sum(squares[..., :, k] * scale[..., k, np.newaxis] for k in range(3)))
    folded = rotates(fold[node])[..., np.newaxis]
    parity = scales.sign[node].prod(axis=-1, keepdims=True)
    unsigned = scale * scales.sign[node] * parity
    moves = (
        rotates(delta[node])[..., np.newaxis] & (scales.uneven[node] | scales.mixed[node])[..., np.newaxis]
    )
    return np.where(folded, unsigned, np.where(moves, mixed, scale))


def _reorient_rest(rig: Rig, delta: Floats, above: Floats, fold: Floats, scales: ScaleTable) -> Rig:
    own, parents = rotates(delta)[:, np.newaxis], rotates(above)[:, np.newaxis]
    translation = np.where(parents, rotate(conjugate(above), rig.translation), rig.translation)
    rotation = np.where(own | parents, conjugate_by(above, rig.rotation, fold, delta), rig.rotation)
    # As USD's groups, which have no transform that could hold rounding.
    rotation[(rig.rotation == IDENTITY).all(1) & (delta == above).all(1) & ~rotates(fold)] = IDENTITY
    scale, rescaled = rig.scale.copy(), np.flatnonzero(_rescaled(delta, fold, scales))
    if len(rescaled):
        scale[rescaled] = _reoriented_scale(scale[rescaled], rescaled, delta, fold, scales)
    matrix, held = rig.matrix.copy(), np.flatnonzero(rig.has_matrix & (own | parents)[:, 0])
    if len(held):
        matrix[held] = rotate_after(rotate_before(delta[held], matrix[held]), conjugate(above[held]))
    return replace(
        rig,
        translation=translation,
        rotation=rotation,
        scale=scale,
        matrix=matrix,
    )


def conjugate_by(above: Floats, q: Floats, fold: Floats, delta: Floats) -> Floats:
    """Cp⁻¹·q·fold·C as quaternions; exact for values of any norm and for tangents."""
    return multiply(multiply(conjugate(above), q), multiply(fold, delta))


def _reorient_skins(rig: Rig, delta: Floats) -> Rig:
    own = rotates(delta)

    def turned(skin: Skin) -> Floats:
        moved = rotate_after(skin.inverse_bind, conjugate(delta[skin.joints]))
        return np.where(own[skin.joints][:, np.newaxis, np.newaxis], moved, skin.inverse_bind)

    skins = (skin.rebound(turned) if own[skin.ever.joints].any() else skin for skin in rig.skins)
    return replace(rig, skins=tuple(skins))


def _reorient_clips(rig: Rig, delta: Floats, above: Floats, fold: Floats, scales: ScaleTable) -> Rig:
    """Turn the keys of all clips; short columns of one kind go through the arithmetic together."""
    own, parents = rotates(delta), rotates(above)
    by_clip = [clip.columns for clip in rig.clips]
    columns = [column for some in by_clip for column in some]
    changed: dict[int, Column] = {}
    rescaled = _rescaled(delta, fold, scales)
    back, after = conjugate(above), multiply(fold, delta)

    def turned(path: str, block: Floats, nodes: Integers) -> Floats:
        if path == "translation":
            return rotate(back[nodes], block)
        if path == "rotation":
            return multiply(multiply(back[nodes], block), after[nodes])
        return _reoriented_scale(block, nodes, delta, fold, scales)

    for path, moves in (("translation", parents), ("rotation", own | parents), ("scale", rescaled)):
        moving = {k: moves[c.nodes] for k, c in enumerate(columns) if c.path == path}
        mine = [k for k, rows in moving.items() if rows.any()]
        for k in [k for k in mine if path != "scale" and columns[k].rows >= _LONG]:
            mine.remove(k)
            values = columns[k].copied()
            for track in np.flatnonzero(moving[k]).tolist():
                rows, node = values[track].reshape(-1, values.shape[-1]), columns[k].nodes[[track]]
                for first in range(0, len(rows), _BLOCK):
                    rows[first : first + _BLOCK] = turned(path, rows[first : first + _BLOCK], node)
            changed[k] = columns[k].having(values, moving[k])
        if not mine:
            continue
        flat = [_rows_of(columns[k].values, moving[k]) for k in mine]
        node = np.concatenate([np.repeat(columns[k].nodes[moving[k]], columns[k].rows) for k in mine])
        rows = np.concatenate([values.reshape(-1, values.shape[-1]) for values in flat])
        for first in range(0, len(rows), _BLOCK):
            rows[first : first + _BLOCK] = turned(
                path, rows[first : first + _BLOCK], node[first : first + _BLOCK]
            )
        start = 0
        for k, old in zip(mine, flat, strict=True):
            end = start + old.size // old.shape[-1]
            part, which = rows[start:end].reshape(old.shape), moving[k]
            start = end
            if path == "scale":  # most stay what they were, to the bit
                other = other_rows(part, old)
                which[which], part = other, part[other]
            if which.all():
                changed[k] = columns[k].having(part, which)
            elif which.any():
                values = columns[k].copied()
                values[which] = part
                changed[k] = columns[k].having(values, which)
    if not changed:
        return rig
    result = iter(changed.get(k, column) for k, column in enumerate(columns))
    clips = tuple(
        replace(clip, tracks=Tracks([next(result) for _ in some]))
        for clip, some in zip(rig.clips, by_clip, strict=True)
    )
    return replace(rig, clips=clips)


def _rows_of(values: Floats, which: Booleans) -> Floats:
    """The rows of values, (t, ...), that are named, (t,)."""
    return values if which.all() else values[which]


def _reorient_bound(rig: Rig, delta: Floats) -> Rig:
    own = rotates(delta)
    return replace(
        rig,
        bound=tuple(
            replace(b, vector=rotate(conjugate(delta[b.node]), b.vector)) if own[b.node] else b
            for b in rig.bound
        ),
    )


def hand_over_attachments(rig: Rig, carriers: Sequence[int], rotation: Floats, scale: Floats) -> Rig:
    """Give what nodes show to new children that stand so in them: rotation (k, 4), scale (k,)."""
    if not carriers:
        return rig
    shown = rig.attachment[carriers]
    attachment = rig.attachment.copy()
    attachment[carriers] = -1
    names = [f"{rig.names[node] or 'node'}_payload" for node in carriers]
    moved = replace(rig, attachment=attachment).with_nodes(
        names, carriers, np.zeros((len(carriers), 3)), rotation, shown.tolist()
    )
    scales = moved.scale.copy()
    scales[len(rig) :] = scale[:, np.newaxis]
    moved = replace(moved, scale=scales)
    return _redirect_weights(moved, dict(zip(carriers, range(len(rig), len(moved)), strict=True)))


def _redirect_weights(rig: Rig, to: dict[int, int]) -> Rig:
    """Let morph tracks drive the node that shows the mesh now."""
    clips = tuple(
        replace(
            clip,
            tracks=tuple(
                replace(t, node=to[t.node]) if t.path == "weights" and t.node in to else t
                for t in clip.tracks
            ),
        )
        for clip in rig.clips
    )
    return replace(rig, clips=clips)
