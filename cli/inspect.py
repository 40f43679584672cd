"""rigtri inspect"""

from __future__ import annotations

import json
from typing import Any

import click

from .options import (
    json_option,
    read_options,
    reading_options,
    source_argument,
    tell_root,
)
from .words import plain


@click.command("inspect")
@source_argument
@reading_options
@click.option("-q", "--quiet", is_flag=True, help="Leave out the warnings.")
@json_option
def command(source: str, **values: Any) -> None:
    """Show the joints of a file: axes, lengths, bends, skins, clips, warnings.

    Every joint is shown with the names by which other commands find it.

    \b
    Example:
        rigtri inspect hero.glb
    """
    from rigtri.descriptions import as_json, describe
    from rigtri.formats import read
    from rigtri.inputs import opened

    with opened(source) as path:
        document = read(path, read_options(values))
        rig = document.rig
        if values["as_json"]:
            warnings = [{"code": n.code, "text": n.text} for n in document.warnings]
            found = {"file": source} | as_json(rig) | {"warnings": warnings}
            click.echo(json.dumps(found, indent=2, ensure_ascii=False))
            return
        click.echo(plain(describe(rig)))
        if not values["quiet"]:
            tell_root(source, values["root"])
            for notice in document.warnings:
                click.echo(f"warning: {plain(notice.text, one_line=True)}", err=True)
