"""How large a control is drawn: as wide as the skin around its joint, else by the length of the bone.

Skin is as wide as the mesh at rest where the plane of the control's ring cuts it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property

import numpy as np

from rigtri.errors import FileError
from rigtri.evaluation.sampling import morph_weights
from rigtri.evaluation.skinning import deformed
from rigtri.frames.skeleton import Skeleton
from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import from_frame, transform_directions
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot, length, normalise
from rigtri.model.mesh import Mesh
from rigtri.model.mesh_triangles import triangles
from rigtri.model.rig import Rig
from rigtri.operations.aim_targets import Aim

# The radius of a shape as a share of how far the skin reaches around the joint; at least, and without skin,
# as a share of the bone. Bones shorter than this share of the median count as that.
MARGIN = 1.2
LEAST, RADIUS = 0.25, 0.5
SHORTEST = 0.5
# A vertex with less weight of a joint than this is skin of another.
_OWN = 0.1


class ControlSizes:
    """The sizes of controls over joints. aims: of joints at rest. extent: of the skeleton, in file units."""

    def __init__(self, tree: Skeleton, aims: Mapping[int, Aim], extent: float) -> None:
        self.tree, self.aims, self.world = tree, aims, tree.rig.world
        bones = [aim.length for aim in aims.values() if aim.length > 0]
        self.typical = float(np.median(bones)) if bones else extent or 1.0
        self.sections = SkinSections(tree.rig)

    def of(self, joint: int, axes: Floats | None = None) -> tuple[float, Floats]:
        """The radius of a joint's shape, and which axis of its control lies along the bone, (3,).

        axes: of a control that has its own.
        """
        end = Aim("keep")
        aim, from_ = self.aims.get(joint, end), joint
        bone = aim.length or 0.5 * self.aims.get(self.tree.above.get(joint, -1), end).length
        if aim.direction is None and self.tree.above.get(joint, -1) >= 0:
            from_ = self.tree.above[joint]
            aim = self.aims.get(from_, end)
        stand = self.world[joint] if axes is None else from_frame(axes, self.world[joint, 3, :3])
        normal = np.array([1.0, 0.0, 0.0])
        if aim.direction is not None:
            along = dot(transform_directions(aim.direction, self.world[from_]), normalise(stand[:3, :3]))
            axis = int(np.argmax(np.abs(along)))
            normal = np.where(np.arange(3) == axis, np.sign(along[axis]), 0.0)
        around = self.sections.radius(joint, stand[3, :3], normalise(transform_directions(normal, stand)))
        bone = max(bone, SHORTEST * self.typical)
        return max(MARGIN * around, LEAST * bone) if around > 0 else RADIUS * bone, normal


class SkinSections:
    """The meshes of a rig at rest, which planes through joints cut."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self._by_skin: dict[int, list[_Skinned]] = {}
        self._by_node: dict[int, list[_Skinned]] = {}
        for mesh in rig.meshes:
            rigid = mesh.skin is None or not mesh.joints.shape[1]
            found = self._by_node if rigid else self._by_skin
            key = mesh.node if rigid or mesh.skin is None else mesh.skin
            found.setdefault(key, []).append(_Skinned(rig, mesh))

    def radius(self, joint: int, place: Floats, normal: Floats) -> float:
        """How far from a place, (3,), skin reaches in the plane square to ``normal``, (3,) unit.

        Of the joint, its parent and its children. Where the plane cuts no such skin, how far it reaches from
        the line along the normal; 0 without any skin. File units, in the world.
        """
        cut = whole = 0.0
        for skinned, own in self._of(joint):
            flat, _ = _seen(skinned.points[own], place, normal)
            whole = max(whole, float(length(flat).max(initial=0.0)))
            flat, height = _seen(skinned.points[skinned.edges_of(own)], place, normal)
            a, b = height.T
            crosses = ((a <= 0) & (b > 0)) | ((b <= 0) & (a > 0))
            flat, a, b = flat[crosses], a[crosses], b[crosses]
            share = (a / (a - b))[:, np.newaxis]
            cut = max(cut, float(length(flat[:, 0] + share * (flat[:, 1] - flat[:, 0])).max(initial=0.0)))
        return cut or whole

    def _of(self, joint: int) -> Iterator[tuple[_Skinned, Integers]]:
        """The meshes that have skin of a joint or of its neighbours, and which vertices of each, (v,).

        Meshes that are children of a joint are the body where there is no skin; else they are held or worn.
        """
        joints = [joint, int(self.rig.parents[joint]), *self.rig.children[joint]]
        found = list(self._skin_of(joints))
        if not found:
            rigid = (mesh for node in joints for mesh in self._by_node.get(node, ()))
            found = [(mesh, np.arange(len(mesh.points))) for mesh in rigid if mesh.usable]
        yield from found

    def _skin_of(self, joints: list[int]) -> Iterator[tuple[_Skinned, Integers]]:
        for skin, meshes in self._by_skin.items():
            rows = [row for k in joints for row in self._rows[skin].get(k, ())]
            for skinned in meshes if rows else ():
                own = skinned.vertices_of(rows)
                if len(own) and skinned.usable:
                    yield skinned, own

    @cached_property
    def _rows(self) -> dict[int, dict[int, list[int]]]:
        """For each skin that meshes have, the rows of its joints."""
        found: dict[int, dict[int, list[int]]] = {}
        for skin in self._by_skin:
            rows = found.setdefault(skin, {})
            for row, joint in enumerate(self.rig.skins[skin].joints.tolist()):
                rows.setdefault(joint, []).append(row)
        return found


