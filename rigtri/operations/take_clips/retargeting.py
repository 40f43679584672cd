"""Tracks of a node of another file as tracks of the rig's node, in its axes.

``local = C · other local · D``. Where C and D are turns of one size, keys are mapped one by one and
stay what they were: times, interpolation, tangents (`rigtri.frames.reframe` has the same mathematics).
Else the motion is worked out at the other file's keys.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import cached_property

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.constraint_solver import to_parts
from rigtri.evaluation.sampling import sample, sorted_unique
from rigtri.maths.matrices import (
    compose,
    determinant,
    inverse,
    multiply,
    skew,
    transform_directions,
    transform_points,
)
from rigtri.maths.quaternions import from_axes, half_turn, make_continuous, unit
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.similarity_fit import SAME_SIZE, SAME_TURN
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import PATHS, Clip, Interpolation, Path, Track, key_values
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.proportions import Proportions


@dataclass(frozen=True, eq=False)
class Transferred:
    """Tracks of one node, at its own times; sampled: they had to be worked out anew."""

    tracks: tuple[Track, ...]
    sampled: bool


def _times(tracks: Iterable[Track]) -> Floats:
    distinct = {id(track.times): track.times for track in tracks}
    return sorted_unique(np.concatenate([*distinct.values(), np.zeros(0)]))


class Transfer:
    """One clip of the other file, seen from the rig. Times are the other file's.

    home: what the rig plays at the same time, which moves nodes that the other file lacks; ours: its times.
    """

    def __init__(
        self, bodies: Proportions, clip: Clip, home: Clip | None, ours: Callable[[Floats], Floats]
    ) -> None:
        self.bodies, self.clip, self.ours = bodies, clip, ours
        self.both = both = bodies.both
        self.driven = _by_node(clip)
        self.own = {} if home is None else {n: t for n, t in _by_node(home).items() if n not in both.of}

    @cached_property
    def frames(self) -> Floats:
        """The times at which anything of the clip has a key."""
        return _times(self.clip.tracks)

    @cached_property
    def joint_frames(self) -> Floats:
        """The times at which joints have keys, else anything: reading samples angles of prims finer."""
        joints = _times(t for t in self.clip.tracks if self.both.other.is_joint[t.node])
        return joints if len(joints) > 2 else self.frames

    def nodes(self) -> list[int]:
        """The nodes of the rig that the clip moves: by keys of their own, or joints and what is above them
        by what stands between.

        A mesh with another parent in the other file is drawn otherwise; it has no motion of its own.
        """
        both, rig = self.both, self.both.rig
        body = rig.with_ancestors(np.flatnonzero(rig.is_joint).tolist()).union(rig.own)
        carried = [n for n in both.of if n in body and self.is_carried(n)]
        return sorted({n for n in both.of if both.of[n] in self.driven}.union(carried))

    def is_carried(self, node: int) -> bool:
        """Whether what stands between a node and the nearest above it in both files moves."""
        theirs, ours, _ = self.both.line(node)
        carriers = (*theirs, *(self.both.of.get(k, -1) for k in ours))
        return any(k in self.driven for k in carriers) or any(k in self.own for k in ours)

    def of(self, node: int) -> Transferred:
        """What moves a node of the rig."""
        own = self.driven.get(self.both.of[node], {})
        left, right = self.both.turns[node], self.both.between(node)
        if not self.is_carried(node) and _mappable(left, right, own):
            place = self._in_parent(node)
            placed = right if place is None else multiply(right, place)
            left, signs = self._folded(node, left)
            tracks = (
                _signed(_mapped(track, node, left, placed if track.path == "translation" else right), signs)
                for track in own.values()
            )
            return Transferred(tuple(tracks), sampled=False)
        return Transferred(self._sampled(node, left), sampled=True)

    def back(self, track: Track) -> Track | None:
        """A track of the rig as one of the other file's node, in its axes; None where no key maps to one."""
        node = track.node
        left, right = self.both.turns[node], self.both.between(node)
        if self.is_carried(node) or not _mappable(left, right, {track.path: track}):
            return None
        if track.path == "translation" and (place := self._in_parent(node)) is not None:
            right = multiply(right, place)
        left, signs = self._folded(node, left)
        track = _signed(track, signs)
        return _mapped(track, self.both.of[node], inverse(left), inverse(right))

    def _folded(self, node: int, left: Floats) -> tuple[Floats, Floats]:
        """The turn of a node's axes and `_signs`; with the signs of scale of both files in it where axes
        stand obliquely, so that no signs of theirs are signs along ours."""
        axes = _axes(left)
        if (np.abs(axes - np.rint(axes)) <= 1e-9).all() or "scale" in self.driven.get(self.both.of[node], {}):
            return left, self._signs(node, left)
        ours, theirs = (
            np.sign(rest_parts(rig, k)["scale"][0])
            for rig, k in ((self.both.rig, node), (self.both.other, self.both.of[node]))
        )
        if ours.prod() != theirs.prod():
            return left, self._signs(node, left)
        folded = left.copy()
        folded[:3, :3] *= ours[:, np.newaxis] * theirs
        return folded, np.ones(3)

    def _signs(self, node: int, left: Floats) -> Floats:
        """Which axes of a node both files mirror otherwise, (3,): 1, or −1 for two of them, a half turn.

        A mirrored node is mirrored along one axis in RIG, and along all three once Blender has written it.
        """
        theirs = rest_parts(self.both.other, self.both.of[node])["scale"][0]
        axes = _axes(left)
        x, y, z = (theirs[k] * axes[k] * axes[k] for k in range(3))
        signs = np.sign((x + y + z) * rest_parts(self.both.rig, node)["scale"][0])
        return np.asarray(signs if signs.prod() > 0 else np.ones(3))

    def _sampled(self, node: int, left: Floats) -> tuple[Track, ...]:
        """Keys wherever anything that moves the node, or a node above it, has one."""
        both = self.both
        apart, parent = [], int(both.rig.parents[node])
        while parent >= 0 and parent not in both.of:
            apart.append(parent)
            parent = int(both.rig.parents[parent])
        own, above = self._lines(both.of[node], both.of[parent] if parent >= 0 else -1)
        tracks = [t for k in (*own, *above) if k in self.driven for t in self.driven[k].values()]
        # What the rig alone moves on the way is undone wherever the clip has a key.
        tracks = tracks or list(self.clip.tracks)
        times = sorted_unique(np.concatenate([track.times for track in tracks]))
        placed = multiply(left, self._along(own, times))
        if parent >= 0:
            placed = multiply(placed, inverse(multiply(both.turns[parent], self._along(above, times))))
        else:
            placed = multiply(placed, both.space)
        stays = self.bodies.stays(node)
        if not stays and (place := self.bodies.place(node)) is not None:
            if parent != both.line(node)[2]:
                raise GeometryError(
                    f"'{both.rig.title(node)}' has another parent and another length in EDITED: through the "
                    "world its bone would stretch. Give it the same parent in both, or --clip without it"
                )
            placed[..., 3, :3] = transform_points(placed[..., 3, :3], place)
        for k in apart[::-1]:
            carrier = local_of(both.rig, k, self.own.get(k, {}), self.ours(times))
            placed = multiply(placed, inverse(carrier))
        if stays:
            placed[..., 3, :3] = both.rig.local[node, 3, :3]
        self._refuse_shear(node, placed)
        parts = to_parts(placed)
        held = all(track.interpolation == "STEP" or len(track.times) == 1 for track in tracks)
        way: Interpolation = "STEP" if held else "LINEAR"
        return tuple(
            Track(node, path, way, times, make_continuous(values) if path == "rotation" else values)
            for path, values in zip(PATHS, parts, strict=True)
            if np.isfinite(values).all()
        )

    def _refuse_shear(self, node: int, placed: Floats) -> None:
        """GeometryError where local matrices, (f, 4, 4), are none that keys could hold."""
        title = self.both.rig.title(node)
        if not np.isfinite(placed).all():
            raise GeometryError(
                f"'{title}' cannot be seen from the nodes above it, which have a scale of 0 or "
                "a flat matrix. Give them their size at rest and in all keys"
            )
        if float(np.nan_to_num(skew(placed)).max(initial=0.0)) > SAME_TURN:
            raise GeometryError(
                f"EDITED shears '{title}', seen from RIG, which keys of rotation and scale cannot hold: "
                "something above it is scaled along one axis. Apply that scale in the DCC, or even it out"
            )

    def _lines(self, node: int, other: int) -> tuple[list[int], list[int]]:
        """The nodes of the other file from two of its nodes up to the nearest above both; −1: to the top."""
        one, two = (self.both.other.path_to_root(k) for k in (node, other))
        while one and two and one[-1] == two[-1]:
            one.pop()
            two.pop()
        return one, two

    def _along(self, line: list[int], times: Floats) -> Floats:
        """The product of the local matrices of a line of nodes, (f, 4, 4)."""
        matrix = np.broadcast_to(np.eye(4), (len(times), 4, 4))
        for k in line:
            matrix = multiply(matrix, self.local(k, times))
        return np.asarray(matrix)

    def local(self, node: int, times: Floats) -> Floats:
        """The local matrices of a node of the other file, (f, 4, 4) or one row."""
        return local_of(self.both.other, node, self.driven.get(node, {}), times)

    def still(self, node: int) -> Floats:
        """The local matrix, (4, 4), that a node of the rig has where the other file rests."""
        both = self.both
        there = both.other.local[both.of[node]]
        seen = multiply(multiply(both.turns[node], there), both.between(node))
        if (place := self._in_parent(node)) is not None:
            seen[3, :3] = transform_points(seen[3, :3], place)
        return seen

    def _in_parent(self, node: int) -> Floats | None:
        """What becomes of a node's place in the axes of its own parent; see `Proportions.place`."""
        place = self.bodies.place(node)
        if place is None:
            return None
        own = np.eye(4)
        for k in self.both.line(node)[1]:
            own = multiply(own, self.both.rig.local[k])
        return multiply(multiply(own, place), inverse(own))


