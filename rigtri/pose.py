"""A rig at given times: local and world matrices, skin matrices, deformed points.

Plain evaluation, the truth that everything is measured against. ``f`` is the
number of times, ``n`` of nodes. All times of a clip are evaluated in one go.

Source: glTF 2.0 §3.5.3, §3.7.3, §3.11 and appendix C; UsdSkel (joint-local S·R·T).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from rigtri.matrices import compose, inverse, multiply
from rigtri.quaternions import norm, slerp, unit
from rigtri.rig import Clip, Mesh, Rig, Skin, Track
from rigtri.trigonometry import Floats


def worlds(rig: Rig, local: Floats | None = None) -> Floats:
    """World matrices, (..., n, 4, 4), of local ones; of the rest pose unless given."""
    local = rig.local if local is None else local
    world = np.empty_like(local)
    for level in rig.levels:
        parents = rig.parents[level]
        if parents[0] < 0:
            world[..., level, :, :] = local[..., level, :, :]
        else:
            world[..., level, :, :] = multiply(local[..., level, :, :], world[..., parents, :, :])
    return world


def rest(rig: Rig, *, normalised: bool = True) -> Floats:
    """Local matrices at rest, (n, 4, 4); see `locals_at` for ``normalised``."""
    composed = _matrices(rig.translation, rig.rotation, rig.scale, normalised)
    return np.where(rig.has_matrix[:, np.newaxis, np.newaxis], rig.matrix, composed)


def locals_at(rig: Rig, clip: Clip, times: ArrayLike, *, normalised: bool = True) -> Floats:
    """Local matrices during a clip, (f, n, 4, 4), at ``times``, (f,), in the clip's unit.

    ``normalised`` makes rotations unit before they become matrices, as the
    formats mean them; without it a quaternion that is not unit scales and
    shears, as three.js and UsdSkel show it.
    """
    times = np.atleast_1d(np.asarray(times, dtype=np.float64))
    local = np.broadcast_to(rest(rig, normalised=normalised), (len(times), len(rig), 4, 4)).copy()
    driven = sorted({t.node for t in clip.tracks if t.path != "weights"})
    if not driven:
        return local
    place = {node: k for k, node in enumerate(driven)}
    parts = {
        "translation": np.repeat(rig.translation[np.newaxis, driven], len(times), axis=0),
        "rotation": np.repeat(rig.rotation[np.newaxis, driven], len(times), axis=0),
        "scale": np.repeat(rig.scale[np.newaxis, driven], len(times), axis=0),
    }
    for tracks in _together(clip):
        if tracks[0].path != "weights":
            columns = [place[track.node] for track in tracks]
            parts[tracks[0].path][:, columns] = _sample(tracks, times)
    local[:, driven] = _matrices(parts["translation"], parts["rotation"], parts["scale"], normalised)
    return local


def sample(track: Track, times: ArrayLike) -> Floats:
    """The values of one track, (f, c), at ``times``, (f,); held before the first and after the last key."""
    return _sample([track], np.atleast_1d(np.asarray(times, dtype=np.float64)))[:, 0]


def key_times(clip: Clip) -> Floats:
    """All key times of a clip, sorted, each once."""
    distinct = {id(track.times): track.times for track in clip.tracks}
    return np.unique(np.concatenate([*distinct.values(), np.zeros(0)]))


def skin_matrices(skin: Skin, world: Floats) -> Floats:
    """``inverse_bind · world`` of a skin's joints, (..., m, 4, 4): bind-pose points to world."""
    return multiply(skin.inverse_bind, world[..., skin.joints, :, :])


def bind_worlds(rig: Rig, skin: Skin) -> Floats:
    """World matrices, (n, 4, 4), with the joints of ``skin`` in its bind pose.

    The whole is placed where the skin's topmost joint stands at rest, so that
    directions of the world mean the same as at rest. Nodes outside the skin
    follow their parents. NaN for joints whose inverse bind matrix is singular.

    A scale that a file hides in all inverse binds alike (dequantisation) cancels.
    """
    place = {joint: k for k, joint in enumerate(skin.joints.tolist())}
    bind = inverse(skin.inverse_bind)
    if not place:
        return worlds(rig)
    top = min(place)
    to_world = multiply(skin.inverse_bind[place[top]], worlds(rig)[top])
    bind = multiply(bind, to_world)
    world = np.empty((len(rig), 4, 4))
    for node, parent in enumerate(rig.parents.tolist()):
        if node in place:
            world[node] = bind[place[node]]
        else:
            world[node] = multiply(rig.local[node], world[parent]) if parent >= 0 else rig.local[node]
    return world


def morph_weights(mesh: Mesh, clip: Clip | None, times: Floats) -> Floats:
    """The morph weights of a mesh, (f, t), at ``times``; its own where no track drives them."""
    for track in clip.tracks if clip is not None else ():
        if track.path == "weights" and track.node == mesh.node:
            return sample(track, times)
    return np.broadcast_to(mesh.morph_weights, (len(times), len(mesh.morph_weights)))


