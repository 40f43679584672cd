"""rigtri pose

Each node, including controls and locators, is shown with its translation, rotation (x y z w) and scale
relative to its parent, and its world position; --matrices prints its matrices instead. With -o, bind
poses and clips do not change: meshes show the pose where no clip plays.

\b
Examples:
    rigtri pose rigged.glb --at walk@0.5
    rigtri pose rigged.glb --at walk@0.5 --json
    rigtri pose rigged.glb --at walk@0.5 --joints 'arm*' --matrices
    rigtri pose rigged.glb -o stand.glb --at idle@0
"""

from __future__ import annotations

from typing import Any

import click

from rigtri.errors import UsageError
from rigtri.model.options import made
from rigtri.operations.options.pose import PoseOptions
from rigtri.report import Report
from rigtri.text import columns

from .edit_command import declared_options, step_of
from .editing import copy_ahead, run_edit
from .given_options import given, given_options, read_options
from .help_format import Command, option
from .matrix_options import chosen_matrices, matrix_options, refuse_without_matrices
from .printing import print_json, print_warnings
from .shared_options import edit_options, output_option, output_options, reading_options, source_argument
from .terminal_text import plain


@click.command("pose", cls=Command, help=__doc__)
@source_argument
@output_option(
    "Write a file whose rest pose is this pose, in the format of IN; - for standard output.",
)
@declared_options(PoseOptions)
@matrix_options
@option("--joints", multiple=True, metavar="GLOB", group="joints", help="Print only these nodes. Repeatable.")
@reading_options
@edit_options
@output_options
@click.pass_context
def command(ctx: click.Context, /, **values: Any) -> None:
    if values["output"] is None:
        _print(values, made(PoseOptions, values, given(ctx)))
        return
    for word in ("matrices", "joints"):
        if values[word]:
            raise UsageError(f"--{word} is for what is printed: leave out -o OUT")
    refuse_without_matrices()
    copy_ahead(ctx, values)
    run_edit("pose", values, step_of("pose", PoseOptions, values), given_options(ctx), summary)


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    (posed,) = (entry for entry in report.added if entry["type"] == "pose")
    return (
        f"{posed['nodes']} nodes rest as in {posed['at']}" if posed["nodes"] else "all nodes rest so already"
    )


def _print(values: dict[str, Any], options: Any) -> None:
    from rigtri.export.matrix_table import matrix_table, matrix_text
    from rigtri.files.input_stream import opened
    from rigtri.formats import read
    from rigtri.operations.pose import table

    if not values["matrices"]:
        refuse_without_matrices()
    for word in ("report_path", "sidecar", "dry_run", "overwrite"):
        if values[word]:
            raise UsageError(f"--{word.removesuffix('_path').replace('_', '-')} is for a file: give -o OUT")
    with opened(values["source"]) as path:
        document = read(path, read_options(values))
        report = Report()
        found = {"file": values["source"]} | table(document.rig, options, report, named=values["joints"])
        if values["matrices"]:
            found["matrices"] = matrix_table(document.rig, options=chosen_matrices(values))
    if not values["quiet"]:
        print_warnings(report.warnings, values["verbose"])
    if values["strict"]:
        report.refuse_warnings()
    if values["as_json"]:
        found["warnings"] = [notice.as_json() for notice in report.warnings]
        print_json(found)
        return
    if values["quiet"]:
        return
    if values["matrices"]:
        click.echo(matrix_text(found["matrices"]))
        return
    rows: list[tuple[str, ...]] = [("node", "translation", "rotation x y z w", "scale", "in the world")]
    rows += [
        (
            plain(joint["joint"], one_line=True),
            *(_numbers(joint[word]) for word in ("translation", "rotation", "scale", "position")),
        )
        for joint in found["joints"]
    ]
    click.echo("\n".join(columns(rows)))


def _numbers(numbers: list[float]) -> str:
    return " ".join(f"{number + 0.0:.5g}" for number in numbers)
