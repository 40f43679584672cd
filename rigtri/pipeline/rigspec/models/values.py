"""Kinds of values that options have in a spec."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    Strict,
    ValidationInfo,
    WithJsonSchema,
)
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from rigtri.errors import AmbiguousNameError, NameNotFoundError, did_you_mean
from rigtri.limits import fits, unfit
from rigtri.operations.option_kinds import SignedAxis, assigned, direction, is_one, is_word, joined
from rigtri.operations.options.constrain import OrientWord

# The type of the error of names that nothing has in the rig that is the context of a validation.
UNKNOWN = "unknown_node"
_TEXT = {"type": "string"}
_NUMBERS = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
_TRIPLE = {"anyOf": [_TEXT, _NUMBERS]}


class OneOrMany:
    """A list, or for a list of one that one itself; in the JSON Schema too. kind: of what is listed."""

    def __init__(self, kind: str) -> None:
        self._kind = kind

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self._listed, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        found = dict(handler(schema))
        return {"anyOf": [found["items"], found]}

    def _listed(self, value: Any) -> Any:
        return [value] if is_one(self._kind, value) else value


def _numbers(value: Any) -> Any:
    """Three numbers of a list, or of words with commas."""
    if isinstance(value, str):
        try:
            value = [float(part) for part in value.split(",")]
        except ValueError:
            raise ValueError(f"'{value}' is not a valid point: use [x, y, z]") from None
    if not isinstance(value, Sequence) or len(value) != 3 or not all(map(_is_number, value)):
        raise ValueError("give three numbers: [x, y, z]")
    return tuple(workable(float(number)) for number in value)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _direction(value: Any) -> Any:
    """A direction as the command line has it, or as three numbers."""
    return direction(value) if isinstance(value, str) else _numbers(value)


def _pairs(value: Any) -> Any:
    """A mapping as texts with ``=`` between key and value, as the command line has it."""
    if isinstance(value, Mapping):
        return assigned(value)
    return [*map(joined, [value] if is_word(value) else value)] if value else value


def _joint_orient(value: Any) -> Any:
    if isinstance(value, str) and value not in ("rest", "none"):
        try:
            value = [float(part) for part in value.split(",")]
        except ValueError:
            raise ValueError(f"'{value}' is not a valid joint orient: use rest, none or [x, y, z]") from None
    return value


def workable(value: float) -> float:
    """A number that files can work with; ValueError for any other."""
    if not fits(value):
        raise ValueError(unfit(value))
    return value


def _finite(value: float) -> float:
    if not math.isfinite(value):
        raise ValueError("is not a valid tolerance: use a finite number")
    return value


def _scalar(value: Any) -> Any:
    if not isinstance(value, str | int | float):
        raise ValueError("give a text, a number, true or false")
    return value


def _check(names: Sequence[str], find: Callable[[str], object]) -> None:
    """An error of pydantic's with all of these names or globs that a rig does not find."""
    lost = {}
    for name in names:
        try:
            find(name)
        except NameNotFoundError as error:
            lost[name] = str(error)
        except AmbiguousNameError:  # it is there
            continue
    if lost:
        raise PydanticCustomError(UNKNOWN, "{names}", {"names": lost})


def _node(name: str, info: ValidationInfo) -> str:
    """The name of one node, which the rig of the context has, where there is one."""
    if info.context is not None:
        _check([name], info.context.find)
    return name


def _nodes(name: str, info: ValidationInfo) -> str:
    """As `_node`, or a glob."""
    if info.context is not None:
        _check([name], info.context.match)
    return name


def _before(text: str, info: ValidationInfo) -> str:
    """``NODE`` or ``NODE=…``; names may hold ``=`` themselves."""
    cuts = [text, *(text[:k] for k, letter in enumerate(text) if letter == "=")]
    if info.context is not None and not any(map(info.context.has, cuts)):
        _check([text.partition("=")[0]], info.context.find)
    return text


def _both(text: str, info: ValidationInfo) -> str:
    """``NODE=NODE``."""
    cuts = [(text[:k], text[k + 1 :]) for k, letter in enumerate(text) if letter == "="]
    if info.context is not None and not any(all(map(info.context.has, pair)) for pair in cuts):
        _check(text.split("=", 1), info.context.find)
    return text


def one_of(word: str, known: Collection[str]) -> str:
    """A word of those that are known; ValueError for any other."""
    if word not in known:
        hint = did_you_mean(word, known)
        raise ValueError(f"'{word}' is not valid: use {', '.join(known)}{'.' if hint else ''}{hint}")
    return word


Name = Annotated[str, Field(min_length=1)]
# What stands in ${…}, and before = of --set.
VariableName = Annotated[str, Field(pattern=r"^[^\s{}$='\"]+$")]
Names = Annotated[tuple[Name, ...], OneOrMany("names")]
# Names of nodes, joints mostly: an option that has such values asks the rig for them.
Node = Annotated[Name, AfterValidator(_node)]
Nodes = Annotated[tuple[Annotated[Name, AfterValidator(_nodes)], ...], OneOrMany("nodes")]
Chains = Annotated[tuple[tuple[Node, Node], ...], OneOrMany("chains")]
Limb = tuple[Node, Node, Node]
Limbs = Annotated[tuple[Limb, ...], OneOrMany("limbs")]
Triples = Annotated[tuple[tuple[Name, Name, Name], ...], OneOrMany("triples")]
# What drives, the node that it drives, and what of it.
Driven = Annotated[tuple[tuple[Name, Node, Name], ...], OneOrMany("driven")]
Flag = Annotated[bool, Strict()]
Tolerance = Annotated[float, Strict(), Field(ge=0), AfterValidator(_finite)]
Integers = Annotated[tuple[Annotated[int, Strict()], ...], OneOrMany("integers")]
Point = Annotated[tuple[float, float, float], BeforeValidator(_numbers), WithJsonSchema(_TRIPLE)]
Points = Annotated[tuple[Point, ...], OneOrMany("points")]
Direction = Annotated[tuple[float, float, float], BeforeValidator(_direction), WithJsonSchema(_TRIPLE)]
# Texts KEY=VALUE, which a spec may also give as a mapping; of nodes, and from node to node.
_ASSIGNED = WithJsonSchema({"anyOf": [_TEXT, {"type": "array", "items": _TEXT}, {"type": "object"}]})
Assignments = Annotated[tuple[str, ...], BeforeValidator(_pairs), _ASSIGNED]
OfNodes = Annotated[tuple[Annotated[str, AfterValidator(_before)], ...], BeforeValidator(_pairs), _ASSIGNED]
NodeToNode = Annotated[tuple[Annotated[str, AfterValidator(_both)], ...], BeforeValidator(_pairs), _ASSIGNED]
# Words or numbers, which a spec may give as a list, and the command line has commas between.
Joined = Annotated[
    str,
    BeforeValidator(joined),
    WithJsonSchema({"anyOf": [_TEXT, {"type": "array", "items": {"type": ["string", "number"]}}]}),
]
# ``rest``, ``none`` or three degrees.
_Degrees = Annotated[float, Strict(), Field(gt=-1e6, lt=1e6)]
JointOrient = Annotated[OrientWord | tuple[_Degrees, _Degrees, _Degrees], BeforeValidator(_joint_orient)]
TextOrPoint = Annotated[str, BeforeValidator(joined), WithJsonSchema(_TRIPLE)]
File = Name
# What a variable may stand for.
Scalar = Annotated[
    Any, AfterValidator(_scalar), WithJsonSchema({"type": ["string", "number", "integer", "boolean"]})
]
Axis = SignedAxis
