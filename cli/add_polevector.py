"""rigtri add-polevector"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from .asked import given_options, request
from .editing import copy_ahead, run_edit
from .options import (
    edit_options,
    facing_option,
    output_options,
    pole_options,
    reading_options,
    source_argument,
    target_option,
)
from .telling import tell_root

if TYPE_CHECKING:
    from rigtri.report import Report


@click.command("add-polevector")
@source_argument
@target_option
@click.option(
    "--limb",
    "limbs",
    nargs=3,
    multiple=True,
    metavar="ROOT MIDDLE END",
    help="The three joints of a limb, e.g. shoulder elbow wrist. Repeatable.",
)
@click.option(
    "--chain",
    "chains",
    nargs=2,
    multiple=True,
    metavar="START END",
    help="A limb of more joints; it bends at the one farthest from the chord. Repeatable.",
)
@click.option("--bend-joint", metavar="NAME", help="With one --chain: the joint at which it bends.")
@click.option(
    "--limbs",
    "auto",
    type=click.Choice(["auto"]),
    help="Find arms and legs by themselves, as rigtri recognise shows them.",
)
@pole_options
@click.option(
    "--bend",
    "bends",
    multiple=True,
    metavar="JOINT=X,Y,Z",
    help="The direction in which the limb of that joint bends; needed where it is straight.",
)
@facing_option
@click.option("--name", help="Name of the locator. [MIDDLE_pole]")
@click.option(
    "--as",
    "kind",
    type=click.Choice(["locator", "joint"]),
    help="A loose node, or a joint of the limb's skin, which engines import. [locator]",
)
@click.option(
    "--pose",
    default="nodes",
    show_default=True,
    metavar="nodes|bind|CLIP@TIME",
    help="Where positions are taken.",
)
@click.option(
    "--check-clips",
    is_flag=True,
    help="List the times of every clip at which the limb is straight or its pole flips side.",
)
@reading_options
@edit_options
@output_options
@click.pass_context
def command(ctx: click.Context, /, **values: Any) -> None:
    """Add a locator that says which way a limb bends.

    It stands in the plane of the limb, on the side it bends to. Straight limbs ask
    the clips, the other side and the joint names; a direction is never invented.
    A second run finds its locator and moves it.

    \b
    Examples:
        rigtri add-polevector hero.glb -o out.glb --limb upper_arm_L forearm_L hand_L
        rigtri add-polevector hero.vrm -o out.vrm --limbs auto
        rigtri add-polevector hero.glb -o out.glb --limb thigh shin foot --bend shin=0,0,1
    """
    copy_ahead(ctx, values)
    from rigtri.pipeline.steps.add_polevector import step

    asked = step(request(values))
    if not values["quiet"]:
        tell_root(str(values["source"]), values["root"])
    run_edit("add-polevector", values, asked, given_options(ctx), summary)


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    lines = []
    for entry in report.limbs:
        x, y, z = entry["position"]
        lines.append(
            f"{entry['polevector']} at {x:.6g} {y:.6g} {z:.6g}: {' - '.join(entry['limb'])} bends "
            f"{entry['bend_degrees']:.4f}° (from: {entry['source']})"
        )
        for clip in entry.get("clips", []):
            times = ", ".join(f"{at['time']:g} {at['what']}" for at in clip["at"][:8])
            more = f" … {len(clip['at'])} in all" if len(clip["at"]) > 8 else ""
            lines.append(f"  {clip['clip']}: {times}{more}")
    return "\n".join(lines)
