"""A rig at given times: local and world matrices, skin matrices, deformed points.

Plain evaluation, the truth that everything is measured against. ``f`` is the
number of times, ``n`` of nodes. All times asked for are evaluated in one go;
`Motion` is a clip made ready for being asked often.

Source: glTF 2.0 §3.5.3, §3.7.3, §3.11 and appendix C; UsdSkel (joint-local S·R·T).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import compose, multiply
from rigtri.maths.quaternions import conjugate, from_axes, norm, normalise, rotate, slerp, slerp_rows, unit
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Interpolation, Path, Track
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin


def worlds(rig: Rig, local: Floats) -> Floats:
    """World matrices, (..., n, 4, 4), of local ones."""
    many = local.ndim - 3
    # Nodes before times: what is multiplied is picked in large pieces of memory, as `Motion` lays it out.
    mine: Floats = local.transpose(*range(many, local.ndim), *range(many))
    world = np.empty(mine.shape)
    with np.errstate(invalid="ignore", over="ignore"):  # inf and NaN go through as they are
        for level in rig.levels:
            parents = rig.parents[level]
            world[level] = mine[level] if parents[0] < 0 else _products(mine[level], world[parents])
    return world.transpose(*range(3, local.ndim), 0, 1, 2)


def _products(a: Floats, b: Floats) -> Floats:
    """As `matrices.multiply`, to the bit, of matrices whose rows and columns come first but for one.

    a, b: (n, 4, 4, ...).
    """
    total = a[:, :, 0, np.newaxis] * b[:, np.newaxis, 0]
    for k in (1, 2, 3):
        total += a[:, :, k, np.newaxis] * b[:, np.newaxis, k]
    return np.asarray(total)


def world_of(rig: Rig, node: int) -> Floats:
    """The world matrix of one node at rest, (4, 4), from it and those above it alone; −1: the world's own."""
    if node >= 0 and "world" in vars(rig):  # all are known, and the same
        return np.asarray(rig.world[node])
    line = []
    while node >= 0:
        line.append(node)
        node = int(rig.parents[node])
    composed = compose(rig.translation[line], rig.rotation[line], rig.scale[line])
    composed[rig.has_matrix[line]] = rig.matrix[line][rig.has_matrix[line]]
    if not line:
        return np.eye(4)
    world: Floats = composed[-1]
    for matrix in composed[-2::-1]:
        world = multiply(matrix, world)
    return world


def locals_at(rig: Rig, clip: Clip, times: ArrayLike, *, normalised: bool = True) -> Floats:
    """Local matrices during a clip, (f, n, 4, 4), at ``times``, (f,), in the clip's unit.

    ``normalised`` makes rotations unit before they become matrices, as the
    formats mean them; without it a quaternion that is not unit scales and
    shears, as three.js and UsdSkel show it.
    """
    return Motion(rig, clip).locals_at(times, normalised=normalised)


class Motion:
    """A clip of a rig with its tracks gathered into few arrays, ready to be evaluated in blocks."""

    def __init__(self, rig: Rig, clip: Clip) -> None:
        tracks = [track for track in clip.tracks if track.path != "weights"]
        self.rig = rig
        self.driven = np.array(sorted({track.node for track in tracks}), dtype=np.int64)
        self.packs = [_Pack.of(alike, self.driven) for alike in _together(tracks)]

    def locals_at(self, times: ArrayLike, *, normalised: bool = True) -> Floats:
        """Local matrices, (f, n, 4, 4), at ``times``, (f,); see the function of the same name."""
        times = np.atleast_1d(np.asarray(times, dtype=np.float64))
        rig, count = self.rig, len(times)
        # Each number of a node at all times in one row of memory, and these together: see `worlds`.
        local: Floats = np.empty((len(rig), 4, 4, count)).transpose(3, 0, 1, 2)
        still = np.ones(len(rig), dtype=bool)
        still[self.driven] = False
        local[:, still] = (rig.normalised_local if normalised else rig.local)[still]
        if not len(self.driven):
            return local
        # With nodes before times, as they lie in memory.
        translation, rotation, scale = (
            self._sampled(path, values, times).swapaxes(0, 1)
            for path, values in (
                ("translation", rig.translation),
                ("rotation", rig.rotation),
                ("scale", rig.scale),
            )
        )
        composed = compose(translation, normalise(rotation) if normalised else rotation, scale)
        local[:, self.driven] = composed.swapaxes(0, 1)
        return local

    def _sampled(self, path: str, still: Floats, times: Floats) -> Floats:
        """What the driven nodes have of one path, (f, d, c); ``still``, (n, c), where no track tells it."""
        found = None
        for pack in self.packs:
            if pack.path != path:
                continue
            if pack.columns is None:
                found = pack.sample(times)
                continue
            found = _held(still[self.driven], len(times)) if found is None else found
            found[:, pack.columns] = pack.sample(times)
        return _held(still[self.driven], len(times)) if found is None else found


