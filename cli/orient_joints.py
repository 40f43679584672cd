"""rigtri orient-joints

By default all joints with weight on or below them get new axes. Root joints other than a character's
hips, helpers, sockets, lone end joints beside siblings (of faces and props) and VRM eyes stay. Each hand,
the trunk and the limbs of a recognised character flex about one axis (docs/presets.md). The hierarchy
never changes.

\b
Examples:
    rigtri orient-joints hero.glb -o out.glb --aim x --up y
    rigtri orient-joints hero.glb -o out.glb --preset blender
    rigtri orient-joints hero.glb -o out.glb --chain thumb_01 thumb_03 --up -z
    rigtri orient-joints back.glb -o same.glb --like hero.glb
"""

from __future__ import annotations

import json
from typing import Any

import click

from rigtri.operations.axis_presets import AXES
from rigtri.operations.options.orient_joints import OrientJointsOptions
from rigtri.report import Report

from .edit_command import SavedFile, edit_command
from .help_format import Command, Option
from .shared_options import shared_option
from .terminal_text import counted


class InOrder(Command):
    """A command that knows in which order its options were given: styles follow their chain."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        values, _, order = self.make_parser(ctx).parse_args(args=list(args))
        waiting = {p.name: list(values[p.name]) for p in order if p.name in (*AXES, "chain")}
        rest = super().parse_args(ctx, args)
        ctx.params |= _styles([(str(p.name), waiting[p.name].pop(0)) for p in order if p.name in waiting])
        return rest


def _styles(order: list[tuple[str, Any]]) -> dict[str, Any]:
    """The axes of all joints, and the chains with those that stand behind each."""
    base: dict[str, Any] = {}
    chains: list[dict[str, Any]] = []
    for name, value in order:
        if name == "chain":
            chains.append({"start": value[0], "end": value[1]})
        else:
            (chains[-1] if chains else base)[name] = value
    return {**dict.fromkeys(AXES), **base, "chain": tuple(chains)}


def _frames(report: Report) -> str:
    from rigtri.operations.orient_joints.frame_sources import frames_json

    return json.dumps(frames_json(report), indent=1) + "\n"


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    counts = {"turned": 0, "unchanged": 0, "kept": 0}
    for entry in report.joints:
        counts[entry["status"]] += 1
    reasons = counts["kept"] and not click.get_current_context().params["verbose"]
    skipped = f"{counts['kept']} skipped" + (" (reasons with -v)" if reasons else "")
    line = f"{counted(counts['turned'], 'joint')} re-oriented, {counts['unchanged']} unchanged, {skipped}"
    if not counts["turned"]:
        already = f"{counts['unchanged']} have these axes already, " if counts["unchanged"] else ""
        line = f"no joint was re-oriented: {already}{skipped}"
    return "\n".join([line, *_splits(report)])


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


_MORE = [
    shared_option("allow_rename"),
    shared_option("unknown_node_ext"),
    SavedFile(
        "--save-frames", "FILE.json", _frames, help="Write the change of frame of each joint.", rare=True
    ),
    shared_option("bake_xform"),
]
command = edit_command("orient-joints", OrientJointsOptions, summary, __doc__, more=_MORE, cls=InOrder)
for _option in command.params:
    if _option.name in AXES:  # each as often as there are chains
        _option.multiple = True
    if isinstance(_option, Option) and _option.name == "chain":
        _option.help = (
            "Re-orient this chain. --aim, --up and --up-from after it apply to it alone. Repeatable."
        )
