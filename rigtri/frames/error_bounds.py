"""Error bounds: the lever arm of each node, which is how far a small error there can move anything.

Bounds for decisions, not values of files: a fault of e (a share) at a node moves nothing by
more than e times its reach, in any pose that bends joints and does not stretch them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property

import numpy as np

from rigtri.errors import FileError
from rigtri.evaluation.sampling import Motion, between_keys, key_times, worlds
from rigtri.frames.rig_size import sizes_of
from rigtri.maths.arrays import Integers, runs
from rigtri.maths.matrices import inverse, multiply, transform_directions, transform_points
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot, length
from rigtri.model.animation import Clip, Column, key_values
from rigtri.model.bounding_boxes import box_of_joints, boxes, corners
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin

# Numbers of matrices in one block of times.
_BLOCK = 1 << 20


class LeverArm:
    """How far from each node the farthest point, joint or frame that is below it can get, (n,).

    As a share of the size of the character; bones below it as if they were all in one line, at rest and
    wherever clips stretch them.
    What is no mesh (cameras, lights) counts as its frame, of axes as long as that size, as it
    is judged. Meshes that cannot be read count for nothing more.
    """

    def __init__(self, rig: Rig) -> None:
        self._rig = rig

    @property
    def _world(self) -> Floats:
        return self._rig.normalised_world

    @cached_property
    def exact(self) -> Floats:
        """As far as it gets, (n,)."""
        rig, world = self._rig, self._world
        own = self.own * self.sizes
        reach = _along(rig, world[np.newaxis], own[np.newaxis])[0]
        stretching = [clip for clip in rig.clips if {t.path for t in clip.tracks} & {"translation", "scale"}]
        for posed in posed_worlds(rig, stretching):
            reach = np.maximum(reach, _along(rig, posed, own * _stretch(world, posed)).max(axis=0))
        return np.asarray(reach / self.sizes)

    @cached_property
    def own(self) -> Floats:
        """How far the points and frames reach that a node moves itself, (n,), without what is below it."""
        return self._own(self.sizes, self._of_points) / self.sizes

    @cached_property
    def sizes(self) -> Floats:
        """What the movement of each node is compared to, (n,), in file units."""
        return sizes_of(self._rig, self._meshes)

    @cached_property
    def at_most(self) -> Floats:
        """No less than `exact`, (n,), from each node's own numbers; infinite where these do not tell."""
        rig, own = self._rig, self._own(self.sizes, self._of_boxes)
        (low, high), (least, most), bones = _sizes_of_nodes(rig)
        for level in rig.levels[1:]:
            parents = rig.parents[level]
            bones[level] *= most[parents]
            for product in (low, high, least, most):
                product[level] *= product[parents]
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            # Of A·Aᵀ, the sum of a row: numbers beside the diagonal are half of what eigenvalues span.
            stretch = np.sqrt(2.0 * (most / low) ** 2 - (least / high) ** 2)
            reach = np.where(own > 0, own * stretch, 0.0)
            for level in reversed(rig.levels[1:]):
                np.maximum.at(reach, rig.parents[level], bones[level] + reach[level])
            # What float64 rounds, and last columns that are nearly 0 0 0 1, are far less.
            reach = 1.001 * reach / self.sizes
        return np.where(np.isfinite(reach), reach, np.inf)

    @cached_property
    def _meshes(self) -> list[Mesh]:
        try:
            return [mesh for mesh in self._rig.content.outlines if mesh.fits(self._rig.skins)]
        except FileError:
            return []

    @property
    def _of_points(self) -> Floats:
        """How far at rest the points of each node reach, (n,), in file units."""
        reach = np.zeros(len(self._rig))
        for mesh in self._meshes:
            _own(self._rig, self._world, mesh, reach)
        return reach

    @property
    def _of_boxes(self) -> Floats:
        """No less than `_of_points`: how far the corners reach of the box of what each joint moves."""
        reach = np.zeros(len(self._rig))
        for mesh in self._meshes:
            if mesh.skin is None or mesh.morphs.size or not mesh.joints.shape[1]:
                _own(self._rig, self._world, mesh, reach)
            else:
                skin = self._rig.skins[mesh.skin]
                _raise_boxes(reach, skin, mesh.bind, boxes(mesh, len(skin.joints)), self._world)
        return reach

    @cached_property
    def unread(self) -> Floats:
        """How far each joint moves the box of its skin's joints, (n,), where no mesh of the skin can be read.

        By that box such a joint is judged, for which all else here counts what is known of it alone.
        """
        reach, shown = np.zeros(len(self._rig)), {mesh.skin for mesh in self._meshes}
        for number, skin in enumerate(self._rig.skins):
            if number not in shown and (box := box_of_joints(skin.bind)) is not None:
                _raise_boxes(reach, skin, np.eye(4), (box[0][np.newaxis], box[1][np.newaxis]), self._world)
        return reach / self.sizes

    def _own(self, sizes: Floats, own: Floats) -> Floats:
        """How far each node's own things reach at rest, (n,), in file units; frames as far as ``sizes``."""
        framed = frames_shown(self._rig, self._meshes)
        if framed:
            own[framed] = np.maximum(own[framed], _corner(self._world[framed, :3, :3]) * sizes[framed])
        return own


