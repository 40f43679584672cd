"""How a command ends that failed: a line on standard error, with --json an object on standard output, too."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import NoReturn

import click

from rigtri.errors import Fault, RigtriError, error_kind, faults_by_text, system_reason

from . import ending
from .terminal_text import echo_message, plain, request_plain, without_advice

# In the context of a run: whether JSON is requested on standard output, which has nothing on it yet.
_JSON_REQUESTED = "rigtri.cli.failures"


def request_json(ctx: click.Context, _option: click.Parameter | None, value: bool) -> bool:
    """Note that JSON is requested; the callback of --json, which may also come from the environment."""
    if value:
        ctx.meta[_JSON_REQUESTED] = True
        request_plain(ctx, value)
    return value


def answered(ctx: click.Context) -> None:
    """Note that the result is on standard output already, and contains what is wrong."""
    ctx.meta[_JSON_REQUESTED] = False


def print_json_error(
    ctx: click.Context, kind: str, message: str, code: int, faults: Sequence[Fault] = ()
) -> None:
    """Print what schemas/error.schema.json describes where JSON is requested and can still be written."""
    if ctx.meta.get(_JSON_REQUESTED) and _takes_more():
        error: dict[str, object] = {"kind": kind, "message": message, "exit_code": code}
        if faults:
            error["faults"] = [fault.as_json() for fault in faults]
        with suppress(OSError):  # the line on standard error has the message
            click.echo(json.dumps({"error": error}, indent=2))


def _takes_more() -> bool:
    """Whether standard output takes what waits for it; of one that does not, let the rest go.

    The end of the program would try it once more, and print its own message.
    """
    try:
        sys.stdout.flush()
    except OSError:
        with suppress(OSError):
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, sys.stdout.fileno())
            os.close(nowhere)
        return False
    return True


@contextmanager
def exit_on_interrupt() -> Iterator[None]:
    """An interrupt ends the program with its own exit code and message."""
    try:
        yield
    except KeyboardInterrupt as error:
        word, code = ending(error)
        with suppress(OSError):  # the terminal is gone
            click.echo(f"\nrigtri: {word}", err=True)
        sys.exit(code)


@contextmanager
def always(ctx: click.Context, code: int) -> Iterator[None]:
    """Whatever fails ends with ``code``: for a command whose other codes are answers. Interrupts go on up."""
    try:
        yield
    except (click.ClickException, click.exceptions.Exit, click.Abort):
        raise
    except (RigtriError, OSError, MemoryError) as error:
        end(ctx, error, code)
    except Exception as error:  # a mistake of ours: Python's own code for it would be an answer
        import traceback

        traceback.print_exc()
        raise SystemExit(code) from error


def end(ctx: click.Context | None, error: Exception, code: int | None = None) -> NoReturn:
    """Print an error of ours or of the system, and end with its exit code or ``code``."""
    kind, message, own = _kind_message_code(error)
    message = plain(message, one_line=True)
    echo_message(f"rigtri: {message}")
    faults = error.faults if isinstance(error, RigtriError) else ()
    for line in _fault_lines(faults):
        click.echo(plain(f"  {line}", one_line=True), err=True)
    if ctx is not None:
        print_json_error(ctx, kind, message, own if code is None else code, faults)
    _takes_more()
    sys.exit(own if code is None else code)


def _fault_lines(faults: Sequence[Fault]) -> list[str]:
    """Each fault once, where it is first and where it is again; then the advice that they have in common."""
    lines: list[str] = []
    advice: dict[str, None] = {}
    for first, *others in faults_by_text(faults).values():
        line, advised = without_advice(str(first))
        advice |= dict.fromkeys(advised)
        places = dict.fromkeys(_position(other, first) for other in others)
        places.pop(_position(first, first), None)
        lines.append(f"{line}{', also at ' if places else ''}{', '.join(places)}")
    return [*lines, *advice]


def _position(fault: Fault, first: Fault) -> str:
    """Where a fault is; with its file where that is another than that of the first."""
    found, file = fault.as_json(), first.as_json()["file"]
    place = f"{found['line']}:{found['column']}"
    return place if found["file"] == file else f"{found['file']}:{place}"


def misused(ctx: click.Context, error: click.ClickException) -> NoReturn:
    """Print what click does not understand in one line, as every error, and end with its exit code."""
    # Versions of click before 8.2 show the help themselves.
    if isinstance(error, getattr(click.exceptions, "NoArgsIsHelpError", ())):
        raise error  # it shows the help
    message = " ".join(plain(error.format_message()).split())
    name = ctx.invoked_subcommand  # errors of the parser do not know it
    page = "rigtri --help" if name in (None, "help") else f"rigtri help {name}"
    stop = "" if message.endswith((".", "?", "!", ")")) else "."
    echo_message(f"rigtri: {message}{stop} Help: {page}")
    print_json_error(ctx, "usage", message, error.exit_code)
    _takes_more()
    sys.exit(error.exit_code)


def _kind_message_code(error: Exception) -> tuple[str, str, int]:
    """Kind, message and exit code."""
    if isinstance(error, RigtriError):
        return error_kind(error), str(error), error.exit_code
    if isinstance(error, OSError):
        # What the pipeline did not foresee, such as a full disk behind standard output.
        return "file", f"{error.filename or 'output'}: {system_reason(error)}", 3
    return "memory", "There is not enough memory for this file.", 1
