"""Animation: tracks of nodes over time, and the clips that they form."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace
from typing import Literal

from rigtri.maths.trigonometry import Floats

Path = Literal["translation", "rotation", "scale", "weights"]
# What places a node.
PATHS: tuple[Path, ...] = ("translation", "rotation", "scale")
Interpolation = Literal["LINEAR", "STEP", "CUBICSPLINE"]


@dataclass(frozen=True, eq=False, init=False)
class Track:
    """One property of one node over the time of a clip.

    times: shape (k,), increasing. values: (k, c), for CUBICSPLINE (k, 3, c):
    in-tangent, value, out-tangent. Tracks of a clip that share their times
    share the array, which is what makes sampling them together cheap. unlisted: columns of weights
    that the file has no word for, which are what they are at rest.
    """

    node: int
    path: Path
    interpolation: Interpolation
    times: Floats
    values: Floats
    key: Hashable = None
    unlisted: frozenset[int] = frozenset()

    def __init__(
        self,
        node: int,
        path: Path,
        interpolation: Interpolation,
        times: Floats,
        values: Floats,
        key: Hashable = None,
        unlisted: frozenset[int] = frozenset(),
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
        )

    def having(self, values: Floats) -> Track:
        """The track with other values; `replace` takes twice as long, and clips have hundreds."""
        return Track(self.node, self.path, self.interpolation, self.times, values, self.key, self.unlisted)


def key_values(track: Track) -> Floats:
    """The values of a track at its keys, (k, c), without the tangents of splines."""
    return track.values[:, 1] if track.interpolation == "CUBICSPLINE" else track.values


@dataclass(frozen=True, eq=False)
class Clip:
    """An animation. What no track drives keeps its rest value during the clip.

    idle: nothing plays its tracks but those of weights, until the file is changed: they are turned
    all the same, so that they fit then, and are no motion.
    fixed_times: new rotation keys can only stand where the clip has some, as its joints share them.
    """

    name: str
    tracks: tuple[Track, ...]
    key: Hashable = None
    idle: bool = False
    fixed_times: bool = False

    def __repr__(self) -> str:
        return f"<Clip {self.name!r}: {len(self.tracks)} tracks>"

    @property
    def without_idle(self) -> Clip:
        """What is seen of it: a clip that is idle without its idle tracks."""
        if not self.idle:
            return self
        return replace(self, tracks=tuple(t for t in self.tracks if t.path == "weights"), idle=False)