def _by_node(clip: Clip) -> dict[int, dict[Path, Track]]:
    found: dict[int, dict[Path, Track]] = {}
    for track in clip.tracks:
        if track.path != "weights":
            found.setdefault(track.node, {})[track.path] = track
    return found


def local_of(rig: Rig, node: int, own: Mapping[Path, Track], times: Floats) -> Floats:
    """The local matrices of a node that tracks move, (f, 4, 4); one row where there are none."""
    if not own:
        still: Floats = rig.local[node][np.newaxis]
        return still
    rest = rest_parts(rig, node)
    values = {path: sample(own[path], times) if path in own else rest[path] for path in PATHS}
    return compose(values["translation"], unit(values["rotation"]), values["scale"])


def rest_parts(rig: Rig, node: int) -> Mapping[Path, Floats]:
    """Translation, rotation and scale of a node at rest, one row each."""
    if rig.has_matrix[node]:
        return dict(zip(PATHS, to_parts(rig.local[node][np.newaxis]), strict=True))
    rows = slice(node, node + 1)
    parts = (rig.translation[rows], unit(rig.rotation[rows]), rig.scale[rows])
    return dict(zip(PATHS, parts, strict=True))


def _mappable(left: Floats, right: Floats, own: Mapping[Path, Track]) -> bool:
    """Whether keys can be mapped one by one: turns of one size, and no scale that the turn would shear."""
    if np.abs(left[3, :3]).max() > 0 or not (_turns(left) and _turns(right)):
        return False
    axes = left[:3, :3] / length(left[:3, :3])[:, np.newaxis]
    if (np.abs(axes - np.rint(axes)) <= 1e-9).all():
        return True
    scale = own.get("scale")
    if scale is None:
        return True
    near = SAME_SIZE * np.abs(key_values(scale)).max(axis=1)
    if scale.interpolation == "CUBICSPLINE" and len(scale.times) > 1:
        # A tangent has no size of its own: what counts is what it comes to until the next key.
        gaps = np.diff(scale.times)
        longest = np.maximum(np.append(gaps, 0.0), np.append(0.0, gaps))
        if (np.ptp(scale.values[:, ::2], axis=2) * longest[:, np.newaxis] > near[:, np.newaxis]).any():
            return False
    return bool((np.ptp(key_values(scale), axis=1) <= near).all())


