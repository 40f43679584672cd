"""rigtri explain

Each line shows the notation of the talk (R. Katz, "Rigging with Triangles", GDC 2018), rigtri's own, and
the numbers: vectors, lengths, dot and cross product, the aim matrix, the projection and the pole vector;
product and inverse of matrices, another space and back, the parent constraint with offset and joint
orient, twist and pose reader. With a file, the matrices are those of its joints. Points are x,y,z each,
or nine numbers in a row; negative numbers need no quotes.

\b
Examples:
    rigtri explain 0,140,0 25,140,-5 50,140,0
    rigtri explain 0 140 0 25 140 -5 50 140 0 -o arm.svg
    rigtri explain hero.glb --limb forearm_L --at walk@0.5
"""

from __future__ import annotations

import math
import re
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rigtri.errors import UsageError
from rigtri.operations.option_kinds import MOMENT
from rigtri.report import Report

from . import output_file
from .given_options import read_options
from .help_format import Command, option
from .name_completion import complete_node
from .printing import print_json, print_warnings
from .shared_options import json_option, output_option, quiet_option, reading_options, shared

if TYPE_CHECKING:
    from rigtri.export.explain.explain import Explanation


@click.command("explain", cls=Command, help=__doc__, context_settings={"ignore_unknown_options": True})
@click.argument(
    "points",
    metavar="A B C | IN [ROOT MIDDLE END]",
    nargs=-1,
    required=True,
    shell_complete=complete_node,
)
@option(
    "--limb", metavar="JOINT", help="The limb of IN that has this joint: root, middle or end.", group="joints"
)
@option(
    "--at",
    metavar="CLIP@TIME|rest",
    help=f"Of a file. {MOMENT} [rest]",
    group="what",
)
@output_option(
    "Also write a picture: .svg or .png (extra rigtri[png]); - for SVG instead of words.",
)
@option("--view", metavar="X,Y,Z", help="View direction of the picture. [across the plane]", group="output")
@reading_options
@shared("overwrite")
@quiet_option
@json_option
def command(points: tuple[str, ...], **values: Any) -> None:
    from rigtri.export.explain.picture import picture
    from rigtri.export.explain.text import text

    output, report = values["output"], Report()
    if output is not None:
        output_file.check_picture(output, points[:1], values)
    found = _explained(points, values, report)
    if output is not None:
        output_file.write_picture(picture(found, view=values["view"]), output)
    if values["as_json"]:
        print_json(found.as_json())
    elif output != "-" and not values["quiet"]:
        wide = shutil.get_terminal_size().columns if sys.stdout.isatty() else 120
        click.echo(text(found, width=wide))
    if output is not None:
        output_file.print_result(report, output, values)
    elif not values["quiet"]:
        print_warnings(report.warnings)


def _explained(points: tuple[str, ...], values: dict[str, Any], report: Report) -> Explanation:
    """What is to be explained: numbers as they are given, or a limb of a file."""
    from rigtri.export.explain.explain import explain_points

    unknown = [word for word in points if word.startswith("--") and len(word) > 2]
    if unknown:
        raise UsageError(f"there is no option {unknown[0]}; see: rigtri explain --help")
    numbers = _numbers(points)
    if numbers is None:
        return _of_file(points, values, report)
    if values["limb"] is not None:
        raise UsageError("--limb names a joint of a file; give the file instead of points")
    if values["at"] is not None:
        raise UsageError("--at is a moment of a file; give the file instead of points")
    return explain_points(numbers[:3], numbers[3:6], numbers[6:])


def _numbers(words: tuple[str, ...]) -> list[float] | None:
    """Nine numbers; None where the first word is no number but a file. UsageError for other counts."""
    parts = [part for word in words for part in re.split(r"\s*[,;]\s*|\s+", word.strip().rstrip(",;"))]
    try:
        float(parts[0])
    except ValueError:
        return None
    if Path(words[0]).is_file():
        return None
    found = []
    for part in parts:
        try:
            found.append(float(part))
            valid = math.isfinite(found[-1])
        except ValueError:
            valid = False
        if not valid:
            raise UsageError(f"'{part}' is not a valid number: give three points as x,y,z x,y,z x,y,z")
    if len(found) != 9:
        raise UsageError(f"three points are nine numbers, not {len(found)}: give x,y,z x,y,z x,y,z")
    return found


def _of_file(words: tuple[str, ...], values: dict[str, Any], report: Report) -> Explanation:
    """A limb of a file: the one that --limb names a joint of, or three joints."""
    from rigtri.export.explain.limb_points import explain_limb, limb_with
    from rigtri.files.input_stream import opened
    from rigtri.formats import read

    named = words[1:]
    if bool(named) == (values["limb"] is not None) or len(named) not in (0, 3):
        raise UsageError("name the limb of the file: --limb JOINT, or its joints ROOT MIDDLE END")
    with opened(words[0]) as path:
        document = read(path, read_options({**values, "empty": True}))
        output_file.check_needed(values["output"], document.needed())
        rig = document.rig
        joints = tuple(map(rig.find, named)) if named else limb_with(rig, values["limb"])
        return explain_limb(rig, joints, values["at"] or "rest", report)
