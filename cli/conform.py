"""rigtri conform

The steps are rename-joints, set-rest, freeze, add-root and orient-joints; --save-spec writes them as a
rig spec that you can edit and build. Every clip looks as before. Characters that conform to one skeleton
have the same names, axes and rest pose, so they can share clips.

\b
Examples:
    rigtri conform hero.glb -o out.glb --to unreal
    rigtri conform hero.vrm -o out.vrm --to vrm --save-spec conform.yaml
"""

from __future__ import annotations

import json

from rigtri.operations.options.conform import ConformOptions
from rigtri.report import Report

from .edit_command import SavedFile, edit_command
from .printing import rebaked


def _spec(report: Report) -> str:
    """The steps that were taken, as a rig spec."""
    lines = ["version: 1", "steps:"]
    for entry in (entry for entry in report.added if entry["type"] == "step"):
        options = {k: v for k, v in entry.items() if k not in ("type", "node", "new", "do")}
        words = "".join(f", {key}: {json.dumps(value)}" for key, value in options.items())
        lines.append(f"  - {{do: {entry['do']}{words}}}")
    return "\n".join(lines) + "\n"


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    steps = dict.fromkeys(entry["do"] for entry in report.added if entry["type"] == "step")
    return f"conforms: {', '.join(steps)}{rebaked(report)}"


_MORE = [
    SavedFile("--save-spec", "FILE.yaml", _spec, help="Write the steps as a rig spec, for rigtri build.")
]
command = edit_command("conform", ConformOptions, summary, __doc__, more=_MORE)
