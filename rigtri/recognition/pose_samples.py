"""Sampled joint positions: at rest, in the bind pose, and at times of the clips."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from rigtri.errors import FileError
from rigtri.evaluation.bind_pose import bind_frames, bind_worlds, bind_worlds_of
from rigtri.evaluation.sampling import worlds
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import compose, from_frame, multiply, transform_directions, transform_points
from rigtri.maths.quaternions import to_axes
from rigtri.maths.scalar_vector import Vector
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Column
from rigtri.model.bounding_boxes import boxes, corners
from rigtri.model.characters import characters
from rigtri.model.dataclass import dataclass
from rigtri.model.hierarchy import Hierarchy
from rigtri.model.rig import Rig
from rigtri.model.skin import moving_points
from rigtri.recognition.joint_tree import Tree, joints_of
from rigtri.recognition.layout import PoseName
from rigtri.recognition.naming_schemes import roles_in_name
from rigtri.recognition.symmetry import Pair, Plane, pairs_of, plane_of
from rigtri.recognition.untwisted import Twist

# Moments that are looked at: so many clips, the longest first, at these parts of their keys.
CLIPS = 4
PARTS = (0.0, 0.25, 0.5, 0.75)


@dataclass(eq=False)
class Measured:
    """A tree of joints, the pairs of its branches that are alike, and the plane between all of them."""

    tree: Tree

    @cached_property
    def pairs(self) -> list[Pair]:
        return pairs_of(self.tree)

    @cached_property
    def plane(self) -> Plane | None:
        return plane_of(self.tree, self.pairs)

    @cached_property
    def rough_pairs(self) -> list[Pair]:
        """The pairs if noise has changed the lengths of bones."""
        return pairs_of(self.tree, rough=True)

    @cached_property
    def rough_plane(self) -> Plane | None:
        return plane_of(self.tree, self.rough_pairs)


@dataclass(eq=False)
class Poses:
    """The poses of a rig, each where its nodes stand, (n, 3), made when needed."""

    rig: Rig

    @cached_property
    def _nameless(self) -> Rig:
        """The same rig without names: one for all its characters, for what it knows of its hierarchy."""
        return replace(self.rig, names=("",) * len(self.rig))

    def without_names(self) -> Poses:
        """The poses of the same rig whose nodes have no names, as far as they are known."""
        bare = Poses(self._nameless)
        vars(bare).update({key: known for key, known in vars(self).items() if key != "rig"})
        return bare

    @cached_property
    def measured(self) -> dict[tuple[PoseName, tuple[int, ...]], Measured]:
        """What is measured of joints in a pose, whatever their names: once, for `without_names`, too."""
        return {}

    @cached_property
    def after(self) -> dict[int, int]:
        """For each joint that follows another beside it by its name, that one: see `order_in_names`.

        It is how joints hang together, so what looks at shape alone has it, too.
        """
        return {}

    @cached_property
    def rest(self) -> Floats:
        return finite(self.rig.world[:, 3, :3])

    @cached_property
    def bind(self) -> Floats | None:
        """The bind pose of each character's skin with most joints; None where it is no pose."""
        world = bind_pose(self.rig)
        return None if world is None else world[:, 3, :3]

    @cached_property
    def moving(self) -> Floats:
        """Moments of the longest clips, (f, n, 3); f is 0 without clips.

        Rotations alone are taken, at keys: bones keep their lengths. What is no body's, as other characters
        are while one is edited, stays as it rests.
        """
        rig, counted = self.rig, [(_rotations(clip), clip) for clip in self.rig.shown_clips]
        longest = sorted(counted, key=lambda each: -each[0])[:CLIPS]
        clips = [clip for rotations, clip in longest if rotations]
        if not clips:
            return np.zeros((0, len(rig), 3))
        body = np.array(sorted(rig.with_ancestors(joints_of(rig))), dtype=np.int64)
        place = np.full(len(rig), -1)
        place[body] = np.arange(len(body))
        rotation = np.tile(rig.rotation[body], (len(clips), len(PARTS), 1, 1))
        for clip, moments in zip(clips, rotation, strict=True):
            for column in clip.columns:
                if column.path == "rotation" and len(column.times):
                    keys = [int(part * len(column.times)) for part in PARTS]
                    rows = np.flatnonzero(place[column.nodes] >= 0)
                    moved = column.at_keys(keys)[rows]
                    moments[:, place[column.nodes[rows]]] = moved.swapaxes(0, 1)
        local = compose(rig.translation[body], rotation.reshape(-1, len(body), 4), rig.scale[body])
        fixed = rig.has_matrix[body]
        local[:, fixed] = rig.matrix[body[fixed]]
        below = Hierarchy()
        below.parents = np.where(rig.parents[body] < 0, -1, place[rig.parents[body]])
        places = np.tile(self.rest, (len(local), 1, 1))
        places[:, body] = finite(worlds(below, local)[..., 3, :3])
        return places

    def travel(self, nodes: Sequence[int]) -> Vector:
        """Which way the highest of the joints that clips move goes in them; zero for on the spot."""
        key = tuple(nodes)
        if key not in self._travelled:
            self._travelled[key] = self._travel(key)
        return self._travelled[key]

    @cached_property
    def _travelled(self) -> dict[tuple[int, ...], Vector]:
        return {}

    def _travel(self, nodes: Sequence[int]) -> Vector:
        rig, inside, total = self.rig, set(nodes), Vector()
        for moved, rows in self._translations:
            tops = [each for each in rows if each[0] in inside]
            if tops:
                top, k, row = min(tops)  # parents come first
                start, end = moved[k].at_keys((0, -1))[row]
                way = end - start
                above = int(rig.parents[top])
                total = total + Vector(*(transform_directions(way, rig.world[above]) if above >= 0 else way))
        return total

    @cached_property
    def _translations(self) -> list[tuple[list[Column], list[tuple[int, int, int]]]]:
        """What moves nodes in each clip: its columns, and of each row its node, column and place there."""
        found = []
        for clip in self.rig.shown_clips:
            moved = [c for c in clip.columns if c.path == "translation" and len(c.times) > 1]
            rows = [
                (node, k, row)
                for k, column in enumerate(moved)
                for row, node in enumerate(column.nodes.tolist())
            ]
            found.append((moved, rows))
        return found

    @cached_property
    def _moving(self) -> Booleans:
        return moving_points(self.rig.skins, len(self.rig))

    @cached_property
    def weighed(self) -> Booleans:
        """Which nodes move points of skins whose weights can be read, (n,)."""
        return moving_points((skin for skin in self.rig.skins if skin.weigh), len(self.rig))

    def roles_of(self, node: int) -> frozenset[str]:
        """The roles that a joint's name says; what moves points is no control, however it is called."""
        roles = frozenset(roles_in_name(self.rig.names[node]))
        return roles - {"control"} if "control" in roles and self.weighed[node] else roles

    def moves_points(self, node: int) -> bool:
        """Whether a joint has weight of any point. It reads the weights of all meshes when first called."""
        return bool(self._moving[node])

    def moves_anything(self, node: int) -> bool:
        """Whether a joint moves points, or in a file without skins shows a mesh, itself or by a child."""
        if self.rig.skins:
            return self.moves_points(node)
        return self.shows_mesh(node)

    def shows_mesh(self, node: int) -> bool:
        """Whether something is drawn at a node itself, or at a child."""
        return any(self.rig.attachment[k] >= 0 for k in (node, *self.rig.children[node]))

    @cached_property
    def has_weights(self) -> bool:
        """Whether any joint moves points: a skeleton alone, as for motion, has no skin."""
        return bool(self._moving.any())

    @cached_property
    def _boxes(self) -> dict[int, list[Floats]]:
        """For each joint the corners of the boxes of what it moves, (8, 3) each, in its own space."""
        found: dict[int, list[Floats]] = {}
        try:
            meshes = [mesh for mesh in self.rig.content.outlines if mesh.skin is not None]
        except FileError:
            return found
        for mesh in meshes:
            assert mesh.skin is not None
            skin = self.rig.skins[mesh.skin]
            # Of a box around all of a mesh no joint knows its part.
            if not mesh.fits(self.rig.skins) or (mesh.box is not None and mesh.box.ndim < 3):
                continue
            low, high = boxes(mesh, len(skin.joints))
            known = np.flatnonzero(np.isfinite(low).all(axis=1) & np.isfinite(high).all(axis=1))
            own = multiply(mesh.bind, skin.inverse_bind)[known, np.newaxis]
            for row, ends in zip(known, transform_points(corners(low[known], high[known]), own), strict=True):
                found.setdefault(int(skin.joints[row]), []).append(ends)
        return found

    @cached_property
    def _corners(self) -> dict[tuple[int, tuple[int, ...]], list[list[float]]]:
        return {}

    @cached_property
    def _turned(self) -> list[tuple[Floats, Floats]]:
        """Places, (n, 3), of poses with a chest turned back, and world matrices, (n, 4, 4)."""
        return []

    def turn(self, twist: Twist, pose: PoseName) -> None:
        """Take note of a pose with a chest turned back, for `box_of`."""
        world = self._world(bound=pose == "bind").copy()
        there, back = from_frame(np.eye(3), twist.centre), from_frame(np.eye(3), -twist.centre)
        turn = multiply(multiply(back, from_frame(to_axes(twist.turn), np.zeros(3))), there)
        world[twist.turned] = multiply(world[twist.turned], turn)
        self._turned.append((twist.tree.places, world))

    def _world(self, *, bound: bool) -> Floats:
        bind = bind_pose(self.rig) if bound else None
        return self.rig.world if bind is None else bind

    def box_of(self, nodes: Sequence[int], places: Floats) -> list[list[float]]:
        """The corners of boxes of what joints move, three numbers each, where all nodes stand at ``places``.

        These are `rest` or `bind`, or those of a `turn`. It reads all meshes when first called.
        """
        turned = next((k for k, (known, _) in enumerate(self._turned) if known is places), None)
        key = (-1 if places is self.bind else -2) if turned is None else turned, tuple(nodes)
        if key not in self._corners:
            world = self._world(bound=key[0] == -1) if turned is None else self._turned[turned][1]
            self._corners[key] = self._box_of(nodes, world)
        return self._corners[key]

    def _box_of(self, nodes: Sequence[int], world: Floats) -> list[list[float]]:
        boxes_of = [(k, box) for k in nodes for box in self._boxes.get(k, ())]
        if not boxes_of:
            return []
        ends = transform_points(
            np.stack([box for _, box in boxes_of]), world[[k for k, _ in boxes_of], np.newaxis]
        )
        found: list[list[float]] = finite(ends).reshape(-1, 3).tolist()
        return found

    def named(self, pose: PoseName) -> Floats:
        return self.bind if pose == "bind" and self.bind is not None else self.rest


