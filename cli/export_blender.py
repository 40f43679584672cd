"""rigtri export-blender"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from rigtri.errors import UsageError

from .options import (
    json_option,
    output_option,
    overwrite_option,
    quiet_option,
    reading_options,
    source_argument,
)
from .parameters import read_options
from .printing import print_warnings


@click.command("export-blender")
@source_argument
@output_option(
    "The script to write; - for standard output.",
    "SETUP.py",
    required=True,
    type=click.Path(allow_dash=True, dir_okay=False),
)
@overwrite_option()
@reading_options
@quiet_option
@json_option
def command(source: str, target: str, overwrite: bool, quiet: bool, as_json: bool, **values: Any) -> None:
    """Write a script that sets controls, IK and constraints up in Blender.

    Import IN in Blender and run the script there (Text Editor, Run Script), or let the script import
    IN: blender --python SETUP.py. Bones follow controls by Blender's own constraints; nothing moves at rest.
    docs/blender.md says what becomes of what, and of the way back.

    \b
    Example:
        rigtri add-controls hero.glb -o rigged.glb --whole-character
        rigtri export-blender rigged.glb -o setup.py
    """
    from rigtri.export.blender.export import setup_for
    from rigtri.files.staged_output import write_text
    from rigtri.report import Report

    path = Path(target)
    if target == "-" and as_json:
        raise UsageError("--json and -o - are both for standard output: give -o a file")
    if target != "-" and path.exists() and not overwrite:
        raise UsageError(f"{target} exists; it is replaced only with --overwrite")
    report = Report()
    made = setup_for(source, read_options(values), report)
    if not quiet:
        print_warnings(report.warnings)
    if target == "-":
        click.echo(made.script, nl=False)
        return
    write_text(path, made.script)
    result = {
        "file": source,
        "script": target,
        "nodes": len(made.plan["nodes"]),
        "constraints": len(made.plan["constraints"]),
        "limbs": len(made.plan["limbs"]),
        "warnings": [notice.as_json() for notice in report.warnings],
    }
    if as_json:
        click.echo(json.dumps(result, indent=2, ensure_ascii=False))
    elif not quiet:
        click.echo(f"{result['constraints']} constraints, {result['limbs']} limbs with IK", err=True)
        click.echo(f"Wrote {target}", err=True)
