"""rigtri inspect"""

from __future__ import annotations

import re
import shutil
import sys
from typing import Any

import click

from .help_format import Command
from .options import json_option, no_warnings_option, reading_options, source_argument
from .parameters import read_options
from .printing import print_json, print_warnings, warn_unused_root
from .text import colored, plain

_COLORS = {"x": "red", "y": "green", "z": "blue"}
# The arrows of a joint's axes, such as x→y↑z⊙.
_ARROWS = re.compile("(?<=  )x[{0}]y[{0}]z[{0}](?= |$)".format("→↗↑↖←↙↓↘⊙⊗·"), re.M)


@click.command("inspect", cls=Command)
@source_argument
@reading_options
@no_warnings_option
@json_option
def command(source: str, **values: Any) -> None:
    """Show the joints of a file: axes, lengths, bends, skins, clips, warnings.

    Every joint is shown with the names by which other commands find it, and with arrows for its axes, in
    colour on a terminal (NO_COLOR and FORCE_COLOR decide it). Narrow terminals have fewer columns.

    \b
    Example:
        rigtri inspect hero.glb
    """
    from rigtri.export.text_description import as_json, describe
    from rigtri.files.input_stream import opened
    from rigtri.formats import read

    with opened(source) as path:
        document = read(path, read_options(values))
        rig = document.rig
        if values["as_json"]:
            warnings = [notice.as_json() for notice in document.warnings]
            found = {"file": source} | as_json(rig) | {"warnings": warnings}
            print_json(found)
            return
        width = shutil.get_terminal_size().columns if sys.stdout.isatty() else None
        _print(plain(describe(rig, width=width)))
        if not values["quiet"]:
            warn_unused_root(source, values["root"])
            print_warnings(document.warnings, verbose=True)


def _print(text: str) -> None:
    """Print the description; the arrows in the colours of their axes where the terminal may have colours."""
    if not colored(sys.stdout):
        click.echo(text, color=False)
        return

    def painted(found: re.Match[str]) -> str:
        word = found.group()
        return "".join(click.style(word[k : k + 2], fg=_COLORS[word[k]]) for k in (0, 2, 4))

    click.echo(_ARROWS.sub(painted, text), color=True)
