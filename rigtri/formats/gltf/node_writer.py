"""Nodes, scenes and what the VRM family binds to nodes, changed in a draft where a rig differs.

Nodes keep their indices; new ones come behind the last. A property that is not
written and has not changed stays unwritten.

Source: glTF 2.0 §3.5; GODOT_single_root; docs/decisions.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite
from rigtri.formats.gltf.structure import SHOWN_EXTENSIONS
from rigtri.formats.vrm.bindings import CONSTRAINT, stored, stored_axis
from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import SKEW, decompose, inverse, multiply, skew
from rigtri.maths.quaternions import normalise_for_storage
from rigtri.maths.trigonometry import Floats
from rigtri.model.bindings import NodeConstraint
from rigtri.model.metadata import illegible
from rigtri.model.rig import Rig

_DEFAULTS = {"translation": (0.0, 0.0, 0.0), "rotation": (0.0, 0.0, 0.0, 1.0), "scale": (1.0, 1.0, 1.0)}
PARTS = tuple(_DEFAULTS)


# Extensions that name the joints of characters.
_BY_NAME = ("KHR_character", "KHR_avatar")


class NodeWriter:
    """Carries the nodes of ``rig`` into a draft of the file that ``source`` was read from."""

    def __init__(self, draft: CopyOnWrite, source: Rig, rig: Rig) -> None:
        self._draft, self._source, self._rig = draft, source, rig
        count = len(source)
        known = {key: place for place, key in enumerate(source.keys)}
        # Where each node of the rig was in the source, −1 for a new one.
        was = [known.get(key, -1) if key is not None else -1 for key in rig.keys]
        self._was = np.array(was, dtype=np.int64)
        old = self._was[self._was >= 0]
        if len(set(old.tolist())) != count:
            raise ValueError("a rig to be written must have every node of the source once")
        self.index = self._indices(count)
        # File index of the node that used to show something → of the one that shows it now.
        self.moved: dict[int, int] = {}

    def _indices(self, count: int) -> list[int]:
        """The file index of each node of the rig."""
        indices, fresh = [], count
        for key in self._rig.keys:
            indices.append(key if isinstance(key, int) else fresh)
            fresh += key is None
        return indices

    def write(self) -> None:
        """Put all differences into the draft."""
        self._add_nodes()
        self._write_names()
        self._write_rest()
        self._write_tree()
        self._move_attachments()
        self._write_notes()
        self._write_bound()
        self._write_constraints()

    @property
    def _new(self) -> list[int]:
        return np.flatnonzero(self._was < 0).tolist()

    def _add_nodes(self) -> None:
        for node in self._new:
            self._draft.need("nodes", empty=[]).append({})
            if self._rig.names[node]:
                self._node(node)["name"] = self._rig.names[node]

    def _node(self, node: int) -> dict[str, Any]:
        """The JSON of a node of the rig, free to be changed."""
        owned: dict[str, Any] = self._draft.edit("nodes", self.index[node])
        return owned

    def _write_names(self) -> None:
        now: dict[str, str] = {}
        for node, was in enumerate(self._was.tolist()):
            if was >= 0 and self._rig.names[node] != self._source.names[was]:
                self._node(node)["name"] = self._rig.names[node]
                if not self._rig.names[node] and node not in self._rig.pending.removed:
                    self._node(node).pop("name")
                now[self._source.names[was]] = self._rig.names[node]
        for name in self._draft.gltf.get("extensions", {}) if now else ():
            if name.startswith(_BY_NAME):
                held = self._draft.gltf["extensions"][name]
                if (new := _with_names(held, now)) != held:
                    self._draft.edit("extensions")[name] = new

    def _write_rest(self) -> None:
        rig, source = self._rig, self._source
        had, has = source.has_matrix.tolist(), rig.has_matrix.tolist()
        old = [(node, was) for node, was in enumerate(self._was.tolist()) if was >= 0]
        for key, now, then in zip(PARTS, _parts(rig), _parts(source), strict=True):
            rows, before = now.tolist(), then.tolist()
            shown = normalise_for_storage(now).tolist() if key == "rotation" else rows
            for node, was in old:
                if not has[node] and (had[was] or rows[node] != before[was]):
                    self._set_part(node, key, shown[node])
        for node, was in old:
            if has[node] and not (had[was] and rig.matrix[node].tolist() == source.matrix[was].tolist()):
                self._write_matrix(node, rig.matrix[node])
        for node, weights in rig.pending.morph_weights.items():
            self._node(node)["weights"] = weights.tolist()
        for node in self._new:
            self._write_new(node)

    def _write_part(self, node: int, key: str, value: Floats) -> None:
        numbers = normalise_for_storage(value) if key == "rotation" else value
        self._set_part(node, key, numbers.tolist())

    def _set_part(self, node: int, key: str, numbers: list[float]) -> None:
        holder = self._node(node)
        holder.pop("matrix", None)
        holder[key] = numbers

    def _write_matrix(self, node: int, matrix: Floats) -> None:
        holder = self._node(node)
        for key in PARTS:
            holder.pop(key, None)
        holder["matrix"] = matrix.reshape(16).tolist()

    def _write_new(self, node: int) -> None:
        """The rest pose of a new node, without what is the default."""
        rig = self._rig
        if rig.has_matrix[node]:
            self._write_matrix(node, rig.matrix[node])
        else:
            self._write_parts(node, *(values[node] for values in _parts(rig)))

    def _write_parts(self, node: int, *parts: Floats) -> None:
        """Translation, rotation and scale, without what is the default."""
        for (key, default), value in zip(_DEFAULTS.items(), parts, strict=True):
            if (value != default).any():
                self._write_part(node, key, value)

    def _write_tree(self) -> None:
        """Lists of children and scenes: what stays keeps its order, what comes goes to the end."""
        above = self._above()
        for node, was in enumerate(self._was.tolist()):
            parent, old = int(above[node]), self._old_parent(was)
            if parent == old and was >= 0:
                continue
            index = self.index[node]
            if was >= 0 and old >= 0:
                self._leave(("nodes", old, "children"), index)
            if parent >= 0:
                self._draft.need("nodes", parent, "children", empty=[]).append(index)
                self._leave_scenes(index, parent if parent >= len(self._source) else -1)
        for node in range(len(self._rig)):
            if above[node] < 0 and (self._was[node] < 0 or self._old_parent(int(self._was[node])) >= 0):
                self._enter_scene(self.index[node])

    def _old_parent(self, was: int) -> int:
        """File index of the parent in the source, −1 for a root, −2 for a new node."""
        if was < 0:
            return -2
        parent = int(self._source.parents[was])
        return int(str(self._source.keys[parent])) if parent >= 0 else -1

    def _above(self) -> Integers:
        """File index of every node's parent in the file to be written, −1 for roots."""
        parents = self._rig.parents.tolist()
        above = np.array([self.index[p] if p >= 0 else -1 for p in parents], dtype=np.int64)
        root = self._single_root()
        if root is not None:
            for node in self._new:
                if above[node] < 0:
                    self._put_under(node, root)
                    above[node] = self.index[root]
        return above

    def _single_root(self) -> int | None:
        """The node that all others are under by GODOT_single_root, as a node of the rig."""
        gltf = self._draft.gltf
        if "GODOT_single_root" not in gltf.get("extensionsUsed", []) or not gltf.get("nodes"):
            return None
        root = self.index.index(0)
        return root if self._rig.parents[root] < 0 else None

    def _put_under(self, node: int, root: int) -> None:
        """Let a new root keep its place in the world below another node."""
        world = self._rig.world
        local = multiply(world[node], inverse(world[root]))
        holder = self._node(node)
        for key in (*PARTS, "matrix"):
            holder.pop(key, None)
        if skew(local) > SKEW:
            self._write_matrix(node, local)
        else:
            self._write_parts(node, *decompose(local))

    def _leave(self, path: tuple[str | int, ...], index: int) -> None:
        owned = self._draft.edit(*path)
        owned.remove(index)
        if not owned:
            # An empty list of children is not allowed.
            self._draft.edit(*path[:-1]).pop(path[-1])

    def _leave_scenes(self, index: int, instead: int) -> None:
        """A node that got a parent is no root of a scene; a new parent takes its place there."""
        for number, scene in enumerate(self._draft.gltf.get("scenes", [])):
            roots = scene.get("nodes") or []
            if index not in roots:
                continue
            owned = self._draft.edit("scenes", number, "nodes")
            if instead >= 0 and instead not in owned:
                owned[owned.index(index)] = instead
            else:
                owned.remove(index)

    def _enter_scene(self, index: int) -> None:
        """Show a root in the default scene, if it is in none; without scenes nothing is shown anyway."""
        scenes = self._draft.gltf.get("scenes", [])
        if not scenes or any(index in (scene.get("nodes") or []) for scene in scenes):
            return
        default = int(self._draft.gltf.get("scene", 0))
        self._draft.need("scenes", default, "nodes", empty=[]).append(index)

    def _move_attachments(self) -> None:
        """Hand what a node shows to the node that shows it now, and whatever refers to it."""
        for node, shown in enumerate(self._rig.attachment.tolist()):
            if shown >= 0 and shown != node:
                self.moved[self.index[shown]] = self.index[node]
                self._hand_over(self._node(shown), self._node(node))
        extensions = self._draft.gltf.get("extensions")
        if not self.moved or not isinstance(extensions, dict):
            return
        from rigtri.formats.vrm.vrm1 import mesh_references

        for path in mesh_references(extensions):
            holder = self._draft.edit("extensions", *path[:-1])
            node = holder["node"]
            # 3.0 is the same number; true is none.
            if type(node) in (int, float):
                holder["node"] = self.moved.get(node, node)

    def _hand_over(self, giver: dict[str, Any], taker: dict[str, Any]) -> None:
        for key in ("camera", "skin", "mesh", "weights"):
            if key in giver:
                taker[key] = giver.pop(key)
        given = dict(giver.get("extensions", {}))
        for name in SHOWN_EXTENSIONS:
            if name in given:
                taker.setdefault("extensions", {})[name] = given.pop(name)
        if "extensions" in giver and given != giver["extensions"]:
            giver["extensions"] = given
            if not given:
                giver.pop("extensions")

    def _write_notes(self) -> None:
        stored = self._numbered().metadata
        for node, was in enumerate(self._was.tolist()):
            now = stored.get(node)
            then = self._source.metadata.get(was) if was >= 0 else None
            if now != then:
                self._write_note(node, dict(now) if now is not None else None)

    def _numbered(self) -> Rig:
        """The rig whose labels are the numbers that nodes have once those that go are gone."""
        gone = self._rig.pending.removed
        if not gone:
            return self._rig
        # What goes comes last, with a number that no node of the file has then.
        order = sorted(range(len(self._rig)), key=lambda node: (node in gone, self.index[node]))
        labels = {node: f"#{number}" for number, node in enumerate(order)}
        return self._rig.with_labels([labels[node] for node in range(len(self._rig))])

    def _write_note(self, node: int, note: dict[str, Any] | None) -> None:
        holder = self._node(node)
        extras = holder.get("extras", {})
        if not isinstance(extras, dict):
            raise FileError(
                f"{self._rig.title(node)} has extras that are not an object, so nothing can be stored there; "
                "remove them first"
            )
        old = extras.get("rigtri")
        if isinstance(old, dict) and illegible(old):
            return  # another version's
        extras = {key: value for key, value in extras.items() if key != "rigtri" or note is not None}
        if note is not None:
            extras["rigtri"] = note
        holder["extras"] = extras
        if not extras:
            holder.pop("extras")

    def _write_bound(self) -> None:
        before = {bound.key: bound.vector for bound in self._source.bound}
        for bound in self._rig.bound:
            if isinstance(bound.key, tuple) and (bound.vector != before[bound.key]).any():
                holder = self._draft.edit(*bound.key[:-1])
                name = bound.key[-1]
                from rigtri.formats.vrm.vrm0 import stored_vector

                holder[name] = stored_vector(bound.key, bound.vector.tolist(), holder.get(name))

    def _write_constraints(self) -> None:
        before = {constraint.key: constraint.axis for constraint in self._source.node_constraints}
        kept = {constraint.key for constraint in self._rig.node_constraints}
        for key in before:
            if isinstance(key, tuple) and key not in kept:
                self._remove_constraint(key[1])
        for constraint in self._rig.node_constraints:
            key = constraint.key
            if key is None and constraint.kind != "tail":
                self._add_constraint(constraint)
            if isinstance(key, tuple) and (constraint.axis != before[key]).any():
                name, word = stored_axis(constraint.kind, constraint.axis.tolist())
                holder = self._draft.edit(*key)
                if holder.get(name) != word:
                    holder[name] = word

    def _add_constraint(self, constraint: NodeConstraint) -> None:
        holder = self._node(constraint.node)
        source = self.index[constraint.source]
        data = stored(constraint.kind, source, constraint.axis.tolist())
        holder["extensions"] = {**holder.get("extensions", {}), CONSTRAINT: data}
        used = self._draft.need("extensionsUsed", empty=[])
        if CONSTRAINT not in used:
            used.append(CONSTRAINT)

    def _remove_constraint(self, index: int) -> None:
        """Take the extension from a node, and from the list of extensions with the last of them."""
        holder = self._draft.edit("nodes", index)
        left = {name: value for name, value in holder["extensions"].items() if name != CONSTRAINT}
        holder["extensions"] = left
        if not left:
            holder.pop("extensions")
        gltf = self._draft.gltf
        still = any(CONSTRAINT in (node.get("extensions") or {}) for node in gltf["nodes"])
        if not still and CONSTRAINT in gltf.get("extensionsUsed", []):
            used = self._draft.edit("extensionsUsed")
            used.remove(CONSTRAINT)
            if not used:
                gltf.pop("extensionsUsed")

    def repair(self, repaired: set[int]) -> None:
        """Give nodes that contradicted themselves the TRS that was understood, and nothing else.

        repaired: file indices, as in `rigtri.formats.gltf.node_reader.Rest`.
        """
        for node, index in enumerate(self.index):
            if index in repaired:
                for key, values in zip(PARTS, _parts(self._rig), strict=True):
                    self._write_part(node, key, values[node])


def _parts(rig: Rig) -> tuple[Floats, Floats, Floats]:
    return rig.translation, rig.rotation, rig.scale


def _with_names(held: Any, now: Mapping[str, str]) -> Any:
    """What an extension holds, with the new names of nodes as values."""
    if isinstance(held, str):
        return now.get(held, held)
    if isinstance(held, dict):
        return {key: _with_names(value, now) for key, value in held.items()}
    return [_with_names(value, now) for value in held] if isinstance(held, list) else held
