"""rigtri add-rivet"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from .asked import given_options, request
from .editing import run_edit
from .options import edit_options, output_options, reading_options, source_argument, target_option
from .values import Number, Tolerance, points
from .words import counted

if TYPE_CHECKING:
    from rigtri.report import Report


@click.command("add-rivet")
@source_argument
@target_option
@click.option(
    "--mesh",
    required=True,
    metavar="NODE",
    help="The node that shows the mesh, by name, path or #index; NODE/1 is its second primitive alone.",
)
@click.option(
    "--triangle",
    "triangles",
    type=int,
    multiple=True,
    metavar="N",
    help="A rivet on this triangle, counted from 0 through the primitives of the node; a polygon of s "
    "corners is s-2 triangles, a fan from its first corner. Repeatable.",
)
@click.option(
    "--barycentric",
    multiple=True,
    callback=points,
    metavar="U,V,W",
    help="Where on the triangle, as weights of its corners; one for each --triangle. [1/3,1/3,1/3]",
)
@click.option(
    "--at",
    multiple=True,
    callback=points,
    metavar="X,Y,Z",
    help="A rivet on the point of the mesh that is nearest to this place at rest. Repeatable.",
)
@click.option(
    "--vertex",
    "vertices",
    type=int,
    multiple=True,
    metavar="N",
    help="A rivet on this point of the first primitive. Repeatable.",
)
@click.option(
    "--name",
    "names",
    multiple=True,
    help="Names of the rivets, in the order --triangle, --at, --vertex; a single one is numbered. "
    "A rivet is found again by its name. [NODE_rivet]",
)
@click.option(
    "--within",
    type=Tolerance(),
    default=1e-5,
    show_default=True,
    help="How far what is tied to a rivet may be off between keys, as a share of the mesh's size.",
)
@click.option("--fps", type=Number(min=0, min_open=True), help="Also so many keys a second.")
@reading_options
@edit_options
@output_options
@click.pass_context
def command(ctx: click.Context, /, **values: Any) -> None:
    """Tie locators to the surface of a mesh, through skinning and morphs, baked to keys.

    The x axis of a rivet lies along the first edge of its triangle, y is the normal. A second
    run finds a rivet by its name and moves it.

    \b
    Examples:
        rigtri add-rivet hero.glb -o out.glb --mesh Body --at 0,1.4,0.2 --name button
        rigtri add-rivet hero.glb -o out.glb --mesh Body --triangle 120 --barycentric 0.2,0.3,0.5
        rigtri add-rivet hero.usdz -o out.usdz --mesh Body --vertex 17 --vertex 40 --fps 24
    """
    from rigtri.pipeline.steps.add_rivet import step

    run_edit("add-rivet", values, step(request(values)), given_options(ctx), summary)


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    new = sum(entry["new"] for entry in report.added)
    keys = sum(count for entry in report.added for count in entry["keys"].values())
    off = max((entry["deviation"] for entry in report.added), default=0.0)
    return (
        f"{counted(len(report.added), 'rivet')}, {new} of them new, {counted(keys, 'key')}, "
        f"at most {off:.2g} of the mesh's size off the surface"
    )
