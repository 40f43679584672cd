"""Models of a spec's steps, made of what operations declare."""

from __future__ import annotations

import typing
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, Strict, WithJsonSchema, create_model

from rigtri.declaration.option import Kind, Option, options_of
from rigtri.operations.registry import options_class
from rigtri.pipeline.rigspec.models import values
from rigtri.pipeline.rigspec.models.base import StepModel

# What values are in a spec, by the kind that an option declares.
_KINDS: dict[str, Any] = {
    "node": values.Node,
    "nodes": values.Nodes,
    "chains": values.Chains,
    "limb": values.Limb,
    "limbs": values.Limbs,
    "name": values.Name,
    "names": values.Names,
    "rig file": values.File,
    "edited file": values.File,
    "json file": values.File,
    "direction": values.Direction,
    "point": values.Point,
    "points": values.Points,
    "of nodes": values.OfNodes,
    "node to node": values.NodeToNode,
    "assignments": values.Assignments,
    "joined": values.Joined,
}


@cache
def step_model(name: str) -> type[StepModel]:
    """The model of an operation's steps."""
    declared: Any = options_class(name)
    fields: dict[str, Any] = {"do": (Literal[name], ...)}
    for option in options_of(declared).values():
        if option.where == "all":
            kind = spec_type(option)
            about = Field(_default(option), alias=option.key, description=option.help)
            fields[option.name] = (kind | None if option.optional else kind, about)
    words = str(declared.__doc__).partition("\n")[0]
    return create_model(name.title().replace("-", ""), __base__=StepModel, __doc__=words, **fields)


def _default(option: Option) -> Any:
    if option.required:
        return ...
    return () if isinstance(option.default, dict) else option.default


def spec_type(option: Option) -> Any:
    """The type of an option's values for pydantic."""
    kind = option.kind
    if kind is not None and kind.name in _KINDS:
        found = _KINDS[kind.name]
        return Annotated[found, Field(min_length=1)] if option.required and _is_list(found) else found
    if option.choices:
        known = option.choices
        return Annotated[
            str,
            AfterValidator(lambda word: values.one_of(word, known)),
            WithJsonSchema({"enum": list(known), "type": "string"}),
        ]
    if option.hint is bool:
        return values.Flag
    if option.hint in (int, float):
        return _number(option.hint, kind)
    return option.hint


def _is_list(found: Any) -> bool:
    return typing.get_origin(typing.get_args(found)[0]) is tuple


def _number(hint: type, kind: Kind | None) -> Any:
    low, high = (None, None) if kind is None else (kind.low, kind.high)
    below, above = (False, False) if kind is None else (kind.low_open, kind.high_open)
    about = Field(
        gt=low if below else None,
        ge=None if below else low,
        lt=high if above else None,
        le=None if above else high,
    )
    return Annotated[hint, Strict(), about, AfterValidator(values.workable)]
