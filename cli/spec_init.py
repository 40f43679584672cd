"""rigtri spec-init"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from rigtri.errors import UsageError

from .options import json_option, output_option, overwrite_option, reading_options, source_argument
from .parameters import read_options
from .text import plain


@click.command("spec-init")
@source_argument
@output_option(
    "Where to write the spec; - for standard output.",
    "FILE.yaml",
    default="-",
    show_default=True,
    type=click.Path(allow_dash=True, dir_okay=False),
)
@overwrite_option("FILE.yaml")
@reading_options
@json_option
def command(source: str, target: str, overwrite: bool, as_json: bool, **values: Any) -> None:
    """Write a rig spec to start from: steps for the joints that a character has.

    Limbs that rigtri recognises get twist joints, controls and pole vectors; all joints stand in
    it as a comment. --json prints the spec as JSON, which `rigtri build` reads as well;
    FILE.json gets it so.

    \b
    Example:
        rigtri spec-init hero.glb -o rig.yaml
        rigtri build hero.glb --spec rig.yaml -o out.glb
    """
    from rigtri.files.staged_output import write_text
    from rigtri.pipeline.rigspec.load import need_extra
    from rigtri.pipeline.rigspec.spec_init import plain_values, spec_init

    need_extra()
    path = Path(target)
    if target != "-" and path.suffix.lower() not in (".yaml", ".yml", ".json"):
        raise UsageError(f"{target}: the spec is YAML or JSON; give it the suffix .yaml or .json")
    if target != "-" and path.exists() and not overwrite:
        raise UsageError(f"{target} exists; it is replaced only with --overwrite")
    text = spec_init(source, options=read_options(values))
    in_json = json.dumps(plain_values(text), indent=2, ensure_ascii=False)
    if as_json:
        click.echo(in_json)
    elif target == "-":
        click.echo(plain(text), nl=False)
    if target == "-":
        return
    write_text(path, in_json + "\n" if path.suffix.lower() == ".json" else text)
    click.echo(f"Wrote {target}", err=True)
