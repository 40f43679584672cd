"""rigtri orient-joints"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rigtri.errors import FileError, RigtriError, UsageError
from rigtri.ops.presets import PRESETS, Style

from .options import (
    copy_ahead,
    edit_options,
    facing_option,
    given_options,
    load_json,
    output_options,
    reading_options,
    refuse_given,
    run_edit,
    source_argument,
    target_option,
    turn_options,
)

if TYPE_CHECKING:
    from rigtri.report import Report
    from rigtri.rig import Rig

_BRANCHES = ("chain", "first", "average", "longest", "incoming", "keep")
_STYLED = ("aim", "up", "up_from")
# Options that say where axes go, which frames from elsewhere have said already.
_GEOMETRY = (
    "--preset",
    "--aim",
    "--up",
    "--up-from",
    "--aim-at",
    "--branch",
    "--end",
    "--per-joint-plane",
    "--facing",
    "--world",
)


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
@click.option(
    "--preset",
    type=click.Choice(list(PRESETS)),
    help="The axes of another program: aim, up and where up comes from.",
)
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
@click.option("--from-side", type=click.Choice(["left", "right"]), default="left", show_default=True)
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
    from rigtri.limbs import given
    from rigtri.ops.frames import frames_json
    from rigtri.ops.orient import Options, orient_joints

    style, chain_styles = _styles(ctx, values["preset"], values["world"])
    rules = [word for word in values["branch"] if word in _BRANCHES]
    _check(values)
    frames = load_json(values["frames"]) if values["frames"] else None
    like = _like(values["like"]) if values["like"] else None
    saved: dict[str, Any] = {}

    def step(rig: Rig, report: Report) -> Rig:
        options = Options(
            style=style,
            selection=_selection(values),
            chain_styles=chain_styles,
            branch=rules[-1] if rules else "chain",
            branch_to=tuple(word for word in values["branch"] if word not in _BRANCHES),
            end=values["end"],
            aim_at=tuple(_pair(rig, text) for text in values["aim_at"]),
            limbs=tuple(given(rig, *names) for names in values["limbs"]),
            per_joint_plane=values["per_joint_plane"],
            facing=values["facing"],
            pose=values["pose"],
            on_nonuniform_scale=values["on_nonuniform_scale"],
            on_constraint=values["on_constraint"],
            snap=values["snap"],
            offset=values["offset"],
            mirror=values["mirror"],
            from_side=values["from_side"],
            plane=values["plane"],
            root=values["root"],
            like=like,
            frames=frames,
            inverse=values["inverse"],
            tolerance=values["tolerance"],
        )
        turned = orient_joints(rig, options=options, report=report)
        saved["frames"] = frames_json(report)
        return turned

    run_edit("orient-joints", values, step, given_options(ctx), _summary, lambda: _save_frames(values, saved))


def _save_frames(values: dict[str, Any], saved: dict[str, Any]) -> None:
    from rigtri.outputs import write_text

    if values["save_frames"]:
        write_text(Path(values["save_frames"]), json.dumps(saved["frames"], indent=1) + "\n")


def _styles(
    ctx: click.Context, preset: str | None, world: bool
) -> tuple[Style, tuple[tuple[str, str, Style], ...]]:
    """The style for all, and the styles of chains: what stands behind a --chain is for it."""
    from dataclasses import replace

    base = PRESETS[preset] if preset else Style()
    base = replace(base, world=True) if world else base
    chains: list[tuple[str, str, Style]] = []
    for name, value in ctx.meta["rigtri.order"]:
        if name == "chains":
            chains.append((*value, base))
        elif chains:
            start, end, style = chains[-1]
            chains[-1] = (start, end, replace(style, **{name: value}))
        else:
            base = replace(base, **{name: value})
    base.checked()
    return base, tuple((start, end, style.checked()) for start, end, style in chains)


def _check(values: dict[str, Any]) -> None:
    """Options that contradict each other."""
    if values["like"] and values["frames"]:
        raise UsageError("give --like or --frames, not both")
    if values["inverse"] and not values["frames"]:
        raise UsageError("--inverse goes with --frames")
    if values["mirror"] and (values["frames"] or values["like"]):
        raise UsageError("--mirror does not go with --like or --frames")
    mirrored = {"--from-side": "from_side", "--plane": "plane"}
    if not values["mirror"]:
        refuse_given(mirrored, "goes with --mirror")
    geometry = {flag: flag[2:].replace("-", "_") for flag in _GEOMETRY}
    if values["frames"]:
        refuse_given(geometry | {"--offset": "offset", "--snap": "snap"}, "does not go with --frames")
    if values["like"]:
        refuse_given(geometry, "does not go with --like")
    if values["world"] or values["preset"] == "vrm":
        axes = {"--aim": "aim", "--up": "up", "--up-from": "up_from"}
        refuse_given(axes, "does not go with axes parallel to the world")
    if values["world"] and values["preset"] not in (None, "vrm"):
        raise UsageError("give --preset or --world, not both")
    if sum(word in _BRANCHES for word in values["branch"]) > 1:
        raise UsageError("give one rule with --branch, and any number of names of children")


def _selection(values: dict[str, Any]) -> Any:
    from rigtri.ops.select import Selection

    return Selection(
        joints=values["joints"],
        below=values["below"],
        skin=values["skin"],
        exclude=values["exclude"],
    )


def _pair(rig: Rig, text: str) -> tuple[str, str]:
    """JOINT=NODE; names may hold ``=`` themselves, so the cut is where both sides are found."""
    cuts = [k for k, letter in enumerate(text) if letter == "=" and 0 < k < len(text) - 1]
    if not cuts:
        raise UsageError(f"--aim-at {text}: give JOINT=NODE")
    pairs = [(text[:k], text[k + 1 :]) for k in cuts]
    found = [pair for pair in pairs if all(rig.has(name) for name in pair)]
    joint, node = found[0] if len(found) == 1 else pairs[0]
    if rig.find(joint) == rig.find(node, "node"):
        raise UsageError(f"--aim-at {text}: a joint cannot aim at itself")
    return joint, node


def _like(path: str) -> Rig:
    from rigtri.formats import read

    if not Path(path).is_file():
        raise FileError(f"--like {path}: there is no such file")
    try:
        return read(Path(path)).rig
    except RigtriError as error:
        raise type(error)(f"--like: {error}") from error


def _summary(report: Report) -> str:
    counts = {"turned": 0, "unchanged": 0, "kept": 0}
    for entry in report.joints:
        counts[entry["status"]] += 1
    words = f"{counts['turned']} joints turned, {counts['unchanged']} already stood so, {counts['kept']} kept"
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
