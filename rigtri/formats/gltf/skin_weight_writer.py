"""Weights of meshes shared anew among joints, as a rig's redistributions and merges require.

Accessors may be shared, so changed influences get new ones; the old bytes stay. Whole numbers
stay whole, and a fifth joint of a point opens a second set. A fold gives points back what they
had, and where the old bytes are still there, they are used again.

Source: glTF 2.0 §3.7.3.3 (skinned mesh attributes).
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigtri.errors import FileError, FixedWeightsError
from rigtri.formats.gltf.accessors import COMPONENTS, FLOAT, FULL, Accessors
from rigtri.formats.gltf.buffer_writer import Role, Storage
from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite
from rigtri.formats.gltf.mesh_reader import DRACO
from rigtri.formats.json_values import Value
from rigtri.maths.arrays import Integers
from rigtri.maths.trigonometry import Floats
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.model.skin import JointMerge, WeightLimit, WeightRedistribution
from rigtri.model.skin_weights import SAME, folded, limited, shared, within
from rigtri.report import Notice

_ROLES: dict[int, Role] = {4: "influences 4", 8: "influences 8", 16: "influences 16"}
BYTE, SHORT = 5121, 5123


@dataclass(frozen=True, eq=False)
class _Influences:
    """What the sets of a primitive hold: joints and weights (v, 4·sets), and how they are stored.

    Weights are in the units of ``weight`` where that is an integer.
    """

    joints: Integers
    weights: Floats
    joint: int
    weight: int

    @property
    def full(self) -> int:
        """What the weights are a whole number of, 0 for floats."""
        return int(FULL.get(self.weight, 0))


class WeightWriter:
    """Carries the redistributions of a rig into a draft. where: what to call the file."""

    def __init__(self, draft: CopyOnWrite, storage: Storage, accessors: Accessors, where: str) -> None:
        self._draft, self._storage, self._accessors, self._where = draft, storage, accessors, where
        self._known: dict[tuple[Any, ...], Mapping[str, int | None]] = {}
        self._again_used: set[int] = set()
        # What this has added, which the file's own accessors do not have: rows as they are stored. And of
        # which of those each has taken the place.
        self._made: dict[int, NDArray[Any]] = {}
        self._instead: dict[int, int | None] = {}
        self.notices: list[Notice] = []
        self._rescaled = 0

    def write(self, rig: Rig) -> None:
        """Share weights in all meshes that are drawn with the skins of redistributions."""
        by_skin: dict[int, list[WeightRedistribution]] = {}
        for redistribution in rig.pending.weight_redistributions:
            by_skin.setdefault(int(str(rig.skins[redistribution.skin].key)), []).append(redistribution)
        folds = {int(str(rig.skins[fold.skin].key)): fold for fold in rig.pending.joint_merges}
        for skin in {**by_skin, **folds}:
            for mesh in self._meshes(skin):
                if skin in by_skin or not folds[skin].idle:  # else joints of no weight alone are renamed
                    self._check_alone(mesh, {skin})
                for number, primitive in enumerate(self._primitives(mesh)):
                    self._primitive(mesh, number, primitive, skin, by_skin.get(skin, ()), folds.get(skin))

        if rig.pending.weight_limits:
            self._limit(rig)
        if self._rescaled:
            text = (
                f"{self._rescaled} vertices had more weight of a joint, all in all, than their numbers hold"
            )
            self.notices.append(Notice("weights-rescaled", f"{text}, so their weights sum to 1 now"))

    def _limit(self, rig: Rig) -> None:
        """Let the points of meshes have as many joints as allowed."""
        known: dict[tuple[Any, ...], Mapping[str, int | None]] = {}
        limits: dict[int, list[WeightLimit]] = {}
        for limit in rig.pending.weight_limits:
            for mesh in self._limited_meshes(rig, limit.skins):
                limits.setdefault(mesh, []).append(limit)
        for mesh, own in limits.items():
            for number, primitive in enumerate(self._primitives(mesh)):
                sets = self._sets(primitive)
                if not sets:
                    continue
                if _is_draco(primitive):
                    text = f"{self._where}: mesh '{self._title(mesh)}' is compressed with {DRACO}"
                    text += ", so its weights cannot be limited. Store it uncompressed"
                    raise FixedWeightsError(text)
                key = (*sets.values(), *own)
                if key not in known:
                    known[key] = self._limited(self._read(primitive, sets), sets, own)
                if known[key]:
                    owned = self._draft.edit("meshes", mesh, "primitives", number, "attributes")
                    owned.update({name: index for name, index in known[key].items() if index is not None})
                    for name in (name for name, index in known[key].items() if index is None):
                        owned.pop(name)

    def _limited_meshes(self, rig: Rig, skins: frozenset[int] | None) -> Sequence[int]:
        """The meshes that a limit is about: all of them, or those that are drawn with some skins."""
        if skins is None:
            return range(len(self._draft.gltf.get("meshes", [])))
        numbers = {int(str(rig.skins[skin].key)) for skin in skins}
        meshes = sorted({mesh for number in numbers for mesh in self._meshes(number)})
        for mesh in meshes:
            self._check_alone(mesh, numbers)
        return meshes

    def _limited(
        self, before: _Influences, sets: dict[str, int], limits: Sequence[WeightLimit]
    ) -> dict[str, int | None]:
        """The accessors of a primitive's influences with limits, None for those of sets that go."""
        joints, weights = before.joints, before.weights
        for limit in limits:
            joints, weights = limited(joints, weights, limit, full=before.full)
        weights = self._fitting(before, weights)
        found: dict[str, int | None] = dict.fromkeys([*sets][joints.shape[1] // 2 :])
        return found | dict(self._added(sets, before, joints, weights, found))

    def _fitting(self, before: _Influences, weights: Floats) -> Floats:
        """New weights as the type that they had can hold them: what was added up may be too large for it."""
        if not before.full:
            return weights
        self._rescaled += int(np.count_nonzero((weights > before.full).any(axis=1)))
        return within(weights, before.full)

    def _meshes(self, skin: int) -> list[int]:
        """The meshes that are drawn with a skin."""
        nodes, among = self._draft.gltf["nodes"], len(self._draft.gltf.get("meshes", []))
        return sorted(
            {
                Value(raw["mesh"], f"{self._where}: nodes[{node}].mesh").index(among, "mesh")
                for node, raw in enumerate(nodes)
                if raw.get("skin") == skin and raw.get("mesh") is not None
            }
        )

    def _primitives(self, mesh: int) -> list[Value]:
        """The primitives of a mesh; an error for one that is only a notice where its weights stay."""
        value = Value(self._draft.gltf["meshes"][mesh], f"{self._where}: meshes[{mesh}]")
        return list(value.need("primitives").items())

    def _sets(self, primitive: Value) -> dict[str, int]:
        """The accessors of a primitive's sets of joints and weights, by name, in their order."""
        attributes, found = primitive.need("attributes"), dict[str, int]()
        while all(attributes.get(f"{kind}_{len(found) // 2}") for kind in ("JOINTS", "WEIGHTS")):
            number = len(found) // 2
            for name in (f"JOINTS_{number}", f"WEIGHTS_{number}"):
                found[name] = attributes.need(name).index(len(self._draft.gltf["accessors"]), "accessor")
        return found

    def _check_alone(self, mesh: int, skins: Collection[int]) -> None:
        """FixedWeightsError where a mesh is drawn with other skins too, whose joints its indices mean."""
        drawn = {n.get("skin") for n in self._draft.gltf["nodes"] if n.get("mesh") == mesh}
        if drawn - {None, *skins}:
            raise FixedWeightsError(
                f"{self._where}: mesh '{self._title(mesh)}' is drawn with several skins, so its weights "
                "cannot be changed for one. Give each skin a mesh of its own, or leave weights as they are"
            )

    def _title(self, mesh: int) -> str:
        return str(self._draft.gltf["meshes"][mesh].get("name") or f"#{mesh}")

    def _primitive(
        self,
        mesh: int,
        number: int,
        primitive: Value,
        skin: int,
        redistributions: Sequence[WeightRedistribution],
        fold: JointMerge | None,
    ) -> None:
        sets, points = self._sets(primitive), primitive.need("attributes").get("POSITION")
        if not sets or points is None:
            return
        if _is_draco(primitive):
            raise FixedWeightsError(
                f"{self._where}: mesh '{self._title(mesh)}' is compressed with {DRACO}, so its weights "
                "cannot be changed. Store it uncompressed, or leave the weights as they are"
            )
        position = points.index(len(self._accessors), "accessor")
        key = (skin, position, *sets.values())
        if key not in self._known:
            before, title = self._read(primitive, sets), self._title(mesh)
            self._known[key] = (
                self._shared(before, position, sets, redistributions, title)
                if fold is None
                else self._folded(before, sets, fold)
            )
        expected = self._known[key]
        if any(sets.get(name) != accessor for name, accessor in expected.items()):
            owned = self._draft.edit("meshes", mesh, "primitives", number, "attributes")
            owned.update({name: accessor for name, accessor in expected.items() if accessor is not None})
            for name in (name for name, accessor in expected.items() if accessor is None):
                owned.pop(name)

    def _shared(
        self,
        before: _Influences,
        position: int,
        sets: dict[str, int],
        redistributions: Sequence[WeightRedistribution],
        title: str,
    ) -> dict[str, int | None]:
        """The accessors of a primitive's influences after the redistributions; only of sets that change."""
        points = self._accessors.read(position)
        if points.shape != (len(before.joints), 3):
            raise FileError(f"{self._where}: mesh '{title}' has not as many influences as vertices")
        joints, weights = before.joints, before.weights
        for redistribution in redistributions:
            joints, weights = shared(redistribution, points, joints, weights, units=before.weight != FLOAT)
        weights = self._fitting(before, weights)
        room = -joints.shape[1] % 4
        joints, weights = np.pad(joints, ((0, 0), (0, room))), np.pad(weights, ((0, 0), (0, room)))
        old = len(sets) // 2
        if joints.shape[1] > 4 * old:
            text = (
                f"mesh '{title}' has vertices with more than {4 * old} joints now, which some engines do not "
                "show; --max-influences keeps them"
            )
            self.notices.append(Notice("more-influences", text))
        return dict(self._added(sets, before, joints, weights))

    def _folded(self, before: _Influences, sets: dict[str, int], fold: JointMerge) -> dict[str, int | None]:
        """The accessors of a primitive's influences after a fold, None for those of sets that go."""
        joints, weights = folded(fold.rows, fold.at, before.joints, before.weights)
        weights = self._fitting(before, weights)
        room = -joints.shape[1] % 4
        joints, weights = np.pad(joints, ((0, 0), (0, room))), np.pad(weights, ((0, 0), (0, room)))
        found: dict[str, int | None] = dict.fromkeys([*sets][joints.shape[1] // 2 :])
        for number in range(joints.shape[1] // 4):
            own = slice(4 * number, 4 * number + 4)
            same = np.array_equal(joints[:, own], before.joints[:, own])
            if not (same and np.array_equal(weights[:, own], before.weights[:, own])):
                left = int(fold.rows.max(initial=0)) + 1
                found |= self._again(number, joints[:, own], weights[:, own], before.weight, sets, left)
        return found | dict(self._added(sets, before, joints, weights, found))

    def _again(
        self,
        number: int,
        joints: Integers,
        weights: Floats,
        kind: int,
        sets: Mapping[str, int],
        left: int,
    ) -> dict[str, int]:
        """Accessors of the file that hold the influences of a set, by name; none is one too few.

        joints, weights: (v, 4) each. Joints of no weight may be any of the ``left`` that the skin has. The
        primitive's own comes first, and then those that nobody uses: meshes alike had one each.
        """
        found: dict[str, int] = {}
        users = self._storage.users
        taken = [users[index] > 0 or index in self._again_used for index in range(len(self._accessors))]
        for name in ("WEIGHTS", "JOINTS"):
            mine = [index for key, index in sets.items() if key == f"{name}_{number}"]
            for index in (*mine, *sorted(range(len(taken)), key=taken.__getitem__)):
                rows = self._influences(index, len(joints), kind if name == "WEIGHTS" else None)
                if rows is None:
                    continue
                wrong = (rows >= left) | ((rows != joints) & (weights != 0))
                off = np.abs(rows - weights) if name == "WEIGHTS" else wrong
                if off.max(initial=0) <= (SAME if name == "WEIGHTS" and kind == FLOAT else 0):
                    found[f"{name}_{number}"] = index
                    break
        self._again_used.update(found.values())
        return found

    def _influences(self, index: int, count: int, kind: int | None) -> Floats | None:
        """What an accessor holds if it can be weights stored as ``kind``, or joints where that is None."""
        try:
            raw, layout = self._accessors.value(index).object(), self._accessors.layout(index)
            if raw.get("type") != "VEC4" or raw.get("count") != count:
                return None
            if kind is None:
                fits = layout.component in (BYTE, SHORT) and not layout.normalized
            else:
                fits = layout.component == kind and layout.normalized == (kind in FULL)
            if not fits:
                return None
            rows = self._accessors.read(index)
        except FileError:
            return None
        return np.rint(rows * FULL[kind]) if kind in FULL else rows

    def _added(
        self,
        sets: dict[str, int],
        before: _Influences,
        joints: Integers,
        weights: Floats,
        known: Collection[str] = (),
    ) -> Iterator[tuple[str, int]]:
        kind = before.joint if joints.max(initial=0) < 256 or before.joint != BYTE else SHORT
        for number in range(joints.shape[1] // 4):
            own = slice(4 * number, 4 * number + 4)
            for name, now, then, component in (
                ("JOINTS", joints, before.joints, kind),
                ("WEIGHTS", weights, before.weights, before.weight),
            ):
                name = f"{name}_{number}"
                same_kind = component == before.joint or name.startswith("WEIGHTS")
                if name in known:
                    continue
                if name in sets and same_kind and np.array_equal(now[:, own], then[:, own]):
                    continue
                rows = np.ascontiguousarray(now[:, own].astype(COMPONENTS[component]))
                yield name, self._add(rows, sets.get(name), name.startswith("WEIGHTS"))

    def _add(self, rows: NDArray[Any], like: int | None, weights: bool) -> int:
        whole = weights and rows.dtype.kind == "u"
        like = self._instead.get(like, like) if like is not None else None
        index = self._storage.add(rows, "VEC4", _ROLES[rows.itemsize * 4], like, normalized=whole)
        self._made[index], self._instead[index] = rows, like
        return index

    def _component(self, index: int) -> int:
        if index in self._made:
            return next(k for k, kind in COMPONENTS.items() if kind == self._made[index].dtype)
        return self._accessors.layout(index).component

    def _rows(self, index: int, name: str) -> Floats:
        """The rows of a set, weights as shares of 1."""
        if index not in self._made:
            return self._accessors.read(index)
        full = FULL.get(self._component(index), 1.0) if name.startswith("WEIGHTS") else 1.0
        return self._made[index] / full

    def _read(self, primitive: Value, sets: dict[str, int]) -> _Influences:
        components = {name: self._component(index) for name, index in sets.items()}
        kinds = {component for name, component in components.items() if name.startswith("WEIGHTS")}
        weight = kinds.pop() if len(kinds) == 1 else FLOAT
        rows = {name: self._rows(index, name) for name, index in sets.items()}
        if {own.shape for own in rows.values()} != {(len(rows["JOINTS_0"]), 4)}:
            primitive.fail("has sets of joints and weights that are not as many, or not four for each vertex")
        joints = np.concatenate([rows[n] for n in sets if n.startswith("JOINTS")], axis=1)
        weights = np.concatenate([rows[n] for n in sets if n.startswith("WEIGHTS")], axis=1)
        if weight in FULL:
            weights = np.rint(weights * FULL[weight])
        joint = max(component for name, component in components.items() if name.startswith("JOINTS"))
        return _Influences(joints.astype(np.int64), weights, joint, weight)


def _is_draco(primitive: Value) -> bool:
    extensions = primitive.get("extensions")
    return extensions is not None and DRACO in extensions.object()
