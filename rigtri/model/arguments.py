"""Arguments of public functions: which have another type than is declared."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import cache, wraps
from inspect import unwrap
from numbers import Real
from typing import Any, TypeVar, cast

from rigtri.errors import UsageError

F = TypeVar("F", bound=Callable[..., Any])
# Where users get what a class is of.
_RETURNED_BY = {"Rig": "rigtri.read"}
# Plain types that are checked here, too, with what fits them.
_PLAIN: Mapping[str, type] = {"str": str, "float": Real}
_NAMES: Mapping[type, str] = {str: "text", Real: "number"}


def typed(function: F) -> F:
    """Let a public function refuse arguments as `check_arguments` does."""

    @wraps(function)
    def called(*values: Any, **keywords: Any) -> Any:
        check_arguments(function, values, keywords)
        return function(*values, **keywords)

    return cast(F, called)


def check_arguments(function: Callable[..., Any], values: Sequence[Any], keywords: Mapping[str, Any]) -> None:
    """TypeError with the name of an argument that is declared as one of rigtri's classes, a text or a number,
    and is none; UsageError for a number that is too large for a float.

    None stands for an object, or an optional value, that is left out. What may be a path, or of several
    types, is checked where it is read.
    """
    needed, positional, kinds = _declared(function)
    for name, value in (*zip(positional, values, strict=False), *keywords.items()):
        if name not in kinds or (value is None and name not in needed):
            continue
        if not isinstance(value, kinds[name]):
            kind = _NAMES.get(kinds[name][0], kinds[name][0].__name__)
            source = f", as {_RETURNED_BY[kind]} returns," if kind in _RETURNED_BY else ","
            given = type(value).__name__
            raise TypeError(f"{function.__name__}: {name} must be a {kind}{source} not {given}")
        if kinds[name] == (Real,) and sys.float_info.max < abs(cast(float, value)) < math.inf:
            raise UsageError(f"{name}=: a number of hundreds of digits is too large")


@cache
def _declared(function: Any) -> tuple[Sequence[str], Sequence[str], Mapping[str, tuple[type, ...]]]:
    """The parameters that cannot be None, the positional ones, and the types of those that are checked."""
    function = unwrap(function)
    positional = function.__code__.co_varnames[: function.__code__.co_argcount]
    needed = [*positional[: len(positional) - len(function.__defaults__ or ())]]
    found = {}
    for name, annotation in function.__annotations__.items():
        words = annotation.split(" | ")
        alone = [word for word in words if word != "None"]
        if len(alone) == 1 and alone[0] in _PLAIN:
            found[name] = (_PLAIN[alone[0]],)
            needed += [name] if words == alone else []
            continue
        kinds = [function.__globals__.get(word) for word in alone]
        if all(isinstance(kind, type) and kind.__module__.startswith("rigtri.") for kind in kinds):
            found[name] = tuple(kinds)
    return needed, positional, found
