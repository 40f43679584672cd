"""Commands of operations: their options are those that the operation declares, and those of all edits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import click

from rigtri.operations.declaration.option import made

from .asked import given, given_options, read_options
from .editing import copy_ahead, run_edit
from .operation_options import click_options
from .options import edit_options, output_options, reading_options, source_argument, target_option

if TYPE_CHECKING:
    from rigtri.report import Report

Step = Callable[[Any, "Report"], Any]


def edit_command(
    name: str,
    declared: type,
    summary: Callable[[Report], str],
    words: str,
    *,
    more: Sequence[click.Option] = (),
    besides: Callable[[dict[str, Any], Report], None] = lambda values, report: None,
    cls: type[click.Command] = click.Command,
) -> click.Command:
    """The command of an operation.

    declared: the dataclass of its options. summary: what was done, in a line or a few. words: the help, with
    an example. more: options that only this command has. besides: writes what it writes besides OUT.
    """

    @click.pass_context
    def run(ctx: click.Context, /, **values: Any) -> None:
        copy_ahead(ctx, values)
        step = step_of(name, declared, values)
        run_edit(name, values, step, given_options(ctx), summary, lambda report: besides(values, report))

    run = output_options(edit_options(reading_options(run)))
    for option in reversed(more):
        _add(run, option)
    run = declared_options(declared)(run)
    return click.command(name, cls=cls, help=words)(source_argument(target_option(run)))


def declared_options(declared: type) -> Callable[[Any], Any]:
    """A decorator with the options that an operation declares."""

    def decorated(command: Any) -> Any:
        for option in reversed(click_options(declared)):
            _add(command, option)
        return command

    return decorated


def step_of(name: str, declared: type, values: dict[str, Any]) -> Step:
    """What the user asks of an operation, as `rigtri.edit` does it. UsageError for what cannot be."""
    from rigtri.pipeline.steps import applied

    options: Any = made(declared, values, given(click.get_current_context()))
    return applied(name, options, read_options(values))


def _add(command: Any, option: click.Parameter) -> None:
    """As the decorators of click add an option: in front of those that are there."""
    command.__click_params__ = [*getattr(command, "__click_params__", []), option]
