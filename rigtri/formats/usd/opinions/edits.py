"""Edits: small changes to a layer, worked out before the first is made.

An edit holds all the values it will write, so that none is read back from a
layer that another edit has already changed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from pxr import Sdf, Vt

from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.composition.animation_binding import SOURCE
from rigtri.formats.usd.reading.metadata_attributes import PREFIX
from rigtri.maths.trigonometry import Floats
from rigtri.model.dataclass import dataclass

BINDING = "SkelBindingAPI"


@dataclass(frozen=True, eq=False)
class Edit:
    """One change to a layer. prim: the path of the prim it is about, as the stage shows it."""

    prim: Any
    change: Callable[[Any], None]

    def __call__(self, layer: Any) -> None:
        self.change(layer)


@dataclass(frozen=True, eq=False)
class Setting(Edit):
    """An attribute that gets a value, samples, or both.

    place: the path of the prim in the layer, within variants where it must be. again: the same with another
    place, value and samples.
    """

    name: str
    value: Any
    samples: Mapping[float, Any]
    place: Any
    again: Callable[[Any, Any, Mapping[float, Any]], Setting]

    @property
    def path(self) -> Any:
        """The attribute's path, as the stage shows it."""
        return self.prim.AppendProperty(self.name)

    def arrays(self) -> dict[Any, np.ndarray]:
        """Default (None) and samples as arrays."""
        return arrays({None: self.value} | dict(self.samples))

    def at(self, prim: Any) -> Setting:
        """The same for another prim."""
        return self.again(prim, self.value, self.samples)

    def picked(self, items: Sequence[int]) -> Setting:
        """The same with some items of arrays alone, by their numbers."""
        default, *rest = (
            None if array is None else type(array)([array[k] for k in items])
            for array in (self.value, *self.samples.values())
        )
        return self._with(default, dict(zip(self.samples, rest, strict=True)))

    def retimed(self, time_of: Callable[[float], float]) -> Setting:
        """The same with samples at other times."""
        return self._with(self.value, {time_of(time): value for time, value in self.samples.items()})

    def _with(self, value: Any, samples: Mapping[float, Any]) -> Setting:
        return replace(self.again(self.place, value, samples), prim=self.prim)


@dataclass(frozen=True, eq=False)
class Binding(Edit):
    """A relationship that gets targets; name: its name."""

    name: str


@dataclass(frozen=True, eq=False)
class Declaration(Edit):
    """An attribute that an edit before has set gets metadata. name: its name; fields: the metadata."""

    name: str
    fields: Mapping[str, Any]


def arrays(values: Mapping[Any, Any]) -> dict[Any, np.ndarray]:
    """Values by time as arrays; what is blocked has none."""
    return {time: np.array(value) for time, value in values.items() if value is not None}


def set_value(
    prim: Any,
    name: str,
    type_name: Any,
    value: Any,
    *,
    samples: Mapping[float, Any] | None = None,
    uniform: bool = False,
    custom: bool = False,
    alone: bool = False,
) -> Setting:
    """Set an attribute's default (None leaves it) and time samples (None is a blocked one).

    The layer gets an ``over`` where it has no opinion on the prim. alone: take
    away time samples the layer has, which would hide the default.
    """
    path = Sdf.Path(prim).AppendProperty(name)

    def edit(layer: Any) -> None:
        spec = layer.GetAttributeAtPath(path)
        if spec is not None and spec.typeName != type_name:
            # An attribute cannot change its type in place.
            del spec.owner.properties[name]
            spec = None
        if spec is None:
            owner = Sdf.CreatePrimInLayer(layer, path.GetPrimPath())
            variability = Sdf.VariabilityUniform if uniform else Sdf.VariabilityVarying
            spec = Sdf.AttributeSpec(owner, name, type_name, variability, declaresCustom=custom)
        if alone:
            for time in layer.ListTimeSamplesForPath(path):
                layer.EraseTimeSample(path, time)
        if value is not None:
            spec.default = value
        for time, sample in (samples or {}).items():
            layer.SetTimeSample(path, time, Sdf.ValueBlock() if sample is None else sample)

    def again(other: Any, value: Any, samples: Mapping[float, Any]) -> Setting:
        return set_value(
            other, name, type_name, value, samples=samples, uniform=uniform, custom=custom, alone=alone
        )

    return Setting(path.GetPrimPath(), edit, name, value, samples or {}, prim, again)


def define(path: Any, type_name: str) -> Edit:
    """Define a prim of a type."""

    def edit(layer: Any) -> None:
        spec = Sdf.CreatePrimInLayer(layer, path)
        spec.specifier, spec.typeName = Sdf.SpecifierDef, type_name

    return Edit(path, edit)


