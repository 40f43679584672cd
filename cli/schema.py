"""rigtri schema"""

from __future__ import annotations

from importlib.resources import files

import click

from rigtri.errors import UsageError

from .options import json_option

_SUFFIX = ".schema.json"


@click.command("schema")
@click.argument("name", default="spec")
@json_option
def command(name: str, as_json: bool) -> None:
    """Print a JSON Schema: of rig specs, or of what rigtri writes.

    NAME is spec unless given; others are batch, batch-report, check, diff, error, frames, mirror, node,
    pose, report and rig.

    \b
    Examples:
        rigtri schema > spec.schema.json
        rigtri schema report
    """
    folder = files("rigtri.schemas")
    known = sorted(one.name.removesuffix(_SUFFIX) for one in folder.iterdir() if one.name.endswith(_SUFFIX))
    if name not in known:
        raise UsageError(f"there is no schema '{name}'; choose of {', '.join(known)}")
    click.echo((folder / f"{name}{_SUFFIX}").read_text(encoding="utf-8"), nl=False)
