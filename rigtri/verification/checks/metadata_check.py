"""What rigtri stores on nodes, prims and joints, judged as schemas/node.schema.json describes it.

The description itself is read: `violations` knows of JSON Schema what that file uses, and passes over
keys that it does not name, which newer versions may have.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from importlib.resources import files
from typing import Any

# What a list is called in USD and in Python.
_KINDS: Mapping[str, Callable[[Any], bool]] = {
    "object": lambda value: isinstance(value, dict),
    "array": lambda value: isinstance(value, list | tuple),
    "string": lambda value: isinstance(value, str),
    "boolean": lambda value: isinstance(value, bool),
    "number": lambda value: isinstance(value, int | float) and not isinstance(value, bool),
    # USD has lists of floats alone.
    "integer": lambda value: _KINDS["number"](value) and value == value // 1,
}
_LIMITS: Mapping[str, Callable[[Any, Any], bool]] = {
    "minimum": lambda value, limit: value >= limit,
    "maximum": lambda value, limit: value <= limit,
    "exclusiveMinimum": lambda value, limit: value > limit,
    "minItems": lambda value, limit: len(value) >= limit,
    "maxItems": lambda value, limit: len(value) <= limit,
    "minLength": lambda value, limit: len(value) >= limit,
    "minProperties": lambda value, limit: len(value) >= limit,
    "maxProperties": lambda value, limit: len(value) <= limit,
    "uniqueItems": lambda value, expected: len({repr(item) for item in value}) == len(value),
}
_ADDRESS = "#/$defs/address"


@cache
def _schema() -> dict[str, Any]:
    text = files("rigtri.schemas").joinpath("node.schema.json").read_text("utf-8")
    found: dict[str, Any] = json.loads(text)
    return found


def unknown(stored: Any) -> str:
    """Why metadata is of a kind that this version does not know; "" where it knows it."""
    if not isinstance(stored, dict):
        return ""
    properties = _schema()["properties"]
    if "v" in stored and stored["v"] != properties["v"]["const"]:
        return f"its version v is {stored['v']!r}, not {properties['v']['const']}"
    if isinstance(stored.get("type"), str) and stored["type"] not in properties["type"]["enum"]:
        return f"its type is {stored['type']!r}, none of {', '.join(properties['type']['enum'])}"
    return ""


def broken(stored: Any, is_node: Callable[[str], bool]) -> str:
    """Why metadata cannot be read, or which node or joint of it is not there; "" where all is well."""
    if not isinstance(stored, dict):
        return "what rigtri stored here is not an object"
    if unknown(stored):
        return ""
    for key, kind in (("v", "number"), ("type", "string")):
        if not _KINDS[kind](stored.get(key)):
            return f"it has no {key}"
    form = _schema()["$defs"][stored["type"]]
    wrong = next(violations(stored, form, "its"), "")
    if wrong:
        return wrong
    missing = [name for name in addresses(stored, form) if not is_node(name)]
    return f"there is no node or joint '{missing[0]}'" if missing else ""


def violations(value: Any, form: Any, name: str) -> Iterator[str]:
    """What of a value is not as its schema requires, in words."""
    form = _resolved(form)
    if "type" in form and not _KINDS[form["type"]](value):
        yield f"{name} is {value!r:.60}, no {form['type']}"
        return
    choices = form.get("enum", [form["const"]] if "const" in form else [value])
    if value not in choices:
        yield f"{name} is {value!r:.60}, none of {', '.join(map(str, choices))}"
    if "oneOf" in form and all(any(violations(value, one, name)) for one in form["oneOf"]):
        yield f"{name} is {value!r:.60}"
    if "pattern" in form and not re.search(form["pattern"], value):
        yield f"{name} is {value!r:.60}"
    for word, within in _LIMITS.items():
        if word in form and not within(value, form[word]):
            yield f"{name} is {value!r:.60}, and {word} is {form[word]}"
    if isinstance(value, list | tuple):
        for item in value:
            yield from violations(item, form.get("items", {}), f"{name} item")
    if isinstance(value, dict):
        yield from _key_violations(value, form, name)


def _key_violations(value: dict[str, Any], form: Any, name: str) -> Iterator[str]:
    then = form.get("then", {}) if "if" in form and not any(violations(value, form["if"], name)) else {}
    for key in (*form.get("required", ()), *then.get("required", ())):
        if key not in value:
            yield f"{name} {key} is missing"
    for key, inner in form.get("properties", {}).items():
        if key in value:
            yield from violations(value[key], inner, f"{name} {key}")


def addresses(value: Any, form: Any) -> Iterator[str]:
    """The nodes and joints that metadata names."""
    if isinstance(form, dict) and form.get("$ref") == _ADDRESS:
        yield value
        return
    form = _resolved(form)
    for one in form.get("oneOf", ()):
        if not any(violations(value, one, "")):
            yield from addresses(value, one)
    if isinstance(value, list | tuple):
        for item in value:
            yield from addresses(item, form.get("items", {}))
    if isinstance(value, dict):
        for key, inner in form.get("properties", {}).items():
            if key in value:
                yield from addresses(value[key], inner)


def _resolved(form: Any) -> dict[str, Any]:
    """A description with what it refers to; of ``true`` nothing is required."""
    if not isinstance(form, dict):
        return {}
    target = form.get("$ref", "").rpartition("/")[2]
    return {**_resolved(_schema()["$defs"][target]), **form} if target else form
