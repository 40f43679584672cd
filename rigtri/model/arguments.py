"""Arguments of public functions: which have another type than is declared."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache, wraps
from inspect import unwrap
from typing import Any, TypeVar, cast

F = TypeVar("F", bound=Callable[..., Any])
# Where users get what a class is of.
_RETURNED_BY = {"Rig": "rigtri.read"}


def typed(function: F) -> F:
    """Let a public function refuse arguments as `check_arguments` does."""

    @wraps(function)
    def called(*values: Any, **keywords: Any) -> Any:
        check_arguments(function, values, keywords)
        return function(*values, **keywords)

    return cast(F, called)


def check_arguments(function: Callable[..., Any], values: Sequence[Any], keywords: Mapping[str, Any]) -> None:
    """TypeError with the name of an argument that is declared as one of rigtri's classes and is none.

    None stands for what is left out. What may be a path, a name or a number is checked where it is read.
    """
    needed, positional, kinds = _declared(function)
    for name, value in (*zip(positional, values, strict=False), *keywords.items()):
        left_out = value is None and name not in needed
        if name in kinds and not left_out and not isinstance(value, kinds[name]):
            kind = kinds[name][0].__name__
            source = f", as {_RETURNED_BY[kind]} returns," if kind in _RETURNED_BY else ","
            given = type(value).__name__
            raise TypeError(f"{function.__name__}: {name} must be a {kind}{source} not {given}")


@cache
def _declared(function: Any) -> tuple[Sequence[str], Sequence[str], Mapping[str, tuple[type, ...]]]:
    """The positional parameters without default, all of these, and those that are of classes of rigtri."""
    function = unwrap(function)
    positional = function.__code__.co_varnames[: function.__code__.co_argcount]
    needed = positional[: len(positional) - len(function.__defaults__ or ())]
    found = {}
    for name, words in function.__annotations__.items():
        kinds = [function.__globals__.get(word) for word in words.split(" | ") if word != "None"]
        if all(isinstance(kind, type) and kind.__module__.startswith("rigtri.") for kind in kinds):
            found[name] = tuple(kinds)
    return needed, positional, found
