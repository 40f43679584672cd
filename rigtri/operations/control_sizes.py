"""How large a control is drawn: as wide as the skin around its joint, else by the length of the bone.

Skin is as wide as the joint's own part of the mesh at rest, where the plane of the control's ring cuts it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property

import numpy as np

from rigtri.errors import FileError
from rigtri.evaluation.sampling import morph_weights
from rigtri.evaluation.skinning import deformed
from rigtri.frames.rig_size import placing_node
from rigtri.frames.skeleton import Skeleton
from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import from_frame, transform_directions
from rigtri.maths.ranking import axis_across, first_largest
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length, normalise, perpendicular
from rigtri.model.characters import characters
from rigtri.model.mesh import Mesh
from rigtri.model.mesh_triangles import triangles
from rigtri.model.metadata import TwistRecord
from rigtri.model.rig import Rig
from rigtri.operations.aim_targets import Aim
from rigtri.recognition.limbs import Limb

# The radius of a shape as a share of how far the skin reaches around the joint; at least, and without skin,
# as a share of the bone. Bones shorter than this share of the median count as that.
MARGIN = 1.2
LEAST, RADIUS = 0.25, 0.5
SHORTEST = 0.5
# Where a limb arrives at its end, as a share of its last bone: its skin often ends just at the joint.
BEFORE = 0.1
# A vertex is skin of the joint that has the largest weight there, or as large a one but for rounding.
_LARGEST = 0.999
# How many times as wide as its own limb a ring may be for others not to hide it.
_WIDER = 1.6
# Where no more than so many of the directions `_AROUND` it were left to see, as under a skirt or in a trunk,
# a ring gets wider until half of them are, up to a share of the character (the diagonal of its joints' box):
# one that is wider does not show whose it is.
_SEEN, _WIDEST = 2, 0.15
# Where that is too little, by this factor at a time until a quarter at most is inside, as beside limbs.
_STEP = 1.1
# Directions in a plane.
_AROUND = (
    np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)])
    * np.where(np.arange(8) % 2, np.sqrt(0.5), 1.0)[:, np.newaxis]
)


class ControlSizes:
    """The sizes of controls over joints. aims: of joints at rest. extent: of the skeleton, in file units."""

    def __init__(self, tree: Skeleton, aims: Mapping[int, Aim], extent: float) -> None:
        self.tree, self.aims, self.world = tree, aims, tree.rig.world
        bones = [aim.length for aim in aims.values() if aim.length > 0]
        self.typical = float(np.median(bones)) if bones else extent or 1.0
        self.sections = SkinSections(tree)

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
            axis = first_largest(np.abs(along))
            normal = np.where(np.arange(3) == axis, np.sign(along[axis]), 0.0)
        around = self.sections.radius(joint, stand[3, :3], normalise(transform_directions(normal, stand)))
        bone = max(bone, SHORTEST * self.typical)
        return max(MARGIN * around, LEAST * bone) if around > 0 else RADIUS * bone, normal

    def of_end(self, limb: Limb) -> float:
        """Half the edge of a cube around the end of a limb: how thick the limb is where it arrives there."""
        end, bone = self.world[limb.end, 3, :3], self.world[limb.end, 3, :3] - self.world[limb.middle, 3, :3]
        for place in (end - bone * BEFORE, end) if bone.any() else ():
            thick = self.sections.thickness([limb.middle, limb.end], place, normalise(bone))
            if thick > 0:
                return MARGIN * thick
        return self.of(limb.end)[0]


class SkinSections:
    """The meshes of a rig at rest, which planes through joints cut."""

    def __init__(self, tree: Skeleton) -> None:
        self.tree = tree
        rig = self.rig = tree.rig
        # By the number of the character.
        self._extents: dict[int, float] = {}
        self._by_skin: dict[int, list[_Skinned]] = {}
        # By the joint that a mesh is, or is below.
        self._by_joint: dict[int, list[_Skinned]] = {}
        joints = set(tree.joints)
        for mesh in rig.meshes:
            if mesh.skin is not None and mesh.joints.shape[1]:
                self._by_skin.setdefault(mesh.skin, []).append(_Skinned(rig, mesh))
            else:
                above = (node for node in rig.path_to_root(mesh.node) if node in joints)
                self._by_joint.setdefault(next(above, -1), []).append(_Skinned(rig, mesh))

    def radius(self, joint: int, place: Floats, normal: Floats) -> float:
        """How wide a ring around a place, (3,), must be in the plane square to ``normal``, (3,) unit.

        The joint's own skin lies inside it, where the plane cuts that; else all of it, seen along the normal.
        The other leg, or the trunk below a clavicle, is not looked at; but where half of the ring would be
        hidden in them it is up to `_WIDER` as wide, and where most of it would still be, up to `_WIDEST` of
        the character. What a joint without skin holds counts up to `_WIDER` as wide as the skin of the joint
        above, or a weapon's ring would be as wide as the weapon is long.
        0 without any skin. File units, in the world.
        """
        near = self._near(joint)
        own = _width(near, place, normal)
        above = self.rig.path_to_root(joint)[1:] if self._holds(near) else []
        if skin := next(filter(None, (list(self._skin_of([node])) for node in above)), []):
            own = min(own, _WIDER * _width(skin, place, normal))
        if own == 0:
            return 0.0
        cuts = [skinned.signed_cut(skinned.triangles, place, normal) for skinned in self._body_of(joint)]
        ends, most = _farthest([lines for lines, _ in cuts], normal), _WIDER * own
        if ends[_SEEN] > most:
            widest = max(most, _WIDEST * self._extent_of(joint))
            most = widest if _half(ends) <= widest else _outside(most, widest, cuts, normal)
        return max(own, min(_half(ends), most))

    def thickness(self, joints: list[int], place: Floats, normal: Floats) -> float:
        """How thick the skin of joints is in the plane: as `radius`, but half of the directions are enough.

        So the length of a foot does not count where its ankle is low.
        """
        near = [(skinned, skinned.triangles_of(vertices)) for skinned, vertices in self._of(joints)]
        return _half(_farthest([skinned.cut(corners, place, normal) for skinned, corners in near], normal))

    def points_of(self, joints: list[int]) -> Floats:
        """The points, (v, 3), that joints move most, in the world at rest."""
        found = [skinned.points[vertices] for skinned, vertices in self._of(joints)]
        return np.concatenate([*found, np.zeros((0, 3))])

    def lowest(self, joint: int, up: Floats) -> float:
        """How high, along ``up``, (3,) unit, the lowest point at rest is of the character that a joint is of.

        NaN without any skin. Where there is none, meshes below joints count, but not those beside them.
        """
        beside = self._by_joint.get(-1, [])
        points = [skinned.points for skinned in self._body_of(joint) if skinned not in beside]
        return min((float(dot(some, up).min()) for some in points if len(some)), default=float("nan"))

    def _near(self, joint: int) -> list[tuple[_Skinned, Integers]]:
        """As `_of` a joint, or where it has none its neighbours, or the nearest joint above that has some."""
        return next(filter(None, map(self._of, self._nearer_first(joint))), [])

    def _nearer_first(self, joint: int) -> Iterator[list[int]]:
        """A joint, its neighbours, and one by one those above, which few ask for."""
        above = int(self.rig.parents[joint])
        yield [joint]
        yield [*([above] if above >= 0 else []), *self.rig.children[joint]]
        yield from ([node] for node in self.rig.path_to_root(above)[1:])

    def _holds(self, near: list[tuple[_Skinned, Integers]]) -> bool:
        """Whether meshes are held or worn: there are some, and they have no skin."""
        return bool(near) and all(skinned.mesh.skin is None for skinned, _ in near)

    def _of(self, joints: list[int]) -> list[tuple[_Skinned, Integers]]:
        """The meshes that have skin of joints, and which vertices of each, (v,).

        Meshes that are below joints are the body where there is no skin; else they are held or worn.
        """
        found = list(self._skin_of(joints))
        if not found:
            rigid = (mesh for node in joints for mesh in self._by_joint.get(node, ()))
            found = [(mesh, np.arange(len(mesh.points))) for mesh in rigid if mesh.usable]
        return found

    def _skin_of(self, joints: list[int]) -> Iterator[tuple[_Skinned, Integers]]:
        for skin, meshes in self._by_skin.items():
            rows = [row for k in joints for row in self._rows[skin].get(k, ())]
            for skinned in meshes if rows else ():
                own = skinned.vertices_of(rows)
                if len(own) and skinned.usable:
                    yield skinned, own

    def _body_of(self, joint: int) -> list[_Skinned]:
        """The meshes that the body of a joint consists of: those with a skin, else all."""
        found, numbers = self._bodies
        number = numbers.get(joint, -1)
        return [one for k, some in found.items() if k == number or -1 in (k, number) for one in some]

    def _extent_of(self, joint: int) -> float:
        """The diagonal of the box of the joints of the character that a joint is of, in file units."""
        number = self._bodies[1].get(joint, -1)
        if number not in self._extents:
            own = [node for node in self.tree.joints if self._bodies[1].get(node, -1) == number]
            self._extents[number] = float(length(np.ptp(self.rig.normalised_world[own, 3, :3], axis=0)))
        return self._extents[number]

    @cached_property
    def _bodies(self) -> tuple[dict[int, list[_Skinned]], dict[int, int]]:
        """The meshes of each character, and to which each node belongs; −1 for none."""
        numbers = {node: k for k, nodes in enumerate(characters(self.rig)) for node in nodes}
        found: dict[int, list[_Skinned]] = {}
        for meshes in (self._by_skin or self._by_joint).values():
            for one in meshes:
                if one.usable:
                    node = placing_node(self.rig, one.mesh)
                    found.setdefault(numbers.get(node, -1), []).append(one)
        return found, numbers

    @cached_property
    def _rows(self) -> dict[int, dict[int, list[int]]]:
        """For each skin that meshes have, the rows of its joints; a bone has those of its twist joints."""
        bones = {node: self.rig.known(twist.joint) for node, twist in self.rig.records(TwistRecord).items()}
        found: dict[int, dict[int, list[int]]] = {}
        for skin in self._by_skin:
            rows = found.setdefault(skin, {})
            for row, joint in enumerate(self.rig.skins[skin].joints.tolist()):
                for owner in {joint, bones.get(joint)} - {None}:
                    rows.setdefault(owner, []).append(row)
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
        """The vertices, (v,), that rows of the skin's joints move most."""
        return np.unique(self._own.of(np.array(rows)))

    def triangles_of(self, vertices: Integers) -> Integers:
        """The triangles, (t, 3), that vertices are at, some more than once."""
        return np.asarray(self.triangles[self._at.of(vertices)])

    def cut(self, corners: Integers, place: Floats, normal: Floats) -> Floats:
        """The lines, (m, 2, 3), in which triangles, (t, 3), cut a plane, seen from ``place``."""
        return self.signed_cut(corners, place, normal)[0]

    def signed_cut(self, corners: Integers, place: Floats, normal: Floats) -> tuple[Floats, Floats]:
        """As `cut`, and the sign, (m,), with which each line goes round what the surface encloses."""
        above = (dot(self.points, normal) > dot(place, normal))[corners]
        corners = corners[above.any(axis=1) & ~above.all(axis=1)]
        flat, height = _seen(self.points[corners], place, normal)
        # Rounded in this way, what begins in the plane may be on one side of it after all.
        parted = (height > 0).any(axis=1) & (height <= 0).any(axis=1)
        flat, height = flat[parted], height[parted]
        above = height > 0
        # The corner that is alone on its side comes first.
        a, b, c = above.T
        alone = np.where(b == c, 0, np.where(a == c, 1, 2))
        order = (alone[:, np.newaxis] + np.arange(3)) % 3
        each = np.arange(len(order))[:, np.newaxis]
        flat, height = flat[each, order], height[each, order]
        apart = height[:, :1] - height[:, 1:]
        share = height[:, :1] / apart
        lines = flat[:, :1] + share[..., np.newaxis] * (flat[:, 1:] - flat[:, :1])
        return np.asarray(lines), np.where(height[:, 0] > 0, 1.0, -1.0)

    @cached_property
    def _own(self) -> _Groups:
        weights = self.mesh.weights
        vertices, columns = np.nonzero(weights >= _LARGEST * weights.max(axis=1, keepdims=True))
        return _Groups(self.mesh.joints[vertices, columns], vertices)

    @cached_property
    def triangles(self) -> Integers:
        """(t, 3); none where its faces cannot be read."""
        try:
            return triangles(self.mesh)
        except FileError:
            return np.zeros((0, 3), dtype=np.int64)

    @cached_property
    def _at(self) -> _Groups:
        numbers = np.arange(len(self.triangles))
        return _Groups(self.triangles.T.ravel(), np.concatenate([numbers] * 3))


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


