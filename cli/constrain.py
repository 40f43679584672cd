"""rigtri constrain"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from .asked import given_options, refuse_given, request
from .editing import run_edit
from .options import edit_options, output_options, reading_options, source_argument, target_option
from .values import direction

if TYPE_CHECKING:
    from rigtri.report import Report

_KINDS = ("parent", "point", "orient", "scale", "aim", "polevector")
_ORDERS = ("xyz", "yzx", "zxy", "xzy", "yxz", "zyx")


def _orient(ctx: click.Context, param: click.Parameter, value: str) -> Any:
    """``rest``, ``none`` or three degrees."""
    if value in ("rest", "none"):
        return value
    try:
        x, y, z = (float(part) for part in value.split(","))
    except ValueError:
        raise click.BadParameter(f"'{value}': give rest, none or X,Y,Z in degrees", ctx, param) from None
    if not all(abs(part) < 1e6 for part in (x, y, z)):
        raise click.BadParameter(f"'{value}': angles are degrees below a million", ctx, param)
    return x, y, z


@click.command("constrain")
@source_argument
@target_option
@click.option("--type", "kind", required=True, type=click.Choice(_KINDS), help="What the child takes over.")
@click.option("--child", metavar="NODE", help="The node that follows; of polevector any joint of the limb.")
@click.option(
    "--driver",
    "drivers",
    multiple=True,
    required=True,
    metavar="NODE[=WEIGHT]",
    help="A node that it follows. Repeatable; the ratio of the weights counts.",
)
@click.option(
    "--skip",
    metavar="tx,ty,…",
    help="Channels that stay the child's own: tx, ty, tz, rx … sz, or t, r, s for three.",
)
@click.option(
    "--maintain-offset/--no-maintain-offset",
    default=True,
    show_default=True,
    help="Keep the place that the child has beside each driver now, or take over the driver's.",
)
@click.option(
    "--rotate-order",
    type=click.Choice(_ORDERS),
    default="xyz",
    show_default=True,
    help="Order of the angles that --skip and the report mean by rx, ry, rz.",
)
@click.option(
    "--joint-orient",
    callback=_orient,
    default="rest",
    show_default=True,
    metavar="rest|none|X,Y,Z",
    help="The turn after those angles, as Maya's jointOrient (degrees, about x, y, z).",
)
@click.option(
    "--space",
    type=click.Choice(["world", "local"]),
    default="world",
    show_default=True,
    help="orient: follow the axes in the world, or the driver's turn from rest in its own axes.",
)
@click.option(
    "--roll-axis",
    type=click.Choice(["x", "y", "z"]),
    help="orient: only the roll about this axis of the child.",
)
@click.option(
    "--aim-axis",
    callback=direction,
    default="x",
    show_default=True,
    metavar="AXIS|X,Y,Z",
    help="aim: the axis of the child that points at the driver.",
)
@click.option(
    "--up-axis",
    callback=direction,
    default="y",
    show_default=True,
    metavar="AXIS|X,Y,Z",
    help="aim: the axis of the child that leans to --world-up.",
)
@click.option(
    "--world-up",
    type=click.Choice(["vector", "object", "objectrotation", "none"]),
    default="vector",
    show_default=True,
    help="aim: what the up axis leans to: a direction, a node's place, a node's axis, or nothing.",
)
@click.option(
    "--up-vector", callback=direction, metavar="AXIS|X,Y,Z", help="That direction or axis. [the file's up]"
)
@click.option("--up-object", metavar="NODE", help="That node.")
@click.option("--limb", nargs=3, metavar="ROOT MIDDLE END", help="polevector: the limb whose bend follows.")
@click.option(
    "--vrm-constraints",
    "vrm",
    is_flag=True,
    help="Also write VRMC_node_constraint where it says the same (glTF); viewers then move the child.",
)
@reading_options
@edit_options
@output_options
@click.pass_context
def command(ctx: click.Context, /, **values: Any) -> None:
    """Let a node follow others by a rule that is stored in the file; nothing moves now.

    A second run for the same child and type replaces the rule.

    \b
    Examples:
        rigtri constrain hero.glb -o out.glb --type parent --child sword --driver hand_L --driver hand_R=0
        rigtri constrain hero.usda -o out.usda --type point --child pole --driver hips --skip ty
        rigtri constrain hero.vrm -o out.vrm --type orient --child sleeve --driver arm \\
            --space local --vrm-constraints
    """
    from rigtri.pipeline.steps.constrain import step

    if str(values["source"]).lower().endswith((".usd", ".usda", ".usdc", ".usdz")):
        refuse_given({"--vrm-constraints": "vrm"}, "means nothing for USD files")
    run_edit("constrain", values, step(request(values)), given_options(ctx), summary)


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    words = []
    for entry in report.added:
        drivers = ", ".join(f"{name} ({weight:g})" for name, weight in entry["drivers"].items())
        told = f", also as a {entry['vrm']} node constraint" if entry["vrm"] else ""
        state = "new" if entry["new"] else "replaced"
        words.append(f"{entry['child']}: {entry['kind']} constraint by {drivers}{told} ({state})")
    return "; ".join(words)
