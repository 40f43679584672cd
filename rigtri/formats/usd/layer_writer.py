"""Where an edit of a stage is written: a copy of its layer, the root layer of a package, or an override."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

from pxr import Sdf, Usd

from rigtri.errors import FileError, UsageError
from rigtri.files.mapped_file import load, pour
from rigtri.files.relative_path import relative_path
from rigtri.formats.document import ReadOptions
from rigtri.formats.usd import usdz
from rigtri.formats.usd.composition import edit_target, layers
from rigtri.formats.usd.composition.stage import DEFAULT, MARK, is_override, open_over, overridden_file
from rigtri.formats.usd.composition.time_samples import time_samples
from rigtri.formats.usd.opinions.edits import Edit, Setting
from rigtri.formats.usd.opinions.instance_edits import apply_edits, drop_empty_classes
from rigtri.formats.usd.reading.source import Source
from rigtri.formats.usd.text import splice
from rigtri.formats.usd.text.statements import UnknownTextError
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.report import Notice
from rigtri.text import and_more

# What an attribute has besides its values.
_METADATA = ("typeName", "variability", "custom", "elementSize", "interpolation", "customData")


@dataclass(frozen=True, eq=False)
class Output:
    """What becomes of a source.

    layer: the one to edit, the stage's root layer or the opinions above it. read: the bytes of the root
    layer's file.
    """

    source: Source
    layer: Any
    options: ReadOptions
    read: memoryview

    @property
    def is_bare(self) -> bool:
        """Whether the output has the opinions alone, as a new layer."""
        return self.options.edit_target == "bare" and not is_override(self.layer)

    @property
    def is_sublayer(self) -> bool:
        """Whether the output is a sublayer of the source, edited."""
        named = self.options.edit_target != "root" and not self.options.is_override
        return named and self.layer != self.source.layer

    @property
    def layer_path(self) -> Path:
        """The file of what is edited."""
        return Path(self.layer.realPath) if self.is_sublayer else self.source.path

    @cached_property
    def times(self) -> edit_target.LayerTimes | None:
        """How its times are those of the stage; None for the root layer, whose they are."""
        return edit_target.LayerTimes(self.source.stage, self.layer) if self.is_sublayer else None

    @property
    def content(self) -> memoryview:
        """The bytes of that file as it was read."""
        return self.read if self.layer == self.source.layer else load(self.layer_path)

    @property
    def is_streamed(self) -> bool:
        return self.options.from_stream or self.options.to_stream

    @property
    def is_new_layer(self) -> bool:
        """Whether the output is an override of its source, and not the source edited."""
        return self.options.is_override and not is_override(self.layer)

    def check_metrics(self, rig: Rig) -> None:
        """UsageError for another unit or up axis in a layer whose own no stage has."""
        if rig.pending.conversion is not None and (self.is_sublayer or self.is_bare):
            raise UsageError(
                f"--edit-target {self.options.edit_target}: the unit and the up axis of a stage are those of "
                "its root layer. Convert that, with --edit-target root or new"
            )

    def check_target(self, target: Path) -> None:
        """UsageError for a target of another format."""
        own, suffix = self.layer_path.suffix.lower(), target.suffix.lower()
        if self.is_new_layer:
            if suffix in (".usda", ".usd", ".usdc"):
                return
            raise UsageError(f"{target.name}: an override is a .usda, .usd or .usdc file")
        encoding = "usdz" if own == ".usdz" else layers.encoding_of(self.layer)
        fits = {"usda": (".usda", ".usd"), "usdc": (".usdc", ".usd"), "usdz": (".usdz",)}[encoding]
        if suffix != own and suffix not in fits:
            raise UsageError(f"{target.name}: the output's format is the input's, {own}")

    def write(
        self, edits: Sequence[Edit], part: Path, target: Path, notices: list[Notice], *, strips: bool
    ) -> None:
        """Write ``part`` with edits, as the file that ``target`` will be; their times are those of the stage.

        strips: something was removed, so what was put back as it lies in a weaker layer needs no opinion,
        and an over that held nothing else goes, too.
        """
        stage = self.source.stage
        if self.is_new_layer:
            layer = self._over_source(target) if self.options.edit_target == "new" else self._bare(target)
            apply_edits(stage, edits, layer)
            encoding = "usda" if target.suffix.lower() == ".usda" else "usdc"
            layers.write(layer, encoding, part)
            return
        path = self.layer_path
        packed = path.suffix.lower() == ".usdz"
        rename = None if packed else self._rename(target)
        if not edits and rename is None:
            self._copy(part)
            return
        layer = layers.copy_of(self.layer)
        self._check_copied(edits, notices)
        # Edits first: what they write has no asset paths, and renamed arcs must not be composed.
        apply_edits(stage, self._in_layer_time(edits), layer)
        if strips and not (packed or self.is_sublayer or is_override(self.layer)):
            _drop_redundant(stage, layer, edits, self._composed_in_place)
        if strips:
            _drop_bare(self.layer, layer, edits)
            drop_empty_classes(layer)
        renamed = rename is not None and layers.rename_assets(layer, rename)
        if not edits and not renamed:
            self._copy(part)
        elif packed:
            package = usdz.parse(bytes(self.content), str(path))
            _check_sums(package, path, notices)
            root = package.bytes_of(package.root)
            encoding = "usdc" if root.startswith(b"PXR-USDC") else "usda"
            usdz.write(package, self._encoded(layer, encoding, root, notices), part)
        else:
            encoding = layers.encoding_of(self.layer)
            if encoding == "usda":
                part.write_bytes(self._encoded(layer, encoding, bytes(self.content), notices))
            else:
                layers.write(layer, encoding, part)

    def _in_layer_time(self, edits: Sequence[Edit]) -> list[Edit]:
        if (times := self.times) is None:
            return list(edits)
        return [edit.retimed(times.in_layer) if isinstance(edit, Setting) else edit for edit in edits]

    def as_composed(self, setting: Setting) -> Setting:
        """A setting as the stage shows it once it is written."""
        return setting if self.times is None else setting.retimed(self.times.as_composed)

    def _copy(self, part: Path) -> None:
        with part.open("wb") as file:
            pour(file, self.content)

    def hidden(self, edits: Sequence[Edit]) -> dict[str, list[str]]:
        """By file, the attributes whose opinions in other layers the output comes to hide.

        Those of all instances, which an edit of the first one is an edit of.
        """
        below: dict[str, dict[Any, dict[str, None]]] = {}
        for setting in _settings(edits):
            for spec, _ in self._taken_over(setting):
                names = below.setdefault(layers.file_name(spec.layer), {}).setdefault(setting.prim, {})
                names[setting.name] = None
        each = self.source.instances.each
        return {
            layer: [
                f"{path}.{name}" for prim, names in prims.items() for path in each(prim) for name in names
            ]
            for layer, prims in below.items()
        }

    def _taken_over(self, setting: Setting) -> list[tuple[Any, Any]]:
        """The opinions of other layers that none of the edited one has hidden so far, with their offsets."""
        attribute = self.source.stage.GetAttributeAtPath(setting.path)
        found = attribute.GetPropertyStackWithLayerOffsets(DEFAULT) if attribute else []
        if not self.is_new_layer and any(spec.layer == self.layer and _has_value(spec) for spec, _ in found):
            return []
        return [(spec, offset) for spec, offset in found if self.is_new_layer or spec.layer != self.layer]

    def _check_copied(self, edits: Sequence[Edit], notices: list[Notice]) -> None:
        """Notice samples that a sublayer gets of another layer's, where one of them counts time otherwise."""
        if self.times is None:
            return
        copied: dict[str, str] = {}
        for setting in _settings(edits):
            for spec, offset in self._taken_over(setting) if setting.samples else ():
                moved = not (offset.IsIdentity() and self.times.offset.IsIdentity())
                if moved and spec.layer.GetNumTimeSamplesForPath(spec.path):
                    copied.setdefault(f"<{setting.path}>", layers.file_name(spec.layer))
        if copied:
            own, root = layers.file_name(self.layer), layers.file_name(self.source.layer)
            text = (
                f"{own} also gets the samples of {and_more(copied, 3)}, which {root} has from "
                f"{and_more(dict.fromkeys(copied.values()), 3)}, for this edit changes them. They are at the "
                f"times of {root}: where {own} has another offset or scale, edit it with that stage"
            )
            notices.append(Notice("samples-copied", text))

    def composed(self, part: Path) -> tuple[Any, Any]:
        """The stage of what was written, and the layer in it that an edit would edit."""
        layer = layers.fresh(part)
        if self.is_sublayer:
            return edit_target.with_other(self.source.layer, self.layer, layer.identifier), layer
        if self.is_streamed and part.suffix.lower() != ".usdz":
            # What a stream got stands where the source stood; a copy with absolute paths does, too.
            layer = self._anchored(layers.copy_of(layer))
        if self.is_bare:
            return layers.over(layer, self.source.layer), layer
        if (below := overridden_file(layer, part)) is not None:
            missing = self.options.allow_missing
            return open_over(layer, below, part, allow_external=True, allow_missing=missing)[0], layer
        return Usd.Stage.Open(layer), layer

    def _composed_in_place(self, layer: Any) -> Any:
        """The stage of an anonymous layer that stands where the source stands."""
        return Usd.Stage.Open(self._anchored(layer))

    def _anchored(self, layer: Any) -> Any:
        """An anonymous layer with the asset paths of the source's folder, made absolute in place."""
        layers.rename_assets(layer, layers.anchored(self.source.path.parent, self.source.layer))
        return layer

    def _rename(self, target: Path) -> layers.Rename | None:
        """How relative asset paths of the source read in the output; None where they stay."""
        if self.is_streamed:
            return None
        return layers.from_folder(self.layer_path.parent, target.parent, self.source.layer)

    def _source_from(self, target: Path) -> str:
        """The source as a relative asset path of the output."""
        if self.options.to_stream:
            return f"./{self.source.path.name}"
        path = relative_path(self.source.path.resolve(), target.parent.resolve())
        return path if path.startswith("../") or os.path.isabs(path) else f"./{path}"

    def _encoded(self, layer: Any, encoding: str, content: bytes, notices: list[Notice]) -> bytes:
        """An edited copy of the layer as a file; a text stays as it is in all that was not edited."""
        if encoding == "usda":
            lost: list[str] = []
            try:
                text = splice.spliced(content, self.layer, layer, lost)
            except UnknownTextError as why:
                reason = f"the text was rewritten by USD, which sorts properties and drops comments: {why}"
                notices.append(Notice("text-respelled", reason))
            else:
                if lost:
                    what = ", ".join(dict.fromkeys(lost))
                    reason = f"comments inside these values went, for the values got another size: {what}"
                    notices.append(Notice("comments-dropped", reason))
                return text
        return layers.to_bytes(layer, encoding)

    def _bare(self, target: Path) -> Any:
        """A layer for bare opinions on the source, to be inserted into any layer stack above it."""
        layer = layers.empty()
        layers.copy_clock(self.source.layer, layer)
        mark: dict[str, Any] = {"override": "layer"}
        if not self.options.from_stream:
            mark["source"] = Sdf.AssetPath(self._source_from(target))
        layer.customLayerData = {MARK: mark}
        return layer

    def _over_source(self, target: Path) -> Any:
        """A layer over the source: its stage metadata, and the source as its only sublayer."""
        if self.options.from_stream:
            raise UsageError(
                "--edit-target new: the layer names IN, and standard input has no name; "
                "give the file, or use --edit-target bare."
            )
        layer = layers.empty()
        layers.copy_metadata(self.source.layer, layer)
        rename = self._rename(target)
        if rename is not None:
            layers.rename_assets(layer, rename)
        layer.subLayerPaths = [self._source_from(target)]
        layer.customLayerData = {**layer.customLayerData, MARK: {"override": "stage"}}
        return layer


