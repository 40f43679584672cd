"""Layers: an editable copy of one, its bytes, and its asset paths seen from another folder."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import gettempdir
from typing import Any

from pxr import Ar, Sdf, Tf, Usd, UsdUtils

from rigtri.errors import FileError
from rigtri.files import temp_dirs
from rigtri.files.mapped_file import load, pour
from rigtri.files.relative_path import relative_path
from rigtri.formats.usd.composition import held_layers
from rigtri.formats.usd.composition.variable_expressions import evaluated, is_one, prefixed, variables_of

Rename = Callable[[str], str]

# The name of layers that are made without content.
_EMPTY = ".usda"


def encoding_of(layer: Any) -> str:
    """``usda`` or ``usdc``: how a layer's file is really written, whatever its suffix."""
    found = Sdf.UsdFileFormat.GetUnderlyingFormatForLayer(layer)
    name = str(found or layer.GetFileFormat().formatId)
    return name if name in ("usda", "usdc") else "usdc"


def copy_of(layer: Any) -> Any:
    """An anonymous layer with the same content and display name, which no other stage sees."""
    copy = Sdf.Layer.CreateAnonymous(layer.GetDisplayName(), Sdf.FileFormat.FindById("usda"))
    copy.TransferContent(layer)
    return copy


def title(layer: Any) -> str:
    """What a layer is called in messages: its file, of a copy the file that it was copied from."""
    return str(layer.GetDisplayName() if layer.anonymous else layer.identifier)


def file_name(layer: Any) -> str:
    """The name of a layer's file; of one in a package that of the package, with the path inside."""
    package, inside = Ar.SplitPackageRelativePathOuter(layer.realPath)
    return Path(package).name + (f"[{inside}]" if inside else "")


def empty() -> Any:
    """An anonymous layer without content."""
    return Sdf.Layer.CreateAnonymous(_EMPTY)


def is_of_file(layer: Any) -> bool:
    """Whether a layer is a file or the copy of one; others hold opinions of an edit or a selection alone."""
    return not (layer.anonymous and layer.GetDisplayName() == _EMPTY)


def fresh(path: Path) -> Any:
    """The layer in a file, as the file is now."""
    known = Sdf.Layer.Find(str(path))
    if known is None:
        return Sdf.Layer.FindOrOpen(str(path))
    # pxr keeps layers that someone holds; the file may have been replaced since.
    now = held_layers.renew(known)
    if now == known:
        now.Reload(True)
    return now


def remove(spec: Any) -> None:
    """Take a prim's spec out of its layer, with all below it; root prims have no parent to USD."""
    del (spec.nameParent or spec.layer.pseudoRoot).nameChildren[spec.name]


def listed_items(spec: Any, field: str) -> list[Any]:
    """What a list of a spec adds or names, such as its ``references``.

    By value: proxies of lists fail where a process has opened and dropped many layers (26.11).
    """
    return list(spec.GetInfo(field).GetAddedOrExplicitItems()) if spec.HasInfo(field) else []


def over(opinions: Any, source: Any) -> Any:
    """A stage of bare opinions over the layer they are about, with that one's metadata."""
    both = empty()
    both.subLayerPaths = [opinions.identifier, source.identifier]
    copy_metadata(source, both)
    return Usd.Stage.Open(both)


def copy_metadata(source: Any, target: Any) -> None:
    """Give a layer the stage metadata of another (up axis, units, time range, default prim …)."""
    UsdUtils.CopyLayerMetadata(source, target, True)


def copy_clock(source: Any, target: Any) -> None:
    """Let a layer count time as another: its samples are scaled where it is sublayered otherwise."""
    if source.HasTimeCodesPerSecond() or source.HasFramesPerSecond():
        # Without timeCodesPerSecond USD goes by framesPerSecond.
        target.timeCodesPerSecond = source.timeCodesPerSecond
    if source.HasFramesPerSecond():
        target.framesPerSecond = source.framesPerSecond


def to_bytes(layer: Any, encoding: str) -> bytes:
    """A layer as the bytes of a file in ``usda`` or ``usdc``.

    FileError where the temporary folder has no room for it.
    """
    if encoding == "usda":
        return str(layer.ExportToString()).encode("utf-8")
    with _exported(layer) as path:
        return path.read_bytes()


