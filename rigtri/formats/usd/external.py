"""Which files a USD file makes USD open, looked through before any stage is composed.

Sublayers, references, payloads (of every variant) and value clips are followed from
layer to layer. What lies outside the folder of the file is opened only if the
user allows it; other schemes than files never are. Textures and other assets are
never opened at all.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pxr import Ar, Sdf, Tf

from rigtri.errors import FileError
from rigtri.formats.usd import crate, package

# How deep packages may stand in each other.
NESTED = 4
# A scheme, of two letters at least: C:/hero.usd is a Windows path.
_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:")


def check(path: Path, *, allow_external: bool) -> list[Any]:
    """Look at every layer that composing ``path`` may open; returns those layers, still open.

    FileError for one that lies outside the folder of ``path`` (unless allowed) or on a network,
    naming the layer and the prim that ask for it.
    """
    folder = path.parent.resolve()
    root = Sdf.Layer.FindOrOpen(str(path))
    layers = [root] if root else []
    known = {layer.identifier for layer in layers}
    for layer in layers:
        for wanted, where, composed in asked(layer):
            identifier = _identifier(layer, wanted, where, folder, allow_external)
            if not identifier or identifier in known:
                continue
            known.add(identifier)
            check_content(identifier)
            # Layers of value clips are not composed, and opened one by one when needed.
            if composed and (found := _opened(identifier)) is not None:
                layers.append(found)
    return layers


def check_content(identifier: str) -> None:
    """FileError for binary layers whose tables are damaged, in a package those of all its entries."""
    file = Path(Sdf.Layer.SplitIdentifier(identifier)[0].partition("[")[0])
    if not file.is_file():
        return
    if file.suffix.lower() != ".usdz":
        crate.check_file(file)
        return
    _check_entries(package.read(file), str(file), NESTED)


def _check_entries(whole: package.Package, name: str, deeper: int) -> None:
    """The same for the entries of a package, and of packages in it."""
    for entry in whole.entries:
        content = memoryview(whole.content)[entry.start : entry.start + entry.size]
        title = f"{name}[{entry.name}]"
        if content[: len(crate.MAGIC)] == crate.MAGIC:
            crate.check(content, title)
        elif entry.name.lower().endswith(".usdz") and not entry.method:
            if not deeper:
                raise FileError(f"{title}: packages stand in each other more than {NESTED} deep. Unpack them")
            try:
                inner = package.parse(bytes(content), title)
            except FileError:
                continue  # USD cannot open it either, which is told where it is needed
            _check_entries(inner, title, deeper - 1)


def _opened(identifier: str) -> Any:
    """A layer; None for one that USD cannot read, which is told when the stage is composed."""
    try:
        return Sdf.Layer.FindOrOpen(identifier)
    except Tf.ErrorException:
        return None


def check_used(stage: Any, path: Path, *, allow_external: bool) -> None:
    """FileError for a layer of a stage that lies outside: one that a variable expression named."""
    folder = path.parent.resolve()
    for layer in stage.GetUsedLayers():
        if layer.realPath and not allow_external and _lies_outside(layer.realPath, folder):
            raise _outside(layer.identifier, f"{path}")


def check_file(other: Path, path: Path, *, allow_external: bool) -> None:
    """FileError for a file that ``path`` is about and that lies outside its folder."""
    if not allow_external and _lies_outside(str(other), path.parent.resolve()):
        raise _outside(str(other), f"{path}")


def _identifier(layer: Any, asked: str, where: str, folder: Path, allow_external: bool) -> str:
    """The identifier of an asset path as USD resolves it; "" where there is nothing to open."""
    if _SCHEME.match(asked):
        raise FileError(f"{where} asks for '{asked}'; rigtri fetches nothing. Put the layer beside this one.")
    resolver = Ar.GetResolver()
    anchor = Ar.ResolvedPath(layer.realPath)
    plain, arguments = Sdf.Layer.SplitIdentifier(asked)
    identifier = resolver.CreateIdentifier(plain, anchor)
    resolved = str(resolver.Resolve(identifier))
    if not resolved:
        return ""  # what is not there is told when the stage is composed
    if not allow_external and _lies_outside(resolved, folder):
        raise _outside(asked, where)
    return str(Sdf.Layer.CreateIdentifier(identifier, arguments))


def _outside(asked: str, where: str) -> FileError:
    return FileError(
        f"{where} asks for '{asked}', which lies outside the folder of the file. "
        "If you trust it, allow this with --allow-external-paths"
    )


def _lies_outside(resolved: str, folder: Path) -> bool:
    """Whether a file, or the package it is in, is not below a folder; links count by what they lead to."""
    return not Path(os.path.realpath(resolved.partition("[")[0])).is_relative_to(folder)


def asked(layer: Any) -> Iterator[tuple[str, str, bool]]:
    """The asset paths of layers that a layer asks for: each with where it does, and whether to compose."""
    for asked in layer.subLayerPaths:
        yield asked, layer.identifier, True
    found: list[tuple[str, str, bool]] = []

    def visit(path: Any) -> None:
        prims = path.IsPrimPath() or path.IsPrimVariantSelectionPath()
        spec = layer.GetPrimAtPath(path) if prims else None
        if spec is not None:
            place = f"<{path}> of {layer.identifier}"
            found.extend((asked, place, True) for asked in _arcs(spec))
            if spec.HasInfo("clips"):
                found.extend((asked, place, False) for asked in _clips(spec, layer))

    layer.Traverse(Sdf.Path.absoluteRootPath, visit)
    yield from (entry for entry in found if entry[0] and not entry[0].startswith("`"))


def _arcs(spec: Any) -> Iterator[str]:
    for arcs in (spec.referenceList, spec.payloadList):
        yield from (arc.assetPath for arc in arcs.GetAddedOrExplicitItems())


def _clips(spec: Any, layer: Any) -> Iterator[str]:
    for clips in spec.GetInfo("clips").values():
        yield from (asset.path for asset in clips.get("assetPaths", ()))
        if "manifestAssetPath" in clips:
            yield clips["manifestAssetPath"].path
        if "templateAssetPath" in clips:
            yield from _matching(str(clips["templateAssetPath"]), layer)


def _matching(template: str, layer: Any) -> Iterator[str]:
    """The files that a template such as ``clips/walk.###.usd`` names, as asset paths."""
    inner, slash, name = template.rpartition("/")
    folder = Path(layer.realPath).parent / inner
    wanted = re.compile(re.sub(r"(?:\\#)+", "-?[0-9]+", re.escape(name)))
    if folder.is_dir():
        yield from (f"{inner}{slash}{item}" for item in sorted(os.listdir(folder)) if wanted.fullmatch(item))
