"""New joint frames, and everything bound to them follows. The only place where frames change.

The change of frame C of a joint is a rotation seen in the joint's own old
frame: a unit quaternion per node, identity where nothing turns. With row
matrices and p the parent::

    world' = C·world          local' = C·local·Cp⁻¹
    inverse_bind' = inverse_bind·C⁻¹

and the same for every key of every clip: the map is linear and constant in
time, so LINEAR, STEP and CUBICSPLINE stay exact with the same key times;
nothing is baked or resampled.

Source: docs/exactness.md; UsdSkel and glTF 2.0 §3.7.3 (skins), appendix C.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from rigtri.frames.constraint_transform import turned_notes
from rigtri.frames.node_constraints import broken, turned_constraints
from rigtri.maths.matrices import compose, decompose, determinant, from_frame, rotate_after, rotate_before
from rigtri.maths.quaternions import IDENTITY, conjugate, from_axes, multiply, rotate, to_axes
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.records import Booleans, Integers, Track
from rigtri.model.rig import Rig

# Scale components that differ by less (share of the largest) are one number: exporters leave
# up to 1.6e-5 of noise on characters nobody scaled. Turning them moves points by at most half
# of that times the bone's reach, a share of the size well inside the tolerance of 1e-5.
SAME_SCALE = 2e-5
# A turn this near to a signed permutation of the axes is one.
SAME_AXIS = 1e-9
# What float64 leaves beside the diagonal of a scale that was turned exactly, as a share of the scale.
LAST_BITS = 1e-12


def turned(turn: Floats) -> Booleans:
    """Which quaternions, (n, 4), turn at all: exactly the identity means no."""
    return np.asarray((turn != IDENTITY).any(axis=-1))


def reframe(rig: Rig, turn: Floats, *, scales: Scales | None = None) -> Rig:
    """Turn the frame of each node by ``turn``, (n, 4), in its own old frame.

    Nothing that can be seen moves. A node that itself shows a mesh, camera or
    light hands it to a new child ``<name>_payload`` that keeps the old axes.
    ValueError where a node's scale does not allow the turn: ask `scale_allows` first; and
    where constraints would no longer mean the same: ask `rigtri.frames.node_constraints.broken`.
    scales: those of ``rig``, where the caller has them.
    """
    own = turned(turn)
    if not own.any():
        return rig
    scales = Scales.of(rig) if scales is None else scales
    refused = np.flatnonzero(own & ~_allowed(scales, turn)).tolist()
    if refused:
        raise ValueError(f"{[rig.title(node) for node in refused]} would shear: non-uniform scale")
    if lost := broken(rig, turn):
        names = [rig.title(constraint.node) for constraint in lost]
        raise ValueError(f"the constraints of {names} compare axes that would not turn alike")
    above = np.where((rig.parents >= 0)[:, np.newaxis], turn[rig.parents], IDENTITY)
    fold = scales.fold(turn)
    rig = _turn_rest(rig, turn, above, fold, scales)
    rig = _turn_skins(rig, turn)
    rig = _turn_clips(rig, turn, above, fold, scales)
    rig = replace(
        _turn_bound(rig, turn), constraints=turned_constraints(rig, turn), notes=turned_notes(rig, turn)
    )
    return _hand_over_payload(rig, turn)


def split(rig: Rig, turns: Mapping[int, Floats]) -> Rig:
    """Give nodes new axes, (4,) each, although their scales forbid it: by nodes above that hold them.

    The new node ``<name>_orient`` takes the translation and rotation of its node, turned; the
    node keeps the opposite turn and its scale: ``S·R·T = (S·C⁻¹)·(C·R·T)``. Exact for any
    scale, also one that is animated. The turn is that of the rotation R: S may mirror, C·R
    does not. Nothing below moves, no inverse bind changes.
    """
    if not turns:
        return rig
    signs = Scales.of(rig).sign
    above = rig.insert_above({node: f"{rig.names[node] or 'joint'}_orient" for node in turns})
    translations, rotations, matrices = above.translation.copy(), above.rotation.copy(), above.matrix.copy()
    notes, lifted = dict(above.notes), {}
    for before, node in enumerate(sorted(turns)):
        turn, holder, old = turns[node], node + before, node + before + 1
        translation, rotation, scale = _parts(rig, node, signs[node])
        translations[holder], rotations[holder] = translation, multiply(rotation, turn)
        translations[old], rotations[old] = 0.0, conjugate(turn)
        # What a matrix has beside rotation and scale stays with the node.
        whole = rig.matrix[node] if rig.has_matrix[node] else compose(translation, rotation, scale)
        back = conjugate(multiply(rotation, turn))
        matrices[old] = rotate_after(from_frame(whole[:3, :3], np.zeros(3)), back)
        notes[holder] = {"v": 1, "type": "frame", "joint": rig.address(node)}
        lifted[old] = turn
    clips = tuple(
        replace(clip, tracks=tuple(_lifted(t, lifted) for t in clip.tracks)) for clip in above.clips
    )
    return replace(
        above, translation=translations, rotation=rotations, matrix=matrices, clips=clips, notes=notes
    )


def _parts(rig: Rig, node: int, sign: Floats) -> tuple[Floats, Floats, Floats]:
    """Translation, rotation and scale of a node at rest; ``sign``: which axes a matrix mirrors."""
    if not rig.has_matrix[node]:
        return rig.translation[node], rig.rotation[node], rig.scale[node]
    translation, rotation, scale = decompose(rig.matrix[node])
    axes = to_axes(rotation) * np.where(scale * sign < 0, -1.0, 1.0)[:, np.newaxis]
    return translation, from_axes(axes), np.abs(scale) * sign


def _lifted(track: Track, turns: Mapping[int, Floats]) -> Track:
    """A track of a split node on the node above it, where it moves or turns."""
    turn = turns.get(track.node)
    if turn is None or track.path not in ("translation", "rotation"):
        return track
    values = multiply(track.values, turn) if track.path == "rotation" else track.values
    return replace(track, node=track.node - 1, values=values)


def scale_allows(rig: Rig, turn: Floats) -> Booleans:
    """Which nodes can take their turn in place, (n,): C·S·C⁻¹ stays diagonal at rest and every key.

    So it does for a uniform |S|, for a signed permutation of the axes, and for
    two equal components with a turn about the third.

    Source: formats of the constraint: glTF 2.0 §3.5.3 forbids sheared nodes.
    """
    return _allowed(Scales.of(rig), turn)


@dataclass(frozen=True, eq=False)
class Scales:
    """Every scale that nodes have, at rest and at keys (tangents are scales too).

    rows: (k, 3). owner: (k,), the node of each row. sign: (n, 3), of the scale at rest.
    apart: (n, 3), how far x and y, y and z, z and x of |S| are apart at most, as a share of the largest.
    same: (n,), how far apart they may be to count as one number: `SAME_SCALE`, or less where so
    much hangs at a node that it would be seen.
    """

    rows: Floats
    owner: Integers
    sign: Floats
    apart: Floats
    same: Floats

    @staticmethod
    def of(rig: Rig) -> Scales:
        tracks = [t for clip in rig.clips for t in clip.tracks if t.path == "scale" and len(t.values)]
        sign = _signs(rig)
        rest = np.where(rig.has_matrix[:, np.newaxis], length(rig.matrix[:, :3, :3]) * sign, rig.scale)
        keys = [_scale_rows(t) for t in tracks]
        counts = np.array([1] * len(rig) + [len(rows) for rows in keys], dtype=np.int64)
        nodes = np.array([*range(len(rig)), *(t.node for t in tracks)], dtype=np.int64)
        rows, owner = np.concatenate([rest, *keys]), np.repeat(nodes, counts)
        unsigned = rows * sign[owner]
        # Of each node's rest and each of its tracks, and then of each node.
        x, y, z = unsigned.T
        sizes = np.abs(np.stack([x, y, z, x - y, y - z, z - x]))
        most = np.zeros((6, len(rig)))
        np.maximum.at(most.T, nodes, np.maximum.reduceat(sizes, np.cumsum(counts) - counts, axis=1).T)
        largest = most[:3].max(axis=0)
        apart = (most[3:] / np.where(largest == 0, 1.0, largest)).T
        return Scales(rows, owner, sign, apart, np.full(len(rig), SAME_SCALE))

    @cached_property
    def _by_owner(self) -> tuple[Integers, Integers]:
        order = np.argsort(self.owner, kind="stable")
        return order, np.searchsorted(self.owner[order], np.arange(len(self.sign) + 1))

    def of_node(self, node: int) -> Floats:
        """All scales of one node, (k, 3)."""
        order, starts = self._by_owner
        return self.rows[order[starts[node] : starts[node + 1]]]

    @cached_property
    def uneven(self) -> Booleans:
        """Which nodes, (n,), have a scale that is not uniform, beyond the noise of exporters.

        Two pairs that are alike make all three alike: otherwise a turn about either odd axis
        would be exact but not both, and a second run would find a third.
        """
        over = self.apart > self.same[:, np.newaxis]
        return np.asarray((over & over[:, [2, 0, 1]]).any(axis=1))

    @property
    def spread(self) -> Floats:
        """The largest share by which |S| of each node is not uniform, (n,)."""
        return np.asarray(self.apart.max(axis=1))

    @property
    def noise(self) -> Floats:
        """How far apart components are that count as one number, (n,): of uneven scales those of a pair."""
        alike = np.where(self.apart <= self.same[:, np.newaxis], self.apart, 0.0).max(axis=1)
        return np.where(self.uneven, alike, self.spread)

    def keeps(self, node: int, axes: Floats) -> bool:
        """Whether C·S·C⁻¹ has nothing off its diagonal for any scale of a node, up to its noise.

        axes: the rows of C, (3, 3).
        """
        rows = self.of_node(node)
        limit = max(0.5 * self.same[node], LAST_BITS) * np.abs(rows).max()
        products = axes[[0, 1, 2]] * axes[[1, 2, 0]]
        off = sum(products[:, k] * rows[:, k, np.newaxis] for k in range(3))
        return bool((np.abs(off) <= limit).all())

    @cached_property
    def mixed(self) -> Booleans:
        """Which nodes, (n,), have a scale at rest that mirrors some of their axes and not all."""
        return np.asarray((self.sign != self.sign[:, :1]).any(axis=1))

    def fold(self, turn: Floats) -> Floats:
        """Half turns (n, 4) that a uniform scale of mixed signs stands for: S = ±|S|·half turn.

        Only of nodes whose turn, (n, 4), does not map axes to axes.
        """
        half, nodes = (
            np.tile(IDENTITY, (len(turn), 1)),
            np.flatnonzero(self.mixed & ~self.uneven & turned(turn)),
        )
        if len(nodes):
            nodes = nodes[~_permutes(to_axes(turn[nodes]))]
            sign = self.sign[nodes]
            half[nodes, :3], half[nodes, 3] = sign * sign.prod(axis=1, keepdims=True) > 0, 0.0
        return half


def _signs(rig: Rig) -> Floats:
    """The signs of each node's scale at rest, (n, 3), ±1; three alike where only a matrix tells."""
    sign = np.where(rig.scale < 0, -1.0, 1.0)
    if not rig.has_matrix.any():
        return sign
    mirrored = np.where(determinant(rig.matrix) < 0, -1.0, 1.0)[:, np.newaxis]
    unsaid = rig.has_matrix[:, np.newaxis] & (sign.prod(axis=1, keepdims=True) != mirrored)
    return np.where(unsaid, mirrored, sign)


