"""rigtri add-posereader"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import click

from rigtri.errors import UsageError

from .options import (
    Number,
    Tolerance,
    direction,
    edit_options,
    given_options,
    output_options,
    reading_options,
    run_edit,
    source_argument,
    target_option,
)
from .words import counted

if TYPE_CHECKING:
    from rigtri.ops.posereader import Goal
    from rigtri.report import Report
    from rigtri.rig import Rig

_NAMED = re.compile(r"([A-Za-z_][A-Za-z0-9_]*)=(.*)", re.S)


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
    from rigtri.ops.posereader import Options, add_posereader

    def step(rig: Rig, report: Report) -> Rig:
        options = Options(
            driver=values["driver"],
            axis=values["axis"],
            frame=values["frame"],
            reader=values["reader"],
            targets=tuple(_goal(rig, text) for text in values["targets"]),
            morphs=values["morphs"],
            attributes=values["attributes"],
            inner=values["inner"],
            outer=values["outer"],
            kernel=values["kernel"],
            mode=values["mode"],
            name=values["name"],
            within=values["within"],
            fps=values["fps"],
        )
        return add_posereader(rig, options=options, report=report)

    foreign = {"cone": ("inner", "outer"), "rbf": ("kernel", "mode")}
    for kind, names in foreign.items():
        for name in names:
            given = ctx.get_parameter_source(name) not in (None, click.core.ParameterSource.DEFAULT)
            if given and values["reader"] != kind:
                raise UsageError(f"--{name} is for --reader {kind}")
    run_edit("add-posereader", values, step, given_options(ctx), _summary)


def _goal(rig: Rig, text: str) -> Goal:
    """A target from its words; the name of a node that is there wins over all else."""
    from rigtri.ops.posereader import Goal

    name, said = "", text
    if not rig.has(text) and (found := _NAMED.fullmatch(text)):
        name, said = found[1], found[2]
    if rig.has(said):
        return Goal(name, node=said)
    parts = said.split(",")
    if len(parts) == 3:
        try:
            x, y, z = map(float, parts)
            return Goal(name, direction=(x, y, z))
        except ValueError:
            pass
    if said == "rest" or "@" in said:
        return Goal(name, pose=said)
    return Goal(name, node=said)


def _summary(report: Report) -> str:
    (entry,) = report.added
    rest = ", ".join(f"{name} {value:.3g}" for name, value in entry["rest"].items())
    keys = sum(entry["keys"].values())
    return (
        f"{entry['reader']} reader of {entry['driver']}: at rest {rest}; {keys} keys in "
        f"{counted(len(entry['keys']), 'clip')}, {counted(entry['morphs'], 'morph target')} driven"
    )
