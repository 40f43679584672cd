"""rigtri strip

The axes of joints stay as orient-joints has set them, and so do sockets, joints of add-root and other nodes
of the character. Everything that stays is verified to look as before.

\b
Example:
    rigtri strip rigged.glb -o plain.glb
"""

from __future__ import annotations

from rigtri.operations.options.strip import StripOptions
from rigtri.report import Report

from .edit_command import edit_command


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    nodes = sum(not entry["kept"] for entry in report.removed)
    others = len(report.removed) - nodes
    if not report.removed:
        return "nothing in this file was added by rigtri"
    elsewhere = report.warned("rig-elsewhere")
    what = (
        "what this file changes of the rig that stays, such as keys, at" if elsewhere else "the metadata of"
    )
    kept = f", and {what} {others} others" if others else ""
    return f"removed: {nodes} nodes{kept}"


command = edit_command("strip", StripOptions, summary, __doc__)
