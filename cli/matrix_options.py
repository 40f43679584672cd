"""Options and output of commands that print matrices: inspect and pose."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

import click

from rigtri.errors import UsageError
from rigtri.model.options import made, options_of
from rigtri.operations.options.matrix_table import MatrixTableOptions

from .given_options import given
from .help_format import option
from .operation_options import click_option
from .shared_options import add_option

F = TypeVar("F", bound=Callable[..., Any])

_FOR_MATRICES = {"rotate_order": "--rotate-order", "joint_orient": "--joint-orient"}


def of_matrices(*names: str) -> Callable[[F], F]:
    """Options that mean something beside --matrices alone."""

    def added(command: F) -> F:
        for one in (options_of(MatrixTableOptions)[name] for name in names):
            words = f"With --matrices: {one.help[0].lower()}{one.help[1:]}"
            add_option(command, click_option(replace(one, help=words)))
        return command

    return added


def matrix_options(command: F) -> F:
    """Whether matrices are printed, and as which numbers."""
    flag: Callable[[F], F] = option(
        "--matrices",
        is_flag=True,
        group="what",
        help="Print local, world and inverse bind matrices (row vectors), with translate, rotate, "
        "joint orient and scale.",
    )
    return flag(of_matrices("joint_orient", "rotate_order")(command))


def chosen_matrices(values: dict[str, Any]) -> MatrixTableOptions:
    """Which matrices are requested."""
    return made(MatrixTableOptions, values, given(click.get_current_context()))


def refuse_without_matrices(more: dict[str, str] | None = None) -> None:
    """UsageError for options that go with --matrices alone; more: by their names."""
    named = given(click.get_current_context())
    for name, flag in (_FOR_MATRICES | (more or {})).items():
        if name in named:
            raise UsageError(f"{flag} goes with --matrices")
