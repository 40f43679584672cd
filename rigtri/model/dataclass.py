"""`dataclasses.dataclass`, whose frozen classes are made in a third of the time.

A command makes some 130 frozen classes when it starts. The standard library compiles six functions for
each, a fifth of the run of a small file (benchmarks/README.md). Here it compiles ``__init__`` alone,
and the five others are the same functions for all classes. In turn an instance takes 0.3 µs longer for each
field, and a comparison a few times as long; so the few classes that are made by thousands, such as tracks,
keep the standard decorator.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import FrozenInstanceError
from functools import cache
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any


def _frozen(*, eq: bool = True, kw_only: bool = False) -> Callable[[type], type]:
    """A decorator as ``dataclass(frozen=True)``; what a class defines itself stays."""

    def made(cls: type) -> type:
        above = (getattr(base, "__dataclass_params__", None) for base in cls.__mro__[1:])
        if any(params is not None and params.frozen for params in above):  # such as a clip of another kind
            return dataclasses.dataclass(frozen=True, eq=eq, kw_only=kw_only)(cls)
        own = vars(cls)
        shared: dict[str, Any] = {"__setattr__": _refuse_set, "__delattr__": _refuse_delete}
        shared["__repr__"] = _repr
        if eq:
            shared["__eq__"] = _equal
        if eq and own.get("__hash__") is None:  # which Python sets where a class has its own __eq__
            cls.__hash__ = _hash  # type: ignore[method-assign, assignment]
        for name, method in shared.items():
            if name not in own:
                setattr(cls, name, method)
        if cls.__doc__ is None:
            cls.__doc__ = (
                ""  # for else the standard library asks for the signature, which takes as long again
            )
        return dataclasses.dataclass(cls, repr=False, eq=False, kw_only=kw_only)

    return made


def _dataclass(cls: type | None = None, /, *, frozen: bool = False, **options: Any) -> Any:
    """As `dataclasses.dataclass`."""
    made = _frozen(**options) if frozen else dataclasses.dataclass(**options)
    return made if cls is None else made(cls)


# To those who check types it is the standard one.
if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:
    dataclass = _dataclass


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
