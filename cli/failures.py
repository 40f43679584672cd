"""How a command ends that failed: a line on standard error, with --json an object on standard output, too."""

from __future__ import annotations

import json
import re
import sys
from typing import NoReturn

import click

from rigtri.errors import RigtriError

from .words import plain

# In the context of a run: whether standard output is wanted as JSON and has nothing on it yet.
_WANTED = "rigtri.cli.failures"


def want_json(ctx: click.Context, _option: click.Parameter | None, value: bool) -> bool:
    """Note that a run is asked for JSON; the callback of --json, which may also come by the environment."""
    if value:
        ctx.meta[_WANTED] = True
    return value


def answered(ctx: click.Context) -> None:
    """Note that the result is on standard output already: it says itself what is wrong."""
    ctx.meta[_WANTED] = False


def tell_json(ctx: click.Context, kind: str, message: str, code: int) -> None:
    """Print what schemas/error.schema.json describes where JSON was asked for."""
    if ctx.meta.get(_WANTED):
        click.echo(json.dumps({"error": {"kind": kind, "message": message, "exit_code": code}}, indent=2))


def end(ctx: click.Context, error: Exception, code: int | None = None) -> NoReturn:
    """Tell an error of ours or of the system, and end with its exit code or ``code``."""
    kind, message, own = _said(error)
    message = plain(message, one_line=True)
    click.echo(f"rigtri: {message}", err=True)
    tell_json(ctx, kind, message, own if code is None else code)
    sys.exit(own if code is None else code)


def _said(error: Exception) -> tuple[str, str, int]:
    """Kind, message and exit code."""
    if isinstance(error, RigtriError):
        return kind_of(type(error)), str(error), error.exit_code
    if isinstance(error, OSError):
        # What the pipeline did not foresee, such as a full disk behind standard output.
        return "file", f"{error.filename or 'output'}: {error.strerror or error}", 3
    return "memory", "There is not enough memory for this file.", 1


def kind_of(error: type[RigtriError]) -> str:
    """The class of an error in words, of those that `rigtri.errors` has.

    >>> from rigtri.errors import NameNotFoundError
    >>> kind_of(NameNotFoundError)
    'name not found'
    """
    known = next(kind for kind in error.__mro__ if kind.__module__ == RigtriError.__module__)
    words = re.findall("[A-Z][a-z]+", known.__name__.removesuffix("Error"))
    return " ".join(words).lower()
