"""A USD file: read into a rig, and written again with only what changed in it."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Sdf, Usd

from rigtri.errors import FileError, UsageError
from rigtri.files.atomic_write import same_file
from rigtri.formats.document import Companion, Embedded, ReadOptions
from rigtri.formats.usd import usdz, writer
from rigtri.formats.usd.composition import dependencies, external_paths, layers
from rigtri.formats.usd.composition.stage import open_stage, quiet
from rigtri.formats.usd.composition.variable_expressions import variables_of
from rigtri.formats.usd.embed import embedded
from rigtri.formats.usd.opinions import drop_redundant_opinions, instance_edits
from rigtri.formats.usd.opinions.composition_check import Expected
from rigtri.formats.usd.opinions.control_shapes import read_lines
from rigtri.formats.usd.opinions.edits import Edit, kind, parts
from rigtri.formats.usd.passes import (
    add_joints,
    drop_columns,
    retime_samples,
    route_tracks,
    route_variants,
    split_joints,
    write_skin_weights,
)
from rigtri.formats.usd.reading import mesh_reader
from rigtri.formats.usd.reading.reader import Source, read_source
from rigtri.formats.usd.reading.scene_facts import read_scenery
from rigtri.formats.usd.text import splice
from rigtri.formats.usd.text.statements import UnknownTextError
from rigtri.model.content import Content
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.model.scene_facts import Scenery
from rigtri.report import Notice

# An override of ours says so here, and a bare one also what it is for; editing it again edits this layer.
MARK = "rigtri"


class UsdDocument:
    """A .usd, .usda, .usdc or .usdz file. Edits are opinions of its root layer."""

    def __init__(self, source: Source, options: ReadOptions, layer: Any) -> None:
        """layer: the one to edit; the stage's root layer, or the opinions above the file they are for."""
        self._notices = list(source.warnings)
        # Of the source alone: a rig that held its document would keep the stage open in a ring.
        drawn = partial(_read_meshes, source, self._notices)
        lines = partial(read_lines, source.stage)
        rig = replace(source.rig, content=Content(lines, drawn, drawn))
        self._source, self._options, self._layer = replace(source, rig=rig), options, layer

    @classmethod
    def read(cls, path: Path, options: ReadOptions | None = None) -> UsdDocument:
        """Read a file. FileError for what is damaged, breaks UsdSkel's rules or has no skeleton."""
        options = options or ReadOptions()
        stage, layer, warnings = opened(path, allow_external=options.allow_external_paths)
        return cls(read_source(path, options, stage, warnings), options, layer)

    @property
    def rig(self) -> Rig:
        return self._source.rig

    @property
    def warnings(self) -> Sequence[Notice]:
        """What the reader noticed; after `write`, also what the writer had to do."""
        return tuple(self._notices)

    def meshes(self) -> Sequence[Mesh]:
        """Skinned and rigid points, blend shapes as morphs without inbetweens."""
        return _read_meshes(self._source, self._notices)

    def outlines(self, *, closely: bool = False) -> Sequence[Mesh]:
        """The same: USD keeps what is drawn in memory anyway."""
        return self.meshes()

    def scenery(self, *, closely: bool = False) -> Scenery:
        """Units and range of the stage; visibility, lenses, lights and materials of what it shows."""
        shown = {node: self.rig.labels[node] for node in np.flatnonzero(self.rig.payload >= 0).tolist()}
        with quiet(f"{self._source.path}: USD cannot read what it shows"):
            return read_scenery(self._source.stage, shown, closely=closely)

    def write(self, rig: Rig, part: Path, target: Path) -> Sequence[Companion]:
        """Write the file, or with ``override`` only the opinions; see `formats.Document`.

        Relative asset paths are anchored anew where ``target`` lies in another folder.
        UsageError for a target of another format.
        """
        self._check(target)
        notices: list[Notice] = []
        with quiet(f"{target}: USD cannot write it"):
            bake = self._options.bake_xform
            source, rig, first = add_joints.extended(self._source, rig, self._options)
            source, rig, split = split_joints.widened(source, rig, self._options, notices)
            first += split
            asked = rig
            source, rig, keyed = retime_samples.driven(source, rig, self._options)
            source, rig = route_tracks.taken_up(source, rig, asked)
            first += keyed
            rig, last = add_joints.shortened(source, rig)
            rig, idle = drop_columns.undriven(source, rig)
            last += idle
            edits = writer.edits(source, rig, bake=bake, warnings=notices)
            edits += write_skin_weights.weight_edits(source, rig, notices)
            expected = Expected()
            routed = route_variants.routed(source, rig, edits, expected)
            every = [*first, *routed, *last]
            self._write(every, part, target, notices, strips=bool(rig.pending.removed))
            if {*map(id, routed)} != {*map(id, edits)} or self._in_instances(edits):
                expected.check(self._composed(part)[0], [*first, *edits])
        self._notices += [notice for notice in notices if notice not in self._notices]
        return ()

    def embedded(self) -> Embedded:
        """All layers as one, with the textures of its materials."""
        source = self._source
        with quiet(f"{source.path}: USD cannot make one layer of it"):
            allowed = self._options.allow_external_paths
            return embedded(source.stage, source.path, allow_external=allowed)

    def needed(self) -> Iterator[tuple[Path, str]]:
        """Layers and assets of all variants; of an override also what it is for."""
        source = self._source
        if self._options.override and not self._is_override():
            yield source.path, "the file that the override is for"
        with quiet(f"{source.path}: USD cannot read what it refers to"):
            files = list(dependencies.files(source.stage, source.path))
        # To edit a file in place is no loss, whoever refers to it.
        yield from (entry for entry in files if not same_file(entry[0], source.path))

    def reopen(self, part: Path) -> UsdDocument:
        """Read what was written; bare opinions are read over the file they were made for."""
        if not self._bare and (not self._streamed or part.suffix.lower() == ".usdz"):
            return UsdDocument.read(part, self._trusting)
        with quiet(f"{part}: USD cannot read it"):
            stage, layer = self._composed(part)
        return UsdDocument(read_source(part, self._options, stage), self._options, layer)

    def _composed(self, part: Path) -> tuple[Any, Any]:
        """The stage of what was written, and the layer in it that an edit would edit."""
        layer = layers.fresh(part)
        if self._streamed and part.suffix.lower() != ".usdz":
            # What a stream got stands where the source stood; a twin with absolute paths does, too.
            layer = layers.copy_of(layer)
            layers.rename_assets(layer, layers.anchored(self._source.path.parent, self._source.layer))
        if self._bare:
            return layers.over(layer, self._source.layer), layer
        if (below := _source_of(layer, part)) is not None:
            return _over(layer, below, part, True)[0], layer
        return Usd.Stage.Open(layer), layer

    def _in_place(self, layer: Any) -> Any:
        """The stage of an anonymous layer that stands where the source stands."""
        layers.rename_assets(layer, layers.anchored(self._source.path.parent, self._source.layer))
        return Usd.Stage.Open(layer)

    @property
    def _trusting(self) -> ReadOptions:
        """Where the output lies in another folder, the source's files are outside it, but were allowed."""
        return replace(self._options, allow_external_paths=True)

    @property
    def _bare(self) -> bool:
        return self._options.override == "layer" and not self._is_override()

    @property
    def _streamed(self) -> bool:
        return self._options.from_stream or self._options.to_stream

    def _in_instances(self, edits: Sequence[Edit]) -> bool:
        stage = self._source.stage
        return any(instance_edits.instance_of(stage, edit.prim) is not None for edit in edits)

    def _is_override(self) -> bool:
        return "override" in dict(self._layer.customLayerData.get(MARK, {}))

    def _rename(self, target: Path) -> layers.Rename | None:
        """How relative asset paths of the source read in the output; None where they stay."""
        if self._streamed:
            return None
        return layers.from_folder(self._source.path.parent, target.parent, self._source.layer)

    def _seen_from(self, target: Path) -> str:
        """The source as a relative asset path of the output."""
        if self._options.to_stream:
            return f"./{self._source.path.name}"
        path = os.path.relpath(self._source.path.resolve(), target.parent.resolve()).replace(os.sep, "/")
        return path if path.startswith("../") else f"./{path}"

    def _write(
        self, edits: list[Edit], part: Path, target: Path, notices: list[Notice], *, strips: bool
    ) -> None:
        source, override = self._source, self._options.override
        if override and not self._is_override():
            layer = self._override(target) if override == "stage" else self._opinions(target)
            _apply(source.stage, edits, layer, notices)
            part.write_bytes(layers.to_bytes(layer, _encoding(target.suffix)))
            return
        packed = source.path.suffix.lower() == ".usdz"
        rename = None if packed else self._rename(target)
        if not edits and rename is None:
            shutil.copyfile(source.path, part)
            return
        layer = layers.copy_of(self._layer)
        # Edits first: what they write has no asset paths, and renamed arcs must not be composed.
        _apply(source.stage, edits, layer, notices)
        if strips and not packed and not self._is_override():
            drop_redundant_opinions.without_repeated(source.stage, layer, edits, self._in_place)
        renamed = rename is not None and layers.rename_assets(layer, rename)
        if not edits and not renamed:
            shutil.copyfile(source.path, part)
        elif packed:
            whole = usdz.read(source.path)
            _check_sums(whole, source.path, notices)
            root = whole.bytes_of(whole.root)
            usdz.write(whole, self._encoded(layer, _by_content(root), root, notices), part)
        else:
            encoding = layers.encoding_of(self._layer)
            content = source.path.read_bytes() if encoding == "usda" else b""
            part.write_bytes(self._encoded(layer, encoding, content, notices))

    def _encoded(self, layer: Any, encoding: str, content: bytes, notices: list[Notice]) -> bytes:
        """An edited copy of the layer as a file; a text stays as it is in all that was not edited."""
        if encoding == "usda":
            lost: list[str] = []
            try:
                told = splice.spliced(content, self._layer, layer, lost)
            except UnknownTextError as why:
                text = f"the text was written anew by USD, which sorts properties and drops comments: {why}"
                notices.append(Notice("text-respelled", text))
            else:
                if lost:
                    what = ", ".join(dict.fromkeys(lost))
                    text = f"comments inside these values went, for the values got another size: {what}"
                    notices.append(Notice("comments-dropped", text))
                return told
        return layers.to_bytes(layer, encoding)

    def _opinions(self, target: Path) -> Any:
        """A layer for bare opinions on the source, to be inserted into any layer stack above it."""
        layer = layers.empty()
        layers.copy_clock(self._source.layer, layer)
        mark: dict[str, Any] = {"override": "layer"}
        if not self._options.from_stream:
            mark["source"] = Sdf.AssetPath(self._seen_from(target))
        layer.customLayerData = {MARK: mark}
        return layer

    def _override(self, target: Path) -> Any:
        """A layer over the source: its stage metadata, and the source as its only sublayer."""
        source = self._source
        if self._options.from_stream:
            raise UsageError(
                "--override-stage names its source, and standard input has no name; "
                "give the file, or use --override."
            )
        layer = layers.empty()
        layers.copy_metadata(source.layer, layer)
        rename = self._rename(target)
        if rename is not None:
            layers.rename_assets(layer, rename)
        layer.subLayerPaths = [self._seen_from(target)]
        layer.customLayerData = {**layer.customLayerData, MARK: {"override": "stage"}}
        return layer

    def _check(self, target: Path) -> None:
        own, wanted = self._source.path.suffix.lower(), target.suffix.lower()
        if self._options.override not in ("", "layer", "stage"):
            raise ValueError(f"override is '', 'layer' or 'stage', not {self._options.override!r}")
        if self._options.override and not self._is_override():
            if wanted in (".usda", ".usd", ".usdc"):
                return
            raise UsageError(f"{target.name}: an override is a .usda, .usd or .usdc file")
        encoding = "usdz" if own == ".usdz" else layers.encoding_of(self._layer)
        fits = {"usda": (".usda", ".usd"), "usdc": (".usdc", ".usd"), "usdz": (".usdz",)}[encoding]
        if wanted != own and wanted not in fits:
            raise UsageError(f"{target.name}: the output's format is the input's, {own}")