def _turns(matrix: Floats) -> bool:
    """Whether a matrix turns, sizes all alike, and moves."""
    sizes = length(matrix[:3, :3])
    return bool(
        np.isfinite(matrix).all()
        and determinant(matrix) > 0
        and sizes.max() - sizes.min() <= SAME_SIZE * sizes.max()
        and skew(matrix) <= SAME_TURN
    )


def _mapped(track: Track, node: int, left: Floats, right: Floats) -> Track:
    """A track with each of its keys, and their tangents, mapped."""
    left_axes, right_axes = _axes(left), _axes(right)
    values = track.values
    if track.path == "translation":
        # Tangents are directions.
        if not np.array_equal(right, np.eye(4)):
            moved = transform_directions(values, right)
            points = transform_points(values, right)
            if track.interpolation == "CUBICSPLINE":
                moved[:, 1] = points[:, 1]
            else:
                moved = points
            values = moved
    elif track.path == "rotation":
        if not np.array_equal(left_axes, np.eye(3)) or not np.array_equal(right_axes, np.eye(3)):
            values = product(product(from_axes(right_axes), values), from_axes(left_axes))
    else:
        size = float(length(left[0, :3])) * float(length(right[0, :3]))
        squares = left_axes * left_axes
        if not np.array_equal(squares, np.eye(3)) or size != 1.0:
            x, y, z = (values[..., k, np.newaxis] * squares[:, k] for k in range(3))
            values = size * (x + y + z)
    return replace(track, node=node, values=values, key=None)


def _signed(track: Track, signs: Floats) -> Track:
    """A track of the same motion: its scale with other signs, its rotation after the half turn they are."""
    if track.path == "translation" or (signs > 0).all():
        return track
    if track.path == "scale":
        return replace(track, values=track.values * signs)
    return replace(track, values=product(track.values, half_turn(signs)))


def _axes(matrix: Floats) -> Floats:
    """The turn of a matrix, as unit rows, (3, 3)."""
    return np.asarray(matrix[:3, :3] / length(matrix[:3, :3])[:, np.newaxis])
