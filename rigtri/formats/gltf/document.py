"""A glTF file that was read: its rig, and all the rest untouched.

Source: glTF 2.0; VRM 0.0 and 1.0; docs/design.md, "How formats fill a Rig".
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from rigtri.errors import FileError, UsageError, system_reason
from rigtri.files import mapped_file
from rigtri.files.atomic_write import fsync_while_writing, same_file
from rigtri.files.mapped_file import load, pour
from rigtri.formats.document import Companion, Embedded, ReadOptions
from rigtri.formats.gltf.accessors import Accessors
from rigtri.formats.gltf.animation_reader import ClipReader, animated_matrices
from rigtri.formats.gltf.animation_writer import ClipWriter
from rigtri.formats.gltf.buffer_writer import Storage
from rigtri.formats.gltf.buffers import Buffers
from rigtri.formats.gltf.container import Container, Piece, open_container
from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite
from rigtri.formats.gltf.mesh_reader import Drawn, MeshReader
from rigtri.formats.gltf.new_key_times import refuse_early
from rigtri.formats.gltf.node_reader import Rest, read_rest, read_tree
from rigtri.formats.gltf.node_writer import NodeWriter
from rigtri.formats.gltf.references import check_added, named_nodes
from rigtri.formats.gltf.scene_facts import read_scene_facts
from rigtri.formats.gltf.skin_reader import read_skins
from rigtri.formats.gltf.structure import (
    check_extensions,
    check_lists,
    check_references,
    extension_in_axes,
    lines_shown,
    referred_frames,
    shows,
    unread_extensions,
)
from rigtri.formats.gltf.uris import accompany, decode_data, file_of, files, is_data, missing, relink
from rigtri.formats.json_values import Value, name_in
from rigtri.formats.vrm.bindings import Bindings
from rigtri.model.bindings import Bound, NodeConstraint
from rigtri.model.content import Content
from rigtri.model.control_shapes import Lines
from rigtri.model.format_rules import FormatRules
from rigtri.model.mesh import Mesh
from rigtri.model.metadata import damage, illegible
from rigtri.model.rig import Rig
from rigtri.model.scene_facts import SceneFacts
from rigtri.report import Notice, SameNotices

# What files of these suffixes have, by the specifications of VRM 0.0, VRM 1.0 and VRMA 1.0.
_AVATARS = {".vrm": ("VRM", "VRMC_vrm"), ".vrma": ("VRMC_vrm_animation",)}

# Large enough that thousands of small changed ranges cost few system calls.
BUFFERING = 1 << 20


class GltfDocument:
    """A .glb, .gltf, .vrm or .vrma file. Its node keys are the node's index in the file.

    like: the file that this one was made of. accessors: those of the same content, whose layouts are known.
    """

    def __init__(
        self,
        container: Container,
        options: ReadOptions,
        like: GltfDocument | None = None,
        *,
        accessors: Accessors | None = None,
    ) -> None:
        self.container, self.options = container, options
        self.notices: list[Notice] = list(container.notices)
        gltf = Value(container.gltf, f"{container.path}:")
        check_lists(gltf)
        check_references(gltf)
        check_extensions(gltf, self.notices)
        self._buffers = Buffers(gltf, container, allow_external=options.allow_external_paths)
        known = accessors if like is None else like.accessors
        self.accessors: Accessors = Accessors(gltf, self._buffers, known)
        self.tree = read_tree(gltf)
        self._reader = MeshReader(gltf, self.accessors, self.tree, self.notices)
        self.rest: Rest = read_rest(
            gltf, self.tree, animated_matrices(gltf), self.notices, lenient=options.lenient
        )
        self._rig = self._read_rig(gltf, like)
        self.accessors.forget_layouts()

    @classmethod
    def read(
        cls,
        path: Path,
        options: ReadOptions | None = None,
        content: bytes | None = None,
        like: GltfDocument | None = None,
    ) -> GltfDocument:
        """Read a file. Raises FileError, in the file's own names, for anything that is broken.

        content: what a file at ``path`` would hold; what it refers to is looked for from there.
        like: what it was made of; both share JSON and key times that are the same, which is then compared
        sooner.
        """
        options = options or ReadOptions()
        known = None if like is None else like.container
        container = open_container(path, lenient=options.lenient, content=content, like=known)
        try:
            return cls(container, options, like)
        except RecursionError:
            raise FileError(f"{path}: the JSON is nested too deep") from None

    @property
    def rig(self) -> Rig:
        """The rig as it was read."""
        return self._rig

    @property
    def warnings(self) -> Sequence[Notice]:
        """What the reader noticed and could live with."""
        return tuple(self.notices)

    @property
    def hidden(self) -> Mapping[str, Sequence[str]]:
        """Nothing: a glTF file has no layers."""
        return {}

    def meshes(self) -> Sequence[Mesh]:
        """Every primitive that can be read, for measuring; the others are noticed."""
        return self._drawn.meshes()

    def outlines(self, *, closely: bool = False) -> Sequence[Mesh]:
        """The same; where a file has very many points, some of them and boxes for its largest meshes."""
        return self._drawn.outlines(closely=closely)

    def scene_facts(self, *, closely: bool = False) -> SceneFacts:
        """Scenes, lenses, lights and materials of the nodes that show something, and what avatars state."""
        facts = read_scene_facts(self.container.gltf, self.tree)
        if not closely:
            return facts
        from rigtri.formats.gltf.materials import Materials
        from rigtri.formats.gltf.stored_data import StoredData
        from rigtri.formats.vrm.scene_facts import read_facts

        gltf, tree = self.container.gltf, self.tree
        materials, stored = Materials(gltf, self.image), StoredData(gltf, self.accessors)
        of = {place: tree.order[place] for place in facts.nodes}
        nodes = {k: {**own, **materials.of(of[k]), **stored.of(of[k])} for k, own in facts.nodes.items()}
        avatar, own = read_facts(gltf, tree.place, self._pointers)
        return replace(facts, nodes=nodes, **stored.with_driven({**facts.whole, **avatar}, own, tree.place))

    def image(self, image: dict[str, object]) -> bytes | memoryview:
        """The bytes of an image. FileError where they are not to be had."""
        uri, where = image.get("uri"), f"{self.container.path}: image"
        if isinstance(uri, str):
            if is_data(uri):
                return decode_data(uri, where)
            allowed = self.options.allow_external_paths
            return load(file_of(uri, self.container.path.parent, where, allow_external=allowed))
        gltf = Value(self.container.gltf, f"{self.container.path}:")
        view = Value(image, where).need("bufferView").index(len(list(gltf.each("bufferViews"))), "bufferView")
        buffer, start, end = self.accessors.span(view)
        return self._buffers.content(buffer)[start:end]

    def embedded(self) -> Embedded:
        """The file as it is, and the files of buffers and images."""
        from rigtri.formats.gltf.embed import embedded

        allowed = self.options.allow_external_paths
        return embedded(self.container.gltf, self.container.path, self.image, allow_external=allowed)

    def needed(self) -> Iterator[tuple[Path, str]]:
        """The files of buffers, images and extensions."""
        return files(self.container.gltf, self.container.path)

    def reopen(self, part: Path) -> GltfDocument:
        """Read what `write` wrote."""
        # A relinked output may point anywhere that the source's data already came from.
        trusted = self.options.allow_external_paths or self.options.relinks
        return GltfDocument.read(part, replace(self.options, allow_external_paths=trusted), like=self)

    def write(self, rig: Rig, part: Path, target: Path) -> Sequence[Companion]:
        """Write the file as ``rig`` wants it to ``part``; see `rigtri.formats.Document`.

        Raises UsageError where the suffix of ``target`` is not the kind of file that was
        read, FileError for what cannot be written.
        """
        self._check_suffix(target)
        container = self.container
        draft = CopyOnWrite(container.gltf)
        storage = Storage(draft, self.accessors, container)
        moves = not same_file(target.parent, container.path.parent)
        if moves and self.options.relinks:
            relink(draft, container.path, target)
        if rig is not self._rig:
            try:
                self._apply(rig, draft, storage)
            except OverflowError as error:
                raise FileError(f"{container.path}: {error}; scale the file down") from None
        binary, companions = storage.finish(target.stem)
        check_added(container.gltf, draft.gltf, container.path)
        if not draft.changed and binary is None:
            _write(part, [container.source])
        else:
            _write(part, container.pieces(draft.gltf, binary))
        if moves:
            self._add_notices(missing(container.gltf, container.path))
        if moves and not self.options.relinks:
            new = {companion.name for companion in companions}
            copies = accompany(draft.gltf, container.path, target)
            companions += [copy for copy in copies if copy.name not in new]
        return companions

    def _apply(self, rig: Rig, draft: CopyOnWrite, storage: Storage) -> None:
        """Put what of ``rig`` differs into the JSON and the buffers."""
        refuse_early(self._rig, rig)
        if rig.pending.removed:
            from rigtri.formats.gltf.removal_check import check_before_removal

            check_before_removal(Value(self.container.gltf, f"{self.container.path}:"))
        nodes = NodeWriter(draft, self._rig, rig)
        clips = ClipWriter(draft, storage, self.accessors, self._rig, rig, nodes.index, nodes.moved)
        nodes.write()
        if rig.pending.shapes:
            from rigtri.formats.gltf.control_shapes import write_shapes

            write_shapes(draft, storage, rig, nodes.index)
        if rig.pending.changes_weights:
            from rigtri.formats.gltf.skin_weight_writer import WeightWriter

            weights = WeightWriter(draft, storage, self.accessors, str(self.container.path))
            weights.write(rig)
            self._add_notices(weights.notices)
        clips.write()
        if draft.changed or not storage.idle:
            nodes.repair(self.rest.repaired)
        if rig.pending.removed:
            from rigtri.formats.gltf.prune import prune

            prune(draft, storage, {nodes.index[node] for node in rig.pending.removed})

    def _add_notices(self, notices: Sequence[Notice]) -> None:
        self.notices += [notice for notice in notices if notice not in self.notices]

    def _check_suffix(self, target: Path) -> None:
        """UsageError for a suffix of another format, or of an avatar where the file is none."""
        allowed = (".glb", ".vrm", ".vrma") if self.container.is_glb else (".gltf",)
        if target.suffix.lower() not in allowed:
            raise UsageError(
                f"{target.name}: the output has the format of the input; give it the suffix "
                f"{' or '.join(allowed)}"
            )
        source, suffix = self.container.path, target.suffix.lower()
        used, marks = self.container.gltf.get("extensions", {}), _AVATARS.get(suffix, ())
        if marks and suffix != source.suffix.lower() and not any(mark in used for mark in marks):
            raise UsageError(
                f"{target.name}: {source.name} has no extension {' or '.join(marks)}, and a {suffix} "
                f"without is refused by viewers; give the output the suffix {source.suffix}"
            )

    def _read_rig(self, gltf: Value, like: GltfDocument | None) -> Rig:
        tree, rest, options = self.tree, self.rest, self.options
        nodes = gltf.object().get("nodes", [])
        ordered = [nodes[index] for index in tree.order]
        skins = read_skins(
            gltf, self.accessors, tree, self.notices, self._reader.weighted, lenient=options.lenient
        )
        self._drawn = Drawn(self._reader, skins)
        known = None if like is None else like._clips
        self._clips: ClipReader = ClipReader(
            gltf, self.accessors, tree, self.notices, known, lenient=options.lenient
        )
        clips = self._clips.read()
        bindings = _bindings(gltf, nodes, tree.above)
        self.notices += bindings.notices
        self._pointers = [pointer for _, _, pointer in bindings.bound]
        fixed = {tree.place[node]: reason for node, reason in bindings.fixed.items()}
        notes = self._notes([node.get("extras") for node in ordered])
        rig = Rig(
            names=tuple(map(name_in, ordered)),
            parents=np.array([_place(tree.place, tree.above[k]) for k in tree.order], dtype=np.int64),
            translation=rest.translation,
            rotation=rest.rotation,
            scale=rest.scale,
            matrix=rest.matrix,
            has_matrix=rest.has_matrix,
            attachment=np.array([k if shows(n) else -1 for k, n in enumerate(ordered)], dtype=np.int64),
            keys=tuple(tree.order),
            labels=tuple(f"#{index}" for index in tree.order),
            skins=skins,
            clips=clips,
            bound=tuple(
                Bound(tree.place[node], np.array(vector), pointer, is_direction=pointer[-1] == "normal")
                for node, vector, pointer in bindings.bound
            ),
            node_constraints=tuple(
                NodeConstraint(c.kind, tree.place[c.node], tree.place[c.source], np.array(c.axis), c.pointer)
                for c in bindings.constraints
            ),
            humanoid={bone: tree.place[node] for bone, node in bindings.humanoid.items()},
            metadata=notes,
            rules=FormatRules(
                fixed=fixed,
                orient_locked=bindings.orient_locked,
                world_aligned=frozenset(tree.place[k] for k in bindings.bones if bindings.orient_locked),
                data_nodes=frozenset(tree.place[node] for node in bindings.data_nodes),
                swinging=frozenset(tree.place[node] for node in bindings.swinging),
                split_locked=bindings.split_locked,
                named=frozenset(tree.place[k] for k in named_nodes(gltf.object()) if k < len(tree.place)),
                facing=bindings.facing,
                unread_extensions=self._unread_extensions(),
                rigid=frozenset(k for k, n in enumerate(ordered) if "mesh" in n and "skin" not in n),
                lines=lines_shown(ordered, self.container.gltf.get("meshes")),
            ),
            # Not of the document: a rig that held it would keep the file open in a ring.
            content=Content(partial(_lines, gltf, self.accessors), self._drawn.outlines, self._drawn.meshes),
        )
        self._freeze(rig, ordered, fixed)
        return rig.with_addresses()

    def _notes(self, extras: Sequence[object]) -> dict[int, dict[str, Any]]:
        """What rigtri has stored, by node; what another version has stored is reported and left alone."""
        found: dict[int, dict[str, Any]] = {}
        same = SameNotices(self.notices)
        for node, extra in enumerate(extras):
            note = extra.get("rigtri") if isinstance(extra, dict) else None
            if not isinstance(note, dict):
                continue
            why = illegible(note)
            if why:
                same.add("note-unread", _STORED, f"node {node}", f" stays as it is: {why}")
                continue
            found[node] = note
            if why := damage(note):
                same.add("note-damaged", _STORED, f"node {node}", f" is damaged and is not used: {why}")
        return found

    def _unread_extensions(self) -> tuple[str, ...]:
        return () if self.options.unknown_node_ext == "ignore" else unread_extensions(self.container.gltf)

    def _freeze(self, rig: Rig, ordered: list[dict[str, object]], fixed: dict[int, str]) -> None:
        """Joints whose matrix is no frame, and nodes with extensions that may name their axes."""
        for node in self.rest.sheared:
            if rig.is_joint[node]:
                fixed.setdefault(node, "its matrix is sheared or flat, which glTF forbids")
        referred = referred_frames(self.container.gltf, self.tree.above)
        for node, raw in enumerate(ordered):
            name, why = extension_in_axes(raw)
            name, why = (name, why) if name else referred.get(self.tree.order[node], ("", ""))
            if not name or self.options.unknown_node_ext == "ignore":
                continue
            if self.options.unknown_node_ext == "error":
                raise FileError(
                    f"{self.container.path}: node '{rig.title(node)}' cannot get new axes: {why}. "
                    "Choose --unknown-node-ext freeze or ignore."
                )
            fixed.setdefault(node, why)


def _bindings(gltf: Value, nodes: Sequence[dict[str, Any]], above: Sequence[int]) -> Bindings:
    """What extensions bind to nodes; most files have none, and no use for what reads them."""
    if any("extensions" in held for held in (gltf.object(), *nodes)):
        from rigtri.formats.vrm.vrm1 import read_bindings

        return read_bindings(gltf, above)
    return Bindings()


def _lines(gltf: Value, accessors: Accessors, node: Hashable) -> Lines | None:
    from rigtri.formats.gltf.control_shapes import read_lines

    return read_lines(gltf, accessors, node)


_STORED = "What rigtri stored on "


def _place(place: list[int], node: int) -> int:
    return place[node] if node >= 0 else -1


def _write(part: Path, pieces: Sequence[Piece]) -> None:
    try:
        size = sum(map(len, pieces))
        if size < BUFFERING:
            part.write_bytes(b"".join(pieces))
            return
        with (
            part.open("wb", buffering=BUFFERING) as file,
            fsync_while_writing(file, large=size >= mapped_file.MAP_FROM),
        ):
            for piece in pieces:
                pour(file, piece)
    except OSError as error:
        raise FileError(f"{part}: cannot be written: {system_reason(error)}") from None