class _Skinned:
    """A mesh at rest, skinned when it is needed."""

    def __init__(self, rig: Rig, mesh: Mesh) -> None:
        self.rig, self.mesh = rig, mesh

    @cached_property
    def points(self) -> Floats:
        """Its points in the world, (v, 3)."""
        weights = morph_weights(self.mesh, None, np.zeros(1))
        return np.asarray(deformed(self.mesh, self.rig, self.rig.normalised_world[np.newaxis], weights)[0])

    @cached_property
    def usable(self) -> bool:
        return bool(np.isfinite(self.points).all())

    def vertices_of(self, rows: list[int]) -> Integers:
        """The vertices, (v,), that rows of the skin's joints move."""
        return np.unique(self._own.of(np.array(rows)))

    def edges_of(self, vertices: Integers) -> Integers:
        """The edges, (e, 2), that vertices are at, some twice."""
        return np.asarray(self._edges[self._at.of(vertices)])

    @cached_property
    def _own(self) -> _Groups:
        vertices, columns = np.nonzero(self.mesh.weights >= _OWN)
        return _Groups(self.mesh.joints[vertices, columns], vertices)

    @cached_property
    def _edges(self) -> Integers:
        return _edges(self.mesh)

    @cached_property
    def _at(self) -> _Groups:
        numbers = np.arange(len(self._edges))
        return _Groups(self._edges.T.ravel(), np.concatenate([numbers, numbers]))


class _Groups:
    """Numbers by a key each, (n,), so that those of a few keys are found without a look at all of them."""

    def __init__(self, keys: Integers, values: Integers) -> None:
        order = np.argsort(keys, kind="stable")
        self._keys, self._values = keys[order], values[order]

    def of(self, keys: Integers) -> Integers:
        """The numbers of keys, (k,), one after another, (m,)."""
        first = np.searchsorted(self._keys, keys, side="left")
        count = np.searchsorted(self._keys, keys, side="right") - first
        before = np.cumsum(count) - count
        ahead = np.repeat(first - before, count)
        return np.asarray(self._values[np.arange(len(ahead)) + ahead])


def _seen(points: Floats, place: Floats, normal: Floats) -> tuple[Floats, Floats]:
    """Points, (..., 3), from a place: in the plane square to a normal, and how far beside it, (...)."""
    away = points - place
    height = dot(away, normal)
    return away - height[..., np.newaxis] * normal, height


def _edges(mesh: Mesh) -> Integers:
    """The edges of a mesh's triangles, (e, 2); none where its faces cannot be read."""
    try:
        found = triangles(mesh)
    except FileError:
        return np.zeros((0, 2), dtype=np.int64)
    return np.concatenate([found[:, [0, 1]], found[:, [1, 2]], found[:, [2, 0]]])