def sample(track: Track, times: ArrayLike) -> Floats:
    """The values of one track, (f, c), at ``times``, (f,); held beyond its first and last key."""
    pack = _Pack.of([track], np.array([track.node]))
    return pack.sample(np.atleast_1d(np.asarray(times, dtype=np.float64)))[:, 0]


def key_times(clip: Clip) -> Floats:
    """All key times of a clip, sorted, each once."""
    distinct = {id(track.times): track.times for track in clip.tracks}
    return sorted_unique(np.concatenate([*distinct.values(), np.zeros(0)]))


def sorted_unique(times: Floats) -> Floats:
    """Times sorted, each once, NaN as one and last: np.unique, which would import masked arrays."""
    times = np.sort(times)
    fresh = np.ones(len(times), dtype=bool)
    fresh[1:] = (times[1:] != times[:-1]) & ~np.isnan(times[:-1])
    return times[fresh]


def between_keys(keys: Floats) -> Floats:
    """Where to look at a clip: its keys, (k,), two places between each two, and beyond both ends.

    The middle is where two interpolations part most; 0.29 is where they do not happen to meet.
    """
    keys = sorted_unique(keys[np.isfinite(keys)])
    if not len(keys):
        return np.zeros(1)
    span = np.diff(keys)
    beyond = max(1e-3, 0.1 * float(keys[-1] - keys[0]))
    ends = keys[[0, -1]] + [-beyond, beyond]
    return sorted_unique(np.concatenate([keys, keys[:-1] + 0.5 * span, keys[:-1] + 0.29 * span, ends]))


def skin_matrices(skin: Skin, world: Floats) -> Floats:
    """``inverse_bind · world`` of a skin's joints, (..., m, 4, 4): bind-pose points to world."""
    return multiply(skin.inverse_bind, world[..., skin.joints, :, :])


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


def morph_weights(mesh: Mesh, clip: Clip | None, times: Floats) -> Floats:
    """The morph weights of a mesh, (f, t), at ``times``; its own where no track drives them."""
    for track in clip.tracks if clip is not None else ():
        if track.path == "weights" and track.node == mesh.node:
            return sample(track, times)
    return np.broadcast_to(mesh.morph_weights, (len(times), len(mesh.morph_weights)))


def normalised_weights(mesh: Mesh) -> Floats:
    """How much of each point each of its joints moves, (v, k), summing to 1 in absolute value.

    A point without any weight follows its first joint, as in engines; NaN stays NaN.
    """
    columns = np.abs(mesh.weights).T
    total = np.zeros((len(mesh.weights), 1))
    for column in columns:
        total[:, 0] += column
    first = np.zeros(mesh.weights.shape[1])
    first[:1] = 1.0
    if total.all():  # NaN is any
        return np.asarray(mesh.weights / total)
    return np.where(total == 0, first, mesh.weights / np.where(total == 0, 1.0, total))


def deformed(mesh: Mesh, rig: Rig, world: Floats, morph: Floats) -> Floats:
    """The points of a mesh in the world, (f, v, 3).

    world: (f, n, 4, 4). morph: (f, t). Weights that do not sum to 1 are scaled
    to do so, as engines do; see `normalised_weights`. IndexError for a joint the skin does not have.
    """
    points = np.broadcast_to(mesh.points, (len(world), *mesh.points.shape))
    if morph.shape[-1] and morph.any():
        points = points + np.tensordot(morph, mesh.morphs, axes=(1, 0))
    if mesh.skin is None or not mesh.joints.shape[1]:
        return _through(points, world[:, mesh.node])
    matrices = multiply(mesh.bind, skin_matrices(rig.skins[mesh.skin], world))
    weights = normalised_weights(mesh)
    if mesh.dual_quaternion:
        return _dual_quaternion(points, matrices, mesh.joints, weights)
    if points.strides[0] == 0:  # no morph: the same points at all times
        return _blended(mesh.points, matrices, mesh.joints, weights)
    moved = np.zeros(points.shape)
    for column in range(mesh.joints.shape[1]):
        live = np.flatnonzero(weights[:, column])
        if len(live):
            of = matrices[:, mesh.joints[live, column]]
            part = np.einsum("fvi,fvij->fvj", points[:, live], of[..., :3, :3]) + of[..., 3, :3]
            moved[:, live] += weights[live, column, np.newaxis] * part
    return moved


