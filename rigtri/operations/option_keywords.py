"""Options of an operation from keywords: its own fields and those of the objects in them, as plain values.

A limb is three names, a direction an axis or three numbers, a list of names may be one name, and what
has fields may be a mapping.
"""

from __future__ import annotations

import collections.abc
import types
import typing
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import MISSING, Field, fields, is_dataclass, replace
from difflib import get_close_matches
from functools import cache
from numbers import Integral
from typing import Any, Literal, TypeVar

from rigtri.errors import UsageError
from rigtri.limits import LARGEST, fits
from rigtri.model.limb import Limb
from rigtri.model.rig import Rig
from rigtri.operations.axis_presets import PRESETS
from rigtri.operations.declaration.kinds import direction
from rigtri.recognition.limbs import given

T = TypeVar("T")
_DIRECTION = tuple[float, float, float]
_WORDS: dict[Any, tuple[type, str]] = {
    bool: (bool, "True or False"),
    str: (str, "a text"),
    int: (Integral, "a whole number"),
}


def known(kind: type) -> dict[str, Any]:
    """The keywords of ``kind`` with their defaults; dataclasses.MISSING where there is none."""
    words = {word: _default(field) for word, (_, field) in _places(kind).items()}
    return words | ({"preset": None} if "style" in _hints(kind) else {})


def from_keywords(kind: type[T], rig: Rig, said: Mapping[str, Any], name: str) -> T:
    """The options that keywords ask of the operation ``name``.

    Raises TypeError for a keyword that there is not or that is missing, UsageError for a value that
    fits nothing, NameNotFoundError for a limb whose joints are not there.
    """
    hints, places = _hints(kind), _places(kind)
    own: dict[str, Any] = {}
    parts: dict[str, dict[str, Any]] = {}
    for word, value in said.items():
        if word == "preset" and "style" in hints:
            # What is said of single axes wins over it, whatever comes first.
            preset = PRESETS[_fitted(Literal[tuple(PRESETS)], value, rig, word)]
            parts["style"] = vars(preset) | parts.get("style", {})
            continue
        if word not in places:
            close = get_close_matches(word, places, n=1)
            hint = f"; did you mean '{close[0]}'?" if close else ""
            raise TypeError(f"{name}() has no option '{word}'{hint}")
        holder, field = places[word]
        fitted = _fitted(_hints(_owner(kind, holder))[field.name], value, rig, word)
        (own if holder is None else parts.setdefault(holder, {}))[field.name] = fitted
    if parts.get("style", {}).get("world") and (axes := [w for w in ("aim", "up", "up_from") if w in said]):
        raise UsageError(f"{axes[0]} does not go with axes parallel to the world")
    for field in fields(kind):  # type: ignore[arg-type]
        if field.name in parts:
            own.setdefault(field.name, _default(field))
            own[field.name] = replace(own[field.name], **parts[field.name])
        elif field.name not in own and _default(field) is MISSING:
            raise TypeError(f"{name}() needs {field.name}")
    return kind(**own)


def _hints(kind: Any) -> dict[str, Any]:
    return _cached_hints(kind)


@cache
def _cached_hints(kind: Any) -> dict[str, Any]:
    return typing.get_type_hints(kind)


def _places(kind: type) -> dict[str, tuple[str | None, Field[Any]]]:
    """For each keyword the field of ``kind`` whose object has it, None for its own, and the field."""
    found: dict[str, tuple[str | None, Field[Any]]] = {}
    for field in fields(kind):
        inner = _hints(kind)[field.name]
        if is_dataclass(inner) and _default(field) is not MISSING:
            found |= {f.name: (field.name, f) for f in fields(inner) if f.name not in found}
    return found | {field.name: (None, field) for field in fields(kind)}


def _owner(kind: type, holder: str | None) -> type:
    return kind if holder is None else _hints(kind)[holder]


def _default(field: Field[Any]) -> Any:
    return field.default_factory() if field.default_factory is not MISSING else field.default


def _fitted(hint: Any, value: Any, rig: Rig, word: str) -> Any:
    """A value as its field has it; UsageError, in the user's words, where it cannot be that."""
    outer, inner = typing.get_origin(hint), typing.get_args(hint)
    if outer in (types.UnionType, typing.Union):
        return _one_of(inner, value, rig, word)
    if outer is tuple:
        return _row(hint, inner, value, rig, word)
    if outer is Literal:
        fits_it, wanted = value in inner, f"one of {', '.join(map(repr, inner))}"
    elif outer is collections.abc.Mapping:
        fits_it, wanted = isinstance(value, Mapping), "a mapping from names, e.g. {'name': value}"
        if fits_it:
            return {name: _fitted(inner[1], each, rig, f"{word}[{name!r}]") for name, each in value.items()}
    elif hint is Limb and not isinstance(value, Limb):
        fits_it, wanted = _three(value), "three joints: root, middle, end"
        value = given(rig, *value) if fits_it else value
    elif is_dataclass(hint) and isinstance(value, Mapping):
        return from_keywords(typing.cast(type, hint), rig, value, word)
    elif is_dataclass(hint):
        fits_it, wanted = isinstance(value, typing.cast(type, hint)), _parts(typing.cast(type, hint))
    else:
        fits_it, wanted = _plain(hint, value)
    if not fits_it:
        raise UsageError(f"{word}={value!r}: give {wanted}")
    return value


def _parts(kind: type) -> str:
    return "a rig" if kind is Rig else f"a mapping with {', '.join(known(kind))}"


def _three(value: Any) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, str) and len(value) == 3


def _plain(hint: Any, value: Any) -> tuple[bool, str]:
    """Whether a value is what a plain type asks for, and what that is in words."""
    if hint is float:
        return not isinstance(value, bool) and fits(value), f"a finite number, at most {LARGEST:g}"
    kind, wanted = _WORDS.get(hint, (object, ""))
    return isinstance(value, kind) and (hint is bool or not isinstance(value, bool)), wanted


def _one_of(inner: tuple[Any, ...], value: Any, rig: Rig, word: str) -> Any:
    """The value as the first of several types that it fits; as what the last says where it fits none."""
    if value is None and type(None) in inner:
        return None
    if Limb in inner:
        return _fitted(Limb, value, rig, word)
    *first, last = (hint for hint in inner if hint is not type(None))
    for hint in first:
        with suppress(UsageError):
            return _fitted(hint, value, rig, word)
    return _fitted(last, value, rig, word)


def _row(hint: Any, inner: tuple[Any, ...], value: Any, rig: Rig, word: str) -> tuple[Any, ...]:
    """Several values: any number of a kind, or one of each."""
    if isinstance(value, str):
        if hint == _DIRECTION:
            try:
                return direction(value)
            except ValueError as error:
                raise UsageError(f"{word}: {error}") from None
        value = (value,)
    if not isinstance(value, Iterable) or isinstance(value, Mapping):
        raise UsageError(f"{word}={value!r}: give a list")
    values = tuple(value)
    kinds = inner[:1] * len(values) if inner[-1] is Ellipsis else inner
    if len(kinds) != len(values):
        raise UsageError(f"{word}={value!r}: give {len(kinds)} values")
    return tuple(_fitted(kind, each, rig, word) for kind, each in zip(kinds, values, strict=True))
