"""rigtri batch-report

MANIFEST is a file or the folder that holds it, with the manifests of all parts. It also lists files that
have one skeleton but different axes, and so cannot share clips.

\b
Example:
    rigtri batch-report out/
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

from .help_format import Command, option
from .option_types import FilePath, Integer, Tolerance
from .printing import print_json
from .shared_options import json_option
from .terminal_text import counted, plain


@click.command("batch-report", cls=Command, help=__doc__)
@click.argument("manifests", metavar="MANIFEST…", nargs=-1, required=True, type=FilePath())
@option(
    "--most",
    type=Integer(1),
    default=10,
    show_default=True,
    help="How many of each kind are listed.",
    group="output",
)
@option(
    "--within",
    type=Tolerance(),
    default=0.1,
    show_default=True,
    help="Largest difference between axes of one skeleton, in degrees.",
)
@json_option
def command(manifests: tuple[str, ...], most: int, within: float, as_json: bool) -> None:
    from rigtri._version import __version__
    from rigtri.pipeline.batch.report import summarise

    found = summarise([Path(name) for name in manifests], most=most, within=within)
    if as_json:
        document = {"rigtri": __version__, "command": "batch-report"} | found
        print_json(document)
        return
    for line in _lines(found):
        click.echo(plain(line, one_line=True))


def _lines(found: dict[str, Any]) -> Iterator[str]:
    counts = [f"{count} {status}" for status, count in found["statuses"].items() if count]
    done = ", ".join(counts) or "none done"
    yield f"{counted(found['files'], 'file')}: {done}; {found['seconds']:.1f} s of work"
    if found["unfinished"]:
        yield f"{counted(found['unfinished'], 'file')} under way, or left by a run that was killed"
    yield from _table(
        "largest vertex movements (of the model's size)",
        [(f"{row['deviation']:.2e}", row["file"]) for row in found["worst"]],
    )
    yield from _table(
        "slowest (seconds)", [(f"{row['seconds']:.2f}", row["file"]) for row in found["slowest"]]
    )
    yield from _table(
        "errors", [(row["files"], row["kind"], row["reason"], row["example"]) for row in found["errors"]]
    )
    yield from _table(
        f"missing in files (of {found['files']})",
        [(row["files"], row["what"], row["example"]) for row in found["missing"]],
    )
    warned = [(row["files"], row["code"], f"e.g. {row['example']}") for row in found["warnings"]]
    yield from _table("warnings", warned)
    yield from _axes(found["axes"])


def _table(title: str, rows: list[tuple[Any, ...]]) -> Iterator[str]:
    """A title and its rows, first column to the right; nothing where there are none."""
    if not rows:
        return
    texts = [[str(cell).replace("\n", " ") for cell in row] for row in rows]
    widths = [max(len(row[k]) for row in texts) for k in range(len(texts[0]))]
    yield ""
    yield title
    for row in texts:
        first = row[0].rjust(widths[0])
        rest = [cell.ljust(width) for cell, width in zip(row[1:], widths[1:], strict=True)]
        yield "  ".join(["", first, *rest]).rstrip()


def _axes(skeletons: list[dict[str, Any]]) -> Iterator[str]:
    for item in skeletons:
        rows = []
        for group in item["groups"]:
            if group["joint"] is None:
                rows.append((group["files"], "the axes of most", group["example"]))
            else:
                more = f" and {counted(group['others'], 'joint')} more" if group["others"] else ""
                words = f"{group['joint']} {group['degrees']:.1f}° off{more}"
                rows.append((group["files"], words, group["example"]))
        if item["more"]:
            rows.append((item["more"], "more kinds of axes", ""))
        title = f"one skeleton of {counted(item['joints'], 'joint')}, different axes ({item['files']} files)"
        yield from _table(title, rows)
