"""Meshes of a glTF file, read only to measure what joints move.

Whatever is wrong with a mesh is a notice and leaves that mesh out: it must not
cost an edit of the rig.

Source: glTF 2.0 §3.7.2 (meshes, morph targets), §3.7.3 (skins).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.gltf.accessors import Accessors
from rigtri.formats.gltf.node_reader import Tree
from rigtri.formats.json_values import Value, name_in
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.trigonometry import Floats
from rigtri.model.bounding_boxes import boxes, extent
from rigtri.model.mesh import Mesh, Surface
from rigtri.model.skin import Skin
from rigtri.report import Notice

DRACO = "KHR_draco_mesh_compression"
# What a primitive draws, by its mode (§5.24.4).
MODES = ("points", "lines", "line loop", "line strip", "triangles", "triangle strip", "triangle fan")
# Reading a point with its joints and weights takes some 400 bytes, an offset of a morph a few.
MOST_POINTS, OFFSETS_TO_A_POINT = 150_000, 8
# Offsets of one primitive that are read at once: 800 MB.
MOST_OFFSETS = 1 << 25
# Rows read at a time of what is read in parts.
BLOCK = 1 << 15
# Of what is outlined: so many samples of so many rows each.
SAMPLES, SAMPLE = 16, 256
# Joints and weights of so many primitives of one block are kept.
MOST_KEPT = 16
# A point counts as inside a box that misses it by this share of the coordinates.
WITHIN = 1e-6

Crowd = Literal["points", "stated", "closely"]
Some = Sequence[tuple[int, int]] | None


class MeshReader:
    """Reads meshes of one file on demand, every accessor once."""

    def __init__(self, gltf: Value, accessors: Accessors, tree: Tree, notices: list[Notice]) -> None:
        self._gltf, self._accessors, self._tree, self._notices = gltf, accessors, tree, notices
        self._numbers: dict[int, Floats] = {}
        # Joints and weights of small primitives, whose joints were needed, until they are read.
        self._influenced: dict[int, tuple[Integers, Floats]] = {}
        self._nodes: Sequence[Any] = gltf.object().get("nodes", [])
        self._meshes: Sequence[Any] = gltf.object().get("meshes", [])

    def read(self, skins: Sequence[Skin], crowd: Crowd = "points") -> list[Mesh]:
        """One Mesh for each primitive of each node that shows a mesh.

        crowd: what to read of `crowd`, all points or outlines. Instances have the same arrays.
        """
        found, known = [], dict[tuple[object, ...], Mesh | None]()
        for node, primitives in self._shown:
            for number, primitive in enumerate(primitives):
                boxed, raw = crowd != "points" and (node, number) in self.crowd, self._nodes[node]
                same = id(primitive.raw), boxed, *(repr(raw.get(each)) for each in ("skin", "weights"))
                try:
                    if (one := known.get(same)) is not None:
                        mesh: Mesh | None = replace(one, **self._named(node, number))
                    elif boxed:
                        mesh = self._outline(node, number, primitive, skins, stated=crowd == "stated")
                    else:
                        mesh = self._mesh(node, number, primitive, skins)
                    known[same] = mesh
                except FileError as error:
                    self._notice(f"{error}")
                else:
                    found += [mesh] if mesh is not None else []
        self._numbers.clear()
        self._influenced.clear()
        return found

    def outlines(self, skins: Sequence[Skin], *, closely: bool = False) -> list[Mesh]:
        """The same; where there are very many points, some of them and boxes for the largest meshes."""
        if not self.crowd:
            return self.read(skins)
        return self.read(skins, "closely" if closely else "stated")

    @cached_property
    def crowd(self) -> set[tuple[int, int]]:
        """Node and number of the primitives to outline: the largest, until few enough points are left."""
        sizes: dict[tuple[int, int], int] = {}
        for node, primitives in self._shown:
            for number, primitive in enumerate(primitives):
                try:
                    rows, targets = self._rows(primitive), len(list(primitive.each("targets")))
                except FileError:
                    continue  # it cannot be read, as reading it will report
                sizes[node, number] = rows + rows * targets // OFFSETS_TO_A_POINT
        left, crowd = sum(sizes.values()), set()
        for place in sorted(sizes, key=lambda place: -sizes[place]):
            if left <= MOST_POINTS:
                break
            left -= sizes[place]
            crowd.add(place)
        return crowd

    def _rows(self, primitive: Value) -> int:
        """How many points a primitive has, 0 where that is not stated."""
        item = primitive.need("attributes").get("POSITION")
        if item is None:
            return 0
        return self._accessors.layout(item.index(len(self._accessors), "accessor")).rows

    def _outline(
        self, node: int, number: int, primitive: Value, skins: Sequence[Skin], *, stated: bool
    ) -> Mesh | None:
        """Some points of a primitive with the boxes of all."""
        rows = self._rows(primitive)
        some = [(start, start + SAMPLE) for start in range(0, rows, max(rows // SAMPLES, SAMPLE))]
        mesh = self._mesh(node, number, primitive, skins, some)
        if mesh is None:
            return None
        box = self._stated_box(primitive, mesh) if stated else None
        if box is None:
            box = self._box(node, number, primitive, skins)
        return replace(mesh, box=box)

    def _stated_box(self, primitive: Value, sample: Mesh) -> Floats | None:
        """The box, (2, 3), that a file states for points and morphs; None where it does not, or wrongly."""
        try:
            box = self._bounds(primitive.need("attributes"))
            offsets = [
                self._bounds(target) for target in primitive.each("targets") if "POSITION" in target.raw
            ]
        except FileError:
            return None
        if box is None or len(offsets) != len(sample.morphs):
            return None
        size = float(np.abs(box).max()) * WITHIN
        if (sample.points < box[0] - size).any() or (sample.points > box[1] + size).any():
            return None
        for bounds, weight in zip(offsets, sample.morph_weights, strict=True):
            if bounds is None:
                return None
            ways = np.concatenate([bounds * min(weight, 0.0), bounds * max(weight, 1.0)])
            box = np.add(box, [ways.min(axis=0), ways.max(axis=0)])
        return box

    def _bounds(self, attributes: Value) -> Floats | None:
        index = attributes.need("POSITION").index(len(self._accessors), "accessor")
        return self._accessors.stated(index)

    def _box(self, node: int, number: int, primitive: Value, skins: Sequence[Skin]) -> Floats:
        """The box of what each joint moves, (2, m, 3), or of a rigid mesh, (2, 3); block by block."""
        low, high = np.full((1, 3), np.inf), np.full((1, 3), -np.inf)
        for block in _blocks(self._rows(primitive)):
            mesh = self._mesh(node, number, primitive, skins, [block])
            assert mesh is not None  # it has points
            if mesh.skin is not None and mesh.joints.shape[1]:
                near, far = boxes(mesh, len(skins[mesh.skin].joints))
            else:
                near, far = (x[np.isfinite(x).all(axis=1)] for x in extent(mesh))
                near = near.min(axis=0, initial=np.inf, keepdims=True)
                far = far.max(axis=0, initial=-np.inf, keepdims=True)
            low, high = np.minimum(low, near), np.maximum(high, far)
        box = np.stack([low, high])
        return box[:, 0] if box.shape[1] == 1 else box

    def weighted(self, number: int, count: int) -> Booleans:
        """Which of the ``count`` joints of skin ``number`` move any point; all where that is unknown."""
        moves = np.zeros(count, dtype=bool)
        shown = (primitives for node, primitives in self._shown if self._nodes[node].get("skin") == number)
        bound = {id(primitive.raw): primitive for primitives in shown for primitive in primitives}
        for primitive in bound.values():
            try:
                self._mark_moved(primitive, moves)
            except FileError:
                return np.ones(count, dtype=bool)
        return moves if bound else np.ones(count, dtype=bool)

    def _mark_moved(self, primitive: Value, moves: Booleans) -> None:
        """Mark the joints that move a point, until all are marked."""
        blocks = _blocks(self._rows(primitive))
        # Spread over the mesh: the first few may have met all joints.
        for block in (block for first in range(SAMPLES) for block in blocks[first::SAMPLES]):
            joints, weights = self._influences(primitive, [block])
            if len(joints) < BLOCK and len(self._influenced) < MOST_KEPT:  # these are all that it has
                self._influenced[id(primitive.raw)] = joints, weights
            joints, weights = _within(primitive, joints, weights, len(moves))
            moves[joints.ravel()[np.flatnonzero(weights != 0)]] = True
            if moves.all():
                return

    @cached_property
    def _shown(self) -> list[tuple[int, list[Value]]]:
        """Nodes with a mesh, and the primitives of that mesh."""
        shown = []
        for node, raw in enumerate(self._nodes):
            mesh = raw.get("mesh")
            if mesh is None:
                continue
            try:
                index = Value(mesh, f"{self._gltf.where} nodes[{node}].mesh").index(len(self._meshes), "mesh")
                value = Value(self._meshes[index], f"{self._gltf.where} meshes[{index}]")
                shown.append((node, list(value.need("primitives").items())))
            except FileError as error:
                self._notice(str(error))
        return shown

    def _notice(self, text: str) -> None:
        notice = Notice("mesh-unread", f"{text} (the mesh is kept, but not checked)")
        if notice not in self._notices:
            self._notices.append(notice)

    def _mesh(
        self, node: int, number: int, primitive: Value, skins: Sequence[Skin], some: Some = None
    ) -> Mesh | None:
        """A primitive, or ``some`` rows of it; None where it has no points."""
        raw = self._nodes[node]
        mesh = self._meshes[int(raw["mesh"])]
        attributes = primitive.need("attributes").object()
        if "POSITION" not in attributes:
            return None
        points = self._read(primitive, "POSITION", 3, some)
        skin, joints, weights = None, np.zeros((len(points), 0), dtype=np.int64), np.zeros((len(points), 0))
        if raw.get("skin") is not None and "JOINTS_0" in attributes:
            skin = Value(raw["skin"], f"{self._gltf.where} nodes[{node}].skin").index(len(skins), "skin")
            kept = self._influenced.get(id(primitive.raw)) if some is None else None
            if kept is None:
                kept = self._influences(primitive, some)
            joints, weights = kept
            joints, weights = _within(primitive, joints, weights, len(skins[skin].joints))
            if len(joints) != len(points):
                primitive.fail(f"has {len(points)} positions and {len(joints)} sets of joints")
        morphs = self._morphs(primitive, points, some)
        return Mesh(
            **self._named(node, number),
            points=points,
            skin=skin,
            joints=joints,
            weights=weights,
            morphs=morphs,
            morph_weights=self._morph_weights(node, mesh, len(morphs)),
            morph_names=_target_names((mesh, primitive.raw), len(morphs)),
            surface=lambda: self._surface(primitive, len(points)),
        )

    def _named(self, node: int, number: int) -> dict[str, Any]:
        """What a primitive has for itself of what a node shows."""
        raw = self._nodes[node]
        name = name_in(raw) or name_in(self._meshes[int(raw["mesh"])]) or f"#{node}"
        return {"name": f"{name}/{number}", "node": self._tree.place[node]}

    def _surface(self, primitive: Value, points: int) -> Surface | None:
        """Faces, normals and other values; None where they cannot be read."""
        try:
            mode = primitive.natural("mode", 4)
            kind = MODES[mode] if mode < len(MODES) else f"mode {mode}"
            none = np.zeros(0, dtype=np.int64)
            corners, normals = np.arange(points), np.zeros((0, 3))
            if primitive.get("indices") is not None:
                corners = self._numbers_of(primitive.need("indices"), 1, None)[:, 0].astype(np.int64)
            if "NORMAL" in primitive.need("attributes").object():
                normals = self._read(primitive, "NORMAL", 3, None)
            values = dict(self._values(primitive))
        except FileError as error:
            self._notice(str(error))
            return None
        return Surface(kind, none, corners, normals, values)

    def _values(self, primitive: Value) -> Iterator[tuple[str, Floats]]:
        """Colours, texture coordinates and what else points have, and what morph targets do to them."""
        holders = [("", primitive.need("attributes"))]
        holders += [(f" of morph target {k}", x) for k, x in enumerate(primitive.each("targets"))]
        for of, holder in holders:
            for name, item in holder.members():
                moved = name == "POSITION" or (name == "NORMAL" and not of)
                if not moved and not name.startswith(("JOINTS_", "WEIGHTS_")):
                    yield f"{name}{of}", self._accessors.read(item.index(len(self._accessors), "accessor"))

    def _read(self, primitive: Value, name: str, width: int, some: Some) -> Floats:
        """The numbers of an attribute, (count, width)."""
        extensions = primitive.get("extensions")
        if extensions is not None and DRACO in extensions.object():
            primitive.fail(f"is compressed with {DRACO}")
        return self._numbers_of(primitive.need("attributes").need(name), width, some)

    def _numbers_of(self, item: Value, width: int, some: Some) -> Floats:
        index = item.index(len(self._accessors), "accessor")
        if some is not None and self._accessors.has_rows(index):
            numbers = np.concatenate([self._accessors.rows(index, *block) for block in some])
        else:
            if index not in self._numbers:
                self._numbers[index] = self._accessors.read(index)
            whole = self._numbers[index]
            numbers = whole if some is None else np.concatenate([whole[slice(*block)] for block in some])
        if numbers.shape[1] != width:
            item.fail(f"the accessor should have {width} numbers for each vertex, not {numbers.shape[1]}")
        return numbers

    def _influences(self, primitive: Value, some: Some = None) -> tuple[Integers, Floats]:
        """Joints and weights of all sets, (v, 4·sets)."""
        attributes = primitive.need("attributes").object()
        joints, weights = [np.zeros((0, 0))], [np.zeros((0, 0))]
        sets = 0
        while f"JOINTS_{sets}" in attributes and f"WEIGHTS_{sets}" in attributes:
            joints.append(self._read(primitive, f"JOINTS_{sets}", 4, some))
            weights.append(self._read(primitive, f"WEIGHTS_{sets}", 4, some))
            sets += 1
        if len({len(rows) for rows in (*joints[1:], *weights[1:])}) > 1:
            primitive.fail("has sets of joints and weights of different lengths")
        together = _side_by_side(joints)
        # What is no number, or none that an index can be, is no joint either.
        if not (np.abs(together).max(initial=0.0) < 1 << 31):
            together = np.where(np.abs(together) < 1 << 31, together, -1.0)
        return together.astype(np.int64), _side_by_side(weights)

    def _morphs(self, primitive: Value, points: Floats, some: Some) -> Floats:
        """Offsets of all targets, (t, v, 3); zero for a target that moves no points."""
        targets = list(primitive.each("targets"))
        if some is None and len(targets) * len(points) > MOST_OFFSETS:
            primitive.fail(
                f"has {len(targets)} morph targets of {len(points)} vertices, too many to move each"
            )
        offsets = np.zeros((len(targets), *points.shape))
        for row, target in zip(offsets, targets, strict=True):
            if "POSITION" in target.object():
                found = self._numbers_of(target.need("POSITION"), 3, some)
                if len(found) != len(points):
                    target.fail(f"moves {len(found)} vertices of {len(points)}")
                row[:] = found
        return offsets

    def _morph_weights(self, node: int, mesh: dict[str, Any], count: int) -> Floats:
        raw = self._nodes[node].get("weights", mesh.get("weights"))
        if raw is None or not count:
            return np.zeros(count)
        return np.array(Value(raw, f"{self._gltf.where} weights of nodes[{node}]").numbers(count))


class Drawn:
    """What a reader finds to be drawn with some skins, read once for all who measure it.

    It holds the reader and what was read, and neither holds it: a ring would keep the file open.
    """

    def __init__(self, reader: MeshReader, skins: Sequence[Skin]) -> None:
        self._reader, self._skins = reader, skins

    def meshes(self) -> Sequence[Mesh]:
        """Every primitive that can be read; the others are noticed."""
        return self._meshes

    @cached_property
    def _meshes(self) -> Sequence[Mesh]:
        return self._reader.read(self._skins)

    def outlines(self, *, closely: bool = False) -> Sequence[Mesh]:
        """The same; where a file has very many points, some of them and boxes for its largest meshes."""
        if not self._reader.crowd:
            return self._meshes
        return self._reader.outlines(self._skins, closely=closely)


def _blocks(rows: int) -> list[tuple[int, int]]:
    return [(start, start + BLOCK) for start in range(0, rows, BLOCK)]


def _target_names(holders: Sequence[Any], count: int) -> tuple[str, ...]:
    """What targets are called, by the extras of a mesh, or, as VRM 0 has it, of its primitive."""
    for holder in holders:
        extras = holder.get("extras")
        names = extras.get("targetNames") if isinstance(extras, dict) else None
        if isinstance(names, list) and len(names) == count and all(isinstance(name, str) for name in names):
            return tuple(names)
    return ()


def _side_by_side(sets: list[Floats]) -> Floats:
    """All sets behind the first, which is none, (v, 4·sets)."""
    return sets[-1] if len(sets) <= 2 else np.concatenate(sets[1:], axis=1)


def _within(primitive: Value, joints: Integers, weights: Floats, count: int) -> tuple[Integers, Floats]:
    """Joint indices that all exist; those without weight may have been anything."""
    if 0 <= int(joints.min(initial=0)) <= int(joints.max(initial=0)) < count:
        return joints, weights
    outside = (joints < 0) | (joints >= count)
    # A weight that is no number gives a point that is none, whatever the joint.
    wrong = outside & (weights != 0) & ~np.isnan(weights)
    if wrong.any():
        worst = joints[wrong][0]
        primitive.fail(f"uses joint {worst} of a skin that has {count}")
    return np.where(outside, 0, joints), weights
