"""The `operation` decorator: calls with an options object or with keywords, and the report.

Values of keywords are plain ones, as specs have them, or those of the fields: a direction may be an axis,
a list of names one name, and what has fields a mapping.
"""

from __future__ import annotations

import collections.abc
import functools
import inspect
import re
import types
import typing
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import MISSING, fields, is_dataclass, replace
from numbers import Integral
from typing import Annotated, Any, Literal, Protocol, TypeVar

import numpy as np

from rigtri.errors import UsageError
from rigtri.limits import LARGEST, fits
from rigtri.model.arguments import check_arguments
from rigtri.model.limb import Limb
from rigtri.model.options import Kind, Option, check, default_of, hints_of, options_of
from rigtri.model.rig import Rig
from rigtri.model.spelling import AS_FLAGS, Spelling, described, python_spelling, spelled
from rigtri.operations.left_behind import naming_left_behind
from rigtri.operations.option_kinds import OneCharacter, assigned, is_one
from rigtri.report import Report

O_contra = TypeVar("O_contra", contravariant=True)
T = TypeVar("T")
# Kinds of options whose list may be a mapping.
_ASSIGNED = ("assignments", "of nodes", "node to node")
F = TypeVar("F", bound=Callable[..., Any])
_WORDS: dict[Any, tuple[type, str]] = {
    bool: (bool, "True or False"),
    str: (str, "a text"),
    int: (Integral, "a whole number"),
}
# What those parameters are that many functions have.
_PARAMETERS = {
    "rig": "The rig, as `rigtri.read` returns it; it is not changed.",
    "source": "The file to read.",
    "target": "The file to write.",
    "options": "All options in one object, instead of keywords.",
    "report": "A `rigtri.Report` of your own, which gets what was done and all warnings.",
}


class Operation(Protocol[O_contra]):
    """Makes a rig of a rig; ``keywords`` are options of the operation by name."""

    def __call__(
        self,
        rig: Rig,
        *others: Rig,
        options: O_contra | None = None,
        report: Report | None = None,
        **keywords: Any,
    ) -> Rig: ...


_unnamed: ContextVar[Report | None] = ContextVar("the report of operations without one", default=None)

# Of the rig, the nodes of the character that is edited alone, its name and the options.
Refusal = Callable[[Rig, frozenset[int], str, Any], None]


def operation(
    kind: type[O_contra] | None, *, alone: Refusal | None = None, made_alone: Refusal | None = None
) -> Callable[[Callable[..., Rig]], Operation[O_contra]]:
    """Let a function of a rig, ``options`` and ``report`` be called without either, or with keywords.

    kind: of its options; None for a function that has none. alone, made_alone: refuse what cannot be done to
    a character alone, and what has been made of it.

    What it reports is also kept with a rig that was read by itself, for when that is written.
    """

    def decorated(function: Callable[..., Rig]) -> Operation[O_contra]:
        @functools.wraps(function)
        def called(
            rig: Rig,
            *others: Rig,
            options: O_contra | None = None,
            report: Report | None = None,
            **keywords: Any,
        ) -> Rig:
            named = keywords if kind is None else {}
            check_arguments(function, (rig, *others), {"options": options, "report": report, **named})
            if options is not None and keywords:
                raise TypeError(f"{function.__name__}: give options or {', '.join(keywords)}, not both")
            report = report if report is not None else _unnamed.get() or Report()
            if kind is None:
                return _run(function, rig, others, report, keywords)
            spelling = python_spelling(kind) if options is None else AS_FLAGS
            with spelled(spelling):
                given = None if options is not None else tuple(keywords)
                if options is None:
                    options = from_keywords(kind, keywords, function.__name__)
                _check_rigs(options)
                options = _with_words(rig, options)
                check(options, given)
                return _run(
                    function, rig, others, report, {"options": options}, spelling, (alone, made_alone)
                )

        return called if kind is None else _shown(called, function, kind)

    return decorated


@contextmanager
def reporting_to(report: Report | None) -> Iterator[None]:
    """Let operations that are given no report add to this one."""
    token = _unnamed.set(report)
    try:
        yield
    finally:
        _unnamed.reset(token)


