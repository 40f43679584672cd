"""What commands that draw share: where the picture goes, and how large it is."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rigtri.errors import UsageError

from .printing import print_warnings
from .text import plain

if TYPE_CHECKING:
    from rigtri.report import Report

SUFFIXES = (".svg", ".png")

view_option = click.option(
    "--view",
    metavar="front|back|side|top|three-quarter|X,Y,Z",
    help="View direction; front looks at the character's face, side at its left. [three-quarter]",
)


def size(ctx: click.Context, param: click.Parameter, value: str | None) -> tuple[int, int] | None:
    """WIDTHxHEIGHT in pixels."""
    if value is None:
        return None
    wide, mark, high = value.lower().partition("x")
    if not (mark and wide.isdecimal() and high.isdecimal() and len(value) <= 20):
        raise click.BadParameter(
            f"'{value}' is not a valid size: use WIDTHxHEIGHT in pixels, e.g. 1200x900", ctx, param
        )
    return int(wide), int(high)


def check_target(target: str, sources: list[str], *, overwrite: bool) -> None:
    """UsageError, before anything is read, for a picture that cannot be written to ``target``."""
    if target == "-":
        return
    path = Path(target)
    if path.suffix.lower() not in SUFFIXES:
        raise UsageError(f"{path} is not a valid picture name: use the suffix .svg or .png")
    check_place(target, sources, overwrite=overwrite)
    if path.suffix.lower() == ".png":
        from rigtri.export.drawing.png import check_installed

        check_installed()


def check_place(target: str, sources: list[str], *, overwrite: bool) -> None:
    """UsageError where a file that is there, or one that is shown, would be lost."""
    from rigtri.files.atomic_write import same_file
    from rigtri.files.staged_output import destination

    path = Path(target)
    for source in sources:
        if source != "-" and same_file(path, Path(source)):
            raise UsageError(f"{path} is an input and would be overwritten. Give another name")
    if destination(path).exists() and not overwrite:
        raise UsageError(f"{path} exists; it is replaced only with --overwrite")


def deliver(svg: str, target: str, report: Report) -> None:
    """Write a picture in the format that its name says, or SVG to standard output."""
    from rigtri.files.staged_output import write_bytes

    if target == "-":
        sys.stdout.buffer.write(svg.encode("utf-8"))
        sys.stdout.buffer.flush()
        return
    path = Path(target)
    if path.suffix.lower() == ".png":
        from rigtri.export.drawing.png import png

        write_bytes(path, png(svg, report))
    else:
        write_bytes(path, svg.encode("utf-8"))


def print_result(report: Report, target: str, values: dict[str, Any]) -> None:
    """The warnings, and where the picture is."""
    if values["quiet"]:
        return
    print_warnings(report.warnings, verbose=True)
    if target != "-":
        click.echo(f"Wrote {plain(target, one_line=True)}", err=True)