def _sizes_of_nodes(rig: Rig) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats], Floats]:
    """By how much each node shrinks and stretches what is below it, (n,) each: at rest, and in any pose.

    And how far it is from its parent at most, (n,), in the parent's space. Splines may overshoot: inf.
    """
    local = rig.normalised_local
    rows = [local[:, k, :3] for k in range(3)]
    square, aside = _squares(rows)
    high = _most(square, aside)
    low = np.sqrt(np.maximum(np.minimum.reduce([a - b for a, b in zip(square, aside, strict=True)]), 0.0))
    least, most, bones = low.copy(), high.copy(), length(local[:, 3, :3])
    moved, scaled = (
        [c for clip in rig.clips for c in clip.columns if c.path == path and len(c.times)]
        for path in ("translation", "scale")
    )
    for column in (column for column in (*moved, *scaled) if column.interpolation == "CUBICSPLINE"):
        (bones if column.path == "translation" else most)[column.nodes] = np.inf
        if column.path == "scale":
            least[column.nodes] = 0.0
    for node, values, starts in _keys(moved):
        np.maximum.at(bones, node, np.maximum.reduceat(length(values), starts))
    for node, values, starts in _keys(scaled):
        smallest, largest = np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)
        turns_over = (smallest * largest <= 0.0).any(axis=1)
        sizes = np.abs(np.stack([smallest, largest]))
        np.minimum.at(least, node, np.where(turns_over, 0.0, sizes.min(axis=(0, 2))))
        np.maximum.at(most, node, sizes.max(axis=(0, 2)))
    return (low, high), (least, most), bones


def _keys(columns: Sequence[Column]) -> Iterator[tuple[Integers, Floats, Integers]]:
    """The nodes, (t,), of tracks without splines, their values in one, (k, 3), and where each starts."""
    plain = [column for column in columns if column.interpolation != "CUBICSPLINE"]
    if plain:
        counts = np.concatenate([np.full(len(column), column.rows) for column in plain])
        values = np.concatenate([column.values.reshape(-1, 3) for column in plain])
        yield np.concatenate([column.nodes for column in plain]), values, np.cumsum(counts) - counts


def _along(rig: Rig, world: Floats, own: Floats) -> Floats:
    """How far from each node what is below it can get, (f, n), at times, (f, n, 4, 4)."""
    reach = own.copy()
    for level in reversed(rig.levels[1:]):
        parents = rig.parents[level]
        bones = length(world[:, level, 3, :3] - world[:, parents, 3, :3])
        far = np.where(np.isfinite(bones), bones, 0.0) + reach[:, level]
        np.maximum.at(reach.T, parents, far.T)
    return reach


