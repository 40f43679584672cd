"""Clips sampled: local and world matrices, and morph weights, at given times.

Plain evaluation, the truth that everything is measured against. ``f`` is the
number of times, ``n`` of nodes. All times are evaluated in one go;
`Motion` is a clip prepared for many evaluations.

Source: glTF 2.0 §3.5.3, §3.7.3, §3.11 and appendix C; UsdSkel (joint-local S·R·T).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from rigtri.evaluation.rotations_between_keys import turned
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.matrices import compose, multiply
from rigtri.maths.quaternions import normalise, unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Column, Interpolation, Path, Track, columns
from rigtri.model.dataclass import dataclass
from rigtri.model.hierarchy import Hierarchy
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig

_NONE = np.zeros(0, dtype=np.int64)
# The last bit of a time in float32 is no more of it.
_LAST_BIT = 2.0**-23


def worlds(rig: Hierarchy, local: Floats) -> Floats:
    """World matrices, (..., n, 4, 4), of local ones of nodes."""
    many = local.ndim - 3
    to_back, to_front = (*range(3, local.ndim), 0, 1, 2), (*range(many, local.ndim), *range(many))
    # Nodes before times: what is multiplied is picked in large pieces of memory, as `Motion` lays it out.
    mine: Floats = local.transpose(to_front)
    world = np.empty(mine.shape)
    for level in rig.levels:
        parents = rig.parents[level]
        if parents[0] < 0:
            world[level] = mine[level]
        else:
            product = multiply(mine[level].transpose(to_back), world[parents].transpose(to_back))
            world[level] = product.transpose(to_front)
    return world.transpose(to_back)


def world_of(rig: Rig, node: int) -> Floats:
    """The world matrix of one node at rest, (4, 4), from it and those above it alone; −1: the world's own."""
    if node >= 0 and "world" in vars(rig):  # all are known, and the same
        return np.asarray(rig.world[node])
    line = rig.path_to_root(node)
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
    """Clips of a rig with their tracks gathered into few arrays, ready to be evaluated in blocks.

    Of many short clips most time goes into the number of arrays: they are evaluated as one.
    """

    def __init__(self, rig: Rig, *clips: Clip) -> None:
        moving = [[column for column in clip.columns if column.path != "weights"] for clip in clips]
        nodes = [np.concatenate([_NONE, *(column.nodes for column in columns)]) for columns in moving]
        self.rig = rig
        self.driven = np.flatnonzero(np.bincount(np.concatenate([_NONE, *nodes])))
        # What a clip does not drive, but another one, and no parts can say.
        kept = self.driven[rig.has_matrix[self.driven]].tolist()
        driven = [set(mine.tolist()) for mine in nodes] if kept else [set[int]() for _ in nodes]
        self.still = [[node for node in kept if node not in mine] for mine in driven]
        self.packs = [[_Pack.of(alike, self.driven) for alike in _together(columns)] for columns in moving]

    def locals_at(self, *times: ArrayLike, normalised: bool = True) -> Floats:
        """Local matrices, (f, n, 4, 4), at ``times``, (f,), of each clip, one clip after the other.

        See the function of the same name.
        """
        every = [np.atleast_1d(np.asarray(some, dtype=np.float64)) for some in times]
        spans = _spans(every)
        rig, count = self.rig, spans[-1].stop
        # Each number of a node at all times in one row of memory, and these together: see `worlds`.
        local: Floats = np.empty((len(rig), 4, 4, count)).transpose(3, 0, 1, 2)
        still = np.ones(len(rig), dtype=bool)
        still[self.driven] = False
        local[:, still] = (rig.normalised_local if normalised else rig.local)[still]
        if not len(self.driven):
            return local
        translation, rotation, scale = self.parts_at(*every)
        composed = compose(translation, normalise(rotation) if normalised else rotation, scale)
        local[:, self.driven] = composed.swapaxes(0, 1)
        for nodes, span in zip(self.still, spans, strict=True):
            if nodes:
                local[span, nodes] = rig.matrix[nodes]
        return local

    def parts_at(self, *times: Floats) -> tuple[Floats, Floats, Floats]:
        """Translations, rotations as they are stored, and scales of the ``driven`` nodes, (d, f, c) each."""
        rig, spans = self.rig, _spans(times)
        # With nodes before times, as they lie in memory.
        translation, rotation, scale = (
            self._sampled(path, values, times, spans).swapaxes(0, 1)
            for path, values in (
                ("translation", rig.translation),
                ("rotation", rig.rotation),
                ("scale", rig.scale),
            )
        )
        return translation, rotation, scale

    def _sampled(self, path: str, still: Floats, times: Sequence[Floats], spans: Sequence[slice]) -> Floats:
        """What the driven nodes have of one path, (f, d, c); ``still``, (n, c), where no track drives it."""
        parts = [
            (pack, some, span)
            for packs, some, span in zip(self.packs, times, spans, strict=True)
            for pack in packs
            if pack.path == path
        ]
        turning = [(pack, some) for pack, some, _ in parts if pack.turns]
        arcs = {
            raw: iter(turned([pack.segments(some)[:3] for pack, some in turning if pack.raw == raw], raw=raw))
            for raw in {pack.raw for pack, _ in turning}
        }
        values = [next(arcs[pack.raw]) if pack.turns else pack.sample(some) for pack, some, _ in parts]
        if len(times) == len(parts) == 1 and isinstance(parts[0][0].columns, slice):
            return values[0]
        found = _held(still[self.driven], spans[-1].stop)
        for (pack, _, span), some in zip(parts, values, strict=True):
            found[span, pack.columns] = some
        return found


