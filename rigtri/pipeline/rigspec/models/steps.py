"""Models of a spec's steps, made of what operations declare."""

from __future__ import annotations

import typing
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    Strict,
    WithJsonSchema,
    create_model,
)
from pydantic_core import CoreSchema, core_schema

from rigtri.model.edit_options import EditOptions
from rigtri.model.options import Kind, Option, made, options_of
from rigtri.model.spelling import spec_spelling
from rigtri.operations.options.orient_joints import StyledChain
from rigtri.operations.registry import OPERATIONS, options_class
from rigtri.pipeline.rigspec.models import values

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
    "axis": values.Axis,
    "tolerance": values.Tolerance,
    "direction": values.Direction,
    "point": values.Point,
    "points": values.Points,
    "node or point": values.TextOrPoint,
    "integers": values.Integers,
    "of nodes": values.OfNodes,
    "node to node": values.NodeToNode,
    "assignments": values.Assignments,
    "triples": values.Triples,
    "driven": values.Driven,
    "joined": values.Joined,
    "joint orient": values.JointOrient,
}


class StepModel(BaseModel):
    """The options of one operation; fields have the names that the operation declares."""

    model_config = ConfigDict(extra="forbid", strict=False, populate_by_name=False)

    optional: values.Flag = Field(
        False,
        description="Leave the step out, with a warning, where a file has not the joints that it names.",
    )

    do: str

    def options(self, shared: dict[str, Any]) -> Any:
        """The options of the operation, checked; UsageError where they contradict each other.

        shared: values that the whole spec has.
        """
        own = {name: getattr(self, name) for name in type(self).model_fields}
        return made(options_class(self.do), shared | own, self.model_fields_set)


@cache
def step_model(name: str) -> type[StepModel]:
    """The model of an operation's steps."""
    declared: Any = options_class(name)
    fields = {"do": (Literal[name], ...), **fields_of(declared)}
    return create_model(_model_name(name), __base__=StepModel, __doc__=OPERATIONS[name].summary, **fields)


def __getattr__(name: str) -> type[StepModel]:
    """A model by its name, for pickle: specs travel to the processes of a batch."""
    for operation in OPERATIONS:
        if name == _model_name(operation):
            return step_model(operation)
    raise AttributeError(name)


def _model_name(operation: str) -> str:
    return operation.title().replace("-", "")


def fields_of(declared: Any) -> dict[str, Any]:
    """What pydantic makes fields of, by their names."""
    own, found = options_of(declared).values(), {}
    keys = spec_spelling([*options_of(EditOptions).values(), *own])
    for option in own:
        if option.where == "all":
            kind = spec_type(option)
            if option.words:
                kind = Annotated[kind, BeforeValidator(option.cased)]
            text = keys.text(option.described())
            about = Field(_default(option), alias=option.key, description=text or None)
            found[option.name] = (kind | None if option.optional or option.one_word else kind, about)
    return found


def _default(option: Option) -> Any:
    if option.required:
        return ...
    if option.one_word:
        return None
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
    several = typing.get_origin(option.hint) is tuple and typing.get_args(option.hint)[-1] is Ellipsis
    return Annotated[option.hint, values.OneOrMany("names")] if several else option.hint


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


def _styled(value: Any) -> Any:
    """[START, END] as the mapping of a chain."""
    if isinstance(value, list) and len(value) == 2:
        return {"start": value[0], "end": value[1]}
    return value


class _Chain:
    """A pair of names for a chain without axes of its own; in the JSON Schema too."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(_styled, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        pair = {"type": "array", "items": {"type": "string"}, "minItems": 2, "maxItems": 2}
        return {"anyOf": [pair, handler(schema)]}


_StyledChain: Any = create_model(
    "StyledChain",
    __config__=ConfigDict(extra="forbid"),
    __doc__=str(StyledChain.__doc__),
    **fields_of(StyledChain),
)
_KINDS["styled chains"] = Annotated[
    tuple[Annotated[_StyledChain, _Chain()], ...], values.OneOrMany("styled chains")
]
