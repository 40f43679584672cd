"""rigtri add-posereader"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from .editing import run_edit
from .options import edit_options, output_options, reading_options, source_argument, target_option
from .parameters import given_options, request
from .text import counted
from .values import Number, Tolerance, direction

if TYPE_CHECKING:
    from rigtri.report import Report


@click.command("add-posereader")
@source_argument
@target_option
@click.option("--driver", required=True, metavar="JOINT", help="The joint whose pose is read.")
@click.option(
    "--axis",
    callback=direction,
    default="x",
    show_default=True,
    metavar="AXIS|X,Y,Z",
    help="The axis of the driver that points somewhere.",
)
@click.option("--frame", default="", metavar="NODE|world", help="What the driver is seen from. [its parent]")
@click.option(
    "--target",
    "targets",
    multiple=True,
    metavar="[NAME=]X,Y,Z|CLIP@TIME|rest|NODE",
    help="What is looked for: a direction of the world at rest, a pose, or a node to point at. "
    "Repeatable; without a name they are target1, target2 and so on.",
)
@click.option(
    "--reader",
    type=click.Choice(["dot", "cone", "rbf"]),
    default="dot",
    show_default=True,
    help="dot: the cosine to each target. cone: 1 inside an angle, 0 outside another. rbf: several poses.",
)
@click.option("--inner", type=Number(), default=0.0, show_default=True, help="Cone: 1 up to here (degrees).")
@click.option("--outer", type=Number(), default=90.0, show_default=True, help="Cone: 0 from here (degrees).")
@click.option(
    "--kernel",
    type=click.Choice(["linear", "gaussian"]),
    default="linear",
    show_default=True,
    help="rbf: how a pose fades out.",
)
@click.option(
    "--mode",
    type=click.Choice(["swing", "twist", "both"]),
    default="swing",
    show_default=True,
    help="rbf: which part of the rotation counts, about --axis.",
)
@click.option(
    "--morph",
    "morphs",
    nargs=3,
    multiple=True,
    metavar="TARGET MESH MORPH",
    help="Let a target drive this morph target (name or number) of a mesh. Repeatable.",
)
@click.option(
    "--attribute",
    "attributes",
    nargs=3,
    multiple=True,
    metavar="TARGET NODE NAME",
    help="Let a target drive a value called NAME of a control. Repeatable.",
)
@click.option("--name", default="", help="Name of the reader, by which it is found again. [JOINT_reader]")
@click.option(
    "--within",
    type=Tolerance(),
    default=1e-4,
    show_default=True,
    help="How far a weight may be off between keys.",
)
@click.option("--fps", type=Number(min=0, min_open=True), help="Also so many keys a second.")
@reading_options
@edit_options
@output_options
@click.pass_context
def command(ctx: click.Context, /, **values: Any) -> None:
    """Let morph targets or values follow a joint's pose, baked to keys of every clip.

    Driven morphs look different on purpose: the self-check compares everything else, and says
    how far they move. A target that drives no morph gets a node whose x translation is its weight.

    \b
    Examples:
        rigtri add-posereader hero.glb -o out.glb --driver upperarm_L --target up=0,1,0 --morph up Body bulge
        rigtri add-posereader hero.glb -o out.glb --driver knee --reader cone --outer 60 --target walk@0.4
        rigtri add-posereader hero.usdz -o out.usdz --driver head --reader rbf --target rest --target nod@12
    """
    from rigtri.pipeline.steps.add_posereader import step

    run_edit("add-posereader", values, step(request(values)), given_options(ctx), summary)


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    (entry,) = (entry for entry in report.added if entry["type"] == "poseReader")
    rivets = [entry["node"] for entry in report.added if entry["type"] == "rivet"]
    rest = ", ".join(f"{name} {value:.3g}" for name, value in entry["rest"].items())
    keys = sum(entry["keys"].values())
    return (
        f"{entry['reader']} reader of {entry['driver']}: at rest {rest}; {keys} keys in "
        f"{counted(len(entry['keys']), 'clip')}, {counted(entry['morphs'], 'morph target')} driven"
        + (f"; rivets baked anew: {', '.join(rivets)}" if rivets else "")
    )
