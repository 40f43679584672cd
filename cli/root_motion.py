"""Move what the hips of IN move over the ground to the root above them, or take it out of the clips.

Extracted, nothing but the root stands elsewhere in any clip: hips, and what else is below the root, get other
keys; removed, the character stays in place. There must be a root above the hips: rigtri add-root.

\b
Examples:
    rigtri root-motion walk.glb -o out.glb
    rigtri root-motion walk.glb -o out.glb --mode remove --clip 'Run*'
"""

from __future__ import annotations

from rigtri.operations.options.root_motion import RootMotionOptions
from rigtri.report import Report

from .edit_command import edit_command
from .terminal_text import counted


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    if not report.added:
        return "no hips move over the ground; nothing was changed"
    done = "went to the root" if report.added[0]["mode"] == "extract" else "was removed"
    return f"motion over the ground {done} in {counted(len(report.added), 'clip')}"


command = edit_command("root-motion", RootMotionOptions, summary, __doc__)
