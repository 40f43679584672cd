"""rigtri diff

Rig terms: joints, axes, rest and bind pose, skins, clips, attachments, colliders. File
terms: JSON members, chunks, buffers, images, spelling; layers, prims, fields, package
entries. Exit code 0 when nothing differs, 1 when something does, 2 for an error. Lines
start with + (added), - (removed), ~ (changed) or > (moved).

\b
Example:
    rigtri diff hero.glb out.glb
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any, get_args

import click

from rigtri.verification import Terms

from . import failures, streams
from .given_options import check_streams, read_options
from .help_format import Command, option
from .option_types import FilePath, Tolerance
from .printing import print_json, warn_unused_root
from .progress import Progress
from .shared_options import json_option, quiet_option, reading_options
from .terminal_text import echo, plain

# As of diff and usddiff: 0 nothing differs, 1 something does, 2 an error.
DIFFERS, ERROR = 1, 2
_PAINTS = (
    (r"^  \+ .*", "green"),
    (r"^  - .*", "red"),
    (r"^  ~", "yellow"),
    (r"^  >", "cyan"),
    (r"\d+ differences?$|(?<=movement: )\S+", "yellow"),
)


@click.command("diff", cls=Command, help=__doc__)
@click.argument("before", metavar="A", type=FilePath(allow_dash=True))
@click.argument("after", metavar="B", type=FilePath(allow_dash=True))
@option("--brief", is_flag=True, help="Print only whether they differ.", group="output")
@option("--all", "every", is_flag=True, help="Show every line of long groups.", group="output")
@option(
    "--only",
    type=click.Choice(get_args(Terms)),
    help="Compare only in rig terms, or only in file terms.",
    group="what",
)
@option(
    "--tolerance",
    type=Tolerance(),
    default=0.0,
    show_default=True,
    help="Numbers that differ by at most this are equal; 0 compares every bit and spelling.",
    group="how",
)
@option(
    "--verify/--no-verify",
    default=True,
    show_default=True,
    help="Also measure how much they differ in every pose.",
    group="what",
)
@reading_options
@quiet_option
@json_option
def command(before: str, after: str, **values: Any) -> None:
    with failures.always(click.get_current_context(), ERROR):
        same = _diff(before, after, values)
    sys.exit(DIFFERS if not same else ERROR if streams.lost() else 0)


def _diff(before: str, after: str, values: dict[str, Any]) -> bool:
    """Print what differs; whether nothing does."""
    from rigtri.files.input_stream import opened
    from rigtri.pipeline.files import diff

    check_streams(before, after)
    brief, quiet = values["brief"], values["quiet"]
    bar = Progress(after, quiet=quiet or values["as_json"])
    with opened(before) as one, opened(after) as other, bar:
        found = diff(
            Path(one),
            Path(other),
            only=values["only"],
            tolerance=values["tolerance"],
            verify=values["verify"] and not (brief or quiet),
            options=read_options(values),
        )
    if values["as_json"]:
        result = {"before": before, "after": after, "tolerance": values["tolerance"]} | found.as_json()
        print_json(result)
    elif brief and not (found.same or quiet):
        click.echo(plain(f"{before} and {after} differ", one_line=True))
    elif not (found.same or quiet):
        echo(found.describe(every=values["every"]), _PAINTS)
    if not (brief or quiet):
        warn_unused_root(before, values["root"])
        for notice in found.notices:
            click.echo(plain(notice, one_line=True), err=True)
    return found.same