def write(layer: Any, encoding: str, part: Path) -> None:
    """Write the bytes of `to_bytes` to a file, without having all of them in memory where it can."""
    if encoding == "usda":
        part.write_bytes(to_bytes(layer, encoding))
        return
    with _exported(layer) as path, part.open("wb") as file:
        pour(file, load(path))


@contextmanager
def _exported(layer: Any) -> Iterator[Path]:
    """A temporary crate file of a layer."""
    with temp_dirs.folder() as folder:
        path = Path(folder, "layer.usdc")
        try:
            layer.Export(str(path))
        except Tf.ErrorException:
            text = "USD cannot write a layer there: make room, or name another folder with TMPDIR"
            raise FileError(f"the temporary folder {gettempdir()}: {text}") from None
        yield path


def from_folder(source: Path, target: Path, layer: Any) -> Rename | None:
    """How asset paths of a layer in ``source`` read from ``target``; None where they are the same.

    Absolute paths, URLs and names on a search path stay as they are. Expressions are put behind the
    way to ``source``; `rename_assets` refuses those that cannot be. One that has no value with the
    variables of ``layer`` may have one below a layer that sets others, so it is treated alike.
    """
    source, target = source.resolve(), target.resolve()
    if source == target:
        return None
    way = _dotted(relative_path(source, target))

    def expressed(path: str) -> str:
        if found := prefixed(path, f"{way}/"):
            return found
        raise _FixedError(path)

    return _renaming(source, lambda path: _dotted(relative_path(source / path, target)), expressed, layer)


def anchored(folder: Path, layer: Any) -> Rename:
    """How asset paths of a layer in ``folder`` read from anywhere: as absolute paths."""
    folder, variables = folder.resolve(), variables_of(layer)

    def absolute(path: str) -> str:
        return os.path.normpath(folder / path).replace(os.sep, "/")

    def expressed(path: str) -> str:
        found = evaluated(path, variables)
        return absolute(found) if found else path

    return _renaming(folder, absolute, expressed, layer)


class _FixedError(Exception):
    """An expression that means another file in another folder."""


def _dotted(path: str) -> str:
    path = path.replace(os.sep, "/")
    return path if path == ".." or path.startswith("../") or os.path.isabs(path) else f"./{path}"


def _renaming(source: Path, moved: Rename, expressed: Rename, layer: Any) -> Rename:
    """Rename what is relative to ``source``: paths, and expressions by their values in ``layer``."""
    variables = variables_of(layer)

    def rename(path: str) -> str:
        value = evaluated(path, variables)
        outer = str(Ar.SplitPackageRelativePathOuter(Sdf.Layer.SplitIdentifier(value)[0])[0])
        # USD leaves a variable that is not set where it stands.
        if is_one(path) and (not outer or "${" in outer):
            return expressed(path)
        if not outer or outer.startswith(("/", "\\")) or ":" in outer.split("/")[0]:
            return path
        # Without a dot in front it is relative only if it is there; else the resolver searches.
        if not outer.startswith(("./", "../")) and not _there(source, outer):
            return path
        return expressed(path) if is_one(path) else moved(outer) + value[len(outer) :]

    return rename


def _there(folder: Path, name: str) -> bool:
    """Whether a file is there; of one with ``<UDIM>`` in its name, whether any tile is."""
    if "<UDIM>" not in name:
        return (folder / name).exists()
    head, _, tail = name.partition("<UDIM>")
    inner, _, start = head.rpartition("/")
    place = folder / inner
    tile = re.compile(f"{re.escape(start)}1[0-9]{{3}}{re.escape(tail)}")
    return place.is_dir() and any(tile.fullmatch(path.name) for path in place.iterdir())