def _spans(times: Sequence[Floats]) -> list[slice]:
    """Which rows are those of each of some arrays of times, one after the other."""
    ends = np.cumsum([len(some) for some in times]).tolist()
    return [slice(end - len(some), end) for some, end in zip(times, ends, strict=True)]


def sample(track: Track, times: ArrayLike) -> Floats:
    """The values of one track, (f, c), at ``times``, (f,); held beyond its first and last key."""
    pack = _Pack.of(columns([track]), np.array([track.node]))
    return pack.sample(np.atleast_1d(np.asarray(times, dtype=np.float64)))[:, 0]


def key_times(clip: Clip, nodes: Sequence[int] | None = None) -> Floats:
    """All key times of a clip, or of some nodes in it, sorted, each once."""
    every = clip.columns
    some = [c for c in every if nodes is None or not set(nodes).isdisjoint(c.nodes.tolist())]
    distinct = {id(column.times): column.times for column in some}
    return sorted_unique(np.concatenate([*distinct.values(), np.zeros(0)]))


def clip_and_time(text: str) -> tuple[str, float] | None:
    """The clip and the time that ``CLIP@TIME`` names, None for other text; the last @ splits.

    >>> clip_and_time("walk@0.5"), clip_and_time("a@b@1"), clip_and_time("walk"), clip_and_time("walk@inf")
    (('walk', 0.5), ('a@b', 1.0), None, None)
    """
    name, _, time = text.rpartition("@")
    try:
        at = float(time)
    except ValueError:
        return None
    return (name, at) if "@" in text and np.isfinite(at) else None