def _blended(points: Floats, matrices: Floats, joints: Integers, weights: Floats) -> Floats:
    """Points, (v, 3), blended linearly at all times, (f, v, 3): joint by joint, all of its points at once.

    A point takes nothing from a joint without weight, also where that is not a number.
    """
    times = len(matrices)
    if times == 1:
        return _blended_once(points, matrices[0], joints, weights)[np.newaxis]
    # Row i of a joint's matrices at all times side by side: what coordinate i is multiplied by.
    beside = matrices[..., :3].transpose(1, 2, 0, 3).reshape(matrices.shape[1], 4, times * 3)
    moved = np.zeros((len(points), times * 3))
    for column in range(joints.shape[1]):
        order = np.argsort(joints[:, column], kind="stable")
        order = order[weights[order, column] != 0]
        of = joints[order, column]
        edges = [*np.flatnonzero(np.diff(of, prepend=-1)).tolist(), len(of)]
        for start, end in pairwise(edges):
            rows, matrix = order[start:end], beside[of[start]]
            part = matrix[3] + points[rows, 0, np.newaxis] * matrix[0]
            part += points[rows, 1, np.newaxis] * matrix[1]
            part += points[rows, 2, np.newaxis] * matrix[2]
            part *= weights[rows, column, np.newaxis]
            moved[rows] += part
    return moved.reshape(len(points), times, 3).transpose(1, 0, 2)


def _blended_once(points: Floats, matrices: Floats, joints: Integers, weights: Floats) -> Floats:
    """As `_blended` at one time, matrices (m, 4, 4) → (v, 3): column by column, each point with its own."""
    beside = np.ascontiguousarray(matrices[..., :3].transpose(1, 2, 0))
    coordinates = np.ascontiguousarray(points.T)
    moved = np.zeros((3, len(points)))
    for column in range(joints.shape[1]):
        weight = weights[:, column]
        live = weight != 0
        if not live.any():
            continue
        some = slice(None) if live.all() else np.flatnonzero(live)
        of, share, mine = joints[some, column], weight[some], [each[some] for each in coordinates]
        for axis in range(3):
            part = beside[3, axis][of]
            for k in range(3):
                part += mine[k] * beside[k, axis][of]
            moved[axis][some] += part * share
    return moved.T


def _through(points: Floats, matrix: Floats) -> Floats:
    return np.asarray(np.einsum("fvi,fij->fvj", points, matrix[:, :3, :3]) + matrix[:, np.newaxis, 3, :3])


def _dual_quaternion(points: Floats, matrices: Floats, joints: Integers, weights: Floats) -> Floats:
    """Dual-quaternion skinning: points stretched by each joint's scale, blended linearly, then
    moved by the blend of (rotation, translation) pairs.

    Source: L. Kavan et al., "Skinning with dual quaternions", I3D 2007; UsdSkel, which
    adds the scale and blends on the side of the heaviest joint.
    """
    stretch, rotation = _polar(matrices[..., :3, :3])
    zero = np.zeros((*rotation.shape[:-1], 1))
    translation = np.concatenate([matrices[..., 3, :3], zero], axis=-1)
    dual = 0.5 * product(translation, rotation)
    heaviest = np.argmax(np.abs(weights), axis=1)
    pivot = rotation[:, joints[np.arange(len(joints)), heaviest]]
    real, other = np.zeros((*points.shape[:-1], 4)), np.zeros((*points.shape[:-1], 4))
    stretched = np.zeros(points.shape)
    for column in range(joints.shape[1]):
        of, share = joints[:, column], weights[:, column, np.newaxis]
        stretched += share * np.einsum("fvi,fvij->fvj", points, stretch[:, of])
        # q and −q are one rotation; on one side of the pivot they blend along the short way.
        q = rotation[:, of]
        share = share * np.where((q * pivot).sum(axis=-1, keepdims=True) < 0, -1.0, 1.0)
        real += share * q
        other += share * dual[:, of]
    size = norm(real)[..., np.newaxis]
    real, other = real / size, other / size
    return rotate(real, stretched) + 2.0 * product(other, conjugate(real))[..., :3]


def _polar(linear: Floats) -> tuple[Floats, Floats]:
    """Linear maps (..., 3, 3) as a symmetric stretch and then a rotation xyzw, (..., 4).

    A mirrored map has a negative stretch. NaN for maps that are not numbers.
    """
    fit = np.isfinite(linear).all(axis=(-1, -2)).reshape(*linear.shape[:-2], 1, 1)
    whole = np.where(fit, linear, np.eye(3))
    squares, axes = np.linalg.eigh(whole @ whole.swapaxes(-1, -2))
    sign = np.where(np.linalg.det(whole) < 0, -1.0, 1.0).reshape(*linear.shape[:-2], 1, 1)
    sizes = np.sqrt(np.maximum(squares, 0.0))[..., np.newaxis, :] * sign
    turned = axes.swapaxes(-1, -2)
    stretch = (axes * sizes) @ turned
    with np.errstate(divide="ignore", invalid="ignore"):
        rotation = from_axes((axes / sizes) @ turned @ whole)
    return np.where(fit, stretch, np.nan), np.where(fit[..., 0], rotation, np.nan)


