"""How two USD files differ as files: layers, prims, properties, metadata, samples, package entries.

Layers are compared as they are written (Sdf). What is composed of them is compared
only where no layer differs: then it is the composition that does.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from pxr import Ar, Sdf, Tf

from rigtri.errors import FileError
from rigtri.files.relative_path import relative_path
from rigtri.formats import ReadOptions
from rigtri.formats.usd import usdz
from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.composition.stage import open_stage, quiet
from rigtri.verification.diff.change import Change, arrow, order_of
from rigtri.verification.diff.usd_layer_diff import layer_changes


def file_changes(before: Path, after: Path, options: ReadOptions, tolerance: float) -> list[Change]:
    """Everything in which the second file is not the first. FileError where one is no USD at all."""
    allowed = {"allow_external": options.allow_external_paths, "allow_missing": options.allow_missing}
    stages = [open_stage(path, **allowed)[0] for path in (before, after)]
    with quiet(f"{after}: USD cannot compare it with {before}"):
        found = []
        encodings = [_encoding(path, stage) for path, stage in zip((before, after), stages, strict=True)]
        if encodings[0] != encodings[1]:
            found.append(Change("layers", "changed", "root layer", f"encoding {arrow(*encodings)}"))
        layered = list(_layers(stages, (before, after), tolerance))
        if not layered:
            layered = list(_composed(stages, (before, after), tolerance))
    if before.suffix.lower() == after.suffix.lower() == ".usdz":
        found += _entries(usdz.read(before), usdz.read(after), tolerance)
    elif ".usdz" in (before.suffix.lower(), after.suffix.lower()):
        found.append(Change("package", "changed", "container", arrow(before.suffix, after.suffix)))
    return found + layered


def _encoding(path: Path, stage: Any) -> str:
    if path.suffix.lower() != ".usdz":
        return layers.encoding_of(stage.GetRootLayer())
    whole = usdz.read(path)
    return "usdc" if whole.bytes_of(whole.root).startswith(b"PXR-USDC") else "usda"


def _layers(stages: Sequence[Any], paths: tuple[Path, Path], tolerance: float) -> Iterator[Change]:
    """The root layers, and the other layers of both stages by their place beside the root."""
    one, other = (stage.GetRootLayer() for stage in stages)
    yield from layer_changes(one, other, "root layer", tolerance)
    mine, theirs = (_others(stage, path) for stage, path in zip(stages, paths, strict=True))
    # One and the same file, though one root reaches it by another way.
    shared = {_real(layer) for layer in mine.values()} & {_real(layer) for layer in theirs.values()}
    for name, layer in mine.items():
        if _real(layer) in shared:
            continue
        if name not in theirs:
            yield Change("layers", "removed", name)
        else:
            yield from layer_changes(layer, theirs[name], name, tolerance)
    for name, layer in theirs.items():
        if name not in mine and _real(layer) not in shared:
            yield Change("layers", "added", name)


def _real(layer: Any) -> str:
    """Where a layer lies, whatever links lead there."""
    name = str(layer.identifier)
    outer = str(Ar.SplitPackageRelativePathOuter(name)[0])
    return os.path.realpath(outer) + name[len(outer) :]


def _others(stage: Any, path: Path) -> dict[str, Any]:
    """The layers a stage uses besides its root, by their path as seen from its file."""
    root, found = stage.GetRootLayer(), {}
    own = (stage.GetSessionLayer(), root)
    for layer in sorted(stage.GetUsedLayers(), key=lambda layer: str(layer.identifier)):
        if layer not in own:
            found[_seen_from(path, layer.identifier)] = layer
    return found


def _seen_from(path: Path, identifier: str) -> str:
    outer, inner = Ar.SplitPackageRelativePathOuter(Sdf.Layer.SplitIdentifier(identifier)[0])
    if inner and Path(outer).resolve() == path.resolve():
        return str(inner)
    return relative_path(Path(outer).resolve(), path.parent.resolve()) + (f"[{inner}]" if inner else "")


def _composed(stages: Sequence[Any], paths: tuple[Path, Path], tolerance: float) -> Iterator[Change]:
    """What the composed stages show differently, though no layer differs."""
    if all(len(stage.GetUsedLayers()) <= 2 for stage in stages):
        return  # the root and the session: nothing is composed
    flat = [_flattened(stage, path) for stage, path in zip(stages, paths, strict=True)]
    yield from layer_changes(flat[0], flat[1], "composed stage", tolerance)


def _flattened(stage: Any, path: Path) -> Any:
    """One layer with all a stage is composed of, its assets as seen from the file."""
    try:
        layer = stage.Flatten(addSourceFileComment=False)
    except Tf.ErrorException as error:
        raise FileError(f"{path}: USD cannot flatten it: {error}") from None
    folder = str(path.parent.resolve())

    def seen(name: str) -> str:
        return os.path.relpath(name, folder) if name.startswith(folder) else name

    layers.rename_assets(layer, seen)
    return layer


def _entries(before: usdz.Package, after: usdz.Package, tolerance: float) -> Iterator[Change]:
    """Entries of packages: names, order, bytes, dates, extra fields, comments.

    With a tolerance the bytes of layers are not compared, for their values are.
    """
    group, theirs = "package", {entry.name: entry for entry in after.entries}
    for entry in before.entries:
        other = theirs.get(entry.name)
        if other is None:
            yield Change(group, "removed", entry.name, f"{entry.size} bytes")
            continue
        layer = entry.name.lower().endswith((".usd", ".usda", ".usdc"))
        if not (layer and tolerance) and before.bytes_of(entry) != after.bytes_of(other):
            same_size = entry.size == other.size
            text = f"{entry.size} bytes, other ones" if same_size else f"{entry.size} → {other.size} bytes"
            yield Change(group, "changed", entry.name, text)
        if (entry.date, entry.time) != (other.date, other.time):
            yield Change(group, "changed", entry.name, f"date {arrow(_date(entry), _date(other))}")
        for name in ("extra", "central_extra", "comment", "external", "internal", "made_by"):
            was, now = getattr(entry, name), getattr(other, name)
            if was != now:
                yield Change(group, "changed", entry.name, f"{name.replace('_', ' ')} {arrow(was, now)}")
    known = {entry.name for entry in before.entries}
    for entry in after.entries:
        if entry.name not in known:
            yield Change(group, "added", entry.name, f"{entry.size} bytes")
    if text := order_of([e.name for e in before.entries], [e.name for e in after.entries]):
        yield Change(group, "moved", "entries", f"order: {text}")
    if before.comment != after.comment:
        yield Change(group, "changed", "comment of the package", arrow(before.comment, after.comment))


def _date(entry: usdz.Entry) -> str:
    date, time = entry.date, entry.time
    day = f"{1980 + (date >> 9)}-{date >> 5 & 15:02}-{date & 31:02}"
    return f"{day} {time >> 11:02}:{time >> 5 & 63:02}:{2 * (time & 31):02}"
