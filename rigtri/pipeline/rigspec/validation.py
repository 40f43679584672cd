"""What is wrong with a spec that its models find, in the user's words and with its place."""

from __future__ import annotations

import json
import re
from collections.abc import Container, Iterator
from typing import TYPE_CHECKING, Any

from rigtri.errors import did_you_mean
from rigtri.operations.registry import OPERATIONS
from rigtri.pipeline.rigspec.errors import Fault
from rigtri.pipeline.rigspec.positions import Keys, Tree
from rigtri.text import cut

if TYPE_CHECKING:
    from pydantic import BaseModel
    from pydantic_core import ErrorDetails

    from rigtri.pipeline.rigspec.models.spec import SpecModel
    from rigtri.pipeline.rigspec.models.steps import StepModel


# What pydantic calls values, and what they are called in a spec, by the type of its error.
_PLAIN = {
    "tuple_type": ("a valid tuple", "a list"),
    "model_attributes_type": ("a valid dictionary or object to extract fields from", "a mapping"),
    "dict_type": ("a valid dictionary", "a mapping"),
    "string_type": ("a valid string", "a text"),
    "int_type": ("a valid integer", "a whole number"),
    "bool_type": ("a valid boolean", "true or false"),
    "float_type": ("a valid number", "a number"),
}


def wrong(tree: Tree, *, whole: bool) -> Iterator[tuple[Keys, Fault | None]]:
    """What is wrong with a spec, by the keys that lead there.

    whole: the spec is complete. Else what is missing is no fault, but nor is it right: None.
    """
    from pydantic import ValidationError

    from rigtri.pipeline.rigspec.models.spec import SpecModel

    known = set()
    try:
        SpecModel.model_validate(tree.values)
    except ValidationError as error:
        for detail in error.errors(include_url=False):
            keys, fault = _fault(tree, detail["loc"], detail)
            known.add(fault.place)
            yield keys, fault if whole or "missing" not in detail["type"] else None
    # Steps have reported what is wrong with values of defaults.
    yield from ((keys, one) for keys, one in _wrong_defaults(tree) if one.place not in known)


def sound(tree: Tree, without: Container[Keys]) -> tuple[SpecModel, list[int]]:
    """What is right in a spec as its model has it, and the numbers of the steps there.

    without: the keys of the steps and of other values that are wrong.
    """
    from rigtri.pipeline.rigspec.models.spec import SpecModel

    values = {key: value for key, value in tree.values.items() if (key,) not in without}
    numbers = [number for number in range(len(tree.steps)) if ("steps", number) not in without]
    steps = {"steps": [tree.steps[number] for number in numbers]} if "steps" in tree.values else {}
    return SpecModel.model_validate(values | steps), numbers


def _wrong_defaults(tree: Tree) -> Iterator[tuple[Keys, Fault]]:
    """Operations and options under ``defaults`` that there are not, and values that they cannot have."""
    from pydantic import ValidationError

    defaults = tree.values.get("defaults")
    for do, own in defaults.items() if isinstance(defaults, dict) else ():
        keys: Keys = ("defaults", do)
        if do not in OPERATIONS:
            text = f"there is no operation '{do}'.{did_you_mean(do, OPERATIONS)}"
            yield keys, Fault(tree.place(keys), "defaults", text)
        elif isinstance(own, dict):
            if "do" in own:
                yield (*keys, "do"), Fault(tree.place((*keys, "do")), "defaults", "there is no option 'do'.")
            try:
                step_models()[do].model_validate({**own, "do": do})
            except ValidationError as error:
                for detail in error.errors(include_url=False):
                    if detail["type"] != "missing":
                        yield _fault(tree, (*keys, *detail["loc"]), detail)