def how_far(points: Iterable[Iterable[float]], start: Vector, way: Vector) -> list[float]:
    """How far each of some points, three numbers each, is from a place in a direction."""
    x, y, z = start
    u, v, w = way
    return [(a - x) * u + (b - y) * v + (c - z) * w for a, b, c in points]


def bind_pose(rig: Rig) -> Floats | None:
    """World matrices, (n, 4, 4), with each character in the bind pose of its skin with most joints.

    None where that of the largest skin is no pose; of other characters, these then stand as they rest.
    """
    stored = [skin for skin in rig.skins if skin.stored and len(skin.joints) > 1]
    largest = sorted(stored, key=lambda skin: -len(skin.joints))
    if not largest or not np.isfinite(bind_worlds(rig, largest[0])[:, 3, :3]).all():
        return None
    number = np.full(len(rig), -1)
    for k, nodes in enumerate(characters(rig) if len(largest) > 1 else ()):
        number[nodes] = k
    of_each = {number[skin.joints[0]]: skin for skin in reversed(largest)}
    if len(of_each) == 1:
        return bind_worlds(rig, largest[0])
    return bind_worlds_of(
        rig, [skin for skin in of_each.values() if np.isfinite(bind_frames(rig, skin)[:, 3, :3]).all()]
    )


def _rotations(clip: Clip) -> int:
    return sum(len(c) for c in clip.columns if c.path == "rotation" and len(c.times) > 1)


def finite(numbers: Floats, other: float = 0.0) -> Floats:
    """The numbers, with another for those that are none or without end."""
    return np.where(np.isfinite(numbers), numbers, other)
