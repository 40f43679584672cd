"""Which files a USD file refers to, and which of them USD may open: known before any stage is composed.

Sublayers, references, payloads (of every variant) and value clips are followed from
layer to layer. What lies outside the folder of the file is opened only if the
user allows it. Other schemes than files are left to an Ar resolver that the site has set up for them
(`PXR_PLUGINPATH_NAME`), which is trusted; rigtri fetches nothing itself. Textures and other assets are
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
from rigtri.formats.usd.composition import held_layers, layer_content, layers
from rigtri.formats.usd.composition.variable_expressions import Variables, evaluated, variables_of

# In how many ways one layer may be referred to, by the variables that are set above it.
SETTINGS = 64
# A scheme, of two letters at least: C:/hero.usd is a Windows path.
_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:")


def check(
    path: Path,
    *,
    allow_external: bool,
    allow_missing: bool = False,
    variables: Variables | None = None,
    root: Any = None,
) -> list[Any]:
    """Look at every layer that composing ``path`` may open; returns those layers, still open.

    variables: of the layer stack that it will be part of; its own where there is none above. root: what was
    read of ``path`` before, instead of what is there now.
    FileError for one that lies outside the folder of ``path`` (unless allowed), on a network or
    in no plain file, naming the layer and the prim that refer to it; and for a damaged one, but for those
    that USD leaves out by itself if that is allowed (``allow_missing``).
    """
    known_root = root
    root = root or Sdf.Layer.FindOrOpen(str(path))
    found: dict[str, Any] = {}
    # A layer is looked at again where other variables are set, which its expressions may name.
    waiting: list[tuple[Any, Variables]] = []
    if root:
        waiting.append((root, variables_of(root) if variables is None else variables))
    known: dict[str, list[Variables]] = {}
    sound: set[str] = set()
    for layer, given in waiting:
        seen = known.setdefault(layer.identifier, [])
        if given in seen:
            continue
        if len(seen) >= SETTINGS:
            raise FileError(
                f"{layer.identifier} is referred to with more than {SETTINGS} settings of "
                "expressionVariables. Write the asset paths without expressions"
            )
        if not seen and layer != known_root:
            layer = held_layers.renew(layer)
        seen.append(given)
        found[layer.identifier] = layer
        waiting += _below(layer, given, path, allow_external, allow_missing, sound)
    return list(found.values())


def _below(
    layer: Any,
    variables: Variables,
    path: Path,
    allow_external: bool,
    allow_missing: bool,
    sound: set[str],
) -> Iterator[tuple[Any, Variables]]:
    """The layers that one refers to and that are composed, each with the variables it gets there.

    sound: the identifiers whose content was looked at, which grows.
    """
    for asset, where, arc in asset_paths(layer, variables):
        identifier = _identifier(layer, asset, where, path, allow_external)
        if not identifier:
            continue
        if identifier not in sound:
            _check_content(identifier, allow_missing)
            sound.add(identifier)
        # Layers of value clips are not composed, and opened one by one when needed.
        if arc != "clip" and (found := _opened(identifier)) is not None:
            # A sublayer is of the same layer stack; the variables of another stack are weaker.
            yield found, variables if arc == "sublayer" else {**variables_of(found), **variables}


def _check_content(identifier: str, allow_missing: bool) -> None:
    """FileError for a damaged layer; not for one that USD can leave out, if that is allowed."""
    try:
        layer_content.check(identifier)
    except FileError as error:
        if not layer_content.is_cut_off(identifier):
            raise
        if not allow_missing:
            why = layer_content.why_unread(identifier)
            if not why:
                raise FileError(f"{error}, or leave it out with --allow-missing") from None
            raise FileError(
                f"{identifier}: USD cannot read this layer, which the file refers to: {why}. Repair or "
                "export it again, or leave it out with --allow-missing"
            ) from None


def _opened(identifier: str) -> Any:
    """A layer; None for one that USD cannot read, which is reported when the stage is composed."""
    try:
        return Sdf.Layer.FindOrOpen(identifier)
    except Tf.ErrorException:
        return None


def check_outside(file: str, path: Path, name: str, *, allow_external: bool) -> None:
    """FileError for a file, called ``name``, that lies outside the folder of ``path``, which needs it."""
    if not allow_external and lies_outside(file, path):
        raise _outside(name, f"{path}")


def _identifier(layer: Any, asset: str, where: str, path: Path, allow_external: bool) -> str:
    """The identifier of an asset path as USD resolves it; "" where there is nothing to open."""
    resolver = Ar.GetResolver()
    anchor = Ar.ResolvedPath(layer.realPath)
    plain, arguments = Sdf.Layer.SplitIdentifier(asset)
    identifier = resolver.CreateIdentifier(plain, anchor)
    resolved = str(resolver.Resolve(identifier))
    if not resolved and _SCHEME.match(asset):
        raise FileError(
            f"{where} asks for '{asset}'; rigtri fetches nothing, and no Ar resolver opens it. Set up the "
            "resolver of your site (PXR_PLUGINPATH_NAME), or refer to a copy of that file by its path."
        )
    if not resolved:
        return ""  # what is not there is reported when the stage is composed
    if is_of_site(identifier):
        return str(Sdf.Layer.CreateIdentifier(identifier, arguments))
    if not allow_external and lies_outside(resolved, path):
        raise _outside(asset, where)
    file = layer_content.outer_file(resolved)
    if file.exists() and not (file.is_file() or file.is_dir()):
        raise FileError(f"{where} asks for '{asset}', which is a device or a pipe. Put a plain file there")
    return str(Sdf.Layer.CreateIdentifier(identifier, arguments))


def is_of_site(identifier: str) -> bool:
    """Whether a resolver that the site has set up opens an asset, wherever that lies."""
    scheme = _SCHEME.match(identifier)
    return scheme is not None and scheme[0][:-1].lower() in {
        known.lower() for known in Ar.GetRegisteredURISchemes()
    }


def _outside(asset: str, where: str) -> FileError:
    return FileError(
        f"{where} asks for '{asset}', which lies outside the folder of the file. "
        "If you trust it, allow this with --allow-external-paths"
    )


def lies_outside(resolved: str, path: Path) -> bool:
    """Whether a file, or the package it is in, is not below the folder of ``path``.

    Links count by what they lead to; but ``path`` itself is the file that the user named.
    """
    file = Path(os.path.realpath(layer_content.outer_file(resolved)))
    return not file.is_relative_to(path.parent.resolve()) and file != path.resolve()


def texture(asset: Any, path: Path, *, allow_external: bool) -> bytes:
    """The bytes of a texture that the file at ``path`` names, be it in a package.

    FileError where it is missing, lies outside the folder of the file (unless ``allow_external``), or is a
    device or a pipe.
    """
    name, resolved = f"the texture '{asset.path}'", str(asset.resolvedPath)
    if not resolved:
        raise FileError(f"{name} is missing")
    if not is_of_site(resolved):
        if not allow_external and lies_outside(resolved, path):
            raise FileError(
                f"{name} lies outside the folder of the file; "
                "if you trust it, allow this with --allow-external-paths"
            )
        if not layer_content.outer_file(resolved).is_file():
            raise FileError(f"{name} is a folder, a device or a pipe")
    content = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(resolved))
    if content is None:
        raise FileError(f"{name} cannot be read")
    return bytes(content.GetBuffer())


def asset_paths(layer: Any, variables: Variables) -> Iterator[tuple[str, str, str]]:
    """The asset paths of layers that a layer refers to, expressions evaluated with ``variables``.

    Each with where it stands, and how it refers: as a ``sublayer``, by an ``arc`` or for a ``clip``.
    """
    found = [(asset, layer.identifier, "sublayer") for asset in layer.subLayerPaths]

    def visit(path: Any) -> None:
        prims = path.IsPrimPath() or path.IsPrimVariantSelectionPath()
        spec = layer.GetPrimAtPath(path) if prims else None
        if spec is not None:
            place = f"<{path}> of {layer.identifier}"
            found.extend((asset, place, "arc") for asset in _arcs(spec))
            if spec.HasInfo("clips"):
                found.extend((asset, place, "clip") for asset in _clips(spec, layer, variables))

    layer.Traverse(Sdf.Path.absoluteRootPath, visit)
    for asset, place, how in found:
        if name := evaluated(asset, variables):
            yield name, place, how


def _arcs(spec: Any) -> Iterator[str]:
    for name in ("references", "payload"):
        yield from (arc.assetPath for arc in layers.listed_items(spec, name))


def _clips(spec: Any, layer: Any, variables: Variables) -> Iterator[str]:
    for clips in spec.GetInfo("clips").values():
        yield from (asset.path for asset in clips.get("assetPaths", ()))
        if "manifestAssetPath" in clips:
            yield clips["manifestAssetPath"].path
        if "templateAssetPath" in clips:
            yield from _matching(evaluated(str(clips["templateAssetPath"]), variables), layer)


def _matching(template: str, layer: Any) -> Iterator[str]:
    """The files that a template such as ``clips/walk.###.usd`` names, as asset paths."""
    inner, slash, name = template.rpartition("/")
    folder = Path(layer.realPath).parent / inner
    pattern = re.compile(re.sub(r"(?:\\#)+", "-?[0-9]+", re.escape(name)))
    if folder.is_dir():
        yield from (f"{inner}{slash}{item}" for item in sorted(os.listdir(folder)) if pattern.fullmatch(item))


