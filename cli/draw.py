"""rigtri draw"""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import click

from rigtri.report import Report

from . import output_file
from .help_format import Command, option
from .options import (
    json_option,
    output_option,
    overwrite_option,
    quiet_option,
    reading_options,
    source_argument,
)
from .parameters import read_options
from .printing import print_json
from .values import FilePath, Number

if TYPE_CHECKING:
    from rigtri.export.drawing.picture import DrawOptions


@click.command("draw", cls=Command)
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
@output_file.view_option
@option(
    "--pose",
    metavar="CLIP@TIME",
    default="rest",
    show_default=True,
    help="The moment, in seconds (USD: time codes), or rest. Active controls move their joints.",
    group="what",
)
@option(
    "--joints",
    multiple=True,
    metavar="GLOB",
    help="Draw only these joints, larger. Repeatable.",
    group="joints",
)
@option(
    "--chain",
    nargs=2,
    multiple=True,
    metavar="START END",
    help="Draw only this chain. Repeatable.",
    group="joints",
)
@option(
    "--below",
    multiple=True,
    metavar="NAME",
    help="Draw this joint and all below it. Repeatable.",
    group="joints",
)
@option("--skin", metavar="NAME", help="Only joints of this skin.", group="joints", rare=True)
@option("--exclude", multiple=True, metavar="GLOB", help="Leave these joints out.", group="joints")
@option("--names/--no-names", default=True, show_default=True, help="Write the joints' names.")
@option(
    "--axes",
    type=Number(min=0, max=10),
    default=0.35,
    show_default=True,
    help="Length of the axes' arrows as a share of the bone; 0 for none.",
)
@option("--mesh/--no-mesh", default=True, show_default=True, help="Draw the outline of the meshes.")
@option(
    "--size", metavar="WIDTHxHEIGHT", callback=output_file.size, help="In pixels. [1000x900; two: 1500x900]"
)
@reading_options
@overwrite_option("the picture")
@quiet_option
@json_option
def command(source: str, output: str, **values: Any) -> None:
    """Draw the skeleton: bones, axes, limb triangles, pole vectors, controls, names.

    The axes of a joint are red (x), green (y) and blue (z); a ring points at you, a crossed ring away.
    Joints none of whose axes lies along their bone are orange. A limb is a teal triangle with the
    projection of its middle joint; the purple arrow from there is its bend direction. --json also prints
    what is drawn: lines, arrows and triangles in space.

    \b
    Examples:
        rigtri draw hero.glb -o hero.svg
        rigtri draw out.glb --against hero.glb -o before-after.png
        rigtri draw hero.glb -o hand.svg --below hand_L --view top --pose walk@0.5
    """
    from rigtri.export.drawing.picture import draw, seen
    from rigtri.export.drawing.primitives import as_json
    from rigtri.files.input_stream import opened, title
    from rigtri.formats import read

    options, report = _draw_options(values), Report()
    sources = [source] if values["against"] is None else [source, values["against"]]
    output_file.check_picture(output, sources, values)
    with ExitStack() as stack:
        reading = read_options({**values, "empty": True})
        documents = [read(stack.enter_context(opened(name)), reading) for name in sources]
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
        lines = [as_json(seen(rig, options)) for rig in rigs] if values["as_json"] else []
    output_file.write_picture(svg, output)
    if values["as_json"]:
        sides = [{"file": name, "marks": found} for name, found in zip(sources, lines, strict=True)]
        warnings = [notice.as_json() for notice in report.warnings]
        found = {"picture": output, "sides": sides, "warnings": warnings}
        print_json(found)
    output_file.print_result(report, output, values)


def _draw_options(values: dict[str, Any]) -> DrawOptions:
    from rigtri.export.drawing.picture import DrawOptions

    kept = {one.name: values[one.name] for one in fields(DrawOptions) if values[one.name] is not None}
    return DrawOptions(**kept).checked()
