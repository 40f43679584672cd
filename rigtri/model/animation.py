"""Animation: tracks of nodes over time, and the clips that they form.

A clip of a character has hundreds of tracks, and most share few arrays of key times. `columns` has those
that do in one array each, in which all of them are read, changed and compared at once.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Sequence
from dataclasses import field, replace
from functools import cached_property
from itertools import chain, repeat
from operator import itemgetter
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import NDArray

from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.trigonometry import Floats
from rigtri.model.dataclass import dataclass

Path = Literal["translation", "rotation", "scale", "weights"]
# What places a node.
PATHS: tuple[Path, ...] = ("translation", "rotation", "scale")
Interpolation = Literal["LINEAR", "STEP", "CUBICSPLINE"]
# Of a tangent times its time to the next key, so much at most is between the two.
_TANGENT = 4.0 / 27.0
# So many keys of all tracks are put in order at once.
_BLOCK = 1 << 8
# So many numbers of some tracks are looked at at once.
_PART = 1 << 19


@dataclass(frozen=True, eq=False)
class Track:
    """One property of one node over the time of a clip.

    times: shape (k,), increasing. values: (k, c), for CUBICSPLINE (k, 3, c):
    in-tangent, value, out-tangent. Tracks of a clip that share their times
    share the array, which is what makes sampling them together cheap. unlisted: columns of weights
    that the file has no word for, which are what they are at rest. raw: rotations play as OpenUSD
    interpolates arrays of joints, of numbers as they are stored (`gf_slerp`).
    """

    node: int
    path: Path
    interpolation: Interpolation
    times: Floats
    values: Floats
    key: Hashable = None
    unlisted: frozenset[int] = frozenset()
    raw: bool = False

    def __init__(
        self,
        node: int,
        path: Path,
        interpolation: Interpolation,
        times: Floats,
        values: Floats,
        key: Hashable = None,
        unlisted: frozenset[int] = frozenset(),
        raw: bool = False,
    ) -> None:
        # That of a frozen dataclass sets field by field, which takes thrice as long, and clips have hundreds.
        vars(self).update(
            node=node,
            path=path,
            interpolation=interpolation,
            times=times,
            values=values,
            key=key,
            unlisted=unlisted,
            raw=raw,
        )

    @property
    def stored(self) -> NDArray[np.floating[Any]]:
        """The values as the file has them, which may be in single or half precision: to compare them."""
        return np.asarray(vars(self)["values"])

    def having(self, values: Floats) -> Track:
        """The track with other values; `replace` takes twice as long, and clips have hundreds."""
        known = self.node, self.path, self.interpolation, self.times
        return Track(*known, values, self.key, self.unlisted, self.raw)


class _StoredTrack(Track):
    """A track whose values are in the file's precision, until somebody asks for them."""

    @property
    def values(self) -> Floats:
        known: dict[str, Any] = vars(self)
        if "double" not in known:
            known["double"] = np.asarray(known["values"], dtype=np.float64)
        found: Floats = known["double"]
        return found


