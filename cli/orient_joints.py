"""rigtri orient-joints"""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .asked import given_options, request
from .editing import copy_ahead, run_edit
from .options import (
    edit_options,
    facing_option,
    output_options,
    preset_option,
    reading_options,
    source_argument,
    target_option,
    turn_options,
)
from .words import counted

if TYPE_CHECKING:
    from rigtri.report import Report

_STYLED = ("aim", "up", "up_from")


class InOrder(click.Command):
    """A command that knows in which order its options were given: styles follow their chain."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        values, _, order = self.make_parser(ctx).parse_args(args=list(args))
        waiting = {p.name: list(values[p.name]) for p in order if p.name in (*_STYLED, "chains")}
        ctx.meta["rigtri.order"] = [(p.name, waiting[p.name].pop(0)) for p in order if p.name in waiting]
        return super().parse_args(ctx, args)


def _degrees(ctx: click.Context, param: click.Parameter, value: str | None) -> Any:
    try:
        angles = tuple(float(part) for part in (value or "0,0,0").split(","))
    except ValueError:
        angles = ()
    if len(angles) != 3 or not all(abs(a) <= 360 for a in angles):
        raise click.BadParameter("give three angles in degrees, e.g. 0,0,90", ctx, param)
    return angles


@click.command("orient-joints", cls=InOrder)
@source_argument
@target_option
@preset_option("The axes of another program: aim, up and where up comes from.")
@click.option("--aim", multiple=True, metavar="AXIS", help="Axis that aims at the child. [x]")
@click.option("--up", multiple=True, metavar="AXIS", help="Axis that goes up. [y]")
@click.option(
    "--up-from",
    multiple=True,
    metavar="SOURCE",
    help="plane (the hinge, +n), pole (towards the bend), world:+y, vector:x,y,z, node:NAME, "
    "noderot:axis:NAME, parent, child, keep. [plane]",
)
@click.option("--joints", multiple=True, metavar="GLOB", help="Turn these joints. Repeatable.")
@click.option(
    "--chain",
    "chains",
    nargs=2,
    multiple=True,
    metavar="START END",
    help="Turn this chain; --aim, --up, --up-from behind it are for it alone. Repeatable.",
)
@click.option("--below", multiple=True, metavar="NAME", help="Turn this joint and all below it.")
@click.option("--skin", metavar="NAME", help="Only joints of this skin.")
@click.option("--exclude", multiple=True, metavar="GLOB", help="Leave these joints as they are.")
@click.option("--aim-at", multiple=True, metavar="JOINT=NODE", help="Aim one joint at any node. Repeatable.")
@click.option(
    "--limb",
    "limbs",
    nargs=3,
    multiple=True,
    metavar="ROOT MIDDLE END",
    help="Three joints that bend as one limb and share its hinge. Repeatable.",
)
@click.option(
    "--branch",
    multiple=True,
    metavar="RULE",
    help="At several children: chain, first, average, longest, incoming, keep, or the NAME of "
    "a child. [chain]",
)
@click.option(
    "--end",
    type=click.Choice(["tip", "parent", "incoming", "keep", "world"]),
    default="tip",
    show_default=True,
    help="What a joint without child aims at.",
)
@click.option("--per-joint-plane", is_flag=True, help="Each joint its own bend plane (S-bends).")
@facing_option
@click.option(
    "--pose",
    metavar="bind|nodes|CLIP@TIME",
    help="Where positions are taken. [bind where one skin holds the chain, else nodes]",
)
@click.option("--world", is_flag=True, help="Make every frame parallel to the world.")
@turn_options
@click.option(
    "--unknown-node-ext",
    type=click.Choice(["freeze", "ignore", "error"]),
    default="freeze",
    show_default=True,
    help="A glTF node with an extension that may hold directions in the node's axes: leave the "
    "node, turn it all the same, or stop.",
)
@click.option("--snap", is_flag=True, help="Turn only to the nearest cardinal axes.")
@click.option(
    "--offset",
    callback=_degrees,
    metavar="X,Y,Z",
    help="Afterwards turn about the new axes, in degrees: X, then Y, then Z.",
)
@click.option(
    "--mirror",
    type=click.Choice(["behavior", "orientation", "blender"]),
    help="Give the other side the mirrored axes of --from-side.",
)
@click.option(
    "--from-side",
    type=click.Choice(["left", "right"]),
    default="left",
    show_default=True,
    help="With --mirror: the side that is copied onto the other.",
)
@click.option(
    "--plane",
    type=click.Choice(["yz", "xz", "xy"]),
    default="yz",
    show_default=True,
    help="The mirror.",
)
@click.option(
    "--like",
    metavar="FILE",
    type=click.Path(),
    help="Give each joint the axes of its namesake in FILE's bind pose.",
)
@click.option(
    "--save-frames",
    metavar="FILE.json",
    type=click.Path(dir_okay=False),
    help="Write the change of frame of each joint.",
)
@click.option(
    "--frames",
    metavar="FILE.json",
    type=click.Path(),
    help="Apply the changes of a --save-frames file.",
)
@click.option("--inverse", is_flag=True, help="With --frames: undo them.")
@click.option(
    "--bake-xform",
    is_flag=True,
    help="USD plain hierarchies: rewrite to translate, orient, scale instead of adding two ops.",
)
@reading_options
@edit_options
@output_options
@click.pass_context
def command(ctx: click.Context, /, **values: Any) -> None:
    """Give joints new axes; nothing that can be seen moves.

    Unnamed, the joints with weight on or below them turn; root joints, helpers, lone
    end joints beside siblings and VRM eyes stay. The hierarchy never changes.

    \b
    Examples:
        rigtri orient-joints hero.glb -o out.glb --aim x --up y
        rigtri orient-joints hero.glb -o out.glb --preset blender
        rigtri orient-joints hero.glb -o out.glb --chain thumb_01 thumb_03 --up -z
        rigtri orient-joints back.glb -o same.glb --like hero.glb
    """
    copy_ahead(ctx, values)
    from rigtri.pipeline.steps.orient_joints import step

    asked = step(request(values | {"order": ctx.meta["rigtri.order"]}))
    run_edit("orient-joints", values, asked, given_options(ctx), summary, partial(_save_frames, values))


def _save_frames(values: dict[str, Any], report: Report) -> None:
    from rigtri.files.staged_output import write_text
    from rigtri.operations.orient_joints.frame_sources import frames_json

    if values["save_frames"]:
        write_text(Path(values["save_frames"]), json.dumps(frames_json(report), indent=1) + "\n")


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    counts = {"turned": 0, "unchanged": 0, "kept": 0}
    for entry in report.joints:
        counts[entry["status"]] += 1
    turned = counted(counts["turned"], "joint")
    words = f"{turned} turned, {counts['unchanged']} already stood so, {counts['kept']} kept"
    return "\n".join([words, *_splits(report)])


def _splits(report: Report) -> list[str]:
    """One line for each joint that was split: which, and for the sake of which scale."""
    lines = []
    for entry in (entry for entry in report.joints if entry.get("split")):
        words, scale = "", entry.get("scale")
        if scale is not None:
            words = ": its scale is " + " ".join(f"{x:.6g}" for x in scale["value"])
            words += f" in {scale['clip']} at {scale['time']:.6g}" if scale["clip"] else ""
        lines.append(f"{entry['joint']} was split, a node above it holds its axes{words}")
    return lines
