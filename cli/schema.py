"""rigtri schema

NAME is spec unless given; others are batch, batch-report, check, diff, draw, error, explain,
export-blender, frames, inspect, mirror, node, pose, recognise, report, rig, steps, verify and view.

\b
Examples:
    rigtri schema > spec.schema.json
    rigtri schema report
"""

from __future__ import annotations

import json
import re
from difflib import get_close_matches
from importlib.resources import files
from typing import Any

import click

from rigtri.errors import UsageError

from .help_format import Command
from .shared_options import json_option

_SUFFIX = ".schema.json"
_REFERENCE = re.compile(r'"\$ref": *"urn:rigtri:schema:([a-z-]+):1[#"]')


def _known() -> list[str]:
    folder = files("rigtri.schemas")
    return sorted(one.name.removesuffix(_SUFFIX) for one in folder.iterdir() if one.name.endswith(_SUFFIX))


def _beginning(start: str) -> list[str]:
    """For shells that complete."""
    return [name for name in _known() if name.startswith(start)]


@click.command("schema", cls=Command, help=__doc__)
@click.argument("name", default="spec", shell_complete=lambda _, __, start: _beginning(start))
@json_option
def command(name: str, as_json: bool) -> None:
    known, name = _known(), name.lower()
    if name not in known:
        meant = "".join(f"did you mean '{close}'? " for close in get_close_matches(name, known, n=1))
        raise UsageError(f"'{name}' is not a valid schema: {meant}use {', '.join(known)}")
    click.echo(_whole(name), nl=False)


def _whole(name: str) -> str:
    """A schema as it is; with those that it refers to in it, so that validators need no others."""
    text = _text(name)
    waiting, needed = set(_REFERENCE.findall(text)), set()
    while waiting:
        other = waiting.pop()
        needed.add(other)
        waiting |= set(_REFERENCE.findall(_text(other))) - needed - {name}
    if not needed:
        return text
    schema: dict[str, Any] = json.loads(text)
    for other in sorted(needed):
        inner = json.loads(_text(other))
        schema.setdefault("$defs", {})[inner["$id"]] = inner
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"


def _text(name: str) -> str:
    return (files("rigtri.schemas") / f"{name}{_SUFFIX}").read_text(encoding="utf-8")