def _allowed(scales: Scales, turn: Floats) -> Booleans:
    allowed = np.ones(len(turn), dtype=bool)
    for node in np.flatnonzero(turned(turn) & scales.uneven).tolist():
        allowed[node] = scales.keeps(node, to_axes(turn[node]))
    return allowed


def _scale_rows(track: Track) -> Floats:
    """All scales of a track, (k, 3); cubic tangents as what they add over the longest interval."""
    if track.interpolation != "CUBICSPLINE":
        return track.values
    longest = float(np.diff(track.times).max(initial=0.0))
    return np.concatenate([track.values[:, 1], track.values[:, ::2].reshape(-1, 3) * longest])


def _permutes(axes: Floats) -> Booleans:
    """Which frames, (..., 3, 3), are signed permutations of the axes, (...)."""
    return np.asarray((np.abs(axes - np.rint(axes)) < SAME_AXIS).all(axis=(-1, -2)))


def _rescaled(turn: Floats, fold: Floats, scales: Scales) -> Booleans:
    """Which nodes, (n,), may have other scales after their turns; the others keep theirs to the bit."""
    return np.asarray(turned(turn) & (scales.uneven | scales.mixed) | turned(fold))


def _turned_scale(scale: Floats, node: Integers | int, turn: Floats, fold: Floats, scales: Scales) -> Floats:
    """Scales, (..., 3), of nodes after their turns: permuted, unsigned, or untouched to the bit."""
    squares = to_axes(turn[node]) ** 2
    mixed = np.asarray(sum(squares[..., :, k] * scale[..., k, np.newaxis] for k in range(3)))
    folded = turned(fold[node])[..., np.newaxis]
    parity = scales.sign[node].prod(axis=-1, keepdims=True)
    unsigned = scale * scales.sign[node] * parity
    moves = turned(turn[node])[..., np.newaxis] & (scales.uneven[node] | scales.mixed[node])[..., np.newaxis]
    return np.where(folded, unsigned, np.where(moves, mixed, scale))


