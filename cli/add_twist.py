"""rigtri add-twist"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from .asked import given_options, request
from .editing import run_edit
from .options import edit_options, output_options, reading_options, source_argument, target_option
from .values import direction
from .words import counted

if TYPE_CHECKING:
    from rigtri.report import Report


@click.command("add-twist")
@source_argument
@target_option
@click.option(
    "--limb",
    "limbs",
    nargs=3,
    multiple=True,
    metavar="ROOT MIDDLE END",
    help="Both bones of this limb, or with --upper or --lower one of them. Repeatable.",
)
@click.option("--limbs", "auto", type=click.Choice(["auto"]), help="Every limb that is known.")
@click.option(
    "--joint", "joints", multiple=True, metavar="JOINT", help="The bone from this joint … Repeatable."
)
@click.option(
    "--to", "children", multiple=True, metavar="CHILD", help="… to this one; one --to for each --joint."
)
@click.option(
    "--upper", is_flag=True, help="Upper bones: the joint's own twist is taken away towards its root."
)
@click.option("--lower", is_flag=True, help="Lower bones: the twist of the bone's end is spread up the bone.")
@click.option(
    "--count",
    type=click.IntRange(1, 64),
    default=2,
    show_default=True,
    help="Twist joints for a bone, at equal distances.",
)
@click.option(
    "--weights",
    metavar="W1,W2,…",
    help="The share of the driver's twist that each turns by, -1 to 1. "
    "[i/(n+1) on lower, i/(n+1) - 1 on upper bones]",
)
@click.option(
    "--axis",
    callback=direction,
    metavar="AXIS|X,Y,Z",
    help="The axis of the twist as the bone's joint sees it. [the bone]",
)
@click.option(
    "--split-weights",
    is_flag=True,
    help="Share the skin weights of the bone among its joint and the twist joints, by place along it.",
)
@click.option(
    "--max-influences",
    "most",
    type=click.IntRange(0),
    default=0,
    metavar="N",
    help="With --split-weights: a point that would get more joints than N gets the nearest alone. [any]",
)
@click.option(
    "--keys/--no-keys", default=True, show_default=True, help="Let the joints follow in every clip."
)
@click.option(
    "--name",
    default="{joint}_twist_{number}",
    show_default=True,
    help="Names of the twist joints; {joint} and {number} stand for what they say.",
)
@reading_options
@edit_options
@output_options
@click.pass_context
def command(ctx: click.Context, /, **values: Any) -> None:
    """Put twist joints along bones, so that forearms and shoulders turn without wringing.

    Each of n joints at i/(n+1) of a bone carries i/(n+1) of the twist and none of the swing. On
    the lower bone of a limb it comes from the end joint (the wrist), on the upper bone the
    joint's own is taken away towards the root. No point changes its weights unless
    --split-weights says so; then the rest pose looks as before, and twisted poses better.

    \b
    Examples:
        rigtri add-twist hero.glb -o out.glb --limbs auto
        rigtri add-twist hero.glb -o out.glb --limb upper_arm forearm hand --count 3 --split-weights
        rigtri add-twist hero.usdz -o out.usdz --joint forearm --to hand --weights 0.25,0.8
    """
    from rigtri.pipeline.steps.add_twist import step

    run_edit("add-twist", values, step(request(values)), given_options(ctx), summary)


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    made = [entry for entry in report.added if entry["type"] == "twist"]
    new = [entry for entry in made if entry["new"]]
    bones = {(entry["joint"], entry["to"]) for entry in made}
    clips = {clip["clip"] for entry in made for clip in entry["clips"]}
    keys = f", with keys in {counted(len(clips), 'clip')}" if clips else ""
    rivets = [entry["node"] for entry in report.added if entry["type"] == "rivet"]
    told = f"; rivets baked anew: {', '.join(rivets)}" if rivets else ""
    along = f"{counted(len(made), 'twist joint')} along {counted(len(bones), 'bone')}"
    return f"{along}, {len(new)} of them new{keys}{told}"