def _fault(tree: Tree, loc: tuple[str | int, ...], detail: ErrorDetails) -> tuple[Keys, Fault]:
    """A fault of the model in the user's words, at the place of the value; and the keys to that."""
    keys = _known(tree.values, loc)
    kind, ctx = detail["type"], detail.get("ctx", {})
    name = str(loc[-1]) if loc else ""
    option, at = _option(keys), keys
    if kind == "extra_forbidden":
        text = f"there is no option '{name}'.{_near(loc)}"
    elif kind == "missing" and name.isdigit():
        text = f"{option.partition('.')[0]}: there are too few values: number {int(name) + 1} is missing"
    elif kind == "missing":
        text = f"'{name}' is missing"
    elif kind == "string_pattern_mismatch" and keys[:1] == ("variables",):
        text = f"'{keys[-1]}' is not a valid variable name: use letters, as in ${{side}}, and no spaces, "
        text += "braces, quotes, $ or ="
    elif kind == "union_tag_not_found":
        text = "'do' is missing: the name of an operation, e.g. orient-joints"
    elif kind == "union_tag_invalid":
        hint = did_you_mean(str(ctx.get("tag")), OPERATIONS) or f" There are {', '.join(OPERATIONS)}."
        text, at = f"there is no operation {ctx.get('tag')!r}.{hint}", (*keys, "do")
    elif kind.endswith("_type") and detail["input"] is None:
        text = f"{option or 'it'} is null: give it a value, or remove it"
    else:
        text = detail["msg"].removeprefix("Value error, ").replace(*_PLAIN.get(kind, ("", "")))
        text = text[:1].lower() + text[1:]
        by = f", by the variable '{tree.at(keys).variable}'" if tree.at(keys).variable else ""
        text += "" if kind == "value_error" else f" (it is {_short(detail['input'])}{by})"
        if kind == "literal_error":
            known = re.findall("'([^']*)'", str(ctx["expected"]))
            text += f".{hint}" if (hint := did_you_mean(str(detail["input"]), known)) else ""
        text = f"{option}: {text}" if option else text
    return keys, Fault(tree.place(at), where_of(tree, keys), text)


def _known(values: Any, loc: tuple[str | int, ...]) -> Keys:
    """The keys of a fault that the spec has; pydantic puts words for its own choices between."""
    keys: Keys = ()
    for key in loc:
        value = value_at(values, keys)
        if (isinstance(value, dict) and key in value) or (
            isinstance(value, list) and isinstance(key, int) and key < len(value)
        ):
            keys = (*keys, key)
    return keys


def value_at(values: Any, keys: Keys) -> Any:
    for key in keys:
        try:
            values = values[key]
        except (KeyError, IndexError, TypeError):
            return None
    return values


def where_of(tree: Tree, keys: Keys) -> str:
    """Which step it is: ``step 3 (add-twist)``, counted from 1; of one with braces with its word."""
    if keys[:1] == ("defaults",) and len(keys) > 1:
        return "defaults"
    if len(keys) < 2 or keys[0] != "steps" or not isinstance(keys[1], int):
        return ""
    one, label = value_at(tree.values, keys[:2]), tree.labels[keys[1]]
    do = one.get("do") if isinstance(one, dict) else None
    words = ", ".join(str(word) for word in (do, label.word) if word)
    return f"step {label.number} ({words})" if words else f"step {label.number}"


def _option(keys: Keys) -> str:
    """The option that a fault is about."""
    below = keys[2:] if len(keys) > 1 and keys[0] in ("steps", "defaults") else keys
    return ".".join(str(key) for key in below)


def _near(loc: tuple[str | int, ...]) -> str:
    """What an unknown option may be meant to be."""
    from rigtri.pipeline.rigspec.models.spec import SpecModel

    do = loc[1] if loc[0] == "defaults" else loc[2] if len(loc) > 2 else ""
    model: type[BaseModel] = step_models().get(str(do), SpecModel)
    if loc[-1] == "auto" and "limbs" in model.model_fields:  # the only value of that option
        return " Did you mean 'limbs: auto'?"
    known = [str(field.alias or name) for name, field in model.model_fields.items()]
    return did_you_mean(str(loc[-1]), known) or f" There are {', '.join(known)}."


def step_models() -> dict[str, type[StepModel]]:
    """The models of steps by their operations."""
    from rigtri.pipeline.rigspec.models.spec import STEP_MODELS

    return STEP_MODELS


def _short(value: Any) -> str:
    return cut(json.dumps(value, ensure_ascii=False, default=str), 60)
