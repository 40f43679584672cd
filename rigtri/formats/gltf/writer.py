"""From a changed rig to a file: only what differs is written, all else is copied."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from rigtri.errors import FileError
from rigtri.files.atomic_write import fsync_while_writing, same_file
from rigtri.formats.document import Companion
from rigtri.formats.gltf import mmap
from rigtri.formats.gltf.animation_writer import ClipWriter, refuse_early
from rigtri.formats.gltf.buffer_writer import Storage
from rigtri.formats.gltf.container import Piece
from rigtri.formats.gltf.control_shape_writer import write_shapes
from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite
from rigtri.formats.gltf.mmap import pour
from rigtri.formats.gltf.node_writer import NodeWriter
from rigtri.formats.gltf.prune import prune
from rigtri.formats.gltf.resources import accompany, missing, relink
from rigtri.formats.gltf.skin_weight_writer import WeightWriter
from rigtri.model.rig import Rig

if TYPE_CHECKING:
    from rigtri.formats.document import ReadOptions
    from rigtri.formats.gltf.accessors import Accessors
    from rigtri.formats.gltf.container import Container
    from rigtri.formats.gltf.node_reader import Rest
    from rigtri.report import Notice

# Large enough that thousands of small changed ranges cost few system calls.
BUFFERING = 1 << 20


class Readable(Protocol):
    """What of a document that was read its writer needs."""

    container: Container
    accessors: Accessors
    options: ReadOptions
    rest: Rest
    notices: list[Notice]

    @property
    def rig(self) -> Rig: ...


def write_file(document: Readable, rig: Rig, part: Path, target: Path) -> Sequence[Companion]:
    """Write ``document`` with ``rig`` to ``part``; the files that must lie beside ``target``."""
    container = document.container
    draft = CopyOnWrite(container.gltf)
    storage = Storage(draft, document.accessors, container)
    moves = not same_file(target.parent, container.path.parent)
    if moves and document.options.relink:
        relink(draft, container.path, target)
    if rig is not document.rig:
        refuse_early(document.rig, rig)
        nodes = NodeWriter(draft, document.rig, rig)
        clips = ClipWriter(draft, storage, document.accessors, document.rig, rig, nodes.index, nodes.moved)
        nodes.write()
        write_shapes(draft, storage, rig, nodes.index)
        weights = WeightWriter(draft, storage, document.accessors, str(container.path))
        weights.write(rig)
        document.notices += [notice for notice in weights.notices if notice not in document.notices]
        try:
            clips.write()
        except OverflowError as error:
            raise FileError(f"{container.path}: {error}; scale the file down") from None
        if draft.changed or not storage.idle:
            nodes.repair(document.rest.repaired)
        if rig.pending.removed:
            prune(draft, storage, {nodes.index[node] for node in rig.pending.removed})
    binary, companions = storage.finish(target.stem)
    if not draft.changed and binary is None:
        _write(part, [container.source])
    else:
        _write(part, container.pieces(draft.gltf, binary))
    if moves:
        document.notices += [n for n in missing(container.gltf, container.path) if n not in document.notices]
    if moves and not document.options.relink:
        new = {companion.name for companion in companions}
        copies = accompany(draft.gltf, container.path, target)
        companions += [copy for copy in copies if copy.name not in new]
    return companions


def _write(part: Path, pieces: Sequence[Piece]) -> None:
    try:
        size = sum(map(len, pieces))
        if size < BUFFERING:
            part.write_bytes(b"".join(pieces))
            return
        with (
            part.open("wb", buffering=BUFFERING) as file,
            fsync_while_writing(file, large=size >= mmap.MAP_FROM),
        ):
            for piece in pieces:
                pour(file, piece)
    except OSError as error:
        raise FileError(f"{part}: cannot be written: {error.strerror or error}") from None
