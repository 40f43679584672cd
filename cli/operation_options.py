"""Options of commands, made of what operations declare."""

from __future__ import annotations

import collections.abc
import typing
from typing import Any, Literal

import click

from rigtri.model.options import Kind, options_of
from rigtri.model.options import Option as Declared

from .help_format import Option
from .option_types import FilePath, Integer, Number, Parsed, Tolerance


def click_options(declared: type) -> list[Option]:
    """The options of an operation for its command, in the order of their declaration."""
    return [click_option(one) for one in options_of(declared).values() if one.where == "all"]


def click_option(one: Declared, *flags: str, **about: Any) -> Option:
    """An option for a command; flags: shorter names, about: as click takes it."""
    flags = (*flags, one.flag, one.name)
    about |= {"required": one.required, "metavar": one.metavar or None}
    about |= {"help": one.help, "group": one.group, "rare": one.rare, "values": dict(one.values)}
    if one.hint is bool:
        return _flag(one, flags, about)
    item, several = one.hint, typing.get_origin(one.hint) is collections.abc.Mapping
    if typing.get_origin(item) is tuple and typing.get_args(item)[-1] is Ellipsis:
        item, several = typing.get_args(item)[0], True
    if one.one_word:
        about["type"] = str
        return Option(flags, **about)
    if several:
        about["multiple"] = True
    elif not one.required:
        about["default"] = one.default
        about["show_default"] = one.default not in (None, "") and not isinstance(one.default, tuple)
    about |= _value(item, one)
    return Option(flags, **about)


def _flag(one: Declared, flags: tuple[str, ...], about: dict[str, Any]) -> Option:
    """A flag; with its contrary where it is on, or as stored, unless said otherwise."""
    about |= {"required": False, "metavar": None}
    if one.default is False:
        return Option(flags, is_flag=True, **about)
    both = f"{one.flag}/--no-{one.key}"
    return Option([both, one.name], default=one.default, show_default=bool(one.default), **about)


def _value(item: Any, one: Declared) -> dict[str, Any]:
    """What click calls the type of one value, and of how many words it is."""
    item, kind = _plain(item, one.kind)
    if kind is not None and kind.parse is not None:
        return {"type": Parsed(kind.parse)}
    if kind is not None and kind.name.endswith("file"):
        return {"type": FilePath(allow_dash=kind.name == "edited file")}
    if one.choices or typing.get_origin(item) is Literal:
        return {"type": click.Choice(list(one.choices or typing.get_args(item))), "metavar": None}
    if typing.get_origin(item) is tuple:
        return {"nargs": len(typing.get_args(item))}
    if item in (int, float):
        return {"type": _number(item, kind)}
    return {"type": str}


def _number(item: type, kind: Kind | None) -> Any:
    if kind is not None and kind.name == "tolerance":
        return Tolerance()
    bounds: dict[str, Any] = {}
    if kind is not None and (kind.low, kind.high) != (None, None):
        bounds = {"min": kind.low, "max": kind.high, "min_open": kind.low_open, "max_open": kind.high_open}
    if item is int:
        return Integer(**bounds) if bounds else click.INT
    return Number(**bounds)


def _plain(item: Any, kind: Kind | None) -> tuple[Any, Kind | None]:
    """A type without what annotates it, and of several kinds the one that words of a command line make."""
    if typing.get_origin(item) is typing.Annotated:
        item, kind = typing.get_args(item)[:2]
    if typing.get_origin(item) not in (None, tuple, Literal, collections.abc.Mapping):
        item = typing.get_args(item)[-1]
    return item, kind