def apply_schema(prim: Any, name: str) -> Edit:
    """Add an API schema to a prim's list, behind those it has; nothing where it is there."""
    path = Sdf.Path(prim)

    def edit(layer: Any) -> None:
        spec = Sdf.CreatePrimInLayer(layer, path)
        schemas = spec.GetInfo("apiSchemas") if spec.HasInfo("apiSchemas") else Sdf.TokenListOp()
        listed = [*schemas.explicitItems, *schemas.prependedItems, *schemas.appendedItems]
        if name in listed:
            return
        if schemas.isExplicit:
            schemas.explicitItems = [*schemas.explicitItems, name]
        else:
            schemas.prependedItems = [*schemas.prependedItems, name]
        spec.SetInfo("apiSchemas", schemas)

    return Edit(path, edit)


def set_tokens(prim: Any, name: str, tokens: Sequence[str]) -> Setting:
    """Set a uniform token array."""
    return set_value(prim, name, Sdf.ValueTypeNames.TokenArray, Vt.TokenArray(list(tokens)), uniform=True)


def set_matrices(prim: Any, name: str, matrices: Floats) -> Setting:
    """Set a uniform matrix array; matrices: (n, 4, 4)."""
    value = Vt.Matrix4dArray.FromNumpy(np.ascontiguousarray(matrices))
    return set_value(prim, name, Sdf.ValueTypeNames.Matrix4dArray, value, uniform=True)


def set_attributes(prim: Any, attributes: Mapping[str, tuple[Any, Any]]) -> list[Edit]:
    """Set custom attributes, each a type and a value; rigtri's own are uniform."""
    return [
        set_value(prim, name, type_name, value, custom=True, uniform=name.startswith(PREFIX))
        for name, (type_name, value) in attributes.items()
    ]


def remove_prim(path: Any) -> Edit:
    """Remove a prim's spec with all below it; nothing where the layer has none."""

    def edit(layer: Any) -> None:
        spec = layer.GetPrimAtPath(path)
        if spec is not None:
            layers.remove(spec)

    return Edit(Sdf.Path(path), edit)


def remove_properties(prim: Any, *names: str) -> Edit:
    """Remove properties of a prim; nothing where the layer has none."""

    def edit(layer: Any) -> None:
        spec = layer.GetPrimAtPath(prim)
        for name in names if spec is not None else ():
            if name in spec.properties:
                del spec.properties[name]

    return Edit(Sdf.Path(prim), edit)


def drop_attribute(attribute: Any, layer: Any) -> Edit:
    """Remove an attribute of a prim; block it where it is composed from elsewhere than ``layer``, too."""
    prim, name = attribute.GetPrimPath(), attribute.GetName()
    if not any(is_elsewhere(spec, attribute.GetPath(), layer) for spec in attribute.GetPropertyStack()):
        return remove_properties(prim, name)
    uniform = attribute.GetVariability() == Sdf.VariabilityUniform
    custom, type_name = attribute.IsCustom(), attribute.GetTypeName()
    return set_value(prim, name, type_name, Sdf.ValueBlock(), uniform=uniform, custom=custom, alone=True)


def is_elsewhere(spec: Any, path: Any, layer: Any) -> bool:
    """Whether a spec of what the stage shows at ``path`` is of another layer, or of a prim referred to."""
    return bool(spec.layer != layer or spec.path.StripAllVariantSelections() != path)


def bind_animation(skeleton: str, animation: str) -> list[Edit]:
    """Let a skeleton be driven by an animation: its binding, and the schema that UsdSkel requires."""
    return _bind(skeleton, SOURCE, [animation])


def bind_skeleton(prim: str, skeletons: Sequence[str]) -> list[Edit]:
    """Bind all below a prim to a skeleton; to none, so that nothing moves by influences of prims above."""
    return _bind(prim, "skel:skeleton", skeletons)


def _bind(path: str, name: str, targets: Sequence[str]) -> list[Edit]:
    def edit(layer: Any) -> None:
        prim = Sdf.CreatePrimInLayer(layer, path)
        relation = prim.relationships.get(name) or Sdf.RelationshipSpec(prim, name, custom=False)
        relation.targetPathList.ClearEditsAndMakeExplicit()
        relation.targetPathList.explicitItems = list(targets)

    return [Binding(Sdf.Path(path), edit, name), apply_schema(path, BINDING)]


def binding_schema(prim: Any) -> list[Edit]:
    """The schema without which UsdSkel sees no opinion on how a prim is bound; none where it has that."""
    return [] if BINDING in prim.GetAppliedSchemas() else [apply_schema(prim.GetPath(), BINDING)]


def free_path(parent: Any, name: str, taken: Callable[[Any], Any]) -> Any:
    """A path below ``parent`` that is not taken: with ``name``, else ``name_2`` and so on."""
    path, count = parent.AppendChild(name), 2
    while taken(path):
        path, count = parent.AppendChild(f"{name}_{count}"), count + 1
    return path
