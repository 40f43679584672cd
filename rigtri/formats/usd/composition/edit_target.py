"""The layer of a stage that an edit is for: the root layer, or one of its sublayers that the user names.

Source: UsdEditTarget; layer stacks of the OpenUSD glossary.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pxr import Ar, Sdf, Usd

from rigtri.errors import FileError, NameNotFoundError
from rigtri.formats.usd.composition import layers


def sublayer(stage: Any, name: str) -> Any:
    """The layer of a stage's own layer stack that is called so, by file name, by path or by identifier.

    NameNotFoundError where there is none. FileError for one that is referred to, or lies in a package.
    """
    root = stage.GetRootLayer()
    folder = Path(root.realPath).parent
    own = list(stage.GetLayerStack(False))
    found = [layer for layer in own if name in _names(layer, folder)]
    if found:
        if Ar.IsPackageRelativePath(found[0].identifier):
            package, inside = Ar.SplitPackageRelativePathOuter(found[0].identifier)
            raise FileError(
                f"--edit-target {name}: {inside} lies in the package {Path(package).name}, of which only the "
                "root layer can be edited. Unpack it, and edit that file; or write to the root layer"
            )
        return found[0]
    others = [layer for layer in stage.GetUsedLayers(False) if layer not in own and not layer.anonymous]
    for layer in others:
        if name in _names(layer, folder):
            raise FileError(
                f"--edit-target {name}: {layer.identifier} is referred to, under other paths; edit that "
                "file itself"
            )
    raise NameNotFoundError("layer", name, [layers.file_name(layer) for layer in own])


class LayerTimes:
    """How the times of a stage read in a layer of its stack, which offsets, scales and clocks may move.

    Source: UsdEditTarget, which maps times alike; a value read at a time of the stage is found to the bit.
    """

    def __init__(self, stage: Any, layer: Any) -> None:
        self.offset = stage.GetEditTargetForLocalLayer(layer).GetMapFunction().timeOffset
        self._inverse = self.offset.GetInverse()
        # Of the layer's own samples: there and back is another time than before in one of a few.
        self._own = {self.offset * time: time for time in layer.ListAllTimeSamples()}

    def in_layer(self, time: float) -> float:
        """A time of the stage, in the layer."""
        return float(self._own.get(time, self._inverse * time))

    def as_composed(self, time: float) -> float:
        """When the stage has the sample that the layer gets for a time of the stage."""
        return float(self.offset * self.in_layer(time))


def with_other(root: Any, old: Any, new: str) -> Any:
    """The stage of a copy of a root layer, in which the layer in the file ``new`` stands for a sublayer."""
    copy = _replaced(root, old, new)
    held = list(copy[1])  # until the stage has them
    stage = Usd.Stage.Open(copy[0])
    del held
    return stage


def _replaced(layer: Any, old: Any, new: str) -> tuple[Any, list[Any]]:
    copy, held = layers.copy_of(layer), list[Any]()
    layers.rename_assets(copy, layers.anchored(Path(layer.realPath).parent, layer))
    offsets = list(copy.subLayerOffsets)
    for number, path in enumerate(layer.subLayerPaths):
        below = Sdf.Layer.FindOrOpenRelativeToLayer(layer, path)
        if below is not None and below == old:
            copy.subLayerPaths[number] = new
        elif below is not None and any(each == old for each in _below(below)):
            inner, more = _replaced(below, old, new)
            copy.subLayerPaths[number] = inner.identifier
            held += [inner, *more]
    for number, offset in enumerate(offsets):  # which go with the paths
        copy.subLayerOffsets[number] = offset
    return copy, held


def _names(layer: Any, folder: Path) -> set[str]:
    path = Path(layer.realPath)
    package, inside = Ar.SplitPackageRelativePathOuter(layer.identifier)
    if inside:
        return {inside, f"{Path(package).name}[{inside}]", layer.identifier}
    relative = {path.relative_to(folder).as_posix()} if path.is_relative_to(folder) else set()
    return {path.name, str(path), layer.identifier, *relative, *(f"./{name}" for name in relative)}


def _below(layer: Any) -> Iterator[Any]:
    """Each layer below one, through its whole layer stack."""
    for path in layer.subLayerPaths:
        below = Sdf.Layer.FindOrOpenRelativeToLayer(layer, path)
        if below is not None:
            yield below
            yield from _below(below)
