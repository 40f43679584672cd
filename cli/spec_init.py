"""rigtri spec-init

Limbs that rigtri recognises get twist joints, controls and pole vectors; a comment lists all joints.
--json prints the spec as JSON, which `rigtri build` reads as well; FILE.json is written as JSON.

\b
Example:
    rigtri spec-init hero.glb -o rig.yaml
    rigtri build hero.glb --spec rig.yaml -o out.glb
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from rigtri.errors import UsageError

from . import output_file
from .given_options import read_options
from .help_format import Command
from .option_types import FilePath
from .shared_options import json_option, output_option, quiet_option, reading_options, shared, source_argument
from .terminal_text import plain


@click.command("spec-init", cls=Command, help=__doc__)
@source_argument
@output_option(
    "Where to write the spec; - for standard output.",
    "FILE.yaml",
    default="-",
    show_default=True,
    type=FilePath(allow_dash=True, dir_okay=False),
)
@shared("overwrite")
@reading_options
@quiet_option
@json_option
def command(source: str, output: str, **values: Any) -> None:
    from rigtri.pipeline.rigspec.load import need_libraries
    from rigtri.pipeline.rigspec.spec_init import plain_values, spec_init
    from rigtri.report import Report

    need_libraries()
    suffix = Path(output).suffix.lower()
    if output != "-" and suffix not in (".yaml", ".yml", ".json"):
        raise UsageError(f"{output}: the spec is YAML or JSON; give it the suffix .yaml or .json")
    # With --json standard output has the spec, too: in JSON, and once.
    output_file.check_output(output, [source], values | {"as_json": False})
    report = Report()
    text = spec_init(source, options=read_options(values), report=report)
    output_file.check_needed(output, report.sources)
    in_json = json.dumps(plain_values(text), indent=2, ensure_ascii=False)
    if values["as_json"]:
        click.echo(in_json)
    elif output == "-":
        click.echo(plain(text), nl=False)
    if output != "-":
        content = in_json + "\n" if suffix == ".json" else text
        output_file.write_output(content, output)
        if not values["quiet"]:
            click.echo(f"Wrote {plain(output, one_line=True)}", err=True)