def files(stage: Any, path: Path) -> Iterator[tuple[Path, str]]:
    """Every file that the layers of a file read or name, in all variants, each with who names it."""
    root = stage.GetRootLayer()
    opened = check(path, allow_external=True, allow_missing=True, root=root if root.realPath else None)
    # What a clip has opened, no walk through the layers finds.
    used = [layer for layer in stage.GetUsedLayers(True) if layer not in opened]
    for layer in (*opened, *used):
        if layer.realPath:
            yield (path if layer == root else layer_content.outer_file(layer.realPath)), f"a layer of {path}"
    for layer in (*opened, *used):
        if layer.realPath:
            yield from ((file, f"a file that {layer.identifier} refers to") for file in _named(layer))


def _named(layer: Any) -> list[Path]:
    """The files that one layer names, there or not; a package for all that is in it."""
    found: set[str] = set()
    variables = variables_of(layer)

    def collect(asset: str) -> str:
        if named := evaluated(asset, variables):
            found.add(_absolute(layer, named))
        return asset

    layers.rename_assets(layer, collect)
    found.update(_absolute(layer, asset) for asset, _, _ in asset_paths(layer, variables))
    return sorted(layer_content.outer_file(name) for name in found if name)


def _absolute(layer: Any, asset: str) -> str:
    """Where an asset path leads; one that leads nowhere may soon be there, beside the layer."""
    name = str(layer.ComputeAbsolutePath(asset))
    return name if Path(name).is_absolute() else str(layer_content.outer_file(layer.realPath).parent / asset)