@reporting_to(None)  # those within another one are told what to report
def _run(
    function: Callable[..., Rig],
    rig: Rig,
    others: Sequence[Rig],
    report: Report,
    words: Mapping[str, Any],
    spelling: Spelling = AS_FLAGS,
    alone: tuple[Refusal | None, Refusal | None] = (None, None),
) -> Rig:
    """What an operation makes of a rig; one that knows its file keeps what was reported."""
    options = words.get("options")
    character = options.character_of(rig) if isinstance(options, OneCharacter) else None
    run = naming_left_behind(_of_character(function, character, *alone))
    read = [*others, *(vars(options).values() if options is not None else ())]
    sources = [file for one in read if isinstance(one, Rig) and one.source for file in one.source.needed()]
    if rig.source is None:
        report.merge(Report(sources=sources))
        with spelled(spelling, report):
            return run(rig, *others, report=report, **words)
    own = Report(sources=sources)
    try:
        # What leaves float64 becomes inf or NaN; writing sees it.
        with np.errstate(all="ignore"), spelled(spelling, own):
            made = run(replace(rig, source=None), *others, report=own, **words)
    finally:
        report.merge(own)
    return replace(made, source=rig.source.after(own))


def takes_keywords(kind: type) -> Callable[[Callable[..., T]], Callable[..., T]]:
    """Let a function that is no operation take the fields of its ``options``, of this kind, as keywords."""

    def decorated(function: Callable[..., T]) -> Callable[..., T]:
        own = inspect.signature(function).parameters

        @functools.wraps(function)
        def called(*values: Any, options: Any = None, **keywords: Any) -> T:
            check_arguments(function, values, {"options": options, **keywords})
            chosen = {word: keywords.pop(word) for word in [*keywords] if word not in own}
            if options is not None and chosen:
                raise TypeError(f"{function.__name__}: give options or {', '.join(chosen)}, not both")
            with spelled(python_spelling(kind) if options is None else AS_FLAGS):
                options = options or from_keywords(kind, chosen, function.__name__)
                return function(*values, options=options, **keywords)

        return _shown(called, function, kind)

    return decorated


def with_keywords(*kinds: type) -> Callable[[F], F]:
    """Let help and editors show the fields of ``kinds``, which a function takes as keywords among others."""

    def decorated(function: F) -> F:
        @functools.wraps(function)
        def called(*values: Any, **keywords: Any) -> Any:
            check_arguments(function, values, keywords)
            with spelled(python_spelling(*kinds), keywords.get("report")):
                return function(*values, **keywords)

        return typing.cast(F, _shown(called, function, *kinds))

    return decorated


def _of_character(
    function: Callable[..., Rig],
    name: str | None,
    alone: Refusal | None,
    made_alone: Refusal | None,
) -> Callable[..., Rig]:
    """A function of a rig that edits one of its characters alone; None for all."""
    if name is None:
        return function

    def run(rig: Rig, *others: Rig, **keywords: Any) -> Rig:
        from rigtri.recognition.one_character import named, within

        nodes = named(rig, name)
        if alone is not None:
            alone(rig, nodes, name, keywords["options"])
        made = within(rig, nodes, lambda small: function(small, *others, **keywords))
        if made_alone is not None:
            made_alone(made, named(made, name), name, keywords["options"])
        return made

    return run


def _with_words(rig: Rig, options: T) -> T:
    """Options with their words in lower case, where no node of the rig is called as they are written."""
    named = [one for one in options_of(type(options)).values() if one.takes_names]
    given = {one.name: getattr(options, one.name) for one in named}
    cased = {one.name: one.cased(given[one.name], rig.has) for one in named}
    return options if cased == given else replace(typing.cast(Any, options), **cased)


def _check_rigs(options: Any) -> None:
    """UsageError where an option that is a rig has anything else; commands and specs have read it by now."""
    for one in options_of(type(options)).values():
        value = getattr(options, one.name)
        a_rig = one.kind is not None and one.kind.name in ("rig file", "edited file")
        if a_rig and value is not None and not isinstance(value, Rig):
            raise UsageError(f"{one.name}={value!r}: give a rig")


