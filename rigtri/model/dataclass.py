"""`dataclasses.dataclass`, whose classes are made in a fraction of the time.

A command makes some 120 of them when it starts. The standard library compiles up to six functions for
each, a fifth of the run of a small file (benchmarks/README.md). Here all six are the same functions for all
classes. A comparison takes a few times as long in turn; an instance takes no longer.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import FrozenInstanceError
from functools import cache
from inspect import Parameter, Signature
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any, NamedTuple


def _maker(*, frozen: bool = False, eq: bool = True, kw_only: bool = False) -> Callable[[type], type]:
    """A decorator as ``dataclass()``; what a class defines itself stays."""

    def made(cls: type) -> type:
        above = (getattr(base, "__dataclass_params__", None) for base in cls.__mro__[1:])
        if any(params is not None and params.frozen for params in above):  # such as a clip of another kind
            return dataclasses.dataclass(frozen=frozen, eq=eq, kw_only=kw_only)(cls)
        own = vars(cls)
        shared: dict[str, Any] = {"__init__": _init, "__repr__": _repr, "__signature__": _ShownSignature()}
        if frozen:
            shared |= {"__setattr__": _refuse_set, "__delattr__": _refuse_delete}
        if eq:
            shared["__eq__"] = _equal
        if eq and own.get("__hash__") is None:  # which Python sets where a class has its own __eq__
            cls.__hash__ = _hash if frozen else None  # type: ignore[method-assign, assignment]
        for name, method in shared.items():
            if name not in own:
                setattr(cls, name, method)
        if cls.__doc__ is None:  # the standard library would ask for the signature, which takes as long again
            cls.__doc__ = ""
        # The standard library would look three times for what each of these texts may mean.
        hints = own.get("__annotations__")
        if hints:
            cls.__annotations__ = {k: hint if "ClassVar" in hint else object for k, hint in hints.items()}
        done: type = dataclasses.dataclass(cls, init=False, repr=False, eq=False, kw_only=kw_only)
        if hints:
            cls.__annotations__ = hints
            for each in dataclasses.fields(cls):
                each.type = hints.get(each.name, each.type)
        return done

    return made


def _dataclass(cls: type | None = None, /, **options: bool) -> Any:
    """As `dataclasses.dataclass`."""
    made = _maker(**options)
    return made if cls is None else made(cls)


# To those who check types it is the standard one.
if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:
    dataclass = _dataclass


class _Parameters(NamedTuple):
    """What ``__init__`` of a class takes. order: names by position. values: of all names, in the order of the
    fields, their defaults, or `dataclasses.MISSING`. required: names that have none. made: names with what
    makes their values. finish: whether the class does more."""

    order: tuple[str, ...]
    values: dict[str, Any]
    required: tuple[str, ...]
    made: tuple[tuple[str, Callable[[], Any]], ...]
    finish: bool


@cache
def _parameters(cls: Any) -> _Parameters:
    none, fields = dataclasses.MISSING, dataclasses.fields(cls)
    given = [each for each in fields if each.init]
    return _Parameters(
        tuple(each.name for each in given if not each.kw_only),
        {each.name: each.default for each in given},
        tuple(each.name for each in given if each.default is none and each.default_factory is none),
        tuple((each.name, each.default_factory) for each in fields if each.default_factory is not none),
        hasattr(cls, "__post_init__"),
    )


def _init(self: Any, *values: Any, **named: Any) -> None:
    order, defaults, required, made, finish = _parameters(self.__class__)
    given = dict(zip(order, values, strict=False)) | named if values else named
    own, count = defaults | given, len(values) + len(named)
    if len(given) < count or len(own) > len(defaults):  # one twice, too many, or one that is not known
        _refuse_call(self.__class__, values, named)
    # Where all are given, as `dataclasses.replace` does, none is missing.
    for name in required if count < len(defaults) else ():
        if own[name] is dataclasses.MISSING:
            _refuse_call(self.__class__, values, named)
    for name, make in made:
        if name not in own or own[name] is dataclasses.MISSING:
            own[name] = make()
    self.__dict__.update(own)
    if finish:
        self.__post_init__()


def _refuse_call(cls: Any, values: tuple[Any, ...], named: dict[str, Any]) -> None:
    try:
        _signature(cls).bind(*values, **named)
    except TypeError as error:
        raise TypeError(f"{cls.__qualname__}: {error}") from None


def _signature(cls: Any) -> Signature:
    """Of ``__init__``, for people: help and refusals."""
    found = []
    for each in dataclasses.fields(cls):
        if not each.init:
            continue
        default: Any = Parameter.empty if each.default is dataclasses.MISSING else each.default
        if each.default_factory is not dataclasses.MISSING:
            default = each.default_factory
        kind = Parameter.KEYWORD_ONLY if each.kw_only else Parameter.POSITIONAL_OR_KEYWORD
        found.append(Parameter(each.name, kind, default=default, annotation=each.type))
    return Signature(sorted(found, key=lambda each: each.kind), return_annotation=None)


class _ShownSignature:
    """Put together when somebody asks for it, by `inspect.signature`."""

    def __get__(self, one: Any, cls: Any) -> Signature:
        return _signature(cls)


@cache
def _names(cls: Any, purpose: str) -> tuple[str, ...]:
    return tuple(each.name for each in dataclasses.fields(cls) if getattr(each, purpose))


def _values(one: Any, purpose: str) -> tuple[Any, ...]:
    return tuple([getattr(one, name) for name in _names(one.__class__, purpose)])


def _refuse_set(self: Any, name: str, value: Any) -> None:
    """Each field is set once, which is by ``__init__``."""
    if name in self.__dict__ or name not in self.__dataclass_fields__:
        raise FrozenInstanceError(f"cannot assign to field {name!r}")
    object.__setattr__(self, name, value)


def _refuse_delete(self: Any, name: str) -> None:
    raise FrozenInstanceError(f"cannot delete field {name!r}")


def _equal(self: Any, other: Any) -> Any:
    if type(other) is not type(self):
        return NotImplemented
    return _values(self, "compare") == _values(other, "compare")


def _hash(self: Any) -> int:
    return hash(_values(self, "compare"))


@recursive_repr()
def _repr(self: Any) -> str:
    shown = [f"{name}={getattr(self, name)!r}" for name in _names(self.__class__, "repr")]
    return f"{type(self).__qualname__}({', '.join(shown)})"