@dataclass(frozen=True, eq=False)
class Column:
    """Tracks of a clip that share path, interpolation and key times, in one array of values, (t, k, [3,] c).

    stored: the values as the file has them, which may be in single or half precision: clips of minutes take
    half of the memory. times: (k,). nodes: (t,). keys, own_times: `Track.key` and `Track.times` of each; the
    latter may be other arrays with the same numbers. places: where each stands among the tracks of the clip.
    tracks: those that were read, by their row. raw: as in `Track`.
    """

    path: Path
    interpolation: Interpolation
    times: Floats
    nodes: Integers
    stored: NDArray[np.floating[Any]]
    keys: Sequence[Hashable]
    own_times: Sequence[Floats]
    places: Sequence[int]
    unlisted: frozenset[int] = frozenset()
    tracks: dict[int, Track] = field(default_factory=dict)
    raw: bool = False

    def __len__(self) -> int:
        return len(self.nodes)

    @property
    def values(self) -> Floats:
        """The values in double precision; made anew each time where they are not stored so."""
        return np.asarray(self.stored) if self.stored.dtype == np.float64 else self.copied()

    def copied(self) -> Floats:
        """The values in double precision, in an array of their own."""
        whole: Floats = np.empty(self.stored.shape)
        for first in range(0, whole.shape[1], _BLOCK):  # some keys of all tracks stay in the cache
            whole[:, first : first + _BLOCK] = self.stored[:, first : first + _BLOCK]
        return whole

    @property
    def key_values(self) -> Floats:
        """The values at the keys, (t, k, c), without the tangents of splines."""
        values = self.values
        return values[:, :, 1] if self.interpolation == "CUBICSPLINE" else values

    def at_keys(self, keys: Sequence[int]) -> Floats:
        """The same at some keys alone, (t, len(keys), c)."""
        some = self.stored[:, keys]
        return np.asarray(some[:, :, 1] if self.interpolation == "CUBICSPLINE" else some, dtype=np.float64)

    @property
    def rows(self) -> int:
        """How many values, (c,), each track has: of splines, three a key."""
        return int(self.stored[0].size) // int(self.stored.shape[-1])

    def parts(self) -> Iterator[tuple[slice, Floats]]:
        """The key values of some tracks after the other, (t, k, c), and which rows those are."""
        step = max(1, _PART // max(self.stored[:1].size, 1))
        for first in range(0, len(self), step):
            some = self.stored[first : first + step]
            keys = some[:, :, 1] if self.interpolation == "CUBICSPLINE" else some
            yield slice(first, first + step), np.asarray(keys, dtype=np.float64)

    def track(self, row: int) -> Track:
        """One of the tracks; its values are a part of the column's."""
        if row not in self.tracks:
            kind = Track if self.stored.dtype == np.float64 else _StoredTrack
            self.tracks[row] = kind(
                int(self.nodes[row]),
                self.path,
                self.interpolation,
                self.own_times[row],
                self.stored[row],
                self.keys[row],
                self.unlisted,
                self.raw,
            )
        return self.tracks[row]

    def having(self, values: Floats, changed: Booleans) -> Column:
        """The column with other values, in rows that are ``changed``, (t,)."""
        same = {row: track for row, track in self.tracks.items() if not changed[row]}
        return replace(self, stored=values, tracks=same)

    def moved(self, place: Integers) -> Column | None:
        """The column on other nodes: ``place``, (n,), has where each went, −1 for those that are left out."""
        nodes = place[self.nodes]
        rows = np.flatnonzero(nodes >= 0)
        if len(rows) == len(nodes):
            return replace(self, nodes=nodes, tracks={})
        if not len(rows):
            return None
        return replace(
            self,
            nodes=nodes[rows],
            stored=self.stored[rows],
            keys=[self.keys[row] for row in rows.tolist()],
            own_times=[self.own_times[row] for row in rows.tolist()],
            places=[self.places[row] for row in rows.tolist()],
            tracks={},
        )


class Tracks(Sequence[Track]):
    """The tracks of columns in the order of their places, made when one is read."""

    def __init__(self, columns: Iterable[Column]) -> None:
        self.columns = tuple(columns)

    @cached_property
    def _all(self) -> tuple[Track, ...]:
        placed = (zip(c.places, repeat(c), range(len(c))) for c in self.columns)
        return tuple(c.track(row) for _, c, row in sorted(chain(*placed), key=itemgetter(0)))

    def __len__(self) -> int:
        return sum(map(len, self.columns))

    def __iter__(self) -> Iterator[Track]:
        return iter(self._all)

    @overload
    def __getitem__(self, index: int) -> Track: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Track, ...]: ...
    def __getitem__(self, index: Any) -> Any:
        return self._all[index]


def other_rows(a: NDArray[Any], b: NDArray[Any]) -> Booleans:
    """Which rows of two arrays of one shape, (t, ...), are not the same, (t,)."""
    return np.asarray((a != b).reshape(len(a), -1).any(axis=1))


def columns(tracks: Sequence[Track]) -> tuple[Column, ...]:
    """The columns of tracks, in the order in which they first appear."""
    if isinstance(tracks, Tracks):
        return tracks.columns
    groups: dict[object, list[int]] = {}
    distinct = {id(track.times): track.times for track in tracks}
    same = {known: times.tobytes() for known, times in distinct.items()}
    for place, track in enumerate(tracks):
        shape = track.values.shape
        alike = track.path, track.interpolation, same[id(track.times)], shape, track.unlisted, track.raw
        groups.setdefault(alike, []).append(place)
    return tuple(_column([tracks[place] for place in places], places) for places in groups.values())


