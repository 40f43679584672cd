"""The `operation` decorator: calls with an options object or with keywords, and the report."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from dataclasses import MISSING, replace
from typing import Any, Protocol, TypeVar

import numpy as np

from rigtri.errors import UsageError
from rigtri.model.rig import Rig
from rigtri.operations.declaration.keywords import defaults, from_keywords
from rigtri.operations.declaration.option import check, described, options_of
from rigtri.report import Report

O_contra = TypeVar("O_contra", contravariant=True)


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


def operation(kind: type[O_contra] | None) -> Callable[[Callable[..., Rig]], Operation[O_contra]]:
    """Let a function of a rig, ``options`` and ``report`` be called without either, or with keywords.

    kind: of its options; None for a function that has none.

    What it tells is also kept with a rig that was read by itself, for when that is written.
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
            if not isinstance(rig, Rig):
                kind_given = type(rig).__name__
                raise TypeError(f"{function.__name__}: give a rig, as rigtri.read does, not {kind_given}")
            if options is not None and keywords:
                raise TypeError(f"{function.__name__}: give options or {', '.join(keywords)}, not both")
            if kind is not None:
                given = None if options is not None else tuple(keywords)
                if options is None:
                    options = from_keywords(kind, keywords, function.__name__)
                _check_rigs(options)
                check(options, given)
                keywords = {"options": options}
            report = report if report is not None else Report()
            if rig.source is None:
                return function(rig, *others, report=report, **keywords)
            own = Report()
            try:
                # What leaves float64 becomes inf or NaN; writing sees it.
                with np.errstate(all="ignore"):
                    made = function(replace(rig, source=None), *others, report=own, **keywords)
            finally:
                report.merge(own)
            return replace(made, source=rig.source.after(own))

        called.__signature__ = _signature(function, kind)  # type: ignore[attr-defined]
        if kind is not None:
            called.__doc__ = f"{inspect.getdoc(function)}\n\nOptions:\n{described(kind)}"
        return called

    return decorated


def _check_rigs(options: Any) -> None:
    """UsageError where an option that is a rig has anything else; commands and specs have read it by now."""
    for one in options_of(type(options)).values():
        value = getattr(options, one.name)
        a_rig = one.kind is not None and one.kind.name in ("rig file", "edited file")
        if a_rig and value is not None and not isinstance(value, Rig):
            raise UsageError(f"{one.name}={value!r}: give a rig")


def _signature(function: Callable[..., Rig], kind: type | None) -> inspect.Signature:
    """For help and for editors that complete: all keywords with their defaults."""
    own = inspect.signature(function)
    if kind is None:
        return own
    only = inspect.Parameter.KEYWORD_ONLY
    first = [p for p in own.parameters.values() if p.name not in ("options", "report")]
    both = [inspect.Parameter(name, only, default=None) for name in ("options", "report")]
    words = [
        inspect.Parameter(word, only, default=inspect.Parameter.empty if default is MISSING else default)
        for word, default in defaults(kind).items()
    ]
    return own.replace(parameters=[*first, *both, *words])
