"""What hangs on the nodes of a rig: tracks and clips, skins, meshes, constraints, as immutable arrays."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigtri.maths.matrices import inverse
from rigtri.maths.trigonometry import Floats

Integers = NDArray[np.int64]
Booleans = NDArray[np.bool_]
Path = Literal["translation", "rotation", "scale", "weights"]
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

    @property
    def played(self) -> Clip:
        """What is seen of it: a clip that is idle without its idle tracks."""
        if not self.idle:
            return self
        return replace(self, tracks=tuple(t for t in self.tracks if t.path == "weights"), idle=False)


@dataclass(frozen=True, eq=False)
class Skin:
    """Joints and the matrices that take bind-pose points into each joint's space.

    joints: node indices, (m,). inverse_bind: (m, 4, 4). ``stored`` is False when
    the file has no matrices and these are the identity its format prescribes.
    ``weigh`` says which joints move any point, (m,) bool; it reads the meshes,
    so it is asked only when needed. drawn: something is drawn with it, whether or
    not its points can be read. key: None for a skin that is new.
    """

    name: str
    joints: Integers
    inverse_bind: Floats
    stored: bool = True
    weigh: Callable[[], Booleans] | None = None
    key: Hashable = None
    drawn: bool = False

    @cached_property
    def bind(self) -> Floats:
        """Where each joint stands in the bind pose, seen from the skin, (m, 4, 4); NaN if nothing tells."""
        return inverse(self.inverse_bind)

    @cached_property
    def weighted(self) -> Booleans:
        """Which joints move any point, (m,); all of them when nobody can tell."""
        return np.ones(len(self.joints), dtype=bool) if self.weigh is None else self.weigh()


@dataclass(frozen=True, eq=False)
class Spread:
    """The weight of a bone's points, to be shared among joints that stand along it.

    skin: its number. joints: rows of the skin, (k,), the bone's own among them; at: where each
    stands along the bone, (k,), rising. start, end: of the bone, in the space of the skin's
    points as ``Mesh.bind`` leaves them, (3,) each. most: joints that a point may have, 0 for any number.
    """

    skin: int
    joints: Integers
    at: Floats
    start: Floats
    end: Floats
    most: int = 0


@dataclass(frozen=True, eq=False)
class Fold:
    """Joints of a skin that go, and which ones take what their points have of them.

    skin: its number. rows: (m,), for each row that the file has, the row from now on: a joint that goes
    has that of its heir. at: where each stands along the bone that it shares, (m,). widths: how many
    joints each point of a mesh had room for before, by the node that shows it. idle: no point of a mesh has
    weight of those that go, and no other changes its row.
    """

    skin: int
    rows: Integers
    at: Floats
    widths: Mapping[int, int]
    idle: bool


@dataclass(frozen=True, eq=False)
class Bound:
    """A point or direction that a format keeps in the frame of a node, e.g. a collider's offset."""

    node: int
    vector: Floats
    key: Hashable = None


class Surface(NamedTuple):
    """How a mesh is drawn between its points; read only to compare.

    kind: what is drawn, e.g. ``triangles``. sizes: corners of each face, (f,), empty
    where ``kind`` says it. corners: point indices. normals: (m, 3), (0, 3) where there are none.
    values: by name what else points, corners or faces have: colours, texture coordinates, tangents.
    """

    kind: str
    sizes: Integers
    corners: Integers
    normals: Floats
    values: Mapping[str, NDArray[Any]] = {}


@dataclass(frozen=True, eq=False)
class Constraint:
    """A node that follows another by a rule that compares their axes.

    kind: ``rotation``, node takes over how source has turned from its rest; ``roll``, of that
    turn the part about ``axis``, seen from the two parents; ``aim``, ``axis`` points at source;
    ``tail``, the end of a swinging chain, which hangs as its parent, the source, stands.
    ``length``, node's rotations are not unit, and the source is its parent: no constraint of a file.
    axis: (3,), one of the six axes of node; zero where the kind has none.
    """

    kind: Literal["rotation", "roll", "aim", "tail", "length"]
    node: int
    source: int
    axis: Floats
    key: Hashable = None


def runs(numbers: Integers) -> Integers:
    """Where each run of the same number begins in sorted ones, (w,)."""
    first = np.ones(len(numbers), dtype=bool)
    np.not_equal(numbers[1:], numbers[:-1], out=first[1:])
    return np.flatnonzero(first)


@dataclass(frozen=True, eq=False)
class Mesh:
    """Points that skins or nodes move; read only to measure, never written.

    points: (v, 3). joints, weights: (v, k), indices into the skin's joints; empty
    (v, 0) for a rigid mesh, whose points are in the space of ``node``. bind: the
    matrix that takes points into the space of the skin's bind pose. morphs:
    (t, v, 3) offsets, weighted by ``morph_weights`` (t,) or a weights track of ``node``;
    morph_names: what they are called, empty where nothing says it.
    ``surface`` reads faces and normals, None where they cannot be read; asked only when needed.
    box: where ``points`` are only some of many, the lows and highs of all of them wherever
    morphs carry them: (2, 3), and any joint may move any of them, or of those that each joint
    of the skin moves, (2, m, 3).
    """

    name: str
    node: int
    points: Floats
    skin: int | None = None
    joints: Integers = field(default_factory=lambda: np.zeros((0, 0), dtype=np.int64))
    weights: Floats = field(default_factory=lambda: np.zeros((0, 0)))
    bind: Floats = field(default_factory=lambda: np.eye(4))
    morphs: Floats = field(default_factory=lambda: np.zeros((0, 0, 3)))
    morph_weights: Floats = field(default_factory=lambda: np.zeros(0))
    morph_names: tuple[str, ...] = ()
    dual_quaternion: bool = False
    surface: Callable[[], Surface | None] | None = None
    box: Floats | None = None

    @cached_property
    def moved(self) -> tuple[Integers, Integers]:
        """Joint and point of each weight that is not 0, (w,) each, joint by joint."""
        weights = np.flatnonzero(self.weights != 0)
        joints, points = self.joints.ravel()[weights], weights // max(self.weights.shape[1], 1)
        few = len(joints) and 0 <= int(joints.min()) <= int(joints.max()) < 1 << 16
        # Of so few joints a sort counts, which is far faster.
        order = np.argsort(joints.astype(np.uint16) if few else joints, kind="stable")
        return joints[order], points[order]

    @cached_property
    def surface_now(self) -> Surface | None:
        """Faces and normals; None when nobody can tell."""
        return None if self.surface is None else self.surface()