def _width(near: list[tuple[_Skinned, Integers]], place: Floats, normal: Floats) -> float:
    """How far skin reaches from a place where the plane cuts it; else all of it, seen along the normal."""
    own = whole = 0.0
    for skinned, vertices in near:
        flat, _ = _seen(skinned.points[vertices], place, normal)
        whole = max(whole, float(length(flat).max(initial=0.0)))
        lines = skinned.cut(skinned.triangles_of(vertices), place, normal)
        own = max(own, float(length(lines).max(initial=0.0)))
    return own or whole


def _farthest(cuts: list[Floats], normal: Floats) -> Floats:
    """How far lines, (m, 2, 3) each, lie away at most in each direction around a normal, (8,), ascending."""
    ends = np.array([np.zeros(len(_AROUND)), *(_ends(lines, normal) for lines in cuts)]).max(axis=0)
    return np.asarray(np.sort(ends))


def _half(ends: Floats) -> float:
    """How far a ring must reach for half of it to be beyond all that ends, (8,), as `_farthest` has them."""
    return float(ends[len(ends) // 2])


def _outside(radius: float, most: float, cuts: list[tuple[Floats, Floats]], normal: Floats) -> float:
    """The smallest radius at which up to a quarter of a ring is inside lines; ``most`` where at none."""
    found = [_crossings(lines, normal) for lines, _ in cuts]
    at = np.concatenate([along for along, _ in found], axis=1)
    turns = np.concatenate([turns * sign for (_, turns), (_, sign) in zip(found, cuts, strict=True)], axis=1)
    while radius < most:
        beyond = at > MARGIN * radius  # as wide as it is drawn
        into, out = (np.count_nonzero(beyond & (turns == way), axis=1) for way in (1.0, -1.0))
        if 4 * np.count_nonzero(into != out) <= len(at):
            return radius
        radius *= _STEP
    return most


def _ends(lines: Floats, normal: Floats) -> Floats:
    """How far lines, (m, 2, 3), lie away at most in each of the directions `_AROUND` a normal, (8,)."""
    return np.asarray(_crossings(lines, normal)[0].max(axis=1, initial=0.0))


def _crossings(lines: Floats, normal: Floats) -> tuple[Floats, Floats]:
    """How far away each direction `_AROUND` a normal crosses lines, (8, m), and to which side, 1 or −1.

    Both are 0 where one does not cross a line.
    """
    u = normalise(perpendicular(axis_across(normal), normal))
    v = cross(normal, u)
    ahead = _AROUND[:, :1] * u + _AROUND[:, 1:] * v
    aside = cross(normal, ahead)
    along, across = (dot(lines[np.newaxis], k[:, np.newaxis, np.newaxis]) for k in (ahead, aside))
    (a, b), (c, d) = (np.moveaxis(k, 2, 0) for k in (along, across))
    crosses = (c <= 0) != (d <= 0)
    share = c / np.where(crosses, c - d, 1.0)
    at = np.where(crosses, a + share * (b - a), 0.0)
    return at, np.where(crosses, np.where(c <= 0, 1.0, -1.0), 0.0)
