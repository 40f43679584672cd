"""rigtri view

Joints with their axes, limb triangles with their projection, pole vectors and controls follow every clip;
with --against, the page shows the character before and after. The page is one file, three.js included,
and fetches nothing.

\b
Examples:
    rigtri view hero.glb -o hero.html
    rigtri view out.glb --against hero.glb -o out.html --clip walk
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rigtri.errors import UsageError
from rigtri.operations.option_kinds import MOMENT
from rigtri.report import Report

from . import output_file
from .given_options import read_options
from .help_format import Command, option
from .option_types import FilePath, Number
from .printing import print_json
from .progress import Progress
from .shared_options import (
    json_option,
    output_option,
    quiet_option,
    reading_options,
    shared,
    source_argument,
)
from .terminal_text import echo_message, plain

if TYPE_CHECKING:
    from rigtri.export.viewer.view import Shown


@click.command("view", cls=Command, help=__doc__)
@source_argument
@output_option(
    "The page to write; - for standard output.",
    "OUT.html",
    required=True,
)
@option(
    "--against",
    metavar="BEFORE",
    type=FilePath(allow_dash=True),
    help="The file before the edit: the page shows either or both, and how far their vertices are apart.",
    group="what",
)
@option("--clip", metavar="CLIP", help="Start with this clip, playing. [the rest pose]", group="what")
@option(
    "--at",
    metavar="CLIP@TIME|rest",
    help=f"Start paused. {MOMENT}",
    group="what",
)
@option(
    "--limit",
    type=Number(min=0, min_open=True),
    default=100.0,
    show_default=True,
    metavar="MB",
    help="Refuse files that are larger than this together.",
    group="safety",
    rare=True,
)
@option("--open", "opens", is_flag=True, help="Open the page in the browser.", group="output")
@reading_options
@shared("overwrite")
@quiet_option
@json_option
def command(source: str, output: str, **values: Any) -> None:
    from rigtri.export.viewer.view import Begin, shown_page

    sources = [source] if values["against"] is None else [source, values["against"]]
    if output != "-" and Path(output).suffix.lower() not in (".html", ".htm"):
        raise UsageError(f"{output} is not a valid page name: use the suffix .html")
    if output == "-" and values["opens"]:
        raise UsageError("--open needs a page in a file; give OUT a name")
    output_file.check_output(output, sources, values)
    report = Report()
    with Progress(source, quiet=values["quiet"] or values["as_json"]):
        text, shown = shown_page(
            sources,
            begin=Begin(values["clip"], values["at"]),
            limit=values["limit"],
            options=read_options(values),
            report=report,
        )
    output_file.check_needed(output, report.sources)
    content = text.encode("utf-8", "backslashreplace")
    output_file.write_output(content, output)
    if values["as_json"]:
        print_json(_as_json(shown, output, len(content), report))
    output_file.print_result(report, output, values)
    if values["opens"] and click.launch(Path(output).resolve().as_uri()) != 0:
        message = (
            f"no browser could be started; install one (such as chromium), or open {plain(output)} elsewhere"
        )
        echo_message(f"warning: {message}")


def _as_json(shown: list[Shown], output: str, size: int, report: Report) -> dict[str, Any]:
    """What was written, for machines."""
    sides = [{"file": one.name, "joints": sum(node["joint"] for node in one.facts["nodes"])} for one in shown]
    warnings = [notice.as_json() for notice in report.warnings]
    return {"page": output, "bytes": size, "sides": sides, "warnings": warnings}
