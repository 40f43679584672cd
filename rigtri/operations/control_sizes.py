"""How large a control is drawn: as wide as the skin around its joint, else by the length of the bone.

Skin is as wide as the joint's own part of the mesh at rest, where the plane of the control's ring cuts it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property

import numpy as np

from rigtri.frames.rig_size import placing_node
from rigtri.frames.skeleton import Skeleton
from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import from_frame, transform_directions
from rigtri.maths.ranking import first_largest
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot, length, normalise
from rigtri.model.characters import characters
from rigtri.model.mesh import each_place
from rigtri.model.metadata import TwistRecord
from rigtri.operations.aim_targets import Aim
from rigtri.operations.skin_cuts import (
    AROUND,
    MARGIN,
    SkinnedMesh,
    crossed,
    farthest,
    half,
    inside,
    outside,
    seen_from,
)

# The radius of a shape at least, and without skin, as a share of the bone. Bones shorter than this share of
# the median count as that.
LEAST, RADIUS = 0.25, 0.5
SHORTEST = 0.5
# Where a limb arrives at its end, as a share of its last bone: its skin often ends just at the joint.
BEFORE = 0.1
# How many times as wide as its own limb a ring may be for others not to hide it.
_WIDER = 1.6
# Where no more than so many of the directions `AROUND` it were left to see, as under a skirt or in a trunk,
# a ring gets wider until half of them are, up to a share of the character (the diagonal of its joints' box):
# one that is wider does not show whose it is.
_SEEN, _WIDEST = 2, 0.15
# Where a ring about its joint is hidden it stands at the first of these shares of the bone where it is not:
# beyond them it would belong to the next joint.
_BESIDE = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
# The axis that a ring moves along lies along the bone by this, at least (a cosine, 18°).
_ALONG = 0.95
# A joint, and the place and the direction of a plane.
Key = tuple[int, bytes, bytes]


class ControlSizes:
    """The sizes of controls over joints. aims: of joints at rest. extent: of the skeleton, in file units."""

    def __init__(self, tree: Skeleton, aims: Mapping[int, Aim], extent: float) -> None:
        self.tree, self.aims, self.world = tree, aims, tree.rig.world
        bones = [aim.length for aim in aims.values() if aim.length > 0]
        self.typical = float(np.median(bones)) if bones else extent or 1.0
        self.sections = SkinSections(tree)
        # Whether the ring of a joint shows at a share of its bone.
        self._shown: dict[tuple[int, float], bool] = {}

    def of(
        self, joint: int, axes: Floats | None = None, *, share: float = 0.0
    ) -> tuple[float, Floats, float]:
        """The radius of a joint's shape, which axis of its control lies along the bone, (3,), and a shift.

        axes: of a control that has its own. share: how far along the bone the shape stands, as a share of it
        (`share_beside`); the shift is that in file units.
        """
        bone, normal, place, across, _ = self._bone(joint, axes)
        shift = share * bone
        around = self.sections.radius(joint, place + across * shift, across)
        bone = max(bone, SHORTEST * self.typical)
        return max(MARGIN * around, LEAST * bone) if around > 0 else RADIUS * bone, normal, shift

    def of_twins(self, joints: Mapping[int, Floats | None]) -> tuple[float, Floats, float]:
        """As `of` the first joint, where `share_beside` has its shape; as large as of its twin, if any.

        joints: both, with the axes of controls that have their own.
        """
        share = self.share_beside(joints)
        found = [self.of(joint, axes, share=share) for joint, axes in joints.items()]
        widths = []
        for joint, axes in joints.items():
            bone, _, place, across, _ = self._bone(joint, axes)
            widths.append(self.sections.width(joint, place + across * (share * bone), across))
        _, normal, shift = found[0]
        return _of_twins([size for size, _, _ in found], widths), normal, shift

    def share_beside(self, joints: Mapping[int, Floats | None]) -> float:
        """The share of its bone by which the ring of a joint, the first, stands beside that.

        0 where it shows about the joint. joints: a joint and its twin, if any, with the axes of controls that
        have their own. One look, left to right: of twins both stand where both show. Where that is nowhere,
        or only one of them has skin and a bone to stand along, each has its own share.
        """
        able = [joint for joint, axes in joints.items() if self._bone(joint, axes)[4]]
        first = next(iter(joints))
        if first not in able:
            return 0.0
        for some in (able, [first]):
            for share in (0.0, *_BESIDE):
                if all(self._shows(joint, joints[joint], share) for joint in some):
                    return share
        return 0.0

    def _shows(self, joint: int, axes: Floats | None, share: float) -> bool:
        """Whether a ring that stands at a share of its bone is outside skin by three quarters."""
        if (joint, share) not in self._shown:
            bone, _, place, across, _ = self._bone(joint, axes)
            self._shown[joint, share] = self.sections.shows(joint, place + across * (share * bone), across)
        return self._shown[joint, share]

    def _bone(self, joint: int, axes: Floats | None) -> tuple[float, Floats, Floats, Floats, bool]:
        """The bone of a ring: length, axis of the control, (3,), start and direction, (3,), in the world.

        And whether the ring may stand along it.
        """
        end = Aim("keep")
        aim, from_ = self.aims.get(joint, end), joint
        bone = aim.length or 0.5 * self.aims.get(self.tree.above.get(joint, -1), end).length
        if aim.direction is None and self.tree.above.get(joint, -1) >= 0:
            from_ = self.tree.above[joint]
            aim = self.aims.get(from_, end)
        stand = self.world[joint] if axes is None else from_frame(axes, self.world[joint, 3, :3])
        normal, able = np.array([1.0, 0.0, 0.0]), False
        if aim.direction is not None:
            along = dot(transform_directions(aim.direction, self.world[from_]), normalise(stand[:3, :3]))
            axis = first_largest(np.abs(along))
            normal = np.where(np.arange(3) == axis, np.sign(along[axis]), 0.0)
            able = bool(from_ == joint and np.abs(along).max() > _ALONG) and self.sections.is_skinned(joint)
        return bone, normal, stand[3, :3], normalise(transform_directions(normal, stand)), able

    def of_ends(self, limbs: Iterable[tuple[int, int]]) -> float:
        """How thick a limb is, the first, where it arrives at its end, and its twin, if any: half the edge of
        a cube. limbs: middle and end of each."""
        edges = [self._of_end(middle, joint) for middle, joint in limbs]
        return _of_twins(edges, edges)

    def _of_end(self, middle: int, joint: int) -> float:
        end, bone = self.world[joint, 3, :3], self.world[joint, 3, :3] - self.world[middle, 3, :3]
        for place in (end - bone * BEFORE, end) if bone.any() else ():
            thick = self.sections.thickness([middle, joint], place, normalise(bone))
            if thick > 0:
                return MARGIN * thick
        return self.of(joint)[0]


def _of_twins(sizes: Sequence[float], widths: Sequence[float]) -> float:
    """The size of a control, the first of the sizes, as large as its twin's, if any: one look, left to right.

    Not where the twin has far more around it, as a shield: widths say how far the own skin of each reaches. A
    ring that is wider because other skin hides it on one side alone, by a little, is so on both.
    """
    pairs = zip(sizes, widths, strict=True)
    return max(size for size, width in pairs if size <= _WIDER * sizes[0] or 0 < width <= _WIDER * widths[0])


class SkinSections:
    """The meshes of a rig at rest, which planes through joints cut."""

    def __init__(self, tree: Skeleton) -> None:
        self.tree = tree
        rig = self.rig = tree.rig
        # By the number of the character.
        self._extents: dict[int, float] = {}
        # Asked of a joint for itself and for its twin, by `_key`.
        self._known_cuts: dict[Key, list[tuple[Floats, Floats]]] = {}
        self._known_widths: dict[Key, float] = {}
        self._known_radii: dict[Key, float] = {}
        self._by_skin: dict[int, list[SkinnedMesh]] = {}
        # By the joint that a mesh is, or is below.
        self._by_joint: dict[int, list[SkinnedMesh]] = {}
        joints = set(tree.joints)
        for mesh in each_place(rig.meshes):
            if mesh.skin is not None and mesh.joints.shape[1]:
                self._by_skin.setdefault(mesh.skin, []).append(SkinnedMesh(rig, mesh))
            else:
                above = (node for node in rig.path_to_root(mesh.node) if node in joints)
                self._by_joint.setdefault(next(above, -1), []).append(SkinnedMesh(rig, mesh))

    def radius(self, joint: int, place: Floats, normal: Floats) -> float:
        """How wide a ring around a place, (3,), must be in the plane square to ``normal``, (3,) unit.

        The joint's own skin lies inside it, where the plane cuts that; else all of it, seen along the normal.
        The other leg, or the trunk below a clavicle, is not looked at; but where half of the ring would be
        hidden in them it is up to `_WIDER` as wide, and where most of it would still be, up to `_WIDEST` of
        the character. What a joint without skin holds counts up to `_WIDER` as wide as the skin of the joint
        above, or a weapon's ring would be as wide as the weapon is long.
        0 without any skin. File units, in the world.
        """
        if (key := _key(joint, place, normal)) not in self._known_radii:
            self._known_radii[key] = self._radius(joint, place, normal)
        return self._known_radii[key]

    def _radius(self, joint: int, place: Floats, normal: Floats) -> float:
        own = self.width(joint, place, normal)
        if own == 0:
            return 0.0
        cuts = self._cuts(joint, place, normal)
        ends, most = farthest([lines for lines, _ in cuts], normal), _WIDER * own
        if ends[_SEEN] > most:
            widest = max(most, _WIDEST * self._extent_of(joint))
            most = widest if half(ends) <= widest else outside(most, widest, cuts, normal)
        return max(own, min(half(ends), most))

    def width(self, joint: int, place: Floats, normal: Floats) -> float:
        """How far the skin near a joint reaches in the plane, as `radius` counts it; 0 without any skin."""
        if (key := _key(joint, place, normal)) not in self._known_widths:
            self._known_widths[key] = self._width(joint, self._near(joint), place, normal)
        return self._known_widths[key]

    def shows(self, joint: int, place: Floats, normal: Floats) -> bool:
        """Whether a ring around a place, (3,), square to ``normal``, (3,), is a quarter inside skin at most.

        A shoulder's ring cuts the trunk, and one around the upper arm does not.
        """
        near = list(self._of([joint]))
        own, cuts = self._width(joint, near, place, normal), self._cuts(joint, place, normal)
        radius = max(own, min(half(farthest([lines for lines, _ in cuts], normal)), _WIDER * own))
        return own > 0 and 4 * inside(radius, *crossed(cuts, normal)) <= len(AROUND)

    def is_skinned(self, joint: int) -> bool:
        """Whether a joint has skin of its own, or, of a body that has none, a mesh."""
        near = list(self._of([joint]))
        return bool(near) and not (self._by_skin and self._holds(near))

    def _width(
        self, joint: int, near: list[tuple[SkinnedMesh, Integers]], place: Floats, normal: Floats
    ) -> float:
        """How far the skin near a joint reaches; what it holds, `_WIDER` as far as the skin above at most."""
        own = _width(near, place, normal)
        above = self.rig.path_to_root(joint)[1:] if self._holds(near) else []
        if skin := next(filter(None, (list(self._skin_of([node])) for node in above)), []):
            own = min(own, _WIDER * _width(skin, place, normal))
        return own

    def _cuts(self, joint: int, place: Floats, normal: Floats) -> list[tuple[Floats, Floats]]:
        # Whether a ring shows at a place is asked first, and then how large it is there.
        if (key := _key(joint, place, normal)) not in self._known_cuts:
            self._known_cuts[key] = [
                skinned.signed_cut(skinned.triangles_near(place, normal), place, normal)
                for skinned in self._body_of(joint)
            ]
        return self._known_cuts[key]

    def thickness(self, joints: list[int], place: Floats, normal: Floats) -> float:
        """How thick the skin of joints is in the plane: as `radius`, but half of the directions are enough.

        So the length of a foot does not count where its ankle is low.
        """
        cuts = [skinned.cut_of(vertices, place, normal) for skinned, vertices in self._of(joints)]
        return half(farthest(cuts, normal))

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

    def _near(self, joint: int) -> list[tuple[SkinnedMesh, Integers]]:
        """As `_of` a joint, or where it has none its neighbours, or the nearest joint above that has some."""
        return next(filter(None, map(self._of, self._nearer_first(joint))), [])

    def _nearer_first(self, joint: int) -> Iterator[list[int]]:
        """A joint, its neighbours, and one by one those above, which few ask for."""
        above = int(self.rig.parents[joint])
        yield [joint]
        yield [*([above] if above >= 0 else []), *self.rig.children[joint]]
        yield from ([node] for node in self.rig.path_to_root(above)[1:])

    def _holds(self, near: list[tuple[SkinnedMesh, Integers]]) -> bool:
        """Whether meshes are held or worn: there are some, and they have no skin."""
        return bool(near) and all(skinned.mesh.skin is None for skinned, _ in near)

    def _of(self, joints: list[int]) -> list[tuple[SkinnedMesh, Integers]]:
        """The meshes that have skin of joints, and which vertices of each, (v,).

        Meshes that are below joints are the body where there is no skin; else they are held or worn.
        """
        found = list(self._skin_of(joints))
        if not found:
            rigid = (mesh for node in joints for mesh in self._by_joint.get(node, ()))
            found = [(mesh, np.arange(len(mesh.points))) for mesh in rigid if mesh.usable]
        return found

    def _skin_of(self, joints: list[int]) -> Iterator[tuple[SkinnedMesh, Integers]]:
        for skin, meshes in self._by_skin.items():
            rows = [row for k in joints for row in self._rows[skin].get(k, ())]
            for skinned in meshes if rows else ():
                own = skinned.vertices_of(rows)
                if len(own) and skinned.usable:
                    yield skinned, own

    def _body_of(self, joint: int) -> list[SkinnedMesh]:
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
    def _bodies(self) -> tuple[dict[int, list[SkinnedMesh]], dict[int, int]]:
        """The meshes of each character, and to which each node belongs; −1 for none."""
        numbers = {node: k for k, nodes in enumerate(characters(self.rig)) for node in nodes}
        found: dict[int, list[SkinnedMesh]] = {}
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


def _key(joint: int, place: Floats, normal: Floats) -> Key:
    return joint, place.tobytes(), normal.tobytes()


def _width(near: list[tuple[SkinnedMesh, Integers]], place: Floats, normal: Floats) -> float:
    """How far skin reaches from a place where the plane cuts it; else all of it, seen along the normal."""
    own = whole = 0.0
    for skinned, vertices in near:
        flat, _ = seen_from(skinned.points[vertices], place, normal)
        whole = max(whole, float(length(flat).max(initial=0.0)))
        lines = skinned.cut_of(vertices, place, normal)
        own = max(own, float(length(lines).max(initial=0.0)))
    return own or whole