def _settings(edits: Iterable[Edit]) -> Iterator[Setting]:
    return (edit for edit in edits if isinstance(edit, Setting))


def _has_value(spec: Any) -> bool:
    return bool(spec.HasDefaultValue() or spec.layer.GetNumTimeSamplesForPath(spec.path))


def _drop_redundant(stage: Any, layer: Any, edits: Iterable[Edit], composed: Callable[[Any], Any]) -> None:
    """Take values out of a layer that only repeat what weaker layers hold, and overs left bare.

    edits: what has set values, as where strip has put one back.
    stage: of the source. composed: the stage of a layer in the source's place, which it may change.
    """
    paths = {edit.path for edit in edits if isinstance(edit, Setting)}
    paths = {path for path in sorted(paths) if layer.GetAttributeAtPath(path) and _lies_below(stage, path)}
    if not paths:
        return
    bare = layers.copy_of(layer)
    for path in paths:
        _remove(bare, path)
    shown, below = composed(layers.copy_of(layer)), composed(bare)
    same = [path for path in sorted(paths) if _resolved(shown, path) == _resolved(below, path)]
    with Sdf.ChangeBlock():
        for path in same:
            _remove(layer, path)
    for path in same:
        _prune(layer, path.GetPrimPath())


def _drop_bare(before: Any, layer: Any, edits: Iterable[Edit]) -> None:
    """Take away overs that only held what the edits have removed."""
    for path in {Sdf.Path(edit.prim) for edit in edits}:
        was = before.GetPrimAtPath(path)
        if was and (was.properties or was.nameChildren or not layer.GetPrimAtPath(path)):
            _prune(layer, path)


