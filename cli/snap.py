"""rigtri snap"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from .asked import given_options, request
from .editing import copy_ahead, run_edit
from .options import edit_options, output_options, reading_options, source_argument, target_option

if TYPE_CHECKING:
    from rigtri.report import Report


@click.command("snap")
@source_argument
@target_option
@click.option(
    "--limb",
    "limbs",
    nargs=3,
    multiple=True,
    metavar="ROOT MIDDLE END",
    help="The three joints of a limb with an IK end. Repeatable.",
)
@click.option("--all-limbs", is_flag=True, help="All limbs with an IK end.")
@click.option("--to", type=click.Choice(["ik", "fk"]), required=True, help="What takes over.")
@click.option(
    "--at",
    multiple=True,
    required=True,
    metavar="CLIP@TIME",
    help="The moment, in seconds (USD: time codes), or rest. Repeatable.",
)
@reading_options
@edit_options
@output_options
@click.pass_context
def command(ctx: click.Context, /, **values: Any) -> None:
    """Match IK to FK, or FK to IK, at some frames: the joints do not move there.

    A limb is solved by IK in a clip where its IK end or pole has keys. So with --to fk those keys go, and
    with --to ik the keys that the limb's FK controls had without IK; what is keyed instead stands
    at the moments given.

    \b
    Examples:
        rigtri snap rigged.glb -o out.glb --limb upper_arm_L forearm_L hand_L --to fk --at walk@0.5
        rigtri snap rigged.glb -o out.glb --all-limbs --to ik --at walk@0 --at walk@0.5
    """
    copy_ahead(ctx, values)
    from rigtri.pipeline.steps.snap import step

    run_edit("snap", values, step(request(values)), given_options(ctx), summary)


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    told = [entry for entry in report.added if entry["type"] == "snap"]
    far = max((entry["deviation"] for entry in told), default=0.0)
    limbs = len({tuple(entry["limb"]) for entry in told})
    return f"{limbs} limbs to {told[0]['to']}; their joints stay within {far:.2g} of the size"
