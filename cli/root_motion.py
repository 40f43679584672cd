"""rigtri root-motion

With --mode extract the root gets the motion, and the hips and all else below the root get new keys, so
that every clip looks as before. With --mode remove the character stays in place. There must be a root
above the hips; rigtri add-root adds one.

\b
Examples:
    rigtri root-motion walk.glb -o out.glb
    rigtri root-motion walk.glb -o out.glb --mode remove --clip 'Run*'
"""

from __future__ import annotations

from rigtri.operations.options.root_motion import RootMotionOptions
from rigtri.report import Report

from .edit_command import edit_command
from .printing import rebaked
from .terminal_text import counted


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    if not report.added:
        return "no hips move over the ground; nothing was changed"
    moved = [entry for entry in report.added if entry["type"] == "moved"]
    done = "went to the root" if moved[0]["mode"] == "extract" else "was removed"
    return f"motion over the ground {done} in {counted(len(moved), 'clip')}{rebaked(report)}"


command = edit_command("root-motion", RootMotionOptions, summary, __doc__)
