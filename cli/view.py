"""rigtri view"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rigtri.errors import UsageError

from . import pictures
from .options import (
    json_option,
    output_option,
    overwrite_option,
    quiet_option,
    reading_options,
    source_argument,
)
from .parameters import check_streams, read_options
from .text import plain
from .values import Number

if TYPE_CHECKING:
    from rigtri.export.viewer.page import Shown
    from rigtri.report import Report


@click.command("view")
@source_argument
@output_option(
    "The page to write; - for standard output.",
    "OUT.html",
    required=True,
)
@click.option(
    "--against",
    metavar="BEFORE",
    type=click.Path(allow_dash=True),
    help="The file before: the page shows either, or both, and the distance of their vertices.",
)
@click.option("--clip", metavar="CLIP", help="Start with this clip, playing. [the rest pose]")
@click.option(
    "--pose",
    metavar="CLIP@TIME",
    help="Start paused at this moment, in seconds (USD: time codes).",
)
@click.option(
    "--limit",
    type=Number(min=0, min_open=True),
    default=100.0,
    show_default=True,
    metavar="MB",
    help="Refuse files that are larger than this, all together.",
)
@click.option("--open", "opens", is_flag=True, help="Open the page in the browser.")
@reading_options
@overwrite_option("the page")
@quiet_option
@json_option
def command(source: str, target: str, **values: Any) -> None:
    """Write a page that shows a character: skinned, textured, moving, with its rig.

    Joints with their axes, limb triangles with their projection, pole vectors and controls follow every
    clip; with --against, the page shows the character before and after. All is in the one
    file, three.js with it; nothing is fetched.

    \b
    Examples:
        rigtri view hero.glb -o hero.html
        rigtri view out.glb --against hero.glb -o out.html --clip walk
    """
    from rigtri.export.viewer.view import Begin, shown_page
    from rigtri.report import Report

    sources = [source] if values["against"] is None else [source, values["against"]]
    _check(sources, target, values)
    report = Report()
    text, shown = shown_page(
        sources,
        begin=Begin(values["clip"], values["pose"]),
        limit=values["limit"],
        options=read_options(values),
        report=report,
    )
    content = text.encode("utf-8", "backslashreplace")
    _deliver(content, target)
    if values["as_json"]:
        click.echo(json.dumps(_as_json(shown, target, len(content), report), indent=2, ensure_ascii=False))
    pictures.print_result(report, target, values)
    if values["opens"] and click.launch(Path(target).resolve().as_uri()) != 0:
        message = (
            f"no browser could be started; install one (such as chromium), or open {plain(target)} elsewhere"
        )
        click.echo(f"warning: {message}", err=True)


def _check(sources: list[str], target: str, values: dict[str, Any]) -> None:
    """UsageError, before anything is read, for what cannot be written or contradicts itself."""
    if len(sources) > 1:
        check_streams(*sources)
    if target == "-":
        if values["opens"] or values["as_json"]:
            raise UsageError("--open and --json need a page in a file; give OUT a name")
    elif Path(target).suffix.lower() not in (".html", ".htm"):
        raise UsageError(f"{target} is not a valid page name: use the suffix .html")
    else:
        pictures.check_place(target, sources, overwrite=values["overwrite"])


def _deliver(text: bytes, target: str) -> None:
    from rigtri.files.staged_output import write_bytes

    if target == "-":
        sys.stdout.buffer.write(text)
        sys.stdout.buffer.flush()
    else:
        write_bytes(Path(target), text)


def _as_json(shown: list[Shown], target: str, size: int, report: Report) -> dict[str, Any]:
    """What was written, for machines."""
    sides = [{"file": one.name, "joints": sum(node["joint"] for node in one.facts["nodes"])} for one in shown]
    warnings = [notice.as_json() for notice in report.warnings]
    return {"page": target, "bytes": size, "sides": sides, "warnings": warnings}