def _turn_rest(rig: Rig, turn: Floats, above: Floats, fold: Floats, scales: Scales) -> Rig:
    own, parents = turned(turn)[:, np.newaxis], turned(above)[:, np.newaxis]
    translation = np.where(parents, rotate(conjugate(above), rig.translation), rig.translation)
    rotation = np.where(own | parents, _sandwich(above, rig.rotation, fold, turn), rig.rotation)
    scale, rescaled = rig.scale.copy(), np.flatnonzero(_rescaled(turn, fold, scales))
    if len(rescaled):
        scale[rescaled] = _turned_scale(scale[rescaled], rescaled, turn, fold, scales)
    matrix, held = rig.matrix.copy(), np.flatnonzero(rig.has_matrix & (own | parents)[:, 0])
    if len(held):
        matrix[held] = rotate_after(rotate_before(turn[held], matrix[held]), conjugate(above[held]))
    return replace(
        rig,
        translation=translation,
        rotation=rotation,
        scale=scale,
        matrix=matrix,
    )


def _sandwich(above: Floats, q: Floats, fold: Floats, turn: Floats) -> Floats:
    """Cp⁻¹·q·fold·C as quaternions; exact for values of any norm and for tangents."""
    return multiply(multiply(conjugate(above), q), multiply(fold, turn))