def posed_worlds(rig: Rig, clips: Iterable[Clip]) -> Iterator[Floats]:
    """The worlds of clips at and between their keys, (f, n, 4, 4), a block of times at once."""
    many = max(1, _BLOCK // (16 * max(len(rig), 1)))
    for clip in clips:
        times, motion = between_keys(key_times(clip)), Motion(rig, clip)
        for start in range(0, len(times), many):
            yield worlds(rig, motion.locals_at(times[start : start + many]))


def _stretch(rest: Floats, posed: Floats) -> Floats:
    """By how much the frames of nodes are longer at most, (f, n), than at rest, (n, 4, 4).

    The largest stretch of A = rest⁻¹·posed is the root of the largest eigenvalue of A·Aᵀ, and that
    is no more than the largest sum of a row. 1 where the rest is flat.
    """
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        change = multiply(inverse(rest), posed)[..., :3, :3]
        most = longest_stretch([change[..., i, :] for i in range(3)])
    return np.where(np.isfinite(most), most, 1.0)


def longest_stretch(rows: Sequence[Floats]) -> Floats:
    """By how much a matrix stretches any direction at most, (...), from its three rows, (..., 3) each."""
    return _most(*_squares(rows))


def _most(square: Sequence[Floats], aside: Sequence[Floats]) -> Floats:
    """As `longest_stretch`, from what `_squares` gives."""
    return np.asarray(np.sqrt(np.maximum.reduce([a + b for a, b in zip(square, aside, strict=True)])))


def _squares(rows: Sequence[Floats]) -> tuple[list[Floats], list[Floats]]:
    """Of A·Aᵀ, by the rows of A: what is on the diagonal, and row by row the sum of what is beside it."""
    mixed = [np.abs(dot(rows[i], rows[(i + 1) % 3])) for i in range(3)]
    return [dot(row, row) for row in rows], [mixed[i] + mixed[i - 1] for i in range(3)]


def frames_shown(rig: Rig, meshes: Sequence[Mesh]) -> list[int]:
    """The nodes that show something of which only the frame is known: cameras, lights, not ours."""
    drawn = {mesh.node for mesh in meshes} | rig.own
    return [node for node in np.flatnonzero(rig.attachment >= 0).tolist() if node not in drawn]


def _corner(axes: Floats) -> Floats:
    """How far the corners of a box are from its middle, (k,), whose half edges are unit along ``axes``,
    (k, 3, 3)."""
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        edges = axes / length(axes)[..., np.newaxis]
    edges = np.where(np.isfinite(edges), edges, 0.0)
    x, y, z = edges[:, 0], edges[:, 1], edges[:, 2]
    far = np.stack([length(x + a * y + b * z) for a in (1.0, -1.0) for b in (1.0, -1.0)])
    return np.asarray(far.max(axis=0))


def _own(rig: Rig, world: Floats, mesh: Mesh, reach: Floats) -> None:
    """Raise ``reach``, (n,), in file units, to what the points of a mesh ask of the nodes that move them."""
    morphed = _morphed(rig, mesh)
    if mesh.skin is None or not mesh.joints.shape[1]:
        _raise(reach, np.full(len(mesh.points), mesh.node), mesh.points, world, morphed)
        return
    skin = rig.skins[mesh.skin]
    into = multiply(mesh.bind, skin.inverse_bind)
    with np.errstate(invalid="ignore", over="ignore"):
        # From a point to its direction from each joint, as the joint stands: rows, components, joints.
        seen = transform_directions(into[..., :3], world[skin.joints][:, np.newaxis]).transpose(1, 2, 0)
        joints, rows = mesh.moved
        points = [mesh.points[:, k][rows] for k in range(3)]
        square = np.zeros(len(rows))
        for axis in range(3):
            along = seen[3, axis][joints]
            for k in range(3):
                along += points[k] * seen[k, axis][joints]
            square += along * along
        far = np.sqrt(np.where(np.isfinite(square), square, 0.0))
        if morphed is not None:
            longest = longest_stretch([seen[k].T for k in range(3)])
            far += np.where(np.isfinite(longest), longest, 0.0)[joints] * morphed[rows]
    if len(joints):
        starts = runs(joints)
        np.maximum.at(reach, skin.joints[joints[starts]], np.maximum.reduceat(far, starts))
    if mesh.box is not None:
        _raise_boxes(reach, skin, mesh.bind, boxes(mesh, len(skin.joints)), world)


def _raise_boxes(reach: Floats, skin: Skin, bind: Floats, box: tuple[Floats, Floats], world: Floats) -> None:
    """Raise ``reach`` to the corners of the box that each joint moves, (m, 3) twice, before ``bind``."""
    with np.errstate(invalid="ignore", over="ignore"):  # a joint that moves nothing has no box
        ends = transform_points(corners(*box), multiply(bind, skin.inverse_bind)[:, np.newaxis])
    _raise(reach, np.repeat(skin.joints, ends.shape[1]), ends.reshape(-1, 3), world)


def _raise(reach: Floats, node: Integers, points: Floats, world: Floats, more: Floats | None = None) -> None:
    """points: (k, 3), each in the space of its ``node``, (k,); they may be so much farther away, (k,)."""
    if len(points):
        with np.errstate(invalid="ignore", over="ignore"):
            far = length(transform_directions(points, world[node]))
            if more is not None:
                far += longest_stretch([world[node, k, :3] for k in range(3)]) * more
        np.maximum.at(reach, node, np.where(np.isfinite(far), far, 0.0))


def _morphed(rig: Rig, mesh: Mesh) -> Floats | None:
    """How far morphs carry each point at most, (v,), at the weights that they have at rest and in clips."""
    if not mesh.morphs.size:
        return None
    count = len(mesh.morphs)
    most = np.zeros(count)
    most[: len(mesh.morph_weights)] = np.abs(mesh.morph_weights)[:count]
    tracks = [t for clip in rig.clips for t in clip.tracks if t.path == "weights" and t.node == mesh.node]
    for track in tracks:
        keys = np.abs(key_values(track)).max(axis=0, initial=0.0)[:count]
        most[: len(keys)] = np.maximum(most[: len(keys)], keys)
    far = np.zeros(mesh.morphs.shape[1])
    with np.errstate(invalid="ignore", over="ignore"):
        for weight, offsets in zip(most.tolist(), mesh.morphs, strict=True):
            if weight > 0.0:
                far += weight * length(offsets)
    return np.where(np.isfinite(far), far, 0.0)


def bearable(rig: Rig, effect: Floats, most: float) -> float:
    """How much of an effect, (n,) a share of the size, one node may have, so that no line of nodes
    from a root down has more than ``most`` of it; infinite where none has.
    """
    total, many = effect.copy(), (effect > 1e-3 * most).astype(float)
    for level in rig.levels[1:]:
        total[level] += total[rig.parents[level]]
        many[level] += many[rig.parents[level]]
    return np.inf if total.max(initial=0.0) <= most else most / float(many.max())
