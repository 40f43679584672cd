"""Meshes of a glTF file, read only to measure what joints move.

Whatever is wrong with a mesh is a notice and leaves that mesh out: it must not
cost an edit of the rig.

Source: glTF 2.0 §3.7.2 (meshes, morph targets), §3.7.3 (skins).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.gltf.accessors import Accessors
from rigtri.formats.gltf.nodes import Tree
from rigtri.formats.gltf.values import Value
from rigtri.report import Notice
from rigtri.rig import Booleans, Integers, Mesh, Skin, Surface
from rigtri.trigonometry import Floats

DRACO = "KHR_draco_mesh_compression"
# What a primitive draws, by its mode (§5.24.4).
MODES = ("points", "lines", "line loop", "line strip", "triangles", "triangle strip", "triangle fan")


class MeshReader:
    """Reads meshes of one file on demand, every accessor once."""

    def __init__(self, gltf: Value, accessors: Accessors, tree: Tree, notices: list[Notice]) -> None:
        self._gltf, self._accessors, self._tree, self._notices = gltf, accessors, tree, notices
        self._numbers: dict[int, Floats] = {}
        self._nodes: Sequence[Any] = gltf.object().get("nodes", [])
        self._meshes: Sequence[Any] = gltf.object().get("meshes", [])

    def read(self, skins: Sequence[Skin]) -> list[Mesh]:
        """One Mesh for each primitive of each node that shows a mesh."""
        found = []
        for node, primitives in self._shown():
            for number, primitive in enumerate(primitives):
                try:
                    mesh = self._mesh(node, number, primitive, skins)
                except FileError as error:
                    self._notice(f"{error}")
                else:
                    found += [mesh] if mesh is not None else []
        return found

    def weighted(self, number: int, count: int) -> Booleans:
        """Which of the ``count`` joints of skin ``number`` move any point; all where nobody can tell."""
        moves, known = np.zeros(count, dtype=bool), False
        for node, primitives in self._shown():
            if self._nodes[node].get("skin") != number:
                continue
            for primitive in primitives:
                try:
                    joints, weights = self._influences(primitive)
                except FileError:
                    return np.ones(count, dtype=bool)
                live = joints[weights > 0]
                moves[live[(live >= 0) & (live < count)]] = True
                known = True
        return moves if known else np.ones(count, dtype=bool)

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

    def _mesh(self, node: int, number: int, primitive: Value, skins: Sequence[Skin]) -> Mesh | None:
        raw = self._nodes[node]
        mesh = self._meshes[int(raw["mesh"])]
        attributes = primitive.need("attributes").object()
        if "POSITION" not in attributes:
            return None
        points = self._read(primitive, "POSITION", 3)
        skin, joints, weights = None, np.zeros((len(points), 0), dtype=np.int64), np.zeros((len(points), 0))
        if raw.get("skin") is not None and "JOINTS_0" in attributes:
            skin = Value(raw["skin"], f"{self._gltf.where} nodes[{node}].skin").index(len(skins), "skin")
            joints, weights = self._influences(primitive)
            joints, weights = _within(primitive, joints, weights, len(skins[skin].joints))
            if len(joints) != len(points):
                primitive.fail(f"has {len(points)} positions and {len(joints)} sets of joints")
        morphs = self._morphs(primitive, mesh, points)
        name = raw.get("name") or mesh.get("name") or f"#{node}"
        return Mesh(
            name=f"{name}/{number}",
            node=self._tree.place[node],
            points=points,
            skin=skin,
            joints=joints,
            weights=weights,
            morphs=morphs,
            morph_weights=self._morph_weights(node, mesh, len(morphs)),
            surface=lambda: self._surface(primitive, len(points)),
        )

    def _surface(self, primitive: Value, points: int) -> Surface | None:
        """Faces and normals; None where they cannot be read."""
        try:
            mode = primitive.natural("mode", 4)
            kind = MODES[mode] if mode < len(MODES) else f"mode {mode}"
            none = np.zeros(0, dtype=np.int64)
            corners, normals = np.arange(points), np.zeros((0, 3))
            if primitive.get("indices") is not None:
                corners = self._numbers_of(primitive.need("indices"), 1)[:, 0].astype(np.int64)
            if "NORMAL" in primitive.need("attributes").object():
                normals = self._read(primitive, "NORMAL", 3)
        except FileError as error:
            self._notice(str(error))
            return None
        return Surface(kind, none, corners, normals)

    def _read(self, primitive: Value, name: str, width: int) -> Floats:
        """The numbers of an attribute, (count, width)."""
        extensions = primitive.get("extensions")
        if extensions is not None and DRACO in extensions.object():
            primitive.fail(f"is compressed with {DRACO}")
        return self._numbers_of(primitive.need("attributes").need(name), width)

    def _numbers_of(self, item: Value, width: int) -> Floats:
        index = item.index(len(self._accessors), "accessor")
        if index not in self._numbers:
            self._numbers[index] = self._accessors.read(index)
        numbers = self._numbers[index]
        if numbers.shape[1] != width:
            item.fail(f"the accessor should have {width} numbers for each point, not {numbers.shape[1]}")
        return numbers

    def _influences(self, primitive: Value) -> tuple[Integers, Floats]:
        """Joints and weights of all sets, (v, 4·sets)."""
        attributes = primitive.need("attributes").object()
        joints, weights = [np.zeros((0, 0))], [np.zeros((0, 0))]
        sets = 0
        while f"JOINTS_{sets}" in attributes and f"WEIGHTS_{sets}" in attributes:
            joints.append(self._read(primitive, f"JOINTS_{sets}", 4))
            weights.append(self._read(primitive, f"WEIGHTS_{sets}", 4))
            sets += 1
        if len({len(rows) for rows in (*joints[1:], *weights[1:])}) > 1:
            primitive.fail("has sets of joints and weights of different lengths")
        together = np.concatenate(joints[1:], axis=1) if sets else joints[0]
        # What is no number, or none that an index can be, is no joint either.
        together = np.where(np.abs(together) < 1 << 31, together, -1.0)
        return together.astype(np.int64), np.concatenate(weights[1:], axis=1) if sets else weights[0]

    def _morphs(self, primitive: Value, mesh: dict[str, Any], points: Floats) -> Floats:
        """Offsets of all targets, (t, v, 3); zero for a target that moves no points."""
        targets = list(primitive.each("targets"))
        offsets = np.zeros((len(targets), *points.shape))
        for row, target in zip(offsets, targets, strict=True):
            if "POSITION" in target.object():
                found = self._numbers_of(target.need("POSITION"), 3)
                if len(found) != len(points):
                    target.fail(f"moves {len(found)} points of {len(points)}")
                row[:] = found
        return offsets

    def _morph_weights(self, node: int, mesh: dict[str, Any], count: int) -> Floats:
        raw = self._nodes[node].get("weights", mesh.get("weights"))
        if raw is None or not count:
            return np.zeros(count)
        return np.array(Value(raw, f"{self._gltf.where} weights of nodes[{node}]").numbers(count))


def _within(primitive: Value, joints: Integers, weights: Floats, count: int) -> tuple[Integers, Floats]:
    """Joint indices that all exist; those without weight may have been anything."""
    outside = (joints < 0) | (joints >= count)
    # A weight that is no number gives a point that is none, whatever the joint.
    wrong = outside & (weights != 0) & ~np.isnan(weights)
    if wrong.any():
        worst = joints[wrong][0]
        primitive.fail(f"uses joint {worst} of a skin that has {count}")
    return np.where(outside, 0, joints), weights