def _read_meshes(source: Source, notices: list[Notice]) -> list[Mesh]:
    """The meshes of a source; those that nobody can measure are noticed."""
    rig = source.rig
    nodes = {label: node for node, label in enumerate(rig.labels) if kind(rig.keys[node]) == "prim"}
    skins = {parts(skin.key)[1]: k for k, skin in enumerate(rig.skins) if kind(skin.key) == "skeleton"}
    tokens = {path: skeleton.tokens for path, skeleton in source.skeletons.items()}
    with quiet(f"{source.path}: USD cannot read its meshes"):
        found = mesh_reader.read_meshes(source.stage, source.bindings.every, nodes, skins, tokens)
        playing = {
            path: source.stage.GetPrimAtPath(skeleton.animation)
            for path, skeleton in source.skeletons.items()
            if skeleton.animation
        }
        found = mesh_reader.resting_weights(found, source.bindings.every, playing)
    for mesh in found:
        if mesh.skin is not None and not np.isfinite(mesh.weights).all():
            text = f"mesh '{mesh.name}' has weights that are no numbers; how it looks was not measured"
            if (notice := Notice("mesh-unread", text)) not in notices:
                notices.append(notice)
    return found


def opened(path: Path, *, allow_external: bool) -> tuple[Any, Any, list[Notice]]:
    """The stage of a file (bare opinions of ours over what they are for), its layer, and notices."""
    stage, warnings = open_stage(path, allow_external=allow_external)
    layer = stage.GetRootLayer()
    if (below := _source_of(layer, path)) is not None:
        stage, warnings = _over(layer, below, path, allow_external)
    return stage, layer, warnings