def _held(values: Floats, count: int) -> Floats:
    """What nodes have at rest, (d, c), at so many times, (count, d, c), laid out as by `_Pack.sample`."""
    held: Floats = np.empty((values.shape[1], len(values), count)).transpose()
    held[:] = values
    return held


def _together(tracks: list[Track]) -> list[list[Track]]:
    """Tracks in groups that share path, interpolation, times and width."""
    groups: dict[object, list[Track]] = {}
    content: dict[int, bytes] = {}
    for track in tracks:
        # What has one key is the same at all times, whatever its time is.
        times = content.get(id(track.times))
        if times is None:
            times = content[id(track.times)] = track.times.tobytes() if len(track.times) > 1 else b""
        alike = (track.path, track.interpolation, times, track.values.shape)
        groups.setdefault(alike, []).append(track)
    return list(groups.values())


@dataclass(frozen=True, eq=False)
class _Pack:
    """Tracks that share path, interpolation and times: values (k, tracks, [3,] c).

    columns: where each track's node stands among the driven nodes, None for all of them in order.
    Each number of a node at all keys is in one row of memory.
    """

    path: Path
    interpolation: Interpolation
    times: Floats
    values: Floats
    columns: Integers | None

    @staticmethod
    def of(tracks: list[Track], driven: Integers) -> _Pack:
        tracks = sorted(tracks, key=lambda track: track.node)
        first = tracks[0]
        shape = len(first.values), len(tracks), *first.values.shape[1:]
        values: Floats = np.empty(shape[::-1]).transpose()
        end_to_end = np.concatenate([track.values for track in tracks])
        values[:] = end_to_end.reshape(len(tracks), *first.values.shape).swapaxes(0, 1)
        nodes = np.array([track.node for track in tracks])
        columns = None if np.array_equal(nodes, driven) else np.searchsorted(driven, nodes)
        return _Pack(first.path, first.interpolation, first.times, values, columns)

    def sample(self, times: Floats) -> Floats:
        """Values, (f, tracks, c), at ``times``, (f,)."""
        keys, cubic = self.times, self.interpolation == "CUBICSPLINE"
        if len(keys) == 1:
            return np.repeat(self.values[:, :, 1] if cubic else self.values, len(times), axis=0)
        left = np.clip(np.searchsorted(keys, times, side="right") - 1, 0, len(keys) - 2)
        span = keys[left + 1] - keys[left]
        inside = np.clip((times - keys[left]) / np.where(span == 0, 1.0, span), 0.0, 1.0)
        share = inside[:, np.newaxis, np.newaxis]
        if cubic:
            return _hermite(self.values, left, share, span[:, np.newaxis, np.newaxis], self.path)
        if self.path == "rotation" and self.interpolation == "LINEAR":
            return _turned(self.values, left, inside)
        here, there = _taken(self.values, left), _taken(self.values, left + 1)
        if self.interpolation == "STEP":
            return np.where(share >= 1.0, there, here)
        return here + (there - here) * share


def _taken(values: Floats, rows: Integers) -> Floats:
    """Some rows of values, (k, tracks, c), in memory as they are in `_Pack`."""
    taken: Floats = np.take(values.transpose(), rows, axis=2)
    return taken.transpose()


def _turned(values: Floats, left: Integers, inside: Floats) -> Floats:
    """Turns, (f, t, 4), between keys ``left`` and the next ones of values, (k, t, 4)."""
    share = inside[:, np.newaxis, np.newaxis]
    first, last = int(left.min()), int(left.max()) + 1
    if last - first >= len(left):
        return _turn_between(_taken(values, left), _taken(values, left + 1), share)
    values, left = values[first : last + 1], left - first  # times are more than keys
    size = norm(values)[..., np.newaxis]
    with np.errstate(divide="ignore", invalid="ignore"):
        turns = values / size
        blended = slerp_rows(turns[:-1], turns[1:], left, inside)
    return blended * ((1.0 - share) * size[left] + share * size[left + 1])


def _turn_between(here: Floats, there: Floats, share: Floats) -> Floats:
    """slerp wants unit values; their stored length travels along, as in a renderer's mixer."""
    size, end = norm(here)[..., np.newaxis], norm(there)[..., np.newaxis]
    with np.errstate(divide="ignore", invalid="ignore"):
        blended = slerp(here / size, there / end, share[..., 0])
    return blended * ((1.0 - share) * size + share * end)


def _hermite(values: Floats, left: Integers, share: Floats, span: Floats, path: str) -> Floats:
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