def thinned(times: Floats, most: int) -> Floats:
    """At most ``most`` of the times, evenly over their order, the first and last among them."""
    if len(times) <= most:
        return times
    return times[np.unique((np.arange(most) * (len(times) - 1)) // (most - 1))]


def sorted_unique(times: Floats) -> Floats:
    """Times sorted, each once, NaN as one and last: np.unique, which would import masked arrays."""
    times = np.sort(times)
    fresh = np.ones(len(times), dtype=bool)
    fresh[1:] = (times[1:] != times[:-1]) & ~np.isnan(times[:-1])
    return times[fresh]


def jumps_at(keys: Floats) -> Booleans:
    """Between which keys and the next, (k − 1,), no file has a time, where a curve jumps."""
    return np.asarray(np.diff(keys) <= _LAST_BIT * np.abs(keys[1:]))


def between_keys(keys: Floats) -> Floats:
    """Where to look at a clip: its keys, (k,), two places between each two, and beyond both ends.

    The middle is where two interpolations part most; 0.29 is where they do not happen to meet. Across a jump,
    between a key and the one just before it, no file has a time: there is nothing to look at.
    """
    keys = sorted_unique(keys[np.isfinite(keys)])
    if not len(keys):
        return np.zeros(1)
    wide = ~jumps_at(keys)
    start, span = keys[:-1][wide], np.diff(keys)[wide]
    beyond = max(1e-3, 0.1 * float(keys[-1] - keys[0]))
    ends = keys[[0, -1]] + [-beyond, beyond]
    return sorted_unique(np.concatenate([keys, start + 0.5 * span, start + 0.29 * span, ends]))


def morph_weights(mesh: Mesh, clip: Clip | None, times: Floats) -> Floats:
    """The morph weights of a mesh, (f, t), at ``times``; its own where no track drives them."""
    track = None if clip is None else clip.weights.get(mesh.node)
    if track is not None:
        return sample(track, times)
    return np.broadcast_to(mesh.morph_weights, (len(times), len(mesh.morph_weights)))


def _held(values: Floats, count: int) -> Floats:
    """What nodes have at rest, (d, c), at so many times, (count, d, c), laid out as by `_Pack.sample`."""
    held: Floats = np.empty((values.shape[1], len(values), count)).transpose()
    held[:] = values
    return held


def _together(columns: Sequence[Column]) -> list[list[Column]]:
    """Columns in groups that share path, interpolation, times and width: of two rigs, or with one key."""
    groups: dict[object, list[Column]] = {}
    for column in columns:
        # What has one key is the same at all times, whatever its time is.
        times = column.times.tobytes() if len(column.times) > 1 else b""
        alike = (column.path, column.interpolation, times, column.stored.shape[1:], column.raw)
        groups.setdefault(alike, []).append(column)
    return list(groups.values())


@dataclass(frozen=True, eq=False)
class _Pack:
    """Tracks that share path, interpolation and times, of one or more columns.

    places: where the tracks of each column stand among all. columns: where each track's node stands among
    the driven nodes. raw: as in `Track`.
    """

    path: Path
    interpolation: Interpolation
    times: Floats
    alike: Sequence[Column]
    places: Sequence[Integers]
    columns: Integers | slice
    raw: bool

    @staticmethod
    def of(alike: Sequence[Column], driven: Integers) -> _Pack:
        first = alike[0]
        nodes = np.concatenate([column.nodes for column in alike])
        order = np.argsort(nodes, kind="stable")
        place = np.empty_like(order)
        place[order] = np.arange(len(order))
        places = np.split(place, np.cumsum([len(column) for column in alike])[:-1])
        whole = np.array_equal(nodes[order], driven)
        columns = slice(None) if whole else np.searchsorted(driven, nodes[order])
        return _Pack(first.path, first.interpolation, first.times, alike, places, columns, first.raw)

    def keyed(self, keys: Integers | slice) -> Floats:
        """The values of some keys, (k, tracks, [3,] c); in memory the keys of one number lie side by side."""
        parts = [column.stored[:, keys] for column in self.alike]
        shape = parts[0].shape[1], sum(map(len, parts)), *parts[0].shape[2:]
        values: Floats = np.empty(shape[::-1]).transpose()
        for part, place in zip(parts, self.places, strict=True):
            values[:, place] = part.swapaxes(0, 1)
        return values

    @property
    def turns(self) -> bool:
        """Whether values go on turning from key to key."""
        return self.path == "rotation" and self.interpolation == "LINEAR" and len(self.times) > 1

    def sample(self, times: Floats) -> Floats:
        """Values, (f, tracks, c), at ``times``, (f,)."""
        cubic = self.interpolation == "CUBICSPLINE"
        if len(self.times) == 1:
            (values,) = self.keyed(slice(None))
            return _held(values[:, 1] if cubic else values, len(times))
        values, left, inside, span = self.segments(times)
        if self.turns:
            return turned([(values, left, inside)], raw=self.raw)[0]
        share = inside[:, np.newaxis, np.newaxis]
        if cubic:
            return _hermite(values, left, share, span[:, np.newaxis, np.newaxis], self.path)
        if self.interpolation == "STEP":
            return _taken(values, left + (inside >= 1.0))
        here, there = _taken(values, left), _taken(values, left + 1)
        return here + (there - here) * share

    def segments(self, times: Floats) -> tuple[Floats, Integers, Floats, Floats]:
        """Keys around times, (k, tracks, [3,] c); of each time the key on its left, the share of the way to
        the next one, and how far that is, (f,)."""
        keys = self.times
        left = np.clip(np.searchsorted(keys, times, side="right") - 1, 0, len(keys) - 2)
        span = keys[left + 1] - keys[left]
        inside = np.clip((times - keys[left]) / np.where(span == 0, 1.0, span), 0.0, 1.0)
        return *self._around(left), inside, span

    def _around(self, left: Integers) -> tuple[Floats, Integers]:
        """The values of the keys on both sides of times, and which of them is on the left of each, (f,)."""
        first, last = int(left.min()), int(left.max()) + 1
        if last - first < 2 * len(left):
            return self.keyed(slice(first, last + 1)), left - first
        both = np.stack([left, left + 1], axis=1).reshape(-1)
        return self.keyed(both), 2 * np.arange(len(left))


def _taken(values: Floats, rows: Integers) -> Floats:
    """Some rows of values, (k, tracks, c), in memory as they are in `_Pack`."""
    taken: Floats = np.take(values.transpose(), rows, axis=2)
    return taken.transpose()


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