def _turn_skins(rig: Rig, turn: Floats) -> Rig:
    own = turned(turn)
    skins = []
    for skin in rig.skins:
        mine = own[skin.joints]
        if mine.any():
            moved = rotate_after(skin.inverse_bind, conjugate(turn[skin.joints]))
            keep = mine[:, np.newaxis, np.newaxis]
            skin = replace(skin, inverse_bind=np.where(keep, moved, skin.inverse_bind))
        skins.append(skin)
    return replace(rig, skins=tuple(skins))


def _turn_clips(rig: Rig, turn: Floats, above: Floats, fold: Floats, scales: Scales) -> Rig:
    """Turn the keys of all clips; tracks of one kind go through the arithmetic together."""
    own, parents = turned(turn), turned(above)
    tracks = [track for clip in rig.clips for track in clip.tracks]
    changed: dict[int, Track] = {}
    rescaled = _rescaled(turn, fold, scales)
    for path, moves in (("translation", parents), ("rotation", own | parents), ("scale", rescaled)):
        mine = [k for k, t in enumerate(tracks) if t.path == path and moves[t.node]]
        if not mine:
            continue
        width = 4 if path == "rotation" else 3
        flat = [tracks[k].values.reshape(-1, width) for k in mine]
        node = np.repeat([tracks[k].node for k in mine], [len(rows) for rows in flat])
        rows = np.concatenate(flat)
        if path == "translation":
            rows = rotate(conjugate(above[node]), rows)
        elif path == "rotation":
            rows = _sandwich(above[node], rows, fold[node], turn[node])
        else:
            rows = _turned_scale(rows, node, turn, fold, scales)
        start = 0
        for k, old in zip(mine, flat, strict=True):
            part, track = rows[start : start + len(old)], tracks[k]
            start += len(old)
            if path != "scale" or not np.array_equal(part, old):
                changed[k] = track.having(part.reshape(track.values.shape))
    if not changed:
        return rig
    after = iter(changed.get(k, track) for k, track in enumerate(tracks))
    clips = tuple(replace(clip, tracks=tuple(next(after) for _ in clip.tracks)) for clip in rig.clips)
    return replace(rig, clips=clips)


def _turn_bound(rig: Rig, turn: Floats) -> Rig:
    own = turned(turn)
    return replace(
        rig,
        bound=tuple(
            replace(b, vector=rotate(conjugate(turn[b.node]), b.vector)) if own[b.node] else b
            for b in rig.bound
        ),
    )


def _hand_over_payload(rig: Rig, turn: Floats) -> Rig:
    """Give what a turned node shows to a new child that stands as the node stood."""
    carriers = np.flatnonzero(turned(turn) & (rig.payload[: len(turn)] >= 0)).tolist()
    if not carriers:
        return rig
    shown = rig.payload[carriers]
    payload = rig.payload.copy()
    payload[carriers] = -1
    names = [f"{rig.names[node] or 'node'}_payload" for node in carriers]
    moved = replace(rig, payload=payload).with_nodes(
        names, carriers, np.zeros((len(carriers), 3)), conjugate(turn[carriers]), shown.tolist()
    )
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