def deformed(mesh: Mesh, rig: Rig, world: Floats, morph: Floats) -> Floats:
    """The points of a mesh in the world, (f, v, 3).

    world: (f, n, 4, 4). morph: (f, t). Weights that do not sum to 1 are scaled
    to do so, as engines do; a point without any weight follows the first joint.
    """
    points = np.broadcast_to(mesh.points, (len(world), *mesh.points.shape))
    if morph.shape[-1] and morph.any():
        points = points + np.tensordot(morph, mesh.morphs, axes=(1, 0))
    if mesh.skin is None:
        return _through(points, world[:, mesh.node])
    skin = rig.skins[mesh.skin]
    matrices = multiply(mesh.bind, skin_matrices(skin, world))
    weights = mesh.weights / _total(mesh.weights)
    if mesh.dual_quaternion:
        return _dual_quaternion(points, matrices, mesh.joints, weights)
    moved = np.zeros(points.shape)
    for column in range(mesh.joints.shape[1]):
        live = np.flatnonzero(weights[:, column])
        if len(live):
            of = matrices[:, mesh.joints[live, column]]
            part = np.einsum("fvi,fvij->fvj", points[:, live], of[..., :3, :3]) + of[..., 3, :3]
            moved[:, live] += weights[live, column, np.newaxis] * part
    return moved


def _total(weights: Floats) -> Floats:
    total = np.abs(weights).sum(axis=1, keepdims=True)
    return np.where(total == 0, 1.0, total)


def _through(points: Floats, matrix: Floats) -> Floats:
    return np.asarray(np.einsum("fvi,fij->fvj", points, matrix[:, :3, :3]) + matrix[:, np.newaxis, 3, :3])


def _dual_quaternion(points: Floats, matrices: Floats, joints: np.ndarray, weights: Floats) -> Floats:
    """Dual-quaternion skinning without scale: blend (rotation, translation) pairs, then normalise.

    Source: L. Kavan et al., "Skinning with dual quaternions", I3D 2007.
    """
    from rigtri.matrices import decompose
    from rigtri.quaternions import multiply as product
    from rigtri.quaternions import rotate

    translation, rotation, _ = decompose(matrices)
    zero = np.zeros((*translation.shape[:-1], 1))
    dual = 0.5 * product(np.concatenate([translation, zero], axis=-1), rotation)
    first = rotation[:, joints[:, :1]]
    real, other = np.zeros((*points.shape[:-1], 4)), np.zeros((*points.shape[:-1], 4))
    for column in range(joints.shape[1]):
        q = rotation[:, joints[:, column]]
        sign = np.where((q * first[:, :, 0]).sum(axis=-1, keepdims=True) < 0, -1.0, 1.0)
        share = sign * weights[:, column, np.newaxis]
        real += share * q
        other += share * dual[:, joints[:, column]]
    size = norm(real)[..., np.newaxis]
    real, other = real / size, other / size
    move = 2.0 * product(other, real * np.array([-1.0, -1.0, -1.0, 1.0]))[..., :3]
    return rotate(real, points) + move


def _matrices(translation: Floats, rotation: Floats, scale: Floats, normalised: bool) -> Floats:
    if normalised:
        size = norm(rotation)[..., np.newaxis]
        return compose(translation, rotation / np.where(size == 0, 1.0, size), scale)
    return compose(translation, rotation, scale)


def _together(clip: Clip) -> Iterator[list[Track]]:
    """The tracks of a clip in groups that share path, interpolation, times and width."""
    groups: dict[object, list[Track]] = {}
    for track in clip.tracks:
        # Rows of different widths (morph weights) cannot lie in one array.
        alike = (track.path, track.interpolation, id(track.times), track.values.shape)
        groups.setdefault(alike, []).append(track)
    return iter(groups.values())


def _sample(tracks: list[Track], times: Floats) -> Floats:
    """Values of tracks that share path, interpolation and times, (f, tracks, c)."""
    first = tracks[0]
    keys, cubic = first.times, first.interpolation == "CUBICSPLINE"
    values = np.stack([track.values for track in tracks], axis=1)  # (k, tracks, [3,] c)
    if len(keys) == 1:
        return np.repeat(values[:, :, 1] if cubic else values, len(times), axis=0)
    left = np.clip(np.searchsorted(keys, times, side="right") - 1, 0, len(keys) - 2)
    span = keys[left + 1] - keys[left]
    inside = np.clip((times - keys[left]) / np.where(span == 0, 1.0, span), 0.0, 1.0)
    share = inside[:, np.newaxis, np.newaxis]
    if cubic:
        return _hermite(values, left, share, span[:, np.newaxis, np.newaxis], first.path)
    here, there = values[left], values[left + 1]
    if first.interpolation == "STEP":
        return np.where(share >= 1.0, there, here)
    if first.path == "rotation":
        # slerp wants unit values; their stored length travels along, as in a renderer's mixer.
        blended = slerp(unit(here), unit(there), share[..., 0])
        return blended * ((1.0 - share) * norm(here)[..., np.newaxis] + share * norm(there)[..., np.newaxis])
    return here + (there - here) * share


def _hermite(values: Floats, left: np.ndarray, share: Floats, span: Floats, path: str) -> Floats:
    """Cubic segments, glTF 2.0 appendix C.5: in-tangent, value, out-tangent per key."""
    u, uu = share, share * share
    uuu = uu * u
    point = (
        (2 * uuu - 3 * uu + 1) * values[left, :, 1]
        + span * (uuu - 2 * uu + u) * values[left, :, 2]
        + (-2 * uuu + 3 * uu) * values[left + 1, :, 1]
        + span * (uuu - uu) * values[left + 1, :, 0]
    )
    return unit(point) if path == "rotation" else point