def _shown(called: Callable[..., T], function: Callable[..., Any], *kinds: type) -> Callable[..., T]:
    """A function with all keywords, their defaults and help, for `help` and for editors that complete."""
    own, only, none = inspect.signature(function), inspect.Parameter.KEYWORD_ONLY, inspect.Parameter.empty
    named = [p for p in own.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
    both = [p.replace(default=None) for p in named if p.name in ("options", "report")]
    words = {word: default for kind in kinds for word, default in defaults(kind).items()}
    more = [
        inspect.Parameter(word, only, default=none if default is MISSING else default)
        for word, default in words.items()
        if word not in own.parameters
    ]
    first = [p for p in named if p.name not in ("options", "report")]
    called.__signature__ = own.replace(parameters=[*first, *both, *more])  # type: ignore[attr-defined]
    text, lines = inspect.getdoc(function) or "", "\n".join(map(described, kinds))
    parameters = [f"    {p.name}: {_PARAMETERS[p.name]}" for p in named if _undescribed(p.name, text)]
    about = "\n".join(["", "", "Parameters:", *parameters]) if parameters else ""
    called.__doc__ = f"{text}{about}\n\nOptions:\n{lines}"
    return called


def _undescribed(name: str, text: str) -> bool:
    """Whether a docstring says nothing of a parameter that many functions have."""
    return name in _PARAMETERS and not re.search(rf"\b{name}(, \w+)*:", text)


def defaults(kind: type) -> dict[str, Any]:
    """The keywords of ``kind`` with their defaults; dataclasses.MISSING where there is none."""
    return {field.name: default_of(field) for field in fields(kind)}


def from_keywords(kind: type[T], keywords: Mapping[str, Any], name: str) -> T:
    """The options of the operation ``name`` from keywords.

    Raises TypeError for a keyword that does not exist or is missing, UsageError for a value of another type.
    """
    known, hints, declared = defaults(kind), hints_of(kind), options_of(kind)
    refuse_unknown(name, keywords, known)
    for keyword, default in known.items():
        if default is MISSING and keyword not in keywords:
            raise TypeError(f"{name}() needs {keyword}")
    cased = {word: declared[word].cased(_spelled(declared[word], value)) for word, value in keywords.items()}
    return kind(**{word: _fitted(hints[word], value, word) for word, value in cased.items()})


def refuse_unknown(name: str, keywords: Iterable[str], known: Collection[str]) -> None:
    """TypeError for the first keyword that a function does not have, with the one that it is like."""
    for keyword in keywords:
        if keyword not in known:
            from difflib import get_close_matches

            close = get_close_matches(keyword, known, n=1)
            hint = f"; did you mean '{close[0]}'?" if close else ""
            raise TypeError(f"{name}() has no option '{keyword}'{hint}")


def _spelled(one: Option, value: Any) -> Any:
    """A value as its field has it, where it is as specs and commands have it: one for a list, or words."""
    kind, hint = one.kind, one.hint
    outer, inner = typing.get_origin(hint), typing.get_args(hint)
    if kind is None or value is None:
        return value
    if one.one_word:
        return kind.read(one.flag, value) if kind.read and isinstance(value, str) else value
    if outer is collections.abc.Mapping and kind.read:
        return _assigned(one, value, plain=inner[1] is str)
    listed = outer is tuple and inner[-1] is Ellipsis
    if listed and isinstance(value, Mapping) and kind.name in _ASSIGNED:
        return assigned(value)
    return [value] if listed and is_one(kind.name, value) else value


def _assigned(one: Option, value: Any, *, plain: bool) -> Any:
    """A mapping, or what it is of texts with ``=``; with what it has in words as commands read these.

    plain: what it has are mere texts.
    """
    assert one.kind is not None
    assert one.kind.read is not None
    texts = [value] if isinstance(value, str) else value
    if isinstance(texts, list | tuple) and all(isinstance(each, str) for each in texts):
        return one.kind.read(one.flag, texts)
    if plain or not isinstance(value, Mapping):
        return value
    words = [f"{name or 'centre'}={each}" for name, each in value.items() if isinstance(each, str)]
    rest = {name: each for name, each in value.items() if not isinstance(each, str)}
    return rest | dict(one.kind.read(one.flag, words)) if words else value


def _fitted(hint: Any, value: Any, word: str) -> Any:
    """A value as its field has it; UsageError, in the user's words, where it cannot be that."""
    outer, inner = typing.get_origin(hint), typing.get_args(hint)
    if outer is Annotated:
        return _fitted(inner[0], _parsed(inner[1], value, word), word)
    if outer in (types.UnionType, typing.Union):
        return _one_of(inner, value, word)
    if outer is tuple:
        return _row(inner, value, word)
    if is_dataclass(hint) and isinstance(value, Mapping):
        try:
            return from_keywords(typing.cast(type, hint), value, word)
        except TypeError:  # keys that it has not, or not all that it needs
            raise UsageError(f"{word}={value!r}: give {_plain(hint, value)[1]}") from None
    if outer is collections.abc.Mapping and isinstance(value, Mapping):
        return {name: _fitted(inner[1], each, f"{word}[{name!r}]") for name, each in value.items()}
    fitting, words = _plain(hint, value)
    if not fitting:
        raise UsageError(f"{word}={value!r}: give {words}")
    # Libraries in C++ and JSON take no numbers of numpy.
    return value.item() if isinstance(value, np.generic) else value


def _parsed(kind: Kind, value: Any, word: str) -> Any:
    """A value, or each of a list, as a command line reads it where it is a text."""
    if kind.parse is None:
        return value
    try:
        if isinstance(value, list | tuple):
            return [kind.parse(each) if isinstance(each, str) else each for each in value]
        return kind.parse(value) if isinstance(value, str) else value
    except ValueError as error:
        raise UsageError(f"{word}: {error}") from None


def _plain(hint: Any, value: Any) -> tuple[bool, str]:
    """Whether a value has a type, and what that is in words."""
    outer, inner = typing.get_origin(hint), typing.get_args(hint)
    if outer is Literal:
        return isinstance(value, str) and value in inner, f"one of {', '.join(map(repr, inner))}"
    if outer is collections.abc.Mapping:
        return False, "a mapping from names, e.g. {'name': value}"
    if is_dataclass(hint):
        kind = typing.cast(type, hint)
        return isinstance(value, kind), f"a mapping with {', '.join(defaults(kind))}"
    if hint is float:
        return not isinstance(value, bool) and fits(value), f"a finite number, at most {LARGEST:g}"
    kind, words = _WORDS.get(hint, (object, ""))
    return isinstance(value, kind) and (hint is bool or not isinstance(value, bool)), words


def _one_of(inner: tuple[Any, ...], value: Any, word: str) -> Any:
    """The value as the first of several types that it has; as the last where it has none."""
    if value is None and type(None) in inner:
        return None
    *first, last = (hint for hint in inner if hint is not type(None))
    if isinstance(value, Mapping) and (records := [hint for hint in (*first, last) if is_dataclass(hint)]):
        return _fitted(records[0], value, word)
    for hint in first:
        with suppress(UsageError):
            return _fitted(hint, value, word)
    if Limb in first and (isinstance(value, str) or not isinstance(value, Sequence) or len(value) != 3):
        raise UsageError(f"{word}={value!r}: give three joints: root, middle, end")
    return _fitted(last, value, word)


def _row(inner: tuple[Any, ...], value: Any, word: str) -> tuple[Any, ...]:
    """Several values: any number of a kind, or one of each."""
    if isinstance(value, str):
        value = (value,)
    if not isinstance(value, Iterable) or isinstance(value, Mapping):
        raise UsageError(f"{word}={value!r}: give a list")
    values = tuple(value)
    kinds = inner[:1] * len(values) if inner[-1] is Ellipsis else inner
    if len(kinds) != len(values):
        raise UsageError(f"{word}={value!r}: give {len(kinds)} values")
    return tuple(_fitted(kind, each, word) for kind, each in zip(kinds, values, strict=True))
