"""rigtri strip"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from .asked import given_options, request
from .editing import copy_ahead, run_edit
from .options import edit_options, output_options, reading_options, source_argument, target_option

if TYPE_CHECKING:
    from rigtri.report import Report


@click.command("strip")
@source_argument
@target_option
@click.option(
    "--splits",
    is_flag=True,
    help="Also forget which nodes hold the axes of split joints; they stay, as nodes like others.",
)
@reading_options
@edit_options
@output_options
@click.pass_context
def command(ctx: click.Context, /, **values: Any) -> None:
    """Take out again what rigtri has put into IN: controls, locators, shapes and notes.

    The axes of joints stay as orient-joints has set them. All that stays is proven to look as before.

    \b
    Example:
        rigtri strip rigged.glb -o plain.glb
    """
    copy_ahead(ctx, values)
    from rigtri.pipeline.steps.strip import step

    run_edit("strip", values, step(request(values)), given_options(ctx), summary)


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    nodes = sum(not entry["kept"] for entry in report.removed)
    notes = len(report.removed) - nodes
    if not report.removed:
        return "Nothing here is rigtri's"
    return f"Taken out: {nodes} nodes, and notes on {notes} others"
