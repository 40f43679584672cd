"""The parameters of a command: which the user gave, and how files are read by them."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any

import click

from rigtri.errors import UsageError

if TYPE_CHECKING:
    from rigtri.formats import ReadOptions


def given(ctx: click.Context) -> list[str]:
    """The names of the parameters that the user gave, with the command or by the environment."""
    defaults = (None, click.core.ParameterSource.DEFAULT)
    return [name for name in ctx.params if ctx.get_parameter_source(name) not in defaults]


def given_options(ctx: click.Context) -> dict[str, Any]:
    """The options that the user gave, for the report."""
    quiet = ("source", "output", "as_json", "quiet", "verbose", "report_path")
    return {name: ctx.params[name] for name in given(ctx) if name not in quiet}


def refuse_given(options: dict[str, str], why: str) -> None:
    """UsageError for the first of these options (flag → parameter) that the user gave."""
    named = given(click.get_current_context())
    for flag, name in options.items():
        if name in named:
            raise UsageError(f"{flag} {why}")


def check_streams(*sources: str) -> None:
    """UsageError where two files are to come from standard input."""
    if sources.count("-") > 1:
        raise UsageError("standard input is one file; give - for one of the two and a name for the other")


def read_options(values: dict[str, Any]) -> ReadOptions:
    """The format options among a command's values."""
    from rigtri.formats import ReadOptions

    named = {field.name: values[field.name] for field in fields(ReadOptions) if field.name in values}
    return ReadOptions(**named)


def destination(values: dict[str, Any]) -> str:
    """OUT; of a run that writes nothing, and needs no OUT for that, IN."""
    output = values["output"]
    return str(values["source"] if output is None else output)
