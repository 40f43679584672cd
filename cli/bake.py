"""rigtri bake"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from .asked import given_options, request
from .editing import run_edit
from .options import edit_options, output_options, reading_options, says_more, source_argument, target_option
from .values import Number, Tolerance
from .words import counted, grown

if TYPE_CHECKING:
    from rigtri.report import Report


@says_more(
    "tolerance", "Also how far keys that are left out may be off, all together, as a share of the rig's size."
)
@click.command("bake")
@source_argument
@target_option
@click.option(
    "--to",
    type=click.Choice(["joints", "controls"]),
    default="joints",
    show_default=True,
    help="joints: what controls, IK and constraints make of them. controls: the motion that the joints have.",
)
@click.option(
    "--rig",
    "described",
    metavar="FILE",
    type=click.Path(dir_okay=False),
    help="Read what is a control of what from this file, by name: exporters drop it from IN. To keep its "
    "keys between IN's frames, too, take-clips first.",
)
@click.option(
    "--as",
    "names",
    multiple=True,
    metavar="NAME=CLIP",
    help="With --rig: the clip NAME (or glob) of IN is CLIP of that file, or a part of it. Repeatable.",
)
@click.option("--clip", "clips", multiple=True, metavar="GLOB", help="Only these clips. Repeatable.")
@click.option(
    "--fps",
    type=Number(min=0, min_open=True),
    help="So many samples a second besides the keys, and no others. [as many as --between needs]",
)
@click.option(
    "--between",
    type=Tolerance(),
    default=1e-3,
    show_default=True,
    help="How far what lies between samples may be off, as a share of the rig's size.",
)
@click.option(
    "--soft",
    type=Number(min=0, max=1, max_open=True),
    metavar="SHARE",
    help="How far before it is straight an IK limb slows down, as a share of its length. [as stored, or 0]",
)
@click.option(
    "--stretch/--no-stretch",
    default=None,
    help="IK limbs grow to reach their target. [as stored, or not]",
)
@reading_options
@edit_options
@output_options
@click.pass_context
def command(ctx: click.Context, /, **values: Any) -> None:
    """Work controls and constraints out into joint keys, or joints' motion into controls.

    A control that has keys in a clip moves its joints there; joints whose controls have none keep
    their own keys. Keys that tell nothing new are left out, within --tolerance.

    \b
    Examples:
        rigtri bake rigged.glb -o game.glb --to joints
        rigtri bake rigged.glb -o animate.glb --to controls --clip 'walk*'
        rigtri bake edited.glb -o home.glb --to joints --rig rigged.glb
        rigtri bake edited.glb -o home.glb --to joints --rig rigged.glb --as '*_ctlAction=walk'
    """
    from rigtri.pipeline.steps.bake import step

    run_edit("bake", values, step(request(values)), given_options(ctx), summary)


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    clips = [entry for entry in report.added if entry["type"] == "clip"]
    beside = _beside(report)
    if not clips:
        bare = any(notice.code == "no-clips" for notice in report.warnings)
        nothing = "the file has no clips" if bare else "no clip has keys of controls or constraints"
        return "; ".join([nothing, *(beside or ["nothing was baked"])])
    keys, frames = sum(entry["keys"] for entry in clips), sum(entry["frames"] for entry in clips)
    line = ", ".join([counted(len(clips), "clip"), counted(frames, "frame"), counted(keys, "key")])
    line += f" for {counted(max(e['nodes'] for e in clips), 'node')}"
    line += grown(clips)
    curved = max(entry["between_samples"] for entry in clips)
    line += f"; between samples within {curved:.2g} of the size" if curved else ""
    line = "; ".join([line, *beside])
    if clips[0]["to"] == "controls":
        far = max(entry["deviation"] for entry in clips)
        turn = max(entry["residual_degrees"] for entry in clips)
        line += f"; the controls give the joints back within {far:.2g} of the size"
        line += f", with up to {turn:.2g}° below IK" if any(entry["limbs"] for entry in clips) else ""
    return line


def _beside(report: Report) -> list[str]:
    """What was done beside keys."""
    of: dict[str, list[dict[str, Any]]] = {}
    for entry in report.added:
        of.setdefault(entry["type"], []).append(entry)
    said = []
    if resting := {name for entry in of.get("rest", []) for name in entry["nodes"]}:
        said.append(f"{counted(len(resting), 'node')} at rest")
    if told := sum(len(entry["nodes"]) for entry in of.get("described", [])):
        said.append(f"{counted(told, 'node')} put where the file of --rig has them")
    if parts := of.get("joined"):
        whole = ", ".join(f"'{entry['clip']}'" for entry in parts)
        said.append(f"{counted(sum(len(entry['from']) for entry in parts), 'clip')} of IN known as {whole}")
    for entry in of.get("moved", []):
        by = f"{abs(entry['by']):.4g} {'earlier' if entry['by'] < 0 else 'later'} than in IN"
        said.append(f"'{entry['clip']}' begins where the file of --rig has it, {by}")
    return said
