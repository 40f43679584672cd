"""rigtri inspect

Every joint is shown with the names by which other commands find it, and with arrows for its axes, in
colour on a terminal (NO_COLOR and FORCE_COLOR decide it). Narrow terminals show fewer columns.

\b
Examples:
    rigtri inspect hero.glb
    rigtri inspect hero.glb --matrices --joints '*_L' --at walk@0.5 --rotate-order zyx
"""

from __future__ import annotations

import re
import shutil
import sys
from typing import TYPE_CHECKING, Any

import click

from rigtri.report import Notice, Report

from .given_options import read_options
from .help_format import Command
from .matrix_options import chosen_matrices, matrix_options, of_matrices, refuse_without_matrices
from .printing import print_json, print_warnings, warn_unused_root
from .shared_options import json_option, quiet_option, reading_options, source_argument
from .terminal_text import colored, plain

if TYPE_CHECKING:
    from rigtri.model.rig import Rig

_COLORS = {"x": "red", "y": "green", "z": "blue"}
# The arrows of a joint's axes, such as x→y↑z⊙.
_ARROWS = re.compile("(?<=  )x[{0}]y[{0}]z[{0}](?= |$)".format("→↗↑↖←↙↓↘⊙⊗·"), re.M)


@click.command("inspect", cls=Command, help=__doc__)
@source_argument
@matrix_options
@of_matrices("joints", "at")
@reading_options
@quiet_option
@json_option
def command(source: str, **values: Any) -> None:
    from rigtri.export.matrix_table import matrix_text
    from rigtri.export.text_description import as_json, describe
    from rigtri.files.input_stream import opened
    from rigtri.formats import read

    with opened(source) as path:
        document = read(path, read_options(values))
        rig = document.rig
        notices = list(document.warnings)
        table = _matrices(rig, values, notices)
        if values["as_json"]:
            more = {} if table is None else {"at": values["at"], "matrices": table}
            warnings = [notice.as_json() for notice in notices]
            print_json({"file": source} | as_json(rig) | more | {"warnings": warnings})
            return
        if values["quiet"]:
            return
        width = shutil.get_terminal_size().columns if sys.stdout.isatty() else None
        _print(plain(describe(rig, width=width) if table is None else matrix_text(table)))
        warn_unused_root(source, values["root"])
        print_warnings(notices, verbose=True)


def _matrices(rig: Rig, values: dict[str, Any], notices: list[Notice]) -> list[dict[str, Any]] | None:
    """The matrices that are requested; None where the joints are."""
    if not values["matrices"]:
        refuse_without_matrices({"joints": "--joints", "at": "--at"})
        return None
    from rigtri.export.matrix_table import matrix_table

    report = Report()
    table = matrix_table(rig, options=chosen_matrices(values), report=report)
    notices += report.warnings
    return table


def _print(text: str) -> None:
    """Print the description; the arrows in the colours of their axes where the terminal may have colours."""
    if not colored(sys.stdout):
        click.echo(text, color=False)
        return

    def painted(found: re.Match[str]) -> str:
        word = found.group()
        return "".join(click.style(word[k : k + 2], fg=_COLORS[word[k]]) for k in (0, 2, 4))

    click.echo(_ARROWS.sub(painted, text), color=True)
