"""Options: the fields of a frozen dataclass, each with its kind, help and default.

Commands (`cli/operation_options.py`), rig specs (`rigtri.pipeline.rigspec.models.steps`) and the keywords
of the library (`rigtri.operations.operation`) are derived from them. The field's name is the
option's everywhere: ``max_influences`` is ``--max-influences`` and the key ``max-influences``, ``from_`` is
``--from``.
"""

from __future__ import annotations

import inspect
import re
import types
import typing
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import MISSING, field, fields
from functools import cache, cached_property
from numbers import Real
from typing import Any, Literal, TypeVar, Union

from rigtri.errors import UsageError
from rigtri.limits import refuse_unworkable
from rigtri.model.dataclass import dataclass

T = TypeVar("T")
_META = "rigtri"
# Kinds that are one word of a command line, or the same in a spec.
_ONE_WORD = ("joined", "node or point")
# Where an option is: everywhere; everywhere, but declared once for all commands and specs; in Python alone.
Where = Literal["all", "shared", "python"]
# Under which heading an option stands in a command's help: what is made, how, for which joints or files of
# other places, what is written, and what protects from a result that nobody wants.
Group = Literal["what", "how", "joints", "output", "safety"]


@dataclass(frozen=True)
class Kind:
    """What a value is where its Python type alone does not say so; it annotates the type of a field.

    name: by which specs know how it is written there. metavar: for help. parse: one word of a command line
    as the value, ValueError for any other. read: the words of a command line or spec, with the flag for
    messages, as the whole value; UsageError. low, high: bounds of a number, open ones without the bound.
    help: of options that do not say their own; values and group: likewise.
    """

    name: str
    metavar: str = ""
    parse: Callable[[str], Any] | None = None
    read: Callable[[str, Any], Any] | None = None
    low: float | None = None
    high: float | None = None
    low_open: bool = False
    high_open: bool = False
    help: str = ""
    values: tuple[tuple[str, str], ...] = ()
    group: Group = "how"

    @property
    def range(self) -> str:
        """The bounds of a number in words."""
        low = "" if self.low is None else f"{'above' if self.low_open else 'at least'} {self.low:g}"
        high = "" if self.high is None else f"{'below' if self.high_open else 'at most'} {self.high:g}"
        return " and ".join(filter(None, (low, high)))

    def allows(self, number: float) -> bool:
        """Whether a number is within the bounds."""
        above = self.low is None or (number > self.low if self.low_open else number >= self.low)
        below = self.high is None or (number < self.high if self.high_open else number <= self.high)
        return above and below


@dataclass(frozen=True)
class Option:
    """One declared option. hint: its Python type without what annotates it; kind: of the annotation.

    optional: None is a value. default: dataclasses.MISSING where the option must be given. values: what its
    words mean, by the word. rare: short help leaves it out.
    """

    name: str
    hint: Any
    kind: Kind | None
    optional: bool
    default: Any
    help: str
    metavar: str
    choices: tuple[str, ...]
    values: tuple[tuple[str, str], ...]
    where: Where
    excludes: tuple[str, ...]
    group: Group
    rare: bool

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

    @cached_property
    def words(self) -> tuple[str, ...]:
        """The words that it knows, alone or beside names: those of its type, and those that it explains."""
        explained = (word for word, _ in self.values if word.islower())
        shown = (
            word for word in self.metavar.split("|") if word.islower() and word.replace("-", "").isalpha()
        )
        return tuple(dict.fromkeys([*self.choices, *_literals(self.hint), *explained, *shown]))

    @cached_property
    def takes_names(self) -> bool:
        """Whether names of nodes can stand where its words do."""
        return bool(self.words) and not {"NODE", "NAME"}.isdisjoint(
            [*self.metavar.split("|"), *dict(self.values)]
        )

    def cased(self, value: Any, is_name: Callable[[str], bool] | None = None) -> Any:
        """A value with the words that it knows as they are declared: ``Maya`` is ``maya``.

        is_name: whether a node is called so, which then is meant; without it, nothing changes where it could.
        """
        if self.takes_names and is_name is None:
            return value
        if isinstance(value, str):
            alike = [word for word in self.words if word.lower() == value.lower()]
            named = is_name is not None and is_name(value)
            return alike[0] if len(alike) == 1 and (value in alike or not named) else value
        if isinstance(value, list | tuple) and self.words:
            return type(value)(
                [self.cased(each, is_name) if isinstance(each, str) else each for each in value]
            )
        return value

    @property
    def required(self) -> bool:
        return self.default is MISSING

    def described(self, gap: str = "") -> str:
        """Its help for specs and Python, and a line for each of its values, behind ``gap``."""
        lines = [self.help, *(f"{gap}- {word}: {words}" for word, words in self.values)]
        several = "a mapping" if typing.get_origin(self.hint) is Mapping else "one or a list"
        text = re.sub(r"(?<=; )repeatable", several, "\n".join(lines))
        return text.replace("Repeatable", several.capitalize())


