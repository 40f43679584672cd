"""rigtri convert

Nodes become prims, skins Skeletons, clips SkelAnimations, morph targets BlendShapes, and materials
UsdPreviewSurface. Images are written to a folder beside OUT, or into it (.usdz, .glb). Both files are
skinned at every key and between, and compared before OUT is written. What the other format cannot store is
listed.

\b
Examples:
    rigtri convert hero.glb -o hero.usdz
    rigtri convert hero.vrm -o hero.usda --clip 'walk*' --fps 30
    rigtri convert hero.glb -o hero.usdc --up-axis z --meters-per-unit 0.01
    rigtri convert hero.usdz -o hero.glb
"""

from __future__ import annotations

from typing import Any

import click

from rigtri.model.options import made
from rigtri.operations.options.convert import ConvertOptions
from rigtri.report import Report

from .edit_command import declared_options
from .editing import edit_request, run
from .given_options import given, given_options
from .help_format import Command
from .shared_options import (
    dry_run_option,
    needed_output,
    output_option,
    output_options,
    reading_options,
    report_option,
    shared,
    source_argument,
)
from .terminal_text import counted


@click.command("convert", cls=Command, help=__doc__)
@source_argument
@output_option("The file to write, in the other format. Required unless --dry-run.", callback=needed_output)
@declared_options(ConvertOptions)
@reading_options
@shared("overwrite")
@dry_run_option
@report_option("Write what was done, and what the other format cannot store")
@shared("strict", more="So is what the other format cannot store.")
@shared("verify")
@shared("tolerance")
@output_options
@click.pass_context
def command(ctx: click.Context, /, **values: Any) -> None:
    from rigtri.pipeline.convert import convert_file

    options = made(ConvertOptions, values, given(ctx))
    values["sidecar"] = False
    request = edit_request(values)

    def done(report: Report) -> Any:
        return convert_file(request, options, report)

    run("convert", values, done, given_options(ctx), summary)


def summary(report: Report) -> str:
    """What was done, in a line."""
    lost = sum(notice.code == "lost" for notice in report.warnings)
    return f"converted; the other format cannot store {counted(lost, 'thing')}" if lost else "converted"