def _source_of(layer: Any, path: Path) -> Path | None:
    """The file that bare opinions of ours are for; None for any other layer, or one put above it."""
    with quiet(f"{path}: USD cannot read it"):
        mark = dict(layer.customLayerData.get(MARK, {}))
    if mark.get("override") != "layer" or list(layer.subLayerPaths):
        return None
    if "source" not in mark:
        raise FileError(
            f"{path}: bare opinions, written with --override for a file that came from standard "
            "input. Make a layer that has this one and that file as sublayers, and give it instead."
        )
    source = Path(layer.ComputeAbsolutePath(mark["source"].path))
    if not source.is_file():
        raise FileError(
            f"{path}: bare opinions, written with --override for {mark['source'].path}, which is not there."
        )
    return source


def _over(layer: Any, below: Path, path: Path, allow_external: bool) -> tuple[Any, list[Notice]]:
    """The stage of bare opinions in ``path`` over the file they are for, and what was noticed about that."""
    external_paths.check_file(below, path, allow_external=allow_external)
    stage, warnings = open_stage(below, allow_external=allow_external)
    with quiet(f"{below}: USD cannot read it"):
        # What their expressions name is known only with the variables of that file.
        variables = variables_of(stage.GetRootLayer())
        held = external_paths.check(path, allow_external=allow_external, variables=variables)
        both = layers.over(layer, stage.GetRootLayer())
        del held  # they had to stay open until the stage has them
    return both, warnings


def _apply(stage: Any, edits: list[Edit], layer: Any, notices: list[Notice]) -> None:
    inside: list[Edit] = []
    with Sdf.ChangeBlock():
        for edit in edits:
            if instance_edits.instance_of(stage, edit.prim) is None:
                edit(layer)
            else:
                inside.append(edit)
    if inside:
        instance_edits.apply(stage, inside, layer, notices)


def _check_sums(whole: usdz.Package, path: Path, notices: list[Notice]) -> None:
    """FileError for a damaged layer that would get a valid checksum; other entries are kept and noticed."""
    damaged = [entry for entry in whole.entries if not whole.is_whole(entry)]
    if whole.root in damaged:
        raise FileError(
            f"{path}: entry '{whole.root.name}' does not have its checksum, so it is damaged. "
            "Copy or export the package again"
        )
    for entry in damaged:
        text = f"entry '{entry.name}' does not have its checksum, so it is damaged; it was kept as it is"
        notices.append(Notice("package-damaged", text))


def _encoding(suffix: str) -> str:
    return "usda" if suffix.lower() == ".usda" else "usdc"


def _by_content(content: bytes) -> str:
    return "usdc" if content.startswith(b"PXR-USDC") else "usda"
