"""rigtri export-blender

Import IN in Blender and run the script there (Text Editor, Run Script), or let the script import
IN: blender --python SETUP.py. Bones follow controls by Blender's own constraints; nothing moves at rest.

\b
Example:
    rigtri add-controls hero.glb -o rigged.glb --whole-character
    rigtri export-blender rigged.glb -o setup.py
"""

from __future__ import annotations

from typing import Any

import click

from rigtri.errors import UsageError
from rigtri.report import Report

from . import output_file
from .given_options import read_options
from .help_format import Command
from .option_types import FilePath
from .printing import print_json
from .shared_options import (
    json_option,
    output_option,
    quiet_option,
    reading_options,
    shared,
    source_argument,
)


@click.command("export-blender", cls=Command, help=__doc__)
@source_argument
@output_option(
    "The script to write; - for standard output.",
    "SETUP.py",
    required=True,
    type=FilePath(allow_dash=True, dir_okay=False),
)
@shared("overwrite")
@reading_options
@quiet_option
@json_option
def command(source: str, output: str, **values: Any) -> None:
    from rigtri.export.blender.script import setup_for

    report = Report()
    if output != "-" and not output.lower().endswith(".py"):
        raise UsageError(f"{output} is not a valid script name: use the suffix .py")
    output_file.check_output(output, [source], values)
    made = setup_for(source, read_options(values), report)
    output_file.check_needed(output, report.sources)
    output_file.write_output(made.script, output)
    counts = {name: len(made.plan[name]) for name in ("nodes", "constraints", "limbs")}
    if values["as_json"]:
        warnings = [notice.as_json() for notice in report.warnings]
        print_json({"file": source, "script": output} | counts | {"warnings": warnings})
    elif output != "-" and not values["quiet"]:
        click.echo(f"{counts['constraints']} constraints, {counts['limbs']} limbs with IK", err=True)
    output_file.print_result(report, output, values)
