"""rigtri take-clips

Joints and controls are found by name and move as in EDITED, relative to RIG's own bind pose, whatever
axes, unit and extra nodes a DCC has given EDITED. Unchanged tracks stay bit for bit, and so do the
unchanged parts of edited ones. Keys on every frame are reduced to those that are needed, within
--tolerance. Clips that a DCC has split per object are joined.

\b
Examples:
    rigtri take-clips rigged.glb --from edited.glb -o home.glb
    rigtri take-clips rigged.glb --from edited.usda -o home.glb --clip 'walk*'
    rigtri take-clips rigged.glb --from edited.glb -o home.glb --as hand_ctlAction=walk
"""

from __future__ import annotations

from typing import Any

import click

from rigtri.operations.options.take_clips import TakeClipsOptions
from rigtri.report import Report

from .edit_command import declared_options, step_of
from .editing import run_edit
from .given_options import check_streams, given_options
from .help_format import Command
from .option_types import FilePath
from .shared_options import edit_options, output_options, reading_options, target_option
from .terminal_text import counted, grown


@click.command("take-clips", cls=Command, help=__doc__)
@click.argument("source", metavar="RIG", type=FilePath(allow_dash=True))
@target_option
@declared_options(TakeClipsOptions)
@reading_options
@edit_options
@output_options
@click.pass_context
def command(ctx: click.Context, /, **values: Any) -> None:
    check_streams(str(values["source"]), str(values["from_"]))
    run_edit(
        "take-clips", values, step_of("take-clips", TakeClipsOptions, values), given_options(ctx), summary
    )


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    clips = [entry for entry in report.added if entry["type"] == "clip"]
    tracks, same = sum(entry["tracks"] for entry in clips), sum(entry["same"] for entry in clips)
    nodes = {name for entry in clips for name in entry["changed"]}
    if not tracks:
        seen = f"{counted(len(clips), 'clip')}, {counted(same, 'track')}"
        return f"{seen}: EDITED has no changes; nothing was transferred"
    new = sum(entry["new"] for entry in clips)
    more = f", {new} of them new" if new else ""
    taken = f"{counted(tracks, 'track')} of {counted(len(nodes), 'node')} transferred"
    return f"{counted(len(clips), 'clip')}{more}: {taken}, {same} unchanged{grown(clips)}"
