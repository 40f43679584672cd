"""rigtri draw

The axes of a joint are red (x), green (y) and blue (z); a ring points at you, a crossed ring away. Joints
without an axis along their bone are orange. A limb is a teal triangle with the projection of its mid
joint; the purple arrow from there is its bend direction. --json also prints what is drawn: lines, arrows
and triangles in space.

\b
Examples:
    rigtri draw hero.glb -o hero.svg
    rigtri draw out.glb --against hero.glb -o before-after.png
    rigtri draw hero.glb -o hand.svg --below hand_L --view top --at walk@0.5
"""

from __future__ import annotations

from contextlib import ExitStack
from itertools import chain
from typing import Any

import click

from rigtri.model.options import made
from rigtri.operations.options.draw import DrawOptions
from rigtri.report import Report

from . import output_file
from .edit_command import declared_options
from .given_options import given, read_options
from .help_format import Command, option
from .option_types import FilePath
from .printing import print_json
from .shared_options import (
    json_option,
    output_option,
    quiet_option,
    reading_options,
    shared,
    source_argument,
)


@click.command("draw", cls=Command, help=__doc__)
@source_argument
@output_option(
    "The picture to write, .svg or .png (extra rigtri[png]); - for SVG on standard output.",
    required=True,
)
@option(
    "--against",
    metavar="BEFORE",
    type=FilePath(allow_dash=True),
    help="Draw this file on the left, at the same scale: IN before the edit.",
    group="what",
)
@declared_options(DrawOptions)
@reading_options
@shared("overwrite")
@quiet_option
@json_option
@click.pass_context
def command(ctx: click.Context, /, source: str, output: str, **values: Any) -> None:
    from rigtri.export.drawing.picture import draw, seen
    from rigtri.export.drawing.primitives import as_json
    from rigtri.files.input_stream import opened, title
    from rigtri.formats import read

    options, report = made(DrawOptions, values, given(ctx)), Report()
    sources = [source] if values["against"] is None else [source, values["against"]]
    output_file.check_picture(output, sources, values)
    with ExitStack() as stack:
        reading = read_options({**values, "empty": True})
        documents = [read(stack.enter_context(opened(name)), reading) for name in sources]
        output_file.check_needed(output, chain.from_iterable(each.needed() for each in documents))
        rigs = [document.rig for document in documents]
        titles = [title(name) for name in sources]
        marked = [f"{when}: {title}" for when, title in zip(("after", "before"), titles, strict=False)]
        svg = draw(
            rigs[0],
            against=rigs[1] if len(rigs) > 1 else None,
            options=options,
            title=marked[0] if len(rigs) > 1 else titles[0],
            title_against=marked[-1],
            report=report,
        )
        for document in documents:  # meshes are read, and found unreadable, while they are drawn
            report.extend(document.warnings)
        lines = [as_json(seen(rig, options=options)) for rig in rigs] if values["as_json"] else []
    output_file.write_picture(svg, output)
    if values["as_json"]:
        sides = [{"file": name, "marks": found} for name, found in zip(sources, lines, strict=True)]
        warnings = [notice.as_json() for notice in report.warnings]
        found = {"picture": output, "sides": sides, "warnings": warnings}
        print_json(found)
    output_file.print_result(report, output, values)
