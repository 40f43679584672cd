"""Commands of operations: their options are those that the operation declares, and those of all edits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import click

from rigtri.errors import NameNotFoundError
from rigtri.model.options import made, options_of
from rigtri.report import Report

from .editing import copy_ahead, run_edit
from .given_options import given, given_options, read_options
from .help_format import Command, Option
from .operation_options import click_options
from .option_types import FilePath
from .output_file import write_output
from .shared_options import (
    add_option,
    edit_options,
    output_options,
    reading_options,
    source_argument,
    target_option,
)

Step = Callable[[Any, "Report"], Any]
Decorator = Callable[[Any], Any]


class SavedFile(Option):
    """An option that has a command write a file besides OUT; text: what is in it, of what was done."""

    def __init__(
        self, flag: str, metavar: str, text: Callable[[Report], str], *, help: str, rare: bool = False
    ) -> None:
        kind = FilePath(allow_dash=True, dir_okay=False)
        super().__init__([flag], metavar=metavar, type=kind, help=help, group="output", rare=rare)
        self.text = text


def edit_command(
    name: str,
    declared: type,
    summary: Callable[[Report], str],
    words: str,
    *,
    more: Sequence[Option] = (),
    **about: Any,
) -> click.Command:
    """The command of an operation on a file; more, about: as `command_of` takes them.

    summary: what was done, in a line or a few.
    """

    def run(ctx: click.Context, values: dict[str, Any]) -> None:
        copy_ahead(ctx, values)
        step = step_of(name, declared, values)
        run_edit(name, values, step, given_options(ctx), summary, lambda report: save(values, report))

    def save(values: dict[str, Any], report: Report) -> None:
        for option in more:
            if isinstance(option, SavedFile) and values[str(option.name)]:
                write_output(option.text(report), values[str(option.name)])

    return command_of(name, declared, words, run, more=more, **about)


def command_of(
    name: str,
    declared: type,
    words: str,
    run: Callable[[click.Context, dict[str, Any]], None],
    *,
    more: Sequence[Option] = (),
    source: Decorator = source_argument,
    output: Decorator = target_option,
    cls: type[Command] = Command,
) -> click.Command:
    """A command with the options of an operation and those of all edits.

    declared: the dataclass of its options. words: the help, with an example. more: options that only this
    command has. source, output: IN and OUT.
    """

    @click.pass_context
    def called(ctx: click.Context, /, **values: Any) -> None:
        run(ctx, values)

    called = output_options(edit_options(reading_options(called)))
    for option in reversed(more):
        add_option(called, option)
    return click.command(name, cls=cls, help=words)(source(output(declared_options(declared)(called))))


def declared_options(declared: type) -> Callable[[Any], Any]:
    """A decorator with the options that an operation declares.

    What it says of an option that all edits have, too, is added to that one's help.
    """

    def decorated(command: Any) -> Any:
        for option in reversed(click_options(declared)):
            add_option(command, option)
        own = {
            one.name: one.help
            for one in options_of(declared).values()
            if one.where == "shared" and one.kind is not None and one.help != one.kind.help
        }
        for option in command.__click_params__:
            if option.name in own:
                option.help += f" Also the {own[option.name][0].lower()}{own[option.name][1:]}"
        return command

    return decorated


def step_of(name: str, declared: type, values: dict[str, Any]) -> Step:
    """What the user asks of an operation, as `rigtri.edit` does it. UsageError for what cannot be."""
    from rigtri.pipeline.steps import applied, name_all_missing

    options: Any = made(declared, values, given(click.get_current_context()))
    step = applied(name, options, read_options(values))

    def named(rig: Any, report: Report) -> Any:
        try:
            return step(rig, report)
        except NameNotFoundError as error:
            name_all_missing(error, rig, options)
            raise

    return named
