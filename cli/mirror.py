"""rigtri mirror"""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, Any

import click

from rigtri.errors import UsageError

from .asked import given_options, read_options, request
from .editing import run_edit
from .options import (
    edit_options,
    optional_target_option,
    output_options,
    reading_options,
    source_argument,
    turn_options,
)
from .values import Number
from .words import counted, plain

if TYPE_CHECKING:
    from rigtri.operations.mirror.mirror import MirrorOptions
    from rigtri.report import Report

MOST = 20


@click.command("mirror")
@source_argument
@optional_target_option
@click.option(
    "--check",
    is_flag=True,
    help="Write nothing: report what is not symmetric (exit code 1 where there is any).",
)
@click.option(
    "--mode",
    type=click.Choice(["behavior", "orientation", "blender"]),
    default="behavior",
    show_default=True,
    help="What mirrored axes are: equal rotations mirror the motion, equal axes, or Blender's X mirror.",
)
@click.option(
    "--from-side",
    type=click.Choice(["left", "right"]),
    default="left",
    show_default=True,
    help="The side that is copied onto the other.",
)
@click.option(
    "--plane",
    type=click.Choice(["yz", "xz", "xy"]),
    default="yz",
    show_default=True,
    help="The plane between the sides, of the space that the joints are in.",
)
@click.option(
    "--plane-at",
    type=Number(),
    help="Where the plane is on the axis across it, in the units of the joints.  [between most pairs]",
)
@click.option(
    "--what",
    type=click.Choice(
        [
            "limbs",
            "joints",
            "controls",
            "polevectors",
            "twists",
            "constraints",
            "rivets",
            "posereaders",
        ]
    ),
    multiple=True,
    help="Mirror only these; repeatable. [all]",
)
@click.option("--joints", multiple=True, metavar="GLOB", help="Only these joints and their twins.")
@click.option("--below", multiple=True, metavar="NAME", help="Only this joint, all below, and their twins.")
@click.option("--exclude", multiple=True, metavar="GLOB", help="Not these joints.")
@click.option("--pose", metavar="POSE", help="The pose that tells axes: bind, nodes or CLIP@TIME.  [bind]")
@click.option(
    "--tolerance-distance",
    type=Number(min=0),
    default=1e-4,
    show_default=True,
    help="With --check: places this far off, as a share of the size, pass.",
)
@click.option(
    "--tolerance-degrees",
    type=Number(min=0),
    default=0.1,
    show_default=True,
    help="With --check: axes this far off pass.",
)
@turn_options
@reading_options
@edit_options
@output_options
@click.pass_context
def command(ctx: click.Context, /, **values: Any) -> None:
    """Give one side of a character what the other has: joint axes, and what rigtri has built.

    Joints stay in place and all that can be seen stays as it is; axes turn as with
    orient-joints. Limbs, controls, pole vectors, twist joints, constraints, rivets and pose
    readers of one side are built, or brought up to date, on the other, with what an animator has
    set. What cannot be mirrored is named.

    \b
    Examples:
        rigtri mirror hero.glb -o out.glb
        rigtri mirror hero.usdz -o out.usdz --from-side right --mode orientation
        rigtri mirror hero.glb --check
    """
    from rigtri.pipeline.steps.mirror import asked, step

    if values["check"]:
        _check(values, asked(request(values)))
        return
    if values["target"] is None and not values["dry_run"]:
        raise UsageError("give the file to write with -o OUT, or --check to write none")
    run_edit("mirror", values, step(request(values)), given_options(ctx), summary)


def _check(values: dict[str, Any], options: MirrorOptions) -> None:
    from rigtri.files.input_stream import opened
    from rigtri.formats import read
    from rigtri.operations.mirror.symmetry_check import asymmetry

    if values["target"] is not None:
        raise UsageError("--check writes nothing; leave -o out")
    with opened(values["source"]) as path:
        found = asymmetry(read(path, read_options(values)).rig, options=options)
    worse = found.worse(values["tolerance_distance"], values["tolerance_degrees"])
    if values["as_json"]:
        document = {
            "source": str(values["source"]),
            "symmetric": not worse and not found.alone,
            "mode": options.mode,
            "plane": options.plane,
            "plane_at": found.at,
            "better_plane": None
            if found.better is None
            else {"plane": found.better[0], "plane_at": found.better[1]},
            "asymmetric": [pair.as_json() for pair in worse],
            "without_twin": list(found.alone),
            "pairs": len(found.pairs),
        }
        click.echo(json.dumps(document, indent=2, ensure_ascii=False))
    elif not values["quiet"]:
        shown = worse if values["verbose"] else worse[:MOST]
        for pair in shown:
            text = f"{pair.node} and {pair.twin}: {pair.distance:.2g} of the size, {pair.degrees:.3g}°"
            click.echo(plain(text, one_line=True))
        if len(shown) < len(worse):
            click.echo(f"{len(worse) - len(shown)} more; -v shows all")
        for name in found.alone:
            click.echo(plain(f"without twin: {name}", one_line=True))
        if found.better is not None:
            plane, at = found.better
            click.echo(f"most pairs lie about another plane: --plane {plane} --plane-at {at:.6g}", err=True)
        where = f" about --plane {found.plane} --plane-at {found.at:g}" if found.at else ""
        total = f"{counted(len(found.pairs), 'pair')}, {len(worse)} not symmetric{where}"
        total += f", {counted(len(found.alone), 'node')} without twin"
        click.echo(total, err=True)
    if worse or found.alone:
        sys.exit(1)


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    turned = sum(entry["status"] == "turned" for entry in report.joints)
    new = sum(entry["new"] for entry in report.added)
    made = len(report.added)
    return f"{counted(turned, 'joint')} turned; {made} of what rigtri has built mirrored, {new} of them new"