def _lies_below(stage: Any, path: Any) -> bool:
    attribute = stage.GetAttributeAtPath(path)
    return bool(attribute) and any(
        spec.layer != stage.GetRootLayer() for spec in attribute.GetPropertyStack(DEFAULT)
    )


def _resolved(stage: Any, path: Any) -> Any:
    """Metadata, default and samples of an attribute; None where it has none."""
    attribute = stage.GetAttributeAtPath(path)
    if not attribute or not attribute.HasAuthoredValue():
        return None
    metadata = {key: attribute.GetMetadata(key) for key in _METADATA}
    return metadata, attribute.Get(DEFAULT), list(time_samples(attribute))


def _remove(layer: Any, path: Any) -> None:
    spec = layer.GetAttributeAtPath(path)
    del spec.owner.properties[spec.name]


def _prune(layer: Any, path: Any) -> None:
    """Take away a prim, and those above it, that are overs of nothing."""
    while path != Sdf.Path.absoluteRootPath:
        spec = layer.GetPrimAtPath(path)
        path = path.GetParentPath()
        if spec is None:
            continue
        more = {key for key in spec.ListInfoKeys() if key != "specifier"}
        if spec.specifier != Sdf.SpecifierOver or spec.properties or spec.nameChildren or more:
            return
        if spec.variantSets:
            return
        layers.remove(spec)


def _check_sums(package: usdz.Package, path: Path, notices: list[Notice]) -> None:
    """FileError for a damaged layer that would get a valid checksum; other entries are kept and noticed."""
    damaged = [entry for entry in package.entries if not package.is_whole(entry)]
    if package.root in damaged:
        raise FileError(
            f"{path}: entry '{package.root.name}' does not have its checksum, so it is damaged. "
            "Copy or export the package again"
        )
    for entry in damaged:
        text = f"entry '{entry.name}' does not have its checksum, so it is damaged; it was kept as it is"
        notices.append(Notice("package-damaged", text))
