"""What commands share that write one file beside IN: a picture, a page, a script or a spec."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import click

from rigtri.errors import UsageError
from rigtri.report import Report

from .given_options import check_streams
from .printing import print_warnings
from .terminal_text import plain


def check_output(output: str, sources: Sequence[str], values: dict[str, Any]) -> None:
    """UsageError, before anything is read, where a file that is there, or is shown, would be lost."""
    from rigtri.files.atomic_write import same_file
    from rigtri.files.staged_output import destination

    check_streams(*sources)
    if output == "-":
        if values["as_json"]:
            raise UsageError("--json and -o - both use standard output; give OUT a name")
        return
    path = Path(output)
    for source in sources:
        if source != "-" and same_file(path, Path(source)):
            raise UsageError(f"{path} is an input and would be overwritten. Give another name")
    if destination(path).exists() and not values["overwrite"]:
        raise UsageError(f"{path} exists; it is replaced only with --overwrite")


def check_picture(output: str, sources: Sequence[str], values: dict[str, Any]) -> None:
    """As `check_output`, also for a picture of another format."""
    suffix = Path(output).suffix.lower()
    if output != "-" and suffix not in (".svg", ".png"):
        raise UsageError(f"{output} is not a valid picture name: use the suffix .svg or .png")
    check_output(output, sources, values)
    if suffix == ".png":
        from rigtri.export.drawing.png import check_installed

        check_installed()


def check_needed(output: str | None, needed: Iterable[tuple[Path, str]]) -> None:
    """UsageError where OUT is a file that what was read refers to, such as an image of the same name."""
    from rigtri.files.staged_output import check_not_an_input

    if output not in (None, "-"):
        check_not_an_input(Path(output), list(needed))


def write_output(content: bytes | str, output: str) -> None:
    """Write a file, or to standard output; text in UTF-8."""
    from rigtri.files.staged_output import encoded, write_bytes

    content = encoded(content) if isinstance(content, str) else content
    if output == "-":
        sys.stdout.buffer.write(content)
        sys.stdout.buffer.flush()
    else:
        write_bytes(Path(output), content)


def write_picture(svg: str, output: str) -> None:
    """Write a picture in the format that its name says, or SVG to standard output."""
    write_output(picture_bytes(svg, output), output)


def picture_bytes(svg: str, output: str) -> bytes:
    """A picture in the format that a name says, SVG for standard output."""
    from rigtri.files.staged_output import encoded

    if Path(output).suffix.lower() == ".png":
        from rigtri.export.drawing.png import png

        return png(svg)
    return encoded(svg)


def print_result(report: Report, output: str, values: dict[str, Any]) -> None:
    """The warnings, and where the file is."""
    if values["quiet"]:
        return
    print_warnings(report.warnings, verbose=True)
    if output != "-":
        click.echo(f"Wrote {plain(output, one_line=True)}", err=True)