def option(
    default: Any = MISSING,
    *,
    help: str = "",
    metavar: str = "",
    choices: Collection[str] = (),
    values: Mapping[str, str] | None = None,
    where: Where = "all",
    excludes: Collection[str] = (),
    group: Group | None = None,
    rare: bool = False,
) -> Any:
    """A field of a dataclass of options.

    help: one sentence or two, for the command's help and for specs. metavar: what stands for the value there,
    where not the kind's. choices: of a text, where its type is no Literal. values: what words mean that can
    be given, each in a few words. excludes: names of options that cannot be given beside it. group: where it
    stands in help, if not where its kind does. rare: only `rigtri help` shows it, `--help` does not.
    """
    about = {
        "help": help,
        "metavar": metavar,
        "choices": tuple(choices),
        "values": tuple((values or {}).items()),
        "where": where,
        "excludes": tuple(excludes),
        "group": group,
        "rare": rare,
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
    plain: dict[str, Any] = option().metadata[_META]
    about = plain | one.metadata.get(_META, {})
    for word in ("metavar", "help", "values", "group"):
        about[word] = about[word] or getattr(kind or Kind(""), word)
    return Option(one.name, hint, kind, optional, default_of(one), **about)


def _literals(hint: Any) -> tuple[str, ...]:
    """The words of a type, or of types within it."""
    inner = typing.get_args(hint)
    if typing.get_origin(hint) is Literal:
        return inner
    return tuple(word for each in inner for word in _literals(each))


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
            known[name] = one.cased(values[name])
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
        _check_value(one, getattr(options, name))
        if name in given and name in _ALL_WITHOUT and getattr(options, name) == ():
            raise UsageError(f"{one.flag} names nothing; leave it out for all")
        for other in one.excludes if name in given else ():
            if other in given:
                raise UsageError(f"give {one.flag} or {declared[other].flag}, not both")
    if hasattr(options, "check"):
        options.check(given)


# Options that are left out for all: a list of names that comes out empty is not meant to be that.
_ALL_WITHOUT = ("joints", "chain", "below", "clip", "what")


def _check_value(one: Option, value: Any) -> None:
    """UsageError for what an option cannot be, whatever the others are."""
    if value is None:
        return
    choices = one.choices or (typing.get_args(one.hint) if typing.get_origin(one.hint) is Literal else ())
    if choices and value not in choices:
        raise UsageError(f"{one.name}={value!r}: give one of {', '.join(map(repr, choices))}")
    if one.hint is bool and not isinstance(value, bool):
        raise UsageError(f"{one.name}={value!r}: give True or False")
    if typing.get_origin(one.hint) is tuple and isinstance(value, str):
        raise UsageError(f"{one.flag}: give a list of names, e.g. ({value!r},), not {value!r}")
    refuse_unworkable(one.flag, *([value] if one.hint in (int, float) else _numbers(value)))
    if one.kind is not None and isinstance(value, Real) and not one.kind.allows(float(value)):
        raise UsageError(f"{one.flag} {value:g}: give a number {one.kind.range}")
    if one.kind is not None and one.kind.name == "axis":
        from rigtri.maths.triangle import axis_of

        try:
            axis_of(value)
        except ValueError as error:
            raise UsageError(f"{one.flag}: {error}") from None
    if one.kind is not None and one.kind.name == "direction" and not any(value):
        raise UsageError(f"{one.flag} is not a valid direction: use numbers that are not all 0")


def _numbers(value: Any) -> Iterator[float]:
    """The numbers of a value, also of points and lists of them."""
    if isinstance(value, Real):
        yield typing.cast(float, value)  # an int of any size
    for each in value if isinstance(value, tuple) else ():
        yield from _numbers(each)


def refuse(given: Collection[str], names: Collection[str], why: str) -> None:
    """UsageError for the first of these options that the user gave."""
    for name in names:
        if name in given:
            raise UsageError(f"--{key_of(name)} {why}")