def _column(tracks: Sequence[Track], places: Sequence[int]) -> Column:
    first = tracks[0]
    values = np.concatenate([track.values for track in tracks]).reshape(len(tracks), *first.values.shape)
    nodes = np.array([track.node for track in tracks], dtype=np.int64)
    keys = [track.key for track in tracks]
    return Column(
        first.path,
        first.interpolation,
        first.times,
        nodes,
        values,
        keys,
        [track.times for track in tracks],
        places,
        first.unlisted,
        dict(enumerate(tracks)),
        first.raw,
    )


def key_values(track: Track) -> Floats:
    """The values of a track at its keys, (k, c), without the tangents of splines."""
    return track.values[:, 1] if track.interpolation == "CUBICSPLINE" else track.values


def values_minus(track: Track, origin: Floats) -> Floats:
    """The values of a track less ``origin``, (3,) or (4,); tangents have no place."""
    moved = np.array(track.values)
    (moved if track.interpolation != "CUBICSPLINE" else moved[:, 1])[:] -= origin
    return moved


def reached(track: Track, numbers: Floats) -> Floats:
    """What numbers as a track's values move at most: a tangent does so by its time to the next key."""
    if track.interpolation != "CUBICSPLINE":
        return numbers
    span = np.diff(track.times, prepend=track.times[:1], append=track.times[-1:]) * _TANGENT
    shares = np.stack([span[:-1], np.ones(len(track.times)), span[1:]], axis=1)
    return np.asarray(numbers * shares[:, :, np.newaxis])


def off_rest(track: Track, rest: Floats) -> float:
    """How far a track comes from the value of a node at rest, (3,) or (4,), in one of its numbers."""
    either = (rest, -rest) if track.path == "rotation" else (rest,)  # both signs are one rotation
    off = [np.abs(reached(track, values_minus(track, one))).max(axis=-1) for one in either]
    return float(np.min(off, axis=0).max(initial=0.0))


@dataclass(frozen=True, eq=False)
class Clip:
    """An animation. What no track drives keeps its rest value during the clip.

    idle: nothing plays its tracks but those of weights, until the file is changed: they are turned
    all the same, so that they fit then, and are no motion.
    fixed_times: new rotation keys can only stand where the clip has some, as its joints share them.
    """

    name: str
    tracks: Sequence[Track]
    key: Hashable = None
    idle: bool = False
    fixed_times: bool = False

    def __repr__(self) -> str:
        return f"<Clip {self.name!r}: {len(self.tracks)} tracks>"

    @property
    def columns(self) -> tuple[Column, ...]:
        """The tracks in few arrays."""
        return columns(self.tracks)

    @cached_property
    def nodes(self) -> frozenset[int]:
        """The nodes that have tracks."""
        return frozenset(track.node for track in self.tracks)

    @cached_property
    def weights(self) -> dict[int, Track]:
        """The tracks of morph weights by their nodes, the first of each."""
        return {track.node: track for track in reversed(self.tracks) if track.path == "weights"}

    @property
    def animation(self) -> Hashable:
        """The animation of a stage, whose clips are one for each skeleton; None in other formats."""
        return self.key[1:] if isinstance(self.key, tuple) else None

    @property
    def as_pose(self) -> Clip:
        """What it places: the default values of a USD animation place nothing where some array has none.

        At the Default time joints rest then. With samples such values show beside those of other arrays, in
        the clip of the samples. Of morph weights alone, and of what is idle, all is as it is.
        Source: UsdSkelAnimQuery::ComputeJointLocalTransforms, which fails without one of the arrays.
        """
        paths = {column.path for column in self.columns} - {"weights"}
        stands = isinstance(self.key, tuple) and self.key[0] == "default"
        if self.idle or not stands or not paths or paths == {*PATHS}:
            return self
        return replace(self, tracks=tuple(track for track in self.tracks if track.path == "weights"))

    @property
    def without_idle(self) -> Clip:
        """What is seen of it: a clip that is idle without its idle tracks."""
        if not self.idle:
            return self
        return replace(self, tracks=tuple(t for t in self.tracks if t.path == "weights"), idle=False)
