"""rigtri add-controls"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from rigtri.model.control_shapes import KINDS

from .asked import given_options, request
from .editing import copy_ahead, run_edit
from .options import (
    edit_options,
    facing_option,
    output_options,
    reading_options,
    source_argument,
    target_option,
)
from .values import Number
from .words import counted

if TYPE_CHECKING:
    from rigtri.report import Report


@click.command("add-controls")
@source_argument
@target_option
@click.option(
    "--whole-character",
    is_flag=True,
    help="A root control, an FK control for every joint with weight, IK ends and pole vectors for all limbs.",
)
@click.option("--joints", multiple=True, metavar="GLOB", help="An FK control for these joints. Repeatable.")
@click.option(
    "--chain", "chains", nargs=2, multiple=True, metavar="START END", help="FK controls along a chain."
)
@click.option("--below", multiple=True, metavar="NAME", help="FK controls for this joint and all below it.")
@click.option("--skin", metavar="NAME", help="Only joints of this skin.")
@click.option("--exclude", multiple=True, metavar="GLOB", help="No controls for these joints.")
@click.option("--root-control", is_flag=True, help="A control over all others, on the ground.")
@click.option(
    "--ik",
    nargs=3,
    multiple=True,
    metavar="ROOT MIDDLE END",
    help="An IK control at the end of this limb, its pole vector, and FK controls below IK. Repeatable.",
)
@click.option("--limbs", "auto", type=click.Choice(["auto"]), help="The same for every limb that is known.")
@click.option(
    "--shape",
    "shapes",
    multiple=True,
    metavar="[KIND=]SHAPE",
    help=f"Lines of the controls, or of one kind (fk, ik, root, pole): {', '.join(KINDS)}.",
)
@click.option(
    "--size",
    type=Number(min=0, min_open=True),
    help="Multiplies the shapes' sizes, which follow the bones' lengths. [1]",
)
@click.option(
    "--color",
    "colors",
    multiple=True,
    metavar="SIDE=R,G,B",
    help="Linear colour of left, right or centre. [blue, red, yellow]",
)
@click.option(
    "--name",
    help="Names of the controls: {joint} and {side} stand for what they say, {kind} for ctl, ik_ctl or "
    "root_ctl. [{joint}_{kind}]",
)
@click.option(
    "--reach",
    type=Number(min=0, min_open=True),
    default=0.5,
    show_default=True,
    help="Distance of pole vectors as a multiple of the limb's length.",
)
@click.option(
    "--as",
    "kind",
    type=click.Choice(["locator", "joint"]),
    help="IK ends and pole vectors: nodes, or joints of the skin, which engines import. [locator]",
)
@click.option(
    "--soft",
    type=click.FloatRange(min=0, max=1, max_open=True),
    metavar="SHARE",
    help="How far before it is straight an IK limb slows down, as a share of its length. [as stored, or 0]",
)
@click.option(
    "--stretch/--no-stretch",
    default=None,
    help="IK limbs grow to reach their target. [as stored, or not]",
)
@facing_option
@reading_options
@edit_options
@output_options
@click.pass_context
def command(ctx: click.Context, /, **values: Any) -> None:
    """Put a tree of controls over joints: fingers, spines, tails, limbs, whole characters.

    Each control stands in its joint's frame with zero channels, below an offset, below the
    control of the joint above. A second run finds its controls again: those that nobody has
    edited get the shape, size, colour and name that are asked for; edited ones stay, and are named.

    \b
    Examples:
        rigtri add-controls hero.glb -o out.glb --chain index_1 index_3
        rigtri add-controls hero.glb -o out.glb --whole-character
        rigtri add-controls hero.usdz -o out.usdz --below spine --shape cube --size 1.5
    """
    copy_ahead(ctx, values)
    from rigtri.pipeline.steps.add_controls import step

    run_edit("add-controls", values, step(request(values)), given_options(ctx), summary)


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    new = [entry for entry in report.added if entry["new"]]
    kinds = [entry["kind"] for entry in report.added]
    counts = ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds))
    poles = f"; {counted(len(report.limbs), 'pole vector')}" if report.limbs else ""
    return f"{counted(len(report.added), 'control')} ({counts}), {len(new)} of them new{poles}"
