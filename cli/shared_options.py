"""Options that several commands share.

source_argument     every command
output_option       what writes a file; target_option: of edits
reading_options     edits, inspect, verify, diff: --lenient, --allow-external-paths, --root
edit_options        edits: --overwrite, --dry-run, --report, --strict, --verify, --tolerance …
output_options      every command: --json, -q, -v
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import click

from rigtri.model.edit_options import EditOptions
from rigtri.model.options import options_of
from rigtri.operations.option_kinds import OneCharacter

from . import failures
from .help_format import Option, option
from .operation_options import click_option
from .option_types import FilePath
from .terminal_text import request_quiet

F = TypeVar("F", bound=Callable[..., Any])

source_argument = click.argument("source", metavar="IN", type=FilePath(allow_dash=True))


def output_option(words: str, metavar: str = "OUT", **more: Any) -> Callable[[F], F]:
    """-o OUT: the file that a command writes; ``more`` as click.option takes it."""
    more = {"type": FilePath(allow_dash=True, dir_okay=False)} | more
    return option("-o", "--output", "output", metavar=metavar, help=words, group="output", **more)


def needed_output(ctx: click.Context, param: click.Parameter, value: Any) -> Any:
    """OUT, which only a dry run does without."""
    if value is None and not ctx.params.get("dry_run"):
        raise click.MissingParameter(ctx=ctx, param=param)
    return value


_IN_FORMAT = "The file to write, in the format of IN; - for standard output."
target_option = output_option(f"{_IN_FORMAT} Required unless --dry-run.", callback=needed_output)
optional_target_option = output_option(_IN_FORMAT)


def shared_option(name: str, *flags: str, more: str = "", **changes: Any) -> Option:
    """An option that all edits have (`EditOptions`), for a command.

    flags: shorter names. more: what its help says besides. changes: another default or help for the command;
    or, such as ``is_eager``, how click takes it.
    """
    one = options_of(EditOptions)[name]
    one = replace(one, **{word: changes.pop(word) for word in ("default", "help") if word in changes})
    return click_option(replace(one, help=f"{one.help} {more}".strip()), *flags, **changes)


def shared(name: str, *flags: str, **changes: Any) -> Callable[[F], F]:
    """The same as a decorator."""

    def added(command: Any) -> Any:
        add_option(command, shared_option(name, *flags, **changes))
        return command

    return added


def add_option(command: Any, option: click.Parameter) -> None:
    """As the decorators of click add an option: in front of those that are there."""
    command.__click_params__ = [*getattr(command, "__click_params__", []), option]


def report_option(words: str) -> Callable[[F], F]:
    """The file with what was done, for machines."""
    return option(
        "--report",
        "report_path",
        metavar="FILE.json",
        type=FilePath(allow_dash=True, dir_okay=False),
        help=f"{words}, with the measured deviation; - for standard output.",
        group="output",
    )


def preset_option(words: str) -> Callable[[F], F]:
    """The axes of another program."""
    from rigtri.operations.axis_presets import WORDS

    return option("--preset", type=click.Choice(list(WORDS)), help=words, group="what", values=WORDS)


dry_run_option = shared("dry_run", "-n", is_eager=True)


# How a difficult file is read, whatever is in it.
READING = ("lenient", "allow_external_paths", "allow_missing")


def reading_options(command: F) -> F:
    """How a difficult file is read."""
    for name in ("root", *READING):
        command = shared(name)(command)
    return command


def spec_reading_options(command: F) -> F:
    """The same but for --root, which is for one file, where a spec can say so, too."""
    for name in READING:
        command = shared(name, more="[as the spec says]")(command)
    return command


def character_option(command: F) -> F:
    """One character of several, as the edits have it that take one."""
    add_option(command, click_option(options_of(OneCharacter)["character"]))
    return command


scheme_option = option(
    "--scheme",
    metavar="FILE",
    type=FilePath(path_type=Path),
    multiple=True,
    help="Try this naming scheme (.toml) before rigtri's own. Repeatable. RIGTRI_SCHEMES lists folders.",
    group="joints",
    rare=True,
)
json_option = option(
    "--json",
    "as_json",
    is_flag=True,
    is_eager=True,
    callback=failures.request_json,
    help="Print the result as JSON.",
    group="output",
)
quiet_option = option(
    "-q",
    "--quiet",
    is_flag=True,
    is_eager=True,
    callback=request_quiet,
    group="output",
    help="Print only errors.",
)


def output_options(command: F) -> F:
    """How much is printed, and in which form."""
    verbose = option(
        "-v", "--verbose", is_flag=True, group="output", help="More detail: each joint, mesh and clip."
    )
    for add in (verbose, quiet_option, json_option):
        command = add(command)
    return command


def edit_options(command: F) -> F:
    """What every edit of a file has in common."""
    for add in (
        shared("resources"),
        shared("edit_target"),
        shared("tolerance"),
        shared("verify"),
        shared("strict"),
        report_option("Write what was done, per joint and limb"),
        shared("sidecar"),
        dry_run_option,
        shared("overwrite"),
    ):
        command = add(command)
    return command