def rename_assets(layer: Any, rename: Rename) -> bool:
    """Rename every asset path in a layer, in place. Returns whether any changed.

    FileError, with the place, for an expression that `from_folder` cannot move.

    UsdUtils.ModifyAssetPaths would do, but it loses the offsets of sublayers
    and the empty elements of asset arrays (26.11).
    """
    with _placed("The layer"):
        changed = [_rename_sublayers(layer, rename)]

    def visit(path: Any) -> None:
        spec = layer.GetObjectAtPath(path)
        if spec is not None:
            with _placed(f"<{path}>"):
                changed.append(_rename_fields(layer, spec, rename))

    layer.Traverse(Sdf.Path.absoluteRootPath, visit)
    return any(changed)


@contextmanager
def _placed(where: str) -> Iterator[None]:
    """Say where an expression stands that cannot be moved."""
    try:
        yield
    except _FixedError as error:
        raise FileError(
            f"{where} asks for {error}, an expression that would name another file in the folder of the "
            "output. Write the output into the folder of the source, or use --edit-target bare"
        ) from None


def _rename_sublayers(layer: Any, rename: Rename) -> bool:
    paths, offsets = list(layer.subLayerPaths), list(layer.subLayerOffsets)
    moved = [rename(path) for path in paths]
    if moved == paths:
        return False
    layer.subLayerPaths = moved
    for number, offset in enumerate(offsets):
        layer.subLayerOffsets[number] = offset
    return True


def _rename_fields(layer: Any, spec: Any, rename: Rename) -> bool:
    changed = False
    for key in spec.ListInfoKeys():
        if key in ("subLayers", "subLayerOffsets"):
            continue
        if key == "timeSamples":
            changed |= _rename_samples(layer, spec, rename)
            continue
        value = spec.GetInfo(key)
        moved = _renamed(value, rename, template=key == "clips")
        if moved is not value:
            spec.SetInfo(key, moved)
            changed = True
    return changed


def _rename_samples(layer: Any, spec: Any, rename: Rename) -> bool:
    if not str(spec.typeName).startswith("asset"):
        return False
    changed = False
    for time in layer.ListTimeSamplesForPath(spec.path):
        value = layer.QueryTimeSample(spec.path, time)
        moved = _renamed(value, rename)
        if moved is not value:
            layer.SetTimeSample(spec.path, time, moved)
            changed = True
    return changed


def _renamed(value: Any, rename: Rename, template: bool = False) -> Any:
    """A value with its asset paths renamed; the very same object where there is nothing to do."""
    if isinstance(value, Sdf.AssetPath):
        moved = rename(value.path)
        return value if moved == value.path else Sdf.AssetPath(moved)
    if isinstance(value, Sdf.AssetPathArray):
        paths = [rename(item.path) for item in value]
        same = paths == [item.path for item in value]
        return value if same else Sdf.AssetPathArray([Sdf.AssetPath(path) for path in paths])
    if isinstance(value, dict):
        items = {key: _renamed_item(key, item, rename, template) for key, item in value.items()}
        return items if any(items[key] is not item for key, item in value.items()) else value
    if isinstance(value, Sdf.ReferenceListOp | Sdf.PayloadListOp):
        return _renamed_list(value, rename)
    return value


def _renamed_item(key: str, item: Any, rename: Rename, template: bool) -> Any:
    if template and key == "templateAssetPath" and isinstance(item, str):
        if is_one(item):
            return rename(item)
        folder, slash, name = item.rpartition("/")
        # '#' stands for digits, so the name itself cannot be looked for.
        return rename(f"{folder}/_").removesuffix("_") + name if slash else item
    return _renamed(item, rename, template)


def _renamed_list(value: Any, rename: Rename) -> Any:
    moved, changed = type(value)(), False
    fields = ("explicitItems",) if value.isExplicit else (
        "addedItems", "prependedItems", "appendedItems", "deletedItems", "orderedItems")  # fmt: skip
    for field in fields:
        items = list(getattr(value, field))
        new = [_renamed_arc(item, rename) for item in items]
        changed = changed or new != items
        if new or field == "explicitItems":
            setattr(moved, field, new)
    return moved if changed else value


def _renamed_arc(item: Any, rename: Rename) -> Any:
    if not item.assetPath:
        return item
    path = rename(item.assetPath)
    if isinstance(item, Sdf.Reference):
        return Sdf.Reference(path, item.primPath, item.layerOffset, item.customData)
    return Sdf.Payload(path, item.primPath, item.layerOffset)
