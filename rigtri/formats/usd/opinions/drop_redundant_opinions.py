"""Drop opinions that only repeat what weaker layers hold, as where strip has put a value back."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from pxr import Sdf

from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.composition.stage import DEFAULT
from rigtri.formats.usd.composition.time_samples import time_samples
from rigtri.formats.usd.opinions.edits import Edit, Setting

_METADATA = ("typeName", "variability", "custom", "elementSize", "interpolation", "customData")


def drop_redundant_opinions(
    stage: Any, layer: Any, edits: Iterable[Edit], composed: Callable[[Any], Any]
) -> None:
    """Take values out of a layer that ``edits`` have set to what they are without it, and overs left bare.

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
        del spec.nameParent.nameChildren[spec.name]
