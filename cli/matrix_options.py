"""Options and output of commands that print matrices: inspect and pose."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar, get_args

import click

from rigtri.errors import UsageError
from rigtri.maths import RotateOrder
from rigtri.operations.options.constrain import joint_orient

from .help_format import option
from .option_types import Parsed
from .parameters import given

if TYPE_CHECKING:
    from rigtri.export.matrix_table import MatrixOptions

F = TypeVar("F", bound=Callable[..., Any])

_FOR_MATRICES = {"rotate_order": "--rotate-order", "joint_orient": "--joint-orient"}


def matrix_options(command: F) -> F:
    """Whether matrices are printed, and as which numbers."""
    for add in (
        option(
            "--joint-orient",
            metavar="rest|none|X,Y,Z",
            type=Parsed(joint_orient),
            default="rest",
            show_default=True,
            help="With --matrices: the joint orient of joints, as Maya has it: their rotation at rest, none, "
            "or degrees.",
            rare=True,
        ),
        option(
            "--rotate-order",
            type=click.Choice(get_args(RotateOrder)),
            default="xyz",
            show_default=True,
            help="With --matrices: the order of the Euler angles.",
            rare=True,
        ),
        option(
            "--matrices",
            is_flag=True,
            group="what",
            help="Print local, world and inverse bind matrices (row vectors), with translate, rotate, "
            "joint orient and scale.",
        ),
    ):
        command = add(command)
    return command


def chosen_matrices(values: dict[str, Any], **more: Any) -> MatrixOptions:
    """Which matrices are requested; UsageError where none are."""
    from rigtri.export.matrix_table import MatrixOptions

    same = {"joint_orient": values["joint_orient"], "order": values["rotate_order"]}
    return MatrixOptions(**same, **more)


def refuse_without_matrices(more: dict[str, str] | None = None) -> None:
    """UsageError for options that go with --matrices alone; more: by their names."""
    named = given(click.get_current_context())
    for name, flag in (_FOR_MATRICES | (more or {})).items():
        if name in named:
            raise UsageError(f"{flag} goes with --matrices")
