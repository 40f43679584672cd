"""Options of an operation: the fields of a frozen dataclass, each with its kind, help and default.

Commands (`cli/operation_options.py`), rig specs (`rigtri.pipeline.rigspec.models.steps`) and the keywords
of the library (`rigtri.operations.declaration.keywords`) are derived from them. The field's name is the
option's everywhere: ``max_influences`` is ``--max-influences`` and the key ``max-influences``, ``from_`` is
``--from``.
"""

from __future__ import annotations

import inspect
import types
import typing
from collections.abc import Callable, Collection, Mapping
from dataclasses import MISSING, dataclass, field, fields
from functools import cache
from typing import Any, Literal, TypeVar, Union

from rigtri.errors import UsageError

T = TypeVar("T")
_META = "rigtri"
# Kinds that are one word of a command line, or the same in a spec.
_ONE_WORD = ("joined", "node or point")
# Where an option is: everywhere; everywhere, but declared once for all commands and specs; in Python alone.
Where = Literal["all", "shared", "python"]


@dataclass(frozen=True)
class Kind:
    """What a value is where its Python type alone does not say so; it annotates the type of a field.

    name: by which specs know how it is written there. metavar: for help. parse: one word of a command line
    as the value, ValueError for any other. read: the words of a command line or spec, with the flag for
    messages, as the whole value; UsageError. low, high: bounds of a number, open ones without the bound.
    """

    name: str
    metavar: str = ""
    parse: Callable[[str], Any] | None = None
    read: Callable[[str, Any], Any] | None = None
    low: float | None = None
    high: float | None = None
    low_open: bool = False
    high_open: bool = False


@dataclass(frozen=True)
class Option:
    """One declared option. hint: its Python type without what annotates it; kind: of the annotation.

    optional: None is a value. default: dataclasses.MISSING where the option must be given.
    """

    name: str
    hint: Any
    kind: Kind | None
    optional: bool
    default: Any
    help: str
    metavar: str
    choices: tuple[str, ...]
    where: Where
    excludes: tuple[str, ...]

    @property
    def key(self) -> str:
        """The option's name in a spec."""
        return key_of(self.name)

    @property
    def flag(self) -> str:
        """The option's name on the command line."""
        return f"--{self.key}"

    @property
    def is_file(self) -> bool:
        """Whether it names another file that the operation reads."""
        return self.kind is not None and self.kind.name.endswith("file")

    @property
    def one_word(self) -> bool:
        """Whether a command line has one word for it, whatever its Python type is."""
        return self.kind is not None and self.kind.name in _ONE_WORD

    @property
    def required(self) -> bool:
        return self.default is MISSING


def option(
    default: Any = MISSING,
    *,
    help: str = "",
    metavar: str = "",
    choices: Collection[str] = (),
    where: Where = "all",
    excludes: Collection[str] = (),
) -> Any:
    """A field of a dataclass of options.

    help: one sentence or two, for the command's help and for specs. metavar: what stands for the value there,
    where not the kind's. choices: of a text, where its type is no Literal. excludes: names of options that
    cannot be given beside it.
    """
    about = {
        "help": help,
        "metavar": metavar,
        "choices": tuple(choices),
        "where": where,
        "excludes": tuple(excludes),
    }
    if isinstance(default, dict):
        return field(default_factory=lambda: dict(default), metadata={_META: about})
    return field(default=default, metadata={_META: about})


def key_of(name: str) -> str:
    """What a field is called by those who do not write Python: ``from_side`` is from-side, ``as_`` is as."""
    return name.rstrip("_").replace("_", "-")


def hints_of(cls: Any) -> dict[str, Any]:
    """The types of a dataclass's fields, with what annotates them."""
    return _hints(cls)


@cache
def _hints(cls: Any) -> dict[str, Any]:
    return typing.get_type_hints(cls, include_extras=True)


def options_of(cls: Any) -> dict[str, Option]:
    """The options of an operation by their names: its own as they are declared, then those it inherits."""
    return _options(cls)


@cache
def _options(cls: Any) -> dict[str, Option]:
    own = inspect.get_annotations(cls)
    ordered = sorted(fields(cls), key=lambda one: one.name not in own)
    return {one.name: _option(one, hints_of(cls)[one.name]) for one in ordered}


def _option(one: Any, hint: Any) -> Option:
    optional, hint = _without_none(hint)
    kind = None
    if typing.get_origin(hint) is typing.Annotated:
        hint, kind = typing.get_args(hint)[:2]
    about: dict[str, Any] = {"help": "", "metavar": "", "choices": (), "where": "all", "excludes": ()}
    about |= one.metadata.get(_META, {})
    about["metavar"] = about["metavar"] or (kind.metavar if kind else "")
    return Option(one.name, hint, kind, optional, default_of(one), **about)


def described(cls: Any) -> str:
    """The options of an operation with their help, a line for each, as Python's help shows them."""
    return "\n".join(f"    {name}: {one.help}" for name, one in options_of(cls).items() if one.help)


def _without_none(hint: Any) -> tuple[bool, Any]:
    """Whether None is among the types, and the type or types besides."""
    if typing.get_origin(hint) not in (typing.Union, types.UnionType):
        return False, hint
    inner = typing.get_args(hint)
    rest = tuple(each for each in inner if each is not type(None))
    return len(rest) < len(inner), rest[0] if len(rest) == 1 else Union[rest]  # noqa: UP007


def default_of(one: Any) -> Any:
    """The default of a field; dataclasses.MISSING where there is none."""
    return one.default_factory() if one.default_factory is not MISSING else one.default


def made(cls: type[T], values: Mapping[str, Any], given: Collection[str]) -> T:
    """The options of values as the command line and specs have them, checked.

    values: by the names of fields, those of others too. given: the names of those that the user gave.
    Raises UsageError for what cannot be read, and for options that contradict each other.
    """
    known: dict[str, Any] = {}
    for name, one in options_of(cls).items():
        read = one.kind.read if one.kind else None
        if name in values and read is None:
            known[name] = values[name]
        elif name in values and read is not None and name in given:
            known[name] = None if values[name] is None else read(one.flag, values[name])
    options = cls(**known)
    check(options, given)
    return options


def check(options: Any, given: Collection[str] | None = None) -> None:
    """UsageError for options that contradict each other, or that make no sense.

    given: the names of those that the user gave; None for all that are not what they are by default.
    """
    declared = options_of(type(options))
    if given is None:
        given = [name for name, one in declared.items() if getattr(options, name) != one.default]
    for name, one in declared.items():
        value = getattr(options, name)
        if one.choices and value is not None and value not in one.choices:
            raise UsageError(f"{name}={value!r}: give one of {', '.join(map(repr, one.choices))}")
        for other in one.excludes if name in given else ():
            if other in given:
                raise UsageError(f"give {one.flag} or {declared[other].flag}, not both")
    if hasattr(options, "check"):
        options.check(given)


def refuse(given: Collection[str], names: Collection[str], why: str) -> None:
    """UsageError for the first of these options that the user gave."""
    for name in names:
        if name in given:
            raise UsageError(f"--{key_of(name)} {why}")
