"""Take rigtri's own prims out of a layer, or what the layer says of those that other layers have."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

from pxr import Ar, Sdf

from rigtri.errors import FileError, GeometryError
from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.opinions.edits import Edit
from rigtri.formats.usd.reading.metadata_attributes import is_drawing, written_by_rigtri
from rigtri.formats.usd.reading.node_keys import kind
from rigtri.formats.usd.reading.source import Source
from rigtri.model.rig import Rig


def removals(source: Source, rig: Rig) -> list[Edit]:
    """Prims of rigtri that go, each with all below it, and opinions on those that stay.

    FileError for a prim that cannot be taken out of the layer, GeometryError for one that others are below.
    """
    gone = [node for node in sorted(rig.pending.removed) if kind(rig.keys[node]) == "prim"]
    tops = [node for node in gone if int(rig.parents[node]) not in rig.pending.removed]
    paths = {rig.labels[node] for node in gone}
    for node in gone:
        stack = source.stage.GetPrimAtPath(rig.labels[node]).GetPrimStack()
        # A prim and one of the same layer that it refers to go together.
        elsewhere = any(spec.layer != source.layer or str(spec.path) not in paths for spec in stack)
        if len(stack) > 1 and elsewhere:
            names = " and in ".join(spec.layer.GetDisplayName() for spec in stack)
            raise FileError(
                f"<{rig.labels[node]}> is written in {names}, so it cannot be taken out of one of them. "
                f"{_first_from(source, stack)}"
            )
    _refuse_others_below(rig, paths)
    erased = (rig.labels[node] for node in tops if not _goes_along(source, rig.labels[node], paths))
    kept = (rig.labels[node] for node in sorted(rig.pending.restored))
    return [*(_erase(source, path) for path in erased), *map(_restore, kept)]


def _first_from(source: Source, stack: Sequence[Any]) -> str:
    """How to take a prim out of its layers one by one: its opinions in sublayers first, which build on it."""
    below = stack[-1].layer.GetDisplayName()
    sublayers = [layer for layer in source.stage.GetLayerStack(False) if layer != source.layer]
    for layer in (spec.layer for spec in stack[:-1]):
        if layer in sublayers and not Ar.IsPackageRelativePath(layer.identifier):
            name = layer.GetDisplayName()
            return f"Take out what {name} says of it with --edit-target {name}, then strip {below}"
    return f"Strip {below}, and take what is about it out of the other"


def _goes_along(source: Source, path: str, gone: Collection[str]) -> bool:
    """Whether a prim goes with another one of the same layer, from which it is composed (`</Lib>`)."""
    (spec, *_) = source.stage.GetPrimAtPath(path).GetPrimStack()
    return bool(spec.layer == source.layer and str(spec.path) != path and str(spec.path) in gone)


def _refuse_others_below(rig: Rig, gone: Collection[str]) -> None:
    """GeometryError where a prim that stays is below one that goes: !resetXformStack! makes it no child."""
    for node, path in enumerate(rig.labels):
        if kind(rig.keys[node]) != "prim" or path in gone:
            continue
        if above := max((k for k in gone if path.startswith(f"{k}/")), key=len, default=""):
            raise GeometryError(
                f"<{path}> is below <{above}>, which strip removes, and does not follow it "
                "(!resetXformStack!). Move it elsewhere, or remove it; then strip again"
            )


def _erase(source: Source, path: str) -> Edit:
    def erase(layer: Any) -> None:
        spec = layer.GetPrimAtPath(path)
        if spec is None:
            (first, *_) = source.stage.GetPrimAtPath(path).GetPrimStack()
            name = first.layer.GetDisplayName()
            raise FileError(
                f"<{path}> is written in {name}, so it cannot be taken out here: run the same on {name}"
            )
        layers.remove(spec)

    return Edit(Sdf.Path(path), erase)


def _restore(path: str) -> Edit:
    """Take what rigtri has written about a prim out of a layer that another one has it from."""

    def restore(layer: Any) -> None:
        spec = layer.GetPrimAtPath(path)
        if spec is None:
            return
        for one in written_by_rigtri(spec):
            spec.RemoveProperty(one)
        for child in list(spec.nameChildren):
            if is_drawing(child.typeName, child.name):
                layers.remove(child)

    return Edit(Sdf.Path(path), restore)
