"""Which files a USD file refers to: what its output, which refers to them too, must not replace."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rigtri.formats.usd.composition import external_paths, layers
from rigtri.formats.usd.composition.variable_expressions import evaluated, variables_of


def files(stage: Any, path: Path) -> Iterator[tuple[Path, str]]:
    """Every file that the layers of a file read or name, in all variants, each with who names it."""
    opened = external_paths.check(path, allow_external=True)
    # What a clip has opened, no walk through the layers finds.
    used = [layer for layer in stage.GetUsedLayers(True) if layer not in opened]
    for layer in (*opened, *used):
        if layer.realPath:
            yield _outer(layer.realPath), f"a layer of {path}"
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
    found.update(_absolute(layer, asset) for asset, _, _ in external_paths.asset_paths(layer, variables))
    return sorted(_outer(name) for name in found if name)


def _absolute(layer: Any, asset: str) -> str:
    """Where an asset path leads; one that leads nowhere may soon be there, beside the layer."""
    name = str(layer.ComputeAbsolutePath(asset))
    return name if Path(name).is_absolute() else str(_outer(layer.realPath).parent / asset)


def _outer(name: str) -> Path:
    return Path(name.partition("[")[0])
